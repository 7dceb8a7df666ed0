"""Two gears in mesh: centre distance, contact, sliding, backlash, clearances and interference."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any, Literal, Self

import numpy as np

from ..core.arguments import FloatOrNan, checked
from ..core.errors import DesignError
from ..core.fields import entry, last_fit, moving_picture, quantity, rounded_up
from ..core.records import record
from ..core.units import bare_mm, mm
from ..plane.roulettes import inverse_involute, involute_function
from ..plane.vec import Pose, Real
from .contract import check_alike
from .cutters import Settled
from .interference import PairInterference
from .ring import RingGear
from .spur import SpurGear

# Least overlap of tip and tooth that counts, modules: smaller ones are errors of the sampled paths.
LEAST_OVERLAP = 1e-5


@record(eq=False)
class MeshGeometry:
    """Two gears in mesh at any centre distance.

    Parameters
    ----------
    first : SpurGear
        The driving gear.
    second : SpurGear or RingGear
        The driven gear.
    """

    first: SpurGear
    second: SpurGear | RingGear

    @property
    def teeth(self) -> int:
        """Sum of the numbers of teeth; their difference for a ring."""
        return self.second.teeth - self.first.teeth if self.second.is_ring else self.second.teeth + self.first.teeth

    @property
    def shift(self) -> float:
        """Sum of the profile shifts, modules; their difference for a ring."""
        x1, x2 = self.first.profile_shift, self.second.profile_shift
        return x2 - x1 if self.second.is_ring else x1 + x2

    @property
    def base_distance(self) -> float:
        """Centre distance for a working pressure angle of 0, mm: sum or difference of the base radii."""
        return self.teeth * self.first.base_radius / self.first.teeth

    def tight_involute(self, tooth_thickness_allowance: float) -> float:
        """Involute function of the working pressure angle without backlash, for the sum of both allowances, mm."""
        slope, sign = np.tan(self.first.pressure_angle), 1 if self.second.is_ring else -1
        apart = 2 * slope * self.shift + sign * tooth_thickness_allowance / self.first.module
        return involute_function(slope) + float(apart) / self.teeth

    def distance_of(self, involute: float) -> float:
        """Centre distance, mm, for the involute function of the working pressure angle."""
        return self.base_distance * float(np.hypot(1, inverse_involute(involute)))

    def line_of_action(self, distance: float) -> float:
        """Length of the line of action between the base circles, mm, for a centre distance."""
        return float(np.sqrt(max(distance**2 - self.base_distance**2, 0.0)))

    def contact_lengths(self, distance: float) -> tuple[float, float]:
        """Start and end of the path of contact, mm from the first gear's base circle, for a centre distance."""
        between, is_ring = self.line_of_action(distance), self.second.is_ring
        start, end = self.first.flank_lengths
        low, high = (s - between if is_ring else between - s for s in self.second.flank_lengths)
        return max(start, min(low, high)), min(end, max(low, high))

    def contact_ratio(self, distance: float) -> float:
        """Contact ratio for a centre distance; 0 or less if no flanks meet."""
        start, end = self.contact_lengths(distance)
        return (end - start) / self.first.base_pitch


