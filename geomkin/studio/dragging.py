"""Drags: the values of a recipe with which a handle follows the pointer."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, TypeGuard

import numpy as np

from ..build import errors_named_by_key
from ..core.errors import DesignError, GeomkinError, RecipeError, harmless, printable, shown
from ..core.field_visitor import Number
from ..core.fields import FARTHEST
from ..core.units import MM, UNITS
from ..export.still import kept_frames
from ..model.scene import SceneHandle
from ..plane.vec import Array, Real
from ..recipe.keys import edited_text, with_values
from ..recipe.load import shown_numbers
from ..recipe.recipe import AbstractRecipe
from .building import moved
from .drafts import Draft
from .structure import is_unfinished, unfinished

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


def dragged(draft: Draft, wanted: Mapping[str, Any], locks: Collection[str]) -> tuple[str, dict[str, Any] | None]:
    """The text with which a handle follows the pointer, and `limit`, why it did not reach it.

    wanted: `handle`, `to`, `frame`, `step` and `snap`, as in a request of `answer`.
    """
    to, frame, steps = _pointer(wanted)
    sort, _, point = str(wanted.get("handle")).partition(":")
    if sort == "point" and (structure := unfinished(draft.table)) and is_unfinished(structure):
        return (moved(draft, point, to, min(steps)) if point in structure.places else draft.text), None
    recipe = draft.recipe
    with errors_named_by_key("recipe", recipe):
        handle = next((h for h in recipe.handles if h.id == wanted.get("handle")), None)
        if handle is None:
            problem = f"found {printable(repr(wanted.get('handle')))}"
            raise DesignError("drag.handle", problem, f"give one of {', '.join(h.id for h in recipe.handles)}")
        x, y = plot_factors(recipe, handle)
        found = drag(
            lambda changes: draft.opened(with_values(draft.table, draft.whole_lists(changes))),
            shown_numbers(draft.written), handle, _frame_of_table(handle, frame),
            complex(to.real * x, to.imag * y), (steps[0] * x, steps[1] * y), locks, bool(wanted.get("snap")),
        )  # fmt: skip
    text = edited_text(draft.text, draft.whole_lists(found.changes)) if found.changes else draft.text
    return text, {"keys": list(handle.keys), "reason": harmless(found.reason)} if found.reason else None


def plot_factors(recipe: AbstractRecipe, handle: SceneHandle) -> tuple[float, float]:
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
