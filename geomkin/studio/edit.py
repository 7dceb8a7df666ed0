"""One step of editing as a pure function: from a recipe's text and a change to the new text and all that is shown."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from ..build import errors_named_by_key
from ..core.errors import DesignError, GeomkinError, Problem, RecipeError, harmless, printable, shown
from ..core.field_visitor import Number, key_parts
from ..core.fields import FARTHEST
from ..core.units import MM, UNITS
from ..export.still import kept_frames
from ..export.summary import as_json
from ..linkage.kinds.linkages import AbstractLinkageRecipe
from ..model.check import Check
from ..model.explanations import explained_check
from ..model.scene import SceneHandle
from ..page.page import scene_data
from ..plane.vec import Array, Complex, Real
from ..recipe.keys import edited_text, with_added, with_values
from ..recipe.load import from_table, shown_numbers, whole_table
from ..recipe.recipe import AbstractGoal, AbstractRecipe
from ..recipe.shown import ShownRecipe
from ..recipe.toml import parsed
from .additions import addition
from .building import (
    LinkageText,
    advice,
    drawn,
    is_unfinished,
    plain,
    point_handles,
    structure_at,
    structure_data,
    unfinished,
)
from .joining import joined, shafts
from .lengths import dimensions, resized
from .strokes import drawn_recipe

# Largest number of values that are tried in one drag: each takes a motion of the mechanism.
MOST_TRIALS = 40
# Distance from the pointer, in pixels, at which a handle is under it; rounding of the values adds up to one more.
UNDER_POINTER = 0.05
# Pixels by which the pointer is beyond a change point before a handle crosses it.
DETENT = 25.0
# Movement, in pixels, below which a step of the search is not tried.
NOTHING = 0.05
# Change for a derivative, as a share of the largest value of the keys.
CHANGE = 1e-6
# Pixels that a snapped value may be away from the pointer: a round step is chosen below this.
SNAP = 20


class Dragged(NamedTuple):
    """The new values by key, and why the handle did not reach the pointer; "" if it did or its keys cannot do more."""

    changes: dict[str, float | int]
    reason: str


class _Outcome(NamedTuple):
    """Distance from the pointer in pixels, as one or two numbers, or the reason for a refusal."""

    residual: Real
    reason: str


def is_locked(key: str, locks: Collection[str]) -> bool:
    """Whether a key or a table that contains it is locked."""
    return any(key == lock or key.startswith((f"{lock}.", f"{lock}[")) for lock in locks)


def drag(
    opened: Callable[[Mapping[str, float | int]], AbstractRecipe],
    known_numbers: Iterable[Number],
    handle: SceneHandle,
    frame: int,
    to: complex,
    step: tuple[float, float],
    locks: Collection[str] = (),
    snap: bool = False,
) -> Dragged:
    """Solve for the unlocked keys of a handle so that it follows the pointer, starting at their values.

    A damped least-squares iteration (Levenberg and Marquardt) on the recipe's own motion at one frame. Values that the
    recipe refuses are not taken, so the handle stops at a limit. It also stops where the mechanism could no longer be
    assembled at other frames, until the pointer is `DETENT` pixels beyond: then a four-bar gets another Grashof type.

    Parameters
    ----------
    opened : callable
        The recipe with other values, by key; raises GeomkinError for values that it refuses.
    known_numbers : iterable of Number
        The numbers of the recipe before the drag, as its text states them.
    handle : SceneHandle
        One of its handles.
    frame : int
        Frame of the scene at which the handle is dragged.
    to : complex
        Position of the pointer, mm or in units of the plot.
    step : (float, float)
        Size of one pixel in x and y.
    locks : collection of str
        Keys and tables that may not change.
    snap : bool
        Whether values are rounded to a coarse step.

    Returns
    -------
    Dragged
    """
    numbers = [n for n in known_numbers if {n.field, n.key} & set(handle.keys)]
    free = [n for n in numbers if not is_locked(n.key, locks)]
    if not free or (handle.is_one_value and len(free) < len(numbers)):
        return Dragged({}, "all keys of this handle are locked")
    # Numbers that have one value are changed together.
    groups = [free] if handle.is_one_value else [[n] for n in free]
    start = np.array([float(group[0].value) for group in groups])
    whole = np.array([isinstance(group[0].value, int) for group in groups])
    known = np.isfinite(handle.at)

    def tried(values: Array, is_strict: bool = True) -> _Outcome:
        nothing = np.full(1, np.inf)
        try:
            changed = opened(_as_changes(groups, values))
            moved, radius = changed.handle_position(handle.id), 0.0
            if handle.shape == "circle":
                radius = next(h.radius for h in changed.handles if h.id == handle.id)
        except RecipeError as error:
            return _Outcome(nothing, f"{error.problems[0].key}: {error.problems[0].problem}")
        except GeomkinError as error:
            return _Outcome(nothing, str(error))
        if not np.isfinite(moved[min(frame, len(moved) - 1)]):
            return _Outcome(nothing, "with more the mechanism could not be assembled in this position")
        if is_strict and len(moved) == len(known) and not np.isfinite(moved[known]).all():
            return _Outcome(nothing, "with more it cannot be assembled in all its positions; drag on to cross")
        away = complex(moved[min(frame, len(moved) - 1)]) - to
        if handle.shape == "circle":
            return _Outcome(np.array([(abs(away) - radius) / step[0]]), "")
        return _Outcome(np.array([away.real / step[0], away.imag / step[1]]), "")

    if not known[min(frame, len(known) - 1)]:
        return Dragged({}, "the mechanism cannot be assembled in this position")
    accepted: Callable[[Array], _Outcome] = tried
    best, residual, reason, slopes = _solved(accepted, start, whole)
    if reason and np.linalg.norm(residual) > DETENT:
        accepted = partial(tried, is_strict=False)
        best, residual, reason, slopes = _solved(accepted, start, whole)
    values = _rounded(accepted, start, best, residual, whole, slopes, snap)
    changes = _as_changes([group for group, v, old in zip(groups, values, start) if v != old], values[values != start])
    return Dragged(changes, reason)


def _solved(tried: Callable[[Array], _Outcome], start: Array, whole: Array) -> tuple[Array, Real, str, Real]:
    """The best values, their distance from the pointer, the last refusal on the way, and the slopes of the distance."""
    values, (residual, reason) = start, tried(start)
    if reason:
        return start, residual, reason, np.zeros(len(start))
    slopes: Real = np.zeros((len(residual), len(start)))
    # room: the longest step, in pixels; halved from a refusal on, which finds the limit by bisection.
    damping, room, trials = 0.0, np.inf, 0
    reason, is_new = "", True
    last: Array = np.zeros(len(start))
    while np.linalg.norm(residual) > UNDER_POINTER and trials < MOST_TRIALS:
        if is_new:
            slopes = _slopes(tried, values, residual, whole)
            trials += len(start)
            square = slopes.T @ slopes
            damping = max(damping, 1e-8 * float(np.trace(square)))
            if damping == 0:
                break
        change = -np.linalg.solve(square + damping * np.eye(len(start)), slopes.T @ residual)
        # A pointer outside a circle on which the handle moves makes steps too long by the ratio of the distances.
        change *= 0.5 if change @ last < 0 else 1.0
        change *= min(1.0, room / max(float(np.linalg.norm(slopes @ change)), NOTHING))
        trial = np.where(whole, np.rint(values + change), values + change)
        movement = float(np.linalg.norm(slopes @ (trial - values)))
        if movement < NOTHING:
            break
        trials += 1
        outcome = tried(trial)
        room = 0.5 * movement if outcome.reason else 0.5 * room
        is_new = not outcome.reason and np.linalg.norm(outcome.residual) < np.linalg.norm(residual)
        if is_new:
            # Slow progress is a minimum that the keys cannot leave.
            slow = np.linalg.norm(outcome.residual) > (1 - 1e-5) * np.linalg.norm(residual) and room == np.inf
            values, residual, damping, last = trial, outcome.residual, 0.01 * damping, change
            if slow:
                break
        elif not outcome.reason:
            damping = 10 * damping if damping > 1e-4 * np.trace(square) else 1e-3 * float(np.trace(square))
        reason = outcome.reason or reason
    if np.linalg.norm(residual) <= UNDER_POINTER:
        reason = ""
    return values, residual, reason, np.linalg.norm(slopes, axis=0)


def _slopes(tried: Callable[[Array], _Outcome], values: Array, residual: Real, whole: Array) -> Real:
    """Derivatives of the distance in pixels by each value; of whole numbers per 1; 0 where both sides are refused."""
    size = CHANGE * max(float(np.abs(values).max()), 1e-3)
    slopes = np.zeros((len(residual), len(values)))
    for k in range(len(values)):
        for change in (1.0, -1.0) if whole[k] else (size, -size):
            shifted = values.copy()
            shifted[k] += change
            outcome = tried(shifted)
            if not outcome.reason:
                slopes[:, k] = (outcome.residual - residual) / change
                break
    return slopes


def _rounded(
    tried: Callable[[Array], _Outcome],
    start: Array,
    values: Array,
    residual: Real,
    whole: Array,
    slopes: Real,
    snap: bool,
) -> Array:
    """The values with as many digits as a pixel resolves, or in round steps, as far as the recipe takes them."""
    rounded, inside = values.copy(), values.copy()
    for k in np.flatnonzero((values != start) & ~whole & (slopes > 0)):
        # Rounding moves the handle by half a pixel at most, shared by all keys.
        resolution = (SNAP if snap else 1.0) / slopes[k] / len(values)
        decimals = -int(np.floor(np.log10(resolution)))
        unit = 10.0**-decimals
        if snap:
            unit *= max(step for step in (1, 2, 5) if step * unit <= max(resolution, unit))
        rounded[k] = float(f"{np.rint(values[k] / unit) * unit:.{max(decimals, 0)}f}")
        # At a limit, the next round value on the near side.
        inward = np.floor if values[k] > start[k] else np.ceil
        inside[k] = float(f"{inward(values[k] / unit) * unit:.{max(decimals, 0)}f}")
    return next((row for row in (rounded, inside) if not tried(row).reason), values)


def _as_changes(groups: Sequence[Sequence[Number]], values: Array) -> dict[str, float | int]:
    """Values by key as a recipe states them: whole numbers without a point."""
    return {
        n.key: int(v) if isinstance(n.value, int) or (v.is_integer() and abs(v) < 2**53) else v
        for group, v in zip(groups, map(float, values))
        for n in group
    }


# Where keys begin of which some may be missing or wrong while a linkage is built.
BUILT = ("linkage", "stroke", "branch")
# Problems of a linkage as it is drawn.
DRAWN = ("impossible-geometry", "does-not-assemble")
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
        `set`, values by dotted key, None to remove one; or `add`, the key of a table or a list of them; or `build`, an
        edit as `built` takes it; or `draw`, a stroke with `points`, [x, y] in mm, and `bars`; or `join`, a mechanism
        as `joined` takes it; or `length`, another length of one of `dimensions`; or `drag`, with `handle`, `to`,
        `frame`, `step` and `snap`;
        `locks`, keys that a drag may not change; `lane`, "scene" or "checks".
    name : str
        Name of the recipe, by default its kind.
    opened : callable, optional
        Gives the recipe of a draft; by default it is read anew. A caller may keep the last one.

    Returns
    -------
    dict
        The new `text`, `scene`, `handles`, `values`, `quantities`, `problems`, `limit`, `preview` (joints of a
        linkage), `structure` (names in a linkage), `unfinished` (what a linkage that is built still lacks),
        `shafts` (that can turn another mechanism), `dimensions` (lengths on the drawing that can be set),
        `unavailable` (keys of tables that this mechanism cannot have), and for the lane "checks" also
        `checks`, `candidates` and `parts`. The text is never lost: if it is wrong, `problems` says where.

    Examples
    --------
    >>> from geomkin.studio.edit import answer
    >>> text = 'kind = "four-bar"\\n[linkage]\\nground = 100\\ncrank = 30\\ncoupler = 90\\nrocker = 70  # output\\n'
    >>> answer(text, {}, {"set": {"linkage.rocker": 75}})["text"].splitlines()[-1]
    'rocker = 75  # output'
    """
    reply = _replied(Draft(text, files, name), request, opened)
    if reply["problems"] and (request.get("drag") or request.get("join")):
        # The plates, which a drag does not compute, are impossible there, or the mechanism is on this shaft: it stops
        # where it was.
        before = _replied(Draft(text, files, name), {**request, "drag": None, "join": None}, opened)
        if not before["problems"]:
            problem = reply["problems"][0]
            reason = f"{problem['key']}: {problem['problem']}; {problem['remedy']}"
            return before | {"limit": {"keys": [problem["key"]], "reason": reason}}
    return reply


