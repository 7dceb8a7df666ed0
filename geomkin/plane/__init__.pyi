# The public names of this package. Each is imported when it is first used.
from .curve import Mirrored as Mirrored
from .curve import Moved as Moved
from .curve import Offset as Offset
from .curve import Reversed as Reversed
from .joined import Path as Path
from .joined import PolarArray as PolarArray
from .joined import Spline as Spline
from .measure import (
    AreaMoments as AreaMoments,
)
from .measure import (
    area_moments as area_moments,
)
from .measure import (
    centroid as centroid,
)
from .measure import (
    convexity as convexity,
)
from .measure import (
    signed_area as signed_area,
)
from .primitives import (
    Arc as Arc,
)
from .primitives import (
    Circle as Circle,
)
from .primitives import (
    Polyline as Polyline,
)
from .primitives import (
    Segment as Segment,
)
from .primitives import (
    rounded_hull as rounded_hull,
)
from .primitives import (
    slot as slot,
)
from .roulettes import Cycloid as Cycloid
from .roulettes import Involute as Involute
from .roulettes import Trochoid as Trochoid
from .vec import Pose as Pose
from .vec import xy as xy
