"""What a path search found: a linkage, how far its path is from the points, and what it gives besides."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ...core.errors import DesignError
from ...core.progress import Watch
from ...core.records import record
from ...linkage.coupler_curve import Cognate, cognates
from ...linkage.linkage import AbstractLinkage
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar, SliderCrank
from ...plane.vec import Complex, Real, Whole, cross
from ..found import Found
from ..rounding import Rounding
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
    along,
    closing,
    folded,
    points_of,
)
from .fits import PathTask, nearest, polished, refined
from .nine_points import reached, through_nine, with_cognates
from .starts import free_starts, timed_starts

# What counts as usable: a transmission angle, deg, and a ratio of links that a workshop can live with.
USABLE_DEG, USABLE_RATIO = 30.0, 10.0
# By how much of itself a limit may be missed and count as held, for rounding.
ROUNDED = 1e-6


@record(eq=False, kw_only=True)
class PathFound(Found):
    """A linkage whose coupler point goes through given points, or near them.

    drive: the crank's angle at each point, rad from the ground line; of a closed path at the nearest point of it.
    square_error: sum of squared distances of the points from the path, mm2, of timed ones from where the coupler point
    then is. largest_distance: the largest of them, mm. closed: whether a full turn draws the path. at_limits: in words,
    the limits that it stands on. cut_short: the search was ended by its time. may_be_incomplete: nine points have a
    finite number of linkages, of which the search may have missed some; another seed or more time may find them.
    ranked: distinct linkages, the best first, this one among them; those with a defect come last. least_squares: more
    points are given than linkages can be made to meet.
    """

    points: Complex
    square_error: float
    largest_distance: float
    closed: bool = False
    at_limits: tuple[str, ...] = ()
    cut_short: bool = False
    may_be_incomplete: bool = False
    least_squares: bool = False
    ranked: tuple[PathFound, ...] = ()
    again: Callable[[], PathFound | None] | None = field(default=None, repr=False)

    @property
    def coupler_point(self) -> complex:
        """In the coupler's frame, mm."""
        return complex(self.linkage.coupler_point)  # type: ignore[attr-defined]

    @property
    def is_usable(self) -> bool:
        """Whether it has no defect, a transmission angle of 30 deg and more, and a ratio of links of 10 and less."""
        angle, ratio = self.transmission_angle_deg, self.ratio
        return not self.defects and angle >= USABLE_DEG * (1 - ROUNDED) and bool(ratio <= USABLE_RATIO * (1 + ROUNDED))

    @cached_property
    def usable(self) -> PathFound | None:
        """The best that is usable too: itself if it is, else searched for when first asked; None where none is found.

        Without such limits the best linkage of a path is often one that jams or has endless links.
        """
        if self.is_usable:
            return self
        return self.again() if self.again else None

    @cached_property
    def cognates(self) -> tuple[Cognate, ...]:
        """It and the two other four-bars that draw the same path; () of a slider-crank, and where one has no size."""
        if not isinstance(self.linkage, FourBar):
            return ()
        try:
            return cognates(self.linkage)
        except DesignError:
            return ()

    @property
    def drive_range(self) -> tuple[float, float]:
        return (0.0, 2 * np.pi) if self.closed else super().drive_range

    def rounded(self, rounding: Rounding) -> PathFound:
        other = super().rounded(rounding)
        # One with a defect may reach some of the points on its other branch.
        branches = (1, -1) if self.defects else (self.branch,)
        paths = [move(other.linkage, other.drive, sign).point("coupler_point").position for sign in branches]
        off = np.fmin.reduce(np.abs(np.array(paths) - self.points))
        return replace(other, square_error=float(np.sum(off**2)), largest_distance=float(off.max()))

    def summary(self) -> Mapping[str, object]:
        told: dict[str, object] = {
            "square_error_mm2": float(f"{self.square_error:.6g}"),
            "largest_distance_mm": float(f"{self.largest_distance:.6g}"),
        }
        more: dict[str, object] = {"at_limits": list(self.at_limits)} if self.at_limits else {}
        return told | dict(super().summary()) | more

    @property
    def drive_deg(self) -> Real:
        """The crank's angles at the points, deg."""
        return np.degrees(self.drive)


