"""A cam as a scene: cam and follower in contact, the intended position of the follower, and the force on it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace

import numpy as np

from ..core.arguments import checked
from ..core.fields import to_digits
from ..core.units import mm, unit_name
from ..making.motors import split_motor_parts, with_motor_plate
from ..model.part import Part
from ..model.scene import (
    Limit,
    Plot,
    Scene,
    SceneBody,
    SceneCurve,
    SceneHandle,
    SceneMark,
    circle_handle,
    dimension,
    playing_time,
    plot_handle,
    point_handle,
)
from ..model.table import Column, Table
from ..plane.primitives import Circle
from ..plane.vec import Complex, Pose, Real, dot, unit
from .cam import Cam
from .undercut import Undercut, undercut
from .untrimmed_outline import UntrimmedOutline

# Length of the force's arrow and of the line next to it, and distance from a translating roller to its guide, as shares
# of the prime radius. Longer ones leave the picture; shorter ones do not show an angle.
ARROW, GUIDE = 0.7, 0.5
# Lift, as a share of the cam's size, that gives the direction in which the follower moves. With a larger value an
# arm's path is curved; a smaller one is lost in rounding.
SMALL_LIFT = 1e-6

# Title of each plot and the names of its columns, the most important plot first.
PLOTS = {
    "lift": "lift",
    "velocity": "velocity",
    "acceleration": "acceleration",
    "jerk": "jerk",
    "pressure angle": "pressure_angle",
    "lift lost to undercut": "lost_lift",
    "curvature of the pitch curve": "pitch_curvature",
    "curvature of the profile": "profile_curvature",
}


@checked
def cam_scene(
    cam: Cam, table: Table, parts: Sequence[Part] = (), cut: Undercut | None = None, limits: Sequence[Limit] = ()
) -> Scene:
    """The scene of a cam that turns under its follower.

    Parameters
    ----------
    cam : Cam
        The cam and its follower.
    table : Table
        The result of `cam_table`; its cam angles are the frames.
    parts : sequence of Part, optional
        The result of `cam_parts`.
    cut : Undercut, optional
        The result of `undercut`, if it is known already.
    limits : sequence of Limit, optional
        Limit lines of the plots, each of its column.

    Returns
    -------
    Scene
        Where undercut costs lift, the follower rests on the remaining corner and its intended position is drawn too.

    Notes
    -----
    Derived here.
    """
    cut = cut or undercut(cam)
    parts, motor = split_motor_parts(parts)
    angle = np.radians(np.asarray(table["cam_angle"], dtype=float))
    follower = _FollowerFrames(cam, cut, angle)
    curves = [SceneCurve(Circle(0j, cam.base_radius), "construction", "base circle")]
    if cam.follower.knife_edge:
        curves.append(SceneCurve(cam.pitch_curve, "pitch", "pitch curve", "cam"))
    if cut.found:
        curves.append(SceneCurve(UntrimmedOutline(cam).curve, "wanted", "profile without undercut", "cam"))
    curves += follower.dimensions(parts)
    marks = (*follower.joints(parts), *follower.force(), *follower.intended())
    is_cyclic = bool(np.isclose(angle[-1] - angle[0], 2 * np.pi))
    return Scene(
        table,
        playing_time(table),
        np.ones(len(angle), dtype=bool),
        with_motor_plate(tuple(follower.bodies(parts)), motor),
        tuple(curves),
        marks,
        tuple(_plots(table, limits)),
        is_cyclic,
    )


class _FollowerFrames:
    """Actual pose of the follower, lowered by undercut, and its contact; all (frames,).

    centre: of the roller, or the contact point of a face. normal: from the cam into the follower. path_direction:
    direction in which the follower moves. Both are unit complex numbers.
    """

    def __init__(self, cam: Cam, cut: Undercut, angle: Real):
        self.cam, self.angle = cam, angle
        follower, lift = cam.follower, cam.program.motion(angle).lift
        self.lost = cut.lost_lift(angle)
        self.intended_pose, self.pose = (follower.pose(z, cam.base_radius) for z in (lift, lift - self.lost))
        contact = cam.contact(angle)
        # In the follower's frame a roller's centre and a face's direction are constant.
        self.intended_centre = contact.point + follower.roller_radius * contact.normal
        centre = self.intended_pose.locate(self.intended_centre)
        self.centre = self.pose.place(centre)
        normal = contact.normal * np.conj(np.asarray(self.intended_pose.direction)) * self.pose.direction
        is_lowered = self.lost > 0
        self.contact = np.where(is_lowered, cut.corner(angle), contact.point)
        if follower.roller_radius:
            normal = np.where(is_lowered, unit(self.centre - self.contact), contact.normal)
        self.normal: Complex = normal
        lifted = follower.pose(
            lift - self.lost + SMALL_LIFT * (1.0 if follower.oscillates else cam.prime_radius), cam.base_radius
        )
        point = centre if follower.roller_radius or follower.knife_edge else self.pose.locate(self.contact)
        self.path_direction = unit(lifted.place(point) - self.pose.place(point))

    def bodies(self, parts: Sequence[Part]) -> Iterator[SceneBody]:
        """A roller and a face lie in the layer of the cam, the bar of a roller next to it, and a base below all."""
        still = np.ones(len(self.angle), dtype=complex)
        follower = self.cam.follower
        poses = {
            "cam": Pose(0 * still, np.exp(1j * self.cam.sense * self.angle)),
            "roller": Pose(self.centre, still),
            "ground": Pose(0 * still, still),
        }
        has_base = any(part.body == "ground" for part in parts)
        names = dict.fromkeys(["cam", *(part.body for part in parts)])
        for name in names:
            pose = poses.get(name, self.pose)
            body_parts = tuple(part for part in parts if part.body == name)
            is_bar = follower.knife_edge is not None and name not in poses
            layer = 0 if is_bar or name == "ground" else 1
            # Over a base, the bar has its own layer.
            layer += has_base and follower.knife_edge is not None and name != "ground"
            fixed = name == "ground"
            yield SceneBody(name, body_parts, np.asarray(pose.origin), np.asarray(pose.direction), layer, fixed)

    def joints(self, parts: Sequence[Part]) -> Iterator[SceneMark]:
        follower, bars = self.cam.follower, {part.body for part in parts} - {"cam", "roller", "ground"}
        yield SceneMark("fixed pin", np.zeros(len(self.angle), dtype=complex), "construction", "cam shaft")
        if follower.oscillates:
            yield SceneMark("fixed pin", np.asarray(self.pose.origin), "construction", "pivot")
        if follower.roller_radius:
            yield SceneMark("pin", self.centre, "construction", "roller")
        if follower.oscillates and not bars:
            arm = self.centre - self.pose.origin
            yield SceneMark("line", np.asarray(self.pose.origin), "construction", "arm", vector=arm)
        elif not bars:
            # A stem without a plate, in a fixed guide.
            foot, direction = np.asarray(self.pose.origin), self.path_direction
            along = dot(direction[0], foot)
            start = foot[np.argmin(along)]
            clear = max(GUIDE * self.cam.prime_radius, 2 * follower.roller_radius)
            guide = np.full(len(along), start + direction[0] * (np.ptp(along) + clear))
            stem = direction * (np.ptp(along) + 1.5 * clear)
            yield SceneMark("line", foot, "construction", "follower", vector=stem)
            yield SceneMark("slide", guide, "construction", "guide", direction=direction)

    def dimensions(self, parts: Sequence[Part]) -> Iterator[SceneCurve]:
        bodies = {part.body for part in parts}
        arm = next((name for name in sorted(bodies - {"cam", "roller", "ground"})), "")
        pivot, centre = complex(np.asarray(self.pose.origin)[0]), complex(self.centre[0])
        for curve in cam_dimensions(self.cam, pivot, centre, complex(self.path_direction[0]), arm or "arm"):
            if curve.body in {"", *bodies}:
                yield curve

    def force(self) -> Iterator[SceneMark]:
        """The pressure angle, between the force on the follower and the direction of its motion."""
        length = ARROW * self.cam.prime_radius
        yield SceneMark("point", self.contact, "contact", "contact")
        yield SceneMark("vector", self.contact, "contact", "force on the follower", vector=length * self.normal)
        yield SceneMark("line", self.contact, "contact", "direction of motion", vector=length * self.path_direction)

    def intended(self) -> Iterator[SceneMark]:
        """The follower's intended position in the frames in which undercut costs lift."""
        if not self.lost.any():
            return
        cam, label = self.cam, "follower without undercut"
        radius, nowhere = cam.follower.roller_radius, complex(np.nan, np.nan)
        place = np.where(self.lost > 0, self.intended_centre, nowhere)
        face = cam.follower.contact_travel(cam.program, cam.base_radius, cam.sense)
        if radius:
            yield SceneMark("circle", place, "wanted", label, radius=np.full(len(place), radius))
        elif face is None:
            yield SceneMark("point", place, "wanted", label)
        else:
            start, end = self.intended_pose.place(face[0]), self.intended_pose.place(face[1])
            place = np.where(self.lost > 0, start, nowhere)
            yield SceneMark("line", place, "wanted", label, vector=end - start)


