"""Lengths of links that are typed on the drawing: the sizes of the recipe that give them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..core.errors import DesignError, shown
from ..core.field_visitor import Number, numbers_in, with_number
from ..core.fields import to_digits
from ..linkage.linkage import AbstractLinkage, Linkage
from ..linkage.scene import link_distances
from ..plane.vec import Real

# Change of a size for a derivative, and the distance from a length at which it is met, in sizes of the linkage.
CHANGE, MET = 1e-6, 1e-12
# Steps of Newton's method; a length is linear, or nearly, in the sizes that give it.
MOST_STEPS = 30
# Derivative below which a size does not count: rounding of a difference.
NO_SLOPE = 1e-7
DIGITS = 10


def dimensions(linkage: Linkage) -> list[dict[str, str]]:
    """The body and joints of each dimension of the drawing that can be typed, in its order."""
    return [{"body": body, "from": one, "to": other} for body, one, other, *_ in link_distances(linkage)]


def resized(
    linkage: AbstractLinkage, wanted: Mapping[str, Any], length: float, is_locked: Callable[[str], bool]
) -> dict[str, float]:
    """Sizes of a linkage, by key, with which two joints of a body have a distance; the others stay.

    Parameters
    ----------
    linkage : AbstractLinkage
        The linkage.
    wanted : mapping
        `body`, `from` and `to`, as in `dimensions`.
    length : float
        The distance, mm.
    is_locked : callable
        Whether a key of the linkage may not change.

    Raises
    ------
    DesignError
        If there is no such dimension, or all its sizes are locked.
    """
    names = tuple(wanted.get(name) for name in ("body", "from", "to"))
    if _distance(linkage, names) is None:
        raise DesignError("length", f"found {shown(wanted)}", "give a dimension of the drawing", "unknown-key")
    free = _sizes_of(linkage, names, is_locked)
    if not free:
        raise DesignError("length", "all sizes that give it are locked", "unlock one", "conflict")
    size, values = float(np.max(linkage.linkage.size)), np.array([float(number.value) for number in free])
    for _ in range(MOST_STEPS):
        now = _changed(linkage, free, values)
        off = length - (_distance(now, names) or 0.0)
        if abs(off) < MET * size:
            break
        slopes = _slopes(now, names, free, size)
        values = values + off * slopes / float(slopes @ slopes)
    return {number.key: to_digits(value, DIGITS) for number, value in zip(free, values.tolist())}


def _sizes_of(linkage: AbstractLinkage, names: tuple[Any, ...], is_locked: Callable[[str], bool]) -> list[Number]:
    """The lengths that change a distance; if its second joint has coordinates of its own, these."""
    numbers = [n for n in numbers_in(linkage) if n.unit == "mm" and not is_locked(n.key)]
    slopes = _slopes(linkage, names, numbers, float(np.max(linkage.linkage.size)))
    fields = {number.field for number, slope in zip(numbers, slopes) if slope}
    own = {field for field in fields if field.rpartition(".")[2] == names[2]}
    return [number for number, slope in zip(numbers, slopes) if slope and number.field in (own or fields)]


def _slopes(linkage: AbstractLinkage, names: tuple[Any, ...], numbers: list[Number], size: float) -> Real:
    """Derivatives of a distance by sizes; 0 if they are rounding."""
    values, slopes = {number.key: float(number.value) for number in numbers_in(linkage)}, []
    for number in numbers:
        ends = [values[number.key] + sign * CHANGE * size for sign in (1, -1)]
        try:
            far, near = (_distance(with_number(linkage, number.key, end), names) or 0.0 for end in ends)
        except DesignError:
            far = near = 0.0
        slopes.append((far - near) / (2 * CHANGE * size))
    rates = np.array(slopes)
    return np.where(np.abs(rates) > NO_SLOPE, rates, 0.0)


def _changed(linkage: AbstractLinkage, numbers: list[Number], values: Any) -> AbstractLinkage:
    for number, value in zip(numbers, values.tolist()):
        linkage = with_number(linkage, number.key, value)
    return linkage


def _distance(linkage: AbstractLinkage, names: tuple[Any, ...]) -> float | None:
    """The distance of two joints of a body, mm; None if they have no dimension."""
    found = (abs(end - start) for *of, start, end in link_distances(linkage.linkage) if tuple(of) == names)
    return next(found, None)
