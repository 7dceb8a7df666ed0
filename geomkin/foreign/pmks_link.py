"""Linkages that PMKS+ shares as a link: its text after the question mark holds joints, links and forces."""

from __future__ import annotations

import cmath
from urllib.parse import unquote

from ..core.errors import printable
from .drawn import MOST, Drawn, DrawnSlot, number, refuse

DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-"
# Inch, cm and m by their digit, in mm.
UNITS = {"0": 25.4, "1": 10.0, "2": 1000.0}
COPY = "copy the whole link from PMKS+ again"


def read(text: str, file: str) -> Drawn:
    """The linkage of a link of PMKS+."""
    content = unquote(text.strip().partition("?")[2] or text.strip())
    content, check = content[:-1], content[-1:]
    if not check or DIGITS[:62].find(check) != len(content) % 62:
        refuse(file, "", "the link is not complete", COPY)
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
