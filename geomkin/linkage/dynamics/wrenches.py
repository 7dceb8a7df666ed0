"""Forces and moments on the bodies of a moving linkage, and the friction of its pins and slides."""

from __future__ import annotations

from dataclasses import field

import numpy as np

from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST, entry, quantity
from ...core.records import record
from ...core.units import mm
from ...model.material import Mass
from ...plane.vec import Array, Complex, Real, Whole, cross, dot
from ..joints.joint import Effect
from ..joints.slide import AbstractSlide
from ..linkage import Linkage
from ..motion import Motion
from ..solve.solution import PointMotion

# kg mm/s2 in N.
NEWTON = 1e-3


def known_body(linkage: Linkage, body: str, field: str) -> str:
    """The name of a body; DesignError if the linkage has none of this name."""
    if body not in linkage.bodies:
        problem = f"found {shown(body)}, which is not the name of a body"
        raise DesignError(field, problem, f"give one of {', '.join(linkage.bodies)}", "unknown-key")
    return body


def known_place(linkage: Linkage, body: str, point: str | complex | Array, prefix: str) -> complex | Complex:
    """A point of a body, given by name or by its position, mm in the body's frame.

    prefix: of the fields body and point in an error.
    """
    points = linkage.bodies[known_body(linkage, body, f"{prefix}body")]
    if not isinstance(point, str):
        return point
    if point not in points:
        problem = f"found {shown(point)}, which is not a point of {body}"
        remedy = f"give one of {', '.join(points) or 'none'}, or a position in mm"
        raise DesignError(f"{prefix}point", problem, remedy, "unknown-key")
    return points[point]


@record(eq=False)
class Wrenches:
    """Sum of the forces on each body and their moment about the body's reference point.

    The reference point is the first one that the linkage names on the body, for the motion of named points is computed
    together with that of the bodies.

    Parameters
    ----------
    motion : Motion
        The motion during which the forces act.
    force : dict of str to array
        Body to force, N, complex.
    moment : dict of str to array
        Body to moment about its reference point, N mm.
    """

    motion: Motion
    force: dict[str, Complex] = field(init=False, default_factory=dict)
    moment: dict[str, Real] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        for body in self.motion.linkage.bodies:
            self.force[body], self.moment[body] = np.zeros((), dtype=complex), np.zeros(())

    def reference(self, body: str) -> PointMotion:
        """Motion of the body's reference point."""
        points = self.motion.linkage.bodies[body]
        return self.motion.point(next(iter(points))) if points else self.motion.bodies[body].origin

    def arm(self, body: str, place: complex | Complex) -> Complex:
        """From the reference point to a point of the body, mm on the ground."""
        start = next(iter(self.motion.linkage.bodies[body].values()), 0j)
        return self.motion.bodies[body].direction * (place - start)

    def position(self, body: str, place: complex | Complex) -> Complex:
        """Position of a point of the body, mm on the ground."""
        return self.reference(body).position + self.arm(body, place)

    def first(self, body: str, place: complex | Complex) -> Complex:
        """Derivative of that position by the drive."""
        with np.errstate(invalid="ignore"):
            return self.reference(body).first + 1j * self.motion.bodies[body].first * self.arm(body, place)

    def acceleration(self, body: str, place: complex | Complex) -> Complex:
        """Acceleration of a point of the body, mm/s2."""
        moving = self.motion.bodies[body]
        with np.errstate(invalid="ignore", over="ignore"):
            return self.reference(body).acceleration + (1j * moving.alpha - moving.omega**2) * self.arm(body, place)

    def add_force(self, body: str, place: complex | Complex, force: Array | complex) -> None:
        """Add a force, N on the ground, that acts at a point of the body."""
        self.force[body] = self.force[body] + force
        self.moment[body] = self.moment[body] + cross(self.arm(body, place), force)

    def add_moment(self, body: str, moment: Array | float, reaction_on: str = "") -> None:
        """Add a moment on the body, N mm, and the opposite one on another."""
        self.moment[body] = self.moment[body] + moment
        if reaction_on:
            self.moment[reaction_on] = self.moment[reaction_on] - moment

    def add_weight(self, body: str, mass: Mass, gravity: complex) -> None:
        """Add the weight of the body."""
        self.add_force(body, mass.centre, NEWTON * mass.mass * gravity)

    def add_inertia(self, body: str, mass: Mass) -> None:
        """Add the inertia force -m a at the centre of mass and the moment -J alpha (d'Alembert)."""
        self.add_force(body, mass.centre, -NEWTON * mass.mass * self.acceleration(body, mass.centre))
        self.add_moment(body, -NEWTON * mass.inertia * self.motion.bodies[body].alpha)

    @property
    def generalised(self) -> Real:
        """Virtual work of all forces per unit of the drive, N mm per rad or N, shape of the motion."""
        total = np.zeros(self.motion.assembled.shape)
        with np.errstate(invalid="ignore"):
            for name, body in self.motion.bodies.items():
                if name != self.motion.linkage.ground:
                    total = total + dot(self.force[name], self.reference(name).first) + self.moment[name] * body.first
        return total


