"""Position of a slider-crank, of a six-bar by dyads or by iteration, and of one that no dyads place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from functools import partial
from math import cos, sin, sqrt
from typing import Any

import numpy as np

from ...linkage.linkage import Linkage
from ...linkage.moving import move, placements_for
from ...linkage.named_linkages import FourBar, SliderCrank
from ...linkage.six_bars import StephensonSixBar
from ...linkage.solve.branch import as_branch_spec
from ...linkage.solve.continuation import newton_raphson
from ...linkage.solve.loops import Loops
from ...linkage.solve.solution import LinkageSolution
from ...plane.vec import Complex, Real
from ..family import (
    ENTRIES,
    FRAMES,
    DecimalComplex,
    Method,
    MethodFamily,
    Track,
    circling,
    coupler_point,
    exact,
    method,
    misses,
    pinned,
    tables,
    turn,
)
from .four_bar import REASONS, STEADY, general_solution

# Slider-crank

A, ROD, OFFSET = 30.0, 90.0, 10.0
SLIDER = SliderCrank(A, ROD, OFFSET)


def _slider_problem() -> Track:
    def slider(angle: Decimal) -> DecimalComplex:
        pin, rod = circling(A, angle), Decimal(ROD)
        return DecimalComplex(pin.real + (rod * rod - (Decimal(OFFSET) - pin.imag) ** 2).sqrt())

    return Track(SLIDER, turn(), exact(slider, turn())[0].real)


@method("geomkin.move", **REASONS)
def _slider_by_library(track: Track) -> Real:
    """The library's call, for any linkage: the rod's direction by the product of factors, and from there the slider's
    position.
    """
    return move(track.linkage, track.drive).slider.origin.position.real


@method("general dyad solver", prepared=True)
def _slider_by_dyad(track: Track) -> Callable[[], Real]:
    """The library's solver of a bar and a slide on any two moving bodies."""
    solve = general_solution(SLIDER.linkage, track.drive)
    return lambda: solve().origin("slider", 0).real


def _factors_of(drive: Real) -> Real:
    down = OFFSET - A * np.sin(drive)
    return np.asarray(A * np.cos(drive) + np.sqrt((ROD - down) * (ROD + down)))


@method("product of factors")
def _factors(track: Track) -> Real:
    """The root of (l - n)(l + n), n the crank pin's height over the line."""
    return _factors_of(track.drive)


@method("single precision", prepared=True)
def _factors_in_single_precision(track: Track) -> Callable[[], Real]:
    """The product of factors in 32-bit numbers."""
    return partial(_factors_of, track.drive.astype(np.float32))


def _root_of(drive: Real) -> Real:
    return np.asarray(A * np.cos(drive) + np.sqrt(ROD**2 - (OFFSET - A * np.sin(drive)) ** 2))


@method("root of a difference of squares")
def _root(track: Track) -> Real:
    """The textbooks' root of l^2 - n^2."""
    return _root_of(track.drive)


@method("angle of the rod")
def _rod_angle(track: Track) -> Real:
    """The rod's angle by its sine, the position by its cosine."""
    return np.asarray(A * np.cos(track.drive) + ROD * np.cos(np.arcsin((OFFSET - A * np.sin(track.drive)) / ROD)))


@method("series", "terms", (2.0, 3.0, 4.0, 6.0, 10.0), prepared=True)
def _series(track: Track, terms: float) -> Callable[[], Real]:
    """The root as a series in n/l, of so many terms; two are the books' approximation."""
    # Of sqrt(1 - y^2): 1 - y^2/2 - y^4/8 - ...
    powers = [1.0]
    for k in range(1, int(terms)):
        powers.append(powers[-1] * (k - 1.5) / k)

    def call() -> Real:
        share = (OFFSET - A * np.sin(track.drive)) / ROD
        square, found = share * share, np.full(FRAMES, powers[-1])
        for power in powers[-2::-1]:
            found = power + square * found
        return np.asarray(A * np.cos(track.drive) + ROD * found)

    return call


@method("Newton, cold", "steps", (1.0, 2.0, 3.0, 4.0))
def _rod_by_newton(track: Track, steps: float) -> Real:
    """All frames at once from a level rod, by so many steps for the rod's angle."""
    height, angle = OFFSET - A * np.sin(track.drive), np.zeros(FRAMES)
    for _ in range(int(steps)):
        angle = angle - (ROD * np.sin(angle) - height) / (ROD * np.cos(angle))
    return np.asarray(A * np.cos(track.drive) + ROD * np.cos(angle))


