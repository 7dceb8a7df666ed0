"""Mechanisms of a machine: own recipes, inline or in files, their places, parts, and scenes joined to one."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, NoReturn

import numpy as np

from ..core.errors import DesignError, RecipeError, shown
from ..core.field_visitor import WrittenForm
from ..core.fields import FARTHEST, entry, quantity
from ..core.names import LONGEST, read_text_file
from ..core.records import record
from ..core.units import marked
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneBody, SceneHandle
from ..model.table import Column, Table
from ..plane.vec import Complex, Real
from ..recipe.aspect import ShaftPlacement, layer_heights
from ..recipe.load import from_table
from ..recipe.recipe import AbstractRecipe
from ..recipe.toml import LARGEST, parsed

# The name of a recipe's file: no folder.
FILE_NAME = re.compile(r"[^/\\]+\.toml")


class RecipeOrFile(WrittenForm):
    """Marks a recipe that a table gives inline, or by the name of a file next to the file of the table."""

    def read(self, given: Any, folder: Any) -> Any:
        return _read(given, folder)

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        return f"{value.name}.toml" if value.name else write(value)


def _read(given: object, folder: Any) -> AbstractRecipe:
    """The recipe of an inline table or of a file in the folder."""
    if isinstance(given, AbstractRecipe):
        return given
    try:
        file, table = "recipe", given
        if isinstance(given, str):
            if not FILE_NAME.fullmatch(given):
                remedy = 'give the name of a file next to this one, such as "leg.toml"'
                raise DesignError("", f"found {shown(given)}", remedy, "out-of-range")
            file = given
            text = read_text_file(given, folder, "the file of a recipe")
            if len(text) > LARGEST:
                problem = f"{given} is larger than {LARGEST:,} bytes"
                raise DesignError("", problem, "give a recipe, a short TOML file", "too-much-work")
            table = parsed(text, given)
        if not isinstance(table, Mapping):
            remedy = 'give a file next to this one, such as "leg.toml", or a table with kind'
            raise DesignError("", f"found {shown(given)}", remedy, "wrong-type")
        # A machine is refused before its own mechanisms are read, for files may name each other in a circle.
        if table.get("kind") == "machine":
            refuse_machine()
        recipe = from_table(table, file, folder)
        return recipe.with_name(file.removesuffix(".toml")) if isinstance(given, str) else recipe
    except RecipeError as error:
        first = error.problems[0]
        raise DesignError(first.key, first.problem, first.remedy, first.id, first.value) from None


def refuse_machine(key: str = "kind") -> NoReturn:
    """DesignError for a machine as a mechanism of a machine. key: of its kind."""
    remedy = "give its mechanisms in this recipe, or a recipe of another kind"
    raise DesignError(key, "found a machine in a machine", remedy, "conflict")


@record(checked=True, kw_only=True)
class Mechanism:
    """A mechanism of a machine."""

    recipe: Annotated[AbstractRecipe, RecipeOrFile()] = entry(
        'its recipe: a file next to this one, such as "leg.toml", or a table with kind', example="leg.toml"
    )
    turned_by: str | None = entry(
        'the body that turns its driver, such as "pair.second"; omitted for the one that a motor or a hand drives',
        default=None,
    )
    phase_deg: float = quantity(
        "rotation of its driver from its own first position when the machine is at its first", "deg", default=0.0,
        at_least=-360, at_most=360,
    )  # fmt: skip
    angle_deg: float = quantity(
        "rotation of the whole mechanism about the axis of its driver", "deg", default=0.0, at_least=-360, at_most=360
    )
    mirrored: bool = entry(
        "whether it is turned over, left for right, about the axis of its driver; its layers are then reversed too",
        default=False,
    )
    foot: str | None = entry(
        "point of its linkage that stands on the ground and carries its share of the weight of the machine; by default "
        "the foot of its recipe",
        default=None,
    )
    gap: float = quantity(
        "height of the tubes between it and the mechanism below, mm: of nuts, collars and a motor", "mm", default=0.0,
        at_least=0, at_most=FARTHEST,
    )  # fmt: skip
    upside_down: bool = entry("whether its layers are in the reverse order, its ground on top", default=False)

    @property
    def is_reversed(self) -> bool:
        """Whether its layers are in the reverse order in the machine."""
        return self.mirrored != self.upside_down


@contextmanager
def errors_of(name: str) -> Iterator[None]:
    """Name the mechanism in a DesignError of its recipe."""
    try:
        yield
    except DesignError as error:
        field = error.field if error.field.startswith("mechanisms") else f"mechanisms.{name}.recipe.{error.field}"
        raise error.named(field) from None


# Units of the columns that a machine's table takes from those of its mechanisms. Rates are those of another speed.
UNITS = ("mm", "deg")
# Id of the column of the driver's torque.
TORQUE = "input_torque"
# Distance of the handle of a phase from its axis, in sizes of the mechanism.
HANDLE = 0.4
# Difference from a whole turn, rad, below which a driver turns round.
WHOLE = 1e-6


@record(eq=False)
class PlacedMechanism:
    """A mechanism in a machine.

    Parameters
    ----------
    name : str
        Its name in the machine.
    recipe : AbstractRecipe
        Its recipe.
    placement : ShaftPlacement
        Of its frame in that of the machine.
    turn : array, shape (frames,)
        Rotation of its driver from its first position, rad.
    is_reversed : bool
        Whether its layers are in the reverse order.
    first_layer : int
        Its lowest layer in the machine.
    gap : float
        Height of the tubes below it, mm; 0 if unknown.
    """

    name: str
    recipe: AbstractRecipe
    placement: ShaftPlacement
    turn: Real
    is_reversed: bool
    first_layer: int
    gap: float = 0.0

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Its parts under the names of the machine."""
        return tuple(map(self._part, self.recipe.parts))

    def _part(self, part: Part) -> Part:
        name = f"{self.name}_{part.name}"
        if len(name) > LONGEST:
            remedy = f"give {self.name} a shorter name, so that there are at most {LONGEST}"
            problem = f"the name {name} of its part has {len(name)} letters"
            raise DesignError(f"mechanisms.{self.name}", problem, remedy, "out-of-range")
        return replace(part, name=name, body=self._of_body(part.body))

    def _of_body(self, body: str) -> str:
        return f"{self.name}/{body}" if body else ""

    @cached_property
    def _own_scene(self) -> Scene:
        return self.recipe.scene_at(self.turn)

    @property
    def layers(self) -> int:
        """The number of its layers."""
        layers = [body.layer for body in self._own_scene.bodies]
        return 1 + max(layers) - min(layers)

    @cached_property
    def scene(self) -> Scene:
        """Its scene in the frame and the layers of the machine, under the names of the machine."""
        own, placement = self._own_scene, self.placement
        lowest = min(body.layer for body in own.bodies)
        known = {id(part): own_part for part, own_part in zip(self.recipe.parts, self.parts)}

        def body_in_place(body: SceneBody, layer: int) -> SceneBody:
            parts = (known.get(id(part)) or self._part(part) for part in body.parts)
            return replace(
                body,
                name=self._of_body(body.name),
                parts=tuple(map(placement.part, parts)),
                origin=placement.place(body.origin),
                direction=placement.rotated(body.direction),
                layer=layer,
            )

        def turned(vector: Complex | None) -> Complex | None:
            return None if vector is None else placement.vector(vector)

        curves = (
            replace(curve, curve=placement.curve(curve.curve, bool(curve.body)), body=self._of_body(curve.body))
            for curve in own.curves
            if curve.role != "dimension"
        )
        marks = (
            replace(
                mark,
                place=placement.place(mark.place),
                vector=turned(mark.vector),
                direction=turned(mark.direction),
                label=f"{self.name} {marked(mark.label)}" if mark.label else "",
            )
            for mark in own.marks
        )
        regions = (replace(region, curves=tuple(map(placement.curve, region.curves))) for region in own.regions)

        def layer_of(body: SceneBody) -> int:
            layer = body.layer - lowest
            return self.first_layer + (self.layers - 1 - layer if self.is_reversed else layer)

        # Units are assembled each by itself, with its own layers.
        units = {
            f"{self.name}{f', {title}' if title else ''}": tuple(body_in_place(body, body.layer) for body in bodies)
            for title, bodies in (own.units or {"": own.bodies}).items()
        }
        return replace(
            own,
            bodies=tuple(body_in_place(body, layer_of(body)) for body in own.bodies),
            units=units,
            curves=tuple(curves),
            marks=tuple(marks),
            regions=tuple(regions),
        )

    @property
    def phase_handle(self) -> SceneHandle:
        """A handle that turns with its driver, and sets by how much that is turned on its shaft."""
        axis = complex(self.placement.place(next(iter(self.recipe.rotating_bodies.values())).axis))
        low, high = self.scene.box
        arm = self.placement.vector(HANDLE * abs(high - low) * np.exp(1j * self.turn))
        key = f"mechanisms.{self.name}.phase_deg"
        at = axis + np.asarray(arm)
        return SceneHandle(f"phase:{self.name}", f"phase of {self.name}", (key,), at, anchor=np.full_like(at, axis))

    @property
    def handles(self) -> Iterator[SceneHandle]:
        """Handles of its recipe that stay, or whose positions over one turn of the driver are known."""
        scene = self.recipe.scene
        passed = np.radians(np.abs(scene.drive.values - scene.drive.values[0])) if scene else np.zeros(1)
        turn = np.copysign(2 * np.pi, scene.drive.values[-1] - scene.drive.values[0]) if scene else 1.0
        goes_round = scene is not None and scene.cyclic and abs(passed[-1] - 2 * np.pi) < WHOLE
        for handle in self.recipe.handles:
            at = np.broadcast_to(handle.at, passed.shape)
            if np.abs(at - at[0]).max() == 0:
                at = at[:1]
            elif goes_round:
                at = np.interp(np.abs(np.remainder(self.turn, turn)), passed, at)
            else:
                continue
            # The axis of the driver is where its shaft is, wherever its own recipe has it.
            if handle.shape != "plot" and not handle.id.startswith("origin:"):
                yield replace(
                    handle,
                    id=f"{self.name}/{handle.id}",
                    label=f"{self.name}: {marked(handle.label)}",
                    keys=tuple(f"mechanisms.{self.name}.recipe.{key}" for key in handle.keys),
                    at=self.placement.place(at),
                    arrow=complex(self.placement.vector(handle.arrow)),
                    anchor=None,
                )

    @property
    def heights(self) -> dict[int, float]:
        """Thickness of each layer in the machine, mm; a layer of spacers is as thick as the thickest."""
        return layer_heights(self.scene.bodies)

    @property
    def columns(self) -> Iterator[Column]:
        """Rotation of the driver, then positions and angles, under the names of the machine."""
        meaning = f"rotation of the driver of {self.name} from its first position"
        yield Column(f"{self.name}_driver_angle", "deg", meaning, np.degrees(self.turn))
        for column in self._own_scene.table.columns[1:]:
            if column.unit in UNITS:
                yield replace(
                    column,
                    id=f"{self.name}_{column.id}",
                    meaning=f"{self.name}, in its own frame: {marked(column.meaning)}",
                )

    @property
    def main_columns(self) -> dict[str, list[str]]:
        """Unit -> ids of the columns of the first plot of that unit, under the names of the machine."""
        units = {column.id: column.unit for column in self._own_scene.table.columns}
        found: dict[str, list[str]] = {}
        for plot in self._own_scene.plots:
            found.setdefault(units[plot.columns[0]], [f"{self.name}_{id}" for id in plot.columns])
        return {unit: ids for unit, ids in found.items() if unit in UNITS}


