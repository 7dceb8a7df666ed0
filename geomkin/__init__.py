"""geomkin: planar mechanisms from text recipes, and their geometry and motion as a library.

    import numpy as np, geomkin as gk
    linkage = gk.FourBar(ground=100, crank=30, coupler=90, rocker=70, coupler_point=40 + 25j)
    motion = gk.move(linkage, drive=np.linspace(0, 2 * np.pi, 361), speed=10.0)
    motion.point("coupler_point").position

Points are complex numbers in mm; angles are rad unless a name ends in `_deg`; y is up and
counterclockwise positive. Recipes need more than NumPy and are loaded only by `gk.load`, `gk.make`, `gk.show`.
"""

from typing import TYPE_CHECKING

# Read by the package's metadata and told in files.
__version__ = "0.1.0"

if TYPE_CHECKING:
    from . import cam as cam
    from . import export as export
    from . import gear as gear
    from . import judge as judge
    from . import kinds as kinds
    from . import linkage as linkage
    from . import plane as plane
    from . import recipe as recipe
    from . import scenes as scenes
    from . import shop as shop
    from . import synthesis as synthesis
    from . import tradeoff as tradeoff
    from .build import index as index
    from .build import load as load
    from .build import make as make
    from .build import write as write
    from .cam.cam import Cam as Cam
    from .cam.followers.flat import OscillatingFlat as OscillatingFlat
    from .cam.followers.flat import TranslatingFlat as TranslatingFlat
    from .cam.followers.roller import OscillatingRoller as OscillatingRoller
    from .cam.followers.roller import TranslatingRoller as TranslatingRoller
    from .cam.measures import pressure_angle as pressure_angle
    from .cam.program.program import Program as Program
    from .cam.program.segments import Dwell as Dwell
    from .cam.program.segments import Return as Return
    from .cam.program.segments import Rise as Rise
    from .cam.undercut import undercut as undercut
    from .check import Check as Check
    from .errors import DesignError as DesignError
    from .errors import FileError as FileError
    from .errors import GeomkinError as GeomkinError
    from .errors import RecipeError as RecipeError
    from .gear.conjugate.conjugate import conjugate as conjugate
    from .gear.pair import GearPair as GearPair
    from .gear.ring import RingGear as RingGear
    from .gear.spur import SpurGear as SpurGear
    from .linkage.bars import FourBar as FourBar
    from .linkage.bars import StephensonSixBar as StephensonSixBar
    from .linkage.bars import WattSixBar as WattSixBar
    from .linkage.coupler_curve import CouplerCurve as CouplerCurve
    from .linkage.linkage import Linkage as Linkage
    from .linkage.linkage import Slider as Slider
    from .linkage.measures import driver_limits as driver_limits
    from .linkage.measures import least_transmission_angle as least_transmission_angle
    from .linkage.sliders import EllipticTrammel as EllipticTrammel
    from .linkage.sliders import InvertedSliderCrank as InvertedSliderCrank
    from .linkage.sliders import OldhamCoupling as OldhamCoupling
    from .linkage.sliders import ScotchYoke as ScotchYoke
    from .linkage.sliders import Shaper as Shaper
    from .linkage.sliders import SliderCrank as SliderCrank
    from .linkage.solve.branch import Follow as Follow
    from .linkage.solve.move import move as move
    from .notebook import show as show
    from .part import HoleFit as HoleFit
    from .part import Part as Part
    from .part import Twist as Twist
    from .plane.arcs import to_arcs as to_arcs
    from .plane.curve import AbstractCurve as AbstractCurve
    from .plane.flatten import flatten as flatten
    from .plane.measure import area as area
    from .plane.measure import curvature as curvature
    from .plane.measure import length as length
    from .plane.measure import nearest as nearest
    from .scaling import scaled as scaled
    from .sweeps.sweep import sweep as sweep
    from .synthesis.function.function import function_generator as function_generator
    from .synthesis.guidance.dyads import dyads_through as dyads_through
    from .synthesis.guidance.guidance import body_guides as body_guides
    from .synthesis.path.path import path_generator as path_generator
    from .synthesis.rockers.crank_rockers import crank_rocker as crank_rocker
    from .table import Column as Column
    from .table import Table as Table
else:
    from .lazy import attach

    __getattr__, __dir__ = attach(__name__)
