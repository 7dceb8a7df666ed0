"""The names that `geomkin` offers, in one place; `import geomkin` reads them when first asked for one."""

from .cam.cam import Cam, pressure_angle
from .cam.follower import TranslatingRoller
from .cam.program import Dwell, FollowerMotion, Program, Return, Rise
from .check import Check
from .errors import DesignError, FileError, GeomkinError, RecipeError
from .gear.rack import Rack
from .gear.spur import SpurGear
from .linkage.four_bar import FourBar
from .linkage.measures import grashof_type
from .linkage.motion import Body, Motion, PointMotion
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
    "AbstractCurve", "Arc", "Body", "Cam", "Check", "Circle", "Column", "DesignError", "Dwell", "FileError",
    "FollowerMotion", "FourBar", "GeomkinError", "Involute", "Mirrored", "Motion", "Moved", "Offset", "Part",
    "Path", "PointMotion", "Polyline", "Pose", "Program", "Rack", "RecipeError", "Return", "Reversed", "Ring",
    "Rise", "Segment", "SpurGear", "Table", "TranslatingRoller", "Trochoid", "area", "centroid", "curvature",
    "flatten", "grashof_type", "length", "move", "nearest", "pressure_angle", "rounded_hull", "slot", "to_arcs",
    "xy",
]  # fmt: skip
