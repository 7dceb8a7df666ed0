"""The motion of a follower, and the coordinates of its cam, as a table."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arguments import Positive, RealRow, checked
from ..plane.vec import Array
from ..table import Column, Table, finite, xy_columns
from .cam import Cam, convex_curvature
from .polar import polar_radius
from .undercut import Undercut, undercut


@checked
def cam_table(cam: Cam, speed: Positive, angle: RealRow, cut: Undercut | None = None) -> Table:
    """Follower motion, pressure angle and coordinates at cam angles, rad, of a cam that turns at `speed`, rad/s.

    cut: what `undercut` found, where it is known already.
    """
    motion, oscillates = cam.program.motion(angle), cam.follower.oscillates
    unit, size = ("deg", 180 / np.pi) if oscillates else ("mm", 1.0)
    rate = "rad" if oscillates else "mm"
    contact, left = cam.contact(angle), cut or undercut(cam)
    radius = polar_radius(left.outline, angle)
    # At a point of the profile no number tells it.
    bend = finite(-cam.sense * cam.profile.curvature(angle))
    columns = [
        Column("cam_angle", "deg", "angle the cam has turned", np.degrees(angle)),
        Column("time", "s", "time at the recipe's speed", angle / speed),
        Column("lift", unit, "lift of the follower", motion.lift * size),
        Column("velocity", f"{rate}/s", "velocity of the follower", motion.velocity * speed),
        Column("acceleration", f"{rate}/s2", "acceleration of the follower", motion.acceleration * speed**2),
        Column("jerk", f"{rate}/s3", "jerk of the follower", motion.jerk * speed**3),
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


def _pitch(cam: Cam, angle: Array) -> Iterator[Column]:
    if cam.follower.rolls:
        bend = convex_curvature(cam, angle)
        yield Column("pitch_curvature", "1/mm", "curvature of the pitch curve, convex +", bend)
        yield from xy_columns("pitch", "mm", "pitch curve on the cam", cam.pitch_curve.point(angle))
