"""A linkage in one position, finished or not: read from a recipe or a text that is none yet, and drawn."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from ..core.errors import GeomkinError
from ..core.units import UNITS
from ..export.still import kept_frames
from ..linkage.kinds.linkages import AbstractLinkageRecipe
from ..linkage.kinds.moved import BodyList, TriangleCorner, with_corners
from ..model.scene import Scene, SceneCurve, SceneHandle, SceneMark
from ..model.table import Column, Table
from ..plane.primitives import Segment
from ..recipe.load import in_mm

# The sheet on which an unfinished linkage is drawn, mm: its lower left and upper right corner.
SHEET = (-120 - 80j, 120 + 80j)
# Largest number of bodies of a linkage that is built by hand.
MOST_BODIES = 60

Pose = tuple[complex, complex]
Points = Mapping[str, complex]


@dataclass(frozen=True)
class Structure:
    """A linkage, finished or not, in the position in which it is shown; lengths in mm before `scale`.

    Parameters
    ----------
    bodies : mapping of str to mapping of str to complex
        Points of each body in its frame, the ground first.
    poses : mapping of str to (complex, complex)
        Origin and direction of each body's frame.
    driver : str
        Name of the driven body or slider; "" if there is none.
    sliders, slots : tuple of mappings
        As in the recipe, with complex points.
    loads : tuple of (str, mapping)
        New loads, each with its key in `loads`, such as `forces`.
    loose : mapping of str to complex
        Points that belong to no body yet.
    """

    bodies: Mapping[str, Points]
    poses: Mapping[str, Pose]
    driver: str = ""
    sliders: tuple[Mapping[str, Any], ...] = ()
    slots: tuple[Mapping[str, Any], ...] = ()
    loads: tuple[tuple[str, Mapping[str, Any]], ...] = ()
    loose: Points = field(default_factory=dict)

    @property
    def ground(self) -> str:
        """Name of the fixed body."""
        return next(iter(self.bodies))

    @property
    def places(self) -> dict[str, complex]:
        """Positions of all points as shown."""
        return {**self.loose, **self.held}

    @property
    def held(self) -> dict[str, complex]:
        """Positions of the points of bodies as shown."""
        return {p: self.position(body, z) for body, points in self.bodies.items() for p, z in points.items()}

    @property
    def joints(self) -> tuple[Mapping[str, Any], ...]:
        """Slides, then slots."""
        return (*self.sliders, *self.slots)

    @property
    def names(self) -> set[str]:
        """Names of bodies, points, slides and slots."""
        return {*self.bodies, *self.places, *(joint["name"] for joint in self.joints)}

    @property
    def freedom(self) -> int:
        """Degrees of freedom by counting bodies and joints (Gruebler)."""
        names = [point for points in self.bodies.values() for point in points]
        pins = len(names) - len(set(names))
        return 3 * (len(self.bodies) - 1) - 2 * pins - 2 * len(self.sliders) - len(self.slots)

    @property
    def is_as_drawn(self) -> bool:
        """Whether all frames coincide, so that every body has the coordinates of the drawing."""
        origin, direction = self.poses[self.ground]
        return all(abs(o - origin) + abs(d - direction) < 1e-9 for o, d in self.poses.values())

    @property
    def drive(self) -> float:
        """Angle of the driver from the ground in this position, rad, or its displacement, mm, if it slides."""
        if self.stroke is not None:
            return sum(self.stroke) / 2
        if self.driver not in self.bodies:
            return 0.0
        return float(np.angle(self.poses[self.driver][1] / self.poses[self.ground][1]))

    @property
    def stroke(self) -> tuple[float, float] | None:
        """Displacements of a driven slide about the present one, a fifth of the size apart; None if an angle drives."""
        ends = {self.driver, self.ground}
        driven = (s for s in self.sliders if s["name"] == self.driver or {s["body"], s["along"]} == ends)
        slide = next(driven, None)
        if slide is None:
            return None
        direction = self.poses[slide["along"]][1] * np.exp(1j * np.radians(slide["direction_deg"]))
        arm = self.position(slide["body"], slide["point"]) - self.position(slide["along"], slide["through"])
        now = float((arm * np.conj(direction)).real)
        reach = 0.1 * max(abs(z) for points in self.bodies.values() for z in points.values())
        return now - reach, now + reach

    def position(self, body: str, place: complex) -> complex:
        """A point of a body as shown."""
        origin, direction = self.poses[body]
        return complex(origin + direction * place)

    def local(self, body: str, place: complex) -> complex:
        """The same, back."""
        origin, direction = self.poses[body]
        return complex((place - origin) * np.conj(direction))

    def bodies_at(self, point: str) -> list[str]:
        """The bodies that have a point."""
        return [body for body, points in self.bodies.items() if point in points]

    def with_point(self, body: str, point: str, place: complex) -> Structure:
        """A copy in which a body has a point there."""
        points = {**self.bodies[body], point: self.local(body, place)}
        return replace(self, bodies={**self.bodies, body: points})

    def with_body(self, noun: str, points: Sequence[str]) -> tuple[Structure, str]:
        """A copy with another body at these points, and its name; a first bar on the ground drives."""
        places, is_crank = self.places, False
        if noun == "bar" and not self.driver and any(point in self.bodies[self.ground] for point in points):
            is_crank = "crank" not in self.bodies
        name = "crank" if is_crank else self.new_name(noun)
        first, *others = (places[point] for point in points)
        # On an existing linkage a bar has its length as a number.
        along = others[0] - first if others else 0j
        pose = (first, along / abs(along) if along else 1 + 0j)
        grown = replace(self, poses={**self.poses, name: self.poses[self.ground] if self.is_as_drawn else pose})
        grown = replace(grown, bodies={**self.bodies, name: {p: grown.local(name, places[p]) for p in points}})
        return (replace(grown, driver=name) if is_crank else grown), name

    def new_name(self, noun: str) -> str:
        """A name that nothing has yet, such as bar_2; of a point, without a noun, a letter."""
        taken = {name.casefold() for name in self.names}
        letters = (f"{chr(65 + k % 26)}{k // 26 or ''}" for k in count())
        names = (f"{noun}_{k}" for k in count(1)) if noun else letters
        return next(name for name in names if name.casefold() not in taken)


# --- structures of recipes, and of texts that are none yet ----------------------------------------------------------


def structure_at(recipe: AbstractLinkageRecipe, frame: int) -> Structure:
    """The structure of a recipe, as it is written, at a frame of its page."""
    motion, general = recipe.motion, recipe.linkage.linkage
    frames = kept_frames(len(motion.drive))
    row = int(frames[min(max(frame, 0), len(frames) - 1)])
    if not motion.assembled[row]:
        row = int(np.argmax(motion.assembled))
    poses = {
        name: (complex(body.origin.position[row]), complex(body.direction[row])) for name, body in motion.bodies.items()
    }
    bodies = {body: {p: complex(z) for p, z in points.items()} for body, points in general.bodies.items()}
    sliders = tuple(_joint(s, ("name", "body", "along", *s.sizes)) for s in general.sliders)
    slots = tuple(_joint(s, ("name", "body", "pin", "along", *s.sizes)) for s in general.slots)
    return Structure(bodies, poses, general.driver, sliders, slots)


def _joint(joint: Any, names: Sequence[str]) -> dict[str, Any]:
    return {name: getattr(joint, name) for name in names}


def unfinished(table: Mapping[str, Any]) -> Structure | None:
    """The structure of a text that is no recipe of a linkage yet; None if it is something else.

    Bodies are placed by `estimate`, and lie in the frame of the ground as far as that has not two of their points.
    """
    try:
        unit = UNITS[table.get("units", "mm")]
        linkage = in_mm(table["linkage"], BodyList, unit) if table.get("kind") == "linkage" else {}
        bodies = {body: _complex(points) for body, points in linkage["bodies"].items()}
        corners = [TriangleCorner(**{**c, "lengths": tuple(c["lengths"])}) for c in linkage.get("corners", ())]
        bodies = with_corners(bodies, corners)
        estimate = _complex(linkage.get("estimate", {}))
        sliders, slots = (tuple(map(_with_places, linkage.get(key, ()))) for key in ("sliders", "slots"))
        ground, *_ = bodies
        known = {body for s in (*sliders, *slots) for body in (s["body"], s["along"])}
        if not known <= set(bodies) or len(bodies) > MOST_BODIES:
            return None
        turn = cmath.rect(1.0, math.radians(linkage.get("ground_angle_deg", 0.0)))
        frame = (complex(*linkage.get("origin", (0, 0))), turn)
        driver = linkage.get("driver", "")
        if not isinstance(driver, str):
            return None
    except (GeomkinError, KeyError, TypeError, ValueError, AttributeError):
        return None
    poses = {body: frame if body == ground else _pose(points, estimate, frame) for body, points in bodies.items()}
    return Structure(bodies, poses, driver, sliders, slots)


def _complex(points: Mapping[str, Any]) -> dict[str, complex]:
    return {name: _place(place) for name, place in points.items()}


def _place(place: Any) -> complex:
    """A position; ValueError if it is none."""
    if not isinstance(place, list | tuple) or [type(x) in (int, float) for x in place] != [True, True]:
        raise ValueError
    return complex(*place)


def _with_places(slide: Mapping[str, Any]) -> dict[str, Any]:
    """A slide of a text with all its values, and its places as complex numbers."""
    defaults = {
        "through": (0, 0),
        "direction_deg": 0.0,
        **({} if "pin" in slide else {"point": (0, 0), "angle_deg": 0.0}),
    }
    whole = {**defaults, **slide}
    return {name: _place(value) if name in ("point", "through") else value for name, value in whole.items()}


def _pose(points: Points, estimate: Points, frame: Pose) -> Pose:
    """The pose of a body by the estimated positions of its points."""
    known = [name for name in points if name in estimate]
    if not known:
        return frame
    first, last = known[0], max(known, key=lambda name: abs(points[name] - points[known[0]]))
    arm, there = points[last] - points[first], estimate[last] - estimate[first]
    direction = there / abs(there) * abs(arm) / arm if arm and there else frame[1]
    return complex(estimate[first] - direction * points[first]), complex(direction)


# --- what the page shows --------------------------------------------------------------------------------------------


def is_unfinished(structure: Structure) -> bool:
    """Whether a linkage still lacks bars, joints or a driver."""
    drivers = {*structure.bodies, *(joint["name"] for joint in structure.sliders)} - {structure.ground}
    return structure.freedom != 1 or structure.driver not in drivers


def structure_data(structure: Structure) -> dict[str, Any]:
    """The names by which a click is meant: bodies with their points, and slides."""
    return {
        "ground": structure.ground,
        "driver": structure.driver,
        "bodies": {body: list(points) for body, points in structure.bodies.items()},
        "slides": [joint["name"] for joint in structure.sliders],
        "freedom": structure.freedom,
    }


def advice(structure: Structure) -> str:
    """What an unfinished linkage lacks."""
    freedom = structure.freedom
    if len(structure.bodies) < 2:
        return "add pivots, bars and dyads"
    if freedom > 1:
        return f"{freedom} degrees of freedom, 1 is needed: join its ends by a bar, a dyad, a slide or a pivot"
    if freedom < 1:
        return f"{freedom} degrees of freedom, 1 is needed: it is rigid, so delete a bar"
    return "1 degree of freedom: choose the driver"


def drawn(structure: Structure, scale: float) -> Scene:
    """An unfinished linkage as a still scene, on its sheet; scale: of the recipe."""
    row = partial(np.full, 1)
    marks: list[SceneMark] = []
    for body, points in structure.bodies.items():
        places = [scale * structure.position(body, z) for z in points.values()]
        if body != structure.ground and len(places) > 1:
            for start, end in zip(places, [*places[1:], *(places[:1] if len(places) > 2 else ())]):
                marks.append(SceneMark("line", row(start), "construction", body, vector=row(end - start)))
    for slide in structure.sliders:
        place = scale * structure.position(slide["along"], slide["through"])
        direction = structure.poses[slide["along"]][1] * np.exp(1j * np.radians(slide["direction_deg"]))
        marks.append(SceneMark("slide", row(place), "construction", slide["name"], direction=row(direction)))
    for point, place in structure.places.items():
        bodies = structure.bodies_at(point)
        where = row(scale * place)
        if structure.ground in bodies:
            marks.append(SceneMark("fixed pin", where, "construction", point))
        elif len(bodies) > 1:
            marks.append(SceneMark("pin", where, "construction", point))
        else:
            marks.append(SceneMark("point", where, "traced", point))
    low, high = SHEET
    corners = [low, complex(high.real, low.imag), high, complex(low.real, high.imag)]
    curves = tuple(SceneCurve(Segment(a, b), "construction") for a, b in zip(corners, [*corners[1:], corners[0]]))
    table = Table((Column("position", "", "as drawn", np.zeros(1)),))
    return Scene(table, np.zeros(1), np.ones(1, dtype=bool), (), curves, tuple(marks), (), False)


def point_handles(structure: Structure, scale: float) -> Iterator[SceneHandle]:
    """Handles of all points of an unfinished linkage."""
    for point, place in structure.places.items():
        keys = tuple(f"linkage.bodies.{body}.{point}" for body in structure.bodies_at(point))
        yield SceneHandle(f"point:{point}", point.replace("_", " "), keys, np.array([scale * place]))
