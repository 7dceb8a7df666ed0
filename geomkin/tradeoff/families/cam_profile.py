"""The profile of a roller cam: closed form, envelopes of polygons, offsets of a polygon, differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...cam.cam import Cam
from ...cam.followers.roller import TranslatingRoller
from ...cam.program.program import Program
from ...cam.program.segments import Dwell, Return, Rise
from ...core.records import record
from ...plane.primitives import Polyline
from ...plane.vec import Complex, Pose, Real, unit
from ..family import Method, MethodFamily, Tool

# Points of the closed form.
POINTS = 360
# Positions of the roller.
COUNTS = (45, 90, 180, 360, 720, 1440, 2880)


@record(eq=False)
class RollerCam:
    """A cam's sizes, from which each method makes its profile anew, and the roller that moves round it."""

    follower: TranslatingRoller
    program: Program
    base_radius: float
    tool: Tool

    def cam(self) -> Cam:
        return Cam(self.follower, self.program, self.base_radius)


def problem() -> RollerCam:
    """Base radius 40, roller 10 with 12 mm offset, 3-4-5 rise of 20 mm, cycloidal return."""
    follower = TranslatingRoller(10.0, 12.0)
    segments = (
        Dwell(end_deg=60),
        Rise("3-4-5", rise=20, end_deg=180),
        Dwell(end_deg=210),
        Return("cycloidal", end_deg=360),
    )
    program = Program(segments)

    def place(angle: Real) -> Pose:
        # From the definition alone: the roller's centre stands e beside the axis, at sqrt(Rp^2 - e^2) plus the lift.
        turned = np.exp(-1j * angle)
        return Pose((12 + 1j * (np.sqrt(50.0**2 - 12**2) + program.motion(angle).lift)) * turned, turned)

    # A little over a turn: every position has neighbours on both sides.
    return RollerCam(follower, program, 40.0, Tool(np.array([0j]), 10.0, place, (0.0, 2 * np.pi)))


def _closed_form(roller_cam: RollerCam, _: float) -> Callable[[], Polyline]:
    angles = 2 * np.pi * np.arange(POINTS) / POINTS
    return lambda: Polyline(roller_cam.cam().profile.point(angles))


def pitch_points(roller_cam: RollerCam, count: float) -> Complex:
    """The roller's centre on the cam at so many even angles, (count,), mm."""
    return np.asarray(roller_cam.tool.pose(2 * np.pi * np.arange(int(count)) / int(count)).origin)


def _by_differences(roller_cam: RollerCam, count: float) -> Callable[[], Polyline]:
    """Each centre moved by the roller's radius, square to the line through its two neighbours."""

    def profile() -> Polyline:
        centres = pitch_points(roller_cam, count)
        # The cam turns counterclockwise, so the centres run clockwise about it: inwards is to their right.
        along = unit(np.roll(centres, -1) - np.roll(centres, 1))
        return Polyline(centres - 1j * roller_cam.tool.rounding * along)

    return profile


def _offset(roller_cam: RollerCam, count: float) -> Callable[[], Polyline]:
    """The polygon through the centres, shrunk by the roller's radius."""
    from ...plane import region as region

    def profile() -> Polyline:
        centres = pitch_points(roller_cam, count)
        # Where the pitch polygon is convex, shrinking it leaves corners, and a tolerance counts only where it is not.
        return Polyline(region.offset([centres], -roller_cam.tool.rounding, _step(count) ** 2 / 100)[0][0])

    return profile


def _cut(roller_cam: RollerCam, count: float) -> Callable[[], Polyline]:
    """The hole that is left in the union of the roller at all positions."""
    from ...plane import region as region

    def profile() -> Polyline:
        (whole,) = region.union(roller_cam.tool.polygons(int(count) + 1, _step(count)))
        holes = sorted(whole[1:], key=len)
        return Polyline(holes[-1])

    return profile


def _step(count: float) -> float:
    """About the way of the centre from one position to the next, mm."""
    return 2 * np.pi * 50 / count


CAM_PROFILE: MethodFamily[RollerCam, Polyline] = MethodFamily(
    name="cam-profile",
    title="Cam profile",
    about="The profile of a roller cam, base radius 40 mm, roller 10 mm, as one closed polygon.",
    per="profile",
    unit="mm",
    reference="brute force: the distance of every corner from the roller, the least over all its positions, without "
    "tangents and envelopes; how well chords follow a curve between its points is another family",
    floor=1e-12,
    problem=problem,
    count=lambda _, found: 1,
    error=lambda roller_cam, found: roller_cam.tool.corner_error(found),
    methods=(
        Method(
            "closed form",
            f"Where the roller touches, by the normal in closed form, at {POINTS} even cam angles (`Cam.profile`).",
            _closed_form,
            because="It is exact, and costs no more than any other.",
        ),
        Method(
            "normals by differences",
            "Roller centres at even angles, each moved by the roller's radius square to the line of its neighbours.",
            _by_differences,
            "angles",
            COUNTS,
        ),
        Method(
            "offset of the pitch polygon",
            "The polygon through the roller's centres, shrunk by its radius (shapely).",
            _offset,
            "angles",
            COUNTS,
        ),
        Method(
            "envelope by polygons",
            "The roller as a polygon, at even angles, cut out of the plane; chords as long as steps (shapely).",
            _cut,
            "angles",
            COUNTS,
        ),
    ),
)
