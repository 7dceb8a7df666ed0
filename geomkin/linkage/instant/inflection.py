"""The inflection circle of a body, and Bobillier's constructions.

Points of a body on its inflection circle pass an inflection of their path. Bobillier's theorem gives the centrode
tangent from two cranks, and one crank from the tangent and the other: the angle from the tangent to one crank equals
the angle from the other crank to the collineation axis, the line from the instant centre to the intersection of coupler
and frame lines. With parallel cranks, whose instant centre is at infinity, tangent and axis are parallel to them and
the theorem is about distances instead of angles.

In the constructions points and lines are homogeneous, (..., 3), about the first pin: a point (x, y, 1) or, at infinity,
(x, y, 0); a line (l, m, n) with l x + m y + n = 0. The line through two points and the point on two lines are both
their vector product, at infinity too.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import ComplexOrNan, checked
from ...core.errors import DesignError
from ...core.records import record
from ...plane.vec import Complex, Real, as_unit, cross, dot, known, unit
from ..motion import Motion
from .centres import InstantCentre, zero_at_infinity
from .curvature import PathCurvature, point_path, second_order

# Share of its terms below which a sum counts as rounding, so that a body that only translates has no inflection circle.
ROUNDING = 1e-13


@record(eq=False)
class InflectionCircle:
    """A body's motion to second order, and its inflection circle; arrays of any shape.

    If the instant centre is at infinity (parallel cranks: `angular_velocity` is 0), the circle is a straight line along
    `tangent` through `nearest`; the centre and the pole are nan and the diameter inf. If all paths have the same
    curvature there (a parallelogram), there is no circle and normal, tangent and nearest are nan too.

    Parameters
    ----------
    reference : complex or array
        Position of a point of the body, mm.
    velocity, acceleration : complex or array
        Of that point, mm per unit of time and per its square; the drive may serve as time.
    angular_velocity, angular_acceleration : float or array
        Angular velocity and acceleration of the body, in the same time.

    Notes
    -----
    The circle and its use: Dijksman, Motion Geometry of Mechanisms, 1976. That no digits are lost where it
    grows into a line is derived here.
    """

    reference: Complex
    velocity: Complex
    acceleration: Complex
    angular_velocity: Real
    angular_acceleration: Real

    # With s from the reference, V = f + i h s and A = f' + (i h' - h^2) s give, with p = h A_I,
    # V x A = c + Re(conj(k) s) + h^3 |s|^2, which is 0 on the circle, and the diameter J = p / h^3.

    @cached_property
    def _p(self) -> Complex:
        h = self.angular_velocity
        one, two, three = h * self.acceleration, -self.velocity * self.angular_acceleration, -1j * h**2 * self.velocity
        total = one + two + three
        return np.where(abs(total) <= ROUNDING * (abs(one) + abs(two) + abs(three)), 0j, total)

    @property
    def instant_centre(self) -> InstantCentre:
        """The point at which the body has no velocity: the circle passes through it."""
        return InstantCentre(self.reference, 1j * self.velocity, self.angular_velocity)

    @property
    def diameter(self) -> Real:
        """Diameter of the circle, mm; inf if it is a line, nan if there is none."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return abs(self._p) / abs(self.angular_velocity) ** 3

    @property
    def normal(self) -> Complex:
        """Centrode normal: the direction from the instant centre to the inflection pole, unit complex."""
        return unit(self._p) * np.where(self.angular_velocity < 0, -1, 1)

    @property
    def tangent(self) -> Complex:
        """Centrode tangent: the direction in which the instant centre moves, unit complex."""
        return 1j * unit(self._p)

    @property
    def centre_velocity(self) -> Complex:
        """Velocity of the instant centre along both centrodes, mm per unit of time; nan at infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return known(self.angular_velocity != 0, 1j * self._p / self.angular_velocity**2)

    @property
    def pole(self) -> Complex:
        """Inflection pole, mm: the end of the diameter from the instant centre; its acceleration is along its path."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.instant_centre.position + self._p / self.angular_velocity**3

    @property
    def nearest(self) -> Complex:
        """The point of the circle nearest to `reference`, mm."""
        k = -(self._p + 2j * self.angular_velocity**2 * self.velocity)
        c, extent = cross(self.velocity, self.acceleration), abs(k) + abs(self._p)
        with np.errstate(divide="ignore", invalid="ignore"):
            away = np.where(extent == 0, np.nan, 2 * c / extent)
        # From the circle's centre all its points are equally near, so any direction serves.
        along: Complex = np.where(k == 0, 1, unit(k))
        return self.reference - along * away

    @property
    def tangent_foot(self) -> Complex:
        """The point of the centrode tangent nearest to `reference`, mm: with `tangent` it defines the line.

        It exists also if the instant centre, through which the line passes, is at infinity.
        """
        across: Real = cross(self.acceleration, self.velocity) + self.angular_velocity * abs(self.velocity) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.reference + 1j * self.tangent * (across / abs(self._p))

    def inflection(self, direction: ArrayLike) -> Real:
        """Signed distance from the instant centre to the circle along a ray, mm: D cos(psi) from the normal.

        Parameters
        ----------
        direction : complex or array_like
            Direction of the ray, of any length above 0.

        Returns
        -------
        array
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            return dot(self._p, as_unit(direction)) / self.angular_velocity**3

    def path(self, position: ArrayLike) -> PathCurvature:
        """Path of the body's point that is now at a position, by the Euler-Savary equation.

        Parameters
        ----------
        position : complex or array_like
            mm on the ground.

        Returns
        -------
        PathCurvature
        """
        place = np.asarray(position)
        state = self.velocity, self.acceleration, self.angular_velocity, self.angular_acceleration
        return point_path(place, place - self.reference, *state)


@checked
def inflection_circle(motion: Motion, body: str) -> InflectionCircle:
    """Inflection circle of a body's motion on the ground, with the drive as time.

    Parameters
    ----------
    motion : Motion
        Motion of the linkage.
    body : str
        Name of the body.

    Returns
    -------
    InflectionCircle
        Arrays of the motion's shape; nan where the linkage is open, at a dead centre of the driver and where the body
        reverses.

    Raises
    ------
    DesignError
        If the linkage has no such body.

    Notes
    -----
    Derived here.
    """
    if body not in motion.bodies:
        raise DesignError("body", f"found {body!r}", f"give one of {', '.join(motion.bodies)}", "unknown-key")
    return InflectionCircle(motion.bodies[body].origin.position, *second_order(motion, body))


@checked
def inflection_circle_of_cranks(one: PathCurvature, two: PathCurvature) -> InflectionCircle:
    """Inflection circle of a body from the paths of two of its points, as two cranks or sliders give them.

    Parameters
    ----------
    one, two : PathCurvature
        The two paths.

    Returns
    -------
    InflectionCircle
        The first point may move along its tangent or against it: the sense of the centrode tangent is arbitrary. nan if
        cranks and body are in line, when the motion is not determined.

    Notes
    -----
    Derived here; `bobillier` is the graphical construction.
    """
    arm = two.position - one.position
    # The body is rigid: both points have the same velocity along the line between them.
    speed = dot(two.tangent, arm), dot(one.tangent, arm)
    velocity = speed[0] * one.tangent, speed[1] * two.tangent
    angular_velocity = cross(one.tangent, two.tangent)
    # Accelerations: across the path by the curvatures; along it so that the body stays rigid, and no more.
    across = [k.curvature * v**2 * 1j * k.tangent for k, v in zip((one, two), speed)]
    lacking = dot(arm, across[0] - across[1]) - (angular_velocity * abs(arm)) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        share = lacking / (speed[0] ** 2 + speed[1] ** 2)
    along = -speed[1] * share * one.tangent, speed[0] * share * two.tangent
    first, second = across[0] + along[0], across[1] + along[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        angular_acceleration = cross(arm, second - first) / abs(arm) ** 2
    extent = abs(arm)
    return InflectionCircle(
        one.position,
        velocity[0],
        first,
        zero_at_infinity(angular_velocity, np.maximum(abs(velocity[0]), abs(velocity[1])), extent),
        zero_at_infinity(angular_acceleration, np.maximum(abs(first), abs(second)), extent),
    )


@record(eq=False)
class Bobillier:
    """Result of Bobillier's construction; arrays of any shape, directions unit complex, of either sense.

    All but the instant centre are nan if the cranks are parallel and coupler and frame too: all paths then have the
    same curvature.

    Parameters
    ----------
    instant_centre : InstantCentre
        Intersection of the cranks.
    crossing : array of complex
        Intersection of coupler and frame lines, mm; nan if parallel.
    axis, tangent : array of complex
        Directions of collineation axis and centrode tangent, both through the instant centre.
    axis_foot, tangent_foot : array of complex
        Points of these lines nearest to the first pin, mm.
    """

    instant_centre: InstantCentre
    crossing: Complex
    axis: Complex
    axis_foot: Complex
    tangent: Complex
    tangent_foot: Complex


@checked
def bobillier(one: PathCurvature, two: PathCurvature) -> Bobillier:
    """Centrode tangent of a body from the paths of two of its points, by Bobillier's theorem.

    Parameters
    ----------
    one, two : PathCurvature
        Paths of the two points, as two cranks or sliders give them.

    Returns
    -------
    Bobillier
        nan if cranks and body are in line, when the motion is not determined.

    Notes
    -----
    Bobillier's theorem: Dijksman, Motion Geometry of Mechanisms, 1976; points at infinity are derived here.
    """
    base = np.asarray(one.position)
    pins = _point(one.position - base), _point(two.position - base)
    cranks = _line(one.tangent, one.position - base), _line(two.tangent, two.position - base)
    extent = np.abs(two.position - base)
    centre = _settled(np.cross(*cranks), extent)
    crossing = _settled(np.cross(np.cross(*pins), np.cross(_centre(one, base), _centre(two, base))), extent)
    axis = np.cross(centre, crossing)
    tangent = _mirrored(axis, cranks, pins)
    return Bobillier(
        _as_centre(centre, base), _as_centre(crossing, base).position, *_as_line(axis, base), *_as_line(tangent, base)
    )


@checked
def bobillier_path(
    one: PathCurvature, tangent_foot: ComplexOrNan, tangent: ComplexOrNan, position: ComplexOrNan
) -> PathCurvature:
    """Path of a body's point from one crank and the centrode tangent, by Bobillier's theorem; any shape.

    Parameters
    ----------
    one : PathCurvature
        Path of one point of the body.
    tangent_foot : complex or array_like
        A point of the centrode tangent, mm.
    tangent : complex or array_like
        Its direction, of any length.
    position : complex or array_like
        The other point of the body, mm.

    Returns
    -------
    PathCurvature
        nan if `position` is in line with the crank, for which the Euler-Savary equation gives the answer; and if the
        tangent is along the crank, one end of which is then the instant centre: that says nothing about other points.

    Notes
    -----
    The instant centre is the intersection of tangent and crank. Source as for `bobillier`.
    """
    base = np.asarray(one.position)
    away = np.asarray(position) - base
    pins = _point(one.position - base), _point(away)
    line = _line(1j * as_unit(tangent), np.asarray(tangent_foot) - base)
    crank = _line(one.tangent, one.position - base)
    extent = np.abs(away)
    centre = _settled(_crossing(crank, line, extent), extent)
    ray: Real = np.cross(centre, pins[1])
    with np.errstate(invalid="ignore"):
        ray = ray / np.hypot(ray[..., 0], ray[..., 1])[..., None]
    ray = np.where(np.isnan(_crossing(crank, ray, extent)), np.nan, ray)
    axis = _mirrored(line, (crank, ray), pins)
    crossing = np.cross(axis, np.cross(*pins))
    end = _settled(np.cross(np.cross(crossing, _centre(one, base)), ray), extent)
    run, weight = ray[..., 0] + 1j * ray[..., 1], end[..., 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = weight / dot(1j * run, end[..., 0] + 1j * end[..., 1] - away * weight)
    return PathCurvature(base + away, run, curvature)


def _point(place: Complex, weight: ArrayLike = 1.0) -> Real:
    return np.stack(np.broadcast_arrays(place.real, place.imag, weight), axis=-1)


def _line(normal: Complex, place: Complex) -> Real:
    """The line through a point with the unit normal `normal`."""
    return _point(np.asarray(normal), -dot(normal, place))


def _centre(path: PathCurvature, base: Complex) -> Real:
    """The path's centre of curvature: at infinity if it is straight, the point itself at a cusp."""
    cusp = np.isinf(path.curvature)
    curvature, normal = np.where(cusp, 1.0, path.curvature), np.where(cusp, 0.0, 1j * np.asarray(path.tangent))
    return _point((path.position - base) * curvature + normal, curvature)


