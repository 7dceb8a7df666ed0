"""The numbers inside a dataclass, by dotted key as in messages and sweeps, and copies with one number changed."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, TypeVar

from .errors import DesignError, shown
from .field_visitor import Number, with_numbers

T = TypeVar("T")
# One part of a key: the position of an item of a list, or a name.
PART = re.compile(r"\[(\d+)\]|([^.\[\]]+)")


def numbers_in(thing: Any, path: str = "") -> list[Number]:
    """All numbers of a dataclass and of those inside it, in the order of its fields.

    Parameters
    ----------
    thing : dataclass
        A recipe or a part of one.
    path : str
        Key of `thing`, with which all keys begin.

    Returns
    -------
    list of Number
        Without those of recipes in files of their own.
    """
    numbers: list[Number] = []

    def listed(number: Number) -> Any:
        numbers.extend([number] if isinstance(number.value, (int, float)) else [])
        return number.value

    with_numbers(
        thing, listed, lambda inner, key: inner if getattr(inner, "is_in_own_file", False) else None, path=path
    )
    return numbers


def with_number(thing: T, key: str, value: float) -> T:
    """A dataclass with another value of the number under a key, relative to the dataclass.

    Raises
    ------
    DesignError
        If the dataclass refuses the value.
    """
    return with_numbers(thing, lambda number: value if number.key == key else number.value)


def key_parts(key: str) -> list[str | int]:
    """The parts of a dotted key: names, and positions of items of lists, from 0."""
    return [int(item) if item else name for item, name in PART.findall(key)]


def texts_by_key(field: str, texts: Iterable[str], form: str) -> dict[str, str]:
    """Split texts of the form KEY=TEXT; DesignError for `field` if a part is missing or a key is given twice."""
    by_key: dict[str, str] = {}
    for text in texts:
        key, _, value = (part.strip() for part in text.partition("="))
        if not key or not value:
            raise DesignError(field, f"found {shown(text)}", f"give {form}", "wrong-type")
        if key in by_key:
            raise DesignError(field, f"{shown(key)} is given twice", f"give {form} once for each key", "conflict")
        by_key[key] = value
    return by_key
