"""Internal gears as a pinion cutter leaves them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arguments import checked
from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..plane.derived import Mirrored, Moved, Reversed
from ..plane.pose import Pose
from ..plane.roulettes import Involute
from ..sizes import check_sizes, entry, quantity, rounded_down, rounded_up
from .cutter import PinionCutter
from .internal import InternalMesh
from .involute import inverse_involute, involute_function, roll_at
from .ring_root import RingTrochoid
from .tooth import toothed, with_land


@dataclass(frozen=True)
class RingGear:
    """An internal gear about the origin, a tooth centred on +y, pointing inwards.

    profile_shift: how far the teeth stand outwards of their normal place, in modules; a pinion of the same
    shift then meshes at the distance of a pair without shift. More makes the teeth thinner at their root
    circle and the spaces wider. thinning: the cutter widens the spaces by going round turned to both sides by
    all angles up to thinning / (2 pitch_radius), so that each side of a tooth turns as a whole, root curve and
    flank, and the bottom lands grow.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=8, at_most=10_000, example=60)
    module: float = quantity("pitch diameter per tooth", "mm", above=0, at_most=1e5, example=2)
    profile_shift: float = quantity("outward shift of the teeth", "modules", default=0.0, at_least=-10, at_most=10)
    cutter: PinionCutter = entry("the gear-shaped tool that cuts the teeth", default=PinionCutter())
    addendum: float = quantity(
        "how far the teeth reach inwards of their reference circle", "modules", default=1.0, above=0, at_most=5
    )
    thinning: float = quantity(
        "how much thinner each tooth is along the reference circle, for backlash", "mm", default=0.0, at_least=0
    )

    def __post_init__(self) -> None:
        check_sizes(self)
        z, z0 = self.teeth, self.cutter.teeth
        if z <= z0:
            raise DesignError(
                "teeth",
                f"found {z}, no more than the {z0} of its cutter",
                f"give at least {z0 + 1}, or a smaller cutter",
            )
        if self._working_involute < 0:
            least = self.cutter.profile_shift - involute_function(self._slope) * (z - z0) / (2 * self._slope)
            raise DesignError(
                "profile_shift",
                f"found {self.profile_shift:g}, for which the cutter does not fit between the teeth",
                f"give {self._wider(least)}",
            )
        self._check_tip()
        if self.root_radius <= self.tip_radius or self._flank_rolls[1] <= self._flank_rolls[0]:
            raise DesignError(
                "addendum",
                "the cutter does not reach the tips of the teeth",
                "give a larger addendum, or a larger one to the cutter",
            )
        self._check_thickness()
        if self._cutting.trochoid_gap < 0:
            raise DesignError(
                "cutter.teeth",
                f"found {z0}: on their way out of the spaces the cutter's tips cut the tips of {z} teeth",
                f"give {self._gentler()}",
            )

    def _check_tip(self) -> None:
        """The tips must stand where the cutter has an involute to make them."""
        least = self.module * float(np.hypot(self._base, self._cutter_distance * np.sin(self._cutting_angle)))
        if self.tip_radius >= least:
            return
        addendum = self.teeth / 2 + self.profile_shift - least / self.module
        remedy = f"give at most {rounded_down(addendum)} modules" if addendum >= 1e-3 else "give"
        joint = ", or more profile_shift" if addendum >= 1e-3 else " a larger profile_shift"
        raise DesignError(
            "addendum",
            f"found {self.addendum:g}, so the tips stand at {self.tip_radius:.5g} mm, but a cutter of "
            f"{self.cutter.teeth} teeth makes involutes from {least:.5g} mm outwards",
            f"{remedy}{joint} or cutter teeth",
        )

    def _check_thickness(self) -> None:
        """The tips, where the teeth are thinnest, must have some thickness left."""
        if self.tip_thickness >= 0:
            return
        most = 2 * self.pitch_radius * (np.pi / self.teeth - self._half_cut(self._flank_rolls[0]))
        if most > 0:
            raise DesignError(
                "thinning",
                f"found {self.thinning:g} mm, with which the flanks meet outside the tip circle",
                # A little less, so that the number still works when rounded.
                f"give at most {most * (1 - 1e-5):.6g}",
            )
        raise DesignError(
            "profile_shift",
            f"found {self.profile_shift:g}, with which the flanks meet outside the tip circle",
            "give a smaller profile_shift or addendum",
        )

    @property
    def pitch_radius(self) -> float:
        """Radius of the reference circle, mm."""
        return self.module * self.teeth / 2

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks at the reference circle, rad: the cutter's."""
        return self.cutter.pressure_angle

    @property
    def base_radius(self) -> float:
        """Radius of the circle from which the flanks unwind, mm."""
        return self.module * self._base

    @property
    def tip_radius(self) -> float:
        """Radius of the tooth tips, mm: the smallest of the gear."""
        return self.module * (self.teeth / 2 - self.addendum + self.profile_shift)

    @property
    def root_radius(self) -> float:
        """Radius of the bottom of the spaces, mm: the largest of the gear."""
        return self.module * (self._cutter_distance + self.cutter.outer_radius)

    @property
    def form_radius(self) -> float:
        """Radius where the involute ends and the root curve begins, mm."""
        return self.base_radius * float(np.hypot(1, self._flank_rolls[1]))

    @property
    def tip_thickness(self) -> float:
        """Thickness of the tooth along its tip circle, mm."""
        return self.thickness(self.tip_radius)

    @checked
    def thickness(self, radius: float) -> float:
        """Thickness of the tooth along a circle through its involute, mm."""
        return 2 * radius * (np.pi / self.teeth - self._half_space(roll_at(radius, self.base_radius)))

    @property
    def flank_lengths(self) -> tuple[float, float]:
        """Tangent lengths from the base circle to the involute's two ends, tip and root, mm."""
        first, last = self._flank_rolls
        return self.base_radius * first, self.base_radius * last

    @property
    def outline(self) -> AbstractCurve:
        """The teeth as one closed counterclockwise curve of exact pieces: the hole of the gear's plate."""
        return toothed([with_land([self.root_curve, self.flank], self._land)], self.teeth)

    @cached_property
    def root_curve(self) -> AbstractCurve:
        """Right-hand root curve of the tooth on +y, from the bottom land to the flank."""
        corner, m = self.cutter.corner, self.module
        wheel = self._cutter_distance * self.cutter.teeth / (self.teeth - self.cutter.teeth)
        radius = self._cutter_distance * self.teeth / (self.teeth - self.cutter.teeth)
        curve = RingTrochoid(
            radius=m * radius,
            wheel=m * wheel,
            reach=m * (corner.radius - wheel),
            rounding=m * self.cutter.tip_radius,
            start=0.0,
            end=np.pi / 2 - self._cutting_angle,
        )
        return Moved(curve, Pose(0j, np.exp(1j * (np.pi / 2 - np.pi / self.teeth + self._land))))

    @cached_property
    def flank(self) -> AbstractCurve:
        """Right-hand flank of the tooth on +y, from the root curve to the tip."""
        cusp = np.pi / 2 - np.pi / self.teeth + self._half_space(0.0)
        left = Moved(Involute(self.base_radius, *self._flank_rolls), Pose(0j, np.exp(1j * (np.pi - cusp))))
        return Reversed(Mirrored(left))

    def _half_space(self, roll: float) -> float:
        """Half the angle that a space takes where the flank has a roll angle, rad."""
        return self._half_cut(roll) + self._turn

    def _half_cut(self, roll: float) -> float:
        """The same before the teeth are thinned, rad."""
        a = self._slope
        return (np.pi / 2 + 2 * self.profile_shift * a) / self.teeth + involute_function(a) - involute_function(roll)

    @property
    def _turn(self) -> float:
        """Angle by which thinning turns each side of a tooth towards its middle, rad."""
        return self.thinning / (2 * self.pitch_radius)

    @property
    def _slope(self) -> float:
        return float(np.tan(self.pressure_angle))

    @property
    def _base(self) -> float:
        return self.teeth / 2 * float(np.cos(self.pressure_angle))

    @property
    def _working_involute(self) -> float:
        """Involute function of the working pressure angle with the cutter."""
        shift = self.profile_shift - self.cutter.profile_shift
        return involute_function(self._slope) + 2 * self._slope * shift / (self.teeth - self.cutter.teeth)

    @cached_property
    def _cutting_angle(self) -> float:
        """Working pressure angle with the cutter, rad."""
        return float(np.arctan(inverse_involute(self._working_involute)))

    @cached_property
    def _cutter_distance(self) -> float:
        """Distance of the cutter's axis from the ring's, modules."""
        return (self._base - self.cutter.base_radius) / float(np.cos(self._cutting_angle))

    @property
    def _land(self) -> float:
        """Half the angle of the bottom land, rad."""
        return max(0.0, self.cutter.corner.angle) * self.cutter.teeth / self.teeth + self._turn

    @cached_property
    def _flank_rolls(self) -> tuple[float, float]:
        """Roll angles of the involute at the tip, and where the cutter's own flank ends."""
        cut = self.cutter.corner.roll * self.cutter.base_radius
        end = (cut + self._cutter_distance * np.sin(self._cutting_angle)) / self._base
        return roll_at(self.tip_radius, self.base_radius), float(end)

    @property
    def _cutting(self) -> InternalMesh:
        """The cutter in the ring, modules."""
        return InternalMesh(
            self.cutter.teeth,
            self.teeth,
            self._cutter_distance,
            self.cutter.outer_radius,
            self.tip_radius / self.module,
            self.cutter.base_radius,
            self._base,
        )

    def _wider(self, least: float) -> str:
        """The least profile shift, from one for which the cutter fits, and failing that the cutter, that make a ring."""
        for step in (1e-9, *np.arange(0.05, 2, 0.05).tolist()):
            shift = rounded_up(least + step)
            if self._stands(profile_shift=float(shift)):
                return f"at least {shift}, or a cutter with fewer teeth"
        for teeth in range(self.cutter.teeth - 1, 3, -1):
            try:
                cutter = replace(self.cutter, teeth=teeth)
            except DesignError:
                continue
            if self._stands(cutter=cutter):
                return f"a cutter of {teeth} teeth"
        return "a cutter with fewer teeth and a larger profile_shift"

    def _stands(self, **changes: Any) -> bool:
        """Whether the ring can be made with other sizes."""
        ring = self._unchecked(**changes)
        # What these refuse looks for other cutters.
        if ring._working_involute < 0 or ring._cutting.trochoid_gap < 0:
            return False
        try:
            ring.__post_init__()
        except DesignError:
            return False
        return True

    def _unchecked(self, **changes: Any) -> RingGear:
        ring = object.__new__(RingGear)
        ring.__dict__.update({field.name: getattr(self, field.name) for field in fields(self)} | changes)
        return ring

    def _gentler(self) -> str:
        """The largest smaller cutter, of the same tips, that cuts these teeth."""
        for teeth in range(self.cutter.teeth - 1, 3, -1):
            try:
                cutter = replace(self.cutter, teeth=teeth)
            except DesignError:
                break
            if self._unchecked(cutter=cutter)._cutting.trochoid_gap < 0:
                continue
            if not self._stands(cutter=cutter):
                break
            return f"{teeth}, or a smaller addendum"
        return "a smaller addendum"
