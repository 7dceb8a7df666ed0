"""The chart: measured points of families, what of them is on the front, and where they were measured."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .. import __version__
from ..arguments import Extended, checked
from ..brief import one_line
from ..cached import cached_property
from ..errors import DesignError, shown
from ..plane.vec import Mask
from ..progress import Watch
from .families import FAMILIES
from .family import MethodFamily
from .measurement import Measurement, measured


def to_six_digits(value: float) -> float:
    """As the table tells it: points that differ beyond that are equal."""
    return float(f"{value:.6g}")


@dataclass(frozen=True, eq=False)
class FamilyChart:
    """One family's measured points. on_front: of each point, whether no other beats it; on_weight_front: by weight."""

    family: MethodFamily[Any, Any]
    points: tuple[Measurement, ...]

    __repr__ = one_line

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


@dataclass(frozen=True, eq=False)
class Chart:
    """Time per result against error, of every method of some families, on one machine.

    quick: whether it was measured in a hurry. versions: of Python, NumPy and geomkin; processor: its name.
    """

    families: tuple[FamilyChart, ...]
    quick: bool
    versions: Mapping[str, str]
    processor: str

    __repr__ = one_line


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
    return lambda share: watch.tell((done + share) / whole)


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
    for time in np.unique(cost[known]):
        here = known[cost[known] == time]
        best = miss[here].min()
        if best < least:
            front[here[miss[here] == best]] = True
            least = best
    return front
