"""How straight the path of a point is over a part of the motion: the best line, its length, and the speed along it."""

from __future__ import annotations

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from ..plane.primitives import convex_hull
from ..plane.vec import Complex, Real, dot, unit
from .drive_limits import moved_to
from .motion import Motion

# Drives at which a path is first looked at; a wave of it that is narrower than two of their steps is missed.
PLACES = 241
# Times that drives are added at which the path is farthest from the line or its speed is extreme. Each squares the
# distance to them.
ADDED = 3
# Distance between both ends of a path, as a share of the length of its line, that counts as rounding.
NOTHING = 1e-12


@record
class StraightPart:
    """The straight line that is nearest to a part of the path of a point, as returned by `straight_part`.

    Parameters
    ----------
    start, end : complex
        Ends of the part, projected onto the line, mm.
    deviation : float
        Largest distance of the path from the line, mm; no line has a smaller one. The path lies in a strip of twice
        this width. nan if the linkage is open in the part.
    speed_variation : float
        Largest less least speed along the line, as a share of the mean, at a constant speed of the driver; above 1 if
        the point turns back, inf if it ends where it began.
    """

    start: complex
    end: complex
    deviation: float
    speed_variation: float

    @property
    def length(self) -> float:
        """Length of the line, mm."""
        return abs(self.end - self.start)

    @property
    def direction(self) -> complex:
        """Direction of the line, a unit complex number."""
        return complex(unit(self.end - self.start))


@checked
def straight_part(motion: Motion, point: str, start: float, end: float) -> StraightPart:
    """The best straight line for a part of the path of a point, also between the frames of a motion.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    point : str
        Name of the point.
    start, end : float
        Drives between which the path counts, rad, or mm if a slide drives.

    Returns
    -------
    StraightPart

    Raises
    ------
    DesignError
        If the linkage has no such point, the motion is of many linkages or has no frames, or start and end are equal.

    Notes
    -----
    Derived here: the narrowest strip around points has a side on an edge of their convex hull (Houle and Toussaint,
    Computing the width of a set, IEEE PAMI 10, 1988). Points are added where the path is parallel to the line.

    Examples
    --------
    Hoecken's linkage, whose coupler point leaves its line by 0.012 % of the length:

    >>> import numpy as np
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(50, 20, 65, 65, coupler_point=130), np.linspace(0, 2 * np.pi, 91))
    >>> part = gk.linkage.straight_part(motion, "coupler_point", np.radians(110), np.radians(250))
    >>> f"{part.length:.2f} {part.deviation:.4f} {part.speed_variation:.3f}"
    '72.45 0.0084 0.204'
    """
    if motion.linkage.is_batch or not len(motion.drive) or start == end:
        raise DesignError(
            "motion", "found many linkages, no frames, or a part without length", "give one linkage and two drives"
        )
    sense = -1 if motion.drive[-1] < motion.drive[0] else 1

    def at(drives: Real) -> tuple[Real, Complex, Complex, Complex]:
        path = moved_to(motion, drives).point(point)
        return drives, path.position[1:], path.first[1:], path.second[1:]

    low, high = sorted((start, end), key=lambda drive: sense * drive)
    drives, z, first, second = at(np.linspace(low, high, PLACES))
    if not np.isfinite(z).all():
        return StraightPart(complex(np.nan), complex(np.nan), np.nan, np.nan)
    for _ in range(ADDED):
        direction = _best_line(z)[0]
        across, along, change = dot(first, 1j * direction), dot(first, direction), dot(second, direction)
        zeros = (_zeros(drives, rate) for rate in (across, along, change))
        drives, z, first, second = at(sense * np.unique(sense * np.concatenate([drives, *zeros])))
    direction, through, deviation = _best_line(z)
    along = dot(z - through, direction)
    if along[-1] < along[0]:
        direction, along = -direction, -along
    speed, passed = dot(first, direction) * abs(high - low), float(along[-1] - along[0])
    variation = np.inf if passed <= NOTHING * np.ptp(along) else float(np.ptp(speed) / passed)
    start_point, end_point = (through + direction * float(end) for end in (along.min(), along.max()))
    return StraightPart(start_point, end_point, deviation, variation)


def _best_line(z: Complex) -> tuple[complex, complex, float]:
    """Direction of the line with the least largest distance from points, a point of it, and that distance."""
    hull = np.array(convex_hull(z))
    edges = unit(np.roll(hull, -1) - hull) if len(hull) > 1 else np.ones(1, dtype=complex)
    widths = dot(hull[None] - hull[:, None], 1j * edges[:, None]).max(axis=1)
    best = int(np.argmin(widths))
    return complex(edges[best]), complex(hull[best] + 0.5j * widths[best] * edges[best]), float(widths[best] / 2)


def _zeros(t: Real, values: Real) -> Real:
    """Zeros between neighbouring arguments of opposite sign, by the chord."""
    at = np.flatnonzero(values[1:] * values[:-1] < 0)
    zeros: Real = t[at] + (t[at + 1] - t[at]) * values[at] / (values[at] - values[at + 1])
    return zeros
