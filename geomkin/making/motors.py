"""Motors that drive a mechanism: torque and speed, the smallest one that suffices, and the plate for each of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal

import numpy as np

from ..core.arguments import ArgumentType, PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import FARTHEST, ComplexPoint, Length, entry, inside, quantity, to_digits, to_digits_or_none
from ..core.records import record
from ..core.units import bare_mm, mm
from ..model.check import Check, Suggestion
from ..model.motor import RPM, Motor, MotorDuty
from ..model.part import HoleFit, Part
from ..model.scene import SceneBody
from ..plane.primitives import Circle, rounded_hull
from ..plane.vec import Complex, Real
from .fasteners import LENGTHS, SIZES, ThreadDiameter
from .materials import NamedIn

# Least margin of a motor that `smallest_motor` chooses, for friction and loads that are not stated; chosen here.
LEAST_MOTOR_MARGIN = 1.5
# Least length over which a shaft is engaged, in diameters: with less a crank or gear tilts on it; chosen here.
LEAST_ENGAGEMENT = 1.0
# Distance of a gear from the plate of its motor, mm: above the heads of the screws.
HEADS = 2.0
# Shares of the greatest torque: direct-current motors heat up if they supply more than a quarter of their torque at
# standstill for long (Pololu's advice for its gear motors; for servos chosen here). That steppers supply half of their
# holding torque up to 300 rpm is chosen here: their data sheets show it for some drivers and voltages only.
LASTING, STEPPING, STEPPER_RPM = 0.25, 0.5, 300.0


def _stepper(name: str, holding_torque: float, mass: float, source: str) -> Motor:
    torque = STEPPING * holding_torque
    return Motor(name, torque, STEPPER_RPM, torque, mass, constant_torque=True, source=source)


def _brushed(
    name: str, stall: float, speed_rpm: float, mass: float, source: str, electric: tuple[float, float, float] | None,
    most: float = np.inf,
) -> Motor:  # fmt: skip
    """electric: voltage, V, and currents without load and at standstill, A. most: lasting torque of its gears, N mm."""
    values = electric or (None, None, None)
    return Motor(name, stall, speed_rpm, min(LASTING * stall, most), mass, False, None, source, *values)


def _servo(name: str, stall: float, seconds_per_60_deg: float, mass: float, source: str) -> Motor:
    return Motor(name, stall, 10 / seconds_per_60_deg, LASTING * stall, mass, range_deg=180, source=source)


# Voltage, and currents without load and at standstill, by the data sheets. The lasting torque of gears of 37 mm,
# 10 kgf cm, is that of their sheet for continuous loads.
N20, GEAR_37 = (6.0, 0.02, 0.36), (12.0, 0.2, 5.5)
# Typical values, N mm, rpm and g, for a first choice. Torques at standstill are extrapolated by the makers; sellers of
# servos claim up to 1.6 times as much. Masses are rounded.
MOTORS: dict[str, Motor] = {
    "sg90": _servo("SG90 servo, 4.8 V", 118, 0.12, 9, "sellers' pages: 1.2 to 1.8 kgf cm, the lowest"),
    "n20-100": _brushed("N20 gear motor 100:1, 6 V", 73, 130, 10, "Pololu micro metal data sheet, LP 6 V", N20),
    "n20-298": _brushed("N20 gear motor 298:1, 6 V", 196, 45, 10, "Pololu micro metal data sheet, LP 6 V", N20),
    "tt": _brushed("TT gear motor 1:48, 6 V", 39, 200, 30, "sellers' pages: 0.4 kgf cm, 90 to 200 rpm", None),
    "28byj-48": Motor(
        "28BYJ-48 geared stepper, 5 V", 34.3, 15, 34.3, 35, constant_torque=True,
        source="makers' sheets: pull-in torque at 120 steps per second",
    ),
    "mg996r": _servo("MG996R servo, 4.8 V", 920, 0.17, 55, "Tower Pro data sheet: 9.4 kgf cm at 4.8 V"),
    "25d-4": _brushed("25 mm gear motor 4.4:1, 6 V", 118, 2200, 90, "Pololu 25D data sheet, HP 6 V", (6, 0.5, 6)),
    "25d-75": _brushed("25 mm gear motor 75:1, 12 V", 696, 75, 100, "Pololu 25D data sheet, LP 12 V", (12, 0.06, 0.9)),
    "nema17-short": _stepper("NEMA 17 stepper, 20 mm long", 160, 130, "StepperOnline 17HS08-1004S data sheet"),
    "nema14": _stepper("NEMA 14 stepper, 34 mm long", 180, 180, "StepperOnline 14HS13-0804S data sheet"),
    "37d-19": _brushed("37 mm gear motor 19:1, 12 V", 834, 530, 185, "Pololu 37D data sheet, 12 V", GEAR_37, 981),
    "37d-30": _brushed("37 mm gear motor 30:1, 12 V", 1373, 330, 190, "Pololu 37D data sheet, 12 V", GEAR_37, 981),
    "37d-50": _brushed("37 mm gear motor 50:1, 12 V", 2059, 200, 195, "Pololu 37D data sheet, 12 V", GEAR_37, 981),
    "nema17": _stepper("NEMA 17 stepper, 48 mm long", 590, 400, "StepperOnline 17HS19-2004S1 data sheet"),
    "nema17-long": _stepper("NEMA 17 stepper, 60 mm long", 650, 500, "StepperOnline 17HS24 data sheet"),
    "nema23": _stepper("NEMA 23 stepper, 56 mm long", 1240, 700, "StepperOnline 23HS22-2804S data sheet"),
}  # fmt: skip
_NAMED = NamedIn(MOTORS, "motor")
# Field type of a motor in the tables of a recipe.
MotorKey = Annotated[Motor, _NAMED]
# Keys of a recipe that decide on one motor.
MotorKeys = tuple[str, ...]


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
    name = _lightest(MOTORS, duty, margin)
    return MOTORS[name] if name else None


def nearest_motor(duty: MotorDuty) -> Motor | None:
    """The motor of the table with the largest margin, the fastest of equal ones; None if a torque is unknown."""
    known = (motor for motor in MOTORS.values() if not np.isnan(motor.margin(duty)))
    return max(known, key=lambda motor: (motor.margin(duty), motor.speed_rpm), default=None)


def _lightest(names: Iterable[str], duty: MotorDuty, margin: float) -> str | None:
    suitable = (name for name in names if MOTORS[name].margin(duty) >= margin)
    return min(suitable, key=lambda name: MOTORS[name].mass_g, default=None)


def motor_entry(item: str) -> Any:
    """The field for the motor that drives an item."""
    words = f"{', '.join(MOTORS)}, or a table of values; by default the lightest of these that suffices"
    return entry(f"motor on the shaft of {item}: {words}", default=None)


def motor_name(motor: Motor) -> str | None:
    """The name of a motor in the table; None if it is not from there."""
    return next((key for key, known in MOTORS.items() if known == motor), None)


def motor_keys(named: Motor | None, mounted: str | MotorFace | None, mounted_key: str = "stock.motor") -> MotorKeys:
    """The keys of a recipe that decide on the motor of a shaft: that of its plate, and `loads.motor`.

    named, mounted: values of `loads.motor` and of `mounted_key`. DesignError if both name a motor and not the same one.
    """
    if named and isinstance(mounted, str) and (name := motor_name(named)) not in (None, mounted):
        problem = f"found {name}, and {mounted_key} is {mounted}, which turns the same shaft"
        raise DesignError("loads.motor", problem, "give the same motor in both, or omit one of them", "conflict")
    keys = {mounted_key: mounted, "loads.motor": named}
    return tuple(key for key, value in keys.items() if value is not None) or ("loads.motor",)


def motor_check(
    motor: Motor, duty: MotorDuty, column: str = "", at: float | None = None, keys: MotorKeys = ("loads.motor",)
) -> Check:
    """Check that a motor supplies the torque and speed of its duty, by the margin of `smallest_motor`.

    column, at: id of the torque's column, and where the driver is at its peak, as in `Check`. keys: the motor's in the
    recipe; if one is not among the loads, a plate has the holes for it, and only motors with a known face replace it.
    """
    on_plate = any(not key.endswith("loads.motor") for key in keys)
    names = [name for name in MOTORS if name in MOTOR_FACES or not on_plate]
    better = _lightest(names, duty, LEAST_MOTOR_MARGIN)
    power = 1e-3 * duty.peak_torque * RPM * duty.peak_speed_rpm
    needed = f"{duty.peak_torque:.4g} N mm at up to {duty.peak_speed_rpm:.4g} rpm are required ({power:.3g} W)"
    change = f"choose another motor by its torque: none of the table suffices; {needed}"
    if better:
        shaft = f", whose shaft has {mm(MOTOR_FACES[better].shaft):g}" if on_plate else ""
        change = f'give {" and ".join(keys)} = "{better}" ({MOTORS[better].name}{shaft})'
    advice = _excess(motor, duty) + change
    if not np.isfinite(duty.torque).all():
        where = "which the driver does not reach, or where friction locks it"
        advice, at = f"no torque is known at some positions, {where}: let the other checks pass first", None
    name = f"torque of the {motor.name} to that required"
    limit = LEAST_MOTOR_MARGIN
    suggestions = (Suggestion(dict.fromkeys(keys, better)),) if better else ()
    return Check("motor_torque", name, motor.margin(duty), "at least", limit, "", advice, column, at, "", suggestions)


# Angles of a driver's turn at which the torque on its motor is computed, rad.
TURN = np.linspace(0, 2 * np.pi, 3601)


def mounted_motor_checks(mechanism: Any, torque: float | Real) -> Iterator[Check]:
    """Whether the motor on a plate supplies a mechanism's torque over `TURN`; a machine checks that of its driver."""
    motor = MOTORS.get(str(mechanism.stock.motor))
    if motor is not None and mechanism.setting.speed is None:
        torques, speed = np.broadcast_to(torque, TURN.shape), np.full(TURN.shape, mechanism.drive.speed)
        yield motor_check(motor, MotorDuty(torques, speed, TURN), keys=("stock.motor",))


