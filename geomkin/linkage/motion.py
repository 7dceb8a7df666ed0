"""Motion of one body, one point and one slide of a linkage, as arrays over frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from functools import cached_property

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError, shown
from ..core.records import record
from ..core.reprs import clipped, moving, short
from ..model.table import Column, Table, finite, xy_columns
from ..plane.vec import Complex, Mask, Real, Whole, cross, dot
from .linkage import Linkage, Slider
from .solve.formulas import LazyEvaluation, Timing, first_of, second_of
from .solve.solution import LinkageSolution


@record(eq=False)
class PointMotion:
    """A point of a body over the frames; all (frames,) complex, nan where the linkage is open."""

    body: Body
    local: complex | Complex
    # Of a point that the linkage names.
    _name: str = field(default="", repr=False)

    def __repr__(self) -> str:
        return f"PointMotion(body={short(self.body.name)}, local={short(self.local)})"

    @cached_property
    def _worked(self) -> LazyEvaluation | None:
        return self.body.solution.worked_at(self.body.name, self.local)

    def _told(self, what: str) -> Complex | None:
        """By formulas; None where there are none."""
        body, solution = self.body.name, self.body.solution
        if self._name:
            return None if solution.worked is None else solution.told((what, body, self._name), body)
        if self._worked is None:
            return None
        told: Complex = self._worked.value((what, body), body)
        return solution.over_frames(body, told)

    @property
    def _arm(self) -> Complex:
        return self.body.direction * self.local

    @cached_property
    def position(self) -> Complex:
        """mm."""
        told = self._told("position")
        if told is not None:
            return told
        return self._arm + self.body.solution.origin(self.body.name, 0)

    @cached_property
    def first(self) -> Complex:
        """First kinematic coefficient: dP/dq, mm per unit of drive."""
        told = self._told("first")
        if told is not None:
            return told
        with np.errstate(invalid="ignore"):  # rates are not finite at a dead centre of the driver
            return first_of(self._arm, self.body.first, self.body.solution.origin(self.body.name, 1))

    @cached_property
    def second(self) -> Complex:
        """Second kinematic coefficient: d2P/dq2, mm per unit of drive squared."""
        told = self._told("second")
        if told is not None:
            return told
        with np.errstate(invalid="ignore"):
            origin = self.body.solution.origin(self.body.name, 2)
            return second_of(self._arm, self.body.first, self.body.second, origin)

    @cached_property
    def velocity(self) -> Complex:
        """mm/s."""
        told = self._told("velocity")
        if told is not None:
            return told
        return self.body.timing.rate(self.first)

    @cached_property
    def acceleration(self) -> Complex:
        """mm/s2."""
        told = self._told("acceleration")
        if told is not None:
            return told
        second = self.second  # first of all, so that the lower orders come with it
        return self.body.timing.gain(self.first, second)


@record(eq=False)
class Body:
    """A rigid body over the frames; all (frames,), angles counterclockwise, nan where the linkage is open."""

    name: str
    solution: LinkageSolution = field(repr=False)

    @property
    def timing(self) -> Timing:
        """Of the driver."""
        return self.solution.timing

    @property
    def direction(self) -> Complex:
        """The body's x axis, unit complex."""
        return self.solution.told("direction", self.name)

    @property
    def first(self) -> Real:
        """First kinematic coefficient: d(angle)/dq, rad per unit of drive."""
        return self.solution.told("first", self.name)

    @property
    def second(self) -> Real:
        """Second kinematic coefficient: d2(angle)/dq2, rad per unit of drive squared."""
        return self.solution.told("second", self.name)

    @property
    def omega(self) -> Real:
        """Angular velocity, rad/s."""
        return self.solution.told("omega", self.name)

    @property
    def alpha(self) -> Real:
        """Angular acceleration, rad/s2."""
        return self.solution.told("alpha", self.name)

    @cached_property
    def origin(self) -> PointMotion:
        """Motion of the body's own origin."""
        return self.point(0j)

    def point(self, local: complex | Complex) -> PointMotion:
        """Motion of the body's own point `local`, mm in the body's frame."""
        return PointMotion(self, local)


@record(eq=False)
class SlideMotion:
    """How a sliding joint slides; all (frames,), positive along the line's direction.

    displacement mm from the line's own point `through`; velocity mm/s and acceleration mm/s2 of the
    sliding alone; coriolis mm/s2, complex: 2 omega v at right angles to the line, omega that of the guide. first and
    second: kinematic coefficients, mm per unit of drive and per its square.
    """

    displacement: Real
    velocity: Real
    acceleration: Real
    coriolis: Complex
    first: Real
    second: Real


