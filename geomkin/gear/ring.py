"""The tooth of an internal gear, and its root curve: what the rounded tip of a rolling pinion cutter leaves."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import entry, last_fit, quantity, rounded_down, rounded_up
from ..core.records import record
from ..plane.curve import AbstractCurve, Mirrored, Moved, Reversed
from ..plane.joined import PolarArray
from ..plane.roulettes import Involute, Traced, inverse_involute, involute_function, roll_at
from ..plane.vec import Complex, Pose, Real
from .contract import AbstractInvoluteGear, AbstractTooth
from .cutters import HelixAngle
from .interference import InternalMesh
from .module import Settled, diametral_pitch, module, settle_module
from .pinion_cutter import PinionCutter
from .tooth import envelope_end, toothed, with_land


@record
class RingTooth(AbstractTooth):
    """A tooth of a ring as a pinion cutter leaves it; the sizes are those of `RingGear`, unchecked."""

    teeth: int
    module: float
    profile_shift: float
    cutter: PinionCutter
    addendum: float
    tooth_thickness_allowance: float

    @property
    def stands(self) -> bool:
        """Whether the cutter leaves whole teeth."""
        if self.teeth <= self.cutter.teeth or self.working_involute < 0:
            return False
        if self.trochoid_gap < 0 or self.tip_radius < self.least_tip_radius:
            return False
        return self.is_reached and self.half_angle(self.tip_radius) >= 0 and self.has_fillet_room

    @property
    def is_reached(self) -> bool:
        """Whether the cutter reaches beyond the tips, and leaves something of the involute."""
        return self.root_radius > self.tip_radius and self.rolls[1] > self.rolls[0]

    @property
    def tip_radius(self) -> float:
        """Radius of the tooth tips, mm: the smallest of the gear."""
        return self.module * (self.teeth / 2 - self.addendum + self.profile_shift)

    @property
    def least_tip_radius(self) -> float:
        """Radius, mm, from which outwards the cutter's flanks make involutes."""
        return self.module * float(np.hypot(self._base, self._cutter_distance * np.sin(self.cutting_angle)))

    @property
    def root_radius(self) -> float:
        """Radius of the bottom of the spaces, mm: the largest of the gear."""
        return self.module * (self._cutter_distance + self.cutter.outer_radius)

    @property
    def base_radius(self) -> float:
        """Radius of the circle from which the flanks unwind, mm."""
        return self.module * self._base

    @cached_property
    def rolls(self) -> tuple[float, float]:
        """Roll angles of the involute at the tip, and where the cutter's own flank ends."""
        cut = self.cutter.corner.roll * self.cutter.base_radius
        end = (cut + self._cutter_distance * np.sin(self.cutting_angle)) / self._base
        if self._fillet is None:
            return roll_at(self.tip_radius, self.base_radius), float(end)
        if self._fillet.end < np.pi / 2 - self.cutting_angle:
            return roll_at(abs(complex(self._fillet.point(self._fillet.end))), self.base_radius), float(end)
        cut = self.cutter.fillet(self.cutter_root).roll * self.cutter.base_radius
        return float((cut + self._cutter_distance * np.sin(self.cutting_angle)) / self._base), float(end)

    def half_angle(self, radius: float) -> float:
        return np.pi / self.teeth - self._half_space(roll_at(radius, self.base_radius))

    @property
    def largest_tooth_thickness_allowance(self) -> float:
        """Thinning, mm, for which the flanks meet at the tips."""
        tip = roll_at(self.tip_radius, self.base_radius)
        return 2 * (self.module * self.teeth / 2) * (np.pi / self.teeth - self._half_cut(tip))

    @cached_property
    def root_curve(self) -> AbstractCurve:
        curve = self._envelope(self.cutter.corner.radius, self.cutter.tip_radius)
        return Moved(curve, Pose(0j, np.exp(1j * (np.pi / 2 - np.pi / self.teeth + self.half_land))))

    @property
    def tip_edge(self) -> AbstractCurve | None:
        """What the cutter's root fillet rounds off the tip's right-hand edge; None where it is sharp."""
        if self._fillet is None:
            return None
        return Moved(Reversed(self._fillet), Pose(0j, 1j * np.exp(-1j * self.fillet_land)))

    @cached_property
    def _fillet(self) -> RingTrochoid | None:
        """What the cutter's root fillet leaves of the tip, from the tip circle to the flank; None if it cuts none."""
        if not self.cutter.fillet_radius:
            return None
        whole = self._envelope(self.cutter.fillet(self.cutter_root).radius, -self.cutter.fillet_radius)
        end = envelope_end(whole, whole.speed, whole.end, self.half_angle, self.fillet_land)
        return None if np.isnan(end) else replace(whole, end=end)

    def _envelope(self, centre: float, rounding: float) -> RingTrochoid:
        """What a rounding of the cutter leaves, from the line of centres to the flank; both lengths in modules."""
        m, apart = self.module, self.teeth - self.cutter.teeth
        wheel = self._cutter_distance * self.cutter.teeth / apart
        return RingTrochoid(
            radius=m * self._cutter_distance * self.teeth / apart,
            wheel=m * wheel,
            reach=m * (centre - wheel),
            rounding=m * rounding,
            start=0.0,
            end=np.pi / 2 - self.cutting_angle,
        )

    @cached_property
    def flank(self) -> AbstractCurve:
        cusp = np.pi / 2 - np.pi / self.teeth + self._half_space(0.0)
        left = Moved(Involute(self.base_radius, *self.rolls), Pose(0j, np.exp(1j * (np.pi - cusp))))
        return Reversed(Mirrored(left))

    @property
    def half_land(self) -> float:
        """Half the angle of the bottom land, rad."""
        return max(0.0, self.cutter.corner.angle) * self.cutter.teeth / self.teeth + self._turn

    @property
    def cutter_root(self) -> float:
        """Radius of the cutter's roots, modules, where they cut the tips."""
        return self.tip_radius / self.module - self._cutter_distance

    @property
    def fillet_land(self) -> float:
        """Half the angle of the tip land that the cutter's root fillet leaves, rad."""
        cutter = self.cutter
        return (np.pi / cutter.teeth - cutter.fillet(self.cutter_root).angle) * cutter.teeth / self.teeth - self._turn

    @property
    def has_fillet_room(self) -> bool:
        """Whether the cutter's root fillet, where it has one, begins on its involute and leaves a tip land."""
        if not self.cutter.fillet_radius:
            return True
        return self.cutter_root > 0 and self.cutter.fillet(self.cutter_root).roll >= 0 and self.fillet_land >= 0

    @property
    def working_involute(self) -> float:
        """Involute function of the working pressure angle with the cutter; negative where the cutter does not fit."""
        shift = self.profile_shift - self.cutter.profile_shift
        return involute_function(self._slope) + 2 * self._slope * shift / (self.teeth - self.cutter.teeth)

    @property
    def least_shift(self) -> float:
        """Profile shift at which the cutter begins to fit between the teeth, modules."""
        apart = self.teeth - self.cutter.teeth
        return self.cutter.profile_shift - involute_function(self._slope) * apart / (2 * self._slope)

    @property
    def trochoid_gap(self) -> float:
        """Angle by which the cutter's tips clear the ring's on their way out of the spaces; see `InternalMesh`."""
        return InternalMesh(
            self.cutter.teeth,
            self.teeth,
            self._cutter_distance,
            self.cutter.outer_radius,
            self.tip_radius / self.module,
            self.cutter.base_radius,
            self._base,
        ).trochoid_gap

    def _half_space(self, roll: float) -> float:
        """Half the angle that a space takes where the flank has a roll angle, rad."""
        return self._half_cut(roll) + self._turn

    def _half_cut(self, roll: float) -> float:
        """The same before the teeth are thinned, rad."""
        a = self._slope
        return (np.pi / 2 + 2 * self.profile_shift * a) / self.teeth + involute_function(a) - involute_function(roll)

    @property
    def _turn(self) -> float:
        """Angle by which tooth_thickness_allowance turns each side of a tooth towards its middle, rad."""
        return self.tooth_thickness_allowance / (2 * (self.module * self.teeth / 2))

    @property
    def _slope(self) -> float:
        return float(np.tan(self.cutter.pressure_angle))

    @property
    def _base(self) -> float:
        return self.teeth / 2 * float(np.cos(self.cutter.pressure_angle))

    @cached_property
    def cutting_angle(self) -> float:
        """Working pressure angle with the cutter, rad."""
        return float(np.arctan(inverse_involute(self.working_involute)))

    @cached_property
    def _cutter_distance(self) -> float:
        """Distance of the cutter's axis from the ring's, modules."""
        return (self._base - self.cutter.base_radius) / float(np.cos(self.cutting_angle))