def engagement_check(motor: str | MotorFace, engaged: float, below: float) -> Check:
    """Check that what a motor turns engages its shaft over at least its diameter.

    engaged: length over which it surrounds the shaft, mm, if that is long enough. below: from the motor's face, mm.
    """
    face = face_of(motor)
    reach = np.inf if face.shaft_length is None else max(0.0, face.shaft_length - below)
    advice = "give a thicker sheet, or a hub with set_screw = true among the attachments"
    if reach < min(engaged, face.shaft):
        advice = f"the shaft ends {mm(reach):.4g} above it: let it lie lower, or take a motor with a longer shaft"
    name = f"length over which the shaft of the {face.product} is engaged, over its diameter"
    value = to_digits(min(engaged, reach) / face.shaft, 12)
    return Check("shaft_engagement", name, value, "at least", LEAST_ENGAGEMENT, "", advice)


def _excess(motor: Motor, duty: MotorDuty) -> str:
    """The beginning of an advice: the speed or the angle that the motor does not reach."""
    speed, angle = duty.peak_speed_rpm, duty.angle_deg
    if not np.all(motor.torque_at(duty.speed)):
        limit = "its largest speed" if motor.constant_torque else "its speed without load"
        return f"the driver turns at {speed:.4g} rpm, and {limit} is {motor.speed_rpm:g} rpm: turn it slower, or "
    if motor.range_deg is not None and angle > motor.range_deg:
        return f"the driver turns by {angle:.4g} deg, and the servo by {motor.range_deg:g} deg: "
    return ""


