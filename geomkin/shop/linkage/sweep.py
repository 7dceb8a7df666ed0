"""How near moving plates and pins come to each other, between frames too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...cached import cached_property
from ...linkage.motion import Motion
from ...plane.hulls import separation
from ...plane.vec import Array, Complex, Real, Whole, dot

# Numbers in each array at once, so that they stay in a processor's cache. More take memory and are slower; with fewer,
# most of the time is spent between arrays.
AT_ONCE = 1 << 15


@dataclass(frozen=True, eq=False)
class Sweep:
    """Paths of points from frame to frame: a step leads from each closed frame to the next, if that is closed.

    drive: (frames,), the driver's angle or displacement. points: (frames, n) complex, mm, nan where open.
    Every path is its chords to within `bulge`, so that no bound that adds it lets anything slip through
    between two frames.
    """

    drive: Real
    points: Complex

    @cached_property
    def frames(self) -> Whole:
        """Frames at which a step starts: the closed ones. The step of a frame before an open one stands still."""
        return np.flatnonzero(np.isfinite(self.points).all(axis=1))

    @cached_property
    def _steps(self) -> tuple[Complex, Complex, Real]:
        start, end, bulge = steps(with_unknown(self.drive), with_unknown(self.points.T))
        return start[:, self.frames].T, end[:, self.frames].T, bulge[:, self.frames].T

    @property
    def ends(self) -> tuple[Complex, Complex]:
        """The points where each step starts and where it ends, (steps, n)."""
        return self._steps[:2]

    @property
    def bulge(self) -> Real:
        """How far the paths leave their chords at most, mm, (steps, n)."""
        return self._steps[2]

    def reach(self, direction: complex) -> float:
        """How far the paths go along a direction at most, mm from the origin."""
        start, end = (dot(direction, z) for z in self.ends)
        return float((np.maximum(start, end) + self.bulge).max())

    def gap(self, corners: Complex) -> Real:
        """Least distance, mm, (steps,), between the points' convex hull and that of `corners` (m,), which stand still.

        A lower bound: the hull of a step's two ends holds all chords between them. It falls short by the bulge,
        and beside the middle of a turning bar by half of what the bar's ends travel. 0 or less where they meet.
        """
        start, end = self.ends
        bulge: Real = self.bulge.max(axis=1)
        found = np.empty(len(bulge))
        count = AT_ONCE // (2 * start.shape[1] + len(corners)) ** 2 + 1
        for some in (slice(k, k + count) for k in range(0, len(bulge), count)):
            moving = np.concatenate([start[some], end[some]], axis=1)
            still = np.broadcast_to(np.asarray(corners, dtype=complex), (len(moving), len(corners)))
            found[some] = separation(moving, still) - bulge[some]
        return found


def steps(drive: Real, points: Complex) -> tuple[Complex, Complex, Real]:
    """Of steps from each frame to the next: start, end, and how far the path leaves its chord at most, (..., steps).

    points: (..., steps + 3), at a frame before the first step, at its start and so on, and at two more after the last
    start; nan where open or unknown. drive: likewise. A path of second derivative P'' over a step h leaves its chord
    by |P''| h^2 / 8. P'' is the second divided difference about either end, whichever is larger; the bound is twice
    that, for what P'' itself changes within a step. Where no neighbour tells P'', half a chord: a half circle.
    """
    start, end = points[..., 1:-2], points[..., 2:-1]
    end = np.where(np.isfinite(end), end, start)
    step = np.diff(drive)
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = np.diff(points) / step
        bend = np.abs(2 * np.diff(slope) / (step[1:] + step[:-1]))
        most = np.fmax(bend[..., :-1], bend[..., 1:]) * step[1:-1] ** 2 / 4
    return start, end, np.where(np.isfinite(most), most, np.abs(end - start) / 2)


def with_unknown(values: Array) -> Array:
    """Values (..., frames) with a nan before the first and two after the last, as `steps` takes them."""
    unknown = np.full_like(values[..., :1], np.nan)
    return np.concatenate([unknown, values, unknown, unknown], axis=-1)


def path_in(motion: Motion, frame: str, body: str, places: complex | Complex) -> Sweep:
    """Paths of points of one body as seen from another."""
    seen, moving = motion.bodies[frame], motion.bodies[body]
    local = np.atleast_1d(np.asarray(places, dtype=complex))
    world = moving.origin.position[:, None] + moving.direction[:, None] * local
    here = (world - seen.origin.position[:, None]) * np.conj(seen.direction[:, None])
    return Sweep(motion.drive, np.where(motion.closed[:, None], here, np.nan))
