"""Measures of a cam, pressure angle, curvature and their extremes, and checks that its follower can follow it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import FloatRow, NonZeroFloat, checked
from ..core.errors import DesignError
from ..core.records import record
from ..core.units import mm
from ..model.check import Check
from ..model.table import Column, Table, finite, xy_columns
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Mask, Real, Whole, first_largest
from .cam import Cam
from .program.laws import highest, largest, samples
from .undercut import Undercut, undercut

# Samples in each smooth piece of the outline. Fewer may miss that a piece passes a direction three times.
SAMPLES = 129
# Newton steps from a bracket of a hundredth of a piece: five reach the last digit, the sixth is a reserve.
STEPS = 6
# A row within this distance of a joint, rad, counts as at the joint: the rounding error of angles given in degrees.
JOINT = 1e-9
# rad. A larger value also selects neighbouring chords; with a smaller one a direction may fall between two chords.
ANGLE_ROUNDING = 1e-14


@record(eq=False)
class SegmentLimits:
    """Extreme values in each smooth stretch of a cam's programme.

    Parameters
    ----------
    pressure_angle : ndarray, shape (stretches,)
        Signed pressure angle of the largest size, rad.
    pressure_angle_at : ndarray, shape (stretches,)
        Cam angle of that pressure angle, rad.
    convex_radius : ndarray, shape (stretches,)
        Least radius of curvature of the convex parts of the profile, mm; inf if there are none, 0 or less if the
        follower undercuts the cam. The corner at a joint at which the velocity jumps is not included; `undercut`
        finds it.
    convex_radius_at : ndarray, shape (stretches,)
        Cam angle of that radius, rad.

    Notes
    -----
    These two quantities size a cam: Norton, Cam Design and Manufacturing Handbook. The search for their extremes is
    derived here.
    """

    pressure_angle: Real
    pressure_angle_at: Real
    convex_radius: Real
    convex_radius_at: Real


@checked
def pressure_angle(cam: Cam, angle: float | ArrayLike) -> Real:
    """Signed pressure angle: the angle between the follower's path and the force of the cam on it.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    angle : float or array_like
        Cam angles, rad, any shape.

    Returns
    -------
    ndarray
        Pressure angle, rad, same shape. For a translating follower it is positive if the force points in the direction
        in which the cam's surface passes under the follower; for an oscillating one, if the force pulls the arm away
        from its pivot.

    See Also
    --------
    Cam, undercut, curvature

    Notes
    -----
    Above about 30 deg (45 deg for an arm) the follower binds. Rothbart, Cams (1956), on pressure angle; the sign is a
    convention of this library.

    Examples
    --------
    >>> program = gk.Program((gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360)))
    >>> cam = gk.Cam(gk.TranslatingRoller(10), program, base_radius=40)
    >>> float(np.degrees(gk.pressure_angle(cam, 1.0)).round(3))
    12.907
    """
    return cam.contact(angle).pressure_angle


def convex_curvature(cam: Cam, angle: ArrayLike) -> Real:
    """Curvature of the pitch curve, 1/mm, positive if convex. The roller fits if it is below 1 / roller radius."""
    return -cam.sense * cam.pitch_curve.curvature(angle)


@checked
def segment_limits(cam: Cam) -> SegmentLimits:
    """Extremes of pressure angle and convex radius in each smooth stretch of a cam's programme.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.

    Returns
    -------
    SegmentLimits
        Exact extremes; both sides of every joint are included.

    Notes
    -----
    Derived here.
    """
    breaks = cam.program.breaks
    size, angle = highest(breaks, lambda t: np.abs(pressure_angle(cam, t)))
    radius, radius_at = cam.follower.convex_radius(cam.program, cam.base_radius, cam.sense)
    return SegmentLimits(np.copysign(size, pressure_angle(cam, angle)), angle, radius, radius_at)


def cam_angles(cam: Cam) -> Real:
    """Cam angles, rad, that resolve every segment and both sides of every joint."""
    return samples(cam.program.breaks).ravel()


def tightest_convex(cam: Cam) -> tuple[float, float]:
    """Least radius of curvature of the convex parts of the pitch curve, mm, and its cam angle, rad.

    A roller of a larger radius undercuts the cam. The radius is inf if the pitch curve is nowhere convex.
    """
    curvature, angle = largest(cam.program.breaks, lambda t: convex_curvature(cam, t))
    return (1 / curvature if curvature > 0 else np.inf), angle


def tightest_concave(cam: Cam) -> tuple[float, float]:
    """Least radius of curvature of the concave parts of the pitch curve, mm, inf if none, and its cam angle, rad."""
    curvature, angle = largest(cam.program.breaks, lambda t: -convex_curvature(cam, t))
    return (1 / curvature if curvature > 0 else np.inf), angle


@checked
def contact_travel(cam: Cam) -> tuple[float, float]:
    """Range of a flat face that the cam touches.

    Parameters
    ----------
    cam : Cam
        A cam with a flat-faced follower.

    Returns
    -------
    tuple of float
        Both ends of the range, mm along the face from the follower's origin. The face must cover this range at least.

    Raises
    ------
    DesignError
        If the follower has a roller.

    Notes
    -----
    Derived here. For a translating face the contact lies at the velocity by angle, as in Rothbart, Cams (1956).
    """
    travel = cam.follower.contact_travel(cam.program, cam.base_radius, cam.sense)
    if travel is None:
        problem = "found a roller, which has no face"
        raise DesignError("follower", problem, "give a cam with a flat-faced follower", "wrong-type")
    return travel


@checked
def cam_table(
    cam: Cam, speed: NonZeroFloat, angle: FloatRow, cut: Undercut | None = None, acceleration: float = 0.0
) -> Table:
    """Follower motion, pressure angle and coordinates at given cam angles.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    speed : float
        Angular velocity of the cam at every row, rad/s, positive in the direction of its programme.
    angle : array_like, shape (rows,)
        Cam angles, rad.
    cut : Undercut, optional
        The result of `undercut`, if it is known already.
    acceleration : float, optional
        Angular acceleration of the cam at every row, rad/s2.

    Returns
    -------
    Table
        Rates are by time, and infinite at a joint at which a lower derivative jumps. The time is nan if the cam
        accelerates. Coordinates, mm, of profile and pitch curve are in the cam's frame, those of the contact in the
        ground's. If the follower undercuts the cam, the last column is the lost lift.

    Notes
    -----
    Derived here, by the chain rule from the motion programme.

    Examples
    --------
    >>> program = gk.Program((gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360)))
    >>> cam = gk.Cam(gk.TranslatingRoller(10), program, base_radius=40)
    >>> table = gk.cam.cam_table(cam, speed=10.0, angle=np.radians(np.arange(360)))
    >>> float(table["lift"].max().round(9))
    20.0
    """
    motion, (unit, size) = cam.program.motion(angle), cam.follower.lift_unit
    velocity_jumps, acceleration_jumps = at_jumps(cam, angle)
    rate = "rad" if cam.follower.oscillates else "mm"
    contact, cut = cam.contact(angle), cut or undercut(cam)
    radius = polar_radius(cut.outline, angle)
    second = motion.acceleration * speed**2 + motion.velocity * acceleration
    third = motion.jerk * speed**3 + 3 * motion.acceleration * speed * acceleration
    # Infinite at a cusp of the profile; a table holds nan there.
    curvature = finite(-cam.sense * cam.profile.curvature(angle))
    columns = [
        Column("cam_angle", "deg", "rotation of the cam", np.degrees(angle)),
        Column("time", "s", "time at the recipe's speed", angle / (np.nan if acceleration else abs(speed))),
        Column("lift", unit, "lift of the follower", motion.lift * size),
        _rate("velocity", f"{rate}/s", motion.velocity * speed),
        _rate("acceleration", f"{rate}/s2", np.where(velocity_jumps, np.inf, second)),
        _rate("jerk", f"{rate}/s3", np.where(velocity_jumps | acceleration_jumps, np.inf, third)),
        Column(
            "pressure_angle",
            "deg",
            "angle between the follower's path and the force on it",
            np.degrees(contact.pressure_angle),
        ),
        *_pitch(cam, angle),
        *xy_columns("profile", "mm", "profile in the cam's frame", cam.profile.point(angle)),
        Column("profile_curvature", "1/mm", "curvature of the profile, positive if convex", curvature),
        *xy_columns("contact", "mm", "contact point of follower and cam, in the ground's frame", contact.point),
        Column("outline_radius", "mm", "radius of the cut cam, at cam_angle from the cam's x axis", radius),
    ]
    if cut.found:
        lost = cut.lost_lift(angle) * size
        columns.append(Column("lost_lift", unit, "lift that the follower loses by undercut", lost))
    return Table(tuple(columns))


def at_jumps(cam: Cam, angle: Real) -> tuple[Mask, Mask]:
    """Masks of the angles at a joint at which the velocity jumps, and at which the acceleration jumps."""
    joints, jumps, wrapped = cam.program.breaks, cam.program.jumps, np.mod(angle, 2 * np.pi)
    k = np.searchsorted(joints, wrapped - JOINT)
    at_joint, k = joints[k] <= wrapped + JOINT, k % (len(joints) - 1)
    return at_joint & (jumps.velocity[k] != 0), at_joint & (jumps.acceleration[k] != 0)


def _rate(name: str, unit: str, values: Real) -> Column:
    largest_rate = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    return Column(name, unit, f"{name} of the follower", values, largest_rate)


def _pitch(cam: Cam, angle: Real) -> Iterator[Column]:
    if cam.follower.knife_edge:
        curvature = convex_curvature(cam, angle)
        yield Column("pitch_curvature", "1/mm", "curvature of the pitch curve, positive if convex", curvature)
        yield from xy_columns("pitch", "mm", "pitch curve in the cam's frame", cam.pitch_curve.point(angle))


@checked
def polar_radius(outline: AbstractCurve, angle: float | ArrayLike) -> Real:
    """Distance from the origin to a closed outline about it, in given directions.

    Parameters
    ----------
    outline : AbstractCurve
        A closed curve round the origin, mm.
    angle : float or array_like
        Directions from the x axis, rad, any shape.

    Returns
    -------
    ndarray
        Radius, mm, same shape. If the outline passes a direction more than once, the farthest point counts, which a
        probe from outside touches first. With these radii a cam can be cut on a dividing head and inspected.

    Notes
    -----
    Derived here.
    """
    directions = np.exp(1j * np.asarray(angle, dtype=float).ravel())
    breaks = outline.breaks
    t = np.concatenate([np.linspace(a, b, SAMPLES)[:-1] for a, b in pairwise(breaks)] + [breaks[-1:]])
    k = _farthest_chords(outline.point(t), directions)
    low, high = t[k], t[k + 1]
    parameter = 0.5 * (low + high)
    for _ in range(STEPS):
        rotated = outline.point(parameter) * np.conj(directions)
        slope = np.imag(outline.velocity(parameter) * np.conj(directions))
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope == 0, 0.0, rotated.imag / slope)
        parameter = np.clip(parameter - step, low, high)
    return np.abs(outline.point(parameter)).reshape(np.shape(angle))


def _farthest_chords(z: Complex, directions: Complex) -> Whole:
    """For each direction (m,), the index of the farthest chord of a polygon z (n + 1,) that passes it."""
    order = np.argsort(np.angle(directions))
    rising = np.angle(directions)[order]
    # A chord lies within half a turn of its start, which lies in the middle one of three turns.
    turns = np.concatenate([rising - 2 * np.pi, rising, rising + 2 * np.pi])
    start = np.angle(z[:-1])
    end = start + np.angle(z[1:] / z[:-1])
    # By rounding, a direction through a corner may miss both chords there.
    first = np.searchsorted(turns, np.minimum(start, end) - ANGLE_ROUNDING, side="left")
    counts = np.searchsorted(turns, np.maximum(start, end) + ANGLE_ROUNDING, side="right") - first
    chord = np.repeat(np.arange(len(start)), counts)
    direction = np.arange(len(chord)) - np.repeat(np.cumsum(counts) - counts - first, counts)
    direction = order[direction % len(order)]
    far = np.maximum(np.abs(z[:-1]), np.abs(z[1:]))[chord]
    # The last assignment remains: the farthest chord, and of equally far ones the first along the outline.
    last = np.lexsort([-chord, far])
    farthest = np.zeros(len(directions), int)
    farthest[direction[last]] = chord[last]
    return farthest


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
VELOCITY_ROUNDING = 1e-9


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
            within = f"give a within of at least {mm(table.wide, unit=unit):up2}"
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
    rest = VELOCITY_ROUNDING * np.abs(cam.program.motion(cam_angles(cam)).velocity).max()

    def size(angle: Real) -> Real:
        motion = cam.program.motion(angle)
        contact = cam.follower.contact(motion, cam.base_radius, cam.sense)
        return np.where(direction * motion.velocity > rest, np.abs(contact.pressure_angle), -1.0)

    most, at = largest(cam.program.breaks, size)
    return float(np.degrees(most)), float(np.degrees(at))