def power_summary(duty: MotorDuty) -> dict[str, float]:
    """Work and powers of a driver, as entries of the summary; unknown ones are left out."""
    values = {
        "work_N_mm": duty.work,
        "mean_power_W": duty.mean_power,
        "largest_power_W": 1e-3 * float(np.max(duty.torque * duty.speed)),
    }
    return {key: number for key, value in values.items() if (number := to_digits_or_none(value)) is not None}


def motor_summary(motor: Motor, duty: MotorDuty) -> dict[str, object]:
    """A motor and its margin, as an entry of the summary."""
    key = motor_name(motor)
    named: dict[str, object] = {"motor": key} if key else {}
    return {**named, "name": motor.name, "margin": to_digits_or_none(motor.margin(duty), 6)}


@record
class MotorScrew:
    """The screws of a motor by their thread, mm.

    hole: diameter of the clearance hole, ISO 273, medium. sunk: height of the head, and lengths of the shortest and the
    longest countersunk screw, ISO 7046.
    """

    hole: float
    sunk: tuple[float, float, float]


# Sources: ISO 273 and ISO 7046.
MOTOR_SCREWS = {
    1.6: MotorScrew(1.8, (1.0, 3, 16)),
    2.0: MotorScrew(2.4, (1.2, 3, 20)),
    2.5: MotorScrew(2.9, (1.5, 3, 25)),
    3.0: MotorScrew(3.4, (1.65, 4, 30)),
    4.0: MotorScrew(4.5, (2.7, 5, 40)),
    5.0: MotorScrew(5.5, (2.7, 6, 50)),
}
MOTOR_THREADS = ", ".join(f"{thread:g}" for thread in MOTOR_SCREWS)
SUNK = "countersunk screw ISO 7046"
# Distance of the engraved ring from the hole of a countersunk screw, mm. A larger one may leave the plate, or remain
# after countersinking.
RING = 0.5
# Corners of a square of side 2 about 0.
CORNERS = np.array([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j])