# Turns nearer to a full one than this are none: the same point twice, and rounding.
NO_TURN = 1e-9
# By how much the cosine of a transmission angle may pass 1 for rounding.
ROUNDING = 1e-12


@record(eq=False)
class Way:
    """The crank's angles (n,), rad, least transmission angle, rad (nan where it does not close), and the defects."""

    drive: Real
    transmission: float
    defects: tuple[str, ...]


def way_through(task: PathTask, x: Real, cranks: Real, branch: Whole) -> Way:
    """How the crank of the linkage x (10,) goes through cranks (n,), each known but for turns, on branches (n,).

    It goes one way, no more than one turn, and closes all the way: else the order is wrong, as where the branch or the
    circuit changes. Angles that were prescribed are taken as they are, and a closed path has no order. The rule of
    circuits is that of `linkage.circuits`.
    """
    defects = []
    if not task.slides and not task.closed and _circuits(x, cranks, branch) > 1:
        defects.append("circuit")
    if len(np.unique(branch)) > 1:
        defects.append("branch")
    if task.turns is not None:
        drive, order = cranks, True
    elif task.closed:
        drive, order = cranks % (2 * np.pi), True
    else:
        drive, order = _one_way(task, x, cranks, bool(defects))
    if not order:
        defects.append("order")
    most = _most_folded(task, x, drive)
    transmission = float(np.arccos(min(most, 1.0))) if most <= 1 + ROUNDING and not defects else np.nan
    return Way(drive, transmission, tuple(defects))


def _one_way(task: PathTask, x: Real, cranks: Real, defect: bool) -> tuple[Real, bool]:
    """The angles on from each other in the sense that closes all the way, the shorter if both do; whether one does."""
    best: tuple[float, Real] | None = None
    for sense in (1, -1):
        turns = (sense * np.diff(cranks)) % (2 * np.pi)
        turns[turns > 2 * np.pi - NO_TURN] = 0
        drive = cranks[0] + sense * np.concatenate([[0.0], np.cumsum(turns)])
        total = float(turns.sum())
        closes = defect or _most_folded(task, x, drive) <= 1 + ROUNDING
        if total <= 2 * np.pi + NO_TURN and closes and (best is None or total < best[0]):
            best = total, drive
    return (np.unwrap(cranks), False) if best is None else (best[1], True)


def _most_folded(task: PathTask, x: Real, drive: Real) -> float:
    """The largest cosine of the transmission angle, without its sign, over the way from the first to the last."""
    at, inside = task.extremes(drive[None])
    cranks = np.concatenate([drive, at[inside[0]]])
    return float(np.abs(folded(x[None], cranks[None], task.slides)).max())


def _circuits(x: Real, cranks: Real, branch: Whole) -> int:
    """On how many circuits the poses of a four-bar lie."""
    d, a, b, c = (float(x[k]) for k in (GROUND, CRANK, COUPLER, ROCKER))
    shortest, second, third, longest = sorted((d, a, b, c))
    if shortest + longest >= second + third:
        return 1
    crank, coupler = (
        np.array([v[0, 0] for v in pair])
        for pair in zip(
            *(closing(x[None], np.array([[q]]), np.array([float(s)]), False) for q, s in zip(cranks, branch))
        )
    )
    rocker = a * crank + b * coupler - d
    # The sign at a joint that is not adjacent to the shortest link.
    sign = cross(coupler, rocker) if shortest in (d, a) else cross(np.ones_like(crank), crank)
    return len(np.unique(np.sign(sign)))


