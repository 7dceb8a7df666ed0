"""Racks, and pinions that drive them."""

from __future__ import annotations

import numpy as np

from ..core.arguments import FloatOrNan, checked
from ..core.errors import DesignError
from ..core.fields import entry, inside, moving_picture, quantity, rounded_down, rounded_up
from ..core.records import record
from ..core.units import bare_mm, mm
from ..plane.primitives import Polyline
from ..plane.vec import Pose, Real
from .contract import AbstractGear, check_alike
from .cutters import (
    HelixAngle,
    RackCutter,
    Settled,
    diametral_pitch,
    module,
    settle_module,
    thickness_allowance,
    transverse_section,
)
from .spur import SpurGear

# Radius of the corners at the back of the bar, modules: sharp corners cut fingers and chip when dropped.
CORNER = 0.5
# Least contact beyond the end of a flank that counts as interference, modules along the line of action. The root curve
# is tangent to the flank, so with less the overlap is a millionth; the standard tip radius, rounded to 0.38, already
# causes so much.
TOUCH = 1e-3


@record(checked=True)
class GearRack(AbstractGear):
    """A gear rack: a straight bar with teeth on top. The reference line is the x axis, a tooth is centred on +y.

    Parameters
    ----------
    teeth : int
        Number of teeth, 1 to 10,000. The bar ends in the middle of a space on both sides.
    module : float
        Pitch divided by pi, mm, above 0. Give either `module` or `diametral_pitch`.
    rack : RackCutter, optional
        The rack that cuts its mating gears and gives its proportions; by default that of ISO 53.
    height : float, optional
        Height of the bar from its back to the reference line, modules, above 0.
    tooth_thickness_allowance : float, optional
        Reduction of the thickness of each tooth along the reference line, for backlash, mm.
    diametral_pitch : float, optional
        pi teeth per so many inches of length, 1/in.

    Raises
    ------
    DesignError
        If the teeth are pointed, or as deep as the bar is high.

    Notes
    -----
    The teeth are those of a gear with infinitely many teeth: straight flanks, roots with the radius of the cutting
    rack's tips (the basic rack of ISO 53), tips with its fillet_radius.
    """

    pitch_radius = tip_radius = root_radius = float("inf")
    hole_room = 0.0

    teeth: int = quantity("number of teeth", whole=True, at_least=1, at_most=10_000, example=12)
    module: Settled = module("pitch by pi")
    rack: RackCutter = entry("the rack that cuts its mating gears, and gives its proportions", default=RackCutter())
    height: float = quantity(
        "height of the bar from its back to the reference line", "modules", default=5.0, above=0, at_most=1e6
    )
    tooth_thickness_allowance: float = thickness_allowance("reference line")
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        settle_module(self)
        if self.height <= self.rack.dedendum:
            problem = f"found {self.height:g} modules, no more than the teeth are deep"
            remedy = f"give more than {rounded_up(self.rack.dedendum)}"
            raise DesignError("height", problem, remedy, value=inside(self.rack.dedendum, -1))
        if self._tip < 0:
            most = self.tooth_thickness_allowance + 2 * self.module * self._tip
            if most <= 0:
                problem = "the flanks meet below the tips"
                raise DesignError("rack.addendum", problem, "give a rack with a smaller addendum")
            problem = f"found {mm(self.tooth_thickness_allowance):g}, for which the teeth are pointed"
            remedy = f"give at most {bare_mm(float(inside(most, 1, 6))):down6}"
            raise DesignError("tooth_thickness_allowance", problem, remedy, value=inside(most, 1, 6))

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> GearRack:
        """The transverse section of helical teeth whose normal section has these sizes.

        Parameters
        ----------
        helix_angle_deg : float
            Helix angle of the teeth, 0 to 45 deg.

        Returns
        -------
        GearRack
            As for `SpurGear.transverse`.
        """
        return transverse_section(self, helix_angle_deg)

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks, rad."""
        return self.rack.pressure_angle

    @property
    def pitch(self) -> float:
        """Distance of adjacent teeth, mm."""
        return float(np.pi * self.module)

    @property
    def tip_height(self) -> float:
        """Height of the teeth above the reference line, mm."""
        return self.module * self.rack.addendum

    @property
    def root_depth(self) -> float:
        """Depth of the spaces below the reference line, mm."""
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
        """Both ends of the bar along the reference line, mm."""
        first = -((self.teeth - 1) // 2)
        return (first - 0.5) * self.pitch, (first + self.teeth - 0.5) * self.pitch

    @property
    def thickness(self) -> float:
        """Thickness of a tooth along the reference line, mm."""
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
        # The edge runs clockwise, so the order and the signs of the bulges are reversed.
        vertices = np.append(edge.vertices, ends)
        bulges = np.append(np.asarray(edge.bulges), [0, 0, quarter, 0, quarter, 0, 0])
        keep = np.abs(np.roll(vertices, -1) - vertices) > 1e-12 * self.height
        vertices, bulges = vertices[keep], bulges[keep]
        return Polyline(m * vertices[::-1], -np.roll(bulges[::-1], -1))


@record(checked=True)
class RackPair:
    """A spur gear and the rack that it drives.

    Parameters
    ----------
    pinion : SpurGear
        The driving gear, about the origin.
    rack : GearRack
        The driven rack, with the same module and pressure angle.
    distance : float, optional
        Distance of the pinion's axis from the rack's reference line, mm; by default the one at which teeth without
        thickness allowance have no backlash.

    Raises
    ------
    DesignError
        If modules or pressure angles differ, the teeth jam, or no flanks are in contact.

    Notes
    -----
    Lengths along the line of action are measured from the pinion's base circle. Derived here, as the limit of a gear
    pair for an infinite number of teeth.

    Examples
    --------
    >>> pair = gk.gear.RackPair(gk.SpurGear(20, 2), gk.gear.GearRack(12, 2))
    >>> pair.distance
    20.0
    """

    # Names of the two in tables.
    names = "pinion", "rack"

    pinion: SpurGear = entry("the driving gear", example=SpurGear(20, 2))
    rack: GearRack = entry("the driven rack", example=GearRack(12, 2))
    distance: Settled = quantity(
        "distance of the gear's axis from the rack's reference line", "mm", default=None, above=0, at_most=1e9
    )

    _repr_html_ = moving_picture

    def __post_init__(self) -> None:
        pinion = self.pinion
        if self.distance is None:
            object.__setattr__(self, "distance", self._tight_distance)
        check_alike(pinion, self.rack.module, self.rack.pressure_angle, "rack", "rack")
        if self.backlash < -1e-9 * pinion.module:
            least = self.distance - self.backlash / (2 * np.tan(pinion.pressure_angle))
            problem = f"found {mm(self.distance):g}, at which the teeth jam"
            raise DesignError("distance", problem, f"give at least {mm(least):up}", value=rounded_up(least))
        start, end = self.contact_lengths
        if end <= start:
            raise DesignError(
                "distance",
                f"found {mm(self.distance):g}, at which no flanks meet",
                f"give at most {mm(self._farthest()):down}, where the contact ratio is 1"
                if self._farthest() >= self._tight_distance
                else "give taller teeth",
                value=rounded_down(self._farthest()) if self._farthest() >= self._tight_distance else None,
            )

    @property
    def driver(self) -> SpurGear:
        """The driving gear: the pinion."""
        return self.pinion

    @property
    def driven(self) -> GearRack:
        """The rack."""
        return self.rack

    @property
    def _tight_distance(self) -> float:
        return self.pinion.pitch_radius + self.pinion.module * self.pinion.profile_shift

    @property
    def module(self) -> float:
        """Module of both, mm."""
        return self.pinion.module

    @property
    def travel(self) -> float:
        """Displacement of the rack for one rotation of the pinion, mm."""
        return float(np.pi * self.pinion.module * self.pinion.teeth)

    @property
    def contact_lengths(self) -> tuple[float, float]:
        """Start and end of the path of contact on the line of action, mm from the pinion's base circle."""
        start, end = self.pinion.flank_lengths
        high, deep = self._along(-self.rack.form_height), self._along(self.rack.form_depth)
        return max(start, high), min(end, deep)

    @property
    def contact_ratio(self) -> float:
        """Contact ratio: mean number of tooth pairs in contact."""
        start, end = self.contact_lengths
        return (end - start) / (self.rack.pitch * float(np.cos(self.pinion.pressure_angle)))

    @checked
    def sliding(self, along: FloatOrNan) -> tuple[Real, Real]:
        """Specific sliding of pinion and rack at points on the line of action.

        Parameters
        ----------
        along : float or array_like
            Lengths on the line of action, mm from the pinion's base circle, any shape.

        Returns
        -------
        tuple of ndarray
            Specific sliding of the pinion and of the rack, as for `GearPair.sliding`.
        """
        s = np.asarray(along, dtype=float)
        pitch_point = self.pinion.pitch_radius * np.sin(self.pinion.pressure_angle)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return (s - pitch_point) / s, (pitch_point - s) / pitch_point

    @property
    def backlash(self) -> float:
        """Backlash along the rack, mm."""
        pinion, rack = self.pinion, self.rack
        # The pinion's pitch circle rolls on a line above the reference line, where the rack's teeth are narrower.
        apart = self.distance - pinion.pitch_radius
        narrower = rack.thickness - 2 * apart * np.tan(pinion.pressure_angle)
        return float(rack.pitch - pinion.thickness(pinion.pitch_radius) - narrower)

    @property
    def clearances(self) -> tuple[float, float]:
        """Tip clearances at the root of the pinion and of the rack, mm."""
        return (
            self.distance - self.rack.tip_height - self.pinion.root_radius,
            self.distance + self.rack.root_depth - self.pinion.tip_radius,
        )

    @property
    def interferences(self) -> tuple[str, ...]:
        """Interferences: `pinion root`, where the rack's tips reach below the flank, and `rack root`; empty for none.

        Rounded tips of the rack count as sharp.
        """
        pinion, limit = self.pinion, TOUCH * self.pinion.module
        start, end = pinion.flank_lengths
        interferences = {
            # Undercut has removed the material that such a tip would hit.
            "pinion root": self.clearances[0] < 0
            or (not pinion.is_undercut and self._along(-self.rack.tip_height) < start - limit),
            "rack root": self.clearances[1] < 0 or self._along(self.rack.form_depth) < end - limit,
        }
        return tuple(name for name, occurs in interferences.items() if occurs)

    @checked
    def poses(self, turn: FloatOrNan) -> tuple[Pose, Pose]:
        """Poses of pinion and rack at rotations of the pinion.

        Parameters
        ----------
        turn : float or array_like
            Rotations of the pinion, rad, any shape; at 0 it has a tooth on +y.

        Returns
        -------
        tuple of Pose
            The pinion about the origin, and the rack below it, teeth up, which moves along +x. Teeth are in the middle
            of spaces, so both sides have half the backlash.
        """
        t = np.asarray(turn, dtype=float)
        # With an even number of teeth the pinion has a tooth on -y too, where the rack needs a space.
        along = self.pinion.pitch_radius * t + (0.0 if self.pinion.teeth % 2 else self.rack.pitch / 2)
        return Pose(np.zeros(t.shape, complex), np.exp(1j * t)), Pose(
            along - 1j * self.distance, np.ones(t.shape, complex)
        )

    def _along(self, depth: float) -> float:
        """Length on the line of action at a line of the rack, `depth` below its reference line, mm."""
        below = depth + self.distance - self.pinion.pitch_radius
        a = self.pinion.pressure_angle
        return float(self.pinion.pitch_radius * np.sin(a) + below / np.sin(a))

    def _farthest(self) -> float:
        """Distance at which the contact ratio is 1, mm. With a larger distance contact starts later."""
        a = self.pinion.pressure_angle
        start = self.pinion.flank_lengths[1] - self.rack.pitch * np.cos(a)
        room = (start - self.pinion.pitch_radius * np.sin(a)) * np.sin(a)
        return float(self.pinion.pitch_radius + self.rack.form_height + room)
