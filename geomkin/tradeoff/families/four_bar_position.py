"""Position of a four-bar by iteration, and from tables."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin

import numpy as np

from ...linkage.named_linkages import FourBar
from ...linkage.solve.continuation import newton_raphson
from ...plane.vec import Array, Real
from ..exact import ENTRIES, cubic, linear
from ..family import Method, MethodFamily
from .four_bar_problem import CLOSED_FORMS, FRAMES, NEAR_TOGGLE, ORDINARY, Directions, FourBarProblem, by_unit_vectors

Call = Callable[[], Directions]


def _newton_cold(problem: FourBarProblem, steps: float) -> Call:
    a, b, c, d = problem.lengths
    start = [float(np.angle(z[FRAMES // 4])) for z in problem.directions]

    def call() -> Directions:
        px, py = d - a * np.cos(problem.drive), -a * np.sin(problem.drive)
        coupler, rocker = np.full(FRAMES, start[0]), np.full(FRAMES, start[1])
        with np.errstate(all="ignore"):
            for _ in range(int(steps)):
                bx, by = b * np.cos(coupler), b * np.sin(coupler)
                cx, cy = c * np.cos(rocker), c * np.sin(rocker)
                off_x, off_y, share = bx - cx - px, by - cy - py, 1 / (by * cx - bx * cy)
                coupler, rocker = (
                    coupler + (off_x * cx + off_y * cy) * share,
                    rocker + (off_x * bx + off_y * by) * share,
                )
        return np.exp(1j * coupler), np.exp(1j * rocker)

    return call


def _newton_warm(problem: FourBarProblem, tolerance: float) -> Call:
    a, b, c, d = problem.lengths
    start = [float(np.angle(z[0])) for z in problem.directions]
    angles = problem.drive.tolist()

    def call() -> Directions:
        coupler, rocker = start
        found = []
        for t in angles:
            ux, uy = d - a * cos(t), -a * sin(t)
            for _ in range(30):
                bx, by, cx, cy = b * cos(coupler), b * sin(coupler), c * cos(rocker), c * sin(rocker)
                off_x, off_y, share = bx - cx - ux, by - cy - uy, (by * cx - bx * cy) or 1e-300
                one, two = (off_x * cx + off_y * cy) / share, (off_x * bx + off_y * by) / share
                coupler, rocker = coupler + one, rocker + two
                if abs(one) + abs(two) < tolerance:
                    break
            found.append((coupler, rocker))
        turned = np.exp(1j * np.array(found))
        return turned[:, 0], turned[:, 1]

    return call


def _root_finder(problem: FourBarProblem, tolerance: float) -> Call:
    a, b, c, d = problem.lengths
    start = np.array([float(np.angle(z[0])) for z in problem.directions])

    def call() -> Directions:
        angles, found = start, []
        for u in (d - a * np.exp(1j * problem.drive)).tolist():

            def off(x: Real, u: complex = u) -> Real:
                z = b * np.exp(1j * x[0]) - c * np.exp(1j * x[1]) - u
                return np.array([z.real, z.imag])

            def slope(x: Real) -> Real:
                z = 1j * b * np.exp(1j * x[0]), -1j * c * np.exp(1j * x[1])
                return np.array([[z[0].real, z[1].real], [z[0].imag, z[1].imag]])

            angles = newton_raphson(off, slope, angles, tolerance).value
            found.append(angles)
        turned = np.exp(1j * np.array(found))
        return turned[:, 0], turned[:, 1]

    return call


def _linear_table(problem: FourBarProblem, entries: float) -> Call:
    return _pair(linear(problem.drive, _directions(problem), entries))


def _cubic_table(problem: FourBarProblem, entries: float) -> Call:
    return _pair(cubic(problem.drive, _directions(problem), entries))


def _directions(problem: FourBarProblem) -> Callable[[Real], Array]:
    return lambda drive: np.nan_to_num(np.array(by_unit_vectors(*problem.lengths, drive)))


def _pair(call: Callable[[], Array]) -> Call:
    def both() -> Directions:
        coupler, rocker = call()
        return coupler, rocker

    return both


ITERATIONS: tuple[Method[FourBarProblem, Directions], ...] = (
    Method(
        "Newton, cold",
        "All frames at once from the pose at a quarter turn, by so many steps on the loop's two equations.",
        _newton_cold,
        "steps",
        (2, 3, 4, 5, 6, 8),
    ),
    Method(
        "Newton, warm",
        "Frame by frame in plain Python, each from the frame before, until both angles change by less than the "
        "tolerance.",
        _newton_warm,
        "tolerance, rad",
        (1e-2, 1e-5, 1e-9),
    ),
    Method(
        "root finder per frame",
        "The library's newton_raphson called for each frame, from the frame before.",
        _root_finder,
        "tolerance",
        (1e-3, 1e-13),
    ),
)
TABLES: tuple[Method[FourBarProblem, Directions], ...] = (
    Method(
        "linear table",
        "Directions at so many even steps of the crank, got ready beforehand, and straight lines between.",
        _linear_table,
        "entries",
        ENTRIES,
    ),
    Method(
        "cubic table",
        "The same table with a cubic through the four nearest entries.",
        _cubic_table,
        "entries",
        ENTRIES,
    ),
)


def _error(problem: FourBarProblem, found: Directions) -> Real:
    one, two = (np.abs(z - right) for z, right in zip(found, problem.directions))
    return np.maximum(one, two)


def _family(name: str, title: str, about: str, linkage: FourBar) -> MethodFamily[FourBarProblem, Directions]:
    return MethodFamily(
        name=name,
        title=title,
        about=f"{about} Found are the directions of coupler and rocker at {FRAMES} even steps of a whole turn of the "
        "crank; the error is that of the worse of the two.",
        per="pose",
        unit="rad",
        reference="circles that meet, in decimal arithmetic of 110 digits",
        floor=1e-15,
        problem=lambda: FourBarProblem.of(linkage),
        count=lambda _, found: len(found[0]),
        error=_error,
        methods=(*CLOSED_FORMS, *ITERATIONS, *TABLES),
    )


POSITION = _family(
    "four-bar-position",
    "Position of a four-bar",
    "A crank-rocker of 30, 90, 70 and 100 mm, which stays away from its toggles.",
    ORDINARY,
)
TOGGLE = _family(
    "four-bar-toggle",
    "Position of a four-bar near its toggle",
    "A four-bar of 30, 60, 70 and 100 mm, whose rocker is longer than that by a hundred-millionth of a mm: once a turn "
    "all its links lie nearly on one line.",
    NEAR_TOGGLE,
)
