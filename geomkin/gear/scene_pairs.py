"""A gear of any tooth form and the mate it shapes as a scene: both in mesh, and the paths on which they touch."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.records import record
from ..making.motors import split_motor_parts, with_motor_plate
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneCurve, SceneMark
from ..model.table import Column, Table, finite
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle, Polyline, Segment
from ..plane.vec import Complex, Pose, Real
from .conjugate.conjugate import Conjugate
from .pair import GearPair
from .planetary import PlanetarySet
from .rack import RackPair
from .scene import (
    MOST_PITCHES,
    Meshing,
    axis_mark,
    bodies_at,
    centre_distance,
    contact_marks,
    gear_dimensions,
    meshing,
    meshing_scene,
)


@checked
def conjugate_scene(
    mate: Conjugate, contacts: Table, parts: Sequence[Part] = (), pins: Sequence[AbstractCurve] = ()
) -> Scene:
    """A gear turning counterclockwise and its mate, over as many pitches as it takes to follow a tooth's contact.

    contacts: as `flank_table` or `pin_table` tells them, of right-hand flanks, which the mate drives. parts: of the
    mate's body, mate or ring, of the gear's, and of the ground, whose x axis is the line from axis to axis. pins:
    drawn on the gear, of which no part is cut. Teeth stand in the middle of spaces: play is seen half on either side.
    Derived here.
    """
    parts, motor = split_motor_parts(parts)
    ratio = mate.gear_teeth / mate.teeth * (1 if mate.is_ring else -1)
    touching = _Touching(contacts, ratio, mate.gear_teeth)
    other = "ring" if mate.is_ring else "mate"
    name = next((part.body for part in parts if part.body not in (other, "ground")), "gear")
    wheels = ((mate.gear_teeth, name), (mate.teeth, other))
    frames = meshing(touching.pitches, [(z, [p for p in parts if p.body == body]) for z, body in wheels])
    turn = touching.first + touching.pitch * frames.passed
    still, away = np.zeros(turn.shape, complex), complex(mate.pose.origin)
    poses = {
        name: Pose(still, np.exp(1j * turn)),
        other: Pose(still + away, mate.pose.direction * np.exp(1j * ratio * turn)),
    }
    places = [place for since in frames.all_since for place in touching.at(since, touching.place)]
    curves = [
        SceneCurve(
            Circle(0j, mate.pitch_radius * mate.gear_teeth / mate.teeth), "pitch", f"pitch circle of the {name}"
        ),
        SceneCurve(Circle(away, mate.pitch_radius), "pitch", f"pitch circle of the {other}"),
        *(SceneCurve(path, "contact", "path of contact") for path in touching.paths()),
        *(SceneCurve(pin, "construction", "pin", name) for pin in pins),
        centre_distance(0j, away),
    ]
    marks = [
        SceneMark("fixed pin", still, "construction", f"axis of the {name}"),
        SceneMark("fixed pin", still + away, "construction", f"axis of the {other}"),
        *contact_marks(np.array(places)),
    ]
    followed = {n: touching.at(frames.since, np.asarray(contacts[n]))[0] for n in ("pressure_angle", "sliding")}
    table = Table(
        (
            Column(f"{name}_turn", "deg", f"turn of the {name}, 0 with a tooth on +y", np.degrees(turn)),
            Column(f"{other}_turn", "deg", f"turn of the {other} meanwhile", np.degrees(ratio * turn)),
            Column("pressure_angle", "deg", "of a tooth's contact", followed["pressure_angle"].real),
            Column("sliding", "mm/rad", "along the mate's flank there, per turn of the gear", followed["sliding"].real),
            Column("contacts", "", "contacts of right-hand flanks", np.isfinite(places).sum(axis=0)),
        )
    )
    plots = (
        Plot("pressure angle", ("pressure_angle_deg",)),
        Plot("sliding", ("sliding_mm_per_rad",)),
        Plot("contacts of right-hand flanks", ("contacts",)),
    )
    always = np.ones(turn.shape, bool)
    poses["ground"] = Pose(still, still + 1j)
    # Of two discs with pins between them the lower one is shown.
    layers = {}
    if pins:
        layers = {name: 1, other: 2} if any(part.body == "ground" for part in parts) else {name: 0}
    bodies = with_motor_plate(bodies_at(parts, poses, layers=layers), motor)
    return Scene(table, frames.time, always, bodies, tuple(curves), tuple(marks), plots, frames.cyclic)


@record(eq=False)
class _Touching:
    """When and where the places on a tooth's flank touch that a table tells, (places,), and what lies between them."""

    contacts: Table
    ratio: float
    teeth: int

    @property
    def pitch(self) -> float:
        """rad of the gear."""
        return 2 * np.pi / self.teeth

    @property
    def angle(self) -> Real:
        """Turn of the gear, the play shared by both sides of its teeth, rad; nan where a place never touches."""
        angle: Real = np.radians(np.asarray(self.contacts["mate_angle"], dtype=float)) / self.ratio
        return angle

    @property
    def place(self) -> Complex:
        """Path of contact, mm."""
        return np.asarray(self.contacts["contact_x"]) + 1j * np.asarray(self.contacts["contact_y"])

    @property
    def first(self) -> float:
        """Turn of the gear at which a tooth begins to touch, rad; 0 where none does."""
        found = self.angle[np.isfinite(self.angle)]
        return float(found.min()) if found.size else 0.0

    @property
    def pitches(self) -> float:
        """For which a tooth touches."""
        found = self.angle[np.isfinite(self.angle)]
        return float(np.ptp(found)) / self.pitch if found.size else 0.0

    def at(self, since: Real, values: Complex | Real) -> Complex:
        """Of contacts of one tooth so many pitches since its first, (frames,), the values, (contacts, frames).

        At least one row; nan where there is no contact. A flank may touch in several places at once.
        """
        angle = self.first + self.pitch * since
        low, high = self.angle[:-1], self.angle[1:]
        with np.errstate(invalid="ignore", divide="ignore"):
            share = (angle[:, None] - low) / (high - low)
        between = (share >= 0) & (share < 1)
        # The last place of all, where a contact ends, is no start of a stretch.
        between[:, -1] |= share[:, -1] == 1
        number = np.cumsum(between, axis=1) - 1
        found = np.full((max(1, int(number.max(initial=-1)) + 1), len(since)), np.nan, dtype=complex)
        frame, k = np.nonzero(between)
        found[number[frame, k], frame] = values[k] + share[frame, k] * (values[k + 1] - values[k])
        return found

    def paths(self) -> Iterator[Polyline]:
        """The path of contact, in as many pieces as it has."""
        known = np.isfinite(self.angle)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
        for start, end in zip(edges[::2].tolist(), edges[1::2].tolist()):
            if end - start > 1:
                yield Polyline(self.place[start:end], is_closed=False)


