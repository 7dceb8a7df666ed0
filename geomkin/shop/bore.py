"""A round hole about a part's axis."""

from __future__ import annotations

from ..errors import DesignError
from ..plane.primitives import Circle

# mm. No cutter makes a smaller hole, and no file tells one apart.
SMALLEST = 0.01


def bore(diameter: float, widest: float, key: str) -> tuple[Circle, ...]:
    """The hole, or none for diameter 0; refuses one that is invisible or leaves no part of `widest` mm across."""
    if diameter == 0:
        return ()
    if not SMALLEST <= diameter < widest:
        raise DesignError(
            key,
            f"found {diameter:g} mm in a part {widest:.4g} mm wide where it is narrowest",
            f"give 0 for none, or at least {SMALLEST:g} and less than {widest:.4g} mm",
        )
    return (Circle(0j, diameter / 2),)