def _replied(draft: Draft, request: Mapping[str, Any], opened: Callable[[Draft], AbstractRecipe] | None) -> Answer:
    text, name = draft.text, draft.name
    reply: Answer = {
        "text": text, "kind": "", "name": name, "scene": None, "handles": [], "values": {}, "problems": [],
        "limit": None, "search": False, "unavailable": [], "quantities": [], "checks": None, "candidates": None,
        "parts": None, "preview": None, "structure": None, "unfinished": "",
        "shafts": [], "dimensions": [],
    }  # fmt: skip
    try:
        _edit(draft, request, reply)
        table = draft.table()
        kind = table.get("kind")
        reply["kind"] = kind if isinstance(kind, str) else ""
        recipe = opened(draft) if opened else draft.opened(table)
        reply["search"] = isinstance(recipe, AbstractGoal)
        reply["unavailable"] = [*recipe.additions.unavailable(recipe)]
        reply["values"] = _values(draft.as_written(table, recipe))
        with errors_named_by_key("recipe", recipe):
            is_scene = request.get("lane") != "checks"
            (_scene if is_scene else _checks)(recipe, request.get("locks") or (), reply)
            # A drag does not change how sizes place the joints, which takes time for many bodies.
            reply["preview"] = recipe.preview(not request.get("drag")) if is_scene else None
            if is_scene and not request.get("drag"):
                reply["shafts"] = [{"body": body, "at": [at.real, at.imag]} for body, at in shafts(recipe)]
            if isinstance(recipe, AbstractLinkageRecipe) and is_scene:
                reply["structure"] = structure_data(structure_at(recipe, 0))
                reply["dimensions"] = dimensions(recipe.linkage.linkage)
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
        _unfinished(draft, request, reply)
    return reply


