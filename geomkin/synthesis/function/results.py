"""What a search for function generators returns."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Self

import numpy as np

from ...arguments import Reals, checked
from ...brief import one_line
from ...linkage.bars import FourBar
from ...linkage.linkage import AbstractLinkage
from ...linkage.sliders import SliderCrank
from ...plane.vec import Real
from ..found import Found, ten_digits
from ..rounding import Rounding
from .four_bar_generator import FourBarGenerator
from .generators import AbstractGenerator
from .peaks import peaks
from .search import LOOKS, PEAKS
from .slider_generator import SliderGenerator
from .wanted import WantedFunction

DEGREE = float(np.degrees(1.0))


class Peak(NamedTuple):
    """A place where the error is largest between its neighbours.

    error: deg of the output, or mm of the slider: what is reached less what is wanted. multiplier: the share that it
    has in holding the largest error where it is, all shares 1; 0 where it could grow, nan where no minimax was asked.
    """

    x: float
    error: float
    multiplier: float


@dataclass(frozen=True, eq=False, kw_only=True)
class AbstractFunctionGenerator(Found):
    """What function generators have in common.

    alternation: the error's peaks, in order of x. active_limits: of "transmission angle" and "ratio" those that hold
    the error up, with their multipliers: how fast the largest error would fall, in its unit, were the limit moved (the
    cosine of the transmission angle, the logarithm of the ratio). certificate: what is left of the derivatives of the
    error at the peaks and of the active limits, each times its multiplier: 0 to rounding, as no multiplier is negative,
    proves that no small change of the sizes makes all peaks less; nan for least squares. others: what the
    search found besides, the best first.
    """

    alternation: tuple[Peak, ...]
    active_limits: Mapping[str, float]
    certificate: float
    others: tuple[Self, ...] = ()
    wanted: WantedFunction = field(repr=False)
    task: AbstractGenerator = field(repr=False)
    unknowns: Real = field(repr=False)
    __repr__ = one_line

    @property
    @abstractmethod
    def _output(self) -> tuple[float, float]:
        """Where the wanted output starts, and how far it goes: deg or mm."""

    @property
    @abstractmethod
    def _unit(self) -> float:
        """Of the task's errors, deg or mm."""

    def _error(self, s: Real) -> Real:
        """Errors (1, m), deg or mm, at shares (1, m) of the input's way."""
        return self._unit * self.task.error(self.unknowns[None], s)

    def _with(self, linkage: AbstractLinkage, p: Real) -> Self:
        """The same with other unknowns p (unknowns,); multipliers and certificate remain those of the optimum."""
        at, errors, real = (row[0] for row in peaks(self.task, p[None], PEAKS, LOOKS))
        x, errors = self.wanted.x(at[real]).tolist(), (self._unit * errors[real]).tolist()
        same = len(x) == len(self.alternation)
        multipliers = [peak.multiplier for peak in self.alternation] if same else len(x) * [np.nan]
        return replace(
            self,
            linkage=linkage,
            drive=p[3] + np.array([0.0, self.task.swing]),
            transmission_angle_deg=float(np.degrees(self.task.transmission(p[None])[0])),
            alternation=tuple(map(Peak, x, errors, multipliers)),
            unknowns=p,
        )

    @property
    def largest(self) -> float:
        """The largest error of the output, deg or mm."""
        return max(abs(peak.error) for peak in self.alternation)

    def proof(self) -> Mapping[str, object]:
        """As `summary.json` lists it: the error's peaks, deg or mm, and the active limits, with their multipliers."""
        # A top is flat: half of all digits tell its place.
        peaks = [{name: _six(value) for name, value in peak._asdict().items()} for peak in self.alternation]
        return {
            "alternation": peaks,
            "active_limits": {name: _six(value) for name, value in self.active_limits.items()},
        }

    def _share(self, x: Reals) -> Real:
        """Of the input's way, (...,)."""
        return np.asarray((np.asarray(x, dtype=float) - self.wanted.x0) / (self.wanted.x1 - self.wanted.x0))

    @checked
    def input_at(self, x: Reals) -> Real:
        """Angle of the input (...,) at x (...,), rad from the ground line."""
        return np.asarray(self.drive[0] + (self.drive[1] - self.drive[0]) * self._share(x))

    @checked
    def wanted_at(self, x: Reals) -> Real:
        """What is wanted of the output (...,) at x (...,): deg from the ground line, or mm along the slide line."""
        start, way = self._output
        return np.asarray(start + way * self.wanted.share(self._share(x)))

    @checked
    def error(self, x: Reals) -> Real:
        """The output's error (...,) at x (...,), deg or mm: reached less wanted; nan where the linkage is open."""
        s = self._share(x)
        return self._error(s.reshape(1, -1)).reshape(s.shape)


