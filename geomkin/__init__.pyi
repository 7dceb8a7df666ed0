# The public names of this package. Each is imported when it is first used.
from . import (
    belt as belt,
)
from . import (
    cam as cam,
)
from . import (
    coupon as coupon,
)
from . import (
    cycloidal as cycloidal,
)
from . import (
    export as export,
)
from . import (
    gear as gear,
)
from . import (
    geneva as geneva,
)
from . import (
    linkage as linkage,
)
from . import (
    machine as machine,
)
from . import (
    making as making,
)
from . import (
    model as model,
)
from . import (
    plane as plane,
)
from . import (
    ratchet as ratchet,
)
from . import (
    recipe as recipe,
)
from . import (
    synthesis as synthesis,
)
from . import (
    tradeoff as tradeoff,
)
from .build import FailedChecksError as FailedChecksError
from .build import index as index
from .build import load as load
from .build import make as make
from .build import write as write
from .cam.cam import Cam as Cam
from .cam.checks import pressure_angle as pressure_angle
from .cam.followers.flat import OscillatingFlat as OscillatingFlat
from .cam.followers.flat import TranslatingFlat as TranslatingFlat
from .cam.followers.roller import OscillatingRoller as OscillatingRoller
from .cam.followers.roller import TranslatingRoller as TranslatingRoller
from .cam.program.program import Program as Program
from .cam.program.segments import Dwell as Dwell
from .cam.program.segments import Return as Return
from .cam.program.segments import Rise as Rise
from .cam.undercut import undercut as undercut
from .core.errors import (
    DesignError as DesignError,
)
from .core.errors import (
    FileError as FileError,
)
from .core.errors import (
    GeomkinError as GeomkinError,
)
from .core.errors import (
    RecipeError as RecipeError,
)
from .core.field_visitor import scaled as scaled
from .gear.conjugate.conjugate import conjugate as conjugate
from .gear.pair import GearPair as GearPair
from .gear.ring import RingGear as RingGear
from .gear.spur import SpurGear as SpurGear
from .gear.train import GearTrain as GearTrain
from .gear.train import gear_train as gear_train
from .linkage.coupler_curve import CouplerCurve as CouplerCurve
from .linkage.drive_limits import driver_limits as driver_limits
from .linkage.dynamics.counterweights import balance as balance
from .linkage.dynamics.forward import forward_dynamics as forward_dynamics
from .linkage.dynamics.inverse import forces as forces
from .linkage.dynamics.loads import (
    DriveTable as DriveTable,
)
from .linkage.dynamics.loads import (
    Force as Force,
)
from .linkage.dynamics.loads import (
    GasSpring as GasSpring,
)
from .linkage.dynamics.loads import (
    Loads as Loads,
)
from .linkage.dynamics.loads import (
    SlideForce as SlideForce,
)
from .linkage.dynamics.loads import (
    Spring as Spring,
)
from .linkage.dynamics.loads import (
    Torque as Torque,
)
from .linkage.dynamics.loads import (
    TorsionSpring as TorsionSpring,
)
from .linkage.dynamics.wrenches import PinFriction as PinFriction
from .linkage.dynamics.wrenches import SlideFriction as SlideFriction
from .linkage.joints.gear_mesh import GearMesh as GearMesh
from .linkage.joints.slide import PinInSlot as PinInSlot
from .linkage.joints.slide import Slider as Slider
from .linkage.linkage import Linkage as Linkage
from .linkage.measures import least_transmission_angle as least_transmission_angle
from .linkage.moving import move as move
from .linkage.named_linkages import (
    EllipticTrammel as EllipticTrammel,
)
from .linkage.named_linkages import (
    FourBar as FourBar,
)
from .linkage.named_linkages import (
    InvertedSliderCrank as InvertedSliderCrank,
)
from .linkage.named_linkages import (
    OldhamCoupling as OldhamCoupling,
)
from .linkage.named_linkages import (
    ScotchYoke as ScotchYoke,
)
from .linkage.named_linkages import (
    SliderCrank as SliderCrank,
)
from .linkage.six_bars import Shaper as Shaper
from .linkage.six_bars import StephensonSixBar as StephensonSixBar
from .linkage.six_bars import WattSixBar as WattSixBar
from .linkage.solve.branch import Continuation as Continuation
from .linkage.tolerance_analysis import tolerances as tolerances
from .model.check import Check as Check
from .model.material import Mass as Mass
from .model.material import Material as Material
from .model.motor import Motor as Motor
from .model.part import HoleFit as HoleFit
from .model.part import Part as Part
from .model.part import Twist as Twist
from .model.table import Column as Column
from .model.table import Table as Table
from .optimisation.optimiser import optimise as optimise
from .plane.approximation import to_arcs as to_arcs
from .plane.curve import AbstractCurve as AbstractCurve
from .plane.flatten import flatten as flatten
from .plane.measure import area as area
from .plane.measure import curvature as curvature
from .plane.measure import length as length
from .plane.measure import nearest as nearest
from .recipe.recipe import masses as masses
from .studio.editor import edit as edit
from .studio.notebook import show as show
from .sweeps.sweep import sweep as sweep
from .synthesis.function.function import function_generator as function_generator
from .synthesis.guidance.dyads import dyads_through as dyads_through
from .synthesis.guidance.guidance import body_guides as body_guides
from .synthesis.path.path import path_generator as path_generator
from .synthesis.rockers.crank_rockers import crank_rocker as crank_rocker
from .verification.certificate import verify as verify

__version__: str
