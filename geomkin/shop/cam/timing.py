"""The mark that tells how a cam is put on its shaft, and which way it turns."""

from __future__ import annotations

import numpy as np

from ...plane.curve import AbstractCurve
from ...plane.primitives import Arc, Polyline, Segment

# Shares of the ring between the hole and the base circle: the line's ends, and where the arrow runs across it.
LINE, ARROW = (0.2, 0.9), 0.55
# Sweep of the arrow, rad, and length of its head as a share of the ring: seen at a glance, and clear of both edges.
SWEEP, HEAD = np.pi / 4, 0.15


def timing_marks(towards: complex, inner: float, outer: float, sense: int) -> tuple[AbstractCurve, ...]:
    """A radial line in the unit direction `towards`, and from it an arrow the way the part turns.

    Both lie between two circles about the axis, mm. sense: +1 counterclockwise, -1 clockwise.
    """
    ring = outer - inner
    start, end = (towards * (inner + share * ring) for share in LINE)
    arrow = Arc(0j, towards * (inner + ARROW * ring), sense * SWEEP)
    tip = complex(arrow.point(1.0))
    back = -1j * sense * tip / abs(tip) * HEAD * ring
    barbs = np.array([tip + back * np.exp(0.5j), tip, tip + back * np.exp(-0.5j)])
    return Segment(start, end), arrow, Polyline(barbs, is_closed=False)
