"""One step of editing as a pure function: from a recipe's text and a change to the new text and all that is shown."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any, TypeGuard

import numpy as np

from ..build import errors_named_by_key
from ..core.dotted_keys import key_parts
from ..core.errors import DesignError, GeomkinError, Problem, RecipeError, harmless, printable, shown
from ..core.fields import FARTHEST
from ..core.units import MM, UNITS
from ..export.still import kept_frames
from ..export.summary import as_json
from ..model.check import Check
from ..model.scene import SceneHandle
from ..page.scene_json import scene_data
from ..plane.vec import Real
from ..recipe.keys import edited_text, with_values
from ..recipe.lengths import shown_numbers
from ..recipe.load import from_table, whole_table
from ..recipe.recipe import AbstractGoal, AbstractRecipe
from ..recipe.shown import ShownRecipe
from ..recipe.toml import parsed
from .drag import drag, is_locked

# Digits of positions of handles: a millionth of their size is far below a pixel.
DIGITS = 7
# The key of an item of a list.
ITEM = re.compile(r"(.+)\[(\d+)\]")
Answer = dict[str, Any]


class Draft:
    """A recipe's text that is being edited, and the texts of the files that it names.

    Parameters
    ----------
    text : str
        TOML; it may be wrong.
    files : mapping of str to str
        Texts of files by their names in the recipe.
    name : str
        Name of the recipe.
    """

    def __init__(self, text: str, files: Mapping[str, str], name: str = ""):
        self.text, self.files, self.name = text, files, name

    def table(self) -> dict[str, Any]:
        """The parsed text; raises RecipeError."""
        return parsed(self.text.replace("\r\n", "\n"))

    def opened(self, table: Mapping[str, Any]) -> AbstractRecipe:
        """The recipe in a table; raises RecipeError."""
        recipe = from_table(table, "recipe", self.files)
        return recipe.with_name(self.name) if self.name else recipe

    def as_written(self, table: Mapping[str, Any], recipe: AbstractRecipe) -> AbstractRecipe:
        """The recipe with the sizes that the text states, before its `scale` multiplies them."""
        if "scale" not in table or not recipe.can_be_scaled:
            return recipe
        return self.opened({key: value for key, value in table.items() if key != "scale"})


def answer(
    text: str,
    files: Mapping[str, str],
    request: Mapping[str, Any],
    name: str = "",
    opened: Callable[[Draft], AbstractRecipe] | None = None,
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
        `set`, values by dotted key, None to remove one; or `drag`, with `handle`, `to`, `frame`, `step` and `snap`;
        `locks`, keys that a drag may not change; `lane`, "scene" or "checks".
    name : str
        Name of the recipe, by default its kind.
    opened : callable, optional
        Gives the recipe of a draft; by default it is read anew. A caller may keep the last one.

    Returns
    -------
    dict
        The new `text`, `scene`, `handles`, `values`, `quantities`, `problems`, `limit`, and for the lane "checks" also
        `checks`, `candidates` and `parts`. The text is never lost: if it is wrong, `problems` says where.

    Examples
    --------
    >>> from geomkin.studio.edit import answer
    >>> text = 'kind = "four-bar"\\n[linkage]\\nground = 100\\ncrank = 30\\ncoupler = 90\\nrocker = 70  # output\\n'
    >>> answer(text, {}, {"set": {"linkage.rocker": 75}})["text"].splitlines()[-1]
    'rocker = 75  # output'
    """
    reply = _replied(Draft(text, files, name), request, opened)
    if reply["problems"] and request.get("drag"):
        # The plates, which a drag does not compute, are impossible there: it stops where it was.
        before = _replied(Draft(text, files, name), {**request, "drag": None}, opened)
        if not before["problems"]:
            problem = reply["problems"][0]
            reason = f"{problem['key']}: {problem['problem']}; {problem['remedy']}"
            return before | {"limit": {"keys": [problem["key"]], "reason": reason}}
    return reply