def _edit(draft: Draft, request: Mapping[str, Any], reply: Answer) -> None:
    """Change the text as requested; of an edit by hand that is impossible report why."""
    locks = request.get("locks") or ()
    if changes := request.get("set"):
        draft.text = edited_text(draft.text, _with_whole_lists(draft, changes))
    if key := request.get("add"):
        _add(draft, key, reply)
    by_hand: Mapping[str, Callable[[Draft, Any], str]]
    by_hand = {"build": built, "draw": _drawn, "join": _joined, "length": partial(with_length, locks=locks)}
    for name, edited in by_hand.items():
        if wanted := request.get(name):
            try:
                draft.text = edited(draft, wanted)
            except DesignError as error:
                reply["limit"] = {"keys": [], "reason": harmless(f"{error.problem}; {error.remedy}")}
    reply["text"] = draft.text
    if request.get("drag"):
        _drag(draft, request["drag"], locks, reply)
        draft.text = reply["text"]


def _joined(draft: Draft, wanted: Mapping[str, Any]) -> str:
    """The text of a machine with another mechanism on a shaft."""
    table = draft.table()
    return joined(draft.text, table, draft.name, draft.opened(table), wanted)


def with_length(draft: Draft, wanted: Mapping[str, Any], locks: Collection[str] = ()) -> str:
    """The text of a linkage with another distance of two joints of a body; raises DesignError if that is impossible.

    wanted: `body`, `from` and `to`, as in `dimensions` of an answer, and `length` in the unit of the recipe.
    """
    table = draft.table()
    recipe = draft.as_written(table, draft.opened(table))
    unit, length = UNITS[recipe.units], wanted.get("length")
    if not isinstance(recipe, AbstractLinkageRecipe):
        raise DesignError("length", "this is no linkage", "give the sizes in the form", "conflict")
    if isinstance(length, int | float) and not isinstance(length, bool):
        length = unit.in_mm(length / table.get("scale", 1.0), "mm")
    sizes = resized(recipe.linkage, wanted, length, lambda key: is_locked(f"linkage.{key}", locks))
    changes = {f"linkage.{key}": plain(unit.in_digits(size, "mm")) for key, size in sizes.items()}
    return edited_text(draft.text, _whole_lists(changes, table, _values(recipe)))