def _crossing(one: Real, two: Real, extent: Real) -> Real:
    """Intersection of two lines of unit normal; nan if they are the same line within rounding."""
    point = np.cross(one, two)
    apart = np.abs(point[..., 2]) * extent + np.hypot(point[..., 0], point[..., 1])
    return np.where((apart <= ROUNDING * extent)[..., None], np.nan, point)


def _settled(point: Real, extent: Real) -> Real:
    weight = zero_at_infinity(point[..., 2], np.hypot(point[..., 0], point[..., 1]), extent)
    return np.concatenate([point[..., :2], weight[..., None]], axis=-1)


def _mirrored(line: Real, rays: tuple[Real, Real], pins: tuple[Real, Real]) -> Real:
    """A line through the intersection of two rays, mirrored in the bisector of the rays.

    With a and b the rays, of unit normal, the mirror image of x a + y b is y a + x b; x and y follow from a point of
    each ray. So it holds for parallel rays too.
    """
    (a, b), extent = rays, np.hypot(*np.moveaxis((pins[1] - pins[0])[..., :2], -1, 0))
    on_a, on_b = _beside(a, b, pins[0], extent), _beside(b, a, pins[1], extent)
    first = (_dot(line, on_a) * _dot(a, on_b))[..., None] * a
    second = (_dot(line, on_b) * _dot(b, on_a))[..., None] * b
    # The line at infinity has the normal 0: a small difference of two equal terms is rounding.
    normal = first[..., :2] + second[..., :2]
    rounding = ROUNDING * (np.abs(first[..., :2]).max(axis=-1) + np.abs(second[..., :2]).max(axis=-1))
    normal = np.where((np.abs(normal).max(axis=-1) <= rounding)[..., None], 0.0, normal)
    return np.concatenate([normal, first[..., 2:] + second[..., 2:]], axis=-1)


def _beside(ray: Real, other: Real, pin: Real, extent: Real) -> Real:
    """A point of a ray far from the other ray: the pin, or one `extent` farther."""
    along = np.stack([-ray[..., 1], ray[..., 0], 0 * ray[..., 2]], axis=-1)
    farther = pin + extent[..., None] * along
    near = np.abs(_dot(other, pin)) < np.abs(_dot(other, farther))
    return np.where(near[..., None], farther, pin)


def _dot(line: Real, point: Real) -> Real:
    product: Real = np.sum(line * point, axis=-1)
    return product


def _as_centre(point: Real, base: Complex) -> InstantCentre:
    return InstantCentre(base, point[..., 0] + 1j * point[..., 1], point[..., 2])


def _as_line(line: Real, base: Complex) -> tuple[Complex, Complex]:
    """Direction of a line and its point nearest to `base`."""
    normal = line[..., 0] + 1j * line[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return 1j * unit(normal), base - unit(normal) * (line[..., 2] / np.abs(normal))
