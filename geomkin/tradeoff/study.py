"""The stability study: every cell at falling distances, and the table of where methods break."""

from __future__ import annotations

import csv
import io
from functools import cached_property
from html import escape

import numpy as np

from ..core.arguments import Reals, checked
from ..core.errors import DesignError
from ..core.records import record
from .breaking import cams as cams
from .breaking import gears as gears
from .breaking import linkages as linkages
from .breaking import poses as poses
from .cell import ANSWERS, Cell, Digits, answered, measured

CELLS: tuple[Cell, ...] = (*linkages.CELLS, *linkages.INSTANT_CELLS, *poses.CELLS, *cams.CELLS, *gears.CELLS)
# Powers of ten of the distance to the place where methods fail.
POWERS = tuple(range(1, 16))
# What digits are told of.
KINDS = ("library", "textbook", "allowed")
# Distances whose digits the page shows.
SHOWN = (1e-4, 1e-8, 1e-12, 1e-15)


@record(eq=False)
class Stability:
    """What was found: for each cell its digits by falling distance."""

    found: tuple[tuple[Digits, ...], ...]

    @cached_property
    def answers(self) -> tuple[str, ...]:
        """What the library does at each cell, a key of `ANSWERS`; another text where it loses digits without a word."""
        return tuple(answered(row) for row in self.found)

    def csv(self) -> bytes:
        """A row for each cell, with the digits at each distance; where there are none, `nan` or `refused`."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        heads = [f"{kind}_{one.distance:.0e}" for kind in KINDS for one in self.found[0]]
        writer.writerow(["family", "place", "result", "distance", "library_does", "told_by", *heads])
        for row, answer in zip(self.found, self.answers):
            cell = row[0].cell
            about = cell.family, cell.place, cell.result, cell.distance, ANSWERS.get(answer, answer), cell.told
            writer.writerow([*about, *(_told(one, kind) for kind in KINDS for one in row)])
        return stream.getvalue().encode("utf-8")

    def section(self) -> str:
        """The table of where methods break, as a part of a page."""
        shown = [k for k, one in enumerate(self.found[0]) if any(abs(one.distance / d - 1) < 0.1 for d in SHOWN)]
        spans = f'colspan="{len(shown)}"'
        heads = "".join(f"<th>{self.found[0][k].distance:.0e}</th>" for k in shown)
        lines = [
            '<section id="stability"><h2>Where methods break</h2>',
            "<p>Decimal digits that the library keeps as the place comes near at which methods fail, and those of the "
            "textbook's formula in the same double precision, against arithmetic of 120 digits. Sizes: the digits that "
            "are left where each size is off by half of its last bit.</p>",
            '<div class="wide"><table><thead>',
            '<tr><th rowspan="2">Place</th><th rowspan="2">Result</th><th rowspan="2">Distance</th>'
            f"<th {spans}>Library</th><th {spans}>Textbook</th><th {spans}>Sizes</th>"
            '<th rowspan="2">What the library does</th></tr>',
            f"<tr>{heads * 3}</tr></thead><tbody>",
        ]
        for row, answer in zip(self.found, self.answers):
            cell = row[0].cell
            does = ANSWERS.get(answer, answer) + (f"; told by {cell.told}" if cell.told else "")
            digits = [f"<td>{_told(row[k], kind)}</td>" for kind in KINDS for k in shown]
            about = (cell.place, f"{cell.family}: {cell.result}", cell.distance)
            lines.append(f"<tr>{''.join(f'<th>{escape(text)}</th>' for text in about)}{''.join(digits)}")
            lines.append(f"<td>{escape(does)}</td></tr>")
        return "\n".join([*lines, "</tbody></table></div></section>"])


@checked
def stability(distances: Reals | None = None) -> Stability:
    """Decimal digits that the library keeps at every cell of `CELLS`, at distances from the place where methods fail.

    distances: above 0 and at most 0.1, as shares of the sizes, falling; 1e-1 to 1e-15 unless given. Asks for mpmath,
    which the extra `test` brings. DesignError for other distances.
    """
    given = np.asarray([10.0**-k for k in POWERS] if distances is None else distances, dtype=float)
    falling = given.ndim == 1 and given.size > 0 and bool(np.all(np.diff(given) < 0))
    if not falling or not 1e-15 <= given.min() <= given.max() <= 0.1:
        raise DesignError("distances", f"found {distances!r}", "give falling numbers from 0.1 down to 1e-15")
    return Stability(tuple(tuple(measured(cell, x) for x in given.tolist()) for cell in CELLS))


def _told(one: Digits, kind: str) -> str:
    value = getattr(one, kind)
    return f"{value:.1f}" if not np.isnan(value) else "refused" if kind == "library" and one.refused else "nan"
