"""Lantern pinions: teeth that are round pins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arguments import checked
from ...errors import DesignError
from ...plane.curve import AbstractCurve, Mirrored, Moved, Reversed
from ...plane.joined import Path
from ...plane.primitives import Arc, Circle, Segment
from ...plane.vec import Pose
from ...sizes import Length, check_sizes, quantity, rounded_down
from ..contract import AbstractShaper
from ..module import Settled, diametral_pitch, module, settle_module


@dataclass(frozen=True)
class LanternPinion(AbstractShaper):
    """Round pins on a circle about the origin, one of them on +y, held between two discs.

    Raises DesignError where neighbouring pins meet.
    """

    pins: int = quantity("number of pins", whole=True, at_least=4, at_most=1000, example=12)
    module: Settled = module("pin circle's diameter per pin", example=4)
    pin_diameter: Settled = quantity("diameter of the pins", "mm", default=None, above=0, at_most=1e5, example=5)
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        check_sizes(self)
        settle_module(self)
        if self.pin_diameter is None:
            raise DesignError("pin_diameter", "is missing", f"give it in mm, about {1.25 * self.module:.3g}")
        chord = 2 * self.pitch_radius * np.sin(np.pi / self.pins)
        if self.pin_diameter >= chord:
            raise DesignError(
                "pin_diameter",
                f"found {self.pin_diameter:g} mm, but neighbouring pins are {chord:.4g} mm apart",
                f"give less than {rounded_down(chord)} mm, about {chord / 2:.3g}",
            )

    @property
    def teeth(self) -> int:
        """Number of pins."""
        return self.pins

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle through the pins' centres, which rolls on the wheel's pitch circle, mm."""
        return self.module * self.pins / 2

    @property
    def pin(self) -> AbstractCurve:
        """The pin on +y, counterclockwise from its innermost point, as four quarters."""
        return self.cutter(0.0)

    @property
    def circles(self) -> tuple[Circle, ...]:
        """All pins."""
        places = 1j * self.pitch_radius * np.exp(2j * np.pi * np.arange(self.pins) / self.pins)
        return tuple(Circle(complex(z), self.pin_diameter / 2) for z in places)

    @property
    def most_backlash(self) -> float:
        """Backlash, mm, for which neighbouring pins of the wheel's cutter meet."""
        pin = float(np.arcsin(self.pin_diameter / 2 / self.pitch_radius))
        return 2 * self.pitch_radius * (np.pi / self.pins - pin)

    @checked
    def cutter(self, clearance: Length, backlash: Length = 0.0) -> AbstractCurve:
        """What cuts a wheel: the pin drawn out and made thicker, counterclockwise from its innermost point.

        Piece 0 is the quarter that drives, from the innermost point to the rightmost. clearance: room at the wheel's
        roots, mm, by which the pin is drawn out along the radius. backlash: play of the pair, mm along the pitch
        circle, for which the two halves are turned apart about the pinion's axis, each by
        backlash / (2 pitch_radius), and joined by arcs about it. The pin itself touches where its turned half does,
        when the pinion has turned less by that angle, counterclockwise, for the right-hand half, and more for the left.
        """
        if backlash >= self.most_backlash:
            raise DesignError(
                "backlash",
                f"found {backlash:.5g} mm, which leaves nothing of the wheel between two pins",
                f"give at most {self.most_backlash * (1 - 1e-5):.6g}",
            )
        centre, radius, turn = 1j * self.pitch_radius, self.pin_diameter / 2, 0.5 * backlash / self.pitch_radius
        right: list[AbstractCurve] = [Arc(centre, centre - 1j * radius, np.pi / 2)]
        if clearance > 0:
            right.append(Segment(centre + radius, centre + radius + 1j * clearance))
        right.append(Arc(centre + 1j * clearance, centre + 1j * clearance + radius, np.pi / 2))
        if backlash > 0:
            right = [Moved(curve, Pose(0j, np.exp(-1j * turn))) for curve in right]
        left = [Reversed(Mirrored(curve)) for curve in reversed(right)]
        if backlash == 0:
            return Path((*right, *left))
        outer, inner = right[-1].point(right[-1].breaks[-1]), left[-1].point(left[-1].breaks[-1])
        return Path((*right, Arc(0j, complex(outer), 2 * turn), *left, Arc(0j, complex(inner), -2 * turn)))
