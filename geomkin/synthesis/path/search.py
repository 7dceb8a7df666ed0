"""The search for the linkages of a path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from ...core.errors import DesignError
from ...core.fields import to_digits
from ...core.processes import Watch, report
from ...core.records import record
from ...linkage.linkage import AbstractLinkage, Linkage
from ...linkage.measures import least_transmission_angle
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar, SliderCrank
from ...plane.vec import Complex, Real, Whole
from ..found import least_angle_deg
from .any_curve import MARGIN_DEG, MARGIN_RATIO, ChainBounds, CurveSearch, CurveTask, State, cranks_along
from .closed_lines import (
    PARTS,
    RETURN_POINTS,
    WantedLine,
    along_line,
    distances,
    evenly,
    path_errors,
    returned,
    smooth_line,
)
from .coupler_paths import (
    ARM_X,
    ARM_Y,
    COUPLER,
    CRANK,
    GROUND,
    ORIGIN_X,
    ORIGIN_Y,
    ROCKER,
    TURN,
    points_of,
)
from .crank_motion import CrankMotion, crank_motion
from .curve_library import SIZE, TimedPoints, target_curve
from .dyad_chains import linkage_of
from .fits import PASSED, PathTask, nearest_angles, nearest_from, polished_starts, refined_starts
from .nine_points import PathCount, cranks_and_branches, special, through_nine, with_cognates
from .path_found import FULL_TURN, USABLE_DEG, USABLE_RATIO, PathFound, is_same, is_worse
from .starts import free_starts, timed_starts

# Longest link of a chain, as a multiple of the path's size.
LONGEST = 3.0
# Number of points in the search; further ones join at the end, since they take longer and change nothing earlier.
SEARCH_POINTS = 60
# Sum of squares per point, in units of the points' size squared, that counts as 0; the transmission angle then decides.
ZERO_ERROR = 1e-24
# Distance of a four-bar through nine points from them, as a share of their size; rounding of extreme ones is less.
EXACT = 1e-6
# Largest number of ranked linkages; nine random points have up to 150.
RANKED = 300


@record(eq=False, kw_only=True)
class PathSearch:
    """A search for the linkages of a path."""

    points: Complex
    middle: complex
    size: float
    task: PathTask
    bounded: frozenset[str]
    all_nine: bool
    seed: int
    time_limit: float
    bars: int = 4
    is_geared: bool = False
    effort: int = 1
    chain_bounds: ChainBounds | None = None
    given: int = 0

    @cached_property
    def wanted_line(self) -> WantedLine | None:
        """The closed line through the points of a closed path."""
        return WantedLine.through(self.points, self.task.weights) if self.task.closed else None

    @cached_property
    def line(self) -> Complex:
        """The closed line that chains follow, for an open path with a way back."""
        return self.wanted_line.line if self.wanted_line else smooth_line(returned(self.points))

    def nothing_found(self) -> DesignError:
        """The reason why there is no linkage."""
        is_bounded = self.bounded or (self.chain_bounds and self.chain_bounds != ChainBounds())
        problem = "no linkage was found that moves within the limits"
        return DesignError(
            "bounds" if is_bounded else "points", problem, "give wider limits or bounds, or another seed"
        )

    def usable(self) -> PathFound | None:
        """The best linkage within the given limits and those of a usable one."""
        task = self.task
        tighter = replace(
            task,
            least_transmission=max(task.least_transmission, np.radians(USABLE_DEG)),
            largest_ratio=min(task.largest_ratio, USABLE_RATIO),
        )
        ranked, _ = replace(self, task=tighter, all_nine=False).ranked(1)
        return replace(ranked[0], ranked=ranked) if ranked and ranked[0].is_usable else None

    def ranked(self, number: int) -> tuple[tuple[PathFound, ...], Watch]:
        """Distinct linkages, the best first, and the watch of the search for them; `number` varies the seed."""
        task, what = self.task, "linkages for the path"
        linkages: list[PathFound] = []
        count, arrangement = None, ""
        if self.all_nine and task.free and not task.closed and not task.slides and len(task.wanted) == 9:
            arrangement = special(task.wanted)
            if not arrangement:
                linkages, count = self.through_nine(lambda share: report(share, what))
        watch = Watch(self.time_limit, what)
        if self.chain_bounds:
            linkages = self.chains(number, watch)
        elif not any(not linkage.defects for linkage in linkages):
            x, t, branch = self.searched(np.random.default_rng([self.seed, number]), watch)
            cranks = task.cranks(x, t)
            linkages += [
                linkage
                for row in range(len(x))
                if (linkage := self.made(x[row], cranks[row], np.full(len(t[0]), int(branch[row]))))
            ]
        unit_error = ZERO_ERROR * len(self.points) * self.size**2

        def rank(linkage: PathFound) -> tuple[float, ...]:
            # Cognates are equally near; their order must not depend on the last digits, which differ by processor.
            # The line between scattered points decides nothing if a linkage meets more of them than chance allows.
            meets = linkage.square_error < len(self.points) * (EXACT * self.size) ** 2
            meets = meets and self.more_than_can_be_met
            square = linkage.square_error
            if task.closed and not meets:
                square = linkage.deviation**2
            elif linkage.weighted_rms_distance is not None:
                square = linkage.weighted_rms_distance**2 * len(self.points)
            error, angle = to_digits(max(square, unit_error), 6), _zero_if_nan(linkage.transmission_angle_deg)
            return len(linkage.defects), error, -round(angle, 4), round(linkage.ratio, 4), linkage.branch

        linkages.sort(key=rank)
        distinct: list[PathFound] = []
        for linkage in linkages:
            if not any(is_same(linkage, other) or (self.bars > 4 and is_worse(linkage, other)) for other in distinct):
                distinct.append(replace(linkage, cut_short=watch.cut, path_count=count, special=arrangement))
        watch.report(1.0)
        return tuple(distinct[:RANKED]), watch

    def searched(self, rng: np.random.Generator, watch: Watch) -> tuple[Real, Real, Real]:
        """Linkages x (s, 10), cranks t (s, n) if these are free, and branches, the best first."""
        task = self.task
        if task.free and task.closed and not task.slides and not self.bounded:
            return self.closed_four_bars(rng, watch)
        few = task.thinned(SEARCH_POINTS)
        if few.free:
            x, t, branch = free_starts(few, rng, watch)
        else:
            x, branch = timed_starts(few, rng, watch)
            t = np.zeros((len(x), len(few.wanted)))
        if len(x):
            # A search that is cut short has hundreds.
            x, t, branch = (rows[:30] for rows in polished_starts(few, x, t, branch, watch))
        if few is not task and len(x):
            t = _cranks_for_all_points(task, few, x, t, branch)
            x, t, branch = refined_starts(task, x, t, branch, watch)
        if task.free and task.closed and len(x):
            t = nearest_from(task, x, nearest_angles(task, x, t, branch), branch)
        return x, t, branch

    def _curve_search(self, seed: int, watch: Watch) -> tuple[CurveTask, list[State]]:
        """The task of a search for chains, and the chains that it finds."""
        if self.wanted_line is None:
            # The way back counts nothing.
            weights = along_line(np.append(self.task.root**2, np.ones(RETURN_POINTS - 1)))
            weights[PARTS * (len(self.points) - 1) + 1 :] = 0
        else:
            weights = self.wanted_line.weights
        target = target_curve(self.line, weights)
        bounds = (self.chain_bounds or ChainBounds()).scaled(target.scale, target.middle)
        bounds = replace(bounds, links=(bounds.links[0], min(bounds.links[1], LONGEST * SIZE)))
        limits = float(np.degrees(self.task.least_transmission)), self.task.largest_ratio
        timed = None
        if self.task.turns is not None:
            places = (self.points - target.middle) / target.scale
            timed = TimedPoints(places, self.task.turns, self.task.root**2)
        task = CurveTask(target, *limits, bounds, timed)
        return task, list(CurveSearch(task, self.bars, self.is_geared, self.effort, seed, watch).run().values())

    def closed_four_bars(self, rng: np.random.Generator, watch: Watch) -> tuple[Real, Real, Real]:
        """`searched` for closed paths: the best two ways, and these with the least squares of the points alone."""
        curve, found = self._curve_search(int(rng.integers(2**32)), watch)
        rows, signs = [], []
        for state in found:
            for k in range(len(state)):
                bar, sign = linkage_of(state.chains, k, curve.target.scale, curve.target.middle)
                assert isinstance(bar, FourBar)
                place, arm = bar.origin - self.middle, complex(bar.coupler_point)
                lengths = [bar.ground, bar.crank, bar.coupler, bar.rocker, arm.real, arm.imag, place.real, place.imag]
                rows.append([*(np.array(lengths, dtype=float) / self.size), np.radians(bar.ground_angle_deg), 0.0])
                signs.append(sign)
        x, branch = np.array(rows).reshape(-1, 10), np.array(signs, dtype=float)
        t = nearest_angles(self.task, x, np.zeros((len(x), len(self.task.wanted))), branch)
        better = refined_starts(self.task, x, t, branch, watch)
        x, t, branch = (np.concatenate(pair) for pair in zip((x, t, branch), better))
        good = self.task.passed(x, t) <= PASSED
        return x[good], nearest_from(self.task, x[good], t[good], branch[good]), branch[good]

    def chains(self, number: int, watch: Watch) -> list[PathFound]:
        """Four- to eight-bars for a path, each measured by its motion alone."""
        curve, found = self._curve_search(int(np.random.default_rng([self.seed, number]).integers(2**32)), watch)
        target, made = curve.target, []
        for state in found:
            cranks: Real | None = None
            if self.task.turns is not None:
                cranks = state.cranks[:, :1] + self.task.turns
            elif self.wanted_line is None:
                shares = evenly(self.line[None], 2)[1][0, : PARTS * len(self.points) : PARTS]
                cranks = cranks_along(curve, state, shares)
            for k in range(len(state)):
                try:
                    linkage, branch = linkage_of(state.chains, k, target.scale, target.middle)
                except DesignError:
                    # A size beyond all that are allowed.
                    continue
                # The crank of a chain is at its first pin's angle from that of a linkage.
                turned = np.angle(state.chains.pins[k, 0, 0]) - np.radians(linkage.ground_angle_deg)
                made.append(self.measured(linkage, branch, None if cranks is None else cranks[k] + turned))
        # Least squares may exceed the longest link a little.
        longest = 2 * LONGEST * SIZE * target.scale
        return [linkage for linkage in made if linkage is not None and linkage.size < longest]

    def measured(self, linkage: FourBar | Linkage, branch: int, cranks: Real | None) -> PathFound | None:
        """A linkage whose crank turns fully, measured, at the points at these crank angles if these are given.

        None if it does not close or violates a limit.
        """
        motion = move(linkage, FULL_TURN, branch)
        path, angle = motion.point("coupler_point").position, float(least_transmission_angle(motion))
        if not motion.assembled.all() or angle < self.task.least_transmission:
            return None
        if cranks is None:
            off = distances(self.points, path)
            drive = FULL_TURN[[int(np.argmin(np.abs(path[:-1] - point))) for point in self.points]]
        else:
            drive = cranks - 2 * np.pi * np.floor(cranks[0] / (2 * np.pi))
            off = np.abs(move(linkage, drive, branch).point("coupler_point").position - self.points)
        found = PathFound(
            linkage=linkage,
            branch=branch,
            drive=drive,
            transmission_angle_deg=float(np.degrees(angle)),
            points=self.points,
            closed=self.task.closed,
            wanted_line=self.wanted_line,
            weights=self.task.weights,
            is_timed=not self.task.free,
            given=self.given,
            least_squares=True,
            **path_errors(off, self.task.weights, self.wanted_line, path),
        )
        if not self.task.closed:
            # The crank turns fully, and a part of its turn is used.
            found = replace(found, transmission_angle_deg=least_angle_deg(found))
        limits = []
        if np.degrees(angle - self.task.least_transmission) < 1.1 * MARGIN_DEG:
            limits.append(f"a transmission angle of {np.degrees(self.task.least_transmission):g} deg")
        if found.ratio > 0.99 * MARGIN_RATIO * self.task.largest_ratio:
            limits.append(f"a ratio of links of {self.task.largest_ratio:g}")
        low, high = (self.chain_bounds or ChainBounds()).links
        bodies = linkage.linkage.bodies.values()
        pins = [[place for name, place in points.items() if name != "coupler_point"] for points in bodies]
        apart = max(abs(complex(a) - complex(b)) for row in pins for a, b in combinations(row, 2))
        is_within = found.ratio <= self.task.largest_ratio and low <= min(found.lengths.values()) and apart <= high
        return replace(found, at_limits=tuple(limits)) if is_within else None

    def through_nine(self, report: Callable[[float], None]) -> tuple[list[PathFound], PathCount]:
        """The best of each three cognates, driven at either pivot, and where all paths to them ended."""
        wanted, linkages = self.task.wanted, []
        rows, count = through_nine(wanted, report)
        for row in rows:
            # Each cognate may be driven at either of its ground pivots.
            both_ways = (row, row[[4, 5, 6, 7, 0, 1, 2, 3]])
            sizes = [x for places in both_ways for x in with_cognates(places, complex(wanted[0]))]
            made = [self.made(x, *cranks_and_branches(x, wanted)) for x in sizes]
            exact = [found for found in made if found is not None and found.square_error <= EXACT**2 * self.size**2]
            if exact:
                linkages.append(
                    min(exact, key=lambda one: (len(one.defects), -_zero_if_nan(one.transmission_angle_deg)))
                )
        return linkages, count

    def made(self, x: Real, cranks: Real, branch: Whole) -> PathFound | None:
        """The linkage x (10,) at its crank angles (n,), in mm; None if its sizes are out of range."""
        task, size = self.task, self.size
        motion = crank_motion(task, x, cranks, branch)
        path = points_of(np.repeat(x[None], len(cranks), axis=0), cranks[:, None], branch.astype(float), task.slides)
        off = np.abs(path[:, 0] - task.wanted) * size
        ground_angle = float(np.degrees(x[TURN]))
        # Reported within half a turn, or within its bounds.
        ground_angle = ground_angle if "ground_angle_deg" in self.bounded else (ground_angle + 180.0) % 360.0 - 180.0
        sizes: dict[str, Any] = {
            "crank": float(x[CRANK]) * size,
            "coupler": float(x[COUPLER]) * size,
            "coupler_point": complex(x[ARM_X], x[ARM_Y]) * size,
            "origin": complex(x[ORIGIN_X], x[ORIGIN_Y]) * size + self.middle,
            "ground_angle_deg": ground_angle,
        }
        try:
            linkage: AbstractLinkage = (
                SliderCrank(offset=float(x[GROUND]) * size, **sizes)
                if task.slides
                else FourBar(ground=float(x[GROUND]) * size, rocker=float(x[ROCKER]) * size, **sizes)
            )
        except DesignError:
            return None
        if self.wanted_line is not None:
            path = points_of(x[None], FULL_TURN[None], branch[:1].astype(float), task.slides) * size + self.middle
        drive = motion.drive
        if "start_deg" not in self.bounded and not (task.free and task.closed):
            drive = drive - 2 * np.pi * np.floor(drive[0] / (2 * np.pi))
        return PathFound(
            linkage=linkage,
            branch=int(branch[0]),
            drive=drive,
            transmission_angle_deg=float(np.degrees(motion.transmission)),
            defects=motion.defects,
            points=self.points,
            closed=task.closed,
            wanted_line=self.wanted_line,
            weights=self.task.weights,
            is_timed=not self.task.free,
            given=self.given,
            at_limits=self.active_limits(x, motion),
            least_squares=self.more_than_can_be_met,
            **path_errors(off, self.task.weights, self.wanted_line, path[0]),
        )

    @property
    def more_than_can_be_met(self) -> bool:
        """Whether there are more conditions than unknowns."""
        unknown = (9 if self.task.slides else 10) - self.task.free
        return len(self.points) * (1 if self.task.free else 2) > unknown

    def active_limits(self, x: Real, motion: CrankMotion) -> tuple[str, ...]:
        """The active limits of a linkage, in words."""
        task = self.task
        limits = []
        if motion.transmission <= task.least_transmission * (1 + 1e-4):
            limits.append(f"a transmission angle of {np.degrees(task.least_transmission):g} deg")
        lengths = x[list(task.links)]
        if lengths.max() >= task.largest_ratio * lengths.min() * (1 - 1e-4):
            limits.append(f"a ratio of links of {task.largest_ratio:g}")
        return tuple(limits)


def _zero_if_nan(value: float) -> float:
    return value if np.isfinite(value) else 0.0


def _cranks_for_all_points(task: PathTask, few: PathTask, x: Real, t: Real, branch: Real) -> Real:
    """Crank angles (s, n) for all points from those for a part of them."""
    if not task.free:
        return np.zeros((len(x), len(task.wanted)))
    if task.closed:
        return nearest_from(task, x, nearest_angles(task, x, np.zeros((len(x), len(task.wanted))), branch), branch)
    path_length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(task.wanted)))])
    chosen = np.unique(np.linspace(0, len(path_length) - 1, len(few.wanted)).round().astype(int))
    return nearest_from(task, x, np.stack([np.interp(path_length, path_length[chosen], row) for row in t]), branch)
