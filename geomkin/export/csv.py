"""Tables as CSV: one header row with units, then numbers that spreadsheets read as such."""

from __future__ import annotations

import csv as text_csv
import io
from math import inf, isnan

import numpy as np

from ..core.errors import harmless
from ..model.table import Column, Table
from .job import Job


def table_file(job: Job) -> bytes:
    """The table of the motion as CSV."""
    return csv(job.table)


def csv(table: Table, infinite: str = "") -> bytes:
    """The table as UTF-8 CSV. nan becomes an empty cell; so does infinity, unless a text for it is given."""
    stream = io.StringIO()
    writer = text_csv.writer(stream, lineterminator="\n")
    writer.writerow([_harmless(c.header) for c in table.columns])
    writer.writerows(zip(*[_cells(c, infinite) for c in table.columns]))
    return stream.getvalue().encode("utf-8")


def _cells(column: Column, infinite: str) -> list[str]:
    values = column.written
    if values.dtype.kind in "iub":
        return [str(int(v)) for v in values.tolist()]
    if values.dtype.kind != "f":
        return [_harmless(str(v)) for v in values.tolist()]
    words = {inf: infinite, -inf: infinite and f"-{infinite}"}
    return ["" if isnan(v) else words.get(v, repr(v)) for v in values.tolist()]


def _harmless(text: str) -> str:
    """Text that a spreadsheet does not execute and a terminal does not interpret; formulas are quoted."""
    return f"'{harmless(text)}" if text.lstrip()[:1] in tuple("=+-@\uff1d\uff0b\uff0d\uff20|") else harmless(text)


def bill_file(job: Job) -> bytes:
    """The bill of materials as CSV."""
    return csv(bill(job))


def bill(job: Job) -> Table:
    """The bill of materials: a row for each part, with its drawn width and height, mm, and for each bought item."""
    cuts, bought = job.solids, job.source.bought
    sizes = np.array([cut.box[1] - cut.box[0] for cut in cuts], dtype=complex)
    no_sizes, no_joints = [np.nan] * len(bought), [""] * len(cuts)
    return Table(
        (
            Column("item", "", "part or item", np.array([*(cut.part.name for cut in cuts), *(b.name for b in bought)])),
            Column("count", "", "quantity", np.array([*(cut.part.count for cut in cuts), *(b.count for b in bought)])),
            Column(
                "thickness",
                "mm",
                "thickness of the sheet",
                np.array([*(cut.part.thickness for cut in cuts), *no_sizes]),
            ),
            Column("width", "mm", "width along x", np.array([*sizes.real.tolist(), *no_sizes])),
            Column("height", "mm", "height along y", np.array([*sizes.imag.tolist(), *no_sizes])),
            Column(
                "joints",
                "",
                "joints or parts it belongs to",
                np.array([*no_joints, *(" ".join(b.joints) for b in bought)]),
            ),
        )
    )
