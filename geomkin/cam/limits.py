"""How far a cam design is from what cannot be cut."""

from __future__ import annotations

import numpy as np

from ..plane.vec import Array
from .cam import Cam, convex_curvature

# Cam angles looked at in each segment. Curvature is as smooth as the law's second derivative, so its
# peak between two of them is within 1e-4 of the larger.
SAMPLES = 256


def cam_angles(cam: Cam) -> Array:
    """Angles, rad, that see every segment finely and every joint from both sides."""
    b = cam.program.breaks
    inside = b[:-1, None] + np.diff(b)[:, None] * np.linspace(0, 1, SAMPLES)
    inside[:, -1] = np.nextafter(inside[:, -1], 0)
    return inside.ravel()


def tightest_convex(cam: Cam) -> tuple[float, float]:
    """Least radius of curvature of the pitch curve where it is convex, mm, and the cam angle there, rad.

    A roller of a larger radius undercuts. Infinite where the pitch curve is nowhere convex.
    """
    angles = cam_angles(cam)
    bend = convex_curvature(cam, angles)
    k = int(bend.argmax())
    return (1 / bend[k].item() if bend[k] > 0 else np.inf), angles[k].item()
