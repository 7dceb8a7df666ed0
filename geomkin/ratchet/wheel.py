"""The wheel of a ratchet and its pawl: sizes, motion, outlines."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..core.errors import DesignError
from ..core.fields import FARTHEST, inside, quantity
from ..core.records import record
from ..core.units import mm
from ..plane.curve import AbstractCurve
from ..plane.joined import Path, PolarArray
from ..plane.primitives import Arc, Segment
from ..plane.vec import Complex, Real, cross, dot

# Least angle of the pawl's nose, deg: a narrower one is soon worn, and no cutter leaves it.
LEAST_NOSE = 18.0
# Angle by which the underside of the nose is steeper than any tooth below it, deg.
OPEN = 1.0
# Longest pawl over the diameter of the wheel: a longer one moves nearly straight, and loses digits.
LONGEST_PAWL = 20.0
# Positions of the wheel at which the lift of the pawl is compared.
POSITIONS = 128


@record(checked=True)
class Ratchet:
    """A ratchet wheel and its pawl; all lengths in mm.

    The wheel's axis is 0. The pawl holds the tooth whose tip is above it against turning clockwise, by a thrust towards
    its pivot on the right; counterclockwise the wheel turns freely.

    Parameters
    ----------
    diameter : float
        Diameter of the wheel over the tips of its teeth.
    teeth : int
        Number of teeth.
    pawl_length : float
        Distance of the pawl's pivot from the tip of the tooth that it holds.
    depth : float, optional
        Depth of the teeth; a quarter of their pitch if omitted.
    undercut_deg : float, optional
        Angle of the teeth's faces to the radius, by which they draw the pawl in, deg.
    pivot_deg : float, optional
        Angle of the line from that tip to the pivot, outwards from the tangent, deg, which draws it in too.
    friction : float, optional
        Coefficient of friction of pawl and teeth.
    nose_radius : float, optional
        Radius of the pawl's nose.
    pawl_width : float, optional
        Width of the pawl's bar.
    gap : float, optional
        Gap of the bar and the tips of the teeth.

    Examples
    --------
    >>> ratchet = gk.ratchet.Ratchet(80, teeth=24, pawl_length=45)
    >>> np.degrees([ratchet.engagement, ratchet.backlash, ratchet.lifts[1]]).round(3)
    array([15.   ,  0.826,  3.235])
    """

    diameter: float = quantity(
        "diameter of the wheel over the tips of its teeth", "mm", above=0, at_most=FARTHEST, example=80
    )
    teeth: int = quantity("number of teeth", whole=True, at_least=8, at_most=200, example=24)
    pawl_length: float = quantity(
        "distance of the pawl's pivot from the tip of the tooth that it holds", "mm", above=0, at_most=FARTHEST,
        example=45,
    )  # fmt: skip
    depth: float | None = quantity(
        "depth of the teeth; a quarter of their pitch if omitted", "mm", default=None, above=0, at_most=FARTHEST
    )
    undercut_deg: float = quantity(
        "angle of the teeth's faces to the radius, by which they draw the pawl in", "deg", default=15.0, at_least=0,
        at_most=40,
    )  # fmt: skip
    pivot_deg: float = quantity(
        "angle of the line from that tip to the pawl's pivot, outwards from the tangent, which draws it in too", "deg",
        default=0.0, at_least=-20, at_most=40,
    )  # fmt: skip
    friction: float = quantity("coefficient of friction of pawl and teeth", default=0.2, above=0, at_most=1)
    nose_radius: float = quantity("radius of the pawl's nose", "mm", default=0.5, above=0, at_most=FARTHEST)
    pawl_width: float = quantity("width of the pawl's bar", "mm", default=12.0, above=0, at_most=FARTHEST)
    gap: float = quantity("gap of the bar and the tips of the teeth", "mm", default=1.0, above=0, at_most=FARTHEST)

    def __post_init__(self) -> None:
        if self.engagement <= 0:
            problem = f"found {self.undercut_deg:g}, so that a load pushes the pawl out of the teeth"
            remedy = f"give more than {max(0.0, -self.pivot_deg):g}, or a larger pivot_deg"
            raise DesignError("undercut_deg", problem, remedy, "conflict")
        if self.tooth_depth >= self.radius * (1 - np.sin(self.undercut)):
            problem = f"found {mm(self.tooth_depth):g}, below which the faces have no end"
            raise DesignError("depth", problem, "give a smaller one, or a smaller undercut_deg", "conflict")
        self.pawl.check()

    @property
    def radius(self) -> float:
        """Radius of the tips, mm."""
        return self.diameter / 2

    @property
    def pitch(self) -> float:
        """Angle of a tooth, rad."""
        return 2 * np.pi / self.teeth

    @property
    def tooth_depth(self) -> float:
        """Depth of the teeth, mm."""
        return self.radius * self.pitch / 4 if self.depth is None else self.depth

    @property
    def undercut(self) -> float:
        """Angle of the faces to the radius, rad."""
        return float(np.radians(self.undercut_deg))

    @property
    def engagement(self) -> float:
        """Angle of the face's normal to the line from the tip to the pivot, rad; it engages above that of friction."""
        return self.undercut + float(np.radians(self.pivot_deg))

    @property
    def tip(self) -> complex:
        """Tip of the tooth that the pawl holds, mm."""
        return 1j * self.radius

    @property
    def pivot(self) -> complex:
        """Pivot of the pawl, mm."""
        return complex(self.tip + self.pawl_length * np.exp(1j * np.radians(self.pivot_deg)))

    @property
    def face(self) -> complex:
        """Direction of the face from its root to the tip; its normal towards the pawl is the same turned clockwise."""
        return complex(np.exp(1j * (np.pi / 2 - self.undercut)))

    @cached_property
    def root(self) -> complex:
        """Root of the face, mm."""
        along = self.radius * np.cos(self.undercut)
        inner, aside = self.radius - self.tooth_depth, self.radius * np.sin(self.undercut)
        return complex(self.tip - (along - np.sqrt(inner**2 - aside**2)) * self.face)

    @property
    def next_tip(self) -> complex:
        """Tip of the tooth behind the pawl's nose, mm."""
        return complex(self.tip * np.exp(-1j * self.pitch))

    @property
    def back(self) -> complex:
        """Direction of that tooth's back from the root to its tip."""
        edge = self.next_tip - self.root
        return edge / abs(edge)

    @cached_property
    def nose(self) -> complex:
        """Centre of the pawl's nose as it holds a tooth, mm: it then touches face and back."""
        half = float(np.angle(self.face / self.back)) / 2
        return complex(self.root + self.nose_radius / np.sin(half) * self.back * np.exp(1j * half))

    @cached_property
    def backlash(self) -> float:
        """Angle by which a tooth must pass the pawl before it drops, rad, and by which the wheel then turns back.

        The pawl drops when the tip leaves the circle about the pivot in which its nose swings.
        """
        far, near = abs(self.pivot), abs(self.nose - self.pivot) + self.nose_radius
        cosine = (self.radius**2 + far**2 - near**2) / (2 * self.radius * far)
        return float(np.angle(self.pivot) + np.arccos(cosine) - np.pi / 2)

    def passed(self, turn: ArrayLike) -> Real:
        """Rotation of the wheel since it was held last, rad, at rotations from where the pawl has just dropped.

        So far it turns back before the pawl holds it again: by the backlash to a pitch more than that.
        """
        turn = np.asarray(turn, dtype=float)
        return self.backlash + turn - self.pitch * np.floor(turn / self.pitch * (1 + 4e-16))

    def lift(self, turn: ArrayLike) -> Real:
        """Rotation of the pawl out of the teeth, rad, at rotations of the wheel from where it has just dropped."""
        return self._lift(self.passed(turn))[0]

    def lift_ratio(self, turn: ArrayLike) -> Real:
        """Derivative of the lift by the wheel's rotation; it jumps as the nose comes to a tip, and as it drops."""
        passed = self.passed(turn)
        lift, on_tip = self._lift(passed)
        centre = self.pivot + (self.nose - self.pivot) * np.exp(-1j * lift)
        wheel = np.exp(1j * passed)
        normal = np.where(on_tip, (centre - self.next_tip * wheel) / self.nose_radius, 1j * self.back * wheel)
        contact = centre - self.nose_radius * normal
        # The points of both bodies in contact have the same speed along the normal.
        return dot(normal, 1j * contact) / dot(normal, -1j * (contact - self.pivot))

    def _lift(self, passed: Real) -> tuple[Real, np.ndarray[tuple[int, ...], np.dtype[np.bool_]]]:
        """Lift of the pawl, rad, and whether its nose is on a tip, not on a back."""
        arm, back, wheel = self.nose - self.pivot, self.back, np.exp(-1j * passed)
        aside = cross(back + 0 * wheel, self.pivot * wheel - self.next_tip)
        reach = np.clip((self.nose_radius - aside) / abs(arm), -1, 1)
        start = float(np.angle(arm / back)) % (2 * np.pi)
        lift = start - passed - np.pi + np.arcsin(reach)
        centre = (self.pivot + arm * np.exp(-1j * lift)) * wheel
        on_tip = dot(back + 0 * wheel, centre - self.next_tip) > 0
        tip = self.next_tip / wheel - self.pivot
        cosine = (abs(arm) ** 2 + np.abs(tip) ** 2 - self.nose_radius**2) / (2 * abs(arm) * np.abs(tip))
        over = np.angle(arm / tip) + np.arccos(np.clip(cosine, -1, 1))
        return np.where(on_tip, over, lift), on_tip

    @property
    def outline(self) -> AbstractCurve:
        """The wheel's outline about its axis, with the tip of a tooth at the top."""
        return PolarArray(Path((Segment(self.next_tip, self.root), Segment(self.root, self.tip))), self.teeth)

    @cached_property
    def pawl(self) -> Pawl:
        """The pawl."""
        return Pawl(self)

    @cached_property
    def lifts(self) -> tuple[float, float]:
        """Least and largest lift of the pawl, rad; the least is below 0 if it lies deeper before it holds a tooth."""
        lifts = self._lift(self.backlash + self.pitch * np.linspace(0, 1, POSITIONS))[0]
        return float(lifts.min()), float(lifts.max())


