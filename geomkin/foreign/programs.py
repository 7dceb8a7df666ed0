"""Mechanisms of other programs: JSON of pylinkage, links of PMKS+ and XML of Linkage, as they were drawn."""

from __future__ import annotations

import cmath
import json
import math
import re
from collections.abc import Collection
from pathlib import Path
from typing import Any
from urllib.parse import unquote
from xml.etree import ElementTree

from ..core.errors import FileError, printable
from .drawn import MOST, Drawn, DrawnSlot, number, recipe_of, refuse

# The program draws 96 units an inch.
UNIT = 25.4 / 96
LOOKS = {"id", "selected", "name", "layer", "color", "measurementelement", "alwaysmanual"}
CONNECTORS = {*LOOKS, "x", "y", "anchor", "input", "draw", "rpm", "slider", "drawcircle", "slideradius"}
LINK_ATTRIBUTES = {*LOOKS, "linesize", "solid", "locked", "throw", "cpm", "actuator", "gear"}
# Bits of `layer` that belong to the mechanism; the others are drawings beside it.
MECHANISM = 0xFFFFFFF0
NUMBER = re.compile(r"[+-]?\d{1,9}(\.\d{1,18})?")


def read_linkage(text: str, file: str) -> Drawn:
    """The linkage of a file of Linkage."""
    if "<!" in text.replace("<!--", ""):
        refuse(file, "", "it declares entities, which files of Linkage do not", "save it again in Linkage")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, RecursionError, ValueError):
        refuse(file, "", "it is not XML", "save it again in Linkage")
    if root.tag != "linkage2":
        refuse(file, printable(root.tag), "it is not a file of Linkage", "save it as .linkage2")
    elements: dict[str, list[ElementTree.Element]] = {"program": [], "connector": [], "Link": [], "selected": []}
    for element in root:
        kind = {"element": "Link"}.get(element.tag, element.tag)
        if kind == "ratios" and len(element):
            refuse(file, "ratios", "gears and chains turn links", "remove them; give [[linkage.meshes]] or a machine")
        if kind not in (*elements, "ratios"):
            refuse(file, printable(element.tag), "this element is not known", "save it as .linkage2")
        elements.setdefault(kind, []).append(element)
    if len(elements["connector"]) > MOST or len(elements["Link"]) > MOST:
        refuse(file, "", "there are too many connectors or links", f"give at most {MOST} of each", "too-much-work")
    scale = (
        max(1.0, float(int(numeric(elements["program"][0], "scalefactor", file, 1.0)))) if elements["program"] else 1.0
    )
    places: dict[str, complex] = {}
    fixed, inputs, sliders = [], [], []
    for connector in filter(is_mechanism, elements["connector"]):
        id = connector.get("id", "")
        known(connector, CONNECTORS, file)
        if id in places or not id.isdecimal():
            refuse(file, f"connector {id}", "its id is missing or given twice", "save it again in Linkage", "conflict")
        places[id] = scale * UNIT * complex(numeric(connector, "x", file), numeric(connector, "y", file))
        fixed += [id] * (connector.get("anchor") == "true")
        inputs += [(id, numeric(connector, "rpm", file, 15.0))] * (connector.get("input") == "true")
        sliders += [connector] * (connector.get("slider") == "true")
    links: list[tuple[str, tuple[str, ...]]] = []
    for link in filter(is_mechanism, elements["Link"]):
        known(link, LINK_ATTRIBUTES, file)
        name = f"link {link.get('id', '')}"
        for kind, remedy in (("actuator", "give a slide and [stroke] yourself"), ("gear", "use a gear-train")):
            if link.get(kind) == "true":
                refuse(file, name, f"it is of the kind {kind}", f"remove it, and {remedy}")
        if odd := next((child for child in link if child.tag != "connector"), None):
            refuse(file, name, f"{printable(odd.tag)} is not known", "unfasten it in Linkage")
        joints = tuple(child.get("id", "") for child in link if child.get("id") in places)
        links.append((link.get("name") or link.get("id") or "", joints))
    if len(inputs) != 1:
        named = ", ".join(id for id, _ in inputs) or "none"
        refuse(file, "input", f"connectors {named} are inputs", "let one connector be an input", "conflict")
    slots = tuple(slot_of_slider(connector, places, links, fixed, file) for connector in sliders)
    notes = ("Drawings, colours and limits of slides are left out.",)
    # A positive speed is clockwise there.
    driver, rpm = inputs[0]
    return Drawn("Linkage", places, frozenset(fixed), tuple(links), driver, -rpm or -15.0, 360.0, slots, 1.0, notes)