def _replied(draft: Draft, request: Mapping[str, Any], opened: Callable[[Draft], AbstractRecipe] | None) -> Answer:
    text, name = draft.text, draft.name
    reply: Answer = {
        "text": text, "kind": "", "name": name, "scene": None, "handles": [], "values": {}, "problems": [],
        "limit": None, "quantities": [], "checks": None, "candidates": None, "parts": None,
    }  # fmt: skip
    try:
        if changes := request.get("set"):
            draft.text = reply["text"] = edited_text(text, _with_whole_lists(draft, changes))
        if request.get("drag"):
            _drag(draft, request["drag"], request.get("locks") or (), reply)
            draft.text = reply["text"]
        table = draft.table()
        kind = table.get("kind")
        reply["kind"] = kind if isinstance(kind, str) else ""
        recipe = opened(draft) if opened else draft.opened(table)
        reply["values"] = _values(draft.as_written(table, recipe))
        with errors_named_by_key("recipe", recipe):
            (_checks if request.get("lane") == "checks" else _scene)(recipe, request.get("locks") or (), reply)
    except RecipeError as error:
        reply["problems"] = [problem.to_dict() for problem in error.problems]
    except DesignError as error:
        reply["problems"] = [error.as_problem.to_dict()]
    except GeomkinError as error:
        reply["problems"] = [Problem("", str(error), "").to_dict()]
    except (MemoryError, RecursionError):
        problem = Problem("", "it takes too much memory", "give smaller numbers", "too-much-work")
        reply["problems"] = [problem.to_dict()]
    if reply["problems"]:
        reply["scene"] = None
    return reply


def _drag(draft: Draft, wanted: Mapping[str, Any], locks: Collection[str], reply: Answer) -> None:
    """Change the text so that a handle follows the pointer."""
    to, frame, steps = _pointer(wanted)
    table = draft.table()
    recipe = draft.opened(table)
    written = draft.as_written(table, recipe)
    with errors_named_by_key("recipe", recipe):
        handle = next((h for h in recipe.handles if h.id == wanted.get("handle")), None)
        if handle is None:
            problem = f"found {printable(repr(wanted.get('handle')))}"
            raise DesignError("drag.handle", problem, f"give one of {', '.join(h.id for h in recipe.handles)}")
        values, (x, y) = _values(written), _factors(recipe, handle)
        found = drag(
            lambda changes: draft.opened(with_values(table, _whole_lists(changes, table, values))),
            shown_numbers(written), handle, _frame_of_table(handle, frame),
            complex(to.real * x, to.imag * y), (steps[0] * x, steps[1] * y), locks, bool(wanted.get("snap")),
        )  # fmt: skip
    if found.changes:
        reply["text"] = edited_text(draft.text, _whole_lists(found.changes, table, values))
    if found.reason:
        reply["limit"] = {"keys": list(handle.keys), "reason": harmless(found.reason)}


def _factors(recipe: AbstractRecipe, handle: SceneHandle) -> tuple[float, float]:
    """Factors from x and y as they are shown to those of the handle: plots are in the recipe's unit, drawings in mm."""
    if handle.shape != "plot" or UNITS[recipe.units] is MM:
        return 1.0, 1.0
    units = recipe.table.columns[0].unit, recipe.table.column(handle.column).unit
    return UNITS[recipe.units].factor(units[0]), UNITS[recipe.units].factor(units[1])


def _pointer(wanted: Mapping[str, Any]) -> tuple[complex, int, tuple[float, float]]:
    """Position of the pointer, frame, and size of a pixel in x and y; raises DesignError."""
    frame, step = wanted.get("frame", 0), wanted.get("step", 0.1)
    numbers = [frame, *_pair("drag.to", wanted.get("to")), *_pair("drag.step", step if _is_row(step) else [step, step])]
    for key, number in zip(("frame", "to", "to", "step", "step"), numbers):
        is_number = isinstance(number, int | float) and not isinstance(number, bool) and abs(number) <= FARTHEST
        if not is_number or (key == "step" and number <= 0):
            raise DesignError(f"drag.{key}", f"found {shown(number)}", "give finite numbers", "wrong-type")
    return complex(numbers[1], numbers[2]), int(frame), (float(numbers[3]), float(numbers[4]))


def _pair(key: str, value: Any) -> Sequence[Any]:
    if not _is_row(value) or len(value) != 2:
        raise DesignError(key, f"found {shown(value)}", "give two numbers", "wrong-type")
    return value


