"""Sizes as lines from one end to the other, with their number: of links between pins, of cams, of gears."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

import numpy as np

from ..gear.contract import AbstractInvoluteGear
from ..plane.primitives import Segment
from ..plane.vec import Array
from ..scene import SceneCurve

if TYPE_CHECKING:
    # A gear's scene needs neither, and both take as long to load as all that it needs.
    from ..cam.cam import Cam
    from ..linkage.linkage import Linkage

# Of a linkage's size: what is shorter is no size, but rounding.
NOTHING = 1e-9
# Directions, deg, of the diameters of tip, pitch and root circle: apart, and off the line from axis to axis.
TIP, PITCH, ROOT = 20.0, 50.0, 155.0
# Direction of a base radius, deg: off the follower, and off its pivot.
BASE = 215.0


def dimension(start: complex, end: complex, words: str, body: str = "") -> SceneCurve:
    """A length on a body, mm in its frame; words: the number as it stands in the drawing, then what it is."""
    return SceneCurve(Segment(start, end), "dimension", words, body)


def mm(length: float) -> str:
    """A length with its unit, to five digits."""
    return f"{length:.5g} mm"


def link_dimensions(linkage: Linkage) -> Iterator[SceneCurve]:
    """Every link between its joints, and how far a slide passes by the first joint of the body that it is on."""
    least = NOTHING * float(np.max(linkage.size))
    joints = {name: _joints(linkage, name) for name in linkage.bodies}
    for body, places in joints.items():
        # Of many joints the distances to the next say all that is wanted.
        pairs = combinations(places.items(), 2) if len(places) <= 3 else pairwise(places.items())
        for (one, start), (other, end) in pairs:
            if abs(end - start) > least:
                words = f"{mm(abs(end - start))}, {one} to {other}".replace("_", " ")
                yield dimension(start, end, words, body)
    for slider in linkage.sliders:
        line = complex(np.asarray(slider.direction))
        for name, place in list(joints[slider.along].items())[:1]:
            away = 1j * line * float(np.imag(np.conj(line) * (complex(slider.through) - place)))
            if abs(away) > least:
                words = f"offset {mm(abs(away))}, of {slider.name} from {name}".replace("_", " ")
                yield dimension(place, place + away, words, slider.along)


def _joints(linkage: Linkage, body: str) -> dict[str, complex]:
    """Pins of a body, and points that it slides by, mm."""
    places: dict[str, complex | Array] = {n: z for n, z in linkage.bodies[body].items() if n in linkage.pins}
    places |= {slider.name: slider.point for slider in linkage.sliders if slider.body == body}
    return {name: complex(np.asarray(place)) for name, place in places.items()}


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
