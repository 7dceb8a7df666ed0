"""The drawing of all parts with their sizes, to read and to measure by: nothing in it is to be cut."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from ..core.errors import harmless
from ..core.records import record
from ..model.part import HoleFit, Part
from ..plane.primitives import Circle, Polyline
from .cut import Cut, Loop
from .job import Job
from .text import Text, width_of

# Layers: outlines and holes, lines of sizes, and all words. Each with colour index and RGB.
PART, DIM, WORDS = "PART", "DIM", "TEXT"
COLOURS = {PART: (7, (0, 0, 0)), DIM: (5, (0, 114, 178)), WORDS: (7, (60, 60, 60))}
# Height of letters on paper, mm, of the title, and from line to line: what is read from a sheet on a bench.
LETTER, TITLE, LINE = 3.0, 5.0, 5.0
# From a part to the line of a size, how far its end lines pass it, and half its ticks, mm on paper.
AWAY, BEYOND, TICK = 8.0, 1.2, 1.2
# Clear paper between parts and round the drawing, mm.
CLEAR = 12.0
# Width or height on paper, mm, above which the largest part is drawn smaller and below which larger than it is; and
# the round scales, paper to part.
LARGEST, SMALLEST = 250.0, 60.0
STEPS = (5.0, 2.0, 1.0)
# Holes whose places are told one by one: more are a pattern, which a drawing to cut from tells better.
MOST_HOLES = 12
# Directions and lengths nearer to each other than this, mm, are the same.
SAME = 1e-6

Shape = tuple[str, Circle | Polyline]
# What a hole without a letter is called, before its number.
NUMBERED = "hole "


@record(eq=False)
class Drawing:
    """Shapes with their layers and texts, mm on paper, from the origin to (width, height)."""

    shapes: tuple[Shape, ...]
    texts: tuple[Text, ...]
    width: float
    height: float


@record(eq=False)
class _Hole:
    """A hole by its letter or number, its size in words, and its middle where it is round."""

    name: str
    size: str
    centre: complex | None


@record(eq=False)
class _Cell:
    """A part with its sizes about its own origin, on paper, and the box that they take."""

    shapes: list[Shape]
    texts: list[Text]

    @property
    def box(self) -> tuple[complex, complex]:
        corners = [Loop(shape, np.zeros(0, complex), "").box for _, shape in self.shapes]
        low, high = np.array([*corners, *(text.box for text in self.texts)]).T
        return complex(low.real.min(), low.imag.min()), complex(high.real.max(), high.imag.max())

    def moved(self, shift: complex) -> _Cell:
        return _Cell(
            [(layer, _scaled(shape, 1.0, shift)) for layer, shape in self.shapes],
            [replace(text, place=text.place + shift) for text in self.texts],
        )

    def line(self, *places: complex) -> None:
        self.shapes.append((DIM, Polyline(np.array(places), is_closed=False)))

    def words(self, words: str, left: complex, height: float = LETTER) -> None:
        """A text from its left end, at half its height."""
        self.texts.append(Text(WORDS, words, left, height, starts=True))

    def size(self, start: complex, end: complex, away: complex, length: float) -> None:
        """A length between two places of the part, its line shifted by `away` to a side, with its number beyond."""
        side = away / abs(away)
        # To the line from either place, whichever is farther off.
        far = max((np.conj(side) * place).real for place in (start, end)) + abs(away)
        ends = [place + side * (far - (np.conj(side) * place).real) for place in (start, end)]
        for place, at in zip((start, end), ends):
            self.line(place + side, at + BEYOND * side)
            self.line(at - TICK * (1 + 1j), at + TICK * (1 + 1j))
        self.line(*ends)
        words = told(length)
        half = complex(width_of(words, LETTER), LETTER) / 2
        middle = (ends[0] + ends[1]) / 2
        self.texts.append(
            Text(DIM, words, middle + complex(side.real * (half.real + 1.5), side.imag * (half.imag + 1.5)), LETTER)
        )


def told(length: float) -> str:
    """A length as drawings have it: to five digits, without the unit that all share."""
    return f"{length:.5g}"


def scale_of(cuts: Sequence[Cut]) -> float:
    """The round scale of all parts: the largest on paper that is not larger than there is room for."""
    corners = np.array([cut.box for cut in cuts])
    across = corners[:, 1] - corners[:, 0]
    size = float(max(across.real.max(), across.imag.max()))
    most = LARGEST / size if size > LARGEST else max(1.0, SMALLEST / size)
    power = 10.0 ** np.floor(np.log10(most * (1 + SAME)))
    return float(next(step * power for step in STEPS if step * power <= most * (1 + SAME)))


def scale_told(scale: float) -> str:
    """A scale as 1:2 or 5:1."""
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"


def drawing(job: Job) -> Drawing:
    """All parts, each with its sizes and what else is known of it, and the title below."""
    scale = scale_of(job.exact)
    # Chords to look at, which are the same on every processor, and the sizes of what they stand for.
    exact = [high - low for low, high in (cut.box for cut in job.exact)]
    cells = [_cell(cut, size, scale, _measures(job, cut.part)) for cut, size in zip(job.solids, exact)]
    boxes = [cell.box for cell in cells]
    sizes = [high - low for low, high in boxes]
    across = max(*(size.real for size in sizes), 1.3 * float(np.sqrt(sum(size.real * size.imag for size in sizes))))
    shapes: list[Shape] = []
    texts: list[Text] = []
    # Rows from the top down, the highest parts first; the first row below y = 0.
    x, y, row, right = CLEAR, 0.0, 0.0, 0.0
    for k in sorted(range(len(cells)), key=lambda k: (-round(sizes[k].imag, 3), k)):
        cell, (low, _), size = cells[k], boxes[k], sizes[k]
        if x > CLEAR and x + size.real > across + CLEAR:
            x, y, row = CLEAR, y - row - CLEAR, 0.0
        placed = cell.moved(complex(x, y - size.imag) - low)
        shapes += placed.shapes
        texts += placed.texts
        x, row, right = x + size.real + CLEAR, max(row, size.imag), max(right, x + size.real)
    title = _title(job, scale, right - CLEAR).moved(complex(CLEAR, y - row - CLEAR))
    whole = _Cell([*shapes, *title.shapes], [*texts, *title.texts])
    low, high = whole.box
    margin = CLEAR * (1 + 1j)
    whole = whole.moved(margin - low)
    end = high - low + 2 * margin
    return Drawing(tuple(whole.shapes), tuple(whole.texts), float(np.ceil(end.real)), float(np.ceil(end.imag)))


def _title(job: Job, scale: float, wide: float) -> _Cell:
    """The recipe's name and what holds for all, in a frame, its upper left corner at 0."""
    parts = job.source.parts
    thicknesses = ", ".join(told(one) for one in sorted({part.thickness for part in parts}))
    cell = _Cell([], [])
    pieces = sum(part.count for part in parts)
    lines = [
        f"sheet of {thicknesses} mm, scale {scale_told(scale)}",
        f"sizes in mm; parts: {len(parts)}, pieces: {pieces}",
        "each part seen from above; drawing 1 of 1",
        *job.title.told(),
    ]
    name = harmless(job.title.name or job.name)
    cell.words(name, complex(3, -3 - TITLE / 2), TITLE)
    # A column for what the drawing tells, and one for what the recipe gives; each line under the one before.
    columns = [lines[:3], lines[3:]]
    left, rows, top = 3.0, max(map(len, columns)), -7 - TITLE
    for column in filter(None, columns):
        if left > 3:
            cell.line(complex(left - 3, top + 1), complex(left - 3, top - rows * LINE))
        for number, line in enumerate(column):
            cell.words(line, complex(left, top - LETTER / 2 - number * LINE))
        left += 6 + max(width_of(line, LETTER) for line in column)
    wide = max(wide, 6 + width_of(name, TITLE), left - 3)
    high = top - rows * LINE
    cell.shapes.append((DIM, Polyline(np.array([0, wide, complex(wide, high), complex(0, high)]))))
    if columns[1]:
        cell.line(complex(0, top + 1), complex(wide, top + 1))
    return cell


