"""A gear of any tooth form and the mate it shapes as a scene: both in mesh, and the paths on which they touch."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..arguments import checked
from ..gear.conjugate.conjugate import Conjugate
from ..part import Part
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, Pose, Real
from ..scene import Plot, Scene, SceneCurve, SceneMark
from ..table import Column, Table
from .dimensions import centre_distance
from .gear import bodies_at, contact_marks
from .meshing import meshing
from .motor import apart, on_motor


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
    parts, motor = apart(parts)
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
    bodies = on_motor(bodies_at(parts, poses, layers=layers), motor)
    return Scene(table, frames.time, always, bodies, tuple(curves), tuple(marks), plots, frames.cyclic)


@dataclass(frozen=True, eq=False)
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
