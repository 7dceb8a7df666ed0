"""Parts nested by their true outlines: each where the sheet grows least, in hollows and holes of others, too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..plane.primitives import Circle
from ..plane.vec import Complex, Mask, Real, direction_deg, rounded
from .cut import Cut, Loop, is_inside

# Cells in which a sheet is looked at. More find room that is narrower, and take longer by as much.
CELLS = 20_000
# Copies that are nested at most: each takes about a millisecond. More lie in rows, which waste little of so many.
MOST = 100
# Steps along an outline, in cells: longer ones keep parts farther apart than the gap, shorter ones take longer.
STEP = 0.5
# Turns, deg, that are tried for a part's least box, and the share of its own box that one must save. For less a part
# lies as it is drawn or by quarter turns: who compares drawings wants to know it again.
TURNS, WORTH = np.arange(90), 0.1
# Vertices of an outline that are looked at for its turn: enough to choose by.
LOOKED_AT = 200
# Decimals of mm and of cells that decide: no last digit may.
DECIMALS = 6
# Of a place that is taken: above all keys of free ones, which stay below a sheet's width and height in mm, squared.
NEVER = np.iinfo(np.int64).max


@record(eq=False)
class Place:
    """Where a copy lies: turned about the origin of its frame, unit complex, then shifted, complex mm.

    corner: upper right one of its box, mm.
    """

    turn: complex
    shift: complex
    corner: complex


@record(eq=False)
class Orientation:
    """A way in which a part can lie.

    low, size: of its box, turned, in whole mm. cells: those that it and half the gap round it take, rows upwards;
    inset: whole mm from their corner to the box's. spectrum: of the cells, to find what they meet at all places.
    """

    turn: complex
    low: complex
    size: complex
    cells: Mask
    inset: complex
    spectrum: Complex


def nest(cuts: Sequence[Cut], width: float, height: float, gap: float) -> list[list[tuple[int, Place]]]:
    """Sheets, each as the index of a part and where it lies, so often as the part is needed; the largest come first.

    width, height: of a sheet, mm, inside its margins; each part finds room there by itself, see `box`. Between two
    parts is the gap at least, mm.
    """
    cell = max(1, int(np.ceil(np.sqrt(width * height / CELLS))))
    # To a sample, from all that is near any place of the outline that it stands for.
    near = gap / 2 / cell + STEP / 2
    margin = int(np.ceil(near))
    shape = _smooth(int(height // cell) + 2 * margin + 2), _smooth(int(width // cell) + 2 * margin + 2)
    lies = [_lies(cut, cell, near, shape) for cut in cuts]
    sheets: list[_Sheet] = []
    copies = [k for k, cut in enumerate(cuts) for _ in range(cut.part.count)]
    for k in sorted(copies, key=lambda k: (-int(lies[k][0].cells.sum()), k)):
        if not any(sheet.take(k, lies[k]) for sheet in sheets):
            sheets.append(_Sheet(width, height, cell, margin * cell, shape))
            sheets[-1].take(k, lies[k])
    return [sheet.taken for sheet in sheets]


def least_turn(cut: Cut) -> complex:
    """The turn by whole degrees that gives a part its least box; 1 where that saves little."""
    if cut.is_twisted:
        return 1 + 0j
    z = cut.loops[0].points
    # Turned, the shortest edges would be lost in rounding.
    if min(np.abs(np.diff(loop.points)).min() for loop in cut.loops) < 10 * 10.0**-cut.digits:
        return 1 + 0j
    turned = z[:: len(z) // LOOKED_AT + 1] * direction_deg(TURNS)[:, None]
    areas: Real = np.ptp(turned.real, axis=1) * np.ptp(turned.imag, axis=1) / np.ptp(z.real) / np.ptp(z.imag)
    best = int(np.argmin(np.round(areas, DECIMALS)))
    return complex(direction_deg(TURNS[best])) if areas[best] < 1 - WORTH else 1 + 0j


def box(cut: Cut, turn: complex) -> tuple[complex, complex]:
    """Lower left corner and size of a part's box, turned: whole mm, so that copies keep the part's own decimals."""
    if cut.is_twisted:
        corners = _corners(cut) * turn
        ends = complex(corners.real.min(), corners.imag.min()), complex(corners.real.max(), corners.imag.max())
    else:
        ends = cut.loops[0].moved(0j, cut.digits, turn).box
    low, high = (rounded(corner, DECIMALS).item() for corner in ends)
    low = complex(np.floor(low.real), np.floor(low.imag))
    return low, complex(np.ceil(high.real), np.ceil(high.imag)) - low


def _corners(cut: Cut) -> Complex:
    """Of a part's box, mm, counterclockwise: what one takes that leans."""
    low, high = cut.box
    return np.array([low, complex(high.real, low.imag), high, complex(low.real, high.imag)])