@record(checked=True)
class GearPair:
    """A spur gear and the spur gear or ring gear that it drives.

    Parameters
    ----------
    first : SpurGear
        The driving gear, about the origin.
    second : SpurGear or RingGear
        The driven gear, with the same module and pressure angle.
    centre_distance : float, optional
        Distance of the axes, mm; by default the one at which teeth without thickness allowance have no backlash.

    Raises
    ------
    DesignError
        If modules or pressure angles differ, the teeth jam, or no flanks are in contact.

    See Also
    --------
    SpurGear, RingGear, gear_train

    Notes
    -----
    Lengths along the line of action are measured from the first gear's base circle. Centre distance, contact ratio and
    specific sliding as in ISO 21771 and DIN 3960.

    Examples
    --------
    >>> pair = gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(40, 2))
    >>> round(pair.centre_distance, 9), round(pair.contact_ratio, 4)
    (60.0, 1.6352)
    """

    # Names of the two gears in tables.
    names = "first", "second"

    first: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    second: SpurGear | RingGear = entry("the driven gear", example=SpurGear(40, 2))
    centre_distance: Settled = quantity("distance of the axes", "mm", default=None, above=0, at_most=1e9)

    _repr_html_ = moving_picture

    def __post_init__(self) -> None:
        first, second = self.first, self.second
        tool, name = "cutter" if self.is_internal else "rack", self.names[1]
        check_alike(first, second.module, second.pressure_angle, name, tool)
        if self.is_internal and second.teeth <= first.teeth:
            problem = f"found a ring of {second.teeth} teeth for a gear of {first.teeth}"
            raise DesignError(f"{name}.teeth", problem, f"give at least {first.teeth + 1}")
        if self.centre_distance is None:
            object.__setattr__(self, "centre_distance", self.tight_distance)
        else:
            self._check_distance()
        start, end = self.contact_lengths
        if end <= start:
            raise _too_far(self._geometry, self.centre_distance, self.tight_distance)

    @property
    def is_internal(self) -> bool:
        """Whether the second gear is a ring round the first."""
        return self.second.is_ring

    @property
    def driver(self) -> SpurGear:
        """The driving gear: the first."""
        return self.first

    @property
    def driven(self) -> SpurGear | RingGear:
        """The driven gear: the second."""
        return self.second

    @property
    def module(self) -> float:
        """Module of both gears, mm."""
        return self.first.module

    @property
    def ratio(self) -> float:
        """Rotations of the first gear for one of the second; negative if they turn in opposite directions."""
        return self.second.teeth / self.first.teeth * (1 if self.is_internal else -1)

    @property
    def tight_distance(self) -> float:
        """Centre distance at which teeth without thickness allowance have no backlash, mm."""
        angle = self._geometry.tight_involute(0.0)
        if angle < 0:
            x1, x2, slope = self.first.profile_shift, self.second.profile_shift, np.tan(self.first.pressure_angle)
            least = -involute_function(slope) * self._geometry.teeth / (2 * slope)
            problem = f"found {x2:g} with {x1:g} for the driving gear: the teeth mesh at no centre distance"
            remedy = f"give {_nearest_shift(self.first, self.second, least + x2 - self._geometry.shift)}"
            raise DesignError(f"{self.names[1]}.profile_shift", problem, remedy)
        return self._geometry.distance_of(angle)

    @property
    def shift_without_backlash(self) -> float:
        """Sum of the profile shifts, modules, for which the teeth have no backlash at the centre distance.

        Of a ring, its shift minus that of the pinion. Thickness allowances are not included.
        """
        slope, working = np.tan([self.first.pressure_angle, self.working_pressure_angle])
        return float((involute_function(working) - involute_function(slope)) * self._geometry.teeth / (2 * slope))

    @cached_property
    def _geometry(self) -> MeshGeometry:
        return MeshGeometry(self.first, self.second)

    @property
    def working_pressure_angle(self) -> float:
        """Working pressure angle: the angle of the line of action, rad."""
        return float(np.arctan2(self.line_of_action, self._geometry.base_distance))

    @property
    def working_radii(self) -> tuple[float, float]:
        """Radii of the working pitch circles, which roll on each other, mm."""
        per_tooth = self.centre_distance / self._geometry.teeth
        return per_tooth * self.first.teeth, per_tooth * self.second.teeth

    @cached_property
    def contact_lengths(self) -> tuple[float, float]:
        """Start and end of the path of contact on the line of action, mm from the first gear's base circle."""
        return self._geometry.contact_lengths(self.centre_distance)

    @property
    def contact_ratio(self) -> float:
        """Contact ratio: mean number of tooth pairs in contact. Below 1 the motion is not transmitted continuously."""
        start, end = self.contact_lengths
        return (end - start) / self.first.base_pitch

    @checked
    def sliding(self, along: FloatOrNan) -> tuple[Real, Real]:
        """Specific sliding of both gears at points on the line of action.

        Parameters
        ----------
        along : float or array_like
            Lengths on the line of action, mm from the first gear's base circle, any shape.

        Returns
        -------
        tuple of ndarray
            Specific sliding of the first and the second gear: sliding speed over the speed of the contact point along
            the gear's flank. It is 0 at the pitch point, negative if the gear's flank is slower than its mate's, and
            -inf at the gear's base circle.
        """
        s1 = np.asarray(along, dtype=float)
        # Speeds along the flanks, divided by the angular velocity of the first gear.
        between = self.line_of_action
        across = s1 + between if self.is_internal else between - s1
        v1, v2 = s1, across * self.first.teeth / self.second.teeth
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return (v1 - v2) / v1, (v2 - v1) / v2

    @property
    def backlash(self) -> float:
        """Backlash along the working pitch circles, mm."""
        r1, r2 = self.working_radii
        return 2 * np.pi * r1 / self.first.teeth - self.first.thickness(r1) - self.second.thickness(r2)

    @property
    def clearances(self) -> tuple[float, float]:
        """Tip clearances at the root of the first and of the second gear, mm."""
        a, first, second = self.centre_distance, self.first, self.second
        if self.is_internal:
            return second.tip_radius - a - first.root_radius, second.root_radius - a - first.tip_radius
        return a - second.tip_radius - first.root_radius, a - first.tip_radius - second.root_radius

    def with_full_clearance(self) -> Self:
        """The pair with tips shortened where they come closer to the mate's roots than the clearance of its tool.

        Returns
        -------
        GearPair
            At the same centre distance. The clearance of a rack is its dedendum less its addendum; at the roots of a
            ring it is that of the pinion's rack.

        Notes
        -----
        Without backlash this is the tip alteration k = y - x1 - x2 of ISO 21771, with y the change of the centre
        distance in modules.

        Examples
        --------
        >>> pair = gk.GearPair(gk.SpurGear(12, 3, 0.6), gk.SpurGear(24, 3, 0.36)).with_full_clearance()
        >>> round(2 * pair.first.tip_radius, 3)
        44.84
        """
        first, second = self.first, self.second
        racks = first.rack, second.rack if isinstance(second, SpurGear) else first.rack
        # Lengths by which tips are too long: of the second gear's at the first gear's roots, and of the first's.
        of_second, of_first = (
            max(rack.dedendum - rack.addendum - room / self.module, 0.0) for rack, room in zip(racks, self.clearances)
        )
        gears: list[Any] = []
        for name, gear, by in zip(self.names, (first, second), (of_first, of_second)):
            try:
                gears.append(gear.shortened(by))
            except DesignError as error:
                raise DesignError(f"{name}.{error.field}", error.problem, error.remedy, error.id) from None
        return replace(self, first=gears[0], second=gears[1])

    @cached_property
    def interference(self) -> PairInterference:
        """Distances of the teeth from each other outside the contact."""
        return PairInterference(
            self.first, self.second, self.centre_distance, self.line_of_action, self.ratio, self.poses
        )

    @property
    def interferences(self) -> tuple[str, ...]:
        """Interferences: `first root`, `second root`, `involute`, `trochoid` and `trimming`, or none.

        The roots of an external pair include the flanks next to them. Tips of an internal pair that dig into flanks as
        they leave the spaces have trochoid interference. Trimming prevents radial assembly, but not the motion.
        """
        limit = -LEAST_OVERLAP * self.first.module
        # The flanks of an internal pair are only reached by tips that leave the spaces.
        margins = self.interference
        roots, flanks = zip(*margins.of_tips) if self.is_internal else (margins.tip_margins, (np.inf, np.inf))
        interferences = {
            f"{self.names[0]} root": roots[0] < limit or self.clearances[0] < 0,
            f"{self.names[1]} root": roots[1] < limit or self.clearances[1] < 0,
            # Undercut has removed the material that such a tip would hit.
            "involute": margins.involute_margin < limit and not self.first.is_undercut,
            "trochoid": margins.trochoid_margin < 0 or min(flanks) < limit,
            "trimming": margins.trimming_margin < 0,
        }
        return tuple(name for name, occurs in interferences.items() if occurs)

    @checked
    def poses(self, turn: FloatOrNan) -> tuple[Pose, Pose]:
        """Poses of both gears at rotations of the first.

        Parameters
        ----------
        turn : float or array_like
            Rotations of the first gear, rad, any shape; at 0 it has a tooth on +y.

        Returns
        -------
        tuple of Pose
            The first gear about the origin, and the second. The contact is on +y of the first: the axis of a spur gear
            is above, that of a ring below. Teeth are in the middle of the spaces of the other gear, so both sides have
            half the backlash.
        """
        t = np.asarray(turn, dtype=float)
        second_turn, half = t / self.ratio, np.pi / self.second.teeth
        side = -1j if self.is_internal else 1j
        second = np.exp(1j * (second_turn + half + (0 if self.is_internal else np.pi)))
        return Pose(np.zeros(t.shape, complex), np.exp(1j * t)), Pose(
            np.full(t.shape, side * self.centre_distance), second
        )

    @checked
    def sensitivity(
        self,
        of: Literal["contact_ratio", "backlash"],
        by: Literal["centre_distance", "first.profile_shift", "second.profile_shift"],
    ) -> float:
        """Derivative of the contact ratio or of the backlash by a size, the others unchanged, exact to rounding.

        Parameters
        ----------
        of : {"contact_ratio", "backlash"}
            The quantity.
        by : {"centre_distance", "first.profile_shift", "second.profile_shift"}
            The size. Profile shifts count at this centre distance, also if it was not given.

        Returns
        -------
        float
            The quantity's unit per mm of distance or per module of shift. nan for the contact ratio by a shift if
            contact ends where the tooth's tip is rounded, chamfered or cut, or its root is undercut.

        Notes
        -----
        Derived here from the formulas of ISO 21771.

        Examples
        --------
        >>> pair = gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(40, 2), centre_distance=60.1)
        >>> round(pair.sensitivity("backlash", by="centre_distance"), 4)
        0.7395
        """
        distance, between, sign = self.centre_distance, self.line_of_action, -1 if self.is_internal else 1
        if of == "backlash":
            if by == "centre_distance":
                return self.backlash / distance + sign * 2 * between / self._geometry.base_distance
            # The sum of both teeth's thickness grows with both shifts; that of a ring's tooth falls with its shift.
            slope = 4 * float(np.tan(self.first.pressure_angle)) * distance / self._geometry.teeth
            return slope if self.is_internal and by == "second.profile_shift" else -slope
        return (_end_rate(self, 1, by) - _end_rate(self, 0, by)) / self.first.base_pitch

    @property
    def line_of_action(self) -> float:
        """Length of the line of action between both base circles, mm."""
        return self._geometry.line_of_action(self.centre_distance)

    def _check_distance(self) -> None:
        """Raise DesignError if the teeth jam."""
        tight = self._distance_of_backlash()
        jams = self.centre_distance > tight if self.is_internal else self.centre_distance < tight
        if self.centre_distance < self._geometry.base_distance or (
            jams and abs(self.centre_distance - tight) > 1e-9 * tight
        ):
            most = f"from {bare_mm(self._geometry.base_distance):up} to {mm(tight):down}"
            # The tolerance keeps rounding from adding a digit.
            least = f"at least {mm(tight * (1 - 1e-12)):up}"
            problem = f"found {mm(self.centre_distance):g}, at which the teeth jam"
            raise DesignError("centre_distance", problem, f"give {most if self.is_internal else least}")

    def _distance_of_backlash(self) -> float:
        """Centre distance at which the teeth, with their thickness allowance, have no backlash, mm."""
        tooth_thickness_allowance = self.first.tooth_thickness_allowance + self.second.tooth_thickness_allowance
        if tooth_thickness_allowance == 0:
            return self.tight_distance
        return self._geometry.distance_of(max(self._geometry.tight_involute(tooth_thickness_allowance), 0.0))


