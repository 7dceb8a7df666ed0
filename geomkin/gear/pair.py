"""Two gears in mesh: distance, contact, sliding, backlash and what keeps clear of what."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from ..core.arguments import RealsOrNan, checked
from ..core.errors import DesignError
from ..core.fields import entry, last_fit, quantity, rounded_down, rounded_up
from ..core.records import record
from ..core.reprs import moving
from ..model.table import Column, Table
from ..plane.roulettes import inverse_involute, involute_function
from ..plane.vec import Pose, Real
from .contract import check_alike
from .interference import InternalMesh, tip_margin
from .module import Settled
from .rack import RackPair
from .ring import RingGear
from .spur import SpurGear

# Overlap of tip and tooth, modules, that counts: below it is the rounding of the sampled paths.
SEEN = 1e-5


@record(checked=True)
class GearPair:
    """A spur gear, and a spur gear or a ring gear that it drives.

    centre_distance: mm; left out, the one at which teeth that are not thinned have no backlash. Lengths along
    the line of action are measured from the first gear's base circle. Distance, contact ratio and specific sliding as
    in ISO 21771 and DIN 3960.
    Raises DesignError where modules or pressure angles differ, the teeth jam, or no flanks meet.
    """

    # What tables call the two.
    names = "first", "second"

    first: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    second: SpurGear | RingGear = entry("the driven gear", example=SpurGear(40, 2))
    centre_distance: Settled = quantity("distance of the axes", "mm", default=None, above=0, at_most=1e9)

    _repr_html_ = moving

    def __post_init__(self) -> None:
        first, second = self.first, self.second
        tool = "cutter" if self.is_internal else "rack"
        check_alike(first, second.module, second.pressure_angle, "second", tool)
        if self.is_internal and second.teeth <= first.teeth:
            raise DesignError(
                "second.teeth",
                f"found a ring of {second.teeth} teeth around {first.teeth}",
                f"give at least {first.teeth + 1}",
            )
        if self.centre_distance is None:
            object.__setattr__(self, "centre_distance", self.tight_distance)
        else:
            self._check_distance()
        start, end = self.contact_lengths
        if end <= start:
            raise DesignError("centre_distance", *self._too_far())

    @property
    def is_internal(self) -> bool:
        """Whether the second gear is a ring around the first."""
        return self.second.is_ring

    @property
    def driver(self) -> SpurGear:
        """The gear that drives: the first."""
        return self.first

    @property
    def module(self) -> float:
        """Pitch diameter per tooth of both, mm."""
        return self.first.module

    @property
    def ratio(self) -> float:
        """Turns of the first for one of the second; negative where they turn against each other."""
        return self.second.teeth / self.first.teeth * (1 if self.is_internal else -1)

    @property
    def tight_distance(self) -> float:
        """Centre distance, mm, at which teeth that are not thinned have no backlash."""
        angle = self._tight_involute(0.0)
        if angle < 0:
            x1, x2, slope = self.first.profile_shift, self.second.profile_shift, np.tan(self.first.pressure_angle)
            least = -involute_function(slope) * self._teeth / (2 * slope)
            raise DesignError(
                "second.profile_shift",
                f"found {x2:g} with {x1:g}: no distance brings the teeth together",
                f"give {self._nearest_shift(least + x2 - self._shift)}",
            )
        return self._base_distance * float(np.hypot(1, inverse_involute(angle)))

    @property
    def _shift(self) -> float:
        """Profile shifts, modules, that bring the axes apart."""
        x1, x2 = self.first.profile_shift, self.second.profile_shift
        return x2 - x1 if self.is_internal else x1 + x2

    def _tight_involute(self, tooth_thickness_allowance: float) -> float:
        """Involute function of the working pressure angle, rad, without backlash; tooth_thickness_allowance: of both
        teeth, mm.
        """
        slope, sign = np.tan(self.first.pressure_angle), 1 if self.is_internal else -1
        apart = 2 * slope * self._shift + sign * tooth_thickness_allowance / self.first.module
        return involute_function(slope) + float(apart) / self._teeth

    def _nearest_shift(self, least: float) -> str:
        """The least profile shift of the second gear, beyond one that brings the teeth together, with contact."""

        def meets(shift: float) -> bool:
            try:
                return GearPair(self.first, replace(self.second, profile_shift=shift)).contact_ratio > 0
            except DesignError:
                return False

        # At the very least there is no line of action yet, and rounding decides on which side of it a shift lies.
        least += 1e-9
        for step in np.arange(0.05, 2, 0.05).tolist():
            if meets(least + step):
                return f"at least {rounded_up(last_fit(meets, least + step, least))}"
        return "more, or gears of other numbers of teeth"

    @property
    def working_pressure_angle(self) -> float:
        """Angle of the line of action, rad."""
        return float(np.arctan2(self._between(self.centre_distance), self._base_distance))

    @property
    def working_radii(self) -> tuple[float, float]:
        """Radii of the circles that roll on each other, mm."""
        one = self.centre_distance / self._teeth
        return one * self.first.teeth, one * self.second.teeth

    @cached_property
    def contact_lengths(self) -> tuple[float, float]:
        """Where contact begins and ends on the line of action, mm: both true flanks must reach it."""
        return self._contact_at(self.centre_distance)

    @property
    def contact_ratio(self) -> float:
        """Mean number of tooth pairs in contact; below 1 the drive is passed on in jerks."""
        start, end = self.contact_lengths
        return (end - start) / self.first.base_pitch

    @checked
    def sliding(self, along: RealsOrNan) -> tuple[Real, Real]:
        """Specific sliding of the first and of the second gear at places on the line of action, mm, any shape.

        Sliding speed over the speed of a gear's own contact point along its flank; 0 where the pitch circles
        touch, negative where a gear's flank is slower than its mate's; -inf at its own base circle.
        """
        s1 = np.asarray(along, dtype=float)
        # Speeds along the flanks over the first gear's speed.
        between = self._between(self.centre_distance)
        across = s1 + between if self.is_internal else between - s1
        v1, v2 = s1, across * self.first.teeth / self.second.teeth
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return (v1 - v2) / v1, (v2 - v1) / v2

    @property
    def backlash(self) -> float:
        """Play between the teeth along the working pitch circles, mm."""
        r1, r2 = self.working_radii
        return 2 * np.pi * r1 / self.first.teeth - self.first.thickness(r1) - self.second.thickness(r2)

    @property
    def clearances(self) -> tuple[float, float]:
        """From the tips of the second to the root of the first, and of the first to the second's, mm."""
        a, one, two = self.centre_distance, self.first, self.second
        if self.is_internal:
            return two.tip_radius - a - one.root_radius, two.root_radius - a - one.tip_radius
        return a - two.tip_radius - one.root_radius, a - one.tip_radius - two.root_radius

    @cached_property
    def tip_margins(self) -> tuple[float, float]:
        """How near the tips of the second come to the teeth of the first, and the first's to the second's, mm.

        Along circles, over the whole way of a tip through the space; 0 where a tip touches a flank as it should,
        negative where it digs into a root or a tooth. Seen to a hundred-thousandth of a module.
        """
        first, second, distance = self.first, self.second, self.centre_distance
        return (
            tip_margin(second, first, distance, lambda turn: self.poses(turn * self.ratio)[::-1]),
            tip_margin(first, second, distance, self.poses),
        )

    @property
    def involute_margin(self) -> float:
        """How far outside the end of the first's involute the second's tips meet the line of action, mm.

        Negative: involute interference, where the first's roots are not cut deep enough.
        """
        tip = self.second.flank_lengths[0 if self.is_internal else 1]
        return self._along(tip, self._between(self.centre_distance))

    @property
    def trochoid_margin(self) -> float:
        """Angle, rad on the first, by which the tips of an internal pair pass each other outside the contact."""
        return self._internal.trochoid_gap if self.is_internal else float("inf")

    @property
    def trimming_margin(self) -> float:
        """Angle, rad on the first, by which it clears the ring's tips when put in along a radius."""
        return self._internal.trimming_gap if self.is_internal else float("inf")

    @property
    def interferences(self) -> tuple[str, ...]:
        """What hits: `first root`, `second root` (or tooth), `involute`, `trochoid`, `trimming`; empty where nothing.

        Trimming keeps a pinion from being put in along a radius; it does not hinder the motion.
        """
        limit = -SEEN * self.first.module
        found = {
            "first root": self.tip_margins[0] < limit or self.clearances[0] < 0,
            "second root": self.tip_margins[1] < limit or self.clearances[1] < 0,
            # Undercut has taken away what such a tip would hit.
            "involute": self.involute_margin < limit and not self.first.is_undercut,
            "trochoid": self.trochoid_margin < 0,
            "trimming": self.trimming_margin < 0,
        }
        return tuple(name for name, hit in found.items() if hit)

    @checked
    def poses(self, turn: RealsOrNan) -> tuple[Pose, Pose]:
        """Where the gears stand when the first, about the origin, has turned by `turn`, rad, any shape.

        The contact lies on +y of the first: a spur gear stands above it, a ring's axis below. The teeth
        of each stand in the middle of the other's spaces, so backlash is shared by both sides.
        """
        t = np.asarray(turn, dtype=float)
        turned, half = t / self.ratio, np.pi / self.second.teeth
        where = -1j if self.is_internal else 1j
        second = np.exp(1j * (turned + half + (0 if self.is_internal else np.pi)))
        return Pose(np.zeros(t.shape, complex), np.exp(1j * t)), Pose(
            np.full(t.shape, where * self.centre_distance), second
        )

    @property
    def _teeth(self) -> int:
        """Sum of the teeth, or their difference for a ring."""
        return self.second.teeth - self.first.teeth if self.is_internal else self.second.teeth + self.first.teeth

    @property
    def _base_distance(self) -> float:
        """Centre distance at which the line of action would touch both base circles at one place, mm."""
        return self._teeth * self.first.base_radius / self.first.teeth

    def _between(self, distance: float) -> float:
        """Length of the line of action between its base points, mm, at a distance of the axes."""
        return float(np.sqrt(max(distance**2 - self._base_distance**2, 0.0)))

    def _contact_at(self, distance: float) -> tuple[float, float]:
        """`contact_lengths` at any distance of the axes."""
        between = self._between(distance)
        start, end = self.first.flank_lengths
        low, high = (self._along(s, between) for s in self.second.flank_lengths)
        return max(start, min(low, high)), min(end, max(low, high))

    def _along(self, across: float, between: float) -> float:
        """Length from the first gear's base point for one from the second's, mm."""
        return across - between if self.is_internal else between - across

    @property
    def _internal(self) -> InternalMesh:
        one, two = self.first, self.second
        return InternalMesh(
            one.teeth, two.teeth, self.centre_distance, one.tip_radius, two.tip_radius, one.base_radius, two.base_radius
        )

    def _check_distance(self) -> None:
        """The teeth must not jam."""
        tight = self._distance_of_backlash()
        jams = self.centre_distance > tight if self.is_internal else self.centre_distance < tight
        if self.centre_distance < self._base_distance or (jams and abs(self.centre_distance - tight) > 1e-9 * tight):
            most = f"from {rounded_up(self._base_distance)} to {rounded_down(tight)} mm"
            # Rounding of the last bits must not cost a digit.
            least = f"at least {rounded_up(tight * (1 - 1e-12))} mm"
            raise DesignError(
                "centre_distance",
                f"found {self.centre_distance:g} mm, at which the teeth jam",
                f"give {most if self.is_internal else least}",
            )

    def _distance_of_backlash(self) -> float:
        """Centre distance at which the teeth, thinned as they are, have no backlash, mm."""
        tooth_thickness_allowance = self.first.tooth_thickness_allowance + self.second.tooth_thickness_allowance
        if tooth_thickness_allowance == 0:
            return self.tight_distance
        angle = self._tight_involute(tooth_thickness_allowance)
        return self._base_distance * float(np.hypot(1, inverse_involute(max(angle, 0.0))))

    def _too_far(self) -> tuple[str, str]:
        """What is wrong with a distance at which no flanks meet, and the nearest one with a contact ratio of 1."""
        problem = f"found {self.centre_distance:.7g} mm, at which no flanks meet"
        good, bad = self.tight_distance, self.centre_distance
        if abs(good - bad) <= 1e-9 * good or self._ratio_at(good) <= 1:
            return problem, "give gears with taller teeth or other profile shifts"
        good = last_fit(lambda distance: self._ratio_at(distance) >= 1, good, bad)
        way = f"at least {rounded_up(good)}" if bad < good else f"at most {rounded_down(good)}"
        return problem, f"give {way} mm, where the contact ratio is 1"

    def _ratio_at(self, distance: float) -> float:
        """Contact ratio at another distance; 0 or less where no flanks meet."""
        start, end = self._contact_at(distance)
        return (end - start) / self.first.base_pitch


