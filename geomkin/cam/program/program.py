"""The motion programme of a cam: its segments, solved as laws of motion, and its motion over one turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ...core.errors import DesignError, shown
from ...core.field_visitor import with_lengths
from ...core.names import Folder
from ...core.records import record
from ...core.units import mm
from ...plane.vec import Real, Whole
from .given_lifts import TableFit, read_lifts, spline_through
from .laws import Ends, Law, SegmentPeaks, breaks_of, highest, law_of, polynomial_from
from .optimise import OptimalLaw, optimal_polynomial, optimal_spline
from .placed_segments import SLIP, PlacedSegment, band, errors_named_by_segment, place_segments
from .segments import Dwell, LiftPolynomial, LiftTable, OptimisedPolynomial, OptimisedSpline, Return, Rise, Segment

# First, second and third derivative of the lift by radian.
State = tuple[float, float, float]
REST: State = (0.0, 0.0, 0.0)


@record(eq=False)
class SolvedSegment:
    """A segment with its law: lift = placed.lift + scale law(x), x from 0 to 1; law None for a dwell.

    Units are those of `placed`. optimum: of an optimised segment, by radian. fit: of a table.
    """

    placed: PlacedSegment
    law: Law | None
    scale: float
    optimum: OptimalLaw | None = None
    fit: TableFit | None = None

    def state(self, x: float) -> State:
        """Slope, curvature and jerk at x, by radian."""
        if self.law is None:
            return REST
        values = np.asarray(self.law(np.array([x])))[1:, 0] * self.scale / self.placed.radians ** np.arange(1.0, 4.0)
        return values[0].item(), values[1].item(), values[2].item()


def solve_segments(placed: Sequence[PlacedSegment]) -> list[SolvedSegment]:
    """The segments of a programme with their laws. Segments that match their neighbours are solved after the others."""
    independent: list[SolvedSegment | None] = []
    for segment in placed:
        with errors_named_by_segment(segment.place):
            independent.append(_independent(segment))
    n = len(placed)
    solved = list(independent)
    for k, segment in enumerate(placed):
        if solved[k] is None:
            before, after = independent[k - 1], independent[(k + 1) % n]
            start, end = before.state(1.0) if before else REST, after.state(0.0) if after else REST
            with errors_named_by_segment(segment.place):
                solved[k] = _matched(segment, start, end, n)
    return [segment for segment in solved if segment]


def _independent(placed: PlacedSegment) -> SolvedSegment | None:
    """A segment that does not depend on its neighbours; None for others."""
    segment = placed.segment
    if isinstance(segment, Dwell):
        return SolvedSegment(placed, None, 0.0)
    if isinstance(segment, Rise | Return):
        return SolvedSegment(placed, law_of(segment.law), placed.end_lift - placed.lift)
    if not isinstance(segment, LiftPolynomial):
        return None
    # If the lift is in degrees, its derivatives by radian are in radians.
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


def _matched(placed: PlacedSegment, start: State, end: State, count: int) -> SolvedSegment:
    """A segment that matches velocity and acceleration of its neighbours, `start` and `end`."""
    segment = placed.segment
    if isinstance(segment, OptimisedPolynomial | OptimisedSpline):
        return _optimal(placed, segment, start, end)
    x, lifts = placed.x(placed.points[:, 0]), placed.points[:, 1] - placed.lift
    first, last = ((v * placed.radians, a * placed.radians**2) for v, a, _ in (start, end))
    # A single segment is its own neighbour.
    ends: Ends = None if count == 1 else (first, last)
    if not isinstance(segment, LiftTable):
        return SolvedSegment(placed, spline_through(x, lifts, ends), 1.0)
    fit = TableFit(x, lifts, ends, band(segment), -placed.lift)
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
        raise DesignError("rise", "the follower does not move", "use a dwell", "out-of-range")
    if segment.jerk_limit and not rise:
        raise DesignError("jerk_limit", "it is a multiple of the rise, which is 0", "omit it", "conflict")
    first, last = (tuple(value / size for value in side) for side in sides)
    if isinstance(segment, OptimisedSpline):
        optimum = optimal_spline(segment.intervals, rise / size, first, last, segment.jerk_limit)
    elif segment.match_jerk and segment.degree < 7:
        problem = f"found {segment.degree}, too low to match the jerk"
        raise DesignError("degree", problem, "give at least 7", "out-of-range")
    else:
        optimum = optimal_polynomial(segment.degree, rise / size, first, last, segment.jerk_limit)
    unit = np.radians(1) if placed.oscillates else 1.0
    return SolvedSegment(placed, optimum.law, size, optimum.scaled(size * unit, angle))


def lift_range(solved: SolvedSegment) -> tuple[float, float, float]:
    """Least lift of a segment, mm or deg, its angle, deg, and the largest lift; sampled in 1024 steps."""
    placed = solved.placed
    if solved.law is None:
        return placed.lift, placed.start, placed.lift
    x = np.linspace(0, 1, 1025)
    lift = placed.lift + solved.scale * np.asarray(solved.law(x))[0]
    k = int(lift.argmin())
    return lift[k].item(), placed.start + x[k].item() * (placed.end - placed.start), lift.max().item()


# Keys of a segment's lift that are omitted from a recipe if not given.
OTHER_LIFTS = ("rise_deg", "end_lift_deg", "fall", "fall_deg")
# A curve through given values may go below the base circle by this share of the lift, less than a cutter follows. A
# smaller share refuses values because of their last decimal; a larger one is visible on the cam.
DIP = 1e-4


@record(eq=False)
class FollowerMotion:
    """Motion of the follower over cam angles; all arrays have one shape.

    Parameters
    ----------
    lift : ndarray
        Lift, mm; rad for an oscillating follower.
    velocity, acceleration, jerk : ndarray
        Derivatives by the cam angle, mm/rad, mm/rad2 and mm/rad3; rad/rad, rad/rad2 and rad/rad3 for an oscillating
        follower. Multiplied by the speed in rad/s, its square and its cube they are rates by time.

    Notes
    -----
    The s v a j diagrams of Norton, Cam Design and Manufacturing Handbook.
    """

    lift: Real
    velocity: Real
    acceleration: Real
    jerk: Real


@record
class Program:
    """A motion programme: segments in order from 0 to 360 deg. Lift at start and end is equal and is never negative.

    Parameters
    ----------
    segments : sequence of segments
        `Dwell`, `Rise`, `Return`, `LiftPolynomial`, `LiftSpline`, `LiftTable`, `OptimisedPolynomial` or
        `OptimisedSpline`.
    folder : str or Path, optional
        Folder that must contain the file of a table, as for a recipe; by default a file may be anywhere.

    Raises
    ------
    DesignError
        If the segments do not fill the turn or overlap, or if the lifts do not close or fall below the base circle.
        Its field is a segment such as `program[2].end_deg`.

    See Also
    --------
    Rise, Dwell, Return, Cam

    Notes
    -----
    Derived here.

    Examples
    --------
    >>> program = gk.Program((gk.Rise("3-4-5", rise=20, end_deg=150), gk.Return("cycloidal", end_deg=360)))
    >>> float(program.motion(np.radians(150)).lift)
    20.0
    """

    # Keys of segments that a recipe omits if they are None.
    OMITTED: ClassVar[tuple[str, ...]] = OTHER_LIFTS

    segments: Sequence[Segment]
    # Not compared: the same recipe read from two folders is equal.
    folder: Folder = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if not isinstance(self.segments, (tuple, list)):
            problem = f"found {shown(self.segments)}"
            raise DesignError("segments", problem, "give a list of segments, such as Dwell", "wrong-type")
        if not isinstance(self.folder, (str, Path, Mapping, type(None))):
            raise DesignError("folder", f"found {shown(self.folder)}", "give the path of a folder", "wrong-type")
        # Raises for inconsistent segments.
        _ = self._stretches

    @cached_property
    def _stretches(self) -> _Stretches:
        return _Stretches(solve_segments(place_segments(self.segments, self.folder)))

    def at_scale(self, scale: float) -> Program:
        """The programme with all lifts in mm multiplied, including those of files and the bands of tables.

        Parameters
        ----------
        scale : float
            The factor.
        """
        if self.oscillates:
            return self
        return Program(tuple(with_lengths(self._written_out(segment), scale) for segment in self.segments), self.folder)

    def _written_out(self, segment: Segment) -> Segment:
        """A table with its rows instead of a file, and its band as a length."""
        if not isinstance(segment, LiftTable):
            return segment
        rows, within = tuple((x, lift) for x, lift in read_lifts(segment, self.folder)[1].tolist()), band(segment)
        if not within:
            return replace(segment, rows=rows, file=None)
        return replace(segment, rows=rows, file=None, within=within, decimals=None)

    @property
    def oscillates(self) -> bool:
        """Whether lifts are angles of an arm, given in degrees and returned in radians; False for dwells only."""
        return self._stretches.oscillates

    @property
    def breaks(self) -> Real:
        """Cam angles, rad, from 0 to 2 pi, between which lift, velocity, acceleration and jerk are continuous."""
        return self._stretches.breaks

    @property
    def ends(self) -> list[tuple[float, float]]:
        """Cam angle, deg, and lift, mm or deg, at the end of each segment."""
        return [(solved.placed.end, solved.placed.end_lift) for solved in self._stretches.solved]

    @property
    def optima(self) -> dict[int, OptimalLaw]:
        """Optima of the optimised segments by their index in `segments`: peaks and bound, mm/rad2 and mm/rad3.

        rad/rad2 and rad/rad3 for an oscillating follower.
        """
        solved = self._stretches.solved
        return {k: segment.optimum for k, segment in enumerate(solved) if segment.optimum is not None}

    @property
    def tables(self) -> dict[int, TableFit]:
        """Fits of the tables by their index in `segments`: rows in mm or deg, and their scatter."""
        return {k: segment.fit for k, segment in enumerate(self._stretches.solved) if segment.fit is not None}

    @property
    def jumps(self) -> FollowerMotion:
        """Jumps of each derivative at `breaks[:-1]`, positive upwards; the first is at 0 deg, where the turn closes.

        A jump in velocity is an infinite acceleration, as between a uniform motion and a dwell. Jumps below 1e-9 of the
        largest value are rounding and returned as 0.
        """
        return FollowerMotion(*self._stretches.jumps())

    @cached_property
    def peaks(self) -> dict[int, SegmentPeaks]:
        """Largest velocity, acceleration and jerk of each segment that moves, by its index in `segments`."""
        stretches, tops = self._stretches, self._stretches.tops()
        peaks = {}
        for k, (number, rise, width) in enumerate(zip(stretches.numbers, stretches.rises, stretches.widths.tolist())):
            if stretches.law_of[k] < len(stretches.laws):
                velocity, acceleration, jerk = tops[:, stretches.segment == k].max(axis=1).tolist()
                peaks[number] = SegmentPeaks(velocity, acceleration, jerk, rise, width)
        return peaks

    def motion(self, angle: ArrayLike) -> FollowerMotion:
        """Motion of the follower.

        Parameters
        ----------
        angle : float or array_like
            Cam angles, rad, any shape. At a joint the segment that starts there counts.

        Returns
        -------
        FollowerMotion
            Lift and derivatives, same shape.
        """
        return FollowerMotion(*self._stretches.motion(np.asarray(angle, dtype=float)))


class _Stretches:
    """A programme's segments as arrays: segments (n,), their smooth stretches between breaks (p,), distinct laws.

    starts, widths (n,): rad. scales (4, n): factors of a law's rows. segment, low, high (p,): the segment of a
    stretch, and its range of x.
    """

    def __init__(self, solved: list[SolvedSegment]):
        self.solved = solved
        self.oscillates = any(segment.placed.oscillates for segment in solved)
        self._check_base()
        # Adjacent dwells count as one.
        resting = [segment.law is None for segment in solved]
        self.numbers = [k for k in range(len(solved)) if not (k and resting[k] and resting[k - 1])]
        solved = [solved[k] for k in self.numbers]
        unit = np.radians(1) if self.oscillates else 1.0
        limits = np.radians([*(segment.placed.start for segment in solved), 360.0])
        self.starts, self.widths = limits[:-1], np.diff(limits)
        self.lifts = np.array([segment.placed.lift for segment in solved]) * unit
        self.rises = [(segment.placed.end_lift - segment.placed.lift) * unit for segment in solved]
        rises = np.array([segment.scale for segment in solved])
        self.scales = rises * unit * self.widths ** -np.arange(4.0)[:, None]
        self.laws = list({id(segment.law): segment.law for segment in solved if segment.law}.values())
        number = {id(law): k for k, law in enumerate(self.laws)}
        # The last number stands for a dwell, without a law.
        self.law_of = np.array([number.get(id(segment.law), len(self.laws)) for segment in solved])
        inner = [np.array([0.0, 1.0]) if segment.law is None else breaks_of(segment.law) for segment in solved]
        self.segment = np.repeat(np.arange(len(solved)), [len(x) - 1 for x in inner])
        self.low = np.concatenate([x[:-1] for x in inner])
        # At a break inside a segment the stretch before ends just before it, independent of the angle's rounding.
        ends = np.concatenate([x[1:] for x in inner])
        self.high = np.where(ends < 1, np.nextafter(ends, 0), 1.0)
        self.breaks = np.append(self.starts[self.segment] + self.widths[self.segment] * self.low, limits[-1])

    def motion(self, angle: Real) -> Real:
        """(4, ...) at angles in rad."""
        wrapped = np.where((angle >= 0) & (angle <= self.breaks[-1]), angle, np.mod(angle, 2 * np.pi))
        stretch = np.clip(np.searchsorted(self.breaks, wrapped, side="right") - 1, 0, len(self.segment) - 1)
        segment = self.segment[stretch]
        x = (wrapped - self.starts[segment]) / self.widths[segment]
        return self.values(segment, np.clip(x, self.low[stretch], self.high[stretch]))

    def values(self, segment: Whole, x: Real) -> Real:
        """(4, ...) at x from 0 to 1 of segments."""
        out = np.zeros((4, *np.shape(x)))
        flat, segments, places = out.reshape(4, -1), np.ravel(segment), np.ravel(x)
        # Evaluated by law, so that a programme of very many segments takes no longer than a short one.
        laws = self.law_of[segments]
        order = np.argsort(laws, kind="stable")
        limits = np.searchsorted(laws[order], np.arange(len(self.laws) + 1))
        for law, start, end in zip(self.laws, limits[:-1], limits[1:]):
            if end > start:
                points = order[start:end]
                flat[:, points] = self.scales[:, segments[points]] * law(places[points])
        out[0] += self.lifts[segment]
        return out

    def jumps(self) -> Real:
        """(4, p): values after each break minus those before."""
        before, after = self._ends
        return after - np.roll(before, 1, axis=1)

    @cached_property
    def _ends(self) -> tuple[Real, Real]:
        """(4, p) each: values before the end of each stretch, and at its start, without rounding errors.

        Values below 1e-9 of the largest are 0, and smaller differences across a joint are removed.
        """
        before, after = self.values(self.segment, self.high), self.values(self.segment, self.low)
        # Inner samples, at which a symmetric motion is not 0.
        inside = [self.values(self.segment, self.low + share * (self.high - self.low)) for share in (0.3, 0.6)]
        small = 1e-9 * np.abs([before, *inside, after]).max(axis=(0, 2))[:, None]
        after = np.where(np.abs(after - np.roll(before, 1, axis=1)) > small, after, np.roll(before, 1, axis=1))
        return np.where(np.abs(before) > small, before, 0.0), np.where(np.abs(after) > small, after, 0.0)

    def tops(self) -> Real:
        """(3, p): largest velocity, acceleration and jerk of each stretch; inf if a lower derivative jumps at an end
        and is not 0 on this side.
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
        ranges = [(segment, *lift_range(segment)) for segment in self.solved]
        highest_lift = max(high for *_, high in ranges)
        for segment, low, angle, _ in ranges:
            # The curve of a table may go below 0 by its band, and by the rounding of the search for it.
            if low < -max(SLIP, DIP * highest_lift, (1 + 1e-6) * band(segment.placed.segment)):
                problem = f"the lift falls to {mm(low, unit=unit):g} at {angle:g} deg, below the base circle"
                remedy = "give other values there, or more lift and a smaller base_radius"
                if segment.fit:
                    wide = f"{mm(segment.fit.wide, unit=unit):up2}" if segment.fit.wide > 0 else ""
                    within = f"a `within` of at least {wide}" if wide else "a larger `within`"
                    remedy = f"no curve was found within the band and above the base circle: give {within}"
                raise DesignError(segment.placed.place, problem, remedy)
