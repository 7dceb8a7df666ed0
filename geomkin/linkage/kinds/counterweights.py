"""Counterweights in a recipe of a linkage: round ends of bars that reduce the shaking force."""

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
from ...plane.vec import root_mean_square
from ...recipe.recipe import part_masses
from ..dynamics.counterweights import balance, fixed_pivots
from ..dynamics.inverse import ForceAnalysis
from ..linkage import Linkage
from ..motion import Motion
from ..parts.counterweight_plates import RoundEnd, round_end
from ..parts.plates import assemble
from ..parts.stack import Stack, fastener_masses, link_parts, stack_assembly
from ..parts.stock import LinkStock

# Rounds in which counterweights and the screws of the stack that they change settle.
ROUNDS = 3
# Largest ratio of the shaking force with counterweights to that without: with more, they are not worth their mass;
# chosen here.
LARGEST_RATIO = 0.7
# Column of the shaking force without counterweights.
UNBALANCED = "shaking_force_without_counterweights"


@record(checked=True)
class CounterweightsTable:
    """Counterweights against the shaking force, in a recipe: round ends of the plates of bars on fixed pivots."""

    bodies: tuple[str, ...] = entry("bodies on fixed pivots whose plates get a round end", example=("crank", "rocker"))
    distance: float = quantity(
        "largest distance of the centre of a round end from the pivot", "mm", above=0, at_most=FARTHEST, example=30
    )
    largest_radius: float = quantity(
        "bound on the size of a counterweight: radius of the disc of equal mass at that distance", "mm",
        above=0, at_most=FARTHEST, example=40,
    )  # fmt: skip

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
    """Plates with counterweights, and what they do to the shaking force of the linkage.

    ends: round end of the plate of each body. before: forces without counterweights.
    """

    ends: Mapping[str, RoundEnd]
    before: ForceAnalysis

    @property
    def columns(self) -> Iterator[Column]:
        """The shaking force without counterweights."""
        yield from vector_columns(UNBALANCED, "N", "shaking force without counterweights", self.before.shaking_force)

    def check(self, after: ForceAnalysis) -> Check:
        """Check that the counterweights reduce the shaking force; after: forces with them."""
        ratio = root_mean_square(after.shaking_force) / root_mean_square(self.before.shaking_force)
        words = "shaking force with counterweights to that without, root mean squares"
        advice = "give a larger distance or largest_radius, or more bodies"
        return Check("counterweights", words, ratio, "at most", LARGEST_RATIO, "", advice, "shaking_force")

    def summary(self, after: ForceAnalysis) -> Mapping[str, object]:
        """Sizes and masses of the round ends, and the shaking force without and with them."""
        ends = {
            body: {
                "added_mass_kg": to_digits(end.added_mass),
                "disc_centre_mm": [round(z, 6) + 0.0 for z in (end.centre.real, end.centre.imag)],
                "disc_radius_mm": to_digits(end.radius),
            }
            for body, end in self.ends.items()
        }
        forces = {"without": self.before.shaking_force, "with": after.shaking_force}
        return {
            "counterweights": ends,
            "shaking_force_rms_N": {key: to_digits(root_mean_square(f)) for key, f in forces.items()},
        }


def stack_with_ends(motion: Motion, stock: LinkStock, ends: Mapping[str, RoundEnd]) -> Stack:
    """Plates with round ends in layers; motion: in steps so small that no collision is missed."""
    assembly = assemble(motion, stock)
    plates = dict(assembly.plates) | {body: replace(assembly.plates[body], rim=end.rim) for body, end in ends.items()}
    return stack_assembly(motion, stock, replace(assembly, plates=plates))


def balanced_plates(
    table: CounterweightsTable,
    forces_of: Callable[[Mapping[str, Mass]], ForceAnalysis],
    fine_motion: Motion,
    stock: LinkStock,
) -> BalancedPlates:
    """The plates that minimise the shaking force.

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
                analysis.motion, analysis.loads, table.bodies, max_mass=max_mass, max_radius=table.distance
            ).counterweights
        except DesignError as error:
            raise error.named("loads.counterweights") from None
        moments = {body: complex(mass.mass * (mass.centre - pivots[body])) for body, mass in best.items() if mass.mass}
        ends = {
            body: round_end(plates[body], stock, stock.material, pivots[body], moment, table.distance)
            for body, moment in moments.items()
        }
        earlier, screws = screws, fastener_masses(fine_motion, stock, stack_with_ends(fine_motion, stock, ends))
        if screws == earlier:
            break
    return BalancedPlates(ends, before)
