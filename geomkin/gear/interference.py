"""Interference of teeth outside their contact: tips with roots, or with a ring's tips; and the cutter of a ring."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.fields import quantity, rounded_down, rounded_up
from ..core.records import record
from ..plane.curve import AbstractCurve, Moved
from ..plane.joined import PolarArray
from ..plane.primitives import Arc, Segment
from ..plane.roulettes import Involute, inverse_involute, involute_function, roll_at
from ..plane.vec import Pose, Real
from .contract import AbstractInvoluteGear
from .cutters import HelixAngle, transverse_factors
from .spur import TipRounding, largest_rounding, tip_rounding, toothed

# Points on each curve of a side, and rotations of the gears. They resolve 1e-5 modules within a millisecond.
POINTS, ROTATIONS = 400, 4001


def side_angles(gear: AbstractInvoluteGear) -> tuple[Real, Real]:
    """Rising radii, mm, and half angles, rad, of the tooth's side: root curve, flank and tip edge."""
    curves = [gear.root_curve, gear.flank, *([gear.tip_edge] if gear.tip_edge else [])]
    z = np.concatenate([c.point(np.linspace(c.breaks[0], c.breaks[-1], POINTS)) for c in curves])
    radius, angle = np.abs(z), np.arctan2(z.real, z.imag)
    order = np.argsort(radius, kind="stable")
    return radius[order], angle[order]


def tip_margins(
    gear: AbstractInvoluteGear, mate: AbstractInvoluteGear, distance: float, poses: Callable[[Real], tuple[Pose, Pose]]
) -> tuple[float, float]:
    """Least distances of a gear's tip edges from the roots and from the flanks of its mate; negative inside the teeth.

    In mm along circles; inf if the tips do not come so far. distance: of the axes, mm. poses: function that returns the
    poses of gear and mate at rotations of the gear, rad.
    """
    last = gear.flank.breaks[-1]
    edges = [gear.flank.point(last)]
    if (edge := gear.tip_edge) is not None:
        edges.extend(edge.point(np.linspace(edge.breaks[0], edge.breaks[-1], 9)))
    radii, angles = side_angles(mate)
    # The tip's corner is inside the mate's tip circle within this angle.
    corner_radius = abs(edges[-1])
    cosine = (distance**2 + corner_radius**2 - mate.tip_radius**2) / (2 * distance * corner_radius)
    if mate.is_ring:
        cosine = -cosine
    span = np.arccos(np.clip(cosine, -1, 1)) + np.pi / gear.teeth
    gear_pose, mate_pose = poses(np.linspace(-span, span, ROTATIONS))
    z = mate_pose.locate(gear_pose.place(np.array(edges)[:, None]))
    pitch = 2 * np.pi / mate.teeth
    angle = np.arctan2(z.real, z.imag)
    from_tooth = np.abs(np.mod(angle + pitch / 2, pitch) - pitch / 2)
    radius = np.abs(z)
    margin = (from_tooth - np.interp(radius, radii, angles)) * radius
    within = (radius >= radii[0]) & (radius <= radii[-1])
    in_roots = radius > mate.form_radius if mate.is_ring else radius < mate.form_radius
    at_roots, at_flanks = (float(margin[within & part].min(initial=np.inf)) for part in (in_roots, ~in_roots))
    return at_roots, at_flanks


