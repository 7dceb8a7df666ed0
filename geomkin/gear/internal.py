"""Whether the tips of a pinion and of the ring around it keep clear of each other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .involute import involute_function, roll_at


class InternalMesh(NamedTuple):
    """A pinion, or a cutter, in a ring: numbers of teeth, distance of the axes, tip and base radii, all in one unit."""

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
