"""Edits of a linkage by clicks, such as a dyad on two points: a function for each, from structure to structure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from ..core.errors import DesignError, shown
from ..core.fields import FARTHEST, to_digits
from .structure import Structure

# A direction that is this near to a multiple of RIGHT is that multiple, deg.
NEARLY, RIGHT = 4.0, 15
# Length of a lever beyond the pin in its slot, in distances of the two; size of a new force, N.
BEYOND, FORCE = 1.3, 10.0
# Stiffness of a new spring, N/mm, and its length without load, in present lengths.
STIFFNESS, RELAXED = 0.5, 0.6


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


def _moving(structure: Structure, clicks: Clicks) -> str:
    """The moving body that was clicked first."""
    body = clicks.body(0, structure)
    if body == structure.ground:
        raise DesignError("build", "no moving body was clicked", "click one first", "conflict")
    return body


def _trace(structure: Structure, clicks: Clicks) -> Structure:
    """A point of the first body that was clicked, at the second click."""
    return structure.with_point(_moving(structure, clicks), structure.new_name(""), clicks.place(1))


def _force(structure: Structure, clicks: Clicks) -> Structure:
    """A force on a point of a moving body, in the direction of the second click."""
    structure, point = clicks.point(0, structure)
    point, body = _held_point(structure, replace(clicks, on=[{"point": point}]))
    arm = complex(np.exp(1j * np.radians(clicks.angle(1, structure.places[point]))))
    force = [round(FORCE * part, 2) + 0.0 for part in (arm.real, arm.imag)]
    return replace(structure, loads=(*structure.loads, ("forces", {"body": body, "point": point, "force_n": force})))


def _spring(structure: Structure, clicks: Clicks) -> Structure:
    """A spring between points of two bodies, as long without load as a part of its present length."""
    structure, names = clicks.points(structure, 2, is_held=True)
    one, two = (structure.bodies_at(name) for name in names)
    if {*one} & {*two}:
        raise DesignError("build", "both ends are on one body", "click points of two bodies", "conflict")
    length = abs(structure.places[names[1]] - structure.places[names[0]])
    spring = {"body": one[-1], "point": names[0], "to_body": two[-1], "to_point": names[1]}
    sizes = {"stiffness": STIFFNESS, "free_length": to_digits(RELAXED * length, 3)}
    return replace(structure, loads=(*structure.loads, ("springs", {**spring, **sizes})))


def _driver(structure: Structure, clicks: Clicks) -> Structure:
    return replace(structure, driver=_moving(structure, clicks))


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


def with_driver(structure: Structure) -> Structure:
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
    "spring": (2, _spring),
    "driver": (1, _driver),
    "delete": (1, _delete),
}


def _degrees(direction: complex) -> float:
    return float(np.degrees(np.angle(direction)))


def are_clicks(on: object, number: int) -> bool:
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
