"""Gears as scenes: in mesh, on a rack, planets round a sun, under the tool that cuts them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from ..arguments import checked
from ..gear.contract import AbstractInvoluteGear
from ..gear.pair import GearPair
from ..gear.planetary import PlanetarySet
from ..gear.rack import RackPair
from ..part import Part
from ..plane.curve import AbstractCurve, Moved
from ..plane.primitives import Arc, Circle, Segment
from ..plane.roulettes import Involute, roll_at
from ..plane.vec import Complex, Pose, Real
from ..scene import Plot, Role, Scene, SceneBody, SceneCurve, SceneMark
from ..table import Column, Table, finite
from .dimensions import centre_distance, gear_dimensions
from .meshing import MOST_PITCHES, LineOfAction, Meshing, meshing
from .motor import apart, on_motor


@checked
def gear_scene(gear: AbstractInvoluteGear, parts: Sequence[Part] = ()) -> Scene:
    """A gear turning by a pitch, or by a turn where its plate shows that it turns, under the tool that cuts it.

    The tool rolls on the pitch circle. A left-hand flank is followed while it is cut, from the end of its involute that
    is nearer to the axis to the other, and then the next. parts: as `gear_parts` gives them, of one body. Derived here.
    """
    parts, motor = apart(parts)
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
    marks, plots = [_axis(frames, 0j, f"axis of the {name}")], []
    if tool := gear.tool(np.mod(turn, pitch)):
        edge, poses["tool"] = tool
        line = np.exp(1j * (np.pi - gear.cutting_angle))
        first, last = (complex(line * (along - 1j * gear.base_radius)) for along in (start, end))
        curves.append(SceneCurve(edge, "contact", "cutting edge of the tool", "tool"))
        curves.append(SceneCurve(Segment(first, last), "contact", "where the tool cuts a left-hand flank"))
        marks += contact_marks(first + line * gear.base_pitch * frames.all_since)
        columns += _cut(gear, start + gear.base_pitch * frames.since)
        plots += [Plot(column.meaning, (column.header,)) for column in columns[1:]]
    return _scene(Table(tuple(columns)), frames, on_motor(bodies_at(parts, poses), motor), curves, marks, tuple(plots))


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


@checked
def pair_scene(pair: GearPair | RackPair, parts: Sequence[Part] = ()) -> Scene:
    """Two gears in mesh, or a pinion and its rack, over as many pitches as it takes to follow a pair of flanks.

    The driver turns counterclockwise. Teeth stand in the middle of spaces, as the pair's `poses` have them, and
    contacts are those of the driver's own flanks: the play that the pair has is seen half on either side. parts: of
    bodies named as the pair's `names`, and plates of the ground, whose x axis is the line from axis to axis, or runs as
    the rack. Derived here.
    """
    parts, motor = apart(parts)
    name, other = pair.names
    gear, line, (start, end) = pair.driver, LineOfAction(pair), pair.contact_lengths
    frames, before = _frames(pair, parts)
    roll = (start + gear.base_pitch * (frames.passed - before)) / gear.base_radius
    poses = dict(zip(pair.names, pair.poses(roll + line.flank_turn)))
    ahead = 1j if isinstance(pair, GearPair) else 1.0 + 0j
    poses["ground"] = Pose(np.zeros(roll.shape, complex), np.full(roll.shape, ahead))
    away = complex(np.asarray(poses[other].origin)[0])
    curves = (
        *line.circles(),
        *gear_dimensions(gear, 0j, name),
        SceneCurve(line.between(min(0.0, start), max(end, 2 * line.pitch_point)), "construction", "line of action"),
        SceneCurve(line.between(start, end), "contact", "path of contact"),
    )
    marks = [_axis(frames, 0j, f"axis of the {name}")]
    if isinstance(pair, GearPair):
        marks.append(_axis(frames, away, f"axis of the {other}"))
        curves += (*gear_dimensions(pair.second, away, other), centre_distance(0j, away))
    marks += contact_marks(line.place(start + gear.base_pitch * frames.all_since))
    plots = (
        Plot("specific sliding", (f"{name}_sliding", f"{other}_sliding")),
        Plot("pairs of flanks in contact", ("pairs",)),
        Plot("place of contact on the line of action", ("along_mm",)),
    )
    columns = (*_turns(pair, roll), *_contact(pair, frames))
    return _scene(Table(columns), frames, on_motor(bodies_at(parts, poses), motor), curves, marks, plots)


def _frames(pair: GearPair | RackPair, parts: Sequence[Part]) -> tuple[Meshing, int]:
    """Frames, and pitches that the driver turns before its flank touches at last in the middle of a rack."""
    if isinstance(pair, GearPair):
        teeth = zip(pair.names, (pair.first.teeth, pair.second.teeth))
        return meshing(pair.contact_ratio, [(z, [p for p in parts if p.body == name]) for name, z in teeth]), 0
    # As far as teeth of the rack meet the pinion, from one end to the other, and no farther than a turn.
    once = meshing(pair.contact_ratio, [])
    pitches = min(MOST_PITCHES, pair.pinion.teeth, pair.rack.teeth - once.followed - 1)
    frames = Meshing(pair.contact_ratio, max(once.followed, pitches), False)
    return frames, frames.pitches // 2


def _turns(pair: GearPair | RackPair, roll: Real) -> Iterator[Column]:
    (name, other), own = pair.names, roll - np.tan(pair.driver.pressure_angle)
    words = "turn since a flank's pitch point was on the line of action"
    yield Column(f"{name}_turn", "deg", words, np.degrees(own))
    if isinstance(pair, RackPair):
        yield Column(f"{other}_way", "mm", "way of the rack since", own * pair.driver.pitch_radius)
    else:
        yield Column(f"{other}_turn", "deg", f"turn of the {other} since", np.degrees(own / pair.ratio))


def _contact(pair: GearPair | RackPair, frames: Meshing) -> Iterator[Column]:
    """Of the pair of flanks that is followed."""
    gear = pair.driver
    along = pair.contact_lengths[0] + gear.base_pitch * frames.since
    yield Column("along", "mm", f"place of a contact on the line of action, from the {pair.names[0]}", along)
    yield Column(f"{pair.names[0]}_radius", "mm", "radius of that contact", np.hypot(gear.base_radius, along))
    for name, sliding in zip(pair.names, pair.sliding(along)):
        yield Column(f"{name}_sliding", "", f"specific sliding of the {name} there", finite(sliding))
    yield Column("pairs", "", "pairs of flanks in contact", np.isfinite(frames.all_since).sum(axis=0))


@checked
def planetary_scene(gears: PlanetarySet, table: Table, parts: Sequence[Part] = ()) -> Scene:
    """A sun that drives planets in a ring that stands still, at the rows of a table.

    table: `sun_angle`, deg, and `time`. parts: of the bodies sun, planet, ring and carrier; each planet is one.
    Derived here.
    """
    parts, motor = apart(parts)
    turn = np.radians(np.asarray(table["sun_angle"], dtype=float))
    sun, planets, ring = gears.poses(turn)
    # It stands still but for whole pitches, by which its place as seen from a planet jumps.
    ring = Pose(ring.origin, np.full(turn.shape, np.asarray(ring.direction)[0]))
    still, arm = np.zeros(turn.shape, complex), np.exp(1j * turn / gears.ratios["sun to carrier"])
    names = ["planet"] if gears.planets == 1 else [f"planet {k + 1}" for k in range(gears.planets)]
    poses = {"carrier": Pose(still, arm), "sun": sun, "ring": ring} | dict(zip(names, planets))
    poses["ground"] = Pose(still, still + 1)
    # A base lies against the gears, and the carrier on their other side.
    layers = {"carrier": 2 if any(part.body == "ground" for part in parts) else 0}
    bodies = bodies_at(parts, poses, dict.fromkeys(names, "planet"), layers)
    away, (inner, outer) = 1j * gears.inner.centre_distance, (LineOfAction(p) for p in (gears.inner, gears.outer))
    start, end = (complex(away - np.conj(outer.place(z))) for z in gears.outer.contact_lengths)
    curves = [
        SceneCurve(Circle(0j, gears.inner.working_radii[0]), "pitch", "pitch circle of the sun"),
        SceneCurve(Circle(0j, gears.outer.working_radii[1]), "pitch", "pitch circle of the ring"),
        SceneCurve(Circle(0j, abs(away)), "construction", "way of the planets"),
        *gear_dimensions(gears.sun, 0j, "sun"),
        centre_distance(0j, away),
        *(SceneCurve(Circle(0j, gears.inner.working_radii[1]), "pitch", f"pitch circle of {n}", n) for n in names),
        # Seen along the first arm both contacts stay on their lines; the ring's is that of a planet turning back.
        SceneCurve(inner.between(*gears.inner.contact_lengths), "contact", "contact of sun and planet", "carrier"),
        SceneCurve(Segment(start, end), "contact", "contact of planet and ring", "carrier"),
    ]
    marks = [SceneMark("fixed pin", still, "construction", "axis of the sun")]
    marks += [
        SceneMark("pin", np.asarray(pose.origin), "construction", f"axis of {n}") for n, pose in zip(names, planets)
    ]
    headers = [column.header for column in table.columns if column.name in ("carrier_angle", "planet_angle")]
    plots = (Plot("angles", tuple(headers)),) if headers else ()
    time = np.asarray(table["time"], dtype=float)
    return Scene(table, time, np.ones(turn.shape, bool), on_motor(bodies, motor), tuple(curves), tuple(marks), plots)


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


def _axis(frames: Meshing, place: complex, label: str) -> SceneMark:
    return SceneMark("fixed pin", np.full(frames.frame.shape, place), "construction", label)


def _scene(
    table: Table,
    frames: Meshing,
    bodies: tuple[SceneBody, ...],
    curves: Iterable[SceneCurve],
    marks: Iterable[SceneMark],
    plots: tuple[Plot, ...],
) -> Scene:
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
