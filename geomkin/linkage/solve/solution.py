"""The branch of every dyad and the poses of all bodies over the frames, only to the order requested; their motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property, reduce
from typing import Annotated

import numpy as np

from ...core.arguments import ArgumentType, checked, is_place
from ...core.fields import short
from ...core.records import record
from ...plane.vec import Array, Complex, Mask, Real, Whole, known
from ..linkage import Linkage
from .branch import BranchSpec, DriveRange, FollowedBranch, change_points
from .dyads import Crossed, Dyad, JointLines
from .input_dyads import InputDyad
from .loops import Loops
from .placement import Coefficients, Placement, Poses, RevoluteInput, Timing
from .program import Group, ProgramRun, first_of, second_of

# Gap, as a share of the linkage's extent, below which it counts as zero. True meetings come out below 2e-16 after
# chains of five dyads. A larger value takes a near miss for a meeting, a smaller one misses meetings after a dyad at
# bad angles.
ROUNDING = 1e-14


def extent_of(linkage: Linkage) -> float:
    """A length, mm, larger than the distance of any two points of the assembled linkage."""
    bodies = sum(
        max((float(np.abs(z).max()) for z in points.values()), default=0.0) for points in linkage.bodies.values()
    )
    return 2 * (
        bodies
        + sum(_distance_from_origin(slide.point) + _distance_from_origin(slide.through) for slide in linkage.slides)
    )


def repeated(values: Array, shape: tuple[int, ...]) -> Array:
    """Values at every frame; for a single value ten times faster than `broadcast_to`."""
    if values.size != 1:
        return np.broadcast_to(values, shape)
    return np.ndarray(shape, values.dtype, values.tobytes(), 0, (0,) * len(shape))


def _distance_from_origin(place: complex | Array) -> float:
    """Distance from the origin, mm; the largest of an array."""
    return float(np.abs(place).max()) if isinstance(place, np.ndarray) else abs(place)


def with_branches(
    linkage: Linkage, placements: Sequence[Placement], drive: Real, linkages: tuple[int, ...], spec: BranchSpec
) -> DriveRange:
    """The range of a motion's drives with the branch of every dyad: by sign, near given points, or followed."""
    dyads = {k: placement for k, placement in enumerate(placements) if isinstance(placement, Dyad)}
    turns = isinstance(placements[0], RevoluteInput)
    if turns and not spec.follow and not spec.branch_points:
        signs = {dyad.joint: spec.sign(dyad.joint) for dyad in dyads.values()}
        return DriveRange(linkage, placements, drive, linkages, 1.0, signs)
    extent = extent_of(linkage)
    drive_range = DriveRange(linkage, placements, drive, linkages, 1.0 if turns else extent, {})
    with np.errstate(all="ignore"):
        for k, dyad in dyads.items():
            branch = _branch(drive_range, k, dyad, spec, extent)
            drive_range = replace(drive_range, branches={**drive_range.branches, dyad.joint: branch})
    return drive_range


def _branch(before: DriveRange, k: int, dyad: Dyad, spec: BranchSpec, extent: float) -> Whole | int | FollowedBranch:
    """The branch of the k-th placement, given the branches of those before it."""
    by_points = spec.branch_points and dyad.joint not in spec.branch
    nearest = _nearest(before, k, spec.branch_points) if by_points else None
    frame, sign = nearest or (0, spec.sign(dyad.joint))
    if not spec.follow:
        return sign
    if not isinstance(dyad, InputDyad):
        return change_points(before, k, sign, before.drive[frame:], ROUNDING * extent) if before.drive.size else sign
    return dyad.sign_from(before.drive, int(sign)) if nearest is None else sign