def _unfinished(draft: Draft, request: Mapping[str, Any], reply: Answer) -> None:
    """Show a linkage that is still built as it is drawn; what it lacks is no problem."""
    try:
        table = draft.table()
    except GeomkinError:
        return
    structure = unfinished(table)
    if structure is None:
        return
    is_open = is_unfinished(structure)
    # Sizes that do not fit are shown by the gap, unless they were drawn.
    if not (is_open or (request.get("build") and reply["problems"][0]["id"] in DRAWN)):
        return
    values = dict(_flat(table, ""))
    if any(not problem["key"].startswith(BUILT) for problem in reply["problems"]) or not _is_json(values):
        return
    scale, unit = float(table.get("scale", 1.0)), UNITS[table.get("units", "mm")]
    name, is_check = draft.name or "linkage", request.get("lane") == "checks"
    try:
        handles = [_handle(handle, (), 1.0, 1.0) for handle in point_handles(structure, scale)]
        scene = None if is_check else scene_data(drawn(structure, scale), name, unit)
    except DesignError:
        # It is too large to be drawn.
        return
    reply["name"], reply["handles"], reply["structure"] = name, handles, structure_data(structure)
    reply["values"] = values
    if is_open:
        reply["problems"], reply["unfinished"] = [], advice(structure)
    if is_check:
        reply["checks"], reply["candidates"], reply["parts"] = [], [], {"parts": [], "bought": [], "steps": []}
    else:
        reply["scene"] = scene
        reply["quantities"] = [{"id": "", "label": "degrees of freedom", "text": str(structure.freedom)}]


