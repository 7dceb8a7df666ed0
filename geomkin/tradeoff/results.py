"""Time against error of every method of a family, on the machine that this runs on."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..core.arguments import AnyFloat, checked
from ..core.errors import DesignError, shown
from ..core.fields import to_digits
from ..core.progress import Watch
from ..core.records import record
from ..core.version import __version__
from ..plane.vec import Mask
from .families import FAMILIES
from .family import Method, MethodFamily, P, R

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

    def __init__(self, method: Method[Any, Any], setting: float, call: Callable[[], Any], results: int) -> None:
        self.method, self.setting, self.call, self.results = method, setting, call, results
        self.errors: Any = None
        self.weight = float("nan")
        self.calls = 1
        self.times: list[float] = []

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


def measured_points(
    family: MethodFamily[P, R], quick: bool, progress: Callable[[float], object]
) -> tuple[Measurement, ...]:
    """Every method of a family at every setting; `progress` receives the share that is done.

    Batches of all points alternate, so that a temporary slowdown affects all alike. The clock is the processor time of
    the process.
    """
    problem = family.problem()
    chosen = [(m, s) for m in family.methods if not (quick and m.slow) for s in _settings(m, quick)]
    trials = []
    for k, (method, setting) in enumerate(chosen):
        call = method.make(problem, setting)
        start = time.process_time()
        found = call()
        spent = time.process_time() - start
        trial = _Trial(method, setting, call, family.count(problem, found))
        trial.errors = np.asarray(family.error(problem, found), dtype=float)
        if family.weigh:
            trial.weight = family.weigh(problem, found)
        trial.times = [spent] if quick and spent > LONG else []
        trials.append(trial)
        progress(0.3 * (k + 1) / len(chosen))
    for k, trial in enumerate(trials):
        if not trial.times:
            trial.calibrate()
        progress(0.3 + 0.2 * (k + 1) / len(trials))
    budget = QUICK / len(trials) if quick else FULL
    for share in _rounds([t for t in trials if not quick or t.times[0] < LONG], budget):
        progress(0.5 + 0.5 * share)
    return tuple(_measurement(family.name, trial) for trial in trials)


def _settings(method: Method[P, R], quick: bool) -> tuple[float, ...]:
    """The settings that are measured; in a quick chart the first, the middle and the last."""
    every = tuple(method.settings) or (np.nan,)
    return every if not quick or len(every) < 4 else (every[0], every[len(every) // 2], every[-1])


def _rounds(trials: list[_Trial], budget: float) -> Iterator[float]:
    """Run a batch of each point in turn until each has had its time; yields the share that is done."""
    left = trials
    while left := [t for t in left if t.spent < budget or len(t.times) < LEAST]:
        for trial in left:
            trial.batch()
        yield float(np.mean([min(1.0, t.spent / budget) for t in trials]))


def _measurement(family: str, trial: _Trial) -> Measurement:
    known = trial.errors[np.isfinite(trial.errors)]
    least = min(trial.times)
    return Measurement(
        family=family,
        method=trial.method.name,
        setting=trial.setting,
        largest=float(known.max(initial=0.0)) if known.size else np.nan,
        rms=float(np.sqrt(np.mean(known**2))) if known.size else np.nan,
        missed=1 - known.size / trial.errors.size,
        seconds=least / trial.results,
        results=trial.results,
        calls=trial.calls,
        batches=len(trial.times),
        spread=float(np.median(trial.times)) / least - 1,
        weight=trial.weight,
    )


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

    family: MethodFamily[Any, Any]
    points: tuple[Measurement, ...]

    @cached_property
    def on_front(self) -> Mask:
        """Mask (points,) of the Pareto front by time per result and largest error; points with missed results are off
        it.
        """
        return self._front([to_digits(p.seconds, 6) for p in self.points])

    @cached_property
    def on_weight_front(self) -> Mask:
        """The same by weight; all False if only time counts."""
        return self._front([to_digits(p.weight, 6) for p in self.points])

    def _front(self, costs: list[float]) -> Mask:
        return pareto_front(costs, [self.shown_error(p) if not p.missed else np.nan for p in self.points])

    def shown_error(self, point: Measurement) -> float:
        """The largest error of a point with six digits, at least the family's floor.

        Parameters
        ----------
        point : Measurement
            A point of this family.
        """
        return to_digits(max(point.largest, self.family.floor), 6)

    @cached_property
    def defaults(self) -> tuple[tuple[Measurement, bool], ...]:
        """The points of the library's default method, and whether each is on the front."""
        names = {method.name for method in self.family.methods if method.is_default}
        return tuple((p, bool(on)) for p, on in zip(self.points, self.on_front) if p.method in names)


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
    for name in families:
        if name not in FAMILIES:
            raise DesignError("families", f"found {shown(name)}", f"give some of {', '.join(FAMILIES)}", "unknown-key")
    chosen = [FAMILIES[name] for name in dict.fromkeys(families or FAMILIES)]
    charts = []
    for k, family in enumerate(chosen):
        watch = Watch(np.inf, f"measuring {family.name}")
        charts.append(FamilyChart(family, measured_points(family, quick, _progress_of(watch, k, len(chosen)))))
    versions = {"geomkin": __version__, "python": platform.python_version(), "numpy": np.__version__}
    return Chart(tuple(charts), quick, versions, processor())


def _progress_of(watch: Watch, done: int, whole: int) -> Callable[[float], None]:
    """Report the share of one family as a share of all of them."""
    return lambda share: watch.report((done + share) / whole)


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
        raise DesignError(
            "errors", f"found shapes {cost.shape} and {miss.shape}", "give two rows of one length", "conflict"
        )
    front = np.zeros(cost.shape, dtype=bool)
    known = np.flatnonzero(np.isfinite(cost) & np.isfinite(miss))
    least = np.inf
    # In order of time, a point is on the front if its error is less than that of all faster ones.
    for fastest in np.unique(cost[known]):
        here = known[cost[known] == fastest]
        best = miss[here].min()
        if best < least:
            front[here[miss[here] == best]] = True
            least = best
    return front
