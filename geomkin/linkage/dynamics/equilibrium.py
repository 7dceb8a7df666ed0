"""Equilibrium of all bodies as one linear system for each frame: joint forces and driver from the loads."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole, cross
from ..joints.joint import AbstractJoint, Effect
from ..joints.slide import AbstractSlide
from ..solve.continuation import solved
from .wrenches import DryFriction, PinFriction, SlideFriction, Wrenches

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
