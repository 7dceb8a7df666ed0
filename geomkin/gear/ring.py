"""Internal gears as a pinion cutter leaves them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from ..arguments import checked
from ..brief import one_line
from ..cached import cached_property
from ..errors import DesignError
from ..plane.joined import Ring
from ..plane.vec import Pose, Real
from ..sizes import check_sizes, entry, last_fit, quantity, rounded_down, rounded_up
from .contract import AbstractInvoluteGear
from .cutters import HelixAngle
from .module import Settled, diametral_pitch, module, settle_module
from .pinion_cutter import PinionCutter
from .ring_tooth import RingTooth
from .tooth import toothed, with_land

# Largest profile shift either way, modules: beyond any use, and far enough to look for one to advise.
FARTHEST_SHIFT = 10


@dataclass(frozen=True)
class RingGear(AbstractInvoluteGear):
    """An internal gear about the origin, a tooth centred on +y, pointing inwards.

    profile_shift: how far the teeth stand outwards of their normal place, in modules; a pinion of the same
    shift then meshes at the distance of a pair without shift. More makes the teeth thinner at their root
    circle and the spaces wider. thinning: the cutter widens the spaces by going round turned to both sides by
    all angles up to thinning / (2 pitch_radius), so that each side of a tooth turns as a whole, root curve and
    flank, and the bottom lands grow. ISO 21771 and DIN 3960, which count the teeth of internal gears as negative,
    give the shift the other sign. The root curve is derived here.
    Raises DesignError where the cutter leaves no whole teeth, with sizes that do.
    """

    is_ring = True

    teeth: int = quantity("number of teeth", whole=True, at_least=8, at_most=10_000, example=60)
    module: Settled = module()
    profile_shift: float = quantity(
        "outward shift of the teeth", "modules", default=0.0, at_least=-FARTHEST_SHIFT, at_most=FARTHEST_SHIFT
    )
    cutter: PinionCutter = entry("the gear-shaped tool that cuts the teeth", default=PinionCutter())
    addendum: float = quantity(
        "how far the teeth reach inwards of their reference circle", "modules", default=1.0, above=0, at_most=5
    )
    thinning: float = quantity(
        "how much thinner each tooth is along the reference circle, for backlash", "mm", default=0.0, at_least=0
    )
    diametral_pitch: float | None = diametral_pitch()

    __repr__ = one_line

    def __post_init__(self) -> None:
        check_sizes(self)
        settle_module(self)
        tooth, z, z0 = self.tooth, self.teeth, self.cutter.teeth
        if z <= z0:
            raise DesignError(
                "teeth",
                f"found {z}, no more than the {z0} of its cutter",
                f"give at least {z0 + 1}, or a smaller cutter",
            )
        if tooth.working_involute < 0:
            raise DesignError(
                "profile_shift",
                f"found {self.profile_shift:g}, for which the cutter does not fit between the teeth",
                f"give {self._wider(tooth.least_shift)}",
            )
        self._check_tip()
        if not tooth.is_reached:
            raise DesignError(
                "addendum",
                "the cutter does not reach the tips of the teeth",
                "give a larger addendum, or a larger one to the cutter",
            )
        self._check_thickness()
        if not tooth.has_fillet_room:
            self._refuse_fillet()
        if tooth.trochoid_gap < 0:
            raise DesignError(
                "cutter.teeth",
                f"found {z0}: on their way out of the spaces the cutter's tips cut the tips of {z} teeth",
                f"give {self._gentler()}",
            )

    def _check_tip(self) -> None:
        """The tips must stand where the cutter has an involute to make them."""
        least = self.tooth.least_tip_radius
        if self.tip_radius >= least:
            return
        addendum = self.teeth / 2 + self.profile_shift - least / self.module
        remedy = f"give at most {rounded_down(addendum)} modules" if addendum >= 1e-3 else "give"
        joint = ", or more profile_shift" if addendum >= 1e-3 else " a larger profile_shift"
        raise DesignError(
            "addendum",
            f"found {self.addendum:g}, so the tips stand at {self.tip_radius:.5g} mm, but a cutter of "
            f"{self.cutter.teeth} teeth makes involutes from {least:.5g} mm outwards",
            f"{remedy}{joint} or cutter teeth",
        )

    def _check_thickness(self) -> None:
        """The tips, where the teeth are thinnest, must have some thickness left."""
        if self.tip_thickness >= 0:
            return
        most = self.tooth.most_thinning
        if most > 0:
            raise DesignError(
                "thinning",
                f"found {self.thinning:g} mm, with which the flanks meet outside the tip circle",
                # A little less, so that the number still works when rounded.
                f"give at most {most * (1 - 1e-5):.6g}",
            )
        raise DesignError(
            "profile_shift",
            f"found {self.profile_shift:g}, with which the flanks meet outside the tip circle",
            "give a smaller profile_shift or addendum",
        )

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> RingGear:
        """The transverse section of helical teeth whose normal section has these sizes, as of a spur gear."""
        ratio = float(np.cos(np.radians(helix_angle_deg)))
        return replace(
            self,
            module=self.module / ratio,
            diametral_pitch=None,
            profile_shift=self.profile_shift * ratio,
            cutter=self.cutter.transverse(helix_angle_deg),
            addendum=self.addendum * ratio,
        )

    def _refuse_fillet(self) -> NoReturn:
        """Name the largest fillet that the cutter has room for, or what else makes room."""
        found, cutter = self.cutter.fillet_radius, self.cutter

        def fits(radius: float) -> bool:
            return replace(self.tooth, cutter=replace(cutter, fillet_radius=radius)).has_fillet_room

        fitting = [share * found for share in np.linspace(0.01, 0.99, 99).tolist() if fits(share * found)]
        most = f"at most {rounded_down(last_fit(fits, fitting[-1], found))}, " if fitting else ""
        raise DesignError(
            "cutter.fillet_radius",
            f"found {found:g}, for which there is no room between the cutter's flanks, outside its base circle",
            f"give {most}0 or a smaller addendum to the ring",
        )

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks at the reference circle, rad: the cutter's."""
        return self.cutter.pressure_angle

    @property
    def outline(self) -> Ring:
        """The teeth as one closed counterclockwise curve of exact pieces: the hole of the gear's plate."""
        edge = [self.tip_edge] if self.tip_edge else []
        return toothed([with_land([self.root_curve, self.flank, *edge], self.tooth.half_land)], self.teeth)

    @property
    def cutting_angle(self) -> float:
        return self.tooth.cutting_angle

    def tool(self, turn: Real) -> tuple[Ring, Pose]:
        """The pinion cutter, which turns inside the ring; where teeth are thinned, in the middle of its ways."""
        cutter = self.cutter
        turned = np.exp(1j * (turn * self.teeth + np.pi) / cutter.teeth)
        place = np.full(np.shape(turn), 1j * (self.root_radius - self.module * cutter.outer_radius))
        return cutter.edge(self.module, self.tooth.cutter_root), Pose(place, turned)

    @cached_property
    def tooth(self) -> RingTooth:
        """Sizes and curves of the tooth on +y."""
        return RingTooth(self.teeth, self.module, self.profile_shift, self.cutter, self.addendum, self.thinning)

    def _wider(self, least: float) -> str:
        """The least profile shift, from one for which the cutter fits, and failing that the cutter, that make one."""
        for step in (1e-9, *np.arange(0.05, 2, 0.05).tolist()):
            shift = rounded_up(least + step)
            if abs(float(shift)) <= FARTHEST_SHIFT and replace(self.tooth, profile_shift=float(shift)).stands:
                return f"at least {shift}, or a cutter with fewer teeth"
        for teeth in range(self.cutter.teeth - 1, 3, -1):
            try:
                cutter = replace(self.cutter, teeth=teeth)
            except DesignError:
                continue
            if replace(self.tooth, cutter=cutter).stands:
                return f"a cutter of {teeth} teeth"
        return "a cutter with fewer teeth and a larger profile_shift"

    def _gentler(self) -> str:
        """The largest smaller cutter, of the same tips, that cuts these teeth."""
        for teeth in range(self.cutter.teeth - 1, 3, -1):
            try:
                cut = replace(self.tooth, cutter=replace(self.cutter, teeth=teeth))
            except DesignError:
                break
            if cut.trochoid_gap < 0:
                continue
            if not cut.stands:
                break
            return f"{teeth}, or a smaller addendum"
        return "a smaller addendum"
