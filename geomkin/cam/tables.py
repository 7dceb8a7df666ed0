"""The motion of a follower and the coordinates of its cam as a table; its outline at equal angles."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ..arguments import Positive, RealRow, Reals, checked
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Real, Whole
from ..table import Column, Table, finite, xy_columns
from .cam import Cam
from .measures import convex_curvature
from .undercut import Undercut, undercut

# Points looked at in each smooth piece of the outline: fewer may miss that it passes a direction three times.
LOOKS = 129
# Newton's steps from a bracket a hundredth of a piece wide: five reach the last digit, one is spare.
STEPS = 6
# rad; larger takes neighbours for chords that pass, smaller lets a direction slip between two.
ROUNDING = 1e-14


@checked
def cam_table(cam: Cam, speed: Positive, angle: RealRow, cut: Undercut | None = None) -> Table:
    """Follower motion, pressure angle and coordinates at cam angles, rad, of a cam that turns at `speed`, rad/s.

    One row for each angle. Rates are by time; coordinates, mm, are those of profile and pitch curve on the cam, of
    the contact on the ground. Where the follower undercuts, a last column tells the lift that is lost. cut: what
    `undercut` found, where it is known already.

        gk.cam.cam_table(cam, speed=10.0, angle=np.radians(np.arange(360)))

    Source: derived here, by the chain rule from the motion programme.
    """
    motion, (unit, size) = cam.program.motion(angle), cam.follower.lift_unit
    rate = "rad" if cam.follower.oscillates else "mm"
    contact, left = cam.contact(angle), cut or undercut(cam)
    radius = polar_radius(left.outline, angle)
    # At a sharp point of the profile it is infinite, which no number tells.
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