# Turning over the linkage's size as a share of sliding: what is less is rounding of a body that only slides, what
# is more a body that turns.
STILL = 1e-9
# Share of the linkage's motion below which a turning is rounding: far above the last bits that processors differ by, so
# that all give the same columns, and far below what any drawing tells.
ROUNDING = 1e-12


@record(eq=False)
class Motion:
    """What a linkage does over its frames: `motion.coupler.direction`, `motion.point("coupler_point")`.

    linkage: the general linkage that moved. drive: the driver's angle, rad, or displacement, mm.
    bodies: by name, also as attributes. All arrays (frames,), or (frames, linkages) where sizes are arrays.
    """

    linkage: Linkage
    drive: Real
    timing: Timing
    solution: LinkageSolution
    # Named points that were asked for, with what is known of them: a table, a scene and checks ask anew.
    _points: dict[str, PointMotion] = field(init=False, repr=False, default_factory=dict)

    _repr_html_ = moving

    def __repr__(self) -> str:
        driver, bodies = short(self.linkage.driver), short(self.linkage.bodies)
        return clipped(f"Motion(drive={short(self.drive)}, driver={driver}, bodies={bodies})")

    def __dir__(self) -> list[str]:
        """Its own names, and those of the bodies."""
        return [*super().__dir__(), *self.linkage.bodies]

    @property
    def assembled(self) -> Mask:
        """Whether the linkage reaches the pose, bool; everything else is nan where it does not."""
        return self.solution.assembled

    @property
    def branches(self) -> Mapping[str, Whole]:
        """For each dyad, by its inner joint: +1 or -1, 0 where open or where both branches meet."""
        return self.solution.branches

    @property
    def transmission_angle(self) -> Real:
        """Acute angle between coupler and rocker at their pin, rad: pi/2 at best, 0 at a dead centre (Alt, 1932).

        Of other dyads, and of loops that are solved together, the angle between the ways in which their two members
        let a joint move; the least of all. nan where the driver drives nothing else.
        """
        return self.solution.transmission_angle

    @property
    def error_amplification(self) -> Real:
        """How many times an error of sizes or drive is seen in the place of the joint that stands worst.

        1/sin of the transmission angle: inf at a limit, nan where there is none. Of velocities and accelerations near a
        limit it is the square, as a share of themselves. It does not tell that of two bodies that slide on each other
        the direction is uncertain where their pins nearly meet: by their sizes over the slide's displacement. Derived
        here.
        """
        with np.errstate(divide="ignore"):
            return 1 / np.sin(self.transmission_angle)

    @cached_property
    def residual(self) -> Real:
        """How far the loops are from closing, mm: the largest distance between points that a joint keeps together."""
        far = np.zeros(self.assembled.shape)
        for pin, bodies in self.linkage.pins.items():
            places = [self.bodies[b].point(self.linkage.bodies[b][pin]).position for b in bodies]
            for other in places[1:]:
                far = np.maximum(far, np.abs(other - places[0]))
        for s in self.linkage.sliders:
            guide, body = self.bodies[s.along], self.bodies[s.body]
            apart = body.point(s.point).position - guide.point(s.through).position
            far = np.maximum(far, np.abs(cross(guide.direction * s.direction, apart)))
        return far

    @cached_property
    def bodies(self) -> Mapping[str, Body]:
        """The bodies by name, the ground first."""
        return {name: Body(name, self.solution) for name in self.linkage.bodies}

    def __getattr__(self, name: str) -> Body:
        # While a copy is being unpickled nothing is there yet.
        bodies = self.bodies if self.__dict__.get("linkage") else {}
        if name in bodies:
            return bodies[name]
        raise AttributeError(f"no body named {name!r}; there are {', '.join(bodies) or 'none'}")

    @checked
    def point(self, name: str) -> PointMotion:
        """Motion of a named point; of a pin, as a point of the first body it joins."""
        if name in self._points:
            return self._points[name]
        for body, points in self.linkage.bodies.items():
            if name in points:
                self._points[name] = PointMotion(self.bodies[body], points[name], name)
                return self._points[name]
        named = dict.fromkeys(p for points in self.linkage.bodies.values() for p in points)
        raise DesignError("name", f"found {shown(name)}, which is no point", f"give one of {', '.join(named)}")

    def slide(self, name: str) -> SlideMotion:
        """Motion of a sliding joint."""
        for slider in self.linkage.sliders:
            if slider.name == name:
                return _slide(self, slider)
        sliders = ", ".join(slider.name for slider in self.linkage.sliders)
        raise DesignError("name", f"found {shown(name)}, which is no slider", f"give one of {sliders or 'none'}")

    def to_columns(self) -> dict[str, Real]:
        """The columns of `motion_table`, (frames,), by name and unit, `rocker_omega_rad_per_s`: feeds any data frame.

        DesignError for arrays of linkages: take one.
        """
        return {column.header: column.values for column in motion_table(self).columns}


