"""Arms that swing about a pivot beside the cam."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ...errors import DesignError
from ...plane.vec import Array

Side = Literal["above", "below"]


def side_sign(side: Side) -> int:
    """tau: +1 where the arm rides above the line from the cam's axis to the pivot, -1 below."""
    return 1 if side == "above" else -1


def check_side(side: str) -> None:
    """Raises DesignError for what is no side."""
    if side not in ("above", "below"):
        raise DesignError("side", f"found {side!r}", "give above or below")


def arm_direction(psi: Array, tau: int) -> Array:
    """Direction from the pivot along an arm at the angle psi, rad, from the line to the cam's axis."""
    return -np.exp(-1j * tau * psi)
