"""Forces and moments on the bodies of a moving linkage, summed about one point of each body."""

from __future__ import annotations

from dataclasses import field

import numpy as np

from ...core.errors import DesignError, shown
from ...core.records import record
from ...model.material import Mass
from ...plane.vec import Array, Complex, Real, cross, dot
from ..body_motion import PointMotion
from ..linkage import Linkage
from ..motion import Motion

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
