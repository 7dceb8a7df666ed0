"""A machine that walks: the feet of its legs carry the weight of all its mechanisms and of what is on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..core.errors import DesignError
from ..core.fields import entry, quantity
from ..core.records import record
from ..linkage.dynamics.wrenches import NEWTON
from ..linkage.kinds.loaded import LEAST_CARRIED
from ..linkage.kinds.loads import CarriedMass
from ..linkage.kinds.stance import FEWEST_FEET, POSITIONS, UNKNOWN_STANCE, UPRIGHT, Stance, Walking, stance_with
from ..model.check import Check
from ..model.scene import Plot
from ..model.table import Column
from ..plane.vec import Pose, Real
from ..recipe.aspect import FootForces, ShaftPlacement, Standing
from ..recipe.recipe import AbstractRecipe
from .mechanism import Mechanism, errors_of
from .shaft_fits import mounted_motor
from .shafts import ShaftGraph

# Gravity, mm/s2; it points down in the machine.
GRAVITY = 9810.0


@record(checked=True)
class WalkerTable:
    """What a machine that walks carries, in a recipe."""

    carried: tuple[CarriedMass, ...] = entry(
        "what it carries besides its parts and its motor, each with mass_kg, along and across; along is in the frame "
        "of the machine, and across from the lower face of the lowest mechanism",
        default=(),
    )
    foot_friction: float = quantity(
        "coefficient of dry friction between feet and ground", default=0.0, at_least=0, at_most=10
    )


def feet_of(mechanisms: Mapping[str, Mechanism]) -> dict[str, str]:
    """The point on which each leg of a machine stands, by its name; empty if it has none."""
    feet = {name: mechanism.foot or mechanism.recipe.standing_point for name, mechanism in mechanisms.items()}
    return {name: foot for name, foot in feet.items() if foot}


def check_walker(mechanisms: Mapping[str, Mechanism], graph: ShaftGraph, table: WalkerTable | None) -> None:
    """DesignError for feet that cannot stand or walk, and for what is carried without feet."""
    feet, count = feet_of(mechanisms), 0
    if not feet:
        if table is not None:
            remedy = "give foot to its legs, or omit it"
            raise DesignError("walker", "is given, but no mechanism has a foot", remedy, "conflict")
        return
    first = next(iter(feet))
    for name, foot in feet.items():
        try:
            count += mechanisms[name].recipe.number_of_feet(foot)
        except DesignError as error:
            raise error.named(f"mechanisms.{name}.{error.field}") from None
        ratio = abs(graph.speeds[name] / graph.speeds[first])
        if ratio != 1:
            problem = f"found {foot}, but it turns at {ratio} times the speed of {first}, so that they do not walk"
            raise DesignError(f"mechanisms.{name}.foot", problem, "let both turn at the same speed", "conflict")
    if count < FEWEST_FEET:
        remedy = f"give foot to at least {FEWEST_FEET} legs or copies"
        raise DesignError(f"mechanisms.{first}.foot", f"found {count} feet, which cannot stand", remedy, "conflict")


@record(eq=False)
class MachineWalking:
    """How a machine stands and walks over a turn of its legs.

    graph: its shafts. mechanisms, recipes, poses: by name. turns: rotations of the driver at the frames. speed_rpm: of
    the driver.
    """

    graph: ShaftGraph
    mechanisms: Mapping[str, Mechanism]
    recipes: Mapping[str, AbstractRecipe]
    poses: Mapping[str, Pose]
    turns: Real
    speed_rpm: float
    table: WalkerTable

    @cached_property
    def feet(self) -> Mapping[str, str]:
        """The point on which each leg stands, by its name."""
        return feet_of(self.mechanisms)

    def _own(self, name: str, turns: Real) -> Standing:
        ratio = float(self.graph.speeds[name])
        turn = 2 * np.pi * ratio * turns + np.radians(self.mechanisms[name].phase_deg)
        with errors_of(name):
            return self.recipes[name].standing_at(turn, self.feet.get(name, ""), ratio * self.speed_rpm * np.pi / 30)

    @cached_property
    def _carried(self) -> Mapping[str, Standing]:
        """The mechanisms that do not stand, each mass at its mean position over the period."""

        def at_mean(own: Standing) -> Standing:
            masses = ((mass, np.asarray(np.mean(place)), across) for mass, place, across in own.masses)
            return replace(own, masses=tuple(masses))

        return {name: at_mean(self._own(name, self.turns)) for name in self.mechanisms if name not in self.feet}

    def _placed(self, turns: Real) -> Iterator[tuple[str, Standing, float]]:
        """Each mechanism in its place at rotations of the driver, and its lower face, mm."""
        face = 0.0
        for name, mechanism in self.mechanisms.items():
            own = self._carried.get(name) or self._own(name, turns)
            face += mechanism.gap
            placement = ShaftPlacement(self.poses[name], mechanism.mirrored)
            yield name, own.placed(placement, mechanism.is_reversed, face), face
            face += own.height

    def _standing(self, drive: Real) -> Standing:
        """All of the machine at positions of its driver, rad."""
        placed = list(self._placed(drive / (2 * np.pi)))
        _, last, face = placed[-1]
        feet, masses, pivots = (
            tuple(item for _, standing, _ in placed for item in getattr(standing, key))
            for key in ("feet", "masses", "pivots")
        )
        return Standing(feet, masses, pivots, face + last.height)

    @property
    def _motor(self) -> Iterator[tuple[float, complex]]:
        """Mass and place of the mounted motor, at its shaft and at the outer face of the driver's lowest plate."""
        driver = self.graph.driver
        if motor := mounted_motor(self.recipes[driver]):
            own, face = next((own, face) for name, own, face in self._placed(self.turns[:1]) if name == driver)
            axis = complex(self.poses[driver].place(next(iter(self.graph.bodies[driver].values())).axis))
            across = face + own.height if self.mechanisms[driver].is_reversed else face
            yield 1e-3 * motor.mass_g, complex(axis.real, across)

    @property
    def _turned(self) -> list[str]:
        """The legs whose feet are not below them."""
        return [name for name in self.feet if abs(complex(np.asarray(self.poses[name].direction)) - 1) > UPRIGHT]

    @cached_property
    def stance(self) -> Stance | None:
        """How it stands over a turn of its legs.

        None if a leg is not upright, or the height of a mechanism along the shaft is unknown.
        """
        if self._turned:
            return None
        turn = 2 * np.pi / float(abs(self.graph.speeds[next(iter(self.feet))]))
        drive = np.copysign(np.linspace(0, turn, POSITIONS), self.speed_rpm)
        standing = self._standing(drive)
        if not np.isfinite(standing.height):
            return None
        return stance_with(standing, self.table.carried, tuple(self._motor), drive, self._standing)

    @cached_property
    def walking(self) -> Walking | None:
        """The forces at the feet; None if it has no weight, or falls over at some position."""
        stance = self.stance
        if stance is None or not stance.mass or not np.isfinite(stance.shares).all():
            return None
        speed = 2 * np.pi * abs(self.speed_rpm) / 60 * float(abs(self.graph.speeds[next(iter(self.feet))]))
        return Walking(stance, NEWTON * stance.mass * GRAVITY, self.table.foot_friction, speed)

    def on_feet(self, name: str, recipe: AbstractRecipe) -> AbstractRecipe:
        """The recipe of a mechanism with the forces at its feet; none if the machine falls over."""
        if name not in self.feet:
            return recipe
        forces = FootForces(self.feet[name])
        if self.walking is not None:
            counts = {leg: self.recipes[leg].number_of_feet(foot) for leg, foot in self.feet.items()}
            first = sum(list(counts.values())[: list(counts).index(name)])
            forces = self.walking.on_feet(self.feet[name], slice(first, first + counts[name]))
        return recipe.in_setting(replace(recipe.setting, feet=forces))

    @property
    def columns(self) -> Iterator[Column]:
        """Load of each foot and speed of the frame at the frames of the machine."""
        if self.walking:
            yield from self.walking.columns(2 * np.pi * self.turns)

    @property
    def plots(self) -> Iterator[Plot]:
        """Plots of these columns."""
        if self.walking:
            yield from self.walking.plots

    @property
    def checks(self) -> Iterator[Check]:
        """That it stands and rocks little, and that its feet carry its weight."""
        advice = "give its legs phase_deg by which three feet always stand, six legs at best, or feet that keep level"
        yield from self.stance.checks("walker", advice) if self.stance else ()
        if self._turned:
            legs = " and ".join(self._turned)
            words = f"give angle_deg = 0 to {legs}, whose feet are at -y of the recipe"
            name = "least distance of the frame's centre inside its feet"
            yield Check("support_margin", name, np.nan, "at least", 0, "mm", words)
        if self.walking is None:
            advice = "the torque is that of legs in the air: let it stand at all positions by the check support_margin"
            name = "share of the weight of the machine that its feet carry"
            yield Check("weight_carried", name, 0.0, "at least", LEAST_CARRIED, "%", advice)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Where its weight is."""
        return tuple(self.stance.remarks) if self.stance else (UNKNOWN_STANCE,) * (not self._turned)

    @property
    def summary(self) -> Mapping[str, object]:
        """Entries of summary.json."""
        stance = {"stance": self.stance.summary} if self.stance else {}
        return {**stance, **({"walking": self.walking.summary} if self.walking else {})}
