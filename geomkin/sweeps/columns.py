"""The rows of a sweep as columns of a table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from ..check import Check
from ..plane.vec import Array
from ..table import Column


class Row(Protocol):
    """What a combination gave."""

    @property
    def values(self) -> Mapping[str, Any]: ...
    @property
    def refused(self) -> str: ...
    @property
    def checks(self) -> Sequence[Check]: ...
    @property
    def told(self) -> Mapping[str, Any]: ...


def columns(keys: Sequence[str], rows: Sequence[Row]) -> tuple[Column, ...]:
    """The keys' values, why a combination is refused, which checks failed, what each check found, what was told."""
    failed = ["; ".join(check.name for check in row.checks if not check.passed) for row in rows]
    found = [
        *(Column(key, "", "value under this key", _array([row.values[key] for row in rows])) for key in keys),
        Column("refused", "", "why there is no such mechanism", _array([row.refused for row in rows])),
        Column("failed", "", "the checks that failed", _array(failed)),
        *of_checks(rows),
        *of_told(rows),
    ]
    return tuple(_apart(found))


def of_checks(rows: Sequence[Row]) -> list[Column]:
    """What each check found, one column for each that any row has; nan where a row has none such."""
    every = [{(c.name, c.unit): c.value for c in row.checks} for row in rows]
    names = dict.fromkeys(name for held in every for name in held)
    return [
        Column(name.replace(" ", "_"), unit, name, np.array([held.get((name, unit), np.nan) for held in every]))
        for name, unit in names
    ]


def of_told(rows: Sequence[Row]) -> list[Column]:
    """What was asked for besides, under the name by which it was asked for."""
    names = dict.fromkeys(name for row in rows for name in row.told)
    return [Column(name.replace(":", "_"), "", name, _array([row.told.get(name) for row in rows])) for name in names]


def _array(values: Sequence[Any]) -> Array:
    """Numbers as such, with nan for none; anything else as texts."""
    if all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        return np.array(values, dtype=object if any(abs(v) >= 2**63 for v in values) else int)
    if all(value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)) for value in values):
        return np.array([np.nan if value is None else float(value) for value in values])
    return np.array([as_text(value) for value in values], dtype=object)


def as_text(value: Any) -> str:
    """A value of a recipe as its text has it."""
    if value is None or isinstance(value, bool):
        return "" if value is None else str(value).lower()
    return f"[{', '.join(map(as_text, value))}]" if isinstance(value, list) else str(value)


def _apart(found: Sequence[Column]) -> Iterator[Column]:
    """The columns, of which no two have one header."""
    taken: set[str] = set()
    for column in found:
        name, number = column.name, 1
        while column.header in taken:
            number += 1
            column = Column(f"{name}_{number}", column.unit, column.meaning, column.values)
        taken.add(column.header)
        yield column
