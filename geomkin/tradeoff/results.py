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

from ..core.arguments import Extended, checked
from ..core.errors import DesignError, shown
from ..core.progress import Watch
from ..core.records import record
from ..core.version import __version__
from ..plane.vec import Mask
from .families import FAMILIES
from .family import Method, MethodFamily, P, R

# Processor seconds that one point of a full chart is measured for, and all points of a family of a quick one. Less, and
# the least of the batches still falls; more changes no digit that is told.
FULL, QUICK = 0.5, 1.0
# Processor seconds of a batch of calls: far above the clock's own cost of a microsecond. Longer batches leave fewer to
# take the least of, and a busy machine disturbs a long one for sure.
BATCH = 4e-3
# Batches of a point at least, however long they take; the least of one alone may be any disturbance.
LEAST = 3
# Processor seconds of one call that is no more disturbed than a batch: in a quick chart it is not made twice.
LONG = 0.3


@record(eq=False)
class Measurement:
    """One point of the chart: a method at a setting.

    setting: nan where there is none. largest, rms: of the errors, in the family's unit, over the results that it found;
    missed: share of the results that it did not find. seconds: processor time per result, the least of `batches` of
    `calls` calls with `results` results each. spread: how much slower the median batch was, as a share: what of the
    time is noise. weight: what the results cost whoever goes on with them; nan in a family where time alone counts.
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
    """A point that is being measured. calls: in a batch; times: of one call, s, by batches."""

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
        """As many calls in a batch as take long enough to be timed."""
        while True:
            self.batch()
            if self.times[-1] * self.calls >= BATCH:
                return
            self.calls = max(2 * self.calls, int(1.2 * BATCH / max(self.times.pop(), 1e-9)))

    @property
    def spent(self) -> float:
        return sum(self.times) * self.calls


def measured(family: MethodFamily[P, R], quick: bool, tell: Callable[[float], object]) -> tuple[Measurement, ...]:
    """Every method of a family at every setting; `tell` hears the share that is done.

    Batches go round over the points, so that a machine that slows down for a while slows all alike. The
    clock is that of the process, which stands still while others run.
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
        tell(0.3 * (k + 1) / len(chosen))
    for k, trial in enumerate(trials):
        if not trial.times:
            trial.calibrate()
        tell(0.3 + 0.2 * (k + 1) / len(trials))
    budget = QUICK / len(trials) if quick else FULL
    for share in _rounds([t for t in trials if not quick or t.times[0] < LONG], budget):
        tell(0.5 + 0.5 * share)
    return tuple(_told(family.name, trial) for trial in trials)


def _settings(method: Method[P, R], quick: bool) -> tuple[float, ...]:
    """The settings that are measured: in a quick chart the first, the middle and the last."""
    every = tuple(method.settings) or (np.nan,)
    return every if not quick or len(every) < 4 else (every[0], every[len(every) // 2], every[-1])


def _rounds(trials: list[_Trial], budget: float) -> Iterator[float]:
    """A batch of each in turn, until each has had its time; after each round, the share that is done."""
    left = trials
    while left := [t for t in left if t.spent < budget or len(t.times) < LEAST]:
        for trial in left:
            trial.batch()
        yield float(np.mean([min(1.0, t.spent / budget) for t in trials]))


def _told(family: str, trial: _Trial) -> Measurement:
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


def to_six_digits(value: float) -> float:
    """As the table tells it: points that differ beyond that are equal."""
    return float(f"{value:.6g}")


@record(eq=False)
class FamilyChart:
    """One family's measured points. on_front: of each point, whether no other beats it; on_weight_front: by weight."""

    family: MethodFamily[Any, Any]
    points: tuple[Measurement, ...]

    @cached_property
    def on_front(self) -> Mask:
        """(points,): by time per result and largest error; what misses results is never on it."""
        return self._front([to_six_digits(p.seconds) for p in self.points])

    @cached_property
    def on_weight_front(self) -> Mask:
        """(points,): the same by weight; all False in a family where time alone counts."""
        return self._front([to_six_digits(p.weight) for p in self.points])

    def _front(self, costs: list[float]) -> Mask:
        return pareto_front(costs, [self.shown_error(p) if not p.missed else np.nan for p in self.points])

    def shown_error(self, point: Measurement) -> float:
        """A point's largest error, not below what is rounding, to six digits."""
        return to_six_digits(max(point.largest, self.family.floor))

    @cached_property
    def defaults(self) -> tuple[tuple[Measurement, bool], ...]:
        """The points of the library's own method, and whether each is on the front."""
        names = {method.name for method in self.family.methods if method.is_default}
        return tuple((p, bool(on)) for p, on in zip(self.points, self.on_front) if p.method in names)


@record(eq=False)
class Chart:
    """Time per result against error, of every method of some families, on one machine.

    quick: whether it was measured in a hurry. versions: of Python, NumPy and geomkin; processor: its name.
    """

    families: tuple[FamilyChart, ...]
    quick: bool
    versions: Mapping[str, str]
    processor: str


@checked
def chart(families: Sequence[str] = (), quick: bool = False) -> Chart:
    """Measure families, by their names in `FAMILIES`; all where none is named.

    Seconds of processor time on the machine it runs on, alone in its process: threads that work beside it are counted
    with it. quick: some seconds a family, with fewer settings and without the slowest methods.
    """
    for name in families:
        if name not in FAMILIES:
            raise DesignError("families", f"found {shown(name)}", f"give some of {', '.join(FAMILIES)}")
    chosen = [FAMILIES[name] for name in dict.fromkeys(families or FAMILIES)]
    found = []
    for k, family in enumerate(chosen):
        watch = Watch(np.inf, f"measuring {family.name}")
        found.append(FamilyChart(family, measured(family, quick, _part(watch, k, len(chosen)))))
    versions = {"geomkin": __version__, "python": platform.python_version(), "numpy": np.__version__}
    return Chart(tuple(found), quick, versions, processor())


def _part(watch: Watch, done: int, whole: int) -> Callable[[float], None]:
    """What is told the share of one family, when so many are done of the whole."""
    return lambda share: watch.report((done + share) / whole)


def processor() -> str:
    """The processor's name, and how many cores there are."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8", "replace").splitlines()
    except OSError:
        lines = []
    model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    return f"{model or platform.processor() or platform.machine()}, {os.cpu_count()} cores"


@checked
def pareto_front(seconds: Extended, errors: Extended) -> Mask:
    """Which of these points (n,) no other one beats: as fast and as accurate, and better in one of the two.

    Equal points stand on the front together; a point that is nan or infinite in either is never on it.
    """
    cost, miss = np.asarray(seconds, dtype=float), np.asarray(errors, dtype=float)
    if cost.ndim != 1 or cost.shape != miss.shape:
        raise DesignError("errors", f"found shapes {cost.shape} and {miss.shape}", "give two rows of one length")
    front = np.zeros(cost.shape, dtype=bool)
    known = np.flatnonzero(np.isfinite(cost) & np.isfinite(miss))
    least = np.inf
    # From the fastest on, a point is on the front where it errs less than all that are as fast.
    for fastest in np.unique(cost[known]):
        here = known[cost[known] == fastest]
        best = miss[here].min()
        if best < least:
            front[here[miss[here] == best]] = True
            least = best
    return front
