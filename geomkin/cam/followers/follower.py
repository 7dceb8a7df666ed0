"""Plates of cam followers in plane terms: rollers, a flat face on a stem, arms with a roller or a face."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, ClassVar, Literal

import numpy as np

from ...core.arguments import ArgumentType
from ...core.errors import DesignError
from ...core.fields import KindTable, OneOfKinds, rounded_up
from ...core.records import record
from ...plane.curve import AbstractCurve
from ...plane.primitives import Polyline
from ...plane.vec import Complex, Pose, Real
from ..program.program import FollowerMotion, Program

# Radius of outer corners, mm. Smaller ones cut fingers, chip when dropped and are burnt by a beam; larger ones waste
# material beyond the face.
CORNER = 1.0
# Least distance of the two guide pins of a stem in its widths. Nearer, the play of the pins in their slot lets the
# follower tilt and jam; farther asks for longer stems.
APART = 2.0


@record
class Bars:
    """What followers are cut from, mm: `CamStock` in shop tells what each is."""

    bar_width: float
    overhang: float
    stem_length: float
    pivot_bore: float
    roller_bore: float


@record
class Hole:
    """A round hole for a pin or shaft of a diameter, mm, 0 for none.

    key: what the stock calls the diameter. widest: width of the plate round it, mm. centre: in the plate's frame, mm.
    """

    key: str
    diameter: float
    widest: float
    centre: complex = 0j


@record(eq=False)
class Plate:
    """One plate of a follower: outline, mm, in the follower's own frame or, for a roller, about its centre."""

    name: str
    outline: AbstractCurve
    holes: tuple[Hole, ...] = ()


def guide_holes(bars: Bars, along: complex) -> tuple[Hole, Hole]:
    """Of the two pins that guide a stem: one beyond the bar along its face or the roller, one at the stem's end.

    along: unit direction of the stem, from the origin. DesignError where the stem is too short for both.
    """
    width, stem = bars.bar_width, bars.stem_length
    first = width / along.imag
    least = first + APART * width
    if stem < least:
        raise DesignError(
            "stock.stem_length",
            f"found {stem:g} mm, on which two guide pins find no room with bars {width:g} mm wide",
            f"give at least {rounded_up(least)} mm, or leave out base",
        )
    near, far = (Hole("pivot_bore", bars.pivot_bore, width, distance * along) for distance in (first, stem))
    return near, far


def rounded(outline: Polyline, radius: float) -> Polyline:
    """The outline, counterclockwise, with its convex corners between straight edges rounded by `radius`, mm, at most.

    A corner is rounded less where its edges are short.
    """
    z = np.asarray(outline.vertices)
    bulges = np.zeros(len(z)) if outline.bulges is None else np.asarray(outline.bulges)
    before, after = z - np.roll(z, 1), np.roll(z, -1) - z
    turn = np.angle(after * np.conj(before))
    corner = (turn > 1e-9) & (bulges == 0) & (np.roll(bulges, 1) == 0)
    tangent = np.tan(turn / 2)
    cut = np.minimum(radius * tangent, 0.4 * np.minimum(np.abs(before), np.abs(after)))
    points: list[complex] = []
    curves: list[float] = []
    for k, place in enumerate(z):
        if corner[k] and cut[k] > 0:
            points += [place - cut[k] * before[k] / abs(before[k]), place + cut[k] * after[k] / abs(after[k])]
            curves += [float(np.tan(turn[k] / 4)), float(bulges[k])]
        else:
            points.append(place)
            curves.append(float(bulges[k]))
    return Polyline(np.array(points), np.array(curves))


def stemmed_face(face: tuple[float, float], tilt: float, width: float, stem: float) -> tuple[Polyline, complex]:
    """Outline of a flat follower, and the place of the hole in its stem's rounded end.

    face: its ends, mm along it from where the stem's middle line meets it, which is the origin. tilt: angle, rad,
    of the face from square to the stem. width: of the stem, and of the bar along the face. stem: from the origin
    to the hole, mm. The cam lies on the -y side.
    """
    along = 1j * np.exp(-1j * tilt)
    aside = -1j * along * width / 2
    # Where the stem's sides leave the bar, and how far the face must reach for the stem to stand on it.
    right, left = (side + along * (width - side.imag) / along.imag for side in (aside, -aside))
    low, high = min(face[0], left.real), max(face[1], right.real)
    end = stem * along
    if (end.imag - width / 2) <= width:
        raise DesignError(
            "stock.stem_length",
            f"found {stem:g} mm with a bar {width:g} mm wide along the face",
            f"give more than {1.5 * width / along.imag:.4g} mm",
        )
    corners = [low, high, high + 1j * width, right, end + aside, end - aside, left, low + 1j * width]
    bulges = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    return _polyline(corners, bulges), complex(end)


