"""The slide, a point of one body on a line of another, and the pin in a slot, about which the slot may turn."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import ClassVar, Literal, Self

import numpy as np

from ...core.fields import ComplexOrArray, entry, quantity
from ...core.records import record
from ...model.scene import SceneMark
from ...model.table import Column, finite, xy_columns
from ...plane.vec import Array, Complex, Real, cross, direction_deg
from .joint import (
    AbstractJoint,
    Effect,
    EquilibriumOfJoint,
    ForcesOfJoint,
    JointForce,
    LinkageOfJoint,
    MotionOfJoint,
    Play,
    WrenchesOfJoint,
)

# Ratio of accelerations below which the Coriolis acceleration is rounding.
ROUNDING = 1e-12
# Points that differ by no more than this share of their coordinates coincide.
EQUAL = 8 * np.finfo(float).eps


class AbstractSlide(AbstractJoint):
    """A point of `body` that stays on a straight line of the body `along`.

    is_aligned: whether it also keeps the two bodies from turning relative to each other; it then takes a moment.
    point: in the frame of `body`, mm; through, direction_deg: of the line, in the frame of `along`.
    """

    is_aligned: ClassVar[bool] = True
    body: str
    along: str
    point: ComplexOrArray
    through: ComplexOrArray
    direction_deg: float

    @property
    def bodies(self) -> tuple[str, ...]:
        return self.body, self.along

    @property
    def names(self) -> tuple[str, ...]:
        """Its name, its bodies, and its pin if that is a point of a body."""
        return self.name, self.body, self.along, *self.points

    @property
    @abstractmethod
    def point_entry(self) -> tuple[str, str]:
        """Owner and name of the point among the sizes of the linkage."""

    @abstractmethod
    def line_on(self, body: str) -> complex:
        """Direction of the line in the frame of a body on which it is fixed."""

    @abstractmethod
    def runs_in(self, linkage: LinkageOfJoint) -> tuple[str, complex, str] | None:
        """A body, its pin, mm, and the body with the slot for that pin; None if plates slide on each other."""

    @cached_property
    def direction(self) -> Complex:
        """Direction of the line in the frame of `along`, unit complex."""
        return direction_deg(self.direction_deg)

    def line(self, motion: MotionOfJoint) -> Complex:
        """Direction of the line on the ground, unit complex, at the frames."""
        direction: Complex = motion.bodies[self.along].direction * self.direction
        return direction

    def gap(self, motion: MotionOfJoint) -> Real:
        guide, body = motion.bodies[self.along], motion.bodies[self.body]
        apart = body.point(self.point).position - guide.point(self.through).position
        return np.abs(cross(self.line(motion), apart))

    def columns(self, motion: MotionOfJoint) -> Iterator[Column]:
        slide, name = motion.slide(self.name), self.name
        velocity, acceleration = finite(slide.velocity), finite(slide.acceleration)
        # Scales for rounding: values that are tiny beside the whole motion of the body are written as 0.
        speed = np.abs(motion.bodies[self.body].origin.velocity)
        of_body = np.abs(motion.bodies[self.body].origin.acceleration)
        yield Column(f"{name}_displacement", "mm", f"displacement along the line of {name}", slide.displacement)
        yield Column(f"{name}_velocity", "mm/s", f"sliding velocity of {name}", velocity, speed)
        yield Column(f"{name}_acceleration", "mm/s2", f"sliding acceleration of {name}", acceleration, of_body)
        if _largest(slide.coriolis) > ROUNDING * max(_largest(of_body), _largest(acceleration)):
            meaning = f"Coriolis acceleration of {name}"
            yield from xy_columns(f"{name}_coriolis", "mm/s2", meaning, finite(slide.coriolis))

    def coefficients(self, motion: MotionOfJoint, order: str, unit: str) -> Iterator[Column]:
        words = f"{order} kinematic coefficient of {self.name}"
        scale = np.abs(getattr(motion.bodies[self.body].origin, order))
        values = finite(getattr(motion.slide(self.name), order))
        yield Column(f"{self.name}_displacement_{order}_coefficient", unit, words, values, scale)

    def marks(self, motion: MotionOfJoint) -> Iterator[SceneMark]:
        place = motion.bodies[self.body].point(self.point).position
        yield SceneMark("slide", place, "construction", self.name, direction=self.line(motion))

    def effects(self, equilibrium: EquilibriumOfJoint) -> Iterator[Effect]:
        """The normal force on `body`, and the moment about its point if the two bodies are aligned."""
        yield equilibrium.pressed(self, 1j)
        if self.is_aligned:
            yield equilibrium.turned(self.body, self.along, 1.0)

    def forces(self, analysis: ForcesOfJoint, wrenches: WrenchesOfJoint) -> Iterator[JointForce]:
        linkage, slide, guide = analysis.motion.linkage, analysis.slide(self.name), analysis.motion.bodies[self.along]
        at: Complex = wrenches.position(self.body, self.point)
        along: Real = np.zeros(())
        if self is linkage.driven_slider:
            along = analysis.driver * (-1 if linkage.driver == self.along else 1)
        force = self.line(analysis.motion) * (along + 1j * slide.normal)
        yield self.body, self.point, force, slide.moment
        yield self.along, (at - guide.origin.position) * np.conj(guide.direction), -force, -slide.moment

    def force_columns(self, analysis: ForcesOfJoint) -> Iterator[Column]:
        name, slide = self.name, analysis.slide(self.name)
        meaning = f"on {self.body}, along the left normal of {name}"
        yield Column(f"{name}_normal_force", "N", f"force of {self.along} {meaning}", slide.normal)
        if self.is_aligned:
            yield Column(f"{name}_moment", "N mm", f"moment of {self.along} on {self.body}", slide.moment)


def _largest(values: Real | Complex) -> float:
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


@record(checked=True, eq=False)
class Slider(AbstractSlide):
    """Sliding joint: `body` slides along a straight line of the body `along`, without turning relative to it.

    Parameters
    ----------
    name : str
        Name of the joint.
    body, along : str
        The sliding body, and the body that has the line.
    point : complex
        Point of `body` that stays on the line, mm in the frame of `body`.
    through : complex
        Point of the line, mm in the frame of `along`; the displacement is measured from it.
    direction_deg : float
        Direction of the line in the frame of `along`, deg.
    angle_deg : float
        Angle of the x axis of `body` from the line's direction, deg.

    See Also
    --------
    Linkage, PinInSlot
    """

    name: str
    body: str
    along: str
    point: ComplexOrArray = 0j
    through: ComplexOrArray = 0j
    direction_deg: float = 0.0
    angle_deg: float = 0.0

    noun = "slider"
    freedoms = 2

    @cached_property
    def rotation(self) -> Complex:
        """Direction of the x axis of `body` in the frame of `along`, unit complex."""
        return self.direction * direction_deg(self.angle_deg) if self.angle_deg else self.direction

    def in_other_frame(self, body: str, place: complex | Complex, displacement: float) -> Complex:
        """A point of one of the two bodies, in the frame of the other.

        Parameters
        ----------
        body : str
            The body that the point belongs to.
        place : complex or array
            The point, mm in the frame of `body`.
        displacement : float
            Displacement of the slider, mm.

        Returns
        -------
        complex or array
            mm, in the frame of the other body.
        """
        start = self.through + displacement * self.direction
        if body == self.body:
            return start + self.rotation * (place - self.point)
        return self.point + np.conj(self.rotation) * (place - start)

    @property
    def points(self) -> Mapping[str, tuple[str, ...]]:
        return {}

    @property
    def sizes(self) -> Mapping[str, complex | Array]:
        fields = "point", "through", "direction_deg", "angle_deg"
        return {field: getattr(self, field) for field in fields}

    @property
    def point_entry(self) -> tuple[str, str]:
        return self.name, "point"

    @property
    def program_sizes(self) -> tuple[str, ...]:
        return "point", "through", "direction", "rotation"

    def line_on(self, body: str) -> complex:
        return complex(self.direction if body == self.along else direction_deg(-self.angle_deg))

    def runs_in(self, linkage: LinkageOfJoint) -> tuple[str, complex, str] | None:
        """A block, which is a body with one pin on the line and nothing else, runs as that pin in the other body."""
        blocks = [body for body in self.bodies if self._is_block(linkage, body)]
        if not blocks:
            return None
        block = min(blocks, key=lambda body: len(linkage.bodies[body]))
        place = complex(next(iter(linkage.bodies[block].values())))
        return block, place, self.along if block == self.body else self.body

    def _is_block(self, linkage: LinkageOfJoint, body: str) -> bool:
        points, other = linkage.bodies[body], self.along if body == self.body else self.body
        # A body that is driven by its angle, or is half of an actuator, must be a plate.
        driven = body == linkage.driver or self is linkage.driven_slider
        if body == linkage.ground or (driven and other != linkage.ground):
            return False
        joined = {one for point in points for one in linkage.joint_points.get(point, ())} - {body}
        if not joined or sum(body in slide.bodies for slide in linkage.slides) > 1:
            return False
        # A body on a fixed shaft that only its slide moves is a hub, which must be a plate.
        if joined == {linkage.ground} and not any(point in linkage.joint_points for point in linkage.bodies[other]):
            return False
        first = complex(next(iter(points.values())))
        if not all(are_equal(first, complex(place)) for place in points.values()):
            return False
        start = complex(self.point if body == self.body else self.through)
        return bool(abs(cross(self.line_on(body), first - start)) <= EQUAL * (abs(first) + abs(start)))


def are_equal(one: complex, two: complex) -> bool:
    """Whether two places coincide, apart from rounding."""
    return bool(abs(one - two) <= EQUAL * max(abs(one), abs(two)))


@record(checked=True)
class PinInSlot(AbstractSlide):
    """A pin of `body` that runs in a straight slot of the body `along`, which is free to turn about the pin.

    Its force is normal to the slot. The displacement of the pin is measured from `through`, along the slot.

    Parameters
    ----------
    name : str
        Name of the joint.
    body, pin : str
        The body that has the pin, and the name of the point of that body at which it is.
    along : str
        The body that has the slot.
    through : complex
        Point of the slot's middle line, mm in the frame of `along`.
    direction_deg : float
        Direction of the slot in the frame of `along`, deg.

    See Also
    --------
    Linkage, Slider

    Examples
    --------
    >>> import geomkin as gk
    >>> quick_return = gk.Linkage(
    ...     bodies={"ground": {"O": 0, "C": 20j}, "crank": {"O": 0, "A": 50}, "lever": {"C": 0, "tip": 85}},
    ...     driver="crank",
    ...     slots=(gk.PinInSlot("slot", "crank", "A", "lever"),),
    ... )
    >>> motion = gk.move(quick_return, [0.0, 1.0], speed=2.0)
    >>> motion.lever.omega.round(4), motion.slide("slot").displacement.round(4)
    (array([1.7241, 2.7255]), array([53.8516, 34.8864]))
    """

    name: str = entry("its name", example="slot")
    body: str = entry("the body that has the pin", example="crank")
    pin: str = entry("the point of that body at which the pin is", example="A")
    along: str = entry("the body that has the slot", example="lever")
    through: ComplexOrArray = entry(
        "point of the slot's middle line, in the frame of the body with the slot", default=0j
    )
    direction_deg: float = quantity(
        "direction of the slot in that frame", "deg", default=0.0, at_least=-360, at_most=360
    )

    noun = "slot"
    freedoms = 1
    is_aligned = False

    def of(self, bodies: Mapping[str, Mapping[str, complex | Array]]) -> Self:
        """The same joint with the position of its pin."""
        return self.with_sizes({"point": bodies[self.body][self.pin]})

    @property
    def points(self) -> Mapping[str, tuple[str, ...]]:
        return {self.pin: (self.body,)}

    @property
    def sizes(self) -> Mapping[str, complex | Array]:
        return {"through": self.through, "direction_deg": self.direction_deg}

    @property
    def plays(self) -> tuple[Play, ...]:
        """The middle line of the slot moves across itself."""
        return ((self.name, "through", 1j * complex(self.direction)),)

    @property
    def point_entry(self) -> tuple[str, str]:
        return self.body, self.pin

    @property
    def program_sizes(self) -> tuple[str, ...]:
        return "through", "direction"

    def line_on(self, body: str) -> complex:
        return complex(self.direction)

    def runs_in(self, linkage: LinkageOfJoint) -> tuple[str, complex, str]:
        return self.body, complex(self.point), self.along

    def marks(self, motion: MotionOfJoint) -> Iterator[SceneMark]:
        """The pin, unless it also joins two bodies; the slot is cut in its plate."""
        if len(motion.linkage.joint_points[self.pin]) == 1:
            place = motion.bodies[self.body].point(self.point).position
            sort: Literal["pin", "fixed pin"] = "fixed pin" if self.body == motion.linkage.ground else "pin"
            yield SceneMark(sort, place, "construction", self.pin)
