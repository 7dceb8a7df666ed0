"""A four-bar through timed points: fits in closed form, least squares from few and many starts, the search."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...core.progress import Watch
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Real
from ...synthesis.path.coupler_paths import START, bounds_of, closing
from ...synthesis.path.fits import PathTask, polished_starts
from ...synthesis.path.path import LONGEST_RATIO, TOGGLE_DEG, path_generator
from ...synthesis.path.starts import linear_fit, random_linkages
from ..family import Method, MethodFamily

# Kunjur and Krishnamurty, Genetic algorithms in mechanism synthesis, 1997: eighteen points, 20 deg of the crank apart.
X = (0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.02, 0, 0, 0.03, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.6)
Y = (1.1, 1.1, 1.1, 1, 0.9, 0.75, 0.6, 0.5, 0.4, 0.3, 0.25, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9, 1)
STEP_DEG = 20.0
# Every method runs from each of these, so that luck shows.
SEEDS = (0, 1, 2)
# Seconds after which a search is cut short: none here takes so long.
PATIENCE = 60.0


class TimedPath(NamedTuple):
    """The points, mm; the same as the search has them; the middle and the size that it measures from and in."""

    points: Complex
    task: PathTask
    middle: complex
    size: float


class PlacedFourBar(NamedTuple):
    """A four-bar: ground, crank, coupler, rocker; coupler point in its frame; ground pivot, ground's direction; mm.

    start: the crank's angle from the ground at the first point, rad; branch: which way the four-bar closes.
    """

    lengths: Real
    arm: complex
    origin: complex
    along: complex
    start: float
    branch: float


Found = Callable[[], list[PlacedFourBar | None]]


def problem() -> TimedPath:
    """The task with the limits that the library holds where none are given."""
    points = np.array(X) + 1j * np.array(Y)
    middle = complex(points.mean())
    size = float(np.sqrt(np.mean(np.abs(points - middle) ** 2)))
    low, high = bounds_of(None, False, True, middle, size)
    task = PathTask(
        wanted=(points - middle) / size,
        turns=np.radians(STEP_DEG) * np.arange(len(points)),
        closed=False,
        slides=False,
        least_transmission=np.radians(TOGGLE_DEG),
        largest_ratio=LONGEST_RATIO,
        low=low,
        high=high,
    )
    return TimedPath(points, task, middle, size)


def coupler_path_error(path: TimedPath, found: list[PlacedFourBar | None]) -> Real:
    """Of the coupler points' distances from the points, mm, (found,); nan where nothing was found, or is open.

    The rocker's pin is where two circles meet, about the crank's pin and about the rocker's pivot.
    """
    return np.array([np.nan if four_bar is None else _root_mean_square(path, four_bar) for four_bar in found])


def _root_mean_square(path: TimedPath, found: PlacedFourBar) -> float:
    ground, crank, coupler, rocker = found.lengths.tolist()
    pin = crank * np.exp(1j * (found.start + np.radians(STEP_DEG) * np.arange(len(path.points))))
    gap = np.abs(ground - pin)
    along = (gap**2 + coupler**2 - rocker**2) / (2 * gap)
    with np.errstate(invalid="ignore"):
        bar = (ground - pin) / gap * (along + 1j * found.branch * np.sqrt(coupler**2 - along**2)) / coupler
    reached = found.origin + found.along * (pin + found.arm * bar)
    return float(np.sqrt(np.mean(np.abs(reached - path.points) ** 2)))


def _fits(path: TimedPath, count: int, seed: int) -> tuple[Real, Real, Real]:
    """Random linkages with coupler point, place, turn and size fitted in closed form: x, branch, squares."""
    rng, task = np.random.default_rng(seed), path.task
    assert task.turns is not None
    x = np.zeros((count, 10))
    x[:, :4] = random_linkages(task, rng, count)
    x[:, START] = rng.uniform(0, 2 * np.pi, count)
    branch = rng.choice([-1.0, 1.0], count)
    fitted, squares = linear_fit(task, x, *closing(x, x[:, START, None] + task.turns, branch, False))
    kept = np.isfinite(squares)
    return fitted[kept], branch[kept], squares[kept]


def _drawn(path: TimedPath, x: Real, branch: float) -> PlacedFourBar:
    """In mm, of a row of the search's unknowns."""
    size = path.size
    along = complex(np.exp(1j * x[8]))
    return PlacedFourBar(
        x[:4] * size, complex(x[4], x[5]) * size, complex(x[6], x[7]) * size + path.middle, along, x[9], branch
    )


def _from_seeds(find: Callable[[TimedPath, int, int], PlacedFourBar | None]) -> Callable[[TimedPath, float], Found]:
    def make(path: TimedPath, count: float) -> Callable[[], list[PlacedFourBar | None]]:
        return lambda: [find(path, int(np.nan_to_num(count)), seed) for seed in SEEDS]

    return make


def _fitted(path: TimedPath, count: int, seed: int) -> PlacedFourBar | None:
    x, branch, squares = _fits(path, count, seed)
    return _drawn(path, x[squares.argmin()], float(branch[squares.argmin()])) if len(x) else None


def _improved(path: TimedPath, count: int, seed: int) -> PlacedFourBar | None:
    x, branch, _ = _fits(path, count, seed)
    watch = Watch(PATIENCE, "linkages for the path")
    x, _, branch = polished_starts(path.task, x, np.zeros((len(x), len(path.points))), branch, watch)
    return _drawn(path, x[0], float(branch[0])) if len(x) else None


def _searched(path: TimedPath, _: int, seed: int) -> PlacedFourBar:
    one = path_generator(path.points, STEP_DEG * np.arange(len(path.points)), seed=seed, time_limit=PATIENCE)
    bar = one.linkage
    assert isinstance(bar, FourBar)
    lengths = np.array([bar.ground, bar.crank, bar.coupler, bar.rocker])
    along = complex(np.exp(1j * np.radians(bar.ground_angle_deg)))
    return PlacedFourBar(
        lengths, complex(bar.coupler_point), complex(bar.origin), along, float(one.drive[0]), one.branch
    )


PATH_SYNTHESIS: MethodFamily[TimedPath, list[PlacedFourBar | None]] = MethodFamily(
    name="path-synthesis",
    title="Path synthesis",
    about="A four-bar whose coupler point goes through eighteen timed points of a path 0.6 mm by 0.9 mm (Kunjur and "
    "Krishnamurty, 1997).",
    per="linkage",
    unit="mm",
    reference="the linkage that is found, closed by the meeting of two circles at each of the eighteen cranks: the "
    "error is the root of the mean squared distance, the largest of those from three seeds",
    floor=1e-9,
    problem=problem,
    count=lambda _, found: len(found),
    error=coupler_path_error,
    methods=(
        Method(
            "search",
            "60,000 random linkages fitted in closed form, the best 140 unlike ones improved by least squares within "
            "the limits, all but the best few left behind on the way (`path_generator`).",
            _from_seeds(_searched),
            rationale="From any seed it finds the best linkage that is known of this problem, and ranks the others.",
            caveat="Few starts suffice for this problem, but not for one with more valleys.",
        ),
        Method(
            "fits alone",
            "Random linkages, each turned, scaled, placed and given its coupler point in closed form; the best.",
            _from_seeds(_fitted),
            "linkages",
            (10.0, 100.0, 1e3, 1e4),
        ),
        Method(
            "fits improved",
            "Random linkages, each fitted in closed form and then improved by least squares, none left out before.",
            _from_seeds(_improved),
            "starts",
            (1.0, 3.0, 10.0, 30.0, 100.0),
            slow=True,
        ),
    ),
)
