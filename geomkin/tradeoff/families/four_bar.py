"""Four families of a four-bar: positions and rates, of an ordinary one and of one that comes near a toggle."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from math import cos, fsum, sin
from typing import Any

import numpy as np

from ...core.records import record
from ...linkage.moving import move, placements_for
from ...linkage.named_linkages import FourBar
from ...linkage.solve.branch import as_branch_spec
from ...linkage.solve.continuation import newton_raphson
from ...linkage.solve.input_dyads import CrankDriven
from ...linkage.solve.placement import Timing
from ...linkage.solve.solution import LinkageSolution
from ...plane.vec import Array, Complex, Real
from ..family import FRAMES, MethodFamily, Track, circling, exact, method, misses, pinned, tables, turn

Directions = tuple[Complex, Complex]
# First and second derivatives of the angles of coupler and rocker by the crank's: h3, h4, h3', h4'.
Rates = tuple[Real, ...]
ORDINARY, NEAR_TOGGLE = FourBar(100, 30, 90, 70), FourBar(100, 30, 60, 70 + 1e-8)
# The driver turns at 1 rad/s: rates are derivatives by its angle.
STEADY = Timing(np.asarray(1.0), np.asarray(0.0))
REASONS: dict[str, Any] = {
    "rationale": "one call serves any linkage, driver and branch, and keeps all digits up to a toggle and through it.",
    "caveat": "The overhead of the general call is constant. It is the same for one pose as for these 360, so it "
    "matters less with more poses per call.",
}


@record(eq=False)
class FourBarTrack(Track):
    """A four-bar with the exact directions of coupler and rocker, and the exact derivatives of their angles.

    `lengths` are those of crank, coupler, rocker and ground; `first` and `second` are (2, frames).
    """

    lengths: tuple[float, float, float, float]
    first: Real
    second: Real

    @classmethod
    @cache
    def of(cls, linkage: FourBar) -> FourBarTrack:
        """By decimal arithmetic, over a turn of the crank."""
        bar_sizes: Any = (linkage.crank, linkage.coupler, linkage.rocker, linkage.ground)
        a, b, c, d = map(float, bar_sizes)
        drive = turn()

        def bar(angle: Any, from_crank: bool) -> Any:
            pin = circling(a, angle)
            return (pinned(pin, d, b, c, 1) - (pin if from_crank else d)).direction

        found = [exact(partial(bar, from_crank=one), drive, rotating=True) for one in (True, False)]
        right, first, second = np.stack(found, axis=1)
        return cls(linkage, drive, right, (a, b, c, d), first.imag, second.imag)


def general_solution(linkage: Any, drive: Real) -> Callable[[], LinkageSolution]:
    """The linkage solved anew at each call by the solver for dyads between any two moving bodies."""
    steps = tuple(one.dyad if isinstance(one, CrankDriven) else one for one in placements_for(linkage, 1))
    return lambda: LinkageSolution(linkage, lambda: steps, drive, as_branch_spec(1), STEADY)


# Positions


@method("geomkin.move", **REASONS)
def _library(track: FourBarTrack) -> Directions:
    """The library's call, for any linkage: it finds in which order members are placed, and solves a four-bar by the
    toggle-proof form.
    """
    motion = move(track.linkage, track.drive)
    return motion.coupler.direction, motion.rocker.direction


@method("toggle-proof form, plain NumPy")
def _toggle_proof(track: FourBarTrack) -> Directions:
    """Every quantity that vanishes at a toggle is a product of factors, and the constants among them are exact (derived
    for geomkin).
    """
    return by_toggle_proof_form(track.lengths, track.drive)


def by_toggle_proof_form(lengths: tuple[float, float, float, float], drive: Real) -> Directions:
    """Factors instead of differences of squares; crank, coupler, rocker, ground."""
    a, b, c, d = lengths
    one, two = closing_gaps(a, b, c, d)
    half, k = 0.5 * drive, 2 * np.sqrt(a * d)
    x, y = k * np.cos(half), k * np.sin(half)
    s = (d - a) ** 2 + y * y
    u = (d - a) + (y * y - 1j * (x * y)) / (2 * d)
    over = 0.5 / s
    p = 0.5 + (b - c) * (b + c) * over
    bar = (p + 1j * (np.sqrt((one + x * x) * (two + y * y)) * over)) * u
    return bar / b, (bar - u) / c


def closing_gaps(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """(b + c)^2 - (a + d)^2 and (d - a)^2 - (b - c)^2, without the digits that squares would lose."""
    return fsum((b, c, -a, -d)) * (a + b + c + d), fsum((d, -a, -b, c)) * fsum((d, -a, b, -c))


@method("general dyad solver", prepared=True)
def _general_dyad(track: FourBarTrack) -> Callable[[], Directions]:
    """The library's solver of two bars between any two moving points: Heron's formula in Kahan's factors."""
    solve = general_solution(track.linkage.linkage, track.drive)

    def call() -> Directions:
        solution = solve()
        return solution.value("direction", "coupler"), solution.value("direction", "rocker")

    return call


