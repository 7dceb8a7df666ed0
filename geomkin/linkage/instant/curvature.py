"""Curvature of the paths of a body's points, and the Euler-Savary equation."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np

from ...core.arguments import AnyFloat, ComplexOrNan, checked
from ...core.errors import DesignError
from ...core.fields import ComplexOrArray
from ...core.records import record
from ...plane.vec import Complex, Real, as_unit, cross, dot, known, unit
from ..joints.slide import Slider
from ..linkage import Linkage
from ..motion import Motion
from ..moving import move
from .centres import pin_between, slider_between, zero_at_infinity

# Share of its terms below which a sum counts as rounding. With a smaller value a slider's pin gets a centre of
# curvature and a cusp a radius; with a larger one flat paths and sharp bends are lost.
ROUNDING = 1e-14
# Speed of a point, as a share of its terms, below which the point is so near the instant centre that a curvature lost
# in rounding is reported as nan instead of straight.
SLOW = 1e-3
# Square of a body's speed over its acceleration, in sizes of the linkage, below which it counts as reversing. Six
# digits of the curvature are left there.
TURNING_BACK = 1e-10
# 1/a - 1/c - 1/j = 0, the Euler-Savary equation.
SIGN = {"point": 1, "centre": -1, "inflection": -1}


@record(checked=True, eq=False)
class PathCurvature:
    """A point on its path to second order; arrays of any shape.

    Parameters
    ----------
    position : complex or array
        mm.
    tangent : complex or array
        Direction of any length, stored with length 1; nan at a cusp.
    curvature : float or array
        1/mm, positive if the path turns left along `tangent`; 0 if straight, inf at a cusp.

    Notes
    -----
    Derived here.
    """

    position: Complex
    tangent: Complex
    curvature: Real

    def __post_init__(self) -> None:
        object.__setattr__(self, "tangent", as_unit(self.tangent))

    @property
    def radius(self) -> Real:
        """Radius of curvature, mm, signed as the curvature; inf if straight, 0 at a cusp."""
        with np.errstate(divide="ignore"):
            size = np.divide(1, np.abs(self.curvature))
        return size * np.where(np.asarray(self.curvature) < 0, -1, 1)

    @property
    def centre(self) -> Complex:
        """Centre of curvature, mm; nan if straight, the point itself at a cusp."""
        with np.errstate(invalid="ignore"):
            centre = self.position + 1j * np.asarray(self.tangent) * self.radius
        straight = np.where(np.asarray(self.curvature) == 0, complex(np.nan, np.nan), centre)
        return np.where(np.isinf(self.curvature), self.position, straight)


@checked
def crank_path(pin: ComplexOrNan, pivot: ComplexOrNan) -> PathCurvature:
    """The circle of a pin about a pivot, counterclockwise.

    The path of a slider's pin is `PathCurvature(pin, direction, 0.0)`.

    Parameters
    ----------
    pin, pivot : complex or array_like
        mm, of any shape.

    Returns
    -------
    PathCurvature

    Notes
    -----
    Derived here.
    """
    pin, arm = np.asarray(pin, dtype=complex), np.asarray(pin, dtype=complex) - pivot
    with np.errstate(divide="ignore"):
        return PathCurvature(pin, 1j * unit(arm), 1 / np.abs(arm))


@checked
def path_curvature(motion: Motion, body: str, local: ComplexOrArray) -> PathCurvature:
    """Path of a body's point on the ground, to second order, along rising drive.

    Parameters
    ----------
    motion : Motion
        Motion of the linkage.
    body : str
        Name of the body.
    local : complex or array
        The point, mm in the body's frame; one, or one for each frame.

    Returns
    -------
    PathCurvature
        Arrays of the motion's shape. nan where the linkage is open, at a dead centre of the driver, where all
        points of the body reverse, and for points so near the instant centre that straight and curved paths cannot be
        distinguished.

    Raises
    ------
    DesignError
        If the linkage has no such body, or the number of points is not that of the frames.

    Notes
    -----
    With V and A the first and second kinematic coefficients of the point the curvature is V x A / |V|^3. A
    body joined to the ground, and a pin that it shares with others, turns about a pivot or runs along a slide. Derived
    here.
    """
    if body not in motion.bodies:
        raise DesignError("body", f"found {body!r}", f"give one of {', '.join(motion.bodies)}", "unknown-key")
    if np.shape(local) not in ((), motion.assembled.shape):
        problem = f"found shape {np.shape(local)}"
        raise DesignError("local", problem, f"give one point, or {motion.assembled.shape} of them", "wrong-type")
    carrier, local = _guided(motion, body, local)
    moved, ground = motion.bodies[carrier], motion.linkage.ground
    position = moved.point(local).position
    pin, rail = pin_between(motion.linkage, ground, carrier), slider_between(motion.linkage, ground, carrier)
    if carrier != ground and pin is not None:
        path = crank_path(position, motion.point(pin).position)
        backwards = np.where(moved.first < 0, -1, 1)
        return PathCurvature(path.position, path.tangent * backwards, path.curvature * backwards)
    if rail is not None:
        along = motion.bodies[rail.along].direction * rail.direction
        backwards = np.where(dot(along, moved.origin.first) < 0, -1, 1)
        return PathCurvature(position, known(motion.assembled, along * backwards), 0 * position.real)
    return point_path(position, position - moved.origin.position, *second_order(motion, carrier, settle=False))


def _guided(motion: Motion, body: str, local: complex | Complex) -> tuple[str, complex | Complex]:
    """The same point as a point of a body joined to the ground, if a pin makes it one."""
    linkage = motion.linkage

    def joined(name: str) -> bool:
        pair = linkage, linkage.ground, name
        return name != linkage.ground and bool(pin_between(*pair) or slider_between(*pair))

    if not joined(body):
        for name, place in linkage.bodies[body].items():
            other = next((b for b in linkage.pins.get(name, ()) if joined(b)), None)
            if other is not None and np.array_equal(place, local):
                return other, linkage.bodies[other][name]
    return body, local


def second_order(motion: Motion, body: str, settle: bool = True) -> tuple[Complex, Complex, Real, Real]:
    """First and second coefficients of a body's origin, then of its angle; nan where second order is lost.

    settle: rotation that is only rounding becomes 0, which keeps a point at infinity there.
    """
    moved, extent = motion.bodies[body], motion.linkage.size
    with np.errstate(invalid="ignore"):  # rates are infinite at a dead centre of the driver
        velocity, acceleration = moved.origin.first, moved.origin.second
        theta_prime, theta_second = moved.first, moved.second
        speed = abs(velocity) + abs(theta_prime) * extent
        speed_rate = abs(acceleration) + abs(theta_second) * extent
        lost = (speed**2 <= TURNING_BACK * speed_rate * extent) | ~np.isfinite(speed_rate)
        if settle:
            theta_prime = zero_at_infinity(theta_prime, abs(velocity), extent)
            theta_second = zero_at_infinity(theta_second, abs(acceleration), extent)
    parts = [known(~lost, part) for part in (velocity, acceleration, theta_prime, theta_second)]
    return parts[0], parts[1], parts[2], parts[3]


def point_path(
    position: Complex, arm: Complex, velocity: Complex, acceleration: Complex, theta_prime: Real, theta_second: Real
) -> PathCurvature:
    """The path of a body's point, at `arm` from a point with this velocity and acceleration."""
    v, a = (velocity, 1j * theta_prime * arm), (acceleration, (1j * theta_second - theta_prime**2) * arm)
    first, second = v[0] + v[1], a[0] + a[1]
    speed, numerator = abs(first), cross(first, second)
    # Speed and numerator are sums: if their terms cancel, only rounding is left.
    speed_terms, rate_terms = abs(v[0]) + abs(v[1]), abs(a[0]) + abs(a[1])
    lost = abs(numerator) <= ROUNDING * (speed_terms * abs(second) + speed * rate_terms)
    straight = np.where(speed > SLOW * speed_terms, 0.0, np.nan)
    cusp = speed <= ROUNDING * speed_terms
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = np.where(cusp, np.inf, np.where(lost, straight, numerator / speed**3))
    return PathCurvature(position, known(~cusp, unit(first)), np.where(speed_terms > 0, curvature, np.nan))


