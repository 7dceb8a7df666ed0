"""Where a body is: the place of its origin and the direction of its x axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import check_fields
from ..brief import one_line
from .vec import Complex


@dataclass(frozen=True, eq=False)
class Pose:
    """A rigid placement: origin, mm, and direction, a unit complex number; arrays of one shape."""

    origin: Complex | complex = 0j
    direction: Complex | complex = 1 + 0j
    __repr__ = one_line

    def __post_init__(self) -> None:
        check_fields(self)

    def place(self, z: ArrayLike) -> Complex:
        """A body's own points as seen from outside."""
        return np.asarray(self.origin + self.direction * np.asarray(z))

    def locate(self, z: ArrayLike) -> Complex:
        """Outside points in the body's own coordinates: the inverse of `place`."""
        return (np.asarray(z) - self.origin) * np.conj(self.direction)
