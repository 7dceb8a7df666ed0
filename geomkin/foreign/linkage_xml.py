"""Mechanisms of the program Linkage (`.linkage2`): connectors with positions, and links that name them, in XML."""

from __future__ import annotations

import re
from xml.etree import ElementTree

from ..core.errors import printable
from .drawn import MOST, Drawn, DrawnSlot, number, refuse

# The program draws 96 units an inch.
UNIT = 25.4 / 96
LOOKS = {"id", "selected", "name", "layer", "color", "measurementelement", "alwaysmanual"}
CONNECTORS = {*LOOKS, "x", "y", "anchor", "input", "draw", "rpm", "slider", "drawcircle", "slideradius"}
LINKS = {*LOOKS, "linesize", "solid", "locked", "throw", "cpm", "actuator", "gear"}
# Bits of `layer` that belong to the mechanism; the others are drawings beside it.
MECHANISM = 0xFFFFFFF0
NUMBER = re.compile(r"[+-]?\d{1,9}(\.\d{1,18})?")


def read(text: str, file: str) -> Drawn:
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
            refuse(file, "ratios", "gears and chains turn links", "remove them; use a machine with a gear-train")
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
        known(link, LINKS, file)
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
    slots = tuple(slot_of(connector, places, links, fixed, file) for connector in sliders)
    notes = ("Drawings, colours and limits of slides are left out.",)
    # A positive speed is clockwise there.
    driver, rpm = inputs[0]
    return Drawn("Linkage", places, frozenset(fixed), tuple(links), driver, -rpm or -15.0, 360.0, slots, 1.0, notes)


def slot_of(
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
