"""Spur gears as a rack leaves them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..sizes import check_sizes, entry, quantity
from .rack import Rack
from .tooth import Tooth, involute_function, outline


@dataclass(frozen=True)
class SpurGear:
    """An external spur gear about the origin, a tooth centred on +y.

    profile_shift: how far the rack stands out from its normal place, in modules; more makes the tooth
    stronger at its root and thinner at its tip.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=10_000, example=24)
    module: float = quantity("pitch diameter per tooth", "mm", above=0, at_most=1e5, example=2)
    profile_shift: float = quantity(
        "outward shift of the cutting rack", "modules", default=0.0, at_least=-10, at_most=10
    )
    rack: Rack = entry("the cutting rack", default=Rack())

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.tip_radius <= self.root_radius or self.root_radius <= 0:
            raise DesignError(
                "profile_shift",
                f"found {self.profile_shift:g}, which puts the root circle at {self.root_radius:.4g} mm",
                "give a larger profile_shift or more teeth",
            )
        if self.tip_radius <= self.base_radius:
            raise DesignError(
                "profile_shift",
                f"found {self.profile_shift:g}, which leaves no tooth outside the base circle",
                "give a larger profile_shift or more teeth",
            )
        if self.tip_thickness < 0:
            raise DesignError(
                "profile_shift",
                f"found {self.profile_shift:g}, with which the flanks meet below the tip circle: the teeth are pointed",
                self._less_pointed(),
            )
        self._tooth  # refuses a tooth that the rack cuts away

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle on which the rack rolls, mm."""
        return self.module * self.teeth / 2

    @property
    def base_radius(self) -> float:
        """Radius of the circle from which the flanks unwind, mm."""
        return self.pitch_radius * float(np.cos(self.rack.pressure_angle))

    @property
    def tip_radius(self) -> float:
        """Radius of the tooth tips, mm."""
        return self.pitch_radius + self.module * (self.rack.addendum + self.profile_shift)

    @property
    def root_radius(self) -> float:
        """Radius of the bottom of the spaces, mm."""
        return self.pitch_radius - self.module * (self.rack.dedendum - self.profile_shift)

    @property
    def form_radius(self) -> float:
        """Radius where the involute begins, mm: where the root curve touches it, or cuts it if undercut."""
        return self.base_radius * float(np.hypot(1, self._tooth.flank_start))

    @property
    def is_undercut(self) -> bool:
        """Whether the rack's tip cuts away part of the involute it has made."""
        return self._tooth.is_undercut

    @property
    def tip_thickness(self) -> float:
        """Thickness of the tooth along its tip circle, mm; negative where the flanks would have met below."""
        return 2 * self.tip_radius * self._half_angle(self.tip_radius)

    def thickness(self, radius: float) -> float:
        """Thickness of the tooth along a circle through its involute, mm."""
        return 2 * radius * self._half_angle(radius)

    @property
    def outline(self) -> AbstractCurve:
        """The whole gear as one closed counterclockwise curve of exact pieces."""
        return outline(self._tooth)

    @property
    def root_curve(self) -> AbstractCurve:
        """Right-hand root curve of the tooth on +y, from the bottom land up to the flank."""
        return self._tooth.root_curve

    @property
    def flank(self) -> AbstractCurve:
        """Right-hand flank of the tooth on +y, from the root curve up to the tip."""
        return self._tooth.flank

    @cached_property
    def _tooth(self) -> Tooth:
        return Tooth(
            teeth=self.teeth,
            pitch_radius=self.pitch_radius,
            base_radius=self.base_radius,
            tip_radius=self.tip_radius,
            root_radius=self.root_radius,
            pressure_angle=self.rack.pressure_angle,
            half_angle_at_base=self._half_angle(self.base_radius),
            corner_depth=self.module * (self.rack.corner_depth - self.profile_shift),
            corner_side=self.module * self.rack.corner_side,
            corner_rounding=self.module * self.rack.tip_radius,
            flank_depth=self.module * (self.rack.flank_depth - self.profile_shift),
        )

    def _half_angle(self, radius: float) -> float:
        """Half the angle that the tooth takes on a circle, rad."""
        a = self.rack.pressure_angle
        at_pitch = (np.pi / 2 + 2 * self.profile_shift * np.tan(a)) / self.teeth
        roll = np.sqrt(max((radius / self.base_radius) ** 2 - 1, 0.0))
        return float(at_pitch + involute_function(np.tan(a)) - involute_function(roll))

    def _less_pointed(self) -> str:
        """What leaves a tip: the largest shift, by bisection, a little on the safe side, if any does."""
        low, high = -self.rack.addendum, self.profile_shift
        a = self.rack.pressure_angle
        for _ in range(60):
            x = 0.5 * (low + high)
            roll = np.sqrt(max(((self.teeth / 2 + self.rack.addendum + x) / (self.teeth / 2 * np.cos(a))) ** 2 - 1, 0))
            half = (np.pi / 2 + 2 * x * np.tan(a)) / self.teeth + involute_function(np.tan(a)) - involute_function(roll)
            low, high = (x, high) if half > 0 else (low, x)
        if low == -self.rack.addendum:
            return "give a rack with a smaller addendum"
        return f"give at most {np.floor(low * 1000) / 1000:.4g}, or a rack with a smaller addendum"
