"""Parts nested on sheets by their true outlines, also in hollows and holes of other parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np

from ..core.errors import DesignError
from ..core.records import record
from ..core.units import bare_mm, mm, rounded_down
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, Mask, Real, box_of, direction_deg, rounded
from .cut import Cut, Loop, is_inside

# Cells of a sheet's raster. More cells find narrower gaps and take proportionally longer.
CELLS = 20_000
# Those of a sheet if parts could need fewer sheets.
FINE_CELLS = 60_000
# Largest number of nested copies, which take about 3 milliseconds each, and 10 with fine cells. More are laid in rows,
# which then waste little.
MOST = 200
# Step along an outline, in cells. Longer steps keep parts farther apart than the gap, shorter ones take longer.
STEP = 0.5
# Rotations, deg, tried for a part's smallest box, and the share of the box that a rotation must save. Otherwise a part
# keeps its orientation up to quarter turns, so that it is recognised in other drawings.
ROTATIONS_DEG, LEAST_SAVING = np.arange(90), 0.1
# Vertices of an outline that are used for choosing its rotation.
SAMPLED_VERTICES = 200
# Decimals of mm and of cells for decisions, so that last digits do not count.
DECIMALS = 6
# Sort key of an occupied position, above those of all free ones, which are below (width + height)^2 of a sheet in mm.
OCCUPIED = np.iinfo(np.int64).max


@record(eq=False)
class SheetPosition:
    """Position of a copy: rotated about the origin of its frame (unit complex), then shifted, complex mm.

    `corner` is the upper right one of its box, mm.
    """

    turn: complex
    shift: complex
    corner: complex


@record(eq=False)
class Orientation:
    """A possible orientation of a part.

    `low` and `size` describe its rotated box in whole mm. `cells` are those of the part and half the gap around it,
    rows upwards; `inset` is the distance in whole mm from their corner to the box's. `spectrum` is the transform of the
    cells, which finds collisions at all positions.
    """

    turn: complex
    low: complex
    size: complex
    cells: Mask
    inset: complex
    spectrum: Complex


def nest(
    cuts: Sequence[Cut], width: float, height: float, gap: float, *, fine: bool = False
) -> list[list[tuple[int, SheetPosition]]]:
    """Sheets as lists of a part's index and its position, the largest parts first.

    `width` and `height` are those of a sheet inside its margins, mm; each part must fit by itself, see `box`. `gap` is
    the least distance of two parts, mm. `fine`: fill whole sheets by a finer raster, instead of keeping their parts
    within a small box.
    """
    cell = max(1, int(np.ceil(np.sqrt(width * height / (FINE_CELLS if fine else CELLS)))))
    # Distance from a sample that covers the surroundings of its whole step.
    distance = gap / 2 / cell + STEP / 2
    margin = int(np.ceil(distance))
    shape = _smooth(int(height // cell) + 2 * margin + 2), _smooth(int(width // cell) + 2 * margin + 2)
    orientations = [_orientations(cut, cell, distance, shape) for cut in cuts]
    sheets: list[_SheetRaster] = []
    copies = [k for k, cut in enumerate(cuts) for _ in range(cut.part.count)]
    for k in sorted(copies, key=lambda k: (-int(orientations[k][0].cells.sum()), k)):
        if not any(sheet.take(k, orientations[k]) for sheet in sheets):
            sheets.append(_SheetRaster(width, height, cell, margin * cell, shape, is_whole=fine))
            sheets[-1].take(k, orientations[k])
    return [sheet.taken for sheet in sheets]


def least_turn(cut: Cut) -> complex:
    """The rotation by whole degrees that gives a part its smallest box; 1 if it saves little."""
    if cut.is_twisted:
        return 1 + 0j
    z = cut.loops[0].points
    # Rotated, the shortest edges would be lost in rounding.
    if min(np.abs(np.diff(loop.points)).min() for loop in cut.loops) < 10 * 10.0**-cut.digits:
        return 1 + 0j
    turned = z[:: len(z) // SAMPLED_VERTICES + 1] * direction_deg(ROTATIONS_DEG)[:, None]
    areas: Real = np.ptp(turned.real, axis=1) * np.ptp(turned.imag, axis=1) / np.ptp(z.real) / np.ptp(z.imag)
    best = int(np.argmin(np.round(areas, DECIMALS)))
    return complex(direction_deg(ROTATIONS_DEG[best])) if areas[best] < 1 - LEAST_SAVING else 1 + 0j


def box(cut: Cut, turn: complex) -> tuple[complex, complex]:
    """Lower left corner and size of a part's rotated box in whole mm, so that copies keep the part's decimals."""
    ends = box_of(_corners(cut) * turn) if cut.is_twisted else cut.loops[0].moved(0j, cut.digits, turn).box
    low, high = (rounded(corner, DECIMALS).item() for corner in ends)
    low = complex(np.floor(low.real), np.floor(low.imag))
    return low, complex(np.ceil(high.real), np.ceil(high.imag)) - low


def _corners(cut: Cut) -> Complex:
    """Corners of a part's box, mm, counterclockwise."""
    low, high = cut.box
    return np.array([low, complex(high.real, low.imag), high, complex(low.real, high.imag)])