def faced_arm(face: tuple[float, float], offset: float, width: float, tau: int) -> Polyline:
    """Outline of an arm about a pivot at the origin with a flat face along its x axis.

    face: nearest and farthest place of the face that is needed, mm from the pivot's foot on it. offset: of the face
    from the pivot, mm, positive away from the cam. width: of the bar behind the face, and of the boss. tau: +1 where
    the cam lies on the +y side.
    """
    boss = width / 2
    # Drawn with the cam above: y counts towards it.
    top, back = -offset, min(-offset - width, -boss)
    # Where the face ends at the boss: below it, beside it, or beyond it.
    start = boss if top <= 0 else np.sqrt(boss**2 - top**2) if top < boss else -boss
    if face[0] < start:
        raise DesignError(
            "stock.bar_width",
            f"found {width:g} mm, but the face must start {face[0]:.4g} mm from the pivot's foot on it, and the boss "
            f"round the pivot reaches to {start:.4g} mm",
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
    """In the x axis."""
    return Polyline(np.conj(outline.vertices), None if outline.bulges is None else -outline.bulges)


def _polyline(corners: list[complex], bulges: list[float]) -> Polyline:
    """Without edges of no length."""
    z, b = np.array(corners, dtype=complex), np.array(bulges, dtype=float)
    kept = np.abs(np.roll(z, -1) - z) > 1e-12 * np.abs(z).max()
    return Polyline(z[kept], b[kept])


# kind -> class of all followers that a recipe may name; filled in this folder's `__init__`, and open to others.
FOLLOWERS: KindTable[AbstractFollower] = KindTable()

Side = Literal["above", "below"]


@record(eq=False)
class Contact:
    """Cam and follower where they touch, over cam angles; arrays of one shape, in the ground's frame.

    point: where they touch, mm. normal: direction from the cam into the follower, unit.
    turn: how fast the normal turns as seen from the cam, rad per rad of cam angle.
    advance: how fast the contact moves along the profile, mm/rad, positive against the cam's turning;
    where it is negative the follower cuts away what it touched before.
    pressure_angle: rad, signed, between the normal and the way the follower is free to go there.

    Source: the profile as envelope of the follower's positions (Chen, Mechanics and Design of Cam Mechanisms, 1982);
    turn and advance derived here.
    """

    point: Complex
    normal: Complex
    turn: Real
    advance: Real
    pressure_angle: Real


class AbstractFollower(ABC):
    """What rides on a cam that turns about the origin: all that cam, judge and shop ask of it.

    A subclass is a frozen dataclass of its sizes with a field `kind`, a Literal with itself as default; with a row in
    `FOLLOWERS`, recipes, templates and the schema know it. Most roll (`AbstractRoller`) or have a flat face
    (`AbstractFace`); those two answer half of these questions.

    Throughout, `sense` is +1 for a cam that turns counterclockwise, -1 for clockwise, `base_radius` is in mm, and
    lifts, mm, or rad where it oscillates, are 0 on the base circle and positive away from the cam. Methods that take
    a `motion` answer at each of its cam angles, those that take the `program` for the whole turn. Derived here.
    """

    kind: str
    # Table that recipes tell followers apart by.
    KINDS: ClassVar[KindTable[AbstractFollower]] = FOLLOWERS
    # mm. Of the cam that a template shows with it, whose lift is 20 mm or deg.
    example_base_radius: ClassVar[float] = 40.0

    @property
    @abstractmethod
    def oscillates(self) -> bool:
        """Whether it swings about a pivot, so that its lifts are angles."""

    @property
    def lift_unit(self) -> tuple[str, float]:
        """Unit in which people are told its lifts, and how many of it are one mm or rad."""
        return ("deg", 180 / np.pi) if self.oscillates else ("mm", 1.0)

    @property
    @abstractmethod
    def size(self) -> float:
        """The largest of its own lengths, mm, 0 where it has none: a cam for it is of about that size or more."""

    @property
    @abstractmethod
    def rounding(self) -> float:
        """Radius of the roller that touches the cam, mm; 0 for a knife edge and for a flat face."""

    @property
    @abstractmethod
    def knife_edge(self) -> AbstractFollower | None:
        """The same shrunk to a knife edge at the roller's centre, whose profile is the pitch curve; None of a face."""

    @abstractmethod
    def check(self, program: Program, base_radius: float, sense: int) -> None:
        """Raises DesignError where the follower cannot ride on such a cam."""

    @abstractmethod
    def base_radii(self, largest_lift: float) -> tuple[float, float]:
        """Base radii, mm, between which, both excluded, the follower can reach the cam in all its lifts."""

    @abstractmethod
    def contact(self, motion: FollowerMotion, base_radius: float, sense: int) -> Contact:
        """Where it touches a cam that it undercuts nowhere."""

    @abstractmethod
    def place(self, lift: Real, base_radius: float) -> Pose:
        """Its own frame in the ground's."""

    @abstractmethod
    def resting_lift(self, points: Complex, base_radius: float) -> Real:
        """Lift at which it rests on points of the ground, complex mm; minus infinity where it passes them by."""

    @abstractmethod
    def joint(self, pose: Pose, start: complex, end: complex) -> AbstractCurve:
        """The part of its surface between two points of contact, mm, along which contact runs while it stands still.

        That is where the programme's velocity jumps. pose: of its own frame, in the frame of the two points.
        """

    @abstractmethod
    def outer_radius_bound(self, motion: FollowerMotion, base_radius: float, sense: int) -> Real:
        """Distance from the cam's axis, mm, of a point that it covers, or whose far side it covers.

        Over a whole turn no cam is left beyond the largest of them.
        """

    @abstractmethod
    def convex_radius(self, program: Program, base_radius: float, sense: int) -> tuple[Real, Real]:
        """Least radius of curvature of each stretch of the profile where convex, mm, and the cam angle there, rad.

        Infinite where it is nowhere convex, 0 or less where the follower undercuts.
        """

    @abstractmethod
    def undercut_violation(self, motion: FollowerMotion, base_radius: float, sense: int, least_radius: float) -> Real:
        """Above 0 where the profile runs backwards, or has a convex radius of curvature below `least_radius`, mm."""

    @abstractmethod
    def contact_travel(self, program: Program, base_radius: float, sense: int) -> tuple[float, float] | None:
        """Ends of the stretch of its face that the cam touches, mm along its x axis; None of a roller."""

    @abstractmethod
    def plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[Plate, ...]:
        """What it is made of, each plate in its own frame. Raises DesignError where the bars' sizes do not fit."""

    def guided_plates(self, bars: Bars, program: Program, base_radius: float, sense: int) -> tuple[Plate, ...]:
        """The same over a base: one that moves straight has two holes `pivot_bore`, whose pins a slot guides.

        They are in line with its motion. Raises DesignError where they find no room.
        """
        return self.plates(bars, program, base_radius, sense)

    def least_base_radius(self, program: Program, least_radius: float) -> float | None:
        """Base radius, mm, at which the least convex radius is just `least_radius`, where a formula tells it."""
        return None


# As a field of a cam, told apart by its kind in a recipe.
Follower = Annotated[
    AbstractFollower,
    OneOfKinds(),
    ArgumentType(
        lambda value: isinstance(value, AbstractFollower),
        "a follower, such as TranslatingRoller",
    ),
]


def side_sign(side: Side) -> int:
    """tau: +1 where an arm rides above the line from the cam's axis to its pivot, -1 below."""
    return 1 if side == "above" else -1


def arm_direction(psi: Real, tau: int) -> Complex:
    """Direction from the pivot along an arm at the angle psi, rad, from the line to the cam's axis."""
    return np.asarray(-np.exp(-1j * tau * psi))
