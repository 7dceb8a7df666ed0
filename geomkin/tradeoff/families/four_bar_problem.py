"""The four-bar that methods are tried on, with its right motion."""

from __future__ import annotations

from collections.abc import Callable
from math import fsum

import numpy as np

from ...core.records import record
from ...linkage.moving import move, placements_for
from ...linkage.named_linkages import FourBar
from ...linkage.solve.branch import as_branch_spec
from ...linkage.solve.input_dyads import CrankDriven
from ...linkage.solve.solution import LinkageSolution
from ...linkage.timing import Timing
from ...plane.vec import Complex, Real
from ..exact import circling, fixed, many_digits, pinned
from ..family import Method

Directions = tuple[Complex, Complex]
FRAMES = 360
ORDINARY, NEAR_TOGGLE = FourBar(100, 30, 90, 70), FourBar(100, 30, 60, 70 + 1e-8)


@record(eq=False)
class FourBarProblem:
    """A four-bar and its crank's angles, rad, with the right directions of coupler and rocker, unit complex, (frames,).

    first, second: the right derivatives of the two's angles by the crank's, (2, frames).
    """

    linkage: FourBar
    drive: Real
    directions: Directions
    first: Real
    second: Real

    @property
    def lengths(self) -> tuple[float, float, float, float]:
        """Crank, coupler, rocker, ground."""
        one = self.linkage
        return float(one.crank), float(one.coupler), float(one.rocker), float(one.ground)

    @classmethod
    def of(cls, linkage: FourBar) -> FourBarProblem:
        """Its directions and their derivatives by decimal arithmetic."""
        drive = np.arange(FRAMES) * (2 * np.pi / FRAMES)
        places, rates = np.empty((2, FRAMES), dtype=complex), np.empty((2, 2, FRAMES))
        with many_digits():
            pivot = fixed(float(linkage.ground))
            for k, angle in enumerate(drive.tolist()):
                crank = circling(float(linkage.crank), angle)
                pin = pinned(crank, pivot, float(linkage.coupler), float(linkage.rocker), 1)
                for j, arm in enumerate((pin - crank, pin - pivot)):
                    length = arm.at.dot(arm.at).sqrt()
                    places[j, k] = complex(arm.at.x / length, arm.at.y / length)
                    rates[:, j, k] = [float(rate) for rate in arm.turning]
        return cls(linkage, drive, (places[0], places[1]), rates[0], rates[1])


Call = Callable[[], Directions]


def _library(problem: FourBarProblem, _: float) -> Call:
    def call() -> Directions:
        motion = move(problem.linkage, problem.drive)
        return motion.coupler.direction, motion.rocker.direction

    return call


def _toggle_proof(problem: FourBarProblem, _: float) -> Call:
    lengths = problem.lengths
    return lambda: by_toggle_proof_form(lengths, problem.drive)


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


def _general_dyad(problem: FourBarProblem, _: float) -> Call:
    general = problem.linkage.linkage
    steps = tuple(
        placement.dyad if isinstance(placement, CrankDriven) else placement for placement in placements_for(general, 1)
    )

    def call() -> Directions:
        solution = LinkageSolution(general, lambda: steps, problem.drive, as_branch_spec(1), STEADY)
        return solution.value("direction", "coupler"), solution.value("direction", "rocker")

    return call


def _unit_vectors(problem: FourBarProblem, _: float) -> Call:
    a, b, c, d = problem.lengths
    return lambda: by_unit_vectors(a, b, c, d, problem.drive)


def by_unit_vectors(a: float, b: float, c: float, d: float, drive: Real) -> Directions:
    """The diagonal's unit vector, with what of the coupler lies along and beside it."""
    u = d - a * np.exp(1j * drive)
    length = np.abs(u)
    along = (length * length + (b * b - c * c)) / (2 * length)
    with np.errstate(invalid="ignore"):
        beside = np.sqrt(b * b - along * along)
    bar = (along + 1j * beside) * (u / length)
    return bar / b, (bar - u) / c


