"""Each segment of a programme as a law over its angle, those that meet their neighbours after those that do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import DesignError
from .boundary import polynomial_from
from .timeline import Span, band, naming
from .laws import Law, checked
from .optimise import Optimum, optimal_polynomial, optimal_spline
from .segments import Dwell, LiftPolynomial, LiftTable, OptimisedPolynomial, OptimisedSpline, Return, Rise
from .spline import Ends, spline_through
from .table_fit import TableFit

# Slope, curvature and jerk by radian.
State = tuple[float, float, float]
REST: State = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Piece:
    """Lift = span.lift + scale law(x), with x from 0 to 1 over the span; law None where it rests.

    In the units of the span. optimum: by radian, where the segment is one. fit: where it is a table.
    """

    span: Span
    law: Law | None
    scale: float
    optimum: Optimum | None = None
    fit: TableFit | None = None

    def state(self, x: float) -> State:
        """Slope, curvature and jerk at x, by radian."""
        if self.law is None:
            return REST
        values = np.asarray(self.law(np.array([x])))[1:, 0] * self.scale / self.span.radians ** np.arange(1.0, 4.0)
        return values[0].item(), values[1].item(), values[2].item()


def pieces_of(spans: Sequence[Span]) -> list[Piece]:
    """The pieces of a programme, one for each span."""
    pieces: list[Piece | None] = []
    for span in spans:
        with naming(span.place):
            pieces.append(_alone(span))
    n = len(spans)
    met = list(pieces)
    for k, span in enumerate(spans):
        if met[k] is None:
            before, after = pieces[k - 1], pieces[(k + 1) % n]
            with naming(span.place):
                met[k] = _meeting(span, before.state(1.0) if before else REST, after.state(0.0) if after else REST, n)
    return [piece for piece in met if piece]


def _alone(span: Span) -> Piece | None:
    """A segment that asks nothing of its neighbours; None for one that does."""
    segment = span.segment
    if isinstance(segment, Dwell):
        return Piece(span, None, 0.0)
    if isinstance(segment, Rise | Return):
        return Piece(span, checked(segment.law), span.end_lift - span.lift)
    if not isinstance(segment, LiftPolynomial):
        return None
    # Derivatives by radian are in radians where the lift is in degrees.
    unit = np.radians(1) if span.oscillates else 1.0
    given = {
        0.0: (segment.start_velocity_per_rad, segment.start_acceleration_per_rad2, segment.start_jerk_per_rad3),
        1.0: (segment.end_velocity_per_rad, segment.end_acceleration_per_rad2, segment.end_jerk_per_rad3),
    }
    conditions = [(0.0, 0, 0.0), (1.0, 0, span.end_lift - span.lift)]
    conditions += [
        (x, k, value / unit * span.radians**k)
        for x, side in given.items()
        for k, value in enumerate(side, 1)
        if value is not None
    ]
    conditions += [(x, 0, lift - span.lift) for x, lift in zip(span.x(span.points[:, 0]), span.points[:, 1])]
    return Piece(span, polynomial_from(conditions), 1.0)


def _meeting(span: Span, start: State, end: State, count: int) -> Piece:
    """A segment that takes slope and curvature from its neighbours' `start` and `end`."""
    segment = span.segment
    if isinstance(segment, OptimisedPolynomial | OptimisedSpline):
        return _optimal(span, segment, start, end)
    x, lifts = span.x(span.points[:, 0]), span.points[:, 1] - span.lift
    first, last = ((v * span.radians, a * span.radians**2) for v, a, _ in (start, end))
    # Alone, it is its own neighbour.
    ends: Ends = None if count == 1 else (first, last)
    if not isinstance(segment, LiftTable):
        return Piece(span, spline_through(x, lifts, ends), 1.0)
    fit = TableFit(x, lifts, ends, band(segment))
    return Piece(span, fit.law, 1.0, fit=fit)


def _optimal(span: Span, segment: OptimisedPolynomial | OptimisedSpline, start: State, end: State) -> Piece:
    rise, angle = span.end_lift - span.lift, span.radians
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
    unit = np.radians(1) if span.oscillates else 1.0
    return Piece(span, found.law, size, found.scaled(size * unit, angle))


def reach(piece: Piece) -> tuple[float, float, float]:
    """Least lift of a piece, in the units of its span, the angle there, deg, and the largest; seen in 1024 steps."""
    span = piece.span
    if piece.law is None:
        return span.lift, span.start, span.lift
    x = np.linspace(0, 1, 1025)
    lift = span.lift + piece.scale * np.asarray(piece.law(x))[0]
    k = int(lift.argmin())
    return lift[k].item(), span.start + x[k].item() * (span.end - span.start), lift.max().item()
