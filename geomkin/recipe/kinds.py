"""The table of kinds: the name of each kind of recipe, and where its classes are."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import entry_points

from ..core.errors import GeomkinError, printable
from .recipe import AbstractRecipe

# Other packages add kinds by entry points of this group, each `name = "module:RecipeClass"`.
ENTRY_POINTS = "geomkin.kinds"


@dataclass(frozen=True)
class KindRow:
    """One kind of recipe.

    Parameters
    ----------
    group : str
        Heading under which `geomkin list` shows the kind.
    recipe : str
        Class of its recipes, as `module:Class`. It is imported when the kind is first used.
    """

    group: str
    recipe: str


KINDS: dict[str, KindRow] = {
    "four-bar": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:FourBarRecipe"),
    "slider-crank": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:SliderCrankRecipe"),
    "inverted-slider-crank": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:InvertedSliderCrankRecipe"),
    "stephenson-six-bar": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:StephensonSixBarRecipe"),
    "watt-six-bar": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:WattSixBarRecipe"),
    "shaper": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:ShaperRecipe"),
    "pantograph": KindRow("linkages", "geomkin.linkage.kinds.pantograph:PantographRecipe"),
    "elliptic-trammel": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:EllipticTrammelRecipe"),
    "scotch-yoke": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:ScotchYokeRecipe"),
    "oldham-coupling": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:OldhamCouplingRecipe"),
    "linkage": KindRow("linkages", "geomkin.linkage.kinds.linkage_kinds:LinkageRecipe"),
    "four-bar-atlas": KindRow("linkages", "geomkin.linkage.kinds.coupler_curves:FourBarAtlasRecipe"),
    "slider-crank-atlas": KindRow("linkages", "geomkin.linkage.kinds.coupler_curves:SliderCrankAtlasRecipe"),
    "cognates": KindRow("linkages", "geomkin.linkage.kinds.coupler_curves:CognatesRecipe"),
    "inflection-circle": KindRow("linkages", "geomkin.linkage.kinds.instants:InflectionCircleRecipe"),
    "centrodes": KindRow("linkages", "geomkin.linkage.kinds.instants:CentrodesRecipe"),
    "polygons": KindRow("linkages", "geomkin.linkage.kinds.polygons:PolygonsRecipe"),
    "shaking-force": KindRow("linkages", "geomkin.linkage.kinds.shaking_force:ShakingForceRecipe"),
    "crank-rocker-synthesis": KindRow("synthesis", "geomkin.synthesis.kinds.rockers:CrankRockerRecipe"),
    "double-rocker-synthesis": KindRow("synthesis", "geomkin.synthesis.kinds.rockers:DoubleRockerRecipe"),
    "slider-crank-stroke": KindRow("synthesis", "geomkin.synthesis.kinds.rockers:SliderCrankStrokeRecipe"),
    "burmester-curves": KindRow("synthesis", "geomkin.synthesis.kinds.burmester_curves:BurmesterCurvesRecipe"),
    "body-guidance": KindRow("synthesis", "geomkin.synthesis.kinds.body_guidance:BodyGuidanceRecipe"),
    "function-generator": KindRow("synthesis", "geomkin.synthesis.kinds.function_generators:FunctionGeneratorRecipe"),
    "slider-function-generator": KindRow(
        "synthesis", "geomkin.synthesis.kinds.function_generators:SliderFunctionGeneratorRecipe"
    ),
    "path-generator": KindRow("synthesis", "geomkin.synthesis.kinds.path_generator:PathGeneratorRecipe"),
    "disk-cam": KindRow("cams", "geomkin.cam.kinds.disk_cam:DiskCamRecipe"),
    "spur-gear": KindRow("gears", "geomkin.gear.kinds.single_gears:SpurGearRecipe"),
    "ring-gear": KindRow("gears", "geomkin.gear.kinds.single_gears:RingGearRecipe"),
    "gear-pair": KindRow("gears", "geomkin.gear.kinds.gear_pairs:GearPairRecipe"),
    "internal-gear-pair": KindRow("gears", "geomkin.gear.kinds.gear_pairs:InternalGearPairRecipe"),
    "rack-and-pinion": KindRow("gears", "geomkin.gear.kinds.gear_pairs:RackAndPinionRecipe"),
    "planetary": KindRow("gears", "geomkin.gear.kinds.planetary:PlanetaryRecipe"),
    "gear-train": KindRow("gears", "geomkin.gear.kinds.gear_trains:GearTrainRecipe"),
    "straight-sided-gears": KindRow("gears", "geomkin.gear.kinds.conjugate_gears:StraightSidedGearsRecipe"),
    "point-tooth-gears": KindRow("gears", "geomkin.gear.kinds.conjugate_gears:PointToothGearsRecipe"),
    "parametric-tooth-gears": KindRow("gears", "geomkin.gear.kinds.conjugate_gears:ParametricToothGearsRecipe"),
    "lantern-gears": KindRow("gears", "geomkin.gear.kinds.conjugate_gears:LanternGearsRecipe"),
    "fit-test": KindRow("coupons", "geomkin.coupon.kinds.fit_test:FitTestRecipe"),
    "machine": KindRow("machines", "geomkin.machine.kinds:MachineRecipe"),
}


def recipe_class(kind: str) -> type[AbstractRecipe]:
    """Class of the recipes of a kind.

    Parameters
    ----------
    kind : str
        Name in the table `KINDS`, or of an entry point of the group `geomkin.kinds` of an installed package.

    Returns
    -------
    type
        A subclass of `AbstractRecipe`.

    Raises
    ------
    KeyError
        If no kind has this name.
    GeomkinError
        If the class of another package cannot be imported.
    """
    row = KINDS.get(kind) or _installed()[kind]
    module, _, name = row.recipe.partition(":")
    try:
        recipe: type[AbstractRecipe] = getattr(import_module(module), name)
    except Exception as error:
        fault = printable(f"{type(error).__name__}: {error}", 200)
        raise GeomkinError(f"kind {kind}: {row.recipe} cannot be imported ({fault}); correct its package") from error
    return recipe


def all_kinds() -> dict[str, KindRow]:
    """The rows of all kinds by name: those of the table, then those of installed packages."""
    return KINDS | {kind: row for kind, row in _installed().items() if kind not in KINDS}


def kind_names() -> list[str]:
    """Names of all kinds.

    Returns
    -------
    list of str
        Those of the table, then those of installed packages.
    """
    return list(all_kinds())


def _installed() -> dict[str, KindRow]:
    return {point.name: KindRow("other packages", point.value) for point in entry_points(group=ENTRY_POINTS)}