def _lies(cut: Cut, cell: int, near: float, shape: tuple[int, int]) -> list[Orientation]:
    """All that differ, those before half a turn first; a round part has one."""
    found: list[Orientation] = []
    # What lies in a hole has the gap all round; none lies in one whose sides lean.
    holes = [] if cut.part.twist else [hole.points for hole in cut.loops[1:] if _side(hole) > 2 * near * cell]
    loops = [_corners(cut) if cut.is_twisted else cut.loops[0].points, *holes]
    first = least_turn(cut)
    turns = (1 + 0j,) if isinstance(cut.loops[0].shape, Circle) else (first, 1j * first)
    for turn in turns:
        low, size = box(cut, turn)
        cells, inset = _cells([(loop * turn - low) / cell for loop in loops], size / cell, near)
        # Half a turn on, the same cells run the other way.
        rest = cell * complex(*cells.shape[::-1]) - size - cell * inset
        ways = ((turn, low, cells, cell * inset), (-turn, -low - size, cells[::-1, ::-1], rest))
        for way, corner, taken, room in ways[: len(turns)]:
            if not any(np.array_equal(taken, one.cells) for one in found):
                found.append(
                    Orientation(way, corner, size, taken, room, np.conj(np.fft.rfft2(taken.astype(np.float32), shape)))
                )
    return sorted(found, key=lambda one: one.turn not in turns)


def _side(loop: Loop) -> float:
    """Least side of a loop's box, mm."""
    return float(min(np.ptp(loop.points.real), np.ptp(loop.points.imag)))


def _cells(loops: Sequence[Complex], size: complex, near: float) -> tuple[Mask, complex]:
    """Cells that lie within `near` of a part's outline or have their middle in it; and where its box begins in them.

    loops: the outline and the holes, all in a box from 0 to `size`; everything in cells.
    """
    margin = int(np.ceil(near))
    taken = np.zeros([int(side) + 1 + 2 * margin for side in (size.imag, size.real)], dtype=bool)
    crossed = np.zeros(taken.shape, dtype=np.intp)
    steps = np.arange(-margin, margin + 1)
    for loop in loops:
        places = rounded(_samples(loop), DECIMALS) + margin * (1 + 1j)
        x, y = (np.floor(part).astype(np.intp) for part in (places.real, places.imag))
        # Squares of how far cells lie beside and above a sample.
        beside, above = (
            np.maximum(np.abs((at - place)[:, None] + steps + 0.5) - 0.5, 0) ** 2
            for at, place in ((x, places.real), (y, places.imag))
        )
        sample, up, along = np.nonzero(above[:, :, None] + beside[:, None, :] <= near**2)
        taken[y[sample] + steps[up], x[sample] + steps[along]] = True
        # The rows whose middle lies between one sample and the next: from there to the right is inside, or out again.
        below = np.floor(places.imag + 0.5).astype(np.intp)
        after = np.append(below[1:], below[:1])
        np.add.at(crossed, (np.minimum(below, after)[below != after], x[below != after]), 1)
    return taken | (np.cumsum(crossed, axis=1) % 2 == 1), margin * (1 + 1j)


