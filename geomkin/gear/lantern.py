"""Lantern pinions: teeth that are round pins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..plane.joined import Path
from ..plane.primitives import Arc, Circle, Segment
from ..sizes import check_sizes, quantity


@dataclass(frozen=True)
class LanternPinion:
    """Round pins on a circle about the origin, one of them on +y, held between two discs."""

    pins: int = quantity("number of pins", whole=True, at_least=4, at_most=1000, example=12)
    module: float = quantity("pin circle's diameter per pin", "mm", above=0, at_most=1e5, example=4)
    pin_diameter: float = quantity("diameter of the pins", "mm", above=0, at_most=1e5, example=5)

    def __post_init__(self) -> None:
        check_sizes(self)
        chord = 2 * self.pitch_radius * np.sin(np.pi / self.pins)
        if self.pin_diameter >= chord:
            raise DesignError(
                "pin_diameter",
                f"found {self.pin_diameter:g} mm, but neighbouring pins are {chord:.4g} mm apart",
                f"give less than {chord:.4g} mm, about {chord / 2:.3g}",
            )

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle through the pins' centres, which rolls on the wheel's pitch circle, mm."""
        return self.module * self.pins / 2

    @property
    def pin(self) -> AbstractCurve:
        """The pin on +y, counterclockwise, as its lower and its upper half."""
        return self.cutter(0.0)

    @property
    def circles(self) -> tuple[Circle, ...]:
        """All pins."""
        places = 1j * self.pitch_radius * np.exp(2j * np.pi * np.arange(self.pins) / self.pins)
        return tuple(Circle(complex(z), self.pin_diameter / 2) for z in places)

    def cutter(self, clearance: float) -> AbstractCurve:
        """What cuts a wheel with room at its roots: the pin drawn out by `clearance`, mm, along the radius."""
        centre, radius = 1j * self.pitch_radius, self.pin_diameter / 2
        lower = Arc(centre, centre - radius, np.pi)
        upper = Arc(centre + 1j * clearance, centre + 1j * clearance + radius, np.pi)
        if clearance == 0:
            return Path((lower, upper))
        return Path(
            (
                lower,
                Segment(centre + radius, centre + radius + 1j * clearance),
                upper,
                Segment(centre + 1j * clearance - radius, centre - radius),
            )
        )
