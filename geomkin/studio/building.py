"""A linkage that is built by hand: each edit, such as a dyad on two points, changes the text of a recipe."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import count
from typing import Any

import numpy as np
import tomlkit

from ..core.errors import DesignError, GeomkinError, shown
from ..core.fields import FARTHEST, to_digits
from ..core.units import UNITS, LengthUnit
from ..export.still import kept_frames
from ..linkage.kinds.linkages import AbstractLinkageRecipe
from ..linkage.kinds.moved import BodyList, TriangleCorner, branch_of, with_corners
from ..linkage.linkage import Linkage
from ..linkage.motion import Motion
from ..linkage.moving import move
from ..model.scene import Scene, SceneCurve, SceneHandle, SceneMark
from ..model.table import Column, Table
from ..plane.primitives import Segment
from ..recipe.keys import edited_text
from ..recipe.load import in_mm
from ..recipe.recipe import AbstractRecipe
from ..recipe.toml import parsed

# A linkage without links, to begin with.
EMPTY = """kind = "linkage"

[linkage]

[linkage.bodies]
ground = {}
"""
# The sheet on which an unfinished linkage is drawn, mm: its lower left and upper right corner.
SHEET = (-120 - 80j, 120 + 80j)
# A direction that is this near to a multiple of RIGHT is that multiple, deg.
NEARLY, RIGHT = 4.0, 15
# Length of a lever beyond the pin in its slot, in distances of the two; size of a new force, N.
BEYOND, FORCE = 1.3, 10.0
# Distance, in sizes of the linkage, by which a point may be away from where it was drawn.
AWAY = 2e-3
# Largest number of bodies of a linkage that is built by hand, and of points of a body.
MOST_BODIES, MOST_POINTS = 60, 40

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
    forces : tuple of mappings
        New forces, as in the recipe.
    loose : mapping of str to complex
        Points that belong to no body yet.
    """

    bodies: Mapping[str, Points]
    poses: Mapping[str, Pose]
    driver: str = ""
    sliders: tuple[Mapping[str, Any], ...] = ()
    slots: tuple[Mapping[str, Any], ...] = ()
    forces: tuple[Mapping[str, Any], ...] = ()
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
        named = {*self.bodies, *self.places, *(joint["name"] for joint in (*self.sliders, *self.slots))}
        taken = {name.casefold() for name in named}
        letters = (f"{chr(65 + k % 26)}{k // 26 or ''}" for k in count())
        names = (f"{noun}_{k}" for k in count(1)) if noun else letters
        return next(name for name in names if name.casefold() not in taken)


# --- one function for every edit: from the structure and its clicks to the structure after it -----------------------


@dataclass(frozen=True)
class Clicks:
    """What was clicked: each with `at`, its place, and `point` or `body`, the name of what is there.

    grid: to which new places are rounded, mm.
    """

    on: Sequence[Mapping[str, Any]]
    grid: float

    def place(self, k: int) -> complex:
        """Where the click is, on the grid."""
        at = self.on[k]["at"]
        return complex(*(round(float(x) / self.grid) * self.grid for x in at))

    def body(self, k: int, structure: Structure) -> str:
        """The body that was clicked, or that of the point; the ground for an empty place."""
        body = self.on[k].get("body") or next(iter(structure.bodies_at(self.on[k].get("point", ""))), structure.ground)
        if body not in structure.bodies:
            raise DesignError("build", f"found {shown(body)}", f"give one of {', '.join(structure.bodies)}")
        return str(body)

    def point(self, k: int, structure: Structure) -> tuple[Structure, str]:
        """The point that was clicked; otherwise a new one, on the body that was clicked, or loose."""
        point = self.on[k].get("point")
        if point:
            if point not in structure.places:
                raise DesignError("build", f"found {shown(point)}", f"give one of {', '.join(structure.places)}")
            return structure, str(point)
        name, place = structure.new_name(""), self.place(k)
        if self.on[k].get("body"):
            return structure.with_point(self.body(k, structure), name, place), name
        return replace(structure, loose={**structure.loose, name: place}), name

    def points(self, structure: Structure, number: int, is_held: bool = False) -> tuple[Structure, list[str]]:
        """The first points; if `is_held`, new ones are on the ground."""
        names: list[str] = []
        for k in range(number):
            structure, name = self.point(k, structure)
            if is_held and name in structure.loose:
                structure = structure.with_point(structure.ground, name, structure.loose[name])
            names.append(name)
        if len(set(names)) < len(names):
            raise DesignError("build", "the same point was clicked twice", "click different points", "conflict")
        return structure, names

    def angle(self, k: int, start: complex) -> float:
        """Direction from a place to a click, deg; to the right if they are equal."""
        arm = complex(*self.on[k]["at"]) - start
        angle = float(np.degrees(np.angle(arm))) if abs(arm) > self.grid else 0.0
        right = RIGHT * round(angle / RIGHT)
        return float(right) if abs(angle - right) < NEARLY else round(angle, 1)


