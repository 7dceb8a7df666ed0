"""How far a size may go, and the number that says so."""

from __future__ import annotations

from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

# Digits of a number that is advised: fewer than are told in messages, more than are set in a workshop.
DIGITS = 7


def last_fit(fits: Callable[[float], bool], good: float, bad: float) -> float:
    """The size nearest to a bad one that still fits, from one that does: by halves, to rounding."""
    for _ in range(60):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if fits(middle) else (good, middle)
    return good


def rounded_down(most: float) -> str:
    """The largest number of few digits that is not above `most`, as text."""
    return f"{float(Context(DIGITS, ROUND_FLOOR).create_decimal(Decimal(float(most)))):.{DIGITS}g}"


def rounded_up(least: float) -> str:
    """The smallest number of few digits that is not below `least`, as text."""
    return f"{float(Context(DIGITS, ROUND_CEILING).create_decimal(Decimal(float(least)))):.{DIGITS}g}"
