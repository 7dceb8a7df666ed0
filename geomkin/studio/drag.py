"""A drag of a handle: the values of its keys with which it follows the pointer, as far as the recipe allows."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..core.errors import GeomkinError, RecipeError
from ..core.field_visitor import Number
from ..model.scene import SceneHandle
from ..plane.vec import Array, Real
from ..recipe.recipe import AbstractRecipe

# Largest number of values that are tried in one drag: each takes a motion of the mechanism.
MOST_TRIALS = 40
# Distance from the pointer, in pixels, at which a handle is under it; rounding of the values adds up to one more.
UNDER_POINTER = 0.05
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
    recipe refuses, or with which the mechanism cannot be at frames where it could be before, are not taken, so the
    handle stops at a limit.

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

    def tried(values: Array) -> _Outcome:
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
        if len(moved) == len(known) and not np.isfinite(moved[known]).all():
            return _Outcome(nothing, "with more the mechanism could not be assembled in all its positions")
        away = complex(moved[min(frame, len(moved) - 1)]) - to
        if handle.shape == "circle":
            return _Outcome(np.array([(abs(away) - radius) / step[0]]), "")
        return _Outcome(np.array([away.real / step[0], away.imag / step[1]]), "")

    if not known[min(frame, len(known) - 1)]:
        return Dragged({}, "the mechanism cannot be assembled in this position")
    best, residual, reason, slopes = _solved(tried, start, whole)
    values = _rounded(tried, start, best, residual, whole, slopes, snap)
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
