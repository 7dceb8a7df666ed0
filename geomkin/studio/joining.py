"""Another mechanism on a shaft: a recipe becomes one of a machine, or a machine gets one more mechanism."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from itertools import count
from typing import Any

import tomlkit

from ..core.errors import DesignError, GeomkinError, shown
from ..core.units import MM, UNITS
from ..machine.kinds import MachineRecipe
from ..recipe.keys import edited_text
from ..recipe.kinds import recipe_class
from ..recipe.load import from_mm, in_mm
from ..recipe.recipe import AbstractGoal, AbstractRecipe
from ..recipe.template import template
from ..recipe.toml import parsed
from .building import plain
from .drafts import Draft

# Longest table in one line.
LONGEST = 110


def shafts(recipe: AbstractRecipe) -> Iterator[tuple[str, complex]]:
    """Names of the bodies that can turn another mechanism, as `turned_by` has them, and their axes, mm."""
    if isinstance(recipe, MachineRecipe):
        for name, bodies in recipe.graph.bodies.items():
            pose = recipe.poses[name]
            yield from ((f"{name}.{body}", complex(pose.place(turning.axis))) for body, turning in bodies.items())
    elif not isinstance(recipe, AbstractGoal):
        yield from ((body, complex(turning.axis)) for body, turning in recipe.rotating_bodies.items())


def joined(draft: Draft, wanted: Mapping[str, Any]) -> str:
    """The text of a machine with another mechanism on one of its shafts.

    Parameters
    ----------
    draft : Draft
        The recipe before: of a machine, or of a mechanism, which becomes the first one of a machine.
    wanted : mapping
        `turned_by`, the name of a shaft as `shafts` gives it; and `recipe`, the name of a recipe of the folder, or
        `kind`, whose template is taken, or `source`, the text of a recipe, with its `name`; `phase_deg`. A body without
        a bore gets that of the shaft, where it can have one.

    Raises
    ------
    DesignError
        If there is no such shaft or kind.
    """
    recipe = draft.recipe
    known = dict(shafts(recipe))
    if not isinstance(wanted, Mapping):
        raise DesignError("join", f"found {shown(wanted)}", "give turned_by, and recipe or kind", "wrong-type")
    turned_by, phase = wanted.get("turned_by"), wanted.get("phase_deg", 0)
    if isinstance(phase, bool) or not isinstance(phase, int | float):
        raise DesignError("join.phase_deg", f"found {shown(phase)}", "give a number", "wrong-type")
    if not isinstance(turned_by, str) or turned_by not in known:
        remedy = f"give one of {', '.join(known)}" if known else "give a mechanism with a shaft that turns"
        raise DesignError("join.turned_by", f"found {shown(turned_by)}", remedy, "unknown-key")
    other, noun = _source(wanted, recipe)
    mechanism: dict[str, Any] = {"turned_by": turned_by, **({"phase_deg": phase} if phase else {}), "recipe": other}
    if isinstance(recipe, MachineRecipe):
        added = _new_name(noun, recipe.mechanisms)
        return _with_bores(draft, edited_text(draft.text, {f"mechanisms.{added}": _table(mechanism)}), added)
    first = _new_name(draft.name or recipe.kind, ())
    added = _new_name(noun, (first,))
    own = {key: value for key, value in draft.table.items() if key != "units"}
    head = 'kind = "machine"\n' if recipe.units == MM.name else f'kind = "machine"\nunits = "{recipe.units}"\n'
    mechanism["turned_by"] = f"{first}.{turned_by}"
    # Its parts are cut by the same beam.
    kerf = {"files.kerf": UNITS[recipe.units].in_digits(recipe.files.kerf, "mm")} if recipe.files.kerf else {}
    both = {f"mechanisms.{first}": _table({"recipe": own}), f"mechanisms.{added}": _table(mechanism)}
    return _with_bores(draft, edited_text(head, {**both, **kerf}), added)


def _with_bores(draft: Draft, text: str, added: str) -> str:
    """The text of a machine in which all bodies on the shaft of a mechanism have a bore, where the text states them."""
    try:
        machine: Any = draft.with_text(text).recipe
        fits = [fit for fit in machine.shafts if added in {name.partition("/")[0] for name in fit.bodies}]
    except GeomkinError:
        return text
    for fit in fits:
        for mechanism, _, body in (name.partition("/") for name, bore in fit.bores.items() if bore is None):
            inner = machine.mechanisms[mechanism].recipe
            key = next((key for key in (f"{body}_stock", "stock") if hasattr(getattr(inner, key, None), "bore")), "")
            if not fit.diameter > 0 or inner.name or not key:
                continue
            bore = plain(UNITS[machine.units].in_digits(fit.diameter, "mm"))
            bored = edited_text(text, {f"mechanisms.{mechanism}.recipe.{key}.bore": bore})
            with suppress(GeomkinError):
                # A small gear may have no room for it.
                draft.with_text(bored).recipe.parts  # noqa: B018
                text = bored
    return text


def _source(wanted: Mapping[str, Any], machine: AbstractRecipe) -> tuple[str | dict[str, Any], str]:
    """The recipe that is joined, as a machine states it, and a word for its name."""
    name, source = wanted.get("recipe"), wanted.get("source")
    if isinstance(name, str) and name:
        return f"{name}.toml", name
    given = parsed(source) if isinstance(source, str) else {}
    kind = given.get("kind", wanted.get("kind"))
    try:
        recipe = recipe_class(kind if isinstance(kind, str) else "")
    except KeyError:
        raise DesignError("join.kind", f"found {shown(kind)}", "give a kind", "unknown-kind") from None
    table, unit = _without_empty(given or parsed(template(recipe))), UNITS[machine.units]
    own = UNITS[table.pop("units", MM.name)]
    if own is not MM:
        table = in_mm(table, recipe, own)
    # The machine states the files.
    table.pop("files", None)
    noun = str(wanted.get("name") or recipe.kind) if given else recipe.kind
    return (table if unit is MM else from_mm(table, recipe, unit)), noun


def _without_empty(table: Mapping[str, Any]) -> dict[str, Any]:
    inner = {key: _without_empty(value) if isinstance(value, Mapping) else value for key, value in table.items()}
    return {key: value for key, value in inner.items() if value != {}}


def _new_name(noun: str, taken: Any) -> str:
    """A free name of letters, digits and `-`: with `_`, `leg` and `leg_2` could both have a part `leg_2_rod`."""
    noun = "-".join(re.findall(r"[^\W_]+", noun))[:20].strip("-") or "mechanism"
    return next(name for k in count(1) if (name := noun if k == 1 else f"{noun}-{k}") not in taken)


def _table(values: Mapping[str, Any]) -> Any:
    """A table whose innermost tables are in one line each, if they are short."""
    table = tomlkit.table()
    for name, value in values.items():
        if isinstance(value, Mapping):
            is_inner = not any(_has_tables(held) for held in value.values()) and len(str(value)) <= LONGEST
            table[name] = _inline(value) if is_inner and value else _table(value)
        else:
            table[name] = value
    return table


def _inline(values: Mapping[str, Any]) -> Any:
    table = tomlkit.inline_table()
    table.update(values)
    return table


def _has_tables(value: Any) -> bool:
    return isinstance(value, Mapping) or (isinstance(value, list) and any(map(_has_tables, value)))
