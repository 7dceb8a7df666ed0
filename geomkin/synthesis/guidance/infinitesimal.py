"""Four-bars for two or three infinitesimally separated positions: given velocities and accelerations of a body."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.records import record
from ...linkage.instant.centres import InstantCentre
from ...linkage.instant.inflection import InflectionCircle
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Real, cross

# Relative distance below which pins, pivots and the instant centre are collinear, or a pin coincides with its pivot. A
# larger value refuses flat four-bars, a smaller one builds a linkage on rounding.
IN_LINE = 1e-9
# Distance of a pivot, in sizes, beyond which its crank is a slide; a larger value builds a pivot on rounding.
FAR = 1e9


@record(checked=True, eq=False)
class BodyState:
    """Velocity and acceleration of a body at an instant.

    Parameters
    ----------
    velocity : complex
        Velocity of the body's point at `position`, mm/s.
    omega : float
        Angular velocity, rad/s.
    acceleration : complex
        Acceleration of that point, mm/s2; used for three positions only.
    alpha : float
        Angular acceleration, rad/s2; used for three positions only.
    position : complex
        The point, mm.

    Raises
    ------
    DesignError
        If velocity and omega are both 0.
    """

    velocity: complex
    omega: float
    acceleration: complex = 0j
    alpha: float = 0.0
    position: complex = 0j

    def __post_init__(self) -> None:
        if not (self.velocity or self.omega):
            remedy = "give one of them; a body at rest does not determine a linkage"
            raise DesignError("velocity", "found 0, and omega 0", remedy, "conflict")

    def velocity_of(self, points: ArrayLike) -> Complex:
        """Velocities of the body's points.

        Parameters
        ----------
        points : array_like of complex
            Present positions of the points, mm.

        Returns
        -------
        array of complex
            Velocities, mm/s.
        """
        velocities: Complex = self.velocity + 1j * self.omega * (np.asarray(points) - self.position)
        return velocities

    def acceleration_of(self, points: ArrayLike) -> Complex:
        """Accelerations of the body's points.

        Parameters
        ----------
        points : array_like of complex
            Present positions of the points, mm.

        Returns
        -------
        array of complex
            Accelerations, mm/s2.
        """
        arms = np.asarray(points) - self.position
        accelerations: Complex = self.acceleration + (1j * self.alpha - self.omega**2) * arms
        return accelerations

    @property
    def instant_centre(self) -> InstantCentre:
        """Point without velocity, mm; at infinity if the body does not rotate."""
        return InstantCentre(np.asarray(self.position), np.asarray(1j * self.velocity), np.asarray(self.omega))

    @property
    def inflection_circle(self) -> InflectionCircle:
        """Second-order geometry of the motion; `path(point).centre` is the pivot of a crank with its pin there."""
        return _second_order(self.position, self.velocity, self.acceleration, self.omega, self.alpha)

    @property
    def seen_by_body(self) -> InflectionCircle:
        """`inflection_circle` of the ground as seen from the body: the centres of the paths of pivots are pins."""
        back = 2j * self.omega * self.velocity - self.acceleration
        return _second_order(self.position, -self.velocity, back, -self.omega, -self.alpha)


def _second_order(position: complex, *rates: complex) -> InflectionCircle:
    place, velocity, acceleration, turn, turn_rate = (np.asarray(rate) for rate in (position, *rates))
    return InflectionCircle(place, velocity, acceleration, turn.real, turn_rate.real)


@record(eq=False, kw_only=True)
class StateFourBar:
    """A four-bar whose coupler has a given state, and the drive for it.

    Parameters
    ----------
    linkage : FourBar
        The linkage, placed in the plane; its coupler point is the point of the state.
    branch : int
        +1 or -1, as `move` takes it.
    drive : float
        Present crank angle, rad from the ground line.
    speed, acceleration : float
        Of the crank, rad/s and rad/s2, as `move` takes them.
    fixed, moving : array of complex, shape (2,)
        Pivots and pins of crank and rocker, mm.
    """

    linkage: FourBar
    branch: int
    drive: float
    speed: float
    acceleration: float
    fixed: Complex
    moving: Complex


@checked
def velocity_state_four_bar(
    state: BodyState,
    speeds: float | ArrayLike,
    moving: None | complex | ArrayLike = None,
    fixed: None | complex | ArrayLike = None,
) -> StateFourBar:
    """Find a four-bar that gives a body its velocities (two infinitely close positions).

    Parameters
    ----------
    state : BodyState
        The motion of the body.
    speeds : array_like, shape (2,)
        Angular velocities of crank and rocker, rad/s, not 0; both are free choices.
    moving : array_like of complex, shape (2,), optional
        Present positions of the pins of crank and rocker on the body, mm. Each pivot is then on the line to the instant
        centre.
    fixed : array_like of complex, shape (2,), optional
        The two ground pivots instead, mm.

    Returns
    -------
    StateFourBar
        The four-bar; its crank is driven without acceleration.

    Raises
    ------
    DesignError
        If a pin does not move or coincides with its pivot, a crank would rotate with the body, or all joints are
        collinear, which leaves the motion undetermined.

    Notes
    -----
    V = i w (A - F), derived here.
    """
    w: Real = np.asarray(speeds, dtype=float)
    if w.shape != (2,) or not w.all():
        raise DesignError(
            "speeds", f"found {np.asarray(speeds).tolist()}", "give two, of crank and rocker, not 0", "out-of-range"
        )
    name, given = _two_points(moving, fixed)
    if name == "moving":
        pins, pivots = given, given + 1j * state.velocity_of(given) / w
    else:
        if (np.abs(w - state.omega) <= IN_LINE * np.abs(w)).any():
            raise DesignError(
                "speeds", f"found {state.omega:g} rad/s, at which the body turns", "give another speed", "conflict"
            )
        moment = state.omega * state.position + 1j * state.velocity
        pivots, pins = given, (moment - w * given) / (state.omega - w)
    return _four_bar(state, name, pins, pivots, 0.0)


@checked
def acceleration_state_four_bar(
    state: BodyState, moving: None | complex | ArrayLike = None, fixed: None | complex | ArrayLike = None
) -> StateFourBar:
    """Find a four-bar that gives a body its velocities and accelerations (three infinitely close positions).

    Parameters
    ----------
    state : BodyState
        The motion of the body.
    moving : array_like of complex, shape (2,), optional
        Present positions of the pins of crank and rocker on the body, mm. Each pivot is at the centre of curvature of
        its pin's path.
    fixed : array_like of complex, shape (2,), optional
        The two ground pivots instead, mm. Each pin is at the centre of curvature of its pivot's path as seen from the
        body.

    Returns
    -------
    StateFourBar
        The four-bar and the drive of its crank.

    Raises
    ------
    DesignError
        If a path is straight, so that its pivot is at infinity, a pin does not move or coincides with its pivot, or all
        joints are collinear.

    Notes
    -----
    Euler-Savary equation; Dijksman, Motion Geometry of Mechanisms, 1976.
    """
    name, given = _two_points(moving, fixed)
    if name == "moving":
        pins, pivots = given, state.inflection_circle.path(given).centre
    else:
        pins, pivots = state.seen_by_body.path(given).centre, given
    far = np.isnan(pins) | np.isnan(pivots) | (np.abs(pins - pivots) > FAR * np.abs(given[1] - given[0]))
    if far.any():
        place = given[np.argmax(far)]
        problem = f"the path of ({place.real:g}, {place.imag:g}) is straight, or the point is at rest"
        raise DesignError(name, problem, "give another point")
    arm = pins[0] - pivots[0]
    alpha = cross(arm, state.acceleration_of(pins[0])) / max(abs(arm) ** 2, np.finfo(float).tiny)
    return _four_bar(state, name, pins, pivots, float(alpha))


def _two_points(moving: None | complex | ArrayLike, fixed: None | complex | ArrayLike) -> tuple[str, Complex]:
    if (moving is None) == (fixed is None):
        raise DesignError("moving", "found both, or neither, of moving and fixed", "give one of them", "conflict")
    name, given = ("moving", moving) if fixed is None else ("fixed", fixed)
    points: Complex = np.asarray(given, dtype=complex)
    if points.shape != (2,) or points[0] == points[1]:
        problem = f"found {points.tolist()}"
        raise DesignError(name, problem, "give two different points: the crank's, then the rocker's", "out-of-range")
    return name, points


def _four_bar(state: BodyState, name: str, pins: Complex, pivots: Complex, alpha: float) -> StateFourBar:
    arms, base, bar = pins - pivots, pivots[1] - pivots[0], pins[1] - pins[0]
    size = float(np.abs([*arms, base, bar]).max())
    if min(np.abs([*arms, base, bar])) <= IN_LINE * size:
        raise DesignError(name, "a pin falls on its pivot or on the other one", "give points off the instant centre")
    if max(abs(cross(bar, arm)) / abs(bar * arm) for arm in arms) <= IN_LINE:
        problem = "the points and the instant centre are collinear, so that the motion is undetermined"
        raise DesignError(name, problem, "move one off it")
    along = base / abs(base)
    linkage = FourBar(
        float(abs(base)),
        float(abs(arms[0])),
        float(abs(bar)),
        float(abs(arms[1])),
        coupler_point=complex((state.position - pins[0]) * abs(bar) / bar),
        origin=complex(pivots[0]),
        ground_angle_deg=float(np.degrees(np.angle(base))),
    )
    speed = float(cross(arms[0], state.velocity_of(pins[0])) / abs(arms[0]) ** 2)
    return StateFourBar(
        linkage=linkage,
        branch=1 if cross(pivots[1] - pins[0], bar) > 0 else -1,
        drive=float(np.angle(arms[0] / along)),
        speed=speed,
        acceleration=alpha,
        fixed=pivots,
        moving=pins,
    )