@checked
def euler_savary(
    *,
    instant_centre: AnyFloat | None = None,
    point: AnyFloat | None = None,
    centre: AnyFloat | None = None,
    inflection: AnyFloat | None = None,
) -> Real:
    """The Euler-Savary equation: one of four points on a ray through the instant centre, from the other three.

    All are signed distances along the ray from one origin, mm, arrays of any shapes that broadcast. Give exactly three.

    Parameters
    ----------
    instant_centre : float or array_like, optional
        Instant centre I.
    point : float or array_like, optional
        A point A of the body; may be inf.
    centre : float or array_like, optional
        Centre of curvature C of its path; may be inf (a slider).
    inflection : float or array_like, optional
        Intersection J of the ray with the inflection circle; may be inf.

    Returns
    -------
    array
        The missing distance, mm; nan if the three do not determine it. The instant centre has two solutions, shape (2,
        ...), the greater first; nan if there is none.

    Raises
    ------
    DesignError
        Unless exactly three are given.

    Notes
    -----
    (A - I)^2 = (A - J)(A - C); with a, c, j the distances from I: 1/a - 1/c = 1/j. j is D cos(psi), with D
    the circle's diameter and psi the ray's angle from the centrode normal; the centrodes' own centres of curvature O_M
    and O_F are such a pair A and C with j = D. Both forms: Hall, Kinematics and Linkage Design, 1961, on path
    curvature. A line has one infinity at both ends of the ray.

    Examples
    --------
    >>> import geomkin as gk
    >>> float(gk.linkage.euler_savary(instant_centre=0.0, point=30.0, inflection=20.0))
    -60.0
    """
    places = {"instant_centre": instant_centre, "point": point, "centre": centre, "inflection": inflection}
    missing = [name for name, place in places.items() if place is None]
    if len(missing) != 1:
        found = ", ".join(name for name in places if name not in missing) or "none"
        raise DesignError("euler_savary", f"found {found}", f"give exactly three of {', '.join(places)}", "conflict")
    wanted = missing[0]
    known = {name: np.asarray(place, dtype=float) for name, place in places.items() if place is not None}
    with np.errstate(all="ignore"):
        if wanted == "instant_centre":
            return _instant_centres(known["point"], known["centre"], known["inflection"])
        base = known.pop("instant_centre")
        # Each distance is n / d, with 1 / 0 for infinity, so that nothing is subtracted from infinity.
        (n1, d1, sign1), (n2, d2, sign2) = (
            (np.where(np.isinf(place), 1.0, place - base), np.where(np.isinf(place), 0.0, 1.0), SIGN[name])
            for name, place in known.items()
        )
        top, bottom = -SIGN[wanted] * n1 * n2, sign1 * d1 * n2 + sign2 * d2 * n1
        return np.where((bottom == 0) & (top != 0), np.inf, base + top / bottom)


