"""The profile of a cam, the root of a gear, the mate of a tooth, each as its tool leaves it; and curves as chords."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...cam.cam import Cam
from ...cam.followers.roller import TranslatingRoller
from ...cam.program.program import Program
from ...cam.program.segments import Dwell, Return, Rise
from ...core.records import record
from ...gear.conjugate.conjugate import conjugate
from ...gear.spur import SpurGear, Tooth
from ...plane.approximation import to_arcs
from ...plane.curve import AbstractCurve
from ...plane.flatten import flatten
from ...plane.joined import Path
from ...plane.primitives import Arc, Polyline
from ...plane.roulettes import Involute, Trochoid, roll_at
from ...plane.vec import Complex, Pose, Real, cross, unit
from ..family import MethodFamily, method
from ..tool import SHARES, Tool

# Cam profile

# Base radius 40 mm, roller 10 mm with 12 mm offset, 3-4-5 rise of 20 mm, cycloidal return.
BASE, ROLLER, OFFSET = 40.0, 10.0, 12.0
LIFT = (Dwell(end_deg=60), Rise("3-4-5", rise=20, end_deg=180), Dwell(end_deg=210), Return("cycloidal", end_deg=360))
PROGRAM = Program(LIFT)
ANGLES = (45, 90, 180, 360, 720, 1440, 2880)


def roller_cam() -> Cam:
    """The cam, made anew."""
    return Cam(TranslatingRoller(ROLLER, OFFSET), PROGRAM, BASE)


def roller() -> Tool:
    """The roller that moves round the cam."""

    def pose(angle: Real) -> Pose:
        # From the definition alone: the roller's centre is e from the axis, at sqrt(Rp^2 - e^2) plus the lift.
        direction = np.exp(-1j * angle)
        height = np.sqrt((BASE + ROLLER) ** 2 - OFFSET**2) + PROGRAM.motion(angle).lift
        return Pose((OFFSET + 1j * height) * direction, direction)

    return Tool(np.array([0j]), ROLLER, pose, (0.0, 2 * np.pi))


@method("closed form", prepared=True, rationale="It is exact, and costs no more than any other.")
def _closed_form(tool: Tool) -> Callable[[], Polyline]:
    """The contact points of the roller, by the normal in closed form, at 360 even cam angles (`Cam.profile`)."""
    angles = 2 * np.pi * np.arange(360) / 360
    return lambda: Polyline(roller_cam().profile.point(angles))


def _centres(tool: Tool, count: float) -> Complex:
    """The roller's centre on the cam at so many even angles, (count,), mm."""
    return np.asarray(tool.pose(2 * np.pi * np.arange(int(count)) / int(count)).origin)


def _step(count: float) -> float:
    """About the displacement of the centre from one position to the next, mm."""
    return 2 * np.pi * (BASE + ROLLER) / count


@method("normals by differences", "angles", ANGLES)
def _by_differences(tool: Tool, count: float) -> Polyline:
    """Roller centres at even angles, each moved by the roller's radius perpendicular to the line of its neighbours."""
    centres = _centres(tool, count)
    # The cam turns counterclockwise, so the centres run clockwise about it: inwards is to their right.
    return Polyline(centres - 1j * tool.rounding * unit(np.roll(centres, -1) - np.roll(centres, 1)))


@method("offset of the pitch polygon", "angles", ANGLES)
def _offset(tool: Tool, count: float) -> Polyline:
    """The polygon through the roller's centres, shrunk by its radius (shapely)."""
    from ...plane import region as region

    # Where the pitch polygon is convex, shrinking it leaves corners, and a tolerance matters only where it is not.
    return Polyline(region.offset([_centres(tool, count)], -tool.rounding, _step(count) ** 2 / 100)[0][0])


@method("envelope by polygons", "angles", ANGLES)
def _envelope(tool: Tool, count: float) -> Polyline:
    """The roller as a polygon, at even angles, cut out of the plane; chords as long as steps (shapely)."""
    from ...plane import region as region

    (whole,) = region.union(tool.polygons(int(count) + 1, _step(count)))
    return Polyline(max(whole[1:], key=len))


CAM_PROFILE = MethodFamily(
    name="cam-profile", title="Cam profile", per="profile", unit="mm", floor=1e-12, problem=roller,
    error=Tool.corner_error, count=lambda *_: 1,
    about="The profile of a roller cam, base radius 40 mm, roller 10 mm, as one closed polygon.",
    reference="brute force: the distance of every corner from the roller, the least over all its positions, without "
    "tangents and envelopes; how well chords follow a curve between its points is another family",
    methods=(_closed_form, _by_differences, _offset, _envelope),
)  # fmt: skip


