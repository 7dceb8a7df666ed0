"""The root of an undercut gear: the exact trochoid, polylines trimmed, a rack cut out by booleans, arcs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.records import record
from ...gear.spur import SpurGear
from ...plane.arcs import to_arcs
from ...plane.joined import Path
from ...plane.primitives import Arc, Polyline
from ...plane.roulettes import Involute, Trochoid, roll_at
from ...plane.vec import Complex, Pose, Real, cross
from ..family import Method, MethodFamily, Tool

# Points of the exact curves, as many on the root curve as on the flank.
POINTS = 50
COUNTS = (20.0, 40.0, 80.0, 160.0, 320.0, 640.0)
TOLERANCES = (0.1, 0.01, 1e-3, 1e-4)


@record(eq=False)
class CutGear:
    """A gear's sizes, from which each method makes its tooth anew, and the rack's tooth that cuts the space beside it.

    What is found is the right-hand side of the tooth on +y, from the middle of the bottom land up.
    """

    teeth: int
    module: float
    tool: Tool

    def gear(self) -> SpurGear:
        return SpurGear(self.teeth, self.module)


def problem() -> CutGear:
    """12 teeth of module 2, pressure angle 20 deg: undercut, so that root curve and flank cross."""
    teeth, module, slope = 12, 2.0, np.radians(20.0)
    # Basic rack profile A of ISO 53, in modules: a tip of dedendum 1.25, rounded by 0.38, as a trapezoid grown so much.
    deep, rounding, high = 1.25 - 0.38, 0.38, 1.5
    half = np.pi / 4 - deep * np.tan(slope) - rounding / np.cos(slope)
    wide = half + (high + deep) * np.tan(slope)
    corners = (1 + 0j) * module * np.array([-half - 1j * deep, half - 1j * deep, wide + 1j * high, -wide + 1j * high])
    pitch = module * teeth / 2

    def place(roll: Real) -> Pose:
        # The pitch line rolls on the pitch circle; seen from the gear it turns round it.
        turned = np.exp(-1j * (roll + np.pi / teeth))
        return Pose((1j * pitch - pitch * roll) * turned, turned)

    # Far enough that the rack's tooth comes and goes.
    return CutGear(teeth, module, Tool(corners, module * rounding, place, (-0.85, 0.85)))


def _exact(cut: CutGear, _: float) -> Callable[[], Polyline]:
    share = np.linspace(0, 1, POINTS)

    def side() -> Polyline:
        tooth = cut.gear().tooth
        ends = [(c, *c.breaks[[0, -1]]) for c in (tooth.root_curve, tooth.flank)]
        return Polyline(np.concatenate([c.point(a + (b - a) * share) for c, a, b in ends]), None, False)

    return side


def _trimmed(cut: CutGear, count: float) -> Callable[[], Polyline | None]:
    """Both curves as polylines, cut off where their chords cross; None where they miss each other."""

    def side() -> Polyline | None:
        tooth = cut.gear().tooth
        lean = np.linspace(0, tooth.pressure_angle - np.pi / 2, int(count))
        trochoid = Trochoid(tooth.pitch_radius, tooth.corner_depth, tooth.corner_rounding, float(lean[-1]), 0.0)
        root = trochoid.point(lean) * 1j * np.exp(1j * (tooth.corner_side / tooth.pitch_radius - np.pi / tooth.teeth))
        roll = np.linspace(0, roll_at(tooth.tip_radius, tooth.base_radius), int(count))
        flank = Involute(tooth.base_radius, 0.0, float(roll[-1])).point(roll) * np.exp(
            1j * (np.pi / 2 - tooth.half_angle_at_base)
        )
        if (found := _crossing(root, flank)) is None:
            return None
        i, j, meeting = found
        return Polyline(np.concatenate([root[: i + 1], [meeting], flank[j + 1 :]]), None, False)

    return side


def _crossing(one: Complex, other: Complex) -> tuple[int, int, complex] | None:
    """The first edges of two polylines that cross, and where; None where none do."""
    along, across = np.diff(one)[:, None], np.diff(other)
    gap, turn = other[:-1] - one[:-1, None], cross(along, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = cross(gap, across) / turn, cross(gap, along) / turn
    crossing = np.argwhere((u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)).tolist()
    return next(((i, j, complex(one[i] + u[i, j] * along[i, 0])) for i, j in crossing), None)


def _cut(cut: CutGear, count: float) -> Callable[[], Polyline]:
    """The rack's tooth as a polygon, at even steps of its roll, cut out of a sector."""
    from ...plane import region as region

    def side() -> Polyline:
        gear, pitch = cut.gear(), 2 * np.pi / cut.teeth
        inner, outer = 0.5 * gear.root_radius, gear.tip_radius
        around = 1j * np.exp(-1j * np.linspace(0, pitch, 33))
        blank = np.concatenate([inner * around, outer * around[::-1]])
        found = region.without([blank], cut.tool.polygons(int(count), np.pi * gear.module / count))
        z = np.concatenate([loops[0] for loops in found])
        turned = np.angle(1j / z)
        # What the rack has left, and of that the side towards the tooth on +y.
        kept = (np.abs(z) > 1.01 * inner) & (turned > 1e-9) & (turned <= pitch / 2) & (np.abs(z) < outer * (1 - 1e-9))
        return Polyline(z[kept][np.abs(z[kept]).argsort()], None, False)

    return side


