"""Racks, gears with their axis at infinity, and pinions that roll on them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..core.arguments import RealsOrNan, checked
from ..core.errors import DesignError
from ..core.fields import entry, quantity, rounded_down, rounded_up
from ..core.records import record
from ..core.reprs import moving
from ..plane.primitives import Polyline
from ..plane.vec import Pose, Real
from .contract import AbstractGear, check_alike
from .cutters import HelixAngle, RackCutter
from .module import Settled, diametral_pitch, module, settle_module
from .spur import SpurGear

# Radius of the corners at the back of the bar, modules: sharp ones cut fingers and chip in a drop.
CORNER = 0.5
# Contact beyond a true flank, modules along the line of action, that counts. The root curve leaves the flank along
# its tangent, so that less digs in by a millionth; the standard tip radius, rounded to 0.38, already reaches so far.
TOUCH = 1e-3


@record(checked=True)
class GearRack(AbstractGear):
    """A straight bar with teeth on top; its reference line is the x axis, a tooth is centred on +y.

    The teeth are those that the cutting rack would leave on a gear of infinitely many teeth: straight flanks,
    roots rounded with the radius of the rack's tips (the basic rack of ISO 53), tips with its fillet_radius. The bar
    ends in the middle of a space on both sides. Raises DesignError where the teeth are pointed, or as deep as the bar
    is high.
    """

    pitch_radius = tip_radius = root_radius = float("inf")
    hole_room = 0.0

    teeth: int = quantity("number of teeth", whole=True, at_least=1, at_most=10_000, example=12)
    module: Settled = module("pitch by pi")
    rack: RackCutter = entry("the rack that cuts its mating gears, and gives its proportions", default=RackCutter())
    height: float = quantity(
        "of the bar, from its back to the reference line", "modules", default=5.0, above=0, at_most=1e6
    )
    tooth_thickness_allowance: float = quantity(
        "how much thinner each tooth is along the reference line, for backlash", "mm", default=0.0, at_least=0
    )
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        settle_module(self)
        if self.height <= self.rack.dedendum:
            raise DesignError(
                "height",
                f"found {self.height:g} modules, no more than the teeth are deep",
                f"give more than {self.rack.dedendum:g}",
            )
        if self._tip < 0:
            most = self.tooth_thickness_allowance + 2 * self.module * self._tip
            if most <= 0:
                raise DesignError(
                    "rack.addendum", "the flanks meet below the tips", "give a rack with a smaller addendum"
                )
            raise DesignError(
                "tooth_thickness_allowance",
                f"found {self.tooth_thickness_allowance:g} mm, which points the teeth",
                f"give at most {most * (1 - 1e-5):.6g}",
            )

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> GearRack:
        """The transverse section of helical teeth whose normal section has these sizes, as of a spur gear."""
        ratio = float(np.cos(np.radians(helix_angle_deg)))
        return replace(
            self,
            module=self.module / ratio,
            diametral_pitch=None,
            rack=self.rack.transverse(helix_angle_deg),
            height=self.height * ratio,
        )

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks, rad."""
        return self.rack.pressure_angle

    @property
    def pitch(self) -> float:
        """Distance of neighbouring teeth, mm."""
        return float(np.pi * self.module)

    @property
    def tip_height(self) -> float:
        """Of the teeth above the reference line, mm."""
        return self.module * self.rack.addendum

    @property
    def root_depth(self) -> float:
        """Of the spaces below the reference line, mm."""
        return self.module * self.rack.dedendum

    @property
    def form_depth(self) -> float:
        """Depth below the reference line where the straight flanks end, mm."""
        return self.module * self.rack.flank_depth

    @property
    def form_height(self) -> float:
        """Height above the reference line where the straight flanks end, mm."""
        return self.module * self.rack.flank_height

    @property
    def ends(self) -> tuple[float, float]:
        """Where the bar begins and ends along the reference line, mm."""
        first = -((self.teeth - 1) // 2)
        return (first - 0.5) * self.pitch, (first + self.teeth - 0.5) * self.pitch

    @property
    def thickness(self) -> float:
        """Of a tooth along the reference line, mm."""
        return self.pitch / 2 - self.tooth_thickness_allowance

    @property
    def tip_thickness(self) -> float:
        """Width of a tooth's tip, mm."""
        return 2 * self.module * self._tip

    @property
    def solid_rim(self) -> float:
        """Thickness of the bar under the spaces, mm."""
        return self.module * (self.height - self.rack.dedendum)

    @property
    def _tip(self) -> float:
        """Half the width of a tooth's tip, modules."""
        return self.thickness / self.module / 2 - self.rack.addendum * float(np.tan(self.pressure_angle))

    @property
    def outline(self) -> Polyline:
        """The bar as one closed counterclockwise curve of straight edges and arcs, exact."""
        m, rack = self.module, self.rack
        edge = rack.edge(1.0, self.teeth, self.tooth_thickness_allowance / m)
        deep = -1j * rack.dedendum
        first = -((self.teeth - 1) // 2)
        places = np.pi * (first + np.arange(self.teeth))
        right, left, back = places[-1] + np.pi / 2, places[0] - np.pi / 2, -1j * self.height
        corner = min(CORNER, 0.4 * (self.height - rack.dedendum))
        ends = np.array([right + deep, right + back + 1j * corner, right + back - corner])
        ends = np.append(ends, [left + back + corner, left + back + 1j * corner, left + deep])
        quarter = -np.tan(np.pi / 8)
        # Left to right along the teeth is clockwise: the other way round, with arcs bent the other way.
        vertices = np.append(edge.vertices, ends)
        bulges = np.append(np.asarray(edge.bulges), [0, 0, quarter, 0, quarter, 0, 0])
        keep = np.abs(np.roll(vertices, -1) - vertices) > 1e-12 * self.height
        vertices, bulges = vertices[keep], bulges[keep]
        return Polyline(m * vertices[::-1], -np.roll(bulges[::-1], -1))


@record(checked=True)
class RackPair:
    """A spur gear and the rack it drives.

    distance: of the gear's axis from the rack's reference line, mm; left out, the one at which teeth that are not
    thinned have no backlash. Lengths along the line of action are measured from the gear's base circle. Derived here,
    as the limit of a pair of gears of which one grows.
    Raises DesignError where modules or pressure angles differ, the teeth jam, or no flanks meet.
    """

    # What tables call the two.
    names = "pinion", "rack"

    pinion: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    rack: GearRack = entry("the rack it drives", example=GearRack(12, 2))
    distance: Settled = quantity(
        "distance of the gear's axis from the rack's reference line", "mm", default=None, above=0, at_most=1e9
    )

    _repr_html_ = moving

    def __post_init__(self) -> None:
        pinion = self.pinion
        if self.distance is None:
            object.__setattr__(self, "distance", self._tight_distance)
        check_alike(pinion, self.rack.module, self.rack.pressure_angle, "rack", "rack")
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
                if self._farthest() >= self._tight_distance
                else "give taller teeth",
            )

    @property
    def driver(self) -> SpurGear:
        """The gear that drives: the pinion."""
        return self.pinion

    @property
    def _tight_distance(self) -> float:
        return self.pinion.pitch_radius + self.pinion.module * self.pinion.profile_shift

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
        high, deep = self._along(-self.rack.form_height), self._along(self.rack.form_depth)
        return max(start, high), min(end, deep)

    @property
    def contact_ratio(self) -> float:
        """Mean number of tooth pairs in contact."""
        start, end = self.contact_lengths
        return (end - start) / (self.rack.pitch * float(np.cos(self.pinion.pressure_angle)))

    @checked
    def sliding(self, along: RealsOrNan) -> tuple[Real, Real]:
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
        """What hits: `pinion root`, where the rack's tips reach below its true flank, `rack root`, the other way.

        Rounded tips of the rack count as sharp ones, which reach farther.
        """
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
        return float(self.pinion.pitch_radius + self.rack.form_height + room)