# Root of a gear, undercut, so that root curve and flank cross

TEETH, MODULE = 12, 2.0
# Points of each exact curve.
POINTS = 50
POSITIONS = (20.0, 40.0, 80.0, 160.0, 320.0, 640.0)
TOLERANCES = (0.1, 0.01, 1e-3, 1e-4)


def gear() -> SpurGear:
    """The gear, made anew."""
    return SpurGear(TEETH, MODULE)


def rack() -> Tool:
    """The rack's tooth that cuts the space beside the tooth on +y."""
    slope = np.radians(20.0)
    # Basic rack profile A of ISO 53, in modules: a tip of dedendum 1.25, rounded by 0.38, as a trapezoid grown so much.
    deep, rounding, high = 1.25 - 0.38, 0.38, 1.5
    half = np.pi / 4 - deep * np.tan(slope) - rounding / np.cos(slope)
    wide = half + (high + deep) * np.tan(slope)
    corners = (1 + 0j) * MODULE * np.array([-half - 1j * deep, half - 1j * deep, wide + 1j * high, -wide + 1j * high])
    pitch = MODULE * TEETH / 2

    def pose(roll: Real) -> Pose:
        # The pitch line rolls on the pitch circle; in the gear's frame it turns round it.
        direction = np.exp(-1j * (roll + np.pi / TEETH))
        return Pose((1j * pitch - pitch * roll) * direction, direction)

    # Far enough that the rack's tooth enters and leaves.
    return Tool(corners, MODULE * rounding, pose, (-0.85, 0.85))


@method(
    "exact curves",
    rationale="It is exact, undercut included, and faster than any method with an error below a micrometre.",
)
def _exact_root(tool: Tool) -> Polyline:
    """Trochoid and involute in closed form, 50 points each, trimmed at their intersection, which is solved for to
    rounding (`SpurGear.outline`).
    """
    tooth, share = gear().tooth, np.linspace(0, 1, POINTS)
    ends = [(c, *c.breaks[[0, -1]]) for c in (tooth.root_curve, tooth.flank)]
    return Polyline(np.concatenate([c.point(a + (b - a) * share) for c, a, b in ends]), None, False)