# Places along the path of contact: enough to draw its curves.
ROWS = 101
# Base pitches to either side at which other pairs of flanks are looked for: no gears have as many in contact.
NEIGHBOURS = 9


@checked
def contact_table(pair: GearPair | RackPair) -> Table:
    """Contact of one pair of flanks from its beginning to its end, sliding included."""
    names, gear = pair.names, pair.driver
    start, end = pair.contact_lengths
    along = np.linspace(start, end, ROWS)
    turn = np.degrees((along - np.sqrt(gear.pitch_radius**2 - gear.base_radius**2)) / gear.base_radius)
    first, second = pair.sliding(along)
    # Other pairs of flanks are whole base pitches away.
    other = along[:, None] + gear.base_pitch * np.arange(-NEIGHBOURS, NEIGHBOURS + 1)
    count = ((other >= start - 1e-9) & (other <= end + 1e-9)).sum(axis=1)
    return Table(
        (
            Column(
                f"{names[0]}_turn", "deg", "turn since its pitch circle's flank point was on the line of action", turn
            ),
            Column("along", "mm", f"place on the line of action, from the base circle of the {names[0]}", along),
            Column(f"{names[0]}_radius", "mm", "radius of the contact", np.hypot(gear.base_radius, along)),
            Column(f"{names[0]}_sliding", "", "specific sliding", first),
            Column(f"{names[1]}_sliding", "", "specific sliding", second),
            Column("pairs", "", "pairs of flanks in contact", count),
        )
    )
