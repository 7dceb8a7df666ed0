"""Sizes as lines from one end to the other, with their number: of links between pins, of cams, of gears."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..core.arguments import checked
from ..core.records import record
from ..making.motors import split_motor_parts, with_motor_plate
from ..model.part import Part
from ..model.scene import Plot, Role, Scene, SceneBody, SceneCurve, SceneMark, dimension, mm
from ..model.table import Column, Table
from ..plane.curve import AbstractCurve, Moved
from ..plane.primitives import Arc, Circle, Segment
from ..plane.roulettes import Involute, roll_at
from ..plane.vec import Complex, Pose, Real, Whole
from .contract import AbstractInvoluteGear

if TYPE_CHECKING:
    pass


# Frames for a pitch: the most, where few pitches are shown; the fewest, where many are; and how many all of them take
# together. Fewer for a pitch and teeth seem to stand still or to run backwards; more make pages that nobody can send.
FINE, COARSE, FRAMES = 60, 12, 360
# Pitches that are shown at most: more than a reader waits for.
MOST_PITCHES = 60
# Seconds that a pitch is shown for: about what the eye follows.
PITCH_TIME = 1.0
# Of a plate's size, how near openings come to each other's places for the plate to look the same.
ALIKE = 1e-6


@record
class Meshing:
    """Frames of a mesh, in equal steps of a driver's turn.

    contact_ratio: pitches for which a pair of flanks touches, 0 where none does; one pair is followed from its first
    contact on, then the next that comes as many whole pitches later. pitches: that are shown. cyclic: the last frame
    looks as the first.
    """

    contact_ratio: float
    pitches: int
    cyclic: bool

    @property
    def followed(self) -> int:
        """Pitches after which the next pair of flanks is followed: that for which one touches, rounded up."""
        return pitches_in_contact(self.contact_ratio)

    @property
    def steps(self) -> int:
        """Frames for a pitch."""
        return max(COARSE, min(FINE, FRAMES // self.pitches))

    @cached_property
    def frame(self) -> Whole:
        """0, 1, 2 ..., (frames,)."""
        return np.arange(self.pitches * self.steps + 1)

    @property
    def passed(self) -> Real:
        """Pitches that the driver has turned since the first frame, (frames,)."""
        return self.frame / self.steps

    @property
    def time(self) -> Real:
        """s."""
        return PITCH_TIME * self.passed

    @property
    def since(self) -> Real:
        """Pitches since the pair of flanks that is followed began to touch, (frames,); nan where it has let go."""
        return self._touching(self.frame % (self.followed * self.steps) / self.steps)

    @property
    def all_since(self) -> Real:
        """The same of every pair of flanks that touches, (pairs, frames), the youngest first."""
        youngest = self.frame % self.steps / self.steps
        return np.array([self._touching(youngest + k) for k in range(self.followed)])

    def _touching(self, since: Real) -> Real:
        # A hair of room: a last contact is not lost to rounding.
        return np.where(since <= self.contact_ratio * (1 + 1e-12), since, np.nan)


def pitches_in_contact(contact_ratio: float) -> int:
    """Whole pitches within which a pair of flanks begins and ends to touch."""
    return max(1, math.ceil(contact_ratio * (1 - 1e-12)))


def meshing(contact_ratio: float, wheels: Iterable[tuple[int, Sequence[Part]]]) -> Meshing:
    """The fewest pitches after which all looks as it did: a keyway, and spokes, come round only with their wheel.

    wheels: number of teeth, and plates, of each. Derived here.
    """
    whole = math.lcm(1, *(teeth for teeth, parts in wheels if not all(_alike(part, teeth) for part in parts)))
    pitches = math.lcm(whole, pitches_in_contact(contact_ratio))
    return Meshing(contact_ratio, min(pitches, MOST_PITCHES), pitches <= MOST_PITCHES)


def _alike(part: Part, teeth: int) -> bool:
    """Whether the openings of a wheel of so many teeth look the same after each pitch."""
    if not part.holes:
        return True
    middles = np.array([_middle(hole.point(_places(hole.breaks))) for hole in part.holes])
    turned = middles * np.exp(2j * np.pi / teeth)
    split_motor_parts = np.abs(turned[:, None] - middles).min(axis=1)
    size = np.abs(part.outline.point(part.outline.breaks)).max()
    return bool(split_motor_parts.max() <= ALIKE * size)


def _places(breaks: Real) -> Real:
    return np.linspace(breaks[:-1], breaks[1:], 5)[:-1].ravel()


def _middle(points: Complex) -> complex:
    return complex(points.mean())


@checked
def gear_scene(gear: AbstractInvoluteGear, parts: Sequence[Part] = ()) -> Scene:
    """A gear turning by a pitch, or by a turn where its plate shows that it turns, under the tool that cuts it.

    The tool rolls on the pitch circle. A left-hand flank is followed while it is cut, from the end of its involute that
    is nearer to the axis to the other, and then the next. parts: as `gear_parts` gives them, of one body. Derived here.
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
    # A rack of few teeth would run off: it looks the same, but for its ends, when it begins anew with each pitch.
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
        plots += [Plot(column.meaning, (column.header,)) for column in columns[1:]]
    return meshing_scene(
        Table(tuple(columns)), frames, with_motor_plate(bodies_at(parts, poses), motor), curves, marks, tuple(plots)
    )


