"""Round holes for shafts and pins: how wide, and whether the part can take them."""

from __future__ import annotations

from typing import Any

from ..errors import DesignError
from ..plane.primitives import Circle
from ..sizes import FARTHEST, quantity

# mm. No cutter makes a smaller hole, and no file tells one apart.
SMALLEST = 0.01


def shaft(what: str, default: float) -> Any:
    """A field for the diameter of a shaft or pin that a hole is for; what: "the cam shaft" and so on."""
    return quantity(
        f"diameter of {what}, 0 for no hole; its hole is wider by the clearance", "mm", default=default, at_least=0
    )


def clearance(default: float) -> Any:
    """The field of stock tables that makes every hole wider than what goes through it."""
    return quantity(
        "how much wider than its pin or shaft a hole is", "mm", default=default, at_least=0, at_most=FARTHEST
    )


def widened(diameter: float, clearance: float) -> float:
    """Diameter, mm, of the hole for a shaft or pin; 0 where there is none."""
    return diameter + clearance if diameter else 0.0


def bore(diameter: float, clearance: float, widest: float, key: str, centre: complex = 0j) -> tuple[Circle, ...]:
    """The hole for a shaft, or none for diameter 0, in a part that is `widest` mm across where it is narrowest.

    Refuses a hole that is invisible or leaves nothing of the part. key: of the diameter in a recipe; that of the
    clearance stands in the same table.
    """
    if diameter == 0:
        return ()
    room = f"in a part {widest:.4g} mm wide where it is narrowest"
    if not SMALLEST <= diameter < widest:
        raise DesignError(
            key,
            f"found {diameter:g} mm {room}",
            f"give 0 for none, or at least {SMALLEST:g} and less than {max(widest - clearance, SMALLEST):.4g} mm",
        )
    if diameter + clearance >= widest:
        raise DesignError(
            f"{key.rpartition('.')[0]}.clearance",
            f"found {clearance:g} mm round a shaft of {diameter:g} mm {room}",
            f"give less than {widest - diameter:.4g} mm, or a smaller {key.rpartition('.')[2]}",
        )
    return (Circle(centre, (diameter + clearance) / 2),)
