"""Measures of a linkage: Grashof's inequality, circuits, transmission angle, straight paths, support polygon."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import combinations, permutations
from typing import Literal, NamedTuple

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from ..core.units import Sentence, mm, to_digits
from ..model.motor import RotatingBody
from ..plane.primitives import convex_hull
from ..plane.vec import Complex, Real, Whole, cross, dot, unit
from .drive_limits import largest_between, moved_to
from .linkage import AbstractLinkage
from .motion import Motion, unwrapped_deg
from .named_linkages import FourBar, SliderCrank


class Grashof(NamedTuple):
    """Grashof's inequality of a four-bar: the shortest link can turn fully if `spare` is not negative.

    Parameters
    ----------
    type : str
        As returned by `grashof_type`.
    shortest, longest : str
        Names of these links.
    shortest_and_longest, other_two : float
        Sums of lengths, mm.
    """

    type: str
    shortest: str
    longest: str
    shortest_and_longest: float
    other_two: float

    @property
    def spare(self) -> float:
        """Sum of the other two links less that of shortest and longest, mm."""
        return self.other_two - self.shortest_and_longest


@checked
def grashof(linkage: FourBar) -> Grashof:
    """Grashof's inequality with its numbers: shortest + longest against the sum of the other two links.

    Parameters
    ----------
    linkage : FourBar
        One four-bar; its lengths are numbers, not arrays.

    Returns
    -------
    Grashof

    Notes
    -----
    Grashof, 1883.

    Examples
    --------
    >>> import geomkin as gk
    >>> result = gk.linkage.grashof(gk.FourBar(ground=100, crank=30, coupler=90, rocker=70))
    >>> result.type, result.spare
    ('crank-rocker', 30.0)
    """
    lengths = {kind: float(getattr(linkage, kind)) for kind in ("ground", "crank", "coupler", "rocker")}
    shortest, *others, longest = sorted(lengths, key=lengths.__getitem__)
    sums = lengths[shortest] + lengths[longest], lengths[others[0]] + lengths[others[1]]
    spare = sums[1] - sums[0]
    types = {"crank": "crank-rocker", "ground": "double-crank", "rocker": "rocker-crank", "coupler": "double-rocker"}
    kind = types[shortest] if spare > 0 else "triple-rocker"
    if abs(spare) <= 1e-12 * lengths[longest]:
        kind = "change-point"
    return Grashof(kind, shortest, longest, *sums)


@checked
def grashof_type(linkage: FourBar) -> str:
    """Type of a four-bar by Grashof's inequality.

    Parameters
    ----------
    linkage : FourBar
        One four-bar.

    Returns
    -------
    str
        "crank-rocker", "double-crank", "rocker-crank", "double-rocker" (the coupler turns fully), "change-point" (the
        sums are equal, to rounding) or "triple-rocker" (no link turns fully).

    Notes
    -----
    Grashof, 1883.
    """
    return grashof(linkage).type


@checked
def circuits(linkage: FourBar | SliderCrank, motion: Motion) -> Whole:
    """Circuit of each frame; poses of one circuit are reached from each other without taking the linkage apart.

    Parameters
    ----------
    linkage : FourBar or SliderCrank
        The linkage.
    motion : Motion
        A motion of this linkage.

    Returns
    -------
    array of int, shape of the motion
        +1 or -1; 0 where open; +1 throughout if there is only one circuit. For a Grashof four-bar it is the sign of the
        angle at a joint not adjacent to the shortest link. For a slider-crank it is the side of the slider if the crank
        turns fully, and the side of the crank if the connecting rod does.

    Raises
    ------
    DesignError
        If the motion is of another linkage.

    Notes
    -----
    Chase and Mirth, Circuits and branches of single-degree-of-freedom planar linkages, Journal of
    Mechanical Design 115, 1993.
    """
    if not _is_of(motion, linkage):
        raise DesignError("motion", "it is of another linkage", "give a motion of this linkage", "conflict")
    if isinstance(linkage, FourBar):
        inequality = grashof(linkage)
        # Shortest link -> a joint that is not adjacent to it.
        joints = {"crank": "rocker_pin", "ground": "rocker_pin", "coupler": "crank_pivot", "rocker": "crank_pin"}
        if inequality.spare <= 0:
            sign = np.ones(motion.assembled.shape)
        else:
            crank, coupler, rocker = (motion.bodies[n].direction for n in ("crank", "coupler", "rocker"))
            ground = motion.bodies["ground"].direction
            pairs = {"rocker_pin": (coupler, rocker), "crank_pivot": (ground, crank), "crank_pin": (crank, coupler)}
            one, two = pairs[joints[inequality.shortest]]
            sign = np.sign(np.imag(np.conj(one) * two))
    elif linkage.crank + np.abs(linkage.offset) < linkage.coupler:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["coupler"].direction))
    elif linkage.coupler + np.abs(linkage.offset) < linkage.crank:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["crank"].direction))
    else:
        sign = np.ones(motion.assembled.shape)
    return np.where(motion.assembled, sign, 0).astype(int)


def _is_of(motion: Motion, linkage: FourBar | SliderCrank) -> bool:
    """Whether a motion is of a linkage with these sizes, at any position and with any driver."""
    moved, given, pins = motion.linkage.bodies, linkage.linkage.bodies, linkage.linkage.pins
    return motion.linkage.pins == pins and all(
        np.array_equal(moved[body][pin], given[body][pin]) for pin, bodies in pins.items() for body in bodies
    )


@checked
def least_transmission_angle(motion: Motion) -> Real:
    """Smallest transmission angle over the frames that are reached; `linkage_checks` also has that between frames.

    Parameters
    ----------
    motion : Motion
        Motion of one or many linkages.

    Returns
    -------
    array, shape () or (linkages,)
        rad; nan if no frame has a transmission angle.

    See Also
    --------
    move, driver_limits, crank_rocker

    Examples
    --------
    >>> import numpy as np
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 361))
    >>> float(np.degrees(gk.least_transmission_angle(motion)).round(1))
    50.0
    """
    least: Real = np.fmin.reduce(np.where(motion.assembled, motion.transmission_angle, np.nan), axis=0)
    return least


# deg. A smaller transmission angle is 0: next to a limit of the driver it changes by the root of a rounding error.
NO_ANGLE_DEG = 1e-5


def transmission_extreme(motion: Motion, sign: Literal[1, -1]) -> tuple[float, float]:
    """Largest (1) or least (-1) transmission angle, deg, also between frames, and the drive there; nan if unknown."""
    (value,), (drive,) = _transmission_extremes(motion, sign)
    return value, drive


def _transmission_extremes(motion: Motion, *signs: Literal[1, -1]) -> tuple[list[float], list[float]]:
    """Largest (1) and least (-1) transmission angles, deg, and the drives there."""
    ways = np.array(signs)

    def both_ways(moved: Motion) -> Real:
        return ways[:, None] * np.degrees(np.where(moved.assembled, moved.transmission_angle, np.nan))

    values, drives = largest_between(motion, both_ways, to_limits=True)
    return np.where(np.abs(values) < NO_ANGLE_DEG, 0.0, ways * values).tolist(), drives.tolist()


# deg. A body that moves through less is at rest, and one that moves through more may turn fully: its ends between
# frames are not known.
AT_REST_DEG, ALL_ROUND_DEG = 1e-6, 350.0
# Share of its distance by which a slide that moves less is at rest.
AT_REST = 1e-9
# rad by which a whole turn of the driver may differ from one.
WHOLE_TURN = 1e-9


class Travel(NamedTuple):
    """How far something moves there and back: least and largest direction, deg from +x, or place along a slide, mm.

    time_ratio: time of the slower of both strokes over that of the other while the driver turns fully at a constant
    speed; nan if it does not turn fully, or the follower turns back more often.
    """

    least: float
    largest: float
    time_ratio: float

    @property
    def between(self) -> float:
        """The swing or stroke."""
        return self.largest - self.least

    @property
    def ratio_text(self) -> str:
        """The time ratio behind a sentence, if it is known."""
        return f"; time ratio {self.time_ratio:.4g}" if np.isfinite(self.time_ratio) else ""

    def entry(self, between: str) -> dict[str, float]:
        """Its entry of a summary; between: name of the swing or stroke."""
        ends = {"from": to_digits(self.least, 10), "to": to_digits(self.largest, 10)}
        ratio = {"time_ratio": to_digits(self.time_ratio, 4)} if np.isfinite(self.time_ratio) else {}
        return {**ends, between: to_digits(self.between, 10), **ratio}


def swings(motion: Motion) -> dict[str, Travel]:
    """Directions, deg from +x, between which each body on a fixed pin swings, also between frames.

    Of the driver, of a body that turns fully, and of a linkage that does not close everywhere there is none.
    """
    linkage = motion.linkage
    fixed = linkage.bodies[linkage.ground].keys() & linkage.pins.keys()
    angles = {
        name: unwrapped_deg(motion.bodies[name].direction)
        for name, points in linkage.bodies.items()
        if name not in (linkage.ground, linkage.driver) and points.keys() & fixed
    }
    swung = {name: row for name, row in angles.items() if AT_REST_DEG < np.ptp(row) < ALL_ROUND_DEG}

    def turned_from(moved: Motion, name: str, middle: float) -> Real:
        turned: Real = np.angle(moved.bodies[name].direction * np.exp(-1j * np.radians(middle)), deg=True)
        return turned

    return _ends(motion, swung, turned_from)


def strokes(motion: Motion) -> dict[str, Travel]:
    """Places, mm, between which each slide on the ground moves, besides that of the driver, also between frames."""
    linkage = motion.linkage
    slides = [s for s in linkage.sliders if s.along == linkage.ground and s.body != linkage.driver]
    places = {slide.name: motion.slide(slide.name).displacement for slide in slides}
    moving = {name: row for name, row in places.items() if np.ptp(row) > AT_REST * np.abs(row).max()}
    return _ends(motion, moving, lambda moved, name, middle: moved.slide(name).displacement - middle)


def _ends(
    motion: Motion, rows: Mapping[str, Real], moved_by: Callable[[Motion, str, float], Real]
) -> dict[str, Travel]:
    """The ends of quantities with these values at the frames; moved_by: their differences from a middle."""
    if not rows or not motion.assembled.all():
        return {}
    middles = {name: float(row.min() + row.max()) / 2 for name, row in rows.items()}

    def both_ways(moved: Motion) -> Real:
        apart = [moved_by(moved, name, middle) for name, middle in middles.items()]
        return np.concatenate([np.negative(apart), apart])

    (below, above), (low, high) = (both.reshape(2, -1) for both in largest_between(motion, both_ways))
    turn = abs(motion.drive[-1] - motion.drive[0])
    is_whole = motion.linkage.driven_slider is None and abs(turn - 2 * np.pi) < WHOLE_TURN
    reversals = [np.count_nonzero(np.diff(np.sign(np.diff(row, append=row[1])))) for row in rows.values()]
    share = np.where(is_whole & (np.array(reversals) == 2), np.abs(high - low) / (2 * np.pi), np.nan)
    ratios = np.maximum(share, 1 - share) / np.minimum(share, 1 - share)
    return {
        name: Travel(middle - float(b), middle + float(a), float(ratio))
        for (name, middle), b, a, ratio in zip(middles.items(), below, above, ratios)
    }


# Largest number of bodies whose lengths are listed.
MOST_LISTED = 12


def motion_quantities(linkage: AbstractLinkage, motion: Motion) -> dict[str, str]:
    """Grashof type, distances between the pins of each body, mm, and range of the transmission angle, by label."""
    general = motion.linkage
    listed = {"Grashof type": grashof_type(linkage)} if isinstance(linkage, FourBar) else {}
    for body, points in list(general.bodies.items())[:MOST_LISTED]:
        pins = [complex(z) for name, z in points.items() if name in general.pins]
        pairs = zip(pins, [*pins[1:], pins[0]]) if len(pins) > 2 else [tuple(pins)] * (len(pins) == 2)
        if lengths := [abs(b - a) for a, b in pairs]:
            listed[body.replace("_", " ")] = Sentence(f"{mm(*lengths):.5g}")
    (least, largest), _ = _transmission_extremes(motion, -1, 1)
    if np.isfinite(least):
        listed["transmission angle"] = f"{least:.4g} to {largest:.4g} deg"
    return listed


# Difference of directions, as unit numbers, below which two bodies turn alike.
ALIKE = 1e-9


def steady_bodies(motion: Motion) -> dict[str, RotatingBody]:
    """The driver of a linkage, which turns on the ground, and the bodies on fixed pins that turn as it does.

    The motion covers one turn of the driver without gaps. A linkage has no other ratio than 1 over the whole turn,
    apart from that of a body at rest.
    """
    linkage = motion.linkage
    driver = motion.bodies[linkage.driver].direction
    names = [linkage.driver, *(name for name in linkage.bodies if name not in (linkage.driver, linkage.ground))]
    bodies = {}
    for name in names:
        pin = next((pin for pin in linkage.bodies[name] if pin in linkage.bodies[linkage.ground]), None)
        angle = motion.bodies[name].direction * np.conj(driver)
        if pin is not None and np.abs(angle - angle[0]).max() <= ALIKE:
            bodies[name] = RotatingBody(complex(motion.point(pin).position[0]), Fraction(1))
    return bodies


# Drives at which a path is first looked at; a wave of it that is narrower than two of their steps is missed.
PLACES = 241
# Times that drives are added at which the path is farthest from the line or its speed is extreme. Each squares the
# distance to them.
ADDED = 3
# Distance between both ends of a path, as a share of the length of its line, that counts as rounding.
ENDS_MEET = 1e-12


@record
class StraightPart:
    """The straight line that is nearest to a part of the path of a point, as returned by `straight_part`.

    Parameters
    ----------
    start, end : complex
        Ends of the part, projected onto the line, mm.
    deviation : float
        Largest distance of the path from the line, mm; no line has a smaller one. The path lies in a strip of twice
        this width. nan if the linkage is open in the part.
    speed_variation : float
        Largest less least speed along the line, as a share of the mean, at a constant speed of the driver; above 1 if
        the point turns back, inf if it ends where it began.
    """

    start: complex
    end: complex
    deviation: float
    speed_variation: float

    @property
    def length(self) -> float:
        """Length of the line, mm."""
        return abs(self.end - self.start)

    @property
    def direction(self) -> complex:
        """Direction of the line, a unit complex number."""
        return complex(unit(self.end - self.start))


@checked
def straight_part(motion: Motion, point: str, start: float, end: float) -> StraightPart:
    """The best straight line for a part of the path of a point, also between the frames of a motion.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    point : str
        Name of the point.
    start, end : float
        Drives between which the path counts, rad, or mm if a slide drives.

    Returns
    -------
    StraightPart

    Raises
    ------
    DesignError
        If the linkage has no such point, the motion is of many linkages or has no frames, or start and end are equal.

    Notes
    -----
    Derived here: the narrowest strip around points has a side on an edge of their convex hull (Houle and Toussaint,
    Computing the width of a set, IEEE PAMI 10, 1988). Points are added where the path is parallel to the line.

    Examples
    --------
    Hoecken's linkage, whose coupler point leaves its line by 0.012 % of the length:

    >>> import numpy as np
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(50, 20, 65, 65, coupler_point=130), np.linspace(0, 2 * np.pi, 91))
    >>> part = gk.linkage.straight_part(motion, "coupler_point", np.radians(110), np.radians(250))
    >>> f"{part.length:.2f} {part.deviation:.4f} {part.speed_variation:.3f}"
    '72.45 0.0084 0.204'
    """
    if motion.linkage.is_batch or not len(motion.drive) or start == end:
        raise DesignError(
            "motion", "found many linkages, no frames, or a part without length", "give one linkage and two drives"
        )
    sense = -1 if motion.drive[-1] < motion.drive[0] else 1

    def at(drives: Real) -> tuple[Real, Complex, Complex, Complex]:
        path = moved_to(motion, drives).point(point)
        return drives, path.position[1:], path.first[1:], path.second[1:]

    low, high = sorted((start, end), key=lambda drive: sense * drive)
    drives, z, first, second = at(np.linspace(low, high, PLACES))
    if not np.isfinite(z).all():
        return StraightPart(complex(np.nan), complex(np.nan), np.nan, np.nan)
    for _ in range(ADDED):
        direction = _best_line(z)[0]
        across, along, change = dot(first, 1j * direction), dot(first, direction), dot(second, direction)
        zeros = (_zeros(drives, rate) for rate in (across, along, change))
        drives, z, first, second = at(sense * np.unique(sense * np.concatenate([drives, *zeros])))
    direction, through, deviation = _best_line(z)
    along = dot(z - through, direction)
    if along[-1] < along[0]:
        direction, along = -direction, -along
    speed, passed = dot(first, direction) * abs(high - low), float(along[-1] - along[0])
    variation = np.inf if passed <= ENDS_MEET * np.ptp(along) else float(np.ptp(speed) / passed)
    start_point, end_point = (through + direction * float(end) for end in (along.min(), along.max()))
    return StraightPart(start_point, end_point, deviation, variation)


def _best_line(z: Complex) -> tuple[complex, complex, float]:
    """Direction of the line with the least largest distance from points, a point of it, and that distance."""
    hull = np.array(convex_hull(z))
    edges = unit(np.roll(hull, -1) - hull) if len(hull) > 1 else np.ones(1, dtype=complex)
    widths = dot(hull[None] - hull[:, None], 1j * edges[:, None]).max(axis=1)
    best = int(np.argmin(widths))
    return complex(edges[best]), complex(hull[best] + 0.5j * widths[best] * edges[best]), float(widths[best] / 2)


def _zeros(t: Real, values: Real) -> Real:
    """Zeros between neighbouring arguments of opposite sign, by the chord."""
    at = np.flatnonzero(values[1:] * values[:-1] < 0)
    zeros: Real = t[at] + (t[at + 1] - t[at]) * values[at] / (values[at] - values[at + 1])
    return zeros


# Relative differences below which feet are in line or in one plane.
ROUNDING = 1e-9
# Gap below a foot, as a share of the size of the walker, up to which it stands, and share of the weight and of the
# largest speed that count as rounding.
STANDING, WEIGHTLESS = 1e-7, 1e-9


def support_margin(feet: Complex, centre: complex | Complex) -> Real:
    """Distance of the centre of weight inside the support polygon, mm, shape (frames,); negative if it falls over.

    The polygon is the convex hull of the feet as seen from above. feet: shape (feet, frames); both in mm, x along the
    path and y across it.
    """
    # The hull's support function, less that of the centre, is least at right angles to an edge of the hull.
    margins = np.full(feet.shape[1], np.inf)
    for one, two in permutations(feet, 2):
        length = np.abs(two - one)
        normal = np.where(length > 0, -1j * (two - one) / np.where(length > 0, length, 1), 1.0)
        margins = np.minimum(margins, dot(feet - centre, normal).max(axis=0))
    return margins


def ground_slopes(feet: Complex, height: Real, centre: complex | Complex) -> Complex:
    """Slope of the ground under the frame along and across the path, complex, shape (frames,); nan if it falls over.

    The frame rests on three feet that have the centre of weight between them and no foot below their plane, for small
    slopes. If the centre is exactly above the line of two feet, it can tilt to either side: the steeper slope counts.
    feet and centre: as in `support_margin`; height: of the feet in the frame, mm, shape (feet, frames).
    """
    slope = np.full(feet.shape[1], np.nan, dtype=complex)
    for three in combinations(range(len(feet)), 3):
        a, b, c = feet[list(three)]
        ya, yb, yc = height[list(three)]
        area = cross(b - a, c - a)
        size = np.abs(b - a) + np.abs(c - a)
        area = np.where(np.abs(area) <= ROUNDING * size**2, np.nan, area)
        at_b, at_c = cross(centre - a, c - a) / area, cross(b - a, centre - a) / area
        is_between = np.minimum(np.minimum(at_b, at_c), 1 - at_b - at_c) >= -ROUNDING
        # The gradient of the plane through the three feet.
        with np.errstate(invalid="ignore"):
            gradient = 1j * ((yc - ya) * (b - a) - (yb - ya) * (c - a)) / area
        above = (height - ya - dot(gradient, feet - a)).min(axis=0)
        carries = is_between & (above >= -ROUNDING * (size + np.ptp(height, axis=0)))
        steeper = carries & ~(np.abs(gradient) <= np.abs(slope))
        slope = np.where(steeper, gradient, slope)
    return slope


def foot_shares(feet: Complex, height: Real, centre: complex | Complex, slope: Complex) -> Real:
    """Share of the weight that each foot carries, (feet, frames); nan if the walker falls over.

    Three feet carry the weight by statics. If more stand, their forces have the least sum of squares, as on equal
    springs. slope: of the ground, as returned by `ground_slopes`; feet, height and centre: as there.
    """
    apart = feet - centre
    size = np.abs(apart).max()
    gap = height - dot(slope, apart)
    with np.errstate(invalid="ignore"):
        stands = gap - gap.min(axis=0) <= STANDING * size
    # Sum of the forces, and their moments about the centre: (frames, 3, feet).
    equations = np.stack([np.ones(feet.shape), apart.real / size, apart.imag / size]).transpose(2, 0, 1)
    shares = np.zeros(feet.shape)
    for _ in range(len(feet)):
        shares = np.linalg.pinv(equations * stands.T[:, None, :])[..., 0].T
        if not (pulled := shares < -WEIGHTLESS).any():
            break
        stands &= ~pulled
    return np.where(np.isfinite(slope), np.maximum(shares, 0.0), np.nan)


def foot_slip(shares: Real, velocity: Real) -> tuple[Real, Real]:
    """Direction of the friction on each foot, from -1 to 1, (feet, frames), and the speed of the frame, (frames,).

    Feet that move at different speeds in the frame cannot all stand still on the ground. The frame then moves so that
    the frictions balance: at the opposite of the median speed of the feet, weighted by the forces that they carry. A
    foot with that speed stands still and takes the rest. velocity: of the feet in the frame along the path, mm/s.
    """
    order = np.argsort(velocity, axis=0, kind="stable")
    passed = np.cumsum(np.take_along_axis(shares, order, axis=0), axis=0)
    middle = (
        np.take_along_axis(order, np.argmax(half, axis=0)[None], axis=0)
        for half in (passed >= 0.5 - WEIGHTLESS, passed > 0.5 + WEIGHTLESS)
    )
    lower, upper = (np.take_along_axis(velocity, foot, axis=0)[0] for foot in middle)
    frame = -(lower + upper) / 2
    slip = velocity + frame
    senses = np.where(np.abs(slip) > WEIGHTLESS * np.abs(velocity).max(), np.sign(slip), 0.0)
    friction = -senses * shares
    still = np.where(senses == 0, shares, 0.0)
    held = still.sum(axis=0)
    return friction - friction.sum(axis=0) * still / np.where(held > 0, held, 1.0), frame
