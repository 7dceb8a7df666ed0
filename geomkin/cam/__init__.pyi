# The public names of this package. Each is imported when it is first used.
from .base_circle import (
    BaseCircle as BaseCircle,
)
from .base_circle import (
    flat_face_base_radius as flat_face_base_radius,
)
from .base_circle import (
    least_base_circle as least_base_circle,
)
from .checks import (
    SegmentLimits as SegmentLimits,
)
from .checks import (
    cam_checks as cam_checks,
)
from .checks import (
    cam_table as cam_table,
)
from .checks import (
    contact_travel as contact_travel,
)
from .checks import (
    polar_radius as polar_radius,
)
from .checks import (
    segment_limits as segment_limits,
)
from .dynamics import (
    CamForces as CamForces,
)
from .dynamics import (
    FollowerLoads as FollowerLoads,
)
from .dynamics import (
    GuideFriction as GuideFriction,
)
from .dynamics import (
    cam_forces as cam_forces,
)
from .dynamics import (
    jump_speed as jump_speed,
)
from .dynamics import (
    least_preload as least_preload,
)
from .dynamics import (
    least_stiffness as least_stiffness,
)
from .followers.flat import AbstractFace as AbstractFace
from .followers.follower import (
    FOLLOWERS as FOLLOWERS,
)
from .followers.follower import (
    AbstractFollower as AbstractFollower,
)
from .followers.follower import (
    Contact as Contact,
)
from .followers.follower import (
    FollowerPlate as FollowerPlate,
)
from .followers.follower import (
    Hole as Hole,
)
from .followers.roller import AbstractRoller as AbstractRoller
from .kinds.conjugate_cams import ConjugateCamsRecipe as ConjugateCamsRecipe
from .kinds.conjugate_cams import SecondCam as SecondCam
from .kinds.disk_cam import DiskCamRecipe as DiskCamRecipe
from .kinds.groove_cam import Groove as Groove
from .kinds.groove_cam import GrooveCamRecipe as GrooveCamRecipe
from .parts import CamStock as CamStock
from .parts import cam_bought as cam_bought
from .parts import cam_parts as cam_parts
from .program.program import FollowerMotion as FollowerMotion
from .program.segments import (
    LiftPolynomial as LiftPolynomial,
)
from .program.segments import (
    LiftSpline as LiftSpline,
)
from .program.segments import (
    LiftTable as LiftTable,
)
from .program.segments import (
    OptimisedPolynomial as OptimisedPolynomial,
)
from .program.segments import (
    OptimisedSpline as OptimisedSpline,
)
from .scene import cam_scene as cam_scene
from .undercut import Undercut as Undercut
