"""Motors that drive a part by their shaft: the plate that each is screwed to, and what is bought for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from ..core.arguments import Positive, checked
from ..core.errors import DesignError
from ..core.fields import Length
from ..core.records import record
from ..model.part import HoleFit, Part
from ..model.scene import SceneBody
from ..plane.primitives import Circle, rounded_hull
from ..plane.vec import Complex
from .fasteners import LENGTHS, SIZES

MotorName = Literal["nema17"]


@record
class Motor:
    """The face of a motor; all in mm.

    called: in the bill. side: of the square face; apart: screws, along its sides; pilot: diameter of the boss round the
    shaft, and boss: its height; shaft: diameter of the D-shaft; thread: of the screws, and hole: what they pass; reach:
    least and largest depth in the motor's threads.
    """

    called: str
    side: float
    apart: float
    pilot: float
    boss: float
    shaft: float
    thread: float
    hole: float
    reach: tuple[float, float]

    def screw(self, thickness: float, sunk: bool = False) -> str:
        """The screw through a plate so thick, mm. sunk: its head lies in the plate, and its length is told with it."""
        least, most = (thickness + depth for depth in self.reach)
        name, lengths = (SUNK, SUNK_LENGTHS) if sunk else (SIZES[self.thread].screw, SIZES[self.thread].lengths)
        fitting = [length for length in LENGTHS if max(least, lengths[0]) <= length <= min(most, lengths[1])]
        if not fitting:
            called = "countersunk screw" if sunk else "screw"
            return f"M{self.thread:g} {called}, {least:g} to {most:g} mm {'long' if sunk else 'under its head'}"
        return f"M{self.thread:g} x {fitting[-1]:g} {name}"

    def holes(self, clearance: float, place: complex = 0j) -> tuple[Circle, ...]:
        """For the boss, as much wider as the clearance, mm, about a place, and for the screws."""
        screws = (Circle(complex(place + z), self.hole / 2) for z in self.apart / 2 * CORNERS)
        return Circle(place, (self.pilot + clearance) / 2), *screws

    def fits(self, clearance: float) -> tuple[HoleFit, ...]:
        """How boss and screws sit in these holes."""
        return HoleFit(self.pilot, clearance), *(len(CORNERS) * (HoleFit(self.thread, self.hole - self.thread),))

    def corners(self, place: complex = 0j, inset: float = 0.0) -> Complex:
        """Of the face about a place, mm, moved in from both sides by the inset."""
        return place + (self.side / 2 - inset) * CORNERS

    def check_plate(self, name: MotorName, thickness: float, key: str) -> None:
        """Refuse a plate, mm thick, that something turns on and that boss or heads would stand out of."""
        if thickness < (least := max(self.boss, SUNK_HEIGHT)):
            raise DesignError(
                key,
                f"found {name}, whose boss is {self.boss:g} mm high, under a plate {thickness:g} mm thick",
                f"give a thickness of at least {least:g} mm, or leave it out",
            )


# What lies in a plate so that others turn on it. Source: ISO 7046 for lengths and height, mm, of M3.
SUNK, SUNK_LENGTHS, SUNK_HEIGHT = "countersunk screw ISO 7046", (4, 30), 1.65
# Of a square, from its middle, in halves of its side.
CORNERS = np.array([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j])
# Source: NEMA ICS 16 for side, screws and the boss's width; what makers draw for its height, shaft and depth of
# threads (4.5 mm); holes for screws by ISO 273, medium. Another number here, and the motor does not fit its plate.
MOTORS: dict[str, Motor] = {"nema17": Motor("NEMA 17", 42.3, 31.0, 22.0, 2.0, 5.0, 3.0, 3.4, (2.0, 4.5))}
# mm. Corners of the plate, about as round as the motor's own; rounder ones come near the screws.
CORNER = 4.0


def fixed_under(plate: str, letter: str) -> str:
    """The step that puts a motor under a plate that others turn on, before any is laid; letter: of its shaft."""
    sunk = "by its 4 countersunk screws from above, their heads sunk in it"
    return f"fix the motor under {plate}, its shaft up through {letter}, {sunk}"


def plate_radius(motor: MotorName) -> float:
    """Radius, mm, about the shaft within which the motor's own plate lies."""
    return float(np.abs(MOTORS[motor].corners(inset=CORNER)).max()) + CORNER


@checked
def motor_plate(motor: MotorName, thickness: Positive, clearance: Length = 0.0) -> Part:
    """The plate that a motor is screwed to, as large as its face, about its shaft.

    clearance: how much wider than the motor's boss the hole for it is, mm. Of the body `motor`, which stands still.
    """
    face = MOTORS[motor]
    outline = rounded_hull(face.corners(inset=CORNER), CORNER)
    holes, fits = face.holes(clearance), face.fits(clearance)
    return Part("motor_plate", outline, holes, thickness, body="motor", fits=fits)


MOTOR = "motor"


def apart(parts: Sequence[Part]) -> tuple[tuple[Part, ...], tuple[Part, ...]]:
    """Parts that turn or hold, and those of the motor."""
    return tuple(p for p in parts if p.body != MOTOR), tuple(p for p in parts if p.body == MOTOR)


def on_motor(bodies: tuple[SceneBody, ...], plates: tuple[Part, ...]) -> tuple[SceneBody, ...]:
    """The bodies on a motor's plates, which lie under all of them about the origin; as they were where it has none."""
    if not plates:
        return bodies
    still = np.ones(bodies[0].origin.shape, dtype=complex)
    motor = SceneBody(MOTOR, plates, 0 * still, still, 0, True)
    return (motor, *(replace(body, layer=body.layer + 1) for body in bodies))
