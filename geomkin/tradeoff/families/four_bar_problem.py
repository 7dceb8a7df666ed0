"""The four-bar that methods are tried on, with its right motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...linkage.bars import FourBar
from ...plane.vec import Complex, Real
from ..exact import circling, fixed, many_digits, pinned

Directions = tuple[Complex, Complex]
FRAMES = 360
ORDINARY, NEAR_TOGGLE = FourBar(100, 30, 90, 70), FourBar(100, 30, 60, 70 + 1e-8)


@dataclass(frozen=True, eq=False)
class FourBarProblem:
    """A four-bar and its crank's angles, rad, with the right directions of coupler and rocker, unit complex, (frames,).

    first, second: the right derivatives of the two's angles by the crank's, (2, frames).
    """

    linkage: FourBar
    drive: Real
    directions: Directions
    first: Real
    second: Real

    @property
    def lengths(self) -> tuple[float, float, float, float]:
        """Crank, coupler, rocker, ground."""
        one = self.linkage
        return float(one.crank), float(one.coupler), float(one.rocker), float(one.ground)

    @classmethod
    def of(cls, linkage: FourBar) -> FourBarProblem:
        """Its directions and their derivatives by decimal arithmetic."""
        drive = np.arange(FRAMES) * (2 * np.pi / FRAMES)
        places, rates = np.empty((2, FRAMES), dtype=complex), np.empty((2, 2, FRAMES))
        with many_digits():
            pivot = fixed(float(linkage.ground))
            for k, angle in enumerate(drive.tolist()):
                crank = circling(float(linkage.crank), angle)
                pin = pinned(crank, pivot, float(linkage.coupler), float(linkage.rocker), 1)
                for j, arm in enumerate((pin - crank, pin - pivot)):
                    length = arm.at.dot(arm.at).sqrt()
                    places[j, k] = complex(arm.at.x / length, arm.at.y / length)
                    rates[:, j, k] = [float(rate) for rate in arm.turning]
        return cls(linkage, drive, (places[0], places[1]), rates[0], rates[1])
