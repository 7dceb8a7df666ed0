"""Motors that drive a part: their torque and speed, dimensions, mounting plates and screws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import Length, entry
from ..core.records import record
from ..model.check import Check
from ..model.motor import Motor, MotorDuty
from ..model.part import HoleFit, Part
from ..model.scene import SceneBody
from ..plane.primitives import Circle, rounded_hull
from ..plane.vec import Complex
from .fasteners import LENGTHS, SIZES
from .named import NamedIn

MotorName = Literal["nema17"]


@record
class MotorFace:
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
MOTOR_FACES: dict[str, MotorFace] = {"nema17": MotorFace("NEMA 17", 42.3, 31.0, 22.0, 2.0, 5.0, 3.0, 3.4, (2.0, 4.5))}
# Corner radius of the plate, mm, about that of the motor's face; larger ones come close to the screws.
CORNER = 4.0


# Least margin of a motor that `smallest_motor` chooses; chosen here, for friction and loads that are not stated.
LEAST_MOTOR_MARGIN = 1.5
# Shares of the greatest torque: direct-current motors and servos heat up if they supply more than a quarter of their
# torque at standstill for long (makers' advice); steppers supply about half of the holding torque up to 300 rpm.
LASTING, STEPPING, STEPPER_RPM = 0.25, 0.5, 300.0


def _stepper(name: str, holding_torque: float, mass: float, source: str) -> Motor:
    torque = STEPPING * holding_torque
    return Motor(name, torque, STEPPER_RPM, torque, mass, constant_torque=True, source=source)


def _brushed(name: str, stall: float, speed_rpm: float, mass: float, source: str, most: float = np.inf) -> Motor:
    """most: lasting torque that the gears carry, N mm."""
    return Motor(name, stall, speed_rpm, min(LASTING * stall, most), mass, source=source)


def _servo(name: str, stall: float, seconds_per_60_deg: float, mass: float, source: str) -> Motor:
    return Motor(name, stall, 10 / seconds_per_60_deg, LASTING * stall, mass, range_deg=180, source=source)


# Typical values, N mm, rpm and g, for a first choice. Torques at standstill are extrapolated by the makers; sellers of
# servos claim up to 1.6 times as much. Masses are rounded.
MOTORS: dict[str, Motor] = {
    "sg90": _servo("SG90 servo, 4.8 V", 118, 0.12, 9, "sellers' pages, the lowest torque"),
    "n20-100": _brushed("N20 gear motor 100:1, 6 V", 73, 130, 10, "Pololu micro metal gearmotor, LP 6 V"),
    "n20-298": _brushed("N20 gear motor 298:1, 6 V", 196, 45, 10, "Pololu micro metal gearmotor, LP 6 V"),
    "tt": _brushed("TT gear motor 1:48, 6 V", 39, 200, 30, "sellers' pages"),
    "28byj-48": Motor(
        "28BYJ-48 geared stepper, 5 V", 34.3, 15, 34.3, 35, constant_torque=True,
        source="makers' sheets: pull-in torque at 120 steps per second",
    ),
    "mg996r": _servo("MG996R servo, 4.8 V", 920, 0.17, 55, "sellers' pages, at 4.8 V"),
    "25d-4": _brushed("25 mm gear motor 4.4:1, 6 V", 118, 2200, 90, "Pololu 25D, HP 6 V"),
    "25d-75": _brushed("25 mm gear motor 75:1, 12 V", 696, 75, 100, "Pololu 25D, LP 12 V"),
    "nema17-short": _stepper("NEMA 17 stepper, 20 mm long", 160, 130, "StepperOnline 17HS08"),
    "nema14": _stepper("NEMA 14 stepper, 34 mm long", 180, 180, "StepperOnline 14HS13-0804S"),
    "37d-19": _brushed("37 mm gear motor 19:1, 12 V", 834, 530, 185, "Pololu 37D, 12 V", 981),
    "37d-30": _brushed("37 mm gear motor 30:1, 12 V", 1373, 330, 190, "Pololu 37D, 12 V", 981),
    "37d-50": _brushed("37 mm gear motor 50:1, 12 V", 2059, 200, 195, "Pololu 37D, 12 V", 981),
    "nema17": _stepper("NEMA 17 stepper, 48 mm long", 590, 400, "StepperOnline 17HS19-2004S1"),
    "nema17-long": _stepper("NEMA 17 stepper, 60 mm long", 650, 500, "StepperOnline 17HS24"),
    "nema23": _stepper("NEMA 23 stepper, 56 mm long", 1240, 700, "StepperOnline 23HS22-2804S"),
}  # fmt: skip
_NAMED = NamedIn(MOTORS, "motor")
# Field type of a motor in the tables of a recipe.
MotorKey = Annotated[Motor | None, _NAMED]


def motor(name: str) -> Motor:
    """A motor of the table.

    Parameters
    ----------
    name : str
        Such as "nema17"; `MOTORS` lists all.

    Returns
    -------
    Motor

    Raises
    ------
    DesignError
        If there is no such motor.

    Examples
    --------
    >>> gk.making.motor("37d-30").torque_n_mm
    1373
    """
    found: Motor = _NAMED.find(name)
    return found


@checked
def smallest_motor(duty: MotorDuty, margin: PositiveFloat = LEAST_MOTOR_MARGIN) -> Motor | None:
    """The lightest motor of the table that supplies a torque and its speed.

    Parameters
    ----------
    duty : MotorDuty
        Required torque and speed, such as `forces(motion, loads).duty`.
    margin : float, optional
        Least ratio of the torque that the motor supplies to the required one, as in `Motor.margin`.

    Returns
    -------
    Motor or None
        None if no motor of the table suffices.

    Notes
    -----
    The motor turns the driver directly, without further gears. Its own inertia is not considered.

    Examples
    --------
    >>> import numpy as np
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 181), speed=5.0)
    >>> result = gk.forces(motion, gk.Loads(forces=[gk.Force("rocker", "rocker_pin", -10j)]))
    >>> gk.making.smallest_motor(result.duty).name
    '37 mm gear motor 19:1, 12 V'
    """
    suitable = [motor for motor in MOTORS.values() if motor.margin(duty) >= margin]
    return min(suitable, key=lambda motor: motor.mass_g, default=None)


def motor_entry(item: str) -> Any:
    """The field for the motor that drives an item."""
    words = f"{', '.join(MOTORS)}, or a table of values; by default the lightest of these that suffices"
    return entry(f"motor on the shaft of {item}: {words}", default=None)


def motor_check(motor: Motor, duty: MotorDuty, column: str = "", at: float | None = None) -> Check:
    """Check that a motor supplies the torque and speed of its duty, by the margin of `smallest_motor`.

    column, at: id of the torque's column, and where the driver is at its peak, as in `Check`.
    """
    better = smallest_motor(duty)
    key = next((key for key, known in MOTORS.items() if known == better), None)
    advice = f'give motor = "{key}" ({better.name})' if better else "no motor of the table suffices"
    name = f"torque of the {motor.name} to that required"
    limit = LEAST_MOTOR_MARGIN
    return Check("motor_torque", name, motor.margin(duty), "at least", limit, "", advice, column, at)


def motor_summary(motor: Motor, duty: MotorDuty) -> dict[str, object]:
    """A motor and its margin, as an entry of the summary."""
    key = next((key for key, known in MOTORS.items() if known == motor), None)
    named: dict[str, object] = {"motor": key} if key else {}
    return {**named, "name": motor.name, "margin": float(f"{motor.margin(duty):.6g}")}


def fixed_under(plate: str, letter: str) -> str:
    """The first step of an assembly with a motor under a plate; letter: of its shaft."""
    screws = "with its 4 countersunk screws from above, heads flush"
    return f"fix the motor under {plate}, its shaft up through {letter}, {screws}"


def plate_radius(motor: MotorName) -> float:
    """Radius round the shaft that contains the motor's plate, mm."""
    return float(np.abs(MOTOR_FACES[motor].corners(inset=CORNER)).max()) + CORNER


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
    face = MOTOR_FACES[motor]
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