def joined_table(
    driver_turns: Real,
    time: Real,
    mechanisms: Sequence[PlacedMechanism],
    torque: Real | None = None,
    further: Iterable[Column] = (),
) -> Table:
    """Driver, time, the columns of all mechanisms, the torque of the driver, N mm, if it is known, and further ones."""
    driver = Column("driver_angle", "deg", "rotation of the machine's driver", 360 * driver_turns)
    columns = [column for mechanism in mechanisms for column in mechanism.columns]
    if torque is not None:
        meaning = "torque on the machine's driver under the loads of its mechanisms, positive with its angle"
        columns.append(Column(TORQUE, "N mm", meaning, torque))
    return Table((driver, Column("time", "s", "time", time), *columns, *further))


def joined_scene(
    table: Table, mechanisms: Sequence[PlacedMechanism], is_cyclic: bool, plots: Iterable[Plot] = ()
) -> Scene:
    """The scenes of all mechanisms as one, with the timing diagrams and further plots."""
    scenes = [mechanism.scene for mechanism in mechanisms]
    # Equal mechanisms in one place leave the same trails, and only the first one's are drawn.
    places = [(id(m.recipe), *(complex(m.placement.place(z)) for z in (0j, 1 + 0j, 1j))) for m in mechanisms]
    first = [places.index(place) == k for k, place in enumerate(places)]
    return Scene(
        table,
        table["time"],
        np.logical_and.reduce([scene.assembled for scene in scenes]),
        tuple(body for scene in scenes for body in scene.bodies),
        tuple(curve for scene in scenes for curve in scene.curves),
        tuple(replace(mark, trail=mark.trail and own) for own, scene in zip(first, scenes) for mark in scene.marks),
        (*timing_diagrams(mechanisms, table), *plots),
        is_cyclic,
        regions=tuple(region for scene in scenes for region in scene.regions),
        units={title: bodies for scene in scenes for title, bodies in scene.units.items()},
    )


def timing_diagrams(mechanisms: Sequence[PlacedMechanism], table: Table) -> Iterator[Plot]:
    """The main columns of all mechanisms over one driver, a plot for each unit; the positions first."""
    main: Mapping[str, list[str]] = {unit: [] for unit in UNITS}
    for mechanism in mechanisms:
        for unit, ids in mechanism.main_columns.items():
            main[unit].extend(id for id in ids if id in table.ids)
    turns = tuple(id for id in table.ids[2:] if id.endswith("_turn"))
    for unit, ids in main.items():
        if ids:
            yield Plot(f"timing diagram, {'positions' if unit == 'mm' else 'angles'}", tuple(ids))
    if turns:
        yield Plot("rotations of wheels", turns)
    if TORQUE in table.ids:
        yield Plot("torque of the driver", (TORQUE,))