def _orientations(cut: Cut, cell: int, near: float, shape: tuple[int, int]) -> list[Orientation]:
    """All distinct orientations; a round part has one."""
    orientations: list[Orientation] = []
    # A part in a hole needs the gap all round; holes with inclined sides are not used.
    holes = [] if cut.part.twist else [hole.points for hole in cut.loops[1:] if _side(hole) > 2 * near * cell]
    loops = [_corners(cut) if cut.is_twisted else cut.loops[0].points, *holes]
    first = least_turn(cut)
    turns = (1 + 0j,) if isinstance(cut.loops[0].shape, Circle) else (first, 1j * first)
    for turn in turns:
        low, size = box(cut, turn)
        cells, inset = _cells([(loop * turn - low) / cell for loop in loops], size / cell, near)
        # After half a turn the cells are reversed.
        rest = cell * complex(*cells.shape[::-1]) - size - cell * inset
        variants = ((turn, low, cells, cell * inset), (-turn, -low - size, cells[::-1, ::-1], rest))
        for rotation, corner, cells_taken, inset_mm in variants[: len(turns)]:
            if not any(np.array_equal(cells_taken, other.cells) for other in orientations):
                orientations.append(
                    Orientation(
                        rotation,
                        corner,
                        size,
                        cells_taken,
                        inset_mm,
                        np.conj(np.fft.rfft2(cells_taken.astype(np.float32), shape)),
                    )
                )
    return sorted(orientations, key=lambda other: other.turn not in turns)


def _side(loop: Loop) -> float:
    """Shortest side of a loop's box, mm."""
    return float(min(np.ptp(loop.points.real), np.ptp(loop.points.imag)))


def _cells(loops: Sequence[Complex], size: complex, near: float) -> tuple[Mask, complex]:
    """Cells within `near` of a part's outline or with their middle inside it, and the origin of its box in them.

    `loops` are the outline and the holes in a box from 0 to `size`; everything is in cells.
    """
    margin = int(np.ceil(near))
    taken = np.zeros([int(side) + 1 + 2 * margin for side in (size.imag, size.real)], dtype=bool)
    crossed = np.zeros(taken.shape, dtype=np.intp)
    steps = np.arange(-margin, margin + 1)
    for loop in loops:
        places = rounded(_samples(loop), DECIMALS) + margin * (1 + 1j)
        x, y = (np.floor(part).astype(np.intp) for part in (places.real, places.imag))
        # Squared horizontal and vertical distances of cells from a sample.
        beside, above = (
            np.maximum(np.abs((at - place)[:, None] + steps + 0.5) - 0.5, 0) ** 2
            for at, place in ((x, places.real), (y, places.imag))
        )
        sample, up, along = np.nonzero(above[:, :, None] + beside[:, None, :] <= near**2)
        taken[y[sample] + steps[up], x[sample] + steps[along]] = True
        # Rows whose middle is between two samples: inside and outside change to the right of them.
        below = np.floor(places.imag + 0.5).astype(np.intp)
        after = np.append(below[1:], below[:1])
        np.add.at(crossed, (np.minimum(below, after)[below != after], x[below != after]), 1)
    return taken | (np.cumsum(crossed, axis=1) % 2 == 1), margin * (1 + 1j)


