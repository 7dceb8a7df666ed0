"""Each segment of a programme as a law over its angle, those that meet their neighbours after those that do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError, shown
from ...core.records import record
from ...core.scaling import with_lengths
from ...plane.vec import Real, Whole
from ..extrema import highest
from .given_lifts import TableFit, read_rows, spline_through
from .laws import Ends, Law, breaks_of, law_of, polynomial_from
from .optimise import Optimum, optimal_polynomial, optimal_spline
from .peaks import SegmentPeaks
from .placed_segments import SLIP, PlacedSegment, band, naming, place_segments
from .segments import (
    Dwell,
    LiftPolynomial,
    LiftTable,
    OneSegment,
    OptimisedPolynomial,
    OptimisedSpline,
    Return,
    Rise,
    Segment,
)

# Slope, curvature and jerk by radian.
State = tuple[float, float, float]
REST: State = (0.0, 0.0, 0.0)


@record(eq=False)
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


# What a segment's lift is called where it is an arm's; not written where there is none.
ARM_LIFTS = ("rise_deg", "end_lift_deg")
# A curve through given values, such as measured ones, may dip below the base circle by this share of the lift:
# less than a cutter follows. Less refuses values for their last decimal, more shows on the cam.
DIP = 1e-4


@record(eq=False)
class FollowerMotion:
    """The follower over cam angles: lift mm and its derivatives by angle, mm/rad, mm/rad2, mm/rad3.

    For a follower that swings, rad, rad/rad, rad/rad2, rad/rad3. Times the speed in rad/s, its square and its cube
    they are rates by time.

    Source: the s v a j diagrams of Norton, Cam Design and Manufacturing Handbook.
    """

    lift: Real
    velocity: Real
    acceleration: Real
    jerk: Real


@record
class Program:
    """Segments one after another from 0 to 360 deg, whose lift ends where it began and stays above 0.

    folder: where a table's file must lie, there or below, as for a recipe's; a script's, without one, may lie anywhere.
    DesignError, its field a segment such as `program[2].end_deg`, where the segments do not fill the turn, overlap,
    or their lifts do not close or fall below the base circle. Derived here.
    """

    segments: Sequence[Segment]
    # Where a text lay is no part of what it says: the same recipe read from two folders is equal.
    folder: str | Path | None = field(default=None, compare=False)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """A recipe gives the list of segments itself; the folder comes with the context it is validated in."""
        from pydantic_core import core_schema

        return core_schema.with_info_after_validator_function(
            lambda segments, info: cls(segments, (info.context or {}).get("folder", ".")),
            handler.generate_schema(tuple[OneSegment, ...]),
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda program: [_plain(segment) for segment in program.segments]
            ),
        )

    def __post_init__(self) -> None:
        if not isinstance(self.segments, (tuple, list)):
            raise DesignError("segments", f"found {shown(self.segments)}", "give a list of segments, such as Dwell")
        if not isinstance(self.folder, (str, Path, type(None))):
            raise DesignError("folder", f"found {shown(self.folder)}", "give the path of a folder")
        # Refuses what does not add up.
        _ = self._stretches

    @cached_property
    def _stretches(self) -> _Stretches:
        return _Stretches(solve_segments(place_segments(self.segments, self.folder)))

    def at_scale(self, scale: float) -> Program:
        """The same with lifts in mm multiplied, those of a file too; how far a curve may leave rows goes with them."""
        if self.oscillates:
            return self
        return Program(tuple(with_lengths(self._written_out(segment), scale) for segment in self.segments), self.folder)

    def _written_out(self, segment: Segment) -> Segment:
        """A table whose rows stand in it, and how far a curve may leave them as a length."""
        if not isinstance(segment, LiftTable):
            return segment
        rows, within = tuple((x, lift) for x, lift in read_rows(segment, self.folder)[1].tolist()), band(segment)
        if not within:
            return replace(segment, rows=rows, file=None)
        return replace(segment, rows=rows, file=None, within=within, decimals=None)

    @property
    def oscillates(self) -> bool:
        """Whether lifts are angles of an arm, given in degrees and told in radians. False for dwells alone."""
        return self._stretches.oscillates

    @property
    def breaks(self) -> Real:
        """Cam angles, rad, from 0 to 2 pi, between which lift, velocity, acceleration and jerk are continuous."""
        return self._stretches.breaks

    @property
    def optima(self) -> dict[int, Optimum]:
        """Of each optimised segment, by its place in `segments`: peaks in mm/rad2 and mm/rad3 and the bound.

        For a follower that swings, rad/rad2 and rad/rad3.
        """
        solved = self._stretches.solved
        return {k: one.optimum for k, one in enumerate(solved) if one.optimum is not None}

    @property
    def tables(self) -> dict[int, TableFit]:
        """Of each table, by its place in `segments`: its rows in mm or deg, and how much they scatter."""
        return {k: one.fit for k, one in enumerate(self._stretches.solved) if one.fit is not None}

    @property
    def jumps(self) -> FollowerMotion:
        """How much each derivative jumps at `breaks[:-1]`, up positive; the first at 0 deg, where the turn closes.

        A jump in velocity is an infinite acceleration, as where a uniform motion meets a dwell. What
        is below 1e-9 of the largest value is rounding, and told as 0.
        """
        return FollowerMotion(*self._stretches.jumps())

    @cached_property
    def peaks(self) -> dict[int, SegmentPeaks]:
        """Largest velocity, acceleration and jerk of each segment that moves, by its place in `segments`."""
        stretches, tops = self._stretches, self._stretches.tops()
        found = {}
        for k, (number, rise, width) in enumerate(zip(stretches.numbers, stretches.rises, stretches.widths.tolist())):
            if stretches.law_of[k] < len(stretches.laws):
                velocity, acceleration, jerk = tops[:, stretches.segment == k].max(axis=1).tolist()
                found[number] = SegmentPeaks(velocity, acceleration, jerk, rise, width)
        return found

    def motion(self, angle: ArrayLike) -> FollowerMotion:
        """The follower at cam angles of any shape, rad; at a joint, that of the segment that starts there."""
        return FollowerMotion(*self._stretches.motion(np.asarray(angle, dtype=float)))


class _Stretches:
    """A programme's segments as arrays: segments (n,), smooth stretches of them between breaks (p,), distinct laws.

    starts, widths (n,): rad. scales (4, n): what a law's rows are multiplied by. segment, low, high (p,):
    the segment a stretch lies in, and its x there.
    """

    def __init__(self, solved: list[SolvedSegment]):
        self.solved = solved
        self.oscillates = any(one.placed.oscillates for one in solved)
        self._check_base()
        # Where one dwell follows another nothing changes: they count as one.
        resting = [one.law is None for one in solved]
        self.numbers = [k for k in range(len(solved)) if not (k and resting[k] and resting[k - 1])]
        solved = [solved[k] for k in self.numbers]
        unit = np.radians(1) if self.oscillates else 1.0
        limits = np.radians([*(one.placed.start for one in solved), 360.0])
        self.starts, self.widths = limits[:-1], np.diff(limits)
        self.lifts = np.array([one.placed.lift for one in solved]) * unit
        self.rises = [(one.placed.end_lift - one.placed.lift) * unit for one in solved]
        rises = np.array([one.scale for one in solved])
        self.scales = rises * unit * self.widths ** -np.arange(4.0)[:, None]
        self.laws = list({id(one.law): one.law for one in solved if one.law}.values())
        number = {id(law): k for k, law in enumerate(self.laws)}
        # The last number is that of no law: rest.
        self.law_of = np.array([number.get(id(one.law), len(self.laws)) for one in solved])
        inner = [np.array([0.0, 1.0]) if one.law is None else breaks_of(one.law) for one in solved]
        self.segment = np.repeat(np.arange(len(solved)), [len(x) - 1 for x in inner])
        self.low = np.concatenate([x[:-1] for x in inner])
        # At a break inside a segment the stretch before ends just before it, whatever the angle's rounding says.
        ends = np.concatenate([x[1:] for x in inner])
        self.high = np.where(ends < 1, np.nextafter(ends, 0), 1.0)
        self.breaks = np.append(self.starts[self.segment] + self.widths[self.segment] * self.low, limits[-1])

    def motion(self, angle: Real) -> Real:
        """(4, ...) at angles in rad."""
        turned = np.where((angle >= 0) & (angle <= self.breaks[-1]), angle, np.mod(angle, 2 * np.pi))
        stretch = np.clip(np.searchsorted(self.breaks, turned, side="right") - 1, 0, len(self.segment) - 1)
        segment = self.segment[stretch]
        x = (turned - self.starts[segment]) / self.widths[segment]
        return self.values(segment, np.clip(x, self.low[stretch], self.high[stretch]))

    def values(self, segment: Whole, x: Real) -> Real:
        """(4, ...) at places x from 0 to 1 of segments."""
        out = np.zeros((4, *np.shape(x)))
        flat, segments, places = out.reshape(4, -1), np.ravel(segment), np.ravel(x)
        # By law, not by segment: a programme of very many segments costs no more than a short one.
        laws = self.law_of[segments]
        order = np.argsort(laws, kind="stable")
        limits = np.searchsorted(laws[order], np.arange(len(self.laws) + 1))
        for law, start, end in zip(self.laws, limits[:-1], limits[1:]):
            if end > start:
                where = order[start:end]
                flat[:, where] = self.scales[:, segments[where]] * law(places[where])
        out[0] += self.lifts[segment]
        return out

    def jumps(self) -> Real:
        """(4, p): values after each break less those before."""
        before, after = self._ends
        return after - np.roll(before, 1, axis=1)

    @cached_property
    def _ends(self) -> tuple[Real, Real]:
        """(4, p) each: values before the end of each stretch, and at its start, less rounding.

        What is below 1e-9 of the largest value is 0, and what differs so little across a joint is the same.
        """
        before, after = self.values(self.segment, self.high), self.values(self.segment, self.low)
        # Places between, none of them where a symmetric motion is 0.
        inside = [self.values(self.segment, self.low + share * (self.high - self.low)) for share in (0.3, 0.6)]
        small = 1e-9 * np.abs([before, *inside, after]).max(axis=(0, 2))[:, None]
        after = np.where(np.abs(after - np.roll(before, 1, axis=1)) > small, after, np.roll(before, 1, axis=1))
        return np.where(np.abs(before) > small, before, 0.0), np.where(np.abs(after) > small, after, 0.0)

    def tops(self) -> Real:
        """(3, p): largest velocity, acceleration and jerk of each stretch, infinite if a lower derivative jumps at one
        of its ends, unless it is 0 on this side.
        """
        tops = np.array([highest(self.breaks, partial(self._size, k))[0] for k in (1, 2, 3)])
        (before, after), jumps = self._ends, self.jumps() != 0
        _, velocity, acceleration, _ = (jumps & (after != 0)) | (np.roll(jumps, -1, axis=1) & (before != 0))
        tops[1:, velocity] = tops[2, acceleration] = np.inf
        return tops

    def _size(self, order: int, angle: Real) -> Real:
        return np.asarray(np.abs(self.motion(angle)[order]))

    def _check_base(self) -> None:
        unit = "deg" if self.oscillates else "mm"
        seen = [(one, *lift_range(one)) for one in self.solved]
        highest = max(high for *_, high in seen)
        for one, low, angle, _ in seen:
            # A curve near rows may dip as far as it may leave them.
            if low < -max(SLIP, DIP * highest, band(one.placed.segment)):
                raise DesignError(
                    one.placed.place,
                    f"the lift falls to {low:g} {unit} at {angle:g} deg, below the base circle",
                    "give other values there, or more lift and a smaller base_radius",
                )


def _plain(segment: Segment) -> dict[str, Any]:
    """A segment as a recipe gives it; an arm's lifts only where there is an arm."""
    given = asdict(segment)
    return {name: value for name, value in given.items() if value is not None or name not in ARM_LIFTS}
