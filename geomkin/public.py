"""The names that `geomkin` offers, in one place; `import geomkin` reads them when first asked for one."""

from .cam.cam import Cam, pressure_angle
from .cam.follower import TranslatingRoller
from .cam.program import Dwell, FollowerMotion, Program, Return, Rise
from .check import Check
from .errors import DesignError, FileError, GeomkinError, RecipeError
from .gear.rack import Rack
from .gear.spur import SpurGear
from .linkage.coupler import CouplerCurve
from .linkage.double_sliders import EllipticTrammel, OldhamCoupling, ScotchYoke
from .linkage.four_bar import FourBar
from .linkage.inverted_slider_crank import InvertedSliderCrank
from .linkage.limits import dead_centres, driver_limits
from .linkage.linkage import Linkage, Slider
from .linkage.measures import circuits, grashof_type, mechanical_advantage
from .linkage.motion import Body, Motion, PointMotion, SlideMotion
from .linkage.newton import Root, newton_raphson
from .linkage.shaper import Shaper
from .linkage.six_bars import StephensonSixBar, WattSixBar
from .linkage.slider_crank import SliderCrank
from .linkage.solve import move
from .part import Part
from .plane.arcs import to_arcs
from .plane.curve import AbstractCurve
from .plane.derived import Mirrored, Moved, Offset, Reversed
from .plane.flatten import flatten
from .plane.joined import Path, Ring
from .plane.measure import area, centroid, curvature, length, nearest
from .plane.pose import Pose
from .plane.primitives import Arc, Circle, Polyline, Segment, rounded_hull, slot
from .plane.roulettes import Involute, Trochoid
from .plane.vec import xy
from .table import Column, Table

__all__ = [
    "AbstractCurve", "Arc", "Body", "Cam", "Check", "Circle", "Column", "CouplerCurve", "DesignError", "Dwell",
    "EllipticTrammel", "FileError", "FollowerMotion", "FourBar", "GeomkinError", "InvertedSliderCrank", "Involute",
    "Linkage", "Mirrored", "Motion", "Moved", "Offset", "OldhamCoupling", "Part", "Path", "PointMotion", "Polyline",
    "Pose", "Program", "Rack", "RecipeError", "Return", "Reversed", "Ring", "Rise", "Root", "ScotchYoke", "Segment",
    "Shaper", "SlideMotion", "Slider", "SliderCrank", "SpurGear", "StephensonSixBar", "Table", "TranslatingRoller",
    "Trochoid", "WattSixBar", "area", "centroid", "circuits", "curvature", "dead_centres", "driver_limits", "flatten",
    "grashof_type", "length", "mechanical_advantage", "move", "nearest", "newton_raphson", "pressure_angle",
    "rounded_hull", "slot", "to_arcs", "xy",
]  # fmt: skip
