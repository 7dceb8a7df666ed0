"""Cells of the stability study: a result near a singular position, and the digits that library and textbook keep."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..core.errors import DesignError
from ..core.records import record

# Digits of the exact answer. The second derivative near a change point loses four digits per digit of distance, and
# more than 50 must remain at a distance of 1e-15.
DIGITS = 120
# Digits of a double, and those that count as all: a smaller limit would hide a lost digit, a larger one would report
# the rounding of about ten operations as a loss.
WHOLE, ALL = 16.0, 12.5
# Digits by which a result may fall short of what its sizes allow, since its operations round too.
SLACK = 1.7
# Description of the library's behaviour towards the singular position, by the outcomes of `Digits.outcome`.
ANSWERS = {
    "all": "keeps all digits",
    "sizes": "keeps the digits that the sizes allow",
    "all, nan": "keeps all digits, then nan",
    "sizes, nan": "keeps the digits that the sizes allow, then nan",
    "all, refused": "keeps all digits, then refuses",
    "sizes, refused": "keeps the digits that the sizes allow, then refuses",
    "refused": "refuses",
}
Sizes = tuple[float, ...]


@record(eq=False)
class Cell:
    """A result of a family near a singular position: a problem, two methods and the exact answer.

    `sizes` maps a distance, 1e-1 to 1e-15 of the size, which `distance` describes, to the problem's sizes. `formula` is
    the textbook's method, from an mpmath context and the sizes; in 120 digits it is the exact answer. `library` gives
    the same result from this library. `answer` is the expected behaviour, a key of `ANSWERS`; `reported_by` names what
    reports a loss. `amplification` maps the sizes to the factor of errors that the library reports. `share` is the
    relative error of each size: half a last bit, or the accuracy of a search.
    """

    family: str
    place: str
    result: str
    distance: str
    sizes: Callable[[float], Sizes]
    formula: Callable[..., Any]
    library: Callable[..., Any]
    answer: str
    reported_by: str = ""
    amplification: Callable[..., Any] | None = None
    share: float = 2.0**-53

    @property
    def name(self) -> str:
        """Unique name of the cell."""
        return f"{self.family}, {self.place}: {self.result}"


def for_each(results: Sequence[str], cell: Cell) -> tuple[Cell, ...]:
    """A cell for each of several results, of which formula, library and amplification yield the name and the value."""

    def pick(function: Callable[..., Any], result: str, *sizes: Any) -> Any:
        return next(value for name, value in function(*sizes) if name == result)

    def one(result: str) -> Cell:
        formula, library = (partial(pick, function, result) for function in (cell.formula, cell.library))
        amplification = cell.amplification and partial(pick, cell.amplification, result)
        return replace(cell, result=result, formula=formula, library=library, amplification=amplification)

    return tuple(map(one, results))


@record(eq=False)
class Digits:
    """Decimal digits of a cell's result at a distance, 16 at most.

    `library`, `textbook`: digits kept, nan without a number. `allowed`: digits that remain if each size has the cell's
    relative error. `refused`: whether the library raised DesignError. `amplification`: the factor that it reported.
    """

    cell: Cell
    distance: float
    library: float
    textbook: float
    allowed: float
    refused: bool
    amplification: float = np.nan

    @property
    def outcome(self) -> str:
        """all, sizes, nan, refused, or lost: fewer digits than the sizes allow, without notice."""
        if self.refused:
            return "refused"
        if np.isnan(self.library):
            return "nan"
        if self.library >= ALL:
            return "all"
        return "sizes" if self.library >= self.allowed - SLACK else "lost"

    def text(self, kind: str) -> str:
        """Digits of a kind as they are written."""
        value = getattr(self, kind)
        return f"{value:.1f}" if not np.isnan(value) else "refused" if kind == "library" and self.refused else "nan"


def measured_digits(cell: Cell, distance: float) -> Digits:
    """The cell's digits at one distance, compared with arithmetic of 120 digits."""
    try:
        from mpmath import fp, mp
    except ImportError:
        raise DesignError("mpmath", "it is not installed", "pip install mpmath", "file-unreadable") from None

    def digits(off: Any, right: Any) -> float:
        share = abs(off) / abs(right) if right else abs(off)
        return float(min(WHOLE, max(0, -mp.log10(share)))) if share else WHOLE

    def last(values: Any) -> complex:
        # A search near its limit may return nothing on some processors.
        row = np.ravel(values)
        return complex(row[-1]) if row.size else complex(np.nan)

    sizes = cell.sizes(distance)
    with mp.workdps(DIGITS):
        exact = [mp.mpf(size) for size in sizes]
        right, error = cell.formula(mp, *exact), mp.mpf(0)
        for k, size in enumerate(exact):
            changed = [*exact[:k], size * (1 + mp.mpf(cell.share)), *exact[k + 1 :]]
            error += abs(cell.formula(mp, *changed) - right)
        textbook, library, amplification, refused = np.nan, np.nan, np.nan, False
        try:
            value = mp.mpmathify(cell.formula(fp, *sizes))
            textbook = digits(value - right, right) if mp.isfinite(value) else np.nan
        except (ArithmeticError, ValueError, TypeError):
            pass  # a root of what rounding made negative
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = last(cell.library(*sizes))
                amplification = last(cell.amplification(*sizes)).real if cell.amplification else np.nan
            library = digits(mp.mpmathify(found) - right, right) if np.isfinite(found) else np.nan
        except DesignError:
            refused = True
        return Digits(cell, distance, library, textbook, digits(error, right), refused, amplification)


def answered(found: Sequence[Digits]) -> str:
    """Behaviour of the library at a cell, from its digits by falling distance: a key of `ANSWERS` unless digits are
    lost.
    """
    outcomes = [result.outcome for result in found]
    if "lost" in outcomes:
        return "lost"
    ends = [outcome for outcome in outcomes if outcome in ("nan", "refused")]
    numbers = outcomes[: len(outcomes) - len(ends)]
    if any(number in ("nan", "refused") for number in numbers):
        return "numbers again beyond nan"
    parts = ["sizes" if "sizes" in numbers else "all"] if numbers else []
    return ", ".join([*parts, *ends[-1:]])