@record
class InternalGearPair(GearPair):
    """A pinion and the ring that it drives: a `GearPair` whose gears are named pinion and ring.

    Parameters
    ----------
    first : SpurGear
        The pinion, about the origin.
    second : RingGear
        The ring, with the same module and pressure angle.
    centre_distance : float, optional
        As of `GearPair`.

    Examples
    --------
    >>> pair = gk.gear.InternalGearPair(gk.SpurGear(20, 2), gk.RingGear(60, 2, addendum=0.8))
    >>> pair.ratio, pair.interferences
    (3.0, ())
    """

    names = "pinion", "ring"

    second: RingGear = entry("the ring", example=RingGear(60, 2, addendum=0.8))


def _flank_rate(gear: SpurGear | RingGear, length: float) -> float:
    """Derivative by the profile shift of the tangent length to an end of the flank, mm per module; nan if unknown."""
    tip = gear.tip_radius
    # The tip circle of a tooth that is cut where it is pointed does not move by the shift.
    if gear.tip_thickness > 1e-9 * gear.module and np.isclose(
        np.hypot(length, gear.base_radius), tip, rtol=1e-13, atol=0
    ):
        return tip * gear.module / length
    if not gear.is_ring and length == gear.flank_lengths[0] and not gear.is_undercut:
        # The straight flank of the rack ends here, and the shift moves it across.
        return gear.module / float(np.sin(gear.pressure_angle))
    return float("nan")