def _slide(motion: Motion, slider: Slider) -> SlideMotion:
    guide = motion.bodies[slider.along]
    line = guide.direction * slider.direction
    start, point = guide.point(slider.through), motion.bodies[slider.body].point(slider.point)
    apart = np.conj(line) * (point.position - start.position)
    # Seen from the turning line the point only slides along it: the rest is the line's own turning.
    first = dot(line, point.first - start.first) + guide.first * apart.imag
    second = dot(line, point.second - start.second) + guide.first**2 * apart.real + guide.second * apart.imag
    velocity, acceleration = motion.timing.rate(first), motion.timing.gain(first, second)
    return SlideMotion(apart.real, velocity, acceleration, 2j * guide.omega * velocity * line, first, second)


@checked
def mechanical_advantage(motion: Motion, output: str) -> Real:
    """Output torque or force over input torque or force, by the power that both have: dq over the output's own way.

    Of a turning body the torque it gives for 1 of the driver's; of one that only slides on the ground the force along
    its line, per mm where the driver turns. Signed: negative where it works against the driver's sense. Of any other
    body that moves without turning, such as a platform on two cranks, the force along the path of its points, which is
    the same for all: positive, since a path has no sense but the motion's. inf where the output stands still (a dead
    centre of the output), 0 where the driver does. Derived here, from virtual work without friction.
    """
    if output not in motion.bodies or output == motion.linkage.ground:
        raise DesignError("output", f"found {output!r}", f"give one of {', '.join(list(motion.bodies)[1:])}")
    body = motion.bodies[output]
    lines = [s for s in motion.linkage.sliders if {s.body, s.along} == {output, motion.linkage.ground}]
    if lines:
        slider = lines[0]
        line = motion.bodies[slider.along].direction * (
            slider.direction if slider.body == output else -slider.direction
        )
        along = dot(line, body.origin.first)
    else:
        along = np.abs(body.origin.first)
    way = np.where(is_translating(motion, output), along, body.first)
    with np.errstate(divide="ignore"):
        advantage: Real = 1 / way
    return advantage


def is_translating(motion: Motion, body: str) -> Mask:
    """Whether all that a body turns over the frames is rounding of its going along, bool, () or (linkages,)."""
    moving = motion.bodies[body]
    turning, going = (
        np.abs(np.nan_to_num(rate, nan=0.0, posinf=0.0, neginf=0.0)).max(axis=0, initial=0.0)
        for rate in (moving.first, moving.origin.first)
    )
    size = np.where(motion.linkage.size > 0, motion.linkage.size, 1.0)
    still: Mask = turning * size <= STILL * going
    return still


@checked
def motion_table(motion: Motion, coefficients: bool = False) -> Table:
    """Driver, time, every body that turns, every slide, transmission angle, and the points that are no pins.

    Angles in deg, without jumps by a turn; times from the first frame, nan where the speed is none or not constant.
    coefficients: whether first and second kinematic coefficients of all these are told too, which no speed changes:
    derivatives by the driver's angle in rad, or by its place in mm where a slide drives. What is nothing but rounding
    has no column. DesignError for arrays of linkages: take one.
    """
    linkage = motion.linkage
    if linkage.is_batch:
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time")
    ground, driver = linkage.ground, linkage.driver
    if linkage.driven_slider:
        drive = Column(f"{driver}_place", "mm", f"place of the {driver} along its line", motion.drive)
    else:
        drive = Column(
            f"{driver}_angle", "deg", f"angle of the {driver} from the ground line", np.degrees(motion.drive)
        )
    columns = [
        drive,
        Column("time", "s", "time at the recipe's speed", motion.timing.elapsed(motion.drive)),
        *_bodies(motion),
        *_slides(motion),
        Column("transmission_angle", "deg", "least over the dyads", np.degrees(motion.transmission_angle)),
        *_outputs(motion),
        *(Column(f"{joint}_branch", "", f"branch of {joint}, 0 for none", b) for joint, b in motion.branches.items()),
    ]
    for body, points in linkage.bodies.items():
        for point in points:
            if body != ground and point not in linkage.pins:
                columns += _point(motion, point)
    return Table((*columns, *_coefficients(motion))) if coefficients else Table(tuple(columns))


def _turning(motion: Motion) -> Iterator[tuple[str, Body]]:
    """Bodies that turn, but for the driver: what less than rounding turns does not."""
    places = [abs(complex(z)) for points in motion.linkage.bodies.values() for z in points.values()]
    reach = max(places, default=0.0) or 1.0
    sizes = {name: (_largest(body.first) * reach, _largest(body.origin.first)) for name, body in motion.bodies.items()}
    least = ROUNDING * max(max(turn, way) for turn, way in sizes.values())
    for name, body in motion.bodies.items():
        if name not in (motion.linkage.ground, motion.linkage.driver) and sizes[name][0] > least:
            yield name, body


