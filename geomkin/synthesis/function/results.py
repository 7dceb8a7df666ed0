"""Four-bars and slider-cranks that generate a function, as results of a search."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import field, replace
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import checked
from ...core.fields import to_digits_or_none
from ...core.records import record
from ...linkage.linkage import AbstractLinkage
from ...linkage.named_linkages import FourBar, SliderCrank
from ...plane.vec import Real
from ..found import Found, Rounding, ten_digits
from .generators import AbstractGenerator, FourBarGenerator, SliderGenerator
from .minimax import certified
from .search import EXACT, LOOKS, PEAKS, LocalOptimum, peaks
from .wanted import WantedFunction

DEGREE = float(np.degrees(1.0))


class Peak(NamedTuple):
    """A local extremum of the error.

    Parameters
    ----------
    x : float
        Its position.
    error : float
        Actual minus wanted output there, deg, or mm for a slider.
    multiplier : float
        Share of this peak in holding the largest error; all shares add up to 1. 0 if the peak could grow, nan if the
        method is not minimax.
    """

    x: float
    error: float
    multiplier: float


@record(eq=False, kw_only=True)
class AbstractFunctionGenerator(Found):
    """The common part of function generators.

    Parameters
    ----------
    linkage, branch, transmission_angle_deg, defects
        As for `Found`.
    drive : array, shape (2,)
        Crank angles at x0 and x1, rad from the ground line.
    alternation : tuple of Peak
        Peaks of the error in order of x.
    active_limits : mapping of str to float
        Multipliers of "transmission angle" and "ratio" if these limit the error: how fast the largest error would fall,
        in its unit, if the limit were moved (the cosine of the transmission angle, the logarithm of the ratio).
    certificate : float
        Norm of the sum of the derivatives of the peaks and active limits, each times its multiplier. 0 to rounding
        proves, since no multiplier is negative, that no small change of the sizes reduces all peaks. nan for least
        squares.
    others : tuple
        Further results of the search, the best first.
    wanted, task, unknowns
        The function, the optimisation task and its unknowns.
    """

    alternation: tuple[Peak, ...]
    active_limits: Mapping[str, float]
    certificate: float
    others: tuple[Self, ...] = ()
    wanted: WantedFunction = field(repr=False)
    task: AbstractGenerator = field(repr=False)
    unknowns: Real = field(repr=False)

    @property
    @abstractmethod
    def _output(self) -> tuple[float, float]:
        """Start and range of the wanted output, deg or mm."""

    @property
    @abstractmethod
    def _unit(self) -> float:
        """Factor from the task's errors to deg or mm."""

    def _error(self, s: Real) -> Real:
        """Errors (1, m), deg or mm, at shares (1, m) of the input range."""
        return self._unit * self.task.error(self.unknowns[None], s)

    def _with(self, linkage: AbstractLinkage, p: Real) -> Self:
        """A copy with other unknowns p (unknowns,); multipliers and certificate remain those of the optimum."""
        positions, errors, is_peak = (row[0] for row in peaks(self.task, p[None], PEAKS, LOOKS))
        x, errors = self.wanted.x(positions[is_peak]).tolist(), (self._unit * errors[is_peak]).tolist()
        is_same_count = len(x) == len(self.alternation)
        multipliers = [peak.multiplier for peak in self.alternation] if is_same_count else len(x) * [np.nan]
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
        """Entries for `summary.json`: peaks of the error, deg or mm, and active limits, with their multipliers."""
        # Rounding leaves only half of the digits of the position of a flat maximum.
        peaks = [
            {name: to_digits_or_none(value, 5) for name, value in peak._asdict().items()} for peak in self.alternation
        ]
        return {
            "alternation": peaks,
            "active_limits": {name: to_digits_or_none(value, 5) for name, value in self.active_limits.items()},
        }

    def _share(self, x: float | ArrayLike) -> Real:
        """Share of the input range, (...,)."""
        return np.asarray((np.asarray(x, dtype=float) - self.wanted.x0) / (self.wanted.x1 - self.wanted.x0))

    @checked
    def input_at(self, x: float | ArrayLike) -> Real:
        """Input angle at x.

        Parameters
        ----------
        x : float or array_like
            Values of the function's variable.

        Returns
        -------
        array
            Angles, rad from the ground line.
        """
        return np.asarray(self.drive[0] + (self.drive[1] - self.drive[0]) * self._share(x))

    @checked
    def wanted_at(self, x: float | ArrayLike) -> Real:
        """Wanted output at x.

        Parameters
        ----------
        x : float or array_like
            Values of the function's variable.

        Returns
        -------
        array
            Output, deg from the ground line, or mm along the slide line.
        """
        start, extent = self._output
        return np.asarray(start + extent * self.wanted.share(self._share(x)))

    @checked
    def error(self, x: float | ArrayLike) -> Real:
        """Error of the output at x.

        Parameters
        ----------
        x : float or array_like
            Values of the function's variable.

        Returns
        -------
        array
            Actual minus wanted output, deg or mm; nan if the linkage does not close.
        """
        s = self._share(x)
        return self._error(s.reshape(1, -1)).reshape(s.shape)


