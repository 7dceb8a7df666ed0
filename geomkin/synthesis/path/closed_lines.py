"""Closed lines through wanted points, and the distances between such a line and a path, both ways."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Real, Whole, cross, dot, unit

# Parts of the line from point to point.
PARTS = 8
# Points at once of which distances are computed.
AT_ONCE = 256
# Number of points beyond which they are taken in their order.
TOURED = 300
# Slope at the ends of the way back from the end of an open path to its start, by their distance, and its points.
RETURN, RETURN_POINTS = 3.0, 16
# Parts of a line that are compared with each other.
COMPARED = 600
# Samples of a path, equal in arc length, whose distances from the line are measured.
MEASURED = 1024


def loop(points: Complex) -> Complex:
    """A smooth closed line (k,) through points in the order of a short tour; its end is the start."""
    return smooth_line(points[short_tour(points)])


def returned(points: Complex) -> Complex:
    """Points of an open path and of a smooth way back, to the left of the chord, by which it becomes a closed one."""
    steps = np.diff(points)
    start, end = steps[steps != 0][[0, -1]]
    far = RETURN * max(abs(points[-1] - points[0]), np.ptp(points.real) / 2, np.ptp(points.imag) / 2)
    t = np.arange(1, RETURN_POINTS) / RETURN_POINTS
    slopes = (far * unit(np.array([end, start]))).tolist()
    back = (1 - t) ** 2 * (1 + 2 * t) * points[-1] + t**2 * (3 - 2 * t) * points[0]
    back = back + 1j * t * (1 - t) * (points[-1] - points[0])
    return np.concatenate([points, back + t * (1 - t) ** 2 * slopes[0] - t**2 * (1 - t) * slopes[1]])


def smooth_line(ahead: Complex) -> Complex:
    """A smooth closed line (k,) through points in their order, with `PARTS` parts from each to the next."""
    before, after, next_but_one = np.roll(ahead, 1), np.roll(ahead, -1), np.roll(ahead, -2)
    t = np.linspace(0, 1, PARTS, endpoint=False)[:, None]
    slope, slope_after = (after - before) / 2, (next_but_one - ahead) / 2
    bend = 2 * (ahead - after) + slope + slope_after
    line = ahead + t * (slope + t * (3 * (after - ahead) - 2 * slope - slope_after + t * bend))
    line = line.T.ravel()
    return np.append(line, line[0])


def along_line(values: Real) -> Real:
    """Values (k,) along a smooth line from those at its points (n,)."""
    places = np.arange(PARTS * len(values) + 1) / PARTS
    along: Real = np.interp(places, np.arange(len(values) + 1), np.append(values, values[0]))
    return along


def play(line: Complex) -> Real:
    """How far a curve through the same points may be from the line (k,) at each of its points, mm.

    It is the distance at which the line would miss each point if this point were not given.
    """
    points = line[:-1:PARTS]
    before, after = np.roll(points, 1), np.roll(points, -1)
    middle = (before + after) / 2 + (after - np.roll(points, 3) - np.roll(points, -3) + before) / 16
    missed = np.abs(cross(unit(after - before), points - middle))
    missed = np.fmax.reduce([np.roll(missed, k) for k in (-1, 0, 1)])
    missed = np.repeat(np.fmax(missed, np.roll(missed, -1)), PARTS)
    return np.append(missed, missed[0])


def distances(points: Complex, line: Complex) -> Real:
    """Distances of points (n,) from a line (k,)."""
    return nearest_on(points, line)[0]


def nearest_on(points: Complex, line: Complex) -> tuple[Real, Whole]:
    """Distances of points (n,) from a line (k,), and the nearest points of the line."""
    start, step = line[:-1], np.diff(line)
    square = np.maximum(np.abs(step) ** 2, 1e-300)
    result, nearest_of_all = np.zeros(len(points)), np.zeros(len(points), dtype=int)
    for k in range(0, len(points), AT_ONCE):
        some = points[k : k + AT_ONCE, None]
        nearest = np.argmin(np.abs(some - start), axis=1)
        found = []
        for at in (nearest - 1, nearest):
            along = np.clip(dot(step[at], some[:, 0] - start[at]) / square[at], 0, 1)
            found.append(np.abs(some[:, 0] - start[at] - along * step[at]))
        result[k : k + AT_ONCE], nearest_of_all[k : k + AT_ONCE] = np.minimum(*found), nearest
    return result, nearest_of_all


def crossings(line: Complex) -> int:
    """How often a closed line (k,) crosses itself; parts that run one on the other do not count."""
    points = evenly(line[None], COMPARED)[0][0]
    # Not the start of the line, where it may cross itself.
    points = 0.7 * points + 0.3 * np.roll(points, -1)
    step = np.roll(points, -1) - points
    # On which side of each part of the line each point is, and the next one.
    side = cross(step[:, None], points - points[:, None])
    side[np.abs(side) < 1e-9 * np.abs(step[:, None]) * np.ptp(np.abs(points - points.mean()))] = 0
    apart = side * np.roll(side, -1, axis=1) < 0
    return int(np.count_nonzero(apart & apart.T)) // 2


@record(eq=False)
class WantedLine:
    """The closed line (k,) through wanted points, mm, how far curves through the points may be away, and weights."""

    points: Complex
    line: Complex
    allowed: Real
    weights: Real

    @classmethod
    def through(cls, points: Complex, weights: Real | None = None) -> WantedLine:
        """The line through points (n,), with their weights."""
        order = short_tour(points)
        line, weights = smooth_line(points[order]), np.ones(len(points)) if weights is None else weights
        return cls(points, line, play(line), along_line(weights[order]))

    def both_ways(self, path: Complex) -> tuple[Real, float, float]:
        """Distances (n,) of the points from a closed path (k,), mm, and the largest and the rms distance both ways."""
        forward = distances(self.points, path)
        back = self.from_path(path)[0]
        rms = float(np.sqrt((np.mean(forward**2) + np.mean(back**2)) / 2))
        return forward, float(max(forward.max(), back.max())), rms

    def from_path(self, path: Complex) -> tuple[Real, Real]:
        """Distances of a closed path (k,) from the line, mm, as far as the points determine it, and their weights."""
        away, nearest = nearest_on(evenly(path[None], MEASURED)[0][0], self.line)
        return np.maximum(away - self.allowed[nearest], 0), self.weights[nearest]


def path_errors(off: Real, weights: Real | None, line: WantedLine | None, path: Complex) -> dict[str, Any]:
    """The distances in a result, mm: those of the points (n,), and of a closed path (k,) also those from the line."""
    sides = [(off, np.ones(len(off)) if weights is None else weights)] + ([line.from_path(path)] if line else [])
    errors: dict[str, Any] = {"square_error": float(np.sum(off**2))}
    for name in ("", "weighted_"):
        if name and weights is None:
            return errors
        parts = [(away, of if name else np.ones(len(of))) for away, of in sides]
        most = max(of.max() for _, of in parts)
        errors[f"{name}largest_distance"] = float(max((away * np.sqrt(of / most)).max() for away, of in parts))
        errors[f"{name}rms_distance"] = float(np.sqrt(np.mean([np.average(away**2, weights=of) for away, of in parts])))
    return errors


def evenly(path: Complex, count: int, ends: bool = False) -> tuple[Complex, Real]:
    """Points (s, count) at equal shares of the lengths of paths (s, k), and the shares (s, k) of these.

    With both ends or only the first. A path without length has nan.
    """
    length = np.cumsum(np.abs(np.diff(path, axis=1)), axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.concatenate([np.zeros((len(path), 1)), length], axis=1) / length[:, -1:]
    row = np.arange(len(path))[:, None]
    at = row + np.linspace(0, 1, count, endpoint=ends) * (1 - 1e-9)
    return np.interp(at.ravel(), (row + share * (1 - 1e-9)).ravel(), path.ravel()).reshape(at.shape), share


def short_tour(points: Complex) -> Whole:
    """An order (n,) of points along a closed line: as given, or a tour without crossings if that is shorter."""
    if len(points) > TOURED:
        return np.arange(len(points))
    far = np.abs(points[:, None] - points)

    def length(order: Whole) -> float:
        return float(far[order, np.roll(order, -1)].sum())

    given = np.arange(len(points))
    left, tour = set(range(1, len(points))), [0]
    while left:
        tour.append(min(left, key=lambda k: (far[tour[-1], k], k)))
        left.remove(tour[-1])
    order = np.array(tour)
    for _ in range(4 * len(points)):
        after = np.roll(order, -1)
        # Saving if two edges of the tour are replaced by those between their starts and between their ends.
        gain = far[order, after][:, None] + far[order, after] - far[np.ix_(order, order)] - far[np.ix_(after, after)]
        i, j = np.unravel_index(np.argmax(np.triu(gain, 1)), gain.shape)
        if gain[i, j] <= 1e-9 * far.max():
            break
        order[i + 1 : j + 1] = order[i + 1 : j + 1][::-1].copy()
    # The given order is kept unless it jumps back and forth, since a curve that crosses itself is not a shortest tour.
    return given if length(given) <= 1.3 * length(order) else order
