"""The contract of cam followers, and outlines of their plates: a flat face on a stem, arms with a roller or a face."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, ClassVar, Literal

import numpy as np

from ...core.arguments import ArgumentType
from ...core.errors import DesignError
from ...core.fields import KindTable, inside, rounded_up
from ...core.records import record
from ...core.units import mm
from ...plane.curve import AbstractCurve
from ...plane.primitives import Polyline
from ...plane.vec import Complex, Pose, Real
from ..program.laws import largest
from ..program.program import FollowerMotion, Program

# Radius of outer corners, mm. Smaller corners cut fingers, chip when dropped and burn in a laser beam; larger ones
# waste material beyond the face.
CORNER = 1.0
# Least distance between the two guide pins of a stem, in widths of the stem. With less the follower tilts in its slot
# and jams; more needs longer stems.
LEAST_PIN_DISTANCE = 2.0


@record
class Bars:
    """Sizes that followers are cut with, mm; `CamStock` describes each."""

    bar_width: float
    overhang: float
    stem_length: float
    pivot_bore: float
    roller_bore: float


@record
class Hole:
    """A round hole in a follower's plate for a pin or shaft.

    Parameters
    ----------
    key : str
        Key of the diameter in the stock, such as "pivot_bore".
    diameter : float
        Diameter of the pin or shaft, mm; 0 for no hole.
    widest : float
        Width of the plate round the hole, mm; the hole must be narrower.
    centre : complex, optional
        Centre in the plate's frame, mm.
    """

    key: str
    diameter: float
    widest: float
    centre: complex = 0j


@record(eq=False)
class FollowerPlate:
    """One plate of a follower.

    Parameters
    ----------
    name : str
        Name of the part: "roller", "follower" or "arm" for those of this library.
    outline : AbstractCurve
        Closed outline, mm, in the follower's frame; for a roller about its centre.
    holes : tuple of Hole, optional
        Holes for pins and shafts.
    window : AbstractCurve, optional
        Opening in which the cam's shaft passes through the plate.
    """

    name: str
    outline: AbstractCurve
    holes: tuple[Hole, ...] = ()
    window: AbstractCurve | None = None


def guide_holes(bars: Bars, along: complex) -> tuple[Hole, Hole]:
    """Holes of the two pins that guide a stem: one beyond the bar of the face or the roller, one at the stem's end.

    along: unit direction of the stem, from the origin. Raises DesignError if the stem is too short for both.
    """
    width, stem = bars.bar_width, bars.stem_length
    first = width / along.imag
    least = first + LEAST_PIN_DISTANCE * width
    if stem < least:
        problem = f"found {mm(stem):g}, too short for two guide pins with bars {mm(width):g} wide"
        remedy = f"give at least {mm(least):up}, or omit base"
        raise DesignError("stock.stem_length", problem, remedy, value=rounded_up(least))
    inner, outer = (Hole("pivot_bore", bars.pivot_bore, width, distance * along) for distance in (first, stem))
    return inner, outer


def with_rounded_corners(outline: Polyline, radius: float) -> Polyline:
    """A counterclockwise outline whose convex corners between straight edges are rounded, with at most `radius`, mm.

    The radius is smaller at short edges.
    """
    z = np.asarray(outline.vertices)
    bulges = np.zeros(len(z)) if outline.bulges is None else np.asarray(outline.bulges)
    before, after = z - np.roll(z, 1), np.roll(z, -1) - z
    exterior = np.angle(after * np.conj(before))
    corner = (exterior > 1e-9) & (bulges == 0) & (np.roll(bulges, 1) == 0)
    tangent = np.tan(exterior / 2)
    cut = np.minimum(radius * tangent, 0.4 * np.minimum(np.abs(before), np.abs(after)))
    points: list[complex] = []
    curves: list[float] = []
    for k, vertex in enumerate(z):
        if corner[k] and cut[k] > 0:
            points += [vertex - cut[k] * before[k] / abs(before[k]), vertex + cut[k] * after[k] / abs(after[k])]
            curves += [float(np.tan(exterior[k] / 4)), float(bulges[k])]
        else:
            points.append(vertex)
            curves.append(float(bulges[k]))
    return Polyline(np.array(points), np.array(curves))


def stemmed_face(face: tuple[float, float], tilt: float, width: float, stem: float) -> tuple[Polyline, complex]:
    """Outline of a flat follower, and the centre of the hole in its stem's rounded end. The cam is on the -y side.

    face: both ends of the face, mm, from the origin, where the stem's centre line meets the face. tilt: deviation of
    the face from the perpendicular of the stem, rad. width: of the stem and of the bar along the face, mm. stem: length
    from the origin to the hole, mm.
    """
    along = 1j * np.exp(-1j * tilt)
    aside = -1j * along * width / 2
    # Points at which the stem's sides leave the bar. The face must be at least as wide as the stem.
    right, left = (side + along * (width - side.imag) / along.imag for side in (aside, -aside))
    low, high = min(face[0], left.real), max(face[1], right.real)
    end = stem * along
    if (end.imag - width / 2) <= width:
        problem = f"found {mm(stem):g}, too short for a bar {mm(width):g} wide along the face"
        remedy = f"give more than {mm(1.5 * width / along.imag):up}"
        raise DesignError("stock.stem_length", problem, remedy, value=inside(1.5 * width / along.imag, -1))
    corners = [low, high, high + 1j * width, right, end + aside, end - aside, left, low + 1j * width]
    bulges = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    return _polyline(corners, bulges), complex(end)


def faced_arm(face: tuple[float, float], offset: float, width: float, tau: int) -> Polyline:
    """Outline of an arm about a pivot at the origin with a flat face along its x axis.

    face: required range of the face, mm from the foot of the perpendicular from the pivot. offset: of the face from the
    pivot, mm, positive away from the cam. width: of the bar behind the face, and of the boss, mm. tau: +1 if the cam is
    on the +y side.
    """
    boss = width / 2
    # Computed with the cam on the +y side.
    top, back = -offset, min(-offset - width, -boss)
    # The face ends at the boss: below it, at its side, or beyond it.
    start = boss if top <= 0 else np.sqrt(boss**2 - top**2) if top < boss else -boss
    if face[0] < start:
        raise DesignError(
            "stock.bar_width",
            f"found {mm(width):g}, but the face must start {mm(face[0]):.4g} from the perpendicular through the pivot, "
            f"and the boss of the pivot extends to {mm(start):.4g}",
            "give a narrower bar, a shorter overhang or a larger pivot_distance",
        )
    corners = [face[1] + 1j * back, face[1] + 1j * top, start + 1j * top]
    bulges = [0.0, 0.0, 0.0]
    if top < boss:
        edge = complex(start, max(top, 0.0))
        corners += [edge, complex(-boss)]
        bulges += [float(np.tan((np.pi - np.angle(edge)) / 4)), 0.0]
    outline = _polyline([*corners, -boss + 1j * back], [*bulges, 0.0])
    return outline if tau > 0 else _mirrored(outline)


def _mirrored(outline: Polyline) -> Polyline:
    return Polyline(np.conj(outline.vertices), None if outline.bulges is None else -outline.bulges)


def _polyline(corners: list[complex], bulges: list[float]) -> Polyline:
    """A polyline without edges of zero length."""
    z, b = np.array(corners, dtype=complex), np.array(bulges, dtype=float)
    has_length = np.abs(np.roll(z, -1) - z) > 1e-12 * np.abs(z).max()
    return Polyline(z[has_length], b[has_length])


# Kind -> class of the followers that a recipe may name; filled in this folder's `__init__`, open to other packages.
FOLLOWERS: KindTable[AbstractFollower] = KindTable()

Side = Literal["above", "below"]


@record(eq=False)
class Contact:
    """Contact of cam and follower over cam angles; all arrays have one shape and refer to the ground's frame.

    Parameters
    ----------
    point : ndarray of complex
        Contact point, mm.
    normal : ndarray of complex
        Unit normal from the cam into the follower.
    normal_rate : ndarray
        Rotation of the normal in the cam's frame, rad per rad of cam angle.
    profile_speed : ndarray
        Speed of the contact along the profile, mm per rad of cam angle, positive against the cam's rotation. Where it
        is negative, the follower undercuts the cam.
    pressure_angle : ndarray
        Signed angle between the normal and the direction of the follower's motion, rad.

    Notes
    -----
    The profile is the envelope of the follower's positions (Chen, Mechanics and Design of Cam Mechanisms, 1982);
    `normal_rate` and `profile_speed` are derived here.
    """

    point: Complex
    normal: Complex
    normal_rate: Real
    profile_speed: Real
    pressure_angle: Real


# Derivatives by a size of a contact point, mm in the ground's frame, and of the pressure angle, rad: per mm or rad.
ContactRate = tuple[Complex, Real]


class AbstractFollower(ABC):
    """Contract of a follower on a cam that rotates about the origin.

    Parameters
    ----------
    kind : str
        A Literal whose default is its own value; the key of the class in `FOLLOWERS`.
    roller_radius : float
        Radius of the roller that touches the cam, mm; 0 for a knife edge and for a flat face.

    Notes
    -----
    A subclass is a frozen dataclass of its sizes. With a row in `FOLLOWERS`, recipes, templates and the schema accept
    it. Most followers inherit from `AbstractRoller` or `AbstractFace`, which implement half of the methods.

    In all methods `sense` is +1 for a cam that turns counterclockwise and -1 for clockwise, and `base_radius` is in mm.
    Lifts, mm, or rad if the follower oscillates, are 0 on the base circle and positive away from the cam. Methods with
    a `motion` return values at each of its cam angles, methods with a `program` values for the whole turn. Derived
    here.
    """

    kind: str
    roller_radius: float
    # The table by which recipes select followers.
    KINDS: ClassVar[KindTable[AbstractFollower]] = FOLLOWERS
    # Base radius in a template with this follower, mm; the lift there is 20 mm or deg.
    example_base_radius: ClassVar[float] = 40.0

    @property
    @abstractmethod
    def oscillates(self) -> bool:
        """Whether the follower swings about a pivot, so that its lifts are angles."""

    @property
    def lift_unit(self) -> tuple[str, float]:
        """Unit in which lifts are reported, and its number per mm or rad."""
        return ("deg", 180 / np.pi) if self.oscillates else ("mm", 1.0)

    @property
    @abstractmethod
    def size(self) -> float:
        """The largest length of the follower, mm, 0 if it has none. Its cam is of about that size or larger."""

    @property
    @abstractmethod
    def knife_edge(self) -> AbstractFollower | None:
        """The same follower with roller radius 0, whose profile is the pitch curve; None for a flat face."""

    @abstractmethod
    def check(self, program: Program, base_radius: float, sense: int) -> None:
        """Raise DesignError if the follower cannot ride on such a cam."""

    @abstractmethod
    def base_radius_range(self, largest_lift: float) -> tuple[float, float]:
        """Open range of base radii, mm, for which the follower reaches the cam at all lifts up to the largest."""

    @abstractmethod
    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        """Contact with the cam, without regard to undercut."""

    def contact_rates(self, motion: FollowerMotion, base_radius: float, sense: int) -> dict[str, ContactRate]:
        """Derivatives of the contact by each size of cam and follower, by field name; empty if there are none."""
        return {}

    @abstractmethod
    def pose(self, lift: Real, base_radius: float) -> Pose:
        """Pose of the follower's frame in the ground's frame at given lifts."""

    @abstractmethod
    def resting_lift(self, points: Complex, base_radius: float) -> Real:
        """Lift at which the follower rests on given points, mm in the ground's frame; -inf if it misses a point."""

    @abstractmethod
    def surface_between(self, pose: Pose, start: complex, end: complex) -> AbstractCurve:
        """Part of the follower's surface between two contact points, mm.

        The contact runs along it at a fixed cam angle if the programme's velocity jumps there. pose: of the follower's
        frame, in the frame of the two points.
        """

    @abstractmethod
    def outer_radius_bound(self, motion: FollowerMotion, base_radius: float, sense: int) -> Real:
        """Upper bound of the cam's radius, mm: the cam lies within the largest value of a whole turn.

        At each cam angle it is the distance from the cam's axis to a point that the follower covers, or beyond which
        it covers everything.
        """

    @abstractmethod
    def convex_radius(self, program: Program, base_radius: float, sense: int) -> tuple[Real, Real]:
        """Least radius of curvature of the convex parts of each stretch of the profile, mm, and its cam angle, rad.

        It is inf if the stretch is nowhere convex, and 0 or less if the follower undercuts the cam.
        """

    @abstractmethod
    def undercut_violation(self, motion: FollowerMotion, base_radius: float, sense: int, least_radius: float) -> Real:
        """Above 0 if the profile is undercut or has a convex radius of curvature below `least_radius`, mm."""

    @abstractmethod
    def contact_travel(self, program: Program, base_radius: float, sense: int) -> tuple[float, float] | None:
        """Range of the face that the cam touches, mm along the follower's x axis; None for a roller."""

    @abstractmethod
    def plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[FollowerPlate, ...]:
        """Plates of the follower, each in its own frame. Raises DesignError if the sizes of the bars do not fit."""

    def guided_plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[FollowerPlate, ...]:
        """Plates of the follower over a base.

        A translating follower has two holes `pivot_bore` in line with its motion, whose pins slide in a slot of the
        base. Raises DesignError if there is no room for them.
        """
        return self.plates(bars, program, base_radius, sense)

    def least_base_radius(self, program: Program, least_radius: float) -> float | None:
        """Base radius, mm, for which the least convex radius equals `least_radius`; None without a closed form."""
        return None


