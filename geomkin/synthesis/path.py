"""Path generation: a four-bar or slider-crank whose coupler point goes through given points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from ..arguments import Positive, Reals, Sort, between, checked, is_real, numbers, whole_between
from ..errors import DesignError
from ..linkage.linkage import AbstractLinkage
from ..linkage.named.four_bar import FourBar
from ..linkage.named.slider_crank import SliderCrank
from ..plane.vec import Complex, Real, Whole
from ..progress import Watch
from ..sizes import FARTHEST, SMALLEST
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
    points_of,
)
from .free_paths import free_starts
from .nine_points import reached, through_nine
from .path_bounds import bound_all_links, bounds_of
from .path_fits import PathTask, nearest, polished, refined
from .path_found import USABLE_DEG, USABLE_RATIO, PathFound
from .timed_paths import timed_starts
from .way import Way, way_through

# Points at most: more take minutes. Up to so many are searched with, the rest come in when that is done: more take
# longer and find nothing else.
MOST_POINTS, SEARCHED = 2_000, 60
# Where nothing limits them: the least transmission angle, deg, and the largest ratio of links of a search, without
# which many have no end; and the same where the lengths are bounded.
TOGGLE_DEG, LONGEST_RATIO = 5.0, 100.0
STUCK_DEG, ANY_RATIO = 0.1, 1e6
# Sums of squares a point, in units of the points' size, that count as none: then the transmission angle decides.
MET = 1e-24
# Linkages that differ in all sizes by less than so much of them are one.
SAME = 1e-3
# Linkages that are ranked, at most.
RANKED = 100

Angles = Annotated[
    Reals,
    Sort(
        lambda value: np.ndim(value) == 1 and numbers(value, "iuf") is not None and bool(np.isfinite(value).all()),
        "a row of angles in deg, one for each point",
    ),
]
Bounds = Annotated[
    Mapping[str, tuple[float, float]],
    Sort(
        lambda value: (
            isinstance(value, Mapping)
            and all(
                isinstance(name, str)
                and isinstance(pair, (tuple, list, np.ndarray))
                and np.shape(pair) == (2,)
                and all(is_real(v) and abs(v) <= FARTHEST for v in pair)
                for name, pair in value.items()
            )
        ),
        f"a table of names, each with its least and its greatest value within {FARTHEST:g} of 0",
    ),
]
PathPoints = Annotated[
    Complex,
    Sort(
        lambda value: (
            np.ndim(value) == 1 and numbers(value) is not None and bool((np.abs(np.asarray(value)) <= FARTHEST).all())
        ),
        f"a row of points as complex numbers x + yj, in mm, within {FARTHEST:g} of 0",
    ),
]


@checked
def path_generator(
    points: PathPoints,
    drive_deg: Angles | None = None,
    closed: bool = False,
    least_transmission_angle_deg: Annotated[float, between(0, 89)] | None = None,
    largest_ratio: Annotated[float, between(1, 1e6)] | None = None,
    bounds: Bounds | None = None,
    seed: Annotated[int, whole_between(0, 2**32 - 1)] = 0,
    seconds: Positive = 10,
    slides: bool = False,
) -> PathFound:
    """A four-bar, or where it `slides` a slider-crank, whose coupler point goes through the points (n,), mm.

    drive_deg: the crank's angles at the points, rising or falling, of which only the differences count unless bounds
    hold the start; None: any, in one drive of one sense on one circuit, no more than a turn. closed: the points lie on
    a closed curve that is drawn by a full turn, in any order, and the error is their distance from the curve.
    least_transmission_angle_deg: held from the first point to the last, or over the turn. largest_ratio: longest
    link over shortest. Without them 5 deg and 100 are held, as many problems run to a toggle or to endless links, and
    `.at_limits` says where the answer stands on them; where all links are bounded, the bounds alone count. bounds: name
    -> (low, high) of ground (of a slider-crank offset), crank, coupler, rocker, coupler_point_x, coupler_point_y,
    origin_x, origin_y in mm, ground_angle_deg, and start_deg, the crank's first angle from the ground line; they hold
    exactly. seconds: a stop; the search ends by itself.

    The least sum of squared distances that is found, from tens of thousands of random linkages held against the points
    in closed form, the best of them improved by least squares. Nine points that are free of other conditions have a
    finite number of four-bars through them: those that are found are all ranked, each with its defects, one of three
    cognates. `.usable` is the best with 30 deg and a ratio of 10. DesignError for fewer than 3 points, points that are
    all the same, more than 2000, angles that are not in order, bounds that are none, time too short for any answer, and
    where no linkage is found within the limits. Derived here; the sources are told where the work is done.
    """
    wanted = np.asarray(points, dtype=complex)
    if not 3 <= len(wanted) <= MOST_POINTS:
        raise DesignError("points", f"found {len(wanted):,}", f"give from 3 to {MOST_POINTS:,} points")
    middle = complex(wanted.mean())
    size = float(np.sqrt(np.mean(np.abs(wanted - middle) ** 2)))
    if not size > max(SMALLEST, 1e-12 * abs(middle)):
        raise DesignError("points", "all are the same", "give points apart from each other")
    turns = None if drive_deg is None else _turns(np.asarray(drive_deg, dtype=float), len(wanted))
    low, high = bounds_of(bounds, slides, turns is not None, middle, size)
    held = bound_all_links(bounds, slides)
    least = least_transmission_angle_deg
    search = _Search(
        points=wanted,
        middle=middle,
        size=size,
        task=PathTask(
            wanted=(wanted - middle) / size,
            turns=turns,
            closed=closed,
            slides=slides,
            least_transmission=np.radians(
                (STUCK_DEG if held else TOGGLE_DEG) if least is None else max(least, STUCK_DEG)
            ),
            largest_ratio=(ANY_RATIO if held else LONGEST_RATIO) if largest_ratio is None else largest_ratio,
            low=low,
            high=high,
        ),
        bounded=frozenset(bounds or ()),
        all_nine=bounds is None and least is None and largest_ratio is None,
        seed=seed,
        seconds=seconds,
    )
    ranked = search.ranked(0)
    if not ranked:
        if search.cut:
            raise DesignError("seconds", f"found {seconds:g} s, too short for any answer", "give 10 or more")
        raise DesignError(
            "bounds" if bounds else "points",
            "no linkage was found that moves within the limits",
            "give wider limits or bounds, or another seed",
        )
    return replace(ranked[0], ranked=ranked, again=search.usable)


def _turns(drive_deg: Real, count: int) -> Real:
    if len(drive_deg) != count:
        raise DesignError("drive_deg", f"found {len(drive_deg)} angles for {count} points", "give one for each point")
    steps = np.diff(drive_deg)
    if not ((steps > 0).all() or (steps < 0).all()):
        raise DesignError("drive_deg", "the angles neither all rise nor all fall", "give them in order")
    turns: Real = np.radians(drive_deg - drive_deg[0])
    return turns


@dataclass(eq=False, kw_only=True)
class _Search:
    """A search for the linkages of a path."""

    points: Complex
    middle: complex
    size: float
    task: PathTask
    bounded: frozenset[str]
    all_nine: bool
    seed: int
    seconds: float
    cut: bool = False

    def usable(self) -> PathFound | None:
        """The best within the limits of what is usable, and those that are set."""
        task = self.task
        tighter = replace(
            task,
            least_transmission=max(task.least_transmission, np.radians(USABLE_DEG)),
            largest_ratio=min(task.largest_ratio, USABLE_RATIO),
        )
        ranked = replace(self, task=tighter, all_nine=False).ranked(1)
        return replace(ranked[0], ranked=ranked) if ranked and ranked[0].is_usable else None

    def ranked(self, number: int) -> tuple[PathFound, ...]:
        """Distinct linkages, the best first."""
        task, watch = self.task, Watch(self.seconds, "linkages for the path")
        rng = np.random.default_rng([self.seed, number])
        found: list[PathFound] = []
        if self.all_nine and task.free and not task.closed and not task.slides and len(task.wanted) == 9:
            found = self.through_nine(rng, watch)
        if not any(not one.defects for one in found):
            x, t, branch = self.searched(rng, watch)
            cranks = task.cranks(x, t)
            found += [
                one
                for row in range(len(x))
                if (one := self.made(x[row], cranks[row], np.full(len(t[0]), int(branch[row]))))
            ]
        self.cut = watch.cut
        unit = MET * len(self.points) * self.size**2
        found.sort(key=lambda one: (len(one.defects), max(one.square_error, unit), -_or_0(one.transmission_angle_deg)))
        distinct: list[PathFound] = []
        for one in found:
            if not any(_alike(one, other) for other in distinct):
                distinct.append(replace(one, cut_short=self.cut))
        watch.tell(1.0)
        return tuple(distinct[:RANKED])

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
                for x in _cognates(row, complex(self.task.wanted[0]))
                if (one := self.made(x, *reached(x, self.task.wanted)))
            ]
            if three:
                found.append(min(three, key=lambda one: (len(one.defects), -_or_0(one.transmission_angle_deg))))
        return [one for one in found if one.square_error <= 1e-16 * self.size**2]

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
            square_error=float(np.sum(off**2)),
            largest_distance=float(off.max()),
            at_limits=self.limits_of(x, way),
            least_squares=self.more_than_can_be_met,
        )

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


def _cognates(places: Real, point: complex) -> list[Real]:
    """A linkage by its pins and pivots (8,) and its cognates as rows (10,), as in `linkage.cognates`."""
    pin, pivot, other, other_pivot = (complex(z) for z in places.view(complex))
    crank, coupler, rocker, ground = pin - pivot, other - pin, other - other_pivot, other_pivot - pivot
    share = (point - pin) / coupler
    third = pivot + share * ground
    rest = 1 - share
    links = (
        (pivot, ground, crank, coupler, rocker),
        (pivot, share * ground, share * coupler, share * crank, share * rocker),
        (third, rest * ground, rest * crank, -rest * rocker, -rest * coupler),
    )
    rows = []
    for origin, d, a, b, c in links:
        arm = (point - origin - a) * np.conj(b) / abs(b)
        lengths = [abs(d), abs(a), abs(b), abs(c)]
        rows.append(np.array([*lengths, arm.real, arm.imag, origin.real, origin.imag, np.angle(d), 0.0]))
    return rows