@record
class InternalMesh:
    """A pinion or cutter in a ring: numbers of teeth, distance of the axes, tip and base radii, in one unit of length.

    Colbourne, The Geometry of Involute Gears, on internal gear pairs; the formulas are derived here.
    """

    pinion_teeth: float
    ring_teeth: float
    distance: float
    pinion_tip: float
    ring_tip: float
    pinion_base: float
    ring_base: float

    @property
    def trochoid_gap(self) -> float:
        """Clearance of the pinion's tip from the ring's tip as it leaves the space, rad of the pinion.

        Negative for trochoid interference; inf if the pinion's tips do not reach those of the ring, -inf if they never
        leave them. When the pinion's tip corner is on the ring's tip circle, the triangle of the two centres and the
        corner gives the rotation of each gear since the flanks of the two corners touched at the pitch point.
        """
        a, pinion, ring = self.distance, self.pinion_tip, self.ring_tip
        # Angles of the corner from the line of centres, at the two centres.
        cosine = (ring**2 - pinion**2 - a**2) / (2 * a * pinion)
        if abs(cosine) >= 1:
            # The pinion's tips pass from space to space of the ring, through its teeth if they do not leave these.
            return float(np.copysign(np.inf, cosine))
        return self._gap(np.arccos(cosine), np.arccos((a**2 + ring**2 - pinion**2) / (2 * a * ring)))

    @property
    def trimming_gap(self) -> float:
        """Clearance of the pinion's tips from the ring's during radial assembly, rad of the pinion.

        Negative for trimming interference: the pinion can then only be inserted along its axis. -inf if the pinion is
        larger than the ring's tip circle.
        """
        tip = self.pinion_base / self.pinion_tip / (self.ring_base / self.ring_tip)
        ratio = self.pinion_teeth / self.ring_teeth
        if tip >= 1 or ratio >= 1:
            return float("inf")
        first = np.sqrt((1 - tip**2) / (1 - ratio**2))
        second = np.sqrt((tip**-2 - 1) / (ratio**-2 - 1))
        if first > 1 or second > 1:
            # Without room for the pinion's tips inside the ring's.
            return float("-inf")
        return self._gap(np.arcsin(first), np.arcsin(second))

    def _gap(self, at_pinion: float, at_ring: float) -> float:
        """Gap between the flanks of two tip corners at given angles about the centres of their gears, rad."""
        working = float(np.sqrt(max((self.distance / (self.ring_base - self.pinion_base)) ** 2 - 1, 0.0)))
        pitch = involute_function(working)
        pinion = at_pinion + involute_function(roll_at(self.pinion_tip, self.pinion_base)) - pitch
        ring = at_ring + involute_function(roll_at(self.ring_tip, self.ring_base)) - pitch
        return float(pinion - ring * self.ring_teeth / self.pinion_teeth)


