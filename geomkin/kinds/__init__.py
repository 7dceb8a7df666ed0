"""The kinds of recipe, one class each. A new kind is one class, and one row in the table here."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from importlib import import_module
from typing import Any

from ..recipe.recipe import AbstractRecipe


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
            row = self.rows[name] = getattr(import_module(f".{module}", __name__), held)
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
    "four-bar": "linkages:FourBarRecipe",
    "slider-crank": "linkages:SliderCrankRecipe",
    "inverted-slider-crank": "linkages:InvertedSliderCrankRecipe",
    "stephenson-six-bar": "linkages:StephensonSixBarRecipe",
    "watt-six-bar": "linkages:WattSixBarRecipe",
    "shaper": "linkages:ShaperRecipe",
    "elliptic-trammel": "linkages:EllipticTrammelRecipe",
    "scotch-yoke": "linkages:ScotchYokeRecipe",
    "oldham-coupling": "linkages:OldhamCouplingRecipe",
    "linkage": "linkages:LinkageRecipe",
    "four-bar-atlas": "coupler_curves:FourBarAtlasRecipe",
    "slider-crank-atlas": "coupler_curves:SliderCrankAtlasRecipe",
    "cognates": "coupler_curves:CognatesRecipe",
    "inflection-circle": "instants:InflectionCircleRecipe",
    "centrodes": "instants:CentrodesRecipe",
    "polygons": "polygons:PolygonsRecipe",
    "shaking-force": "shaking_force:ShakingForceRecipe",
    "crank-rocker": "rocker_goals:CrankRockerRecipe",
    "double-rocker": "rocker_goals:DoubleRockerRecipe",
    "slider-crank-stroke": "rocker_goals:SliderCrankStrokeRecipe",
    "burmester-curves": "burmester_curves:BurmesterCurvesRecipe",
    "body-guidance": "body_guidance:BodyGuidanceRecipe",
    "function-generator": "function_generators:FunctionGeneratorRecipe",
    "slider-function-generator": "function_generators:SliderFunctionGeneratorRecipe",
    "path-generator": "path_generator:PathGeneratorRecipe",
    "disk-cam": "disk_cam:DiskCamRecipe",
    "spur-gear": "single_gears:SpurGearRecipe",
    "ring-gear": "single_gears:RingGearRecipe",
    "gear-pair": "gear_pairs:GearPairRecipe",
    "rack-and-pinion": "gear_pairs:RackAndPinionRecipe",
    "planetary": "planetary:PlanetaryRecipe",
    "straight-sided-gears": "conjugate_gears:StraightSidedGearsRecipe",
    "point-tooth-gears": "conjugate_gears:PointToothGearsRecipe",
    "lantern-gears": "conjugate_gears:LanternGearsRecipe",
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
