"""The stability study: digits of every cell at falling distances, and a table of the results."""

from __future__ import annotations

import csv
import io
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from .breaking import CELLS
from .cell import ANSWERS, Digits, answered, measured_digits

# Negative powers of ten of the distance from the singular position, and those whose digits the page shows.
POWERS, SHOWN = tuple(range(1, 16)), (4, 8, 12, 15)
DIGIT_KINDS = ("library", "textbook", "allowed")
# What the page shows of each cell.
HEADS = ("mechanism", "place", "distance", "result", "geomkin", "textbook", "possible", "what geomkin does")
EXPLANATION = (
    "Correct decimal digits, of 16, at distances of 1e-4, 1e-8, 1e-12 and 1e-15 from singular positions: those that "
    "geomkin keeps, and those that the textbook's formula keeps in double precision, compared with arithmetic of 120 "
    "digits. Possible: the digits that remain if each size has an error of half of its last bit."
)
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

    @property
    def table(self) -> tuple[tuple[str, ...], ...]:
        """A row for each cell, of the columns `HEADS`."""

        def cells(row: tuple[Digits, ...], answer: str) -> tuple[str, ...]:
            cell, shown = row[0].cell, [one for one in row if round(-np.log10(one.distance)) in SHOWN]
            digits = (" ".join(one.text(kind).split(".")[0] for one in shown) for kind in DIGIT_KINDS)
            does = ANSWERS.get(answer, answer) + (f"; reported by {cell.reported_by}" if cell.reported_by else "")
            return cell.family, cell.place, cell.distance, cell.result, *digits, does

        return tuple(map(cells, self.results, self.answers))


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
