"""The dimensioned drawing of all parts, for reading and measuring, not for cutting."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from ..core.errors import harmless
from ..core.records import record
from ..core.units import MM, LengthUnit
from ..model.limits import FitLimits
from ..model.part import HoleFit, Part
from ..plane.primitives import Circle, Polyline
from ..plane.vec import box_of
from .cut import Cut, shape_box
from .job import Job
from .text import Text, width_of

# Layers of outlines and holes, of dimension lines, and of texts, each with colour index and RGB.
PART, DIM, WORDS = "PART", "DIM", "TEXT"
COLOURS = {PART: (7, (0, 0, 0)), DIM: (5, (0, 114, 178)), WORDS: (7, (60, 60, 60))}
# Heights on paper, mm, of letters, of the title, and from line to line, legible on a workbench.
LETTER, TITLE, LINE = 3.0, 5.0, 5.0
# Distance of a dimension line from the part, length of extension lines beyond it, and half a tick, mm on paper.
AWAY, BEYOND, TICK = 8.0, 1.2, 1.2
# Margin between parts and around the drawing, mm.
CLEAR = 12.0
# Size on paper, mm, above which the largest part is reduced and below which it is enlarged, and the standard scales.
LARGEST, SMALLEST = 250.0, 60.0
STEPS = (5.0, 2.0, 1.0)
# Largest number of holes whose distances are listed. More form a pattern, for which the cutting drawing is clearer.
MOST_HOLES = 12
# Directions and lengths nearer to each other than this, mm, are the same.
SAME = 1e-6

Shape = tuple[str, Circle | Polyline]
# Prefix of the number of a hole without a letter.
NUMBERED = "hole "


@record(eq=False)
class DimensionedDrawing:
    """Shapes with their layers and texts, mm on paper, from the origin to (width, height)."""

    shapes: tuple[Shape, ...]
    texts: tuple[Text, ...]
    width: float
    height: float


@record(eq=False)
class _Hole:
    """A hole with its letter or number, its size in words, and its centre if it is round."""

    name: str
    size: str
    centre: complex | None


@record(eq=False)
class _Cell:
    """A part with its dimensions about its origin, on paper, and the box around them."""

    shapes: list[Shape]
    texts: list[Text]
    unit: LengthUnit = MM

    @property
    def box(self) -> tuple[complex, complex]:
        return box_of(np.array([*(shape_box(shape) for _, shape in self.shapes), *(text.box for text in self.texts)]))

    def moved(self, shift: complex) -> _Cell:
        return _Cell(
            [(layer, _scaled(shape, 1.0, shift)) for layer, shape in self.shapes],
            [replace(text, place=text.place + shift) for text in self.texts],
            self.unit,
        )

    def line(self, *places: complex) -> None:
        self.shapes.append((DIM, Polyline(np.array(places), is_closed=False)))

    def words(self, words: str, left: complex, height: float = LETTER) -> None:
        """A text by its left end at half of its height."""
        self.texts.append(Text(WORDS, words, left, height, starts=True))

    def size(self, start: complex, end: complex, away: complex, length: float) -> None:
        """A dimension between two points, its line shifted by `away` to a side, with the number outside of it."""
        side = away / abs(away)
        # Distance of the dimension line, from the farther of both points.
        far = max((np.conj(side) * place).real for place in (start, end)) + abs(away)
        ends = [place + side * (far - (np.conj(side) * place).real) for place in (start, end)]
        for place, at in zip((start, end), ends):
            self.line(place + side, at + BEYOND * side)
            self.line(at - TICK * (1 + 1j), at + TICK * (1 + 1j))
        self.line(*ends)
        words = length_text(length, self.unit)
        half = complex(width_of(words, LETTER), LETTER) / 2
        middle = (ends[0] + ends[1]) / 2
        self.texts.append(
            Text(DIM, words, middle + complex(side.real * (half.real + 1.5), side.imag * (half.imag + 1.5)), LETTER)
        )


def length_text(length: float, unit: LengthUnit = MM) -> str:
    """A length, mm, in a unit with five digits and without its name, as usual in drawings."""
    return f"{unit.of(length):.5g}"


def drawing_scale(cuts: Sequence[Cut]) -> float:
    """The largest standard scale with which all parts fit on paper."""
    corners = np.array([cut.box for cut in cuts])
    across = corners[:, 1] - corners[:, 0]
    size = float(max(across.real.max(), across.imag.max()))
    most = LARGEST / size if size > LARGEST else max(1.0, SMALLEST / size)
    power = 10.0 ** np.floor(np.log10(most * (1 + SAME)))
    return float(next(step * power for step in STEPS if step * power <= most * (1 + SAME)))


def scale_text(scale: float) -> str:
    """A scale as 1:2 or 5:1."""
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"


def dimensioned_drawing(job: Job) -> DimensionedDrawing:
    """All parts with dimensions and notes, and the title block below."""
    scale = drawing_scale(job.exact)
    # Outlines are drawn as chords, which are equal on every processor; sizes are those of the exact shapes.
    exact = [high - low for low, high in (cut.box for cut in job.exact)]
    cells = [_cell(cut, size, scale, _measures(job, cut.part), job.unit) for cut, size in zip(job.solids, exact)]
    boxes = [cell.box for cell in cells]
    sizes = [high - low for low, high in boxes]
    across = max(*(size.real for size in sizes), 1.3 * float(np.sqrt(sum(size.real * size.imag for size in sizes))))
    shapes: list[Shape] = []
    texts: list[Text] = []
    # Rows from top to bottom, the highest parts first; the first row is below y = 0.
    x, y, row_height, right = CLEAR, 0.0, 0.0, 0.0
    for k in sorted(range(len(cells)), key=lambda k: (-round(sizes[k].imag, 3), k)):
        cell, (low, _), size = cells[k], boxes[k], sizes[k]
        if x > CLEAR and x + size.real > across + CLEAR:
            x, y, row_height = CLEAR, y - row_height - CLEAR, 0.0
        placed = cell.moved(complex(x, y - size.imag) - low)
        shapes += placed.shapes
        texts += placed.texts
        x, row_height, right = x + size.real + CLEAR, max(row_height, size.imag), max(right, x + size.real)
    title = _title(job, scale, right - CLEAR).moved(complex(CLEAR, y - row_height - CLEAR))
    page = _Cell([*shapes, *title.shapes], [*texts, *title.texts])
    low, high = page.box
    margin = CLEAR * (1 + 1j)
    page = page.moved(margin - low)
    end = high - low + 2 * margin
    return DimensionedDrawing(tuple(page.shapes), tuple(page.texts), float(np.ceil(end.real)), float(np.ceil(end.imag)))


def _title(job: Job, scale: float, width: float) -> _Cell:
    """The title block in a frame whose upper left corner is 0."""
    parts, unit = job.source.parts, job.unit
    thicknesses = ", ".join(length_text(thickness, unit) for thickness in sorted({part.thickness for part in parts}))
    cell = _Cell([], [])
    pieces = sum(part.count for part in parts)
    lines = [
        f"sheet of {thicknesses} {unit.name}, scale {scale_text(scale)}",
        f"sizes in {unit.plural}; parts: {len(parts)}, pieces: {pieces}",
        "each part seen from above; drawing 1 of 1",
        *job.title.lines(),
    ]
    name = harmless(job.title.name or job.name)
    cell.words(name, complex(3, -3 - TITLE / 2), TITLE)
    # One column for facts of the drawing, one for entries of the recipe.
    columns = [lines[:3], lines[3:]]
    left, rows, top = 3.0, max(map(len, columns)), -7 - TITLE
    for column in filter(None, columns):
        if left > 3:
            cell.line(complex(left - 3, top + 1), complex(left - 3, top - rows * LINE))
        for number, line in enumerate(column):
            cell.words(line, complex(left, top - LETTER / 2 - number * LINE))
        left += 6 + max(width_of(line, LETTER) for line in column)
    width = max(width, 6 + width_of(name, TITLE), left - 3)
    bottom = top - rows * LINE
    cell.shapes.append((DIM, Polyline(np.array([0, width, complex(width, bottom), complex(0, bottom)]))))
    if columns[1]:
        cell.line(complex(0, top + 1), complex(width, top + 1))
    return cell


def _cell(cut: Cut, size: complex, scale: float, measures: Sequence[str], unit: LengthUnit) -> _Cell:
    """A part with its dimensions, mm: width below, height to the right, distances of holes above, notes in words."""
    part, loops = cut.part, (*cut.loops, *cut.marks)
    cell = _Cell([(PART, _scaled(loop.shape, scale, 0j)) for loop in loops if loop.layer != "LABEL"], [], unit)
    low, high = (corner * scale for corner in cut.box)
    cell.size(complex(low.real, low.imag), complex(high.real, low.imag), -1j * AWAY, size.real)
    cell.size(complex(high.real, low.imag), high, AWAY + 0j, size.imag)
    holes = _holes(cut, unit)
    pieces = "1 piece" if part.count == 1 else f"{part.count} pieces"
    title = f"{harmless(part.name)}: {pieces}, {length_text(part.thickness, unit)} {unit.name} thick"
    lines = [title, *_callouts(holes), *_distances(cell, holes, scale, high.imag), *measures]
    for number, line in enumerate(lines):
        cell.words(line, complex(low.real, low.imag - AWAY - 3 * LETTER - number * LINE))
    return cell


def _distances(cell: _Cell, holes: Sequence[_Hole], scale: float, top: float) -> list[str]:
    """Add dimensions between holes of a row above a part, whose upper edge is at `top`, mm on paper.

    The distances for which there is no room are returned as lines of text.
    """
    lines: list[str] = []
    spans: list[tuple[float, float]] = []
    for (name_1, start), (name_2, end) in _pairs([(h.name, h.centre) for h in holes if h.centre is not None]):
        distance = abs(end - start)
        left, right = sorted((start * scale, end * scale), key=lambda place: place.real)
        # Extension lines of a dimension that starts inside another would cross its number.
        is_clear = all(not (a + SAME < x < b - SAME) for a, b in spans for x in (left.real, right.real))
        is_level = (
            abs((end - start).imag) < SAME and width_of(length_text(distance, cell.unit), LETTER) < scale * distance
        )
        if is_level and is_clear and len(spans) < 3:
            cell.size(left, right, complex(0, top - left.imag + AWAY + len(spans) * (LINE + 1)), distance)
            spans.append((left.real, right.real))
        else:
            lines.append(f"{name_1} to {name_2}: {length_text(distance, cell.unit)}")
    return lines


def _holes(cut: Cut, unit: LengthUnit) -> list[_Hole]:
    """The holes to describe: those with a fit and all round ones, numbered if they have no letter."""
    part, loops = cut.part, cut.loops[1:]
    names, fits = [*part.hole_names, *[""] * len(loops)], [*part.fits, *[None] * len(loops)]
    holes = []
    for k, (loop, name, fit) in enumerate(zip(loops, names, fits), 1):
        circle = loop.shape if isinstance(loop.shape, Circle) else None
        if circle or fit:
            size = _size_of(fit, 2 * circle.radius if circle else None, unit)
            holes.append(_Hole(harmless(name) or f"{NUMBERED}{k}", size, complex(circle.centre) if circle else None))
    return holes


# Forms of holes by their number of flats.
FORMS = {1: "D dia", 2: "double D dia", 4: "square over corners", 6: "hexagonal over corners"}


def _size_of(fit: HoleFit | None, diameter: float | None, unit: LengthUnit) -> str:
    """Width and purpose of a hole; `diameter` is that of a round one as drawn, mm."""
    if fit is None:
        return f"dia {length_text(diameter or 0.0, unit)}"
    width = length_text(fit.diameter + fit.play if diameter is None else diameter, unit)
    sizes = [f"dia {width}"]
    if fit.travel:
        sizes = [f"slot {width} wide", f"{length_text(fit.travel + fit.diameter + fit.play, unit)} long"]
    if fit.flat:
        across = "across flat" if fit.flats == 1 else "between flats"
        sizes = [f"{FORMS[fit.flats]} {width}", f"{across} {length_text(fit.flat, unit)}"]
    if any(fit.keyway):
        sizes.append("keyway {} wide {} deep".format(*(length_text(size, unit) for size in fit.keyway)))
    if (limits := fit.limits) is not None:
        hole, _, shaft = fit.iso_fit.partition("/")
        sizes[0] = sizes[0].replace(width, f"{length_text(fit.diameter, unit)} {hole} {_deviations(limits.hole, unit)}")
        kinds = (f"shaft {shaft} {_deviations(limits.shaft, unit)}", _clearances(limits, unit)) if shaft else ()
        return ", ".join([*sizes, *kinds])
    if not fit.play:
        return ", ".join(sizes)
    kind = "press" if fit.is_press or fit.play < 0 else "clearance"
    return f"{', '.join(sizes)} ({length_text(fit.diameter, unit)}, {kind} {unit.of(fit.play):+.5g})"


def _deviations(deviations: tuple[float, float], unit: LengthUnit) -> str:
    """Upper and lower deviation of a size, mm, in a unit, as usual in drawings."""
    low, high = (f"{unit.of(value):+.4f}" if unit is MM else f"{unit.of(value):+.5f}" for value in deviations)
    return "({}/{})".format(*("0" if float(text) == 0 else text.rstrip("0") for text in (high, low)))


def _clearances(limits: FitLimits, unit: LengthUnit) -> str:
    """The least and the largest clearance of a fit in words; negative ones are interferences."""
    least, largest = (f"{unit.of(value):+.4g}" for value in (limits.least_clearance, limits.largest_clearance))
    return f"clearance {least} to {largest}"


def _callouts(holes: Sequence[_Hole]) -> Iterator[str]:
    """A line for each size of holes with their number and names."""
    by_size: dict[str, list[str]] = {}
    for hole in holes:
        by_size.setdefault(hole.size, []).append(hole.name)
    for size, names in by_size.items():
        yield f"{len(names)} x {size}" + (f" at {', '.join(names)}" if 1 < len(holes) <= MOST_HOLES else "")


def _pairs(holes: Sequence[tuple[str, complex]]) -> Iterator[tuple[tuple[str, complex], tuple[str, complex]]]:
    """Pairs of holes whose distances are dimensioned: all of up to three, else successive ones, letters first."""
    pairs = list(combinations(holes, 2))
    if len(holes) > 3:
        # Holes with letters are joints, whose distances matter most; screws come last.
        pairs = list(pairwise(sorted(holes, key=lambda hole: hole[0].startswith(NUMBERED))))
    if len(holes) <= MOST_HOLES:
        # The longest last and outermost; otherwise extension lines would cross its number.
        yield from sorted(pairs, key=lambda pair: round(abs(pair[1][1] - pair[0][1]), 6))


def _measures(job: Job, part: Part) -> Sequence[str]:
    """Data for making and measuring a gear, one line each; empty for other parts."""
    measures, helix = _notes_of(job, part, f"measures_{job.unit.name}"), _notes_of(job, part, "helix")
    if "teeth" not in measures:
        return ()
    lines = [
        f"teeth {measures['teeth']}, module {length_text(measures['module'])}, "
        f"pressure angle {length_text(measures['pressure_angle_deg'])} deg",
        f"profile shift {length_text(measures['profile_shift'])}",
        *(f"{circle} dia {length_text(2 * measures[f'{circle}_radius'])}" for circle in ("tip", "pitch", "root")),
    ]
    if helix:
        herringbone = ", herringbone" if helix["herringbone"] else ""
        lines.insert(1, f"helix angle {length_text(helix['helix_angle_deg'])} deg, {helix['hand']} hand{herringbone}")
    if span := measures.get("span"):
        lines.append(f"span over {span['teeth']} teeth {length_text(span['measure'])}")
    for key, words in (("over_pins", "over"), ("between_pins", "between")):
        if pins := measures.get(key):
            lines.append(f"{words} pins of dia {length_text(pins['pin_diameter'])}: {length_text(pins['measure'])}")
    return lines


def _notes_of(job: Job, part: Part, key: str) -> Mapping[str, Any]:
    """Notes on a part, by its name, or for the first part if the notes have a single entry."""
    notes = job.source.notes.get(key)
    if not isinstance(notes, Mapping):
        return {}
    entry = notes.get(part.name, notes if part is job.source.parts[0] else None)
    return entry if isinstance(entry, Mapping) else {}


def _scaled(shape: Circle | Polyline, scale: float, shift: complex) -> Circle | Polyline:
    if isinstance(shape, Circle):
        return Circle(shape.centre * scale + shift, shape.radius * scale)
    return Polyline(np.asarray(shape.vertices) * scale + shift, shape.bulges, shape.closed)
