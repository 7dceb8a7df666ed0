"""A pinion that rolls on a rack."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import RealsOrNan, checked
from ..errors import DesignError
from ..plane.pose import Pose
from ..plane.vec import Array
from ..sizes import check_sizes, entry, quantity, rounded_down, rounded_up
from .gear_rack import GearRack
from .spur import SpurGear

# Contact beyond a true flank, modules along the line of action, that counts. The root curve leaves the flank along
# its tangent, so that less digs in by a millionth; the standard tip radius, rounded to 0.38, already reaches so far.
TOUCH = 1e-3


@dataclass(frozen=True)
class RackPair:
    """A spur gear and the rack it drives.

    distance: of the gear's axis from the rack's reference line, mm; left out, the one without backlash, were it
    not for the teeth's thinning. Lengths along the line of action are measured from the gear's base circle.
    """

    pinion: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    rack: GearRack = entry("the rack it drives", example=GearRack(12, 2))
    distance: float = quantity(
        "distance of the gear's axis from the rack's reference line", "mm", default=None, above=0, at_most=1e9
    )

    def __post_init__(self) -> None:
        check_sizes(self)
        pinion, rack = self.pinion, self.rack
        if abs(pinion.module - rack.module) > 1e-9 * pinion.module:
            raise DesignError(
                "rack.module", f"found {rack.module:g} mm beside {pinion.module:g} mm", f"give {pinion.module:.10g}"
            )
        if abs(pinion.pressure_angle - rack.pressure_angle) > 1e-9:
            raise DesignError(
                "rack.rack.pressure_angle_deg",
                f"found {np.degrees(rack.pressure_angle):g} beside {np.degrees(pinion.pressure_angle):g} deg",
                "give both the same",
            )
        tight = pinion.pitch_radius + pinion.module * pinion.profile_shift
        if self.distance is None:
            object.__setattr__(self, "distance", tight)
        if self.backlash < -1e-9 * pinion.module:
            least = self.distance - self.backlash / (2 * np.tan(pinion.pressure_angle))
            raise DesignError(
                "distance",
                f"found {self.distance:g} mm, at which the teeth jam",
                f"give at least {rounded_up(least)} mm",
            )
        start, end = self.contact_lengths
        if end <= start:
            raise DesignError(
                "distance",
                f"found {self.distance:g} mm, at which no flanks meet",
                f"give at most {rounded_down(self._farthest())} mm, where the contact ratio is 1"
                if self._farthest() >= tight
                else "give taller teeth",
            )

    @property
    def module(self) -> float:
        """Pitch per pi of both, mm."""
        return self.pinion.module

    @property
    def travel(self) -> float:
        """Way of the rack for one turn of the pinion, mm."""
        return float(np.pi * self.pinion.module * self.pinion.teeth)

    @property
    def contact_lengths(self) -> tuple[float, float]:
        """Where contact begins and ends on the line of action, mm: both true flanks must reach it."""
        start, end = self.pinion.flank_lengths
        high, deep = self._along(-self.rack.tip_height), self._along(self.rack.form_depth)
        return max(start, high), min(end, deep)

    @property
    def contact_ratio(self) -> float:
        """Mean number of tooth pairs in contact."""
        start, end = self.contact_lengths
        return (end - start) / (self.rack.pitch * float(np.cos(self.pinion.pressure_angle)))

    @checked
    def sliding(self, along: RealsOrNan) -> tuple[Array, Array]:
        """Specific sliding of the pinion and of the rack at places on the line of action, mm, any shape."""
        s = np.asarray(along, dtype=float)
        still = self.pinion.pitch_radius * np.sin(self.pinion.pressure_angle)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return (s - still) / s, (still - s) / still

    @property
    def backlash(self) -> float:
        """Play of the rack along its way, mm."""
        pinion, rack = self.pinion, self.rack
        # The pinion's pitch circle rolls on a line beside the reference line, where the rack's teeth are narrower.
        apart = self.distance - pinion.pitch_radius
        narrower = rack.thickness - 2 * apart * np.tan(pinion.pressure_angle)
        return float(rack.pitch - pinion.thickness(pinion.pitch_radius) - narrower)

    @property
    def clearances(self) -> tuple[float, float]:
        """From the rack's tips to the pinion's root, and from the pinion's tips to the rack's, mm."""
        return (
            self.distance - self.rack.tip_height - self.pinion.root_radius,
            self.distance + self.rack.root_depth - self.pinion.tip_radius,
        )

    @property
    def interferences(self) -> tuple[str, ...]:
        """What hits: `pinion root`, where the rack's tips reach below its true flank, `rack root`, the other way."""
        pinion, limit = self.pinion, TOUCH * self.pinion.module
        start, end = pinion.flank_lengths
        found = {
            # Undercut has taken away what such a tip would hit.
            "pinion root": self.clearances[0] < 0
            or (not pinion.is_undercut and self._along(-self.rack.tip_height) < start - limit),
            "rack root": self.clearances[1] < 0 or self._along(self.rack.form_depth) < end - limit,
        }
        return tuple(name for name, hit in found.items() if hit)

    @checked
    def poses(self, turn: RealsOrNan) -> tuple[Pose, Pose]:
        """Where both stand when the pinion, about the origin, has turned by `turn`, rad, any shape.

        The rack lies below, teeth up, and moves along +x. Teeth stand in the middle of spaces.
        """
        t = np.asarray(turn, dtype=float)
        # A tooth on +y has one opposite where the teeth are even, and there the rack needs a space.
        along = self.pinion.pitch_radius * t + (0.0 if self.pinion.teeth % 2 else self.rack.pitch / 2)
        return Pose(np.zeros(t.shape, complex), np.exp(1j * t)), Pose(
            along - 1j * self.distance, np.ones(t.shape, complex)
        )

    def _along(self, depth: float) -> float:
        """Length on the line of action where it crosses a line of the rack, `depth` below its reference line, mm."""
        below = depth + self.distance - self.pinion.pitch_radius
        a = self.pinion.pressure_angle
        return float(self.pinion.pitch_radius * np.sin(a) + below / np.sin(a))

    def _farthest(self) -> float:
        """Distance at which the contact ratio is 1, mm: the farther the rack, the later contact begins."""
        a = self.pinion.pressure_angle
        start = self.pinion.flank_lengths[1] - self.rack.pitch * np.cos(a)
        room = (start - self.pinion.pitch_radius * np.sin(a)) * np.sin(a)
        return float(self.pinion.pitch_radius + self.rack.tip_height + room)