def _plots(table: Table, limits: Sequence[Limit]) -> Iterator[Plot]:
    for title, id in PLOTS.items():
        if id in table.ids:
            yield Plot(title, (id,)).with_limits(limits)


# Direction of the dimension of the base radius, deg: clear of the follower and of its pivot.
BASE_DIRECTION = 215.0


def cam_dimensions(cam: Cam, pivot: complex, centre: complex, line: complex, arm: str) -> Iterator[SceneCurve]:
    """Dimensions of the base radius and of the follower's lengths.

    pivot: of an arm, and centre: of the roller or the contact point, mm, in the ground's frame at the first frame.
    line: unit direction of the follower's motion. arm: name of the oscillating body; its length lies along its x axis.
    """
    end = cam.base_radius * np.exp(1j * np.radians(BASE_DIRECTION))
    yield dimension(0j, end, f"base radius {mm(cam.base_radius):.5g}, where the lift is 0")
    follower, sizes = cam.follower, follower_lengths(cam)
    meanings = {f.name: f.metadata["description"].removesuffix(", mm") for f in fields(follower) if f.name in sizes}  # type: ignore[arg-type]
    foot = centre - line * np.real(np.conj(line) * centre)
    ends = {
        "pivot_distance": (0j, pivot, ""),
        "offset": (0j, complex(foot), ""),
        "arm_length": (0j, abs(centre - pivot) + 0j, arm),
        "roller_radius": (0j, 1j * follower.roller_radius, "roller"),
    }
    for name, size in sizes.items():
        if name in ends and size:
            start, end, body = ends[name]
            yield dimension(start, end, f"{name.replace('_', ' ')} {mm(abs(size)):.5g}, {meanings[name]}", body)


