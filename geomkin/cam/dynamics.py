"""Forces of a cam: contact with its follower, torque on its shaft, and the spring that keeps them together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import PositiveFloat, between, checked
from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, quantity, rounded_up
from ..core.records import record
from ..core.units import bare_mm, mm
from ..model.material import Mass, Material, hertz_pressure
from ..model.motor import MotorDuty
from ..plane.vec import Real, cross
from .cam import Cam
from .program.laws import largest

# N per kg mm/s2, N mm per kg mm2/s2, and W per N mm/s.
MILLI = 1e-3

CamSpeed = Annotated[float, between(-FARTHEST, FARTHEST, "rad/s")]


@record(checked=True)
class GuideFriction:
    """Dry friction of a translating follower in its guide.

    Parameters
    ----------
    coefficient : float
        Coefficient of friction.
    length : float
        Length of the guide, mm.
    overhang : float
        Distance along the stroke, at lift 0, from the roller's centre, or from the face where it crosses the y axis,
        to the guide, mm.

    Notes
    -----
    Both ends of the guide take the force across the stroke and its moment, so a short guide jams.

    Examples
    --------
    >>> gk.cam.GuideFriction(0.15, length=50, overhang=30)
    GuideFriction(coefficient=0.15, length=50, overhang=30)
    """

    coefficient: float = quantity("coefficient of friction", at_least=0, at_most=2, example=0.15)
    length: float = quantity("length of the guide", "mm", above=0, at_most=FARTHEST, example=50)
    overhang: float = quantity(
        "distance from the roller's centre or the face to the guide at lift 0", "mm",
        at_least=0, at_most=FARTHEST, example=30,
    )  # fmt: skip


@record(checked=True)
class FollowerLoads:
    """Everything that acts on a cam's follower besides the cam.

    Parameters
    ----------
    mass : Mass
        Of the follower with all that moves with it; of an arm in its own frame, whose origin is the pivot and whose x
        axis runs along the arm, or parallel to its face.
    stiffness : float, optional
        Of the spring that presses the follower on the cam, N/mm; of a torsion spring at an arm's pivot, N mm/rad.
    preload : float, optional
        Force of the spring at lift 0, N; torque about an arm's pivot, N mm.
    force : float, optional
        Constant further force on the follower, positive towards the cam, N; torque about an arm's pivot, N mm.
    gravity : complex, optional
        Acceleration of a falling body, mm/s2, on the ground: -9810j if it falls along -y; 0 if it is not considered.
    friction : GuideFriction, optional
        Of the guide of a translating follower.

    Examples
    --------
    >>> loads = gk.cam.FollowerLoads(gk.Mass(0.4), stiffness=3, preload=40, gravity=-9810j)
    """

    mass: Mass = entry("mass of the follower with all that moves with it", example=Mass(0.4))
    stiffness: float = quantity(
        "stiffness of the spring, N/mm; of a torsion spring, N mm/rad", default=0.0, at_least=0, at_most=FARTHEST
    )
    preload: float = quantity(
        "force of the spring at lift 0, N; torque about an arm's pivot, N mm", default=0.0, at_least=0, at_most=FARTHEST
    )
    force: float = quantity(
        "constant further force towards the cam, N; torque about an arm's pivot, N mm",
        default=0.0, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    gravity: complex = 0j
    friction: GuideFriction | None = None

    def __post_init__(self) -> None:
        if any(np.ndim(value) for value in (self.mass.mass, self.mass.centre, self.mass.inertia)):
            raise DesignError("mass", "found arrays, but a cam has one follower", "give one mass", "wrong-type")


@record(eq=False)
class CamForces:
    """Forces of a cam and its follower at given cam angles; all arrays have the shape of `angle`.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    angle : ndarray
        Cam angles, rad.
    speed : float
        Angular velocity of the cam, rad/s.
    stroke_force : ndarray
        Force along the stroke that the cam must supply, without friction, N; torque about an arm's pivot, N mm. Below
        0 the follower leaves the cam, unless the cam also holds it from the other side.
    contact : ndarray
        Force between cam and follower along their normal, N, with the sign of `stroke_force`; nan if the guide jams.
    torque : ndarray
        Torque on the camshaft, N mm, positive in the direction of the programme, in which the speed is positive.
    guide_share : ndarray
        Contact force without friction of the guide, over that with friction; 1 without friction. Towards 0 the guide
        jams.
    """

    cam: Cam
    angle: Real
    speed: float
    stroke_force: Real
    contact: Real
    torque: Real
    guide_share: Real

    @property
    def power(self) -> Real:
        """Power that drives the camshaft, W."""
        return MILLI * self.torque * self.speed

    @property
    def duty(self) -> MotorDuty:
        """Torque and speed that a motor on the camshaft must supply, at the cam angles in the given order."""
        torque = np.ravel(self.torque)
        return MotorDuty(torque, np.full(torque.shape, self.speed), np.ravel(self.angle))

    @checked
    def pressure(self, face_width: PositiveFloat, material: Material, follower: Material | None = None) -> Real:
        """Hertz pressure of the contact of cam and follower, a contact along a line.

        Parameters
        ----------
        face_width : float
            Width of the contact, mm.
        material : Material
            Of the cam.
        follower : Material, optional
            Of the follower; by default that of the cam.

        Returns
        -------
        ndarray
            N/mm2, 0 if the contact is lost; nan for a knife edge, and if a modulus of elasticity is unknown. A
            material begins to yield at its `yielding_pressure`.

        Notes
        -----
        See `geomkin.model.hertz_pressure`.

        Examples
        --------
        >>> cam = gk.Cam(gk.TranslatingFlat(), gk.Program((gk.Dwell(end_deg=360),)), base_radius=40)
        >>> result = gk.cam.cam_forces(cam, gk.cam.FollowerLoads(gk.Mass(0.4), preload=500), [0.0], speed=0)
        >>> result.pressure(10, gk.making.material("steel-S235")).round(3)
        array([214.266])
        """
        follower_shape = self.cam.follower
        if follower_shape.knife_edge is not None and not follower_shape.roller_radius:
            return np.full(np.shape(self.contact), np.nan)
        curvature = -self.cam.sense * self.cam.profile.curvature(self.angle)
        if follower_shape.roller_radius:
            curvature = curvature + 1 / follower_shape.roller_radius
        return hertz_pressure(self.contact, face_width, curvature, material, follower or material)


@checked
def cam_forces(
    cam: Cam, loads: FollowerLoads, angle: float | ArrayLike, *, speed: CamSpeed, acceleration: float = 0.0
) -> CamForces:
    """Contact force of cam and follower, and torque on the camshaft, at given cam angles.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    loads : FollowerLoads
        Mass, spring, force, gravity and friction of the follower.
    angle : float or array_like
        Cam angles, rad, any shape.
    speed : float
        Angular velocity of the cam, rad/s, positive in the direction of its programme. With 0 the result is that of
        statics, with friction as if the cam turned slowly in that direction.
    acceleration : float, optional
        Angular acceleration of the cam, rad/s2.

    Returns
    -------
    CamForces

    Raises
    ------
    DesignError
        If the loads do not suit the follower: an arm has no guide, and a guide must be beyond the largest lift.

    Notes
    -----
    The profile is that of the motion programme, without undercut. Friction acts in the guide alone: the roller rolls,
    and sliding of a face or knife edge is not considered. In the guide it is that of the contact force; spring, force
    and centre of mass are on its axis. During dwells friction is unknown, and counted as 0. Where the velocity jumps,
    the impact is not included. The inertia of the cam itself is not included. Norton, Cam Design and Manufacturing
    Handbook, on the dynamics of force-closed cams; the formulas are derived here.

    Examples
    --------
    >>> rise, back = gk.Rise("3-4-5", rise=20, end_deg=120), gk.Return("cycloidal", end_deg=360)
    >>> cam = gk.Cam(gk.TranslatingRoller(10), gk.Program((rise, back)), base_radius=40)
    >>> loads = gk.cam.FollowerLoads(gk.Mass(0.4), stiffness=3, preload=40)
    >>> result = gk.cam.cam_forces(cam, loads, np.radians([60.0, 90.0]), speed=60.0)
    >>> result.contact.round(3), result.torque.round(2)
    (array([73.05 , 57.479]), array([1253.35,  572.64]))
    """
    check_follower_loads(cam, loads)
    angle = np.asarray(angle, dtype=float)
    at, velocity = cam.contact(angle), cam.program.motion(angle).velocity
    stroke = _static_force(cam, loads, angle) + _inertia_force(cam, loads, angle, speed, acceleration)
    lever: Real = np.abs(_moment_about_pivot(cam, angle)) if cam.follower.oscillates else np.imag(at.normal)
    share = np.ones(angle.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        if loads.friction:
            along = -velocity if speed < 0 else velocity
            share = 1 - np.sign(along * stroke) * _guide_resistance(cam, loads.friction, angle) / lever
        contact: Real = np.where((lever > 0) & (share > 0), stroke / (lever * share), np.nan)
    torque = contact * cam.sense * cross(at.point, at.normal)
    return CamForces(cam, angle, float(speed), stroke, contact, torque, share)


@checked
def jump_speed(cam: Cam, loads: FollowerLoads) -> float:
    """Constant speed above which the follower leaves the cam.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    loads : FollowerLoads
        Mass, spring, force and gravity of the follower. Friction has no effect: it vanishes with the contact force.

    Returns
    -------
    float
        rad/s; 0 if the follower leaves the cam at any speed, for its velocity jumps or nothing presses it on the cam,
        and inf if it never does.

    Notes
    -----
    Derived here.

    Examples
    --------
    >>> rise, back = gk.Rise("3-4-5", rise=20, end_deg=120), gk.Return("cycloidal", end_deg=360)
    >>> cam = gk.Cam(gk.TranslatingRoller(10), gk.Program((rise, back)), base_radius=40)
    >>> round(gk.cam.jump_speed(cam, gk.cam.FollowerLoads(gk.Mass(0.4), stiffness=3, preload=40)), 4)
    95.2687
    """
    check_follower_loads(cam, loads)
    breaks = cam.program.breaks
    if np.any(cam.program.jumps.velocity) or largest(breaks, lambda t: -_static_force(cam, loads, t))[0] > 0:
        return 0.0

    def minus_squared_speed(angle: Real) -> Real:
        """Of the speed at which the contact force vanishes; -inf if it never does."""
        pull = -_inertia_force(cam, loads, angle, 1.0)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return np.where(pull > 0, -_static_force(cam, loads, angle) / pull, -np.inf)

    return float(np.sqrt(max(0.0, -largest(breaks, minus_squared_speed)[0])))


@checked
def least_preload(cam: Cam, loads: FollowerLoads, speed: CamSpeed) -> float:
    """Least preload of the spring, at its stiffness, that keeps the follower on the cam at a constant speed.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    loads : FollowerLoads
        Mass, stiffness, force and gravity of the follower; its preload does not matter.
    speed : float
        rad/s.

    Returns
    -------
    float
        N, or N mm for an arm; 0 if the contact needs none, inf if the velocity of the follower jumps.

    Notes
    -----
    Derived here.

    Examples
    --------
    >>> rise, back = gk.Rise("3-4-5", rise=20, end_deg=120), gk.Return("cycloidal", end_deg=360)
    >>> cam = gk.Cam(gk.TranslatingRoller(10), gk.Program((rise, back)), base_radius=40)
    >>> round(gk.cam.least_preload(cam, gk.cam.FollowerLoads(gk.Mass(0.4), stiffness=3), speed=95.2687), 3)
    40.0
    """
    return _least_of_spring(cam, replace(loads, preload=0.0), speed, lambda pull, lift: pull)


@checked
def least_stiffness(cam: Cam, loads: FollowerLoads, speed: CamSpeed) -> float:
    """Least stiffness of the spring, at its preload, that keeps the follower on the cam at a constant speed.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    loads : FollowerLoads
        Mass, preload, force and gravity of the follower; its stiffness does not matter.
    speed : float
        rad/s.

    Returns
    -------
    float
        N/mm, or N mm/rad for an arm; 0 if the contact needs none, inf if no stiffness suffices: the preload is too
        small at lift 0, or the velocity of the follower jumps.

    Notes
    -----
    Derived here.

    Examples
    --------
    >>> rise, back = gk.Rise("3-4-5", rise=20, end_deg=120), gk.Return("cycloidal", end_deg=360)
    >>> cam = gk.Cam(gk.TranslatingRoller(10), gk.Program((rise, back)), base_radius=40)
    >>> round(gk.cam.least_stiffness(cam, gk.cam.FollowerLoads(gk.Mass(0.4), preload=40), speed=95.2687), 4)
    3.0
    """

    def stiffness(pull: Real, lift: Real) -> Real:
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return np.where(pull > 0, np.where(lift > 0, pull / lift, np.inf), 0.0)

    return _least_of_spring(cam, replace(loads, stiffness=0.0), speed, stiffness)


def _least_of_spring(cam: Cam, loads: FollowerLoads, speed: float, needed: Callable[[Real, Real], Real]) -> float:
    """The largest value that a spring needs over a turn. needed: from the pull off the cam without it, and the lift."""
    check_follower_loads(cam, loads)
    if speed and np.any(cam.program.jumps.velocity):
        return np.inf

    def value(angle: Real) -> Real:
        pull = -_static_force(cam, loads, angle) - _inertia_force(cam, loads, angle, speed)
        return needed(pull, cam.program.motion(angle).lift)

    return max(0.0, largest(cam.program.breaks, value)[0])


def check_follower_loads(cam: Cam, loads: FollowerLoads) -> None:
    """DesignError if the friction of a guide does not suit the follower."""
    if not loads.friction:
        return
    if cam.follower.oscillates:
        problem = "found friction of a guide, but an arm turns about a pivot"
        raise DesignError("loads.friction", problem, "omit it", "conflict")
    lift = largest(cam.program.breaks, lambda t: cam.program.motion(t).lift)[0]
    if loads.friction.overhang < lift:
        problem = f"found {mm(loads.friction.overhang):g}, less than the largest lift: the follower would hit its guide"
        remedy = f"give at least {bare_mm(lift):up}"
        raise DesignError("loads.friction.overhang", problem, remedy, "out-of-range", rounded_up(lift))


def _static_force(cam: Cam, loads: FollowerLoads, angle: Real) -> Real:
    """Spring, force and weight towards the cam, along the stroke, N, or about an arm's pivot, N mm."""
    pressing: Real = loads.preload + loads.stiffness * cam.program.motion(angle).lift + loads.force
    mass, centre = float(loads.mass.mass), complex(loads.mass.centre)
    if not loads.gravity:
        return pressing
    if not cam.follower.oscillates:
        return pressing - MILLI * mass * loads.gravity.imag
    weight: Real = MILLI * mass * cross(cam.follower_pose(angle).direction * centre, loads.gravity)
    # The cam turns the arm away, so weight presses on the cam if its moment has the opposite sign.
    pressing -= np.sign(_moment_about_pivot(cam, angle)) * weight
    return pressing


