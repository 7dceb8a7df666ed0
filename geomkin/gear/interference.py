"""Interference of teeth outside their contact: tips with roots, and a pinion's tips with its ring's."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from ..core.records import record
from ..plane.roulettes import involute_function, roll_at
from ..plane.vec import Pose, Real
from .contract import AbstractInvoluteGear

# Points on each curve of a side, and rotations of the gears. They resolve 1e-5 modules within a millisecond.
POINTS, ROTATIONS = 400, 4001


def side_angles(gear: AbstractInvoluteGear) -> tuple[Real, Real]:
    """Rising radii, mm, and half angles, rad, of the tooth's side: root curve, flank and tip edge."""
    curves = [gear.root_curve, gear.flank, *([gear.tip_edge] if gear.tip_edge else [])]
    z = np.concatenate([c.point(np.linspace(c.breaks[0], c.breaks[-1], POINTS)) for c in curves])
    radius, angle = np.abs(z), np.arctan2(z.real, z.imag)
    order = np.argsort(radius, kind="stable")
    return radius[order], angle[order]


def tip_margins(
    gear: AbstractInvoluteGear, mate: AbstractInvoluteGear, distance: float, poses: Callable[[Real], tuple[Pose, Pose]]
) -> tuple[float, float]:
    """Least distances of a gear's tip edges from the roots and from the flanks of its mate; negative inside the teeth.

    In mm along circles; inf if the tips do not come so far. distance: of the axes, mm. poses: function that returns the
    poses of gear and mate at rotations of the gear, rad.
    """
    last = gear.flank.breaks[-1]
    edges = [gear.flank.point(last)]
    if (edge := gear.tip_edge) is not None:
        edges.extend(edge.point(np.linspace(edge.breaks[0], edge.breaks[-1], 9)))
    radii, angles = side_angles(mate)
    # The tip's corner is inside the mate's tip circle within this angle.
    corner_radius = abs(edges[-1])
    cosine = (distance**2 + corner_radius**2 - mate.tip_radius**2) / (2 * distance * corner_radius)
    if mate.is_ring:
        cosine = -cosine
    span = np.arccos(np.clip(cosine, -1, 1)) + np.pi / gear.teeth
    gear_pose, mate_pose = poses(np.linspace(-span, span, ROTATIONS))
    z = mate_pose.locate(gear_pose.place(np.array(edges)[:, None]))
    pitch = 2 * np.pi / mate.teeth
    angle = np.arctan2(z.real, z.imag)
    from_tooth = np.abs(np.mod(angle + pitch / 2, pitch) - pitch / 2)
    radius = np.abs(z)
    margin = (from_tooth - np.interp(radius, radii, angles)) * radius
    within = (radius >= radii[0]) & (radius <= radii[-1])
    in_roots = radius > mate.form_radius if mate.is_ring else radius < mate.form_radius
    at_roots, at_flanks = (float(margin[within & part].min(initial=np.inf)) for part in (in_roots, ~in_roots))
    return at_roots, at_flanks


