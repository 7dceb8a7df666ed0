"""Counterweights in a recipe of a linkage: round ends of bars that reduce shaking or the ripple of the torque."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity, to_digits
from ...core.records import record
from ...model.check import Check
from ...model.material import Mass
from ...model.table import Column, vector_columns
from ...recipe.recipe import part_masses
from ..dynamics.counterweights import BalanceMeasure, BalanceObjective, balance, fixed_pivots, size_of_objective
from ..dynamics.inverse import ForceAnalysis
from ..linkage import Linkage
from ..motion import Motion
from ..parts.counterweight_plates import RoundEnd, round_end
from ..parts.flywheel import Flywheel, with_flywheel
from ..parts.plates import assemble
from ..parts.stack import Stack, fastener_masses, link_parts, stack_assembly
from ..parts.stock import LinkStock

# Rounds in which counterweights and the screws of the stack that they change settle.
ROUNDS = 3
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

    table: of the recipe. ends: round end of the plate of each body. before: forces without counterweights.
    """

    table: CounterweightsTable
    ends: Mapping[str, RoundEnd]
    before: ForceAnalysis

    @property
    def _objective(self) -> tuple[str, str, str]:
        """Name, column and unit of the objective."""
        if self.table.objective == "driver" and self.before.motion.linkage.driven_slider is not None:
            return "deviation of the driver's force from its mean", "driver_force", "N"
        return OBJECTIVES[self.table.objective]

    def _size(self, analysis: ForceAnalysis) -> float:
        return size_of_objective(analysis, self.table.objective, self.table.measure)

    @property
    def columns(self) -> Iterator[Column]:
        """The shaking force without counterweights."""
        yield from vector_columns(UNBALANCED, "N", "shaking force without counterweights", self.before.shaking_force)

    def check(self, after: ForceAnalysis) -> Check:
        """Check that the counterweights reduce the objective; after: forces with them."""
        ratio = self._size(after) / self._size(self.before)
        name, column, _ = self._objective
        words = f"{name} with counterweights to that without, {MEASURES[self.table.measure][0]}"
        advice = "give a larger distance or largest_radius, or more bodies"
        return Check("counterweights", words, ratio, "at most", LARGEST_RATIO, "", advice, column)

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
        sizes = {"without": self._size(self.before), "with": self._size(after)}
        return {"counterweights": ends, key: {name: to_digits(size) for name, size in sizes.items()}}


def stack_with_ends(
    motion: Motion, stock: LinkStock, ends: Mapping[str, RoundEnd], wheel: Flywheel | None = None
) -> Stack:
    """Plates with round ends and a flywheel in layers; motion: in steps so small that no collision is missed."""
    assembly = assemble(motion, stock)
    plates = dict(assembly.plates) | {body: replace(assembly.plates[body], rim=end.rim) for body, end in ends.items()}
    assembly = replace(assembly, plates=plates)
    return stack_assembly(motion, stock, with_flywheel(assembly, motion.linkage, stock, wheel) if wheel else assembly)


def balanced_plates(
    table: CounterweightsTable,
    forces_of: Callable[[Mapping[str, Mass]], ForceAnalysis],
    fine_motion: Motion,
    stock: LinkStock,
) -> BalancedPlates:
    """The plates that minimise the objective of the table.

    The round ends have the first moments of the best point masses, at their distances.

    forces_of: forces for given masses of the bodies. fine_motion: in steps so small that no collision is missed.
    """
    assert stock.material is not None
    stack = stack_with_ends(fine_motion, stock, {})
    plates, plain = stack.plates, part_masses(link_parts(fine_motion, stock, stack))

    def bodies(screws: Mapping[str, Mass]) -> dict[str, Mass]:
        """Masses without counterweights, with screws."""
        return {body: plain.get(body, Mass(0.0)) + screws.get(body, Mass(0.0)) for body in {**plain, **screws}}

    screws = fastener_masses(fine_motion, stock, stack)
    before = forces_of(bodies(screws))
    pivots, ends = fixed_pivots(before.motion.linkage, table.bodies), dict[str, RoundEnd]()
    max_mass = stock.material.density * 1e-9 * stock.thickness * np.pi * table.largest_radius**2
    for _ in range(ROUNDS):
        analysis = forces_of(bodies(screws))
        try:
            best = balance(
                analysis.motion, analysis.loads, table.bodies, table.objective, max_mass=max_mass,
                max_radius=table.distance, measure=table.measure,
            ).counterweights  # fmt: skip
        except DesignError as error:
            raise error.named("loads.counterweights") from None
        moments = {body: complex(mass.mass * (mass.centre - pivots[body])) for body, mass in best.items() if mass.mass}
        radii = {body: float(np.abs(mass.centre - pivots[body])) for body, mass in best.items()}
        ends = {
            body: round_end(plates[body], stock, stock.material, pivots[body], moment, radii[body])
            for body, moment in moments.items()
        }
        earlier, screws = screws, fastener_masses(fine_motion, stock, stack_with_ends(fine_motion, stock, ends))
        if screws == earlier:
            break
    return BalancedPlates(table, ends, before)
