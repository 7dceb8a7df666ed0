"""The recipe of a machine: mechanisms of any kinds on common shafts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from ..core.errors import DesignError, shown
from ..core.field_visitor import fields_of
from ..core.fields import entry, quantity
from ..core.names import check_names
from ..core.records import record
from ..core.units import marked, mm
from ..linkage.kinds.loads import CarriedMass
from ..model.check import Check
from ..model.material import Mass
from ..model.part import Part
from ..model.scene import Scene, SceneHandle
from ..model.table import Table
from ..plane.vec import Pose, Real
from ..recipe.aspect import ALONE, AbstractAspect, Setting, ShaftPlacement
from ..recipe.composed import AbstractComposedRecipe
from ..recipe.load import from_table, to_toml
from ..recipe.recipe import AbstractAssembledRecipe, AbstractGoal, AbstractRecipe, Additions, assembly_summary
from ..recipe.settings import SLOWEST_RPM, Files
from ..recipe.shown import before_scaling
from .mechanisms import Mechanism, PlacedMechanism, errors_of, joined_scene, joined_table, refuse_machine
from .shafts import MachineAssembly, ShaftFit, ShaftGraph, motor_key, motor_room, shaft_fits
from .torques import MachineTorques, MachineWalking, WalkerTable, check_walker, feet_of

# Most mechanisms of a machine: what a page shows and a person can distinguish. Twelve legs and their train are 13.
MOST_MECHANISMS = 16


@record(checked=True)
class MachineDrive:
    """How the machine is driven."""

    speed_rpm: float = quantity(
        "speed of the driver of the first mechanism; negative if clockwise", "rpm", default=60.0, at_least=-1e6,
        at_most=1e6,
    )  # fmt: skip
    speed_fluctuation: float | None = quantity(
        "allowed difference of the largest and the least speed over their mean under a constant torque, for a flywheel "
        "on the driver", default=None, above=0, at_most=1,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if abs(self.speed_rpm) < SLOWEST_RPM:
            remedy = f"give at least {SLOWEST_RPM:g}, or at most {-SLOWEST_RPM:g} to go the other way"
            raise DesignError("speed_rpm", f"found {self.speed_rpm:g}", remedy, "out-of-range")


# Keys of a mechanism that the machine decides for all, and those of one that another mechanism turns.
OF_MACHINE = ("loads.run", "loads.motors", "loads.speed_fluctuation", "drive.acceleration_rad_per_s2")
OF_DRIVER = ("loads.motor",)
# Notes of mechanisms that state teeth; meshes, which have a centre distance, are others.
TEETH = ("measures_mm", "helix", "wheels", "belt", "chain")


class MachineAdditions(Additions):
    """What neither the mechanisms alone nor this machine refuses."""

    def unavailable(self, recipe: MachineRecipe) -> Iterator[str]:
        if not feet_of(recipe.mechanisms):
            yield "walker"
        for name, mechanism in recipe.mechanisms.items():
            inner = mechanism.recipe
            motors = [f"{key}.motor" for key in fields_of(type(inner)) if key.endswith("stock")]
            of_driver = (*OF_DRIVER, *motors) if mechanism.turned_by else ()
            refused = (*OF_MACHINE, "loads.carried", "stroke", "printing", *of_driver)
            for key in (*inner.additions.unavailable(inner), *refused):
                yield f"mechanisms.{name}.recipe.{key}"


@record(kw_only=True)
class MachineRecipe(AbstractAssembledRecipe):
    """Several mechanisms on common shafts, such as a gear train that turns two cranks: one motion, one bill.

    The mechanisms lie above one another in the order of the recipe. The axis of each driver is on the axis of the body
    that turns it.
    """

    takes_workshop: ClassVar[bool] = False
    additions: ClassVar[Additions] = MachineAdditions()

    kind: Literal["machine"] = "machine"
    mechanisms: dict[str, Mechanism] = entry("the mechanisms by name, the lowest first", example={})
    drive: MachineDrive = entry("how the machine is driven", default=MachineDrive())
    walker: WalkerTable | None = entry("what a machine on feet carries, and their friction", default=None)
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        print_mechanisms(self)
        names = list(self.mechanisms)
        if not 1 < len(names) <= MOST_MECHANISMS:
            raise DesignError("mechanisms", f"found {len(names)}", f"give 2 to {MOST_MECHANISMS}", "out-of-range")
        check_names("mechanisms", names, "a mechanism")
        for name in names:
            # Parts are named `mechanism_part`.
            if twin := next((other for other in names if other.startswith(f"{name}_")), None):
                problem = f"found {shown(name)} and {shown(twin)}, whose parts might have the same name"
                raise DesignError("mechanisms", problem, f"name one of them without {name}_", "conflict")
        for name, mechanism in self.mechanisms.items():
            if isinstance(mechanism.recipe, MachineRecipe):
                refuse_machine(f"mechanisms.{name}.recipe")
            if not mechanism.recipe.name and mechanism.recipe.units != self.units:
                problem = f'found "{mechanism.recipe.units}" in a machine with units = "{self.units}"'
                remedy = "omit it, or give the recipe in a file of its own"
                raise DesignError(f"mechanisms.{name}.recipe.units", problem, remedy, "conflict")
            if mechanism.turned_by and (key := motor_key(mechanism.recipe)):
                problem = f"found a motor, but {mechanism.turned_by} turns this mechanism"
                raise DesignError(f"mechanisms.{name}.recipe.{key}", problem, "omit it, or omit turned_by", "conflict")
            check_settings(f"mechanisms.{name}", mechanism)
            if (kerf := mechanism.recipe.files.kerf) not in (0, self.files.kerf):
                problem = f"found {mm(self.files.kerf):g}, but {mm(kerf):g} in the recipe of {name}"
                raise DesignError("files.kerf", problem, f"give {mm(kerf):g} as kerf in [files]", "conflict")
        check_gravity(self.mechanisms)
        if not any(isinstance(recipe, AbstractGoal) for recipe in alone(self.mechanisms).values()):
            # Raises for shafts that do not join, and for a long period. A goal would search for its mechanism first.
            self.graph.period  # noqa: B018
            check_walker(self.mechanisms, self.graph, self.walker)

    @property
    def recipes(self) -> Mapping[str, AbstractRecipe]:
        """The recipe of each mechanism at its speed, in its position and under its loads in this machine.

        Equal ones are the same object, so that their parts are computed once.
        """
        return self.torques.loaded_recipes

    @cached_property
    def graph(self) -> ShaftGraph:
        """Which mechanism turns which."""
        bodies = {}
        for name, recipe in alone(self.mechanisms).items():
            with errors_of(name):
                bodies[name] = recipe.rotating_bodies
            if self.mechanisms[name].mirrored:
                bodies[name] = {key: body.turned_over for key, body in bodies[name].items()}
            if not bodies[name]:
                problem = f"this {recipe.kind} has no driver that makes whole turns on a fixed shaft and moves others"
                remedy = (
                    "give a linkage whose crank turns by 360 deg, a cam, a Geneva or cycloidal drive, a ratchet, a "
                    "belt or chain, or a pair, planetary set or train of involute gears"
                )
                raise DesignError(f"mechanisms.{name}.recipe", problem, remedy, "conflict")
        return ShaftGraph(bodies, {name: mechanism.turned_by for name, mechanism in self.mechanisms.items()})

    @property
    def design(self) -> Mapping[str, AbstractRecipe]:
        """The recipe of each mechanism."""
        return self.recipes

    @cached_property
    def poses(self) -> Mapping[str, Pose]:
        """Pose of each mechanism, which is turned over before if it is mirrored.

        The axis of its driver is that of the body that turns it.
        """
        poses, bodies = dict[str, Pose](), self.graph.bodies
        for name in self.graph.order:
            place = axis = next(iter(bodies[name].values())).axis
            if name in self.graph.sources:
                mechanism, body = self.graph.sources[name]
                place = complex(poses[mechanism].place(bodies[mechanism][body].axis))
            direction = np.exp(1j * np.radians(self.mechanisms[name].angle_deg))
            poses[name] = Pose(complex(place - direction * axis), complex(direction))
        return poses

    @cached_property
    def placed(self) -> tuple[PlacedMechanism, ...]:
        """All mechanisms in their places, the lowest first."""
        graph, recipes, layer, placed = self.graph, self.recipes, 0, []
        for name, mechanism in self.mechanisms.items():
            turn = 2 * np.pi * float(graph.speeds[name]) * self.turns + np.radians(mechanism.phase_deg)
            placement = ShaftPlacement(self.poses[name], mechanism.mirrored)
            with errors_of(name):
                own, is_reversed = recipes[name], mechanism.is_reversed
                placed.append(PlacedMechanism(name, own, placement, turn, is_reversed, layer, mechanism.gap))
                layer += placed[-1].layers
        return tuple(placed)

    @property
    def turns(self) -> Real:
        """Rotations of the driver at the frames, (frames,); negative if clockwise."""
        return self.graph.turns if self.drive.speed_rpm > 0 else -self.graph.turns

    @cached_property
    def table(self) -> Table:
        """Positions and angles of all mechanisms over the period."""
        time = 60 * self.graph.turns / abs(self.drive.speed_rpm)
        torques = self.torques
        further = (*torques.columns, *(torques.walking.columns if torques.walking else ()))
        return joined_table(self.turns, time, self.placed, torques.input, further)

    @cached_property
    def torques(self) -> MachineTorques:
        """Torques on the drivers of all mechanisms under their loads, and how the machine walks."""
        recipes, walking, run = moving(self), None, (self.poses, self.turns, self.drive.speed_rpm)
        if feet_of(self.mechanisms):
            walking = MachineWalking(self.graph, self.mechanisms, recipes, *run, self.walker or WalkerTable())
            recipes = {name: walking.on_feet(name, recipe) for name, recipe in recipes.items()}
        fluctuation = self.drive.speed_fluctuation
        return MachineTorques(self.graph, self.mechanisms, recipes, *run, walking, fluctuation)

    @cached_property
    def scene(self) -> Scene:
        """All mechanisms over the period."""
        torques = self.torques
        plots = (*torques.plots, *(torques.walking.plots if torques.walking else ()))
        return joined_scene(self.table, self.placed, self.graph.is_cyclic, plots)

    @cached_property
    def handles(self) -> tuple[SceneHandle, ...]:
        """Those of all mechanisms whose recipes are in this one, and of the phases of those that a shaft turns."""
        own = (handle for mechanism in self.placed if not mechanism.recipe.name for handle in mechanism.handles)
        return (
            *own,
            *(mechanism.phase_handle for mechanism in self.placed if self.mechanisms[mechanism.name].turned_by),
        )

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        parts: list[Part] = []
        for mechanism in self.placed:
            with errors_of(mechanism.name):
                parts += mechanism.parts
        return tuple(parts)

    @cached_property
    def shafts(self) -> tuple[ShaftFit, ...]:
        """The shafts that join mechanisms, in the layers of the machine."""
        return tuple(shaft_fits(self.graph, self.placed))

    @property
    def assembly(self) -> MachineAssembly:
        """One bill of all mechanisms and of the shafts that join them."""
        return MachineAssembly(self.mechanisms, self.recipes, self.shafts)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        own = checks_of(self, "design_checks")
        shafts = (check for shaft in self.shafts for check in shaft.checks(self.placed))
        standing = self.torques.walking.checks if self.torques.walking else ()
        return (*own, *shafts, *motor_room(self.graph, self.placed), *standing, *self.torques.checks)

    @property
    def motion_checks(self) -> tuple[Check, ...]:
        return (*checks_of(self, "motion_checks"), *self.torques.checks)

    def wall_advice(self, part: Part) -> str:
        owners = [name for name in self.recipes if part.name.startswith(f"{name}_".replace(" ", "_"))]
        if not owners:
            return super().wall_advice(part)
        name = max(owners, key=len)
        own = part.name.removeprefix(f"{name}_".replace(" ", "_"))
        return f"{name}: {self.recipes[name].wall_advice(replace(part, name=own))}"

    @cached_property
    def body_masses(self) -> Mapping[str, Mass]:
        """Mass of each body of all mechanisms whose stock names a material."""
        masses = {name: recipe.body_masses for name, recipe in self.recipes.items()}
        return {f"{name}/{body}": mass for name, bodies in masses.items() for body, mass in bodies.items()}

    @property
    def sources(self) -> Mapping[str, str]:
        """The recipes that are files, and the files that these read."""
        own = {f"{recipe.name}.toml": to_toml(recipe) for recipe in self.recipes.values() if recipe.name}
        return own | {name: text for recipe in self.recipes.values() for name, text in recipe.sources.items()}

    @property
    def assumed_fits(self) -> Mapping[str, float]:
        """Those of each mechanism, whose kerf is that of the machine."""
        return dict(super().assumed_fits) | {
            f"mechanisms.{name}.recipe.{key}": value
            for name, mechanism in self.mechanisms.items()
            for key, value in mechanism.recipe.assumed_fits.items()
            if key != "files.kerf"
        }

    @property
    def notes(self) -> Mapping[str, object]:
        graph = self.graph
        turns = {name: str(graph.period * speed) for name, speed in graph.speeds.items()}
        return {
            "period_turns": {"driver": str(graph.period), **turns},
            **gear_notes(self.recipes),
            **_results_of(self.recipes),
            **(self.torques.walking.summary if self.torques.walking else {}),
            **self.torques.summary,
            **assembly_summary(self),
        }

    @property
    def remarks(self) -> tuple[str, ...]:
        """Those of each mechanism, and where the weight of a walker is."""
        own = (f"{name}: {marked(remark)}" for name, recipe in self.recipes.items() for remark in recipe.remarks)
        return (*own, *(self.torques.walking.remarks if self.torques.walking else ()))

    @property
    def facts(self) -> tuple[str, ...]:
        """The speed of each mechanism and the period."""
        speeds = (f"{name} {speed}" for name, speed in self.graph.speeds.items())
        return (
            f"rotations for one of the driver: {', '.join(speeds)}",
            f"the motion repeats after {_turns(self.graph.period)} of the driver",
        )

    @property
    def quantities(self) -> Mapping[str, str]:
        """The period and the speed of each mechanism."""
        speeds = {f"speed of {name}": f"{speed} of the driver's" for name, speed in self.graph.speeds.items()}
        of_mechanisms = {
            f"{name}: {label}": text
            for name, recipe in self.recipes.items()
            for aspect in _own_aspects(recipe)
            for label, text in aspect.quantities.items()
        }
        return {"period": f"{_turns(self.graph.period)} of the driver", **speeds, **of_mechanisms}

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """A gear pair that turns a crank, or the cranks of legs."""
        pair = from_table({"kind": "gear-pair", **EXAMPLE_PAIR})
        if "walker" in tables:
            legs = from_table({"kind": "four-bar", **EXAMPLE_LEGS})
            leg = Mechanism(recipe=legs, turned_by="pair.second", foot="coupler_point")
            carried = WalkerTable(carried=(CarriedMass(0.5),))
            return {"mechanisms": {"pair": Mechanism(recipe=pair), "legs": leg}, "walker": carried}
        crank = from_table({"kind": "slider-crank", **EXAMPLE_CRANK})
        return {
            "mechanisms": {"pair": Mechanism(recipe=pair), "pump": Mechanism(recipe=crank, turned_by="pair.second")}
        }


def _own_aspects(recipe: AbstractRecipe) -> Iterator[AbstractAspect[Any, Any]]:
    """The aspects of a mechanism but its loads, which the machine adds up."""
    return (aspect for aspect in getattr(recipe, "aspects", ()) if aspect.key != "loads")


def _results_of(recipes: Mapping[str, AbstractRecipe]) -> dict[str, object]:
    """Results of the mechanisms, such as dwells, by name; empty without any."""
    results = {
        name: {key: value for aspect in _own_aspects(recipe) for key, value in aspect.entries.items()}
        for name, recipe in recipes.items()
    }
    known = {name: entries for name, entries in results.items() if entries}
    return {"results_of_mechanisms": known} if known else {}


def _turns(count: object) -> str:
    return f"{count} turn{'s' if count != 1 else ''}"


def alone(mechanisms: Mapping[str, Mechanism]) -> Mapping[str, AbstractRecipe]:
    """The recipe of each mechanism as if it stood alone; equal ones are the same object."""
    recipes: list[AbstractRecipe] = []
    for mechanism in mechanisms.values():
        equal = (r for r in recipes if type(r) is type(mechanism.recipe) and r == mechanism.recipe)
        recipes.append(next(equal, mechanism.recipe))
    return dict(zip(mechanisms, recipes))


def print_mechanisms(machine: MachineRecipe) -> None:
    """Print all mechanisms as the machine is printed."""
    printed = {}
    for name, mechanism in machine.mechanisms.items():
        if (inner := mechanism.recipe).printing == machine.printing:
            continue
        if machine.printing is None:
            remedy = "give the table printing of the machine, which is that of all its mechanisms"
            raise DesignError(f"mechanisms.{name}.recipe.printing", "is given", remedy, "conflict")
        with errors_of(name):
            recipe = replace(inner, printing=machine.printing).with_name(inner.name)
        object.__setattr__(recipe, "loaded_table", inner.loaded_table)
        printed[name] = replace(mechanism, recipe=recipe)
    if printed:
        object.__setattr__(machine, "mechanisms", {**machine.mechanisms, **printed})


def gear_notes(recipes: Mapping[str, AbstractRecipe]) -> Mapping[str, object]:
    """Data of the teeth and meshes of each mechanism, as drawings state them."""

    def is_geometry(key: str, note: object) -> bool:
        return key in TEETH or (isinstance(note, Mapping) and "centre_distance_mm" in note)

    found = {}
    for name, recipe in recipes.items():
        # Those of aspects, such as loads, are not needed.
        notes = recipe.own_notes[0] if isinstance(recipe, AbstractComposedRecipe) else recipe.notes
        if geometry := {key: note for key, note in notes.items() if is_geometry(key, note)}:
            found[name] = geometry
    return {"mechanisms": found} if found else {}


def moving(machine: MachineRecipe) -> Mapping[str, AbstractRecipe]:
    """The recipe of each mechanism at its speed and in its position, without the torques that others take from it."""
    placed: dict[tuple[int, Setting], AbstractRecipe] = {}
    recipes = {}
    for name, recipe in alone(machine.mechanisms).items():
        # In this order, by which a mechanism at the ratio 1 has the loads of its own recipe to the last digit.
        speed = float(machine.graph.speeds[name]) * machine.drive.speed_rpm * np.pi / 30
        setting = ShaftPlacement(machine.poses[name], machine.mechanisms[name].mirrored).setting(speed)
        key = (id(recipe), setting if recipe.depends_on_setting else ALONE)
        recipes[name] = placed.setdefault(key, recipe.in_setting(setting))
    return recipes


def check_settings(key: str, mechanism: Mechanism) -> None:
    """DesignError for a key of a mechanism that would count for nothing in a machine. key: of the mechanism."""
    for path in (*OF_MACHINE, *(OF_DRIVER if mechanism.turned_by else ())):
        table, _, name = path.partition(".")
        if getattr(getattr(mechanism.recipe, table, None), name, None):
            problem = "is given, but the machine sets speed and motor of this mechanism"
            raise DesignError(f"{key}.recipe.{path}", problem, "omit it", "conflict")


def check_gravity(mechanisms: Mapping[str, Mechanism]) -> None:
    """DesignError for two gravities in one machine."""
    loads = {name: getattr(mechanism.recipe, "loads", None) for name, mechanism in mechanisms.items()}
    known = {name: gravity for name, own in loads.items() if (gravity := getattr(own, "gravity_m_per_s2", None))}
    first = next(iter(known), "")
    for name, gravity in known.items():
        if gravity != known[first]:
            problem = f"found {list(gravity)}, but {first} has {list(known[first])}"
            remedy = "give all mechanisms with loads the gravity of the machine"
            raise DesignError(f"mechanisms.{name}.recipe.loads.gravity_m_per_s2", problem, remedy, "conflict")


def checks_of(machine: MachineRecipe, kind: Literal["design_checks", "motion_checks"]) -> Iterator[Check]:
    """Checks of all mechanisms under the names of the machine; their columns and positions are not those of it."""
    for name, recipe in machine.recipes.items():
        # A recipe in a file of its own has no keys in this one.
        is_file, key = machine.mechanisms[name].recipe.is_in_own_file, f"mechanisms.{name}.recipe"
        with errors_of(name):
            checks: tuple[Check, ...] = getattr(recipe, kind)
        for check in checks:
            if check.id == "motor_torque":
                continue  # The machine has one check of the motor on its driver.
            id, reason = f"{name}_{check.id}".replace(" ", "_"), recipe.expected_failures.get(check.id, "")
            check = before_scaling(recipe, check)
            inner = () if is_file else tuple(suggestion.under(key) for suggestion in check.suggestions)
            yield replace(
                check, id=id, name=f"{name}: {check.name}", column="", at=None, expected=reason, suggestions=inner
            )


EXAMPLE_PAIR: dict[str, object] = {
    "first": {"teeth": 12, "module": 2, "profile_shift": 0.3},
    "second": {"teeth": 36, "module": 2},
    "first_stock": {"thickness": 4, "bore": 4},
    "second_stock": {"thickness": 4, "bore": 4},
    "base": {},
}
EXAMPLE_CRANK: dict[str, object] = {
    "linkage": {"crank": 20, "coupler": 70},
    "stock": {"thickness": 4, "pin_diameter": 4},
}
# Six legs of which three always stand, and whose feet are level for a third of the turn: found by a random search.
EXAMPLE_LEGS: dict[str, object] = {
    "linkage": {
        "ground": 58,
        "crank": 20,
        "coupler": 53,
        "rocker": 44,
        "coupler_point": [69, 67],
        "ground_angle_deg": 150,
    },
    "copies": [{"mirrored": True}, *({"phase_deg": p, "mirrored": m} for p in (120, 240) for m in (False, True))],
    "stock": {"thickness": 4, "pin_diameter": 4, "material": "birch-plywood"},
}