@method("frame by frame", prepared=True)
def _by_frame(track: Track) -> Callable[[], Real]:
    """The textbooks' root in plain Python, without NumPy."""
    drive = track.drive.tolist()
    return lambda: np.array([A * cos(t) + sqrt(ROD**2 - (OFFSET - A * sin(t)) ** 2) for t in drive])


SLIDER_CRANK = MethodFamily(
    name="slider-crank-position", title="Position of a slider-crank", per="pose", unit="mm", floor=5e-14,
    problem=_slider_problem, error=misses,
    about=f"A slider-crank of {A:g} and {ROD:g} mm whose line is {OFFSET:g} mm from the crank's pivot. Computed is the "
    f"slider's position at {FRAMES} even steps of a whole turn of the crank.",
    reference="a circle that intersects a line, in decimal arithmetic of 110 digits",
    methods=(_slider_by_library, _slider_by_dyad, _factors, _root, _rod_angle, _factors_in_single_precision, _series,
             _rod_by_newton, _by_frame, *tables(lambda _, drive: _root_of(drive))),
)  # fmt: skip


# Six-bar

GROUND, CRANK, COUPLER, ROCKER, POINT = 99.0, 30.0, 77.0, 95.0, 128 + 15j
LINK, OUTPUT, PIVOT = 58.7, 60.0, 69 + 191j
SIX_BAR = StephensonSixBar(FourBar(GROUND, CRANK, COUPLER, ROCKER, POINT), LINK, OUTPUT, PIVOT)
# Its moving bodies, in the order of the loops' unknowns.
BODIES = ("crank", "coupler", "rocker", "link", "output")


def exact_output(angle: Decimal) -> DecimalComplex:
    """The output link's direction."""
    point = coupler_point((GROUND, CRANK, COUPLER, ROCKER), POINT, angle)
    return (pinned(point, PIVOT, LINK, OUTPUT, 1) - PIVOT).direction


@method("geomkin.move", **REASONS)
def _six_bar_by_library(track: Track) -> Complex:
    """The library's call, for any linkage: the first dyad by the toggle-proof form, the second by the general dyad
    solver.
    """
    return move(track.linkage, track.drive).output.direction


@method("general dyad solver", prepared=True)
def _general_dyads(track: Track) -> Callable[[], Complex]:
    """Both dyads by the library's solver of two bars between any moving points."""
    solve = general_solution(SIX_BAR.linkage, track.drive)
    return lambda: solve().value("direction", "output")


@method("unit vectors")
def _circles(track: Track) -> Complex:
    """Both dyads by the textbooks' vector form, in plain NumPy."""
    return by_circles(track.drive)


@method("single precision", prepared=True)
def _circles_in_single_precision(track: Track) -> Callable[[], Complex]:
    """The vector form in 32-bit numbers."""
    drive = track.drive.astype(np.float32)
    return lambda: _output(np.float32(CRANK) * (np.cos(drive) + 1j * np.sin(drive)))


def by_circles(drive: Real) -> Complex:
    """The output's direction by unit vectors, one dyad after the other."""
    return _output(CRANK * np.exp(1j * drive))


def _output(crank: Complex) -> Complex:
    diagonal = PIVOT - (crank + _first_bar(GROUND - crank, COUPLER, ROCKER) * (POINT / COUPLER))
    return np.asarray((_first_bar(diagonal, LINK, OUTPUT) - diagonal) / OUTPUT)


def _first_bar(u: Complex, b: float, c: float) -> Complex:
    """The first bar of a dyad between two points, u apart."""
    square = u.real * u.real + u.imag * u.imag
    along = 0.5 + (b - c) * (b + c) / (2 * square)
    return np.asarray((along + 1j * np.sqrt(b * b / square - along * along)) * u)


