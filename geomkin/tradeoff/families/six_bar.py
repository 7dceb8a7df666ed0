"""Position of a six-bar: dyads in closed form against iteration of its loops."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...linkage.linkage import Linkage
from ...linkage.moving import move, placements_for
from ...linkage.named_linkages import FourBar
from ...linkage.six_bars import StephensonSixBar
from ...linkage.solve.branch import as_branch_spec
from ...linkage.solve.continuation import newton_raphson
from ...linkage.solve.input_dyads import CrankDriven
from ...linkage.solve.loops import Loops
from ...linkage.solve.solution import LinkageSolution
from ...plane.vec import Array, Complex, Real
from ..exact import (
    ENTRIES,
    FRAMES,
    DecimalVector,
    Track,
    carried,
    circling,
    count,
    cubic,
    fixed,
    linear,
    misses,
    pinned,
)
from ..family import Method, MethodFamily
from .four_bar_problem import LIBRARY, STEADY

GROUND, CRANK, COUPLER, ROCKER, POINT = 99.0, 30.0, 77.0, 95.0, 128 + 15j
LINK, OUTPUT, PIVOT = 58.7, 60.0, 69 + 191j
SIX_BAR = StephensonSixBar(FourBar(GROUND, CRANK, COUPLER, ROCKER, POINT), LINK, OUTPUT, PIVOT)
Call = Callable[[], Array]


def exact_output(angle: float) -> DecimalVector:
    """The output link's direction."""
    crank, end = circling(CRANK, angle), fixed(PIVOT.real, PIVOT.imag)
    point = carried(crank, pinned(crank, fixed(GROUND), COUPLER, ROCKER, 1), POINT)
    arm = (pinned(point, end, LINK, OUTPUT, 1) - end).at
    return arm.times(1 / arm.dot(arm).sqrt())


def _library(track: Track, _: float) -> Call:
    return lambda: move(track.linkage, track.drive).output.direction


def _general_dyads(track: Track, _: float) -> Call:
    general = SIX_BAR.linkage
    steps = tuple(one.dyad if isinstance(one, CrankDriven) else one for one in placements_for(general, 1))
    spec = as_branch_spec(1)
    return lambda: LinkageSolution(general, lambda: steps, track.drive, spec, STEADY).value("direction", "output")


def _circles(track: Track, _: float) -> Call:
    return lambda: by_circles(track.drive)


def by_circles(drive: Real) -> Complex:
    """The output's direction by unit vectors, one dyad after the other."""
    crank = CRANK * np.exp(1j * drive)
    bar = _meeting(GROUND - crank, COUPLER, ROCKER)
    point = crank + bar * (POINT / COUPLER)
    way = PIVOT - point
    found: Complex = (_meeting(way, LINK, OUTPUT) - way) / OUTPUT
    return found


def _meeting(u: Complex, b: float, c: float) -> Complex:
    """The first bar of a dyad between two points, u apart."""
    square = u.real * u.real + u.imag * u.imag
    along = 0.5 + (b - c) * (b + c) / (2 * square)
    found: Complex = (along + 1j * np.sqrt(b * b / square - along * along)) * u
    return found


def _single(track: Track, _: float) -> Call:
    drive = track.drive.astype(np.float32)
    crank, a, d, pivot = np.float32(CRANK), np.complex64(POINT / COUPLER), np.float32(GROUND), np.complex64(PIVOT)

    def call() -> Array:
        pin = crank * (np.cos(drive) + 1j * np.sin(drive))
        way = pivot - (pin + _meeting(d - pin, COUPLER, ROCKER) * a)
        return (_meeting(way, LINK, OUTPUT) - way) / np.float32(OUTPUT)

    return call


# The six-bar's members that turn, in the order of the loops' unknowns.
TURNING = ("crank", "coupler", "rocker", "link", "output")


def loop_equations(angles: Real) -> tuple[Real, Real]:
    """The two loops, mm, (n, 4), and their slopes by the angles of all that turns, (n, 4, 5); angles: (n, 5), rad."""
    crank, bar, arm, link, output = np.exp(1j * angles).T * np.array([[CRANK], [COUPLER], [ROCKER], [LINK], [OUTPUT]])
    point, nothing = bar * (POINT / COUPLER), np.zeros_like(bar)
    loops = np.array([crank + bar - GROUND - arm, crank + point + link - PIVOT - output])
    slopes = 1j * np.array([[crank, bar, -arm, nothing, nothing], [crank, point, nothing, link, -output]])
    off = np.array([loops[0].real, loops[0].imag, loops[1].real, loops[1].imag])
    by = np.array([slopes[0].real, slopes[0].imag, slopes[1].real, slopes[1].imag])
    return off.T, np.moveaxis(by, -1, 0)


