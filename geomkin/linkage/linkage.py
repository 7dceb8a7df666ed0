"""The one general linkage: bodies with named points, sliders, a driver."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from ..arguments import Place, Sort, check_fields, is_place
from ..errors import DesignError, shown
from ..names import check_names
from ..plane.vec import Array, direction_deg


def _are_bodies(value: Any) -> bool:
    return isinstance(value, Mapping) and all(
        isinstance(body, str) and isinstance(points, Mapping) and all(is_place(z, gaps=True) for z in points.values())
        for body, points in value.items()
    )


# That the points are finite is said with their names.
Bodies = Annotated[
    Mapping[str, Mapping[str, complex]], Sort(_are_bodies, "a table of bodies, each a table of its points, x + yj")
]


@dataclass(frozen=True, eq=False)
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

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def direction(self) -> Array:
        """The line's direction in the frame of `along`, unit complex."""
        return direction_deg(self.direction_deg)


@dataclass(frozen=True, eq=False)
class Linkage:
    """Rigid bodies with named points: where two bodies name the same point, a pin joins them there.

    bodies: the fixed body first, each with its points, mm in its own frame. sliders: the sliding
    joints. driver: the body that is driven: its angle from the ground's x axis, or its displacement if it
    slides on the ground. origin, ground_angle_deg: where the fixed body's frame stands. estimate: roughly where
    pins are with the driver at its first frame, mm; needed only where the linkage is no chain of dyads.
    Points may be arrays (linkages,): many linkages of one make.
    """

    bodies: Bodies
    driver: str
    sliders: tuple[Slider, ...] = ()
    origin: Place = 0j
    ground_angle_deg: float = 0.0
    estimate: Mapping[str, complex] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_fields(self)
        names = list(self.bodies)
        if len(names) < 2:
            raise DesignError("bodies", f"found {len(names)}", "give the fixed body first and at least one that moves")
        check_names("bodies", names, "a body")
        check_names("bodies", (point for points in self.bodies.values() for point in points), "a point")
        check_names("sliders", (slider.name for slider in self.sliders), "a slider")
        if len({slider.name for slider in self.sliders}) < len(self.sliders):
            raise DesignError("sliders", "two have the same name", "give each a name of its own")
        if self.driver not in names[1:]:
            raise DesignError("driver", f"found {shown(self.driver)}", f"give one of {', '.join(names[1:])}")
        for body, points in self.bodies.items():
            for point, place in points.items():
                if not np.isfinite(place).all():
                    raise DesignError("bodies", f"point {point} of {body} is {place}", "give finite coordinates")
        for slider in self.sliders:
            for body in (slider.body, slider.along):
                if body not in names:
                    raise DesignError(
                        "sliders", f"{slider.name} names {shown(body)}", f"give one of {', '.join(names)}"
                    )

    @property
    def linkage(self) -> Linkage:
        """Itself, as every named linkage has it."""
        return self

    @cached_property
    def many(self) -> bool:
        """Whether sizes are arrays: many linkages of one make."""
        return any(np.ndim(place) for points in self.bodies.values() for place in points.values())

    @cached_property
    def ground(self) -> str:
        """Name of the fixed body."""
        return next(iter(self.bodies))

    @cached_property
    def pins(self) -> Mapping[str, tuple[str, ...]]:
        """Pins: the bodies each one joins, two or more."""
        joined: dict[str, list[str]] = {}
        for body, points in self.bodies.items():
            for point in points:
                joined.setdefault(point, []).append(body)
        return {name: tuple(bodies) for name, bodies in joined.items() if len(bodies) > 1}
