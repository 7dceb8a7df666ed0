"""Gears whose teeth are given by points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np

from ...errors import DesignError
from ...plane.curve import AbstractCurve
from ...plane.spline import Spline
from ...sizes import PointXY, check_sizes, entry, quantity
from .flank_gear import FARTHEST_OUT, FlankGear

# A flank that runs out a little, stays steep and rounds over towards the tip.
EXAMPLE = (3.4 + 33.2j, 2.9 + 34.4j, 2.35 + 36j, 1.75 + 37.6j, 1.0 + 39j)

# Points of a flank. More, each with its own bend, take minutes to shape a mate.
MOST = 100


@dataclass(frozen=True)
class PointToothGear:
    """A gear about the origin whose tooth on +y has a flank through given points and its mirror image."""

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=1000, example=24)
    module: float = quantity("pitch diameter per tooth", "mm", above=0, at_most=1e5, example=3)
    points: tuple[Annotated[complex, PointXY()], ...] = entry(
        "right-hand flank of the tooth on +y as [x, y] in mm, from the bottom land out to the tip", example=EXAMPLE
    )

    def __post_init__(self) -> None:
        check_sizes(self)
        self._check_points()
        self.gear  # refuses points that make no tooth

    def _check_points(self) -> None:
        """Neither so many points nor so far off that no tooth could have them."""
        points = self.points
        if len(points) > MOST:
            raise DesignError("points", f"found {len(points)}", f"give at most {MOST}")
        most = FARTHEST_OUT * self.pitch_radius
        if max((abs(z) for z in points), default=0.0) <= self.pitch_radius:
            raise DesignError(
                "points",
                f"none lies outside the pitch circle of {self.pitch_radius:.5g} mm",
                "give them from the bottom land out to the tip, across the pitch circle",
            )
        far = [k for k, z in enumerate(points) if abs(z) > most]
        if far:
            raise DesignError(
                "points",
                f"point {far[0] + 1} lies {abs(points[far[0]]):.5g} mm from the axis, with a pitch circle of "
                f"{self.pitch_radius:.5g} mm",
                f"give points within {most * (1 - 1e-5):.6g} mm of the axis",
            )

    @property
    def pitch_radius(self) -> float:
        """Radius of the pitch circle, mm."""
        return self.module * self.teeth / 2

    @cached_property
    def flank(self) -> AbstractCurve:
        """The spline through the points."""
        return Spline(np.array(self.points, dtype=complex))

    @cached_property
    def gear(self) -> FlankGear:
        """The same as a gear given by its flank."""
        try:
            return FlankGear(self.flank, self.teeth, self.pitch_radius)
        except DesignError as error:
            raise DesignError("points", error.problem, error.remedy) from None

    @property
    def outline(self) -> AbstractCurve:
        """The whole gear as one closed counterclockwise curve."""
        return self.gear.outline
