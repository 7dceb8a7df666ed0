"""The rows of a sweep as columns of a table."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, Protocol

import numpy as np

from ..core.errors import harmless
from ..export.text import capital, number, text
from ..model.check import Check
from ..model.table import Column
from ..page.page import document
from ..page.sections import MOST_ROWS, section, wide
from ..plane.vec import Array


class Row(Protocol):
    """What a combination gave."""

    @property
    def values(self) -> Mapping[str, Any]: ...
    @property
    def refused(self) -> str: ...
    @property
    def checks(self) -> Sequence[Check]: ...
    @property
    def results(self) -> Mapping[str, Any]: ...


def columns(keys: Sequence[str], rows: Sequence[Row]) -> tuple[Column, ...]:
    """The keys' values, the reason of a refusal, failed checks, values of checks, further results."""
    failed = ["; ".join(check.id for check in row.checks if not check.passed) for row in rows]
    found = [
        *(Column(key, "", "value under this key", _array([row.values[key] for row in rows])) for key in keys),
        Column("refused", "", "why there is no such mechanism", _array([row.refused for row in rows])),
        Column("failed", "", "the checks that failed", _array(failed)),
        *of_checks(rows),
        *of_results(rows),
    ]
    return tuple(_apart(found))


def of_checks(rows: Sequence[Row]) -> list[Column]:
    """The value of each check, one column for each that any row has; nan if a row has no such check."""
    every = [{check.id: check for check in row.checks} for row in rows]
    first = {id: check for held in reversed(every) for id, check in held.items()}
    ids = dict.fromkeys(id for held in every for id in held)
    return [
        Column(
            id, first[id].unit, first[id].name, np.array([held[id].value if id in held else np.nan for held in every])
        )
        for id in ids
    ]


def of_results(rows: Sequence[Row]) -> list[Column]:
    """What was asked for besides, under the name by which it was asked for."""
    names = dict.fromkeys(name for row in rows for name in row.results)
    return [Column(name.replace(":", "_"), "", name, _array([row.results.get(name) for row in rows])) for name in names]


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
    """The columns, of which no two have one id or one header."""
    taken: set[str] = set()
    for column in found:
        id, number = column.id, 1
        while taken & {column.id, column.header}:
            number += 1
            column = Column(f"{id}_{number}", column.unit, column.meaning, column.values)
        taken |= {column.id, column.header}
        yield column


SCRIPTS = ("uplot/uPlot.iife.min.js", "shapes.js", "pictures.js", "plots.js", "rows.js")
START = 'mountRows(document.getElementById("plots"), JSON.parse(document.getElementById("scene").textContent));'
# Most lines in a plot: as many as colours and dashes distinguish.
MOST_LINES = 6
# Plots to choose from, and values of a line at most; more make pages of megabytes, and the CSV has them all.
MOST_PLOTS, MOST_POINTS = 40, 1001


def report(name: str, values: Mapping[str, Sequence[Any]], rows: Sequence[Row]) -> bytes:
    """The page. name: of the recipe; values: of each key, all of whose combinations are the rows, in order."""
    found = [*of_checks(rows), *of_results(rows)]
    refused = sum(bool(row.refused) for row in rows)
    sound = sum(not row.refused and all(check.passed for check in row.checks) for row in rows)
    counts = f"{len(rows):,} combinations of {text(' and '.join(values))}: in {sound:,} all checks hold"
    about = f"<p>{counts}; {refused:,} the recipe refuses.</p>"
    data, note = _plotted(values, rows, found)
    plots = f'<section id="plots" class="values" aria-label="Plots"></section>\n{note}' if data["plots"] else ""
    unplotted = "" if data["plots"] else '<section id="plots" hidden></section>'
    body = f"{plots}{unplotted}{_table(list(values), rows, found)}\n"
    json_text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    return document(f"{name}: a sweep", about, body, json_text, SCRIPTS, START)


