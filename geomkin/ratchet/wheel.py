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
    >>> np.degrees([ratchet.engagement, ratchet.backlash, ratchet.largest_lift]).round(3)
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
        least = self._shortest
        if self.pawl_length <= least:
            problem = f"found {mm(self.pawl_length):g}, so near that its bar meets the wheel"
            remedy = f"give more than {mm(least):up}, or a smaller pawl_width"
            raise DesignError("pawl_length", problem, remedy, "conflict", inside(least, -1))
        if not self.nose_angle >= np.radians(LEAST_NOSE):
            degrees = f"{np.degrees(self.nose_angle):.3g}" if self.nose_angle > 0 else "less than 0"
            problem = f"found {mm(self.tooth_depth):g}, for which the nose of the pawl has {degrees} deg"
            remedy = f"give a smaller depth, a smaller undercut_deg or nose_radius, for at least {LEAST_NOSE:g} deg"
            raise DesignError("depth", problem, remedy, "conflict")

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

    @property
    def _corner(self) -> complex:
        """End of the nose at the face of the pawl, mm."""
        return self.nose + 1j * self.nose_radius * self.face

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

    @cached_property
    def largest_lift(self) -> float:
        """Largest lift of the pawl, rad."""
        return float(self._lift(self.backlash + self.pitch * np.linspace(0, 1, POSITIONS))[0].max())

    @property
    def _under(self) -> float:
        """Direction of the underside of the nose, rad: steeper than any back while the nose is on it."""
        steepest = float(np.angle(self.back)) + self.pitch + self.backlash + self.largest_lift
        return steepest + float(np.radians(OPEN))

    @property
    def nose_angle(self) -> float:
        """Angle of the pawl's nose, rad."""
        return float(np.angle(self.face)) - self._under

    @property
    def _shortest(self) -> float:
        """Length of the pawl, mm, at which its bar is on the wheel."""
        sine = float(np.sin(np.radians(self.pivot_deg)))
        beyond = (self.radius + self.gap + self.pawl_width / 2) ** 2 - self.radius**2
        return float(np.sqrt((self.radius * sine) ** 2 + beyond)) - self.radius * sine

    @property
    def bar(self) -> complex:
        """Direction of the pawl's bar from the pivot to the nose: its edge passes the tips at the gap."""
        sine = (self.radius + self.gap + self.pawl_width / 2) / abs(self.pivot)
        return complex(-self.pivot / abs(self.pivot) * np.exp(-1j * np.arcsin(sine)))

    @property
    def tail(self) -> complex:
        """End of the pawl beyond its pivot, for a spring, mm."""
        return self.pivot - 1.5 * self.pawl_width * self.bar

    @property
    def outline(self) -> AbstractCurve:
        """The wheel's outline about its axis, with the tip of a tooth at the top."""
        return PolarArray(Path((Segment(self.next_tip, self.root), Segment(self.root, self.tip))), self.teeth)

    @property
    def pawl_outline(self) -> AbstractCurve:
        """The pawl's outline about its pivot, as it holds a tooth."""
        side, under = 1j * self.bar * self.pawl_width / 2, np.exp(1j * self._under)
        nose, corner, tail = self.nose - self.pivot, self._corner - self.pivot, self.tail - self.pivot
        start = complex(nose - 1j * self.nose_radius * under)
        knee = _crossing(start, complex(under), side, self.bar)
        end = _crossing(corner, self.face, -side, self.bar)
        sweep = np.pi - self.nose_angle
        return Path((
            Arc(nose, corner, sweep), Segment(start, knee), Segment(knee, tail + side), Arc(tail, tail + side, np.pi),
            Segment(tail - side, end), Segment(end, corner),
        ))  # fmt: skip

    def pawl_direction(self, turn: ArrayLike) -> Complex:
        """Direction of the pawl's x axis, that of `pawl_outline` as it holds a tooth."""
        return np.asarray(np.exp(-1j * self.lift(turn)))


def _crossing(point: complex, along: complex, other: complex, direction: complex) -> complex:
    """Crossing of two lines, each by a point and a direction."""
    return complex(point + along * cross(other - point, direction) / cross(along, direction))