def _cell(cut: Cut, size: complex, scale: float, measures: Sequence[str]) -> _Cell:
    """A part with its size, mm: width below it, height to the right, distances of holes above, the rest in words."""
    cell, part = (
        _Cell(
            [(PART, _scaled(loop.shape, scale, 0j)) for loop in (*cut.loops, *cut.marks) if loop.layer != "LABEL"], []
        ),
        cut.part,
    )
    low, high = (corner * scale for corner in cut.box)
    cell.size(complex(low.real, low.imag), complex(high.real, low.imag), -1j * AWAY, size.real)
    cell.size(complex(high.real, low.imag), high, AWAY + 0j, size.imag)
    holes = _holes(cut)
    pieces = "1 piece" if part.count == 1 else f"{part.count} pieces"
    lines = [f"{harmless(part.name)}: {pieces}, {told(part.thickness)} mm thick"]
    lines += _callouts(holes)
    spans: list[tuple[float, float]] = []
    for (one, start), (other, end) in _pairs([(hole.name, hole.centre) for hole in holes if hole.centre is not None]):
        apart = end - start
        left, right = sorted((start * scale, end * scale), key=lambda place: place.real)
        # The end lines of one that begins within another would cross its number.
        nested = all(not (a + SAME < x < b - SAME) for a, b in spans for x in (left.real, right.real))
        in_row = abs(apart.imag) < SAME and width_of(told(abs(apart)), LETTER) < scale * abs(apart)
        if in_row and nested and len(spans) < 3:
            top = complex(0, high.imag - left.imag + AWAY + len(spans) * (LINE + 1))
            cell.size(left, right, top, abs(apart))
            spans.append((left.real, right.real))
        else:
            lines.append(f"{one} to {other}: {told(abs(apart))}")
    for number, line in enumerate((*lines, *measures)):
        cell.words(line, complex(low.real, low.imag - AWAY - 3 * LETTER - number * LINE))
    return cell


