"""Recipe of a gear train, and its scene: all gears in mesh, in their layers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import ClassVar, Literal

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import Ratio, entry, quantity, to_digits
from ...core.records import record
from ...core.units import mm
from ...making.assembly import Assembly, BaseStock
from ...making.materials import MATERIALS
from ...model.check import Check
from ...model.motor import RotatingBody
from ...model.part import Part
from ...model.scene import Plot, Scene, SceneBody, SceneCurve, SceneHandle, circle_handle, dimension, point_handle
from ...model.table import Table
from ...plane.curve import Moved
from ...plane.primitives import Circle
from ...plane.vec import Pose, Real
from ...recipe.recipe import Additions, assembly_summary
from ...recipe.settings import Files
from ..checks import TrainLoads, TrainStrength, gear_checks, mesh_checks
from ..cutters import LARGEST
from ..parts import GearStock
from ..parts_train import ArborStock, TrainStocks, arbor_check, train_assembly, train_parts
from ..scene import (
    MOST_PITCHES,
    Meshing,
    axis_mark,
    bodies_at,
    centre_distance,
    contact_marks,
    meshing_scene,
    pitches_in_contact,
    turned_scene,
)
from ..scene_pairs import LineOfAction
from ..train import (
    FEWEST_TEETH,
    LARGEST_RATIO,
    MOST_SEARCHED,
    MOST_TEETH,
    Direction,
    GearTrain,
    Stages,
    gear_train,
    train_table,
    turn_columns,
)
from .helical import (
    LEAST_EFFICIENCY,
    Measuring,
    boss_checks,
    check_tooth_points,
    gear_notes,
    measuring_entry,
    mesh_notes,
)
from .loaded import AbstractLoadedRecipe, LoadedMeshes, loaded_materials, train_strength_notes


@checked
def train_scene(train: GearTrain, parts: Sequence[Part] = ()) -> Scene:
    """The scene of a gear train whose first gear turns counterclockwise.

    Parameters
    ----------
    train : GearTrain
        The train.
    parts : sequence of Part, optional
        The result of `train_parts`.

    Returns
    -------
    Scene
        Each gear is a body in the layer of its stage. The contacts are those of the first stage.

    Notes
    -----
    Derived here.
    """
    frames = _frames(train)
    pair, direction = train.pairs[0], train.directions[0]
    line, (start, _), pitch = LineOfAction(pair), pair.contact_lengths, pair.first.base_pitch
    roll = (start + pitch * frames.passed) / pair.first.base_radius
    axes = train.axes
    bodies = train_bodies(train, parts, roll + line.flank_turn + float(np.angle(direction / 1j)))
    curves = list[SceneCurve]()
    for k, (mesh, unit) in enumerate(zip(train.pairs, train.directions)):
        # A pair's contact is on +y of its driver.
        frame = Pose(complex(axes[k]), complex(unit / 1j))
        curves += _pitch_circles(train, k)
        path = LineOfAction(mesh).between(*mesh.contact_lengths)
        curves.append(SceneCurve(Moved(path, frame), "contact", f"path of contact of stage {k + 1}"))
        curves.append(_distance(train, k))
    contacts = axes[0] + direction / 1j * line.place(start + pitch * frames.all_since)
    marks = [axis_mark(frames, axis, label) for label, axis in _axes(train).items()]
    marks += contact_marks(contacts)
    columns = tuple(turn_columns(train, roll - roll[0]))
    plots = (Plot("rotations", tuple(column.id for column in columns[1:])),)
    return meshing_scene(Table(columns), frames, bodies, curves, marks, plots)


def train_bodies(train: GearTrain, parts: Sequence[Part], turn: Real) -> tuple[SceneBody, ...]:
    """The gears at rotations of the first one, rad, (frames,), each in the layer of its stage, and the ground."""
    poses, still = train.poses(turn), np.zeros(turn.shape, complex)
    bodies, layers = {"ground": Pose(still, still + 1)}, {"ground": 0}
    for k in range(len(train.stages)):
        for name, pose in ((f"driver_{k + 1}", poses[k]), (f"driven_{k + 1}", poses[k + 1])):
            bodies[name], layers[name] = pose, k + 1
    return bodies_at(parts, bodies, layers=layers)


def turned_train_scene(train: GearTrain, parts: Sequence[Part], turn: Real) -> Scene:
    """The scene of a train as a part of a machine. turn: of the first gear, rad, (frames,)."""
    circles = (circle for k in range(len(train.stages)) for circle in _pitch_circles(train, k))
    return turned_scene(turn_columns(train, turn), train_bodies(train, parts, turn), circles, _axes(train))


def _axes(train: GearTrain) -> dict[str, complex]:
    return {f"arbor {letter}": axis for letter, axis in train.arbor_axes.items()}


def _pitch_circles(train: GearTrain, k: int) -> Iterator[SceneCurve]:
    for name, radius, axis in zip(("driver", "driven"), train.pairs[k].working_radii, train.axes[k : k + 2]):
        yield SceneCurve(Circle(complex(axis), radius), "pitch", f"pitch circle of {name}_{k + 1}")


def _distance(train: GearTrain, k: int) -> SceneCurve:
    start, end = (complex(z) for z in train.axes[k : k + 2])
    if k == 0:
        return centre_distance(start, end)
    return dimension(start, end, f"centre distance {mm(abs(end - start)):.5g} of stage {k + 1}")


def _frames(train: GearTrain) -> Meshing:
    """The pitches of the first gear after which all gears are where they began, or as many as a scene may have."""
    teeth, contact_ratio = train.stages[0][0], train.pairs[0].contact_ratio
    period = lcm(pitches_in_contact(contact_ratio), *(Fraction(speed, teeth).denominator for speed in train.speeds))
    return Meshing(contact_ratio, min(period, MOST_PITCHES), period <= MOST_PITCHES)


def train_handles(train: GearTrain, are_stages_given: bool, are_directions_given: bool) -> Iterator[SceneHandle]:
    """Handles of the module of a train, of its directions and, if the recipe gives them, of its numbers of teeth.

    Parameters
    ----------
    train : GearTrain
        The train.
    are_stages_given : bool
        Whether the recipe gives the numbers of teeth.
    are_directions_given : bool
        Whether the recipe gives the directions.

    Returns
    -------
    iterator of SceneHandle
    """
    axes = train.axes
    radius = train.pairs[0].first.root_radius
    yield circle_handle("train.module", radius=radius, label="module")
    for k, pair in enumerate(train.pairs):
        if are_stages_given:
            for j, (name, gear_radius) in enumerate(zip(("driver", "driven"), pair.working_radii)):
                label = f"teeth of {name}_{k + 1}"
                yield circle_handle(f"train.stages[{k}][{j}]", radius=gear_radius, centre=axes[k + j], label=label)
        if are_directions_given:
            yield point_handle(f"train.directions_deg[{k}]", at=axes[k + 1], label=f"direction of stage {k + 1}")


@record(checked=True)
class TrainSpecification:
    """The wanted ratio of a train, within bounds, or the teeth of all its stages."""

    module: float = quantity("pitch diameter per tooth of all gears", "mm", above=0, at_most=LARGEST, example=2.5)
    ratio: Ratio | None = quantity(
        'wanted rotations of the first gear for one of the last, in either direction, such as 12 or "10/3"; '
        "give this or stages",
        default=None,
        at_least=1 / LARGEST_RATIO,
        at_most=LARGEST_RATIO,
        example=12,
    )
    stages: Stages | None = entry(
        "teeth of driver and driven gear of each stage, such as [[10, 30], [8, 32]]; give this or ratio", default=None
    )
    least_teeth: int = quantity(
        "least number of teeth of a gear, for a wanted ratio",
        whole=True, default=12, at_least=FEWEST_TEETH, at_most=MOST_TEETH,
    )  # fmt: skip
    most_teeth: int = quantity(
        "largest number of teeth of a gear, for a wanted ratio",
        whole=True, default=60, at_least=FEWEST_TEETH, at_most=MOST_TEETH,
    )  # fmt: skip
    most_stages: int = quantity(
        "largest number of stages, for a wanted ratio", whole=True, default=3, at_least=1, at_most=MOST_SEARCHED
    )
    error: float = quantity(
        "largest relative error of the wanted ratio; 0 for an exact train", default=0.0, at_least=0, at_most=0.5
    )
    arrangement: Literal["line", "reverted"] = entry(
        "arbors in a line, or two stages with input and output on one axis", default="line"
    )
    centre_distance: float | None = quantity(
        "centre distance of every stage, for a wanted ratio; free if omitted", "mm", default=None, above=0, at_most=1e9
    )
    directions_deg: tuple[Direction, ...] = entry(
        "direction from each arbor to the next one, deg; by default that of the arrangement", default=()
    )
    backlash: float = quantity(
        "backlash of each mesh along the pitch circles", "modules", default=0.04, at_least=0, at_most=0.5, printed=1.0
    )
    friction: float = quantity(
        "mean coefficient of friction of the flanks, for the efficiency", default=0.1, at_least=0, at_most=1
    )

    def __post_init__(self) -> None:
        if (self.ratio is None) == (self.stages is None):
            number = "neither" if self.ratio is None else "both"
            raise DesignError("ratio", f"found {number} ratio and stages", "give one of them", "conflict")
        if self.arrangement == "reverted" and self.directions_deg:
            problem = "found directions for a reverted train"
            raise DesignError("directions_deg", problem, 'omit them, or give arrangement = "line"', "conflict")
        self.train  # noqa: B018  raises if no train has the ratio, or the gears do not mesh

    @cached_property
    def train(self) -> GearTrain:
        """The given train, or the one of the wanted ratio."""
        reverted = self.arrangement == "reverted"
        if self.stages is not None:
            directions = tuple(180.0 * (k % 2) for k in range(len(self.stages))) if reverted else self.directions_deg
            train = GearTrain(self.stages, self.module, directions, self.backlash, self.friction)
            if reverted:
                self._check_reverted(train)
            return train
        assert self.ratio is not None
        train = gear_train(
            self.ratio,
            self.module,
            least_teeth=self.least_teeth,
            most_teeth=self.most_teeth,
            most_stages=self.most_stages,
            error=self.error,
            reverted=reverted,
            centre_distance=self.centre_distance,
        )
        directions = train.directions_deg or self.directions_deg
        return replace(train, directions_deg=directions, backlash=self.backlash, friction=self.friction)

    def _check_reverted(self, train: GearTrain) -> None:
        if len(train.stages) % 2 == 0 and train.arbors[-1] == train.arbors[0]:
            return
        sums = ", ".join(str(a + b) for a, b in train.stages)
        problem = f"found stages of {sums} teeth, whose input and output are not on one axis"
        raise DesignError("stages", problem, "give two stages with equal sums of teeth", "conflict")


@record(kw_only=True)
class GearTrainRecipe(AbstractLoadedRecipe):
    """A compound gear train with a wanted ratio: gears joined on their arbors, and the plate that holds the arbors."""

    additions: ClassVar[Additions] = Additions(("stock.motor", "last_stock.motor"))
    kind: Literal["gear-train"] = "gear-train"
    train: TrainSpecification
    stock: ArborStock = entry("sheet and bore of all gears, and their pins", default=ArborStock())
    first_stock: GearStock | None = entry(
        "sheet, bore and motor of the driving gear; if omitted, those of the others", default=None
    )
    last_stock: GearStock | None = entry(
        "sheet and bore of the last gear; if omitted, those of the others", default=None
    )
    base: BaseStock = entry("the plate that holds the arbors", default=BaseStock())
    loads: TrainLoads | None = entry(
        "torque on the last gear, for the torque of the first and for strength; the stocks then name their material",
        default=None,
    )
    measuring: Measuring | None = measuring_entry()
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.stocks.gears(self.design)
        for aspect in self.aspects:
            aspect.check()

    def loaded(self, loads: TrainLoads) -> LoadedMeshes:
        gears = self.stocks.gears(self.design)
        loaded_materials(**{gear.key: gear.stock.material for gear in gears})
        materials = tuple(gear.stock.material for gear in gears if gear.stock.material)
        strength = TrainStrength(self.design, loads, self.stock.thickness, materials)
        stages = {f"stage_{k}": stage for k, stage in enumerate(strength.stages, 1)}
        summary = train_strength_notes(strength)
        limit, torque = strength.torque_limit, strength.input_torque
        return LoadedMeshes(strength, stages, limit, summary, torque, "loads.output_torque_n_mm")

    @cached_property
    def design(self) -> GearTrain:
        """The given train, or the one of the wanted ratio."""
        return self.train.train

    @property
    def stocks(self) -> TrainStocks:
        """Sheets, bores and pins."""
        return TrainStocks(self.stock, self.first_stock, self.last_stock, self.base)

    @property
    def own_table(self) -> Table:
        return train_table(self.design)

    @property
    def own_checks(self) -> tuple[Check, ...]:
        train, gears = self.design, self.stocks.gears(self.design)
        meshes = (check for k, pair in enumerate(train.pairs, 1) for check in mesh_checks(pair, f"stage_{k}"))
        teeth = (check for g in gears for check in gear_checks(g.gear, g.stock.rim_under(g.gear), g.name))
        boss = boss_checks("driver_1", gears[0].gear.root_radius, gears[0].stock.motor, self.base)
        return (*meshes, *teeth, *boss, arbor_check(train, self.stocks))

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        check_tooth_points(self.files, [g.gear.outline for g in self.stocks.gears(self.design)])
        return train_parts(self.design, self.stocks)

    @cached_property
    def assembly(self) -> Assembly:
        """Arbors, collars, pins and screws, and the steps of assembly."""
        return train_assembly(self.design, self.stocks)

    @property
    def own_scene(self) -> Scene:
        """All gears in mesh."""
        return train_scene(self.design, self.parts)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """All gears."""
        train, bodies = self.design, {}
        shares = (1.0, *np.cumprod(np.maximum(train.efficiencies, LEAST_EFFICIENCY)).tolist())
        for k in range(len(train.stages)):
            for name, j in ((f"driver_{k + 1}", k), (f"driven_{k + 1}", k + 1)):
                bodies[name] = RotatingBody(complex(train.axes[j]), train.speeds[j], True, shares[j])
        return bodies

    def scene_at(self, turn: Real) -> Scene:
        return turned_train_scene(self.design, self.parts, turn)

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(train_handles(self.design, self.train.stages is not None, bool(self.train.directions_deg)))

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """The bore of the other gears, and materials, if loads are requested."""
        material = MATERIALS["steel-C45"] if "loads" in tables else None
        ends = [key for key in ("first_stock", "last_stock") if key in tables]
        stocks = {key: GearStock(bore=ArborStock().bore, material=material) for key in ends}
        return stocks | ({"stock.material": material} if material else {})

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        train = self.design
        notes = {
            "train": {
                "stages": [list(teeth) for teeth in train.stages],
                "ratio": to_digits(train.ratio),
                **({} if self.train.ratio is None else {"error": to_digits(abs(train.ratio) / self.train.ratio - 1)}),
                "efficiency": to_digits(train.efficiency),
                "axes_mm": [[round(z.real, 6) + 0.0, round(z.imag, 6) + 0.0] for z in train.axes.tolist()],
            },
            **{
                f"stage_{k}": {**mesh_notes(pair), "efficiency": to_digits(efficiency)}
                for k, (pair, efficiency) in enumerate(zip(train.pairs, train.efficiencies), start=1)
            },
            "measures_mm": {g.name: gear_notes(g.gear, measuring=self.measuring) for g in self.stocks.gears(train)},
        }
        return notes, assembly_summary(self)

    @property
    def facts(self) -> tuple[str, ...]:
        """The stages that were found, the ratio, the efficiency, and the torque on the first gear under loads."""
        train, loads = self.design, self.aspect("loads")
        stages = " x ".join(f"{driven}/{driver}" for driver, driven in train.stages)
        return (
            f"stages {stages}, ratio {to_digits(train.ratio):.9g}",
            f"efficiency {train.efficiency:.3f} at friction {train.friction:g}, without bearings",
            *((f"torque on the first gear {loads.meshes.strength.input_torque:.4g} N mm",) if loads else ()),
        )