def _pivot(structure: Structure, clicks: Clicks) -> Structure:
    structure, (point,) = clicks.points(structure, 1)
    return structure.with_point(structure.ground, point, structure.places[point])


def _link(structure: Structure, clicks: Clicks, corners: int) -> Structure:
    structure, points = clicks.points(structure, corners)
    return structure.with_body("bar" if corners == 2 else "plate", points)[0]


def _dyad(structure: Structure, clicks: Clicks) -> Structure:
    """Two bars, from two points to a third; new ends are on the ground."""
    structure, (one, two) = clicks.points(structure, 2, is_held=True)
    structure, middle = clicks.point(2, structure)
    if middle in (one, two):
        raise DesignError("build", "the same point was clicked twice", "click different points", "conflict")
    structure, _ = structure.with_body("bar", (one, middle))
    return structure.with_body("bar", (two, middle))[0]


def _slide(structure: Structure, clicks: Clicks) -> Structure:
    """A bar from a point to a block that slides along a line of the ground, or of a body at the second click."""
    structure, (end,) = clicks.points(structure, 1, is_held=True)
    along, place = clicks.body(1, structure), clicks.place(1)
    pin: str = clicks.on[1].get("point", "")
    if not pin:
        pin = structure.new_name("")
        structure = replace(structure, loose={**structure.loose, pin: place})
    else:
        along, place = structure.ground, structure.places[pin]
    if pin != end:
        structure, _ = structure.with_body("bar", (end, pin))
    structure, block = structure.with_body("block", (pin,))
    on_block, on_line = structure.poses[block], structure.poses[along]
    angle = clicks.angle(2, place) - _degrees(on_line[1])
    slider = {"name": structure.new_name("slide"), "body": block, "along": along}
    sizes = {
        "point": structure.local(block, place),
        "through": structure.local(along, place),
        "direction_deg": angle,
        "angle_deg": _degrees(on_block[1] / on_line[1]) - angle,
    }
    return replace(structure, sliders=(*structure.sliders, {**slider, **sizes}))


def _guide(structure: Structure, clicks: Clicks) -> Structure:
    """A straight slot in the ground for a pin."""
    point, body = _held_point(structure, clicks)
    return _with_slot(structure, body, point, structure.ground, point, clicks.angle(1, structure.places[point]))


def _lever(structure: Structure, clicks: Clicks) -> Structure:
    """A lever on a pivot, with a slot for a pin."""
    pin, body = _held_point(structure, clicks)
    structure, (_, pivot) = clicks.points(structure, 2, is_held=True)
    places = structure.places
    arm, tip = places[pin] - places[pivot], structure.new_name("")
    structure = replace(structure, loose={**structure.loose, tip: places[pivot] + BEYOND * arm})
    structure, lever = structure.with_body("lever", (pivot, tip))
    return _with_slot(structure, body, pin, lever, pivot, _degrees(arm))


def _held_point(structure: Structure, clicks: Clicks) -> tuple[str, str]:
    """The point of a moving body that was clicked first, and the body."""
    point = clicks.on[0].get("point", "")
    moving = [body for body in structure.bodies_at(point) if body != structure.ground]
    if not moving:
        raise DesignError("build", "no point of a moving body was clicked", "click the pin first", "conflict")
    return point, moving[0]


def _with_slot(structure: Structure, body: str, pin: str, along: str, through: str, angle: float) -> Structure:
    slot = {
        "name": structure.new_name("slot"),
        "body": body,
        "pin": pin,
        "along": along,
        "through": structure.local(along, structure.places[through]),
        "direction_deg": angle - _degrees(structure.poses[along][1]),
    }
    return replace(structure, slots=(*structure.slots, slot))


def _trace(structure: Structure, clicks: Clicks) -> Structure:
    """A point of the first body that was clicked, at the second click."""
    body = clicks.body(0, structure)
    if body == structure.ground:
        raise DesignError("build", "no moving body was clicked", "click the body of the point first", "conflict")
    return structure.with_point(body, structure.new_name(""), clicks.place(1))


