"""Time against error of every method of a family, on the machine that this runs on."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..brief import one_line
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


@dataclass(frozen=True, eq=False)
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

    __repr__ = one_line


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