def follower_lengths(cam: Cam) -> dict[str, float]:
    """Lengths of the follower by name, mm."""
    follower = cam.follower
    return {f.name: getattr(follower, f.name) for f in fields(follower) if f.metadata.get("unit") == "mm"}  # type: ignore[arg-type]


# Keys of a segment that a point of the lift plot sets.
SEGMENT_KEYS = ("end_deg", "duration_deg", "rise", "rise_deg", "fall", "fall_deg", "end_lift", "end_lift_deg")


def cam_handles(cam: Cam, angle: Real) -> Iterator[SceneHandle]:
    """Handles of the base circle, the follower's lengths, and the ends of segments on the plot of the lift.

    Parameters
    ----------
    cam : Cam
        The cam as the recipe has it.
    angle : ndarray, shape (frames,)
        Cam angles of the scene's frames, rad.

    Returns
    -------
    iterator of SceneHandle
    """
    follower, lengths = cam.follower, set(follower_lengths(cam))
    yield circle_handle("cam.base_radius", radius=cam.base_radius)
    contact = cam.contact(angle)
    centre = contact.point + follower.roller_radius * contact.normal
    if follower.roller_radius:
        yield circle_handle("cam.follower.roller_radius", radius=follower.roller_radius, centre=centre)
    if follower.oscillates:
        pivot = np.asarray(follower.pose(cam.program.motion(angle[:1]).lift, cam.base_radius).origin)
        yield point_handle("cam.follower.pivot_distance", at=pivot)
    # The roller's centre, or the place where the cam touches a face.
    others = [f"cam.follower.{name}" for name in sorted(lengths - {"roller_radius", "pivot_distance"})]
    if others:
        yield point_handle(*others, at=centre)
    # The last end is that of the turn.
    for k, ((end, lift), segment) in enumerate(zip(cam.program.ends[:-1], cam.program.segments)):
        names = [name for name in SEGMENT_KEYS if getattr(segment, name, None) is not None]
        if {"fall", "fall_deg", "end_lift_deg"} & set(names) and "end_lift" in names:
            # The default end of a return.
            names.remove("end_lift")
        keys = [f"cam.program[{k}].{name}" for name in names]
        if keys:
            yield plot_handle(*keys, at=complex(end, lift), column="lift", label=f"end of segment {k + 1}")


# Change, deg per mm, below which a length matters only by rounding.
LEAST = 1e-9


def with_size_plot(scene: Scene, cam: Cam) -> Scene:
    """The scene of a cam with a plot of the change of the pressure angle per mm of each length.

    The most influential length comes first. A face that does not turn has the same pressure angle with all lengths, and
    its scene no such plot.
    """
    columns = [column for column in _columns(scene, cam) if np.max(column.values) > LEAST]
    if not columns:
        return scene
    # To six digits, so that rounding does not decide the order.
    columns.sort(key=lambda column: -to_digits(np.max(column.values), 6))
    plot = Plot(f"effect of 1 {unit_name()} of each length", tuple(column.id for column in columns), bars=True)
    return replace(scene, table=Table((*scene.table.columns, *columns)), plots=(*scene.plots, plot))


def _columns(scene: Scene, cam: Cam) -> Iterator[Column]:
    angle = np.radians(scene.table["cam_angle"])
    for size, (_, rate) in cam.follower.contact_rates(cam.program.motion(angle), cam.base_radius, cam.sense).items():
        if not size.endswith("_deg"):
            words = f"change of the pressure angle for 1 {unit_name()} of {size}"
            yield Column(f"pressure_angle_by_{size}", "deg/mm", words, np.abs(np.degrees(rate)))