def _bodies(motion: Motion) -> Iterator[Column]:
    omega = np.fmax.reduce([np.abs(body.omega) for body in motion.bodies.values()])
    for name, body in _turning(motion):
        yield Column(f"{name}_angle", "deg", f"direction of the {name} from +x", unwrapped_deg(body.direction), 1.0)
        yield Column(f"{name}_omega", "rad/s", f"angular velocity of the {name}", finite(body.omega), omega)
        alpha = finite(body.alpha)
        yield Column(f"{name}_alpha", "rad/s2", f"angular acceleration of the {name}", alpha, omega**2)


def _slides(motion: Motion) -> Iterator[Column]:
    for slider in motion.linkage.sliders:
        slide, name = motion.slide(slider.name), slider.name
        velocity, acceleration = finite(slide.velocity), finite(slide.acceleration)
        # Along its own guide the driver slides as it is told to, and what else is found is rounding.
        speed = np.abs(motion.bodies[slider.body].origin.velocity)
        pull = np.abs(motion.bodies[slider.body].origin.acceleration)
        yield Column(f"{name}_displacement", "mm", f"place on the line of {name}", slide.displacement)
        yield Column(f"{name}_velocity", "mm/s", f"sliding velocity of {name}", velocity, speed)
        yield Column(f"{name}_acceleration", "mm/s2", f"sliding acceleration of {name}", acceleration, pull)
        if _largest(slide.coriolis) > ROUNDING * max(_largest(pull), _largest(acceleration)):
            yield from xy_columns(
                f"{name}_coriolis", "mm/s2", f"Coriolis acceleration of {name}", finite(slide.coriolis)
            )


def _largest(values: Real | Complex) -> float:
    """Largest finite magnitude; 0 where there is none."""
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


def on_ground(linkage: Linkage) -> set[str]:
    """Bodies that a pin or a slider joins to the ground."""
    held = {b for bodies in linkage.pins.values() if linkage.ground in bodies for b in bodies}
    held |= {b for s in linkage.sliders if linkage.ground in (s.body, s.along) for b in (s.body, s.along)}
    return held - {linkage.ground}


def _outputs(motion: Motion) -> Iterator[Column]:
    """Mechanical advantage of every body that the ground holds: what may drive something else."""
    linkage = motion.linkage
    for name in linkage.bodies:
        if name in on_ground(linkage) - {linkage.driver}:
            words = f"torque or force that the {name} gives for 1 of the driver's"
            # Torque for force is in mm, force for torque in 1/mm, like for like a plain ratio.
            slides, driver_slides = bool(is_translating(motion, name)), linkage.driven_slider is not None
            unit = "" if slides == driver_slides else "1/mm" if slides else "mm"
            advantage = finite(mechanical_advantage(motion, name))
            yield Column(f"{name}_mechanical_advantage", unit, words, advantage)


def _point(motion: Motion, point: str) -> Iterator[Column]:
    track, words = motion.point(point), point.replace("_", " ")
    yield from xy_columns(point, "mm", words, track.position)
    yield from xy_columns(f"{point}_velocity", "mm/s", f"velocity of the {words}", finite(track.velocity))
    yield from xy_columns(f"{point}_acceleration", "mm/s2", f"acceleration of the {words}", finite(track.acceleration))


def _coefficients(motion: Motion) -> Iterator[Column]:
    """Of every angle, slide and free point, by the driver's angle in rad or its place in mm."""
    linkage, by = motion.linkage, "mm" if motion.linkage.driven_slider else "rad"
    orders = (("first", by), ("second", f"{by}2"))
    turning = dict(_turning(motion))
    # Of a body that turns evenly, or of a slide that is driven, the second coefficient is rounding beside the first.
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
        for slider in linkage.sliders:
            words = f"{order} kinematic coefficient of {slider.name}"
            scale = np.abs(getattr(motion.bodies[slider.body].origin, order))
            values = finite(getattr(motion.slide(slider.name), order))
            yield Column(f"{slider.name}_displacement_{order}_coefficient", unit, words, values, scale)
        for point in (point for body, point in free if body != linkage.ground and point not in linkage.pins):
            words = f"{order} kinematic coefficient of the {point.replace('_', ' ')}"
            values = finite(getattr(motion.point(point), order))
            yield from xy_columns(f"{point}_{order}_coefficient", unit, words, values)


def unwrapped_deg(direction: Complex) -> Real:
    """Angles without jumps by a turn, nan kept."""
    angle, known = np.angle(direction), np.isfinite(direction)
    angle[known] = np.unwrap(angle[known])
    return np.degrees(angle)
