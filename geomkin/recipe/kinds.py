"""The kinds of recipe, one class each. A new kind is one class, and one row in the table here."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from importlib import import_module
from typing import Any

from .recipe import AbstractRecipe


class Kinds(MutableMapping[str, type[AbstractRecipe]]):
    """Name in a recipe -> its class, loaded when first asked for: a recipe of gears loads no linkages.

    rows: name -> `module:Class`, the module relative to this folder, or the class itself.
    """

    def __init__(self, rows: dict[str, str | type[AbstractRecipe]]):
        self.rows = rows

    def __getitem__(self, name: str) -> type[AbstractRecipe]:
        row = self.rows[name]
        if isinstance(row, str):
            module, _, held = row.partition(":")
            row = self.rows[name] = getattr(import_module(module), held)
        return row

    def __setitem__(self, name: str, recipe: type[AbstractRecipe]) -> None:
        self.rows[name] = recipe

    def __delitem__(self, name: str) -> None:
        del self.rows[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)


KINDS = Kinds({
    "four-bar": "geomkin.linkage.kinds.linkages:FourBarRecipe",
    "slider-crank": "geomkin.linkage.kinds.linkages:SliderCrankRecipe",
    "inverted-slider-crank": "geomkin.linkage.kinds.linkages:InvertedSliderCrankRecipe",
    "stephenson-six-bar": "geomkin.linkage.kinds.linkages:StephensonSixBarRecipe",
    "watt-six-bar": "geomkin.linkage.kinds.linkages:WattSixBarRecipe",
    "shaper": "geomkin.linkage.kinds.linkages:ShaperRecipe",
    "pantograph": "geomkin.linkage.kinds.pantograph:PantographRecipe",
    "elliptic-trammel": "geomkin.linkage.kinds.linkages:EllipticTrammelRecipe",
    "scotch-yoke": "geomkin.linkage.kinds.linkages:ScotchYokeRecipe",
    "oldham-coupling": "geomkin.linkage.kinds.linkages:OldhamCouplingRecipe",
    "linkage": "geomkin.linkage.kinds.linkages:LinkageRecipe",
    "four-bar-atlas": "geomkin.linkage.kinds.coupler_curves:FourBarAtlasRecipe",
    "slider-crank-atlas": "geomkin.linkage.kinds.coupler_curves:SliderCrankAtlasRecipe",
    "cognates": "geomkin.linkage.kinds.coupler_curves:CognatesRecipe",
    "inflection-circle": "geomkin.linkage.kinds.instants:InflectionCircleRecipe",
    "centrodes": "geomkin.linkage.kinds.instants:CentrodesRecipe",
    "polygons": "geomkin.linkage.kinds.polygons:PolygonsRecipe",
    "shaking-force": "geomkin.linkage.kinds.shaking_force:ShakingForceRecipe",
    "crank-rocker-synthesis": "geomkin.synthesis.kinds.rockers:CrankRockerRecipe",
    "double-rocker-synthesis": "geomkin.synthesis.kinds.rockers:DoubleRockerRecipe",
    "slider-crank-stroke": "geomkin.synthesis.kinds.rockers:SliderCrankStrokeRecipe",
    "burmester-curves": "geomkin.synthesis.kinds.burmester_curves:BurmesterCurvesRecipe",
    "body-guidance": "geomkin.synthesis.kinds.body_guidance:BodyGuidanceRecipe",
    "function-generator": "geomkin.synthesis.kinds.function_generators:FunctionGeneratorRecipe",
    "slider-function-generator": "geomkin.synthesis.kinds.function_generators:SliderFunctionGeneratorRecipe",
    "path-generator": "geomkin.synthesis.kinds.path_generator:PathGeneratorRecipe",
    "disk-cam": "geomkin.cam.kinds.disk_cam:DiskCamRecipe",
    "spur-gear": "geomkin.gear.kinds.single_gears:SpurGearRecipe",
    "ring-gear": "geomkin.gear.kinds.single_gears:RingGearRecipe",
    "gear-pair": "geomkin.gear.kinds.gear_pairs:GearPairRecipe",
    "rack-and-pinion": "geomkin.gear.kinds.gear_pairs:RackAndPinionRecipe",
    "planetary": "geomkin.gear.kinds.planetary:PlanetaryRecipe",
    "straight-sided-gears": "geomkin.gear.kinds.conjugate_gears:StraightSidedGearsRecipe",
    "point-tooth-gears": "geomkin.gear.kinds.conjugate_gears:PointToothGearsRecipe",
    "lantern-gears": "geomkin.gear.kinds.conjugate_gears:LanternGearsRecipe",
})  # fmt: skip


def _classes() -> dict[str, str]:
    """Name of a class -> the kind that it is of."""
    return {row.partition(":")[2] if isinstance(row, str) else row.__name__: kind for kind, row in KINDS.rows.items()}


def __getattr__(name: str) -> Any:
    """The class of a kind, such as `SpurGearRecipe`, to build its recipes in Python."""
    if kind := _classes().get(name):
        return KINDS[kind]
    raise AttributeError(f"{__name__} has no {name!r}")


def __dir__() -> list[str]:
    return ["KINDS", "Kinds", *_classes()]
