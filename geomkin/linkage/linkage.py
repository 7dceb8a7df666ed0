"""The one general linkage: bodies with named points, sliders, a driver."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np

from ..core.arguments import LARGEST, PLAIN, ArgumentType, Place, is_place
from ..core.errors import DesignError, shown
from ..core.fields import KindTable
from ..core.names import check_names
from ..core.records import record
from ..core.reprs import LONGEST, moving, one_line
from ..plane.vec import Array, Complex, Real, direction_deg
from .solve.placement import Placement

if TYPE_CHECKING:
    from .solve.program import Formulas


def _are_bodies(value: Any) -> bool:
    return isinstance(value, Mapping) and all(
        isinstance(body, str)
        and isinstance(points, Mapping)
        and all(PLAIN[np.ndarray].fits(z) for z in points.values())
        for body, points in value.items()
    )


# That the points are finite is said with their names.
Bodies = Annotated[
    Mapping[str, Mapping[str, complex | Array]],
    ArgumentType(_are_bodies, "a table of bodies, each a table of its points, x + yj"),
]


# kind -> table of all linkages that one table of a recipe may describe; filled in `kinds.any_linkage`.
LINKAGES: KindTable[AbstractLinkage] = KindTable()


class AbstractLinkage(ABC):
    """A linkage by whatever describes it: the sizes of a FourBar, a SliderCrank, ..., or the bodies of a Linkage."""

    KINDS: ClassVar[KindTable[AbstractLinkage]] = LINKAGES

    _repr_html_ = moving
    can_be_scaled: ClassVar[bool] = True

    @property
    @abstractmethod
    def linkage(self) -> Linkage:
        """The same as bodies with named points: what is solved, drawn and cut."""

    def __repr__(self) -> str:
        """As it is made, without what may be left out; of much in one line."""
        values = ((f.name, getattr(self, f.name), f.default) for f in fields(self))  # type: ignore[arg-type]
        told = ", ".join(f"{name}={value!r}" for name, value, left_out in values if np.any(value != left_out))
        text = f"{type(self).__name__}({told})"
        return text if len(text) <= LONGEST and not self.linkage.is_batch else one_line(self)


AnyLinkage = Annotated[
    AbstractLinkage,
    ArgumentType(lambda value: isinstance(value, AbstractLinkage), "a linkage, such as FourBar or Linkage"),
]
OneLinkage = Annotated[
    AbstractLinkage,
    ArgumentType(
        lambda value: isinstance(value, AbstractLinkage) and not value.linkage.is_batch,
        "one linkage, its sizes numbers and no arrays",
    ),
]


@record(checked=True, eq=False)
class Slider:
    """A sliding joint: `body` slides along a straight line of the body `along`, without turning against it.

    point: the place of `body`, mm in its own frame, that stays on the line. through, direction_deg:
    the line in the frame of `along`. angle_deg: the body's x axis from the line's direction.
    """

    name: str
    body: str
    along: str
    point: Place = 0j
    through: Place = 0j
    direction_deg: float = 0.0
    angle_deg: float = 0.0

    @property
    def direction(self) -> Complex:
        """The line's direction in the frame of `along`, unit complex."""
        return direction_deg(self.direction_deg)

    def seen(self, body: str, place: complex | Complex, displacement: float) -> Complex:
        """A point of one of its two bodies in the frame of the other, mm."""
        turn = self.direction * direction_deg(self.angle_deg)
        start = self.through + displacement * self.direction
        return (
            start + turn * (place - self.point) if body == self.body else self.point + np.conj(turn) * (place - start)
        )


