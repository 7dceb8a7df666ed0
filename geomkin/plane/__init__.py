"""Plane geometry in complex numbers, in mm: points, poses, curves and measures. No mechanisms here."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .curve import Mirrored as Mirrored
    from .curve import Moved as Moved
    from .curve import Offset as Offset
    from .curve import Reversed as Reversed
    from .joined import Path as Path
    from .joined import Ring as Ring
    from .measure import centroid as centroid
    from .measure import convexity as convexity
    from .measure import signed_area as signed_area
    from .primitives import Arc as Arc
    from .primitives import Circle as Circle
    from .primitives import Polyline as Polyline
    from .primitives import Segment as Segment
    from .primitives import rounded_hull as rounded_hull
    from .primitives import slot as slot
    from .roulettes import Cycloid as Cycloid
    from .roulettes import Involute as Involute
    from .roulettes import Trochoid as Trochoid
    from .spline import Spline as Spline
    from .vec import Pose as Pose
    from .vec import xy as xy
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
