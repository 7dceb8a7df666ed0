"""Path generation: a linkage whose traced point passes through given points or follows a closed curve."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import ArgumentType, PositiveFloat, between, checked, is_real, numbers, whole_between
from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST, SMALLEST
from ...core.units import bare_mm, mm
from ...linkage.linkage import AbstractLinkage
from ...plane.vec import Complex, Real
from .any_curve import ChainBounds
from .closed_lines import loop
from .coupler_paths import CHAIN_ONLY, bound_all_links, bounds_of, check_bound
from .curve_library import curve_library, target_curve
from .dyad_chains import linkage_of
from .fits import PathTask
from .path_found import PathFound
from .search import LONGEST, PathSearch

# Largest number of points, and of those that a search uses: more take minutes.
MOST_POINTS, MOST_USED = 200_000, 1_000
# Limits of six- and eight-bars if none are given.
CHAIN_DEG, CHAIN_RATIO = 20.0, 10.0
# Bounds of linkages for closed curves; others than these only four-bars and slider-cranks take.
CURVE_BOUNDS = ("origin_x", "origin_y", *CHAIN_ONLY)
# Limits of a search if none are given: the least transmission angle, deg, and the largest ratio of links. Without them
# many paths have no best linkage. The second line applies if all lengths are bounded.
TOGGLE_DEG, LONGEST_RATIO = 5.0, 100.0
STUCK_DEG, ANY_RATIO = 0.1, 1e6
# Least and greatest weight of a point.
WEIGHTS = (1e-3, 1e3)


def _is_row(value: Any, kinds: str) -> bool:
    """Whether a value is a 1-D array of numbers within the allowed range."""
    row = numbers(value, kinds)
    return row is not None and row.ndim == 1 and bool((np.abs(row) <= FARTHEST).all())


Angles = Annotated[
    ArrayLike, ArgumentType(lambda value: _is_row(value, "iuf"), "a row of angles in deg, one for each point")
]
Weights = Annotated[
    ArrayLike, ArgumentType(lambda value: _is_row(value, "iuf"), "a row of weights, one for each point")
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
    time_limit: PositiveFloat = 30,
    slides: bool = False,
    bars: Literal[4, 5, 6, 7, 8] = 4,
    geared: bool = False,
    effort: Annotated[int, whole_between(1, 100)] = 1,
    weights: Weights | None = None,
) -> PathFound:
    """Find the linkage whose traced point passes through given points or follows a closed curve.

    Parameters
    ----------
    points : array_like of complex, shape (n,)
        The points x + yj, mm; 3 to 200,000 of them. At most 1000, evenly chosen, are used.
    drive_deg : array_like, shape (n,), optional
        Crank angles at the points, deg, rising or falling. Only their differences count, unless `bounds` limits the
        start. By default the angles are free, within one drive of one sense on one circuit and at most one turn.
    closed : bool
        Whether the points lie, in any order if there are at most 300, on a closed curve that a full turn draws. The
        error is then the distance both ways: of the points from the curve, and of the curve from a smooth closed line
        through the points.
    least_transmission_angle_deg : float, optional
        Limit from the first point to the last, or over the full turn, 0 to 89 deg; 5 by default, 20 for more than four
        bars.
    largest_ratio : float, optional
        Limit of the longest link over the shortest, 1 to 1e6; 100 by default, 10 for more than four bars. If all links
        are bounded, neither default applies.
    bounds : mapping of str to (low, high), optional
        Exact bounds of `ground` (`offset` of a slider-crank), `crank`, `coupler`, `rocker`, `coupler_point_x`,
        `coupler_point_y`, `origin_x`, `origin_y` in mm, `ground_angle_deg`, and `start_deg`, the first crank angle from
        the ground line. For closed curves `origin_x`, `origin_y` of the crank pivot, `pivots_x`, `pivots_y` of all
        other ground pivots, and `links`, the distances of the pins of each body, which limit the size of the mechanism;
        with more than four bars only these.
    seed : int
        Seed of the random starts, 0 to 2**32 - 1.
    time_limit : float
        Longest processor time of the search from random linkages, s. The search usually ends by itself.
    slides : bool
        Whether a slider-crank is wanted instead of a four-bar.
    bars : {4, 5, 6, 7, 8}
        Largest number of bars. With more than 4 `ranked` also has linkages with fewer, and the crank turns fully; an
        open path is traced in a part of the turn.
    geared : bool
        Whether to search for five- and seven-bars as well, whose two cranks are coupled by gears.
    effort : int
        Work of the search for closed curves, and for open ones with more than four bars, 1 to 100: with 3 it takes
        three times as long and comes nearer.
    weights : array_like, shape (n,), optional
        Weights of the squared distances of the points, 0.001 to 1000, for parts of the path that matter more or less;
        of a closed path also of the distances of the curve from there. The result then has weighted distances as well,
        by which linkages are ranked. Nine points that linkages meet exactly need none.

    Returns
    -------
    PathFound
        The best linkage; `ranked` lists others, `usable` is the best with a transmission angle of 30 deg and a ratio of
        10, `at_limits` names the limits that are active.

    Raises
    ------
    DesignError
        For fewer than 3 or more than 200,000 points, coinciding points, angles out of order, invalid bounds, a time
        limit too short for any result, or if no linkage is found within the limits.

    See Also
    --------
    function_generator, body_guides, CouplerCurve

    Notes
    -----
    The search minimises the sum of squared distances. It compares tens of thousands of random linkages with the points
    in closed form and improves the best of them by least squares.

    Six- and eight-bars are chains of dyads on one crank, five- and seven-bars on two cranks with a ratio of 1, 2 or 3,
    in opposite senses or, with an idler, in one. Those of up to 50,000 random ones whose curves are most similar are
    refined by least squares of the distances both ways; others grow from the best with two bars less. The list leaves
    out a linkage if another is twice as near with no more bars, no longer links and no smaller transmission angle. The
    same seed and effort give the same list unless the time limit ends the search, which takes about 20 s for an effort
    of 1. At most half of the chains that are kept are of kinds whose plates mostly collide: a crank with several links,
    or a second dyad without a pivot. At the end the sums of higher powers of the distances are made least, which makes
    the largest distance smaller. Four-bars for closed curves without other bounds are found in the same way.

    Nine points without other conditions have a finite number of four-bars through them, up to 150. All are found, in 3
    to 30 s, whatever the time limit, and ranked, one of each three cognates. `path_count` states where the 1442 paths
    that lead to them ended.
    Points in a special position, such as seven on a line, have no finite number; `special` then says why, and the
    search proceeds as for other points.

    The method is derived here; the modules of each step cite their sources.

    Examples
    --------
    >>> import geomkin as gk
    >>> found = gk.path_generator([0, 10 + 5j, 20 + 5j, 30])
    >>> found.defects, found.largest_distance < 1e-6
    ((), True)
    """
    wanted = np.asarray(points, dtype=complex)
    _check_search(bars, geared, effort, closed, slides, drive_deg is not None)
    is_curve, chain_bounds = closed and drive_deg is None and not slides, None
    if bars > 4 or (bounds and is_curve and set(bounds) <= {*CURVE_BOUNDS}):
        chain_bounds, bounds = _chain_bounds(bounds or {}), None
    targets, crank_angles, weights_used = _used(wanted, drive_deg, closed, weights, bars)
    centre = complex(targets.mean())
    size = float(np.sqrt(np.mean(np.abs(targets - centre) ** 2)))
    if not size > max(SMALLEST, 1e-12 * abs(centre)):
        raise DesignError("points", "all are the same", "give points apart from each other", "conflict")
    low, high = bounds_of(bounds, slides, crank_angles is not None, centre, size)
    if chain_bounds:
        _check_pivots(targets, chain_bounds)
    least, usual = least_transmission_angle_deg, usual_limits(bars, bound_all_links(bounds, slides))
    path_search = PathSearch(
        points=targets,
        middle=centre,
        size=size,
        task=PathTask(
            wanted=(targets - centre) / size,
            turns=crank_angles,
            closed=closed,
            slides=slides,
            least_transmission=np.radians(usual[0] if least is None else max(least, STUCK_DEG)),
            largest_ratio=usual[1] if largest_ratio is None else largest_ratio,
            low=low,
            high=high,
            weights=weights_used,
        ),
        bounded=frozenset(bounds or ()),
        all_nine=bounds is None and least is None and largest_ratio is None,
        seed=seed,
        time_limit=time_limit,
        bars=bars,
        is_geared=geared,
        effort=effort,
        chain_bounds=chain_bounds,
        given=len(wanted) if len(wanted) > len(targets) else 0,
    )
    ranked, watch = path_search.ranked(0)
    if not ranked:
        raise watch.too_short() if watch.cut else path_search.nothing_found()
    return replace(ranked[0], ranked=ranked, again=path_search.usable if bars == 4 else None)


@checked
def nearest_linkages(
    points: PathPoints, bars: Literal[4, 5, 6, 7, 8] = 8, count: Annotated[int, whole_between(1, 100)] = 6
) -> tuple[tuple[AbstractLinkage, int], ...]:
    """Known linkages whose curves are most similar to a closed one, at once: no search, no limits.

    Parameters
    ----------
    points : array_like of complex, shape (n,)
        Points x + yj of the closed curve in their order, mm; 3 to 200,000.
    bars : {4, 5, 6, 7, 8}
        Number of bars; five- and seven-bars have geared cranks.
    count : int
        Number of linkages.

    Returns
    -------
    tuple of (linkage, branch)
        The best first, laid over the curve. The traced point is "coupler_point"; the crank turns fully.

    Notes
    -----
    The first call for a number of bars makes its library, in up to two seconds; others take about 0.1 s.

    Examples
    --------
    >>> import numpy as np, geomkin as gk
    >>> turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    >>> [(linkage, branch)] = gk.synthesis.nearest_linkages(30 * np.cos(turn) + 20j * np.sin(turn), bars=4, count=1)
    >>> bool(gk.move(linkage, turn, branch).assembled.all())
    True
    """
    curve = np.asarray(points, dtype=complex)
    if not 3 <= len(curve) <= MOST_POINTS:
        raise DesignError("points", f"found {len(curve):,}", f"give from 3 to {MOST_POINTS:,} points", "out-of-range")
    target = target_curve(loop(curve))
    if not target.scale > SMALLEST:
        raise DesignError("points", "all are the same", "give points apart from each other", "conflict")
    chains, _ = curve_library(bars).nearest(target, count)
    return tuple(linkage_of(chains, k, target.scale, target.middle) for k in range(len(chains)))


def usual_limits(bars: int, is_bounded: bool = False) -> tuple[float, float]:
    """Least transmission angle, deg, and largest ratio of links by default; is_bounded: whether all lengths are."""
    if bars > 4:
        return CHAIN_DEG, CHAIN_RATIO
    return (STUCK_DEG, ANY_RATIO) if is_bounded else (TOGGLE_DEG, LONGEST_RATIO)


def _check_search(bars: int, geared: bool, effort: int, is_closed: bool, slides: bool, is_timed: bool) -> None:
    """Refuse arguments that a search does not take."""
    if (geared and bars == 4) or (not geared and bars % 2):
        problem, remedy = f"{bars} bars with geared = {str(geared).lower()}", "give geared = true with 5 to 8 bars"
        raise DesignError("bars", problem, f"{remedy}, or 4, 6 or 8 bars without", "conflict")
    if slides and bars > 4:
        problem = f"is given, and linkages with up to {bars} bars have no slider"
        raise DesignError("slides", problem, "omit slides, or give 4 bars", "conflict")
    if effort > 1 and bars == 4 and (not is_closed or slides or is_timed):
        remedy = "omit it, or give a closed path without crank angles and a slider, or more bars"
        raise DesignError("effort", f"found {effort} for an open path of a four-bar", remedy, "conflict")


def _used(
    points: Complex, drive_deg: Angles | None, closed: bool, weights: Weights | None, bars: int
) -> tuple[Complex, Real | None, Real | None]:
    """The points that are used, no two in a row equal on closed curves, their crank angles, rad, and weights."""
    if not 3 <= len(points) <= MOST_POINTS:
        raise DesignError("points", f"found {len(points):,}", f"give from 3 to {MOST_POINTS:,} points", "out-of-range")
    turns = None if drive_deg is None else _turns(np.asarray(drive_deg, dtype=float), len(points))
    if bars > 4 and turns is not None and not abs(turns[-1]) < 2 * np.pi * (1 - 1e-9):
        remedy = "give less than 360 deg, or 4 bars"
        raise DesignError("drive_deg", "the angles cover a full turn or more", remedy, "conflict")
    heavy = None if weights is None else _weights(np.asarray(weights, dtype=float), len(points))
    if len(points) > MOST_USED:
        used = np.linspace(0, len(points) - 1, MOST_USED).round().astype(int)
        if heavy is not None:
            # Each point that is used stands for those up to the next one, so that no weight is lost.
            heavy = np.maximum.reduceat(heavy, used)
        points, turns = points[used], None if turns is None else turns[used]
    if closed and turns is None:
        # A point that is given twice in a row would make a corner of the line through the points.
        apart = np.abs(points - np.roll(points, 1)) > 1e-9 * np.ptp(np.concatenate([points.real, points.imag]))
        if apart.sum() >= 3:
            points, heavy = points[apart], None if heavy is None else heavy[apart]
    return points, turns, heavy


def _chain_bounds(bounds: Mapping[str, tuple[float, float]]) -> ChainBounds:
    """Boxes of the crank pivot and of all other ground pivots, and bounds of the links, mm."""
    for name, (low, high) in bounds.items():
        if name not in CURVE_BOUNDS:
            remedy = f"give any of {', '.join(CURVE_BOUNDS)}, or 4 bars"
            raise DesignError("bounds", f"found {shown(name)}", remedy, "unknown-key")
        check_bound(name, low, high, is_length=name == "links")
    free, links = (-np.inf, np.inf), bounds.get("links", (0.0, np.inf))
    sides = [(bounds.get(f"{of}_x", free), bounds.get(f"{of}_y", free)) for of in ("origin", "pivots")]
    crank, pivots = ((complex(x[0], y[0]), complex(x[1], y[1])) for x, y in sides)
    return ChainBounds(crank, pivots, links)


def _check_pivots(points: Complex, bounds: ChainBounds) -> None:
    """Refuse boxes of ground pivots that the longest links cannot reach."""
    corners = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
    middle, size = sum(corners) / 2, abs(corners[1] - corners[0])
    longest = min(LONGEST * size, bounds.links[1])
    if bounds.links[0] > longest:
        problem = f"links is at least {mm(bounds.links[0]):.4g}, {LONGEST:g} times the size of the curve or more"
        raise DesignError("bounds", problem, f"give at most {mm(longest):down3}, or a larger curve", "out-of-range")
    for of, (low, high) in zip(("origin", "pivots"), (bounds.crank, bounds.pivots)):
        nearest = complex(*(np.clip((middle.real, middle.imag), (low.real, low.imag), (high.real, high.imag))))
        if abs(nearest - middle) > longest:
            raise DesignError(
                "bounds",
                f"{of}_x and {of}_y put ground pivots at least {mm(abs(nearest - middle)):.4g} from the middle of the "
                f"curve, and no link is longer than {mm(longest):.4g}",
                f"give places within {mm(longest):.4g} of {bare_mm(middle.real, middle.imag):.4g}, or a larger curve",
                "out-of-range",
            )


def _one_each(field: str, values: Real, count: int) -> None:
    if len(values) != count:
        raise DesignError(field, f"found {len(values):,} for {count:,} points", "give one for each point", "conflict")


def _weights(weights: Real, count: int) -> Real:
    _one_each("weights", weights, count)
    low, high = WEIGHTS
    if wrong := weights[~((weights >= low) & (weights <= high))].tolist():
        raise DesignError("weights", f"found {wrong[0]:g}", f"give weights from {low:g} to {high:g}", "out-of-range")
    return weights


def _turns(drive_deg: Real, count: int) -> Real:
    _one_each("drive_deg", drive_deg, count)
    steps = np.diff(drive_deg)
    if not ((steps > 0).all() or (steps < 0).all()):
        raise DesignError("drive_deg", "the angles neither all rise nor all fall", "give them in order", "out-of-range")
    turns: Real = np.radians(drive_deg - drive_deg[0])
    return turns