def _samples(loop: Complex) -> Complex:
    """Points along a closed polygon including its corners, at most a step apart."""
    edges = np.append(loop[1:], loop[:1]) - loop
    counts = np.maximum(np.ceil(np.round(np.abs(edges) / STEP, DECIMALS)), 1).astype(np.intp)
    share = (np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)) / np.repeat(counts, counts)
    return np.repeat(loop, counts) + share * np.repeat(edges, counts)


def _smooth(number: int) -> int:
    """The next number with no prime factors except 2, 3 and 5; transforms of other lengths are several times slower."""
    left = number
    for factor in (2, 3, 5):
        while left % factor == 0:
            left //= factor
    return number if left == 1 else _smooth(number + 1)


class _SheetRaster:
    """The occupied cells of a sheet, and the extent of its parts, mm, which does not count if it is whole.

    Cells and spectra have single precision; counts are accurate to a hundredth.
    """

    def __init__(
        self, width: float, height: float, cell: int, margin: float, shape: tuple[int, int], is_whole: bool
    ) -> None:
        self.room, self.cell, self.margin = complex(width, height), cell, margin * (1 + 1j)
        self.cells = np.zeros(shape, dtype=np.float32)
        self.reach = self.room if is_whole else 0j
        self.taken: list[tuple[int, SheetPosition]] = []

    def take(self, part: int, orientations: Sequence[Orientation]) -> bool:
        """Place a part where width plus height grow least, nearest to the corner; False if there is no room."""
        spectrum = np.fft.rfft2(self.cells)
        least, best = OCCUPIED, None
        for orientation in orientations:
            # Possible ends of its box, for all cells in which its cells may begin.
            first = orientation.inset - self.margin + orientation.size
            x, y = (
                np.arange(start, most + 1e-9, self.cell)
                for start, most in ((first.real, self.room.real), (first.imag, self.room.imag))
            )
            if not (len(x) and len(y)):
                continue
            collisions = np.fft.irfft2(spectrum * orientation.spectrum, self.cells.shape)[: len(y), : len(x)]
            extent_sum = np.maximum(x, self.reach.real) + np.maximum(y, self.reach.imag)[:, None]
            keys = extent_sum * (self.room.real + self.room.imag + 1) + (x + y[:, None])
            keys = np.where(collisions < 0.5, keys.astype(np.int64), OCCUPIED)
            at = int(np.argmin(keys))
            if keys.flat[at] < least:
                row, column = divmod(at, len(x))
                least, best = keys.flat[at], (orientation, row, column, complex(x[column], y[row]))
        if best is None:
            return False
        orientation, row, column, end = best
        self.cells[row : row + len(orientation.cells), column : column + len(orientation.cells[0])] += orientation.cells
        self.reach = complex(max(self.reach.real, end.real), max(self.reach.imag, end.imag))
        self.taken.append((part, SheetPosition(orientation.turn, end - orientation.size - orientation.low, end)))
        return True


# Gap between parts, mm; with less, kerf and heat of one cut affect the next part.
GAP = 5.0
# Size of the first nesting sheet relative to that of rows. A larger one makes the raster coarser; a smaller one
# leaves no other shape to try.
SPARE = 1.1


@record(eq=False)
class Placed:
    """One copy of a part, rotated (unit complex), then shifted, complex mm, from its own frame to the sheet."""

    cut: Cut
    shift: complex
    turn: complex = 1 + 0j

    @property
    def loops(self) -> tuple[Loop, ...]:
        """All loops on the sheet in the order of the work.

        Holes come first, then marks, then the outline, since a part that is cut free drops or tilts.
        """
        outline, *holes = self.cut.loops
        pieces = (
            tabbed(outline, self.cut.tab, self.cut.digits) if self.cut.tab and outline.layer == "CUT" else [outline]
        )
        inner = [holes[k] for k in nearest_next([hole.points[0] for hole in holes], outline.box[0])]
        return tuple(loop.moved(self.shift, self.cut.digits, self.turn) for loop in (*inner, *self.cut.marks, *pieces))