def _instant_centres(point: Real, centre: Real, inflection: Real) -> Real:
    product = (point - inflection) * (point - centre)
    root = np.where(np.isinf(product), np.inf, np.sqrt(product))
    # If the point is at infinity, its centre and its inflection point are equally far from the one instant centre.
    second = np.where(np.isinf(point), 0.5 * (centre + inflection), point - root)
    return np.stack(np.broadcast_arrays(point + root, second))


@record(checked=True, eq=False)
class DirectContact:
    """A turning body that drives a follower by rolling and sliding contact: a cam, a roller, two curved levers.

    Arrays have one shape (positions,), or all are numbers; positions in the ground's frame. Give either
    `follower_pivot` or `follower_direction`. A roller may count as part of the driver: then `point` is its centre,
    `follower_radius` 0 and `driver_radius` that of the pitch curve.

    Parameters
    ----------
    point : complex or array
        Point of contact, mm.
    normal : complex or array
        Common normal, from the driver into the follower, of any length.
    driver_radius, follower_radius : float or array
        Radius of curvature of each surface there, mm, positive if convex, inf if straight, 0 at an edge.
    driver_pivot : complex or array
        Pivot of the driver, mm.
    follower_pivot : complex or array, optional
        Pivot of a follower that turns, mm.
    follower_direction : complex or array, optional
        Direction of a follower that slides.

    Raises
    ------
    DesignError
        If both surfaces are straight, or not exactly one of pivot and direction is given.

    Notes
    -----
    To the second order, two bodies in contact move as if a bar joined their centres of curvature; for a
    straight surface a slider on it replaces the bar. So the follower's velocity and acceleration depend on the
    curvatures at the contact and not on the equations of the curves. They are not finite if the follower cannot move
    along the normal, or if both surfaces have the same centre of curvature. Derived here, after the equivalent linkage
    of the textbooks.
    """

    point: ComplexOrArray
    normal: ComplexOrArray
    driver_radius: Real
    follower_radius: Real
    driver_pivot: ComplexOrArray = 0j
    follower_pivot: ComplexOrArray | None = None
    follower_direction: ComplexOrArray | None = None

    def __post_init__(self) -> None:
        if (self.follower_pivot is None) == (self.follower_direction is None):
            found = "neither" if self.follower_pivot is None else "both"
            raise DesignError(
                "follower_pivot", f"of it and follower_direction found {found}", "give one of them", "conflict"
            )
        if np.any(np.isinf(self.driver_radius) & np.isinf(self.follower_radius)):
            raise DesignError("follower_radius", "both surfaces are straight", "give at least one a finite radius")

    @property
    def driver_centre(self) -> Complex:
        """Centre of curvature of the driver's surface, mm; not finite if it is straight."""
        return self._centre(-np.asarray(self.driver_radius))

    @property
    def follower_centre(self) -> Complex:
        """Centre of curvature of the follower's surface, mm; not finite if it is straight."""
        return self._centre(np.asarray(self.follower_radius))

    def _centre(self, along: Real) -> Complex:
        with np.errstate(invalid="ignore"):
            return np.asarray(self.point) + along * self._normal

    @property
    def first(self) -> Real:
        """Follower's first kinematic coefficient: rad per rad of the driver, or mm per rad if it slides."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return dot(self._normal, self._driver_velocity) / dot(self._normal, self._follower_velocity)

    @property
    def sliding(self) -> Real:
        """Sliding velocity of the follower's surface on the driver's, mm per rad, positive left of the normal."""
        with np.errstate(invalid="ignore"):
            return dot(1j * self._normal, self.first * self._follower_velocity - self._driver_velocity)

    @property
    def second(self) -> Real:
        """Follower's second kinematic coefficient: rad, or mm if it slides, per rad squared of the driver."""
        n, f, point = self._normal, self.first, np.asarray(self.point)
        with np.errstate(invalid="ignore", divide="ignore"):
            along = self._curving(0 * f if self.follower_pivot is None else f) - dot(n, point - self.driver_pivot)
            if self.follower_pivot is not None:
                along = along + f**2 * dot(n, point - self.follower_pivot)
            return along / dot(n, self._follower_velocity)

    def _curving(self, h: Real) -> Real:
        """Contribution of the curvatures along the normal: r1 + h^2 r2 - (r1 + r2) k^2, k the first coefficient of the
        bar.

        r1, r2 the radii, s the sliding, h the follower's first coefficient: (r1 + r2) k = s + r1 + h r2. As a radius
        goes to infinity: r1 (1 - h)^2 - 2 h s for a straight follower, r2 (1 - h)^2 - 2 s for a straight driver.
        """
        r1, r2, s = np.asarray(self.driver_radius), np.asarray(self.follower_radius), self.sliding
        both = r1 + h**2 * r2 - (s + r1 + h * r2) ** 2 / (r1 + r2)
        straight_follower = r1 * (1 - h) ** 2 - 2 * h * s
        straight_driver = r2 * (1 - h) ** 2 - 2 * s
        return np.where(np.isinf(r2), straight_follower, np.where(np.isinf(r1), straight_driver, both))

    @property
    def linkage(self) -> Linkage:
        """The equivalent linkage of one position, which is there at drive 0, on the branch `branch`.

        Bodies ground, driver, coupler (a bar, or a slider on the straight surface) and follower; the frames of driver
        and follower are parallel to the ground's.
        """
        for field, given in vars(self).items():
            if np.ndim(given) and field in self.__dataclass_fields__:
                raise DesignError(field, f"found {np.shape(given)} positions", "give one position", "wrong-type")
        pivot, c1, c2 = complex(self.driver_pivot), complex(self.driver_centre), complex(self.follower_centre)
        ground, driver = {"driver_pivot": pivot}, {"driver_pivot": 0j}
        coupler: dict[str, complex] = {}
        follower: dict[str, complex] = {}
        sliders, home = [], self._home
        if self.follower_pivot is not None:
            ground["follower_pivot"], follower["follower_pivot"] = home, 0j
        along = float(np.degrees(np.angle(1j * self._normal)))
        start = c1 if np.isfinite(c1) else c2
        if np.isfinite(c1):
            driver["driver_centre"], coupler["driver_centre"] = c1 - pivot, c1 - start
        else:
            sliders.append(Slider("contact", "coupler", "driver", through=c2 - pivot, direction_deg=along))
        if np.isfinite(c2):
            follower["follower_centre"], coupler["follower_centre"] = c2 - home, c2 - start
        else:
            sliders.append(Slider("contact", "coupler", "follower", through=c1 - home, direction_deg=along))
        if self.follower_direction is not None:
            direction = float(np.degrees(np.angle(self.follower_direction)))
            sliders.append(
                Slider("guide", "follower", "ground", through=home, direction_deg=direction, angle_deg=-direction)
            )
        bodies = {"ground": ground, "driver": driver, "coupler": coupler, "follower": follower}
        return Linkage(bodies, "driver", tuple(sliders))

    @property
    def branch(self) -> Literal[1, -1]:
        """The branch of `linkage` that is the given position; +1 if both are."""

        def distance(branch: Literal[1, -1]) -> float:
            follower = move(self.linkage, [0.0], branch).bodies["follower"]
            moved = follower.point(complex(self.point) - self._home).position[0] - complex(self.point)
            away = abs(moved) + abs(follower.origin.position[0] - self._home)
            return float(away) if np.isfinite(away) else np.inf

        return 1 if distance(1) <= distance(-1) else -1

    @property
    def _home(self) -> complex:
        """The follower's origin: its pivot, or the contact."""
        return complex(self.point if self.follower_pivot is None else self.follower_pivot)

    @cached_property
    def _normal(self) -> Complex:
        return unit(self.normal)

    @property
    def _driver_velocity(self) -> Complex:
        """Velocity of the driver's point of contact, mm per rad of the driver."""
        return 1j * (np.asarray(self.point) - self.driver_pivot)

    @property
    def _follower_velocity(self) -> Complex:
        """Velocity of the follower's point of contact, mm per rad or mm of the follower."""
        if self.follower_direction is not None:
            return unit(self.follower_direction)
        arm: Complex = np.asarray(self.point) - np.asarray(self.follower_pivot)
        return 1j * arm