@record(checked=True, eq=False)
class Linkage(AbstractLinkage):
    """Rigid bodies with named points: where two bodies name the same point, a pin joins them there.

    bodies: the fixed body first, each with its points, mm in its own frame. sliders: the sliding
    joints. driver: the body that is driven: its angle from the ground's x axis, or its displacement if it
    slides on the ground; or the slider that is driven: its displacement, as of a cylinder and its rod between any
    two bodies, which count as one bar where a branch goes by the order of bodies. origin, ground_angle_deg: where
    the fixed body's frame stands. estimate: roughly where pins are with the driver at its first frame, mm; needed
    only where the linkage is no chain of dyads.
    Points may be arrays (linkages,): many linkages of one make.
    """

    bodies: Bodies
    driver: str
    sliders: tuple[Slider, ...] = ()
    origin: Place = 0j
    ground_angle_deg: float = 0.0
    estimate: Mapping[str, complex] = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = list(self.bodies)
        if len(names) < 2:
            raise DesignError("bodies", f"found {len(names)}", "give the fixed body first and at least one that moves")
        check_names("bodies", names, "a body")
        check_names("bodies", (point for points in self.bodies.values() for point in points), "a point")
        check_names("sliders", (slider.name for slider in self.sliders), "a slider")
        if len({slider.name for slider in self.sliders}) < len(self.sliders):
            raise DesignError("sliders", "two have the same name", "give each a name of its own")
        drivers = [*names[1:], *(slider.name for slider in self.sliders)]
        if self.driver not in drivers:
            raise DesignError("driver", f"found {shown(self.driver)}", f"give one of {', '.join(drivers)}")
        for body, points in self.bodies.items():
            for point, place in points.items():
                if not is_place(place):
                    found = f"point {point} of {body} is {'not finite everywhere' if np.ndim(place) else place}"
                    raise DesignError("bodies", found, f"give finite coordinates below {LARGEST:g} mm")
        rows = {np.shape(place) for points in self.bodies.values() for place in points.values()} - {(), (1,)}
        if len(rows) > 1 or (0,) in rows:
            found = f"found points of {' and '.join(str(row[0]) for row in sorted(rows))} linkages"
            raise DesignError("bodies", found, "give one place, or as many of each")
        for slider in self.sliders:
            for body in (slider.body, slider.along):
                if body not in names:
                    raise DesignError(
                        "sliders", f"{slider.name} names {shown(body)}", f"give one of {', '.join(names)}"
                    )
            if slider.body == slider.along:
                raise DesignError("sliders", f"{slider.name} slides {slider.body} on itself", "give two bodies")
        self._check_driver()

    def _check_driver(self) -> None:
        """A driver that could be meant as an angle or as a displacement is refused."""
        if self.driver not in self.bodies or self.driven_slider:
            return
        alike = [slider.name for slider in self.sliders if slider.name == self.driver]
        if alike:
            raise DesignError(
                "driver", f"{self.driver} is the name of a body and of a slider", "give the slider another name"
            )
        sliding = {s.name: {s.body, s.along} - {self.driver} for s in self.sliders if self.driver in (s.body, s.along)}
        pinned = {body for bodies in self.pins.values() if self.ground in bodies for body in bodies}
        if not sliding or self.driver in pinned:
            return
        name, (other,) = next(iter(sliding.items()))
        turning = f", or {other}, which turns as it does, for its angle" if other in pinned else ""
        raise DesignError(
            "driver",
            f"{self.driver} slides on {other} and is not pinned to the {self.ground}, so its angle may be meant or its "
            "displacement",
            f"give {name}, the slider, for its displacement{turning}",
        )

    @property
    def driver_pivot(self) -> str | None:
        """The pin on which the driver turns on the ground; None where it slides, or turns on no pin there."""
        if self.driven_slider is not None:
            return None
        on_ground = self.bodies[self.ground]
        return next((p for p in self.bodies[self.driver] if p in on_ground), None)

    @property
    def linkage(self) -> Linkage:
        """Itself."""
        return self

    @cached_property
    def is_batch(self) -> bool:
        """Whether sizes are arrays: many linkages of one make."""
        return bool(self.shape)

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """(linkages,) where sizes are arrays, otherwise ()."""
        return np.broadcast_shapes(*(np.shape(z) for points in self.bodies.values() for z in points.values()))

    @cached_property
    def ground_direction(self) -> complex:
        """The fixed body's x axis, unit complex."""
        return complex(direction_deg(self.ground_angle_deg))

    @cached_property
    def shifted(self) -> bool:
        """Whether the fixed body's origin stands elsewhere than at 0."""
        return bool(np.any(self.origin != 0))

    @cached_property
    def size(self) -> Real:
        """Largest distance of a point or a slide's line from its body's origin, mm, () or (linkages,)."""
        places = [z for points in self.bodies.values() for z in points.values()]
        places += [place for slider in self.sliders for place in (slider.point, slider.through)]
        largest: Real = np.zeros(())
        for place in places:
            largest = np.maximum(largest, np.abs(place))
        return np.asarray(largest)

    @cached_property
    def ground(self) -> str:
        """Name of the fixed body."""
        return next(iter(self.bodies))

    @cached_property
    def driven_slider(self) -> Slider | None:
        """The sliding joint whose displacement, mm, is driven; None where the driver is an angle."""
        if self.driver in self.bodies:
            ends = {self.driver, self.ground}
            return next((s for s in self.sliders if {s.body, s.along} == ends), None)
        return next(s for s in self.sliders if s.name == self.driver)

    @cached_property
    def pins(self) -> Mapping[str, tuple[str, ...]]:
        """Pins: the bodies each one joins, two or more."""
        joined: dict[str, list[str]] = {}
        for body, points in self.bodies.items():
            for point in points:
                joined.setdefault(point, []).append(body)
        return {name: tuple(bodies) for name, bodies in joined.items() if len(bodies) > 1}

    @cached_property
    def plans(self) -> dict[bool, tuple[Placement, ...]]:
        """Kept here by the solver, as curves ask for it thousands of times: how bodies are placed, by `follow`."""
        return {}

    @cached_property
    def formulas(self) -> dict[object, Formulas | int]:
        """Kept here by the solver: the formulas of its placements on each branch, or how many frames went without."""
        return {}