@method("polylines trimmed", "points", POSITIONS)
def _trimmed(tool: Tool, count: float) -> Polyline | None:
    """The same curves as polylines of so many points each, trimmed where chords cross."""
    tooth = gear().tooth
    incline = np.linspace(0, tooth.pressure_angle - np.pi / 2, int(count))
    trochoid = Trochoid(tooth.pitch_radius, tooth.corner_depth, tooth.corner_rounding, float(incline[-1]), 0.0)
    root = trochoid.point(incline) * 1j * np.exp(1j * (tooth.corner_side / tooth.pitch_radius - np.pi / tooth.teeth))
    flank = _flank(tooth, int(count))
    along, across = np.diff(root)[:, None], np.diff(flank)
    gap, sine = flank[:-1] - root[:-1, None], cross(along, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = cross(gap, across) / sine, cross(gap, along) / sine
    crossings = np.argwhere((u >= 0) & (u <= 1) & (v >= 0) & (v <= 1))
    if not len(crossings):
        return None
    i, j = crossings[0].tolist()
    meeting = root[i] + u[i, j] * along[i, 0]
    return Polyline(np.concatenate([root[: i + 1], [meeting], flank[j + 1 :]]), None, False)


def _flank(tooth: Tooth, count: int) -> Complex:
    """The whole involute from the base circle to the tip, at even steps of its roll."""
    roll = np.linspace(0, roll_at(tooth.tip_radius, tooth.base_radius), count)
    involute = Involute(tooth.base_radius, 0.0, float(roll[-1]))
    return np.asarray(involute.point(roll) * np.exp(1j * (np.pi / 2 - tooth.half_angle_at_base)))


@method("cut by booleans", "positions", POSITIONS)
def _cut_root(tool: Tool, count: float) -> Polyline:
    """The rack's tooth as a polygon at so many positions cut out of the blank (shapely)."""
    made, pitch = gear(), 2 * np.pi / TEETH
    inner, outer = 0.5 * made.root_radius, made.tip_radius
    z = _left_of_sector(tool.polygons(int(count), np.pi * MODULE / count), inner, outer, -pitch, 0)
    angle = np.angle(1j / z)
    # The part that the rack has left, and of that the side towards the tooth on +y.
    kept = (np.abs(z) > 1.01 * inner) & (angle > 1e-9) & (angle <= pitch / 2) & (np.abs(z) < outer * (1 - 1e-9))
    return Polyline(z[kept][np.abs(z[kept]).argsort()], None, False)


def _left_of_sector(tools: list[Complex], inner: float, outer: float, first: float, last: float) -> Complex:
    """Corners of what polygons leave of a sector between two radii and two angles from +y, rad."""
    from ...plane import region as region

    around = 1j * np.exp(1j * np.linspace(first, last, 33))
    found = region.without([np.concatenate([outer * around, inner * around[::-1]])], tools)
    return np.concatenate([loops[0] for loops in found])


@method("arcs", "tolerance, mm", TOLERANCES)
def _root_by_arcs(tool: Tool, tolerance: float) -> Polyline:
    """The exact curves as tangent arcs within a tolerance (`to_arcs`)."""
    return to_arcs(side_of_tooth(), tolerance)


@method("one arc")
def _one_arc(tool: Tool) -> Polyline:
    """As in many drawings: a radial line below the base circle, and from it to the root circle an arc of the rack's tip
    radius. It knows no undercut.
    """
    tooth = gear().tooth
    rho, root = tooth.corner_rounding, tooth.root_radius
    start = 1j * np.exp(-1j * tooth.half_angle_at_base)
    # Its centre is rho from the line and rho from the circle.
    off = np.arcsin(rho / (root + rho))
    centre = (root + rho) * start * np.exp(-1j * off)
    foot = start * (root + rho) * np.cos(off)
    low = root * np.exp(1j * np.angle(centre))
    fillet = Arc(complex(centre), complex(low), float(np.angle((foot - centre) / (low - centre))))
    return Polyline(np.concatenate([fillet.point(np.linspace(0, 1, POINTS)), _flank(tooth, POINTS)]), None, False)


def side_of_tooth() -> Path:
    """Root curve and flank on the right-hand side of the tooth on +y, from the middle of the bottom land up."""
    tooth = gear().tooth
    return Path((tooth.root_curve, tooth.flank))


def _root_error(tool: Tool, found: Polyline | None) -> Real:
    if found is None:
        return np.array([np.nan])
    return tool.corner_error(found) if found.bulges is None else tool.edge_error(found)


GEAR_ROOT = MethodFamily(
    name="gear-root", title="Gear root", per="side of a tooth", unit="mm", floor=1e-12, problem=rack,
    error=_root_error, count=lambda *_: 1,
    about="Root and flank of one side of a tooth of a gear of 12 teeth, module 2, which the rack undercuts.",
    reference="brute force: the distance of every corner, and of points along arcs, from the cutting rack's tooth, the "
    "least over all positions of its roll, without the law of gearing",
    methods=(_exact_root, _trimmed, _cut_root, _root_by_arcs, _one_arc),
)  # fmt: skip


# Mate of a straight-sided tooth of 25 deg: its space, from tip to tip, on the side of -y

STRAIGHT_TEETH, MATE_TEETH = 40, 20
RADIUS, MATE_RADIUS = MODULE * STRAIGHT_TEETH / 2, MODULE * MATE_TEETH / 2
MATE_TIP = MATE_RADIUS + MODULE
# Points of each curve that the exact outline is made of.
CURVE_POINTS = 20
# Radii at which the sampled distances are evaluated, and halvings of the angle there: to 1e-12 of a pitch.
RADII, HALVINGS = 60, 40


def straight_tooth() -> Tool:
    """The tooth, rolling round the mate."""
    slope, high, deep = np.tan(np.radians(25.0)), 1.0, 1.2
    wide, narrow = np.pi / 4 + deep * slope, np.pi / 4 - high * slope
    heights = 1j * np.array([-deep, -deep, high, high])
    corners = 1j * RADIUS + MODULE * (np.array([-wide, wide, narrow, -narrow]) + heights)

    def pose(angle: Real) -> Pose:
        # The gear's axis goes round the mate's, and the gear turns by so much more as the pitch circles roll.
        return Pose(-1j * (RADIUS + MATE_RADIUS) * np.exp(1j * angle), np.exp(1j * angle * (1 + MATE_RADIUS / RADIUS)))

    # The tooth goes through the mate while its axis goes round by a little more than a pitch to either side.
    return Tool(corners, 0.0, pose, (-0.6, 0.6))


@method(
    "law of gearing",
    rationale="It is exact, trimmed corners included, and names the part of the tooth that cuts each curve.",
)
def _law_of_gearing(tool: Tool) -> Complex:
    """Contact where the normal passes through the pitch point, in closed form; curves are trimmed at crossings that are
    solved for to rounding. 20 points per curve (`conjugate`).
    """
    mate = conjugate(Polyline(tool.corners), STRAIGHT_TEETH, RADIUS, MATE_TEETH, MODULE)
    share, pitch = np.linspace(0, 1, CURVE_POINTS), 2 * np.pi / mate.teeth
    z = np.concatenate([step.curve.point(step.start + (step.end - step.start) * share) for step in mate.steps])
    z = z * mate.pose.direction
    return np.asarray(z * np.exp(-1j * pitch * np.round(np.angle(z.mean() / -1j) / pitch)))


@method("cut by booleans", "positions", POSITIONS[1:])
def _cut_space(tool: Tool, count: float) -> Complex:
    """The tooth at so many positions cut out of the blank (shapely)."""
    half, inner = np.pi / MATE_TEETH, 0.5 * MATE_RADIUS
    z = _left_of_sector(tool.polygons(int(count), 1.0), inner, MATE_TIP, np.pi - half, np.pi + half)
    kept = (np.abs(z) < MATE_TIP * (1 - 1e-9)) & (np.abs(z) > 1.01 * inner)
    return np.asarray(z[kept & (np.abs(np.angle(z / -1j)) < half * (1 - 1e-9))])


@method("sampled distances", "positions", POSITIONS[1:])
def _sampled(tool: Tool, count: float) -> Complex:
    """At 60 radii on one side of the space, the angle at which the least distance from the tooth over so many positions
    is 0, by halving.
    """
    positions = np.linspace(*tool.span, int(count))
    radii = np.linspace(MATE_RADIUS - MODULE, MATE_TIP, RADII + 2)[1:-1]
    # From the middle of the space, through which the tooth passes, to that of the mate's tooth, which it never reaches.
    within, beyond = np.zeros(RADII), np.full(RADII, np.pi / MATE_TEETH)
    for _ in range(HALVINGS):
        angle = 0.5 * (within + beyond)
        z = -1j * radii * np.exp(1j * angle)
        off = tool.distance(*np.broadcast_arrays(z[:, None], positions)).min(axis=1)
        within, beyond = np.where(off < 0, angle, within), np.where(off < 0, beyond, angle)
    return np.asarray(-1j * radii * np.exp(0.5j * (within + beyond)))


CONJUGATE_TOOTH = MethodFamily(
    name="conjugate-tooth", title="Conjugate tooth", per="space", unit="mm", floor=1e-12, problem=straight_tooth,
    error=lambda tool, found: np.abs(tool.clearance(found)), count=lambda *_: 1,
    about="The space that a straight-sided tooth, 25 deg, module 2, one of 40, leaves in its mate of 20 teeth.",
    reference="brute force: the distance of every corner from the tooth, the least over all positions of the rolling, "
    "without the law of gearing",
    methods=(_law_of_gearing, _cut_space, _sampled),
)  # fmt: skip


# Flattening

# Where the greedy search looks along a chord, and its halvings.
LOOKS, GREEDY_HALVINGS = np.linspace(0, 1, 101), 30


@record(eq=False)
class ToolPath:
    """A curve, made anew for each call, and the tool that leaves it."""

    curve: Callable[[], AbstractCurve]
    tool: Tool


@method(
    "equal errors",
    "tolerance, mm",
    TOLERANCES,
    rationale="It keeps the tolerance with at most 3 % more chords than the least possible number.",
    caveat="Even steps are as fast, but take two to four times as many vertices, each of which slows down reading, "
    "cutting and meshing; arcs take fewer still, but solids and many programs need chords.",
)
def _equal_errors(path: ToolPath, tolerance: float) -> Polyline:
    """Chords that all have the same error, found by moving the points until they do (`flatten`)."""
    curve = path.curve()
    return Polyline(flatten(curve, tolerance), is_closed=curve.closed)


def at_even_parameters(curve: AbstractCurve, count: int) -> Complex:
    """Points of a closed curve at so many even steps of the parameter from each break to the next."""
    b = curve.breaks
    return curve.point((b[:-1, None] + np.diff(b)[:, None] * np.arange(count) / count).ravel())


@method("even parameters", "tolerance, mm", TOLERANCES)
def _even_parameters(path: ToolPath, tolerance: float) -> Polyline:
    """Even steps of the parameter on each smooth piece, twice as many until three points of each chord are within the
    tolerance.
    """
    curve, count = path.curve(), 2
    b = curve.breaks
    while True:
        steps = np.diff(b)[:, None] * np.arange(count + 1) / count
        t = np.append((b[:-1, None] + steps[:, :-1]).ravel(), b[-1])
        z, inside = curve.point(t), curve.point(t[:-1, None] + np.diff(t)[:, None] * SHARES)
        if (_off(z[:-1], z[1:], inside) <= tolerance).all():
            return Polyline(z[:-1] if curve.closed else z, is_closed=curve.closed)
        count *= 2


@method("halving", "tolerance, mm", TOLERANCES)
def _halving(path: ToolPath, tolerance: float) -> Polyline:
    """Pieces halved until three points of each are within the tolerance of its chord."""
    curve = path.curve()
    t = curve.breaks
    new = np.ones(len(t) - 1, dtype=bool)
    while new.any():
        low, step = t[:-1][new], np.diff(t)[new]
        a, b = curve.point(low), curve.point(low + step)
        far = np.zeros(len(new), dtype=bool)
        # Pieces within the tolerance rest; the others go on as two halves.
        far[new] = _off(a, b, curve.point(low[:, None] + step[:, None] * SHARES)) > tolerance
        t = np.sort(np.concatenate([t, 0.5 * (t[:-1][far] + t[1:][far])]))
        new = np.repeat(far, 1 + far)
    return Polyline(curve.point(t[:-1] if curve.closed else t), is_closed=curve.closed)


def _off(a: Complex, b: Complex, z: Complex) -> Real:
    """Largest distance of points (n, places) from the lines between a and b, (n,)."""
    return np.asarray(np.abs(cross((b - a)[:, None], z - a[:, None])).max(axis=1) / np.abs(b - a))


@method("greedy", "tolerance, mm", TOLERANCES[:3], slow=True)
def _greedy(path: ToolPath, tolerance: float) -> Polyline:
    """From one end to the other, each chord as long as a search by halves finds it may be: the least possible
    number.
    """
    curve = path.curve()
    found: list[float] = []
    for start, last in zip(curve.breaks[:-1].tolist(), curve.breaks[1:].tolist()):
        t = start
        while t < last:
            found.append(t)
            t = _farthest(curve, t, last, tolerance)
    return Polyline(curve.point(np.array(found if curve.closed else [*found, last])), is_closed=curve.closed)


def _farthest(curve: AbstractCurve, t: float, last: float, tolerance: float) -> float:
    """The end of the longest chord from t that keeps the tolerance."""

    def off(end: float) -> float:
        z = curve.point(t + (end - t) * LOOKS)
        return float(np.abs(cross(z[-1] - z[0], z - z[0])).max() / np.abs(z[-1] - z[0]))

    if off(last) <= tolerance:
        return last
    near, far = t, last
    for _ in range(GREEDY_HALVINGS):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if off(middle) <= tolerance else (near, middle)
    return near


@method("arcs", "tolerance, mm", TOLERANCES)
def _arcs(path: ToolPath, tolerance: float) -> Polyline:
    """Tangent arcs that all have the same error (`to_arcs`)."""
    return to_arcs(path.curve(), tolerance)


def _flattening(name: str, title: str, about: str, problem: Callable[[], ToolPath]) -> MethodFamily:
    return MethodFamily(
        name=name, title=title, per="curve", unit="mm", floor=1e-12, problem=problem,
        error=lambda path, found: path.tool.edge_error(found), count=lambda *_: 1, weighed="vertices",
        weigh=lambda _, found: len(found.vertices),
        about=about,
        reference="brute force: the distance of three points along every chord or arc from the tool that leaves the "
        "curve, the least over all its positions",
        methods=(_equal_errors, _even_parameters, _halving, _greedy, _arcs),
    )  # fmt: skip


CAM_FLATTENING = _flattening(
    "cam-flattening",
    "Flattening of a cam",
    "The profile of a roller cam, 60 mm across its rise, as chords or arcs.",
    lambda: ToolPath(lambda: roller_cam().profile, roller()),
)
GEAR_FLATTENING = _flattening(
    "gear-flattening",
    "Flattening of a tooth",
    "Root and flank of one side of a tooth of a gear of 12 teeth, module 2, as chords or arcs.",
    lambda: ToolPath(side_of_tooth, rack()),
)
