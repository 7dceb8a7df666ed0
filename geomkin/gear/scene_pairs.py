"""Scenes of gear pairs, racks, planetary sets and conjugate gears: gears in mesh and their paths of contact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.records import record
from ..making.motors import split_motor_parts, with_motor_plate
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneCurve, SceneHandle, SceneMark, circle_handle, playing_time, point_handle
from ..model.table import Column, Table, finite
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle, Polyline, Segment
from ..plane.vec import Complex, Pose, Real
from .conjugate.conjugate import Conjugate
from .pair import GearPair
from .planetary import MEMBERS, Member, PlanetarySet
from .rack import RackPair
from .scene import (
    MOST_PITCHES,
    Meshing,
    axis_mark,
    bodies_at,
    centre_distance,
    contact_marks,
    gear_dimensions,
    gear_handles,
    meshing,
    meshing_scene,
    turned_scene,
)


@checked
def conjugate_scene(
    mate: Conjugate, contacts: Table, parts: Sequence[Part] = (), pins: Sequence[AbstractCurve] = ()
) -> Scene:
    """The scene of a gear that turns counterclockwise and its conjugate mate.

    Parameters
    ----------
    mate : Conjugate
        The mate.
    contacts : Table
        The result of `flank_table` or `pin_table`, for right-hand flanks, which the mate drives.
    parts : sequence of Part, optional
        Plates of the mate (body "mate" or "ring"), of the gear, and of the ground, whose x axis is the line of centres.
    pins : sequence of AbstractCurve, optional
        Curves on the gear that are drawn without a plate.

    Returns
    -------
    Scene
        The number of pitches follows the contact of one tooth. Teeth are in the middle of spaces, with half the
        backlash on each side.

    Notes
    -----
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
    columns = (
        Column(f"{name}_turn", "deg", f"rotation of the {name}, 0 with a tooth on +y", np.degrees(turn)),
        Column(f"{other}_turn", "deg", f"rotation of the {other}", np.degrees(ratio * turn)),
        *touching.columns(frames.since),
        Column("contacts", "", "number of contacts of right-hand flanks", np.isfinite(places).sum(axis=0)),
    )
    plots = (
        Plot("pressure angle", ("pressure_angle",)),
        Plot("sliding", ("sliding",)),
        Plot("contacts of right-hand flanks", ("contacts",)),
    )
    always = np.ones(turn.shape, bool)
    poses["ground"] = Pose(still, still + 1j)
    # Only the lower of two discs with pins is shown.
    layers = {}
    if pins:
        layers = {name: 1, other: 2} if any(part.body == "ground" for part in parts) else {name: 0}
    bodies = with_motor_plate(bodies_at(parts, poses, layers=layers), motor)
    return Scene(Table(columns), frames.time, always, bodies, tuple(curves), tuple(marks), plots, frames.cyclic)


@record(eq=False)
class _Touching:
    """Contacts of the points of a tooth's flank in a table, (points,), interpolated between them."""

    contacts: Table
    ratio: float
    teeth: int

    @property
    def pitch(self) -> float:
        """Angular pitch of the gear, rad."""
        return 2 * np.pi / self.teeth

    @property
    def angle(self) -> Real:
        """Rotation of the gear with equal backlash on both sides, rad; nan for points that never touch."""
        angle: Real = np.radians(np.asarray(self.contacts["mate_angle"], dtype=float)) / self.ratio
        return angle

    @property
    def place(self) -> Complex:
        """Contact points, mm."""
        return np.asarray(self.contacts["contact_x"]) + 1j * np.asarray(self.contacts["contact_y"])

    @property
    def first(self) -> float:
        """Rotation of the gear at a tooth's first contact, rad; 0 without contact."""
        angle = self.angle[np.isfinite(self.angle)]
        return float(angle.min()) if angle.size else 0.0

    @property
    def pitches(self) -> float:
        """Duration of a tooth's contact, pitches."""
        angle = self.angle[np.isfinite(self.angle)]
        return float(np.ptp(angle)) / self.pitch if angle.size else 0.0

    def at(self, since: Real, values: Complex | Real) -> Complex:
        """Values of the contacts of one tooth, (contacts, frames), at pitches since its first contact, (frames,).

        At least one row; nan for no contact. A flank may touch at several points at once.
        """
        angle = self.first + self.pitch * since
        low, high = self.angle[:-1], self.angle[1:]
        with np.errstate(invalid="ignore", divide="ignore"):
            share = (angle[:, None] - low) / (high - low)
        between = (share >= 0) & (share < 1)
        # The last point, the end of contact, does not start an interval.
        between[:, -1] |= share[:, -1] == 1
        number = np.cumsum(between, axis=1) - 1
        contacts = np.full((max(1, int(number.max(initial=-1)) + 1), len(since)), np.nan, dtype=complex)
        frame, k = np.nonzero(between)
        contacts[number[frame, k], frame] = values[k] + share[frame, k] * (values[k + 1] - values[k])
        return contacts

    def columns(self, since: Real) -> Iterator[Column]:
        """Pressure angle and sliding of the first contact of one tooth; `since` as in `at`."""
        meanings = {
            "pressure_angle": ("deg", "pressure angle of a tooth's contact"),
            "sliding": ("mm/rad", "sliding on the mate's flank, per rad of the gear"),
        }
        for id, (unit, meaning) in meanings.items():
            yield Column(id, unit, meaning, self.at(since, np.asarray(self.contacts[id]))[0].real)

    def paths(self) -> Iterator[Polyline]:
        """The pieces of the path of contact."""
        known = np.isfinite(self.angle)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
        for start, end in zip(edges[::2].tolist(), edges[1::2].tolist()):
            if end - start > 1:
                yield Polyline(self.place[start:end], is_closed=False)


