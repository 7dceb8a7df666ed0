"""How far a size may go."""

from __future__ import annotations

from collections.abc import Callable


def last_fit(fits: Callable[[float], bool], good: float, bad: float) -> float:
    """The size nearest to a bad one that still fits, from one that does: by halves, to rounding."""
    for _ in range(60):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if fits(middle) else (good, middle)
    return good
