"""Whether teeth hit each other beside their contact: tips against roots, a pinion's tips against its ring's."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..core.records import record
from ..plane.roulettes import involute_function, roll_at
from ..plane.vec import Pose, Real
from .contract import AbstractInvoluteGear

# Points on each curve of a side, and places of a tip on its way. Fewer would see less than a hundred-thousandth of
# a module; the time stays at a millisecond.
POINTS, PLACES = 400, 4001


def side_angles(gear: AbstractInvoluteGear) -> tuple[Real, Real]:
    """Radii, rising, mm, and angles of the tooth's side from its middle, rad: root curve, flank and tip edge."""
    curves = [gear.root_curve, gear.flank, *([gear.tip_edge] if gear.tip_edge else [])]
    z = np.concatenate([c.point(np.linspace(c.breaks[0], c.breaks[-1], POINTS)) for c in curves])
    radius, angle = np.abs(z), np.arctan2(z.real, z.imag)
    order = np.argsort(radius, kind="stable")
    return radius[order], angle[order]


def tip_margin(
    moving: AbstractInvoluteGear,
    still: AbstractInvoluteGear,
    distance: float,
    poses: Callable[[Real], tuple[Pose, Pose]],
) -> float:
    """Least distance along circles, mm, of one gear's tip edges from the other's teeth; negative inside them.

    distance: of the axes, mm; poses: where `moving` and `still` stand when the first has turned by angles, rad.
    """
    last = moving.flank.breaks[-1]
    edges = [moving.flank.point(last)]
    if (edge := moving.tip_edge) is not None:
        edges.extend(edge.point(np.linspace(edge.breaks[0], edge.breaks[-1], 9)))
    radii, angles = side_angles(still)
    # The tip's corner meets the other's circle of tips, and through the space leaves it again, within this angle.
    mine = abs(edges[-1])
    cosine = (distance**2 + mine**2 - still.tip_radius**2) / (2 * distance * mine)
    if still.is_ring:
        cosine = -cosine
    span = np.arccos(np.clip(cosine, -1, 1)) + np.pi / moving.teeth
    here, there = poses(np.linspace(-span, span, PLACES))
    z = there.locate(here.place(np.array(edges)[:, None]))
    pitch = 2 * np.pi / still.teeth
    angle = np.arctan2(z.real, z.imag)
    off = np.abs(np.mod(angle + pitch / 2, pitch) - pitch / 2)
    radius = np.abs(z)
    beside = (off - np.interp(radius, radii, angles)) * radius
    within = (radius >= radii[0]) & (radius <= radii[-1])
    return float(beside[within].min()) if within.any() else float("inf")


@record
class InternalMesh:
    """A pinion, or a cutter, in a ring: numbers of teeth, distance of the axes, tip and base radii, all in one unit.

    Colbourne, The Geometry of Involute Gears, on internal gear pairs; the formulas are derived here.
    """

    pinion_teeth: float
    ring_teeth: float
    distance: float
    pinion_tip: float
    ring_tip: float
    pinion_base: float
    ring_base: float

    @property
    def trochoid_gap(self) -> float:
        """Angle, rad on the pinion, by which its tip passes clear of the ring's tip on its way out of the space.

        Negative where they hit: trochoid interference. Infinite where the tip circles do not cross. Where the
        pinion's tip corner stands on the ring's tip circle, the triangle of the two centres and the corner gives
        how far each gear has turned since the two corners' flanks touched at the pitch point.
        """
        a, one, two = self.distance, self.pinion_tip, self.ring_tip
        # The angles at the two centres, of the corner from the line of centres.
        cosine = (two**2 - one**2 - a**2) / (2 * a * one)
        if abs(cosine) >= 1:
            return float("inf")
        return self._gap(np.arccos(cosine), np.arccos((a**2 + two**2 - one**2) / (2 * a * two)))

    @property
    def trimming_gap(self) -> float:
        """Angle, rad on the pinion, by which its tips clear the ring's when it is moved in along a radius.

        Negative where they hit, so that the pinion can only be put in along its axis: trimming interference.
        """
        tip = self.pinion_base / self.pinion_tip / (self.ring_base / self.ring_tip)
        ratio = self.pinion_teeth / self.ring_teeth
        if tip >= 1 or ratio >= 1:
            return float("inf")
        first = np.sqrt((1 - tip**2) / (1 - ratio**2))
        second = np.sqrt((tip**-2 - 1) / (ratio**-2 - 1))
        if first > 1 or second > 1:
            return float("inf")
        return self._gap(np.arcsin(first), np.arcsin(second))

    def _gap(self, at_pinion: float, at_ring: float) -> float:
        """Between the flanks of two tip corners that stand at these angles about their own centres, rad."""
        working = float(np.sqrt(max((self.distance / (self.ring_base - self.pinion_base)) ** 2 - 1, 0.0)))
        pitch = involute_function(working)
        pinion = at_pinion + involute_function(roll_at(self.pinion_tip, self.pinion_base)) - pitch
        ring = at_ring + involute_function(roll_at(self.ring_tip, self.ring_base)) - pitch
        return float(pinion - ring * self.ring_teeth / self.pinion_teeth)
