"""Disk cams: motion laws, programmes, followers and the curves they give. Knows nothing of plates or files."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .base_circle import BaseCircle as BaseCircle
    from .base_circle import flat_face_base_radius as flat_face_base_radius
    from .base_circle import least_base_circle as least_base_circle
    from .limits import SegmentLimits as SegmentLimits
    from .limits import segment_limits as segment_limits
    from .polar import polar_radius as polar_radius
    from .program.program import FollowerMotion as FollowerMotion
    from .program.segments import LiftPolynomial as LiftPolynomial
    from .program.segments import LiftSpline as LiftSpline
    from .program.segments import LiftTable as LiftTable
    from .program.segments import OptimisedPolynomial as OptimisedPolynomial
    from .program.segments import OptimisedSpline as OptimisedSpline
    from .tables import cam_table as cam_table
    from .undercut import Undercut as Undercut
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
