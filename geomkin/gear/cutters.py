"""The tools that define a gear's teeth: the rack and how far it is shifted, and the pinion cutter that cuts rings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ..arguments import Count, between, checked, whole_between
from ..cached import cached_property
from ..errors import DesignError
from ..plane.curve import AbstractCurve, Moved
from ..plane.joined import Ring
from ..plane.primitives import Arc, Polyline, Segment
from ..plane.roulettes import Involute, inverse_involute, involute_function, roll_at
from ..plane.vec import Pose
from ..sizes import check_sizes, quantity, rounded_down, rounded_up
from .tooth import TipRounding, largest_rounding, tip_rounding, toothed

# Shifts looked at, modules. Gears outside have neither teeth nor use.
LEAST, MOST = -2.0, 3.0
Teeth = Annotated[int, whole_between(4, 10_000)]
Total = Annotated[float, between(-20, 20, "modules")]


@dataclass(frozen=True)
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

    def edge(self, module: float, teeth: int, thinning: float = 0.0) -> Polyline:
        """Its cutting edge along the x axis from left to right, mm, round so many teeth of what it cuts.

        One of them is centred on +y, the middle one where their number is odd. module: mm. thinning: how much thinner
        they are along the reference line, modules, for which the rack goes to both sides. Open, of straight edges and
        arcs.
        """
        a = self.pressure_angle
        land = self.corner_side + thinning / 2
        top = self.fillet_side - thinning / 2
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
    rack's addendum above their shifted reference lines; a fillet_radius of the rack is left out. Derived here. Raises DesignError where tips of either gear meet
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


@dataclass(frozen=True)
class PinionCutter:
    """An involute gear with cutting edges that cuts internal gears, lengths in modules.

    `addendum` is how far its teeth reach above its reference circle, `tip_radius` the rounding of their
    tips, 0 for sharp. A cutter that has been sharpened has a smaller `profile_shift` than a new one. With a
    `fillet_radius` the roots of its teeth, which then are as deep as the ring's tips ask, round those tips' edges.
    Raises DesignError where its teeth are pointed, or their tips have no room for the rounding.
    """

    teeth: int = quantity("number of the cutter's teeth", whole=True, default=24, at_least=4, at_most=1000)
    pressure_angle_deg: float = quantity("angle of the flanks", "deg", default=20.0, at_least=5, at_most=45)
    addendum: float = quantity(
        "height of the cutter's teeth above its reference circle", "modules", default=1.25, above=0, at_most=5
    )
    tip_radius: float = quantity("rounding of the cutter's tips", "modules", default=0.2, at_least=0)
    profile_shift: float = quantity("profile shift of the cutter", "modules", default=0.0, at_least=-5, at_most=5)
    fillet_radius: float = quantity(
        "fillet at the root of the cutter's teeth, which rounds the ring's tips", "modules", default=0.0, at_least=0
    )

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.outer_radius <= self.base_radius or self._half_angle(self.outer_radius) < 0:
            raise DesignError(
                "addendum",
                f"found {self.addendum:g} with {self.teeth} teeth, whose flanks meet below the tip or never begin",
                self._whole_addendum(),
            )
        largest = largest_rounding(self.base_radius, self.half_angle_at_base, self.outer_radius)
        if self.tip_radius > largest:
            raise DesignError(
                "tip_radius",
                f"found {self.tip_radius:g}, but the cutter's tips have room for {largest:.4g} modules",
                f"give at most {rounded_down(largest)}, or a smaller addendum",
            )

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks at the reference circle, rad."""
        return float(np.radians(self.pressure_angle_deg))

    @property
    def base_radius(self) -> float:
        """Radius of the circle from which its flanks unwind, modules."""
        return self.teeth / 2 * float(np.cos(self.pressure_angle))

    @property
    def outer_radius(self) -> float:
        """Radius of its tips, modules."""
        return self.teeth / 2 + self.addendum + self.profile_shift

    @property
    def half_angle_at_base(self) -> float:
        """Half the angle that a tooth takes on the base circle, rad."""
        a = np.tan(self.pressure_angle)
        return float((np.pi / 2 + 2 * self.profile_shift * a) / self.teeth + involute_function(a))

    @cached_property
    def corner(self) -> TipRounding:
        """The rounding of its tips, modules and rad."""
        return tip_rounding(self.base_radius, self.half_angle_at_base, self.outer_radius, self.tip_radius)

    def fillet(self, root_radius: float) -> TipRounding:
        """The fillet at its roots, modules and rad, where they reach a radius: as its tips' rounding, from outside."""
        return tip_rounding(self.base_radius, self.half_angle_at_base, root_radius, -self.fillet_radius)

    def edge(self, module: float, root_radius: float | None = None) -> Ring:
        """The cutter about its axis, mm, a tooth centred on +y; below its base circle, where it cuts nothing, straight.

        module: mm. root_radius: of its roots, modules, which count where they have a fillet.
        """
        corner, turned = self.corner, np.exp(1j * (np.pi / 2 - self.half_angle_at_base))
        fillet = self.fillet(root_radius) if self.fillet_radius and root_radius else None
        begin = fillet.roll if fillet else 0.0
        flank = Moved(Involute(module * self.base_radius, begin, corner.roll), Pose(0j, turned))
        # Its spaces are as deep as its teeth reach out.
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
        """The addendum with which flanks begin and do not meet, in words, or else what might help."""
        others = "other teeth or profile_shift"
        least = self.base_radius - self.teeth / 2 - self.profile_shift
        if self.half_angle_at_base <= 0:
            return f"give {others}"
        point = self.base_radius * np.hypot(1, inverse_involute(self.half_angle_at_base))
        largest = float(point - self.teeth / 2 - self.profile_shift)
        if largest <= max(least, 0.0) + 1e-5:
            return f"give {others}"
        if self.addendum <= least:
            # A little more, for flanks of some length.
            return f"give at least {rounded_up(least + 1e-6)} modules, or {others}"
        return f"give at most {rounded_down(largest)} modules, or {others}"
