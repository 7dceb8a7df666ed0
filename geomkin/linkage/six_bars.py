"""Six-bars: four-bars that move an output link through a second dyad, the shaper; and the pantograph."""

from __future__ import annotations

from functools import cached_property

from ..core.errors import DesignError
from ..core.fields import FARTHEST, ComplexPoint, Ratio, entry, inside, quantity
from ..core.records import record
from ..core.units import mm
from ..plane.vec import Array
from .joints.slide import Slider
from .linkage import AbstractLinkage, BodyPoints, Linkage, points_entry, with_points
from .named_linkages import FourBar


@record(checked=True)
class Shaper(AbstractLinkage):
    """Shaper (quick-return) mechanism: a crank pin in the slot of a lever, whose tip moves a ram by a connecting rod.

    The crank turns about `origin`. The ram's line is perpendicular to the line from crank pivot to lever pivot, on the
    other side of the crank. By default the lever's pivot is below the crank and the ram runs along x. The ram cuts
    slowly and returns quickly. Joints for branches: `slide`, and `ram_pin`: +1 puts the ram on the +x side of the
    lever's tip.

    Parameters
    ----------
    ground : float
        Distance from crank pivot to lever pivot, mm; above 0.
    crank : float
        Length of the crank, mm; above 0 and below `ground`.
    lever : float
        Distance from the lever's pivot to its tip, mm; above 0.
    link : float
        Connecting rod from the lever's tip to the ram, mm; above 0.
    ram_height : float
        Distance from the crank pivot to the ram's line, away from the lever pivot, mm; above 0.
    origin : complex
        Position of the crank's ground pivot, mm.
    ground_angle_deg : float
        Direction from the crank pivot to the lever pivot, deg, from -360 to 360.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    Raises
    ------
    DesignError
        If a size is out of range, or the crank is not shorter than the ground.

    See Also
    --------
    InvertedSliderCrank, SliderCrank, move
    """

    ground: float = quantity("from crank pivot to lever pivot", "mm", above=0, at_most=FARTHEST, example=90)
    crank: float = quantity("length of the crank", "mm", above=0, at_most=FARTHEST, example=30)
    lever: float = quantity("from lever pivot to the lever's tip", "mm", above=0, at_most=FARTHEST, example=180)
    link: float = quantity("connecting rod, from lever tip to ram", "mm", above=0, at_most=FARTHEST, example=60)
    ram_height: float = quantity(
        "from crank pivot to the ram's line, away from the lever pivot", "mm", above=0, at_most=FARTHEST, example=85
    )
    origin: ComplexPoint = entry("crank's ground pivot, [x, y] in mm", default=0j)
    ground_angle_deg: float = quantity(
        "direction from crank pivot to lever pivot", "deg", default=-90.0, at_least=-360, at_most=360
    )
    points: BodyPoints = points_entry()

    def __post_init__(self) -> None:
        if self.crank >= self.ground:
            problem = (
                f"found {mm(self.crank):g}, but the lever turns over unless the crank is shorter than the ground, "
                f"{mm(self.ground):g}"
            )
            raise DesignError("crank", problem, f"give less than {mm(self.ground):down}", value=inside(self.ground, 1))

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: the sliding joints are "slide" (crank pin on lever) and "ram_slide"."""
        return Linkage(
            bodies={
                "ground": {"crank_pivot": 0j, "lever_pivot": self.ground + 0j},
                "crank": {"crank_pivot": 0j, "crank_pin": self.crank + 0j},
                "lever": {"lever_pivot": 0j, "lever_tip": self.lever + 0j},
                "block": {"crank_pin": 0j},
                "link": {"lever_tip": 0j, "ram_pin": self.link + 0j},
                "ram": {"ram_pin": 0j},
            },
            driver="crank",
            sliders=(
                Slider("slide", "block", "lever"),
                Slider("ram_slide", "ram", "ground", through=-self.ram_height + 0j, direction_deg=90.0),
            ),
            origin=self.origin,
            ground_angle_deg=self.ground_angle_deg,
        )


@record(checked=True)
class StephensonSixBar(AbstractLinkage):
    """Stephenson six-bar: a four-bar whose coupler point moves an output link through a connecting link.

    The output dwells while the coupler point runs along an arc about the far end of the connecting link, with the
    radius `link`. Joints for branches: `rocker_pin`, and `output_pin`: +1 puts it left of the line from the coupler
    point to the output pivot. Angles and `output_pivot` are measured from the four-bar's ground line.

    Parameters
    ----------
    four_bar : FourBar
        The first loop; its `coupler_point` moves the connecting link.
    link : float
        Connecting link from coupler point to output pin, mm; above 0.
    output : float
        Output link from its pivot to its pin, mm; above 0.
    output_pivot : complex
        Ground pivot of the output link, mm from the crank pivot.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    See Also
    --------
    WattSixBar, FourBar, Linkage, move
    """

    four_bar: FourBar
    link: float = quantity(
        "connecting link, from coupler point to output pin", "mm", above=0, at_most=FARTHEST, example=120
    )
    output: float = quantity("output link, from its pivot to its pin", "mm", above=0, at_most=FARTHEST, example=90)
    output_pivot: ComplexPoint = entry(
        "ground pivot of the output link, from the crank pivot, [x, y] in mm", example=130 + 100j
    )
    points: BodyPoints = points_entry()

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: bodies of the four-bar, then "link" and "output"."""
        return _with_dyad(self.four_bar, "coupler_point", "coupler", self.four_bar.coupler_point, self)


