"""What is read off a cam: pressure angle, curvature, and the worst of both in each segment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Reals, checked
from ..brief import one_line
from ..errors import DesignError
from ..plane.vec import Real
from .cam import Cam
from .maxima import highest, largest, samples


@dataclass(frozen=True, eq=False)
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

    __repr__ = one_line


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
