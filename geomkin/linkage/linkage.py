"""The general linkage: rigid bodies with named points, sliders and one driver."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import MISSING, field, fields, replace
from functools import cached_property, lru_cache, wraps
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np

from ..core.arguments import LARGEST, PLAIN, ArgumentType, is_place
from ..core.errors import DesignError, ProblemId, shown
from ..core.fields import LONGEST, ComplexOrArray, ComplexPoint, KindTable, entry, moving_picture, one_line
from ..core.names import check_names
from ..core.records import record
from ..core.units import mm
from ..plane.vec import Array, Real, direction_deg
from .joints.gear_mesh import GearMesh
from .joints.joint import AbstractJoint, PinJoint
from .joints.slide import AbstractSlide, PinInSlot, Slider
from .solve.placement import Placement

# The structure of a linkage, equal for linkages that differ only in sizes: each body with its points; each slide with
# its name, body and guide, and its pin if it has one; the driver; each mesh with its name, bodies and teeth.
Meshes = tuple[tuple[str, tuple[str, str], tuple[int, int]], ...]
Structure = tuple[tuple[tuple[str, ...], ...], tuple[tuple[str, ...], ...], str, Meshes]
# Attributes of `Motion`, which has its bodies as further attributes: no body may have one of these names.
MOTION_ATTRIBUTES = {
    "assembled", "bodies", "branches", "drive", "error_amplification", "given", "linkage",
    "point", "residual", "sensitivity", "slide", "solution", "timing", "to_columns", "transmission_angle",
}  # fmt: skip


def _are_bodies(value: Any) -> bool:
    return isinstance(value, Mapping) and all(isinstance(points, Mapping) for points in value.values())


# `Linkage` itself checks the points, so that its message can name the point.
Bodies = Annotated[
    Mapping[str, Mapping[str, complex | Array]],
    ArgumentType(_are_bodies, "a table of bodies, each a table of its points, x + yj"),
]


# kind -> class of each linkage that a recipe may contain as a table; filled in `kinds.any_linkage`.
LINKAGES: KindTable[AbstractLinkage] = KindTable()


class AbstractLinkage(ABC):
    """Base class of all linkages: the named ones (FourBar, SliderCrank, ...) and the general Linkage."""

    KINDS: ClassVar[KindTable[AbstractLinkage]] = LINKAGES

    _repr_html_ = moving_picture
    can_be_scaled: ClassVar[bool] = True

    @property
    @abstractmethod
    def linkage(self) -> Linkage:
        """The same mechanism as a general Linkage, which is what is solved, drawn and cut."""

    def __repr__(self) -> str:
        defaults = {f.name: f.default if f.default_factory is MISSING else f.default_factory() for f in fields(self)}  # type: ignore[arg-type]
        values = ((name, getattr(self, name), default) for name, default in defaults.items())
        arguments = ", ".join(f"{name}={value!r}" for name, value, default in values if np.any(value != default))
        text = f"{type(self).__name__}({arguments})"
        return text if len(text) <= LONGEST and not self.linkage.is_batch else one_line(self)


OneLinkage = Annotated[
    AbstractLinkage,
    ArgumentType(
        lambda value: isinstance(value, AbstractLinkage) and not value.linkage.is_batch,
        "one linkage, its sizes numbers and no arrays",
    ),
]


@record(checked=True, eq=False)
class Linkage(AbstractLinkage):
    """Rigid bodies with named points; a pin joins two bodies at each point that both name.

    Parameters
    ----------
    bodies : mapping of str to mapping of str to complex
        The fixed body first, each with its points, mm in its own frame. Points may be arrays of shape
        (linkages,): many linkages of one structure. A body may not have the name of an attribute of `Motion`.
    driver : str
        The driven body: its angle from the fixed body's x axis is driven, or its displacement if it slides on
        the fixed body. Or the name of a slider, whose displacement is driven, as in a hydraulic cylinder
        between any two bodies. The two bodies of such an actuator count as one bar if a branch depends on the order
        of bodies.
    sliders : tuple of Slider
        The sliding joints.
    origin : complex
        Position of the fixed body's origin, mm.
    ground_angle_deg : float
        Direction of the fixed body's x axis, deg.
    estimate : mapping of str to complex
        Approximate positions of pins at the first frame, mm. Only needed if the linkage is not a chain of dyads.
    slots : tuple of PinInSlot
        The pins that run in slots.
    meshes : tuple of GearMesh
        The gears that couple bodies on the ground.

    Raises
    ------
    DesignError
        If a name is not allowed or used twice, a point is not finite, a slider or the driver names no body, or the
        driver could be meant as an angle and as a displacement.

    See Also
    --------
    Slider, PinInSlot, FourBar, move

    Examples
    --------
    >>> import geomkin as gk
    >>> linkage = gk.Linkage(
    ...     bodies={
    ...         "ground": {"crank_pivot": 0, "rocker_pivot": 100},
    ...         "crank": {"crank_pivot": 0, "crank_pin": 30},
    ...         "coupler": {"crank_pin": 0, "rocker_pin": 90},
    ...         "rocker": {"rocker_pivot": 0, "rocker_pin": 70},
    ...     },
    ...     driver="crank",
    ... )
    >>> motion = gk.move(linkage, [0.0])
    >>> complex(motion.point("rocker_pin").position[0].round(3))
    (87.857+68.939j)
    """

    bodies: Bodies
    driver: str
    sliders: tuple[Slider, ...] = ()
    origin: ComplexOrArray = 0j
    ground_angle_deg: float = 0.0
    estimate: Mapping[str, complex] = field(default_factory=dict)
    slots: tuple[PinInSlot, ...] = ()
    meshes: tuple[GearMesh, ...] = ()

    def __post_init__(self) -> None:
        _check_structure(*self.structure)
        shapes = set()
        for body, points in self.bodies.items():
            for point, place in points.items():
                if not is_place(place):
                    is_number = PLAIN[np.ndarray].fits(place)
                    value = "not finite everywhere" if is_number and np.ndim(place) else shown(place)
                    remedy = f"give finite coordinates x + yj below {mm(LARGEST):down6}"
                    id: ProblemId = "impossible-geometry" if is_number else "wrong-type"
                    raise DesignError("bodies", f"point {point} of {body} is {value}", remedy, id)
                if isinstance(place, np.ndarray):
                    shapes.add(place.shape)
        shapes -= {(), (1,)}
        if len(shapes) > 1 or (0,) in shapes:
            problem = f"found points of {' and '.join(str(row[0]) for row in sorted(shapes))} linkages"
            raise DesignError("bodies", problem, "give one place, or as many of each")

    @cached_property
    def structure(self) -> Structure:
        """Names of bodies and points, slides with their bodies, the driver, and meshes with their teeth."""
        slides = tuple(slide.names for slide in (*self.sliders, *self.slots))
        meshes = tuple((mesh.name, mesh.bodies, mesh.teeth) for mesh in self.meshes)
        return tuple((body, *points) for body, points in self.bodies.items()), slides, self.driver, meshes

    @property
    def driver_pivot(self) -> str | None:
        """The pin on which the driver turns on the ground; None if it slides, or has no pin there."""
        if self.driven_slider is not None:
            return None
        on_ground = self.bodies[self.ground]
        return next((p for p in self.bodies[self.driver] if p in on_ground), None)

    @property
    def linkage(self) -> Linkage:
        """The linkage itself."""
        return self

    @cached_property
    def is_batch(self) -> bool:
        """Whether points are arrays: many linkages of one structure."""
        return bool(self.shape)

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """(linkages,) if points are arrays, otherwise ()."""
        places = (z for points in self.bodies.values() for z in points.values() if isinstance(z, np.ndarray))
        return max((z.shape for z in places), default=())

    @cached_property
    def ground_direction(self) -> complex:
        """Direction of the fixed body's x axis, unit complex."""
        return complex(direction_deg(self.ground_angle_deg)) if self.ground_angle_deg else 1 + 0j

    @property
    def shifted(self) -> bool:
        """Whether the fixed body's origin is not at 0."""
        return bool(np.any(self.origin)) if isinstance(self.origin, np.ndarray) else self.origin != 0

    @cached_property
    def size(self) -> Real:
        """Largest distance of a point or a slide line from its body's origin, mm, shape () or (linkages,)."""
        places = [z for points in self.bodies.values() for z in points.values()]
        places += [place for slide in self.slides for place in (slide.point, slide.through)]
        largest: Real = np.zeros(())
        for place in places:
            largest = np.maximum(largest, np.abs(place))
        return largest

    @cached_property
    def ground(self) -> str:
        """Name of the fixed body."""
        return next(iter(self.bodies))

    @cached_property
    def driven_slider(self) -> Slider | None:
        """The sliding joint whose displacement, mm, is driven; None if the driver is an angle."""
        if self.driver in self.bodies:
            ends = {self.driver, self.ground}
            return next((s for s in self.sliders if {s.body, s.along} == ends), None)
        return next(s for s in self.sliders if s.name == self.driver)

    @cached_property
    def pins(self) -> Mapping[str, tuple[str, ...]]:
        """Name of each pin -> the bodies that it joins, two or more."""
        bodies_at: dict[str, list[str]] = {}
        for body, points in self.bodies.items():
            for point in points:
                bodies_at.setdefault(point, []).append(body)
        return {name: tuple(bodies) for name, bodies in bodies_at.items() if len(bodies) > 1}

    @cached_property
    def slides(self) -> tuple[AbstractSlide, ...]:
        """The joints in which a point of one body runs along a line of another: sliders, then pins in slots."""
        return *self.sliders, *(slot.of(self.bodies) for slot in self.slots)

    @property
    def sized_joints(self) -> tuple[AbstractJoint, ...]:
        """The joints with sizes of their own: slides, then meshes."""
        return *self.slides, *self.meshes

    def with_joints(self, changed: Callable[[Any], Any]) -> dict[str, Any]:
        """The fields of these joints, with each of them changed."""
        return {field: tuple(map(changed, getattr(self, field))) for field in ("sliders", "slots", "meshes")}

    @cached_property
    def joints(self) -> tuple[AbstractJoint, ...]:
        """All joints, the pins first."""
        pins = (PinJoint(name, {b: self.bodies[b][name] for b in bodies}) for name, bodies in self.pins.items())
        return *pins, *self.sized_joints

    @cached_property
    def joint_points(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the points at which joints are, with the bodies to which each belongs."""
        named: dict[str, tuple[str, ...]] = {}
        for point, bodies in (item for joint in self.joints for item in joint.points.items()):
            named[point] = tuple(dict.fromkeys((*named.get(point, ()), *bodies)))
        return named

    @cached_property
    def plans(self) -> dict[bool, tuple[Placement, ...]]:
        """Cache of the solver: the placements of all bodies, by whether branches are followed."""
        return {}

    @cached_property
    def programs(self) -> dict[object, tuple[Any, dict[int, Any]]]:
        """Cache of the solver: the program of the structure and its values at these sizes, by branch."""
        return {}


# Number of structures in the cache: linkages of new sizes mostly have the structure of one before.
STRUCTURES = 256


@lru_cache(STRUCTURES)
def _check_structure(
    bodies: tuple[tuple[str, ...], ...], slides: tuple[tuple[str, ...], ...], driver: str, meshes: Meshes
) -> None:
    """Raise DesignError for names, joints or a driver that make no linkage, whatever its sizes.

    bodies: each a name and its points, the ground first; slides: each name, body, guide, and its pin if it has one;
    meshes: each name, bodies and teeth.
    """
    names = [body for body, *_ in bodies]
    if len(names) < 2:
        raise DesignError("bodies", f"found {len(names)}", "give the fixed body first and at least one that moves")
    check_names("bodies", names, "a body")
    if taken := [name for name in names if name in MOTION_ATTRIBUTES or name.startswith("_")]:
        problem = f"a body is named {shown(taken[0])}, which is reserved for an attribute of Motion"
        raise DesignError("bodies", problem, f"give it another name, such as {taken[0].lstrip('_')}_body")
    check_names("bodies", (point for _, *points in bodies for point in points), "a point")
    sliders = tuple((name, body, along) for name, body, along, *pin in slides if not pin)
    joints = [name for name, *_ in sliders]
    check_names("sliders", joints, "a slider")
    check_names("slots", (name for name, _, _, *pin in slides if pin), "a slot")
    if len({name for name, *_ in slides}) < len(slides):
        field = "sliders" if len(sliders) == len(slides) else "slots"
        raise DesignError(field, "two have the same name", "give each a different name")
    drivers = [*names[1:], *joints]
    if driver not in drivers:
        raise DesignError("driver", f"found {shown(driver)}", f"give one of {', '.join(drivers)}")
    points = {body: named for body, *named in bodies}
    for name, *ends, pin in ((*slide, "")[:4] for slide in slides):
        field = "slots" if pin else "sliders"
        for body in ends:
            if body not in names:
                raise DesignError(field, f"{name} names {shown(body)}", f"give one of {', '.join(names)}")
        if ends[0] == ends[1]:
            raise DesignError(field, f"{name} slides {ends[0]} on itself", "give two bodies")
        if pin and pin not in points[ends[0]]:
            problem = f"{name} names {shown(pin)}, which is not a point of {ends[0]}"
            raise DesignError(field, problem, f"give one of {', '.join(points[ends[0]]) or 'its points'}")
    check_names("meshes", (name for name, *_ in meshes), "a gear mesh")
    joined = [name for name, *_ in (*slides, *meshes)]
    if len({*joined}) < len(joined):
        raise DesignError("meshes", "two joints have the same name", "give each a different name")
    on_ground = [body for body in names[1:] if {*points[body]} & {*points[names[0]]}]
    for name, pair, _ in meshes:
        if not {*pair} <= {*on_ground} or pair[0] == pair[1]:
            problem = f"{name} joins {' and '.join(map(shown, pair))}"
            raise DesignError("meshes", problem, f"give two that turn on the {names[0]}: {', '.join(on_ground)}")
    _check_driver(bodies, sliders, driver)


def _check_driver(bodies: tuple[tuple[str, ...], ...], sliders: tuple[tuple[str, str, str], ...], driver: str) -> None:
    """A driver that could be meant as an angle and as a displacement is refused."""
    ground, *ground_points = bodies[0]
    bodies_of_sliders = {name: {body, along} for name, body, along in sliders}
    if driver not in {body for body, *_ in bodies} or {driver, ground} in bodies_of_sliders.values():
        return
    if driver in bodies_of_sliders:
        raise DesignError("driver", f"{driver} is the name of a body and of a slider", "give the slider another name")
    sliding = {name: ends - {driver} for name, ends in bodies_of_sliders.items() if driver in ends}
    pinned = {body for body, *points in bodies if set(points) & set(ground_points)}
    if not sliding or driver in pinned:
        return
    name, (other,) = next(iter(sliding.items()))
    or_angle = f", or {other}, which turns as it does, for its angle" if other in pinned else ""
    problem = (
        f"{driver} slides on {other} and is not pinned to the {ground}, so its angle may be meant or its displacement"
    )
    raise DesignError("driver", problem, f"give {name}, the slider, for its displacement{or_angle}")


# Further points of the bodies of a named linkage.
BodyPoints = dict[str, dict[str, ComplexPoint]]
L = TypeVar("L", bound=AbstractLinkage)


def points_entry() -> Any:
    """Field for further points of a named linkage."""
    return entry(
        "further points of bodies by name, such as points.rocker.tip = [x, y] in mm in the frame of the rocker; each "
        "has columns, a trail, a hole in its plate, and may be named by loads",
        default_factory=dict,
    )


def with_points(linkage_of: Callable[[L], Linkage]) -> Callable[[L], Linkage]:
    """The general linkage of a named one, with the further points of its field `points`."""

    @wraps(linkage_of)
    def extended(named: L) -> Linkage:
        linkage, points = linkage_of(named), named.points  # type: ignore[attr-defined]
        if not points:
            return linkage
        bodies = {body: dict(places) for body, places in linkage.bodies.items()}
        taken = {point for places in bodies.values() for point in places}
        for body, places in points.items():
            if body not in bodies:
                problem = f"found {shown(body)}, which is not a body"
                raise DesignError(f"points.{body}", problem, f"give one of {', '.join(bodies)}", "unknown-key")
            for point, place in places.items():
                if point in taken:
                    raise DesignError(f"points.{body}.{point}", "the linkage has a point of this name", "give another")
                taken.add(point)
                bodies[body][point] = place
        return replace(linkage, bodies=bodies)

    return extended