@record(checked=True)
class WattSixBar(AbstractLinkage):
    """Watt six-bar: two four-bars in series; a point of the first one's rocker moves an output link.

    Joints for branches: `rocker_pin`, and `output_pin`: +1 puts it left of the line from the rocker's point to the
    output pivot. Angles and `output_pivot` are measured from the first four-bar's ground line.

    Parameters
    ----------
    four_bar : FourBar
        The first loop.
    rocker_point : complex
        Point of the rocker that moves the second coupler, mm from its ground pivot, x towards the rocker pin.
    link : float
        Second coupler, from rocker point to output pin, mm; above 0.
    output : float
        Output link from its pivot to its pin, mm; above 0.
    output_pivot : complex
        Ground pivot of the output link, mm from the crank pivot.
    points : dict of str to dict of str to complex
        Further points of bodies by name, mm in the frame of the body.

    See Also
    --------
    StephensonSixBar, FourBar, Linkage, move
    """

    four_bar: FourBar
    rocker_point: ComplexPoint = entry(
        "point of the rocker that drives on, from its ground pivot, x towards the rocker pin, [x, y] in mm",
        example=50 - 30j,
    )
    link: float = quantity(
        "second coupler, from rocker point to output pin", "mm", above=0, at_most=FARTHEST, example=90
    )
    output: float = quantity("output link, from its pivot to its pin", "mm", above=0, at_most=FARTHEST, example=60)
    output_pivot: ComplexPoint = entry(
        "ground pivot of the output link, from the crank pivot, [x, y] in mm", example=180 + 0j
    )
    points: BodyPoints = points_entry()

    @cached_property
    @with_points
    def linkage(self) -> Linkage:
        """The general linkage: bodies of the four-bar, then "link" and "output"."""
        return _with_dyad(self.four_bar, "rocker_point", "rocker", self.rocker_point, self)


def _with_dyad(
    four_bar: FourBar, point: str, body: str, place: complex | Array, sizes: StephensonSixBar | WattSixBar
) -> Linkage:
    first = four_bar.linkage
    bodies = {name: dict(points) for name, points in first.bodies.items()}
    bodies[body][point] = place
    bodies["ground"]["output_pivot"] = sizes.output_pivot
    bodies["link"] = {point: 0j, "output_pin": sizes.link + 0j}
    bodies["output"] = {"output_pivot": 0j, "output_pin": sizes.output + 0j}
    return Linkage(bodies, first.driver, (), first.origin, first.ground_angle_deg)


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
            problem = (
                f"found {mm(distance):g} from the pole, but the bars reach from "
                f"{mm(nearest, farthest, between=' to '):g} there"
            )
            remedy = f"give a distance within {mm(self.crank):g} of that range"
            raise DesignError("crank_pivot", problem, remedy, "does-not-assemble")

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
