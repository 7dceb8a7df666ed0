"""The search for the linkages of a path: starts, least squares, what comes of them in mm, and which is best."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...brief import one_line
from ...errors import DesignError
from ...linkage.bars import FourBar
from ...linkage.linkage import AbstractLinkage
from ...linkage.sliders import SliderCrank
from ...plane.vec import Complex, Real, Whole
from ...progress import Watch
from .coupler_paths import ARM_X, ARM_Y, COUPLER, CRANK, GROUND, ORIGIN_X, ORIGIN_Y, ROCKER, TURN, along, points_of
from .fits import PathTask, nearest, polished, refined
from .nine_points import reached, through_nine, with_cognates
from .results import USABLE_DEG, USABLE_RATIO, PathFound
from .starts import free_starts, timed_starts
from .way import Way, way_through

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


@dataclass(frozen=True, eq=False, kw_only=True)
class PathSearch:
    """A search for the linkages of a path."""

    points: Complex
    middle: complex
    size: float
    task: PathTask
    bounded: frozenset[str]
    all_nine: bool
    seed: int
    seconds: float

    __repr__ = one_line

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
        task, watch = self.task, Watch(self.seconds, "linkages for the path")
        rng = np.random.default_rng([self.seed, number])
        found: list[PathFound] = []
        nine = self.all_nine and task.free and not task.closed and not task.slides and len(task.wanted) == 9
        if nine:
            part = Watch(NINE * self.seconds, watch.what)
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
        watch.tell(1.0)
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