# Field type of a cam's follower; a recipe selects the class by its `kind`.
Follower = Annotated[
    AbstractFollower,
    ArgumentType(lambda value: isinstance(value, AbstractFollower), "a follower, such as TranslatingRoller"),
]


def check_reach(
    follower: AbstractFollower, program: Program, base_radius: float, part: str, size: str, other: str
) -> None:
    """Raise DesignError if an oscillating follower does not reach the cam at all lifts.

    part: its arm or face, for the message. size, other: the fields that limit it.
    """
    lift = largest(program.breaks, lambda t: program.motion(t).lift)[0]
    low, high = follower.base_radius_range(lift)
    if low < base_radius < high:
        return
    digits = ".4g" if high - low > 1e-2 * high else ".12g"
    limits = f"only cams with a base_radius above {low:{digits}} and below {high:{digits}} mm"
    reached = f"{limits}, not {base_radius:g}" if low < high else "no cam"
    raise DesignError(
        f"follower.{size}",
        f"found {mm(getattr(follower, size)):g} with {other} {mm(getattr(follower, other)):g} and lifts up to "
        f"{np.degrees(lift):.4g} deg: the {part} reaches {reached}",
        f"change {size}, {other} or base_radius",
    )


def side_sign(side: Side) -> int:
    """tau: +1 if the arm is above the line from the cam's axis to its pivot, -1 if below."""
    return 1 if side == "above" else -1


def arm_direction(psi: Real, tau: int) -> Complex:
    """Direction from the pivot along an arm at the angle psi, rad, from the line to the cam's axis."""
    return np.asarray(-np.exp(-1j * tau * psi))
