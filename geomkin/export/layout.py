"""Parts laid out flat, apart and at full size: where each copy lies on the sheet, or on which."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..brief import one_line
from ..errors import DesignError
from .cut import Cut, Loop, is_inside
from .nest import MOST, Place, box, nest

# Operations that a cutting program tells apart, each with its colour index, for programs that know only those, and its
# RGB; colour-blind readers tell them apart too.
LAYERS: dict[str, tuple[int, tuple[int, int, int]]] = {
    "CUT": (1, (213, 94, 0)),
    "HOLE": (5, (0, 114, 178)),
    "ENGRAVE": (3, (0, 158, 115)),
    "LABEL": (6, (204, 121, 167)),
    "REFERENCE": (8, (110, 110, 110)),
}
# Clear space between parts, mm: less lets kerf and heat of one cut reach the next part.
GAP = 5.0
# How much longer and wider than rows would take may the sheet be in which parts are nested first. More makes the
# raster coarser; less leaves no other form to try.
SPARE = 1.1


@dataclass(frozen=True, eq=False)
class Placed:
    """One copy of a part, and what takes its own frame to the sheet: a turn, unit complex, then a shift, complex mm."""

    cut: Cut
    shift: complex
    turn: complex = 1 + 0j

    __repr__ = one_line

    @property
    def loops(self) -> tuple[Loop, ...]:
        """All of it on the sheet, in the order of the work.

        Holes first, then marks, then the outline: what is cut free drops or tilts, and takes no more cuts.
        """
        outline, *holes = self.cut.loops
        inner = [holes[k] for k in nearest_next([hole.points[0] for hole in holes], outline.box[0])]
        return tuple(loop.moved(self.shift, self.cut.digits, self.turn) for loop in (*inner, *self.cut.marks, outline))


@dataclass(frozen=True, eq=False)
class Sheet:
    """All copies; the sheet reaches from the origin to (width, height), mm, margins included."""

    placed: tuple[Placed, ...]
    width: float
    height: float

    __repr__ = one_line

    @property
    def extents(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of all that is cut, mm."""
        low, high = np.array([p.loops[-1].box for p in self.placed]).T
        return complex(low.real.min(), low.imag.min()), complex(high.real.max(), high.imag.max())

    @property
    def filled(self) -> float:
        """Share of the sheet that becomes parts."""
        return sum(one.cut.area for one in self.placed) / (self.width * self.height)


def nearest_next(places: Sequence[complex], start: complex) -> list[int]:
    """An order of places, mm, in which each is the nearest one to the last: a head that moves less is done sooner."""
    left, order, here = np.array(places, dtype=complex), [], start
    for _ in places:
        # To the micrometre, so that no last digit chooses between two that are equally far.
        order.append(int(np.argmin(np.round(np.abs(left - here), 3))))
        here, left[order[-1]] = complex(left[order[-1]]), np.inf
    return order


def lay_out(cuts: Sequence[Cut]) -> Sheet:
    """All parts on one sheet, about as wide as it is high and no larger than they take: nested where that is less."""
    rows = _least_rows(cuts)
    if not 1 < len(rows.placed) <= MOST:
        return rows
    side = SPARE * max(rows.width, rows.height)
    return _lesser(cuts, nest(cuts, side, side, GAP), rows) or rows


def lay_out_on(cuts: Sequence[Cut], width: float, height: float) -> tuple[Sheet, ...]:
    """The parts on as many sheets of a size, mm, as they take; those of another thickness on others.

    Raises DesignError for a part that no quarter turn makes fit.
    """
    _refuse_larger(cuts, width, height)
    room = width - 2 * GAP, height - 2 * GAP
    sheets: list[Sheet] = []
    for thickness in sorted({cut.part.thickness for cut in cuts}):
        some = [cut for cut in cuts if cut.part.thickness == thickness]
        rows = _least_rows(some)
        if len(rows.placed) > MOST:
            turns = [1 + 0j if _fits(box(cut, 1 + 0j)[1], *room) else 1j for cut in some]
            sheets += [_sheet(some, one, width, height) for one in _in_rows(some, turns, *room)]
            continue
        # A corner of a large sheet first: all of it could only be looked at coarsely.
        side = SPARE * max(rows.width, rows.height)
        across = min(room[0], side * side / min(room[1], side))
        nested = nest(some, across, min(room[1], side * side / across), GAP)
        if rows.width <= width and rows.height <= height and not _lesser(some, nested, rows):
            sheets.append(replace(rows, width=width, height=height))
            continue
        nested = nested if len(nested) == 1 else nest(some, *room, GAP)
        sheets += [_sheet(some, one, width, height) for one in nested]
    return tuple(sheets)