def _end_rate(pair: GearPair, which: int, by: str) -> float:
    """Derivative by a size of the start (0) or the end (1) of the path of contact, mm per mm or module."""
    sign, mates = -1 if pair.is_internal else 1, pair.second.flank_lengths
    of_mate = mates[which if pair.is_internal else 1 - which]
    # The flank that ends first is that of the gear or of its mate.
    if pair.contact_lengths[which] == pair.first.flank_lengths[which]:
        return _flank_rate(pair.first, pair.first.flank_lengths[which]) if by == "first.profile_shift" else 0.0
    if by == "centre_distance":
        return sign * pair.centre_distance / pair.line_of_action
    return -sign * _flank_rate(pair.second, of_mate) if by == "second.profile_shift" else 0.0


def _nearest_shift(first: SpurGear, second: SpurGear | RingGear, least: float) -> str:
    """A remedy: the least profile shift of the second gear, above a lower bound, for which flanks meet."""

    def meets(shift: float) -> bool:
        try:
            return GearPair(first, replace(second, profile_shift=shift)).contact_ratio > 0
        except DesignError:
            return False

    # At the bound itself the line of action has no length, and rounding would decide.
    least += 1e-9
    for step in np.arange(0.05, 2, 0.05).tolist():
        if meets(least + step):
            return f"at least {rounded_up(last_fit(meets, least + step, least))}"
    return "a larger shift, or other numbers of teeth"


def _too_far(geometry: MeshGeometry, distance: float, tight: float) -> DesignError:
    """For a distance at which no flanks meet; the remedy is the nearest one with a contact ratio of 1."""
    problem, good = f"found {mm(distance):.7g}, at which no flanks meet", tight
    if abs(good - distance) <= 1e-9 * good or geometry.contact_ratio(good) <= 1:
        return DesignError("centre_distance", problem, "give gears with taller teeth or other profile shifts")
    good = last_fit(lambda value: geometry.contact_ratio(value) >= 1, good, distance)
    limit = f"at least {mm(good):up}" if distance < good else f"at most {mm(good):down}"
    return DesignError("centre_distance", problem, f"give {limit}, where the contact ratio is 1")
