"""The basic rack: the tool that defines a gear's teeth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import DesignError
from ..sizes import check_sizes, quantity, rounded_down


@dataclass(frozen=True)
class RackCutter:
    """A straight-flanked cutting rack, lengths in modules; the defaults are ISO 53 profile A.

    `addendum` is the gear's: how far its teeth reach above the reference line. `dedendum` is how deep
    the rack's tip cuts below it, `tip_radius` the rounding of that tip.
    """

    pressure_angle_deg: float = quantity("angle of the flanks", "deg", default=20.0, at_least=5, at_most=45)
    addendum: float = quantity(
        "height of the gear's teeth above the reference line", "modules", default=1.0, above=0, at_most=5
    )
    dedendum: float = quantity(
        "depth that the rack cuts below the reference line", "modules", default=1.25, above=0, at_most=5
    )
    tip_radius: float = quantity("rounding of the rack's tip", "modules", default=0.38, at_least=0)

    def __post_init__(self) -> None:
        check_sizes(self)
        slope = np.radians(self.pressure_angle_deg)
        # The rounding grows until the two corners of a tip meet in its middle.
        narrowest = np.pi / 4 - self.dedendum * np.tan(slope)
        if narrowest < 0:
            raise DesignError(
                "dedendum",
                f"found {self.dedendum:g}, but the rack's flanks meet at {np.pi / 4 / np.tan(slope):.4g} modules",
                f"give at most {rounded_down(np.pi / 4 / np.tan(slope))}, or a smaller pressure_angle_deg",
            )
        largest = narrowest * np.cos(slope) / (1 - np.sin(slope))
        if self.tip_radius > largest:
            raise DesignError(
                "tip_radius",
                f"found {self.tip_radius:g}, but the rack's tip is too narrow for more than {largest:.4g} modules",
                f"give at most {rounded_down(largest)}, or a smaller dedendum",
            )

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks, rad."""
        return float(np.radians(self.pressure_angle_deg))

    @property
    def corner_depth(self) -> float:
        """Depth of the tip rounding's centre below the reference line, modules."""
        return self.dedendum - self.tip_radius

    @property
    def corner_side(self) -> float:
        """Distance of the tip rounding's centre from the middle of the rack's tooth, modules, 0 or more."""
        a = self.pressure_angle
        return max(0.0, float(np.pi / 4 - self.corner_depth * np.tan(a) - self.tip_radius / np.cos(a)))

    @property
    def flank_depth(self) -> float:
        """Depth below the reference line where the straight flank ends, modules."""
        return float(self.dedendum - self.tip_radius * (1 - np.sin(self.pressure_angle)))