# Up to so many points are searched with, the rest come in when that is done: more take longer and find nothing else.
SEARCHED = 60
# Sums of squares a point, in units of the points' size, that count as none: then the transmission angle decides.
MET = 1e-24
# Linkages that differ in all sizes by less than so much of them are one.
SAME = 1e-3
# Linkages that are ranked, at most.
RANKED = 100
# Share of the time that is spent on nine points as such: the rest is kept for linkages near them, if none is sound.
NINE = 0.75


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

    def usable(self) -> PathFound | None:
        """The best within the limits of what is usable, and those that are set."""
        task = self.task
        tighter = replace(
            task,
            least_transmission=max(task.least_transmission, np.radians(USABLE_DEG)),
            largest_ratio=min(task.largest_ratio, USABLE_RATIO),
        )
        ranked, _ = replace(self, task=tighter, all_nine=False).ranked(1)
        return replace(ranked[0], ranked=ranked) if ranked and ranked[0].is_usable else None

    def ranked(self, number: int) -> tuple[tuple[PathFound, ...], bool]:
        """Distinct linkages, the best first, and whether it was cut short. number: of the search, for its seed."""
        task, watch = self.task, Watch(self.time_limit, "linkages for the path")
        rng = np.random.default_rng([self.seed, number])
        found: list[PathFound] = []
        nine = self.all_nine and task.free and not task.closed and not task.slides and len(task.wanted) == 9
        if nine:
            part = Watch(NINE * self.time_limit, watch.what)
            found = self.through_nine(rng, part)
            watch.cut = part.cut
        if not any(not one.defects for one in found):
            x, t, branch = self.searched(rng, watch)
            cranks = task.cranks(x, t)
            found += [
                one
                for row in range(len(x))
                if (one := self.made(x[row], cranks[row], np.full(len(t[0]), int(branch[row]))))
            ]
        unit = MET * len(self.points) * self.size**2

        def rank(one: PathFound) -> tuple[float, ...]:
            # Cognates are equally near: which comes first must not hang on the last digits, as processors differ there.
            near, angle = float(f"{max(one.square_error, unit):.6g}"), _or_0(one.transmission_angle_deg)
            return len(one.defects), near, -round(angle, 4), round(one.ratio, 4), one.branch

        found.sort(key=rank)
        distinct: list[PathFound] = []
        for one in found:
            if not any(_alike(one, other) for other in distinct):
                distinct.append(replace(one, cut_short=watch.cut, may_be_incomplete=nine))
        watch.report(1.0)
        return tuple(distinct[:RANKED]), watch.cut

    def searched(self, rng: np.random.Generator, watch: Watch) -> tuple[Real, Real, Real]:
        """Linkages x (s, 10), cranks t (s, n) if these are free, and branches, the best first."""
        task = self.task
        few = task.thinned(SEARCHED)
        if few.free:
            x, t, branch = free_starts(few, rng, watch)
        else:
            x, branch = timed_starts(few, rng, watch)
            t = np.zeros((len(x), len(few.wanted)))
        if len(x):
            x, t, branch = polished(few, x, t, branch, watch)
        if few is not task and len(x):
            t = _for_all(task, few, x, t, branch)
            x, t, branch = refined(task, x, t, branch, watch)
        if task.free and task.closed and len(x):
            t = _settled(task, x, nearest(task, x, t, branch), branch)
        return x, t, branch

    def through_nine(self, rng: np.random.Generator, watch: Watch) -> list[PathFound]:
        """Of each three cognates through nine points the one that is best."""
        found = []
        for row in through_nine(self.task.wanted, rng, watch):
            three = [
                one
                for x in with_cognates(row, complex(self.task.wanted[0]))
                if (one := self.made(x, *reached(x, self.task.wanted)))
            ]
            if three:
                found.append(min(three, key=lambda one: (len(one.defects), -_or_0(one.transmission_angle_deg))))
        return [one for one in found if one.square_error <= 1e-16 * self.size**2 and self.is_within(one)]

    def made(self, x: Real, cranks: Real, branch: Whole) -> PathFound | None:
        """The linkage x (10,) at its cranks (n,), in mm; None for one that cannot be told in mm."""
        task, size = self.task, self.size
        way = way_through(task, x, cranks, branch)
        path = points_of(np.repeat(x[None], len(cranks), axis=0), cranks[:, None], branch.astype(float), task.slides)
        off = np.abs(path[:, 0] - task.wanted) * size
        turn = float(np.degrees(x[TURN]))
        # As it is told: within half a turn, or within its bounds.
        turn = turn if "ground_angle_deg" in self.bounded else (turn + 180.0) % 360.0 - 180.0
        placed: dict[str, Any] = {
            "crank": float(x[CRANK]) * size,
            "coupler": float(x[COUPLER]) * size,
            "coupler_point": complex(x[ARM_X], x[ARM_Y]) * size,
            "origin": complex(x[ORIGIN_X], x[ORIGIN_Y]) * size + self.middle,
            "ground_angle_deg": turn,
        }
        try:
            linkage: AbstractLinkage = (
                SliderCrank(offset=float(x[GROUND]) * size, **placed)
                if task.slides
                else FourBar(ground=float(x[GROUND]) * size, rocker=float(x[ROCKER]) * size, **placed)
            )
        except DesignError:
            return None
        drive = way.drive
        if "start_deg" not in self.bounded and not (task.free and task.closed):
            drive = drive - 2 * np.pi * np.floor(drive[0] / (2 * np.pi))
        return PathFound(
            linkage=linkage,
            branch=int(branch[0]),
            drive=drive,
            transmission_angle_deg=float(np.degrees(way.transmission)),
            defects=way.defects,
            points=self.points,
            closed=task.closed,
            square_error=float(np.sum(off**2)),
            largest_distance=float(off.max()),
            at_limits=self.limits_of(x, way),
            least_squares=self.more_than_can_be_met,
        )

    def is_within(self, one: PathFound) -> bool:
        """Whether a linkage without a defect keeps the limits; of the others none is asked."""
        least = float(np.degrees(self.task.least_transmission))
        return bool(one.defects) or (one.transmission_angle_deg >= least and one.ratio <= self.task.largest_ratio)

    @property
    def more_than_can_be_met(self) -> bool:
        """Whether there are more conditions than unknowns."""
        unknown = (9 if self.task.slides else 10) - self.task.free
        return len(self.points) * (1 if self.task.free else 2) > unknown

    def limits_of(self, x: Real, way: Way) -> tuple[str, ...]:
        """What a linkage stands on."""
        task = self.task
        told = []
        if way.transmission <= task.least_transmission * (1 + 1e-4):
            told.append(f"a transmission angle of {np.degrees(task.least_transmission):g} deg")
        lengths = x[list(task.links)]
        if lengths.max() >= task.largest_ratio * lengths.min() * (1 - 1e-4):
            told.append(f"a ratio of links of {task.largest_ratio:g}")
        return tuple(told)