def _drawn(draft: Draft, stroke: Mapping[str, Any]) -> str:
    """The text of a recipe that follows a stroke."""
    try:
        table = draft.table()
    except GeomkinError:
        table = {}
    kind, units = table.get("kind"), table.get("units")
    known = units if isinstance(units, str) and units in UNITS else MM.name
    return drawn_recipe(draft.text, str(kind), known, stroke.get("points"), stroke.get("bars", 6))


def built(draft: Draft, edit: Mapping[str, Any]) -> str:
    """The text of a linkage after an edit by hand, such as a dyad on two of its points.

    Parameters
    ----------
    draft : Draft
        The recipe of any linkage, or a text with bodies that are no linkage yet.
    edit : mapping
        `do`, a name in `geomkin.studio.building.EDITS`, with `on`, its clicks: each a mapping with `at`, [x, y] in mm,
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
    >>> from geomkin.studio.building import EMPTY
    >>> from geomkin.studio.edit import Draft, built
    >>> text = built(Draft(EMPTY, {}), {"do": "bar", "on": [{"at": [0, 0]}, {"at": [30, 40]}], "step": 0.5})
    >>> text.splitlines()[-1]
    'bar_1 = {A = [0, 0], B = [30, 40]}'
    """
    table = draft.table()

    def written(text: str) -> AbstractRecipe:
        other = Draft(text, draft.files, draft.name)
        return other.as_written(other.table(), other.opened(other.table()))

    return LinkageText(draft.text, table, written, _moving(written, draft.text)).edited(edit)


