"""How far a cam design is from what cannot be cut or does not run well."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arguments import checked
from ..errors import DesignError
from ..plane.vec import Array
from .cam import Cam, convex_curvature, pressure_angle
from .extremes import highest, largest, samples
from .followers.follower import Flat, Roller


@dataclass(frozen=True, eq=False)
class SegmentLimits:
    """The worst of each segment of a cam's programme, (segments,), and the cam angle, rad, where it is.

    pressure_angle: the largest to either side, rad, with its sign. convex_radius: least radius of curvature
    of the profile where it is convex, mm; infinite where it is nowhere convex, 0 or less where the follower
    undercuts. A joint at which the velocity jumps has a corner besides, which `undercut` finds.
    """

    pressure_angle: Array
    pressure_angle_at: Array
    convex_radius: Array
    convex_radius_at: Array


@checked
def segment_limits(cam: Cam) -> SegmentLimits:
    """Pressure angle and convex radius of each segment, at their exact peaks, with both sides of every joint."""
    breaks = cam.program.breaks
    leaning, leaning_at = highest(breaks, lambda t: np.abs(pressure_angle(cam, t)))
    radius, radius_at = _convex_radius(cam)
    return SegmentLimits(np.copysign(leaning, pressure_angle(cam, leaning_at)), leaning_at, radius, radius_at)


def cam_angles(cam: Cam) -> Array:
    """Angles, rad, that see every segment finely and every joint from both sides."""
    return samples(cam.program.breaks).ravel()


def tightest_convex(cam: Cam) -> tuple[float, float]:
    """Least radius of curvature of the pitch curve where it is convex, mm, and the cam angle there, rad.

    A roller of a larger radius undercuts. Infinite where the pitch curve is nowhere convex.
    """
    bend, angle = largest(cam.program.breaks, lambda t: convex_curvature(cam, t))
    return (1 / bend if bend > 0 else np.inf), angle


def contact_travel(cam: Cam) -> tuple[float, float]:
    """Ends of the stretch of a flat face that the cam touches, mm along the face from the follower's origin.

    The face must be as wide at least, and a swinging one reach as far from its pivot.
    """
    if not isinstance(cam.follower, Flat):
        raise DesignError("follower", "a roller has no face", "ask this of a flat-faced follower")

    def along(angle: Array) -> Array:
        return cam.follower_pose(angle).locate(cam.contact(angle).point).real

    breaks = cam.program.breaks
    return -largest(breaks, lambda t: -along(t))[0], largest(breaks, along)[0]


def _convex_radius(cam: Cam) -> tuple[Array, Array]:
    breaks = cam.program.breaks
    if isinstance(cam.follower, Roller):
        # By curvature, which stays finite where the pitch curve is straight and its radius is not.
        bend, at = highest(breaks, lambda t: convex_curvature(cam, t))
        with np.errstate(divide="ignore"):
            return np.where(bend > 0, 1 / np.maximum(bend, 0), np.inf) - cam.follower.roller_radius, at

    def below(angle: Array) -> Array:
        contact = cam.contact(angle)
        return -contact.advance / np.abs(contact.turn)

    radius, at = highest(breaks, below)
    return -radius, at
