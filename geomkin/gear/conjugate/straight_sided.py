"""Gears with straight-sided teeth."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...errors import DesignError
from ...plane.curve import AbstractCurve
from ...plane.primitives import Segment
from ...sizes import check_sizes, quantity, rounded_down
from .flank_gear import FlankGear


@dataclass(frozen=True)
class StraightSidedGear:
    """A gear whose teeth have straight flanks, about the origin, a tooth on +y; heights in modules.

    Heights and thicknesses are those of the straight tooth itself: along its middle from the pitch circle, and
    square to that, so that at the pitch circle the tooth is half a pitch, pi / 2 modules, thick.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=1000, example=40)
    module: float = quantity("pitch diameter per tooth", "mm", above=0, at_most=1e5, example=3)
    flank_angle_deg: float = quantity(
        "angle between a flank and the middle of its tooth", "deg", default=25.0, at_least=0, at_most=60
    )
    addendum: float = quantity("height of the teeth above the pitch circle", "modules", default=1.0, above=0, at_most=5)
    dedendum: float = quantity("depth of the spaces below the pitch circle", "modules", default=1.2, above=0, at_most=5)

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.tip_thickness < 0:
            largest = np.pi / 4 / self._slope
            raise DesignError(
                "addendum",
                f"found {self.addendum:g}, but the flanks meet {largest:.4g} modules above the pitch circle",
                f"give at most {rounded_down(largest)}, or a smaller flank_angle_deg",
            )
        if self.dedendum >= self.teeth / 2:
            raise DesignError(
                "dedendum",
                f"found {self.dedendum:g} with {self.teeth} teeth",
                f"give less than {self.teeth / 2:g}, or more teeth",
            )
        half = np.arctan2(self.root_thickness / 2, self.pitch_radius - self.dedendum * self.module)
        if half > np.pi / self.teeth:
            raise DesignError(
                "dedendum",
                f"found {self.dedendum:g}, at which neighbouring teeth run into each other",
                f"give at most {rounded_down(self._deepest())}, or a smaller flank_angle_deg",
            )

    @property
    def _slope(self) -> float:
        return float(max(np.tan(np.radians(self.flank_angle_deg)), 1e-300))

    def _deepest(self) -> float:
        """The dedendum at which the bottom lands vanish, modules: where a flank meets the line between two teeth."""
        a = np.tan(np.pi / self.teeth)
        return float((self.teeth / 2 * a - np.pi / 4) / (self._slope + a) * (1 - 1e-12))

    @property
    def pitch_radius(self) -> float:
        """Radius of the pitch circle, mm."""
        return self.module * self.teeth / 2

    @property
    def tip_thickness(self) -> float:
        """Thickness of the tooth at its tip, mm; negative where the flanks would have met below."""
        return self.module * (np.pi / 2 - 2 * self.addendum * self._slope)

    @property
    def root_thickness(self) -> float:
        """Thickness of the tooth at its root, mm."""
        return self.module * (np.pi / 2 + 2 * self.dedendum * self._slope)

    @property
    def flank(self) -> AbstractCurve:
        """Right-hand flank of the tooth on +y, from the bottom land up to the tip."""
        r, m = self.pitch_radius, self.module
        root = complex(self.root_thickness / 2, r - self.dedendum * m)
        return Segment(root, complex(self.tip_thickness / 2, r + self.addendum * m))

    @cached_property
    def gear(self) -> FlankGear:
        """The same as a gear given by its flank."""
        return FlankGear(self.flank, self.teeth, self.pitch_radius)

    @property
    def outline(self) -> AbstractCurve:
        """The whole gear as one closed counterclockwise curve."""
        return self.gear.outline