def slot_of_slider(
    connector: ElementTree.Element,
    places: dict[str, complex],
    links: list[tuple[str, tuple[str, ...]]],
    fixed: list[str],
    file: str,
) -> DrawnSlot:
    """The slot in which a connector slides, between its two limits."""
    id = connector.get("id", "")
    limits = [child.get("id", "") for child in connector if child.tag == "slidelimit"]
    if numeric(connector, "slideradius", file, 0.0):
        refuse(file, f"connector {id}", "it slides along an arc", "use a link about the centre of the arc")
    if len(limits) != 2 or any(limit not in places for limit in limits):
        refuse(file, f"connector {id}", "it slides between no two connectors", "give its two limits in Linkage")
    one, two = (places[limit] for limit in limits)
    on_frame = all(limit in fixed for limit in limits)
    return DrawnSlot(id, () if on_frame else tuple(limits), one, two - one or 1 + 0j)


def is_mechanism(element: ElementTree.Element) -> bool:
    """Whether an element moves, and is not a drawing or a measure."""
    layer = element.get("layer", "0")
    drawn_beside = layer.isdecimal() and len(layer) < 12 and int(layer) != 0 and not int(layer) & MECHANISM
    return not drawn_beside and element.get("measurementelement") != "true"


def known(element: ElementTree.Element, attributes: set[str], file: str) -> None:
    """Refuse attributes that are not understood."""
    if odd := sorted(set(element.attrib) - attributes):
        what = f"{element.tag} {element.get('id', '')}"
        refuse(file, printable(what), f"{printable(odd[0])} is not known", "remove it in Linkage")


def numeric(element: ElementTree.Element, name: str, file: str, missing: float | None = None) -> float:
    """A number among the attributes of an element."""
    text = element.get(name)
    if text is None and missing is not None:
        return missing
    if text is None or not NUMBER.fullmatch(text):
        refuse(file, printable(f"{element.tag} {element.get('id', '')}"), f"{name} is not a number", "save it again")
    return number(file, name, float(text))


DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
# Inch, cm and m by their digit, in mm.
UNITS = {"0": 25.4, "1": 10.0, "2": 1000.0}
COPY = "copy the whole link from PMKS+ again"


def read_pmks(text: str, file: str) -> Drawn:
    """The linkage of a link of PMKS+."""
    content = unquote(text.strip().partition("?")[2] or text.strip())
    content, check = content[:-1], content[-1:]
    if not check or DIGITS[:62].find(check) != len(content) % 62:
        refuse(file, "", "it is neither JSON nor a .linkage2 file nor a whole link", COPY)
    settings, joint_rows, link_rows, force_rows = sections(content, file)
    flags, _, whole, units = settings
    if len(joint_rows) + len(link_rows) > MOST:
        refuse(file, "", f"there are {len(joint_rows) + len(link_rows)} joints and links", f"give at most {MOST}")
    if units[:1] not in UNITS:
        refuse(file, "units", f"the unit of length {printable(units[:1])} is not known", COPY)
    unit = UNITS[units[:1]]
    places: dict[str, complex] = {}
    inputs, fixed, slides = [], set(), {}
    for row in joint_rows:
        bits, id, _, x, y, angle = fields(row, 6, 1, file)
        places[id] = unit / 1000 * complex(*(number(file, id, value(part, file)) for part in (x, y)))
        is_slide, is_input, is_fixed, *_ = (DIGITS.find(bits) >> k & 1 for k in range(5))
        inputs += [id] * is_input
        if is_slide:
            slides[id] = (bool(is_fixed), value(angle, file) / 1000)
        elif is_fixed:
            fixed.add(id)
    links: list[tuple[str, tuple[str, ...]]] = []
    pistons: list[tuple[str, tuple[str, ...]]] = []
    for row in link_rows:
        root, sort = row[:1], row[1:2]
        _, name, *rest = row[2:].split(",")
        joints = tuple(rest[5 : rest.index("", 5)] if "" in rest[5:] else rest[5:])
        if sort not in ("R", "P") or len(joints) < 1 or any(joint not in places for joint in joints):
            refuse(file, printable(row[:20]), "this link names joints that are not in the file", COPY)
        # Links of a welded one are stated again by themselves; the welded link has all their joints.
        if root == "Y":
            (links if sort == "R" else pistons).append((name, joints))
    if len(inputs) != 1:
        refuse(file, "input", f"{len(inputs)} joints are inputs", "let one joint be the input", "conflict")
    if inputs[0] in slides:
        refuse(
            file, inputs[0], "a slide is the input", "let a link turn about a fixed joint, or give [stroke] yourself"
        )
    slots = tuple(slot_of(name, joints, slides, links, places, file) for name, joints in pistons)
    for slide in slides:
        del places[slide]
    links = [(name, tuple(joint for joint in joints if joint not in slides)) for name, joints in links]
    rpm = abs(value(whole.partition(",")[0], file)) or 10.0
    notes = ["Masses are those of the plates, and colours are left out."]
    notes += [f"{len(force_rows)} forces of the file are left out: see [loads]."] * bool(force_rows)
    clockwise = DIGITS.find(flags[-1:]) & 1
    speed = -rpm if clockwise else rpm
    return Drawn("PMKS+", places, frozenset(fixed), tuple(links), inputs[0], speed, 360.0, slots, 1.0, tuple(notes))


