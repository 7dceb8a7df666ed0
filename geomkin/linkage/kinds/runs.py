"""The motion that follows from a torque or a motor, in a recipe of a linkage: its speed over the last turn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, quantity, to_digits
from ...core.records import record
from ...model.check import Check
from ...model.motor import RPM, Motor
from ...model.scene import Plot
from ...model.table import Column
from ...plane.vec import Real
from ...recipe.settings import Stroke, Turn
from ..dynamics.forward import ForwardMotion, forward_dynamics
from ..dynamics.loads import Loads
from ..linkage import Linkage
from ..motion import Motion
from ..moving import move
from .copies import is_whole_turn

# Frames of a turn between which inertia and loads are interpolated.
FRAMES = 721
# The run is integrated in pieces of about a quarter turn, each in so many time steps; a run may have so many pieces for
# each turn before it counts as stalled.
PIECE, STEPS, MOST_PIECES = np.pi / 2, 250, 50
# Time of the first look at the acceleration, s.
FIRST_LOOK = 1e-6
# Largest error of the energy of a run, as a share of it.
MOST_ENERGY_ERROR = 1e-5


@record(checked=True)
class RunTable:
    """A run of a linkage under a torque or a motor, in a recipe."""

    torque_n_mm: float | None = quantity(
        "constant torque on the driver; by default that of the motor, a direct-current one at full voltage", "N mm",
        default=None, at_least=-FARTHEST, at_most=FARTHEST, example=300,
    )  # fmt: skip
    start_rpm: float = quantity("speed of the driver at the start", "rpm", default=0.0, at_least=0, at_most=1e6)
    turns: int = quantity(
        "number of turns; table and plots have the last one", default=1, at_least=1, at_most=50, whole=True
    )

    def check(
        self, linkage: Linkage, input_range: Turn | Stroke, motor: Motor | None, has_friction: bool, has_copies: bool
    ) -> None:
        """DesignError with the key of what a run cannot have. motor: given or mounted."""
        if linkage.driver_pivot is None:
            problem = "is given, but the driver turns on no fixed shaft"
            raise DesignError("loads.run", problem, "omit it, or let a body on a fixed pivot drive", "conflict")
        if not (isinstance(input_range, Turn) and is_whole_turn(input_range) and input_range.speed_rpm > 0):
            problem = "is given, but the range of the drive is no whole turn forwards"
            raise DesignError("loads.run", problem, "let the driver turn from 0 to 360 deg, or omit run", "conflict")
        if has_friction:
            problem = "is given with dry friction, which a run does not consider"
            raise DesignError("loads.run", problem, "give viscous friction only", "conflict")
        if has_copies:
            raise DesignError("loads.run", "is given for a linkage with copies", "omit copies or run", "conflict")
        if self.torque_n_mm is None and (motor is None or motor.constant_torque):
            problem = "is missing" if motor is None else f"is missing, and the {motor.name} moves step by step"
            raise DesignError(
                "loads.run.torque_n_mm", problem, "give it, or a direct-current motor in loads.motor", "missing-key"
            )


@record(eq=False)
class LinkageRun:
    """A run: time, s, and speed of the driver, rad/s, at the frames of its last turn; nan where it does not get.

    mean_speeds: of each turn that it completes, rad/s. energy_error: as of `ForwardMotion`. extremes: least and largest
    speed of the last turn, at all time steps; nan if it does not get there.
    """

    time: Real
    speed: Real
    mean_speeds: tuple[float, ...]
    energy_error: float
    turns: int
    extremes: tuple[float, float]

    @property
    def columns(self) -> Iterator[Column]:
        """Time and speed of the last turn."""
        yield Column("run_time", "s", "time since the start of the run", self.time)
        yield Column("run_speed", "rad/s", "speed of the driver in the last turn of the run", self.speed)

    @property
    def plots(self) -> tuple[Plot, ...]:
        """The speed over the driver's angle."""
        return (Plot("speed of the run", ("run_speed",)),)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks that all turns are completed, and that energy is kept."""
        weak = "give a stronger motor, more torque or a larger start_rpm"
        unsteady = "give a smaller torque or start_rpm, or masses to light bodies"
        return (
            Check("run_turns", "turns completed", len(self.mean_speeds), "at least", self.turns, "", weak, "run_speed"),
            Check(
                "run_energy", "energy error of the run", self.energy_error, "at most", MOST_ENERGY_ERROR, "", unsteady
            ),
        )

    @property
    def summary(self) -> Mapping[str, object]:
        """Mean speed of each turn, fluctuation of the last one, and the error of the energy."""
        least, largest = self.extremes
        mean = (largest + least) / 2
        return {
            "mean_speeds_rpm": [to_digits(speed / RPM) for speed in self.mean_speeds],
            "fluctuation": to_digits((largest - least) / mean) if mean > 0 else None,
            "energy_error": to_digits(self.energy_error, 3),
        }


def linkage_run(table: RunTable, motion: Motion, loads: Loads, motor: Motor | None) -> LinkageRun:
    """The run of a linkage; motion: over the frames of the last turn."""
    torque = motor if table.torque_n_mm is None else table.torque_n_mm
    frames = motion.drive
    turn = move(motion.linkage, np.linspace(frames.min(), frames.max(), FRAMES), motion.solution.spec)
    start, turned = float(turn.drive[0]), float(np.ptp(turn.drive))
    if not all(np.isfinite(body.first[0]) for body in turn.bodies.values()):
        problem = f"found a run from {np.degrees(start):g} deg, where the linkage is open or its driver at a limit"
        raise DesignError("drive.start_deg", problem, "give another start_deg, or other lengths", "conflict")
    pieces = list(_pieces(table, turn, loads, torque, start + table.turns * turned))
    time, drive, speed = (
        np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("time", "drive", "speed")
    )
    # Until the driver stands still or turns back.
    going = np.logical_and.accumulate((np.diff(drive, prepend=drive[0]) >= 0) & (speed >= 0))
    time, drive, speed = time[going], drive[going], speed[going]
    wanted = frames - frames.min() + start + (table.turns - 1) * turned
    # The square of the speed is smooth over the drive, also at the start from rest.
    squared = np.interp(wanted, drive, speed**2, left=np.nan, right=np.nan)
    last = np.append(speed[drive >= wanted.min()], np.sqrt(squared[np.isfinite(squared)]))
    ends = np.interp(start + turned * np.arange(table.turns + 1), drive, time, right=np.nan)
    means = turned / np.diff(ends)
    return LinkageRun(
        np.interp(wanted, drive, time, left=np.nan, right=np.nan),
        np.sqrt(squared),
        tuple(means[np.isfinite(means)].tolist()),
        max(piece.energy_error for piece in pieces),
        table.turns,
        (float(last.min()), float(last.max())) if last.size else (np.nan, np.nan),
    )


def _pieces(table: RunTable, turn: Motion, loads: Loads, torque: object, end: float) -> Iterator[ForwardMotion]:
    """Consecutive pieces of a run until the driver is at `end` or stops, timed from the start."""
    drive, speed, time = float(turn.drive[0]), RPM * table.start_rpm, 0.0
    acceleration = float(forward_dynamics(turn, loads, torque, speed, FIRST_LOOK, 1).acceleration[0])
    for _ in range(MOST_PIECES * table.turns):
        rising = max(acceleration, 0.0)
        rests = rising == speed == 0
        duration = 1.0 if rests else 2 * PIECE / (speed + np.sqrt(speed**2 + 2 * rising * PIECE))
        piece = forward_dynamics(turn, loads, torque, speed, duration, STEPS, drive)
        yield replace(piece, time=time + piece.time)
        drive, speed, acceleration = (float(z[-1]) for z in (piece.drive, piece.speed, piece.acceleration))
        time += float(piece.time[-1])
        if drive >= end or (piece.speed < 0).any() or len(piece.time) <= STEPS or rests:
            return