def _moving(written: Callable[[str], AbstractRecipe], text: str) -> AbstractRecipe | None:
    """The recipe of a text; None if it is none, or does not move."""
    try:
        recipe = written(text)
        if isinstance(recipe, AbstractLinkageRecipe):
            _ = recipe.motion
    except GeomkinError:
        return None
    return recipe


def _add(draft: Draft, key: Any, reply: Answer) -> None:
    """Change the text so that the recipe has another table or item of a list; if it can have none, report why."""
    if not isinstance(key, str):
        raise DesignError("add", f"found {shown(key)}", "give a key", "wrong-type")
    table = draft.table()
    recipe = draft.as_written(table, draft.opened(table))
    try:
        with errors_named_by_key("recipe", recipe):
            changes = addition(recipe, key, lambda changes: draft.opened(with_added(table, changes)))
    except RecipeError as error:
        problem = error.problems[0]
        reply["limit"] = {"keys": [problem.key], "reason": harmless(f"{problem.problem}; {problem.remedy}")}
        return
    draft.text = reply["text"] = edited_text(draft.text, changes)


def _drag(draft: Draft, wanted: Mapping[str, Any], locks: Collection[str], reply: Answer) -> None:
    """Change the text so that a handle follows the pointer."""
    to, frame, steps = _pointer(wanted)
    table = draft.table()
    sort, _, point = str(wanted.get("handle")).partition(":")
    if sort == "point" and (structure := unfinished(table)) and is_unfinished(structure):
        if point in structure.places:
            linkage = LinkageText(draft.text, table, lambda _: draft.opened(table), None)
            reply["text"] = linkage.moved(point, to, min(steps))
        return
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


def _is_json(values: Mapping[str, Any]) -> bool:
    """Whether JSON has such values: a text may have numbers that are none, and dates."""
    try:
        json.dumps(values, allow_nan=False)
    except (TypeError, ValueError):
        return False
    return True


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
    def places(at: Complex) -> list[Any]:
        """[x, y], each a row over the frames unless it stays."""
        kept = at[kept_frames(len(at))]
        is_fixed = bool(np.isfinite(kept).all() and (kept == kept[0]).all())
        x, y = (_row(part[:1] if is_fixed else part) for part in (kept.real / x_factor, kept.imag / y_factor))
        return [x[0], y[0]] if is_fixed else [x, y]

    return {
        "id": handle.id, "label": harmless(handle.label), "keys": list(handle.keys), "shape": handle.shape,
        "at": places(handle.at), "radius": handle.radius or None, "plot": handle.column or None,
        "arrow": [handle.arrow.real, handle.arrow.imag] if handle.arrow else None,
        "anchor": None if handle.anchor is None else places(handle.anchor),
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
            "lines": [[_row(stroke.real), _row(stroke.imag)] for stroke in candidate.lines],
        }
        for candidate in (recipe.candidates if isinstance(recipe, AbstractGoal) else ())
    ]
    thicknesses = [results.unit.in_digits(part.thickness, "mm") for part in recipe.parts]
    parts = [{"name": p.name, "count": p.count, "thickness": t} for p, t in zip(recipe.parts, thicknesses)]
    bought = [item.data for item in results.bought]
    reply["parts"] = as_json({"parts": parts, "bought": bought, "steps": list(results.steps)})