@record
class LineOfAction:
    """That of a pair whose driver turns counterclockwise about the origin.

    Lengths along it, mm, are measured from the driver's base circle; the pitch point lies on +y of the driver, of a
    rack on -y. Derived here.
    """

    pair: GearPair | RackPair

    @property
    def angle(self) -> float:
        """Working pressure angle, rad."""
        return self.pair.driver.pressure_angle if isinstance(self.pair, RackPair) else self.pair.working_pressure_angle

    @property
    def side(self) -> int:
        """1 where the other lies on +y of the driver, or is a ring round it; -1 where it is a rack below."""
        return -1 if isinstance(self.pair, RackPair) else 1

    @property
    def pitch_point(self) -> float:
        """Length at which the line passes the line of centres, mm."""
        return self.pair.driver.base_radius * float(np.tan(self.angle))

    @property
    def flank_turn(self) -> float:
        """Turn of the driver, less the roll angle of its contact, rad, within half a pitch of none."""
        driver = self.pair.driver
        # It touches with the left-hand flank of the tooth on +y, or with that of one half a turn on.
        opposite = 0.0 if self.side > 0 or driver.teeth % 2 == 0 else np.pi / driver.teeth
        return opposite - self.angle - driver.tooth.half_angle(driver.base_radius)

    def place(self, along: ArrayLike) -> Complex:
        """Points of the line, mm, at lengths along it."""
        ahead = np.exp(1j * (np.pi - self.angle))
        return np.asarray(self.side * ahead * (np.asarray(along) - 1j * self.pair.driver.base_radius))

    def between(self, start: float, end: float) -> Segment:
        """A stretch of the line."""
        return Segment(complex(self.place(start)), complex(self.place(end)))

    def circles(self) -> Iterator[SceneCurve]:
        """Pitch and base circles of both, those that roll on each other; of a rack its pitch line."""
        driver, pair = self.pair.driver, self.pair
        name, other = pair.names
        if isinstance(pair, RackPair):
            half = pair.rack.teeth * pair.rack.pitch / 2
            radius = driver.pitch_radius
            yield SceneCurve(
                Segment(complex(-half, -radius), complex(half, -radius)), "pitch", f"pitch line of the {other}"
            )
        else:
            radius, across = pair.working_radii
            centre = complex(0, -pair.centre_distance if pair.is_internal else pair.centre_distance)
            yield SceneCurve(Circle(centre, across), "pitch", f"pitch circle of the {other}")
            yield SceneCurve(Circle(centre, pair.second.base_radius), "construction", f"base circle of the {other}")
        yield SceneCurve(Circle(0j, radius), "pitch", f"pitch circle of the {name}")
        yield SceneCurve(Circle(0j, driver.base_radius), "construction", f"base circle of the {name}")


@checked
def pair_scene(pair: GearPair | RackPair, parts: Sequence[Part] = ()) -> Scene:
    """Two gears in mesh, or a pinion and its rack, over as many pitches as it takes to follow a pair of flanks.

    The driver turns counterclockwise. Teeth stand in the middle of spaces, as the pair's `poses` have them, and
    contacts are those of the driver's own flanks: the play that the pair has is seen half on either side. parts: of
    bodies named as the pair's `names`, and plates of the ground, whose x axis is the line from axis to axis, or runs as
    the rack. Derived here.
    """
    parts, motor = split_motor_parts(parts)
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
    return meshing_scene(Table(columns), frames, with_motor_plate(bodies_at(parts, poses), motor), curves, marks, plots)


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
    parts, motor = split_motor_parts(parts)
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
    return Scene(
        table, time, np.ones(turn.shape, bool), with_motor_plate(bodies, motor), tuple(curves), tuple(marks), plots
    )