def _cut(gear: AbstractInvoluteGear, along: Real) -> Iterator[Column]:
    """Of the flank that is followed, at the tangent lengths at which it is cut, mm; nan where it is not."""
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
    called: Mapping[str, str] | None = None,
    layers: Mapping[str, int] | None = None,
) -> tuple[SceneBody, ...]:
    """Bodies with their parts at their poses; the ground only where it has any. Those that stand still are fixed.

    called: what parts call a body, where that is another name. layers: of those that do not lie in the first layer
    over the ground.
    """
    found = []
    for name, pose in poses.items():
        held = tuple(part for part in parts if part.body == (called or {}).get(name, name))
        if held or name != "ground":
            origin, direction = np.asarray(pose.origin), np.asarray(pose.direction)
            still = bool((direction == direction[0]).all() and (origin == origin[0]).all())
            layer = ({"ground": 0} | dict(layers or {})).get(name, 1)
            found.append(SceneBody(name, held, origin, direction, layer, still))
    return tuple(found)


def contact_marks(places: Complex) -> Iterator[SceneMark]:
    """Points (contacts, frames) at which flanks touch, mm; nan where they do not. The first has the name of all."""
    seen = [place for place in places if np.isfinite(place).any()]
    for k, place in enumerate(seen):
        yield SceneMark("point", place, "contact", "" if k else "contact")


def axis_mark(frames: Meshing, place: complex, label: str) -> SceneMark:
    """The pin of an axis that stands still at a place, mm."""
    return SceneMark("fixed pin", np.full(frames.frame.shape, place), "construction", label)


def meshing_scene(
    table: Table,
    frames: Meshing,
    bodies: tuple[SceneBody, ...],
    curves: Iterable[SceneCurve],
    marks: Iterable[SceneMark],
    plots: tuple[Plot, ...],
) -> Scene:
    """A scene of frames at all of which the mechanism can be, over the time that they take."""
    always = np.ones(frames.frame.shape, bool)
    return Scene(table, frames.time, always, bodies, tuple(curves), tuple(marks), plots, frames.cyclic)


def tooth_regions(gear: AbstractInvoluteGear, name: str) -> Iterator[SceneCurve]:
    """Right-hand side of the tooth on +y of a gear called `name`, region by region, mm in its frame.

    Of an undercut tooth also the involute that is lost, from the base circle to where the root curve crosses it.
    Derived here.
    """
    root, tip = gear.root_curve, gear.tip_edge or gear.flank
    low, high = complex(root.point(root.breaks[0])), complex(tip.point(tip.breaks[-1]))
    # Lands reach as far on the other side of the tooth's and the space's middle.
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


# Directions, deg, of the diameters of tip, pitch and root circle: apart, and off the line from axis to axis.
TIP, PITCH, ROOT = 20.0, 50.0, 155.0


def gear_dimensions(gear: AbstractInvoluteGear, centre: complex = 0j, name: str = "gear") -> Iterator[SceneCurve]:
    """Diameters of tip, pitch and root circle about an axis, mm."""
    circles = (("tip", gear.tip_radius, TIP), ("pitch", gear.pitch_radius, PITCH), ("root", gear.root_radius, ROOT))
    for circle, radius, turn in circles:
        half = radius * np.exp(1j * np.radians(turn))
        yield dimension(
            centre - half, centre + half, f"{circle} \N{DIAMETER SIGN} {mm(2 * radius)}, {circle} circle of the {name}"
        )


def centre_distance(start: complex, end: complex) -> SceneCurve:
    """From axis to axis, mm."""
    return dimension(start, end, f"centre distance {mm(abs(end - start))}, from axis to axis")
