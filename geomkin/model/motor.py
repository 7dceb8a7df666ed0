"""Shafts: a motor with its torque at a speed, and bodies that turn in a constant ratio to the driver."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Annotated

import numpy as np

from ..core.arguments import AnyFloat, ArgumentType, checked, numbers
from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, inside, quantity
from ..core.names import VisibleName, VisibleText
from ..core.records import record
from ..core.units import mm
from ..plane.vec import Real, without_rounding

# rpm in rad/s.
RPM = np.pi / 30
# Relative difference of an angle from the range of a servo that counts as rounding.
ROUNDING = 1e-9


def _is_row(value: object) -> bool:
    return isinstance(value, np.ndarray) and value.ndim == 1 and numbers(value, "iuf") is not None


# May hold nan.
_Row = Annotated[Real, ArgumentType(_is_row, "a one-dimensional array of real numbers")]


def effective_value(values: Real, over: Real) -> float:
    """Root mean square of values over a quantity that rises or falls, by trapezoids; nan values are left out."""
    known = np.isfinite(values)
    if not known.any():
        return float("nan")
    values, over = values[known], over[known]
    extent = over[-1] - over[0]
    mean = np.trapezoid(values**2, over) / extent if extent else np.mean(values**2)
    return float(np.sqrt(mean))


@record(checked=True, eq=False)
class MotorDuty:
    """Torque and speed that a motor must supply over a motion.

    Parameters
    ----------
    torque : array, shape (frames,)
        N mm; nan if unknown.
    speed : array, shape (frames,)
        rad/s.
    angle : array, shape (frames,)
        Angle of the shaft, rad.
    between : float
        Largest torque of either sense between the frames, N mm, if it exceeds those at them.

    Examples
    --------
    >>> import numpy as np
    >>> angle = np.linspace(0, 2 * np.pi, 361)
    >>> duty = gk.model.MotorDuty(100 * np.sin(angle), np.full(361, 10.0), angle)
    >>> round(duty.peak_torque), round(duty.rms_torque, 1)
    (100, 70.7)
    """

    torque: _Row
    speed: _Row
    angle: _Row
    between: float = 0.0

    def __post_init__(self) -> None:
        if not len(self.torque) == len(self.speed) == len(self.angle) > 0:
            found = f"found {len(self.torque)}, {len(self.speed)} and {len(self.angle)} numbers"
            raise DesignError("torque", found, "give arrays of the same length, at least 1", "conflict")

    @property
    def peak_torque(self) -> float:
        """Largest torque of either sense, N mm; nan if all are unknown."""
        known = self.torque[np.isfinite(self.torque)]
        return max(float(np.abs(known).max()), self.between) if known.size else float("nan")

    @cached_property
    def rms_torque(self) -> float:
        """Root mean square of the torque over the angle, N mm; at a constant speed that over time."""
        return effective_value(self.torque, self.angle)

    @cached_property
    def work(self) -> float:
        """Work of the torque, N mm, by trapezoids, without rounding noise; nan if a torque is unknown."""
        size = float(np.trapezoid(np.abs(self.torque), self.angle))
        return without_rounding(float(np.trapezoid(self.torque, self.angle)), size)

    @property
    def mean_power(self) -> float:
        """Mean power, W; nan if the speed changes or a torque is unknown."""
        range_of_angle = float(self.angle[-1] - self.angle[0])
        steady = not np.ptp(self.speed) and range_of_angle
        return 1e-3 * self.work / range_of_angle * float(self.speed[0]) if steady else float("nan")

    @property
    def steadying_inertia(self) -> float:
        """Inertia with which the speed under a constant torque fluctuates by all of its mean, kg mm2; nan if unknown.

        By the largest difference of the work from that of the mean torque.
        """
        steps = np.diff(self.angle) * (self.torque[1:] + self.torque[:-1]) / 2
        work = np.append(0.0, np.cumsum(steps))
        excess = work - work[-1] * (self.angle - self.angle[0]) / (self.angle[-1] - self.angle[0])
        return float(np.ptp(excess)) / 1e-3 / float(self.speed[0]) ** 2

    @property
    def peak_speed_rpm(self) -> float:
        """Largest speed of either sense, rpm."""
        return float(np.abs(self.speed).max()) / RPM

    @property
    def angle_deg(self) -> float:
        """Angle between the extreme positions of the shaft, deg."""
        return float(np.degrees(np.ptp(self.angle)))


@record(checked=True)
class Motor:
    """Torque and speed of a motor's output shaft.

    Parameters
    ----------
    name : str
        For people, such as "NEMA 17 stepper, 48 mm".
    torque_n_mm : float
        Greatest torque, N mm: at standstill; if `constant_torque`, at all speeds up to `speed_rpm`.
    speed_rpm : float
        Speed without load, rpm, at which the torque has fallen to zero along a straight line; if `constant_torque`,
        the largest speed.
    lasting_torque_n_mm : float
        Root mean square of the torque that it supplies for long, N mm.
    mass_g : float
        Mass, g.
    constant_torque : bool, optional
        True for a stepper: its torque is `torque_n_mm` up to `speed_rpm`, and 0 beyond.
    range_deg : float, optional
        Angle through which a servo turns, deg; None if the shaft turns without end.
    source : str, optional
        Where the values are from.
    voltage_v, no_load_current_a, stall_current_a : float, optional
        Rated voltage of a direct-current motor, V, and its currents without load and at standstill, A.

    See Also
    --------
    forces, forward_dynamics

    Examples
    --------
    >>> motor = gk.Motor("own", torque_n_mm=1000, speed_rpm=100, lasting_torque_n_mm=250, mass_g=100)
    >>> round(float(motor.torque_at(50 * np.pi / 30)), 6)
    500.0
    """

    name: VisibleName = entry("name of the motor", example="gear motor 12 V")
    torque_n_mm: float = quantity("greatest torque", "N mm", above=0, at_most=1e12, example=1000)
    speed_rpm: float = quantity(
        "speed without load, or the largest speed of a motor of constant torque", "rpm", above=0, at_most=1e6,
        example=100,
    )  # fmt: skip
    lasting_torque_n_mm: float = quantity(
        "root mean square of the torque that it supplies for long", "N mm", above=0, at_most=1e12, example=250
    )
    mass_g: float = quantity("mass", "g", above=0, at_most=1e9, example=200)
    constant_torque: bool = entry("whether its torque is the same up to its largest speed", default=False)
    range_deg: float | None = quantity(
        "angle through which a servo turns", "deg", default=None, above=0, at_most=36_000
    )
    source: VisibleText = entry("where the values are from", default="")
    voltage_v: float | None = quantity("rated voltage", "V", default=None, above=0, at_most=1e6)
    no_load_current_a: float | None = quantity(
        "current without load, of a direct-current motor", "A", default=None, at_least=0, at_most=1e6
    )
    stall_current_a: float | None = quantity(
        "current at standstill, of a direct-current motor", "A", default=None, above=0, at_most=1e6
    )

    def __post_init__(self) -> None:
        electric = {key: getattr(self, key) for key in ("voltage_v", "no_load_current_a", "stall_current_a")}
        missing = [key for key, value in electric.items() if value is None]
        if 0 < len(missing) < len(electric):
            raise DesignError(missing[0], "is missing", f"give all of {', '.join(electric)}, or none", "missing-key")
        if not missing and electric["no_load_current_a"] >= electric["stall_current_a"]:
            problem = f"found {self.no_load_current_a:g} A, not less than stall_current_a"
            most = electric["stall_current_a"]
            raise DesignError("no_load_current_a", problem, f"give less than {most:g} A", "conflict", most)

    @property
    def has_currents(self) -> bool:
        """Whether its electric power is that of its data sheet."""
        return self.stall_current_a is not None

    @checked
    def electric_power(self, torque: AnyFloat, speed: AnyFloat) -> Real:
        """Power that a direct-current motor takes from its supply, at the voltage that gives a torque at a speed.

        Parameters
        ----------
        torque : float or array_like
            N mm.
        speed : float or array_like
            rad/s.

        Returns
        -------
        ndarray
            W; 0 where the load drives it, for nothing is fed back; nan for a motor of constant torque.

        Notes
        -----
        The current rises in proportion to the torque, from `no_load_current_a` to `stall_current_a`; the voltage is
        that of the winding's resistance at this current and of the speed. Without currents the motor and its gears
        count as free of friction, so that the power is the least possible.

        Examples
        --------
        >>> motor = gk.making.motor("37d-50")
        >>> float(motor.electric_power(216.0, 180 * np.pi / 30).round(2))
        9.11
        """
        if self.constant_torque:
            return np.full(np.broadcast_shapes(np.shape(torque), np.shape(speed)), np.nan)
        no_load, at_stall = 0.0, 1e-3 * self.torque_n_mm * RPM * self.speed_rpm
        if self.voltage_v and self.stall_current_a and self.no_load_current_a is not None:
            no_load, at_stall = self.no_load_current_a / self.stall_current_a, self.voltage_v * self.stall_current_a
        # At standstill a torque of either sense takes current.
        forwards = np.where(np.asarray(speed) == 0, np.abs(torque), torque * np.sign(speed)) / self.torque_n_mm
        current = no_load + (1 - no_load) * forwards
        voltage = current + (1 - no_load) * np.abs(speed) / (RPM * self.speed_rpm)
        return np.asarray(at_stall * np.where(current > 0, np.maximum(voltage, 0.0) * current, 0.0))

    @checked
    def torque_at(self, speed: AnyFloat) -> Real:
        """Greatest torque at a speed of the shaft.

        Parameters
        ----------
        speed : float or array_like
            rad/s, of either sign.

        Returns
        -------
        ndarray
            N mm; 0 at and beyond the speed without load.
        """
        share = np.abs(np.asarray(speed, dtype=float)) / (RPM * self.speed_rpm)
        left = np.where(share <= 1, 1.0, 0.0) if self.constant_torque else np.maximum(1 - share, 0.0)
        return np.asarray(self.torque_n_mm * left)

    def at_scale(self, scale: float) -> Motor:
        """The same motor, since a bought item does not change with the size of the mechanism."""
        return self

    def margin(self, duty: MotorDuty) -> float:
        """How many times the torques of a duty the motor supplies.

        Parameters
        ----------
        duty : MotorDuty

        Returns
        -------
        float
            The least of the torque at each speed over the required one, and of the lasting torque over the root mean
            square; 0 if the motor does not turn so fast or so far; nan if a torque is unknown.
        """
        if not np.isfinite(duty.torque).all():
            return float("nan")
        if self.range_deg is not None and duty.angle_deg > self.range_deg * (1 + ROUNDING):
            return 0.0
        supplied, required = self.torque_at(duty.speed), np.abs(duty.torque)
        if not (supplied > ROUNDING * self.torque_n_mm).all():
            return 0.0
        peak = np.argmax(required)
        required[peak] = duty.peak_torque
        with np.errstate(divide="ignore"):
            return float(min(np.min(supplied / required), np.divide(self.lasting_torque_n_mm, duty.rms_torque)))


@record(checked=True)
class LinearActuator:
    """Force and speed of a linear actuator, such as a spindle with its motor.

    Parameters
    ----------
    name : str
        For people.
    force_n : float
        Largest force that it moves, N, push or pull.
    no_load_speed, full_load_speed : float
        Speed without load, and with the largest force, mm/s; it falls along a straight line between them.
    stroke : float
        Largest displacement of its rod, mm.
    source : str, optional
        Where the values are from.

    Raises
    ------
    DesignError
        If it is faster with the largest force than without load.

    Examples
    --------
    >>> actuator = gk.model.LinearActuator("own", force_n=200, no_load_speed=20, full_load_speed=10, stroke=50)
    >>> actuator.force_at([5.0, 15.0, 25.0]).tolist()
    [200.0, 100.0, 0.0]
    """

    name: VisibleName = entry("name of the actuator", example="linear actuator 12 V")
    force_n: float = quantity("largest force that it moves", "N", above=0, at_most=1e12, example=200)
    no_load_speed: float = quantity("speed without load", "mm/s", above=0, at_most=1e6, example=20)
    full_load_speed: float = quantity("speed with the largest force", "mm/s", at_least=0, at_most=1e6, example=10)
    stroke: float = quantity("largest displacement of its rod", "mm", above=0, at_most=FARTHEST, example=100)
    source: VisibleText = entry("where the values are from", default="")

    def __post_init__(self) -> None:
        if self.full_load_speed >= self.no_load_speed:
            problem = f"found {mm(self.full_load_speed, unit='mm/s'):g}, not less than no_load_speed"
            remedy = f"give less than {mm(self.no_load_speed, unit='mm/s'):down}"
            raise DesignError("full_load_speed", problem, remedy, "conflict", inside(self.no_load_speed, 1))

    @checked
    def force_at(self, speed: AnyFloat) -> Real:
        """Largest force at a speed.

        Parameters
        ----------
        speed : float or array_like
            mm/s, of either sign.

        Returns
        -------
        ndarray
            N; 0 at and beyond the speed without load.
        """
        left = self.no_load_speed - np.abs(np.asarray(speed, dtype=float))
        return np.asarray(self.force_n * np.clip(left / (self.no_load_speed - self.full_load_speed), 0.0, 1.0))

    def at_scale(self, scale: float) -> LinearActuator:
        """The same actuator, since a bought item does not change with the size of the mechanism."""
        return self


@record
class RotatingBody:
    """A body that turns about a fixed axis in a constant ratio to the driver of its mechanism.

    Parameters
    ----------
    axis : complex
        Its axis, mm.
    speed : Fraction
        Its rotations, counterclockwise, for one rotation of the driver; not 0.
    is_wheel : bool, optional
        Whether it looks alike at every angle, apart from teeth and marks, as a gear does.
    efficiency : float, optional
        Share of the power of the driver that reaches it, above 0 to 1; of the same power backwards too.
    is_ring : bool, optional
        Whether it has no middle for a bore, so that a disc on the shaft carries it.
    load : float, optional
        Torque that resists its rotation by the loads of its recipe, N mm; None without loads.
    """

    axis: complex
    speed: Fraction
    is_wheel: bool = False
    efficiency: float = 1.0
    is_ring: bool = False
    load: float | None = None

    @property
    def turned_over(self) -> RotatingBody:
        """The body of a mechanism that is turned over about its y axis, left for right."""
        return replace(self, axis=-self.axis.conjugate(), speed=-self.speed)
