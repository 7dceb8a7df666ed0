"""Motors that drive a mechanism: torque and speed, and the smallest one that suffices."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.fields import entry, to_digits
from ..model.check import Check, Suggestion
from ..model.motor import RPM, Motor, MotorDuty
from .motor_faces import MOTOR_FACES
from .named import NamedIn

# Least margin of a motor that `smallest_motor` chooses, for friction and loads that are not stated; chosen here.
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
MotorKey = Annotated[Motor, _NAMED]


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


def nearest_motor(duty: MotorDuty) -> Motor:
    """The motor of the table with the largest margin; the fastest of equal ones."""
    return max(MOTORS.values(), key=lambda motor: (motor.margin(duty), motor.speed_rpm))


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


def motor_check(
    motor: Motor, duty: MotorDuty, column: str = "", at: float | None = None, key: str = "loads.motor"
) -> Check:
    """Check that a motor supplies the torque and speed of its duty, by the margin of `smallest_motor`.

    column, at: id of the torque's column, and where the driver is at its peak, as in `Check`. key: the motor's in the
    recipe; if it is not among the loads, a plate has the holes for it, and only motors with a known face replace it.
    """
    on_plate = not key.endswith("loads.motor")
    names = [name for name in MOTORS if name in MOTOR_FACES or not on_plate]
    better = _lightest(names, duty, LEAST_MOTOR_MARGIN)
    power = 1e-3 * duty.peak_torque * RPM * duty.peak_speed_rpm
    needed = f"{duty.peak_torque:.4g} N mm at up to {duty.peak_speed_rpm:.4g} rpm are required ({power:.3g} W)"
    change = f"choose another motor by its torque: none of the table suffices; {needed}"
    if better:
        shaft = f", whose shaft has {MOTOR_FACES[better].shaft:g} mm" if on_plate else ""
        change = f'give motor = "{better}" ({MOTORS[better].name}{shaft})'
    advice = _excess(motor, duty) + change
    name = f"torque of the {motor.name} to that required"
    limit = LEAST_MOTOR_MARGIN
    suggestions = (Suggestion({key: better}),) if better else ()
    return Check("motor_torque", name, motor.margin(duty), "at least", limit, "", advice, column, at, "", suggestions)


def _excess(motor: Motor, duty: MotorDuty) -> str:
    """The beginning of an advice: the speed or the angle that the motor does not reach."""
    speed, angle = duty.peak_speed_rpm, duty.angle_deg
    if not np.all(motor.torque_at(duty.speed)):
        limit = "its largest speed" if motor.constant_torque else "its speed without load"
        return f"the driver turns at {speed:.4g} rpm, and {limit} is {motor.speed_rpm:g} rpm: turn it slower, or "
    if motor.range_deg is not None and angle > motor.range_deg:
        return f"the driver turns by {angle:.4g} deg, and the servo by {motor.range_deg:g} deg: "
    return ""


def motor_summary(motor: Motor, duty: MotorDuty) -> dict[str, object]:
    """A motor and its margin, as an entry of the summary."""
    key = motor_name(motor)
    named: dict[str, object] = {"motor": key} if key else {}
    return {**named, "name": motor.name, "margin": to_digits(motor.margin(duty), 6)}