def _force(structure: Structure, clicks: Clicks) -> Structure:
    """A force on a point of a moving body, in the direction of the second click."""
    structure, point = clicks.point(0, structure)
    point, body = _held_point(structure, replace(clicks, on=[{"point": point}]))
    arm = complex(np.exp(1j * np.radians(clicks.angle(1, structure.places[point]))))
    force = [to_digits(FORCE * part, 3) for part in (arm.real, arm.imag)]
    return replace(structure, forces=(*structure.forces, {"body": body, "point": point, "force_n": force}))


def _driver(structure: Structure, clicks: Clicks) -> Structure:
    body = clicks.body(0, structure)
    if body == structure.ground:
        raise DesignError("build", "no moving body was clicked", "click the body that is to drive", "conflict")
    return replace(structure, driver=body)


def _delete(structure: Structure, clicks: Clicks) -> Structure:
    """Removes a point, a slide or a body, and what is nothing without it."""
    clicked, bodies = clicks.on[0], dict(structure.bodies)
    sliders = [s for s in structure.sliders if s["name"] != clicked.get("slide")]
    gone = {s["body"] for s in structure.sliders if s not in sliders and len(bodies[s["body"]]) < 2}
    if point := clicked.get("point"):
        bodies = {body: {p: z for p, z in points.items() if p != point} for body, points in bodies.items()}
        # A bar with one end is nothing, unless it slides.
        runs = {body for s in (*structure.sliders, *structure.slots) for body in (s["body"], s["along"])}
        for body in structure.bodies_at(point):
            gone |= {body} if len(bodies[body]) < (1 if body in runs else 2) else set()
    elif "body" in clicked:
        gone.add(clicked["body"])
    gone.discard(structure.ground)
    bodies = {body: points for body, points in bodies.items() if body not in gone}
    sliders = [s for s in sliders if not {s["body"], s["along"]} & gone]
    slots = [s for s in structure.slots if not {s["body"], s["along"]} & gone and s["pin"] in bodies[s["body"]]]
    driver = structure.driver if structure.driver in {*bodies, *(s["name"] for s in sliders)} else ""
    poses = {body: structure.poses[body] for body in bodies}
    return replace(structure, bodies=bodies, poses=poses, driver=driver, sliders=tuple(sliders), slots=tuple(slots))


def _driven(structure: Structure) -> Structure:
    """The structure with a driver, if a body turns on the ground and none drives."""
    ground = structure.bodies[structure.ground]
    pivoted = (body for body, points in structure.bodies.items() if {*points} & {*ground} and points is not ground)
    return structure if structure.driver else replace(structure, driver=next(pivoted, ""))


# Edits by name, with the number of clicks of each.
EDITS: Mapping[str, tuple[int, Callable[[Structure, Clicks], Structure]]] = {
    "pivot": (1, _pivot),
    "bar": (2, partial(_link, corners=2)),
    "plate": (3, partial(_link, corners=3)),
    "dyad": (3, _dyad),
    "slide": (3, _slide),
    "guide": (2, _guide),
    "lever": (2, _lever),
    "trace": (2, _trace),
    "force": (2, _force),
    "driver": (1, _driver),
    "delete": (1, _delete),
}


def _degrees(direction: complex) -> float:
    return float(np.degrees(np.angle(direction)))


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


# --- the change of the text -----------------------------------------------------------------------------------------