def _inertia_force(cam: Cam, loads: FollowerLoads, angle: Real, speed: float, acceleration: float = 0.0) -> Real:
    """Force along the stroke that accelerates the follower, N; of an arm the torque about its pivot, N mm."""
    inertia = float(loads.mass.mass)
    if cam.follower.oscillates:
        inertia = float(loads.mass.inertia) + inertia * abs(complex(loads.mass.centre)) ** 2
    motion = cam.program.motion(angle)
    force: Real = MILLI * inertia * (speed**2 * motion.acceleration + acceleration * motion.velocity)
    return force


def _moment_about_pivot(cam: Cam, angle: Real) -> Real:
    """Moment of a unit contact force about an arm's pivot, mm, counterclockwise."""
    at = cam.contact(angle)
    return cross(at.point - cam.follower_pose(angle).origin, at.normal)


def _guide_resistance(cam: Cam, friction: GuideFriction, angle: Real) -> Real:
    """Friction force of the guide per unit of contact force, from the forces that press on its two ends."""
    at = cam.contact(angle)
    start = cam.follower.pose(np.zeros(()), cam.base_radius).origin + 1j * friction.overhang
    far = cross(at.point - start, at.normal) / friction.length
    resistance: Real = friction.coefficient * (np.abs(far) + np.abs(np.real(at.normal) + far))
    return resistance
