"""A judgement on a design: a value, the limit it should keep, and the verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .arguments import Found, check_fields
from .brief import clipped


@dataclass(frozen=True)
class Check:
    """One quality of a design against its limit.

    A failed check is advice, not an error: the design exists, and its files are still made.
    """

    name: str
    value: Found
    side: Literal["at least", "at most"]
    limit: Found
    unit: str = ""
    advice: str = ""

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def passed(self) -> bool:
        """False also for nan: what could not be measured has not passed."""
        return self.value >= self.limit if self.side == "at least" else self.value <= self.limit

    def __repr__(self) -> str:
        verdict = "passed" if self.passed else "FAILED"
        unit = f" {self.unit}" if self.unit else ""
        return clipped(f"Check({verdict}: {self.name} {self.value:.6g}{unit}, limit {self.side} {self.limit:.6g})")

    def __str__(self) -> str:
        # A value close to its limit is printed in full, or "14 should be at least 14" comes out.
        digits = ".3g" if abs(self.value - self.limit) > 5e-3 * abs(self.limit) else ".6g"
        text = f"{self.name} {self.value:{digits}} {self.unit}".rstrip()
        if self.passed:
            return text
        text = f"{text}, should be {self.side} {self.limit:.3g} {self.unit}".rstrip()
        return f"{text}: {self.advice}" if self.advice else text