def _half_angles(problem: FourBarProblem, _: float) -> Call:
    a, b, c, d = problem.lengths
    k1, k2, k3 = d / a, d / c, (a * a - b * b + c * c + d * d) / (2 * a * c)
    k4, k5 = d / b, (c * c - d * d - a * a - b * b) / (2 * a * b)

    def call() -> Directions:
        cosine, sine = np.cos(problem.drive), np.sin(problem.drive)
        shared = -2 * sine
        rocker = _half_angle(cosine - k1 - k2 * cosine + k3, shared, k1 - (k2 + 1) * cosine + k3, -1)
        coupler = _half_angle(cosine - k1 + k4 * cosine + k5, shared, k1 + (k4 - 1) * cosine + k5, -1)
        return np.exp(1j * coupler), np.exp(1j * rocker)

    return call


def _half_angle(first: Real, middle: Real, last: Real, sign: int) -> Real:
    with np.errstate(invalid="ignore"):
        root = np.sqrt(middle * middle - 4 * first * last)
    angle: Real = 2 * np.arctan2(-middle + sign * root, 2 * first)
    return angle


def _diagonal(problem: FourBarProblem, _: float) -> Call:
    a, b, c, d = problem.lengths

    def call() -> Directions:
        px, py = a * np.cos(problem.drive), a * np.sin(problem.drive)
        square = (d - px) ** 2 + py * py
        length, lean = np.sqrt(square), np.arctan2(-py, d - px)
        with np.errstate(invalid="ignore"):
            coupler = lean + np.arccos((b * b + square - c * c) / (2 * b * length))
            rocker = lean + np.pi - np.arccos((c * c + square - b * b) / (2 * c * length))
        return np.exp(1j * coupler), np.exp(1j * rocker)

    return call


def _single(problem: FourBarProblem, _: float) -> Call:
    a, b, c, d = (np.float32(v) for v in problem.lengths)
    drive = problem.drive.astype(np.float32)

    def call() -> Directions:
        ux, uy = d - a * np.cos(drive), -a * np.sin(drive)
        square = ux * ux + uy * uy
        along = (square + (b - c) * (b + c)) / (2 * square)
        with np.errstate(invalid="ignore"):
            beside = np.sqrt(b * b / square - along * along)
        bx, by = along * ux - beside * uy, along * uy + beside * ux
        return (bx + 1j * by) / b, (bx - ux + 1j * (by - uy)) / c

    return call


# The driver turns at 1 rad/s: rates are derivatives by its angle.
STEADY = Timing(np.asarray(1.0), np.asarray(0.0))
LIBRARY: Method[FourBarProblem, Directions] = Method(
    "geomkin.move",
    "The library's call, for any linkage: it finds in which order members are placed, and works out a four-bar's by "
    "the toggle-proof form.",
    _library,
    rationale="one call serves any linkage, driver and branch, and keeps all digits up to a toggle and through it.",
    caveat="The overhead of the general call is constant. It is the same for one pose as for "
    f"these {FRAMES}, so it matters less with more poses per call.",
)
CLOSED_FORMS: tuple[Method[FourBarProblem, Directions], ...] = (
    LIBRARY,
    Method(
        "toggle-proof form, plain NumPy",
        "Every quantity that vanishes at a toggle is a product of factors, and the constants among them are exact "
        "(derived for geomkin).",
        _toggle_proof,
    ),
    Method(
        "general dyad solver",
        "The library's solver of two bars between any two moving points: Heron's formula in Kahan's factors.",
        _general_dyad,
    ),
    Method(
        "unit vectors",
        "The textbooks' vector form: so far along the diagonal's unit vector, and so far beside it.",
        _unit_vectors,
    ),
    Method(
        "half-angle (Freudenstein)",
        "Freudenstein's equation as a quadratic in the tangent of half the angle (Norton, Design of Machinery, "
        "chapter 4).",
        _half_angles,
    ),
    Method(
        "diagonal and cosine rule",
        "Two triangles on the _diagonal, their angles by the cosine rule.",
        _diagonal,
    ),
    Method(
        "single precision",
        "The vector form in 32-bit numbers, from angles and sizes that were made such beforehand.",
        _single,
    ),
)
