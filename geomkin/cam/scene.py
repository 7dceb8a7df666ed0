"""A cam as a scene: cam and follower in contact, what the follower was to do, and where the force acts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from ..core.arguments import checked
from ..making.motors import apart, on_motor
from ..model.part import Part
from ..model.scene import Limit, Plot, Scene, SceneBody, SceneCurve, SceneMark, dimension, mm
from ..model.table import Table
from ..plane.primitives import Circle
from ..plane.vec import Complex, Pose, Real, dot, unit
from .cam import Cam
from .undercut import Undercut, undercut
from .untrimmed_outline import UntrimmedOutline

if TYPE_CHECKING:
    from .cam import Cam


# Lengths of the arrow of the force and of the line beside it, and from a straight roller to its guide, as shares of the
# prime radius: longer ones leave the picture, shorter ones do not show an angle.
ARROW, GUIDE = 0.7, 0.5
# Share of the cam's size by which a follower is lifted to see which way it goes. Larger, and an arm's way is bent;
# smaller, and it is rounding.
LIFTED = 1e-6

# Title of each plot and the columns that it shows, of those that there are, the most telling first.
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
    cam: Cam,
    table: Table,
    parts: Sequence[Part] = (),
    cut: Undercut | None = None,
    limits: Sequence[Limit] = (),
) -> Scene:
    """A cam turning under its follower, at the cam angles of its table.

    table: as `cam_table` gives it. parts: as `cam_parts` gives them. cut: what `undercut` found, where it is known
    already. limits: lines across the plots of their columns. Where undercut takes lift
    the follower rests on the corner that is left, and what it should do is drawn beside it. Derived here.
    """
    cut = cut or undercut(cam)
    parts, motor = apart(parts)
    angle = np.radians(np.asarray(table["cam_angle"], dtype=float))
    riding = _Riding(cam, cut, angle)
    curves = [SceneCurve(Circle(0j, cam.base_radius), "construction", "base circle")]
    if cam.follower.knife_edge:
        curves.append(SceneCurve(cam.pitch_curve, "pitch", "pitch curve", "cam"))
    if cut.found:
        curves.append(SceneCurve(UntrimmedOutline(cam).curve, "wanted", "profile that was asked for", "cam"))
    curves += riding.dimensions(parts)
    marks = (*riding.joints(parts), *riding.force(), *riding.wished())
    around = bool(np.isclose(angle[-1] - angle[0], 2 * np.pi))
    time = np.asarray(table["time"], dtype=float)
    return Scene(
        table,
        # The time of a speed that changes is unknown: the scene then lasts two seconds.
        time if np.isfinite(time).all() else np.linspace(0, 2, len(time)),
        np.ones(len(angle), dtype=bool),
        on_motor(tuple(riding.bodies(parts)), motor),
        tuple(curves),
        marks,
        tuple(_plots(table, limits)),
        around,
    )


class _Riding:
    """Where the follower really is, which undercut keeps below its lift, and where it touches; all (frames,).

    centre: of the roller, or where a face touches. normal: from the cam into the follower; way: the way it is free to
    go; unit complex.
    """

    def __init__(self, cam: Cam, cut: Undercut, angle: Real):
        self.cam, self.angle = cam, angle
        follower, lift = cam.follower, cam.program.motion(angle).lift
        self.lost = cut.lost_lift(angle)
        self.asked, self.pose = (follower.place(z, cam.base_radius) for z in (lift, lift - self.lost))
        contact = cam.contact(angle)
        # In the follower's own frame a roller's centre stays where it is, and so does a face's direction.
        self.asked_centre = contact.point + follower.rounding * contact.normal
        centre = self.asked.locate(self.asked_centre)
        self.centre = self.pose.place(centre)
        normal = contact.normal * np.conj(np.asarray(self.asked.direction)) * self.pose.direction
        sunk = self.lost > 0
        self.contact = np.where(sunk, cut.corner(angle), contact.point)
        if follower.rounding:
            normal = np.where(sunk, unit(self.centre - self.contact), contact.normal)
        self.normal: Complex = normal
        lifted = follower.place(
            lift - self.lost + LIFTED * (1.0 if follower.oscillates else cam.prime_radius), cam.base_radius
        )
        touching = centre if follower.rounding or follower.knife_edge else self.pose.locate(self.contact)
        self.way = unit(lifted.place(touching) - self.pose.place(touching))

    def bodies(self, parts: Sequence[Part]) -> Iterator[SceneBody]:
        """A roller's centre runs in the plane of the cam, and what carries it beside both; a face lies in it too.

        A base lies under all of them.
        """
        still = np.ones(len(self.angle), dtype=complex)
        follower = self.cam.follower
        poses = {
            "cam": Pose(0 * still, np.exp(1j * self.cam.sense * self.angle)),
            "roller": Pose(self.centre, still),
            "ground": Pose(0 * still, still),
        }
        stands = any(part.body == "ground" for part in parts)
        names = dict.fromkeys(["cam", *(part.body for part in parts)])
        for name in names:
            pose = poses.get(name, self.pose)
            held = tuple(part for part in parts if part.body == name)
            beside = follower.knife_edge is not None and name not in poses
            layer = 0 if beside or name == "ground" else 1
            # Over a base what is beside has a layer of its own.
            layer += stands and follower.knife_edge is not None and name != "ground"
            fixed = name == "ground"
            yield SceneBody(name, held, np.asarray(pose.origin), np.asarray(pose.direction), layer, fixed)

    def joints(self, parts: Sequence[Part]) -> Iterator[SceneMark]:
        follower, carried = self.cam.follower, {part.body for part in parts} - {"cam", "roller", "ground"}
        yield SceneMark("fixed pin", np.zeros(len(self.angle), dtype=complex), "construction", "cam shaft")
        if follower.oscillates:
            yield SceneMark("fixed pin", np.asarray(self.pose.origin), "construction", "pivot")
        if follower.rounding:
            yield SceneMark("pin", self.centre, "construction", "roller")
        if follower.oscillates and not carried:
            arm = self.centre - self.pose.origin
            yield SceneMark("line", np.asarray(self.pose.origin), "construction", "arm", vector=arm)
        elif not carried:
            # A stem that no plate is cut of, in a guide that stands still.
            foot = np.asarray(self.pose.origin)
            along = dot(self.way[0], foot)
            start = foot[np.argmin(along)]
            clear = max(GUIDE * self.cam.prime_radius, 2 * follower.rounding)
            guide = np.full(len(along), start + self.way[0] * (np.ptp(along) + clear))
            stem = self.way * (np.ptp(along) + 1.5 * clear)
            yield SceneMark("line", foot, "construction", "follower", vector=stem)
            yield SceneMark("slide", guide, "construction", "guide", direction=self.way)

    def dimensions(self, parts: Sequence[Part]) -> Iterator[SceneCurve]:
        bodies = {part.body for part in parts}
        arm = next((name for name in sorted(bodies - {"cam", "roller", "ground"})), "")
        pivot, centre = complex(np.asarray(self.pose.origin)[0]), complex(self.centre[0])
        for curve in cam_dimensions(self.cam, pivot, centre, complex(self.way[0]), arm or "arm"):
            if curve.body in {"", *bodies}:
                yield curve

    def force(self) -> Iterator[SceneMark]:
        """The pressure angle, between the force on the follower and the way that it is free to go."""
        length = ARROW * self.cam.prime_radius
        yield SceneMark("point", self.contact, "contact", "contact")
        yield SceneMark("vector", self.contact, "contact", "force on the follower", vector=length * self.normal)
        yield SceneMark("line", self.contact, "contact", "direction of motion", vector=length * self.way)

    def wished(self) -> Iterator[SceneMark]:
        """The follower where it should be, as long as undercut keeps it from there."""
        if not self.lost.any():
            return
        cam, label = self.cam, "follower where it should be"
        radius, nowhere = cam.follower.rounding, complex(np.nan, np.nan)
        place = np.where(self.lost > 0, self.asked_centre, nowhere)
        face = cam.follower.contact_travel(cam.program, cam.base_radius, cam.sense)
        if radius:
            yield SceneMark("circle", place, "wanted", label, radius=np.full(len(place), radius))
        elif face is None:
            yield SceneMark("point", place, "wanted", label)
        else:
            end = np.where(self.lost > 0, self.asked.place(face[0]), nowhere)
            yield SceneMark("line", end, "wanted", label, vector=self.asked.place(face[1]) - self.asked.place(face[0]))


def _plots(table: Table, limits: Sequence[Limit]) -> Iterator[Plot]:
    for title, id in PLOTS.items():
        if id in table.ids:
            yield Plot(title, (id,)).with_limits(limits)


# Direction of a base radius, deg: off the follower, and off its pivot.
BASE = 215.0


def cam_dimensions(cam: Cam, pivot: complex, centre: complex, line: complex, arm: str) -> Iterator[SceneCurve]:
    """Base radius and the lengths of the follower, as they were declared.

    pivot: of an arm, and centre: of the roller or where it touches, mm on the ground and at the first frame; line:
    unit, along the follower's way; arm: the body that swings, in whose frame its length lies along x.
    """
    yield dimension(
        0j, cam.base_radius * np.exp(1j * np.radians(BASE)), f"base radius {mm(cam.base_radius)}, where the lift is 0"
    )
    follower = cam.follower
    sizes = {f.name: getattr(follower, f.name) for f in fields(follower) if f.metadata.get("unit") == "mm"}  # type: ignore[arg-type]
    told = {f.name: f.metadata["description"].removesuffix(", mm") for f in fields(follower) if f.name in sizes}  # type: ignore[arg-type]
    foot = centre - line * np.real(np.conj(line) * centre)
    ends = {
        "pivot_distance": (0j, pivot, ""),
        "offset": (0j, complex(foot), ""),
        "arm_length": (0j, abs(centre - pivot) + 0j, arm),
        "roller_radius": (0j, 1j * follower.rounding, "roller"),
    }
    for name, size in sizes.items():
        if name in ends and size:
            start, end, body = ends[name]
            yield dimension(start, end, f"{name.replace('_', ' ')} {mm(abs(size))}, {told[name]}", body)
