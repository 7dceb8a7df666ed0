"""How near moving plates and pins come to each other, between frames too."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...linkage.motion import Motion
from ...plane.hulls import separation
from ...plane.vec import Complex, Real, Whole, dot


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
    def ends(self) -> tuple[Complex, Complex]:
        """The points where each step starts and where it ends, (steps, n)."""
        following = np.append(self.points[1:], np.full_like(self.points[:1], np.nan), axis=0)
        start, end = self.points[self.frames], following[self.frames]
        return start, np.where(np.isfinite(end), end, start)

    @cached_property
    def bulge(self) -> Real:
        """How far the paths leave their chords at most, mm, (steps, n).

        A path of second derivative P'' over a step h leaves its chord by |P''| h^2 / 8. P'' is the second
        divided difference about either end, whichever is larger; the bound is twice that, for what P'' itself
        changes within a step. Where no neighbour tells P'', half a chord: a half circle.
        """
        start, end = self.ends
        step = np.append(np.diff(self.drive), np.nan)[:, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            slope = np.append(np.diff(self.points, axis=0), np.full_like(self.points[:1], np.nan), axis=0) / step
            bend = np.abs(2 * (slope[1:] - slope[:-1]) / (step[1:] + step[:-1]))
        unknown = np.full((1, self.points.shape[1]), np.nan)
        before, after = np.concatenate([unknown, bend]), np.concatenate([bend, unknown])
        most = np.fmax(before[self.frames], after[self.frames]) * step[self.frames] ** 2 / 4
        return np.where(np.isfinite(most), most, np.abs(end - start) / 2)

    def reach(self, direction: complex) -> float:
        """How far the paths go along a direction at most, mm from the origin."""
        start, end = (dot(direction, z) for z in self.ends)
        return float((np.maximum(start, end) + self.bulge).max())

    def gap(self, corners: Complex) -> Real:
        """Least distance, mm, (steps,), between the points' convex hull and that of `corners` (m,), which stand still.

        A lower bound: the hull of a step's two ends holds all chords between them. It falls short by the bulge,
        and beside the middle of a turning bar by half of what the bar's ends travel. 0 or less where they meet.
        """
        still = np.broadcast_to(np.asarray(corners, dtype=complex), (len(self.frames), len(corners)))
        bulge: Real = self.bulge.max(axis=1)
        return separation(np.concatenate(self.ends, axis=1), still) - bulge


def path_in(motion: Motion, frame: str, body: str, places: complex | Complex) -> Sweep:
    """Paths of points of one body as seen from another."""
    seen, moving = motion.bodies[frame], motion.bodies[body]
    local = np.atleast_1d(np.asarray(places, dtype=complex))
    world = moving.origin.position[:, None] + moving.direction[:, None] * local
    here = (world - seen.origin.position[:, None]) * np.conj(seen.direction[:, None])
    return Sweep(motion.drive, np.where(motion.closed[:, None], here, np.nan))
