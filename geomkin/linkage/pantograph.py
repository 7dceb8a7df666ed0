"""The pantograph: a parallelogram that copies the motion of one point larger, about a pole."""

from __future__ import annotations

from functools import cached_property

from ..core.errors import DesignError
from ..core.fields import FARTHEST, ComplexPoint, Ratio, entry, quantity
from ..core.records import record
from ..core.units import mm
from .linkage import AbstractLinkage, BodyPoints, Linkage, points_entry, with_points


@record(checked=True)
class Pantograph(AbstractLinkage):
    """A parallelogram of four bars whose pen copies the path of a tracer, enlarged about a pole.

    Pole, tracer and pen stay in line, with pen = pole + ratio (tracer - pole). A crank carries the tracer round a
    circle, so that the pen draws one that is `ratio` times as large.

    Parameters
    ----------
    arm : float
        Long bar from the pole to the elbow, mm.
    forearm : float
        Long bar from the elbow to the pen, mm.
    ratio : float
        Size of the pen's path to that of the tracer, above 1.
    crank : float
        Radius of the tracer's circle, mm.
    crank_pivot : complex
        Centre of the tracer's circle, from the pole, mm.
    origin : complex
        The pole, mm.
    ground_angle_deg : float
        Angle by which the whole is turned about the pole.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    Raises
    ------
    DesignError
        If the bars reach no point of the tracer's circle.

    Notes
    -----
    Joints for branches: `arm_joint` and `forearm_joint`. With both at +1, the default, the short bars are parallel to
    the long ones; with different signs they cross, and the pen no longer copies. Source: C. Scheiner, Pantographice
    (1631); the proof is that of similar triangles.

    Examples
    --------
    >>> import geomkin as gk
    >>> linkage = gk.linkage.Pantograph(arm=150, forearm=150, ratio=3, crank=10, crank_pivot=60 + 0j)
    >>> motion = gk.move(linkage, [0.0, 1.0])
    >>> bool(abs(motion.point("pen").position - 3 * motion.point("tracer").position).max() < 1e-9)
    True
    """

    arm: float = quantity("bar from the pole to the elbow", "mm", above=0, at_most=FARTHEST, example=150)
    forearm: float = quantity("bar from the elbow to the pen", "mm", above=0, at_most=FARTHEST, example=150)
    ratio: Ratio = quantity("size of the pen's path to that of the tracer", above=1, at_most=100, example=3)
    crank: float = quantity("radius of the tracer's circle", "mm", above=0, at_most=FARTHEST, example=15)
    crank_pivot: ComplexPoint = entry("centre of the tracer's circle, from the pole, [x, y] in mm", example=65 + 0j)
    origin: ComplexPoint = entry("the pole, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "angle by which the whole is turned about the pole", "deg", default=0.0, at_least=-360, at_most=360
    )
    points: BodyPoints = points_entry()

    def __post_init__(self) -> None:
        distance = abs(self.crank_pivot)
        farthest, nearest = (self.arm + self.forearm) / self.ratio, abs(self.arm - self.forearm) / self.ratio
        if abs(distance - self.crank) >= farthest or distance + self.crank <= nearest:
            raise DesignError(
                "crank_pivot",
                f"found {mm(distance):g} from the pole, but the bars reach from "
                f"{mm(nearest, farthest, between=' to '):g} there",
                f"give a distance within {mm(self.crank):g} of that range",
                "does-not-assemble",
            )

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage; the frame of each bar lies at the joint that is named first."""
        arm_joint, forearm_joint = self.arm / self.ratio, self.forearm / self.ratio
        return Linkage(
            bodies={
                "ground": {"pole": 0j, "crank_pivot": self.crank_pivot},
                "crank": {"crank_pivot": 0j, "tracer": self.crank + 0j},
                "arm": {"pole": 0j, "arm_joint": arm_joint + 0j, "elbow": self.arm + 0j},
                "tracer_bar": {"arm_joint": 0j, "tracer": forearm_joint + 0j},
                "forearm": {"elbow": 0j, "forearm_joint": forearm_joint + 0j, "pen": self.forearm + 0j},
                "link": {"tracer": 0j, "forearm_joint": self.arm - arm_joint + 0j},
            },
            driver="crank",
            origin=self.origin,
            ground_angle_deg=self.ground_angle_deg,
        )
