"""Four-bars that follow a function, go through timed points of a path, or through nine points: fits and searches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...core.processes import Watch
from ...linkage.moving import move
from ...plane.vec import Complex, Real
from ...synthesis.function.function import chebyshev_points, function_generator
from ...synthesis.path.coupler_paths import START, bounds_of, closing
from ...synthesis.path.fits import PathTask, polished_starts
from ...synthesis.path.nine_point_equations import follow, refine, rotations_of
from ...synthesis.path.nine_points import REAL, starts_of, through_nine
from ...synthesis.path.path import LONGEST_RATIO, TOGGLE_DEG, path_generator
from ...synthesis.path.starts import linear_fit, random_linkages
from ..family import Method, MethodFamily, method

# Seconds after which a search is cut short: none here takes so long.
PATIENCE = 600.0


def rocker_pin(gap: Complex, b: Any, c: Any, branch: Any = 1.0) -> Complex:
    """From one point to the pin at distance b from it and c from a second point, `gap` away: two circles intersect.

    nan where they do not intersect.
    """
    length = np.abs(gap)
    with np.errstate(invalid="ignore"):
        along = (length**2 + b**2 - c**2) / (2 * length)
        return np.asarray(gap / length * (along + 1j * branch * np.sqrt(b**2 - along**2)))


# Function: log10(x) from 1 to 2, input 60 deg, output 90 deg

INPUT, SWING = np.radians(60.0), np.radians(90.0)
# Points where the output is compared with the function, and where the textbook's linkages are, to choose between them.
PLACES, FEW = np.linspace(0, 1, 2001), np.linspace(0, 1, 33)
# Limits that all keep: least transmission angle, and ratio of the longest link to the shortest.
TRANSMISSION_DEG, RATIO = 30.0, 10.0


def wanted(s: Real) -> Real:
    """Output angle, rad, from its start, at shares of the input's range."""
    return np.asarray(SWING * (np.log10(1 + s) / np.log10(2.0)))


def structural_error(found: Real, s: Real) -> Real:
    """Output less function, rad, (..., places) at shares s of the input's range; nan where the four-bar is open.

    Four-bars (6, ...): crank, coupler and rocker over the ground, starts of crank and rocker, rad, and branch.
    """
    a, b, c, start, output_start, branch = found[..., None]
    pin = a * np.exp(1j * (start + INPUT * s))
    rocker = pin + rocker_pin(1 - pin, b, c, branch) - 1
    return np.asarray(np.angle(rocker * np.exp(-1j * (output_start + wanted(s)))))


def by_hand(starts: Real) -> Real:
    """Four-bars through three precision points of Chebyshev's spacing, for each pair of starts (n, 2), rad.

    Freudenstein, Approximate synthesis of four-bar linkages, Transactions of the ASME 77, 1955: three linear equations
    in ground/crank, ground/rocker and a third number. A negative length starts half a turn on.
    """
    s = chebyshev_points((0.0, 1.0), 3)
    angle, out = starts[:, :1] + INPUT * s, starts[:, 1:] + wanted(s)
    terms = np.stack([np.cos(out), -np.cos(angle), np.ones(out.shape)], axis=-1)
    k = np.linalg.solve(terms, np.cos(angle - out)[..., None])[..., 0]
    with np.errstate(all="ignore"):
        crank, rocker = 1 / k[:, 0], 1 / k[:, 1]
        coupler = np.sqrt(1 + crank**2 + rocker**2 - 2 * crank * rocker * k[:, 2])
    start, output = starts[:, 0] + np.pi * (crank < 0), starts[:, 1] + np.pi * (rocker < 0)
    sizes = [np.abs(crank), coupler, np.abs(rocker), start, output]
    return np.concatenate([[*sizes, np.full(len(starts), branch)] for branch in (1.0, -1.0)], axis=1)


def best_within_limits(found: Real) -> Real:
    """Of many four-bars (6, n) the one (6,) of least error within the limits, nan if there is none."""
    worst = np.abs(structural_error(found, FEW)).max(axis=-1)
    lengths = np.concatenate([np.ones_like(found[:1]), found[:3]])
    a, b, c, start = found[:4, :, None]
    gap = np.abs(1 - a * np.exp(1j * (start + INPUT * FEW))) ** 2
    with np.errstate(invalid="ignore"):
        cosine = np.abs((b**2 + c**2 - gap) / (2 * b * c)).max(axis=-1)
        kept = (cosine <= np.cos(np.radians(TRANSMISSION_DEG))) & (lengths.max(axis=0) <= RATIO * lengths.min(axis=0))
    worst = np.where(kept & np.isfinite(worst), worst, np.inf)
    best = int(worst.argmin())
    return found[:, best] if np.isfinite(worst[best]) else np.full(6, np.nan)


