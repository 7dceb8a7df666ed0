"""The bill and the assembly steps of a machine: those of its mechanisms, and the shafts that join them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

from ..core.records import record
from ..core.units import marked, mm
from ..model.check import Check
from ..model.part import Bought
from ..recipe.recipe import AbstractRecipe
from .mechanism import Mechanism
from .shaft_fits import ShaftFit


@record(eq=False)
class MachineAssembly:
    """Items to buy and assembly steps. mechanisms, recipes: by name, the lowest first. shafts: that join them."""

    mechanisms: Mapping[str, Mechanism]
    recipes: Mapping[str, AbstractRecipe]
    shafts: tuple[ShaftFit, ...]

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Items of all mechanisms, equal ones in one line, and the shafts that join them instead of their own."""
        lines: dict[str, Bought] = {}
        for name, recipe in self.recipes.items():
            replaced = [item for item in recipe.shaft_items if {(name, j) for j in item.joints} & self._replaced]
            for item in recipe.bought:
                own = [other for other in replaced if other.name == item.name]
                joints = set(item.joints).difference(*(other.joints for other in own))
                kept = tuple(f"{name} {joint}" for joint in item.joints if joint in joints)
                _add(lines, replace(item, count=item.count - sum(other.count for other in own), joints=kept))
        for shaft in self.shafts:
            for item in shaft.bought:
                _add(lines, item)
        return tuple(lines.values())

    @property
    def snap_checks(self) -> tuple[Check, ...]:
        """None: its pins are bought."""
        return ()

    @property
    def shaft_items(self) -> tuple[Bought, ...]:
        """None: a machine is no mechanism of another."""
        return ()

    @property
    def _replaced(self) -> set[tuple[str, str]]:
        """Mechanism and joint of each shaft that a shaft of the machine replaces."""
        return {joint for shaft in self.shafts for joint in shaft.joints.items()}

    @property
    def steps(self) -> tuple[str, ...]:
        """The shafts that join the mechanisms, then the steps of each mechanism."""
        own = (f"{name}: {marked(step)}" for name, recipe in self.recipes.items() for step in recipe.steps)
        phases = (
            f"turn the driver of {name} by {mechanism.phase_deg:g} deg before it is fixed to its shaft"
            for name, mechanism in self.mechanisms.items()
            if mechanism.phase_deg
        )
        gaps = {name: mechanism.gap for name, mechanism in self.mechanisms.items()}
        neighbours = (
            f"set {upper} above {lower} on tubes "
            + (f"{mm(gaps[upper]):g} high" if gaps[upper] else "as high as the nuts and collars between them")
            for lower, upper in pairwise(self.mechanisms)
        )
        words = {
            (True, False): "turn {} over, left for right",
            (False, True): "turn {} upside down, its ground on top",
            (True, True): "lay each plate of {} with its other face up, in the same order",
        }
        turned = (
            words[mechanism.mirrored, mechanism.upside_down].format(name)
            for name, mechanism in self.mechanisms.items()
            if mechanism.mirrored or mechanism.upside_down
        )
        return (*(shaft.step for shaft in self.shafts), *own, *turned, *neighbours, *phases)


def _add(lines: dict[str, Bought], item: Bought) -> None:
    """Add an item to the lines of a bill."""
    if item.count:
        before = lines.get(item.name, Bought(item.name, 0, ()))
        lines[item.name] = Bought(item.name, before.count + item.count, (*before.joints, *item.joints))
