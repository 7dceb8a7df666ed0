"""The check of a design: a value, its limit, and whether it keeps the limit."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from math import isnan, pi
from typing import Annotated, Literal

from ..core.arguments import LARGEST, REAL, ArgumentType
from ..core.errors import harmless
from ..core.fields import clipped, to_digits
from ..core.records import record
from ..core.units import as_sentences
from ..plane.vec import NOTHING, rounded

# May be nan or infinite.
AnyNumber = Annotated[
    float, ArgumentType(lambda value: isinstance(value, REAL) and not isinstance(value, bool), "a number")
]


@record
class Suggestion:
    """Values with which a failed check passes, as data beside its advice.

    Parameters
    ----------
    values : mapping of str to float or str
        Value of each dotted key of the recipe, such as `tolerances.tolerance`; all of them together.
    unit : str
        Unit of the numbers.
    """

    values: Mapping[str, float | str]
    unit: str = ""

    def under(self, key: str) -> Suggestion:
        """The same, of a recipe that another one has under a key."""
        return replace(self, values={f"{key}.{inner}": value for inner, value in self.values.items()})


@record(checked=True)
class Check:
    """A value of a design compared with its limit.

    A failed check is advice, not an error: the design exists, and its files are still made.

    Parameters
    ----------
    id : str
        Unique among the checks of a recipe, in snake case, such as `transmission_angle`.
    name : str
        For people. It may be reworded; the id stays.
    value, limit : float
    side : {"at least", "at most"}
        Side of the limit on which the value should be.
    unit, advice : str
    column : str
        Id of the table's column that the value comes from; "" if there is none.
    at : float, optional
        Position of the driver at which the value is worst, as in the first column of the scene's table: deg, or mm if
        it slides. None if unknown.
    expected : str
        The reason that the recipe gives for an intended failure; "" if there is none.
    suggestions : tuple of Suggestion
        Changes of the recipe's values, each of which lets the check pass; empty if none is known.

    See Also
    --------
    FailedChecksError, make
    """

    id: str
    name: str
    value: AnyNumber
    side: Literal["at least", "at most"]
    limit: AnyNumber
    unit: str = ""
    advice: str = ""
    column: str = ""
    at: AnyNumber | None = None
    expected: str = ""
    suggestions: tuple[Suggestion, ...] = ()

    def __post_init__(self) -> None:
        as_sentences(self, "name", "advice")
        if self.value and abs(self.limit) < LARGEST and abs(self.value) <= NOTHING * abs(self.limit):
            object.__setattr__(self, "value", 0.0)

    @property
    def passed(self) -> bool:
        """Whether the value keeps its limit; False for nan, an unknown value."""
        return self.value >= self.limit if self.side == "at least" else self.value <= self.limit

    def to_dict(self) -> dict[str, object]:
        """The entries of the check in JSON files."""
        known: dict[str, object] = {"column": self.column} if self.column else {}
        # Rounding displaces the position of a maximum by the square root of its size: further decimals would be noise.
        known |= {"at": float(rounded(self.at, 3)) + 0.0} if self.at is not None else {}
        known |= {"expected": self.expected} if self.expected and not self.passed else {}
        if self.suggestions and not self.passed:
            known["suggestions"] = [dict(suggestion.values) for suggestion in self.suggestions]
        return {
            "id": self.id,
            "name": self.name,
            "value": to_digits(self.value, self.digits(10)),
            "side": self.side,
            "limit": self.limit,
            "unit": self.unit,
            "passed": bool(self.passed),
            **known,
        }

    def digits(self, least: int) -> int:
        """Significant digits, `least` or more, with which the value of a failed check and its limit differ."""
        counts = (n for n in range(least, 17) if self.passed or f"{self.value:.{n}g}" != f"{self.limit:.{n}g}")
        return next(counts, 17)

    def __repr__(self) -> str:
        verdict = "passed" if self.passed else "FAILED"
        unit = f" {self.unit}" if self.unit else ""
        n = self.digits(6)
        return clipped(f"Check({verdict}: {self.name} {self.value:.{n}g}{unit}, limit {self.side} {self.limit:.{n}g})")

    def __str__(self) -> str:
        n = self.digits(3)
        # Adding 0 removes the sign of -0.
        value = "unknown" if isnan(self.value) else f"{self.value + 0.0:.{n}g} {self.unit}".rstrip()
        text = f"{self.name} {value}"
        if self.passed:
            return text
        text = f"{text}, should be {self.side} {self.limit:.{n}g} {self.unit}".rstrip()
        if self.expected:
            return f"{text}; expected: {harmless(self.expected)}"
        return f"{text}: {self.advice}" if self.advice else text


@record
class WorkedFormula:
    """A formula with its numbers put in, by which a reader checks a result by hand.

    Parameters
    ----------
    name, symbol : str
        The result and its symbol.
    expression : str
        The formula in symbols; empty for a given number.
    substituted : str
        The same with the numbers put in.
    value : float
        The result, from the exact numbers.
    unit : str
        Unit of the result and of lengths in the formula; angles are in deg.
    source : str
        Where the formula is from.
    """

    name: str
    symbol: str
    expression: str
    substituted: str
    value: AnyNumber
    unit: str
    source: str


class WorkedFormulas:
    """Formulas that are worked one after another, each with the results of those before it.

    Parameters
    ----------
    source : str
        Where the formulas are from.
    numbers : mapping of str to float, optional
        Numbers by symbol that are known already.
    """

    def __init__(self, source: str, numbers: Mapping[str, float] | None = None) -> None:
        self.source, self.numbers = source, {"pi": pi, **(numbers or {})}
        self.formulas: list[WorkedFormula] = []

    def give(self, symbol: str, name: str, value: float, unit: str = "") -> float:
        """A given number, by its symbol and meaning; returns it."""
        self.formulas.append(WorkedFormula(name, symbol, "", "", float(value), unit, ""))
        self.numbers[symbol] = float(value)
        return float(value)

    def add(self, name: str, symbol: str, template: str, value: float, unit: str = "") -> float:
        """A formula as a template with `{symbol}` for each number and spaces for products; returns its value."""
        template = re.sub(r"(?<=[}\d)]) (?!deg)(?=[{(a-z\d])", " * ", template)
        digits = {key: f"({n:.7g})" if n < 0 else f"{n:.7g}" for key, n in self.numbers.items()}
        symbols, substituted = template.format(**{key: key for key in digits}), template.format(**digits)
        self.formulas.append(WorkedFormula(name, symbol, symbols, substituted, float(value), unit, self.source))
        self.numbers[symbol] = float(value)
        return float(value)
