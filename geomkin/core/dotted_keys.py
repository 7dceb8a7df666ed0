"""The numbers inside a dataclass, by dotted key as in messages and sweeps, and copies with one number changed."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple, TypeVar

from .errors import DesignError, shown

T = TypeVar("T")
# One part of a key: the position of an item of a list, or a name.
PART = re.compile(r"\[(\d+)\]|([^.\[\]]+)")


class Number(NamedTuple):
    """A number of a dataclass.

    Parameters
    ----------
    key : str
        Dotted key; items of lists and the x and y of points have `[0]`, `[1]`: `linkage.coupler_point[0]`.
    field : str
        The key of the whole value: that of the point or of the field.
    value : float or int
        The number.
    unit : str
        Its unit as the field declares it; "mm" for points.
    """

    key: str
    field: str
    value: float | int
    unit: str


def numbers_in(thing: Any, path: str = "") -> Iterator[Number]:
    """All numbers of a dataclass and of those inside it, in the order of its fields.

    Parameters
    ----------
    thing : dataclass
        A recipe or a part of one.
    path : str
        Key of `thing`, with which all keys begin.

    Returns
    -------
    iterator of Number
    """
    for field in dataclasses.fields(thing):
        key = f"{path}.{field.name}" if path else field.name
        yield from _inside(getattr(thing, field.name), key, key, field.metadata)


def _inside(value: Any, key: str, field: str, about: Mapping[str, Any]) -> Iterator[Number]:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        yield Number(key, field, value, about.get("unit", ""))
    elif isinstance(value, complex):
        yield Number(f"{key}[0]", key, value.real, "mm")
        yield Number(f"{key}[1]", key, value.imag, "mm")
    elif dataclasses.is_dataclass(value) and not getattr(value, "is_in_own_file", False):
        # A table that a recipe writes as the list of its segments.
        segments = getattr(value, "segments", None)
        yield from numbers_in(value, key) if segments is None else _inside(segments, key, key, {})
    elif isinstance(value, Mapping):
        for name, item in value.items():
            yield from _inside(item, f"{key}.{name}", f"{key}.{name}", about)
    elif isinstance(value, (tuple, list)):
        units = about.get("units", [about.get("unit", "")] * len(value))
        for k, item in enumerate(value):
            is_point = isinstance(item, (int, float)) and len(value) <= 3
            # Rows of numbers have the units of their columns.
            inner = about if isinstance(item, (tuple, list)) else {"unit": units[k % len(units)]}
            yield from _inside(item, f"{key}[{k}]", field if is_point else f"{key}[{k}]", inner)


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


def with_number(thing: T, key: str, value: float) -> T:
    """A dataclass with another value of the number under a key, relative to the dataclass.

    Raises
    ------
    DesignError
        If the dataclass refuses the value.
    """
    changed: T = _replaced(thing, key_parts(key), value)
    return changed


def _replaced(thing: Any, parts: list[int | str], value: float) -> Any:
    if not parts:
        return value
    part, *rest = parts
    if isinstance(thing, complex):
        return complex(value, thing.imag) if part == 0 else complex(thing.real, value)
    if isinstance(part, int):
        return (*thing[:part], _replaced(thing[part], rest, value), *thing[part + 1 :])
    if isinstance(thing, Mapping):
        return {**thing, part: _replaced(thing[part], rest, value)}
    return dataclasses.replace(thing, **{part: _replaced(getattr(thing, part), rest, value)})
