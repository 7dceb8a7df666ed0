# The public names of this package. Each is imported when it is first used.
from .checks import (
    conjugate_checks as conjugate_checks,
)
from .checks import (
    gear_checks as gear_checks,
)
from .checks import (
    mesh_checks as mesh_checks,
)
from .checks import (
    planetary_checks as planetary_checks,
)
from .checks import (
    strength_checks as strength_checks,
)
from .checks import (
    touch_check as touch_check,
)
from .conjugate.conjugate import (
    Conjugate as Conjugate,
)
from .conjugate.conjugate import (
    Untouched as Untouched,
)
from .conjugate.conjugate import (
    flank_table as flank_table,
)
from .conjugate.conjugate import (
    pin_table as pin_table,
)
from .conjugate.parametric_gear import ParametricToothGear as ParametricToothGear
from .conjugate.shaping_gears import (
    AbstractFlankGear as AbstractFlankGear,
)
from .conjugate.shaping_gears import (
    FlankGear as FlankGear,
)
from .conjugate.shaping_gears import (
    LanternPinion as LanternPinion,
)
from .conjugate.shaping_gears import (
    PointToothGear as PointToothGear,
)
from .conjugate.shaping_gears import (
    StraightSidedGear as StraightSidedGear,
)
from .contract import (
    AbstractGear as AbstractGear,
)
from .contract import (
    AbstractInvoluteGear as AbstractInvoluteGear,
)
from .contract import (
    AbstractShaper as AbstractShaper,
)
from .cutters import (
    RackCutter as RackCutter,
)
from .cutters import (
    balanced_shifts as balanced_shifts,
)
from .cutters import (
    undercut_free_shift as undercut_free_shift,
)
from .helix import Helix as Helix
from .kinds.conjugate_gears import (
    LanternGearsRecipe as LanternGearsRecipe,
)
from .kinds.conjugate_gears import (
    ParametricToothGearsRecipe as ParametricToothGearsRecipe,
)
from .kinds.conjugate_gears import (
    PointToothGearsRecipe as PointToothGearsRecipe,
)
from .kinds.conjugate_gears import (
    StraightSidedGearsRecipe as StraightSidedGearsRecipe,
)
from .kinds.gear_pairs import (
    GearPairRecipe as GearPairRecipe,
)
from .kinds.gear_pairs import (
    InternalGearPairRecipe as InternalGearPairRecipe,
)
from .kinds.gear_pairs import (
    RackAndPinionRecipe as RackAndPinionRecipe,
)
from .kinds.gear_trains import (
    GearTrainRecipe as GearTrainRecipe,
)
from .kinds.gear_trains import (
    TrainSpecification as TrainSpecification,
)
from .kinds.gear_trains import (
    train_scene as train_scene,
)
from .kinds.planetary import PlanetaryRecipe as PlanetaryRecipe
from .kinds.single_gears import RingGearRecipe as RingGearRecipe
from .kinds.single_gears import SpurGearRecipe as SpurGearRecipe
from .measures import (
    chord as chord,
)
from .measures import (
    contact_table as contact_table,
)
from .measures import (
    over_pins as over_pins,
)
from .measures import (
    span as span,
)
from .measures import (
    tooth_table as tooth_table,
)
from .output_loads import (
    RackLoads as RackLoads,
)
from .output_loads import (
    RackStrength as RackStrength,
)
from .output_loads import (
    TrainLoads as TrainLoads,
)
from .output_loads import (
    TrainStrength as TrainStrength,
)
from .pair import InternalGearPair as InternalGearPair
from .parts import (
    GearStock as GearStock,
)
from .parts import (
    LanternStock as LanternStock,
)
from .parts import (
    PairStock as PairStock,
)
from .parts import (
    RingStock as RingStock,
)
from .parts import (
    Web as Web,
)
from .parts import (
    base_plate as base_plate,
)
from .parts import (
    gear_parts as gear_parts,
)
from .parts import (
    lantern_parts as lantern_parts,
)
from .parts import (
    pair_parts as pair_parts,
)
from .parts_assembly import (
    carrier as carrier,
)
from .parts_assembly import (
    pair_base as pair_base,
)
from .parts_assembly import (
    planetary_base as planetary_base,
)
from .parts_assembly import (
    rack_base as rack_base,
)
from .parts_train import (
    ArborStock as ArborStock,
)
from .parts_train import (
    TrainStocks as TrainStocks,
)
from .parts_train import (
    arbor_check as arbor_check,
)
from .parts_train import (
    train_assembly as train_assembly,
)
from .parts_train import (
    train_parts as train_parts,
)
from .pinion_cutter import PinionCutter as PinionCutter
from .planetary import PlanetarySet as PlanetarySet
from .rack import GearRack as GearRack
from .rack import RackPair as RackPair
from .scene import gear_scene as gear_scene
from .scene_pairs import (
    conjugate_scene as conjugate_scene,
)
from .scene_pairs import (
    pair_scene as pair_scene,
)
from .scene_pairs import (
    planetary_scene as planetary_scene,
)
from .strength import (
    GearLoads as GearLoads,
)
from .strength import (
    LoadFactors as LoadFactors,
)
from .strength import (
    PairStrength as PairStrength,
)
from .strength import (
    RootSection as RootSection,
)
from .strength import (
    ToothForm as ToothForm,
)
from .strength import (
    ToothStrength as ToothStrength,
)
from .strength import (
    root_section as root_section,
)
from .strength import (
    tooth_form as tooth_form,
)
from .train import (
    GearTrain as GearTrain,
)
from .train import (
    gear_train as gear_train,
)
from .train import (
    loss_factor as loss_factor,
)
from .train import (
    train_table as train_table,
)
