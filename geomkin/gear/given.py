"""What a gear is given: one number where a number is meant, one gear or tool where such is meant."""

from __future__ import annotations

import dataclasses
from functools import cache
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike

from ..errors import DesignError, shown
from ..plane.vec import Array
from ..sizes import FARTHEST, allowed, check_sizes

# Least of a size that must be above 0, in its unit. Less is a slip of units; with far less, squares and quotients
# leave the range of numbers.
LEAST = 1e-12
# Most of an angle or a length that is asked for; what is farther has lost the digits of a tooth.
MOST = 1e12


def check_given(thing: Any) -> None:
    """Raise DesignError for the first field of a gear or tool that is not one number in its range, or not its type.

    Call it from `__post_init__`. Fields that are sequences are left to their class.
    """
    for field, kinds in _fields(type(thing)):  # type: ignore[arg-type]
        value, about = getattr(thing, field.name), field.metadata
        if value is None and field.default is None:
            continue
        if "unit" in about:
            number(field.name, value, f"give {allowed(about)}")
            if "gt" in about and about["gt"] == 0 and 0 < abs(value) < LEAST:
                unit = f", in {about['unit']}" if about["unit"] else ""
                raise DesignError(
                    field.name, f"found {value}, too small to reckon with", f"give at least {LEAST}{unit}"
                )
        elif kinds and isinstance(kinds[0], str):
            if not isinstance(value, str) or value not in kinds:
                raise DesignError(field.name, f"found {shown(value)}", f"give {' or '.join(kinds)}")
        elif kinds:
            instance(field.name, value, *kinds)
    check_sizes(thing)


@cache
def _fields(kind: Any) -> list[tuple[dataclasses.Field[Any], tuple[Any, ...]]]:
    """Fields with what their values may be: words, or classes; nothing where that is left to the class."""
    hints = get_type_hints(kind)
    pairs = [(field, hints[field.name]) for field in dataclasses.fields(kind)]
    return [(field, () if get_origin(hint) is tuple else get_args(hint) or (hint,)) for field, hint in pairs]


def instance(name: str, value: Any, *kinds: type) -> None:
    """Raise DesignError unless the value is of one of the types."""
    if not isinstance(value, kinds):
        raise DesignError(name, f"found {shown(value)}", f"give {' or '.join(f'a {kind.__name__}' for kind in kinds)}")


def number(name: str, value: Any, remedy: str = "give a number") -> None:
    """Raise DesignError unless the value is one finite real number."""
    real = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    try:
        if real and np.isfinite(float(value)):
            return
    except OverflowError:
        pass
    raise DesignError(name, f"found {shown(value)}", remedy)


def numbers(name: str, values: ArrayLike) -> Array:
    """Real numbers of any shape, as an array; DesignError where they are none. What is not known, nan, passes."""
    try:
        found = np.asarray(values)
        if found.dtype.kind in "iuf" and not (np.abs(found) > MOST).any():
            return found.astype(float)
    except (TypeError, ValueError):
        pass
    raise DesignError(name, f"found {shown(values)}", f"give numbers up to {MOST:g}, one or an array of them")


def size(name: str, value: Any) -> None:
    """Raise DesignError unless the value is one length from 0 to a thousand kilometres, mm."""
    number(name, value, "give a number of mm, 0 or more")
    if not 0 <= value <= FARTHEST:
        raise DesignError(name, f"found {value:g} mm", f"give a number from 0 to {FARTHEST:g}")


def whole_number(name: str, value: Any, least: int, most: int) -> None:
    """Raise DesignError unless the value is one whole number within limits."""
    remedy = f"give a whole number from {least} to {most}"
    number(name, value, remedy)
    if value != int(value) or not least <= value <= most:
        raise DesignError(name, f"found {shown(value)}", remedy)