@method("three points by hand", "pairs of starts", (16.0, 64.0, 256.0, 1024.0, 4096.0, 16384.0), prepared=True)
def _by_hand(_: None, count: float) -> Callable[[], Real]:
    """Freudenstein's equations for three precision points of Chebyshev's spacing, from so many pairs of starts on a
    grid; the best linkage within the limits is kept.
    """
    each = round(count**0.5)
    halves = np.pi * (np.arange(each) + 0.5) / each
    starts = np.stack([axis.ravel() for axis in np.meshgrid(halves, halves)], axis=1)
    return lambda: best_within_limits(by_hand(starts))


def _searched(name: str, about: str, aim: Any, points: int = 3, **options: Any) -> Method:
    def search(_: None) -> Real:
        swings = float(np.degrees(INPUT)), float(np.degrees(SWING))
        found = function_generator("log10(x)", (1.0, 2.0), *swings, method=aim, points=points)
        bar: Any = found.linkage
        lengths = np.array([bar.crank, bar.coupler, bar.rocker]) / bar.ground
        return np.array([*lengths, *np.radians(found.starts_deg), found.branch])

    search.__doc__ = about
    return method(name, **options)(search)


FUNCTION_SYNTHESIS = MethodFamily(
    name="function-synthesis", title="Function synthesis", per="linkage", unit="deg", floor=1e-9,
    problem=lambda: None, error=lambda _, found: np.degrees(np.abs(structural_error(found, PLACES))),
    count=lambda *_: 1,
    about="A four-bar whose rocker follows log10(x), 1 to 2, through 90 deg while its crank turns by 60; transmission "
    f"angle {TRANSMISSION_DEG:g} deg, ratio of links {RATIO:g}.",
    reference="the resulting linkage, assembled by intersecting circles at 2001 positions, and the logarithm",
    methods=(
        _searched(
            "minimax",
            "Thousands of fits, the best few dozen followed to where no small change reduces the largest error "
            "(`function_generator`).",
            "minimax",
            rationale="No other method comes near its error, and it proves that no small change reduces it.",
        ),
        _searched("least squares", 'The same search for the least mean square (`method="least-squares"`).',
                  "least-squares", slow=True),
        _searched("three points searched", "Three precision points of Chebyshev's spacing; the free parameters "
                  "minimise the largest error.", "points", 3, slow=True),
        _searched("four points searched", "The same with four, for which a start must be right.", "points", 4,
                  slow=True),
        _by_hand,
    ),
)  # fmt: skip


# Path

# Kunjur and Krishnamurty, Genetic algorithms in mechanism synthesis, 1997: eighteen points, 20 deg of the crank apart.
X = (0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.02, 0, 0, 0.03, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.6)
Y = (1.1, 1.1, 1.1, 1, 0.9, 0.75, 0.6, 0.5, 0.4, 0.3, 0.25, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9, 1)
TIMED, STEP_DEG = np.array(X) + 1j * np.array(Y), 20.0
TURNS = np.radians(STEP_DEG) * np.arange(len(TIMED))
# The search measures from the points' middle, in units of their size.
MIDDLE = complex(TIMED.mean())
SIZE = float(np.sqrt(np.mean(np.abs(TIMED - MIDDLE) ** 2)))
# Every method runs from each of these, so that luck shows.
SEEDS = (0, 1, 2)


def _path_task() -> PathTask:
    """The task with the limits that the library holds by default."""
    low, high = bounds_of(None, False, True, MIDDLE, SIZE)
    return PathTask(
        wanted=(TIMED - MIDDLE) / SIZE,
        turns=TURNS,
        closed=False,
        slides=False,
        least_transmission=np.radians(TOGGLE_DEG),
        largest_ratio=LONGEST_RATIO,
        low=low,
        high=high,
    )


def path_error(_: PathTask, found: Real) -> Real:
    """Root mean square of the coupler points' distances from the points, mm, (seeds,); nan if open or not found.

    A row of the search's unknowns for each seed: ground, crank, coupler, rocker, coupler point, ground pivot, angles of
    ground and crank, and the branch.
    """
    ground, crank, coupler, rocker, x, y, x_0, y_0, angle, start, branch = found.T[..., None]
    # Rows that were not found are nan, and so are their errors.
    with np.errstate(invalid="ignore"):
        pin = crank * np.exp(1j * (start + TURNS))
        bar = rocker_pin(ground - pin, coupler, rocker, branch) / coupler
        reached = MIDDLE + SIZE * (x_0 + 1j * y_0 + np.exp(1j * angle) * (pin + (x + 1j * y) * bar))
        return np.asarray(np.sqrt(np.mean(np.abs(reached - TIMED) ** 2, axis=-1)))


