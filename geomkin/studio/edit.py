"""One step of editing as a pure function: from a recipe's text and a change to the new text and all that is shown."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from functools import partial
from itertools import count, takewhile
from typing import Any

import numpy as np
import tomlkit
from tomlkit.exceptions import ParseError, TOMLKitError

from ..build import errors_named_by_key
from ..core.errors import DesignError, FileError, GeomkinError, Problem, RecipeError, harmless, shown
from ..core.fields import FARTHEST
from ..core.units import MM, UNITS
from ..export.still import kept_frames
from ..export.text import as_json
from ..linkage.dynamics.wrenches import known_place
from ..linkage.kinds.linkages import AbstractLinkageRecipe
from ..linkage.scene_handles import body_point
from ..model.check import Check
from ..model.explanations import explained_check
from ..model.scene import SceneHandle
from ..page.page import scene_data
from ..plane.vec import Complex, Real
from ..recipe.keys import edited_text, with_added
from ..recipe.recipe import AbstractGoal, AbstractRecipe
from ..recipe.shown import ShownRecipe
from .additions import addition
from .building import built, plain, without_empty_loads
from .drafts import Draft, flat, read
from .dragging import dragged, is_locked, plot_factors
from .joining import joined, shafts
from .lengths import dimensions, resized
from .strokes import drawn_recipe, lines_of, posed_recipe
from .structure import Structure, advice, drawn, is_unfinished, point_handles, structure_at, structure_data, unfinished

# Where keys begin of which some may be missing or wrong while a linkage is built.
BUILT = ("linkage", "stroke", "branch")
# Problems of a linkage as it is drawn.
DRAWN = ("impossible-geometry", "does-not-assemble")
# Digits of positions of handles: a millionth of their size is far below a pixel.
DIGITS = 7
Answer = dict[str, Any]


def answer(
    text: str,
    files: Mapping[str, str],
    request: Mapping[str, Any],
    name: str = "",
    reader: Callable[[Draft], AbstractRecipe] = read,
) -> Answer:
    """Apply one change to a recipe's text and compute what an editor shows.

    It opens no file, starts no thread and keeps nothing, so the same request always has the same answer.

    Parameters
    ----------
    text : str
        The recipe, TOML.
    files : mapping of str to str
        Texts of the files that it names.
    request : mapping
        `set`, values by dotted key, None to remove one; or `add`, the key of a table or a list of them; or `build`, an
        edit as `built` takes it; or `draw`, a stroke with `points`, [x, y] in mm, and `bars`, or `poses`, [x, y,
        angle] in mm and deg, with `step`; or `join`, a mechanism as `joined` takes it; or `length`, another length of
        one of `dimensions`; or `drag`, with `handle`, `to`, `frame`, `step` and `snap`;
        `locks`, keys that a drag may not change; `lane`, "scene" or "checks".
    name : str
        Name of the recipe, by default its kind.
    reader : callable
        Gives the recipe of a draft; by default it is read anew. A caller may keep the last ones.

    Returns
    -------
    dict
        The new `text`, `scene`, `handles`, `values`, `written` (values of a wrong text as it has them), `quantities`,
        `problems`, `limit`, `preview` (joints of a
        linkage), `structure` (names in a linkage), `unfinished` (what a linkage that is built still lacks),
        `shafts` (that can turn another mechanism), `dimensions` (lengths on the drawing that can be set),
        `springs` (with the places of their ends),
        `unavailable` (keys of tables that this mechanism cannot have), and for the lane "checks" also
        `checks`, `candidates` and `parts`. The text is never lost: if it is wrong, `problems` says where.

    Examples
    --------
    >>> from geomkin.studio.edit import answer
    >>> text = 'kind = "four-bar"\\n[linkage]\\nground = 100\\ncrank = 30\\ncoupler = 90\\nrocker = 70  # output\\n'
    >>> answer(text, {}, {"set": {"linkage.rocker": 75}})["text"].splitlines()[-1]
    'rocker = 75  # output'
    """
    draft = Draft(text, files, name, reader)
    reply = _replied(draft, request)
    if reply["problems"] and (request.get("drag") or request.get("join")):
        # The plates, which a drag does not compute, are impossible there, or the mechanism is on this shaft: it stops
        # where it was.
        before = _replied(draft, {**request, "drag": None, "join": None})
        if not before["problems"]:
            problem = reply["problems"][0]
            reason = f"{problem['key']}: {problem['problem']}; {problem['remedy']}"
            return before | {"limit": {"keys": [problem["key"]], "reason": reason}}
    return reply


def _replied(draft: Draft, request: Mapping[str, Any]) -> Answer:
    reply: Answer = {
        "text": draft.text, "kind": "", "name": draft.name, "scene": None, "handles": [], "values": {}, "written": {},
        "problems": [],
        "limit": None, "search": False, "unavailable": [], "quantities": [], "checks": None, "candidates": None,
        "parts": None, "preview": None, "structure": None, "unfinished": "",
        "shafts": [], "dimensions": [], "springs": [],
    }  # fmt: skip
    try:
        for edited in (_set, _by_hand, _drag):
            draft = edited(draft, request, reply)
            reply["text"] = draft.text
        kind = draft.table.get("kind")
        reply["kind"] = kind if isinstance(kind, str) else ""
        recipe = draft.recipe
        reply["search"] = isinstance(recipe, AbstractGoal)
        reply["unavailable"] = [*recipe.additions.unavailable(recipe)]
        reply["values"] = draft.values
        with errors_named_by_key("recipe", recipe):
            is_scene = request.get("lane") != "checks"
            (_scene if is_scene else _checks)(recipe, request.get("locks") or (), reply)
            # A drag does not change how sizes place the joints, which takes time for many bodies.
            reply["preview"] = recipe.preview(not request.get("drag")) if is_scene else None
            if is_scene:
                reply["shafts"] = [{"body": body, "at": [at.real, at.imag]} for body, at in shafts(recipe)]
            if isinstance(recipe, AbstractLinkageRecipe) and is_scene:
                reply["structure"] = structure_data(structure_at(recipe, 0))
                reply["dimensions"] = dimensions(recipe.linkage.linkage)
                reply["springs"] = [*_springs(recipe)]
    except GeomkinError as error:
        reply["problems"] = [_with_line(problem, draft.text) for problem in problems_of(error)]
    except (MemoryError, RecursionError):
        problem = Problem("", "it takes too much memory", "give smaller numbers", "too-much-work")
        reply["problems"] = [problem.to_dict()]
    if reply["problems"]:
        reply["scene"] = None
        with suppress(GeomkinError):
            reply["written"] = {key: value for key, value in flat(draft.table).items() if _is_json(value)}
        _unfinished(draft, request, reply)
    return reply


def problems_of(error: GeomkinError) -> list[dict[str, str | float]]:
    """The problems of an error as plain values."""
    match error:
        case RecipeError():
            problems = list(error.problems)
        case DesignError():
            problems = [error.as_problem]
        case FileError():
            problems = [Problem("", f"{error.file} {error.problem}", error.remedy, error.id)]
        case _:
            problems = [Problem("", str(error), "")]
    return [problem.to_dict() for problem in problems]


def _with_line(problem: dict[str, str | float], text: str) -> dict[str, str | float]:
    """The problem of a text that is not TOML with the line at which reading ends."""
    if problem["id"] == "invalid-toml":
        try:
            tomlkit.parse(text)
        except ParseError as error:
            return {**problem, "line": error.line}
        except TOMLKitError:
            pass
    return problem


# --- changes of the text: each from a draft to the draft after it -----------------------------------------------------


def _set(draft: Draft, request: Mapping[str, Any], reply: Answer) -> Draft:
    changes = request.get("set")
    if not changes:
        return draft
    draft = draft.with_changes(draft.whole_lists(changes))
    return without_empty_loads(draft) if any(value is None for value in changes.values()) else draft


def _by_hand(draft: Draft, request: Mapping[str, Any], reply: Answer) -> Draft:
    """The draft after an edit by hand; if it is impossible, `limit` states why."""
    edits: Mapping[str, Callable[[Draft, Any], str]] = {
        "add": _added,
        "build": built,
        "draw": _drawn,
        "join": joined,
        "length": partial(with_length, locks=request.get("locks") or ()),
    }
    for name, edited in edits.items():
        if wanted := request.get(name):
            try:
                draft = draft.with_text(edited(draft, wanted))
            except (DesignError, RecipeError) as error:
                problem = problems_of(error)[0]
                keys = [problem["key"]] if name == "add" else []
                reply["limit"] = {"keys": keys, "reason": harmless(f"{problem['problem']}; {problem['remedy']}")}
    return draft


def _drag(draft: Draft, request: Mapping[str, Any], reply: Answer) -> Draft:
    if not request.get("drag"):
        return draft
    text, limit = dragged(draft, request["drag"], request.get("locks") or ())
    reply["limit"] = limit or reply["limit"]
    return draft.with_text(text)


def _added(draft: Draft, key: Any) -> str:
    """The text with another table or item of a list."""
    if not isinstance(key, str):
        raise DesignError("add", f"found {shown(key)}", "give a key", "wrong-type")
    with errors_named_by_key("recipe", draft.written):
        changes = addition(draft.written, key, lambda changes: draft.opened(with_added(draft.table, changes)))
    return edited_text(draft.text, changes)


def with_length(draft: Draft, wanted: Mapping[str, Any], locks: Collection[str] = ()) -> str:
    """The text of a linkage with another distance of two joints of a body; raises DesignError if that is impossible.

    wanted: `body`, `from` and `to`, as in `dimensions` of an answer, and `length` in the unit of the recipe.
    """
    recipe, unit, length = draft.written, draft.unit, wanted.get("length")
    if not isinstance(recipe, AbstractLinkageRecipe):
        raise DesignError("length", "this is no linkage", "give the sizes in the form", "conflict")
    most = unit.in_digits(FARTHEST, "mm") * draft.scale
    if isinstance(length, bool) or not isinstance(length, int | float) or not 0 < length < most:
        raise DesignError("length", f"found {shown(length)}", f"give one above 0 and below {most:g}", "out-of-range")
    in_mm = unit.in_mm(length / draft.scale, "mm")
    sizes = resized(recipe.linkage, wanted, in_mm, lambda key: is_locked(f"linkage.{key}", locks))
    changes = {f"linkage.{key}": plain(unit.in_digits(size, "mm")) for key, size in sizes.items()}
    return edited_text(draft.text, draft.whole_lists(changes))


def _drawn(draft: Draft, stroke: Mapping[str, Any]) -> str:
    """The text of a recipe that follows a stroke."""
    try:
        table = draft.table
    except GeomkinError:
        table = {}
    kind, units = table.get("kind"), table.get("units")
    known = units if isinstance(units, str) and units in UNITS else MM.name
    if "poses" in stroke:
        return posed_recipe(draft, str(kind), known, stroke["poses"], stroke.get("step", 0.1))
    return drawn_recipe(draft.text, str(kind), known, stroke.get("points"), stroke.get("bars", 6))


# --- what is shown ----------------------------------------------------------------------------------------------------


def _unfinished(draft: Draft, request: Mapping[str, Any], reply: Answer) -> None:
    """Show a linkage that is still built as it is drawn; what it lacks is no problem."""
    try:
        table = draft.table
    except GeomkinError:
        return
    structure = unfinished(table)
    if structure is None:
        return
    is_open = is_unfinished(structure)
    # Sizes that do not fit are shown by the gap, unless they were drawn.
    if not (is_open or (request.get("build") and reply["problems"][0]["id"] in DRAWN)):
        return
    values = flat(table)
    if any(not problem["key"].startswith(BUILT) for problem in reply["problems"]) or not _is_json(values):
        return
    name, is_check = draft.name or "linkage", request.get("lane") == "checks"
    try:
        handles = [_handle(handle, (), 1.0, 1.0) for handle in point_handles(structure, draft.scale)]
        scene = None if is_check else scene_data(drawn(structure, draft.scale), name, draft.unit)
    except DesignError:
        # It is too large to be drawn.
        return
    reply["name"], reply["handles"], reply["structure"] = name, handles, structure_data(structure)
    reply["values"], reply["springs"] = values, [*_drawn_springs(values, structure, draft.scale)]
    if is_open:
        reply["problems"], reply["unfinished"] = [], advice(structure)
    if is_check:
        reply["checks"], reply["candidates"], reply["parts"] = [], [], {"parts": [], "bought": [], "steps": []}
    else:
        reply["scene"] = scene
        reply["quantities"] = [{"id": "", "label": "degrees of freedom", "text": str(structure.freedom)}]


def _is_json(values: Any) -> bool:
    """Whether JSON has such values: a text may have numbers that are none, and dates."""
    try:
        json.dumps(values, allow_nan=False)
    except (TypeError, ValueError):
        return False
    return True


def _scene(recipe: AbstractRecipe, locks: Collection[str], reply: Answer) -> None:
    name, results = recipe.name or recipe.kind, ShownRecipe(recipe)
    scene = results.scene
    reply["name"] = name
    reply["handles"] = [_handle(handle, locks, *plot_factors(recipe, handle)) for handle in recipe.handles]
    reply["quantities"] = [
        {"id": "", "label": harmless(label), "text": harmless(text)} for label, text in results.quantities.items()
    ] + [{"id": check.id, "label": check.name, "text": _stated(check)} for check in results.motion_checks]
    reply["scene"] = None if scene is None else scene_data(scene, name, results.unit)


def _stated(check: Check) -> str:
    return f"{check.value:.{check.digits(4)}g} {check.unit}".strip()


def _springs(recipe: AbstractLinkageRecipe) -> Iterator[dict[str, Any]]:
    """Springs of a linkage with their keys and the places of both ends."""
    motion, loads = recipe.motion, getattr(recipe, "loads", None)
    for key in ("springs", "gas_springs"):
        for k, spring in enumerate(getattr(loads, key, ())):
            ends = ((spring.body, spring.point), (spring.to_body, spring.to_point))
            places = (complex(known_place(motion.linkage, body, point, f"loads.{key}[{k}].")) for body, point in ends)
            at, to = (_places(body_point(motion, body, place)) for (body, _), place in zip(ends, places))
            yield {"key": f"loads.{key}[{k}]", "label": f"{key[:-1].replace('_', ' ')} {k + 1}", "at": at, "to": to}


def _drawn_springs(values: Mapping[str, Any], structure: Structure, scale: float) -> Iterator[dict[str, Any]]:
    """The same of a linkage that is still built, between points with names."""
    keys = takewhile(lambda key: f"{key}.point" in values, (f"loads.springs[{k}]" for k in count()))
    for k, key in enumerate(keys, 1):
        ends = [structure.places.get(str(values.get(f"{key}.{end}"))) for end in ("point", "to_point")]
        at, to = ([scale * end.real, scale * end.imag] if end is not None else None for end in ends)
        if at and to:
            yield {"key": key, "label": f"spring {k}", "at": at, "to": to}


def _places(at: Complex, x_factor: float = 1.0, y_factor: float = 1.0) -> list[Any]:
    """[x, y], each a row over the frames unless it stays."""
    kept = at[kept_frames(len(at))]
    is_fixed = bool(np.isfinite(kept).all() and (kept == kept[0]).all())
    x, y = (_row(part[:1] if is_fixed else part) for part in (kept.real / x_factor, kept.imag / y_factor))
    return [x[0], y[0]] if is_fixed else [x, y]


def _handle(handle: SceneHandle, locks: Collection[str], x_factor: float, y_factor: float) -> dict[str, Any]:
    return {
        "id": handle.id, "label": harmless(handle.label), "keys": list(handle.keys), "shape": handle.shape,
        "at": _places(handle.at, x_factor, y_factor), "radius": handle.radius or None, "plot": handle.column or None,
        "arrow": [handle.arrow.real, handle.arrow.imag] if handle.arrow else None,
        "anchor": None if handle.anchor is None else _places(handle.anchor, x_factor, y_factor),
        "locked": all(is_locked(key, locks) for key in handle.keys),
    }  # fmt: skip


def _row(values: Real) -> list[float | None]:
    known = np.isfinite(values)
    largest = float(np.abs(values[known]).max(initial=0.0))
    rounded = np.round(values, DIGITS - int(np.ceil(np.log10(largest)))) if largest else values
    return [v if is_known else None for v, is_known in zip(rounded.tolist(), known.tolist())]


def _checks(recipe: AbstractRecipe, locks: Collection[str], reply: Answer) -> None:
    _ = locks
    reply["name"], results = recipe.name or recipe.kind, ShownRecipe(recipe)
    reply["checks"] = [
        {
            "id": check.id,
            "label": harmless(check.name),
            "value": _stated(check),
            "text": harmless(check),
            "state": "pass" if check.passed else "expected" if check.expected else "fail",
            "column": check.column or None,
            "about": explained_check(check.id),
        }
        for check in results.checks
    ]
    reply["candidates"] = [
        {
            "key": candidate.key,
            "value": candidate.value,
            "label": harmless(candidate.label),
            "lines": lines_of(candidate.lines),
        }
        for candidate in (recipe.candidates if isinstance(recipe, AbstractGoal) else ())
    ]
    thicknesses = [results.unit.in_digits(part.thickness, "mm") for part in recipe.parts]
    parts = [{"name": p.name, "count": p.count, "thickness": t} for p, t in zip(recipe.parts, thicknesses)]
    bought = [item.data for item in results.bought]
    reply["parts"] = as_json({"parts": parts, "bought": bought, "steps": list(results.steps)})