@record(checked=True)
class MotorFace:
    """The face of a motor by which it is screwed to a plate, seen from its shaft, which is at the origin.

    Raises
    ------
    DesignError
        If a size is out of range, the flat does not fit the shaft, or the screws meet the boss or are off the face.
    """

    product: str = entry("name of the motor in the bill of materials", example="own motor")
    face_width: float = quantity(
        "width of the square face, or diameter of a round one", "mm", above=0, at_most=FARTHEST, example=42.3
    )
    screws: tuple[ComplexPoint, ...] = entry(
        "positions of the screws from the shaft, each [x, y] in mm",
        example=(15.5 + 15.5j, -15.5 + 15.5j, -15.5 - 15.5j, 15.5 - 15.5j),
    )
    boss_diameter: float = quantity("diameter of the boss round the shaft", "mm", above=0, at_most=FARTHEST, example=22)
    boss_height: float = quantity("height of the boss", "mm", at_least=0, at_most=FARTHEST, example=2)
    shaft: float = quantity("diameter of the shaft", "mm", above=0, at_most=FARTHEST, example=5)
    flat: float | None = quantity(
        "of a D-shaft, from its flat side across to the round side, or the distance of two flats; if omitted, the "
        "shaft is round",
        "mm",
        default=None,
        above=0,
        at_most=FARTHEST,
    )
    thread: ThreadDiameter = quantity(
        f"thread of the screws, as M3, or its diameter: {MOTOR_THREADS}", "mm", default=3.0, above=0, at_most=5
    )
    least_depth: float = quantity(
        "least length of a screw beyond the plate", "mm", default=2.0, at_least=0, at_most=100
    )
    largest_depth: float = quantity(
        "largest length of a screw beyond the plate", "mm", default=4.5, above=0, at_most=100
    )
    nuts: bool = entry("whether the screws pass through a flange and have nuts", default=False)
    face_offset: float = quantity(
        "distance of the face's middle from the shaft, along +x",
        "mm",
        default=0.0,
        at_least=-FARTHEST,
        at_most=FARTHEST,
    )

    flats: Literal[1, 2] = entry("number of flats of the shaft", default=1)
    shaft_length: float | None = quantity(
        "length of the shaft from the face; if omitted, it counts as long enough", "mm", default=None, above=0,
        at_most=FARTHEST,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if round(self.thread, 9) not in MOTOR_SCREWS:
            raise DesignError("thread", f"found {mm(self.thread):g}", f"give {MOTOR_THREADS} mm", "out-of-range")
        if self.least_depth > self.largest_depth:
            problem = f"found {mm(self.least_depth):g}, more than largest_depth"
            most = self.largest_depth
            raise DesignError("least_depth", problem, f"give at most {mm(most):down}", "conflict", most)
        if self.boss_diameter <= self.shaft:
            problem = f"found {mm(self.boss_diameter):g} round a shaft of {mm(self.shaft):g}"
            remedy = f"give more than {mm(self.shaft):up}"
            raise DesignError("boss_diameter", problem, remedy, "conflict", inside(self.shaft, -1))
        least = self.shaft / 2 if self.flats == 1 else 0.0
        if self.flat is not None and not least < self.flat < self.shaft:
            problem = f"found {mm(self.flat):g} across a shaft of {mm(self.shaft):g}"
            limits = f"give more than {bare_mm(least):up} and less than {mm(self.shaft):down}"
            raise DesignError("flat", problem, limits, "out-of-range", inside(self.shaft, 1))
        if len(self.screws) < 2:
            raise DesignError("screws", f"found {len(self.screws)}", "give at least two")
        places, half = np.array(self.screws), self.face_width / 2
        clear = (self.boss_diameter + self.screw_hole) / 2
        on_face = np.maximum(np.abs((places - self.face_offset).real), np.abs(places.imag)) < half
        if not (on_face & (np.abs(places) > clear)).all():
            problem = "found a screw in the hole of the boss, or off the face"
            remedy = f"give places more than {mm(clear):up} from the shaft, on the face"
            raise DesignError("screws", problem, remedy)

    def __str__(self) -> str:
        return self.product

    @property
    def bore_form(self) -> Literal["round", "D", "double-D"]:
        """Form of the bore for the shaft."""
        return "round" if self.flat is None else "D" if self.flats == 1 else "double-D"

    @property
    def screw_hole(self) -> float:
        """Clearance hole of a screw, mm."""
        return self._own_screws.hole

    @property
    def _own_screws(self) -> MotorScrew:
        return MOTOR_SCREWS[round(self.thread, 9)]

    def screw(self, thickness: float, sunk: bool = False) -> str:
        """The screw through a plate of a thickness, mm. sunk: countersunk, with a length that includes the head."""
        least, most = thickness + self.least_depth, thickness + self.largest_depth
        size = SIZES[round(self.thread, 9)]
        name, lengths = size.screw, size.lengths
        if sunk:
            name, lengths = SUNK, self._own_screws.sunk[1:]
        fitting = [length for length in LENGTHS if max(least, lengths[0]) <= length <= min(most, lengths[1])]
        if not fitting:
            product = "countersunk screw" if sunk else "screw"
            return (
                f"{size.thread} {product}, {mm(least, most, between=' to '):g} {'long' if sunk else 'under its head'}"
            )
        return f"{size.thread} x {fitting[-1]:g} {name}"

    def bill(self, thickness: float, sunk: bool = False, count: int = 1) -> tuple[tuple[str, int], ...]:
        """Screws through a plate of a thickness, mm, and their nuts; count: number of motors."""
        number = count * len(self.screws)
        nuts = ((f"M{self.thread:g} {SIZES[round(self.thread, 9)].nut}", number),) if self.nuts else ()
        return (self.screw(thickness, sunk), number), *nuts

    def holes(self, clearance: float, place: complex = 0j) -> tuple[Circle, ...]:
        """Holes round a shaft's place for the boss, wider by the clearance, mm, and for the screws."""
        screws = (Circle(complex(place + z), self.screw_hole / 2) for z in self.screws)
        return Circle(place, (self.boss_diameter + clearance) / 2), *screws

    def countersinks(self, place: complex = 0j) -> tuple[Circle, ...]:
        """A ring to engrave around each hole for a countersunk screw; the countersink removes it."""
        return tuple(Circle(complex(place + z), self.screw_hole / 2 + RING) for z in self.screws)

    def fits(self, clearance: float) -> tuple[HoleFit, ...]:
        """The fits of these holes."""
        screw = HoleFit(self.thread, self.screw_hole - self.thread)
        return HoleFit(self.boss_diameter, clearance), *(len(self.screws) * (screw,))

    def corners(self, place: complex = 0j, inset: float = 0.0) -> Complex:
        """Corners of the face, or of the square round it, mm, moved inwards by the inset; place: of the shaft."""
        return place + self.face_offset + (self.face_width / 2 - inset) * CORNERS

    def check_plate(self, thickness: float, key: str, sheets: int = 1) -> None:
        """DesignError if the boss or the heads of the screws project from the plate, on which a wheel turns.

        sheets: largest number of plates that the boss may pass.
        """
        head = self._own_screws.sunk[0]
        if thickness < (least := max(self.boss_height / sheets, head)):
            high = f"boss is {mm(self.boss_height):g} high, and the heads of its screws {mm(head):g}"
            problem = f"found {motor_face_name(self)}, whose {high}, under a plate {mm(thickness):g} thick"
            raise DesignError(key, problem, f"give a thickness of at least {mm(least):up}, or omit the motor")


def _square(spacing: float) -> tuple[complex, ...]:
    """Four screws at the corners of a square."""
    return tuple((spacing / 2 * CORNERS).tolist())


def _nema17(product: str) -> MotorFace:
    return MotorFace(product, 42.3, _square(31.0), 22.0, 2.0, 5.0, 4.5)


def _gear_motor_37(product: str) -> MotorFace:
    """Four of six threads on a circle of 31 mm, clear of the boss; the shaft is 7 mm from its middle."""
    screws = tuple(complex(7 + 15.5 * z) for z in np.exp(1j * np.pi / 6 * np.array([1, 3, 9, 11])))
    return MotorFace(product, 37.0, screws, 12.0, 6.0, 6.0, 5.5, 3.0, 2.0, 3.0, face_offset=7.0, shaft_length=21.5)


def _gear_motor_25(product: str) -> MotorFace:
    return MotorFace(product, 25.0, (8.5 + 0j, -8.5 + 0j), 7.0, 2.5, 4.0, 3.5, 3.0, 2.0, 3.0, shaft_length=12.5)


# Sources: NEMA ICS 16 for faces, screws and diameters of bosses of steppers; makers' drawings for the heights of
# bosses, shafts and depths of threads; Pololu's and DFRobot's drawings of gear motors of 25 mm and 37 mm; NopSCADlib
# for the 28BYJ-48. With other numbers the motor does not fit. Lengths of shafts: Pololu's pages, 12.5 mm from the face
# plate (25D), and 0.61 in (37D), taken as beyond its boss. Steppers are sold with shafts of several lengths.
MOTOR_FACES: dict[str, MotorFace] = {
    "nema14": MotorFace("NEMA 14 stepper", 35.2, _square(26.0), 22.0, 2.0, 5.0, 4.5),
    "nema17": _nema17("NEMA 17"),
    "nema17-short": _nema17("NEMA 17 stepper, 20 mm long"),
    "nema17-long": _nema17("NEMA 17 stepper, 60 mm long"),
    # The flange, about 5 mm thick, has holes of 5 mm, which fit M4 screws and nuts.
    "nema23": MotorFace("NEMA 23 stepper", 56.4, _square(47.14), 38.1, 1.6, 6.35, None, 4.0, 12.0, 18.0, True),
    # The face width is that over the ears. Their holes of 4.2 mm, 35 mm apart, fit M4 screws and nuts.
    "28byj-48": MotorFace(
        "28BYJ-48 geared stepper", 42.0, (8 + 17.5j, 8 - 17.5j), 9.0, 1.5, 5.0, 3.0, 4.0, 8.0, 14.0, True, 8.0, 2
    ),
    "25d-4": _gear_motor_25("25 mm gear motor 4.4:1, 6 V"),
    "25d-75": _gear_motor_25("25 mm gear motor 75:1, 12 V"),
    "37d-19": _gear_motor_37("37 mm gear motor 19:1, 12 V"),
    "37d-30": _gear_motor_37("37 mm gear motor 30:1, 12 V"),
    "37d-50": _gear_motor_37("37 mm gear motor 50:1, 12 V"),
}
# Corner radius of the plate, mm, about that of the motor's face; larger ones come close to the screws.
CORNER = 4.0


# Field type of a motor on its plate: its name, or its face.
MountedMotorKey = Annotated[
    str | MotorFace,
    NamedIn(MOTOR_FACES, "motor", keeps_name=True),
    ArgumentType(
        lambda value: isinstance(value, MotorFace) or (isinstance(value, str) and value in MOTOR_FACES),
        f"{', '.join(MOTOR_FACES)}, or a MotorFace",
        (str,),
    ),
]


def face_of(motor: str | MotorFace) -> MotorFace:
    """The face of a motor of the table, or the given one."""
    return MOTOR_FACES[motor] if isinstance(motor, str) else motor


def motor_face_name(face: MotorFace) -> str:
    """The name of a face in the table, or of the product."""
    return next((name for name, known in MOTOR_FACES.items() if known == face), face.product)


def mounted_motor_entry(meaning: str) -> Any:
    """The field for the motor of a stock."""
    return entry(f"{meaning}: {', '.join(MOTOR_FACES)}, or a table of values; none if omitted", default=None)


def fixed_under(plate: str, letter: str, count: int, packing: int = 0) -> str:
    """The first step of an assembly with a motor under a plate.

    letter: at its shaft; count: number of screws; packing: number of plates between motor and plate.
    """
    screws = f"with its {count} countersunk screws from above, in holes countersunk until the heads are flush"
    between = f", {packing} motor_plate between them" if packing else ""
    return f"fix the motor under {plate}{between}, its shaft up through {letter}, {screws}"


def plate_radius(motor: MountedMotorKey) -> float:
    """Radius round the shaft that contains the motor's plate, mm."""
    return float(np.abs(face_of(motor).corners(inset=CORNER)).max()) + CORNER


@checked
def motor_plate(motor: MountedMotorKey, thickness: PositiveFloat, clearance: Length = 0.0) -> Part:
    """The mounting plate of a motor, as large as its face, with the shaft at the origin.

    Parameters
    ----------
    motor : str or MotorFace
        The motor: a name such as "nema17", or its dimensions.
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
    face = face_of(motor)
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