def _fits(task: PathTask, count: int, seed: int) -> tuple[Real, Real, Real]:
    """Random linkages with coupler point, position, rotation and size fitted in closed form: x, branch, squares."""
    rng = np.random.default_rng(seed)
    x = np.zeros((count, 10))
    x[:, :4] = random_linkages(task, rng, count)
    x[:, START] = rng.uniform(0, 2 * np.pi, count)
    branch = rng.choice([-1.0, 1.0], count)
    fitted, squares = linear_fit(task, x, *closing(x, x[:, START, None] + TURNS, branch, False))
    kept = np.isfinite(squares)
    return fitted[kept], branch[kept], squares[kept]


def _row(x: Real, branch: Real, best: int) -> Real:
    return np.append(x[best], branch[best]) if len(x) else np.full(11, np.nan)


@method("fits alone", "linkages", (10.0, 100.0, 1e3, 1e4))
def _fitted(task: PathTask, count: float) -> Real:
    """Random linkages, each rotated, scaled, placed and given its coupler point in closed form; the best."""
    fits = [_fits(task, int(count), seed) for seed in SEEDS]
    return np.array([_row(x, branch, int(np.argmin([*squares, np.inf]))) for x, branch, squares in fits])


@method("fits improved", "starts", (1.0, 3.0, 10.0, 30.0, 100.0), slow=True)
def _improved(task: PathTask, count: float) -> Real:
    """Random linkages, each fitted in closed form and then improved by least squares, none left out before."""
    found = []
    for seed in SEEDS:
        x, branch, _ = _fits(task, int(count), seed)
        watch = Watch(PATIENCE, "linkages for the path")
        x, _, branch = polished_starts(task, x, np.zeros((len(x), len(TIMED))), branch, watch)
        found.append(_row(x, branch, 0))
    return np.array(found)


@method(
    "search",
    rationale="From any seed it finds the best linkage that is known of this problem, and ranks the others.",
    caveat="Few starts suffice for this problem, but not for one with more valleys.",
)
def _path_search(_: PathTask) -> Real:
    """60,000 random linkages fitted in closed form, the best 140 different ones improved by least squares within the
    limits, all but the best few left out on the way (`path_generator`).
    """

    def search(seed: int) -> list[float]:
        found = path_generator(TIMED, np.degrees(TURNS), seed=seed, time_limit=PATIENCE)
        bar: Any = found.linkage
        point, origin = bar.coupler_point / SIZE, (bar.origin - MIDDLE) / SIZE
        sizes = [length / SIZE for length in (bar.ground, bar.crank, bar.coupler, bar.rocker)]
        angles = np.radians(bar.ground_angle_deg), found.drive[0]
        return [*sizes, point.real, point.imag, origin.real, origin.imag, *angles, found.branch]

    return np.array([search(seed) for seed in SEEDS])


PATH_SYNTHESIS = MethodFamily(
    name="path-synthesis", title="Path synthesis", per="linkage", unit="mm", floor=1e-9, problem=_path_task,
    error=path_error,
    about="A four-bar whose coupler point goes through eighteen timed points of a path 0.6 mm by 0.9 mm (Kunjur and "
    "Krishnamurty, 1997).",
    reference="the resulting linkage, assembled by intersecting circles at each of the eighteen crank angles: the "
    "error is the root of the mean squared distance, the largest one from three seeds",
    methods=(_path_search, _fitted, _improved),
)  # fmt: skip


# Nine points

# Wampler, Morgan and Sommese, Journal of Mechanical Design 114, 1992, problem 3, mm, and its number of real linkages.
POINTS = np.array([0.25, 0.52 + 0.1j, 0.8 + 0.7j, 1.2 + 1j, 1.4 + 1.3j, 1.1 + 1.48j, 0.7 + 1.4j, 0.2 + 1j, 0.02 + 0.4j])
KNOWN = 64
# Distance from the points, as a share of the linkage's size, and relative difference of pivots, that are rounding.
ROUNDING = 1e-6
# The size of the points, mm, and the parameters of the equations.
OFFSETS = (POINTS - POINTS[0])[1:]
EXTENT = float(np.sqrt(np.mean(np.abs(OFFSETS) ** 2)))
TARGET = np.concatenate([OFFSETS, np.conj(OFFSETS)]) / complex(EXTENT)