def _lesser(cuts: Sequence[Cut], nested: Sequence[Sequence[tuple[int, Place]]], rows: Sheet) -> Sheet | None:
    """The sheet of parts that are nested on a single one, where it is smaller than in rows."""
    sheet = _sheet(cuts, nested[0])
    return sheet if len(nested) == 1 and sheet.width * sheet.height < rows.width * rows.height else None


def _fits(size: complex, width: float, height: float) -> bool:
    return size.real <= width and size.imag <= height


def _refuse_larger(cuts: Sequence[Cut], width: float, height: float) -> None:
    sizes = [box(cut, 1 + 0j)[1] for cut in cuts]
    for cut, size in zip(cuts, sizes):
        if not any(
            _fits(size, *room) for room in ((width - 2 * GAP, height - 2 * GAP), (height - 2 * GAP, width - 2 * GAP))
        ):
            long = max(max(one.real, one.imag) for one in sizes) + 2 * GAP
            short = max(min(one.real, one.imag) for one in sizes) + 2 * GAP
            raise DesignError(
                "sheet",
                f"found {width:g} x {height:g} mm, and the {cut.part.name} is {size.real:g} x {size.imag:g} mm",
                f"give at least [{long:g}, {short:g}], which has {GAP:g} mm to each edge",
            )


def _least_rows(cuts: Sequence[Cut]) -> Sheet:
    """All parts in rows, on a sheet about as wide as it is high."""
    counted = [(cut.part.count, box(cut, 1 + 0j)[1]) for cut in cuts]
    room = sum(count * (size.real + GAP) * (size.imag + GAP) for count, size in counted)
    across = max(max(size.real for _, size in counted), float(np.sqrt(room)) * 1.2 - 2 * GAP)
    (rows,) = _in_rows(cuts, [1 + 0j for _ in cuts], across, np.inf)
    return _sheet(cuts, rows)


def _in_rows(cuts: Sequence[Cut], turns: Sequence[complex], across: float, up: float) -> list[list[tuple[int, Place]]]:
    """Rows of parts, highest first, on sheets of so much room, mm; each as the index of a part and where it lies."""
    boxes = [box(cut, turn) for cut, turn in zip(cuts, turns)]
    copies = [k for k, cut in enumerate(cuts) for _ in range(cut.part.count)]
    filled: list[list[tuple[int, Place]]] = [[]]
    x = y = row = 0.0
    for k in sorted(copies, key=lambda k: (-boxes[k][1].imag, k)):
        low, size = boxes[k]
        if x and x + size.real > across:
            x, y, row = 0.0, y + row + GAP, 0.0
        if filled[-1] and y + size.imag > up:
            filled.append([])
            x = y = row = 0.0
        filled[-1].append((k, Place(turns[k], complex(x, y) - low, complex(x, y) + size)))
        x, row = x + size.real + GAP, max(row, size.imag)
    return filled


def _sheet(cuts: Sequence[Cut], places: Sequence[tuple[int, Place]], width: float = 0.0, height: float = 0.0) -> Sheet:
    """The parts within margins, in the order of the work, on a sheet of a size, mm; 0: as large as they take."""
    margin = GAP * (1 + 1j)
    placed = [Placed(cuts[k], place.shift + margin, place.turn) for k, place in sorted(places, key=lambda one: one[0])]
    return Sheet(
        tuple(_in_order(placed)),
        width or max(place.corner.real for _, place in places) + 2 * GAP,
        height or max(place.corner.imag for _, place in places) + 2 * GAP,
    )


def _in_order(placed: Sequence[Placed]) -> list[Placed]:
    """The nearest one next, but what lies in another part's hole first: that drops out as a whole."""
    starts = np.array([one.turn * one.cut.loops[0].points[0] + one.shift for one in placed])
    depths = np.zeros(len(placed), dtype=int)
    for one in placed if len(placed) <= MOST else ():
        for hole in one.cut.loops[1:]:
            ring = hole.points * one.turn + one.shift
            near = (ring.real.min() < starts.real) & (starts.real < ring.real.max())
            near &= (ring.imag.min() < starts.imag) & (starts.imag < ring.imag.max())
            for k in np.flatnonzero(near):
                depths[k] += is_inside(ring, complex(starts[k]))
    order: list[int] = []
    for depth in sorted(set(depths.tolist()), reverse=True):
        some = np.flatnonzero(depths == depth)
        here = complex(starts[order[-1]]) if order else 0j
        order += [int(some[k]) for k in nearest_next(starts[some].tolist(), here)]
    return [placed[k] for k in order]
