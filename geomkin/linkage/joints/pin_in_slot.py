"""The pin in a slot: a pin of one body that runs in a straight slot of another, which may turn about it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal, Self

from ...core.fields import ComplexOrArray, entry, quantity
from ...core.records import record
from ...model.scene import SceneMark
from ...plane.vec import Array
from .joint import LinkageOfJoint, MotionOfJoint, Play
from .slide import AbstractSlide


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