def missed_share(points: Complex, places: Real) -> Real:
    """Share (1,) of the known linkages that are not among those that are found.

    places: x, y of crank pin, crank pivot, rocker pin and rocker pivot at the first point (s, 8), mm.
    """
    pin, pivot, other, far = places.view(complex).T[..., None]
    # The crank's pin is where its circle meets that of the coupler point about the point; the rocker has to fit.
    apart = points - pivot
    unit = apart / np.abs(apart)
    along = (np.abs(apart) ** 2 + np.abs(pin - pivot) ** 2 - np.abs(points[0] - pin) ** 2) / (2 * np.abs(apart))
    across = np.sqrt(np.maximum(np.abs(pin - pivot) ** 2 - along**2, 0))
    pins = pivot + unit * (along + 1j * across * np.array([1, -1])[:, None, None])
    ends = pins + (other - pin) / (points[0] - pin) * (points - pins)
    off = np.abs(np.abs(ends - far) - np.abs(other - far)).min(axis=0).max(axis=-1)
    exact = off <= ROUNDING * (1 + np.abs(places).max(axis=-1))
    # Cognates have the same three pivots.
    third = pivot + (points[0] - pin) / (other - pin) * (far - pivot)
    sums = np.stack([pivot + far + third, pivot * far + far * third + third * pivot, pivot * far * third])[:, exact, 0]
    size = 1 + np.abs(sums).max(axis=0)
    same = (np.abs(sums[:, :, None] - sums[:, None, :]) < ROUNDING * size).all(axis=0)
    return np.array([1 - (~np.tril(same, -1).any(axis=1)).sum() / KNOWN])


@method(
    "continuation (path_generator)",
    rationale="It finds every linkage, and counts where all paths ended.",
    caveat="These points need no second pass over doubtful ends; others lose linkages without it.",
)
def _continued(points: Complex) -> Real:
    """All 1442 known solutions for nine complex points, followed to the wanted points; doubtful ends again in
    double-double.
    """
    return through_nine(points, lambda share: None)[0]


def _real_places(ends: Any) -> Real:
    x = ends.x[ends.reached]
    dyads, conjugates = x[:, 0:8:2], x[:, 1:8:2]
    with np.errstate(invalid="ignore"):
        real = np.all(np.abs(conjugates - np.conj(dyads)) < REAL * (1 + np.abs(dyads)), axis=1)
    return np.asarray((EXTENT * dyads[real] + POINTS[0]).copy().view(float))


@method("some of the paths", "paths", (50.0, 150.0, 500.0, 1442.0), prepared=True)
def _some_paths(_: Complex, count: float) -> Callable[[], Real]:
    """Some of the 1442 paths, chosen at random."""
    starts, parameters = starts_of(1)
    chosen = starts[np.random.default_rng(0).permutation(len(starts))[: int(count)]]
    return lambda: _real_places(follow(chosen, parameters, TARGET, lambda share: None))


@method("Newton from random linkages", "linkages", (3e3, 1e4, 3e4), slow=True)
def _newton(_: Complex, count: float) -> Real:
    """Twelve Newton steps at most on the same equations from random linkages."""
    x, y = np.random.default_rng(0).normal(size=(2, int(count), 4))
    places = np.stack([x + 1j * y, x - 1j * y], axis=2).reshape(-1, 8)
    rotations = rotations_of(places, np.broadcast_to(TARGET, (len(places), 16)))
    return _real_places(refine(np.concatenate([places, rotations], axis=1), TARGET))


@method("path search", "seeds", (1.0, 2.0), slow=True)
def _nine_searched(points: Complex, count: float) -> Real:
    """80,000 random curves compared with the path, the best improved by least squares (`path_generator` with limits);
    linkages that leave their branch or pass the points in another order are not wanted.
    """
    places = []
    for seed in range(int(count)):
        # With a limit the search does not use the continuation.
        for found in path_generator(points, least_transmission_angle_deg=0, seed=seed, time_limit=PATIENCE).ranked:
            bar: Any = found.linkage
            motion = move(bar, found.drive[:1], found.branch)
            far = bar.origin + bar.ground * np.exp(1j * np.radians(bar.ground_angle_deg))
            pins = [motion.point(pin).position[0] for pin in ("crank_pin", "rocker_pin")]
            places.append(np.array([pins[0], bar.origin, pins[1], far]).view(float))
    return np.array(places)


NINE_POINTS = MethodFamily(
    name="nine-points", title="Nine points of a path", per="search", unit="share", floor=0.01,
    problem=lambda: POINTS, error=missed_share,
    about=f"The {KNOWN} four-bars, up to cognates, whose coupler points go through nine points (Wampler, Morgan and "
    "Sommese, 1992, problem 3); the share of them that is missed.",
    reference=f"the published number of {KNOWN} real linkages; each one that is found is assembled at every point by "
    "intersecting circles, and counted once with its cognates",
    methods=(_continued, _some_paths, _newton, _nine_searched),
)  # fmt: skip