@record
class InternalMesh:
    """A pinion or cutter in a ring: numbers of teeth, distance of the axes, tip and base radii, in one unit of length.

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
        """Clearance of the pinion's tip from the ring's tip as it leaves the space, rad of the pinion.

        Negative for trochoid interference; inf if the pinion's tips do not reach those of the ring, -inf if they never
        leave them. When the pinion's tip corner is on the ring's tip circle, the triangle of the two centres and the
        corner gives the rotation of each gear since the flanks of the two corners touched at the pitch point.
        """
        a, pinion, ring = self.distance, self.pinion_tip, self.ring_tip
        # Angles of the corner from the line of centres, at the two centres.
        cosine = (ring**2 - pinion**2 - a**2) / (2 * a * pinion)
        if abs(cosine) >= 1:
            # The pinion's tips pass from space to space of the ring, through its teeth if they do not leave these.
            return float(np.copysign(np.inf, cosine))
        return self._gap(np.arccos(cosine), np.arccos((a**2 + ring**2 - pinion**2) / (2 * a * ring)))

    @property
    def trimming_gap(self) -> float:
        """Clearance of the pinion's tips from the ring's during radial assembly, rad of the pinion.

        Negative for trimming interference: the pinion can then only be inserted along its axis. -inf if the pinion is
        larger than the ring's tip circle.
        """
        tip = self.pinion_base / self.pinion_tip / (self.ring_base / self.ring_tip)
        ratio = self.pinion_teeth / self.ring_teeth
        if tip >= 1 or ratio >= 1:
            return float("inf")
        first = np.sqrt((1 - tip**2) / (1 - ratio**2))
        second = np.sqrt((tip**-2 - 1) / (ratio**-2 - 1))
        if first > 1 or second > 1:
            # Without room for the pinion's tips inside the ring's.
            return float("-inf")
        return self._gap(np.arcsin(first), np.arcsin(second))

    def _gap(self, at_pinion: float, at_ring: float) -> float:
        """Gap between the flanks of two tip corners at given angles about the centres of their gears, rad."""
        working = float(np.sqrt(max((self.distance / (self.ring_base - self.pinion_base)) ** 2 - 1, 0.0)))
        pitch = involute_function(working)
        pinion = at_pinion + involute_function(roll_at(self.pinion_tip, self.pinion_base)) - pitch
        ring = at_ring + involute_function(roll_at(self.ring_tip, self.ring_base)) - pitch
        return float(pinion - ring * self.ring_teeth / self.pinion_teeth)


@record(eq=False)
class PairInterference:
    """Distances of the teeth of two gears in mesh from each other, outside their contact.

    Parameters
    ----------
    first, second : AbstractInvoluteGear
        The driving gear, and the gear or ring that it drives.
    distance : float
        Distance of the axes, mm.
    line_of_action : float
        Length of the line of action between both base circles, mm.
    ratio : float
        Rotations of the first gear for one of the second.
    poses : callable
        Poses of both gears at rotations of the first, rad.
    """

    first: AbstractInvoluteGear
    second: AbstractInvoluteGear
    distance: float
    line_of_action: float
    ratio: float
    poses: Callable[[Real], tuple[Pose, Pose]]

    @property
    def tip_margins(self) -> tuple[float, float]:
        """Least distance of the second gear's tips from the teeth of the first, and of the first's from the second's.

        mm along circles, over the whole path of a tip through the space. 0 means proper contact with a flank, a
        negative value interference with a root or tooth. Accurate to 1e-5 modules.
        """
        of_second, of_first = self.of_tips
        return min(of_second), min(of_first)

    @cached_property
    def of_tips(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """`tip_margins`, each from the roots and from the flanks of the other gear."""
        first, second, distance = self.first, self.second, self.distance
        return (
            tip_margins(second, first, distance, lambda turn: self.poses(turn * self.ratio)[::-1]),
            tip_margins(first, second, distance, self.poses),
        )

    @property
    def involute_margin(self) -> float:
        """Length on the line of action from the first gear's base circle to the tip circle of the second, mm.

        A negative value means involute interference: the first gear's roots are not deep enough.
        """
        if self.second.is_ring:
            return self.second.flank_lengths[0] - self.line_of_action
        return self.line_of_action - self.second.flank_lengths[1]

    @property
    def trochoid_margin(self) -> float:
        """Clearance of the tips of an internal pair outside the contact, rad of the first gear; inf for other pairs.

        -inf if the tips never leave the spaces, so that they run through the teeth.
        """
        return self._internal.trochoid_gap if self.second.is_ring else float("inf")

    @property
    def trimming_margin(self) -> float:
        """Clearance of the ring's tips during radial assembly, rad of the first gear; inf for external pairs."""
        return self._internal.trimming_gap if self.second.is_ring else float("inf")

    @property
    def _internal(self) -> InternalMesh:
        first, second = self.first, self.second
        teeth, tips = (first.teeth, second.teeth), (first.tip_radius, second.tip_radius)
        return InternalMesh(*teeth, self.distance, *tips, first.base_radius, second.base_radius)
