"""The names that `geomkin` offers, in one place; `import geomkin` reads them when first asked for one."""

from .cam.base_circle import BaseCircle, flat_face_base_radius, least_base_circle
from .cam.cam import Cam, pressure_angle
from .cam.follower import OscillatingFlat, OscillatingRoller, TranslatingFlat, TranslatingRoller
from .cam.limits import SegmentLimits, segment_limits
from .cam.polar import polar_radius
from .cam.program import Dwell, FollowerMotion, Program, Return, Rise
from .cam.segments import LiftPolynomial, LiftSpline, LiftTable, OptimisedPolynomial, OptimisedSpline
from .cam.undercut import Undercut, undercut
from .check import Check
from .errors import DesignError, FileError, GeomkinError, RecipeError
from .gear.conjugate import Conjugate, conjugate
from .gear.cutter import PinionCutter
from .gear.flank_gear import FlankGear
from .gear.gear_rack import GearRack
from .gear.lantern import LanternPinion
from .gear.measures import base_pitch, chord, over_pins, span
from .gear.pair import GearPair
from .gear.planetary import PlanetarySet
from .gear.point_tooth import PointToothGear
from .gear.rack import Rack
from .gear.rack_pair import RackPair
from .gear.ring import RingGear
from .gear.shifts import balanced_shifts, undercut_free_shift
from .gear.spur import SpurGear
from .gear.straight_sided import StraightSidedGear
from .gear.untouched import Untouched
from .linkage.atlas import coupler_curves, coupler_grid, dashes
from .linkage.bobillier import Bobillier, bobillier, bobillier_path
from .linkage.branch import Follow
from .linkage.centres import InstantCentre, instant_centre, instant_centres
from .linkage.centrode_curve import CentrodeCurve
from .linkage.centrodes import Centrodes
from .linkage.cognates import Cognate, cognates, roberts_linkage, third_pivot
from .linkage.coupler import CouplerCurve
from .linkage.curvature import PathCurvature, crank_path, euler_savary, path_curvature
from .linkage.double_sliders import EllipticTrammel, OldhamCoupling, ScotchYoke
from .linkage.equivalent import Contact
from .linkage.four_bar import FourBar
from .linkage.inflection import InflectionCircle, inflection_circle, inflection_circle_of_cranks
from .linkage.inverted_slider_crank import InvertedSliderCrank
from .linkage.limits import dead_centres, driver_limits
from .linkage.linkage import Linkage, Slider
from .linkage.measures import circuits, grashof_type, least_transmission_angle, mechanical_advantage
from .linkage.motion import Body, Motion, PointMotion, SlideMotion
from .linkage.newton import Root, newton_raphson
from .linkage.opening import Opening, opening
from .linkage.polygons import Polygon, acceleration_polygon, velocity_polygon
from .linkage.shaking import (
    Counterbalance,
    SliderCrankMasses,
    best_counterbalance,
    judged_counterbalance,
    shaking_force,
)
from .linkage.shaper import Shaper
from .linkage.six_bars import StephensonSixBar, WattSixBar
from .linkage.slider_crank import SliderCrank
from .linkage.solve import move
from .part import Part
from .plane.arcs import to_arcs
from .plane.curve import AbstractCurve
from .plane.cycloid import Cycloid
from .plane.derived import Mirrored, Moved, Offset, Reversed
from .plane.flatten import flatten
from .plane.joined import Path, Ring
from .plane.measure import area, centroid, convexity, curvature, length, nearest, signed_area
from .plane.pose import Pose
from .plane.primitives import Arc, Circle, Polyline, Segment, rounded_hull, slot
from .plane.roulettes import Involute, Trochoid
from .plane.spline import Spline
from .plane.vec import xy
from .table import Column, Table

__all__ = [
    "AbstractCurve", "Arc", "BaseCircle", "Bobillier", "Body", "Cam", "CentrodeCurve", "Centrodes", "Check",
    "Circle", "Cognate", "Column", "Conjugate", "Contact", "Counterbalance", "CouplerCurve", "Cycloid",
    "DesignError", "Dwell", "EllipticTrammel", "FileError", "FlankGear", "Follow", "FollowerMotion", "FourBar",
    "GearPair", "GearRack", "GeomkinError", "InflectionCircle", "InstantCentre", "InvertedSliderCrank",
    "Involute", "LanternPinion", "LiftPolynomial", "LiftSpline", "LiftTable", "Linkage", "Mirrored", "Motion",
    "Moved", "Offset", "OldhamCoupling", "Opening", "OptimisedPolynomial", "OptimisedSpline", "OscillatingFlat",
    "OscillatingRoller", "Part", "Path", "PathCurvature", "PinionCutter", "PlanetarySet", "PointMotion",
    "PointToothGear", "Polygon", "Polyline", "Pose", "Program", "Rack", "RackPair", "RecipeError", "Return",
    "Reversed", "Ring", "RingGear", "Rise", "Root", "ScotchYoke", "Segment", "SegmentLimits", "Shaper",
    "SlideMotion", "Slider", "SliderCrank", "SliderCrankMasses", "Spline", "SpurGear", "StephensonSixBar",
    "StraightSidedGear", "Table", "TranslatingFlat", "TranslatingRoller", "Trochoid", "Undercut", "Untouched",
    "WattSixBar", "acceleration_polygon", "area", "balanced_shifts", "base_pitch", "best_counterbalance",
    "bobillier", "bobillier_path", "centroid", "chord", "circuits", "cognates", "conjugate", "convexity",
    "coupler_curves", "coupler_grid", "crank_path", "curvature", "dashes", "dead_centres", "driver_limits",
    "euler_savary",
    "flat_face_base_radius", "flatten", "grashof_type", "inflection_circle", "inflection_circle_of_cranks",
    "instant_centre", "instant_centres", "judged_counterbalance", "least_base_circle", "least_transmission_angle", "length",
    "mechanical_advantage", "move", "nearest", "newton_raphson", "opening", "over_pins", "path_curvature", "polar_radius",
    "pressure_angle", "roberts_linkage", "rounded_hull", "segment_limits", "shaking_force", "signed_area",
    "slot", "span", "third_pivot", "to_arcs", "undercut", "undercut_free_shift", "velocity_polygon", "xy",
]  # fmt: skip
