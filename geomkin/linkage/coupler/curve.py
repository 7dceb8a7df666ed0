"""The path of a point of a linkage as a curve: exact, since every point of it solves the linkage."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import check_fields
from ...errors import DesignError
from ...plane.curve import AbstractCurve
from ...plane.vec import Array
from ..limits import driver_limits
from ..body_motion import PointMotion
from ..linkage import AbstractLinkage, OneLinkage
from ..motion import Motion
from ..solve.branch import Branch
from ..solve.move import move


def moved_at(linkage: AbstractLinkage, t: ArrayLike, branch: Branch, start: float) -> tuple[Motion, Array]:
    """The motion at drives of any shape and order, and which of its frames each of them is.

    A branch that is followed is followed from `start`, whatever drives are asked for.
    """
    drive = np.asarray(t, dtype=float)
    order = np.argsort(drive, axis=None, kind="stable")
    frames = np.empty(drive.size, dtype=int)
    frames[order] = np.arange(1, drive.size + 1)
    return move(linkage, np.append(start, drive.ravel()[order]), branch), frames.reshape(drive.shape)


@dataclass(frozen=True, eq=False)
class CouplerCurve(AbstractCurve):
    """The path of the named `point`; t is the driver's angle, rad, or place, mm, over `span`.

    span: one turn unless given; where a slide drives it must be. branch as in `move`. Raises DesignError where the
    linkage does not reach the whole span.
    """

    linkage: OneLinkage
    point_name: str
    branch: Branch = 1
    span: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        named = dict.fromkeys(point for points in self.linkage.linkage.bodies.values() for point in points)
        if self.point_name not in named:
            raise DesignError("point_name", f"found {self.point_name!r}", f"give one of {', '.join(named)}")
        untold = self.span is None and self.linkage.linkage.driven_slider is not None
        parts = driver_limits(self.linkage, self.branch, None if untold else self.way)
        reached = " and ".join(f"{low:.6g} to {high:.6g}" for low, high in parts) or "nowhere"
        if untold:
            remedy = f"give its first and last place, mm: the linkage closes from {reached}"
            raise DesignError("span", "is missing where a slide drives", remedy)
        if parts != (self.way,):
            raise DesignError("span", f"the linkage closes only from {reached}", "give a span inside it")

    @property
    def way(self) -> tuple[float, float]:
        """The driver's first and last angle or place."""
        return (0.0, 2 * np.pi) if self.span is None else (self.span[0], self.span[1])

    def _track(self, t: ArrayLike) -> tuple[PointMotion, Array]:
        motion, frames = moved_at(self.linkage, t, self.branch, self.way[0])
        return motion.point(self.point_name), frames

    def point(self, t: ArrayLike) -> Array:
        track, frames = self._track(t)
        return track.position[frames]

    def velocity(self, t: ArrayLike) -> Array:
        track, frames = self._track(t)
        return track.first[frames]

    def curvature(self, t: ArrayLike) -> Array:
        track, frames = self._track(t)
        second, first = track.second[frames], track.first[frames]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.imag(np.conj(first) * second) / np.abs(first) ** 3

    @property
    def breaks(self) -> Array:
        return np.array(self.way, dtype=float)

    @cached_property
    def closed(self) -> bool:
        ends = self.point(np.array(self.way))
        return bool(abs(ends[1] - ends[0]) <= 1e-9 * abs(self.velocity(self.way[0])) * (self.way[1] - self.way[0]))
