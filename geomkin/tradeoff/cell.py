"""One place at which methods fail, one result there, and the digits that the library keeps as the place comes near."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..core.errors import DesignError
from ..core.records import record

# Arithmetic of the reference. The second derivative near a change point loses four digits for one of distance, and more
# than 50 have to be left at 1e-15 of it.
DIGITS = 120
# Digits that a double holds, and of them those that count as all: fewer would call a lost digit none, more would call
# the rounding of some ten steps a loss.
WHOLE, ALL = 16.0, 12.5
# Digits that a result may have less than its sizes allow and still be as good as they are: its steps round as well.
SLACK = 1.7

Sizes = tuple[float, ...]


@record(eq=False)
class Cell:
    """A result of a family at a place where methods fail.

    distance: what it is told by, which is 1e-1 to 1e-15 of its size. sizes: from the distance, what is given. formula:
    the textbook's, from a context of mpmath, with 120 digits or with a double's 16, and the sizes. library: the same
    result from this library. answer: what the library does there, of `ANSWERS`; told: where a loss is told.
    condition: from the sizes, the number of digits' loss, as a factor, that the library gives besides. share: of each
    size, that it may be off by: half a last bit, or what a search says that it keeps to.
    """

    family: str
    place: str
    result: str
    distance: str
    sizes: Callable[[float], Sizes]
    formula: Callable[..., Any]
    library: Callable[..., Any]
    answer: str
    told: str = ""
    condition: Callable[..., Any] | None = None
    share: float = 2.0**-53

    @property
    def name(self) -> str:
        """Of the cell among all."""
        return f"{self.family}, {self.place}: {self.result}"


# In words, from the nearest distance that is told in full: what the library does, by what `Digits.outcome` finds.
ANSWERS = {
    "all": "keeps all digits",
    "sizes": "keeps those that the sizes have",
    "all, nan": "keeps all digits, then nan",
    "sizes, nan": "keeps those that the sizes have, then nan",
    "all, refused": "keeps all digits, then refuses",
    "sizes, refused": "keeps those that the sizes have, then refuses",
    "refused": "refuses",
}


@record(eq=False)
class Digits:
    """Decimal digits of a cell's result at a distance, 16 at most.

    library, textbook: kept; nan where it tells no number. allowed: what is left where each size is off by
    the cell's share of it. refused: whether the library raised DesignError. condition: what the cell's own gives.
    """

    cell: Cell
    distance: float
    library: float
    textbook: float
    allowed: float
    refused: bool
    condition: float = np.nan

    @property
    def outcome(self) -> str:
        """all, sizes, nan, refused, or lost: fewer digits than the sizes allow, and no word of it."""
        if self.refused:
            return "refused"
        if np.isnan(self.library):
            return "nan"
        if self.library >= ALL:
            return "all"
        return "sizes" if self.library >= self.allowed - SLACK else "lost"


def measured(cell: Cell, distance: float) -> Digits:
    """The cell's digits at one distance, against arithmetic of 120 digits."""
    mp, fp = _contexts()
    sizes = cell.sizes(distance)
    with mp.workdps(DIGITS):
        exact = [mp.mpf(size) for size in sizes]
        right = cell.formula(mp, *exact)
        off = mp.mpf(0)
        for k, size in enumerate(exact):
            beside = [*exact[:k], size * (1 + mp.mpf(cell.share)), *exact[k + 1 :]]
            off += abs(cell.formula(mp, *beside) - right)
        allowed = _digits(mp, off, right)
        textbook = np.nan
        try:
            told = mp.mpmathify(cell.formula(fp, *sizes))
            textbook = _digits(mp, told - right, right) if mp.isfinite(told) else np.nan
        except (ArithmeticError, ValueError, TypeError):
            pass  # a root of what rounding made negative
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = _last(cell.library(*sizes))
                condition = np.nan if cell.condition is None else _last(cell.condition(*sizes)).real
        except DesignError:
            return Digits(cell, distance, np.nan, textbook, allowed, True)
        kept = _digits(mp, mp.mpmathify(found) - right, right) if np.isfinite(found) else np.nan
    return Digits(cell, distance, kept, textbook, allowed, False, condition)


def _last(answer: Any) -> complex:
    """The last of a method's answers; nan where a search came back with none, as on some processors near its end."""
    row = np.ravel(answer)
    return complex(row[-1]) if row.size else complex(np.nan)


def answered(found: Sequence[Digits]) -> str:
    """What the library does at a cell, from its digits by falling distance: a key of `ANSWERS` where it is honest."""
    outcomes = [one.outcome for one in found]
    if "lost" in outcomes:
        return "lost"
    ends = [one for one in outcomes if one in ("nan", "refused")]
    numbers = outcomes[: len(outcomes) - len(ends)]
    if any(one in ("nan", "refused") for one in numbers):
        return "numbers again beyond nan"
    kept = ["sizes" if "sizes" in numbers else "all"] if numbers else []
    return ", ".join([*kept, *ends[-1:]])


def _digits(mp: Any, off: Any, right: Any) -> float:
    share = abs(off) / abs(right) if right else abs(off)
    return float(min(WHOLE, max(0, -mp.log10(share)))) if share else WHOLE


def _contexts() -> tuple[Any, Any]:
    try:
        from mpmath import fp, mp
    except ImportError:
        raise DesignError("mpmath", "it is not installed", "pip install 'geomkin[test]'") from None
    return mp, fp
