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
    design : str, optional
        Class of `recipe.design`, as `module:Class`. Empty for a goal, whose design is a recipe of another kind.
    """

    group: str
    recipe: str
    design: str = ""


KINDS: dict[str, KindRow] = {
    "four-bar": KindRow(
        "linkages", "geomkin.linkage.kinds.linkages:FourBarRecipe", "geomkin.linkage.named_linkages:FourBar"
    ),
    "slider-crank": KindRow(
        "linkages", "geomkin.linkage.kinds.linkages:SliderCrankRecipe", "geomkin.linkage.named_linkages:SliderCrank"
    ),
    "inverted-slider-crank": KindRow(
        "linkages",
        "geomkin.linkage.kinds.linkages:InvertedSliderCrankRecipe",
        "geomkin.linkage.named_linkages:InvertedSliderCrank",
    ),
    "stephenson-six-bar": KindRow(
        "linkages",
        "geomkin.linkage.kinds.linkages:StephensonSixBarRecipe",
        "geomkin.linkage.named_linkages:StephensonSixBar",
    ),
    "watt-six-bar": KindRow(
        "linkages", "geomkin.linkage.kinds.linkages:WattSixBarRecipe", "geomkin.linkage.named_linkages:WattSixBar"
    ),
    "shaper": KindRow(
        "linkages", "geomkin.linkage.kinds.linkages:ShaperRecipe", "geomkin.linkage.named_linkages:Shaper"
    ),
    "elliptic-trammel": KindRow(
        "linkages",
        "geomkin.linkage.kinds.linkages:EllipticTrammelRecipe",
        "geomkin.linkage.named_linkages:EllipticTrammel",
    ),
    "scotch-yoke": KindRow(
        "linkages", "geomkin.linkage.kinds.linkages:ScotchYokeRecipe", "geomkin.linkage.named_linkages:ScotchYoke"
    ),
    "oldham-coupling": KindRow(
        "linkages",
        "geomkin.linkage.kinds.linkages:OldhamCouplingRecipe",
        "geomkin.linkage.named_linkages:OldhamCoupling",
    ),
    "linkage": KindRow(
        "linkages", "geomkin.linkage.kinds.linkages:LinkageRecipe", "geomkin.linkage.linkage:AbstractLinkage"
    ),
    "four-bar-atlas": KindRow(
        "linkages", "geomkin.linkage.kinds.coupler_curves:FourBarAtlasRecipe", "geomkin.linkage.named_linkages:FourBar"
    ),
    "slider-crank-atlas": KindRow(
        "linkages",
        "geomkin.linkage.kinds.coupler_curves:SliderCrankAtlasRecipe",
        "geomkin.linkage.named_linkages:SliderCrank",
    ),
    "cognates": KindRow(
        "linkages", "geomkin.linkage.kinds.coupler_curves:CognatesRecipe", "geomkin.linkage.named_linkages:FourBar"
    ),
    "inflection-circle": KindRow(
        "linkages", "geomkin.linkage.kinds.instants:InflectionCircleRecipe", "geomkin.linkage.named_linkages:FourBar"
    ),
    "centrodes": KindRow(
        "linkages", "geomkin.linkage.kinds.instants:CentrodesRecipe", "geomkin.linkage.named_linkages:FourBar"
    ),
    "polygons": KindRow(
        "linkages", "geomkin.linkage.kinds.polygons:PolygonsRecipe", "geomkin.linkage.linkage:AbstractLinkage"
    ),
    "shaking-force": KindRow(
        "linkages",
        "geomkin.linkage.kinds.shaking_force:ShakingForceRecipe",
        "geomkin.linkage.named_linkages:SliderCrank",
    ),
    "crank-rocker-synthesis": KindRow("goals", "geomkin.synthesis.kinds.rockers:CrankRockerRecipe"),
    "double-rocker-synthesis": KindRow("goals", "geomkin.synthesis.kinds.rockers:DoubleRockerRecipe"),
    "slider-crank-stroke": KindRow("goals", "geomkin.synthesis.kinds.rockers:SliderCrankStrokeRecipe"),
    "burmester-curves": KindRow(
        "goals",
        "geomkin.synthesis.kinds.burmester_curves:BurmesterCurvesRecipe",
        "geomkin.synthesis.guidance.burmester:Burmester",
    ),
    "body-guidance": KindRow("goals", "geomkin.synthesis.kinds.body_guidance:BodyGuidanceRecipe"),
    "function-generator": KindRow("goals", "geomkin.synthesis.kinds.function_generators:FunctionGeneratorRecipe"),
    "slider-function-generator": KindRow(
        "goals", "geomkin.synthesis.kinds.function_generators:SliderFunctionGeneratorRecipe"
    ),
    "path-generator": KindRow("goals", "geomkin.synthesis.kinds.path_generator:PathGeneratorRecipe"),
    "disk-cam": KindRow("cams", "geomkin.cam.kinds.disk_cam:DiskCamRecipe", "geomkin.cam.cam:Cam"),
    "spur-gear": KindRow("gears", "geomkin.gear.kinds.single_gears:SpurGearRecipe", "geomkin.gear.spur:SpurGear"),
    "ring-gear": KindRow("gears", "geomkin.gear.kinds.single_gears:RingGearRecipe", "geomkin.gear.ring:RingGear"),
    "gear-pair": KindRow("gears", "geomkin.gear.kinds.gear_pairs:GearPairRecipe", "geomkin.gear.pair:GearPair"),
    "rack-and-pinion": KindRow(
        "gears", "geomkin.gear.kinds.gear_pairs:RackAndPinionRecipe", "geomkin.gear.rack:RackPair"
    ),
    "planetary": KindRow(
        "gears", "geomkin.gear.kinds.planetary:PlanetaryRecipe", "geomkin.gear.planetary:PlanetarySet"
    ),
    "straight-sided-gears": KindRow(
        "gears",
        "geomkin.gear.kinds.conjugate_gears:StraightSidedGearsRecipe",
        "geomkin.gear.conjugate.conjugate:Conjugate",
    ),
    "point-tooth-gears": KindRow(
        "gears",
        "geomkin.gear.kinds.conjugate_gears:PointToothGearsRecipe",
        "geomkin.gear.conjugate.conjugate:Conjugate",
    ),
    "lantern-gears": KindRow(
        "gears", "geomkin.gear.kinds.conjugate_gears:LanternGearsRecipe", "geomkin.gear.conjugate.conjugate:Conjugate"
    ),
}


def recipe_class(kind: str) -> type[AbstractRecipe]:
    """Class of the recipes of a kind.

    Parameters
    ----------
    kind : str
        Name in the table `KINDS`, or of an entry point of the group `geomkin.kinds` of an installed package.

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
        raise GeomkinError(f"kind {kind}: {row.recipe} cannot be imported ({fault}); mend its package") from error
    return recipe


def all_kinds() -> dict[str, KindRow]:
    """The rows of all kinds by name: those of the table, then those of installed packages."""
    return KINDS | {kind: row for kind, row in _installed().items() if kind not in KINDS}


def kind_names() -> list[str]:
    """Names of all kinds."""
    return list(all_kinds())


def _installed() -> dict[str, KindRow]:
    return {point.name: KindRow("other packages", point.value) for point in entry_points(group=ENTRY_POINTS)}
