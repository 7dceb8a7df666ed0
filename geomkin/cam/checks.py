"""Whether a cam drives its follower well, and whether the follower can follow it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..core.arguments import checked
from ..core.fields import rounded_up
from ..model.check import Check
from ..plane.vec import Real, first_largest
from .cam import Cam
from .measures import cam_angles, segment_limits, tightest_convex
from .program.extrema import largest
from .undercut import Undercut, undercut

# deg. With a larger angle a guide binds, a smaller one requires larger cams. 30 for straight followers is the rule of
# Rothbart, Cams (1956). An arm swings away from the force and allows more: Norton, Design of Machinery, ch. 8, gives
# about 35; 45 is chosen here.
MOST_PRESSURE_ANGLE_DEG = {"straight": 30, "arm": 45}
# Least radius of the pitch curve over the roller's. At 1 the cam is pointed, and towards it the stress in the flank
# rises without limit. Norton, Design of Machinery, ch. 8, advises 2 to 3; 1.5 is chosen here.
LEAST_PITCH_TO_ROLLER = 1.5
# mm. A sharper edge wears off under a flat face or a knife edge; chosen here, as the chamfer of a deburred edge.
LEAST_CONVEX_RADIUS = 1
# Share of the peak acceleration that may be due to scatter of a table's rows. A larger one can be felt and heard;
# chosen here.
MOST_NOISE = 0.1

# Largest number of cam angles that an advice lists.
MOST_ANGLES = 4
# Laws that begin and end without acceleration, as a dwell does.
SMOOTH = "cycloidal, modified-sine, modified-trapezoid or 3-4-5"

# Velocity, as a share of the largest one, up to which the follower counts as resting. A larger value omits angles at
# which it moves.
ROUNDING = 1e-9


def most_pressure_angle(cam: Cam) -> float:
    """The usual limit of the pressure angle for the follower of a cam, deg."""
    return MOST_PRESSURE_ANGLE_DEG["arm" if cam.follower.oscillates else "straight"]


@checked
def cam_checks(cam: Cam, cut: Undercut | None = None) -> tuple[Check, ...]:
    """Check whether a cam drives its follower well.

    Parameters
    ----------
    cam : Cam
        The cam.
    cut : Undercut, optional
        Result of `undercut(cam)`, if it is known already.

    Returns
    -------
    tuple of Check
        Pressure angles of rise and return, deg; jumps of velocity and acceleration; scatter of tables; the margin
        before undercut, or the lift lost to it.

    Notes
    -----
    The limits are constants of this module, with their sources: Rothbart, Cams (1956), and Norton, Design of Machinery.

    Examples
    --------
    >>> import geomkin as gk
    >>> program = gk.Program([gk.Rise("cycloidal", 20, end_deg=180), gk.Return("cycloidal", end_deg=360)])
    >>> cam = gk.Cam(gk.TranslatingRoller(10), program, base_radius=40)
    >>> [check.id for check in gk.cam.cam_checks(cam) if not check.passed]
    []
    """
    return tuple(_checks(cam, cut or undercut(cam)))


def _checks(cam: Cam, cut: Undercut) -> Iterator[Check]:
    for name, direction in (("rise", 1), ("return", -1)):
        largest_angle, at = _largest_pressure_angle(cam, direction)
        if largest_angle >= 0:
            id, words = f"pressure_angle_{name}", f"pressure angle on the {name}"
            advice = "give a larger base_radius or a longer segment"
            limit = most_pressure_angle(cam)
            yield Check(id, words, largest_angle, "at most", limit, "deg", advice, "pressure_angle", at)
    jumps = np.abs(cam.program.jumps.velocity)
    if jumps.any():
        at = float(np.degrees(cam.program.breaks[:-1][first_largest(jumps)]))
        advice = f"infinite acceleration, worst at {at:.4g} deg: start and end the motion with a law that rests there"
        unit = "mm/rad or rad/rad"
        yield Check("velocity_jump", "jump in velocity", jumps.max(), "at most", 0, unit, advice, "velocity", at)
    jumps = np.abs(cam.program.jumps.acceleration)
    if jumps.any():
        joints = np.degrees(cam.program.breaks[:-1])
        angles, at = joints[jumps > 0], float(joints[first_largest(jumps)])
        listed = ", ".join(f"{angle:.4g}" for angle in angles[:MOST_ANGLES])
        listed += " and more" * (len(angles) > MOST_ANGLES)
        advice = f"infinite jerk at {listed} deg: give laws that meet there in acceleration, such as {SMOOTH}"
        unit = f"{'rad' if cam.follower.oscillates else 'mm'}/rad2"
        name, column = "jump in acceleration", "acceleration"
        yield Check("acceleration_jump", name, jumps.max(), "at most", 0, unit, advice, column, at)
    for k, table in cam.program.tables.items():
        # Unknown scatter gives no check.
        if not np.isnan(table.noise):
            unit = "deg" if cam.follower.oscillates else "mm"
            within = f"give a within of at least {rounded_up(table.wide, 2)} {unit}"
            advice = f"the curve of program[{k}] follows the scatter of its rows: {within}"
            if np.isinf(table.noise):
                advice += ", or replace it by a dwell or a uniform motion: the rows show no other motion"
            name = f"acceleration from scatter of the rows of program[{k}]"
            yield Check(f"scatter_{k}", name, table.noise, "at most", MOST_NOISE, "of the peak", advice)
    yield from _undercut_checks(cam, cut)


def _undercut_checks(cam: Cam, cut: Undercut) -> Iterator[Check]:
    """Margin before undercut, or the lost lift if the cam is undercut."""
    roller = cam.follower.roller_radius
    if roller:
        tightest, angle = tightest_convex(cam)
        at = float(np.degrees(angle)) if np.isfinite(tightest) else None
        name, least = "least pitch radius to roller radius", LEAST_PITCH_TO_ROLLER
        advice = "near 1 the profile becomes pointed: enlarge the base circle"
        yield Check("pitch_radius", name, tightest / roller, "at least", least, "", advice, at=at)
    if cut.found:
        (lost, angle), (unit, size) = cut.worst, cam.follower.lift_unit
        at = float(np.degrees(angle))
        advice = f"undercut, worst at {at:.4g} deg: give a larger base_radius or a longer segment there"
        yield Check("lost_lift", "lift lost to undercut", lost * size, "at most", 0, unit, advice, "lost_lift", at)
    elif not roller:
        sharpest = float(segment_limits(cam).convex_radius.min())
        advice = "a sharp edge wears: give a larger base_radius"
        name, least = "least convex radius of the profile", LEAST_CONVEX_RADIUS
        yield Check("convex_radius", name, sharpest, "at least", least, "mm", advice)


def _largest_pressure_angle(cam: Cam, direction: int) -> tuple[float, float]:
    """Largest pressure angle while the follower moves outwards (1) or inwards (-1), and its cam angle, deg.

    The pressure angle is negative if the follower never moves in that direction.
    """
    # The velocity of a resting follower is a rounding error of either sign.
    rest = ROUNDING * np.abs(cam.program.motion(cam_angles(cam)).velocity).max()

    def size(angle: Real) -> Real:
        motion = cam.program.motion(angle)
        contact = cam.follower.contact(motion, cam.base_radius, cam.sense)
        return np.where(direction * motion.velocity > rest, np.abs(contact.pressure_angle), -1.0)

    most, at = largest(cam.program.breaks, size)
    return float(np.degrees(most)), float(np.degrees(at))
