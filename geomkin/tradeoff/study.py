"""The stability study: digits of every cell at falling distances, and a table of the results."""

from __future__ import annotations

import csv
import io
from functools import cached_property
from html import escape

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from .breaking import CELLS
from .cell import ANSWERS, Digits, answered, measured_digits

# Negative powers of ten of the distance from the singular position; kinds of digits; distances that the page shows.
POWERS, DIGIT_KINDS, SHOWN = tuple(range(1, 16)), ("library", "textbook", "allowed"), (1e-4, 1e-8, 1e-12, 1e-15)
MISSING = (
    "The study of the places where methods lose digits is left out, since it needs mpmath. To add it, install mpmath "
    "(pip install mpmath) and measure the chart again."
)


@record(eq=False)
class Stability:
    """Results of the stability study.

    Parameters
    ----------
    results : tuple of tuple of Digits
        For each cell its digits by falling distance.
    """

    results: tuple[tuple[Digits, ...], ...]

    @cached_property
    def answers(self) -> tuple[str, ...]:
        """Behaviour of the library at each cell: a key of `ANSWERS`, or another text if it loses digits silently."""
        return tuple(answered(row) for row in self.results)

    def csv(self) -> bytes:
        """A row for each cell with its digits at each distance, or `nan` or `refused`."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        heads = [f"{kind}_{digits.distance:.0e}" for kind in DIGIT_KINDS for digits in self.results[0]]
        writer.writerow(["family", "place", "result", "distance", "library_does", "reported_by", *heads])
        for row, answer in zip(self.results, self.answers):
            cell = row[0].cell
            about = cell.family, cell.place, cell.result, cell.distance, ANSWERS.get(answer, answer), cell.reported_by
            writer.writerow([*about, *(digits.text(kind) for kind in DIGIT_KINDS for digits in row)])
        return stream.getvalue().encode("utf-8")

    def section(self) -> str:
        """The table of the study as HTML."""
        shown = [k for k, one in enumerate(self.results[0]) if any(abs(one.distance / d - 1) < 0.1 for d in SHOWN)]
        spans = f'colspan="{len(shown)}"'
        heads = "".join(f"<th>{self.results[0][k].distance:.0e}</th>" for k in shown)
        lines = [
            "<p>Decimal digits that the library keeps near singular positions, and those that the "
            "textbook's formula keeps in double precision, compared with arithmetic of 120 digits. Sizes: the digits "
            "that remain if each size has an error of half of its last bit.</p>",
            '<div class="wide"><table><thead>',
            '<tr><th rowspan="2">Place</th><th rowspan="2">Result</th><th rowspan="2">Distance</th>'
            f"<th {spans}>Library</th><th {spans}>Textbook</th><th {spans}>Sizes</th>"
            '<th rowspan="2">What the library does</th></tr>',
            f"<tr>{heads * 3}</tr></thead><tbody>",
        ]
        for row, answer in zip(self.results, self.answers):
            cell = row[0].cell
            does = ANSWERS.get(answer, answer) + (f"; reported by {cell.reported_by}" if cell.reported_by else "")
            digits = [f"<td>{row[k].text(kind)}</td>" for kind in DIGIT_KINDS for k in shown]
            about = (cell.place, f"{cell.family}: {cell.result}", cell.distance)
            heads = "".join(f"<th>{escape(text)}</th>" for text in about)
            lines.append(f"<tr>{heads}{''.join(digits)}<td>{escape(does)}</td></tr>")
        return "\n".join([*lines, "</tbody></table></div>"])


@checked
def stability(distances: None | float | ArrayLike = None) -> Stability:
    """Measure the decimal digits that the library keeps near singular positions.

    Parameters
    ----------
    distances : array_like, optional
        Distances from the singular position as shares of the sizes, falling from at most 0.1 to at least 1e-15; 1e-1 to
        1e-15 by default.

    Returns
    -------
    Stability
        The digits of every cell.

    Raises
    ------
    DesignError
        For other distances, or if mpmath is not installed.
    """
    given = np.asarray([10.0**-k for k in POWERS] if distances is None else distances, dtype=float)
    falling = given.ndim == 1 and given.size > 0 and bool(np.all(np.diff(given) < 0))
    if not falling or not 1e-15 <= given.min() <= given.max() <= 0.1:
        remedy = "give falling numbers from 0.1 down to 1e-15"
        raise DesignError("distances", f"found {distances!r}", remedy, "out-of-range")
    return Stability(tuple(tuple(measured_digits(cell, x) for x in given.tolist()) for cell in CELLS))
