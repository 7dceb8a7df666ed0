"""Motors that drive a part: their dimensions, mounting plates and screws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from ..core.arguments import PositiveFloat, checked
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
    """Dimensions of a motor's face, mm.

    product: its name in the bill. face_width: of the square face. screw_spacing: along the sides of the face.
    boss_diameter, boss_height: of the boss round the shaft. shaft: diameter of the D-shaft. thread: of the screws.
    screw_hole: clearance hole of a screw. thread_depth: least and largest depth of the screws in the motor.
    """

    product: str
    face_width: float
    screw_spacing: float
    boss_diameter: float
    boss_height: float
    shaft: float
    thread: float
    screw_hole: float
    thread_depth: tuple[float, float]

    def screw(self, thickness: float, sunk: bool = False) -> str:
        """The screw through a plate of a thickness, mm. sunk: countersunk; its length then includes the head."""
        least, most = (thickness + depth for depth in self.thread_depth)
        name, lengths = (SUNK, SUNK_LENGTHS) if sunk else (SIZES[self.thread].screw, SIZES[self.thread].lengths)
        fitting = [length for length in LENGTHS if max(least, lengths[0]) <= length <= min(most, lengths[1])]
        if not fitting:
            product = "countersunk screw" if sunk else "screw"
            return f"M{self.thread:g} {product}, {least:g} to {most:g} mm {'long' if sunk else 'under its head'}"
        return f"M{self.thread:g} x {fitting[-1]:g} {name}"

    def holes(self, clearance: float, place: complex = 0j) -> tuple[Circle, ...]:
        """Holes round a centre for the boss, wider by the clearance, mm, and for the screws."""
        screws = (Circle(complex(place + z), self.screw_hole / 2) for z in self.screw_spacing / 2 * CORNERS)
        return Circle(place, (self.boss_diameter + clearance) / 2), *screws

    def fits(self, clearance: float) -> tuple[HoleFit, ...]:
        """The fits of these holes."""
        screw = HoleFit(self.thread, self.screw_hole - self.thread)
        return HoleFit(self.boss_diameter, clearance), *(len(CORNERS) * (screw,))

    def corners(self, place: complex = 0j, inset: float = 0.0) -> Complex:
        """Corners of the face round a centre, mm, moved inwards by the inset."""
        return place + (self.face_width / 2 - inset) * CORNERS

    def check_plate(self, name: MotorName, thickness: float, key: str) -> None:
        """Refuse a plate from which the boss or the heads of the screws would project: a wheel turns on it."""
        if thickness < (least := max(self.boss_height, SUNK_HEIGHT)):
            raise DesignError(
                key,
                f"found {name}, whose boss is {self.boss_height:g} mm high, under a plate {thickness:g} mm thick",
                f"give a thickness of at least {least:g} mm, or omit the motor",
            )


# Countersunk screws, for plates on which others turn. Source: ISO 7046 for lengths and height, mm, of M3.
SUNK, SUNK_LENGTHS, SUNK_HEIGHT = "countersunk screw ISO 7046", (4, 30), 1.65
# Corners of a square of side 2 about 0.
CORNERS = np.array([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j])
# Sources: NEMA ICS 16 for the face, the screws and the diameter of the boss; makers' drawings for its height, the shaft
# and the depth of the threads (4.5 mm); screw holes by ISO 273, medium. With other numbers the motor does not fit.
MOTORS: dict[str, Motor] = {"nema17": Motor("NEMA 17", 42.3, 31.0, 22.0, 2.0, 5.0, 3.0, 3.4, (2.0, 4.5))}
# Corner radius of the plate, mm, about that of the motor's face; larger ones come close to the screws.
CORNER = 4.0


def fixed_under(plate: str, letter: str) -> str:
    """The first step of an assembly with a motor under a plate; letter: of its shaft."""
    screws = "with its 4 countersunk screws from above, heads flush"
    return f"fix the motor under {plate}, its shaft up through {letter}, {screws}"


def plate_radius(motor: MotorName) -> float:
    """Radius round the shaft that contains the motor's plate, mm."""
    return float(np.abs(MOTORS[motor].corners(inset=CORNER)).max()) + CORNER


@checked
def motor_plate(motor: MotorName, thickness: PositiveFloat, clearance: Length = 0.0) -> Part:
    """The mounting plate of a motor, as large as its face, with the shaft at the origin.

    Parameters
    ----------
    motor : {"nema17"}
        The motor.
    thickness : float
        Thickness of the plate, mm, above 0.
    clearance : float, optional
        How much wider the hole is than the motor's boss, mm.

    Returns
    -------
    Part
        Of the fixed body `motor`.

    Examples
    --------
    >>> plate = gk.making.motor_plate("nema17", thickness=5.0)
    >>> len(plate.holes)
    5
    """
    face = MOTORS[motor]
    outline = rounded_hull(face.corners(inset=CORNER), CORNER)
    holes, fits = face.holes(clearance), face.fits(clearance)
    return Part("motor_plate", outline, holes, thickness, body="motor", fits=fits)


MOTOR = "motor"


def split_motor_parts(parts: Sequence[Part]) -> tuple[tuple[Part, ...], tuple[Part, ...]]:
    """All parts of a mechanism except those of the motor, and those of the motor."""
    return tuple(p for p in parts if p.body != MOTOR), tuple(p for p in parts if p.body == MOTOR)


def with_motor_plate(bodies: tuple[SceneBody, ...], plates: tuple[Part, ...]) -> tuple[SceneBody, ...]:
    """The bodies one layer higher, above a motor's plates about the origin; unchanged without such plates."""
    if not plates:
        return bodies
    one = np.ones(bodies[0].origin.shape, dtype=complex)
    motor = SceneBody(MOTOR, plates, 0 * one, one, 0, True)
    return (motor, *(replace(body, layer=body.layer + 1) for body in bodies))