def slot_of(
    name: str,
    joints: tuple[str, ...],
    slides: dict[str, tuple[bool, float]],
    links: list[tuple[str, tuple[str, ...]]],
    places: dict[str, complex],
    file: str,
) -> DrawnSlot:
    """The slot of a piston: its pin slides along the line of its slide, in the frame or another link."""
    pins, lines = [j for j in joints if j not in slides], [j for j in joints if j in slides]
    if len(pins) != 1 or len(lines) != 1:
        refuse(file, printable(name), "this piston has not one pin and one slide", "draw it so in PMKS+", "conflict")
    is_fixed, angle = slides[lines[0]]
    guide = next((tuple(j for j in other if j not in slides) for _, other in links if lines[0] in other), ())
    if not is_fixed and len(guide) < 2:
        refuse(file, lines[0], "this slide is on no link and not on the frame", "draw it so in PMKS+", "conflict")
    return DrawnSlot(pins[0], () if is_fixed else guide, places[lines[0]], cmath.rect(1.0, angle))


def sections(content: str, file: str) -> tuple[list[str], list[str], list[str], list[str]]:
    """The four settings, and the rows of joints, links and forces."""
    parts = content.split(".")
    settings, rest = parts[:4], parts[4:]
    lists = []
    for _ in range(3):
        if "" not in rest:
            refuse(file, "", "the link lacks its joints, links or forces", COPY)
        end = rest.index("")
        lists.append(rest[:end])
        rest = rest[end + 1 :]
    return settings, lists[0], lists[1], lists[2]


def fields(row: str, count: int, flags: int, file: str) -> list[str]:
    """The values of a row, its flags first."""
    found = [row[:flags], *row[flags:].split(",")]
    if len(found) != count or row[:flags] not in DIGITS:
        refuse(file, printable(row[:20]), f"this joint has {len(found) - 1} values", COPY)
    return found


def value(text: str, file: str) -> float:
    """A whole number of base 64; a zero before it makes it negative."""
    if not text or len(text) > 12 or set(text) - set(DIGITS):
        refuse(file, printable(text), "this is not a number of PMKS+", COPY)
    amount = 0
    for digit in text:
        amount = 64 * amount + DIGITS.index(digit)
    return float(-amount if text[0] == "0" else amount)


JOINTS = {"id", "type", "position", "name", "axis", "line_point", "slide_distance"}
TRACKERS = {"ref_joint1_id", "ref_joint2_id", "distance", "angle"}
LINK_KEYS = {"id", "type", "joints", "name", "angular_velocity", "initial_angle", "motor_joint", "arc_start", "arc_end"}
LEGACY = {"Static", "Crank", "Revolute", "Fixed", "Linear", "Pivot"}
AGAIN = "save it again with pylinkage's mechanism_to_json"


def read_pylinkage(text: str, file: str) -> Drawn:
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
        unknown(link, LINK_KEYS, f"link {printable(id)}", file)
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


# Largest file, bytes.
LARGEST = 1_000_000


def imported(path: Path) -> str:
    """The text of a recipe with the linkage of a file of pylinkage, PMKS+ or Linkage.

    Parameters
    ----------
    path : Path
        JSON of pylinkage's `mechanism_to_json`, a text file with a link that PMKS+ shares, or a `.linkage2` file.

    Returns
    -------
    str
        A recipe of the kind `linkage`, with the linkage where it was drawn.

    Raises
    ------
    FileError
        If the file cannot be read.
    RecipeError
        If it holds something that is not understood, which the message names.
    """
    try:
        with path.open("rb") as opened:
            content = opened.read(LARGEST + 1)
    except OSError as error:
        raise FileError(path, f"cannot be read ({error.strerror})", "give a file", "file-unreadable") from error
    file = str(path)
    if len(content) > LARGEST:
        refuse(file, "", f"it is larger than {LARGEST:,} bytes", "give the file of one linkage", "too-much-work")
    try:
        text = content.decode("utf-8-sig").strip()
    except UnicodeDecodeError:
        refuse(file, "", "it is not UTF-8 text", "save it again", "file-unreadable")
    if not text:
        refuse(file, "", "it is empty", "save it again", "file-unreadable")
    reader = {"{": read_pylinkage, "<": read_linkage}.get(text[:1], read_pmks)
    return recipe_of(reader(text, file), file)