class LinkageText:
    """The text of a linkage that is built, and what the page shows of it.

    Parameters
    ----------
    text : str
        The recipe, TOML.
    table : mapping
        The same, parsed.
    opened : callable
        The recipe of a text, as it is written, without its scale; raises GeomkinError if it is none.
    recipe : AbstractRecipe, optional
        The recipe of this text, as it is written.
    """

    def __init__(
        self,
        text: str,
        table: Mapping[str, Any],
        opened: Callable[[str], AbstractRecipe],
        recipe: AbstractRecipe | None,
    ):
        self.text, self.table, self.opened = text, table, opened
        self.recipe = recipe if isinstance(recipe, AbstractLinkageRecipe) else None
        self.unit: LengthUnit = UNITS[table.get("units", "mm")]
        self.scale = float(table.get("scale", 1.0))
        if recipe is None and unfinished(table) is None:
            raise DesignError("build", "this text is no linkage", "correct it, or undo", "conflict")
        if recipe is not None and self.recipe is None:
            remedy = "open its linkage, or start a new one"
            raise DesignError("build", f"a {table.get('kind')} is not built by clicks", remedy, "conflict")

    def edited(self, edit: Mapping[str, Any]) -> str:
        """The text after an edit, as `built` takes it."""
        do, on, frame, step = edit.get("do"), edit.get("on", ()), edit.get("frame", 0), edit.get("step", 0.1)
        if do == "rename":
            return self._renamed(edit.get("old"), edit.get("new"))
        number, change = EDITS.get(do, (0, None)) if isinstance(do, str) else (0, None)
        if change is None or not _are_clicks(on, number) or not isinstance(frame, int) or not _is_size(step):
            problem, names = f"found {shown(do)} with {shown(on)}", ", ".join(EDITS)
            raise DesignError("build", problem, f"give one of {names} with the places of its clicks", "wrong-type")
        before, text = self._structure(frame), self.text
        if len(before.bodies) >= MOST_BODIES:
            raise DesignError("build", f"it has {len(before.bodies)} bodies", "start another linkage", "too-much-work")
        grid = nice(step / self.scale / self.unit.mm) * self.unit.mm
        scaled = [{**click, "at": [x / self.scale for x in click["at"]]} for click in on]
        after = _driven(change(before, Clicks(scaled, grid)))
        if self.table.get("kind") != "linkage":
            text = edited_text(text, {"kind": "linkage", "linkage": self._general(before)})
        digits = max(0, 2 - math.floor(math.log10(grid / self.unit.mm)))
        text = edited_text(text, self._changes(before, after, digits))
        if "loads" in self.table and not any(parsed(text)["loads"].values()):
            # Loads that are all gone are no loads.
            text = edited_text(text, {"loads": None})
        return self._settled(text, after, digits)

    def moved(self, point: str, to: complex, step: float) -> str:
        """The text of an unfinished linkage with a point elsewhere."""
        structure, grid = self._structure(0), nice(step / self.scale / self.unit.mm) * self.unit.mm
        place = Clicks([{"at": (to.real / self.scale, to.imag / self.scale)}], grid).place(0)
        after = structure
        for body in structure.bodies_at(point):
            after = after.with_point(body, point, place)
        digits = max(0, 2 - math.floor(math.log10(grid / self.unit.mm)))
        changes = self._changes(structure, after, digits)
        if point in self.table["linkage"].get("estimate", {}):
            changes[f"linkage.estimate.{point}"] = self._pair(place, digits)
        return edited_text(self.text, changes)

    def _structure(self, frame: int) -> Structure:
        structure = unfinished(self.table) if self.recipe is None else structure_at(self.recipe, frame)
        if structure is None:
            raise DesignError("build", "this text is no linkage", "correct it, or undo", "conflict")
        return structure

    def _pair(self, place: complex, digits: int) -> list[float | int]:
        return [plain(round(self.unit.in_digits(part, "mm"), digits)) for part in (place.real, place.imag)]

    def _value(self, value: Any, digits: int) -> Any:
        if isinstance(value, complex):
            return self._pair(value, digits)
        return plain(round(value, 6)) if isinstance(value, float) else value

    def _points(self, points: Points, digits: int) -> Any:
        table = tomlkit.inline_table()
        table.update({name: self._pair(place, digits) for name, place in points.items()})
        return table

    def _joint(self, joint: Mapping[str, Any], digits: int) -> Any:
        """A slide without the values that are 0 by default."""
        return _row({name: self._value(value, digits) for name, value in joint.items() if value != 0})

    def _general(self, structure: Structure) -> Any:
        """The table of a named linkage as one of bodies."""
        linkage: Linkage = self.recipe.linkage.linkage  # type: ignore[union-attr]
        table, bodies = tomlkit.table(), tomlkit.table()
        table["driver"] = structure.driver
        if linkage.origin:
            table["origin"] = self._pair(complex(linkage.origin), 12)
        if linkage.ground_angle_deg:
            table["ground_angle_deg"] = linkage.ground_angle_deg
        for body, points in structure.bodies.items():
            bodies[body] = self._points(points, 12)
        table["bodies"] = bodies
        for key, joints in (("sliders", structure.sliders), ("slots", structure.slots)):
            if joints:
                table[key] = [self._joint(joint, 12) for joint in joints]
        return table

    def _changes(self, before: Structure, after: Structure, digits: int) -> dict[str, Any]:
        """The difference of two structures as values by dotted key."""
        changes: dict[str, Any] = {}
        if after.driver != before.driver:
            changes["linkage.driver"] = after.driver or None
            ends = self._pair(complex(*after.stroke), digits) if after.stroke else None
            changes["stroke"] = {"start": ends[0], "end": ends[1]} if ends else None
        for body, points in after.bodies.items():
            old = before.bodies.get(body)
            if not old:
                changes[f"linkage.bodies.{body}"] = self._points(points, digits)
                continue
            for point, place in points.items():
                if old.get(point) != place:
                    changes[f"linkage.bodies.{body}.{point}"] = self._pair(place, digits)
            changes |= {f"linkage.bodies.{body}.{point}": None for point in old if point not in points}
        changes |= {f"linkage.bodies.{body}": None for body in before.bodies if body not in after.bodies}
        joints = (("sliders", before.sliders, after.sliders), ("slots", before.slots, after.slots))
        for key, were, are in joints:
            gone = [k for k, joint in enumerate(were) if joint not in are]
            changes |= {f"linkage.{key}[{k}]": None for k in gone[::-1]}
            kept = len(were) - len(gone)
            changes |= {f"linkage.{key}[{k}]": self._joint(joint, digits) for k, joint in enumerate(are) if k >= kept}
        if after.forces:
            forces = self.table.get("loads", {}).get("forces", [])
            force = _row(after.forces[0])
            changes |= {f"loads.forces[{len(forces)}]": force} if forces else {"loads.forces": [force]}
        return changes | dict(_without(self.table, _names(before) - _names(after), changes))

    def _settled(self, text: str, structure: Structure, digits: int) -> str:
        """The text with the branches, and the estimate if it takes one, with which it moves from where it is drawn."""
        places = structure.held
        estimate = {p: self._pair(z, digits) for p, z in places.items()}
        pinned = {p: z for p, z in estimate.items() if len(structure.bodies_at(p)) > 1}
        start = 0 if structure.stroke else plain(round(math.degrees(structure.drive), 6))
        turn = {"drive.start_deg": start, "drive.end_deg": plain(start + 360)} if start else {}
        # A linkage that is no chain of dyads takes an estimate of its first position; another driver makes other dyads.
        guesses: list[dict[str, Any]] = [{"linkage.estimate": None}, {"linkage.estimate": pinned, **turn}]
        for changes in (*guesses, *(guess | {"branches": None} for guess in guesses)):
            settled = edited_text(text, changes)
            try:
                recipe = self.opened(settled)
                if not isinstance(recipe, AbstractLinkageRecipe):
                    return text
                least = _misplaced(recipe, structure.drive, places)
            except GeomkinError:
                continue
            if least <= len(places):
                return self._on_branch(settled, recipe, structure, least)
        return text if structure.is_as_drawn else edited_text(text, {"linkage.estimate": estimate})

    def _on_branch(self, text: str, recipe: AbstractLinkageRecipe, structure: Structure, least: int) -> str:
        """The text with the signs of joints that bring most points to where they are drawn; least: misplaced ones."""
        places = structure.held
        for joint in (joint.name for joint in recipe.linkage.linkage.joints):
            sign = recipe.branches.get(joint, 1 if recipe.branch == "follow" else recipe.branch)
            if not least or isinstance(sign, complex):
                continue
            turned = edited_text(text, {f"branches.{joint}": -int(sign)})
            try:
                other = self.opened(turned)
                found = _misplaced(other, structure.drive, places)  # type: ignore[arg-type]
            except GeomkinError:
                continue
            if found < least:
                text, least = turned, found
        return text

    def _renamed(self, old: object, new: object) -> str:
        """The text with another name of a body, a point or a slide."""
        structure = self._structure(0)
        kinds = {
            "body": set(structure.bodies),
            "point": set(structure.places),
            "joint": {joint["name"] for joint in (*structure.sliders, *structure.slots)},
        }
        of = [kind for kind, names in kinds.items() if old in names]
        if not isinstance(old, str) or not isinstance(new, str) or len(of) != 1 or not new.strip():
            problem = f"found {shown(old)} to {shown(new)}"
            raise DesignError("build", problem, "give the name of one thing, and another name", "unknown-key")
        if new in set().union(*kinds.values()):
            raise DesignError("build", f"{shown(new)} is the name of something else", "give another name", "conflict")
        text = self.text
        if self.table.get("kind") != "linkage":
            text = edited_text(text, {"kind": "linkage", "linkage": self._general(structure)})
        changes: dict[str, Any] = {}
        if of[0] != "joint":
            bodies = tomlkit.table()
            for body, points in tomlkit.parse(text)["linkage"]["bodies"].items():
                renamed = tomlkit.inline_table()
                renamed.update({new if p == old and of[0] == "point" else p: z for p, z in points.items()})
                bodies[new if body == old and of[0] == "body" else body] = renamed
            changes["linkage.bodies"] = bodies
        changes |= dict(_mentions(tomlkit.parse(text).unwrap(), old, new))
        return edited_text(text, changes)


