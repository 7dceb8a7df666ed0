"""Spur gears as a rack leaves them."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Literal, NoReturn

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import entry, last_fit, quantity, rounded_down
from ..core.records import record
from ..plane.joined import PolarArray
from ..plane.primitives import Polyline
from ..plane.roulettes import inverse_involute, involute_function
from ..plane.vec import Pose, Real
from .contract import AbstractInvoluteGear
from .cutters import HelixAngle, RackCutter
from .module import Settled, diametral_pitch, module, settle_module
from .tooth import Tooth, largest_rounding, outline

# Teeth along the rack that is shown cutting a gear: more run off the picture, fewer end where it still cuts.
TOOL_TEETH = 7
# Least chamfer, modules: rounding turns the edge of a smaller one, and a kerf's offset of it never gets smooth.
SMALLEST_CHAMFER = 1e-6


@record(checked=True)
class SpurGear(AbstractInvoluteGear):
    """An external spur gear about the origin, a tooth centred on +y.

    profile_shift: how far the rack stands out from its normal place, in modules; more makes the tooth
    stronger at its root and thinner at its tip. The teeth's size is given as `module`, or as
    `diametral_pitch`, which then gives the module. Flanks are involutes (ISO 21771), roots what the rack's rounded
    tips leave (Litvin and Fuentes, Gear Geometry and Applied Theory, on rack cutters).
    Raises DesignError where the rack leaves no whole teeth, with the nearest size that leaves some.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=10_000, example=24)
    module: Settled = module()
    profile_shift: float = quantity(
        "outward shift of the cutting rack", "modules", default=0.0, at_least=-10, at_most=10
    )
    rack: RackCutter = entry("the cutting rack", default=RackCutter())
    addendum: float | None = quantity(
        "height of the teeth above the shifted reference line, where it is not the rack's",
        "modules",
        default=None,
        above=0,
        at_most=5,
    )
    tooth_thickness_allowance: float = quantity(
        "how much thinner each tooth is along the pitch circle, for backlash", "mm", default=0.0, at_least=0
    )
    tip_rounding: float = quantity("radius of the rounding of the tips' edges", "modules", default=0.0, at_least=0)
    tip_chamfer: float = quantity(
        "size of the chamfer of the tips' edges, along the radius and along the tip circle",
        "modules",
        default=0.0,
        at_least=0,
    )
    on_pointed_tip: Literal["refuse", "cut"] = entry(
        "teeth whose flanks meet below the tip circle are refused, or cut off at the point", default="refuse"
    )
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        settle_module(self)
        if not self._is_whole(self._sharp):
            self._refuse()
        self._check_tip_edge()

    def _is_whole(self, tooth: Tooth) -> bool:
        return tooth.stands and (self.on_pointed_tip == "cut" or tooth.half_angle(tooth.tip_radius) >= 0)

    def _leaves_teeth(self, shift: float, tooth_thickness_allowance: float) -> bool:
        """Whether the rack leaves whole teeth at another shift and tooth_thickness_allowance; tips are taken as
        sharp.
        """
        return self._is_whole(self._sharp_at(shift, tooth_thickness_allowance))

    def _refuse(self) -> NoReturn:
        """Say why there are no teeth, and the nearest size that leaves some."""
        if self.tooth_thickness_allowance and self._leaves_teeth(self.profile_shift, 0.0):
            thickest = min(self.tooth_thickness_allowance, np.pi * self.module)
            most = last_fit(
                lambda tooth_thickness_allowance: self._leaves_teeth(self.profile_shift, tooth_thickness_allowance),
                0.0,
                thickest,
            )
            raise DesignError(
                "tooth_thickness_allowance",
                f"found {self.tooth_thickness_allowance:g} mm, which leaves no tooth",
                f"give at most {most * (1 - 1e-5):.6g}",
            )
        tooth, found = self._sharp, f"found {self.profile_shift:g}"
        remedy = "more teeth or a smaller addendum"
        if tooth.half_angle_at_base <= 0 or tooth.tip_radius <= max(tooth.base_radius, tooth.root_radius):
            problem = f"{found}, which leaves no tooth outside its base and root circles"
        elif tooth.stands:
            problem = f"{found}, with which the flanks meet below the tip circle: the teeth are pointed"
            remedy = "a smaller addendum or on_pointed_tip = cut"
        else:
            problem = f"{found}: with {self.teeth} teeth the rack's tips cut the teeth off"
        raise DesignError("profile_shift", problem, f"give {self._nearest_shift()}{remedy}")

    def _nearest_shift(self) -> str:
        """The profile shift nearest to the one found that leaves teeth, in words; none if none is near."""
        found = self.profile_shift

        def fits(shift: float) -> bool:
            return self._leaves_teeth(shift, self.tooth_thickness_allowance)

        # Gears whose shifts leave teeth over less than a fiftieth of a module are not found.
        for step in np.arange(0.02, 20, 0.02).tolist():
            if fits(found - step):
                return f"at most {np.floor(last_fit(fits, found - step, found) * 1000) / 1000:g}, or "
            if fits(found + step):
                return f"at least {np.ceil(last_fit(fits, found + step, found) * 1000) / 1000:g}, or "
        return ""

    def _check_tip_edge(self) -> None:
        """The two edges of a tip must leave each other, and the flanks, their room."""
        given = {"addendum": self.addendum, "tip_rounding": self.tip_rounding, "tip_chamfer": self.tip_chamfer}
        if self.rack.fillet_radius and (twice := next((name for name, value in given.items() if value), None)):
            problem = (
                f"found {given[twice]:g} beside a rack whose fillet_radius of {self.rack.fillet_radius:g} cuts tips"
            )
            remedy = "rack.addendum instead" if twice == "addendum" else "one of them"
            raise DesignError(twice, problem, f"give {remedy}")
        if self.tip_rounding and self.tip_chamfer:
            raise DesignError("tip_chamfer", f"found {self.tip_chamfer:g} beside a tip_rounding", "give one of them")
        if 0 < self.tip_chamfer < SMALLEST_CHAMFER:
            remedy = f"give 0 or at least {SMALLEST_CHAMFER:g}"
            raise DesignError("tip_chamfer", f"found {self.tip_chamfer:g}, too small to be told from none", remedy)
        if self.tip_rounding:
            name, value = "tip_rounding", self.tip_rounding
            most = largest_rounding(self.base_radius, self.tooth.half_angle_at_base, self.tip_radius)
        else:
            name, value = "tip_chamfer", self.tip_chamfer
            most = min(max(0.0, self.tip_thickness / 2), self.tip_radius - self.base_radius)
        # Twelve digits: a full round asked for as exactly as a number can be written is one.
        fits = value * self.module <= most * (1 + 1e-12)
        if fits and not self.tooth.stands:
            # Undercut has left less of the flanks.
            def stands(edge: float) -> bool:
                rounding, chamfer = (edge, 0.0) if self.tip_rounding else (0.0, edge)
                return replace(self.tooth, tip_rounding=rounding, tip_chamfer=chamfer).stands

            most, fits = last_fit(stands, 0.0, value * self.module), False
        if not fits:
            raise DesignError(
                name,
                f"found {value:g}, but the tips have room for {most / self.module:.4g} modules",
                f"give at most {rounded_down(most / self.module)}",
            )

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> SpurGear:
        """The transverse section of helical teeth whose normal section has this gear's sizes.

        Parameters
        ----------
        helix_angle_deg : float
            Angle of the teeth to the axis at the pitch circle, 0 to 45 deg.

        Returns
        -------
        SpurGear
            Module, profile shift, heights, tip edges and rack of the section across the axis (ISO 21771);
            `tooth_thickness_allowance`, mm along the pitch circle, stays.
        """
        ratio = float(np.cos(np.radians(helix_angle_deg)))
        return replace(
            self,
            module=self.module / ratio,
            diametral_pitch=None,
            profile_shift=self.profile_shift * ratio,
            rack=self.rack.transverse(helix_angle_deg),
            addendum=None if self.addendum is None else self.addendum * ratio,
            tip_rounding=self.tip_rounding * ratio,
            tip_chamfer=self.tip_chamfer * ratio,
        )

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks at the pitch circle, rad: the rack's."""
        return self.rack.pressure_angle

    @property
    def is_undercut(self) -> bool:
        """Whether the rack's tip cuts away part of the involute it has made."""
        return self.tooth.is_undercut

    @property
    def lost_to_undercut(self) -> float:
        """Height of the involute that undercut takes away, mm along the radius."""
        roll = self.tooth.rolls[0]
        # What the form radius is more than the base radius, where that is little.
        return self.base_radius * roll**2 / (1 + float(np.hypot(1, roll))) if self.is_undercut else 0.0

    @property
    def tip_land(self) -> float:
        """What a rounding or chamfer leaves of the tip thickness, mm."""
        return 2 * self.tip_radius * max(0.0, self.tooth.tip_land)

    @property
    def outline(self) -> PolarArray:
        """The whole gear as one closed counterclockwise curve of exact pieces."""
        return outline(self.tooth)

    def tool(self, turn: Real) -> tuple[Polyline, Pose]:
        """The rack, round as many teeth as meet it; where teeth are thinned, as it would cut both sides at once."""
        edge = self.rack.edge(self.module, min(self.teeth, TOOL_TEETH), self.tooth_thickness_allowance / self.module)
        height = self.pitch_radius + self.module * self.profile_shift
        return edge, Pose(1j * height - self.pitch_radius * np.asarray(turn), np.ones(np.shape(turn), complex))

    @cached_property
    def tooth(self) -> Tooth:
        """Sizes and curves of the tooth on +y."""
        if not (self.tip_rounding or self.tip_chamfer):
            return self._sharp
        return replace(
            self._sharp, tip_rounding=self.module * self.tip_rounding, tip_chamfer=self.module * self.tip_chamfer
        )

    @cached_property
    def _sharp(self) -> Tooth:
        return self._sharp_at(self.profile_shift, self.tooth_thickness_allowance)

    def _sharp_at(self, shift: float, tooth_thickness_allowance: float) -> Tooth:
        """What a rack leaves at a profile shift, modules, and a tooth_thickness_allowance, mm, before the tips'
        edges are broken.
        """
        rack, module, pitch_radius = self.rack, self.module, self.pitch_radius
        base_radius = pitch_radius * float(np.cos(rack.pressure_angle))
        slope = np.tan(rack.pressure_angle)
        half = float(
            (np.pi / 2 + 2 * shift * slope - tooth_thickness_allowance / module) / self.teeth + involute_function(slope)
        )
        addendum = rack.addendum if self.addendum is None else self.addendum
        tip_radius = pitch_radius + module * (addendum + shift)
        if self.on_pointed_tip == "cut" and half > 0:
            tip_radius = min(tip_radius, base_radius * float(np.hypot(1, inverse_involute(half))))
        return Tooth(
            teeth=self.teeth,
            pitch_radius=pitch_radius,
            base_radius=base_radius,
            tip_radius=tip_radius,
            root_radius=pitch_radius - module * (rack.dedendum - shift),
            pressure_angle=rack.pressure_angle,
            half_angle_at_base=half,
            corner_depth=module * (rack.corner_depth - shift),
            # A rack with teeth as much thicker as the gear's are to be thinner.
            corner_side=module * rack.corner_side + tooth_thickness_allowance / 2,
            corner_rounding=module * rack.tip_radius,
            flank_depth=module * (rack.flank_depth - shift),
            fillet_radius=module * rack.fillet_radius,
            fillet_height=module * (rack.fillet_height + shift),
            fillet_side=module * rack.fillet_side - tooth_thickness_allowance / 2,
            flank_height=module * (rack.flank_height + shift),
        )