def loop_equations(angles: Real) -> tuple[Real, Real]:
    """The two loops, mm, (n, 4), and their slopes by the angles of all bodies, (n, 4, 5); angles: (n, 5), rad."""
    crank, bar, arm, link, output = np.exp(1j * angles).T * np.array([[CRANK], [COUPLER], [ROCKER], [LINK], [OUTPUT]])
    point, nothing = bar * (POINT / COUPLER), np.zeros_like(bar)
    loops = np.array([crank + bar - GROUND - arm, crank + point + link - PIVOT - output])
    slopes = 1j * np.array([[crank, bar, -arm, nothing, nothing], [crank, point, nothing, link, -output]])
    off = np.array([loops[0].real, loops[0].imag, loops[1].real, loops[1].imag])
    by = np.array([slopes[0].real, slopes[0].imag, slopes[1].real, slopes[1].imag])
    return off.T, np.moveaxis(by, -1, 0)


def first_angles(drive: Real) -> Real:
    """Known angles of all bodies at the first of the crank's drives, (5,)."""
    motion = move(SIX_BAR, drive[:1])
    return np.array([float(np.angle(motion.bodies[body].direction[0])) for body in BODIES])


def newton_all(start: Real, drive: Real, driver: int, steps: int) -> Real:
    """Angles (n, 5) by so many of Newton's steps from one start, all frames at once; `driver` is the known one."""
    angles = np.tile(start, (len(drive), 1))
    angles[:, driver] = drive
    free = [k for k in range(5) if k != driver]
    for _ in range(steps):
        off, slope = loop_equations(angles)
        angles[:, free] -= np.linalg.solve(slope[:, :, free], off[..., None])[..., 0]
    return angles


def newton_each(start: Real, drive: Real, driver: int, tolerance: float) -> Real:
    """Angles (n, 5) by `newton_raphson`, each frame from the one before."""
    free = [k for k in range(5) if k != driver]
    angles, found = start.copy(), []
    for place in drive.tolist():

        def at(x: Real, place: float = place) -> Real:
            every = np.empty((1, 5))
            every[0, free], every[0, driver] = x, place
            return every

        def off(x: Real) -> Real:
            return np.asarray(loop_equations(at(x))[0][0])

        def slope(x: Real) -> Real:
            return np.asarray(loop_equations(at(x))[1][0][:, free])

        angles[free], angles[driver] = newton_raphson(off, slope, angles[free], tolerance).value, place
        found.append(angles.copy())
    return np.array(found)


def by_newton(driver: int, first: float, body: int, steps: tuple[float, ...], slow: bool) -> tuple[Method, Method]:
    """Methods for the direction of one body from the angles of another, the start known at an angle of the crank."""

    @method("Newton, cold", "steps", steps, prepared=True)
    def cold(track: Track, steps: float) -> Callable[[], Complex]:
        """All frames at once from the pose of the first, by so many steps on four equations."""
        start = first_angles(np.array([first]))
        return lambda: np.exp(1j * newton_all(start, track.drive, driver, int(steps))[:, body])

    @method("root finder per frame", "tolerance", (1e-3, 1e-6, 1e-13), prepared=True, slow=slow)
    def warm(track: Track, tolerance: float) -> Callable[[], Complex]:
        """newton_raphson on the four equations, each frame from the one before."""
        start = first_angles(np.array([first]))
        return lambda: np.exp(1j * newton_each(start, track.drive, driver, tolerance)[:, body])

    return cold, warm


def with_estimate(driver: str, drive: Real) -> Linkage:
    """The six-bar with another driver, and its pins' positions at the first of the crank's drives."""
    motion = move(SIX_BAR, drive[:1])
    places = {pin: complex(motion.point(pin).position[0]) for pin in SIX_BAR.linkage.pins}
    return replace(SIX_BAR.linkage, driver=driver, estimate=places)


@method("the library's iteration", prepared=True, slow=True)
def _loops(track: Track) -> Callable[[], Complex]:
    """The solver for linkages that are no chain of dyads, applied to this one: the path of poses is followed, and every
    frame is found on it.
    """
    linkage = with_estimate("crank", track.drive)

    def call() -> Complex:
        # Made anew, since what was iterated once is kept. The crank's rotation and its pin come first.
        known = frozenset((linkage.ground, linkage.driver))
        loops = Loops(linkage, tuple(b for b in linkage.bodies if b not in known), known, known, True, False)
        steps = (*placements_for(linkage, 1)[:2], loops)
        solution = LinkageSolution(linkage, lambda: steps, track.drive, as_branch_spec(1), STEADY)
        return solution.value("direction", "output")

    return call