def _arcs(cut: CutGear, tolerance: float) -> Callable[[], Polyline]:
    def side() -> Polyline:
        tooth = cut.gear().tooth
        return to_arcs(Path((tooth.root_curve, tooth.flank)), tolerance)

    return side


def _error(cut: CutGear, found: Polyline | None) -> Real:
    if found is None:
        return np.array([np.nan])
    return cut.tool.corner_error(found) if found.bulges is None else cut.tool.edge_error(found)


def _one_arc(cut: CutGear, _: float) -> Callable[[], Polyline]:
    """A radial line from the base circle in, and between it and the root circle an arc of the rack's tip radius."""

    def side() -> Polyline:
        tooth = cut.gear().tooth
        rho, root = tooth.corner_rounding, tooth.root_radius
        start = 1j * np.exp(-1j * tooth.half_angle_at_base)
        # Its centre stands rho off the line and rho off the circle.
        off = np.arcsin(rho / (root + rho))
        centre = (root + rho) * start * np.exp(-1j * off)
        foot = start * (root + rho) * np.cos(off)
        low = root * np.exp(1j * np.angle(centre))
        fillet = Arc(complex(centre), complex(low), float(np.angle((foot - centre) / (low - centre))))
        roll = np.linspace(0, roll_at(tooth.tip_radius, tooth.base_radius), POINTS)
        turned = np.exp(1j * (np.pi / 2 - tooth.half_angle_at_base))
        flank = Involute(tooth.base_radius, 0.0, float(roll[-1])).point(roll) * turned
        return Polyline(np.concatenate([fillet.point(np.linspace(0, 1, POINTS)), flank]), None, False)

    return side


GEAR_ROOT: MethodFamily[CutGear, Polyline | None] = MethodFamily(
    name="gear-root",
    title="Gear root",
    about="Root and flank of one side of a tooth of a gear of 12 teeth, module 2, which the rack undercuts.",
    per="side of a tooth",
    unit="mm",
    reference="brute force: the distance of every corner, and of places along arcs, from the cutting rack's tooth, the "
    "least over all positions of its roll, without the law of gearing",
    floor=1e-12,
    problem=problem,
    count=lambda _, found: 1,
    error=_error,
    methods=(
        Method(
            "exact curves",
            f"Trochoid and involute in closed form, {POINTS} points each, cut off where they cross, which is solved "
            "for to rounding (`SpurGear.outline`).",
            _exact,
            rationale="It is exact, undercut included, and faster than any method with an error below a micrometre.",
        ),
        Method(
            "polylines trimmed",
            "The same curves as polylines of so many points each, cut off where chords cross.",
            _trimmed,
            "points",
            COUNTS,
        ),
        Method(
            "cut by booleans",
            "The rack's tooth as a polygon at so many positions cut out of the blank (shapely).",
            _cut,
            "positions",
            COUNTS,
        ),
        Method(
            "arcs",
            "The exact curves as tangent arcs within a tolerance (`to_arcs`).",
            _arcs,
            "tolerance, mm",
            TOLERANCES,
        ),
        Method(
            "one arc",
            "As in many drawings: a radial line below the base circle, and from it to the root circle an arc of the "
            "rack's tip radius. It knows no undercut.",
            _one_arc,
        ),
    ),
)
