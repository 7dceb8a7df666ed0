"""The rack that defines a gear's teeth, and how far it is shifted."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from ..core.arguments import Count, between, checked, whole_between
from ..core.errors import DesignError
from ..core.fields import quantity, rounded_down
from ..core.records import record
from ..plane.primitives import Polyline
from ..plane.roulettes import inverse_involute, involute_function, roll_at

# Shifts looked at, modules. Gears outside have neither teeth nor use.
LEAST, MOST = -2.0, 3.0
Teeth = Annotated[int, whole_between(4, 10_000)]
# Above it, deg, the teeth push along the axis harder than round it, and gears become screws.
STEEPEST = 45
HelixAngle = Annotated[float, between(0, STEEPEST, "deg")]
Total = Annotated[float, between(-20, 20, "modules")]


@record(checked=True)
class RackCutter:
    """A straight-flanked cutting rack, lengths in modules; the defaults are basic rack profile A of ISO 53.

    `addendum` is the gear's: how far its teeth reach above the reference line. `dedendum` is how deep
    the rack's tip cuts below it, `tip_radius` the rounding of that tip. `fillet_radius` is the fillet at the root of
    the rack's teeth: such a rack cuts the gear's tips, too, and rounds their edges.
    Raises DesignError where the flanks meet above the tip, or a tip or root has no room for its rounding.
    """

    pressure_angle_deg: float = quantity("angle of the flanks", "deg", default=20.0, at_least=5, at_most=45)
    addendum: float = quantity(
        "height of the gear's teeth above the reference line", "modules", default=1.0, above=0, at_most=5
    )
    dedendum: float = quantity(
        "depth that the rack cuts below the reference line", "modules", default=1.25, above=0, at_most=5
    )
    tip_radius: float = quantity("rounding of the rack's tip", "modules", default=0.38, at_least=0)
    fillet_radius: float = quantity(
        "fillet at the root of the rack's teeth, which rounds the gear's tips", "modules", default=0.0, at_least=0
    )

    def __post_init__(self) -> None:
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
        room = max(0.0, np.pi / 4 - self.addendum * np.tan(slope)) * np.cos(slope) / (1 - np.sin(slope))
        if self.fillet_radius > room:
            raise DesignError(
                "fillet_radius",
                f"found {self.fillet_radius:g}, but the rack's spaces have room for {room:.4g} modules",
                f"give at most {rounded_down(room)}, or a smaller addendum",
            )

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks, rad."""
        return float(np.radians(self.pressure_angle_deg))

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> RackCutter:
        """The transverse section of a rack that cuts helical teeth, and has these sizes square to the teeth.

        Heights stay as they are in mm, widths grow. The ellipses that the roundings become count as circles that leave
        the flanks at the same height, so that form radius and undercut are exact; of the ISO 53 rack's rounding they
        are 0.002, 0.007 and 0.016 modules off at most, at 15, 30 and 45 deg (derived here). helix_angle_deg: of the
        teeth at the pitch circle, 0 to 45 deg.
        """
        pressure_angle, ratio, rounding = transverse_factors(self.pressure_angle, helix_angle_deg)
        return RackCutter(
            float(np.degrees(pressure_angle)),
            self.addendum * ratio,
            self.dedendum * ratio,
            self.tip_radius * rounding,
            self.fillet_radius * rounding,
        )

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

    @property
    def fillet_height(self) -> float:
        """Height of the root fillet's centre above the reference line, modules."""
        return self.addendum - self.fillet_radius

    @property
    def fillet_side(self) -> float:
        """Distance of the root fillet's centre from the middle of the rack's space, modules."""
        a = self.pressure_angle
        return float(np.pi / 4 - self.fillet_height * np.tan(a) - self.fillet_radius / np.cos(a))

    @property
    def flank_height(self) -> float:
        """Height above the reference line where the straight flank ends, modules."""
        return float(self.addendum - self.fillet_radius * (1 - np.sin(self.pressure_angle)))

    def edge(self, module: float, teeth: int, tooth_thickness_allowance: float = 0.0) -> Polyline:
        """Its cutting edge along the x axis from left to right, mm, round so many teeth of what it cuts.

        One of them is centred on +y, the middle one where their number is odd. module: mm.
        tooth_thickness_allowance: how much thinner they are along the reference line, modules, for which the rack
        goes to both sides. Open, of straight edges and arcs.
        """
        a = self.pressure_angle
        land = self.corner_side + tooth_thickness_allowance / 2
        top = self.fillet_side - tooth_thickness_allowance / 2
        # One tooth's right-hand side, downwards: end of the tip, both ends of the flank, start of the bottom land.
        flank_start = top + self.fillet_radius * np.cos(a) + 1j * self.flank_height
        flank_end = np.pi / 2 - land - self.tip_radius * np.cos(a) - 1j * self.flank_depth
        side = np.array([top + 1j * self.addendum, flank_start, flank_end, np.pi / 2 - land - 1j * self.dedendum])
        # The roundings turn from the flank's slope to the level: a quarter of it as tan.
        turn = np.tan((np.pi / 2 - a) / 4)
        turns = np.array([-turn, 0, turn])
        # Where a corner is sharp, flank and land meet.
        first, last = int(self.fillet_radius == 0), 3 - int(self.tip_radius == 0)
        side, turns = side[first : last + 1], turns[first:last]
        bends = [*turns[::-1], 0, *turns, 0]
        tooth = np.concatenate([-np.conj(side)[::-1], side])
        places = np.pi * (np.arange(teeth) - (teeth - 1) // 2)
        bulges = np.tile(bends, teeth)[:-1]
        return Polyline(module * (places[:, None] + tooth).ravel(), bulges, is_closed=False)


def transverse_factors(pressure_angle: float, helix_angle_deg: float) -> tuple[float, float, float]:
    """Pressure angle, rad, and what lengths in modules and radii of roundings are to be multiplied by."""
    ratio = float(np.cos(np.radians(helix_angle_deg)))
    angle = float(np.arctan(np.tan(pressure_angle) / ratio))
    return angle, ratio, ratio * float((1 - np.sin(pressure_angle)) / (1 - np.sin(angle)))


@checked
def undercut_free_shift(teeth: Count, rack: RackCutter | None = None) -> float:
    """The least profile shift, 0 or more, modules, with which a rack does not undercut a gear of `teeth` teeth.

    The end of the rack's straight flank must meet the line of action outside the base circle: h - z sin^2(alpha) / 2
    for a flank that is straight down to h below the reference line (Colbourne, The Geometry of Involute Gears).
    """
    rack = RackCutter() if rack is None else rack
    least = rack.flank_depth - teeth / 2 * float(np.sin(rack.pressure_angle)) ** 2
    # Just beyond the limit, where rounding cannot call it undercut.
    return max(0.0, least + 1e-12 * (1 + abs(least)))


@checked
def balanced_shifts(
    first: Teeth, second: Teeth, rack: RackCutter | None = None, total: Total = 0.0
) -> tuple[float, float]:
    """Profile shifts, modules, of a pair of spur gears whose flanks slide equally at the two ends of contact.

    first, second: numbers of teeth; total: sum of the shifts; 0 keeps the centre distance of gears without.
    The largest specific sliding of each gear, at the tips of the other, becomes the same. Teeth reach the
    rack's addendum above their shifted reference lines; a fillet_radius of the rack is left out. Derived here. Raises
    DesignError where tips of either gear meet
    the line of action outside the base circles whatever the shifts.
    """
    rack = RackCutter() if rack is None else rack
    slope = float(np.tan(rack.pressure_angle))
    base_1, base_2 = (z / 2 * float(np.cos(rack.pressure_angle)) for z in (first, second))
    angle = involute_function(slope) + 2 * slope * total / (first + second)
    if angle <= 0:
        raise DesignError("total", f"found {total:g}, with which the teeth cannot mesh", "give more")
    between = (base_1 + base_2) * inverse_involute(angle)

    def ends(x: float) -> tuple[float, float]:
        """Lengths of the line of action left of the ends of contact, beside each base circle; negative outside."""
        tips = (
            base * roll_at(z / 2 + rack.addendum + shift, base)
            for z, base, shift in ((first, base_1, x), (second, base_2, total - x))
        )
        reach_1, reach_2 = tips
        return between - reach_2, between - reach_1

    def excess(x: float) -> float:
        """Positive where the first gear slides more: its sliding is 1 - (z1 / z2) (between - s) / s at s."""
        one, two = ends(x)
        if one <= 0 or two <= 0:
            return float(np.sign(two - one))
        return first / second * (between - one) / one - second / first * (between - two) / two

    low, high = LEAST, MOST
    for _ in range(100):
        middle = 0.5 * (low + high)
        # More shift of the first takes its contact away from its base circle.
        low, high = (middle, high) if excess(middle) > 0 else (low, middle)
    x = 0.5 * (low + high)
    if min(ends(x)) <= 0 or not LEAST + 1e-6 < x < MOST - 1e-6:
        raise DesignError(
            "teeth",
            f"found {first} and {second}: at no profile shifts both gears keep contact outside their base circles",
            "give more teeth, a smaller addendum or a larger total",
        )
    return x, total - x
