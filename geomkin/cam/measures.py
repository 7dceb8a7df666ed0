"""What is read off a cam: pressure angle and curvature, the worst of both in each segment, and all of it as a table."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import Positive, RealRow, Reals, checked
from ..core.errors import DesignError
from ..core.records import record
from ..model.table import Column, Table, finite, xy_columns
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Mask, Real, Whole
from .cam import Cam
from .extrema import highest, largest, samples
from .undercut import Undercut, undercut

# Points looked at in each smooth piece of the outline: fewer may miss that it passes a direction three times.
LOOKS = 129
# Newton's steps from a bracket a hundredth of a piece wide: five reach the last digit, one is spare.
STEPS = 6
# rad from a joint within which a row is at the joint: what rounding of degrees explains.
JOINT = 1e-9
# rad; larger takes neighbours for chords that pass, smaller lets a direction slip between two.
ROUNDING = 1e-14


@record(eq=False)
class SegmentLimits:
    """The worst of each smooth stretch of a cam's programme, (stretches,), and the cam angle, rad, where it is.

    pressure_angle: the largest to either side, rad, with its sign. convex_radius: least radius of curvature
    of the profile where it is convex, mm; infinite where it is nowhere convex, 0 or less where the follower
    undercuts. A joint at which the velocity jumps has a corner besides, which `undercut` finds.

    Source: the two quantities that size a cam, after Norton, Cam Design and Manufacturing Handbook; their extremes
    are found here.
    """

    pressure_angle: Real
    pressure_angle_at: Real
    convex_radius: Real
    convex_radius_at: Real


@checked
def pressure_angle(cam: Cam, angle: Reals) -> Real:
    """Signed angle, rad, between the follower's path and the force on it, at cam angles in rad.

    Of a follower that moves straight, positive when the force leans the way the cam's surface runs under it;
    of one on an arm, when the force pulls the arm away from its pivot. Above about 30 deg (45 on an arm) the
    follower binds.

    Source: Rothbart, Cams (1956), on pressure angle; the sign is a convention of this library.
    """
    return cam.contact(angle).pressure_angle


def convex_curvature(cam: Cam, angle: ArrayLike) -> Real:
    """Curvature of the pitch curve, 1/mm, positive where convex; the roller fits while it is below 1 / its radius."""
    return -cam.sense * cam.pitch_curve.curvature(angle)


@checked
def segment_limits(cam: Cam) -> SegmentLimits:
    """Pressure angle and convex radius of each segment, at their exact peaks, with both sides of every joint.
    Derived here.
    """
    breaks = cam.program.breaks
    leaning, leaning_at = highest(breaks, lambda t: np.abs(pressure_angle(cam, t)))
    radius, radius_at = cam.follower.convex_radius(cam.program, cam.base_radius, cam.sense)
    return SegmentLimits(np.copysign(leaning, pressure_angle(cam, leaning_at)), leaning_at, radius, radius_at)


def cam_angles(cam: Cam) -> Real:
    """Angles, rad, that see every segment finely and every joint from both sides."""
    return samples(cam.program.breaks).ravel()


def tightest_convex(cam: Cam) -> tuple[float, float]:
    """Least radius of curvature of the pitch curve where it is convex, mm, and the cam angle there, rad.

    A roller of a larger radius undercuts. Infinite where the pitch curve is nowhere convex.
    """
    bend, angle = largest(cam.program.breaks, lambda t: convex_curvature(cam, t))
    return (1 / bend if bend > 0 else np.inf), angle


@checked
def contact_travel(cam: Cam) -> tuple[float, float]:
    """Ends of the stretch of a flat face that the cam touches, mm along the face from the follower's origin.

    The face must be as wide at least, and a swinging one reach as far from its pivot. DesignError of a roller.

    Source: derived here; of a straight face it is the velocity by angle, as in Rothbart, Cams (1956).
    """
    travel = cam.follower.contact_travel(cam.program, cam.base_radius, cam.sense)
    if travel is None:
        raise DesignError("follower", "a roller has no face", "ask this of a flat-faced follower")
    return travel


@checked
def cam_table(
    cam: Cam, speed: Positive, angle: RealRow, cut: Undercut | None = None, acceleration: float = 0.0
) -> Table:
    """Follower motion, pressure angle and coordinates at cam angles.

    Parameters
    ----------
    cam : Cam
    speed, acceleration : float
        Of the cam at every row, rad/s and rad/s2, counted in the direction in which it turns.
    angle : array, shape (rows,)
        Cam angles, rad.
    cut : Undercut, optional
        The result of `undercut`, if it is known already.

    Returns
    -------
    Table
        Rates are by time, infinite at a joint where a lower one jumps; time is nan if the cam accelerates.
        Coordinates, mm, of profile and pitch curve are on the cam, those of the contact on the ground. If the
        follower undercuts, a last column has the lost lift.

    Notes
    -----
    Derived here, by the chain rule from the motion program.

    Examples
    --------
    >>> table = gk.cam.cam_table(cam, speed=10.0, angle=np.radians(np.arange(360)))
    """
    motion, (unit, size) = cam.program.motion(angle), cam.follower.lift_unit
    step, smooth_step = _at_steps(cam, angle)
    rate = "rad" if cam.follower.oscillates else "mm"
    contact, left = cam.contact(angle), cut or undercut(cam)
    radius = polar_radius(left.outline, angle)
    second = motion.acceleration * speed**2 + motion.velocity * acceleration
    third = motion.jerk * speed**3 + 3 * motion.acceleration * speed * acceleration
    # At a sharp point of the profile it is infinite, which no number tells.
    bend = finite(-cam.sense * cam.profile.curvature(angle))
    columns = [
        Column("cam_angle", "deg", "angle the cam has turned", np.degrees(angle)),
        Column("time", "s", "time at the recipe's speed", angle / (np.nan if acceleration else speed)),
        Column("lift", unit, "lift of the follower", motion.lift * size),
        _rate("velocity", f"{rate}/s", motion.velocity * speed),
        _rate("acceleration", f"{rate}/s2", np.where(step, np.inf, second)),
        _rate("jerk", f"{rate}/s3", np.where(step | smooth_step, np.inf, third)),
        Column("pressure_angle", "deg", "between path and force", np.degrees(contact.pressure_angle)),
        *_pitch(cam, angle),
        *xy_columns("profile", "mm", "profile on the cam", cam.profile.point(angle)),
        Column("profile_curvature", "1/mm", "curvature of the profile, convex +", bend),
        *xy_columns("contact", "mm", "where follower and cam touch, on the ground", contact.point),
        Column("outline_radius", "mm", "outline of the cut cam in the direction of cam_angle from its x axis", radius),
    ]
    if left.found:
        lost = left.lost_lift(angle) * size
        columns.append(Column("lost_lift", unit, "how far undercut leaves the follower below its lift", lost))
    return Table(tuple(columns))


def _at_steps(cam: Cam, angle: Real) -> tuple[Mask, Mask]:
    """Which angles are those of a joint at which the velocity jumps, and at which the acceleration does."""
    joints, jumps, turned = cam.program.breaks, cam.program.jumps, np.mod(angle, 2 * np.pi)
    k = np.searchsorted(joints, turned - JOINT)
    there, k = joints[k] <= turned + JOINT, k % (len(joints) - 1)
    return there & (jumps.velocity[k] != 0), there & (jumps.acceleration[k] != 0)


def _rate(name: str, unit: str, values: Real) -> Column:
    return Column(
        name, unit, f"{name} of the follower", values, float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    )


def _pitch(cam: Cam, angle: Real) -> Iterator[Column]:
    if cam.follower.knife_edge:
        bend = convex_curvature(cam, angle)
        yield Column("pitch_curvature", "1/mm", "curvature of the pitch curve, convex +", bend)
        yield from xy_columns("pitch", "mm", "pitch curve on the cam", cam.pitch_curve.point(angle))


@checked
def polar_radius(outline: AbstractCurve, angle: Reals) -> Real:
    """Distance from the origin to a closed outline about it, mm, in the directions of `angle`, rad; any shape.

    Where the outline passes a direction more than once, the farthest point counts: what a probe from outside meets,
    so that a cam can be cut on a dividing head and inspected. Derived here.
    """
    directions = np.exp(1j * np.asarray(angle, dtype=float).ravel())
    breaks = outline.breaks
    t = np.concatenate([np.linspace(a, b, LOOKS)[:-1] for a, b in pairwise(breaks)] + [breaks[-1:]])
    k = _farthest(outline.point(t), directions)
    low, high = t[k], t[k + 1]
    place = 0.5 * (low + high)
    for _ in range(STEPS):
        here = outline.point(place) * np.conj(directions)
        slope = np.imag(outline.velocity(place) * np.conj(directions))
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope == 0, 0.0, here.imag / slope)
        place = np.clip(place - step, low, high)
    return np.abs(outline.point(place)).reshape(np.shape(angle))


def _farthest(z: Complex, directions: Complex) -> Whole:
    """Of the chords of a polygon z (n + 1,) that pass directions (m,), the number of the farthest for each, (m,)."""
    order = np.argsort(np.angle(directions))
    rising = np.angle(directions)[order]
    # A chord lies within half a turn of its start, which lies within the middle one of three turns.
    turns = np.concatenate([rising - 2 * np.pi, rising, rising + 2 * np.pi])
    start = np.angle(z[:-1])
    end = start + np.angle(z[1:] / z[:-1])
    # A direction through a corner may pass both chords there by rounding.
    first = np.searchsorted(turns, np.minimum(start, end) - ROUNDING, side="left")
    counts = np.searchsorted(turns, np.maximum(start, end) + ROUNDING, side="right") - first
    chord = np.repeat(np.arange(len(start)), counts)
    passed = np.arange(len(chord)) - np.repeat(np.cumsum(counts) - counts - first, counts)
    passed = order[passed % len(order)]
    far = np.maximum(np.abs(z[:-1]), np.abs(z[1:]))[chord]
    # The last that is written stays: the farthest, and of equals the first along the outline.
    last = np.lexsort([-chord, far])
    found = np.zeros(len(directions), int)
    found[passed[last]] = chord[last]
    return found
