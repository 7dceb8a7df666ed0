"""Motion of a linkage over its frames, and its table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from functools import cached_property

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError, shown
from ..core.fields import clipped, moving_picture, short
from ..core.records import record
from ..model.table import Column, Table, finite, xy_columns
from ..plane.vec import Array, Complex, Mask, Real, Whole, dot
from .joints.slide import AbstractSlide
from .linkage import AbstractLinkage, Linkage
from .sensitivity import Sensitivities
from .solve.placement import Timing
from .solve.solution import Body, LinkageSolution, PointMotion, SlideMotion

# Threshold that separates rotation from rounding noise in a body that only translates (rotation x size / displacement).
TRANSLATING = 1e-9
# Share of the linkage's motion below which a rate counts as rounding, and a quotient by it is infinite. It is far above
# the last bits, in which processors differ, so that all give the same columns, and far below what a drawing shows.
ROUNDING = 1e-12


@record(eq=False)
class Motion:
    """Motion of a linkage over its frames, as returned by `move`.

    All arrays have the shape (frames,), or (frames, linkages) if the linkage's sizes are arrays. Where the linkage
    cannot be assembled they are nan, and `assembled` is False.

    A body is reached as `motion["coupler"]`, as `motion.bodies["coupler"]` or, if its name is a Python name, as
    `motion.coupler`; a point as `motion.point("coupler_point")`; a sliding joint as `motion.slide("slide")`.

    Parameters
    ----------
    linkage : Linkage
        The general linkage that moved.
    drive : array
        Angle of the driver, rad, or displacement, mm.
    timing : Timing
        Speed and acceleration of the driver.
    solution : LinkageSolution
        The solved positions.
    given : Linkage or any named linkage
        The linkage as it was passed to `move`; `sensitivity` differentiates by its sizes.

    Examples
    --------
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), [0.0, 1.0], speed=10.0)
    >>> motion["rocker"].omega.round(4)
    array([-4.2857,  2.1951])
    >>> motion.point("rocker_pin").position.round(3)
    array([87.857+68.939j, 94.419+69.777j])
    """

    linkage: Linkage
    drive: Real
    timing: Timing
    solution: LinkageSolution
    given: AbstractLinkage = field(repr=False)
    # Cache of named points: a table, a scene and checks use the same ones.
    _points: dict[str, PointMotion] = field(init=False, repr=False, default_factory=dict)

    _repr_html_ = moving_picture

    def __repr__(self) -> str:
        driver, bodies = short(self.linkage.driver), short(self.linkage.bodies)
        return clipped(f"Motion(drive={short(self.drive)}, driver={driver}, bodies={bodies})")

    def __dir__(self) -> list[str]:
        """The attributes of the class and the names of the bodies."""
        return [*super().__dir__(), *self.linkage.bodies]

    @property
    def assembled(self) -> Mask:
        """Whether the linkage can be assembled at each frame, bool; all other results are nan at the other frames."""
        return self.solution.assembled

    @property
    def branches(self) -> Mapping[str, Whole]:
        """Branch of each dyad by its inner joint: +1 or -1, 0 where open or where both branches meet."""
        return self.solution.branches

    @property
    def transmission_angle(self) -> Real:
        """Acute angle between coupler and rocker at their pin, rad: pi/2 at best, 0 at a dead centre.

        For other dyads, and for loops solved together: the angle between the two directions in which the members let
        their joint move. The smallest angle is reported; nan if the driver drives nothing else.

        Notes
        -----
        Alt, 1932.
        """
        return self.solution.transmission_angle

    @property
    def error_amplification(self) -> Real:
        """Largest displacement of any joint per unit error of a length or of the drive.

        It is 1/sin of the transmission angle: inf at a limit, nan if there is no such angle. Near a limit the relative
        error of velocities and accelerations grows with its square. Rounding of sizes and drive to doubles, 1.1e-16 of
        the largest length, displaces the joints by so many times as much, and turns a body by that over its length. It
        does not cover one case: if the pins of two bodies that slide on each other nearly meet, the error of their
        direction is their size over the slide's displacement.

        Notes
        -----
        Derived here.
        """
        sine = np.sin(self.transmission_angle)
        with np.errstate(divide="ignore"):
            return 1 / np.where(is_rounding(sine, 1.0), 0.0, sine)

    @cached_property
    def residual(self) -> Real:
        """Closure error, mm: the largest distance between points that a joint keeps together, or stretch of a body."""
        largest = np.zeros(self.assembled.shape)
        for name, points in self.linkage.bodies.items():
            stretch = np.abs(np.abs(self.bodies[name].direction) - 1)
            for place in points.values():
                largest = np.maximum(largest, stretch * np.abs(place))
        for joint in self.linkage.joints:
            largest = np.maximum(largest, joint.gap(self))
        return largest

    @cached_property
    def bodies(self) -> Mapping[str, Body]:
        """All bodies by name, the ground first."""
        return {name: Body(name, self.solution) for name in self.linkage.bodies}

    def __getattr__(self, name: str) -> Body:
        # An object that is being unpickled has no fields yet.
        bodies = self.bodies if self.__dict__.get("linkage") else {}
        if name in bodies:
            return bodies[name]
        raise AttributeError(f"no body named {name!r}; there are {', '.join(bodies) or 'none'}")

    def __getitem__(self, name: str) -> Body:
        """The body with this name."""
        if name in self.bodies:
            return self.bodies[name]
        problem = f"found {shown(name)}, which is not the name of a body"
        raise DesignError("name", problem, f"give one of {', '.join(self.bodies)}", "unknown-key")

    @checked
    def point(self, name: str) -> PointMotion:
        """Motion of a point that the linkage names.

        Parameters
        ----------
        name : str
            Name of the point. A pin is returned as a point of the first body that it joins.

        Returns
        -------
        PointMotion

        Raises
        ------
        DesignError
            If the linkage has no such point; lists the names.
        """
        if name in self._points:
            return self._points[name]
        for body, points in self.linkage.bodies.items():
            if name in points:
                self._points[name] = PointMotion(self.bodies[body], points[name], name)
                return self._points[name]
        named = dict.fromkeys(p for points in self.linkage.bodies.values() for p in points)
        problem = f"found {shown(name)}, which is not the name of a point"
        raise DesignError("name", problem, f"give one of {', '.join(named)}", "unknown-key")

    def slide(self, name: str) -> SlideMotion:
        """Motion of a sliding joint.

        Parameters
        ----------
        name : str
            Name of the slider.

        Returns
        -------
        SlideMotion

        Raises
        ------
        DesignError
            If the linkage has no such slider; lists the names.
        """
        for slide in self.linkage.slides:
            if slide.name == name:
                return _slide(self, slide)
        sliders = ", ".join(slide.name for slide in self.linkage.slides)
        problem = f"found {shown(name)}, which is not the name of a slider"
        raise DesignError("name", problem, f"give one of {sliders or 'none'}", "unknown-key")

    @checked
    def sensitivity(self, of: str, by: str) -> Array:
        """Derivative of a quantity by a size of the linkage, exact to rounding, at a fixed position of the driver.

        Parameters
        ----------
        of : str
            A point's name, for its position as a complex number, or the id of a column of `motion_table`:
            `coupler_point_x`, `coupler_point_velocity` (complex) or `coupler_point_velocity_x`, `rocker_angle`,
            `rocker_omega`, `rocker_alpha`, `slide_displacement`, `slide_velocity`, `transmission_angle` ...
        by : str
            A size of the linkage as passed to `move`, such as `crank` or `ground_angle_deg`; of a point its coordinate,
            such as `coupler_point.x`; of a part its own size, such as `four_bar.crank`. Or any point or slider of the
            general linkage: `coupler.rocker_pin.y`, `slide.direction_deg`.

        Returns
        -------
        array, shape of the motion
            The quantity's unit per mm, or per rad if the size is an angle; angles are in rad. nan where the linkage is
            open, and at a limit of the driver or a change point, except for points of the driver itself. The
            transmission angle of loops that are solved together has no derivative here: nan.

        Raises
        ------
        DesignError
            If there is no such quantity or size; names the nearest.

        Notes
        -----
        Implicit function theorem on the conditions of the joints. At the frame with the smallest or largest value the
        result is also the derivative of that extreme value, since the extreme does not depend on the driver there.

        Examples
        --------
        >>> import geomkin as gk
        >>> motion = gk.move(gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j), [0.0, 1.0])
        >>> motion.sensitivity("coupler_point", by="crank").round(4)
        array([0.8825+0.0165j, 0.9456+0.6229j])
        >>> motion.sensitivity("transmission_angle", by="ground").round(5)
        array([0.01451, 0.01469])
        """
        return self._sensitivities.of(of, by)

    @cached_property
    def _sensitivities(self) -> Sensitivities:
        return Sensitivities(self.solution, self.given)

    def to_columns(self) -> dict[str, Real]:
        """The columns of `motion_table` as arrays, for a data frame.

        Returns
        -------
        dict of str to array
            Column header with unit, such as `rocker_omega_rad_per_s`, to values of shape (frames,).

        Raises
        ------
        DesignError
            If the motion is of arrays of linkages.
        """
        return {column.header: column.values for column in motion_table(self).columns}


def _slide(motion: Motion, slider: AbstractSlide) -> SlideMotion:
    guide, line = motion.bodies[slider.along], slider.line(motion)
    start, point = guide.point(slider.through), motion.bodies[slider.body].point(slider.point)
    apart = np.conj(line) * (point.position - start.position)
    # Relative to the rotating line the point only slides along it: the other terms are the line's rotation.
    first = dot(line, point.first - start.first) + guide.first * apart.imag
    second = dot(line, point.second - start.second) + guide.first**2 * apart.real + guide.second * apart.imag
    velocity, acceleration = motion.timing.rate(first), motion.timing.second_rate(first, second)
    return SlideMotion(apart.real, velocity, acceleration, 2j * guide.omega * velocity * line, first, second)


@checked
def mechanical_advantage(motion: Motion, output: str) -> Real:
    """Output torque or force per unit of input torque or force.

    Parameters
    ----------
    motion : Motion
        Motion of the linkage.
    output : str
        The output body.

    Returns
    -------
    array, shape of the motion
        For a body that turns: its torque per unit of the driver's torque or force. For a body that slides on the
        ground: its force along the line, per N mm if the driver turns. Negative if it acts against the driver's sense.
        For any other body that translates, such as a platform on two cranks: the force along the path of its points,
        positive. inf where the output is momentarily at rest, within rounding (a dead centre of the output), 0 where
        the driver is.

    Raises
    ------
    DesignError
        If `output` is not a moving body of the linkage.

    Notes
    -----
    Derived here, from virtual work without friction.
    """
    if output not in motion.bodies or output == motion.linkage.ground:
        raise DesignError(
            "output", f"found {output!r}", f"give one of {', '.join(list(motion.bodies)[1:])}", "unknown-key"
        )
    body = motion.bodies[output]
    ground_sliders = [s for s in motion.linkage.sliders if {s.body, s.along} == {output, motion.linkage.ground}]
    if ground_sliders:
        slider = ground_sliders[0]
        line = motion.bodies[slider.along].direction * (
            slider.direction if slider.body == output else -slider.direction
        )
        along = dot(line, body.origin.first)
    else:
        along = np.abs(body.origin.first)
    translating = is_translating(motion, output)
    coefficient = np.where(translating, along, body.first)
    at_rest = is_rounding(np.where(translating, along, body.first * motion.linkage.size), fastest(motion))
    with np.errstate(divide="ignore"):
        advantage: Real = 1 / np.where(at_rest, 0.0, coefficient)
    return advantage


def is_rounding(rate: Real | Complex, scale: Real | float) -> Mask:
    """Whether a rate is only rounding compared with a scale of its unit, so that its exact value may be 0."""
    return np.isfinite(scale) & (np.abs(rate) <= ROUNDING * scale)


def fastest(motion: Motion) -> Real:
    """Largest finite first coefficient of any point of the linkage at each frame, mm per unit of drive."""
    size = motion.linkage.size
    with np.errstate(invalid="ignore"):  # rates are infinite at a dead centre of the driver
        speeds = [np.abs(body.origin.first) + np.abs(body.first) * size for body in motion.bodies.values()]
    largest: Real = np.fmax.reduce([np.where(np.isfinite(speed), speed, 0.0) for speed in speeds])
    return largest


def is_translating(motion: Motion, body: str) -> Mask:
    """Whether a body only translates over all frames, apart from rounding; bool, shape () or (linkages,)."""
    moving = motion.bodies[body]
    # Second coefficients too, so that a body does not count as translating because all frames are its dead centres.
    rotation, displacement = (
        np.max([np.abs(np.where(np.isfinite(rate), rate, 0.0)).max(axis=0, initial=0.0) for rate in rates], axis=0)
        for rates in ((moving.first, moving.second), (moving.origin.first, moving.origin.second))
    )
    size = np.where(motion.linkage.size > 0, motion.linkage.size, 1.0)
    translating: Mask = rotation * size <= TRANSLATING * displacement
    return translating


@checked
def motion_table(motion: Motion, coefficients: bool = False) -> Table:
    """Table of the motion: driver, time, bodies that turn, slides, transmission angle, and points that are not pins.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    coefficients : bool
        Whether to add first and second kinematic coefficients, which do not depend on the speed: derivatives by the
        driver's angle in rad, or by its displacement in mm if a slider drives.

    Returns
    -------
    Table
        Angles in deg, without jumps by a turn. Times from the first frame; nan if the speed is 0 or not constant.
        A quantity that is only rounding has no column.

    Raises
    ------
    DesignError
        If the motion is of arrays of linkages.
    """
    linkage = motion.linkage
    if linkage.is_batch:
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time", "wrong-type")
    ground, driver = linkage.ground, linkage.driver
    if linkage.driven_slider:
        drive = Column(f"{driver}_place", "mm", f"displacement of the {driver} along its line", motion.drive)
    else:
        drive = Column(
            f"{driver}_angle", "deg", f"angle of the {driver} from the ground line", np.degrees(motion.drive)
        )
    columns = [
        drive,
        Column("time", "s", "time at the recipe's speed", motion.timing.elapsed(motion.drive)),
        *_bodies(motion),
        *(column for joint in linkage.joints for column in joint.columns(motion)),
        Column(
            "transmission_angle",
            "deg",
            "smallest transmission angle of all dyads",
            np.degrees(motion.transmission_angle),
        ),
        *_outputs(motion),
        *(Column(f"{joint}_branch", "", f"branch of {joint}, 0 if open", b) for joint, b in motion.branches.items()),
    ]
    for body, points in linkage.bodies.items():
        for point in points:
            if body != ground and point not in linkage.joint_points:
                columns += _point(motion, point)
    return Table((*columns, *_coefficients(motion))) if coefficients else Table(tuple(columns))


def _turning(motion: Motion) -> Iterator[tuple[str, Body]]:
    """Bodies that turn by more than rounding, except the driver."""
    places = [abs(complex(z)) for points in motion.linkage.bodies.values() for z in points.values()]
    size = max(places, default=0.0) or 1.0
    rates = {name: (_largest(body.first) * size, _largest(body.origin.first)) for name, body in motion.bodies.items()}
    least = ROUNDING * max(max(rotation, displacement) for rotation, displacement in rates.values())
    for name, body in motion.bodies.items():
        if name not in (motion.linkage.ground, motion.linkage.driver) and rates[name][0] > least:
            yield name, body


def _bodies(motion: Motion) -> Iterator[Column]:
    omega = np.fmax.reduce([np.abs(body.omega) for body in motion.bodies.values()])
    for name, body in _turning(motion):
        yield Column(f"{name}_angle", "deg", f"direction of the {name} from +x", unwrapped_deg(body.direction), 1.0)
        yield Column(f"{name}_omega", "rad/s", f"angular velocity of the {name}", finite(body.omega), omega)
        alpha = finite(body.alpha)
        yield Column(f"{name}_alpha", "rad/s2", f"angular acceleration of the {name}", alpha, omega**2)


def _largest(values: Real | Complex) -> float:
    """Largest finite magnitude; 0 if no value is finite."""
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


def on_ground(linkage: Linkage) -> set[str]:
    """Names of the bodies that a joint leaves one freedom on the ground."""
    joints = (joint.bodies for joint in linkage.joints if joint.freedoms == 2 and linkage.ground in joint.bodies)
    return {body for bodies in joints for body in bodies} - {linkage.ground}


def _outputs(motion: Motion) -> Iterator[Column]:
    """Mechanical advantage of every body joined to the ground, since it may drive something else."""
    linkage = motion.linkage
    for name in linkage.bodies:
        if name in on_ground(linkage) - {linkage.driver}:
            words = f"torque or force that the {name} gives for 1 of the driver's"
            # Output torque over input force is in mm, force over torque in 1/mm; otherwise it is a ratio.
            slides, driver_slides = bool(is_translating(motion, name)), linkage.driven_slider is not None
            unit = "" if slides == driver_slides else "1/mm" if slides else "mm"
            advantage = finite(mechanical_advantage(motion, name))
            yield Column(f"{name}_mechanical_advantage", unit, words, advantage)


def _point(motion: Motion, point: str) -> Iterator[Column]:
    moved, words = motion.point(point), point.replace("_", " ")
    yield from xy_columns(point, "mm", words, moved.position)
    yield from xy_columns(f"{point}_velocity", "mm/s", f"velocity of the {words}", finite(moved.velocity))
    yield from xy_columns(f"{point}_acceleration", "mm/s2", f"acceleration of the {words}", finite(moved.acceleration))


def _coefficients(motion: Motion) -> Iterator[Column]:
    """Kinematic coefficients of every angle, slide and free point, by the drive in rad or mm."""
    linkage, by = motion.linkage, "mm" if motion.linkage.driven_slider else "rad"
    orders = (("first", by), ("second", f"{by}2"))
    turning = dict(_turning(motion))
    # For a body that turns evenly, or a driven slide, the second coefficient is rounding compared with the first.
    largest = np.fmax.reduce([np.zeros(len(motion.drive)), *(np.abs(body.first) for body in turning.values())])
    scales = {"first": largest, "second": largest**2}
    for order, per in orders:
        unit = {"rad": "", "rad2": "1/rad"}.get(per, f"rad/{per}")
        for name, body in turning.items():
            words = f"{order} kinematic coefficient of the {name}'s angle"
            values = finite(getattr(body, order))
            yield Column(f"{name}_angle_{order}_coefficient", unit, words, values, scales[order])
    free = [(body, point) for body, points in linkage.bodies.items() for point in points]
    for order, per in orders:
        unit = {"mm": "", "mm2": "1/mm"}.get(per, f"mm/{per}")
        for joint in linkage.joints:
            yield from joint.coefficients(motion, order, unit)
        for point in (point for body, point in free if body != linkage.ground and point not in linkage.joint_points):
            words = f"{order} kinematic coefficient of the {point.replace('_', ' ')}"
            values = finite(getattr(motion.point(point), order))
            yield from xy_columns(f"{point}_{order}_coefficient", unit, words, values)


def unwrapped_deg(direction: Complex) -> Real:
    """Angles of directions in deg, without jumps by a turn; nan stays nan."""
    angle, known = np.angle(direction), np.isfinite(direction)
    angle[known] = np.unwrap(angle[known])
    return np.degrees(angle)
