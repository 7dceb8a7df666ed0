"""Motors that drive a part by their shaft: the plate that each is screwed to, and what is bought for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arguments import Positive, checked
from ..brief import one_line
from ..part import HoleFit, Part
from ..plane.primitives import Circle, rounded_hull
from ..sizes import Length
from .fasteners import LENGTHS, SIZES

MotorName = Literal["nema17"]


@dataclass(frozen=True)
class Motor:
    """The face of a motor; all in mm.

    called: in the bill. side: of the square face; apart: screws, along its sides; pilot: diameter of the boss round the
    shaft; thread: of the screws, and hole: what they pass; reach: least and largest depth in the motor's threads.
    """

    called: str
    side: float
    apart: float
    pilot: float
    thread: float
    hole: float
    reach: tuple[float, float]

    __repr__ = one_line

    def screw(self, thickness: float) -> str:
        """The screw through a plate so thick, mm."""
        least, most = (thickness + depth for depth in self.reach)
        size = SIZES[self.thread]
        fitting = [length for length in LENGTHS if max(least, size.lengths[0]) <= length <= min(most, size.lengths[1])]
        if not fitting:
            return f"M{self.thread:g} screw, {least:g} to {most:g} mm under its head"
        return f"M{self.thread:g} x {fitting[-1]:g} {size.screw}"


# Source: NEMA ICS 16 for side, screws and boss, and for the depth of threads what makers draw (4.5 mm); holes for
# screws by ISO 273, medium. Another number here, and the motor does not fit its plate.
MOTORS: dict[str, Motor] = {"nema17": Motor("NEMA 17", 42.3, 31.0, 22.0, 3.0, 3.4, (2.0, 4.5))}
# mm. Corners of the plate, about as round as the motor's own; rounder ones come near the screws.
CORNER = 4.0


@checked
def motor_plate(motor: MotorName, thickness: Positive, clearance: Length = 0.0) -> Part:
    """The plate that a motor is screwed to, as large as its face, about its shaft.

    clearance: how much wider than the motor's boss the hole for it is, mm. Of the body `motor`, which stands still.
    """
    face = MOTORS[motor]
    corners = np.array([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j])
    outline = rounded_hull((face.side / 2 - CORNER) * corners, CORNER)
    screws = (Circle(complex(z), face.hole / 2) for z in face.apart / 2 * corners)
    holes = (Circle(0j, (face.pilot + clearance) / 2), *screws)
    fits = (HoleFit(face.pilot, clearance), *(4 * (HoleFit(face.thread, face.hole - face.thread),)))
    return Part("motor_plate", outline, holes, thickness, body="motor", fits=fits)
