"""The dimensioned drawing of all parts, for making and measuring them, not for cutting."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..core.errors import harmless
from ..core.records import record
from ..core.units import LengthUnit
from ..model.part import HoleFit
from ..plane.curve import AbstractCurve, Mirrored, Moved, Reversed
from ..plane.joined import Path, PolarArray
from ..plane.primitives import Arc, Circle, Polyline, Segment
from ..plane.vec import Complex
from .cut import Cut, Loop
from .dimensions import (
    CENTRE,
    DIM,
    LETTER,
    LINE,
    MARK,
    PART,
    WORDS,
    Dimension,
    DimensionKind,
    DrawingCanvas,
    Shape,
    length_text,
    scaled,
)
from .drawing_views import base_circle, draw_table, gear_data, hole_size, point_table, profile_table, section_view
from .job import Job
from .text import Text, width_of

# Size of the largest engraved line that is a letter's, mm on the part.
LARGEST_LETTER = 6.0
# Layers with their colour index and RGB.
COLOURS = {
    PART: (7, (0, 0, 0)),
    MARK: (8, (120, 120, 120)),
    CENTRE: (1, (213, 94, 0)),
    DIM: (5, (0, 114, 178)),
    WORDS: (7, (60, 60, 60)),
}
# Height of the title's letters, mm on paper.
TITLE = 5.0
# Margin between parts, between the drawing and its frame, and from the frame to the edge of the paper, mm.
CLEAR, FRAME = 12.0, 10.0
# Width and height of paper, mm: ISO A4 to A0. Larger drawings have a size of their own.
PAPERS = ((297.0, 210.0), (420.0, 297.0), (594.0, 420.0), (841.0, 594.0), (1189.0, 841.0))
# Size on paper, mm, above which the largest part is reduced and below which it is enlarged, and the standard scales.
LARGEST, SMALLEST = 250.0, 60.0
STEPS = (5.0, 2.0, 1.0)
# Directions and lengths nearer to each other than this, mm, are the same.
SAME = 1e-6
# Angle, rad, below which a contour has no corner.
SMOOTH = 0.02
# Largest number of arcs and corners of a contour that are dimensioned, and of one of a gear, whose data have the teeth.
# One with more is given as a curve, by a table.
MOST_PIECES, OF_GEARS = 200, 32
# Largest number of coordinates along an axis that are drawn at their lines. More are listed in a table.
MOST_ORDINATES = 60


@record(eq=False)
class DimensionedDrawing:
    """Shapes with their layers, texts and dimensions, mm on paper, from the origin to (width, height)."""

    shapes: tuple[Shape, ...]
    texts: tuple[Text, ...]
    dimensions: tuple[Dimension, ...]
    width: float
    height: float
    scale: float


@record(eq=False)
class _Contour:
    """Arcs and corners of a contour, mm: arcs as centre, radius, direction of their middle, and whether to locate."""

    arcs: tuple[tuple[complex, float, complex, bool], ...]
    corners: tuple[complex, ...]

    def turned_into(self, other: _Contour, datum: complex) -> complex | None:
        """The direction by which a rotation about the datum makes this contour the other; None if none does."""
        if (len(self.arcs), len(self.corners)) != (len(other.arcs), len(other.corners)):
            return None
        mine, its = (
            np.array([*((c - datum, r) for c, r, _, _ in contour.arcs), *((c - datum, 0) for c in contour.corners)])
            for contour in (self, other)
        )
        means = its[:, 0].mean(), mine[:, 0].mean()
        if min(map(abs, means)) < SAME:
            return None
        turn = complex(means[0] / means[1])
        gaps = np.abs(turn * mine[:, None, 0] - its[:, 0]) + np.abs(mine[:, None, 1] - its[:, 1])
        near = 1e-4 * float(np.abs(its[:, 0]).max())
        return turn if abs(abs(turn) - 1) < 1e-4 and np.all(gaps.min(axis=1) < near) else None


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
    """All parts with dimensions and tables in a frame with a title block, on the smallest paper with room for them."""
    scale = drawing_scale(job.exact)
    cells = [cell for exact, solid in zip(job.exact, job.solids) for cell in _cells(job, exact, solid, scale)]
    boxes = [cell.box for cell in cells]
    sizes = [high - low for low, high in boxes]
    title = _title(job, scale)
    low, high = title.box
    block, inner = high - low + CLEAR * (1 + 1j), 2 * (FRAME + CLEAR)
    room = sum((size + CLEAR).real * (size + CLEAR * 1j).imag for size in sizes)
    own = float(np.ceil(max(1.3 * room**0.5, block.real, *(size.real for size in sizes)) + inner))
    for width, height in (*PAPERS, (own, np.inf)):
        if (places := _packed(sizes, complex(width - inner, height - inner), block)) is not None:
            break
    if height == np.inf:
        height = float(
            np.ceil(max(size.imag - place.imag for size, place in zip(sizes, places or ())) + block.imag + inner)
        )
    page = DrawingCanvas(job.unit)
    top_left = complex(FRAME + CLEAR, height - FRAME - CLEAR)
    for cell, place, (start, end) in zip(cells, places or (), boxes):
        page.take(cell, top_left + place - complex(start.real, end.imag))
    page.take(title, complex(width - FRAME, FRAME) - complex(high.real, low.imag))
    across, up = width - 2 * FRAME, height - 2 * FRAME
    corners = np.array([0, across, complex(across, up), 1j * up])
    page.shapes.append((DIM, Polyline(corners + FRAME * (1 + 1j))))
    shapes, texts, dimensions = tuple(page.shapes), tuple(page.texts), tuple(page.dimensions)
    return DimensionedDrawing(shapes, texts, dimensions, float(width), height, scale)


def _packed(sizes: Sequence[complex], room: complex, block: complex) -> list[complex] | None:
    """Upper left corners of boxes below y = 0 in a room whose lower right corner is taken; None if they do not fit.

    Each is as high as it can be below those before it (bottom-left, of a skyline): the highest first, or the widest.
    """
    orders = (sorted(range(len(sizes)), key=lambda k: (-round(side(sizes[k]), 3), k)) for side in (np.imag, np.real))
    return next((places for order in orders if (places := _in_turn(sizes, order, room, block))), None)


def _in_turn(sizes: Sequence[complex], order: Sequence[int], room: complex, block: complex) -> list[complex] | None:
    places = [0j] * len(sizes)
    # Left ends of the steps below what is placed, and their depths.
    steps = [(0.0, 0.0)]
    for k in order:
        wide, high = sizes[k].real, sizes[k].imag
        found = []
        for x, _ in steps:
            ends = [*(left for left, _ in steps[1:]), np.inf]
            depth = max(depth for (left, depth), end in zip(steps, ends) if left < x + wide + CLEAR and end > x)
            # The block has the same margin to the boxes as they have to each other.
            is_beside = x + wide > room.real + CLEAR - block.real
            if x + wide <= room.real and depth + high <= room.imag + is_beside * (CLEAR - block.imag):
                found.append((depth, x))
        if not found:
            return None
        depth, x = min(found)
        places[k], right = complex(x, -depth), x + wide + CLEAR
        after = max((step for step in steps if step[0] <= right), default=steps[0])[1]
        kept = [step for step in steps if not x <= step[0] <= right]
        steps = sorted([*kept, (x, depth + high + CLEAR), (right, after)])
    return places


def _title(job: Job, scale: float) -> DrawingCanvas:
    """The title block in a frame whose upper left corner is 0."""
    parts, unit = job.source.parts, job.unit
    pieces = sum(part.count for part in parts)
    masses = [part.count * part.mass.mass for part in parts if part.mass]
    lines = [
        f"scale {scale_text(scale)}, sizes in {unit.plural}",
        "first-angle projection, parts seen from above",
        "coordinates from the datum 0, holes through",
        f"parts: {len(parts)}, pieces: {pieces}, sheet 1 of 1",
    ]
    if len(masses) == len(parts):
        lines.append(f"mass of all pieces: {sum(masses):.4g} kg")
    cell = DrawingCanvas(unit)
    name = harmless(job.title.name or job.name)
    cell.words(name, complex(3, -3 - TITLE / 2), TITLE)
    # One column for facts of the drawing, one for entries of the recipe.
    columns = [lines, list(job.title.lines())]
    left, rows, top = 3.0, max(map(len, columns)), -7 - TITLE
    for column in filter(None, columns):
        if left > 3:
            cell.line(complex(left - 3, top + 1), complex(left - 3, top - rows * LINE))
        for number, line in enumerate(column):
            cell.words(line, complex(left, top - LETTER / 2 - number * LINE))
        left += 6 + max(width_of(line, LETTER) for line in column)
    width = max(6 + width_of(name, TITLE), left - 3)
    bottom = top - rows * LINE
    cell.add(DIM, Polyline(np.array([0, width, complex(width, bottom), complex(0, bottom)])))
    cell.line(complex(0, top + 1), complex(width, top + 1))
    return cell


def _cells(job: Job, exact: Cut, solid: Cut, scale: float) -> Iterator[DrawingCanvas]:
    """A part with its views and dimensions, then its tables."""
    part, canvas = exact.part, DrawingCanvas(job.unit)
    curves = (part.outline, *part.holes)
    data = gear_data(job, part)
    pitch = data.pitch_radius if data else 0.0
    contours = [_contour(loop, curve, OF_GEARS if data else MOST_PIECES) for loop, curve in zip(exact.loops, curves)]
    if rack := _rack(exact.loops[0], contours[0]):
        contours[0] = rack.rest
    # Curves are drawn as chords, which are equal on every processor.
    drawn = [fine if contour else coarse for fine, coarse, contour in zip(exact.loops, solid.loops, contours)]
    for loop in drawn:
        canvas.add(PART, scaled(loop.shape, scale))
    for loop in solid.marks:
        if loop.layer == MARK:
            size = max(np.ptp(loop.points.real), np.ptp(loop.points.imag))
            canvas.mark(scaled(loop.shape, scale), bool(size < LARGEST_LETTER and not isinstance(loop.shape, Circle)))
    features = _Features(exact, contours, job.unit, bool(data))
    located, datum = features.located, features.datum
    for place, radius in dict.fromkeys(located):
        if radius:
            canvas.centre_mark(place * scale, radius * scale)
    if data and len(located) == 1:
        canvas.centre_mark(datum * scale, 0.0)
    if pitch:
        canvas.add(CENTRE, Circle(datum * scale, pitch * scale))
    if base := getattr(part.outline, "base_radius", None):
        features.radii |= base_circle(canvas, exact.loops[0], datum, base, scale)
    if contours[0] is None or data:
        section_view(canvas, exact, datum, scale, pitch)
    tables: list[list[Sequence[str]]] = [[("gear data", ""), *data.rows]] if data else []
    coordinates = [{round(float(part_of(place - datum)), 6) for place, _ in located} for part_of in (np.real, np.imag)]
    if max(map(len, coordinates)) > MOST_ORDINATES:
        tables.append(point_table(canvas, datum, scale, located))
    elif max(map(len, coordinates)) > 1:
        canvas.ordinates(datum, scale, located)
    notes = list(_leaders(canvas, features, scale))
    fits = [None, *part.fits, *[None] * len(curves)]
    for curve, contour, fit in zip(curves, contours, fits):
        if contour is None and not fit and not (data and data.is_involute):
            table, sentence = profile_table(job, part, curve, datum, data.teeth if data else 1)
            tables.append(table)
            notes.append(sentence)
    teeth = rack.lines(datum, job.unit) if rack else ()
    canvas.write_below([*_facts(job, exact), *teeth, *features.patterns, *notes])
    yield canvas
    for table in tables:
        yield from draw_table(job.unit, harmless(part.name), table)


def _leaders(canvas: DrawingCanvas, features: _Features, scale: float) -> Iterator[str]:
    """Draw diameters and radii at leaders, and yield as sentences those for which there is no free place."""
    kinds: dict[DimensionKind, dict[str, Arcs]] = {"diameter": features.diameters, "radius": features.radii}
    for kind, groups in kinds.items():
        for words, circles in groups.items():
            text = f"{len(circles)} x {words}" if len(circles) > 1 else words
            if not canvas.leader(text, [(c * scale, radius * scale, middle) for c, radius, middle in circles], kind):
                offsets = [centre - features.datum for centre, _, _ in circles]
                places = (f"{length_text(z.real, canvas.unit)}, {length_text(z.imag, canvas.unit)}" for z in offsets)
                yield f"{text}: centre at {'; '.join(places)}"


def _facts(job: Job, exact: Cut) -> Iterator[str]:
    """Name, number, thickness, blank, material and mass of a part."""
    part, unit = exact.part, job.unit
    pieces = "1 piece" if part.count == 1 else f"{part.count} pieces"
    yield f"{harmless(part.name)}: {pieces}, t = {length_text(part.thickness, unit)}"
    low, high = exact.box
    size = " x ".join(length_text(side, unit) for side in ((high - low).real, (high - low).imag))
    # In parentheses, as it follows from the other dimensions.
    yield f"blank ({size})"
    if part.material:
        mass = f", {part.mass.mass:.4g} kg" if part.mass else ""
        yield f"{harmless(part.material.name)}{mass}"


def _has_arcs_only(curve: AbstractCurve) -> bool:
    """Whether a curve consists of straight lines and arcs."""
    match curve:
        case Path():
            return all(map(_has_arcs_only, curve.pieces))
        case Mirrored() | Reversed():
            return _has_arcs_only(curve.curve)
        case PolarArray():
            return _has_arcs_only(curve.piece)
    return isinstance(curve, Arc | Circle | Polyline | Segment)


def _contour(loop: Loop, curve: AbstractCurve, most: int) -> _Contour | None:
    """The whole arcs of a contour, and its corners that are not smooth; None of a curve, or if more than `most`."""
    shape = loop.shape
    if not _has_arcs_only(curve):
        return None
    if isinstance(shape, Circle):
        return _Contour(((complex(shape.centre), shape.radius, 1 + 0j, True),), ())
    z = np.asarray(shape.vertices)
    bulges = np.zeros(len(z)) if shape.bulges is None else np.asarray(shape.bulges)
    chord = np.roll(z, -1) - z
    half = 2 * np.arctan(bulges)
    first, last = (np.angle(chord * np.exp(sign * 1j * half)) for sign in (-1, 1))
    turn = np.angle(np.exp(1j * (first - np.roll(last, 1))))
    is_arc = bulges != 0
    safe = np.where(is_arc, bulges, 1.0)
    centre = (z + np.roll(z, -1)) / 2 + 1j * chord * (1 - safe**2) / (4 * safe)
    radius = np.abs(chord) * (1 + safe**2) / (4 * np.abs(safe))
    near = 1e-4 * max(np.ptp(z.real), np.ptp(z.imag))
    same_arc = is_arc & np.roll(is_arc, 1) & (np.abs(centre - np.roll(centre, 1)) < near)
    same_arc &= (np.abs(radius - np.roll(radius, 1)) < near) & (bulges * np.roll(bulges, 1) > 0)
    is_corner = np.abs(turn) > SMOOTH
    starts = np.flatnonzero(is_arc & ~same_arc)
    arcs = []
    for start in starts.tolist():
        end, sweep = start, 2 * half[start]
        while same_arc[(end + 1) % len(z)] and (end + 1) % len(z) != start:
            end = (end + 1) % len(z)
            sweep += 2 * half[end]
        spoke = z[start] - centre[start]
        middle = complex(spoke / abs(spoke) * np.exp(0.5j * sweep))
        located = not (is_corner[start] and is_corner[(end + 1) % len(z)])
        arcs.append((complex(centre[start]), float(radius[start]), middle, located))
    if is_arc.any() and not len(starts):
        arcs = [(complex(centre.mean()), float(radius.mean()), 1 + 0j, True)]
    if len(arcs) + is_corner.sum() > most:
        return None
    return _Contour(tuple(arcs), tuple(z[is_corner].tolist()))


@record(eq=False)
class _Rack:
    """The teeth of a contour along x: the places of their tip corners in pairs, fillet and flank, and all the rest."""

    tips: Complex
    fillet: float
    root: float
    flank_deg: float
    rest: _Contour

    def lines(self, datum: complex, unit: LengthUnit) -> Iterator[str]:
        """The teeth in words, from the datum."""
        pitch = float((self.tips[-1, 0] - self.tips[0, 0]).real) / (len(self.tips) - 1)
        first = complex(self.tips[0].mean()) - datum
        depth, width = float(self.tips[0, 0].imag) - self.root, float((self.tips[0, 1] - self.tips[0, 0]).real)
        sizes = [length_text(value, unit) for value in (pitch, width, depth, self.fillet, first.real, first.imag)]
        yield f"teeth {len(self.tips)}, pitch {sizes[0]}, pressure angle {self.flank_deg:.6g} deg"
        yield f"width at the tip {sizes[1]}, depth {sizes[2]}, fillet R{sizes[3]}"
        yield f"middle of the first tip at x {sizes[4]}, y {sizes[5]}"


def _rack(loop: Loop, contour: _Contour | None) -> _Rack | None:
    """The teeth of a rack that point up; None if a contour has none."""
    if contour is None or isinstance(loop.shape, Circle) or len(contour.corners) < OF_GEARS / 2:
        return None
    corners = np.array(contour.corners)
    near = 1e-5 * float(np.ptp(loop.points.real))
    tips = np.sort(corners[corners.imag > corners.imag.max() - near])
    if len(tips) < OF_GEARS / 4 or len(tips) % 2:
        return None
    pairs = tips.reshape(-1, 2)
    radii = [round(arc[1], 5) for arc in contour.arcs]
    fillet = max(radii, key=radii.count, default=0.0)
    roots = [arc[0].imag - arc[1] for arc in contour.arcs if abs(arc[1] - fillet) < near]
    if not roots or np.ptp(np.diff(pairs.real.mean(axis=1))) > near or np.ptp(np.diff(pairs.real, axis=1)) > near:
        return None
    root = float(np.mean(roots))
    z = np.asarray(loop.shape.vertices)
    k = int(np.argmin(np.abs(z - pairs[0, 0])))
    sides = [other - z[k] for other in (z[k - 1], z[(k + 1) % len(z)])]
    flank = max(sides, key=lambda side: -side.imag)
    rest = _Contour(
        tuple(arc for arc in contour.arcs if arc[0].imag < root),
        tuple(c for c in contour.corners if c.imag < root + near),
    )
    return _Rack(pairs, fillet, root, float(np.degrees(np.arctan2(abs(flank.real), abs(flank.imag)))), rest)


def _bore(contour: _Contour) -> complex:
    """Centre of a bore with flats or a keyway: that of its largest arc."""
    if not contour.arcs:
        return complex(np.mean(contour.corners))
    return max(contour.arcs, key=lambda arc: arc[1])[0]


# Centre, radius and direction of the middle of an arc, 0 of a whole circle.
Arcs = list[tuple[complex, float, complex]]


class _Features:
    """What is dimensioned of a part, mm: places with the radii of circles around them, diameters and radii by words."""

    def __init__(self, exact: Cut, contours: Sequence[_Contour | None], unit: LengthUnit, is_gear: bool) -> None:
        self.unit = unit
        self.datum = self._datum(exact, contours, is_gear)
        self.located: list[tuple[complex, float]] = [(self.datum, 0.0)]
        self.diameters: dict[str, Arcs] = {}
        self.radii: dict[str, Arcs] = {}
        self.patterns: list[str] = []
        openings: list[tuple[_Contour, list[float]]] = []
        fits = [None, *exact.part.fits, *[None] * len(contours)]
        for loop, contour, fit in zip(exact.loops, contours, fits):
            if isinstance(loop.shape, Circle):
                centre, radius = complex(loop.shape.centre), float(loop.shape.radius)
                self.located.append((centre, radius))
                self.diameters.setdefault(hole_size(fit, 2 * radius, unit), []).append((centre, radius, 0j))
            elif contour and fit:
                self._add_fitted(contour, fit)
            elif contour and not self._repeats(contour, openings):
                self._add_contour(contour)
                openings.append((contour, []))
            elif contour is None and is_gear and loop is exact.loops[0]:
                spokes = loop.points - self.datum
                farthest = spokes[int(np.argmax(np.round(np.abs(spokes), 6)))]
                tip = float(np.abs(farthest))
                self.diameters[f"Ø{length_text(2 * tip, unit)}"] = [(self.datum, tip, complex(farthest / tip))]
        for _, turns in openings:
            if turns:
                angles = ", ".join(f"{angle:.6g}" for angle in sorted(turns))
                self.patterns.append(f"opening also turned about the datum by {angles} deg")

    @staticmethod
    def _datum(exact: Cut, contours: Sequence[_Contour | None], is_gear: bool) -> complex:
        """The origin: the centre of a round outline or of a curve, a round hole or a bore, or the lower left corner."""
        if isinstance(outline := exact.loops[0].shape, Circle):
            return complex(outline.centre)
        if contours[0] is None and (exact.loops[1:] or is_gear):
            # Of a gear that is placed on a body, its axis.
            placed = exact.part.outline
            return complex(placed.pose.origin) if isinstance(placed, Moved) else 0j
        holes = [complex(loop.shape.centre) for loop in exact.loops[1:] if isinstance(loop.shape, Circle)]
        fits = zip(contours[1:], exact.part.fits)
        holes += [_bore(contour) for contour, fit in fits if contour and fit and not fit.travel]
        return min(holes, key=lambda centre: round(abs(centre), 6), default=exact.box[0])

    def _add_fitted(self, contour: _Contour, fit: HoleFit) -> None:
        """A slot, located by the centres of its ends, or a bore with flats or a keyway by its own."""
        ends = sorted(contour.arcs, key=lambda arc: arc[1])[:2] if fit.travel else contour.arcs
        places = [arc[0] for arc in ends] if fit.travel else [_bore(contour)]
        radius = max((arc[1] for arc in ends), default=fit.diameter / 2)
        self.located += [(place, radius) for place in places]
        self.diameters.setdefault(hole_size(fit, None, self.unit), []).append((places[0], radius, 0j))

    def _add_contour(self, contour: _Contour) -> None:
        self.located += [(corner, 0.0) for corner in contour.corners]
        self.located += [(centre, 0.0) for centre, _, _, is_located in contour.arcs if is_located]
        for centre, radius, middle, _ in contour.arcs:
            self.radii.setdefault(f"R{length_text(radius, self.unit)}", []).append((centre, radius, middle))

    def _repeats(self, contour: _Contour, openings: Sequence[tuple[_Contour, list[float]]]) -> bool:
        """Whether an earlier opening, turned about the datum, is this one; its angle is then noted."""
        for first, turns in openings:
            if (turn := first.turned_into(contour, self.datum)) is not None:
                turns.append(round(float(np.degrees(np.angle(turn))) % 360, 6))
                return True
        return False