def _nearest(before: DriveRange, k: int, points: Mapping[str, complex]) -> tuple[int, Whole] | None:
    """The first frame at which a dyad can be assembled, and the side on which its points are nearest to given ones."""
    later = (j for j, one in enumerate(before.placements) if j > k and isinstance(one, Dyad | Loops))
    end = next(later, len(before.placements))
    ground_direction = np.exp(1j * np.radians(before.linkage.ground_angle_deg))
    for frames in (before.drive[:1], before.drive):
        poses = before.poses(frames, k)
        distances = []
        for side in (1, -1):
            p = Poses(dict(poses.origin), dict(poses.direction), poses.drive, dict(poses.cache))
            for placement in before.placements[k:end]:
                placement.place(p, side)
            differences = [
                p.origin[body]
                + p.direction[body] * before.linkage.bodies[body][name]
                - (z - before.linkage.origin) / ground_direction
                for body in set(p.origin) - set(poses.origin)
                for name, z in points.items()
                if name in before.linkage.bodies[body]
            ]
            if not differences:
                return None
            distances.append(np.sum(np.abs(differences) ** 2, axis=0))
        known = np.isfinite(distances[0]) | np.isfinite(distances[1])
        share = known.reshape(len(frames), -1).mean(axis=1)
        if share.size and share.any():
            frame = int(np.argmax(share))
            return frame, np.where(distances[1][frame] < distances[0][frame], -1, 1)
    return None


