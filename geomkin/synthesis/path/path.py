"""Path generation: a four-bar or slider-crank whose coupler point goes through given points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import ArgumentType, Positive, between, checked, is_real, numbers, whole_between
from ...core.errors import DesignError
from ...core.fields import FARTHEST, SMALLEST
from ...plane.vec import Real
from .coupler_paths import bound_all_links, bounds_of
from .fits import PathTask
from .search import PathFound, PathSearch

# Points at most: more take minutes.
MOST_POINTS = 1_000
# Where nothing limits them: the least transmission angle, deg, and the largest ratio of links of a search, without
# which many have no end; and the same where the lengths are bounded.
TOGGLE_DEG, LONGEST_RATIO = 5.0, 100.0
STUCK_DEG, ANY_RATIO = 0.1, 1e6


def _is_row(value: Any, kinds: str) -> bool:
    """Whether this is a row of numbers of bearable size."""
    row = numbers(value, kinds)
    return row is not None and row.ndim == 1 and bool((np.abs(row) <= FARTHEST).all())


Angles = Annotated[
    ArrayLike, ArgumentType(lambda value: _is_row(value, "iuf"), "a row of angles in deg, one for each point")
]
Bounds = Annotated[
    Mapping[str, tuple[float, float]],
    ArgumentType(
        lambda value: (
            isinstance(value, Mapping)
            and all(
                isinstance(name, str)
                and isinstance(pair, (tuple, list, np.ndarray))
                and len(pair) == 2
                and all(is_real(v) and abs(v) <= FARTHEST for v in pair)
                for name, pair in value.items()
            )
        ),
        f"a table of names, each with its least and its greatest value within {FARTHEST:g} of 0",
    ),
]
PathPoints = Annotated[
    ArrayLike,
    ArgumentType(
        lambda value: _is_row(value, "iufc"),
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
    time_limit: Positive = 10,
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
    exactly. time_limit: a stop; the search ends by itself.

    The least sum of squared distances that is found, from tens of thousands of random linkages held against the points
    in closed form, the best of them improved by least squares. Nine points that are free of other conditions have a
    finite number of four-bars through them: those that are found are all ranked, each with its defects, one of three
    cognates. Some may be missing, as `.may_be_incomplete` says: the search goes on, in three quarters of its time,
    until new starts bring nothing new. `.usable` is the best with 30 deg and a ratio of 10. DesignError for fewer than
    3 points, points that are all the same, more than 1000, angles that are not in order, bounds that are none, time too
    short for any answer, and where no linkage is found within the limits. Derived here; the sources are told where the
    work is done.
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
    search = PathSearch(
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
        time_limit=time_limit,
    )
    ranked, cut = search.ranked(0)
    if not ranked:
        if cut:
            raise DesignError("time_limit", f"found {time_limit:g} s, too short for any answer", "give 10 or more")
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