@method("unit vectors")
def _unit_vectors(track: FourBarTrack) -> Directions:
    """The textbooks' vector form: one component along the diagonal's unit vector, and one across it."""
    return by_unit_vectors(track.lengths, track.drive)


def by_unit_vectors(lengths: Any, drive: Real) -> Directions:
    """The components of the coupler along and across the diagonal's unit vector."""
    a, b, c, d = lengths
    u = d - a * np.exp(1j * drive)
    length = np.abs(u)
    along = (length * length + (b * b - c * c)) / (2 * length)
    with np.errstate(invalid="ignore"):
        across = np.sqrt(b * b - along * along)
    bar = (along + 1j * across) * (u / length)
    return bar / b, (bar - u) / c


@method("half-angle (Freudenstein)")
def _half_angles(track: FourBarTrack) -> Directions:
    """Freudenstein's equation as a quadratic in the tangent of half the angle (Norton, Design of Machinery,
    chapter 4).
    """
    a, b, c, d = track.lengths
    k1, k2, k3 = d / a, d / c, (a * a - b * b + c * c + d * d) / (2 * a * c)
    k4, k5 = d / b, (c * c - d * d - a * a - b * b) / (2 * a * b)
    cosine, middle = np.cos(track.drive), -2 * np.sin(track.drive)

    def direction(first: Real, last: Real) -> Complex:
        with np.errstate(invalid="ignore"):
            root = np.sqrt(middle * middle - 4 * first * last)
        return np.asarray(np.exp(2j * np.arctan2(-middle - root, 2 * first)))

    rocker = direction(cosine - k1 - k2 * cosine + k3, k1 - (k2 + 1) * cosine + k3)
    return direction(cosine - k1 + k4 * cosine + k5, k1 + (k4 - 1) * cosine + k5), rocker


@method("diagonal and cosine rule")
def _diagonal(track: FourBarTrack) -> Directions:
    """Two triangles on the diagonal, their angles by the cosine rule."""
    a, b, c, d = track.lengths
    px, py = a * np.cos(track.drive), a * np.sin(track.drive)
    square = (d - px) ** 2 + py * py
    length, diagonal = np.sqrt(square), np.arctan2(-py, d - px)
    with np.errstate(invalid="ignore"):
        coupler = diagonal + np.arccos((b * b + square - c * c) / (2 * b * length))
        rocker = diagonal + np.pi - np.arccos((c * c + square - b * b) / (2 * c * length))
    return np.exp(1j * coupler), np.exp(1j * rocker)


def by_components(lengths: Any, drive: Real) -> Any:
    """Crank and coupler by real components, which are faster than complex numbers of 32 bits."""
    a, b, c, d = lengths
    px, py = a * np.cos(drive), a * np.sin(drive)
    ux, uy = d - px, -py
    square = ux * ux + uy * uy
    along = (square + (b - c) * (b + c)) / (2 * square)
    with np.errstate(invalid="ignore"):
        across = np.sqrt(b * b / square - along * along)
    return (px, py), (along * ux - across * uy, along * uy + across * ux)