@record(eq=False)
class LinkageSolution:
    """Poses of all bodies and their derivatives by the drive, each computed on first use.

    plan: finds the placements of all bodies, in order; drive: rad or mm, (frames,). run: of the linkage's program; None
    if the placements are evaluated instead. Results are (frames,) or, for arrays of linkages, (frames, linkages), and
    nan where the linkage is open.
    """

    linkage: Linkage
    plan: Callable[[], tuple[Placement, ...]]
    drive: Real
    spec: BranchSpec
    timing: Timing
    run: ProgramRun | None = None
    _values: dict[tuple[Group, str], Array] = field(init=False, repr=False, default_factory=dict)

    @cached_property
    def placements(self) -> tuple[Placement, ...]:
        """How the bodies are placed, in order."""
        return self.plan()

    @property
    def joint_lines(self) -> tuple[JointLines, ...]:
        """The members between which the transmission angles of dyads lie."""
        if self.run is not None:
            return self.run.program.joint_lines
        return tuple(placement.joint_lines for placement in self.placements if isinstance(placement, Dyad | Crossed))

    @property
    def shape(self) -> tuple[int, ...]:
        """(frames,) or (frames, linkages)."""
        return (len(self.drive), *self.linkage.shape)

    def origin(self, body: str, order: int) -> Complex:
        """Position of a body's origin, mm, or its derivative of order 1 or 2 by the drive."""
        return self.value(f"origin {order}", body)

    def value(self, group: Group, body: str) -> Array:
        """A quantity of a body over the frames; that of a moving body is nan where the linkage is open.

        group: "direction", unit complex; "first" or "second" derivative of the angle by the drive, rad; "omega" and
        "alpha", rad/s and rad/s2; "origin 0" to "origin 2", the position of the origin, mm, and its derivatives;
        "angle" of the body "", the smallest transmission angle, rad; or (quantity, body, name) of a named point, from
        the program.
        """
        key = group, body
        if key not in self._values:
            values = self._placed(str(group), body) if self.run is None else self.run.value(group, body)
            self._values[key] = values if values.shape == self._whole else self._over_frames(values, body)
        return self._values[key]

    def _placed(self, quantity: str, body: str) -> Array:
        """The same by the placements, without a program."""
        if quantity == "angle":
            angles = [placement.transmission_angle(self.poses) for placement in self.placements]
            return reduce(np.fmin, [angle for angle in angles if angle is not None], np.asarray(np.nan))
        if quantity == "omega":
            return self.timing.rate(self.value("first", body))
        if quantity == "alpha":
            return self.timing.second_rate(self.value("first", body), self.value("second", body))
        if quantity in ("first", "second"):
            return (self._first if quantity == "first" else self._second).theta_prime[body]
        place: Complex = (
            self.poses.direction if quantity == "direction"
            else self.poses.origin if quantity == "origin 0"
            else (self._first if quantity == "origin 1" else self._second).origin
        )[body]  # fmt: skip
        if self.linkage.ground_direction != 1:
            place = place * self.linkage.ground_direction
        return place + self.linkage.origin if quantity == "origin 0" and self.linkage.shifted else place

    def _over_frames(self, values: Array, body: str) -> Array:
        if self._whole is None and body != self.linkage.ground:
            values = known(self.assembled, values)
        return values if values.shape == self.shape else repeated(values, self.shape)

    @cached_property
    def assembled(self) -> Mask:
        """Whether every body can be placed."""
        if self.run is not None:
            closed = self.run.value("direction", "")
            return closed if closed.shape == self.shape else repeated(closed, self.shape)
        closed = np.ones(self.shape, dtype=bool)
        for placement in self.placements:
            reached = placement.reached(self.poses)
            if reached is not None:
                closed &= np.isfinite(reached)
        return closed

    @cached_property
    def poses(self) -> Poses:
        """Poses of all bodies in the fixed body's frame; nan from the first one on that cannot be placed."""
        return self._range.poses(self.drive)

    @cached_property
    def _first(self) -> Coefficients:
        return self._range.first(self.poses)

    @cached_property
    def _second(self) -> Coefficients:
        return self._range.second(self.poses, self._first)

    @cached_property
    def _range(self) -> DriveRange:
        return with_branches(self.linkage, self.placements, self.drive, self.shape[1:], self.spec)

    @cached_property
    def signs(self) -> Mapping[str, Whole]:
        """Sign of each dyad by its inner joint, also where the linkage is open; 0 where both branches meet."""
        signs: dict[str, Whole] = {}
        for dyad in self.placements:
            if isinstance(dyad, Dyad):
                sign = self._range.sign(dyad, self.poses)
                if isinstance(dyad, InputDyad):
                    with np.errstate(invalid="ignore"):
                        r = dyad.roots(Poses(drive=self.poses.drive), sign).r
                    sign = np.where(np.isfinite(r), np.sign(r), sign)
                signs[dyad.joint] = np.broadcast_to(sign, self.shape)
        return signs

    @cached_property
    def branches(self) -> Mapping[str, Whole]:
        """The branch of each dyad, by its inner joint: its sign, and 0 where the linkage is open."""
        return {joint: np.where(self.assembled, sign, 0).astype(int) for joint, sign in self.signs.items()}

    @property
    def transmission_angle(self) -> Real:
        """Smallest transmission angle of all joints that have one, rad; nan if none has."""
        return self.value("angle", "")

    @cached_property
    def _whole(self) -> tuple[int, ...] | None:
        """Shape of results that need no nan; None if the linkage is open at some frame."""
        closed = self.assembled
        return closed.shape if np.count_nonzero(closed) == closed.size else None


PointOrPoints = Annotated[
    complex | Complex, ArgumentType(lambda value: is_place(value, True), "a point x + yj, or an array of them")
]


