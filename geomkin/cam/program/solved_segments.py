"""Each segment of a programme as a law over its angle, those that meet their neighbours after those that do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import DesignError
from .given_lifts import TableFit, spline_through
from .laws import Ends, Law, law_of, polynomial_from
from .optimise import Optimum, optimal_polynomial, optimal_spline
from .placed_segments import PlacedSegment, band, naming
from .segments import Dwell, LiftPolynomial, LiftTable, OptimisedPolynomial, OptimisedSpline, Return, Rise

# Slope, curvature and jerk by radian.
State = tuple[float, float, float]
REST: State = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class SolvedSegment:
    """Lift = placed.lift + scale law(x), with x from 0 to 1 over the segment; law None where it rests.

    In the units of `placed`. optimum: by radian, where the segment is one. fit: where it is a table.
    """

    placed: PlacedSegment
    law: Law | None
    scale: float
    optimum: Optimum | None = None
    fit: TableFit | None = None

    def state(self, x: float) -> State:
        """Slope, curvature and jerk at x, by radian."""
        if self.law is None:
            return REST
        values = np.asarray(self.law(np.array([x])))[1:, 0] * self.scale / self.placed.radians ** np.arange(1.0, 4.0)
        return values[0].item(), values[1].item(), values[2].item()


def solve_segments(placed: Sequence[PlacedSegment]) -> list[SolvedSegment]:
    """The segments of a programme, each with its law: those that meet their neighbours after those that do not."""
    alone: list[SolvedSegment | None] = []
    for segment in placed:
        with naming(segment.place):
            alone.append(_alone(segment))
    n = len(placed)
    solved = list(alone)
    for k, segment in enumerate(placed):
        if solved[k] is None:
            before, after = alone[k - 1], alone[(k + 1) % n]
            start, end = before.state(1.0) if before else REST, after.state(0.0) if after else REST
            with naming(segment.place):
                solved[k] = _meeting(segment, start, end, n)
    return [segment for segment in solved if segment]


def _alone(placed: PlacedSegment) -> SolvedSegment | None:
    """A segment that asks nothing of its neighbours; None for one that does."""
    segment = placed.segment
    if isinstance(segment, Dwell):
        return SolvedSegment(placed, None, 0.0)
    if isinstance(segment, Rise | Return):
        return SolvedSegment(placed, law_of(segment.law), placed.end_lift - placed.lift)
    if not isinstance(segment, LiftPolynomial):
        return None
    # Derivatives by radian are in radians where the lift is in degrees.
    unit = np.radians(1) if placed.oscillates else 1.0
    given = {
        0.0: (segment.start_velocity_per_rad, segment.start_acceleration_per_rad2, segment.start_jerk_per_rad3),
        1.0: (segment.end_velocity_per_rad, segment.end_acceleration_per_rad2, segment.end_jerk_per_rad3),
    }
    conditions = [(0.0, 0, 0.0), (1.0, 0, placed.end_lift - placed.lift)]
    conditions += [
        (x, k, value / unit * placed.radians**k)
        for x, side in given.items()
        for k, value in enumerate(side, 1)
        if value is not None
    ]
    conditions += [(x, 0, lift - placed.lift) for x, lift in zip(placed.x(placed.points[:, 0]), placed.points[:, 1])]
    return SolvedSegment(placed, polynomial_from(conditions), 1.0)


def _meeting(placed: PlacedSegment, start: State, end: State, count: int) -> SolvedSegment:
    """A segment that takes slope and curvature from its neighbours' `start` and `end`."""
    segment = placed.segment
    if isinstance(segment, OptimisedPolynomial | OptimisedSpline):
        return _optimal(placed, segment, start, end)
    x, lifts = placed.x(placed.points[:, 0]), placed.points[:, 1] - placed.lift
    first, last = ((v * placed.radians, a * placed.radians**2) for v, a, _ in (start, end))
    # Alone, it is its own neighbour.
    ends: Ends = None if count == 1 else (first, last)
    if not isinstance(segment, LiftTable):
        return SolvedSegment(placed, spline_through(x, lifts, ends), 1.0)
    fit = TableFit(x, lifts, ends, band(segment))
    return SolvedSegment(placed, fit.law, 1.0, fit=fit)


def _optimal(
    placed: PlacedSegment, segment: OptimisedPolynomial | OptimisedSpline, start: State, end: State
) -> SolvedSegment:
    rise, angle = placed.end_lift - placed.lift, placed.radians
    orders = 3 if isinstance(segment, OptimisedPolynomial) and segment.match_jerk else 2
    sides = [[value * angle**k for k, value in enumerate(side[:orders], 1)] for side in (start, end)]
    # Solved for a rise of 1, so that equal shapes are solved once.
    size = rise or max(map(abs, [*sides[0], *sides[1]]))
    if size == 0:
        raise DesignError("rise", "it does not move", "use a dwell")
    if segment.jerk_limit and not rise:
        raise DesignError("jerk_limit", "it is a multiple of the rise, which is 0", "leave it out")
    first, last = (tuple(value / size for value in side) for side in sides)
    if isinstance(segment, OptimisedSpline):
        found = optimal_spline(segment.intervals, rise / size, first, last, segment.jerk_limit)
    elif segment.match_jerk and segment.degree < 7:
        raise DesignError("degree", f"found {segment.degree}, too low to match the jerk", "give 7 at least")
    else:
        found = optimal_polynomial(segment.degree, rise / size, first, last, segment.jerk_limit)
    unit = np.radians(1) if placed.oscillates else 1.0
    return SolvedSegment(placed, found.law, size, found.scaled(size * unit, angle))


def lift_range(solved: SolvedSegment) -> tuple[float, float, float]:
    """Least lift of a segment, mm or deg, the angle there, deg, and the largest lift; seen in 1024 steps."""
    placed = solved.placed
    if solved.law is None:
        return placed.lift, placed.start, placed.lift
    x = np.linspace(0, 1, 1025)
    lift = placed.lift + solved.scale * np.asarray(solved.law(x))[0]
    k = int(lift.argmin())
    return lift[k].item(), placed.start + x[k].item() * (placed.end - placed.start), lift.max().item()
