"""Spur gears as a rack leaves them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Literal, NoReturn

import numpy as np

from ..arguments import checked
from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..sizes import SMALLEST, check_sizes, entry, quantity, rounded_down
from .involute import inverse_involute, involute_function, largest_rounding, roll_at
from .limit import last_fit
from .rack import RackCutter
from .tooth import Tooth, outline

# An inch, mm, by definition.
INCH = 25.4
# Least chamfer, modules: rounding turns the edge of a smaller one, and a kerf's offset of it never gets smooth.
SMALLEST_CHAMFER = 1e-6


@dataclass(frozen=True)
class SpurGear:
    """An external spur gear about the origin, a tooth centred on +y.

    profile_shift: how far the rack stands out from its normal place, in modules; more makes the tooth
    stronger at its root and thinner at its tip. The teeth's size is given as `module`, or as
    `diametral_pitch`, which then gives the module.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=10_000, example=24)
    module: float = quantity("pitch diameter per tooth", "mm", default=None, above=0, at_most=1e5, example=2)
    profile_shift: float = quantity(
        "outward shift of the cutting rack", "modules", default=0.0, at_least=-10, at_most=10
    )
    rack: RackCutter = entry("the cutting rack", default=RackCutter())
    addendum: float = quantity(
        "height of the teeth above the shifted reference line, where it is not the rack's",
        "modules",
        default=None,
        above=0,
        at_most=5,
    )
    thinning: float = quantity(
        "how much thinner each tooth is along the pitch circle, for backlash", "mm", default=0.0, at_least=0
    )
    tip_rounding: float = quantity("radius of the rounding of the tips' edges", "modules", default=0.0, at_least=0)
    tip_chamfer: float = quantity(
        "size of the chamfer of the tips' edges, along the radius and along the tip circle",
        "modules",
        default=0.0,
        at_least=0,
    )
    pointed: Literal["refuse", "cut"] = entry(
        "teeth whose flanks meet below the tip circle are refused, or cut off at the point", default="refuse"
    )
    diametral_pitch: float = quantity("teeth per inch of pitch diameter", "1/in", default=None, above=0, at_most=1e5)

    def __post_init__(self) -> None:
        check_sizes(self)
        self._settle_module()
        if not self._leaves_teeth():
            self._refuse()
        self._check_tip_edge()

    def _settle_module(self) -> None:
        if self.diametral_pitch is None:
            if self.module is None:
                raise DesignError("module", "found neither module nor diametral_pitch", "give one of them")
            return
        module = INCH / self.diametral_pitch
        if self.module is not None and abs(self.module - module) > 1e-9 * module:
            raise DesignError(
                "module",
                f"found {self.module:g} mm, but a diametral_pitch of {self.diametral_pitch:g} makes it {module:.6g} mm",
                "give one of them",
            )
        object.__setattr__(self, "module", module)
        if not SMALLEST <= module <= 1e5:
            raise DesignError(
                "diametral_pitch",
                f"found {self.diametral_pitch:g}, which makes a module of {module:.6g} mm",
                f"give {INCH / 1e5:g} to 1e5",
            )

    def _leaves_teeth(self, **changes: float) -> bool:
        """Whether a rack leaves whole teeth on this gear, with other sizes; tips are taken as sharp."""
        gear = object.__new__(SpurGear)  # not checked
        sizes = {field.name: getattr(self, field.name) for field in fields(self)}
        gear.__dict__.update(sizes | {"tip_rounding": 0.0, "tip_chamfer": 0.0} | changes)
        return gear._tooth.stands and (self.pointed == "cut" or gear.tip_thickness >= 0)

    def _refuse(self) -> NoReturn:
        """Say why there are no teeth, and the nearest size that leaves some."""
        if self.thinning and self._leaves_teeth(thinning=0.0):
            thickest = min(self.thinning, np.pi * self.module)
            most = last_fit(lambda thinning: self._leaves_teeth(thinning=thinning), 0.0, thickest)
            raise DesignError(
                "thinning",
                f"found {self.thinning:g} mm, which leaves no tooth",
                f"give at most {most * (1 - 1e-5):.6g}",
            )
        tooth, found = replace(self._tooth, tip_rounding=0.0, tip_chamfer=0.0), f"found {self.profile_shift:g}"
        remedy = "more teeth or a smaller addendum"
        if tooth.half_angle_at_base <= 0 or tooth.tip_radius <= max(tooth.base_radius, tooth.root_radius):
            problem = f"{found}, which leaves no tooth outside its base and root circles"
        elif tooth.stands:
            problem = f"{found}, with which the flanks meet below the tip circle: the teeth are pointed"
            remedy = "a smaller addendum or pointed = cut"
        else:
            problem = f"{found}: with {self.teeth} teeth the rack's tips cut the teeth off"
        raise DesignError("profile_shift", problem, f"give {self._nearest_shift()}{remedy}")

    def _nearest_shift(self) -> str:
        """The profile shift nearest to the one found that leaves teeth, in words; none if none is near."""
        found = self.profile_shift

        def fits(shift: float) -> bool:
            return self._leaves_teeth(profile_shift=shift)

        # Gears whose shifts leave teeth over less than a fiftieth of a module are not found.
        for step in np.arange(0.02, 20, 0.02).tolist():
            if fits(found - step):
                return f"at most {np.floor(last_fit(fits, found - step, found) * 1000) / 1000:g}, or "
            if fits(found + step):
                return f"at least {np.ceil(last_fit(fits, found + step, found) * 1000) / 1000:g}, or "
        return ""

    def _check_tip_edge(self) -> None:
        """The two edges of a tip must leave each other, and the flanks, their room."""
        if self.tip_rounding and self.tip_chamfer:
            raise DesignError("tip_chamfer", f"found {self.tip_chamfer:g} beside a tip_rounding", "give one of them")
        if 0 < self.tip_chamfer < SMALLEST_CHAMFER:
            remedy = f"give 0 or at least {SMALLEST_CHAMFER:g}"
            raise DesignError("tip_chamfer", f"found {self.tip_chamfer:g}, too small to be told from none", remedy)
        if self.tip_rounding:
            name, value = "tip_rounding", self.tip_rounding
            most = largest_rounding(self.base_radius, self._half_angle(self.base_radius), self.tip_radius)
        else:
            name, value = "tip_chamfer", self.tip_chamfer
            most = min(max(0.0, self.tip_thickness / 2), self.tip_radius - self.base_radius)
        # Twelve digits: a full round asked for as exactly as a number can be written is one.
        fits = value * self.module <= most * (1 + 1e-12)
        if fits and not self._tooth.stands:
            # Undercut has left less of the flanks.
            def stands(edge: float) -> bool:
                changed: dict[str, Any] = {name: edge}
                return replace(self._tooth, **changed).stands

            most, fits = last_fit(stands, 0.0, value * self.module), False
        if not fits:
            raise DesignError(
                name,
                f"found {value:g}, but the tips have room for {most / self.module:.4g} modules",
                f"give at most {rounded_down(most / self.module)}",
            )

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks at the pitch circle, rad: the rack's."""
        return self.rack.pressure_angle

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle on which the rack rolls, mm."""
        return self.module * self.teeth / 2

    @property
    def base_radius(self) -> float:
        """Radius of the circle from which the flanks unwind, mm."""
        return self.pitch_radius * float(np.cos(self.rack.pressure_angle))

    @property
    def tip_radius(self) -> float:
        """Radius of the tooth tips, mm."""
        addendum = self.rack.addendum if self.addendum is None else self.addendum
        full = self.pitch_radius + self.module * (addendum + self.profile_shift)
        if self.pointed == "refuse":
            return full
        half = self._half_angle(self.base_radius)
        return min(full, self.base_radius * float(np.hypot(1, inverse_involute(half)))) if half > 0 else full

    @property
    def root_radius(self) -> float:
        """Radius of the bottom of the spaces, mm."""
        return self.pitch_radius - self.module * (self.rack.dedendum - self.profile_shift)

    @property
    def form_radius(self) -> float:
        """Radius where the involute begins, mm: where the root curve touches it, or cuts it if undercut."""
        return self.base_radius * float(np.hypot(1, self._tooth.flank_start))

    @property
    def is_undercut(self) -> bool:
        """Whether the rack's tip cuts away part of the involute it has made."""
        return self._tooth.is_undercut

    @property
    def involute_lost(self) -> float:
        """Share of the involute's length, from base circle to tip, that undercut takes away; 0 without undercut."""
        return (self._tooth.flank_start / self._tooth.flank_end) ** 2 if self.is_undercut else 0.0

    @property
    def tip_thickness(self) -> float:
        """Thickness of the tooth along its tip circle, mm; negative where the flanks would have met below."""
        return 2 * self.tip_radius * self._half_angle(self.tip_radius)

    @property
    def tip_land(self) -> float:
        """What a rounding or chamfer leaves of the tip thickness, mm."""
        return 2 * self.tip_radius * max(0.0, self._tooth.tip_land)

    @checked
    def thickness(self, radius: float) -> float:
        """Thickness of the tooth along a circle through its involute, mm."""
        return 2 * radius * self._half_angle(radius)

    @property
    def flank_lengths(self) -> tuple[float, float]:
        """Tangent lengths from the base circle to the involute's two ends, root and tip, mm."""
        return self.base_radius * self._tooth.flank_start, self.base_radius * self._tooth.flank_end

    @property
    def outline(self) -> AbstractCurve:
        """The whole gear as one closed counterclockwise curve of exact pieces."""
        return outline(self._tooth)

    @property
    def root_curve(self) -> AbstractCurve:
        """Right-hand root curve of the tooth on +y, from the bottom land up to the flank."""
        return self._tooth.root_curve

    @property
    def flank(self) -> AbstractCurve:
        """Right-hand flank of the tooth on +y, from the root curve up to the tip."""
        return self._tooth.flank

    @property
    def tip_edge(self) -> AbstractCurve | None:
        """Rounding or chamfer of the right-hand edge of the tip on +y; None where the edge is sharp."""
        return self._tooth.tip_edge

    @cached_property
    def _tooth(self) -> Tooth:
        return Tooth(
            teeth=self.teeth,
            pitch_radius=self.pitch_radius,
            base_radius=self.base_radius,
            tip_radius=self.tip_radius,
            root_radius=self.root_radius,
            pressure_angle=self.rack.pressure_angle,
            half_angle_at_base=self._half_angle(self.base_radius),
            corner_depth=self.module * (self.rack.corner_depth - self.profile_shift),
            # A rack with teeth as much thicker as the gear's are to be thinner.
            corner_side=self.module * self.rack.corner_side + self.thinning / 2,
            corner_rounding=self.module * self.rack.tip_radius,
            flank_depth=self.module * (self.rack.flank_depth - self.profile_shift),
            tip_rounding=self.module * self.tip_rounding,
            tip_chamfer=self.module * self.tip_chamfer,
        )

    def _half_angle(self, radius: float) -> float:
        """Half the angle that the tooth takes on a circle, rad."""
        return self._half_angle_of(self.profile_shift, roll_at(radius, self.base_radius))

    def _half_angle_of(self, shift: float, roll: float) -> float:
        slope = np.tan(self.rack.pressure_angle)
        at_pitch = (np.pi / 2 + 2 * shift * slope - self.thinning / self.module) / self.teeth
        return float(at_pitch + involute_function(slope) - involute_function(roll))
