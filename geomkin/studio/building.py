"""A linkage that is built by hand: each edit, such as a dyad on two points, changes the text of a recipe."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import tomlkit

from ..core.errors import DesignError, GeomkinError, shown
from ..core.fields import FARTHEST, to_digits
from ..core.names import check_names
from ..core.units import LengthUnit
from ..linkage.kinds.linkage_kinds import LinkageRecipe
from ..linkage.kinds.linkages import AbstractLinkageRecipe
from ..linkage.kinds.moved import branch_of
from ..linkage.linkage import Linkage
from ..linkage.motion import Motion
from ..linkage.moving import move
from ..recipe.keys import edited_text
from ..recipe.load import from_mm
from ..recipe.reader import field_of
from .clicks import EDITS, Clicks, are_clicks, with_driver
from .drafts import Draft
from .structure import MOST_BODIES, Points, Structure, structure_at, unfinished

# A linkage without links, to begin with.
EMPTY = """kind = "linkage"

[linkage]

[linkage.bodies]
ground = {}
"""
# Distance, in sizes of the linkage, by which a point may be away from where it was drawn.
AWAY = 2e-3
# Tables of a recipe that name bodies, points and joints, and keys that an edit changes itself.
NAMING = {"linkage", "branches", "stock", *(aspect.key for aspect in LinkageRecipe.aspect_kinds)}
CHANGED = ("linkage.bodies.", "linkage.sliders", "linkage.slots", "linkage.driver")


def built(draft: Draft, edit: Mapping[str, Any]) -> str:
    """The text of a linkage after an edit by hand, such as a dyad on two of its points.

    Parameters
    ----------
    draft : Draft
        The recipe of any linkage, or a text with bodies that are no linkage yet.
    edit : mapping
        `do`, a name in `geomkin.studio.clicks.EDITS`, with `on`, its clicks: each a mapping with `at`, [x, y] in mm,
        and `point`, `body` or `slide`, the name of what is there; `frame`, the position of the linkage in which they
        are meant, and `step`, the size of a pixel in mm, to which new places are rounded. Or "rename", `old` and `new`.

    Returns
    -------
    str
        The new text, of kind "linkage". A mechanism that moves still passes through the position that was shown.

    Raises
    ------
    DesignError
        If the recipe is none of a linkage, or the clicks mean nothing.

    Examples
    --------
    >>> from geomkin.studio.building import EMPTY, built
    >>> from geomkin.studio.drafts import Draft
    >>> text = built(Draft(EMPTY, {}), {"do": "bar", "on": [{"at": [0, 0]}, {"at": [30, 40]}], "step": 0.5})
    >>> text.splitlines()[-1]
    'bar_1 = {A = [0, 0], B = [30, 40]}'
    """
    do, on, frame, step = edit.get("do"), edit.get("on", ()), edit.get("frame", 0), edit.get("step", 0.1)
    if do == "rename":
        return _renamed(draft, edit.get("old"), edit.get("new"))
    number, change = EDITS.get(do, (0, None)) if isinstance(do, str) else (0, None)
    if change is None or not are_clicks(on, number) or not isinstance(frame, int) or not is_size(step):
        problem, names = f"found {shown(do)} with {shown(on)}", ", ".join(EDITS)
        raise DesignError("build", problem, f"give one of {names} with the places of its clicks", "wrong-type")
    before, (grid, writer) = _structure(draft, frame), _grid(draft, step)
    if len(before.bodies) >= MOST_BODIES:
        raise DesignError("build", f"it has {len(before.bodies)} bodies", "start another linkage", "too-much-work")
    scaled = [{**click, "at": [x / draft.scale for x in click["at"]]} for click in on]
    after = with_driver(change(before, Clicks(scaled, grid)))
    draft = _as_bodies(draft, before)
    draft = without_empty_loads(draft.with_changes(_changes(draft.table, before, after, writer)))
    return _settled(draft, after, writer).text


def without_empty_loads(draft: Draft) -> Draft:
    """The draft without a table of loads of which the last one was removed."""
    loads = draft.table.get("loads")
    return draft.with_changes({"loads": None}) if isinstance(loads, dict) and not any(loads.values()) else draft


def moved(draft: Draft, point: str, to: complex, step: float) -> str:
    """The text of an unfinished linkage with a point elsewhere."""
    structure, (grid, writer) = _structure(draft, 0), _grid(draft, step)
    place = Clicks([{"at": (to.real / draft.scale, to.imag / draft.scale)}], grid).place(0)
    after = structure
    for body in structure.bodies_at(point):
        after = after.with_point(body, point, place)
    changes = _changes(draft.table, structure, after, writer)
    if point in draft.table["linkage"].get("estimate", {}):
        changes[f"linkage.estimate.{point}"] = writer.pair(place)
    return edited_text(draft.text, changes)


def _structure(draft: Draft, frame: int) -> Structure:
    structure, recipe = None, None
    try:
        recipe = draft.written
        if isinstance(recipe, AbstractLinkageRecipe):
            return structure_at(recipe, frame)
    except GeomkinError:
        # Unfinished, or of sizes that do not move.
        structure = unfinished(draft.table)
    if recipe is not None and structure is None:
        remedy = "open its linkage, or start a new one"
        raise DesignError("build", f"a {recipe.kind} is not built by clicks", remedy, "conflict")
    if structure is None:
        raise DesignError("build", "this text is no linkage", "correct it, or undo", "conflict")
    return structure


@dataclass(frozen=True)
class _Writer:
    """Writes lengths in mm as values of a text: in its unit, with so many decimals."""

    unit: LengthUnit
    digits: int = 12

    def pair(self, place: complex) -> list[float | int]:
        return [plain(round(self.unit.in_digits(part, "mm"), self.digits)) for part in (place.real, place.imag)]

    def points(self, points: Points) -> Any:
        table = tomlkit.inline_table()
        table.update({name: self.pair(place) for name, place in points.items()})
        return table

    def row(self, joint: Mapping[str, Any]) -> Any:
        """A table of a list, after an empty line, without the values that are 0 by default."""
        row = tomlkit.item({name: self._value(value) for name, value in joint.items() if value != 0})
        row.trivia.indent = "\n"
        return row

    def _value(self, value: Any) -> Any:
        if isinstance(value, complex):
            return self.pair(value)
        return plain(round(value, 6)) if isinstance(value, float) else value


def _grid(draft: Draft, step: float) -> tuple[float, _Writer]:
    """The step to which new places are rounded, mm, and a writer with two more digits than it has."""
    unit = draft.unit
    grid = nice(step / draft.scale / unit.mm)
    return grid * unit.mm, _Writer(unit, max(0, 2 - math.floor(math.log10(grid))))


def _as_bodies(draft: Draft, structure: Structure) -> Draft:
    """The draft with the table of a named linkage as one of bodies."""
    if draft.table.get("kind") == "linkage":
        return draft
    linkage: Linkage = draft.written.linkage.linkage  # type: ignore[attr-defined]
    writer, table, bodies = _Writer(draft.unit), tomlkit.table(), tomlkit.table()
    table["driver"] = structure.driver
    if linkage.origin:
        table["origin"] = writer.pair(complex(linkage.origin))
    if linkage.ground_angle_deg:
        table["ground_angle_deg"] = linkage.ground_angle_deg
    for body, points in structure.bodies.items():
        bodies[body] = writer.points(points)
    table["bodies"] = bodies
    for key, joints in (("sliders", structure.sliders), ("slots", structure.slots)):
        if joints:
            table[key] = [writer.row(joint) for joint in joints]
    return draft.with_changes({"kind": "linkage", "linkage": table})


def _changes(table: Mapping[str, Any], before: Structure, after: Structure, writer: _Writer) -> dict[str, Any]:
    """The difference of two structures as values by dotted key."""
    changes: dict[str, Any] = {}
    if after.driver != before.driver:
        changes["linkage.driver"] = after.driver or None
        ends = writer.pair(complex(*after.stroke)) if after.stroke else None
        changes["stroke"] = {"start": ends[0], "end": ends[1]} if ends else None
    for body, points in after.bodies.items():
        key, old = f"linkage.bodies.{body}", before.bodies.get(body)
        if not old:
            changes[key] = writer.points(points)
            continue
        changes |= {f"{key}.{p}": writer.pair(place) for p, place in points.items() if old.get(p) != place}
        changes |= {f"{key}.{p}": None for p in old if p not in points}
    changes |= {f"linkage.bodies.{body}": None for body in before.bodies if body not in after.bodies}
    joints = (("sliders", before.sliders, after.sliders), ("slots", before.slots, after.slots))
    for key, were, are in joints:
        gone = [k for k, joint in enumerate(were) if joint not in are]
        changes |= {f"linkage.{key}[{k}]": None for k in gone[::-1]}
        kept = len(were) - len(gone)
        changes |= {f"linkage.{key}[{k}]": writer.row(joint) for k, joint in enumerate(are) if k >= kept}
    for key, load in after.loads:
        held = len(table.get("loads", {}).get(key, []))
        (row,) = from_mm({"loads": {key: [load]}}, LinkageRecipe, writer.unit)["loads"][key]
        changes |= {f"loads.{key}[{held}]": writer.row(row)} if held else {f"loads.{key}": [writer.row(row)]}
    return changes | dict(_without(table, before.names - after.names, changes))


def _settled(draft: Draft, structure: Structure, writer: _Writer) -> Draft:
    """The draft with the branches, and the estimate if it takes one, with which it moves from where it is drawn."""
    places = structure.held
    estimate = {p: writer.pair(z) for p, z in places.items()}
    pinned = {p: z for p, z in estimate.items() if len(structure.bodies_at(p)) > 1}
    start = 0 if structure.stroke else plain(round(math.degrees(structure.drive), 6))
    turn = {"drive.start_deg": start, "drive.end_deg": plain(start + 360)} if start else {}
    # A linkage that is no chain of dyads takes an estimate of its first position; another driver makes other dyads.
    guesses: list[dict[str, Any]] = [{"linkage.estimate": None}, {"linkage.estimate": pinned, **turn}]
    for changes in (*guesses, *(guess | {"branches": None} for guess in guesses)):
        settled = draft.with_changes(changes)
        try:
            if not isinstance(settled.written, AbstractLinkageRecipe):
                return draft
            least = _misplaced(settled, structure.drive, places)
        except GeomkinError:
            continue
        if least <= len(places):
            return _on_branch(settled, structure, least)
    return draft if structure.is_as_drawn else draft.with_changes({"linkage.estimate": estimate})


def _on_branch(draft: Draft, structure: Structure, least: int) -> Draft:
    """The draft with the signs of joints that bring most points to where they are drawn; least: misplaced ones."""
    recipe: Any = draft.written
    for joint in (joint.name for joint in recipe.linkage.linkage.joints):
        sign = recipe.branches.get(joint, 1 if recipe.branch == "follow" else recipe.branch)
        if not least or isinstance(sign, complex):
            continue
        turned = draft.with_changes({f"branches.{joint}": -int(sign)})
        try:
            found = _misplaced(turned, structure.drive, structure.held)
        except GeomkinError:
            continue
        if found < least:
            draft, least = turned, found
    return draft


def _misplaced(draft: Draft, drive: float, places: Points) -> int:
    """The number of points that are not where they are drawn, with the driver where it is drawn."""
    recipe: Any = draft.written
    general = recipe.linkage.linkage
    motion: Motion = move(general, np.array([drive]), branch_of(recipe.branch, recipe.branches))
    if not motion.assembled[0]:
        return len(places) + 1
    size = AWAY * float(np.max(general.size) or 1.0)
    return sum(abs(complex(motion.point(p).position[0]) - z) > size for p, z in places.items())


def _renamed(draft: Draft, old: object, new: object) -> str:
    """The text with another name of a body, a point or a slide."""
    structure = _structure(draft, 0)
    kinds = {
        "body": set(structure.bodies),
        "point": set(structure.places),
        "joint": {joint["name"] for joint in structure.joints},
    }
    of = [kind for kind, names in kinds.items() if old in names]
    if not isinstance(old, str) or not isinstance(new, str) or len(of) != 1 or not new.strip():
        problem = f"found {shown(old)} to {shown(new)}"
        raise DesignError("build", problem, "give the name of one thing, and another name", "unknown-key")
    if new in structure.names:
        raise DesignError("build", f"{shown(new)} is the name of something else", "give another name", "conflict")
    check_names("build", [new], f"a {of[0]}")
    draft = _as_bodies(draft, structure)
    changes: dict[str, Any] = {}
    if of[0] != "joint":
        bodies = tomlkit.table()
        for body, points in tomlkit.parse(draft.text)["linkage"]["bodies"].items():
            renamed = tomlkit.inline_table()
            renamed.update({new if p == old and of[0] == "point" else p: z for p, z in points.items()})
            bodies[new if body == old and of[0] == "body" else body] = renamed
        changes["linkage.bodies"] = bodies
    return edited_text(draft.text, changes | dict(_mentions(draft.table, old, new)))


def _walked(value: Any, key: str) -> Iterator[tuple[str, Any, Any]]:
    """Every text, and key that is no field, below a key: its own key, itself, what it holds; lists from their ends."""
    if isinstance(value, Mapping):
        for name, held in value.items():
            inner = f"{key}.{name}" if key else name
            if key or name in NAMING:
                declared = field_of(inner, LinkageRecipe)
                if declared is None or declared.name != name:
                    yield inner, name, held
                yield from _walked(held, inner)
    elif isinstance(value, list):
        for k in range(len(value))[::-1]:
            yield from _walked(value[k], f"{key}[{k}]")
    elif isinstance(value, str):
        yield key, value, None


def _mentions(table: Mapping[str, Any], old: str, new: str) -> Iterator[tuple[str, Any]]:
    """Changes of the texts and keys that are a name, outside of the bodies themselves."""
    for key, name, held in _walked(table, ""):
        if name != old or key.startswith("linkage.bodies."):
            continue
        if held is None:
            yield key, new
        else:
            yield key, None
            yield f"{key.removesuffix(f'.{old}')}.{new}", held


def _without(table: Mapping[str, Any], gone: set[str], changes: Mapping[str, Any]) -> Iterator[tuple[str, None]]:
    """Changes that remove what names something that is gone: entries of tables and rows of lists."""
    done: set[str] = set()
    for key, name, held in _walked(table, ""):
        if name not in gone or key.startswith(CHANGED):
            continue
        # The row of the list that has the name, or the key itself.
        row = key[: key.index("]") + 1] if held is None and "]" in key else key
        if row not in done and row not in changes:
            done.add(row)
            yield row, None


def nice(step: float) -> float:
    """The next of 1, 2, 5, 10 ... that is at least a step."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(to_digits(factor * power, 3) for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))


def plain(value: float) -> float | int:
    """A number as a recipe states it: a whole one without a point."""
    return int(value) if float(value).is_integer() and abs(value) < 2**53 else float(value)


def is_size(step: object) -> bool:
    """Whether a value can be the size of a pixel, mm."""
    return isinstance(step, int | float) and not isinstance(step, bool) and 1e-9 < step < FARTHEST