@record(eq=False)
class PairInterference:
    """Distances of the teeth of two gears in mesh from each other, outside their contact.

    Parameters
    ----------
    first, second : AbstractInvoluteGear
        The driving gear, and the gear or ring that it drives.
    distance : float
        Distance of the axes, mm.
    line_of_action : float
        Length of the line of action between both base circles, mm.
    ratio : float
        Rotations of the first gear for one of the second.
    poses : callable
        Poses of both gears at rotations of the first, rad.
    """

    first: AbstractInvoluteGear
    second: AbstractInvoluteGear
    distance: float
    line_of_action: float
    ratio: float
    poses: Callable[[Real], tuple[Pose, Pose]]

    @property
    def tip_margins(self) -> tuple[float, float]:
        """Least distance of the second gear's tips from the teeth of the first, and of the first's from the second's.

        mm along circles, over the whole path of a tip through the space. 0 means proper contact with a flank, a
        negative value interference with a root or tooth. Accurate to 1e-5 modules.
        """
        of_second, of_first = self.of_tips
        return min(of_second), min(of_first)

    @cached_property
    def of_tips(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """`tip_margins`, each from the roots and from the flanks of the other gear."""
        first, second, distance = self.first, self.second, self.distance
        return (
            tip_margins(second, first, distance, lambda turn: self.poses(turn * self.ratio)[::-1]),
            tip_margins(first, second, distance, self.poses),
        )

    @property
    def involute_margin(self) -> float:
        """Length on the line of action from the first gear's base circle to the tip circle of the second, mm.

        A negative value means involute interference: the first gear's roots are not deep enough.
        """
        if self.second.is_ring:
            return self.second.flank_lengths[0] - self.line_of_action
        return self.line_of_action - self.second.flank_lengths[1]

    @property
    def trochoid_margin(self) -> float:
        """Clearance of the tips of an internal pair outside the contact, rad of the first gear; inf for other pairs.

        -inf if the tips never leave the spaces, so that they run through the teeth.
        """
        return self._internal.trochoid_gap if self.second.is_ring else float("inf")

    @property
    def trimming_margin(self) -> float:
        """Clearance of the ring's tips during radial assembly, rad of the first gear; inf for external pairs."""
        return self._internal.trimming_gap if self.second.is_ring else float("inf")

    @property
    def _internal(self) -> InternalMesh:
        first, second = self.first, self.second
        teeth, tips = (first.teeth, second.teeth), (first.tip_radius, second.tip_radius)
        return InternalMesh(*teeth, self.distance, *tips, first.base_radius, second.base_radius)


@record(checked=True)
class PinionCutter:
    """An involute gear with cutting edges that cuts internal gears, lengths in modules.

    Parameters
    ----------
    teeth : int, optional
        Number of teeth, 4 to 1000.
    pressure_angle_deg : float, optional
        Angle of the flanks, 5 to 45 deg.
    addendum : float, optional
        Height of the teeth above the reference circle, modules.
    tip_radius : float, optional
        Radius of the tip edges, modules; 0 for sharp edges.
    profile_shift : float, optional
        Profile shift, modules; that of a sharpened cutter is smaller than that of a new one.
    fillet_radius : float, optional
        Fillet at the root of the teeth, modules, which rounds the tip edges of the ring. The roots are then as deep as
        the ring's tips need.

    Raises
    ------
    DesignError
        If the teeth are pointed, or their tips have no room for the radius.
    """

    teeth: int = quantity("number of the cutter's teeth", whole=True, default=24, at_least=4, at_most=1000)
    pressure_angle_deg: float = quantity("angle of the flanks", "deg", default=20.0, at_least=5, at_most=45)
    addendum: float = quantity(
        "height of the cutter's teeth above its reference circle", "modules", default=1.25, above=0, at_most=5
    )
    tip_radius: float = quantity("radius of the cutter's tip edges", "modules", default=0.2, at_least=0)
    profile_shift: float = quantity("profile shift of the cutter", "modules", default=0.0, at_least=-5, at_most=5)
    fillet_radius: float = quantity(
        "fillet at the root of the cutter's teeth, which rounds the ring's tips", "modules",
        default=0.0, at_least=0, at_most=10,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if self.outer_radius <= self.base_radius or self._half_angle(self.outer_radius) < 0:
            raise DesignError(
                "addendum",
                f"found {self.addendum:g} with {self.teeth} teeth, for which the flanks meet below the tip or vanish",
                self._whole_addendum(),
            )
        largest = largest_rounding(self.base_radius, self.half_angle_at_base, self.outer_radius)
        if self.tip_radius > largest:
            problem = f"found {self.tip_radius:g}, but the cutter's tips have room for {largest:.4g} modules"
            remedy = f"give at most {rounded_down(largest)}, or a smaller addendum"
            raise DesignError("tip_radius", problem, remedy, value=rounded_down(largest))

    @property
    def pressure_angle(self) -> float:
        """Pressure angle at the reference circle, rad."""
        return float(np.radians(self.pressure_angle_deg))

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> PinionCutter:
        """The transverse section of a cutter for helical teeth whose normal section has these sizes.

        Parameters
        ----------
        helix_angle_deg : float
            Helix angle of the teeth at the pitch circle, 0 to 45 deg.

        Returns
        -------
        PinionCutter
            As for `RackCutter.transverse`.
        """
        pressure_angle, ratio, rounding = transverse_factors(self.pressure_angle, helix_angle_deg)
        return PinionCutter(
            self.teeth,
            float(np.degrees(pressure_angle)),
            self.addendum * ratio,
            self.tip_radius * rounding,
            self.profile_shift * ratio,
            self.fillet_radius * rounding,
        )

    @property
    def base_radius(self) -> float:
        """Radius of the base circle, modules."""
        return self.teeth / 2 * float(np.cos(self.pressure_angle))

    @property
    def outer_radius(self) -> float:
        """Radius of the tip circle, modules."""
        return self.teeth / 2 + self.addendum + self.profile_shift

    @property
    def half_angle_at_base(self) -> float:
        """Half the angle of a tooth on the base circle, rad."""
        a = np.tan(self.pressure_angle)
        return float((np.pi / 2 + 2 * self.profile_shift * a) / self.teeth + involute_function(a))

    @cached_property
    def corner(self) -> TipRounding:
        """The rounding of the tip edges, modules and rad."""
        return tip_rounding(self.base_radius, self.half_angle_at_base, self.outer_radius, self.tip_radius)

    def fillet(self, root_radius: float) -> TipRounding:
        """The root fillet for a root radius, modules and rad; computed as a tip rounding of negative radius."""
        return tip_rounding(self.base_radius, self.half_angle_at_base, root_radius, -self.fillet_radius)

    def edge(self, module: float, root_radius: float | None = None) -> PolarArray:
        """The cutter's outline about its axis, mm, with a tooth centred on +y.

        Below the base circle, where it does not cut, the flanks are straight. module: mm. root_radius: of the roots,
        modules, used if they have a fillet.
        """
        corner, cusp = self.corner, np.exp(1j * (np.pi / 2 - self.half_angle_at_base))
        fillet = self.fillet(root_radius) if self.fillet_radius and root_radius else None
        begin = fillet.roll if fillet else 0.0
        flank = Moved(Involute(module * self.base_radius, begin, corner.roll), Pose(0j, cusp))
        # The depth of the spaces equals the addendum.
        root = min(self.base_radius, self.outer_radius - 2 * self.addendum)
        side: list[AbstractCurve] = [flank]
        half_land = max(0.0, np.pi / self.teeth - self.half_angle_at_base)
        if fillet:
            inward = 1j * np.exp(-1j * fillet.angle)
            end, centre = complex(flank.point(begin)), module * fillet.radius * inward
            start = centre - module * self.fillet_radius * inward
            side.insert(0, Arc(centre, start, float(np.angle((end - centre) / (start - centre)))))
            half_land = max(0.0, np.pi / self.teeth - fillet.angle)
        elif 0 < root < self.base_radius:
            start = complex(flank.point(0.0))
            side.insert(0, Segment(start * root / self.base_radius, start))
        if self.tip_radius:
            towards = 1j * np.exp(-1j * max(0.0, corner.angle))
            start, centre = complex(flank.point(corner.roll)), module * corner.radius * towards
            side.append(Arc(centre, start, float(np.angle(towards / (start - centre)))))
        return toothed(side, self.teeth, half_land)

    def _half_angle(self, radius: float) -> float:
        return self.half_angle_at_base - involute_function(np.sqrt((radius / self.base_radius) ** 2 - 1))

    def _whole_addendum(self) -> str:
        """A remedy: the range of addenda for complete flanks, or other sizes to change."""
        others = "other teeth or profile_shift"
        least = self.base_radius - self.teeth / 2 - self.profile_shift
        if self.half_angle_at_base <= 0:
            return f"give {others}"
        point = self.base_radius * np.hypot(1, inverse_involute(self.half_angle_at_base))
        largest = float(point - self.teeth / 2 - self.profile_shift)
        if largest <= max(least, 0.0) + 1e-5:
            return f"give {others}"
        if self.addendum <= least:
            # Slightly more, so that the flanks have a length.
            return f"give at least {rounded_up(least + 1e-6)} modules, or {others}"
        return f"give at most {rounded_down(largest)} modules, or {others}"


@record
class CutterInRing:
    """A pinion cutter at its full feed in a ring; lengths in modules.

    Parameters
    ----------
    teeth : int
        Number of the ring's teeth.
    profile_shift : float
        Outward shift of the ring's teeth, modules.
    cutter : PinionCutter
        The cutter.
    """

    teeth: int
    profile_shift: float
    cutter: PinionCutter

    @property
    def slope(self) -> float:
        """Tangent of the pressure angle at the reference circle."""
        return float(np.tan(self.cutter.pressure_angle))

    @property
    def base_radius(self) -> float:
        """Radius of the ring's base circle, modules."""
        return self.teeth / 2 * float(np.cos(self.cutter.pressure_angle))

    @property
    def working_involute(self) -> float:
        """Involute function of the working pressure angle; negative if the cutter does not fit."""
        shift = self.profile_shift - self.cutter.profile_shift
        return involute_function(self.slope) + 2 * self.slope * shift / (self.teeth - self.cutter.teeth)

    @property
    def least_shift(self) -> float:
        """Least profile shift for which the cutter fits between the teeth, modules."""
        apart = self.teeth - self.cutter.teeth
        return self.cutter.profile_shift - involute_function(self.slope) * apart / (2 * self.slope)

    @cached_property
    def cutting_angle(self) -> float:
        """Working pressure angle, rad."""
        return float(np.arctan(inverse_involute(self.working_involute)))

    @cached_property
    def distance(self) -> float:
        """Distance of the cutter's axis from the ring's, modules."""
        return (self.base_radius - self.cutter.base_radius) / float(np.cos(self.cutting_angle))