def _holes(cut: Cut) -> list[_Hole]:
    """The holes that are told: those that something goes through, and all round ones; numbered where no letter is."""
    part, loops = cut.part, cut.loops[1:]
    names, fits = [*part.hole_names, *[""] * len(loops)], [*part.fits, *[None] * len(loops)]
    holes = []
    for k, (loop, name, fit) in enumerate(zip(loops, names, fits), 1):
        circle = loop.shape if isinstance(loop.shape, Circle) else None
        if circle or fit:
            size = _size_of(fit, 2 * circle.radius if circle else None)
            holes.append(_Hole(harmless(name) or f"{NUMBERED}{k}", size, complex(circle.centre) if circle else None))
    return holes


def _size_of(fit: HoleFit | None, diameter: float | None) -> str:
    """How wide a hole is, and what for. diameter: of a round one, mm, as it is drawn."""
    if fit is None:
        return f"dia {told(diameter or 0.0)}"
    wide = told(fit.diameter + fit.play if diameter is None else diameter)
    sizes = [f"dia {wide}"]
    if fit.travel:
        sizes = [f"slot {wide} wide", f"{told(fit.travel + fit.diameter + fit.play)} long"]
    if fit.flat:
        sizes = [f"D dia {wide}", f"across flat {told(fit.flat)}"]
    if any(fit.keyway):
        sizes.append("keyway {} wide {} deep".format(*map(told, fit.keyway)))
    if not fit.play:
        return ", ".join(sizes)
    return f"{', '.join(sizes)} ({told(fit.diameter)}, {'press' if fit.play < 0 else 'clearance'} {fit.play:+.5g})"


def _callouts(holes: Sequence[_Hole]) -> Iterator[str]:
    """A line for each size of holes: how many, and which."""
    by_size: dict[str, list[str]] = {}
    for hole in holes:
        by_size.setdefault(hole.size, []).append(hole.name)
    for size, names in by_size.items():
        yield f"{len(names)} x {size}" + (f" at {', '.join(names)}" if 1 < len(holes) <= MOST_HOLES else "")


def _pairs(holes: Sequence[tuple[str, complex]]) -> Iterator[tuple[tuple[str, complex], tuple[str, complex]]]:
    """Pairs of holes whose distances are told: all of three, the next of more, those with letters first."""
    pairs = list(combinations(holes, 2))
    if len(holes) > 3:
        # What turns is at the letters: screws between two of them would hide the distance that must be right.
        pairs = list(pairwise(sorted(holes, key=lambda hole: hole[0].startswith(NUMBERED))))
    if len(holes) <= MOST_HOLES:
        # The longest last, and so outermost: farther in, the end lines of the others would cross its number.
        yield from sorted(pairs, key=lambda pair: round(abs(pair[1][1] - pair[0][1]), 6))


def _measures(job: Job, part: Part) -> Sequence[str]:
    """What a workshop has to know of a gear, a line each; nothing of other parts."""
    own, helix = _noted(job, part, "measures_mm"), _noted(job, part, "helix")
    if "teeth" not in own:
        return ()
    lines = [
        f"teeth {own['teeth']}, module {told(own['module'])}, pressure angle {told(own['pressure_angle_deg'])} deg",
        f"profile shift {told(own['profile_shift'])}",
        *(f"{circle} dia {told(2 * own[f'{circle}_radius'])}" for circle in ("tip", "pitch", "root")),
    ]
    if helix:
        herringbone = ", herringbone" if helix["herringbone"] else ""
        lines.insert(1, f"helix angle {told(helix['helix_angle_deg'])} deg, {helix['hand']} hand{herringbone}")
    if span := own.get("span"):
        lines.append(f"span over {span['teeth']} teeth {told(span['measure'])}")
    for key, words in (("over_pins", "over"), ("between_pins", "between")):
        if pins := own.get(key):
            lines.append(f"{words} pins of dia {told(pins['pin_diameter'])}: {told(pins['measure'])}")
    return lines


def _noted(job: Job, part: Part, what: str) -> Mapping[str, Any]:
    """What the notes tell of a part: under its name, or of the first of all where it is the only one they tell of."""
    held = job.source.notes.get(what)
    if not isinstance(held, Mapping):
        return {}
    own = held.get(part.name, held if part is job.source.parts[0] else None)
    return own if isinstance(own, Mapping) else {}


def _scaled(shape: Circle | Polyline, scale: float, shift: complex) -> Circle | Polyline:
    if isinstance(shape, Circle):
        return Circle(shape.centre * scale + shift, shape.radius * scale)
    return Polyline(np.asarray(shape.vertices) * scale + shift, shape.bulges, shape.closed)