@method("single precision", prepared=True)
def _single(track: FourBarTrack) -> Callable[[], Directions]:
    """The vector form in 32-bit numbers, from angles and sizes that were converted beforehand."""
    _, b, c, d = lengths = [np.float32(v) for v in track.lengths]
    drive = track.drive.astype(np.float32)

    def call() -> Directions:
        (px, py), (bx, by) = by_components(lengths, drive)
        return (bx + 1j * by) / b, (bx - (d - px) + 1j * (by + py)) / c

    return call


@method("Newton, cold", "steps", (2, 3, 4, 5, 6, 8))
def _newton_cold(track: FourBarTrack, steps: float) -> Directions:
    """All frames at once from the pose at a quarter turn, by so many steps on the loop's two equations."""
    a, b, c, d = track.lengths
    px, py = d - a * np.cos(track.drive), -a * np.sin(track.drive)
    coupler, rocker = np.angle(track.right[:, FRAMES // 4, None]) * np.ones(FRAMES)
    with np.errstate(all="ignore"):
        for _ in range(int(steps)):
            bx, by = b * np.cos(coupler), b * np.sin(coupler)
            cx, cy = c * np.cos(rocker), c * np.sin(rocker)
            off_x, off_y, share = bx - cx - px, by - cy - py, 1 / (by * cx - bx * cy)
            coupler = coupler + (off_x * cx + off_y * cy) * share
            rocker = rocker + (off_x * bx + off_y * by) * share
    return np.exp(1j * coupler), np.exp(1j * rocker)


@method("Newton, warm", "tolerance, rad", (1e-2, 1e-5, 1e-9))
def _newton_warm(track: FourBarTrack, tolerance: float) -> Array:
    """Frame by frame in plain Python, each from the frame before, until both angles change by less than the
    tolerance.
    """
    a, b, c, d = track.lengths
    coupler, rocker = np.angle(track.right[:, 0]).tolist()
    found = []
    for t in track.drive.tolist():
        ux, uy = d - a * cos(t), -a * sin(t)
        for _ in range(30):
            bx, by, cx, cy = b * cos(coupler), b * sin(coupler), c * cos(rocker), c * sin(rocker)
            off_x, off_y, share = bx - cx - ux, by - cy - uy, (by * cx - bx * cy) or 1e-300
            one, two = (off_x * cx + off_y * cy) / share, (off_x * bx + off_y * by) / share
            coupler, rocker = coupler + one, rocker + two
            if abs(one) + abs(two) < tolerance:
                break
        found.append((coupler, rocker))
    return np.asarray(np.exp(1j * np.array(found)).T)


@method("root finder per frame", "tolerance", (1e-3, 1e-13))
def _root_finder(track: FourBarTrack, tolerance: float) -> Array:
    """The library's newton_raphson called for each frame, from the frame before."""
    a, b, c, d = track.lengths
    angles, found = np.angle(track.right[:, 0]), []
    for u in (d - a * np.exp(1j * track.drive)).tolist():

        def off(x: Real, u: complex = u) -> Real:
            z = b * np.exp(1j * x[0]) - c * np.exp(1j * x[1]) - u
            return np.array([z.real, z.imag])

        def slope(x: Real) -> Real:
            z = 1j * b * np.exp(1j * x[0]), -1j * c * np.exp(1j * x[1])
            return np.array([[z[0].real, z[1].real], [z[0].imag, z[1].imag]])

        angles = newton_raphson(off, slope, angles, tolerance).value
        found.append(angles)
    return np.asarray(np.exp(1j * np.array(found)).T)


def _tabulated(track: Any, drive: Real) -> Array:
    return np.asarray(np.nan_to_num(np.array(by_unit_vectors(track.lengths, drive))))


def _family(name: str, title: str, linkage: FourBar, computed: str, **others: Any) -> MethodFamily:
    near = linkage is NEAR_TOGGLE
    return MethodFamily(
        name=name,
        title=title + (" near its toggle" if near else ""),
        about=f"{NEAR_ABOUT if near else ORDINARY_ABOUT} Computed are {computed}",
        per="pose",
        floor=1e-15,
        problem=lambda: FourBarTrack.of(linkage),
        **others,
    )


ORDINARY_ABOUT = "A crank-rocker of 30, 90, 70 and 100 mm, which stays away from its toggles."
NEAR_ABOUT = (
    "A four-bar of 30, 60, 70 and 100 mm, whose rocker is a hundred-millionth of a mm longer than that: once a turn "
    "all its links are nearly collinear."
)
POSITION, TOGGLE = (
    _family(
        name,
        "Position of a four-bar",
        linkage,
        f"the directions of coupler and rocker at {FRAMES} even steps of a whole turn of the crank; the error is the "
        "larger one of the two.",
        unit="rad",
        reference="intersecting circles, in decimal arithmetic of 110 digits",
        error=misses,
        methods=(_library, _toggle_proof, _general_dyad, _unit_vectors, _half_angles, _diagonal, _single, _newton_cold,
                 _newton_warm, _root_finder, *tables(_tabulated)),
    )
    for name, linkage in (("four-bar-position", ORDINARY), ("four-bar-toggle", NEAR_TOGGLE))
)  # fmt: skip


# Rates


@method("geomkin.move", **REASONS)
def _library_rates(track: FourBarTrack) -> Rates:
    """The library's call, for any linkage: derivatives of the toggle-proof form for a four-bar."""
    motion = move(track.linkage, track.drive)
    return motion.coupler.first, motion.rocker.first, motion.coupler.second, motion.rocker.second


@method("general dyad solver", prepared=True)
def _general_rates(track: FourBarTrack) -> Callable[[], Rates]:
    """The library's solver of two bars between any two moving points, and its loop equations."""
    solve = general_solution(track.linkage.linkage, track.drive)

    def call() -> Rates:
        solution = solve()
        return tuple(solution.value(k, body) for k in ("first", "second") for body in ("coupler", "rocker"))

    return call


@method("toggle-proof form, plain NumPy")
def _toggle_proof_rates(track: FourBarTrack) -> Rates:
    """Derivatives of the toggle-proof form, also in factors (derived for geomkin)."""
    a, b, c, d = track.lengths
    one, two = closing_gaps(a, b, c, d)
    half, k = 0.5 * track.drive, 2 * np.sqrt(a * d)
    x, y = k * np.cos(half), k * np.sin(half)
    f1, f2 = np.sqrt(one + x * x), np.sqrt(two + y * y)
    s = (d - a) ** 2 + y * y
    p = 0.5 + (b - c) * (b + c) / (2 * s)
    psi = (y * y - 2 * a * (d - a)) / (2 * s)
    g1, g2 = x / f1, y / f2
    tau = g1 * g2
    change = 0.5 * (two * x / f2**3 * g1 - one * y / f1**3 * g2)
    # (a d sin t / s)(1 - 2 psi + (1 - 2 p) tau), which has no difference that vanishes.
    shared = (x * y) / (2 * s * s) * ((d - a) * (d + a) - (b - c) * (b + c) * tau)
    return psi - (1 - p) * tau, psi + p * tau, shared - (1 - p) * change, shared + p * change


@method("loop equations on unit vectors")
def _loop_equations(track: FourBarTrack) -> Rates:
    """Positions by unit vectors, then the loop's equation differentiated: two linear equations for the velocities and
    two for the accelerations, as in the textbooks.
    """
    return _by_loop(track.lengths, track.drive, by_unit_vectors(track.lengths, track.drive))


@method("loop equations, exact positions")
def _loop_after_toggle_proof(track: FourBarTrack) -> Rates:
    """The same from positions by the toggle-proof form: the digits that the equations themselves lose."""
    return _by_loop(track.lengths, track.drive, by_toggle_proof_form(track.lengths, track.drive))


@method("single precision", prepared=True)
def _single_rates(track: FourBarTrack) -> Callable[[], Rates]:
    """Unit vectors and loop equations in 32-bit numbers."""
    lengths, drive = [np.float32(v) for v in track.lengths], track.drive.astype(np.float32)

    def call() -> Rates:
        (px, py), (bx, by) = by_components(lengths, drive)
        cx, cy = bx - (lengths[3] - px), by + py
        with np.errstate(invalid="ignore", divide="ignore"):
            share = 1 / (bx * cy - by * cx)
            h3, h4 = (cx * py - cy * px) * share, (bx * py - by * px) * share
            wx, wy = px + h3 * h3 * bx - h4 * h4 * cx, py + h3 * h3 * by - h4 * h4 * cy
            return h3, h4, (wx * cx + wy * cy) * share, (wx * bx + wy * by) * share

    return call


def _by_loop(sizes: Any, drive: Real, directions: Directions) -> Rates:
    """The loop's equation differentiated once and twice: two linear equations each."""
    a, b, c, _ = sizes
    crank, bar, arm = a * np.exp(1j * drive), b * directions[0], c * directions[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = 1 / (bar.real * arm.imag - bar.imag * arm.real)
        h3 = (arm.real * crank.imag - arm.imag * crank.real) * share
        h4 = (bar.real * crank.imag - bar.imag * crank.real) * share
        pull = crank + h3 * h3 * bar - h4 * h4 * arm
        second = ((pull.real * one.real + pull.imag * one.imag) * share for one in (arm, bar))
        return h3, h4, *second


@method("differences of positions", "step, deg", (5.0, 1.0, 0.2, 0.05, 0.01))
def _differences(track: FourBarTrack, step: float) -> Rates:
    """Five positions by the toggle-proof form around each frame, and central differences of order 4."""
    h = np.radians(step)
    around = track.drive + h * np.array([-2, -1, 0, 1, 2])[:, None]
    found = []
    for z in by_toggle_proof_form(track.lengths, around):
        # Angles from the middle one, which has no jump by a turn.
        w = np.angle(z * np.conj(z[2]))
        first = (w[0] - w[4] + 8 * (w[3] - w[1])) / (12 * h)
        found.append((first, (16 * (w[1] + w[3]) - w[0] - w[4]) / (12 * h * h)))
    (h3, h3_prime), (h4, h4_prime) = found
    return h3, h4, h3_prime, h4_prime


def _rate_error(track: FourBarTrack, found: Rates) -> Real:
    right = np.concatenate([track.first, track.second])
    off = (np.abs(np.array(found) - right) / np.maximum(1.0, np.abs(right))).max(axis=0)
    # A value that is wrong by more than itself, or is no number, was not found.
    return np.where(off <= 1, off, np.nan)


RATES, TOGGLE_RATES = (
    _family(
        name,
        "Velocity and acceleration of a four-bar",
        linkage,
        f"the first and second derivatives of the angles of coupler and rocker by the crank's at {FRAMES} even steps "
        "of a whole turn, which are velocities and accelerations at a speed of 1 rad/s. The error is the largest one "
        "of the four, as a share of the value, or of 1 if that is larger; a value that is off by more than itself "
        "counts as missed.",
        unit="share of the value",
        reference="intersecting circles, and differences of these, in decimal arithmetic of 110 digits",
        error=_rate_error,
        methods=(_library_rates, _toggle_proof_rates, _general_rates, _loop_equations, _loop_after_toggle_proof,
                 _single_rates, _differences),
    )
    for name, linkage in (("four-bar-rates", ORDINARY), ("four-bar-toggle-rates", NEAR_TOGGLE))
)  # fmt: skip
