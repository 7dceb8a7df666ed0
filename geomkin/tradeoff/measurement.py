"""Time against error of every method of a family, and the digits of every cell of the stability study."""

from __future__ import annotations

import csv
import io
import os
import platform
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import AnyFloat, checked
from ..core.errors import DesignError, shown
from ..core.fields import to_digits
from ..core.processes import Watch
from ..core.records import record
from ..core.version import __version__
from ..plane.vec import Mask
from .cam_and_gear_cells import CAM_CELLS, GEAR_CELLS
from .families import FAMILIES
from .family import ANSWERS, Cell, Digits, Method, MethodFamily, answered, measured_digits
from .linkage_cells import LINKAGE_CELLS, POSE_CELLS

# Processor seconds for each point of a full chart, and for all points of a family in a quick one. With less time the
# least of the batches still falls; more changes no reported digit.
FULL, QUICK = 0.5, 1.0
# Processor seconds of a batch of calls, far above the clock's own cost of a microsecond. Longer batches are fewer and
# more likely to be disturbed by other programs.
BATCH = 4e-3
# Least number of batches of a point, since a single one may be disturbed.
LEAST = 3
# Processor seconds from which a call counts as a batch; a quick chart does not repeat it.
LONG = 0.3


@record(eq=False)
class Measurement:
    """One point of a chart: a method at a setting.

    Parameters
    ----------
    family, method : str
        Their names.
    setting : float
        The setting; nan if there is none.
    largest, rms : float
        Of the errors of the results that were found, in the family's unit.
    missed : float
        Share of the results that were not found.
    seconds : float
        Processor time per result: the least of the batches.
    results, calls, batches : int
        Results per call, calls per batch, and number of batches.
    spread : float
        Relative excess of the median batch over the least: the noise of the time.
    weight : float
        Further cost of the results; nan if only time counts.
    """

    family: str
    method: str
    setting: float
    largest: float
    rms: float
    missed: float
    seconds: float
    results: int
    calls: int
    batches: int
    spread: float
    weight: float = np.nan


class _Trial:
    """A point being measured: the number of calls in a batch, and the time of one call, s, in each batch."""

    def __init__(self, family: MethodFamily, problem: Any, method: Method, setting: float) -> None:
        self.family, self.method, self.setting = family, method, setting
        self.call, self.calls, start = method.make(problem, setting), 1, time.process_time()
        found = self.call()
        self.first, self.times = time.process_time() - start, list[float]()
        self.errors = np.asarray(family.error(problem, found), dtype=float)
        self.results = family.count(problem, found) if family.count else self.errors.size
        self.weight = family.weigh(problem, found) if family.weigh else np.nan

    def batch(self) -> None:
        call, start = self.call, time.process_time()
        for _ in range(self.calls):
            call()
        self.times.append((time.process_time() - start) / self.calls)

    def calibrate(self) -> None:
        """Choose the number of calls in a batch so that it takes long enough to be timed."""
        while True:
            self.batch()
            if self.times[-1] * self.calls >= BATCH:
                return
            self.calls = max(2 * self.calls, int(1.2 * BATCH / max(self.times.pop(), 1e-9)))

    @property
    def spent(self) -> float:
        return sum(self.times) * self.calls

    @property
    def measurement(self) -> Measurement:
        known, least = self.errors[np.isfinite(self.errors)], min(self.times)
        return Measurement(
            family=self.family.name,
            method=self.method.name,
            setting=self.setting,
            largest=float(known.max()) if known.size else np.nan,
            rms=float(np.sqrt(np.mean(known**2))) if known.size else np.nan,
            missed=1 - known.size / self.errors.size,
            seconds=least / self.results,
            results=self.results,
            calls=self.calls,
            batches=len(self.times),
            spread=float(np.median(self.times)) / least - 1,
            weight=self.weight,
        )


def measured_points(family: MethodFamily, quick: bool, progress: Callable[[float], object]) -> tuple[Measurement, ...]:
    """Every method of a family at every setting; `progress` receives the share that is done.

    Batches of all points alternate, so that a temporary slowdown affects all alike. The clock is the processor time of
    the process.
    """
    problem = family.problem()
    chosen = [(m, s) for m in family.methods if not (quick and m.slow) for s in _settings(m, quick)]
    trials = []
    for k, (method, setting) in enumerate(chosen):
        trials.append(_Trial(family, problem, method, setting))
        progress(0.3 * (k + 1) / len(chosen))
    for k, trial in enumerate(trials):
        if quick and trial.first > LONG:
            trial.times = [trial.first]
        else:
            trial.calibrate()
        progress(0.3 + 0.2 * (k + 1) / len(trials))
    budget = QUICK / len(trials) if quick else FULL
    repeated = [t for t in trials if not quick or t.times[0] < LONG]
    while left := [t for t in repeated if t.spent < budget or len(t.times) < LEAST]:
        for trial in left:
            trial.batch()
        progress(0.5 + 0.5 * float(np.mean([min(1.0, t.spent / budget) for t in repeated])))
    return tuple(trial.measurement for trial in trials)