def _is_row(value: Any) -> TypeGuard[Sequence[Any]]:
    return isinstance(value, list | tuple)


def _frame_of_table(handle: SceneHandle, frame: int) -> int:
    frames = kept_frames(len(handle.at))
    return int(frames[min(max(frame, 0), len(frames) - 1)])


def _with_whole_lists(draft: Draft, changes: Mapping[str, Any]) -> Mapping[str, Any]:
    """Changes of values, with whole lists for those items that belong to a list which the text leaves out."""
    if not any("[" in key for key in changes):
        return changes
    try:
        table = draft.table()
        return _whole_lists(changes, table, _values(draft.as_written(table, draft.opened(table))))
    except GeomkinError:
        # Without a recipe no default is known.
        return changes


def _whole_lists(changes: Mapping[str, Any], table: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """The changes, with whole points and lists for those that the text leaves out."""
    whole: dict[str, Any] = {}
    for key, value in changes.items():
        field, item = match.groups() if (match := ITEM.fullmatch(key)) else ("", "0")
        items = values.get(field)
        if value is not None and isinstance(items, list) and int(item) < len(items) and not _is_there(table, field):
            plain = [int(v) if isinstance(v, float) and v == int(v) else v for v in items]
            whole.setdefault(field, plain)[int(item)] = value
        else:
            whole[key] = value
    return whole


def _is_there(table: Mapping[str, Any], field: str) -> bool:
    place: Any = table
    try:
        for part in key_parts(field):
            place = place[part]
    except (LookupError, TypeError):
        return False
    return True


def _values(recipe: AbstractRecipe) -> dict[str, Any]:
    """Every key with its value as it stands, also those that the text leaves out."""
    return dict(_flat(whole_table(recipe), ""))


def _flat(value: Any, key: str) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict) and (value or not key):
        for name, held in value.items():
            yield from _flat(held, f"{key}.{name}" if key else name)
    elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
        for k, item in enumerate(value):
            yield from _flat(item, f"{key}[{k}]")
    else:
        yield key, value


def _scene(recipe: AbstractRecipe, locks: Collection[str], reply: Answer) -> None:
    name, results = recipe.name or recipe.kind, ShownRecipe(recipe)
    scene = results.scene
    reply["name"] = name
    reply["handles"] = [_handle(handle, locks, *_factors(recipe, handle)) for handle in recipe.handles]
    reply["quantities"] = [
        {"id": "", "label": harmless(label), "text": harmless(text)} for label, text in results.quantities.items()
    ] + [{"id": check.id, "label": check.name, "text": _stated(check)} for check in results.motion_checks]
    reply["scene"] = None if scene is None else scene_data(scene, name, results.unit)


def _stated(check: Check) -> str:
    return f"{check.value:.{check.digits(4)}g} {check.unit}".strip()


def _handle(handle: SceneHandle, locks: Collection[str], x_factor: float, y_factor: float) -> dict[str, Any]:
    at = handle.at[kept_frames(len(handle.at))]
    is_fixed = bool(np.isfinite(at).all() and (at == at[0]).all())
    x, y = (_row(part[:1] if is_fixed else part) for part in (at.real / x_factor, at.imag / y_factor))
    return {
        "id": handle.id, "label": harmless(handle.label), "keys": list(handle.keys), "shape": handle.shape,
        "at": [x[0], y[0]] if is_fixed else [x, y], "radius": handle.radius or None, "plot": handle.column or None,
        "arrow": [handle.arrow.real, handle.arrow.imag] if handle.arrow else None,
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
        }
        for check in results.checks
    ]
    reply["candidates"] = [
        {
            "key": candidate.key,
            "value": candidate.value,
            "label": harmless(candidate.label),
            "lines": [[_row(stroke.real), _row(stroke.imag)] for stroke in candidate.lines],
        }
        for candidate in (recipe.candidates if isinstance(recipe, AbstractGoal) else ())
    ]
    thicknesses = [results.unit.in_digits(part.thickness, "mm") for part in recipe.parts]
    parts = [{"name": p.name, "count": p.count, "thickness": t} for p, t in zip(recipe.parts, thicknesses)]
    bought = [item.data for item in results.bought]
    reply["parts"] = as_json({"parts": parts, "bought": bought, "steps": list(results.steps)})