@record
class LineOfAction:
    """The line of action of a pair whose driver turns counterclockwise about the origin.

    Lengths along it, mm, are measured from the driver's base circle. The pitch point is on +y of the driver, for a rack
    on -y. Derived here.
    """

    pair: GearPair | RackPair

    @property
    def angle(self) -> float:
        """Working pressure angle, rad."""
        return self.pair.driver.pressure_angle if isinstance(self.pair, RackPair) else self.pair.working_pressure_angle

    @property
    def side(self) -> int:
        """1 if the mate is on +y of the driver or a ring round it; -1 for a rack below."""
        return -1 if isinstance(self.pair, RackPair) else 1

    @property
    def pitch_point(self) -> float:
        """Length at which it crosses the line of centres, mm."""
        return self.pair.driver.base_radius * float(np.tan(self.angle))

    @property
    def flank_turn(self) -> float:
        """Rotation of the driver minus the roll angle of its contact, rad, within half a pitch of 0."""
        driver = self.pair.driver
        # Contact is on the left-hand flank of the tooth on +y, or of the opposite tooth.
        opposite = 0.0 if self.side > 0 or driver.teeth % 2 == 0 else np.pi / driver.teeth
        return opposite - self.angle - driver.tooth.half_angle(driver.base_radius)

    def place(self, along: ArrayLike) -> Complex:
        """Points of the line, mm, at lengths along it."""
        direction = np.exp(1j * (np.pi - self.angle))
        return np.asarray(self.side * direction * (np.asarray(along) - 1j * self.pair.driver.base_radius))

    def between(self, start: float, end: float) -> Segment:
        """The segment between two lengths."""
        return Segment(complex(self.place(start)), complex(self.place(end)))

    def circles(self) -> Iterator[SceneCurve]:
        """Working pitch circles and base circles of both gears; the pitch line of a rack."""
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
    """The scene of two gears in mesh, or of a pinion and its rack.

    Parameters
    ----------
    pair : GearPair or RackPair
        The pair.
    parts : sequence of Part, optional
        Plates of the bodies in the pair's `names`, and of the ground, whose x axis is the line of centres or parallel
        to the rack.

    Returns
    -------
    Scene
        The driver turns counterclockwise, and the number of pitches follows a pair of flanks. Contacts are those of the
        driver's flanks. Teeth are in the middle of spaces, with half the backlash on each side.

    Notes
    -----
    Derived here.
    """
    parts, motor = split_motor_parts(parts)
    name, other = pair.names
    gear, line, (start, end) = pair.driver, LineOfAction(pair), pair.contact_lengths
    frames, before = _frames(pair, parts)
    roll = (start + gear.base_pitch * (frames.passed - before)) / gear.base_radius
    poses = dict(zip(pair.names, pair.poses(roll + line.flank_turn)))
    ground_direction = 1j if isinstance(pair, GearPair) else 1.0 + 0j
    poses["ground"] = Pose(np.zeros(roll.shape, complex), np.full(roll.shape, ground_direction))
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
        Plot("place of contact on the line of action", ("along",)),
    )
    columns = (*_turns(pair, roll), *_contact(pair, frames))
    return meshing_scene(Table(columns), frames, with_motor_plate(bodies_at(parts, poses), motor), curves, marks, plots)


