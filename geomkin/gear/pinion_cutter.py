"""The pinion-shaped cutter of internal gears, and its place in the ring that it cuts."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import quantity, rounded_down, rounded_up
from ..core.records import record
from ..plane.curve import AbstractCurve, Moved
from ..plane.joined import PolarArray
from ..plane.primitives import Arc, Segment
from ..plane.roulettes import Involute, inverse_involute, involute_function
from ..plane.vec import Pose
from .cutters import HelixAngle, transverse_factors
from .spur import TipRounding, largest_rounding, tip_rounding, toothed


@record(checked=True)
class PinionCutter:
    """An involute gear with cutting edges that cuts internal gears, lengths in modules.

    Parameters
    ----------
    teeth : int, optional
        Number of teeth, 4 to 1000.
    pressure_angle_deg : float, optional
        Angle of the flanks, 5 to 45 deg.
    addendum : float, optional
        Height of the teeth above the reference circle, modules.
    tip_radius : float, optional
        Radius of the tip edges, modules; 0 for sharp edges.
    profile_shift : float, optional
        Profile shift, modules; that of a sharpened cutter is smaller than that of a new one.
    fillet_radius : float, optional
        Fillet at the root of the teeth, modules, which rounds the tip edges of the ring. The roots are then as deep as
        the ring's tips need.

    Raises
    ------
    DesignError
        If the teeth are pointed, or their tips have no room for the radius.
    """

    teeth: int = quantity("number of the cutter's teeth", whole=True, default=24, at_least=4, at_most=1000)
    pressure_angle_deg: float = quantity("angle of the flanks", "deg", default=20.0, at_least=5, at_most=45)
    addendum: float = quantity(
        "height of the cutter's teeth above its reference circle", "modules", default=1.25, above=0, at_most=5
    )
    tip_radius: float = quantity("radius of the cutter's tip edges", "modules", default=0.2, at_least=0)
    profile_shift: float = quantity("profile shift of the cutter", "modules", default=0.0, at_least=-5, at_most=5)
    fillet_radius: float = quantity(
        "fillet at the root of the cutter's teeth, which rounds the ring's tips", "modules",
        default=0.0, at_least=0, at_most=10,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if self.outer_radius <= self.base_radius or self._half_angle(self.outer_radius) < 0:
            raise DesignError(
                "addendum",
                f"found {self.addendum:g} with {self.teeth} teeth, for which the flanks meet below the tip or vanish",
                self._whole_addendum(),
            )
        largest = largest_rounding(self.base_radius, self.half_angle_at_base, self.outer_radius)
        if self.tip_radius > largest:
            problem = f"found {self.tip_radius:g}, but the cutter's tips have room for {largest:.4g} modules"
            remedy = f"give at most {rounded_down(largest)}, or a smaller addendum"
            raise DesignError("tip_radius", problem, remedy, value=rounded_down(largest))

    @property
    def pressure_angle(self) -> float:
        """Pressure angle at the reference circle, rad."""
        return float(np.radians(self.pressure_angle_deg))

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> PinionCutter:
        """The transverse section of a cutter for helical teeth whose normal section has these sizes.

        Parameters
        ----------
        helix_angle_deg : float
            Helix angle of the teeth at the pitch circle, 0 to 45 deg.

        Returns
        -------
        PinionCutter
            As for `RackCutter.transverse`.
        """
        pressure_angle, ratio, rounding = transverse_factors(self.pressure_angle, helix_angle_deg)
        return PinionCutter(
            self.teeth,
            float(np.degrees(pressure_angle)),
            self.addendum * ratio,
            self.tip_radius * rounding,
            self.profile_shift * ratio,
            self.fillet_radius * rounding,
        )

    @property
    def base_radius(self) -> float:
        """Radius of the base circle, modules."""
        return self.teeth / 2 * float(np.cos(self.pressure_angle))

    @property
    def outer_radius(self) -> float:
        """Radius of the tip circle, modules."""
        return self.teeth / 2 + self.addendum + self.profile_shift

    @property
    def half_angle_at_base(self) -> float:
        """Half the angle of a tooth on the base circle, rad."""
        a = np.tan(self.pressure_angle)
        return float((np.pi / 2 + 2 * self.profile_shift * a) / self.teeth + involute_function(a))

    @cached_property
    def corner(self) -> TipRounding:
        """The rounding of the tip edges, modules and rad."""
        return tip_rounding(self.base_radius, self.half_angle_at_base, self.outer_radius, self.tip_radius)

    def fillet(self, root_radius: float) -> TipRounding:
        """The root fillet for a root radius, modules and rad; computed as a tip rounding of negative radius."""
        return tip_rounding(self.base_radius, self.half_angle_at_base, root_radius, -self.fillet_radius)

    def edge(self, module: float, root_radius: float | None = None) -> PolarArray:
        """The cutter's outline about its axis, mm, with a tooth centred on +y.

        Below the base circle, where it does not cut, the flanks are straight. module: mm. root_radius: of the roots,
        modules, used if they have a fillet.
        """
        corner, cusp = self.corner, np.exp(1j * (np.pi / 2 - self.half_angle_at_base))
        fillet = self.fillet(root_radius) if self.fillet_radius and root_radius else None
        begin = fillet.roll if fillet else 0.0
        flank = Moved(Involute(module * self.base_radius, begin, corner.roll), Pose(0j, cusp))
        # The depth of the spaces equals the addendum.
        root = min(self.base_radius, self.outer_radius - 2 * self.addendum)
        side: list[AbstractCurve] = [flank]
        half_land = max(0.0, np.pi / self.teeth - self.half_angle_at_base)
        if fillet:
            inward = 1j * np.exp(-1j * fillet.angle)
            end, centre = complex(flank.point(begin)), module * fillet.radius * inward
            start = centre - module * self.fillet_radius * inward
            side.insert(0, Arc(centre, start, float(np.angle((end - centre) / (start - centre)))))
            half_land = max(0.0, np.pi / self.teeth - fillet.angle)
        elif 0 < root < self.base_radius:
            start = complex(flank.point(0.0))
            side.insert(0, Segment(start * root / self.base_radius, start))
        if self.tip_radius:
            towards = 1j * np.exp(-1j * max(0.0, corner.angle))
            start, centre = complex(flank.point(corner.roll)), module * corner.radius * towards
            side.append(Arc(centre, start, float(np.angle(towards / (start - centre)))))
        return toothed(side, self.teeth, half_land)

    def _half_angle(self, radius: float) -> float:
        return self.half_angle_at_base - involute_function(np.sqrt((radius / self.base_radius) ** 2 - 1))

    def _whole_addendum(self) -> str:
        """A remedy: the range of addenda for complete flanks, or other sizes to change."""
        others = "other teeth or profile_shift"
        least = self.base_radius - self.teeth / 2 - self.profile_shift
        if self.half_angle_at_base <= 0:
            return f"give {others}"
        point = self.base_radius * np.hypot(1, inverse_involute(self.half_angle_at_base))
        largest = float(point - self.teeth / 2 - self.profile_shift)
        if largest <= max(least, 0.0) + 1e-5:
            return f"give {others}"
        if self.addendum <= least:
            # Slightly more, so that the flanks have a length.
            return f"give at least {rounded_up(least + 1e-6)} modules, or {others}"
        return f"give at most {rounded_down(largest)} modules, or {others}"


@record
class CutterInRing:
    """A pinion cutter at its full feed in a ring; lengths in modules.

    Parameters
    ----------
    teeth : int
        Number of the ring's teeth.
    profile_shift : float
        Outward shift of the ring's teeth, modules.
    cutter : PinionCutter
        The cutter.
    """

    teeth: int
    profile_shift: float
    cutter: PinionCutter

    @property
    def slope(self) -> float:
        """Tangent of the pressure angle at the reference circle."""
        return float(np.tan(self.cutter.pressure_angle))

    @property
    def base_radius(self) -> float:
        """Radius of the ring's base circle, modules."""
        return self.teeth / 2 * float(np.cos(self.cutter.pressure_angle))

    @property
    def working_involute(self) -> float:
        """Involute function of the working pressure angle; negative if the cutter does not fit."""
        shift = self.profile_shift - self.cutter.profile_shift
        return involute_function(self.slope) + 2 * self.slope * shift / (self.teeth - self.cutter.teeth)

    @property
    def least_shift(self) -> float:
        """Least profile shift for which the cutter fits between the teeth, modules."""
        apart = self.teeth - self.cutter.teeth
        return self.cutter.profile_shift - involute_function(self.slope) * apart / (2 * self.slope)

    @cached_property
    def cutting_angle(self) -> float:
        """Working pressure angle, rad."""
        return float(np.arctan(inverse_involute(self.working_involute)))

    @cached_property
    def distance(self) -> float:
        """Distance of the cutter's axis from the ring's, modules."""
        return (self.base_radius - self.cutter.base_radius) / float(np.cos(self.cutting_angle))