@record(checked=True)
class PinFriction:
    """Dry and viscous friction of a pin: a couple against the relative rotation.

    If more than two bodies meet at the pin, the pin belongs to the first of them and the others turn on it.

    Parameters
    ----------
    pin : str
        Name of the pin.
    coefficient : float
        Coefficient of dry friction.
    radius : float
        Radius of the pin, mm.
    viscous : float
        Viscous couple per relative angular velocity, N mm s/rad.

    See Also
    --------
    Loads, SlideFriction

    Notes
    -----
    The dry couple is sin(atan(coefficient)) x radius x force: the force at the pin touches the friction circle.
    """

    pin: str = entry("name of the pin", example="crank_pin")
    coefficient: float = quantity("coefficient of dry friction", default=0.0, at_least=0, at_most=10, example=0.15)
    radius: float = quantity("radius of the pin", "mm", default=0.0, at_least=0, at_most=FARTHEST, example=3.0)
    viscous: float = quantity(
        "viscous couple per relative angular velocity", "N mm s/rad", default=0.0, at_least=0, at_most=FARTHEST
    )

    @property
    def arm(self) -> float:
        """Dry couple per force, mm."""
        return self.radius * self.coefficient / float(np.hypot(1, self.coefficient))

    def pairs(self, linkage: Linkage) -> list[tuple[str, str]]:
        """Each body that turns on the pin, with the body that has it."""
        if self.pin not in linkage.pins:
            problem, names = f"found {shown(self.pin)}, which is not a pin", ", ".join(linkage.pins)
            raise DesignError("friction.pin", problem, f"give one of {names}", "unknown-key")
        holder, *others = linkage.pins[self.pin]
        return [(body, holder) for body in others]

    def apply(self, wrenches: Wrenches) -> None:
        """Add the viscous couples to the forces on the bodies."""
        bodies = wrenches.motion.bodies
        for body, holder in self.pairs(wrenches.motion.linkage):
            if self.viscous:
                wrenches.add_moment(body, -self.viscous * (bodies[body].omega - bodies[holder].omega), holder)


@record(checked=True)
class SlideFriction:
    """Dry and viscous friction of a slide: a force against the sliding velocity.

    Parameters
    ----------
    slide : str
        Name of the slider.
    coefficient : float
        Coefficient of dry friction.
    length : float
        Length of the guided part, mm, half of it on each side of the slider's point; 0 if it takes no moment, as of
        a pin in a slot. The slip of such a pin is that of its centre.
    viscous : float
        Viscous force per sliding velocity, N s/mm.

    See Also
    --------
    Loads, PinFriction

    Notes
    -----
    The guide presses on both ends of the guided part, with forces that follow from the normal force N and the moment M
    about its middle. Their sizes add up to max(N, 2 M / length).
    """

    slide: str = entry("name of the slider", example="slide")
    coefficient: float = quantity("coefficient of dry friction", default=0.0, at_least=0, at_most=10, example=0.15)
    length: float = quantity("length of the guided part", "mm", default=0.0, at_least=0, at_most=FARTHEST, example=40.0)
    viscous: float = quantity("viscous force per sliding velocity", "N s/mm", default=0.0, at_least=0, at_most=FARTHEST)

    def slider(self, linkage: Linkage) -> AbstractSlide:
        """The slider with this name."""
        for slider in linkage.slides:
            if slider.name == self.slide:
                if self.length and not slider.is_aligned:
                    problem = f"found {mm(self.length):.4g}, but {self.slide} is a pin in a slot, which takes no moment"
                    raise DesignError("friction.length", problem, "omit it", "conflict")
                return slider
        problem = f"found {shown(self.slide)}, which is not the name of a slider"
        names = ", ".join(slider.name for slider in linkage.slides) or "none, for the linkage has no slider"
        raise DesignError("friction.slide", problem, f"give one of {names}", "unknown-key")

    def apply(self, wrenches: Wrenches) -> None:
        """Add the viscous force to the forces on the bodies."""
        slider, motion = self.slider(wrenches.motion.linkage), wrenches.motion
        if self.viscous:
            force = -self.viscous * motion.slide(slider.name).velocity
            line = slider.line(motion)
            wrenches.add_force(slider.body, slider.point, force * line)
            wrenches.add_force(slider.along, slider.through, -force * line)


@record(eq=False)
class DryFriction:
    """Dry friction of two bodies on each other, as it enters the equations of equilibrium.

    Parameters
    ----------
    column : int
        First of the two unknowns that it depends on: a pin's force, a slide's normal force and moment, or the force of
        teeth alone.
    effect : Effect
        Its effect per unit of the joint's load: against the relative motion, 0 at relative rest.
    moment_share : float, optional
        For a slide: size of the load per unit of the moment's unknown, 0 for teeth. None for a pin, whose load is the
        length of its force.
    """

    column: int
    effect: Effect
    moment_share: float | None = None

    def add_slopes(self, matrix: Real, unknowns: Real, frames: Whole) -> None:
        """Add the derivative of the effect by the two unknowns to the matrix, (frames, rows, columns).

        The joint's load is homogeneous in the unknowns: it is the product of this derivative with them.
        """
        columns = slice(self.column, self.column + 2)
        pair = unknowns[:, columns]
        if self.moment_share is None:
            length = np.hypot(*pair.T)
            slope = pair / np.where(length > 0, length, 1.0)[:, None]
        else:
            weights = np.array([1.0, self.moment_share])
            greater = np.argmax(np.abs(pair) * weights, axis=-1)
            slope = np.sign(pair) * weights * (np.arange(2) == greater[:, None])
        for row, values in self.effect:
            matrix[:, row, columns] += slope * (values[frames, None] if isinstance(values, np.ndarray) else values)