@record(eq=False, kw_only=True)
class FunctionGenerator(AbstractFunctionGenerator):
    """A four-bar whose rocker follows a function of its crank's angle.

    Parameters
    ----------
    starts_deg : tuple of float
        Directions of crank and rocker at x0, each from its ground pivot, deg from the ground line: the zeros of the
        scales of x and y.
    largest_error_deg : float
        Largest error of the output angle over the whole range, not only at samples.
    linkage, branch, drive, transmission_angle_deg, defects
        As for `Found`; drive holds the two ends of the range.
    alternation, active_limits, certificate, others
        Peaks of the error and the proof of the optimum; see `Peak` and `function_generator`.
    """

    linkage: FourBar
    starts_deg: tuple[float, float]
    largest_error_deg: float
    task: FourBarGenerator = field(repr=False)

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


@record(eq=False, kw_only=True)
class SliderFunctionGenerator(AbstractFunctionGenerator):
    """A slider-crank whose slider follows a function of its crank's angle.

    Parameters
    ----------
    start_deg : float
        Crank angle at x0, deg from the slide line.
    start_mm : float
        Position of the slider at x0, mm along the slide line from the foot of the crank pivot.
    largest_error : float
        Largest error of the slider's position over the whole range, mm, not only at samples.
    linkage, branch, drive, transmission_angle_deg, defects
        As for `Found`; drive holds the two ends of the range.
    alternation, active_limits, certificate, others
        Peaks of the error and the proof of the optimum; see `Peak` and `slider_function_generator`.
    """

    linkage: SliderCrank
    start_deg: float
    start_mm: float
    largest_error: float
    task: SliderGenerator = field(repr=False)

    @property
    def _output(self) -> tuple[float, float]:
        return self.start_mm, self.task.sense * self.task.length

    @property
    def _unit(self) -> float:
        return self.task.length

    def rounded(self, rounding: Rounding) -> SliderFunctionGenerator:
        linkage, scale = rounding.linkage(self.linkage), self.task.length
        first = rounding.angle("input_start_deg", self.start_deg)
        position = rounding.length("output_start_mm", self.start_mm)
        logs = np.log(np.array([linkage.crank, linkage.coupler]) / scale)
        p = np.array([*logs, float(linkage.offset) / scale, np.radians(first), position / scale, self.branch])
        other = self._with(linkage, p)
        return replace(other, start_deg=first, start_mm=position, largest_error=other.largest)

    def summary(self) -> Mapping[str, object]:
        entries = {"largest_error_mm": self.largest_error, "start_deg": self.start_deg, "start_mm": self.start_mm}
        return {**{name: ten_digits(value) for name, value in entries.items()}, **super().summary()}


def common_fields(
    task: AbstractGenerator, wanted: WantedFunction, optimum: LocalOptimum, method: str, unit: float, start_deg: float
) -> dict[str, Any]:
    """Fields common to both results."""
    s, errors = optimum.s, optimum.errors
    multipliers, limits, residual = np.full(len(s), np.nan), dict[str, float](), np.nan
    if optimum.worst < EXACT:
        residual = 0.0
    elif method != "least-squares":
        proof = certified(task, optimum.p, s, errors)
        multipliers, residual = proof.peaks, proof.left
        for name, value in zip(task.limit_names, proof.limits):
            if value > 0 and name:
                limits[name] = limits.get(name, 0.0) + unit * float(value)
    return {
        "linkage": task.linkage(optimum.p),
        "branch": int(optimum.p[5]),
        "drive": np.radians(start_deg) + np.array([0.0, task.swing]),
        "transmission_angle_deg": float(np.degrees(task.transmission(optimum.p[None])[0])),
        "alternation": tuple(
            Peak(*peak) for peak in zip(wanted.x(s).tolist(), (unit * errors).tolist(), multipliers.tolist())
        ),
        "active_limits": limits,
        "certificate": residual,
        "wanted": wanted,
        "unknowns": optimum.p,
    }