def _plotted(values: Mapping[str, Sequence[Any]], rows: Sequence[Row], found: Sequence[Column]) -> tuple[Any, str]:
    """The plots as the player takes them, over the first key of numbers, and what is to be said of their lines."""
    data: dict[str, Any] = {"frames": 0, "spots": True, "columns": [], "plots": []}
    along = next((key for key, row in values.items() if len(row) > 1 and all(map(_is_number, row))), None)
    if along is None:
        return data, ""
    others = [key for key in values if key != along]
    place = sorted(values[along])[:MOST_POINTS]
    lines = list(product(*(values[key] for key in others)))
    shown = [lines[k] for k in np.unique(np.rint(np.linspace(0, len(lines) - 1, MOST_LINES)).astype(int))]
    at = {(row.values[along], *(as_text(row.values[key]) for key in others)): k for k, row in enumerate(rows)}
    data["frames"], data["columns"] = len(place), [_column(along, "", "", place)]
    limits = [{c.id: (c.limit, f"{c.side} {number(c.limit)}") for c in row.checks} for row in rows]
    for column in [c for c in found if c.values.dtype.kind in "fi"][:MOST_PLOTS]:
        limit = {held[column.id] for held in limits if column.id in held}
        data["plots"].append(
            {
                "title": harmless(capital(column.meaning)),
                "columns": [len(data["columns"]) + k for k in range(len(shown))],
                # Limits that differ from one combination to the next are no line.
                "limits": [[value, said] for value, said in limit if len(limit) == 1 and math.isfinite(value)],
            }
        )
        for choice in shown:
            chosen = [f"{key.rpartition('.')[2]} {as_text(value)}" for key, value in zip(others, choice)]
            picked = [column.values[at[x, *map(as_text, choice)]] for x in place]
            line = ", ".join(chosen) or capital(column.meaning)
            data["columns"].append(_column(line, column.unit, column.meaning, picked))
    left = len(lines) - len(shown)
    note = f"<p>Of {len(lines):,} lines {len(shown)} are drawn, evenly chosen; the file has them all.</p>"
    return data, note if left else ""


def _column(name: str, unit: str, meaning: str, row: Sequence[Any]) -> dict[str, Any]:
    values = [float(f"{value:.6g}") if math.isfinite(value) else None for value in row]
    return {"name": harmless(name), "unit": harmless(unit), "meaning": harmless(meaning), "row": values}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _table(keys: Sequence[str], rows: Sequence[Row], found: Sequence[Column]) -> str:
    """The first rows, as many as a reader takes in."""
    found_heads = [f"{capital(c.meaning)}{f', {c.unit}' if c.unit else ''}" for c in found]
    heads = "".join(f'<th scope="col">{text(head)}</th>' for head in (*keys, "Checks", *found_heads))
    lines = "".join(_line(keys, row, [c.values[k] for c in found]) for k, row in enumerate(rows[:MOST_ROWS]))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{lines}</tbody></table>"
    more = f"<p>And {len(rows) - MOST_ROWS:,} more in the file.</p>" if len(rows) > MOST_ROWS else ""
    return section("rows", "All combinations", wide("Combinations", table) + more)


def _line(keys: Sequence[str], row: Row, found: Sequence[Any]) -> str:
    values = "".join(f'<th scope="row">{text(as_text(row.values[key]))}</th>' for key in keys)
    if row.refused:
        return f'<tr class="fails">{values}<td colspan="{1 + len(found)}">{text(row.refused)}</td></tr>'
    failed = [check.name for check in row.checks if not check.passed]
    verdict = text(f"fails: {', '.join(failed)}") if failed else "all hold" if row.checks else "none"
    cells = "".join(f"<td>{text(one) if isinstance(one, str) else number(float(one))}</td>" for one in found)
    return f'<tr class="{"fails" if failed else "holds"}">{values}<td>{verdict}</td>{cells}</tr>'
