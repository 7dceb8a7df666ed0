"""Dimensions on a drawing: ordinates from a datum, diameters and radii at leaders, all placed clear of every letter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from textwrap import wrap
from typing import Any, Literal

import numpy as np

from ..core.records import record
from ..core.units import MM, LengthUnit
from ..plane.flatten import flatten
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, Mask, Real, box_of, direction_deg, rounded
from .cut import shape_box
from .text import Text, width_of

# Layers of visible edges, of engraved lines, of centre lines and pitch circles, of dimension lines, and of texts.
PART, MARK, CENTRE, DIM, WORDS = "PART", "ENGRAVE", "CENTRE", "DIM", "TEXT"
# Heights on paper, mm, of letters, and from line to line, legible on a workbench.
LETTER, LINE = 3.0, 5.0
# Least number of letters in a line below a part.
FEWEST = 32
# Distance of a dimension line from the part, length of extension lines beyond it, and half a tick, mm on paper.
AWAY, BEYOND, TICK = 8.0, 1.2, 1.2
# Length of a centre line beyond its circle, mm on paper, and gap between a feature and its extension line.
OVER, GAP = 2.0, 0.8
# Distances of texts from the circle they describe, mm on paper, and the directions of leaders, deg, in the order tried.
LEADERS = np.arange(7.0, 400.0, 4.0)
DIRECTIONS_DEG = (45, 135, -45, -135, 60, 120, 30, 150, -60, -120, -30, -150, 75, 105, 15, 165, -75, -105, -15, -165)
ARC_DIRECTIONS_DEG = (-30, 30, -60, 60, 180, 150, -150)
# Circles of a group that are tried for its leader. More take longer without a visibly better place.
TRIED = 6
# Tolerance of chords, mm on paper, when texts avoid lines, and the least distance of a text from a line.
CHORDS, CLEARANCE = 0.1, 0.9
# Distance at which lines end before engraved letters, and the shortest piece of a line that is drawn between them, mm.
BEFORE, SHORTEST = 0.4, 1.0

# Coordinates below this share of the largest are rounding errors.
NOISE = 1e-6

Shape = tuple[str, Circle | Polyline]
DimensionKind = Literal["linear", "x", "y", "diameter", "radius"]


@record(eq=False)
class Dimension:
    """A dimension on paper with its lines and its text.

    `points`, mm on paper, depend on the kind. linear: both ends and a point of the dimension line. x and y: the datum,
    the feature and the end of the line. diameter: opposite points of the circle. radius: centre and a point of the arc.
    A `measured` one has the number of its length alone as its text.
    """

    kind: DimensionKind
    points: tuple[complex, ...]
    text: Text
    lines: tuple[Polyline, ...]
    measured: bool = True

    def moved(self, shift: complex) -> Dimension:
        return replace(
            self,
            points=tuple(point + shift for point in self.points),
            text=replace(self.text, place=self.text.place + shift),
            lines=tuple(Polyline(np.asarray(line.vertices) + shift, is_closed=False) for line in self.lines),
        )


def scaled(shape: Circle | Polyline, scale: float, shift: complex = 0j) -> Circle | Polyline:
    """A shape enlarged about the origin, then moved."""
    if isinstance(shape, Circle):
        return Circle(shape.centre * scale + shift, shape.radius * scale)
    return Polyline(np.asarray(shape.vertices) * scale + shift, shape.bulges, shape.closed)


def rounded_shape(shape: Circle | Polyline, digits: int) -> Circle | Polyline:
    """A shape with so many decimals."""
    if isinstance(shape, Circle):
        return Circle(rounded(shape.centre, digits).item(), rounded(shape.radius, digits).item())
    return Polyline(rounded(shape.vertices, digits), shape.bulges, shape.closed)


def length_text(length: float, unit: LengthUnit = MM) -> str:
    """A length, mm, in a unit and without its name: three decimals of mm, four of an inch, or four digits."""
    value = unit.of(length)
    if abs(value) < 1:
        return f"{value:.4g}" if abs(value) > 1e-9 else "0"
    return f"{value:.{3 if unit is MM else 4}f}".rstrip("0").rstrip(".")


def without_noise(offsets: Complex) -> Complex:
    """Offsets from a datum, with coordinates of 0 where only rounding is left of them."""
    near = NOISE * float(np.abs(offsets).max(initial=0.0))
    return np.where(np.abs(offsets.real) > near, offsets.real, 0.0) + 1j * np.where(
        np.abs(offsets.imag) > near, offsets.imag, 0.0
    )


class DrawingCanvas:
    """What is drawn of a part, mm on paper about the part's origin, and the search for free room."""

    def __init__(self, unit: LengthUnit = MM) -> None:
        self.unit = unit
        self.shapes: list[Shape] = []
        self.texts: list[Text] = []
        self.dimensions: list[Dimension] = []
        self._starts: list[Complex] = []
        self._ends: list[Complex] = []
        self._corners = np.zeros((0, 2), dtype=complex)
        self._letters = np.zeros((0, 2), dtype=complex)

    @property
    def all_texts(self) -> list[Text]:
        return [*self.texts, *(dimension.text for dimension in self.dimensions)]

    @property
    def box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of everything, mm."""
        return box_of(self._item_boxes)

    @property
    def _item_boxes(self) -> Complex:
        lines = (line for dimension in self.dimensions for line in dimension.lines)
        shapes = [*(shape for _, shape in self.shapes), *lines]
        return np.array([*map(shape_box, shapes), *(text.box for text in self.all_texts)])

    def add(self, layer: str, shape: Circle | Polyline) -> None:
        self.shapes.append((layer, shape))
        self._occupy(shape)

    def line(self, *places: complex, layer: str = DIM) -> None:
        self.add(layer, Polyline(np.array(places), is_closed=False))

    def words(self, words: str, left: complex, height: float = LETTER) -> None:
        """A text by its left end at half of its height."""
        self.texts.append(Text(WORDS, words, left, height, starts=True))

    def write_below(self, sentences: Sequence[str]) -> None:
        """Sentences at the left end, no wider than the rest, below everything that is above them."""
        boxes = self._item_boxes
        low, high = self.box
        letters = max(FEWEST, int((high - low).real / width_of("x", LETTER)))
        lines = [line for sentence in sentences for line in wrap(sentence, letters)]
        right = low.real + LETTER + max(width_of(line, LETTER) for line in lines)
        top = boxes[boxes[:, 0].real < right, 0].imag.min() - 2 * LETTER
        for number, line in enumerate(lines):
            self.words(line, complex(low.real, top - number * LINE))

    def take(self, other: DrawingCanvas, shift: complex) -> None:
        """Add all of another canvas, moved."""
        self.shapes += [(layer, scaled(shape, 1.0, shift)) for layer, shape in other.shapes]
        self.texts += [replace(text, place=text.place + shift) for text in other.texts]
        self.dimensions += [dimension.moved(shift) for dimension in other.dimensions]

    def mark(self, shape: Circle | Polyline, is_letter: bool) -> None:
        """An engraved line. No other line but the part's own crosses a letter."""
        self.add(MARK, shape)
        if is_letter:
            self._letters = np.concatenate([self._letters, [shape_box(shape)]])

    def between_letters(self, start: complex, end: complex) -> list[Polyline]:
        """The pieces of a straight line that are clear of engraved letters."""
        margin = BEFORE * (1 + 1j)
        low, high = self._letters[:, 0] - margin, self._letters[:, 1] + margin
        enter, leave = within_box(np.array([start]), np.array([end]), low, high)
        hidden = sorted(zip(enter[enter < leave].tolist(), leave[enter < leave].tolist()))
        shares, at = [], 0.0
        for low, high in [*hidden, (1.0, 1.0)]:
            if (low - at) * abs(end - start) >= SHORTEST or not hidden:
                shares.append((at, low))
            at = max(at, high)
        step = end - start
        return [Polyline(np.array([start + a * step, start + b * step]), is_closed=False) for a, b in shares]

    def centre_mark(self, centre: complex, radius: float) -> None:
        """The centre lines of a circle."""
        for arm in ((radius + OVER), 1j * (radius + OVER)):
            for line in self.between_letters(centre - arm, centre + arm):
                self.add(CENTRE, line)

    def linear(self, start: complex, end: complex, away: complex, length: float) -> None:
        """A dimension between two points, its line shifted by `away` to a side, with the number outside of it."""
        side = away / abs(away)
        # Distance of the dimension line, from the farther of both points.
        far = max((np.conj(side) * place).real for place in (start, end)) + abs(away)
        ends = [place + side * (far - (np.conj(side) * place).real) for place in (start, end)]
        lines = [Polyline(np.array(ends), is_closed=False)]
        for place, at in zip((start, end), ends):
            lines.append(Polyline(np.array([place + GAP * side, at + BEYOND * side]), is_closed=False))
            lines.append(Polyline(np.array([at - TICK * (1 + 1j), at + TICK * (1 + 1j)]), is_closed=False))
        words = length_text(length, self.unit)
        half = complex(width_of(words, LETTER), LETTER) / 2
        place = (ends[0] + ends[1]) / 2 + complex(side.real * (half.real + 1.5), side.imag * (half.imag + 1.5))
        self._dimension(Dimension("linear", (start, end, ends[0]), Text(DIM, words, place, LETTER), tuple(lines)))

    def ordinates(self, datum: complex, scale: float, features: Sequence[tuple[complex, float]]) -> None:
        """Coordinates of features from a datum, below and to the left of all that is drawn.

        `features` are places of the part, mm, and radii of the circles around them; those with an equal coordinate
        share a line.
        """
        low = self.box[0]
        offsets = without_noise(np.array([place - datum for place, _ in features]))
        features = [(datum + offset, radius) for offset, (_, radius) in zip(offsets.tolist(), features)]
        axes: tuple[DimensionKind, ...] = ("x", "y")
        for axis in axes:
            # Along the axis, and across it from the part to the numbers, which are below or to the left.
            along, across = (1, 1j) if axis == "x" else (1j, 1)
            # Coordinates with one number share it.
            groups: dict[str, list[tuple[complex, float]]] = {}
            for place, radius in sorted(features, key=lambda f: f[0].real if axis == "x" else f[0].imag):
                offset = place - datum
                value = offset.real if axis == "x" else offset.imag
                groups.setdefault(length_text(value, self.unit), []).append((place, radius))
            values = list(groups)
            first = [min(groups[v], key=lambda f: (f[0].imag if axis == "x" else f[0].real) - f[1]) for v in values]
            positions = np.array([(place.real if axis == "x" else place.imag) * scale for place, _ in first])
            spread = _spread(positions, LETTER + 1.8)
            edge = (low.imag if axis == "x" else low.real) - AWAY / 2
            # An angle of at most 45 degrees keeps the lines apart from each other's numbers.
            jog = max(2.0, float(np.abs(spread - positions).max(initial=0.0)))
            for words, (place, radius), start, end in zip(values, first, positions.tolist(), spread.tolist()):
                across_place = (place.imag if axis == "x" else place.real) * scale
                clear = radius * scale + OVER + GAP if radius else GAP
                points = [start * along + max(across_place - clear, edge) * across]
                points += [start * along + edge * across, end * along + (edge - jog) * across]
                points.append(end * along + (edge - jog - 2) * across)
                text = Text(DIM, words, points[-1] - across, LETTER, ends=True, turned=axis == "x")
                line = Polyline(np.array(points[1:]), is_closed=False)
                ends = (datum * scale, place * scale, points[-1])
                self._dimension(Dimension(axis, ends, text, (*self.between_letters(*points[:2]), line)))

    def leader(self, words: str, circles: Sequence[tuple[complex, float, complex]], kind: DimensionKind) -> bool:
        """A text for equal circles or arcs, at the end of a leader from one of them; False if no place is free.

        Each has its centre and radius, mm on paper, and a direction of a point of the arc, 0 for a whole circle.
        """
        for distance in LEADERS.tolist():
            for centre, radius, middle in circles[:TRIED]:
                for angle in DIRECTIONS_DEG if middle == 0 else ARC_DIRECTIONS_DEG:
                    direction = complex(direction_deg(angle)) * (middle or 1)
                    touch = centre + radius * (middle or direction)
                    bend = touch + distance * direction
                    side = 1.0 if direction.real >= 0 else -1.0
                    end = bend + 2 * side
                    text = Text(DIM, words, end + 1.5 * side, LETTER, starts=side > 0, ends=side < 0)
                    arrow = 2 * (bend - touch) / abs(bend - touch)
                    wings = [touch + arrow * complex(direction_deg(turn)) for turn in (15, -15)]
                    places = (touch, bend, end), (wings[0], touch, wings[1])
                    if not self.is_free(text) or any(map(self._crosses_text, places)):
                        continue
                    lines = tuple(Polyline(np.array(points), is_closed=False) for points in places)
                    first = centre if kind == "radius" else 2 * centre - touch
                    self._dimension(Dimension(kind, (first, touch), text, lines, measured=False))
                    return True
        return False

    def label(self, words: str, near: complex) -> bool:
        """A short text as near to a point as possible; False if no place is free."""
        size = complex(width_of(words, LETTER), LETTER)
        for distance in (LEADERS - LEADERS[0] + 2.5).tolist():
            for angle in DIRECTIONS_DEG:
                end = near + distance * complex(direction_deg(angle))
                place = end + complex(np.sign(end.real - near.real) * size.real / 2, 0)
                text = Text(WORDS, words, place, LETTER)
                if self.is_free(text) and not self._crosses_text((near, end)):
                    self.texts.append(text)
                    # A line shows what a number at a distance belongs to.
                    if distance > LETTER:
                        self.line(near, end - CLEARANCE * (end - near) / abs(end - near))
                    return True
        return False

    def is_free(self, text: Text) -> bool:
        """Whether a text meets no line and no other text."""
        low, high = text.box
        margin = CLEARANCE * (1 + 1j)
        low, high = low - margin, high + margin
        a, b = self._boxes
        apart = (low.real >= b.real) | (a.real >= high.real) | (low.imag >= b.imag) | (a.imag >= high.imag)
        return bool(apart.all()) and not bool(meets_box(*self._segments, low, high).any())

    def _crosses_text(self, points: Sequence[complex]) -> bool:
        return any(
            bool(meets_box(np.array([start]), np.array([end]), *self._boxes).any())
            for start, end in zip(points, points[1:])
        )

    @property
    def _boxes(self) -> tuple[Complex, Complex]:
        """Lower left and upper right corners of all texts and engraved letters."""
        if len(self._corners) < len(self.texts) + len(self.dimensions) + len(self._letters):
            self._corners = np.concatenate([self._letters, *([text.box] for text in self.all_texts)])
        return self._corners[:, 0], self._corners[:, 1]

    def _dimension(self, dimension: Dimension) -> None:
        self.dimensions.append(dimension)
        for line in dimension.lines:
            self._occupy(line)

    def _occupy(self, shape: Circle | Polyline) -> None:
        points = flatten(shape, CHORDS)
        points = np.append(points, points[0]) if isinstance(shape, Circle) or shape.closed else points
        self._starts.append(points[:-1])
        self._ends.append(points[1:])

    @property
    def _segments(self) -> tuple[Complex, Complex]:
        if len(self._starts) > 1:
            self._starts, self._ends = [np.concatenate(self._starts)], [np.concatenate(self._ends)]
        return (self._starts[0], self._ends[0]) if self._starts else (np.zeros(0, complex), np.zeros(0, complex))


