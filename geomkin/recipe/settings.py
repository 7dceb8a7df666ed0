"""Tables that recipes of several kinds share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..plane.vec import Array
from ..sizes import check_sizes, entry, quantity

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
    """How the driver turns, and how finely its motion is told."""

    speed_rpm: float = quantity("speed of the driver", "rpm", default=60.0, at_least=0.001, at_most=1e6)
    step_deg: float = quantity(
        "driver's turn between rows of the motion table", "deg", default=1.0, at_least=0.001, at_most=90
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