def _settings(method: Method, quick: bool) -> tuple[float, ...]:
    """The settings that are measured; in a quick chart the first, the middle and the last."""
    every = tuple(method.settings) or (np.nan,)
    return every if not quick or len(every) < 4 else (every[0], every[len(every) // 2], every[-1])


@record(eq=False)
class FamilyChart:
    """The measured points of one family.

    Parameters
    ----------
    family : MethodFamily
        The family.
    points : tuple of Measurement
        Its measured points.
    """

    family: MethodFamily
    points: tuple[Measurement, ...]

    @cached_property
    def on_front(self) -> Mask:
        """Mask (points,) of the Pareto front by time per result and largest error; points with missed results are off
        it.
        """
        return self._front([p.seconds for p in self.points])

    @cached_property
    def on_weight_front(self) -> Mask:
        """The same by weight; all False if only time counts."""
        return self._front([p.weight for p in self.points])

    def _front(self, costs: list[float]) -> Mask:
        errors = [self.shown_error(p) if not p.missed else np.nan for p in self.points]
        return pareto_front([to_digits(cost, 6) for cost in costs], errors)

    def shown_error(self, point: Measurement) -> float:
        """The largest error of a point with six digits, at least the family's floor.

        Parameters
        ----------
        point : Measurement
            A point of this family.
        """
        return to_digits(max(point.largest, self.family.floor), 6)

    def view(self, weighed: bool = False) -> list[tuple[Measurement, float, bool]]:
        """Each point with its cost and whether it is on the front.

        Parameters
        ----------
        weighed : bool
            By weight instead of time.
        """
        front = self.on_weight_front if weighed else self.on_front
        return [(p, p.weight if weighed else p.seconds, on) for p, on in zip(self.points, front.tolist())]


@record(eq=False)
class Chart:
    """Time per result against error of all methods of some families on one machine.

    Parameters
    ----------
    families : tuple of FamilyChart
        The measured families.
    quick : bool
        Whether it is a quick chart.
    versions : mapping of str to str
        Versions of Python, NumPy and geomkin.
    processor : str
        Name of the processor.
    """

    families: tuple[FamilyChart, ...]
    quick: bool
    versions: Mapping[str, str]
    processor: str


@checked
def chart(families: Sequence[str] = (), quick: bool = False) -> Chart:
    """Measure families of methods on this machine.

    Times are processor seconds of this process, including its other threads.

    Parameters
    ----------
    families : sequence of str
        Names in `FAMILIES`; all by default.
    quick : bool
        Take some seconds per family, with fewer settings and without the slowest methods.

    Returns
    -------
    Chart
        The measured points.

    Raises
    ------
    DesignError
        For an unknown name.
    """
    return list(growing_chart(families, quick))[-1]


def growing_chart(families: Sequence[str], quick: bool) -> Iterator[Chart]:
    """The chart after each family that is measured."""
    for name in families:
        if name not in FAMILIES:
            raise DesignError("families", f"found {shown(name)}", f"give some of {', '.join(FAMILIES)}", "unknown-key")
    names = list(dict.fromkeys(families or FAMILIES))
    versions = {"geomkin": __version__, "python": platform.python_version(), "numpy": np.__version__}
    measured: tuple[FamilyChart, ...] = ()
    for k, name in enumerate(names):
        family, watch = FAMILIES[name], Watch(np.inf, f"measuring {name}")
        points = measured_points(family, quick, partial(_report, watch, k, len(names)))
        measured += (FamilyChart(family, points),)
        yield Chart(measured, quick, versions, processor())


def _report(watch: Watch, done: int, whole: int, share: float) -> None:
    watch.report((done + share) / whole)


def processor() -> str:
    """Name of the processor and number of cores."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8", "replace").splitlines()
    except OSError:
        lines = []
    model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    return f"{model or platform.processor() or platform.machine()}, {os.cpu_count()} cores"


@checked
def pareto_front(seconds: AnyFloat, errors: AnyFloat) -> Mask:
    """Mark the points that no other point beats in both time and error.

    Parameters
    ----------
    seconds, errors : array_like, shape (n,)
        The two costs of each point.

    Returns
    -------
    array of bool, shape (n,)
        Equal points are on the front together; a point with nan or an infinite value is never on it.

    Raises
    ------
    DesignError
        If the arguments are not two rows of equal length.

    Examples
    --------
    >>> from geomkin.tradeoff import pareto_front
    >>> pareto_front([1, 2, 3], [3, 4, 1]).tolist()
    [True, False, True]
    """
    cost, miss = np.asarray(seconds, dtype=float), np.asarray(errors, dtype=float)
    if cost.ndim != 1 or cost.shape != miss.shape:
        problem = f"found shapes {cost.shape} and {miss.shape}"
        raise DesignError("errors", problem, "give two rows of one length", "conflict")
    known = np.isfinite(cost) & np.isfinite(miss)
    one, other = (np.where(known, values, np.inf) for values in (cost, miss))
    as_good = (one <= one[:, None]) & (other <= other[:, None])
    better = (one < one[:, None]) | (other < other[:, None])
    return np.asarray(known & ~(as_good & better).any(axis=1))


# Negative powers of ten of the distance from the singular position, and those whose digits the page shows.
POWERS, SHOWN = tuple(range(1, 16)), (4, 8, 12, 15)
CELLS: tuple[Cell, ...] = (*LINKAGE_CELLS, *POSE_CELLS, *CAM_CELLS, *GEAR_CELLS)
DIGIT_KINDS = ("library", "textbook", "allowed")
# What the page shows of each cell.
HEADS = ("mechanism", "place", "distance", "result", "geomkin", "textbook", "possible", "what geomkin does")
EXPLANATION = (
    "Correct decimal digits, of 16, at distances of 1e-4, 1e-8, 1e-12 and 1e-15 from singular positions: those that "
    "geomkin keeps, and those that the textbook's formula keeps in double precision, compared with arithmetic of 120 "
    "digits. Possible: the digits that remain if each size has an error of half of its last bit."
)
MISSING = (
    "The study of the places where methods lose digits is left out, since it needs mpmath. To add it, install mpmath "
    "(pip install mpmath) and measure the chart again."
)


@record(eq=False)
class Stability:
    """Results of the stability study.

    Parameters
    ----------
    results : tuple of tuple of Digits
        For each cell its digits by falling distance.
    """

    results: tuple[tuple[Digits, ...], ...]

    @cached_property
    def answers(self) -> tuple[str, ...]:
        """Behaviour of the library at each cell: a key of `ANSWERS`, or another text if it loses digits silently."""
        return tuple(answered(row) for row in self.results)

    def csv(self) -> bytes:
        """A row for each cell with its digits at each distance, or `nan` or `refused`."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        heads = [f"{kind}_{digits.distance:.0e}" for kind in DIGIT_KINDS for digits in self.results[0]]
        writer.writerow(["family", "place", "result", "distance", "library_does", "reported_by", *heads])
        for row, answer in zip(self.results, self.answers):
            cell = row[0].cell
            about = cell.family, cell.place, cell.result, cell.distance, ANSWERS.get(answer, answer), cell.reported_by
            writer.writerow([*about, *(digits.text(kind) for kind in DIGIT_KINDS for digits in row)])
        return stream.getvalue().encode("utf-8")

    @property
    def table(self) -> tuple[tuple[str, ...], ...]:
        """A row for each cell, of the columns `HEADS`."""

        def cells(row: tuple[Digits, ...], answer: str) -> tuple[str, ...]:
            cell, shown = row[0].cell, [one for one in row if round(-np.log10(one.distance)) in SHOWN]
            digits = (" ".join(one.text(kind).split(".")[0] for one in shown) for kind in DIGIT_KINDS)
            does = ANSWERS.get(answer, answer) + (f"; reported by {cell.reported_by}" if cell.reported_by else "")
            return cell.family, cell.place, cell.distance, cell.result, *digits, does

        return tuple(map(cells, self.results, self.answers))


@checked
def stability(distances: None | float | ArrayLike = None) -> Stability:
    """Measure the decimal digits that the library keeps near singular positions.

    Parameters
    ----------
    distances : array_like, optional
        Distances from the singular position as shares of the sizes, falling from at most 0.1 to at least 1e-15; 1e-1 to
        1e-15 by default.

    Returns
    -------
    Stability
        The digits of every cell.

    Raises
    ------
    DesignError
        For other distances, or if mpmath is not installed.
    """
    given = np.asarray([10.0**-k for k in POWERS] if distances is None else distances, dtype=float)
    falling = given.ndim == 1 and given.size > 0 and bool(np.all(np.diff(given) < 0))
    if not falling or not 1e-15 <= given.min() <= given.max() <= 0.1:
        remedy = "give falling numbers from 0.1 down to 1e-15"
        raise DesignError("distances", f"found {distances!r}", remedy, "out-of-range")
    return Stability(tuple(tuple(measured_digits(cell, x) for x in given.tolist()) for cell in CELLS))