@record(eq=False)
class RingTrochoid(Traced):
    """The envelope of a small circle on a wheel that rolls inside a ring: derived here from the law of gearing.

    The wheel, of `wheel` radius w, rolls inside the ring of `radius` R > w about the origin, mm. The small
    circle, of radius `rounding` rho, has its centre at a distance w + `reach` from the wheel's centre;
    where the centre comes farthest out the wheel touches at +x. rho > 0 is a rounded tip of the wheel, whose circle is
    touched on its outer side, rho < 0 a fillet between its teeth, touched on the inner one.

    t = psi is the lean of the contact normal from the radius to the rolling point I, rad, counterclockwise,
    from `start` to `end`, inside (-pi/2, pi/2). By the law of gearing the normal passes I, at a distance
    d from the small circle's centre, with d^2 + 2 w d cos(psi) = (w + reach)^2 - w^2, negative where the
    centre lies inside the rolling circle. This parameter keeps its digits where `reach` vanishes and the
    whole corner is cut at one instant. Asks for w |sin(psi)| < w + reach.
    """

    radius: float
    wheel: float
    reach: float
    rounding: float
    start: float
    end: float

    def _away(self, t: Real) -> tuple[Real, Real]:
        """d, and q = d + w cos(psi), in the form that keeps the digits of a small reach."""
        w, c = self.wheel, self.wheel + self.reach
        q = np.sqrt((c - w * np.sin(t)) * (c + w * np.sin(t)))
        return self.reach * (c + w) / (w * np.cos(t) + q), q

    def _turned(self, t: Real, d: Real) -> Complex:
        """Direction of the normal's frame in the ring: the ring turns by w / R of the wheel."""
        turned: Complex = np.exp(-1j * self.wheel / self.radius * np.angle(self.wheel + d * np.exp(1j * t)))
        return turned

    def point(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        d, _ = self._away(t)
        return (self.radius + (d + self.rounding) * np.exp(1j * t)) * self._turned(t, d)

    def _bend(self, d: Real, q: Real) -> tuple[Real, Real]:
        """Turn of the tangent and speed along it, per lean of the normal."""
        k = self.wheel / self.radius
        turn = 1 - k * d / q
        return turn, self.rounding * turn + (1 - k) * d**2 / q

    def velocity(self, t: ArrayLike) -> Complex:
        t = np.asarray(t, dtype=float)
        d, q = self._away(t)
        return 1j * self._bend(d, q)[1] * np.exp(1j * t) * self._turned(t, d)

    def speed(self, t: float) -> float:
        """Signed speed along the tangent, per lean of the normal."""
        return float(self._bend(*self._away(np.asarray(t)))[1])

    def curvature(self, t: ArrayLike) -> Real:
        turn, speed = self._bend(*self._away(np.asarray(t, dtype=float)))
        with np.errstate(divide="ignore"):
            return turn / np.abs(speed)


# Largest profile shift either way, modules: beyond any use, and far enough to look for one to advise.
FARTHEST_SHIFT = 10


@record(checked=True)
class RingGear(AbstractInvoluteGear):
    """An internal gear about the origin, a tooth centred on +y, pointing inwards.

    profile_shift: how far the teeth stand outwards of their normal place, in modules; a pinion of the same
    shift then meshes at the distance of a pair without shift. More makes the teeth thinner at their root
    circle and the spaces wider. tooth_thickness_allowance: the cutter widens the spaces by going round turned to
    both sides by all angles up to tooth_thickness_allowance / (2 pitch_radius), so that each side of a tooth turns
    as a whole, root curve and flank, and the bottom lands grow. ISO 21771 and DIN 3960, which count the teeth of
    internal gears as negative, give the shift the other sign. The root curve is derived here.
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
    tooth_thickness_allowance: float = quantity(
        "how much thinner each tooth is along the reference circle, for backlash", "mm", default=0.0, at_least=0
    )
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
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
        most = self.tooth.largest_tooth_thickness_allowance
        if most > 0:
            raise DesignError(
                "tooth_thickness_allowance",
                f"found {self.tooth_thickness_allowance:g} mm, with which the flanks meet outside the tip circle",
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
    def outline(self) -> PolarArray:
        """The teeth as one closed counterclockwise curve of exact pieces: the hole of the gear's plate."""
        edge = [self.tip_edge] if self.tip_edge else []
        return toothed([with_land([self.root_curve, self.flank, *edge], self.tooth.half_land)], self.teeth)

    @property
    def cutting_angle(self) -> float:
        return self.tooth.cutting_angle

    def tool(self, turn: Real) -> tuple[PolarArray, Pose]:
        """The pinion cutter, which turns inside the ring; where teeth are thinned, in the middle of its ways."""
        cutter = self.cutter
        turned = np.exp(1j * (turn * self.teeth + np.pi) / cutter.teeth)
        place = np.full(np.shape(turn), 1j * (self.root_radius - self.module * cutter.outer_radius))
        return cutter.edge(self.module, self.tooth.cutter_root), Pose(place, turned)

    @cached_property
    def tooth(self) -> RingTooth:
        """Sizes and curves of the tooth on +y."""
        return RingTooth(
            self.teeth, self.module, self.profile_shift, self.cutter, self.addendum, self.tooth_thickness_allowance
        )

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
