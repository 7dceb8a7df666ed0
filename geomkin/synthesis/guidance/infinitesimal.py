"""Two and three infinitesimally separated positions: a body's velocities and accelerations, to a four-bar."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import Points, Reals, checked
from ...core.errors import DesignError
from ...core.records import record
from ...linkage.instant.centres import InstantCentre
from ...linkage.instant.inflection import InflectionCircle
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Real, cross

# Share of their size below which pins, pivots and the instant centre are in one line, and a pivot is its own pin.
# Larger, and flat four-bars are refused; smaller, and rounding makes a linkage.
IN_LINE = 1e-9
# Distance of a pivot, in sizes, from which its crank is a slide. Larger, and a slide's pivot is made of rounding.
FAR = 1e9


@record(checked=True, eq=False)
class BodyState:
    """How a body moves at an instant: the velocity, mm/s, of its point at `position`, mm, and its turning, rad/s.

    acceleration, mm/s2, of that point and alpha, rad/s2, are needed for three positions only.
    """

    velocity: complex
    omega: float
    acceleration: complex = 0j
    alpha: float = 0.0
    position: complex = 0j

    def __post_init__(self) -> None:
        if not (self.velocity or self.omega):
            raise DesignError("velocity", "found 0, and omega 0", "give one of them: a body at rest tells nothing")

    def velocity_of(self, points: ArrayLike) -> Complex:
        """Velocities, mm/s, of the body's points that are at these places now, mm."""
        velocities: Complex = self.velocity + 1j * self.omega * (np.asarray(points) - self.position)
        return velocities

    def acceleration_of(self, points: ArrayLike) -> Complex:
        """Accelerations, mm/s2, of the same."""
        arms = np.asarray(points) - self.position
        accelerations: Complex = self.acceleration + (1j * self.alpha - self.omega**2) * arms
        return accelerations

    @property
    def instant_centre(self) -> InstantCentre:
        """Where the body has no velocity, mm; at infinity where it does not turn."""
        return InstantCentre(np.asarray(self.position), np.asarray(1j * self.velocity), np.asarray(self.omega))

    @property
    def inflection_circle(self) -> InflectionCircle:
        """What the two states tell to second order: `path` of any place, its centre the pivot of a crank there."""
        return _second_order(self.position, self.velocity, self.acceleration, self.omega, self.alpha)

    @property
    def seen_by_body(self) -> InflectionCircle:
        """The same of the ground's motion as the body sees it: the centres of paths of pivots are their pins."""
        back = 2j * self.omega * self.velocity - self.acceleration
        return _second_order(self.position, -self.velocity, back, -self.omega, -self.alpha)


def _second_order(position: complex, *rates: complex) -> InflectionCircle:
    place, velocity, acceleration, turn, turn_rate = (np.asarray(rate) for rate in (position, *rates))
    return InflectionCircle(place, velocity, acceleration, turn.real, turn_rate.real)


@record(eq=False, kw_only=True)
class StateFourBar:
    """A four-bar whose coupler moves as a state wants, and how it is to be driven for that.

    linkage: placed in the plane; its coupler point is the body's point that the state is given for. branch: +1 or -1.
    drive: the crank's angle now, rad from the ground line; speed, rad/s, and acceleration, rad/s2, of the crank, as
    `move` takes them. fixed, moving: the crank's pivot and pin now, then the rocker's, mm.
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
    state: BodyState, speeds: Reals, moving: Points | None = None, fixed: Points | None = None
) -> StateFourBar:
    """A four-bar that gives a body its velocities: two positions infinitely close together.

    speeds: of crank and rocker, rad/s, both free. Then either moving: their pins on the body, where they are now, mm,
    each of whose pivots is on the line to the instant centre; or fixed: their pivots. The crank is driven without
    acceleration. DesignError where a pin does not move or falls on its pivot, where a crank would turn as the body
    does, and where all joints are in line, which leaves the motion open. V = i w (A - F), derived here.
    """
    w: Real = np.asarray(speeds, dtype=float)
    if w.shape != (2,) or not w.all():
        raise DesignError("speeds", f"found {np.asarray(speeds).tolist()}", "give two, of crank and rocker, not 0")
    name, given = _two(moving, fixed)
    if name == "moving":
        pins, pivots = given, given + 1j * state.velocity_of(given) / w
    else:
        if (np.abs(w - state.omega) <= IN_LINE * np.abs(w)).any():
            raise DesignError("speeds", f"found {state.omega:g} rad/s, at which the body turns", "give another speed")
        whole = state.omega * state.position + 1j * state.velocity
        pivots, pins = given, (whole - w * given) / (state.omega - w)
    return _four_bar(state, name, pins, pivots, 0.0)


@checked
def acceleration_state_four_bar(
    state: BodyState, moving: Points | None = None, fixed: Points | None = None
) -> StateFourBar:
    """A four-bar that gives a body its velocities and accelerations: three positions infinitely close together.

    moving: the two pins on the body, where they are now, mm; each has its pivot at the centre of curvature of its
    path. Or fixed: the two pivots; each has its pin where the body sees that centre of its own path. Euler-Savary;
    Dijksman, Motion Geometry of Mechanisms, 1976. DesignError where a path is straight, so that its pivot is at
    infinity, where a pin does not move or falls on its pivot, and where all joints are in line.
    """
    name, given = _two(moving, fixed)
    if name == "moving":
        pins, pivots = given, state.inflection_circle.path(given).centre
    else:
        pins, pivots = state.seen_by_body.path(given).centre, given
    far = np.isnan(pins) | np.isnan(pivots) | (np.abs(pins - pivots) > FAR * np.abs(given[1] - given[0]))
    if far.any():
        place = given[np.argmax(far)]
        raise DesignError(
            name, f"the path of ({place.real:g}, {place.imag:g}) is straight, or it stands still", "give another point"
        )
    arm = pins[0] - pivots[0]
    alpha = cross(arm, state.acceleration_of(pins[0])) / max(abs(arm) ** 2, np.finfo(float).tiny)
    return _four_bar(state, name, pins, pivots, float(alpha))


def _two(moving: Points | None, fixed: Points | None) -> tuple[str, Complex]:
    if (moving is None) == (fixed is None):
        raise DesignError("moving", "found both, or neither, of moving and fixed", "give one of them")
    name, given = ("moving", moving) if fixed is None else ("fixed", fixed)
    points: Complex = np.asarray(given, dtype=complex)
    if points.shape != (2,) or points[0] == points[1]:
        raise DesignError(name, f"found {points.tolist()}", "give two different points: the crank's, then the rocker's")
    return name, points


def _four_bar(state: BodyState, name: str, pins: Complex, pivots: Complex, alpha: float) -> StateFourBar:
    arms, base, bar = pins - pivots, pivots[1] - pivots[0], pins[1] - pins[0]
    size = float(np.abs([*arms, base, bar]).max())
    if min(np.abs([*arms, base, bar])) <= IN_LINE * size:
        raise DesignError(name, "a pin falls on its pivot or on the other one", "give points off the instant centre")
    if max(abs(cross(bar, arm)) / abs(bar * arm) for arm in arms) <= IN_LINE:
        raise DesignError(
            name, "the points and the instant centre are in one line, which leaves the motion open", "move one off it"
        )
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