def meets_box(starts: Complex, ends: Complex, low: complex | Complex, high: complex | Complex) -> Mask:
    """Whether segments meet boxes; one of both may be single."""
    enter, leave = within_box(starts, ends, low, high)
    met: Mask = enter <= leave
    return met


def within_box(starts: Complex, ends: Complex, low: complex | Complex, high: complex | Complex) -> tuple[Real, Real]:
    """The shares of segments at which they enter boxes and leave them; the first is larger if they do not meet."""
    enter: Any = 0.0
    leave: Any = 1.0
    for a, b, least, most in (
        (starts.real, ends.real, low.real, high.real),
        (starts.imag, ends.imag, low.imag, high.imag),
    ):
        step = b - a
        flat = step == 0
        safe = np.where(flat, 1.0, step)
        one, two = (least - a) / safe, (most - a) / safe
        is_within = (least <= a) & (a <= most)
        enter = np.maximum(enter, np.where(flat, np.where(is_within, 0.0, 2.0), np.minimum(one, two)))
        leave = np.minimum(leave, np.where(flat, 1.0, np.maximum(one, two)))
    return enter, leave


def _spread(positions: Real, gap: float) -> Real:
    """Sorted positions moved as little as possible so that neighbours are at least a gap apart."""
    blocks: list[tuple[float, int]] = []
    for k, position in enumerate(positions.tolist()):
        mean, size = position - k * gap, 1
        while blocks and blocks[-1][0] > mean:
            before, count = blocks.pop()
            mean, size = (before * count + mean * size) / (count + size), count + size
        blocks.append((mean, size))
    level = np.repeat([mean for mean, _ in blocks], [size for _, size in blocks])
    return np.asarray(level + gap * np.arange(len(positions)), dtype=float)
