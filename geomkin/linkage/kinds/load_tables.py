"""Tables of the loads of a recipe: counterweights, and the run that follows from a torque or a motor."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST, entry, quantity, to_digits
from ...core.records import record
from ...model.check import Check
from ...model.material import Mass
from ...model.motor import RPM, Motor
from ...model.part import Part
from ...model.scene import Plot
from ...model.table import Column, vector_columns
from ...plane.vec import Real
from ...recipe.recipe import part_masses
from ...recipe.settings import Stroke, Turn
from ..dynamics.counterweights import (
    Balance,
    BalanceMeasure,
    BalanceObjective,
    balance,
    fixed_pivots,
    size_of_objective,
)
from ..dynamics.forward import ForwardMotion, forward_dynamics
from ..dynamics.inverse import ForceAnalysis
from ..dynamics.loads import Loads
from ..linkage import Linkage
from ..motion import Motion
from ..moving import move
from ..parts.plates import assemble
from ..parts.rotating_masses import Flywheel, RoundEnd, round_end, with_flywheel
from ..parts.stack import Stack, fastener_masses, link_parts, stack_assembly
from ..parts.stock import LinkStock
from .copies import is_whole_turn

# Rounds in which counterweights and the screws of the stack that they change settle.
ROUNDS = 3
# Shares of `largest_radius` that are tried until the objective is not larger than without counterweights.
SMALLER = 1.0, 0.5, 0.25
# Mass of a counterweight in that of the whole linkage that stands for one of any size.
HEAVY = 1e4
# Largest ratio of the objective with counterweights to that without: with more, they are not worth their mass; chosen
# here.
LARGEST_RATIO = 0.7
# Name, column and unit of each objective; names of the measures.
OBJECTIVES = {
    "shaking_force": ("shaking force", "shaking_force", "N"),
    "shaking_moment": ("shaking moment", "shaking_moment", "N_mm"),
    "driver": ("deviation of the driver's torque from its mean", "driver_torque", "N_mm"),
}
MEASURES = {"root_mean_square": ("root mean squares", "rms"), "maximum": ("largest values", "largest")}
# Column of the shaking force without counterweights.
UNBALANCED = "shaking_force_without_counterweights"


@record(checked=True)
class CounterweightsTable:
    """Counterweights in a recipe: round ends of the plates of bars on fixed pivots."""

    bodies: tuple[str, ...] = entry("bodies on fixed pivots whose plates get a round end", example=("crank", "rocker"))
    distance: float = quantity(
        "largest distance of the centre of a round end from the pivot", "mm", above=0, at_most=FARTHEST, example=30
    )
    largest_radius: float = quantity(
        "bound on the size of a counterweight: radius of the disc of equal mass at that distance", "mm",
        above=0, at_most=FARTHEST, example=40,
    )  # fmt: skip
    objective: BalanceObjective = entry(
        "what becomes least: the shaking force, the shaking moment about the driver's pivot, or the deviation of the "
        "driver's torque from its mean",
        default="shaking_force",
    )
    measure: BalanceMeasure = entry(
        "whether its root mean square over the motion becomes least, or its largest value", default="root_mean_square"
    )

    def size(self, analysis: ForceAnalysis) -> float:
        """The objective of forces, N or N mm."""
        return size_of_objective(analysis, self.objective, self.measure)

    def best(self, analysis: ForceAnalysis, max_mass: float) -> Balance:
        """The counterweights of at most a mass, kg, that make the objective of forces least."""
        try:
            return balance(
                analysis.motion, analysis.loads, self.bodies, self.objective, max_mass=max_mass,
                max_radius=self.distance, measure=self.measure,
            )  # fmt: skip
        except DesignError as error:
            raise error.named("loads.counterweights") from None

    def check(self, linkage: Linkage, stock: LinkStock, masses: Mapping[str, object]) -> None:
        """DesignError with the key of what the linkage cannot have."""
        try:
            fixed_pivots(linkage, self.bodies)
        except DesignError as error:
            raise error.named(f"loads.counterweights.{error.field}") from None
        if stock.material is None:
            problem = "is missing, and the mass of counterweights depends on it"
            raise DesignError(
                "stock.material", problem, 'give "steel-S235", or omit loads.counterweights', "missing-key"
            )
        for body in self.bodies:
            if body in masses:
                problem = f"is given, and the counterweight on the {body} would change it"
                raise DesignError(f"loads.masses.{body}", problem, "omit it, or name another body", "conflict")


@record(eq=False)
class BalancedPlates:
    """Plates with counterweights, and what they do to the forces of the linkage.

    table: of the recipe. ends: round end of the plate of each body. before: forces without counterweights. share: of
    `largest_radius` that is used.
    """

    table: CounterweightsTable
    ends: Mapping[str, RoundEnd]
    before: ForceAnalysis
    share: float = 1.0

    @property
    def _objective(self) -> tuple[str, str, str]:
        """Name, column and unit of the objective."""
        if self.table.objective == "driver" and self.before.motion.linkage.driven_slider is not None:
            return "deviation of the driver's force from its mean", "driver_force", "N"
        return OBJECTIVES[self.table.objective]

    @property
    def columns(self) -> Iterator[Column]:
        """The shaking force without counterweights."""
        yield from vector_columns(UNBALANCED, "N", "shaking force without counterweights", self.before.shaking_force)

    def check(self, after: ForceAnalysis) -> Check:
        """Check that the counterweights reduce the objective; after: forces with them."""
        ratio = self.table.size(after) / self.table.size(self.before)
        name, column, _ = self._objective
        words = f"{name} with counterweights to that without, {MEASURES[self.table.measure][0]}"
        advice = "" if ratio <= LARGEST_RATIO else self._advice
        return Check("counterweights", words, ratio, "at most", LARGEST_RATIO, "", advice, column)

    @property
    def _advice(self) -> str:
        """What makes the objective smaller, if larger round ends do not."""
        table, bodies = self.table, " and ".join(self.table.bodies)
        heavy = HEAVY * sum(float(mass.mass) for mass in self.before.loads.masses.values())
        least = table.size(table.best(self.before, heavy).after) / table.size(self.before)
        larger = "a larger distance or more bodies" if table.objective != "shaking_force" else "more bodies"
        if least > LARGEST_RATIO:
            return f"the ratio is at least {least:.3g} with any largest_radius on {bodies} alone: give {larger}"
        if self.share < 1:
            causes = "by their inertia, or by longer screws in other layers"
            return f"round ends as large as allowed make it larger, {causes}: give more bodies"
        return "give a larger distance or largest_radius, or more bodies"

    def summary(self, after: ForceAnalysis) -> Mapping[str, object]:
        """Sizes and masses of the round ends, and the objective without and with them."""
        ends = {
            body: {
                "added_mass_kg": to_digits(end.added_mass),
                "disc_centre_mm": [round(z, 6) + 0.0 for z in (end.centre.real, end.centre.imag)],
                "disc_radius_mm": to_digits(end.radius),
            }
            for body, end in self.ends.items()
        }
        key = f"{self.table.objective}_{MEASURES[self.table.measure][1]}_{self._objective[2]}"
        sizes = {"without": self.table.size(self.before), "with": self.table.size(after)}
        return {"counterweights": ends, key: {name: to_digits(size) for name, size in sizes.items()}}


def stack_with_ends(
    motion: Motion, stock: LinkStock, ends: Mapping[str, RoundEnd], wheel: Flywheel | None = None, open_pin: str = ""
) -> Stack:
    """Plates with round ends and a flywheel in layers; motion: in steps so small that no collision is missed.

    open_pin: a pin that goes up to the uppermost layer, "" for none.
    """
    assembly = replace(assemble(motion, stock), open_pin=open_pin)
    plates = dict(assembly.plates) | {body: replace(assembly.plates[body], rim=end.rim) for body, end in ends.items()}
    assembly = replace(assembly, plates=plates)
    return stack_assembly(motion, stock, with_flywheel(assembly, motion.linkage, stock, wheel) if wheel else assembly)


def linkage_masses(parts: Iterable[Part], motion: Motion, stock: LinkStock, stack: Stack) -> dict[str, Mass]:
    """Mass of each body with screws or rods of a stack, and with what is screwed to it; empty without a material."""
    bodies = part_masses(parts)
    if bodies:
        for body, mass in fastener_masses(motion, stock, stack).items():
            bodies[body] = bodies[body] + mass if body in bodies else mass
        for plate in stack.plates.values():
            for item, middle in plate.attached:
                bodies[plate.body] += Mass(item.mass_kg, middle)
    return bodies


def _refuse_bodies_without_round_end(table: CounterweightsTable, stack: Stack) -> None:
    round_ended = [body for body in table.bodies if body in stack.plates and not stack.plates[body].wheel]
    if others := [body for body in table.bodies if body not in round_ended]:
        problem = f"found {', '.join(others)}; bodies that are cut as a gear or a block get no round end"
        remedy = f"give bodies = {shown(round_ended)}" if round_ended else "omit loads.counterweights"
        raise DesignError("loads.counterweights.bodies", problem, remedy, "conflict")


def balanced_plates(
    table: CounterweightsTable,
    forces_of: Callable[[Mapping[str, Mass]], ForceAnalysis],
    fine_motion: Motion,
    stock: LinkStock,
) -> BalancedPlates:
    """The plates that minimise the objective of the table.

    The round ends have the first moments of the best point masses, at their distances. They are smaller than allowed,
    or there are none, if in the layers of larger ones screws are so long that the objective grows.

    forces_of: forces for given masses of the bodies. fine_motion: in steps so small that no collision is missed.
    """
    assert stock.material is not None
    material, plain_stack = stock.material, stack_with_ends(fine_motion, stock, {})
    _refuse_bodies_without_round_end(table, plain_stack)
    plain = link_parts(fine_motion, stock, plain_stack)
    before = forces_of(linkage_masses(plain, fine_motion, stock, plain_stack))
    pivots = fixed_pivots(before.motion.linkage, table.bodies)

    def fitted(max_mass: float) -> tuple[Mapping[str, RoundEnd], Stack]:
        """The round ends with which the screws of their stack settle, and this stack."""
        ends, stack, screws = dict[str, RoundEnd](), plain_stack, fastener_masses(fine_motion, stock, plain_stack)
        for _ in range(ROUNDS):
            best = table.best(forces_of(linkage_masses(plain, fine_motion, stock, stack)), max_mass)
            arms = {
                body: complex(mass.centre - pivots[body]) for body, mass in best.counterweights.items() if mass.mass
            }
            ends = {
                body: round_end(
                    plain_stack.plates[body], stock, material, pivots[body],
                    complex(best.counterweights[body].mass * arm), abs(arm),
                )
                for body, arm in arms.items()
            }  # fmt: skip
            stack = stack_with_ends(fine_motion, stock, ends)
            earlier, screws = screws, fastener_masses(fine_motion, stock, stack)
            if screws == earlier:
                break
        return ends, stack

    max_mass = material.density * 1e-9 * stock.thickness * np.pi * table.largest_radius**2
    for smaller in SMALLER:
        ends, stack = fitted(smaller**2 * max_mass)
        after = forces_of(linkage_masses(link_parts(fine_motion, stock, stack), fine_motion, stock, stack))
        if table.size(after) <= table.size(before):
            return BalancedPlates(table, ends, before, smaller)
    return BalancedPlates(table, {}, before, 0.0)


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
            remedy = "give it, or a direct-current motor in loads.motor or stock.motor"
            raise DesignError("loads.run.torque_n_mm", problem, remedy, "missing-key")


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
        """Checks that all turns are completed, and then that energy is kept."""
        weak = "give a stronger motor, more torque or a larger start_rpm"
        unsteady = "give a smaller torque or start_rpm, or masses to light bodies"
        turns = Check(
            "run_turns", "turns completed", len(self.mean_speeds), "at least", self.turns, "", weak, "run_speed"
        )
        energy = Check(
            "run_energy", "energy error of the run", self.energy_error, "at most", MOST_ENERGY_ERROR, "", unsteady
        )
        return (turns, energy) if turns.passed else (turns,)

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
    # Until the driver stands still or turns back, each position once, when it is reached.
    going = np.logical_and.accumulate((np.diff(drive, prepend=drive[0]) >= 0) & (speed >= 0))
    drive, reached = np.unique(drive[going], return_index=True)
    time, speed = time[going][reached], speed[going][reached]
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