@dataclass(frozen=True, eq=False, kw_only=True)
class FunctionGenerator(AbstractFunctionGenerator):
    """A four-bar whose rocker follows a function of its crank's angle.

    starts_deg: of input and output, from the ground line, the rocker's direction from its ground pivot; there stand x0
    and y(x0) on their scales. largest_error_deg: of the output angle, also between any samples.
    """

    linkage: FourBar
    starts_deg: tuple[float, float]
    largest_error_deg: float
    task: FourBarGenerator = field(repr=False)
    __repr__ = one_line

    @property
    def _output(self) -> tuple[float, float]:
        return self.starts_deg[1], DEGREE * self.task.out

    @property
    def _unit(self) -> float:
        return DEGREE

    def rounded(self, rounding: Rounding) -> FunctionGenerator:
        linkage = rounding.linkage(self.linkage)
        first, last = (rounding.angle(f"{end}_start_deg", at) for end, at in zip(("input", "output"), self.starts_deg))
        logs = np.log(np.array([linkage.crank, linkage.coupler, linkage.rocker]) / linkage.ground)
        other = self._with(linkage, np.array([*logs, *np.radians([first, last]), self.branch]))
        return replace(other, starts_deg=(first, last), largest_error_deg=other.largest)

    def summary(self) -> Mapping[str, object]:
        starts = [ten_digits(start) for start in self.starts_deg]
        return {"largest_error_deg": ten_digits(self.largest_error_deg), "starts_deg": starts, **super().summary()}


@dataclass(frozen=True, eq=False, kw_only=True)
class SliderFunctionGenerator(AbstractFunctionGenerator):
    """A slider-crank whose slider follows a function of its crank's angle.

    start_deg: of the crank, from the slide line; start_mm: the slider's place for y(x0), along that line from the foot
    of the crank pivot. largest_error: of the slider's place, mm, also between any samples.
    """

    linkage: SliderCrank
    start_deg: float
    start_mm: float
    largest_error: float
    task: SliderGenerator = field(repr=False)
    __repr__ = one_line

    @property
    def _output(self) -> tuple[float, float]:
        return self.start_mm, self.task.sense * self.task.length

    @property
    def _unit(self) -> float:
        return self.task.length

    def rounded(self, rounding: Rounding) -> SliderFunctionGenerator:
        linkage, way = rounding.linkage(self.linkage), self.task.length
        first = rounding.angle("input_start_deg", self.start_deg)
        place = rounding.length("output_start_mm", self.start_mm)
        logs = np.log(np.array([linkage.crank, linkage.coupler]) / way)
        p = np.array([*logs, float(linkage.offset) / way, np.radians(first), place / way, self.branch])
        other = self._with(linkage, p)
        return replace(other, start_deg=first, start_mm=place, largest_error=other.largest)

    def summary(self) -> Mapping[str, object]:
        told = {"largest_error_mm": self.largest_error, "start_deg": self.start_deg, "start_mm": self.start_mm}
        return {**{name: ten_digits(value) for name, value in told.items()}, **super().summary()}


def _six(value: float) -> float | None:
    """Six digits of a number; None for what cannot be told."""
    return float(f"{value:.6g}") if np.isfinite(value) else None
