"""Gears in mesh as scenes: pairs, a pinion on its rack, planets round a sun."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..arguments import checked
from ..gear.pair import GearPair
from ..gear.planetary import PlanetarySet
from ..gear.rack import RackPair
from ..part import Part
from ..plane.primitives import Circle, Segment
from ..plane.vec import Pose, Real
from ..scene import Plot, Scene, SceneCurve, SceneMark
from ..table import Column, Table, finite
from .dimensions import centre_distance, gear_dimensions
from .gear import axis_mark, bodies_at, contact_marks, meshing_scene
from .line_of_action import LineOfAction
from .meshing import MOST_PITCHES, Meshing, meshing
from .motor import apart, on_motor


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
    marks = [axis_mark(frames, 0j, f"axis of the {name}")]
    if isinstance(pair, GearPair):
        marks.append(axis_mark(frames, away, f"axis of the {other}"))
        curves += (*gear_dimensions(pair.second, away, other), centre_distance(0j, away))
    marks += contact_marks(line.place(start + gear.base_pitch * frames.all_since))
    plots = (
        Plot("specific sliding", (f"{name}_sliding", f"{other}_sliding")),
        Plot("pairs of flanks in contact", ("pairs",)),
        Plot("place of contact on the line of action", ("along_mm",)),
    )
    columns = (*_turns(pair, roll), *_contact(pair, frames))
    return meshing_scene(Table(columns), frames, on_motor(bodies_at(parts, poses), motor), curves, marks, plots)


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
    # Of a speed that changes no time is known: then it is shown in two seconds.
    time = time if np.isfinite(time).all() else np.linspace(0, 2, len(time))
    return Scene(table, time, np.ones(turn.shape, bool), on_motor(bodies, motor), tuple(curves), tuple(marks), plots)
