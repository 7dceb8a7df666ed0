"""A mechanism put together from the files in its folder alone: outlines, holes and letters read off the drawing."""

import csv
import json
from dataclasses import dataclass, field
from functools import cache
from string import ascii_uppercase

import ezdxf
import numpy as np
import shapely
from HersheyFonts import HersheyFonts

# Heights of engraved capitals, mm, and those of the font.
HEIGHTS, CAPITAL = (5.0, 4.0, 3.0, 2.5), 21.0
# mm that strokes in the drawing may be off the font's: they are rounded to a thousandth.
OFF = 5e-3


@dataclass
class Piece:
    """An outline of the drawing: polygon, circles as (centre, diameter), slots as polygons, and what is engraved."""

    shape: shapely.Polygon
    holes: list = field(default_factory=list)
    slots: list = field(default_factory=list)
    strokes: list = field(default_factory=list)
    name: str = ""

    @property
    def lettered(self):
        """Letter -> numbers of its openings, holes first: each letter stands next to the one that it names."""
        found = {}
        openings = [shapely.Point(z.real, z.imag).buffer(d / 2) for z, d in self.holes] + self.slots
        for letter, place in self.letters:
            away = [opening.distance(shapely.Point(place.real, place.imag)) for opening in openings]
            if away and min(away) < 5:
                found.setdefault(letter, []).append(int(np.argmin(away)))
        return found

    @property
    def letters(self):
        """Single letters in the smallest height, with their places; the most strokes first, as an E holds an F."""
        left = list(self.strokes)
        for letter in sorted(ascii_uppercase, key=lambda sign: -len(strokes(sign))):
            for laid in list(engraved(left, letter, HEIGHTS[-1:])):
                if all(any(same(one, line) for line in left) for one in laid):
                    left = [line for line in left if not any(same(one, line) for one in laid)]
                    yield letter, np.concatenate(laid).mean()


@cache
def strokes(words):
    font = HersheyFonts()
    font.load_default_font("futural")
    return [np.array([x - 1j * y for x, y in stroke]) for stroke in font.strokes_for_text(words)]


def engraved(lines, words, heights=HEIGHTS):
    """Each text of these words among strokes, turned in any way, as its strokes there.

    Its first stroke states how it is laid, and all others must lie where that says.
    """
    glyphs = strokes(words)
    first = glyphs[0]
    for line in lines:
        if len(line) != len(first):
            continue
        far = int(np.argmax(abs(first - first[0])))
        grown = (line[far] - line[0]) / (first[far] - first[0])
        height = min(heights, key=lambda h: abs(h / CAPITAL - abs(grown)))
        if abs(abs(grown) * CAPITAL - height) > 0.05:
            continue
        # Rounded ends turn a short stroke a little: all strokes together give the rotation.
        grown *= height / CAPITAL / abs(grown)
        laid = [line[0] + grown * (glyph - first[0]) for glyph in glyphs]
        near = [min(lines, key=lambda one, a=a: abs(one - a).max() if len(one) == len(a) else np.inf) for a in laid]
        if all(len(one) == len(a) and abs(one - a).max() < 0.1 for one, a in zip(near, laid)):
            yield near


@dataclass
class Folder:
    """What a builder has: pieces cut, the bill, and the steps."""

    pieces: list
    cut: dict
    bought: list
    steps: list
    summary: dict

    def of(self, name):
        return [piece for piece in self.pieces if piece.name == name]


def read(folder):
    """The folder of a recipe, as `geomkin run` leaves it."""
    name = folder.name
    summary = json.loads((folder / "summary.json").read_text())
    rows = list(csv.DictReader((folder / f"{name}-bom.csv").read_text().splitlines()))
    cut = {row["item"]: row for row in rows if row["thickness_mm"]}
    bought = [(row["item"], int(row["count"]), row["joints"].split()) for row in rows if not row["thickness_mm"]]
    steps = summary.get("steps") or summary.get("stack", {}).get("steps", [])
    sheets = [folder / f"{name}.dxf", *sorted(folder.glob(f"{name}-[0-9]*.dxf"))]
    pieces = [piece for sheet in sheets for piece in drawing(sheet)]
    for piece in pieces:
        piece.name = identity(piece, cut, summary)
    return Folder(pieces, cut, bought, steps, summary)


def drawing(path):
    """Every outline with all that lies in it."""
    model = ezdxf.readfile(path).modelspace()
    outlines, holes, slots, lines = [], [], [], []
    for entity in model:
        layer = entity.dxf.layer
        if entity.dxftype() == "CIRCLE":
            circle = complex(entity.dxf.center.x, entity.dxf.center.y), 2 * entity.dxf.radius
            {"HOLE": holes, "CUT": outlines}.get(layer, []).append(circle)
            continue
        z = np.array([complex(x, y) for x, y in entity.get_points("xy")])
        if layer == "LABEL":
            lines.append(z)
        elif entity.closed:
            shape = shapely.Polygon(np.column_stack([z.real, z.imag]))
            {"HOLE": slots, "CUT": outlines}.get(layer, []).append(shape)
    shapes = [
        shapely.Point(one[0].real, one[0].imag).buffer(one[1] / 2, quad_segs=64) if isinstance(one, tuple) else one
        for one in outlines
    ]
    # A small part may lie in the hole of a large one: the smallest outline around is that of a hole.
    pieces = [Piece(shape) for shape in sorted(shapes, key=lambda shape: shape.area)]

    def around(z):
        return next(piece for piece in pieces if piece.shape.contains(shapely.Point(z.real, z.imag)))

    for hole in holes:
        around(hole[0]).holes.append(hole)
    for slot in slots:
        around(complex(*np.asarray(slot.exterior.coords)[0])).slots.append(slot)
    for line in lines:
        around(line[0]).strokes.append(line)
    return pieces


def identity(piece, cut, summary):
    """Name of a piece: engraved, or its number in the bill; without either, the one part that is as large.

    Strokes of what it is called are no letters of joints.
    """
    by = {name: name for name in cut} | {str(number): name for number, name in enumerate(cut, 1)}
    for words in sorted(by, key=len, reverse=True):
        for laid in engraved(piece.strokes, words):
            kept = [line for line in piece.strokes if not any(same(line, one) for one in laid)]
            # A number of one stroke looks like part of a longer word, which would leave more than letters of holes.
            if not words.isdigit() or len(kept) <= 4 * (len(piece.holes) + len(piece.slots)):
                piece.strokes = kept
                return by[words]
    area = piece.shape.area - sum(np.pi * d * d / 4 for _, d in piece.holes) - sum(s.area for s in piece.slots)
    areas = {part["name"]: part.get("written_area_mm2", part["area_mm2"]) for part in summary["parts"]}
    near = [name for name, size in areas.items() if abs(size - area) < 2e-3 * size]
    return near[0] if len(near) == 1 else ""


def same(one, two):
    return len(one) == len(two) and abs(one - two).max() < OFF
