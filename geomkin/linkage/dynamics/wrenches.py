"""Forces and moments on the bodies of a moving linkage, friction of pins and slides, equilibrium of all bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from functools import cached_property

import numpy as np

from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST, entry, quantity
from ...core.records import record
from ...core.units import mm
from ...model.material import Mass
from ...plane.vec import Array, Complex, Mask, Real, Whole, cross, dot
from ..joints.joint import AbstractJoint, Effect
from ..joints.slide import AbstractSlide
from ..linkage import Linkage
from ..motion import Motion
from ..solve.continuation import solved
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


# Frames times linkages that are solved at once: their matrices stay in the processor's cache.
BLOCK = 512
# Ratio of the largest unknown to the largest load from which a position counts as a dead centre, and relative size of
# a singular value below which it counts as zero.
DEAD, SINGULAR = 1e12, 1e-11
# Share of an unknown in a self-stress of length 1 below which it counts as rounding.
SELF_STRESS = 1e-8
# Relative velocity, as a share of the velocities that it is the difference of, that counts as rest.
REST = 1e-12
# Relative error of the equilibrium from which no forces of the joints balance the loads.
UNBALANCED = 1e-6
# Largest number of Newton's steps for dry friction, and relative change at which they end. Three are usual.
STEPS, CONVERGED = 40, 1e-13


@record(eq=False)
class Equilibrium:
    """The equations of equilibrium of a linkage's moving bodies.

    Each body gives three rows: the two components of force, and the moment about its reference point. Each pin gives
    two unknowns for every body but its first, the force on that body; each slide the normal force on the sliding body
    and, if it keeps the bodies aligned, the moment about its point; the last unknown is the driver's torque or force.
    Moments are divided by the size of the linkage, so that they compare with forces.

    Parameters
    ----------
    wrenches : Wrenches
        The loads on the bodies.
    frictions : sequence of PinFriction or SlideFriction
        Dry friction, which depends on the unknowns.
    """

    wrenches: Wrenches
    frictions: Sequence[PinFriction | SlideFriction] = ()

    @cached_property
    def size(self) -> float:
        """The largest distance named by the linkage, mm."""
        return float(self.wrenches.motion.linkage.size.max()) or 1.0

    @cached_property
    def rows(self) -> dict[str, int]:
        """First row of each moving body."""
        linkage = self.wrenches.motion.linkage
        return {body: 3 * k for k, body in enumerate(body for body in linkage.bodies if body != linkage.ground)}

    @cached_property
    def pins(self) -> dict[tuple[str, str], int]:
        """First column of the force at a pin on each body but the pin's first."""
        pairs = [(pin, body) for pin, bodies in self.wrenches.motion.linkage.pins.items() for body in bodies[1:]]
        return {pair: 2 * k for k, pair in enumerate(pairs)}

    @cached_property
    def joints(self) -> dict[AbstractJoint, int]:
        """First column of each joint."""
        joints = self.wrenches.motion.linkage.joints
        return dict(zip(joints, np.cumsum([0, *(joint.removes for joint in joints)]).tolist()))

    @cached_property
    def slides(self) -> dict[str, int]:
        """First column of each slide: normal force, then moment / size if it takes one."""
        return {slide.name: self.joints[slide] for slide in self.wrenches.motion.linkage.slides}

    @property
    def columns(self) -> int:
        """Number of unknowns; the last one is the driver's."""
        return sum(joint.removes for joint in self.joints) + 1

    def matrix(self, frames: slice | Whole) -> Real:
        """Coefficients of the unknowns at some frames, (frames x linkages, rows, columns)."""
        count = len(self.loads[frames])
        matrix = np.zeros((count, 3 * len(self.rows), self.columns))
        for column, effect in self._effects:
            for row, values in effect:
                matrix[:, row, column] += values[frames] if isinstance(values, np.ndarray) else values
        return matrix

    @cached_property
    def _effects(self) -> list[tuple[int, Effect]]:
        """Each unknown's column, and its effect on the equations."""
        linkage, effects = self.wrenches.motion.linkage, list[tuple[int, Effect]]()
        for joint, column in self.joints.items():
            effects += enumerate(joint.effects(self), column)
        if linkage.driven_slider is None:
            effects.append((self.columns - 1, self.turned(linkage.driver, linkage.ground, 1.0)))
        else:
            sense = -1 if linkage.driver == linkage.driven_slider.along else 1
            effects.append((self.columns - 1, self.pressed(linkage.driven_slider, sense)))
        return effects

    def force(self, body: str, arm: Complex, force: Complex | complex) -> Effect:
        """Effect of a force at the end of an arm of a body."""
        if body not in self.rows:
            return []
        acting = np.asarray(force)
        row, components = self.rows[body], (acting.real, acting.imag, cross(arm, force) / self.size)
        return [(row + k, self._flat(values)) for k, values in enumerate(components) if np.any(values)]

    def pressed(self, slider: AbstractSlide, force: complex | Real) -> Effect:
        """Effect of a force at the slider's point, relative to its line, on the sliding body and its guide."""
        wrenches, line = self.wrenches, slider.line(self.wrenches.motion)
        guide_arm = wrenches.position(slider.body, slider.point) - wrenches.reference(slider.along).position
        arm = wrenches.arm(slider.body, slider.point)
        return [*self.force(slider.body, arm, force * line), *self.force(slider.along, guide_arm, -force * line)]

    def turned(self, body: str, other: str, moment: Real | float) -> Effect:
        """Effect of a moment, in units of size, on a body and of the opposite one on another."""
        ends = ((body, moment), (other, -moment))
        return [(self.rows[end] + 2, self._flat(values)) for end, values in ends if end in self.rows]

    def _flat(self, values: Real | float) -> Real | float:
        shape = self.wrenches.motion.assembled.shape
        return np.broadcast_to(values, shape).reshape(-1) if np.ndim(values) else float(values)

    @cached_property
    def loads(self) -> Real:
        """Right-hand side, (frames x linkages, rows): the loads on the bodies, reversed."""
        shape, wrenches = self.wrenches.motion.assembled.shape, self.wrenches
        loads = np.empty((*shape, 3 * len(self.rows)))
        for body, row in self.rows.items():
            loads[..., row] = -wrenches.force[body].real
            loads[..., row + 1] = -wrenches.force[body].imag
            loads[..., row + 2] = -wrenches.moment[body] / self.size
        return loads.reshape(-1, loads.shape[-1])

    @cached_property
    def dry_friction(self) -> list[DryFriction]:
        """Dry friction of each pair of bodies that rub, whose relative motions are known, and what parts gears."""
        motion = self.wrenches.motion
        terms = [DryFriction(self.joints[mesh], mesh.separating(self), 0.0) for mesh in motion.linkage.meshes]
        turning: Real = np.max([np.abs(body.first) for body in motion.bodies.values()], axis=0)
        for friction in self.frictions:
            if isinstance(friction, PinFriction):
                for body, holder in friction.pairs(motion.linkage):
                    sense = self._sense(motion.bodies[body].first - motion.bodies[holder].first, turning)
                    effect = self.turned(body, holder, -friction.arm / self.size * sense)
                    terms.append(DryFriction(self.pins[friction.pin, body], effect))
            else:
                slider = friction.slider(motion.linkage)
                speed = np.abs(self.wrenches.first(slider.body, slider.point))
                sense = self._sense(motion.slide(slider.name).first, speed)
                effect = self.pressed(slider, -friction.coefficient * sense)
                share = 2 * self.size / friction.length if friction.length else 0.0
                terms.append(DryFriction(self.slides[slider.name], effect, share))
        return terms

    def _sense(self, rate: Real, scale: Real) -> Real:
        """Sign of a relative motion; 0 at relative rest, apart from rounding, where friction is undetermined."""
        with np.errstate(invalid="ignore"):
            sense: Real = np.where(np.abs(rate) > REST * scale, np.sign(rate), 0.0)
        return sense * np.sign(self.wrenches.motion.timing.speed)

    @cached_property
    def solvable(self) -> Whole:
        """Indices of the frames x linkages at which the linkage is assembled and all loads are finite."""
        return np.flatnonzero(self.wrenches.motion.assembled.reshape(-1) & np.isfinite(self.loads).all(axis=-1))

    @cached_property
    def unknowns(self) -> Real:
        """All unknowns, (frames x linkages, columns): N, and N mm / size.

        nan if they are undetermined, at dead centres, and where dry friction locks the linkage.
        """
        unknowns = np.full((len(self.loads), self.columns), np.nan)
        starts = range(0, len(self.solvable), BLOCK)
        for frames in (self.solvable[start : start + BLOCK] for start in starts):
            unknowns[frames] = self._solved(frames)
        if np.isnan(unknowns[self.solvable]).any() and self.undetermined.any():
            # No frame has a unique solution: the one without self-stress has the determined unknowns.
            for frames in (self.solvable[start : start + BLOCK] for start in starts):
                matrix, loads = self.matrix(frames), self.loads[frames, :, None]
                least = np.linalg.pinv(matrix, rcond=SINGULAR) @ loads
                missed = np.abs(matrix @ least - loads).max(axis=(1, 2))
                least[missed > UNBALANCED * np.abs(loads).max(axis=(1, 2))] = np.nan
                unknowns[frames] = np.where(self.undetermined, np.nan, least[..., 0])
        return unknowns

    def _solved(self, frames: Whole) -> Real:
        """The unknowns at some frames; nan if the equations have no unique solution."""
        matrix, loads = self.matrix(frames), self.loads[frames]
        unknowns = unique_solutions(matrix, loads)
        if not self.dry_friction:
            return unknowns
        active = np.arange(len(frames))
        for step in range(STEPS):
            # The friction is homogeneous in the forces, so that Newton's step solves for the forces themselves.
            slopes = matrix[active]
            for friction in self.dry_friction:
                friction.add_slopes(slopes, unknowns[active], frames[active])
            latest = unique_solutions(slopes, loads[active])
            # Where the friction of a slide changes between its two forms, whole steps could alternate.
            latest = latest if step < STEPS // 2 else 0.5 * (latest + unknowns[active])
            change = np.abs(latest - unknowns[active]).max(axis=-1)
            unknowns[active] = latest
            active = active[change > CONVERGED * np.abs(latest).max(axis=-1)]
            if not active.size:
                break
        unknowns[active] = np.nan
        return unknowns

    @cached_property
    def undetermined(self) -> Mask:
        """Which unknowns the equations leave open at every frame, (columns,).

        They are the components of self-stresses: sets of joint forces in equilibrium without any load.
        """
        if not self.solvable.size:
            return np.zeros(self.columns, dtype=bool)
        # A few frames suffice, of which one may be a dead centre.
        values, vectors = np.linalg.svd(self.matrix(self.solvable[:: max(1, len(self.solvable) // 8)]))[1:]
        rank = (values > SINGULAR * values[:, :1]).sum(axis=-1)
        stresses = vectors[int(np.argmax(rank)), rank.max() :]
        open_columns: Mask = np.abs(stresses).max(axis=0, initial=0.0) > SELF_STRESS
        return open_columns


def unique_solutions(matrix: Real, loads: Real) -> Real:
    """Solutions of the equations, (frames, columns); nan if there is no unique one, apart from rounding."""
    if matrix.shape[-2] != matrix.shape[-1]:
        return np.full((len(matrix), matrix.shape[-1]), np.nan)
    solutions = solved(matrix, loads)
    solutions[np.abs(solutions).max(axis=-1) > DEAD * np.abs(loads).max(axis=-1)] = np.nan
    return solutions
