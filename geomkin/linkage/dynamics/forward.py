"""Forward dynamics: the motion that follows from the torque of the driver, from a motor or from the loads alone."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from ...core.arguments import ArgumentType, PositiveFloat, PositiveInt, checked, is_real
from ...core.errors import DesignError
from ...core.records import record
from ...model.motor import RPM, Motor
from ...plane.vec import Real
from ..motion import Motion
from ..moving import move
from .loads import Loads

# Relative tolerance of the steps of the drive, and of a whole turn.
EVEN = 1e-9
# Fewest frames of the given motion, for cubic interpolation between them.
FEWEST = 8
# Largest number of time steps; they take a minute.
MOST_STEPS = 1_000_000
# Turns of the driver in a step, above which inertia and loads would be taken at random.
MOST_TURNS = 1

DriverTorque = Annotated[
    Any,
    ArgumentType(
        lambda value: isinstance(value, Motor) or is_real(value) or (callable(value) and not isinstance(value, type)),
        "a number, a Motor, or a function of drive and speed",
    ),
]


@record(eq=False)
class ReducedDynamics:
    """A linkage reduced to its driver, over evenly spaced positions of it (Eksergian).

    inertia q'' + slope q'^2 + damping q' = load + torque; in N mm, per rad or mm of the drive.
    """

    drive: Real
    inertia: Real
    slope: Real
    damping: Real
    load: Real
    period: float

    def at(self, drive: float) -> tuple[float, float, float, float]:
        """Inertia, slope, damping and load at a position, by cubic interpolation; nan beyond the range."""
        start, step, last = self.drive[0], self.drive[1] - self.drive[0], len(self.drive) - 1
        x = float((drive - start) / step)
        if self.period:
            x %= last
        if not 0 <= x <= last:
            return (np.nan,) * 4
        k = int(x)
        s = x - k
        # Frames before, at and after the position; at the ends of a range the nearest ones inside.
        if self.period:
            frames = [(k + j) % last for j in (-1, 0, 1, 2)]
        else:
            first = min(max(k - 1, 0), last - 3)
            s, frames = x - first - 1, [first + j for j in range(4)]
        weights = (
            -s * (s - 1) * (s - 2) / 6,
            (s + 1) * (s - 1) * (s - 2) / 2,
            -(s + 1) * s * (s - 2) / 2,
            (s + 1) * s * (s - 1) / 6,
        )
        values = self._rows[frames]
        a, b, c, d = weights @ values
        return float(a), float(b), float(c), float(d)

    @cached_property
    def _rows(self) -> Real:
        return np.stack([self.inertia, self.slope, self.damping, self.load], axis=-1)


def reduced_dynamics(motion: Motion, loads: Loads) -> ReducedDynamics:
    """Reduced inertia and loads at the frames of a motion."""
    linkage, drive = motion.linkage, motion.drive
    steps = np.diff(drive)
    if linkage.is_batch:
        raise DesignError("motion", "found many linkages at once", "give one", "wrong-type")
    if len(drive) < FEWEST or np.ptp(steps) > EVEN * np.abs(drive).max() or steps[0] <= 0:
        problem = "its drive does not rise in equal steps" if len(drive) >= FEWEST else f"it has {len(drive)} frames"
        raise DesignError("motion", problem, "give a motion over np.linspace(start, end, 1001)", "conflict")
    if any(friction.coefficient for friction in loads.friction):
        raise DesignError("loads.friction", "found dry friction", "give viscous friction only", "conflict")

    def generalised(speed: float, acceleration: float) -> Real:
        timed = move(linkage, drive, motion.solution.spec, speed, acceleration)
        return loads.wrenches(timed).generalised + np.zeros(drive.shape)

    load, forth, back = generalised(0.0, 0.0), generalised(1.0, 0.0), generalised(-1.0, 0.0)
    inertia = load - generalised(0.0, 1.0)
    if not np.nanmin(inertia, initial=np.inf) > 0:
        raise DesignError("loads.masses", "nothing that the driver moves has a mass", "give masses", "missing-key")
    whole = linkage.driven_slider is None and abs(np.ptp(drive) - 2 * np.pi) < EVEN * 2 * np.pi
    repeats = whole and motion.assembled.all() and abs(load[-1] - load[0]) <= 1e-6 * np.abs(load).max()
    period = 2 * np.pi if repeats else 0.0
    return ReducedDynamics(drive, inertia, load - (forth + back) / 2, (back - forth) / 2, load, period)


@record(eq=False)
class ForwardMotion:
    """A motion that follows from a torque, as returned by `forward_dynamics`; arrays have the shape (steps + 1,).

    Parameters
    ----------
    time : array
        s; it ends before `duration` if the driver leaves the range of the given motion.
    drive, speed, acceleration : array
        Of the driver: rad, rad/s and rad/s2, or mm, mm/s and mm/s2 if a slider drives.
    kinetic_energy : array
        N mm.
    work : array
        Work of the driver, the loads and viscous friction since the start, N mm.
    source : Motion
        The given motion.
    """

    time: Real
    drive: Real
    speed: Real
    acceleration: Real
    kinetic_energy: Real
    work: Real
    source: Motion

    @property
    def energy_error(self) -> float:
        """Largest difference of the kinetic energy from that of the start and the work, over the largest energy."""
        error = self.kinetic_energy - self.kinetic_energy[0] - self.work
        scale = max(float(np.abs(self.kinetic_energy).max()), float(np.abs(self.work).max()))
        return float(np.abs(error).max()) / (scale or 1.0)

    @cached_property
    def motion(self) -> Motion:
        """The motion of all bodies at these times."""
        spec = self.source.solution.spec
        return move(self.source.linkage, self.drive, spec, self.speed, self.acceleration)


@checked
def forward_dynamics(
    motion: Motion,
    loads: Loads,
    torque: DriverTorque = 0.0,
    speed: float = 0.0,
    duration: PositiveFloat = 1.0,
    steps: PositiveInt = 1000,
    start: float | None = None,
) -> ForwardMotion:
    """The motion of a linkage that follows from the torque of its driver and from its loads.

    Parameters
    ----------
    motion : Motion
        Motion over the range of the driver, in equal steps; over one whole turn it repeats. Its speed and acceleration
        do not matter.
    loads : Loads
        Masses, gravity, forces, springs, viscous friction.
    torque : float, Motor or function
        Of the driver, N mm, or N if a slider drives: a number, a direct-current motor at full voltage that turns
        counterclockwise, or a function of drive and speed that returns a number.
    speed : float, optional
        Of the driver at the start, rad/s or mm/s.
    duration : float, optional
        s.
    steps : int, optional
        Number of time steps; the error falls with the fourth power of their length.
    start : float, optional
        Position of the driver at the start, rad or mm; by default the first of the motion.

    Returns
    -------
    ForwardMotion
        Its `energy_error` states how well energy is kept.

    Raises
    ------
    DesignError
        If the driver's steps are unequal, nothing has a mass, there is dry friction, the motor is a stepper, the start
        is not reached, or the time steps are too long.

    See Also
    --------
    forces, Loads, Motor

    Notes
    -----
    Eksergian's equation of motion with the reduced inertia, integrated by the classical Runge-Kutta method; inertia and
    loads are interpolated between the frames by cubic polynomials (Paul, Kinematics and Dynamics of Planar Machinery).

    Examples
    --------
    >>> turn = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 361))
    >>> loads = gk.Loads(masses={"crank": gk.Mass(0.5, inertia=500), "rocker": gk.Mass(0.5, centre=35)})
    >>> result = gk.forward_dynamics(turn, loads, speed=10.0, duration=1.0)
    >>> result.energy_error < 1e-6
    True
    """
    if steps > MOST_STEPS:
        raise DesignError("steps", f"found {steps}", f"give at most {MOST_STEPS}", "too-much-work")
    reduced, supplied = reduced_dynamics(motion, loads), _torque(torque)

    def slope(drive: float, speed: float) -> tuple[float, float, float]:
        """Derivatives of drive, speed and work by time."""
        inertia, change, damping, load = reduced.at(drive)
        force = load + supplied(drive, speed) - damping * speed
        return speed, (force - change * speed**2) / inertia, force * speed

    dt = duration / steps
    state = np.array([motion.drive[0] if start is None else start, speed, 0.0], dtype=float)
    turns = abs(state[1]) * dt / (reduced.period or np.ptp(motion.drive))
    if turns > MOST_TURNS:
        problem = f"found {state[1]:g}, so that the driver passes its whole range {turns:.3g} times in a step"
        raise DesignError("speed", problem, "give a lower one, or shorter steps", "out-of-range")
    if np.isnan(reduced.at(state[0])[0]):
        problem = f"found {state[0]:g}, where the linkage is open or its motion is not given"
        raise DesignError("start", problem, "give a drive that the motion reaches", "out-of-range")
    rows = [state]
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(steps):
            one = np.array(slope(*state[:2]))
            two = np.array(slope(*(state + dt / 2 * one)[:2]))
            three = np.array(slope(*(state + dt / 2 * two)[:2]))
            four = np.array(slope(*(state + dt * three)[:2]))
            state = state + dt / 6 * (one + 2 * two + 2 * three + four)
            if not np.isfinite(state).all():
                break
            rows.append(state)
    if len(rows) <= steps and (reduced.period or np.isinf(state).any()):
        problem = f"found {steps}, with which the motion grows without limit"
        raise DesignError("steps", problem, "give more steps, or masses to all bodies", "out-of-range")
    drive, speeds, work = np.array(rows).T
    inertia = np.array([reduced.at(position)[0] for position in drive])
    acceleration = np.array([slope(*row[:2])[1] for row in rows])
    return ForwardMotion(dt * np.arange(len(rows)), drive, speeds, acceleration, inertia * speeds**2 / 2, work, motion)


def _torque(torque: Any) -> Callable[[float, float], float]:
    if isinstance(torque, Motor):
        if torque.constant_torque:
            problem = f"found {torque.name}, which moves step by step at a prescribed speed"
            raise DesignError("torque", problem, "give a direct-current motor, or use gk.forces", "conflict")
        return lambda drive, speed: torque.torque_n_mm * (1 - speed / (RPM * torque.speed_rpm))
    if callable(torque):
        return lambda drive, speed: float(torque(drive, speed))
    return lambda drive, speed: float(torque)
