"""The tables of the face: modules by name, which only here are text. A new kind of recipe is one row."""

from __future__ import annotations

from .core.named import KINDS_BY_GROUP, VIEWS

VIEWS.update({
    "page": "geomkin.page.page:mechanism_page",
    "colours": "geomkin.page.page:colours",
    "moving": "geomkin.studio.notebook:inline",
    "still": "geomkin.export.svg_path:picture",
})  # fmt: skip
KINDS_BY_GROUP.update({
    "linkages": {
        "four-bar": "geomkin.linkage.kinds.linkage_kinds:FourBarRecipe",
        "slider-crank": "geomkin.linkage.kinds.linkage_kinds:SliderCrankRecipe",
        "inverted-slider-crank": "geomkin.linkage.kinds.linkage_kinds:InvertedSliderCrankRecipe",
        "stephenson-six-bar": "geomkin.linkage.kinds.linkage_kinds:StephensonSixBarRecipe",
        "watt-six-bar": "geomkin.linkage.kinds.linkage_kinds:WattSixBarRecipe",
        "shaper": "geomkin.linkage.kinds.linkage_kinds:ShaperRecipe",
        "pantograph": "geomkin.linkage.kinds.linkage_kinds:PantographRecipe",
        "elliptic-trammel": "geomkin.linkage.kinds.linkage_kinds:EllipticTrammelRecipe",
        "scotch-yoke": "geomkin.linkage.kinds.linkage_kinds:ScotchYokeRecipe",
        "oldham-coupling": "geomkin.linkage.kinds.linkage_kinds:OldhamCouplingRecipe",
        "linkage": "geomkin.linkage.kinds.linkage_kinds:LinkageRecipe",
        "four-bar-atlas": "geomkin.linkage.kinds.coupler_curves:FourBarAtlasRecipe",
        "slider-crank-atlas": "geomkin.linkage.kinds.coupler_curves:SliderCrankAtlasRecipe",
        "cognates": "geomkin.linkage.kinds.coupler_curves:CognatesRecipe",
        "inflection-circle": "geomkin.linkage.kinds.instants:InflectionCircleRecipe",
        "centrodes": "geomkin.linkage.kinds.instants:CentrodesRecipe",
        "polygons": "geomkin.linkage.kinds.vector_diagrams:PolygonsRecipe",
        "shaking-force": "geomkin.linkage.kinds.vector_diagrams:ShakingForceRecipe",
    },
    "synthesis": {
        "crank-rocker-synthesis": "geomkin.synthesis.kinds.rockers:CrankRockerRecipe",
        "double-rocker-synthesis": "geomkin.synthesis.kinds.rockers:DoubleRockerRecipe",
        "slider-crank-stroke": "geomkin.synthesis.kinds.rockers:SliderCrankStrokeRecipe",
        "burmester-curves": "geomkin.synthesis.kinds.burmester_curves:BurmesterCurvesRecipe",
        "body-guidance": "geomkin.synthesis.kinds.body_guidance:BodyGuidanceRecipe",
        "function-generator": "geomkin.synthesis.kinds.function_generators:FunctionGeneratorRecipe",
        "slider-function-generator": "geomkin.synthesis.kinds.function_generators:SliderFunctionGeneratorRecipe",
        "path-generator": "geomkin.synthesis.kinds.path_generator:PathGeneratorRecipe",
    },
    "cams": {
        "disk-cam": "geomkin.cam.kinds.disk_cam:DiskCamRecipe",
        "groove-cam": "geomkin.cam.kinds.groove_cam:GrooveCamRecipe",
        "conjugate-cams": "geomkin.cam.kinds.conjugate_cams:ConjugateCamsRecipe",
    },
    "gears": {
        "spur-gear": "geomkin.gear.kinds.gears:SpurGearRecipe",
        "ring-gear": "geomkin.gear.kinds.gears:RingGearRecipe",
        "gear-pair": "geomkin.gear.kinds.gear_pairs:GearPairRecipe",
        "internal-gear-pair": "geomkin.gear.kinds.gear_pairs:InternalGearPairRecipe",
        "rack-and-pinion": "geomkin.gear.kinds.gear_pairs:RackAndPinionRecipe",
        "planetary": "geomkin.gear.kinds.gears:PlanetaryRecipe",
        "gear-train": "geomkin.gear.kinds.gear_trains:GearTrainRecipe",
        "straight-sided-gears": "geomkin.gear.kinds.conjugate_gears:StraightSidedGearsRecipe",
        "point-tooth-gears": "geomkin.gear.kinds.conjugate_gears:PointToothGearsRecipe",
        "parametric-tooth-gears": "geomkin.gear.kinds.conjugate_gears:ParametricToothGearsRecipe",
        "lantern-gears": "geomkin.gear.kinds.conjugate_gears:LanternGearsRecipe",
    },
    "cycloidal drives": {
        "cycloidal-drive": "geomkin.cycloidal.kinds:CycloidalDriveRecipe",
    },
    "Geneva drives": {
        "geneva": "geomkin.geneva.kinds:GenevaRecipe",
    },
    "ratchets": {
        "ratchet": "geomkin.ratchet.kinds:RatchetRecipe",
    },
    "belts and chains": {
        "belt-drive": "geomkin.belt.kinds:BeltDriveRecipe",
        "chain-drive": "geomkin.belt.kinds:ChainDriveRecipe",
    },
    "coupons": {
        "fit-test": "geomkin.coupon.kinds:FitTestRecipe",
    },
    "machines": {
        "machine": "geomkin.machine.kinds:MachineRecipe",
    },
})  # fmt: skip