def turned_pair_scene(pair: GearPair, parts: Sequence[Part], turn: Real) -> Scene:
    """The scene of a pair as a part of a machine. turn: of the first gear, rad, (frames,)."""
    parts, motor = split_motor_parts(parts)
    poses, (name, other) = dict(zip(pair.names, pair.poses(turn))), pair.names
    still = np.zeros(turn.shape, complex)
    bodies = with_motor_plate(bodies_at(parts, poses | {"ground": Pose(still, still + 1j)}), motor)
    columns = (
        Column(f"{name}_turn", "deg", f"rotation of the {name}", np.degrees(turn)),
        Column(f"{other}_turn", "deg", f"rotation of the {other}", np.degrees(turn / pair.ratio)),
    )
    circles = (curve for curve in LineOfAction(pair).circles() if curve.role == "pitch")
    axes = {f"axis of the {body}": complex(np.asarray(pose.origin)[0]) for body, pose in poses.items()}
    return turned_scene(columns, bodies, circles, axes)


def _frames(pair: GearPair | RackPair, parts: Sequence[Part]) -> tuple[Meshing, int]:
    """Frames, and pitches before the followed contact is in the middle of a rack."""
    if isinstance(pair, GearPair):
        teeth = zip(pair.names, (pair.first.teeth, pair.second.teeth))
        return meshing(pair.contact_ratio, [(z, [p for p in parts if p.body == name]) for name, z in teeth]), 0
    # From one end of the rack to the other, and at most one turn of the pinion.
    once = meshing(pair.contact_ratio, [])
    pitches = min(MOST_PITCHES, pair.pinion.teeth, pair.rack.teeth - once.followed - 1)
    frames = Meshing(pair.contact_ratio, max(once.followed, pitches), False)
    return frames, frames.pitches // 2


def _turns(pair: GearPair | RackPair, roll: Real) -> Iterator[Column]:
    (name, other), turn = pair.names, roll - np.tan(pair.driver.pressure_angle)
    meaning = f"rotation of the {name} since contact at the pitch point"
    yield Column(f"{name}_turn", "deg", meaning, np.degrees(turn))
    if isinstance(pair, RackPair):
        yield Column(f"{other}_way", "mm", "displacement of the rack since then", turn * pair.driver.pitch_radius)
    else:
        yield Column(f"{other}_turn", "deg", f"rotation of the {other} since then", np.degrees(turn / pair.ratio))


def _contact(pair: GearPair | RackPair, frames: Meshing) -> Iterator[Column]:
    """Columns of the followed pair of flanks."""
    gear = pair.driver
    along = pair.contact_lengths[0] + gear.base_pitch * frames.since
    yield Column("along", "mm", f"contact on the line of action, from the base circle of the {pair.names[0]}", along)
    yield Column(f"{pair.names[0]}_radius", "mm", "radius of that contact", np.hypot(gear.base_radius, along))
    for name, sliding in zip(pair.names, pair.sliding(along)):
        yield Column(f"{name}_sliding", "", f"specific sliding of the {name} there", finite(sliding))
    yield Column("pairs", "", "pairs of flanks in contact", np.isfinite(frames.all_since).sum(axis=0))


@checked
def planetary_scene(
    gears: PlanetarySet, table: Table, parts: Sequence[Part] = (), driver: Member = "sun", fixed: Member = "ring"
) -> Scene:
    """The scene of a planetary set.

    Parameters
    ----------
    gears : PlanetarySet
        The gears.
    table : Table
        Columns with the rotation of the driver, such as `sun_angle`, deg, and `time`; its rows are the frames.
    parts : sequence of Part, optional
        Plates of the bodies sun, planet, ring, carrier and ground.
    driver, fixed : {"sun", "carrier", "ring"}, optional
        The member that drives, and another one that is held.

    Returns
    -------
    Scene
        Each planet is a body.

    Notes
    -----
    Derived here.
    """
    parts, motor = split_motor_parts(parts)
    turn = np.radians(np.asarray(table[f"{driver}_angle"], dtype=float))
    sun, planets, ring = gears.poses(turn, driver, fixed)
    still, arm = np.zeros(turn.shape, complex), np.exp(1j * turn * float(gears.turns(driver, fixed)["carrier"]))
    names = ["planet"] if gears.planets == 1 else [f"planet {k + 1}" for k in range(gears.planets)]
    poses = {"carrier": Pose(still, arm), "sun": sun, "ring": ring} | dict(zip(names, planets))
    poses["ground"] = Pose(still, still + 1)
    # The base is on one side of the gears, the carrier on the other.
    layers = {"carrier": 2 if any(part.body == "ground" for part in parts) else 0}
    bodies = bodies_at(parts, poses, dict.fromkeys(names, "planet"), layers)
    away, (inner, outer) = 1j * gears.inner.centre_distance, (LineOfAction(p) for p in (gears.inner, gears.outer))
    start, end = (complex(away - np.conj(outer.place(z))) for z in gears.outer.contact_lengths)
    curves = [
        SceneCurve(Circle(0j, gears.inner.working_radii[0]), "pitch", "pitch circle of the sun"),
        SceneCurve(Circle(0j, gears.outer.working_radii[1]), "pitch", "pitch circle of the ring"),
        SceneCurve(Circle(0j, abs(away)), "construction", "path of the planets"),
        *gear_dimensions(gears.sun, 0j, "sun"),
        centre_distance(0j, away),
        *(SceneCurve(Circle(0j, gears.inner.working_radii[1]), "pitch", f"pitch circle of {n}", n) for n in names),
        # In the frame of the first arm both contacts stay on fixed lines; at the ring the planet turns backwards.
        SceneCurve(inner.between(*gears.inner.contact_lengths), "contact", "contact of sun and planet", "carrier"),
        SceneCurve(Segment(start, end), "contact", "contact of planet and ring", "carrier"),
    ]
    marks = [SceneMark("fixed pin", still, "construction", "axis of the sun")]
    marks += [
        SceneMark("pin", np.asarray(pose.origin), "construction", f"axis of {n}") for n, pose in zip(names, planets)
    ]
    angles = tuple(f"{name}_angle" for name in (*MEMBERS, "planet") if name != driver and f"{name}_angle" in table.ids)
    plots = (Plot("angles", angles),) if angles else ()
    bodies, assembled = with_motor_plate(bodies, motor), np.ones(turn.shape, bool)
    return Scene(table, playing_time(table), assembled, bodies, tuple(curves), tuple(marks), plots)


