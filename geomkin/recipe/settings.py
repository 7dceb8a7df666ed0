"""Tables that recipes of several kinds share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..errors import DesignError
from ..plane.vec import Array
from ..sizes import FARTHEST, check_sizes, entry, quantity

Format = Literal["dxf", "stl", "svg", "csv"]


@dataclass(frozen=True)
class Files:
    """What is written, and how true to the exact curves."""

    write: tuple[Format, ...] = entry("files to write", default=("dxf", "stl", "svg", "csv"))
    tolerance: float = quantity(
        "largest distance between a curve and its chords", "mm", default=0.005, at_least=1e-6, at_most=10
    )
    curves: Literal["chords", "arcs"] = entry(
        "outlines in DXF and SVG as chords, which every program reads, or as arcs, a tenth of the points",
        default="chords",
    )
    kerf: float = quantity(
        "width of the cut; DXF and SVG move outlines out and holes in by half of it",
        "mm",
        default=0.0,
        at_least=0,
        at_most=20,
    )

    def __post_init__(self) -> None:
        check_sizes(self)


@dataclass(frozen=True)
class Drive:
    """How a cam turns, and how finely its motion is told."""

    speed_rpm: float = quantity("speed of the driver", "rpm", default=60.0, at_least=0.001, at_most=1e6)
    # Of smaller steps a turn has ten times as many rows: ten seconds, and 70 MB of text.
    step_deg: float = quantity(
        "driver's turn between rows of the motion table", "deg", default=1.0, at_least=0.01, at_most=90
    )

    def __post_init__(self) -> None:
        check_sizes(self)

    @property
    def speed(self) -> float:
        """rad/s."""
        return self.speed_rpm * np.pi / 30

    @property
    def angles(self) -> Array:
        """Driver angles over one turn, rad, both ends included, in equal steps no larger than asked."""
        return np.linspace(0, 2 * np.pi, int(np.ceil(360 / self.step_deg - 1e-9)) + 1)


@dataclass(frozen=True)
class Turn:
    """How a linkage's driver turns, and how finely its motion is told."""

    speed_rpm: float = quantity("speed of the driver", "rpm", default=60.0, at_least=0.001, at_most=1e6)
    step_deg: float = quantity(
        "driver's turn between rows of the motion table", "deg", default=1.0, at_least=0.001, at_most=90
    )
    start_deg: float = quantity("driver's first angle", "deg", default=0.0, at_least=-3600, at_most=3600)
    end_deg: float = quantity("driver's last angle", "deg", default=360.0, at_least=-3600, at_most=3600)

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.end_deg <= self.start_deg:
            raise DesignError("end_deg", f"found {self.end_deg:g}", f"give more than {self.start_deg:g}, the start")

    @property
    def speed(self) -> float:
        """rad/s."""
        return self.speed_rpm * np.pi / 30

    @property
    def frames(self) -> Array:
        """Driver angles, rad, both ends included, in equal steps no larger than asked."""
        return self._in_steps(self.step_deg)

    @property
    def fine(self) -> Array:
        """The same in steps in which nothing slips through between two plates."""
        return self._in_steps(min(self.step_deg, 1.0))

    def _in_steps(self, step: float) -> Array:
        turn = self.end_deg - self.start_deg
        count = int(np.ceil(turn / step - 1e-9)) + 1
        return np.linspace(np.radians(self.start_deg), np.radians(self.end_deg), count)


@dataclass(frozen=True)
class Stroke:
    """How a sliding driver moves, and how finely its motion is told."""

    start: float = quantity(
        "driver's first place along its line", "mm", at_least=-FARTHEST, at_most=FARTHEST, example=70
    )
    end: float = quantity("driver's last place", "mm", at_least=-FARTHEST, at_most=FARTHEST, example=110)
    speed: float = quantity("speed of the driver", "mm/s", default=50.0, at_least=1e-6, at_most=FARTHEST)
    step: float = quantity(
        "driver's way between rows of the motion table", "mm", default=1.0, above=0, at_most=FARTHEST
    )

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.end <= self.start:
            raise DesignError("end", f"found {self.end:g}", f"give more than {self.start:g}, the start")
        if (self.end - self.start) / self.step > MOST_FRAMES:
            raise DesignError(
                "step",
                f"found {self.step:g} mm for {self.end - self.start:g} mm",
                f"give at least {(self.end - self.start) / MOST_FRAMES:.3g} mm",
            )

    @property
    def frames(self) -> Array:
        """Driver places, mm, both ends included, in equal steps no larger than asked."""
        return self._in_steps(self.step)

    @property
    def fine(self) -> Array:
        """The same in steps in which nothing slips through between two plates."""
        return self._in_steps(min(self.step, (self.end - self.start) / 180))

    def _in_steps(self, step: float) -> Array:
        return np.linspace(self.start, self.end, int(np.ceil((self.end - self.start) / step - 1e-9)) + 1)


# Rows of a motion table: more take minutes to write, and no program opens them.
MOST_FRAMES = 400_000