@record(eq=False)
class Pawl:
    """The pawl of a ratchet wheel; places are from its pivot, as it holds a tooth, mm."""

    wheel: Ratchet

    def check(self) -> None:
        """DesignError if it has no room, or no nose."""
        wheel = self.wheel
        if wheel.nose_radius >= (most := self._widest_nose):
            problem = (
                f"found {mm(wheel.nose_radius):g}, which does not fit into a tooth {mm(wheel.tooth_depth):.4g} deep"
            )
            remedy = f"give less than {mm(most):down}, or deeper teeth" if most > 0 else "give deeper or fewer teeth"
            raise DesignError("nose_radius", problem, remedy, "conflict", inside(most, 1) if most > 0 else None)
        if wheel.pawl_length > (longest := LONGEST_PAWL * wheel.diameter):
            problem = f"found {mm(wheel.pawl_length):g} for a wheel of {mm(wheel.diameter):g}"
            raise DesignError("pawl_length", problem, f"give at most {mm(longest):down}", "conflict", longest)
        least = self._shortest
        if wheel.pawl_length <= least:
            problem = f"found {mm(wheel.pawl_length):g}, so near that its bar meets the wheel"
            remedy = f"give more than {mm(least):up}, or a smaller pawl_width"
            raise DesignError("pawl_length", problem, remedy, "conflict", inside(least, -1))
        if not self.nose_angle >= np.radians(LEAST_NOSE):
            degrees = f"{np.degrees(self.nose_angle):.3g}" if self.nose_angle > 0 else "less than 0"
            problem = f"found {mm(wheel.tooth_depth):g}, for which the nose of the pawl has {degrees} deg"
            remedy = f"give a smaller depth, a smaller undercut_deg or nose_radius, for at least {LEAST_NOSE:g} deg"
            raise DesignError("depth", problem, remedy, "conflict")
        if wheel.gap <= (least := self._least_gap):
            problem = f"found {mm(wheel.gap):g}, with which the bar meets the wheel as the pawl drops"
            raise DesignError("gap", problem, f"give more than {mm(least):up}", "conflict", inside(least, -1))
        start, knee, end = self._bends
        reach = dot(self.bar, np.array([knee, end]))
        if not (wheel.pawl_width / 2 < reach[0] < reach[1] and dot(np.exp(1j * self._under), knee - start) > 0):
            problem = f"found {wheel.pivot_deg:g}, with which the bar of the pawl passes its nose"
            remedy = "give a smaller one, a narrower pawl_width, or a longer pawl_length"
            raise DesignError("pivot_deg", problem, remedy, "conflict")

    @property
    def _widest_nose(self) -> float:
        """Radius of a nose, mm, that reaches up to four fifths of the face or back of a tooth."""
        wheel = self.wheel
        half = float(np.angle(wheel.face / wheel.back)) / 2
        return float(min(abs(wheel.tip - wheel.root), abs(wheel.next_tip - wheel.root)) * 0.8 * np.tan(half))

    @property
    def _shortest(self) -> float:
        """Length, mm, at which its bar is on the wheel."""
        wheel = self.wheel
        sine = float(np.sin(np.radians(wheel.pivot_deg)))
        beyond = (wheel.radius + wheel.gap + wheel.pawl_width / 2) ** 2 - wheel.radius**2
        return float(np.sqrt((wheel.radius * sine) ** 2 + beyond)) - wheel.radius * sine

    @property
    def _least_gap(self) -> float:
        """Gap, mm, at which the bar meets the wheel where it lies deeper than as it holds a tooth."""
        wheel = self.wheel
        far, least = abs(wheel.pivot), wheel.radius + wheel.pawl_width / 2
        deeper = max(0.0, -1.02 * wheel.lifts[0])
        return far * float(np.sin(np.arcsin(least / far) + deeper)) - least

    @cached_property
    def _under(self) -> float:
        """Direction of the underside of the nose, rad: steeper than any back while the nose is on it."""
        wheel = self.wheel
        steepest = float(np.angle(wheel.back)) + wheel.pitch + wheel.backlash + wheel.lifts[1]
        return steepest + float(np.radians(OPEN))

    @property
    def nose_angle(self) -> float:
        """Angle of the nose, rad."""
        return float(np.angle(self.wheel.face)) - self._under

    @property
    def bar(self) -> complex:
        """Direction of the bar from the pivot to the nose: its edge passes the tips at the gap."""
        wheel, pivot = self.wheel, self.wheel.pivot
        sine = (wheel.radius + wheel.gap + wheel.pawl_width / 2) / abs(pivot)
        return complex(-pivot / abs(pivot) * np.exp(-1j * np.arcsin(sine)))

    @property
    def tail(self) -> complex:
        """End beyond the pivot, for a spring."""
        return -1.5 * self.wheel.pawl_width * self.bar

    @property
    def _corner(self) -> complex:
        """End of the nose at the face."""
        wheel = self.wheel
        return wheel.nose - wheel.pivot + 1j * wheel.nose_radius * wheel.face

    @property
    def _bends(self) -> tuple[complex, complex, complex]:
        """End of the nose below, and the bar's ends below the nose and at the face."""
        wheel, under = self.wheel, complex(np.exp(1j * self._under))
        side = 1j * self.bar * wheel.pawl_width / 2
        start = wheel.nose - wheel.pivot - 1j * wheel.nose_radius * under
        end = _crossing(self._corner, wheel.face, -side, self.bar)
        return start, _crossing(start, under, side, self.bar), end

    @property
    def outline(self) -> AbstractCurve:
        """Its outline about the pivot."""
        wheel, corner, tail = self.wheel, self._corner, self.tail
        side, (start, knee, end) = 1j * self.bar * wheel.pawl_width / 2, self._bends
        nose = Arc(wheel.nose - wheel.pivot, corner, np.pi - self.nose_angle)
        return Path((
            nose, Segment(start, knee), Segment(knee, tail + side), Arc(tail, tail + side, np.pi),
            Segment(tail - side, end), Segment(end, corner),
        ))  # fmt: skip

    def direction(self, turn: ArrayLike) -> Complex:
        """Direction of its x axis, at rotations of the wheel from where it has just dropped; 1 as it holds a tooth."""
        return np.asarray(np.exp(-1j * self.wheel.lift(turn)))


def _crossing(point: complex, along: complex, other: complex, direction: complex) -> complex:
    """Crossing of two lines, each by a point and a direction."""
    return complex(point + along * cross(other - point, direction) / cross(along, direction))