@record(eq=False)
class PointMotion:
    """Motion of one point of a body; every array is (frames,) complex, nan where the linkage is open.

    Obtained from `Motion.point` or `Body.point`. With arrays of linkages the shape is (frames, linkages).

    Parameters
    ----------
    body : Body
        The body that the point belongs to.
    local : complex
        The point, mm in the body's frame.
    """

    body: Body
    local: complex | Complex
    # Set if the linkage names the point.
    _name: str = field(default="", repr=False)

    def __repr__(self) -> str:
        return f"PointMotion(body={short(self.body.name)}, local={short(self.local)})"

    def _value(self, quantity: str, formula: Callable[[], Complex]) -> Complex:
        """A quantity of a named point by the linkage's program if there is one, otherwise by a formula."""
        body, solution = self.body.name, self.body.solution
        if self._name and solution.run is not None:
            return solution.value((quantity, body, self._name), body)
        with np.errstate(invalid="ignore"):  # rates are not finite at a dead centre of the driver
            return formula()

    @property
    def _arm(self) -> Complex:
        return self.body.direction * self.local

    def _origin(self, order: int) -> Complex:
        return self.body.solution.origin(self.body.name, order)

    @cached_property
    def position(self) -> Complex:
        """Position on the ground, mm."""
        return self._value("position", lambda: self._arm + self._origin(0))

    @cached_property
    def first(self) -> Complex:
        """First kinematic coefficient dP/dq, mm per unit of drive (rad, or mm if a slider drives)."""
        return self._value("first", lambda: first_of(self._arm, self.body.first, self._origin(1)))

    @cached_property
    def second(self) -> Complex:
        """Second kinematic coefficient d2P/dq2, mm per unit of drive squared."""
        return self._value("second", lambda: second_of(self._arm, self.body.first, self.body.second, self._origin(2)))

    @cached_property
    def velocity(self) -> Complex:
        """Velocity, mm/s."""
        return self._value("velocity", lambda: self.body.timing.rate(self.first))

    @cached_property
    def acceleration(self) -> Complex:
        """Acceleration, mm/s2."""
        return self._value("acceleration", lambda: self.body.timing.second_rate(self.first, self.second))


@record(eq=False)
class Body:
    """Motion of one rigid body; arrays are (frames,), angles counterclockwise, nan where the linkage is open.

    Obtained as `motion.coupler`, `motion["coupler"]` or `motion.bodies["coupler"]`. With arrays of linkages the shape
    is (frames, linkages).

    Parameters
    ----------
    name : str
        Name of the body in the linkage.
    solution : LinkageSolution
        The solved positions that the body reads.
    """

    name: str
    solution: LinkageSolution = field(repr=False)

    @property
    def timing(self) -> Timing:
        """Speed and acceleration of the driver."""
        return self.solution.timing

    @property
    def direction(self) -> Complex:
        """Direction of the body's x axis, unit complex."""
        return self.solution.value("direction", self.name)

    @property
    def first(self) -> Real:
        """First kinematic coefficient d(angle)/dq, rad per unit of drive (rad, or mm if a slider drives)."""
        return self.solution.value("first", self.name)

    @property
    def second(self) -> Real:
        """Second kinematic coefficient d2(angle)/dq2, rad per unit of drive squared."""
        return self.solution.value("second", self.name)

    @property
    def omega(self) -> Real:
        """Angular velocity, rad/s."""
        return self.solution.value("omega", self.name)

    @property
    def alpha(self) -> Real:
        """Angular acceleration, rad/s2."""
        return self.solution.value("alpha", self.name)

    @cached_property
    def origin(self) -> PointMotion:
        """Motion of the origin of the body's frame."""
        return self.point(0j)

    @checked
    def point(self, local: PointOrPoints) -> PointMotion:
        """Motion of any point of the body.

        Parameters
        ----------
        local : complex or array
            The point, mm in the body's frame; or one point for each frame.

        Returns
        -------
        PointMotion

        Raises
        ------
        DesignError
            If `local` is no point.
        """
        return PointMotion(self, local)


@record(eq=False)
class SlideMotion:
    """Motion of a sliding joint; arrays are (frames,), positive along the line's direction.

    Obtained from `Motion.slide`.

    Parameters
    ----------
    displacement : array
        Displacement from the line's point `through`, mm.
    velocity, acceleration : array
        Sliding velocity and acceleration relative to the guide, mm/s and mm/s2.
    coriolis : array
        Coriolis acceleration, mm/s2, complex: 2 omega v perpendicular to the line, omega that of the guide.
    first, second : array
        Kinematic coefficients, mm per unit of drive and per unit squared.
    """

    displacement: Real
    velocity: Real
    acceleration: Real
    coriolis: Complex
    first: Real
    second: Real
