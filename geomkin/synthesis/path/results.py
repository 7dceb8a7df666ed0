"""What a path search found: a linkage, how far its path is from the points, and what it gives besides."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ...brief import one_line
from ...cached import cached_property
from ...errors import DesignError
from ...linkage.bars import FourBar
from ...linkage.cognate_linkages import Cognate, cognates
from ...linkage.solve.move import move
from ...plane.vec import Complex, Real
from ..found import Found
from ..rounding import Rounding

# What counts as usable: a transmission angle, deg, and a ratio of links that a workshop can live with.
USABLE_DEG, USABLE_RATIO = 30.0, 10.0
# By how much of itself a limit may be missed and count as held, for rounding.
ROUNDED = 1e-6


@dataclass(frozen=True, eq=False, kw_only=True)
class PathFound(Found):
    """A linkage whose coupler point goes through given points, or near them.

    drive: the crank's angle at each point, rad from the ground line; of a closed path at the nearest point of it.
    square_error: sum of squared distances of the points from the path, mm2, of timed ones from where the coupler point
    then is. largest_distance: the largest of them, mm. closed: whether a full turn draws the path. at_limits: in words,
    the limits that it stands on. cut_short: the search was ended by its time. may_be_incomplete: nine points have a
    finite number of linkages, of which the search may have missed some; another seed or more time may find them.
    ranked: distinct linkages, the best first, this one among them; those with a defect come last. least_squares: more
    points are given than linkages can be made to meet.
    """

    points: Complex
    square_error: float
    largest_distance: float
    closed: bool = False
    at_limits: tuple[str, ...] = ()
    cut_short: bool = False
    may_be_incomplete: bool = False
    least_squares: bool = False
    ranked: tuple[PathFound, ...] = ()
    again: Callable[[], PathFound | None] | None = field(default=None, repr=False)

    __repr__ = one_line

    @property
    def coupler_point(self) -> complex:
        """In the coupler's frame, mm."""
        return complex(self.linkage.coupler_point)  # type: ignore[attr-defined]

    @property
    def is_usable(self) -> bool:
        """Whether it has no defect, a transmission angle of 30 deg and more, and a ratio of links of 10 and less."""
        angle, ratio = self.transmission_angle_deg, self.ratio
        return not self.defects and angle >= USABLE_DEG * (1 - ROUNDED) and bool(ratio <= USABLE_RATIO * (1 + ROUNDED))

    @cached_property
    def usable(self) -> PathFound | None:
        """The best that is usable too: itself if it is, else searched for when first asked; None where none is found.

        Without such limits the best linkage of a path is often one that jams or has endless links.
        """
        if self.is_usable:
            return self
        return self.again() if self.again else None

    @cached_property
    def cognates(self) -> tuple[Cognate, ...]:
        """It and the two other four-bars that draw the same path; () of a slider-crank, and where one has no size."""
        if not isinstance(self.linkage, FourBar):
            return ()
        try:
            return cognates(self.linkage)
        except DesignError:
            return ()

    @property
    def drive_range(self) -> tuple[float, float]:
        return (0.0, 2 * np.pi) if self.closed else super().drive_range

    def rounded(self, rounding: Rounding) -> PathFound:
        other = super().rounded(rounding)
        # One with a defect may reach some of the points on its other branch.
        branches = (1, -1) if self.defects else (self.branch,)
        paths = [move(other.linkage, other.drive, sign).point("coupler_point").position for sign in branches]
        off = np.fmin.reduce(np.abs(np.array(paths) - self.points))
        return replace(other, square_error=float(np.sum(off**2)), largest_distance=float(off.max()))

    def summary(self) -> Mapping[str, object]:
        told: dict[str, object] = {
            "square_error_mm2": float(f"{self.square_error:.6g}"),
            "largest_distance_mm": float(f"{self.largest_distance:.6g}"),
        }
        more: dict[str, object] = {"at_limits": list(self.at_limits)} if self.at_limits else {}
        return told | dict(super().summary()) | more

    @property
    def drive_deg(self) -> Real:
        """The crank's angles at the points, deg."""
        return np.degrees(self.drive)
