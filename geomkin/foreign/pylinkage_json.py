"""Mechanisms that pylinkage saves as JSON: joints with positions, and links that name their joints."""

from __future__ import annotations

import cmath
import json
import math
from collections.abc import Collection
from typing import Any

from ..core.errors import printable
from .drawn import MOST, Drawn, DrawnSlot, number, refuse

JOINTS = {"id", "type", "position", "name", "axis", "line_point", "slide_distance"}
TRACKERS = {"ref_joint1_id", "ref_joint2_id", "distance", "angle"}
LINKS = {"id", "type", "joints", "name", "angular_velocity", "initial_angle", "motor_joint", "arc_start", "arc_end"}
LEGACY = {"Static", "Crank", "Revolute", "Fixed", "Linear", "Pivot"}
AGAIN = "save it again with pylinkage's mechanism_to_json"


def read(text: str, file: str) -> Drawn:
    """The linkage of a file of pylinkage."""
    try:
        data = json.loads(text, parse_constant=lambda _: None)
    except (ValueError, RecursionError):
        refuse(file, "", "it is not JSON", AGAIN)
    joints = entries(data, "joints", file)
    links = entries(data, "links", file)
    unknown(data, {"name", "joints", "links", "ground"}, "the file", file)
    places: dict[str, complex] = {}
    fixed: set[str] = set()
    trackers = []
    slots = []
    for joint in joints:
        id, sort = text_of(joint, "id", file), joint.get("type", "revolute")
        if sort in LEGACY:
            refuse(file, id, "the file has the older format of pylinkage, with parents of joints", AGAIN)
        if sort not in ("ground", "revolute", "prismatic", "tracker"):
            refuse(file, id, f"a joint of type {printable(sort)} is not known", "use pins, slides and trackers")
        unknown(joint, JOINTS | (TRACKERS if sort == "tracker" else set()), f"joint {printable(id)}", file)
        if id in places:
            refuse(file, id, "two joints have this id", "give each its own", "conflict")
        places[id] = point(joint.get("position"), f"{id}.position", file)
        if sort == "ground":
            fixed.add(id)
        elif sort == "tracker":
            trackers.append((id, text_of(joint, "ref_joint1_id", file), text_of(joint, "ref_joint2_id", file), joint))
        elif sort == "prismatic":
            axis = point(joint.get("axis", [1, 0]), f"{id}.axis", file)
            through = point(joint.get("line_point", [0, 0]), f"{id}.line_point", file)
            slots.append(DrawnSlot(id, (), through, axis or 1 + 0j))
    bodies = []
    drivers = []
    for link in links:
        id, sort = text_of(link, "id", file), link.get("type", "link")
        if sort not in ("ground", "link", "driver", "arc_driver"):
            refuse(file, id, f"a link of type {printable(sort)} is not known", "use links, a ground and one driver")
        unknown(link, LINKS, f"link {printable(id)}", file)
        named = link.get("joints")
        if not isinstance(named, list) or any(not isinstance(joint, str) or joint not in places for joint in named):
            refuse(file, id, "its joints are not joints of the file", AGAIN, "unknown-key")
        fixed |= set(named if sort == "ground" else [])
        if sort != "ground":
            bodies.append((id, tuple(named)))
        if sort.endswith("driver"):
            drivers.append(link)
    if len(drivers) != 1:
        refuse(file, "links", f"{len(drivers)} links drive", "let one link drive", "conflict")
    for id, one, two, joint in trackers:
        places[id] = tracked(id, one, two, joint, places, file)
        holder = next((k for k, (_, named) in enumerate(bodies) if one in named and two in named), None)
        if holder is None:
            refuse(file, id, "it follows joints of no common link", "let it follow two joints of one link", "conflict")
        bodies[holder] = (bodies[holder][0], (*bodies[holder][1], id))
    scale = scale_of(places.values())
    motor = text_of(drivers[0], "motor_joint", file)
    fixed.add(motor)
    note = f"pylinkage has no unit: one unit is {scale:g} mm here; change scale."
    speed = math.copysign(60.0, number(file, "angular_velocity", drivers[0].get("angular_velocity", 1.0)))
    turn = arc_of(drivers[0], file) if drivers[0]["type"] == "arc_driver" else 360.0
    return Drawn("pylinkage", places, frozenset(fixed), tuple(bodies), motor, speed, turn, tuple(slots), scale, (note,))


def scale_of(places: Collection[complex]) -> float:
    """The power of ten by which a linkage is a few hundred mm large; 1 if it is of such a size as it is."""
    xs, ys = [place.real for place in places], [place.imag for place in places]
    size = math.hypot(max(xs) - min(xs), max(ys) - min(ys))
    return 10.0 ** round(math.log10(150 / size)) if size and not 20 <= size <= 2000 else 1.0


def arc_of(driver: dict[str, Any], file: str) -> float:
    """The angle of an arc from its start, deg, at which the linkage must be drawn."""
    start, end = (number(file, name, driver.get(name, 0.0)) for name in ("arc_start", "arc_end"))
    first = driver.get("initial_angle")
    if first is not None and abs(number(file, "initial_angle", first) - start) > 1e-6:
        refuse(file, text_of(driver, "id", file), "it is drawn inside its arc", "save it at the start of the arc")
    return math.degrees(end - start)


def tracked(id: str, one: str, two: str, joint: dict[str, Any], places: dict[str, complex], file: str) -> complex:
    """The position of a point that follows two joints."""
    if one not in places or two not in places or places[one] == places[two]:
        refuse(file, id, "it follows no two joints of the file", AGAIN, "unknown-key")
    distance, angle = (number(file, f"{id}.{name}", joint.get(name, 0.0)) for name in ("distance", "angle"))
    return places[one] + cmath.rect(distance, cmath.phase(places[two] - places[one]) + angle)


def entries(data: object, key: str, file: str) -> list[dict[str, Any]]:
    """The joints or links of the file."""
    listed = data.get(key) if isinstance(data, dict) else None
    if not isinstance(listed, list) or not listed or not all(isinstance(entry, dict) for entry in listed):
        refuse(file, key, "the file has none", AGAIN, "missing-key")
    if len(listed) > MOST:
        refuse(file, key, f"there are {len(listed)}", f"give at most {MOST}", "too-much-work")
    return listed


def unknown(entry: dict[str, Any], known: set[str], what: str, file: str) -> None:
    """Refuse keys that are not understood."""
    if odd := sorted(set(entry) - known):
        refuse(file, odd[0], f"this key of {what} is not known", "remove what it states, and save the file again")


def text_of(entry: dict[str, Any], key: str, file: str) -> str:
    """A text of an entry."""
    value = entry.get(key)
    if not isinstance(value, str) or not value:
        refuse(file, key, "it is not given as a text", AGAIN, "missing-key")
    return value


def point(value: object, key: str, file: str) -> complex:
    """A point, given as two numbers."""
    if not isinstance(value, list) or len(value) != 2 or None in value:
        refuse(file, key, "it is not two numbers", "solve one position in pylinkage, and save again", "wrong-type")
    return complex(*(number(file, key, part) for part in value))