def first_angles(drive: Real) -> Real:
    """Angles of all that turns when the crank stands at the first of its drives, as somebody knows them, (5,)."""
    motion = move(SIX_BAR, drive[:1])
    return np.array([float(np.angle(motion.bodies[body].direction[0])) for body in TURNING])


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
            value: Real = loop_equations(at(x))[0][0]
            return value

        def slope(x: Real) -> Real:
            value: Real = loop_equations(at(x))[1][0][:, free]
            return value

        angles[free], angles[driver] = newton_raphson(off, slope, angles[free], tolerance).value, place
        found.append(angles.copy())
    return np.array(found)


def _newton_cold(track: Track, steps: float) -> Call:
    start = first_angles(track.drive)
    return lambda: np.exp(1j * newton_all(start, track.drive, 0, int(steps))[:, 4])


def _newton_warm(track: Track, tolerance: float) -> Call:
    start = first_angles(track.drive)
    return lambda: np.exp(1j * newton_each(start, track.drive, 0, tolerance)[:, 4])


def _loops(track: Track, _: float) -> Call:
    estimated = with_estimate("crank", track.drive)
    return lambda: _iterated(estimated, track.drive).value("direction", "output")


def with_estimate(driver: str, drive: Real) -> Linkage:
    """The six-bar with another driver, and where its pins are at the first of the crank's drives."""
    motion = move(SIX_BAR, drive[:1])
    places = {pin: complex(motion.point(pin).position[0]) for pin in SIX_BAR.linkage.pins}
    return replace(SIX_BAR.linkage, driver=driver, estimate=places)


def _iterated(linkage: Linkage, drive: Real) -> LinkageSolution:
    """The linkage with all but its crank left to iteration, made anew, since what was iterated once is kept."""
    # The crank's turn and its pin come first.
    crank = placements_for(linkage, 1)[:2]
    known = frozenset((linkage.ground, linkage.driver))
    waiting = tuple(body for body in linkage.bodies if body not in known)
    steps = (*crank, Loops(linkage, waiting, known, known, True, False))
    return LinkageSolution(linkage, lambda: steps, drive, as_branch_spec(1), STEADY)


SIX_BAR_POSITION: MethodFamily[Track, Array] = MethodFamily(
    name="six-bar-position",
    title="Position of a six-bar",
    about="Stephenson's six-bar of the gallery, whose output dwells: a four-bar, and a dyad on a point of its coupler. "
    f"Found is the direction of the output link at {FRAMES} even steps of a whole turn of the crank.",
    per="pose",
    unit="rad",
    reference="circles that meet, one dyad after the other, in decimal arithmetic of 110 digits",
    floor=2e-15,
    problem=lambda: Track.of(SIX_BAR, exact_output),
    count=count,
    error=misses,
    methods=(
        Method(
            "geomkin.move",
            "The library's call, for any linkage: the first dyad by the toggle-proof form, the second by the general "
            "dyad solver.",
            _library,
            rationale=LIBRARY.rationale,
            caveat=LIBRARY.caveat,
        ),
        Method(
            "general dyad solver",
            "Both dyads by the library's solver of two bars between any moving points.",
            _general_dyads,
        ),
        Method("unit vectors", "Both dyads by the textbooks' vector form, in plain NumPy.", _circles),
        Method("single precision", "The vector form in 32-bit numbers.", _single),
        Method(
            "Newton, cold",
            "All frames at once from the pose of the first, by so many steps on four equations.",
            _newton_cold,
            "steps",
            (3.0, 5.0, 7.0, 10.0),
        ),
        Method(
            "root finder per frame",
            "newton_raphson on the four equations, each frame from the one before.",
            _newton_warm,
            "tolerance",
            (1e-3, 1e-6, 1e-13),
            slow=True,
        ),
        Method(
            "the library's iteration",
            "What solves linkages that are no chain of dyads, made to solve this one: "
            "the path of poses is followed, and every frame is found on it.",
            _loops,
            slow=True,
        ),
        Method(
            "linear table",
            "Directions at so many even steps, got ready beforehand, and straight lines between.",
            lambda track, entries: linear(track.drive, by_circles, entries),
            "entries",
            ENTRIES,
        ),
        Method(
            "cubic table",
            "The same table with a cubic through the four nearest entries.",
            lambda track, entries: cubic(track.drive, by_circles, entries),
            "entries",
            ENTRIES,
        ),
    ),
)