SIX_BAR_POSITION = MethodFamily(
    name="six-bar-position", title="Position of a six-bar", per="pose", unit="rad", floor=2e-15,
    problem=lambda: Track(SIX_BAR, turn(), exact(exact_output, turn())[0]), error=misses,
    about="Stephenson's six-bar of the gallery, whose output dwells: a four-bar, and a dyad on a point of its coupler. "
    f"Computed is the direction of the output link at {FRAMES} even steps of a whole turn of the crank.",
    reference="intersecting circles, one dyad after the other, in decimal arithmetic of 110 digits",
    methods=(_six_bar_by_library, _general_dyads, _circles, _circles_in_single_precision,
             *by_newton(0, 0.0, 4, (3.0, 5.0, 7.0, 10.0), True), _loops, *tables(lambda _, drive: by_circles(drive))),
)  # fmt: skip


# Six-bar driven by its output

# Angles of the crank, rad, between which the output turns in one direction, and their number.
FIRST, LAST, POSES = 0.2, 1.2, 100


def _backwards_problem() -> Track:
    """Angles of the output that belong to known ones of the crank."""
    crank = np.linspace(FIRST, LAST, POSES)
    output = np.angle(exact(exact_output, crank)[0])
    return Track(with_estimate("output", crank), output, np.exp(1j * crank))


@method(
    "geomkin.move",
    rationale="it needs one rough pose, finds the branch that the motion leads to from there, whatever the steps, and "
    "finds the limits of the motion.",
    caveat="It takes longer because of this safety: the others are given the range of the crank, and do not report a "
    "change of branch.",
)
def _followed(track: Track) -> Complex:
    """The path of poses is followed by its own length, and every frame is found on it by Newton's method."""
    # Made anew each time: the path that was followed last is kept with the plan.
    return move(with_estimate("output", np.array([FIRST])), track.drive).crank.direction


@method("dyads backwards, by halving", "steps", (10.0, 20.0, 35.0, 50.0))
def _halving(track: Track, steps: float) -> Complex:
    """The closed form from the crank, which is found in its known range by halving so many times."""
    wanted = np.exp(-1j * track.drive)
    low, high = np.full(POSES, FIRST - 0.05), np.full(POSES, LAST + 0.05)
    for _ in range(int(steps)):
        middle = 0.5 * (low + high)
        # The output's angle rises with the crank's.
        beyond = (by_circles(middle) * wanted).imag > 0
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return np.asarray(np.exp(0.5j * (low + high)))


@method("dyads backwards, by secants", "steps", (3.0, 5.0, 7.0, 10.0))
def _secants(track: Track, steps: float) -> Complex:
    """The same by the secant method, from the ends of the crank's range."""
    wanted = np.exp(-1j * track.drive)
    before, here = np.full(POSES, FIRST), np.full(POSES, LAST)
    off_before, off_here = ((by_circles(crank) * wanted).imag for crank in (before, here))
    for _ in range(int(steps)):
        with np.errstate(invalid="ignore", divide="ignore"):
            step = off_here * (here - before) / (off_here - off_before)
        # If nothing is left to improve, both are alike.
        before, here, off_before = here, here - np.nan_to_num(step, posinf=0.0, neginf=0.0), off_here
        off_here = (by_circles(here) * wanted).imag
    return np.exp(1j * here)


@method("table read backwards", "entries", ENTRIES, prepared=True)
def _backwards(track: Track, entries: float) -> Callable[[], Any]:
    """Outputs at so many even steps of the crank, prepared beforehand, with linear interpolation."""
    crank = np.linspace(FIRST - 0.05, LAST + 0.05, int(entries))
    output = np.unwrap(np.angle(by_circles(crank)))
    order = np.argsort(output)
    output, crank = output[order], crank[order]
    return lambda: np.exp(1j * np.interp(track.drive, output, crank))


ITERATION = MethodFamily(
    name="iteration", title="A linkage that no closed form places", per="pose", unit="rad", floor=1e-14,
    problem=_backwards_problem, error=misses,
    about="Stephenson's six-bar of the gallery, driven by its last link: no two of its members are connected to known "
    f"ones, so that all loops are solved at once. Computed is the direction of the crank at {POSES} positions of the "
    "output.",
    reference="the output's angles, which were computed from known ones of the crank in decimals of 110 digits",
    methods=(_followed, *by_newton(4, FIRST, 0, (2.0, 4.0, 6.0, 8.0, 12.0), False), _halving, _secants, _backwards),
)  # fmt: skip
