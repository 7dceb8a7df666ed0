"""A centrode as a curve: exact, since every point of it solves the linkage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import check_fields
from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..plane.vec import Array
from .centrodes import Centrodes
from .coupler import moved_at
from .solve import Branch, OneLinkage


@dataclass(frozen=True, eq=False)
class CentrodeCurve(AbstractCurve):
    """The centrode of `body` on the ground, or where `moving` on the body itself; t is the drive over `span`.

    The span is to lie inside one run, as `Centrodes.runs` finds them: at infinity the curve breaks. start: the
    drive from which a branch is followed.
    """

    linkage: OneLinkage
    body: str
    span: tuple[float, float]
    moving: bool = False
    branch: Branch = 1
    start: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.span[0] < self.span[1]:
            raise DesignError("span", f"found {self.span}", "give a rising pair")
        bodies = self.linkage.linkage.bodies
        if self.body not in bodies:
            raise DesignError("body", f"found {self.body!r}", f"give one of {', '.join(bodies)}")

    def _centrodes(self, t: ArrayLike) -> tuple[Centrodes, Array]:
        motion, frames = moved_at(self.linkage, t, self.branch, self.start)
        return Centrodes(motion, self.body), frames

    def point(self, t: ArrayLike) -> Array:
        centrodes, frames = self._centrodes(t)
        return (centrodes.moving if self.moving else centrodes.fixed)[frames]

    def velocity(self, t: ArrayLike) -> Array:
        centrodes, frames = self._centrodes(t)
        # The moving centrode rolls on the fixed one: the same way along both, seen from the body.
        turned = np.conj(centrodes.motion.bodies[self.body].direction) if self.moving else 1.0
        return (centrodes.velocity * turned)[frames]

    @property
    def breaks(self) -> Array:
        return np.array(self.span)

    @property
    def closed(self) -> bool:
        return False