@record(eq=False)
class Sheet:
    """All copies on a sheet from the origin to (width, height), mm, margins included."""

    placed: tuple[Placed, ...]
    width: float
    height: float

    @property
    def extents(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of all cuts, mm."""
        outlines = [copy.cut.loops[0].moved(copy.shift, copy.cut.digits, copy.turn) for copy in self.placed]
        return box_of(np.array([outline.box for outline in outlines]))

    @property
    def filled(self) -> float:
        """Share of the sheet that becomes parts."""
        return sum(copy.cut.area for copy in self.placed) / (self.width * self.height)


# Length of outline that one tab holds, mm, and the least number of tabs: a part on a single one turns.
HELD, LEAST_TABS = 150.0, 2
# Narrowest tab, mm: less than the decimals of drawings state, and it would hold nothing. Chosen here.
NARROWEST_TAB = 0.01


def check_tabs(cuts: Sequence[Cut], width: float, cut_width: float) -> None:
    """DesignError if tabs of a width, mm, each wider by that of the cut, would take more than half of an outline."""
    lengths = [(float(_along(cut.loops[0])[-1][-1]), cut.part.name) for cut in cuts if cut.loops[0].layer == "CUT"]
    fits = [(whole / (2 * _tabs_on(whole)) - cut_width, whole, name) for whole, name in lengths]
    widest, whole, name = min(fits, default=(inf, inf, ""))
    if width <= widest:
        return
    cut_too = f", and {mm(cut_width):g} more each for the cut," if cut_width else ""
    problem = (
        f"found {mm(width):g}, but {_tabs_on(whole)} tabs as wide{cut_too} take more than half of the outline of the "
        f"{name}, which is {mm(whole):.4g} long"
    )
    if widest < NARROWEST_TAB:
        raise DesignError("tab_width", problem, "give 0 for no tabs", "out-of-range", 0.0)
    remedy = f"give at most {mm(widest):down4}, or 0 for no tabs"
    raise DesignError("tab_width", problem, remedy, "out-of-range", float(rounded_down(widest, 4)))


def _tabs_on(whole: float) -> int:
    return max(LEAST_TABS, int(np.ceil(whole / HELD)))


def _along(loop: Loop) -> tuple[Polyline, Real, Real, Real]:
    """An outline as a polyline, with the turns of its edges, rad, their lengths, mm, and where they begin and end."""
    shape = loop.shape
    if isinstance(shape, Circle):
        corners = shape.centre + shape.radius * np.array([1, 1j, -1, -1j])
        shape = Polyline(corners, np.full(4, np.tan(np.pi / 8)))
    sweeps = 4 * np.arctan(np.zeros(len(shape.vertices)) if shape.bulges is None else np.asarray(shape.bulges))
    z = np.asarray(shape.vertices)
    lengths = np.abs(np.roll(z, -1) - z) / np.sinc(sweeps / (2 * np.pi))
    return shape, sweeps, lengths, np.append(0.0, np.cumsum(lengths))


def tabbed(loop: Loop, width: float, digits: int) -> list[Loop]:
    """The pieces of an outline in turn: those to cut, and on layer TAB those of tabs of a width, mm, that are left.

    Tabs are evenly spaced, each moved to the middle of the longest edge nearby.
    """
    shape, sweeps, lengths, ends = _along(loop)
    whole = float(ends[-1])
    count = _tabs_on(whole)
    middles = (ends[:-1] + ends[1:]) / 2
    spacing = whole / count
    tabs = []
    for wanted in middles[int(np.argmax(np.round(lengths, 6)))] + spacing * np.arange(count):
        away = (middles - wanted + whole / 2) % whole - whole / 2
        near = np.flatnonzero(np.abs(away) < spacing / 8)
        tabs.append(float(middles[near[np.argmax(np.round(lengths[near], 6))]] if len(near) else wanted) % whole)
    first = min(tabs) - width / 2
    starts = np.sort((np.array(tabs) - width / 2 - first) % whole) + first
    cuts = np.column_stack([starts, starts + width]).ravel()
    pieces = [
        _piece(shape, sweeps, ends, float(a), float(b), loop.layer if k % 2 else "TAB", digits)
        for k, (a, b) in enumerate(zip(cuts, np.append(cuts[1:], cuts[0] + whole)))
    ]
    # Each piece ends exactly where the next one begins, whatever the rounding.
    for piece, after in zip(pieces, [*pieces[1:], pieces[0]]):
        piece.points[-1] = after.points[0]
    return pieces


def _piece(shape: Polyline, sweeps: Real, ends: Real, start: float, end: float, layer: str, digits: int) -> Loop:
    """The piece of a closed shape between two positions along it, mm; `ends` are those of its vertices."""
    twice = np.append(ends[:-1], ends + ends[-1])
    margin = 10.0**-digits
    at = np.concatenate([[start], twice[(twice > start + margin) & (twice < end - margin)], [end]])
    edges = np.searchsorted(ends, (at[:-1] + at[1:]) / 2 % ends[-1], side="right") - 1
    shares = np.diff(at) / np.diff(ends)[edges]
    vertices = rounded(shape.point(np.interp(at % ends[-1], ends, np.arange(len(ends)))), digits)
    bulges = None if shape.bulges is None else np.round(np.tan(shares * sweeps[edges] / 4), 12)
    return Loop(Polyline(vertices, bulges, is_closed=False), vertices, layer)


def nearest_next(places: Sequence[complex], start: complex) -> list[int]:
    """An order of points, mm, in which each is the nearest to the one before, which shortens the travel."""
    left, order, here = np.array(places, dtype=complex), [], start
    for _ in places:
        # Rounded to the micrometre, so that last digits do not decide between equal distances.
        order.append(int(np.argmin(np.round(np.abs(left - here), 3))))
        here, left[order[-1]] = complex(left[order[-1]]), np.inf
    return order


def lay_out(cuts: Sequence[Cut]) -> Sheet:
    """All parts on one sheet that is sized to fit them, roughly square: nested if that is smaller than rows."""
    rows = _least_rows(cuts)
    if not 1 < len(rows.placed) <= MOST:
        return rows
    side = SPARE * max(rows.width, rows.height)
    return _if_smaller(cuts, nest(cuts, side, side, GAP), rows) or rows


def lay_out_on(cuts: Sequence[Cut], width: float, height: float, by_thickness: bool = True) -> tuple[Sheet, ...]:
    """The parts on as many sheets of a given size, mm, as they need, by default with one thickness per sheet.

    Raises DesignError for a part that does not fit, even after a quarter turn.
    """
    _check_parts_fit(cuts, width, height)
    room = width - 2 * GAP, height - 2 * GAP
    sheets: list[Sheet] = []
    groups: dict[float, list[Cut]] = {}
    for cut in sorted(cuts, key=lambda cut: cut.part.thickness) if by_thickness else cuts:
        groups.setdefault(cut.part.thickness if by_thickness else 0.0, []).append(cut)
    for some in groups.values():
        rows = _least_rows(some)
        if len(rows.placed) > MOST:
            turns = [1 + 0j if _fits(box(cut, 1 + 0j)[1], *room) else 1j for cut in some]
            sheets += [_sheet(some, row, width, height) for row in _in_rows(some, turns, *room)]
            continue
        # A corner of a large sheet is tried first, since the raster of the whole would be coarse.
        side = SPARE * max(rows.width, rows.height)
        across = min(room[0], side * side / min(room[1], side))
        nested = nest(some, across, min(room[1], side * side / across), GAP)
        if rows.width <= width and rows.height <= height and not _if_smaller(some, nested, rows):
            sheets.append(replace(rows, width=width, height=height))
            continue
        nested = nested if len(nested) == 1 else _fewest_sheets(some, *room)
        sheets += [_sheet(some, sheet, width, height) for sheet in nested]
    return tuple(sheets)


def _fewest_sheets(cuts: Sequence[Cut], width: float, height: float) -> list[list[tuple[int, SheetPosition]]]:
    """The parts nested on whole sheets, by a finer raster if that saves one."""
    nested = nest(cuts, width, height, GAP)
    if sum(cut.part.count * cut.area for cut in cuts) > (len(nested) - 1) * width * height:
        return nested
    return min(nested, nest(cuts, width, height, GAP, fine=True), key=len)


def _if_smaller(
    cuts: Sequence[Cut], nested: Sequence[Sequence[tuple[int, SheetPosition]]], rows: Sheet
) -> Sheet | None:
    """The sheet of nested parts, if there is only one and it is smaller than that of the rows."""
    sheet = _sheet(cuts, nested[0])
    return sheet if len(nested) == 1 and sheet.width * sheet.height < rows.width * rows.height else None


def _fits(size: complex, width: float, height: float) -> bool:
    return size.real <= width and size.imag <= height


def _check_parts_fit(cuts: Sequence[Cut], width: float, height: float) -> None:
    sizes = [box(cut, 1 + 0j)[1] for cut in cuts]
    for cut, size in zip(cuts, sizes):
        if not any(
            _fits(size, *room) for room in ((width - 2 * GAP, height - 2 * GAP), (height - 2 * GAP, width - 2 * GAP))
        ):
            long = max(max(size.real, size.imag) for size in sizes) + 2 * GAP
            short = max(min(size.real, size.imag) for size in sizes) + 2 * GAP
            low, high = cut.box
            raise DesignError(
                "sheet",
                f"found {mm(width, height, between=' x '):g}, and the {cut.part.name} is "
                f"{mm(high.real - low.real, high.imag - low.imag, between=' x '):.5g}",
                f"give at least [{bare_mm(long, short):g}], which leaves {mm(GAP):g} to each edge",
                "out-of-range",
            )


def _least_rows(cuts: Sequence[Cut]) -> Sheet:
    """All parts in rows on a roughly square sheet."""
    counted = [(cut.part.count, box(cut, 1 + 0j)[1]) for cut in cuts]
    room = sum(count * (size.real + GAP) * (size.imag + GAP) for count, size in counted)
    across = max(max(size.real for _, size in counted), float(np.sqrt(room)) * 1.2 - 2 * GAP)
    (rows,) = _in_rows(cuts, [1 + 0j for _ in cuts], across, np.inf)
    return _sheet(cuts, rows)


def _in_rows(
    cuts: Sequence[Cut], turns: Sequence[complex], across: float, up: float
) -> list[list[tuple[int, SheetPosition]]]:
    """Rows of parts, highest first, on sheets of the given size, mm, as lists of a part's index and its position."""
    boxes = [box(cut, turn) for cut, turn in zip(cuts, turns)]
    copies = [k for k, cut in enumerate(cuts) for _ in range(cut.part.count)]
    filled: list[list[tuple[int, SheetPosition]]] = [[]]
    x = y = row = 0.0
    for k in sorted(copies, key=lambda k: (-boxes[k][1].imag, k)):
        low, size = boxes[k]
        if x and x + size.real > across:
            x, y, row = 0.0, y + row + GAP, 0.0
        if filled[-1] and y + size.imag > up:
            filled.append([])
            x = y = row = 0.0
        filled[-1].append((k, SheetPosition(turns[k], complex(x, y) - low, complex(x, y) + size)))
        x, row = x + size.real + GAP, max(row, size.imag)
    return filled


def _sheet(
    cuts: Sequence[Cut], places: Sequence[tuple[int, SheetPosition]], width: float = 0.0, height: float = 0.0
) -> Sheet:
    """The parts within margins, in the order of the work, on a sheet of the given size, mm, or sized to fit if 0."""
    margin = GAP * (1 + 1j)
    placed = [Placed(cuts[k], place.shift + margin, place.turn) for k, place in sorted(places, key=lambda one: one[0])]
    return Sheet(
        tuple(_in_order(placed)),
        width or max(place.corner.real for _, place in places) + 2 * GAP,
        height or max(place.corner.imag for _, place in places) + 2 * GAP,
    )


def _in_order(placed: Sequence[Placed]) -> list[Placed]:
    """The nearest part next, but parts in another part's hole first, since that piece drops out as a whole."""
    starts = np.array([copy.turn * copy.cut.loops[0].points[0] + copy.shift for copy in placed])
    depths = np.zeros(len(placed), dtype=int)
    for copy in placed if len(placed) <= MOST else ():
        for hole in copy.cut.loops[1:]:
            hole_outline = hole.points * copy.turn + copy.shift
            in_box = (hole_outline.real.min() < starts.real) & (starts.real < hole_outline.real.max())
            in_box &= (hole_outline.imag.min() < starts.imag) & (starts.imag < hole_outline.imag.max())
            for k in np.flatnonzero(in_box):
                depths[k] += is_inside(hole_outline, complex(starts[k]))
    order: list[int] = []
    for depth in sorted(set(depths.tolist()), reverse=True):
        at_depth = np.flatnonzero(depths == depth)
        here = complex(starts[order[-1]]) if order else 0j
        order += [int(at_depth[k]) for k in nearest_next(starts[at_depth].tolist(), here)]
    return [placed[k] for k in order]
