"""Disk cams: motion laws, programmes, followers and the curves they give. Knows nothing of plates or files."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .base_circle import BaseCircle as BaseCircle
    from .base_circle import flat_face_base_radius as flat_face_base_radius
    from .base_circle import least_base_circle as least_base_circle
    from .followers.flat import AbstractFace as AbstractFace
    from .followers.follower import FOLLOWERS as FOLLOWERS
    from .followers.follower import AbstractFollower as AbstractFollower
    from .followers.follower import Contact as Contact
    from .followers.plates import Hole as Hole
    from .followers.plates import Plate as Plate
    from .followers.roller import AbstractRoller as AbstractRoller
    from .measures import SegmentLimits as SegmentLimits
    from .measures import cam_table as cam_table
    from .measures import contact_travel as contact_travel
    from .measures import polar_radius as polar_radius
    from .measures import segment_limits as segment_limits
    from .program.program import FollowerMotion as FollowerMotion
    from .program.segments import LiftPolynomial as LiftPolynomial
    from .program.segments import LiftSpline as LiftSpline
    from .program.segments import LiftTable as LiftTable
    from .program.segments import OptimisedPolynomial as OptimisedPolynomial
    from .program.segments import OptimisedSpline as OptimisedSpline
    from .undercut import Undercut as Undercut
else:
    from ..lazy import attach

    __getattr__, __dir__ = attach(__name__)
