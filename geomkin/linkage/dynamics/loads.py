"""Loads on a linkage: masses, gravity, forces, torques and springs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Annotated, Any, Literal

import numpy as np

from ...core.arguments import ArgumentType, are_points, are_reals, is_complex
from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST, PlaceOnBody, entry, quantity
from ...core.records import record
from ...core.units import mm
from ...model.material import Mass
from ...plane.vec import Array, Real, unit
from ..motion import Motion
from .wrenches import PinFriction, SlideFriction, Wrenches, known_body, known_place


@record(checked=True, eq=False)
class DriveTable:
    """A load given at some positions of the driver, linear between them.

    Parameters
    ----------
    drive : array, shape (rows,)
        Driver positions, rad or mm; they do not fall. Two equal ones make a step.
    values : array, shape (rows,)
        The load there: N, complex or real, or N mm.
    period : float
        Drive after which the load repeats, usually 2 pi; 0 if it does not: then the first and last value hold beyond
        the table.

    See Also
    --------
    Force, Torque, SlideForce
    """

    drive: Annotated[Any, ArgumentType(are_reals, "finite real numbers")]
    values: Annotated[Any, ArgumentType(are_points, "finite numbers")]
    period: float = quantity("drive after which it repeats, rad", default=0.0, at_least=0)

    def __post_init__(self) -> None:
        drive = np.asarray(self.drive, dtype=float)
        if drive.ndim != 1 or drive.shape != np.shape(self.values) or not len(drive):
            raise DesignError("drive", f"found {np.shape(self.drive)} numbers", "give as many values, at least one")
        if np.any(np.diff(drive) < 0):
            raise DesignError("drive", "falls", "give rising numbers", "conflict")
        if self.period and drive[-1] - drive[0] > self.period * (1 + 1e-9):
            raise DesignError("drive", "covers more than its period", f"give {self.period:g} at most", "conflict")

    def at(self, drive: Real) -> Array:
        """The load at some driver positions."""
        places, values = np.asarray(self.drive, dtype=float), np.asarray(self.values)
        if self.period:
            drive = places[0] + (drive - places[0]) % self.period
            places, values = np.append(places, places[0] + self.period), np.append(values, values[0])
        load: Array = np.interp(drive, places, values)
        return load


def _is_load(value: Any) -> bool:
    return isinstance(value, DriveTable) or is_complex(value) or (isinstance(value, np.ndarray) and are_points(value))


Varying = Annotated[Any, ArgumentType(_is_load, "a finite number, an array of one for each frame, or a DriveTable")]


def _over_frames(motion: Motion, load: Any, field: str) -> Array:
    """A load at every frame of a motion, in a shape that multiplies its arrays."""
    values = np.asarray(load.at(motion.drive) if isinstance(load, DriveTable) else load)
    frames, shape = len(motion.drive), motion.assembled.shape
    if values.shape in ((), shape):
        return values
    if values.shape == (frames,):
        return values.reshape(-1, *(1,) * (len(shape) - 1))
    problem = f"found an array of shape {values.shape}, but the motion has the shape {shape}"
    raise DesignError(field, problem, f"give a number or an array of shape {(frames,)}", "conflict")


# Share of the linkage's size up to which a length counts as rounding: the ends are then joined by a pin.
NO_LENGTH = 1e-9


class AbstractLoad(ABC):
    """Base class of loads that act on bodies."""

    @abstractmethod
    def apply(self, wrenches: Wrenches) -> None:
        """Add the load to the forces on the bodies."""


@record(checked=True, eq=False)
class Force(AbstractLoad):
    """A force at a point of a body.

    Parameters
    ----------
    body : str
        The body that it acts on.
    point : str or complex
        Where it acts: a point that the linkage names on this body, or its position, mm in the body's frame.
    force : complex, array of shape (frames,), or DriveTable
        N.
    frame : {"ground", "body"}
        Whether its direction is fixed on the ground or turns with the body.

    See Also
    --------
    Loads, Torque, SlideForce, DriveTable
    """

    body: str
    point: PlaceOnBody = 0j
    force: Varying = 0j
    frame: Literal["ground", "body"] = "ground"

    def apply(self, wrenches: Wrenches) -> None:
        motion = wrenches.motion
        place = known_place(motion.linkage, self.body, self.point, "forces.")
        force = _over_frames(motion, self.force, "forces.force")
        wrenches.add_force(
            self.body, place, force * motion.bodies[self.body].direction if self.frame == "body" else force
        )


@record(checked=True, eq=False)
class Torque(AbstractLoad):
    """A torque on a body.

    Parameters
    ----------
    body : str
        The body that it acts on.
    torque : float, array of shape (frames,), or DriveTable
        N mm, counterclockwise positive.
    reaction_on : str
        The body that takes the opposite torque; "" for the ground.

    See Also
    --------
    Loads, Force, DriveTable
    """

    body: str
    torque: Varying = 0.0
    reaction_on: str = ""

    def apply(self, wrenches: Wrenches) -> None:
        linkage = wrenches.motion.linkage
        torque = _over_frames(wrenches.motion, self.torque, "torques.torque")
        if np.iscomplexobj(torque):
            raise DesignError("torques.torque", "found complex numbers", "give real ones, N mm", "wrong-type")
        other = self.reaction_on or linkage.ground
        known_body(linkage, other, "torques.reaction_on")
        wrenches.add_moment(known_body(linkage, self.body, "torques.body"), torque, other)


@record(checked=True, eq=False)
class SlideForce(AbstractLoad):
    """A force along a slider's line, such as that of a cylinder: on the sliding body, and the opposite on its guide.

    Parameters
    ----------
    slide : str
        Name of the slider.
    force : float, array of shape (frames,), or DriveTable
        N, positive along the line's direction.

    See Also
    --------
    Loads, Force, DriveTable
    """

    slide: str
    force: Varying = 0.0

    def apply(self, wrenches: Wrenches) -> None:
        linkage = wrenches.motion.linkage
        slider = next((s for s in linkage.slides if s.name == self.slide), None)
        if slider is None:
            problem = f"found {shown(self.slide)}, which is not the name of a slider"
            names = ", ".join(s.name for s in linkage.slides) or "none, for the linkage has no slider"
            raise DesignError("slide_forces.slide", problem, f"give one of {names}", "unknown-key")
        force = _over_frames(wrenches.motion, self.force, "slide_forces.force")
        line = slider.line(wrenches.motion)
        wrenches.add_force(slider.body, slider.point, force * line)
        # Both act along the same line.
        wrenches.add_force(slider.along, slider.through, -force * line)


@record(checked=True)
class _TwoPoints(AbstractLoad):
    """Base class of loads along the line between two points.

    Parameters
    ----------
    body, point : str, and str or complex
        One end: a body and its point, by name or by position, mm in the body's frame.
    to_body, to_point : str, and str or complex
        The other end.
    """

    body: str = entry("body at one end", example="rocker")
    point: PlaceOnBody = entry("point of that body, by name or [x, y]", example="rocker_pin")
    to_body: str = entry("body at the other end", example="ground")
    to_point: PlaceOnBody = entry("point of that body, by name or [x, y]", example=0j)

    @abstractmethod
    def tension(self, length: Real) -> Real:
        """Force that pulls the ends together, N, at a length, mm."""

    def length(self, motion: Motion) -> Real:
        """Distance of the two points at the frames of a motion, mm; both are points of their bodies."""
        wrenches = Wrenches(motion)
        one, two = (
            wrenches.position(body, known_place(motion.linkage, body, point, "springs."))
            for body, point in ((self.body, self.point), (self.to_body, self.to_point))
        )
        return np.asarray(np.abs(two - one))

    def apply(self, wrenches: Wrenches) -> None:
        linkage, one, two = wrenches.motion.linkage, self.body, self.to_body
        here = known_place(linkage, one, self.point, "springs.")
        there = known_place(linkage, two, self.to_point, "springs.to_")
        if one == two:
            raise DesignError("springs.to_body", f"both ends are on {one}", "give another body", "conflict")
        apart = wrenches.position(two, there) - wrenches.position(one, here)
        length = np.abs(apart)
        if np.any(length <= NO_LENGTH * linkage.size):
            raise DesignError(
                "springs", f"the spring from {one} to {two} has no length at a frame, so no direction", "move an end"
            )
        pull = self.tension(length) * unit(apart)
        wrenches.add_force(one, here, pull)
        wrenches.add_force(two, there, -pull)


@record(checked=True)
class Spring(_TwoPoints):
    """A linear spring between two points of bodies.

    Parameters
    ----------
    body, point : str, and str or complex
        One end: a body and its point, by name or by position, mm in the body's frame.
    to_body, to_point : str, and str or complex
        The other end.
    stiffness : float
        N/mm; 0 for a constant force.
    free_length : float
        Length at which only the preload acts, mm.
    preload : float
        Tension at the free length, N; negative if the spring pushes.

    See Also
    --------
    Loads, GasSpring, TorsionSpring
    """

    stiffness: float = quantity("stiffness", "N/mm", default=0.0, at_least=0, at_most=FARTHEST, example=2.0)
    free_length: float = quantity("length without load", "mm", default=0.0, at_least=0, at_most=FARTHEST, example=40.0)
    preload: float = quantity(
        "tension at the free length, negative if it pushes", "N", default=0.0, at_least=-FARTHEST, at_most=FARTHEST
    )

    def tension(self, length: Real) -> Real:
        return self.stiffness * (length - self.free_length) + self.preload


@record(checked=True)
class GasSpring(_TwoPoints):
    """A gas spring between two points of bodies: it pushes, and the more the shorter it is.

    Parameters
    ----------
    body, point, to_body, to_point
        As for `Spring`.
    force : float
        Push when fully extended, N.
    extended : float
        Length when fully extended, mm; beyond it the spring pushes no more.
    gas_length : float
        Length of the gas column, mm: the push is force / (1 - x / gas_length) after a compression by x.
    stroke : float, optional
        By which its rod goes in, mm; for a check of recipes.

    See Also
    --------
    Loads, Spring
    """

    force: float = quantity("push when fully extended", "N", default=0.0, at_least=0, at_most=FARTHEST, example=100)
    extended: float = quantity("length when extended", "mm", default=0.0, at_least=0, at_most=FARTHEST, example=200)
    gas_length: float = quantity(
        "length of the gas column: the push is force / (1 - compression / gas_length)", "mm", default=FARTHEST,
        above=0, at_most=FARTHEST, example=300,
    )  # fmt: skip
    stroke: float | None = quantity(
        "by which its rod goes in; a check then compares its lengths in motion", "mm", default=None, above=0,
        at_most=FARTHEST,
    )  # fmt: skip

    def tension(self, length: Real) -> Real:
        compression = self.extended - length
        if np.any(compression >= self.gas_length):
            problem = f"the gas spring is compressed by {mm(np.fmax.reduce(compression, axis=None)):.5g}"
            raise DesignError("springs.gas_length", problem, "give a longer gas column, or a shorter spring")
        return np.where(compression >= 0, -self.force / (1 - compression / self.gas_length), 0.0)


@record(checked=True)
class TorsionSpring(AbstractLoad):
    """A torsion spring between two bodies.

    Parameters
    ----------
    body, to_body : str
        The bodies that it turns apart.
    stiffness : float
        N mm/rad.
    free_angle_deg : float
        Angle of `body` from `to_body` at which only the preload acts, deg. The twist is within 180 deg of it at the
        first frame and continues from there.
    preload : float
        Torque on `body` at the free angle, N mm.

    See Also
    --------
    Loads, Spring
    """

    body: str = entry("body at one end", example="rocker")
    to_body: str = entry("body at the other end", example="ground")
    stiffness: float = quantity("stiffness", "N mm/rad", default=0.0, at_least=0, at_most=FARTHEST, example=500)
    free_angle_deg: float = quantity(
        "angle of the first body from the second without load", "deg", default=0.0, at_least=-360, at_most=360
    )
    preload: float = quantity(
        "torque on the first body at the free angle", "N mm", default=0.0, at_least=-FARTHEST, at_most=FARTHEST
    )

    def apply(self, wrenches: Wrenches) -> None:
        motion = wrenches.motion
        one, two = (known_body(motion.linkage, getattr(self, key), f"springs.{key}") for key in ("body", "to_body"))
        if one == two:
            raise DesignError("springs.to_body", f"both ends are on {one}", "give another body", "conflict")
        free = np.exp(1j * np.radians(self.free_angle_deg))
        twist = np.angle(motion.bodies[one].direction * np.conj(motion.bodies[two].direction * free))
        known = np.isfinite(twist)
        twist = np.where(known, np.unwrap(np.where(known, twist, 0.0), axis=0), np.nan)
        wrenches.add_moment(one, self.preload - self.stiffness * twist, two)


def _rows(kind: Any) -> Any:
    words = f"a sequence of {' or '.join(each.__name__ for each in (kind if isinstance(kind, tuple) else (kind,)))}"
    return ArgumentType(
        lambda value: isinstance(value, Sequence) and all(isinstance(each, kind) for each in value), words
    )


Springs = (Spring, GasSpring, TorsionSpring)


@record(checked=True, eq=False)
class Loads:
    """Everything that acts on a linkage besides its driver.

    Parameters
    ----------
    gravity : complex
        Acceleration of a falling body, mm/s2, on the ground: -9810j if it falls along -y; 0 if it is not considered.
    masses : mapping of str to Mass
        Body to its mass; others have none.
    forces : sequence of Force
    torques : sequence of Torque
    slide_forces : sequence of SlideForce
        Forces along slides, such as those of cylinders.
    springs : sequence of Spring, GasSpring or TorsionSpring
    friction : sequence of PinFriction or SlideFriction
        Friction of joints.

    See Also
    --------
    forces, Force, Torque, SlideForce, Spring, GasSpring, TorsionSpring, PinFriction, SlideFriction, Mass

    Examples
    --------
    >>> import geomkin as gk
    >>> loads = gk.Loads(gravity=-9810j, masses={"crank": gk.Mass(0.2, centre=20, inertia=100)})
    """

    gravity: complex = 0j
    masses: Mapping[str, Mass] = field(default_factory=dict)
    forces: Annotated[Sequence[Force], _rows(Force)] = ()
    torques: Annotated[Sequence[Torque], _rows(Torque)] = ()
    slide_forces: Annotated[Sequence[SlideForce], _rows(SlideForce)] = ()
    springs: Annotated[Sequence[AbstractLoad], _rows(Springs)] = ()
    friction: Annotated[Sequence[PinFriction | SlideFriction], _rows((PinFriction, SlideFriction))] = ()

    @property
    def without_friction(self) -> Loads:
        """The same loads without friction."""
        return replace(self, friction=())

    def wrenches(self, motion: Motion) -> Wrenches:
        """The forces of all loads on the bodies, without joints, driver and dry friction."""
        total = Wrenches(motion)
        self.apply_to(total)
        return total

    def apply_to(self, total: Wrenches) -> None:
        """Add the forces of all loads to those on the bodies."""
        motion = total.motion
        for body, mass in self.masses.items():
            if known_body(motion.linkage, body, "masses") != motion.linkage.ground:
                total.add_weight(body, mass, self.gravity)
                total.add_inertia(body, mass)
        for load in (*self.forces, *self.torques, *self.slide_forces, *self.springs, *self.friction):
            load.apply(total)
