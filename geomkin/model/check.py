"""A judgement on a design: a value, the limit it should keep, and the verdict."""

from __future__ import annotations

from math import isnan
from typing import Annotated, Literal

from ..core.arguments import REAL, ArgumentType
from ..core.errors import harmless
from ..core.records import record
from ..core.reprs import clipped
from ..plane.vec import rounded

# May be nan or infinite.
AnyNumber = Annotated[
    float, ArgumentType(lambda value: isinstance(value, REAL) and not isinstance(value, bool), "a number")
]


@record(checked=True)
class Check:
    """One quality of a design against its limit.

    A failed check is advice, not an error: the design exists, and its files are still made.

    Parameters
    ----------
    id : str
        In snake case, such as `transmission_angle`; a recipe's checks have different ones.
    name : str
        For people; it may change, the id does not.
    value, limit : float
    side : {"at least", "at most"}
        Of the limit that the value should keep to.
    unit, advice : str
    column : str
        Id of the table's column that is judged; "" if none is.
    at : float, optional
        Where the driver is when the check comes out worst, as the first column of the scene's table states it: deg, or
        mm if it slides. None if unknown.
    expected : str
        The reason that the recipe gives for a failure that is meant; "" if there is none.
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

    @property
    def passed(self) -> bool:
        """False also for nan: what could not be measured has not passed."""
        return self.value >= self.limit if self.side == "at least" else self.value <= self.limit

    def to_dict(self) -> dict[str, object]:
        """As JSON files state it."""
        known: dict[str, object] = {"column": self.column} if self.column else {}
        # The place of a maximum is known to the square root of the rounding only: more decimals would be noise.
        known |= {"at": float(rounded(self.at, 3)) + 0.0} if self.at is not None else {}
        known |= {"expected": self.expected} if self.expected and not self.passed else {}
        return {
            "id": self.id,
            "name": self.name,
            "value": float(f"{self.value:.{self.digits(10)}g}"),
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
        value = "unknown" if isnan(self.value) else f"{self.value:.{n}g} {self.unit}".rstrip()
        text = f"{self.name} {value}"
        if self.passed:
            return text
        text = f"{text}, should be {self.side} {self.limit:.{n}g} {self.unit}".rstrip()
        if self.expected:
            return f"{text}; expected: {harmless(self.expected)}"
        return f"{text}: {self.advice}" if self.advice else text