def _samples(loop: Complex) -> Complex:
    """Places along a closed polygon, its corners among them, at most a step apart."""
    edges = np.append(loop[1:], loop[:1]) - loop
    counts = np.maximum(np.ceil(np.round(np.abs(edges) / STEP, DECIMALS)), 1).astype(np.intp)
    share = (np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)) / np.repeat(counts, counts)
    return np.repeat(loop, counts) + share * np.repeat(edges, counts)


def _smooth(number: int) -> int:
    """The next number whose prime factors are 2, 3 and 5: spectra of others take several times as long."""
    left = number
    for factor in (2, 3, 5):
        while left % factor == 0:
            left //= factor
    return number if left == 1 else _smooth(number + 1)


class _Sheet:
    """A sheet that fills: which of its cells are taken, and how far to the right and up its parts reach, mm.

    Cells and spectra are of single precision: what they count is off by a hundredth at most.
    """

    def __init__(self, width: float, height: float, cell: int, margin: float, shape: tuple[int, int]) -> None:
        self.room, self.cell, self.margin = complex(width, height), cell, margin * (1 + 1j)
        self.cells = np.zeros(shape, dtype=np.float32)
        self.reach = 0j
        self.taken: list[tuple[int, Place]] = []

    def take(self, part: int, lies: Sequence[Orientation]) -> bool:
        """Lay a part where width and height grow least together, nearest to the corner; False where no room is left."""
        spectrum = np.fft.rfft2(self.cells)
        least, best = NEVER, None
        for lie in lies:
            # Where its box can end, of all cells where its own can begin.
            first = lie.inset - self.margin + lie.size
            x, y = (
                np.arange(start, most + 1e-9, self.cell)
                for start, most in ((first.real, self.room.real), (first.imag, self.room.imag))
            )
            if not (len(x) and len(y)):
                continue
            met = np.fft.irfft2(spectrum * lie.spectrum, self.cells.shape)[: len(y), : len(x)]
            grown = np.maximum(x, self.reach.real) + np.maximum(y, self.reach.imag)[:, None]
            keys = grown * (self.room.real + self.room.imag + 1) + (x + y[:, None])
            keys = np.where(met < 0.5, keys.astype(np.int64), NEVER)
            at = int(np.argmin(keys))
            if keys.flat[at] < least:
                row, column = divmod(at, len(x))
                least, best = keys.flat[at], (lie, row, column, complex(x[column], y[row]))
        if best is None:
            return False
        lie, row, column, end = best
        self.cells[row : row + len(lie.cells), column : column + len(lie.cells[0])] += lie.cells
        self.reach = complex(max(self.reach.real, end.real), max(self.reach.imag, end.imag))
        self.taken.append((part, Place(lie.turn, end - lie.size - lie.low, end)))
        return True


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


@record(eq=False)
class Placed:
    """One copy of a part, and what takes its own frame to the sheet: a turn, unit complex, then a shift, complex mm."""

    cut: Cut
    shift: complex
    turn: complex = 1 + 0j

    @property
    def loops(self) -> tuple[Loop, ...]:
        """All of it on the sheet, in the order of the work.

        Holes first, then marks, then the outline: what is cut free drops or tilts, and takes no more cuts.
        """
        outline, *holes = self.cut.loops
        inner = [holes[k] for k in nearest_next([hole.points[0] for hole in holes], outline.box[0])]
        return tuple(loop.moved(self.shift, self.cut.digits, self.turn) for loop in (*inner, *self.cut.marks, outline))


@record(eq=False)
class Sheet:
    """All copies; the sheet reaches from the origin to (width, height), mm, margins included."""

    placed: tuple[Placed, ...]
    width: float
    height: float

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