def _or_0(value: float) -> float:
    return value if np.isfinite(value) else 0.0


def _alike(one: PathFound, other: PathFound) -> bool:
    """Whether two linkages are the same but for rounding, or for how a slide line is named."""
    if one.branch != other.branch and isinstance(one.linkage, FourBar):
        return False

    def sizes(found: PathFound) -> list[complex]:
        lengths = [abs(length) for length in found.lengths.values()]
        return [*lengths, found.coupler_point, found.linkage.origin]  # type: ignore[attr-defined]

    return all(
        abs(a - b) <= SAME * max(abs(a), abs(b), 1e-3 * one.lengths["crank"]) for a, b in zip(sizes(one), sizes(other))
    )


def _for_all(task: PathTask, few: PathTask, x: Real, t: Real, branch: Real) -> Real:
    """Cranks (s, n) for all points from those of few of them."""
    if not task.free:
        return np.zeros((len(x), len(task.wanted)))
    if task.closed:
        return _settled(task, x, nearest(task, x, np.zeros((len(x), len(task.wanted))), branch), branch)
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(task.wanted)))])
    chosen = np.unique(np.linspace(0, len(way) - 1, len(few.wanted)).round().astype(int))
    return _settled(task, x, np.stack([np.interp(way, way[chosen], row) for row in t]), branch)


def _settled(task: PathTask, x: Real, t: Real, branch: Real) -> Real:
    """Cranks at the very points of the paths that are nearest to the wanted ones."""
    for _ in range(20):
        point, by_crank = along(x, t, branch, task.slides)
        off = task.wanted - point
        step = np.real(np.conj(by_crank) * off) / np.abs(by_crank) ** 2
        new = t + np.clip(step, -0.1, 0.1)
        nearer = np.abs(points_of(x, new, branch, task.slides) - task.wanted) < np.abs(off)
        if not nearer.any():
            break
        t = np.where(nearer, new, t)
    return t
