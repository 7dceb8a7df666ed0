"""Recipe of a gear train."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Literal

from ...core.errors import DesignError
from ...core.fields import Ratio, entry, quantity, to_digits
from ...core.records import record
from ...making.assembly import Assembly, BaseStock
from ...making.materials import MATERIALS
from ...model.check import Check
from ...model.motor import RotatingBody
from ...model.part import Part
from ...model.scene import Scene, SceneHandle
from ...model.table import Table
from ...plane.vec import Real
from ...recipe.recipe import assembly_summary
from ...recipe.settings import Files
from ..checks import gear_checks, mesh_checks
from ..cutters import LARGEST
from ..output_loads import TrainLoads, TrainStrength
from ..parts import GearStock
from ..parts_train import ArborStock, TrainStocks, arbor_check, train_assembly, train_parts
from ..scene_train import train_handles, train_scene, turned_train_scene
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
)
from .helical import boss_checks, check_tooth_points, gear_notes, mesh_notes
from .loaded import AbstractLoadedRecipe, LoadedMeshes, loaded_materials, train_strength_notes


@record(checked=True)
class TrainSpecification:
    """The wanted ratio of a train, within bounds, or the teeth of all its stages.

    Parameters
    ----------
    module : float
        Pitch diameter per tooth of all gears, mm.
    ratio : float, optional
        Rotations of the first gear for one of the last, in either direction; in a recipe also a fraction such as
        "10/3". Give this or `stages`.
    stages : tuple of tuple of int, optional
        Teeth of the driver and of the driven gear of each stage.
    least_teeth, most_teeth, most_stages : int, optional
        Bounds of a wanted ratio's train.
    error : float, optional
        Largest relative error of a wanted ratio; 0 for an exact train.
    arrangement : {"line", "reverted"}, optional
        Arbors in a line, or two stages with input and output on one axis.
    centre_distance : float, optional
        Centre distance of every stage of a wanted ratio's train, mm; free if omitted.
    directions_deg : tuple of float, optional
        Direction from each arbor to the next one, deg; by default that of the arrangement.
    backlash : float, optional
        Backlash of each mesh along the pitch circles, modules.
    friction : float, optional
        Mean coefficient of friction of the flanks, for the efficiency.
    """

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
        whole=True,
        default=12,
        at_least=FEWEST_TEETH,
        at_most=MOST_TEETH,
    )
    most_teeth: int = quantity(
        "largest number of teeth of a gear, for a wanted ratio",
        whole=True,
        default=60,
        at_least=FEWEST_TEETH,
        at_most=MOST_TEETH,
    )
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
        "centre distance of every stage, for a wanted ratio; free if omitted",
        "mm",
        default=None,
        above=0,
        at_most=1e9,
    )
    directions_deg: tuple[Direction, ...] = entry(
        "direction from each arbor to the next one, deg; by default that of the arrangement", default=()
    )
    backlash: float = quantity(
        "backlash of each mesh along the pitch circles", "modules", default=0.04, at_least=0, at_most=0.5
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
    """A compound gear train with a wanted ratio: gears joined on their arbors, and the plate that holds the arbors.

    Parameters
    ----------
    train : TrainSpecification
        The wanted ratio, or the teeth of all stages.
    stock : ArborStock, optional
        Sheet and bore of all gears, and the pins that join two gears on an arbor.
    first_stock, last_stock : GearStock, optional
        Sheet and bore of the driving and of the last gear, if different from those of the others.
    base : BaseStock, optional
        The plate that holds the arbors.
    loads : TrainLoads, optional
        Torque on the last gear, for the torque of the first, tooth forces and strength; the stocks then name their
        material.
    files : Files, optional
        Formats and tolerance of the files.
    """

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
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
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
        return LoadedMeshes(strength, stages, strength.torque_limit, summary, "loads.output_torque_n_mm")

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
        for k in range(len(train.stages)):
            for name, j in ((f"driver_{k + 1}", k), (f"driven_{k + 1}", k + 1)):
                bodies[name] = RotatingBody(complex(train.axes[j]), train.speeds[j], is_wheel=True)
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
            "measures_mm": {g.name: gear_notes(g.gear) for g in self.stocks.gears(train)},
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
