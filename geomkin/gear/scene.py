"""Scenes of gears: frames of a mesh, a gear under its tool, regions of a tooth, and dimensions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np

from ..core.arguments import checked
from ..core.records import record
from ..core.units import mm
from ..making.motors import split_motor_parts, with_motor_plate
from ..model.part import Part
from ..model.scene import Plot, Role, Scene, SceneBody, SceneCurve, SceneHandle, SceneMark, circle_handle, dimension
from ..model.table import Column, Table
from ..plane.curve import AbstractCurve, Moved
from ..plane.primitives import Arc, Circle, Segment
from ..plane.roulettes import Involute, roll_at
from ..plane.vec import Complex, Pose, Real, Whole
from .contract import AbstractInvoluteGear

# Frames per pitch: the most, for few pitches; the fewest, for many; and the total. With fewer per pitch, teeth seem to
# stop or to run backwards; more make pages too large.
FINE, COARSE, FRAMES = 60, 12, 360
# Largest number of pitches in a scene.
MOST_PITCHES = 60
# Duration of a pitch, s: about what the eye follows.
PITCH_TIME = 1.0
# Tolerance, as a share of a plate's size, for openings that coincide after a rotation.
ALIKE = 1e-6


@record
class Meshing:
    """Frames of a mesh, in equal steps of the driver's rotation.

    contact_ratio: pitches in which a pair of flanks is in contact, 0 for none. One pair is followed from its first
    contact, then the next, a whole number of pitches later. pitches: in the scene. cyclic: whether the last frame
    equals the first.
    """

    contact_ratio: float
    pitches: int
    cyclic: bool

    @property
    def followed(self) -> int:
        """Pitches after which the next pair of flanks is followed: the contact ratio, rounded up."""
        return pitches_in_contact(self.contact_ratio)

    @property
    def steps(self) -> int:
        """Frames per pitch."""
        return max(COARSE, min(FINE, FRAMES // self.pitches))

    @cached_property
    def frame(self) -> Whole:
        """0, 1, 2 ..., (frames,)."""
        return np.arange(self.pitches * self.steps + 1)

    @property
    def passed(self) -> Real:
        """Rotation of the driver since the first frame, pitches, (frames,)."""
        return self.frame / self.steps

    @property
    def time(self) -> Real:
        """Time of each frame, s."""
        return PITCH_TIME * self.passed

    @property
    def since(self) -> Real:
        """Pitches since the first contact of the followed pair of flanks, (frames,); nan after its last contact."""
        return self._touching(self.frame % (self.followed * self.steps) / self.steps)

    @property
    def all_since(self) -> Real:
        """The same for every pair of flanks in contact, (pairs, frames), the latest first."""
        youngest = self.frame % self.steps / self.steps
        return np.array([self._touching(youngest + k) for k in range(self.followed)])

    def _touching(self, since: Real) -> Real:
        # The tolerance keeps a last contact from being lost in rounding.
        return np.where(since <= self.contact_ratio * (1 + 1e-12), since, np.nan)


def pitches_in_contact(contact_ratio: float) -> int:
    """Whole pitches that contain the contact of a pair of flanks."""
    return max(1, math.ceil(contact_ratio * (1 - 1e-12)))


def meshing(contact_ratio: float, wheels: Iterable[tuple[int, Sequence[Part]]]) -> Meshing:
    """The fewest pitches after which the scene repeats; a keyway or a spoke repeats only with its wheel's rotation.

    wheels: number of teeth, and plates, of each wheel. Derived here.
    """
    whole = math.lcm(1, *(teeth for teeth, parts in wheels if not all(_alike(part, teeth) for part in parts)))
    pitches = math.lcm(whole, pitches_in_contact(contact_ratio))
    return Meshing(contact_ratio, min(pitches, MOST_PITCHES), pitches <= MOST_PITCHES)


def _alike(part: Part, teeth: int) -> bool:
    """Whether the openings of a wheel coincide after each pitch."""
    if not part.holes:
        return True
    middles = np.array([hole.point(_places(hole.breaks)).mean() for hole in part.holes])
    turned = middles * np.exp(2j * np.pi / teeth)
    split_motor_parts = np.abs(turned[:, None] - middles).min(axis=1)
    size = np.abs(part.outline.point(part.outline.breaks)).max()
    return bool(split_motor_parts.max() <= ALIKE * size)


def _places(breaks: Real) -> Real:
    return np.linspace(breaks[:-1], breaks[1:], 5)[:-1].ravel()


@checked
def gear_scene(gear: AbstractInvoluteGear, parts: Sequence[Part] = ()) -> Scene:
    """The scene of a gear that rotates under its cutting tool.

    Parameters
    ----------
    gear : AbstractInvoluteGear
        The gear.
    parts : sequence of Part, optional
        The result of `gear_parts`, of one body.

    Returns
    -------
    Scene
        The gear rotates by one pitch, or by a full turn if its plate is not symmetric. The tool rolls on the pitch
        circle. A left-hand flank is followed while it is cut, from the inner end of its involute to the outer one, then
        the next.

    Notes
    -----
    Derived here.
    """
    parts, motor = split_motor_parts(parts)
    name = parts[0].body if parts else "gear"
    (start, end), pitch = gear.flank_lengths, 2 * np.pi / gear.teeth
    frames = meshing((end - start) / gear.base_pitch, [(gear.teeth, parts)])
    side = -1 if gear.is_ring else 1
    begun = start / gear.base_radius - gear.cutting_angle - side * gear.tooth.half_angle(gear.base_radius)
    turn = begun + pitch * frames.passed
    poses = {name: Pose(np.zeros(turn.shape, complex), np.exp(1j * turn))}
    curves = [SceneCurve(Circle(0j, radius), role, f"{circle} circle") for circle, role, radius in _circles(gear)]
    curves += tooth_regions(gear, name)
    curves += gear_dimensions(gear, name=name)
    # A short rack would leave the picture. It restarts with each pitch, which changes only its ends.
    columns = [Column(f"{name}_turn", "deg", f"turn of the {name}, 0 with a tooth on +y", np.degrees(turn))]
    marks, plots = [axis_mark(frames, 0j, f"axis of the {name}")], []
    if tool := gear.tool(np.mod(turn, pitch)):
        edge, poses["tool"] = tool
        line = np.exp(1j * (np.pi - gear.cutting_angle))
        first, last = (complex(line * (along - 1j * gear.base_radius)) for along in (start, end))
        curves.append(SceneCurve(edge, "contact", "cutting edge of the tool", "tool"))
        curves.append(SceneCurve(Segment(first, last), "contact", "where the tool cuts a left-hand flank"))
        marks += contact_marks(first + line * gear.base_pitch * frames.all_since)
        columns += _cut(gear, start + gear.base_pitch * frames.since)
        plots += [Plot(column.meaning, (column.id,)) for column in columns[1:]]
    return meshing_scene(
        Table(tuple(columns)), frames, with_motor_plate(bodies_at(parts, poses), motor), curves, marks, tuple(plots)
    )


def _cut(gear: AbstractInvoluteGear, along: Real) -> Iterator[Column]:
    """Columns of the followed flank at the tangent lengths at which it is cut, mm; nan while it is not cut."""
    radius = np.hypot(gear.base_radius, along)
    thickness = [gear.thickness(r) if np.isfinite(r) else np.nan for r in radius.tolist()]
    yield Column("thickness", "mm", "thickness of the tooth where it is cut", np.array(thickness))
    yield Column("curvature_radius", "mm", "radius of curvature of the flank there", along)
    yield Column("radius", "mm", "distance of that place from the axis", radius)


def _circles(gear: AbstractInvoluteGear) -> Iterator[tuple[str, Role, float]]:
    yield "tip", "construction", gear.tip_radius
    yield "pitch", "pitch", gear.pitch_radius
    yield "base", "construction", gear.base_radius
    yield "root", "construction", gear.root_radius


def bodies_at(
    parts: Sequence[Part],
    poses: Mapping[str, Pose],
    part_bodies: Mapping[str, str] | None = None,
    layers: Mapping[str, int] | None = None,
) -> tuple[SceneBody, ...]:
    """Bodies with their parts and poses; the ground only if it has parts. Bodies without motion are fixed.

    part_bodies: the name of a body in its parts, if different. layers: of bodies that are not in the first layer above
    the ground.
    """
    bodies = []
    for name, pose in poses.items():
        body_parts = tuple(part for part in parts if part.body == (part_bodies or {}).get(name, name))
        if body_parts or name != "ground":
            origin, direction = np.asarray(pose.origin), np.asarray(pose.direction)
            is_fixed = bool((direction == direction[0]).all() and (origin == origin[0]).all())
            layer = ({"ground": 0} | dict(layers or {})).get(name, 1)
            bodies.append(SceneBody(name, body_parts, origin, direction, layer, is_fixed))
    return tuple(bodies)


def contact_marks(places: Complex) -> Iterator[SceneMark]:
    """Contact points (contacts, frames), mm; nan for none. Only the first is labelled."""
    for k, place in enumerate([place for place in places if np.isfinite(place).any()]):
        yield SceneMark("point", place, "contact", "" if k else "contact")


def axis_mark(frames: Meshing, place: complex, label: str) -> SceneMark:
    """The pin of a fixed axis, mm."""
    return SceneMark("fixed pin", np.full(frames.frame.shape, place), "construction", label)


def meshing_scene(
    table: Table,
    frames: Meshing,
    bodies: tuple[SceneBody, ...],
    curves: Iterable[SceneCurve],
    marks: Iterable[SceneMark],
    plots: tuple[Plot, ...],
) -> Scene:
    """A scene of frames, in all of which the mechanism is assembled."""
    always = np.ones(frames.frame.shape, bool)
    return Scene(table, frames.time, always, bodies, tuple(curves), tuple(marks), plots, frames.cyclic)


def turned_scene(
    columns: Iterable[Column], bodies: tuple[SceneBody, ...], circles: Iterable[SceneCurve], axes: Mapping[str, complex]
) -> Scene:
    """The scene of gears at the rotations of a machine's frames, whose time the machine sets.

    axes: fixed axes by their labels, mm.
    """
    still = np.zeros(bodies[0].origin.shape, complex)
    marks = (SceneMark("fixed pin", still + axis, "construction", label) for label, axis in axes.items())
    table = Table(tuple(columns))
    return Scene(table, still.real, np.ones(still.shape, bool), bodies, tuple(circles), tuple(marks))


def tooth_regions(gear: AbstractInvoluteGear, name: str) -> Iterator[SceneCurve]:
    """Regions of the right-hand side of the tooth on +y, mm in the frame of the gear `name`.

    An undercut tooth also has the lost involute, from the base circle to its crossing with the root curve. Derived
    here.
    """
    root, tip = gear.root_curve, gear.tip_edge or gear.flank
    low, high = complex(root.point(root.breaks[0])), complex(tip.point(tip.breaks[-1]))
    # Lands are symmetric about the middle of the tooth or the space.
    other = -low.conjugate() * np.exp(-2j * np.pi / gear.teeth)
    regions: list[tuple[str, Role, AbstractCurve]] = [
        ("involute flank", "traced", gear.flank),
        ("root curve, as the tool leaves it", "contact", root),
        ("bottom land", "construction", Arc(0j, other, float(np.angle(low / other)))),
        ("tip land", "construction", Arc(0j, high, 2 * float(np.arctan2(high.real, high.imag)))),
    ]
    if gear.tip_edge:
        regions.append(("broken edge of the tip", "construction", gear.tip_edge))
    if gear.is_undercut:
        whole = Involute(gear.base_radius, 0.0, roll_at(gear.form_radius, gear.base_radius))
        cusp = complex(1j * np.exp(-1j * gear.tooth.half_angle(gear.base_radius)))
        regions.append(("involute lost to undercut", "wanted", Moved(whole, Pose(0j, cusp))))
    for label, role, curve in regions:
        yield SceneCurve(curve, role, label, name)


# Directions of the dimensions of tip, pitch and root circle, deg: separate, and clear of the line of centres.
TIP, PITCH, ROOT = 20.0, 50.0, 155.0


def gear_dimensions(gear: AbstractInvoluteGear, centre: complex = 0j, name: str = "gear") -> Iterator[SceneCurve]:
    """Diameters of tip, pitch and root circle about an axis, mm."""
    circles = (("tip", gear.tip_radius, TIP), ("pitch", gear.pitch_radius, PITCH), ("root", gear.root_radius, ROOT))
    for circle, radius, turn in circles:
        half = radius * np.exp(1j * np.radians(turn))
        yield dimension(
            centre - half,
            centre + half,
            f"{circle} \N{DIAMETER SIGN} {mm(2 * radius):.5g}, {circle} circle of the {name}",
        )


def centre_distance(start: complex, end: complex) -> SceneCurve:
    """The dimension of the centre distance, mm."""
    return dimension(start, end, f"centre distance {mm(abs(end - start)):.5g}, from axis to axis")


def gear_handles(
    gear: AbstractInvoluteGear,
    key: str,
    pitch_radius: float | None = None,
    centre: Complex | complex = 0j,
    modules: Sequence[str] = (),
    shifts: bool = True,
) -> Iterator[SceneHandle]:
    """Handles of a gear: teeth by its pitch circle, module by its root circle, profile shift by its tip circle.

    Parameters
    ----------
    gear : AbstractInvoluteGear
        The gear as it is drawn.
    key : str
        Key of its table in the recipe.
    pitch_radius : float, optional
        Radius of the drawn pitch circle, mm; by default that of the gear alone.
    centre : complex or complex array, shape (frames,)
        Its axis, mm.
    modules : sequence of str
        Keys of the modules of all gears in mesh; by default that of the gear.
    shifts : bool
        Whether its profile shift is the recipe's.

    Returns
    -------
    iterator of SceneHandle
    """
    name = key.rpartition(".")[2]
    radius = gear.pitch_radius if pitch_radius is None else pitch_radius
    yield circle_handle(f"{key}.teeth", radius=radius, centre=centre, label=f"teeth of the {name}")
    if shifts:
        label = f"profile shift of the {name}"
        yield circle_handle(f"{key}.profile_shift", radius=gear.tip_radius, centre=centre, label=label)
    first, *others = modules or [f"{key}.module"]
    if first == f"{key}.module":
        yield circle_handle(first, *others, radius=gear.root_radius, centre=centre, label="module", is_one_value=True)