def pair_handles(pair: GearPair, shifts: bool = True, distance: bool = False) -> Iterator[SceneHandle]:
    """Handles of two gears in mesh, and of the axis of the second one.

    Parameters
    ----------
    pair : GearPair
        The gears; the keys of their tables are the pair's `names`.
    shifts : bool
        Whether their profile shifts are the recipe's.
    distance : bool
        Whether the recipe gives the centre distance; otherwise the profile shifts set it.

    Returns
    -------
    iterator of SceneHandle
    """
    axis = complex(0, -pair.centre_distance if pair.is_internal else pair.centre_distance)
    modules = [f"{name}.module" for name in pair.names]
    for name, gear, radius, centre in zip(pair.names, (pair.first, pair.second), pair.working_radii, (0j, axis)):
        yield from gear_handles(gear, name, radius, centre, modules, shifts)
    keys = ("centre_distance",) if distance else tuple(f"{name}.profile_shift" for name in pair.names)
    if distance or shifts:
        yield point_handle(*keys, at=axis, label="centre distance")


def rack_handles(pair: RackPair, distance: bool = False) -> Iterator[SceneHandle]:
    """Handles of a pinion and its rack: the pinion's sizes, the rack's length in teeth, and the pinion's distance.

    Parameters
    ----------
    pair : RackPair
        Pinion and rack.
    distance : bool
        Whether the recipe gives the distance; otherwise the profile shift sets it.

    Returns
    -------
    iterator of SceneHandle
    """
    pinion, half = pair.pinion, pair.rack.teeth * pair.rack.pitch / 2
    yield from gear_handles(pinion, "pinion", modules=("pinion.module", "rack.module"))
    yield point_handle("rack.teeth", at=complex(half, -pinion.pitch_radius), label="teeth of the rack")
    key = "distance" if distance else "pinion.profile_shift"
    yield point_handle(key, at=complex(0, -pair.distance), label="distance of the reference line")


def planetary_handles(gears: PlanetarySet) -> Iterator[SceneHandle]:
    """The handle of the module of a planetary set; other numbers of teeth need those of two gears to change at once."""
    modules = [f"gears.{name}.module" for name in ("sun", "planet", "ring")]
    yield circle_handle(*modules, radius=gears.inner.working_radii[0], label="module", is_one_value=True)


def conjugate_handles(mate: Conjugate, key: str, teeth: str) -> Iterator[SceneHandle]:
    """Handles of a gear and the mate that it generates.

    Parameters
    ----------
    mate : Conjugate
        The mate.
    key : str
        Key of the gear's table in the recipe.
    teeth : str
        Name of its number of teeth or pins in that table.

    Returns
    -------
    iterator of SceneHandle
    """
    axis, radius = complex(mate.pose.origin), mate.pitch_radius * mate.gear_teeth / mate.teeth
    yield circle_handle(f"{key}.module", radius=radius, label=f"module of the {key}")
    yield circle_handle("mate.teeth", radius=mate.pitch_radius, centre=axis, label="teeth of the mate")
    yield circle_handle("mate.addendum", radius=mate.tip_radius, centre=axis, label="addendum of the mate")
    yield point_handle(f"{key}.{teeth}", at=axis, label=f"{teeth} of the {key}")
