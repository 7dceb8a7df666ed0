"""What one member of a linkage does over a turn of its crank, with the right values: what its methods are tried on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...linkage.linkage import AnyLinkage
from ...plane.vec import Array, Complex, Real
from ..exact import Vector, many_digits

FRAMES = 360


@dataclass(frozen=True, eq=False)
class Track:
    """A linkage, its crank's angles, rad, and the right values there, (frames,)."""

    linkage: AnyLinkage
    drive: Real
    right: Complex

    @classmethod
    def of(cls, linkage: AnyLinkage, exact: Callable[[float], Vector]) -> Track:
        """The values as `exact` finds them at an angle of the crank, in decimals."""
        drive = np.arange(FRAMES) * (2 * np.pi / FRAMES)
        with many_digits():
            found = [exact(angle) for angle in drive.tolist()]
        return cls(linkage, drive, np.array([complex(z.x, z.y) for z in found]))


def misses(track: Track, found: Array) -> Real:
    """How far each value is from the right one."""
    off: Real = np.abs(found - track.right)
    return off


def count(_: Track, found: Array) -> int:
    """How many values there are."""
    return len(found)
