"""The page of a sweep, and the columns of its table."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, Protocol

import numpy as np

from ..core.errors import harmless
from ..core.fields import to_digits_or_none
from ..export.text import capital, number, text
from ..model.check import Check
from ..model.table import Column
from ..page.page import rows_document
from ..page.sections import MOST_ROWS, html_section, wide
from ..plane.vec import Array


class Row(Protocol):
    """Results for one combination; `SweepRow` is one."""

    @property
    def values(self) -> Mapping[str, Any]: ...
    @property
    def refused(self) -> str: ...
    @property
    def checks(self) -> Sequence[Check]: ...
    @property
    def results(self) -> Mapping[str, Any]: ...


def sweep_columns(keys: Sequence[str], rows: Sequence[Row]) -> tuple[Column, ...]:
    """Columns: values of the keys, reason of a refusal, failed checks, values of checks, results."""
    failed = ["; ".join(check.id for check in row.checks if not check.passed) for row in rows]
    columns = [
        *(Column(key, "", "value under this key", _array([row.values[key] for row in rows])) for key in keys),
        Column("refused", "", "why there is no such mechanism", _array([row.refused for row in rows])),
        Column("failed", "", "the checks that failed", _array(failed)),
        *check_columns(rows),
        *result_columns(rows),
    ]
    return tuple(_with_unique_names(columns))


def check_columns(rows: Sequence[Row]) -> list[Column]:
    """One column for each check of any row; nan if a row has no such check."""
    by_id = [{check.id: check for check in row.checks} for row in rows]
    columns = []
    for id in dict.fromkeys(id for checks in by_id for id in checks):
        first = next(checks[id] for checks in by_id if id in checks)
        values = [checks[id].value if id in checks else np.nan for checks in by_id]
        columns.append(Column(id, first.unit, first.name, np.array(values)))
    return columns


def result_columns(rows: Sequence[Row]) -> list[Column]:
    """One column for each requested result."""
    names = dict.fromkeys(name for row in rows for name in row.results)
    return [Column(name.replace(":", "_"), "", name, _array([row.results.get(name) for row in rows])) for name in names]


def _array(values: Sequence[Any]) -> Array:
    """An array of numbers, with nan for None, or of texts."""
    if all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        return np.array(values, dtype=object if any(abs(v) >= 2**63 for v in values) else int)
    if all(value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)) for value in values):
        return np.array([np.nan if value is None else float(value) for value in values])
    return np.array([as_text(value) for value in values], dtype=object)


def as_text(value: Any) -> str:
    """A value as a recipe writes it."""
    if value is None or isinstance(value, bool):
        return "" if value is None else str(value).lower()
    return f"[{', '.join(map(as_text, value))}]" if isinstance(value, list) else str(value)


def _with_unique_names(columns: Sequence[Column]) -> Iterator[Column]:
    """The columns, renamed if an id or header repeats."""
    taken: set[str] = set()
    for column in columns:
        id, number = column.id, 1
        while taken & {column.id, column.header}:
            number += 1
            column = Column(f"{id}_{number}", column.unit, column.meaning, column.values)
        taken |= {column.id, column.header}
        yield column


# Largest number of lines in a plot: as many as colours and dashes distinguish.
MOST_LINES = 6
# Largest number of plots and of points of a line. More make pages of megabytes; the CSV file has all values.
MOST_PLOTS, MOST_POINTS = 40, 1001


def sweep_page(name: str, values: Mapping[str, Sequence[Any]], rows: Sequence[Row]) -> bytes:
    """The page of a sweep. name: of the recipe; values: by key; rows: one for each combination, in order."""
    columns = [*check_columns(rows), *result_columns(rows)]
    refused = sum(bool(row.refused) for row in rows)
    passed = sum(not row.refused and all(check.passed for check in row.checks) for row in rows)
    counts = f"{len(rows):,} combinations of {text(' and '.join(values))}: {passed:,} pass all checks"
    about = f"<p>{counts}; {refused:,} are refused.</p>"
    data, note = _plots(values, rows, columns)
    plots = f'<section id="plots" class="values" aria-label="Plots"></section>\n{note}' if data["plots"] else ""
    unplotted = "" if data["plots"] else '<section id="plots" hidden></section>'
    body = f"{plots}{unplotted}{_table(list(values), rows, columns)}\n"
    return rows_document(f"{name}: a sweep", about, body, data)


def _plots(values: Mapping[str, Sequence[Any]], rows: Sequence[Row], columns: Sequence[Column]) -> tuple[Any, str]:
    """Data of the plots for the player, over the first numeric key, and a note if some lines are left out."""
    data: dict[str, Any] = {"frames": 0, "spots": True, "columns": [], "plots": []}
    along = next((key for key, row in values.items() if len(row) > 1 and all(map(_is_number, row))), None)
    if along is None:
        return data, ""
    others = [key for key in values if key != along]
    abscissas = sorted(values[along])[:MOST_POINTS]
    lines = list(product(*(values[key] for key in others)))
    shown = [lines[k] for k in np.unique(np.rint(np.linspace(0, len(lines) - 1, MOST_LINES)).astype(int))]
    row_of = {(row.values[along], *(as_text(row.values[key]) for key in others)): k for k, row in enumerate(rows)}
    data["frames"], data["columns"] = len(abscissas), [_column(along, "", "", abscissas)]
    limits = [{c.id: (c.limit, f"{c.side} {number(c.limit)}") for c in row.checks} for row in rows]
    for column in [c for c in columns if c.values.dtype.kind in "fi"][:MOST_PLOTS]:
        limit = {by_id[column.id] for by_id in limits if column.id in by_id}
        data["plots"].append(
            {
                "title": harmless(capital(column.meaning)),
                "columns": [len(data["columns"]) + k for k in range(len(shown))],
                # A limit that differs between combinations is not drawn.
                "limits": [[value, label] for value, label in limit if len(limit) == 1 and math.isfinite(value)],
            }
        )
        for line in shown:
            sizes = [f"{key.rpartition('.')[2]} {as_text(value)}" for key, value in zip(others, line)]
            ordinates = [column.values[row_of[x, *map(as_text, line)]] for x in abscissas]
            label = ", ".join(sizes) or capital(column.meaning)
            data["columns"].append(_column(label, column.unit, column.meaning, ordinates))
    note = f"<p>The plots show {len(shown)} of {len(lines):,} lines, evenly chosen; the CSV file has all values.</p>"
    return data, note if len(lines) > len(shown) else ""


def _column(name: str, unit: str, meaning: str, row: Sequence[Any]) -> dict[str, Any]:
    values = [to_digits_or_none(value, 6) for value in row]
    return {"name": harmless(name), "unit": harmless(unit), "meaning": harmless(meaning), "row": values}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _table(keys: Sequence[str], rows: Sequence[Row], columns: Sequence[Column]) -> str:
    """A table of the first `MOST_ROWS` rows."""
    results = [f"{capital(c.meaning)}{f', {c.unit}' if c.unit else ''}" for c in columns]
    heads = "".join(f'<th scope="col">{text(head)}</th>' for head in (*keys, "Checks", *results))
    lines = "".join(_line(keys, row, [c.values[k] for c in columns]) for k, row in enumerate(rows[:MOST_ROWS]))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{lines}</tbody></table>"
    more = f"<p>The CSV file has {len(rows) - MOST_ROWS:,} more rows.</p>" if len(rows) > MOST_ROWS else ""
    return html_section("rows", "All combinations", wide("Combinations", table) + more)


def _line(keys: Sequence[str], row: Row, results: Sequence[Any]) -> str:
    values = "".join(f'<th scope="row">{text(as_text(row.values[key]))}</th>' for key in keys)
    if row.refused:
        return f'<tr class="fails">{values}<td colspan="{1 + len(results)}">{text(row.refused)}</td></tr>'
    failed = [check.name for check in row.checks if not check.passed]
    verdict = text(f"fails: {', '.join(failed)}") if failed else "all pass" if row.checks else "none"
    cells = "".join(f"<td>{text(v) if isinstance(v, str) else number(float(v))}</td>" for v in results)
    return f'<tr class="{"fails" if failed else "holds"}">{values}<td>{verdict}</td>{cells}</tr>'