# Tables of a recipe that name bodies, points and joints, and keys that an edit changes itself.
OWN = ("linkage.bodies.", "linkage.sliders", "linkage.slots", "linkage.driver")
NAMING = ("linkage", "branches", "loads", "dwell", "tolerances", "foot", "stock")


def _names(structure: Structure) -> set[str]:
    joints = (joint["name"] for joint in (*structure.sliders, *structure.slots))
    return {*structure.bodies, *structure.places, *joints}


def _walked(value: Any, key: str) -> Iterator[tuple[str, Any, bool]]:
    """Every text and key below a key, with its own key, and whether it is a text; lists from their ends."""
    if isinstance(value, Mapping):
        for name, held in value.items():
            yield f"{key}.{name}" if key else name, name, False
            yield from _walked(held, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for k in range(len(value))[::-1]:
            yield from _walked(value[k], f"{key}[{k}]")
    elif isinstance(value, str):
        yield key, value, True


def _mentions(table: Mapping[str, Any], old: str, new: str) -> Iterator[tuple[str, Any]]:
    """Changes of the texts and keys that are a name, outside of the bodies themselves."""
    for key, name, is_value in _walked({k: v for k, v in table.items() if k in NAMING}, ""):
        if name != old or key.startswith("linkage.bodies."):
            continue
        if is_value:
            yield key, new
        else:
            around = key.removesuffix(f".{old}")
            held: Any = table
            for part in key.split("."):
                held = held[part] if isinstance(held, Mapping) and part in held else None
            if held is not None:
                yield key, None
                yield f"{around}.{new}", held


def _without(table: Mapping[str, Any], gone: set[str], changes: Mapping[str, Any]) -> Iterator[tuple[str, None]]:
    """Changes that remove what names something that is gone: entries of tables and rows of lists."""
    done: set[str] = set()
    for key, name, is_value in _walked({k: v for k, v in table.items() if k in NAMING}, ""):
        if name not in gone or key.startswith(
            ("linkage.bodies.", "linkage.sliders", "linkage.slots", "linkage.driver")
        ):
            continue
        # The row of the list that has the name, or the key itself.
        row = key[: key.index("]") + 1] if is_value and "]" in key else key
        if row not in done and row not in changes:
            done.add(row)
            yield row, None


def _misplaced(recipe: AbstractLinkageRecipe, drive: float, places: Points) -> int:
    """The number of points that are not where they are drawn, with the driver where it is drawn."""
    general = recipe.linkage.linkage
    motion: Motion = move(general, np.array([drive]), branch_of(recipe.branch, recipe.branches))
    if not motion.assembled[0]:
        return len(places) + 1
    size = AWAY * float(np.max(general.size) or 1.0)
    return sum(abs(complex(motion.point(p).position[0]) - z) > size for p, z in places.items())


def nice(step: float) -> float:
    """The next of 1, 2, 5, 10 ... that is at least a step."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(to_digits(factor * power, 3) for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))


def plain(value: float) -> float | int:
    """A number as a recipe states it: a whole one without a point."""
    return int(value) if float(value).is_integer() and abs(value) < 2**53 else float(value)


def _row(values: Mapping[str, Any]) -> Any:
    """A table of a list, after an empty line."""
    row = tomlkit.item(dict(values))
    row.trivia.indent = "\n"
    return row


def _is_size(step: object) -> bool:
    return isinstance(step, int | float) and not isinstance(step, bool) and 1e-9 < step < FARTHEST


def _are_clicks(on: object, number: int) -> bool:
    """Whether these are as many clicks as an edit takes, each a place, perhaps with names."""
    if not isinstance(on, Sequence) or isinstance(on, str) or len(on) != number:
        return False
    for click in on:
        at = click.get("at") if isinstance(click, Mapping) else None
        if not isinstance(at, Sequence) or isinstance(at, str) or len(at) != 2:
            return False
        if not all(isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= FARTHEST for x in at):
            return False
        if not all(isinstance(click.get(name, ""), str) for name in ("point", "body", "slide")):
            return False
    return True


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
