"""The cutting rack that defines a gear's teeth: its module or diametral pitch, and profile shifts."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Any, TypeVar

import numpy as np

from ..core.arguments import NUMBER, ArgumentType, PositiveInt, between, checked, whole_between
from ..core.errors import DesignError
from ..core.fields import SMALLEST, last_fit, quantity, rounded_down
from ..core.records import record
from ..core.units import INCH, mm
from ..plane.primitives import Polyline
from ..plane.roulettes import inverse_involute, involute_function, roll_at

# Largest module, mm.
LARGEST = 1e5
# A number that may be omitted if it follows from another one; always set in a finished gear.
Settled = Annotated[float, ArgumentType(lambda value: value is None or NUMBER.fits(value), NUMBER.allowed)]


def module(meaning: str = "pitch diameter per tooth", example: float = 2) -> Any:
    """The field for a module; `settle_module` sets it if it is omitted."""
    return quantity(meaning, "mm", default=None, above=0, at_most=LARGEST, example=example)


def diametral_pitch() -> Any:
    """The field for the diametral pitch, an alternative to the module."""
    return quantity("teeth per inch of pitch diameter", "1/in", default=None, above=0, at_most=1e5)


def thickness_allowance(line: str) -> Any:
    """The field by which teeth are thinner along a line, such as "pitch circle", for backlash."""
    meaning = f"reduction of the thickness of each tooth along the {line}, for backlash"
    return quantity(meaning, "mm", default=0.0, at_least=0, printed=0.5)


def settle_module(gear: Any) -> None:
    """Set the module of a gear from its diametral pitch. Raises DesignError if it has neither, or both disagree."""
    if gear.diametral_pitch is None:
        if gear.module is None:
            raise DesignError("module", "found neither module nor diametral_pitch", "give one of them", "missing-key")
        return
    module = INCH / gear.diametral_pitch
    if gear.module is not None and abs(gear.module - module) > 1e-9 * module:
        problem = f"found {mm(gear.module):g}, but a diametral_pitch of {gear.diametral_pitch:g} means {mm(module):.6g}"
        raise DesignError("module", problem, "give one of them", "conflict")
    object.__setattr__(gear, "module", module)
    if not SMALLEST <= module <= LARGEST:
        raise DesignError(
            "diametral_pitch",
            f"found {gear.diametral_pitch:g}, which means a module of {mm(module):.6g}",
            f"give {INCH / LARGEST:g} to 1e5",
            "out-of-range",
            INCH / LARGEST if module > LARGEST else 1e5,
        )


# Range of the search for profile shifts, modules. Gears outside it have no usable teeth.
LEAST, MOST = -2.0, 3.0
Teeth = Annotated[int, whole_between(4, 10_000)]
# Largest helix angle, deg: above it the axial force exceeds the tangential one, and gears become screws.
STEEPEST = 45
HelixAngle = Annotated[float, between(0, STEEPEST, "deg")]
Total = Annotated[float, between(-20, 20, "modules")]
G = TypeVar("G", bound=Any)


@record(checked=True)
class RackCutter:
    """A cutting rack with straight flanks, lengths in modules. The defaults are basic rack profile A of ISO 53.

    Parameters
    ----------
    pressure_angle_deg : float, optional
        Angle of the flanks, 5 to 45 deg.
    addendum : float, optional
        Height of the gear's teeth above the reference line, modules.
    dedendum : float, optional
        Depth that the rack cuts below the reference line, modules.
    tip_radius : float, optional
        Radius of the rack's tip edges, modules, which forms the gear's root.
    fillet_radius : float, optional
        Fillet at the root of the rack's teeth, modules. Such a rack also cuts the gear's tips and rounds their edges.

    Raises
    ------
    DesignError
        If the flanks meet before the tip, or a tip or root has no room for its radius.

    Examples
    --------
    >>> gk.SpurGear(24, 2, rack=gk.gear.RackCutter(pressure_angle_deg=25, tip_radius=0.2)).pressure_angle
    0.4363323129985824
    """

    pressure_angle_deg: float = quantity("angle of the flanks", "deg", default=20.0, at_least=5, at_most=45)
    addendum: float = quantity(
        "height of the gear's teeth above the reference line", "modules", default=1.0, above=0, at_most=5
    )
    dedendum: float = quantity(
        "depth that the rack cuts below the reference line", "modules", default=1.25, above=0, at_most=5
    )
    tip_radius: float = quantity("radius of the rack's tip edges", "modules", default=0.38, at_least=0)
    fillet_radius: float = quantity(
        "fillet at the root of the rack's teeth, which rounds the gear's tips", "modules", default=0.0, at_least=0
    )

    def __post_init__(self) -> None:
        slope = np.radians(self.pressure_angle_deg)
        # The largest radius is reached when the two corners of a tip meet in its middle.
        narrowest = np.pi / 4 - self.dedendum * np.tan(slope)
        if narrowest < 0:
            problem = f"found {self.dedendum:g}, but the rack's flanks meet at {np.pi / 4 / np.tan(slope):.4g} modules"
            remedy = f"give at most {rounded_down(np.pi / 4 / np.tan(slope))}, or a smaller pressure_angle_deg"
            raise DesignError("dedendum", problem, remedy, value=rounded_down(np.pi / 4 / np.tan(slope)))
        largest = narrowest * np.cos(slope) / (1 - np.sin(slope))
        if self.tip_radius > largest:
            problem = f"found {self.tip_radius:g}, but the rack's tip is too narrow for more than {largest:.4g} modules"
            remedy = f"give at most {rounded_down(largest)}, or a smaller dedendum"
            raise DesignError("tip_radius", problem, remedy, value=rounded_down(largest))
        room = max(0.0, np.pi / 4 - self.addendum * np.tan(slope)) * np.cos(slope) / (1 - np.sin(slope))
        if self.fillet_radius > room:
            problem = f"found {self.fillet_radius:g}, but the rack's spaces have room for {room:.4g} modules"
            remedy = f"give at most {rounded_down(room)}, or a smaller addendum"
            raise DesignError("fillet_radius", problem, remedy, value=rounded_down(room))

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks, rad."""
        return float(np.radians(self.pressure_angle_deg))

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> RackCutter:
        """The transverse section of a rack for helical teeth whose normal section has these sizes.

        Parameters
        ----------
        helix_angle_deg : float
            Helix angle of the teeth at the pitch circle, 0 to 45 deg.

        Returns
        -------
        RackCutter
            Heights in mm are unchanged, widths are larger.

        Notes
        -----
        In the transverse section the roundings are ellipses. They are replaced by circles that leave the flanks at the
        same height, so form radius and undercut are exact. For the ISO 53 rack the circles deviate by at most 0.002,
        0.007 and 0.016 modules at 15, 30 and 45 deg (derived here).
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
        """The cutting edge round a number of the gear's teeth, from left to right along the x axis.

        Parameters
        ----------
        module : float
            mm.
        teeth : int
            Number of the gear's teeth. One is centred on +y, the middle one if the number is odd.
        tooth_thickness_allowance : float, optional
            Reduction of the gear's tooth thickness along the reference line, modules; the rack cuts both sides.

        Returns
        -------
        Polyline
            Open, of straight edges and arcs, mm.
        """
        a = self.pressure_angle
        land = self.corner_side + tooth_thickness_allowance / 2
        top = self.fillet_side - tooth_thickness_allowance / 2
        # The right-hand side of one tooth, downwards: end of the tip, both ends of the flank, start of the bottom land.
        flank_start = top + self.fillet_radius * np.cos(a) + 1j * self.flank_height
        flank_end = np.pi / 2 - land - self.tip_radius * np.cos(a) - 1j * self.flank_depth
        side = np.array([top + 1j * self.addendum, flank_start, flank_end, np.pi / 2 - land - 1j * self.dedendum])
        # Bulge of a rounding, whose sweep is the angle from the flank to the land.
        bulge = np.tan((np.pi / 2 - a) / 4)
        side_bulges = np.array([-bulge, 0, bulge])
        # At a sharp corner, flank and land meet.
        first, last = int(self.fillet_radius == 0), 3 - int(self.tip_radius == 0)
        side, side_bulges = side[first : last + 1], side_bulges[first:last]
        tooth_bulges = [*side_bulges[::-1], 0, *side_bulges, 0]
        tooth = np.concatenate([-np.conj(side)[::-1], side])
        centres = np.pi * (np.arange(teeth) - (teeth - 1) // 2)
        bulges = np.tile(tooth_bulges, teeth)[:-1]
        return Polyline(module * (centres[:, None] + tooth).ravel(), bulges, is_closed=False)


def transverse_factors(pressure_angle: float, helix_angle_deg: float) -> tuple[float, float, float]:
    """Transverse pressure angle, rad, and the factors for lengths in modules and for radii of roundings."""
    ratio = float(np.cos(np.radians(helix_angle_deg)))
    angle = float(np.arctan(np.tan(pressure_angle) / ratio))
    return angle, ratio, ratio * float((1 - np.sin(pressure_angle)) / (1 - np.sin(angle)))


def transverse_section(gear: G, helix_angle_deg: float) -> G:
    """The transverse section of helical teeth whose normal section has the sizes of a gear or rack.

    The module grows, fields in modules shrink by the same factor, and the tool is replaced by its transverse section.
    """
    ratio = float(np.cos(np.radians(helix_angle_deg)))
    changes: dict[str, Any] = {"module": gear.module / ratio, "diametral_pitch": None}
    for field in dataclasses.fields(gear):
        value = getattr(gear, field.name)
        if field.metadata.get("unit") == "modules" and value is not None:
            changes[field.name] = value * ratio
        elif hasattr(value, "transverse"):
            changes[field.name] = value.transverse(helix_angle_deg)
    return dataclasses.replace(gear, **changes)


@checked
def undercut_free_shift(teeth: PositiveInt, rack: RackCutter | None = None) -> float:
    """The least profile shift, 0 or more, for which a rack does not undercut a gear.

    Parameters
    ----------
    teeth : int
        Number of teeth of the gear.
    rack : RackCutter, optional
        The cutting rack; by default that of ISO 53.

    Returns
    -------
    float
        Profile shift, modules.

    Notes
    -----
    The end of the rack's straight flank must meet the line of action outside the base circle. For a flank that is
    straight to a depth h below the reference line the shift is h - z sin^2(alpha) / 2 (Colbourne, The Geometry of
    Involute Gears).

    Examples
    --------
    >>> round(gk.gear.undercut_free_shift(12), 4)
    0.2981
    """
    rack = RackCutter() if rack is None else rack
    least = rack.flank_depth - teeth / 2 * float(np.sin(rack.pressure_angle)) ** 2
    # Slightly beyond the limit, so that rounding does not cause undercut.
    return max(0.0, least + 1e-12 * (1 + abs(least)))


@checked
def balanced_shifts(
    first: Teeth, second: Teeth, rack: RackCutter | None = None, total: Total = 0.0
) -> tuple[float, float]:
    """Profile shifts of a pair of spur gears with equal sliding at both ends of contact.

    Parameters
    ----------
    first, second : int
        Numbers of teeth, 4 to 10,000.
    rack : RackCutter, optional
        The cutting rack of both; by default that of ISO 53. Its fillet_radius is ignored.
    total : float, optional
        Sum of the shifts, modules; 0 keeps the centre distance of gears without shift.

    Returns
    -------
    tuple of float
        Profile shifts of the first and the second gear, modules. The largest specific sliding of each gear, at the tips
        of the other, is then equal.

    Raises
    ------
    DesignError
        If for all shifts the tips of one gear meet the line of action outside the base circles.

    Notes
    -----
    Derived here.
    """
    rack = RackCutter() if rack is None else rack
    slope = float(np.tan(rack.pressure_angle))
    base_1, base_2 = (z / 2 * float(np.cos(rack.pressure_angle)) for z in (first, second))
    angle = involute_function(slope) + 2 * slope * total / (first + second)
    if angle <= 0:
        raise DesignError("total", f"found {total:g}, for which the teeth cannot mesh", "give a larger sum")
    between = (base_1 + base_2) * inverse_involute(angle)

    def ends(x: float) -> tuple[float, float]:
        """Lengths on the line of action from each base circle to the nearer end of contact; negative outside."""
        tips = (
            base * roll_at(z / 2 + rack.addendum + shift, base)
            for z, base, shift in ((first, base_1, x), (second, base_2, total - x))
        )
        tip_1, tip_2 = tips
        return between - tip_2, between - tip_1

    def sliding_difference(x: float) -> float:
        """Positive if the first gear slides more: its sliding is 1 - (z1 / z2) (between - s) / s at s."""
        end_1, end_2 = ends(x)
        if end_1 <= 0 or end_2 <= 0:
            return float(np.sign(end_2 - end_1))
        return first / second * (between - end_1) / end_1 - second / first * (between - end_2) / end_2

    # A larger shift of the first gear moves its contact away from its base circle.
    x = last_fit(lambda shift: sliding_difference(shift) > 0, LEAST, MOST)
    if min(ends(x)) <= 0 or not LEAST + 1e-6 < x < MOST - 1e-6:
        raise DesignError(
            "teeth",
            f"found {first} and {second}: no profile shifts keep the contact of both gears outside their base circles",
            "give more teeth, a smaller addendum or a larger total",
        )
    return x, total - x
