"""Inverse dynamics: the driver's effort and the forces in all joints for a given motion."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np

from ...core.arguments import ArgumentType, PositiveFloat, checked, is_complex
from ...core.errors import DesignError, shown
from ...core.records import record
from ...model.motor import MotorDuty
from ...plane.vec import Complex, Mask, Real, cross
from ..motion import Motion
from .loads import Loads
from .wrenches import BLOCK, NEWTON, Equilibrium, Wrenches, known_place

# N mm/s in W.
WATT = 1e-3
# Ratio of a sum to its terms below which it is rounding noise; of works, which are integrals, the same.
ROUNDING, NO_WORK = 1e-13, 1e-9
AboutPoint = Annotated[
    Any,
    ArgumentType(
        lambda value: value is None or isinstance(value, str) or is_complex(value),
        "a point of the fixed body, or a position x + yj",
    ),
]


@record(eq=False)
class SlideForces:
    """Force and moment with which a guide presses on a sliding body; arrays have the shape of the motion.

    Parameters
    ----------
    normal : array
        N along the left normal of the line's direction.
    moment : array
        N mm about the slider's point.
    """

    normal: Real
    moment: Real


@record(eq=False)
class ForceAnalysis:
    """Forces of a motion, as returned by `forces`; arrays have the shape of the motion.

    They are nan where the linkage is open, at dead centres, where dry friction locks it, and for reactions that
    equilibrium does not determine.

    Parameters
    ----------
    motion : Motion
        The motion that the driver enforces.
    loads : Loads
        The loads.
    about : complex
        Point of the shaking moment, mm on the ground.
    """

    motion: Motion
    loads: Loads
    about: complex | Complex = 0j

    @cached_property
    def wrenches(self) -> Wrenches:
        """Forces and moments of all loads on the bodies, without joints, driver and dry friction."""
        return self.loads.wrenches(self.motion)

    @cached_property
    def _equilibrium(self) -> Equilibrium:
        dry = [friction for friction in self.loads.friction if friction.coefficient]
        return Equilibrium(self.wrenches, dry)

    @cached_property
    def driver(self) -> Real:
        """Torque on the driver, N mm, counterclockwise positive; if a slider drives, the force along its line, N.

        Without dry friction it follows from virtual work alone, so that no joint force is needed.
        """
        if not self._equilibrium.frictions:
            return np.where(np.isfinite(self.wrenches.generalised), -self.wrenches.generalised, np.nan)
        effort = self._unknown(-1)
        return effort * self._equilibrium.size if self.motion.linkage.driven_slider is None else effort

    def pin(self, name: str, on: str, frame: Literal["ground", "body"] = "ground") -> Complex:
        """Force at a pin: the sum of what the other bodies exert on a body there.

        Parameters
        ----------
        name : str
            Name of the pin.
        on : str
            The body that the force acts on.
        frame : {"ground", "body"}
            Frame of the components: the ground's or that body's.

        Returns
        -------
        array of complex
            N.

        Raises
        ------
        DesignError
            If the linkage has no such pin, or the body is not at it.
        """
        bodies = self.motion.linkage.pins.get(name)
        if bodies is None:
            problem, names = f"found {shown(name)}, which is not a pin", ", ".join(self.motion.linkage.pins)
            raise DesignError("name", problem, f"give one of {names}", "unknown-key")
        if on not in bodies:
            problem = f"found {shown(on)}, which is not at {name}"
            raise DesignError("on", problem, f"give one of {', '.join(bodies)}", "unknown-key")
        forces = {body: self._force(self._equilibrium.pins[name, body]) for body in bodies[1:]}
        force = forces[on] if on in forces else -np.sum(list(forces.values()), axis=0)
        return force * np.conj(self.motion.bodies[on].direction) if frame == "body" else force

    def slide(self, name: str) -> SlideForces:
        """Normal force and moment of a guide on the body that slides.

        Parameters
        ----------
        name : str
            Name of the slider.

        Returns
        -------
        SlideForces

        Raises
        ------
        DesignError
            If the linkage has no such slider.
        """
        column = self._equilibrium.slides.get(name)
        if column is None:
            problem, names = f"found {shown(name)}, which is not a slider", ", ".join(self._equilibrium.slides)
            raise DesignError("name", problem, f"give one of {names or 'none'}", "unknown-key")
        is_aligned = next(slide.is_aligned for slide in self.motion.linkage.slides if slide.name == name)
        normal = self._unknown(column)
        moment = self._equilibrium.size * self._unknown(column + 1) if is_aligned else 0 * normal
        return SlideForces(normal, moment)

    def mesh(self, name: str) -> Real:
        """Force of the teeth of a gear mesh on its second body, counterclockwise about the first, at the pitch point.

        Parameters
        ----------
        name : str
            Name of the mesh.

        Returns
        -------
        array
            N, along the pitch circles.

        Raises
        ------
        DesignError
            If the linkage has no such mesh.
        """
        mesh = next((mesh for mesh in self.motion.linkage.meshes if mesh.name == name), None)
        if mesh is None:
            names = ", ".join(mesh.name for mesh in self.motion.linkage.meshes)
            problem = f"found {shown(name)}, which is not a gear mesh"
            raise DesignError("name", problem, f"give one of {names or 'none'}", "unknown-key")
        return self._unknown(self._equilibrium.joints[mesh])

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Names of the joints of which equilibrium leaves a force open, since they hold the same direction."""
        is_open, joints = self._equilibrium.undetermined, self._equilibrium.joints.items()
        names = (joint.name for joint, first in joints if is_open[first : first + joint.removes].any())
        return tuple(dict.fromkeys(names))

    @cached_property
    def shaking_force(self) -> Complex:
        """Force of the moving masses on the frame, N: -sum m a. Weights and loads are not in it."""
        return self._shaking[0]

    @cached_property
    def shaking_moment(self) -> Real:
        """Moment of the moving masses on the frame about the point `about`, N mm: -sum (c x m a + J alpha)."""
        return self._shaking[1]

    @cached_property
    def _shaking(self) -> tuple[Complex, Real]:
        shape = self.motion.assembled.shape
        total, size, moment = np.zeros(shape, dtype=complex), np.zeros(shape), np.zeros(shape)
        for name, mass in self.loads.masses.items():
            if name != self.motion.linkage.ground:
                force = -NEWTON * mass.mass * self.wrenches.acceleration(name, mass.centre)
                arm = self.wrenches.position(name, mass.centre) - self.about
                couple = -NEWTON * mass.inertia * self.motion.bodies[name].alpha
                total, size, moment = total + force, size + np.abs(force), moment + cross(arm, force) + couple
        # If masses balance each other, their sum is rounding noise, which differs between processors.
        return np.where(np.abs(total) <= ROUNDING * size, 0, total), moment

    @cached_property
    def power(self) -> Real:
        """Power of the driver, W; negative where the loads drive it."""
        return WATT * self.driver * self.motion.timing.speed

    @cached_property
    def work(self) -> Real:
        """Work of the driver over all frames, N mm: over a whole turn, the energy that it supplies, by trapezoids."""
        return np.asarray(np.trapezoid(self.driver, self.motion.drive, axis=0))

    @property
    def duty(self) -> MotorDuty:
        """Torque and speed of the driver, which a motor on its shaft must supply.

        Raises
        ------
        DesignError
            If a slide drives, the driver turns about no fixed pivot, or there are many linkages at once.
        """
        linkage, motion = self.motion.linkage, self.motion
        if linkage.driver_pivot is None:
            raise DesignError(
                "motion", "its driver turns on no fixed shaft", "let a body on a fixed pivot drive", "conflict"
            )
        if linkage.is_batch:
            raise DesignError("motion", "found many linkages at once", "give one", "wrong-type")
        speed = np.broadcast_to(np.asarray(motion.timing.speed, dtype=float), motion.drive.shape)
        return MotorDuty(self.driver, speed, motion.drive)

    @checked
    def flywheel(self, fluctuation: PositiveFloat) -> float:
        """Inertia of a flywheel on the driver's shaft that limits the fluctuation of its speed under a constant torque.

        Parameters
        ----------
        fluctuation : float
            Difference of the largest and the least speed over their mean, above 0, such as 0.02.

        Returns
        -------
        float
            kg mm2, in addition to the masses of the analysis; nan if the torque is unknown at a frame.

        Raises
        ------
        DesignError
            If the motion is not a whole turn at a constant speed, or as for `duty`.

        Notes
        -----
        The excess of energy over a turn is taken from the torque at constant speed (Norton, Design of Machinery, on
        flywheels), which is exact for loads that do not depend on speed if the flywheel's inertia is much larger than
        that of the linkage.
        """
        duty, speed = self.duty, self.motion.timing.speed
        if speed.ndim or not speed or not self.motion.timing.steady or abs(duty.angle_deg - 360) > 1e-6:
            raise DesignError("motion", "found no whole turn at a constant speed", "give one", "conflict")
        drive = duty.angle
        excess = self.driver - self.work / (drive[-1] - drive[0])
        energy = np.cumsum(np.diff(drive) * (excess[1:] + excess[:-1]) / 2)
        return float(np.ptp(np.append(energy, 0.0)) / NEWTON / (fluctuation * speed**2))

    @cached_property
    def friction_power(self) -> Real:
        """Power that dry and viscous friction dissipate, W."""
        without = ForceAnalysis(self.motion, self.loads.without_friction)
        return self.power - without.power

    @cached_property
    def efficiency(self) -> Real:
        """Mechanical efficiency over all frames: work taken out over work put in, whichever of driver and loads drives.

        The work of the loads is what the driver would supply or take without friction, with the opposite sign. nan if
        both put work in, as where friction nearly locks, or if loads take as much as they give, as weights over a turn.
        """
        without = ForceAnalysis(self.motion, self.loads.without_friction)
        sense, drive = np.sign(self.motion.timing.speed), self.motion.drive
        passed = np.append(0.0, np.cumsum(np.abs(np.diff(drive))))
        driver, loads, exchanged = (
            np.trapezoid(effort, passed, axis=0)
            for effort in (self.driver * sense, -without.driver * sense, np.abs(without.driver))
        )
        put_in, taken = np.maximum(driver, loads), -np.minimum(driver, loads)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(taken > NO_WORK * exchanged, taken / put_in, np.nan)

    @property
    def self_locking(self) -> Mask:
        """Where loads that drive the linkage cannot overcome its friction, so that it stays at rest by itself.

        There the driver must supply power although, without friction, it would have to brake; or no force of the driver
        moves the linkage at all, and its forces are nan.
        """
        without = ForceAnalysis(self.motion, self.loads.without_friction)
        with np.errstate(invalid="ignore"):
            locked: Mask = (without.power < 0) & ~(self.power < 0)
        return locked | self.jammed

    @property
    def jammed(self) -> Mask:
        """Where no force of the driver moves the linkage against its dry friction; all forces are nan there."""
        return np.isfinite(self.wrenches.generalised) & np.isnan(self.driver)

    @cached_property
    def condition(self) -> Real:
        """Condition number of the equations, lengths relative to the linkage's size: joint forces lose so many digits.

        It grows without limit towards a dead centre. inf if a reaction is undetermined, nan where the linkage is open.
        """
        equilibrium = self._equilibrium
        condition = np.full(self.motion.assembled.size, np.nan)
        for frame in np.array_split(equilibrium.solvable, 1 + len(equilibrium.solvable) // BLOCK):
            condition[frame] = np.linalg.cond(equilibrium.matrix(frame))
        return condition.reshape(self.motion.assembled.shape)

    def _unknown(self, column: int) -> Real:
        return self._equilibrium.unknowns[:, column].reshape(self.motion.assembled.shape)

    def _force(self, column: int) -> Complex:
        return self._unknown(column) + 1j * self._unknown(column + 1)


@checked
def forces(motion: Motion, loads: Loads, about: AboutPoint = None) -> ForceAnalysis:
    """Driver effort, joint forces and shaking forces of a linkage in a given motion.

    Parameters
    ----------
    motion : Motion
        The motion with its speed and acceleration; with speed 0 the result is that of statics.
    loads : Loads
        Masses, gravity, forces, springs, friction.
    about : str or complex, optional
        Point of the shaking moment: a point of the fixed body, or a position, mm. By default the driver's pivot, or the
        fixed body's origin if it has none.

    Returns
    -------
    ForceAnalysis
        Each quantity is computed on first use.

    Raises
    ------
    DesignError
        If a load names a body, point or joint that the linkage does not have, or has another number of frames.

    See Also
    --------
    Loads, forward_dynamics, balance, masses, move

    Notes
    -----
    Newton's and Euler's equations of all bodies are solved as one linear system for each frame; the driver's effort
    follows from virtual power (Uicker, Pennock, Shigley, Theory of Machines and Mechanisms, chapters on static and
    dynamic force analysis).

    Examples
    --------
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), [1.0], speed=10.0)
    >>> loads = gk.Loads(gravity=-9810j, masses={"coupler": gk.Mass(0.5, centre=45, inertia=350)})
    >>> result = gk.forces(motion, loads)
    >>> result.driver.round(3)
    array([53.369])
    >>> result.pin("crank_pin", on="coupler").round(3)
    array([-1.02+1.704j])
    """
    linkage = motion.linkage
    about = linkage.driver_pivot if about is None else about
    if about is None or isinstance(about, str):
        place = known_place(linkage, linkage.ground, about or 0j, "about.")
        about = linkage.origin + linkage.ground_direction * place
    result = ForceAnalysis(motion, loads, about)
    result.wrenches  # noqa: B018  so that errors of the loads are raised here
    return result
