"""Drawings read back, DXF by ezdxf and SVG by the standard library. No other module of this package loads ezdxf."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
from ezdxf.filemanagement import readfile

from ..core.errors import DesignError, with_article
from ..plane.vec import Complex
from ..synthesis.path.svg_drawings import AffineMap, tag_of, transform_of, tree_of, view_of
from .outline import LARGEST, Drawing, Line, Outline, Pen, UnreadableError, circle, collected, polyline

# Lengths of the units in which drawings are written, by their number in the format, mm.
UNITS = {1: 25.4, 4: 1.0}


def read_dxf(path: Path, error: float) -> Drawing:
    """The lines of a DXF file, arcs as chords within `error`, mm.

    UnreadableError if it is no DXF file, or has too many vertices.
    """
    try:
        document = readfile(path)
        entities: list[Any] = list(document.modelspace())
    except Exception as fault:
        # The library lets many kinds of error through when a file is damaged.
        raise UnreadableError(f"ezdxf cannot read it ({type(fault).__name__})") from fault
    problems: list[str] = []
    if (units := document.header.get("$INSUNITS", 0)) not in UNITS:
        problems.append(f"its $INSUNITS is {units}, not 4 for mm or 1 for inches")
    unit = UNITS.get(units, 1.0)
    lines = collected(_dxf_lines(entities, error, problems, unit))
    problems += _wrong_extents(document, lines, error, unit)
    return Drawing(lines, document.ezdxf_metadata().get("STAMP", ""), tuple(problems))


def _dxf_lines(entities: list[Any], error: float, problems: list[str], unit: float) -> Iterator[Line]:
    """The circles and polylines; a sentence is added to `problems` for anything else. unit: of the drawing, mm."""
    for entity in entities:
        kind, layer = entity.dxftype(), entity.dxf.layer
        if kind == "CIRCLE":
            yield Line(circle(unit * _point(entity.dxf.center), unit * float(entity.dxf.radius), error), layer)
        elif kind != "LWPOLYLINE":
            problems.append(f"it has {with_article(kind)} on layer {layer}, which is not a closed polyline or circle")
        elif len(entity) < 2:
            problems.append(f"a polyline on layer {layer} has fewer than two vertices")
        else:
            rows = np.array(entity.get_points("xyb"), dtype=float).reshape(-1, 3)
            outline = polyline(unit * (rows[:, 0] + 1j * rows[:, 1]), rows[:, 2].tolist(), bool(entity.closed), error)
            yield Line(outline, layer)


def _wrong_extents(document: Any, lines: Sequence[Line], error: float, unit: float) -> list[str]:
    """A sentence if the header's extents are not those of the lines."""
    cut = np.concatenate([line.outline.points for line in lines]) if lines else np.zeros(0, dtype=complex)
    if not len(cut):
        return ["it has no lines"]
    low, high = (unit * _point(document.header.get(name, (np.nan, np.nan))) for name in ("$EXTMIN", "$EXTMAX"))
    found = np.array([cut.real.min(), cut.imag.min(), cut.real.max(), cut.imag.max()])
    stated = np.array([low.real, low.imag, high.real, high.imag])
    far = not np.all(np.abs(found - stated) <= 2 * error + 1e-6)
    return ["the extents in its header are not those of its lines"] if far else []


def _point(place: Any) -> complex:
    return complex(float(place[0]), float(place[1]))


TOKEN = re.compile(r"([MmLlHhVvAaCcZz])|([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|([\s,]+)")
# Numbers that each command takes.
COUNTS = {"m": 2, "l": 2, "h": 1, "v": 1, "a": 7, "c": 6, "z": 0}
# Operations by stroke colour, as laser cutting programs have them, for lines without a class.
COLOURS = {"#ff0000": "CUT", "#0000ff": "ENGRAVE"}
LAYERS = ("CUT", "HOLE", "ENGRAVE", "LABEL", "PITCH")
# Chords of a cubic curve, which editors write in place of arcs.
CHORDS = np.arange(1, 257) / 256
UNIT = re.compile(r"[\d.]+(?:mm|in)")


def read_svg(path: Path, error: float) -> Drawing:
    """The lines of an SVG file, arcs as chords within `error`, mm. UnreadableError if it is no such drawing."""
    with path.open("rb") as file:
        content = file.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise UnreadableError(f"it has more than {LARGEST:,} bytes")
    try:
        root = tree_of(content.decode("utf-8"))
        view = view_of(root)
        lines = collected(_svg_lines(root, view, "", error, 0))
    except UnicodeDecodeError:
        raise UnreadableError("it is not UTF-8 text") from None
    except DesignError as refusal:
        raise UnreadableError(refusal.problem) from None
    problems = [
        f"its {name} is not stated in mm or in"
        for name in ("width", "height")
        if not UNIT.fullmatch(root.get(name, ""))
    ]
    stamps = [element.text or "" for element in root if tag_of(element) == "desc"]
    return Drawing(lines, stamps[0] if stamps else "", tuple(problems if lines else [*problems, "it has no lines"]))


def _svg_lines(element: Element, view: AffineMap, layer: str, error: float, depth: int) -> Iterator[Line]:
    """The lines of an element and of those inside it."""
    if depth > 100:
        raise UnreadableError("its elements are nested more than 100 deep")
    if "transform" in element.attrib:
        view = view.after(transform_of(element.get("transform", "")))
    layer = _layer(element) or layer
    tag = tag_of(element)
    if tag == "path":
        for outline in subpaths(element.get("d", ""), error):
            yield Line(_placed(outline, view), layer or "CUT")
    elif tag == "circle":
        centre = complex(_number(element, "cx"), _number(element, "cy"))
        yield Line(_placed(circle(centre, _number(element, "r"), error), view), layer or "CUT")
    for child in element:
        yield from _svg_lines(child, view, layer, error, depth + 1)


def _layer(element: Element) -> str:
    name = element.get("class", "")
    return name if name in LAYERS else COLOURS.get(element.get("stroke", "").lower(), "")


def _number(element: Element, key: str) -> float:
    try:
        return float(element.get(key, "0").removesuffix("mm"))
    except ValueError:
        raise UnreadableError(f"the {key} of a circle is not a number") from None


def _placed(outline: Outline, view: AffineMap) -> Outline:
    """The outline in mm, y up, about an arbitrary origin, which does not matter for the fit of a part."""
    return Outline(np.conj(view.place(outline.points)), outline.error, outline.closed)


def subpaths(text: str, error: float) -> Iterator[Outline]:
    """The subpaths of the attribute `d`, made of straight edges, circular arcs and cubic curves."""
    tokens = _tokens(text)
    pen, here, start, command, k = Pen(error), 0j, 0j, "", 0
    while k < len(tokens):
        if tokens[k].isalpha():
            command, k = tokens[k], k + 1
        count = COUNTS.get(command.lower(), -1)
        try:
            values = [float(token) for token in tokens[k : k + count]]
        except ValueError:
            values = []
        if count < 0 or len(values) != count:
            raise UnreadableError(f"a path lacks numbers after {command or 'its start'}")
        k += count
        base = 0j if command.isupper() else here
        if command in "Zz":
            if here != start:
                pen.edge(here, start)
            yield pen.outline(closed=True)
            pen, here = Pen(error), start
            if k < len(tokens) and not tokens[k].isalpha():
                raise UnreadableError("a path has numbers after its end")
        elif command in "Mm":
            if pen.points:
                yield pen.outline(closed=False, end=here)
                pen = Pen(error)
            here = start = base + complex(*values)
            # Further pairs of numbers are straight edges.
            command = "L" if command == "M" else "l"
        else:
            end = _end(command, values, here, base)
            _step(pen, command, values, here, end, base)
            here = end
    if pen.points:
        yield pen.outline(closed=False, end=here)


def _tokens(text: str) -> list[str]:
    tokens, at = [], 0
    while at < len(text):
        if not (match := TOKEN.match(text, at)):
            raise UnreadableError(f"a path holds {text[at : at + 10]!r}")
        if not match.group(3):
            tokens.append(match.group())
        at = match.end()
    return tokens


def _end(command: str, values: list[float], here: complex, base: complex) -> complex:
    kind = command.lower()
    if kind == "h":
        return complex(base.real + values[0], here.imag)
    if kind == "v":
        return complex(here.real, base.imag + values[0])
    return base + complex(*values[-2:])


def _step(pen: Pen, command: str, values: list[float], here: complex, end: complex, base: complex) -> None:
    kind = command.lower()
    if kind == "a":
        across, up, _, large, sweep = values[:5]
        if abs(across - up) > 1e-9 * abs(across):
            raise UnreadableError("a path has an arc of an ellipse")
        pen.edge(here, end, _bulge(here, end, across, bool(large), bool(sweep)))
    elif kind == "c":
        one, two = base + complex(*values[:2]), base + complex(*values[2:4])
        t = np.append(0.0, CHORDS[:-1])
        points: Complex = here * (1 - t) ** 3 + 3 * one * t * (1 - t) ** 2 + 3 * two * t**2 * (1 - t) + end * t**3
        pen.add(points)
    else:
        pen.edge(here, end)


def _bulge(here: complex, end: complex, radius: float, large: bool, sweep: bool) -> float:
    """Tangent of a quarter of an arc's sweep, in the file's own coordinates."""
    if here == end or radius == 0:
        return 0.0
    half = float(np.arcsin(min(abs(end - here) / (2 * abs(radius)), 1.0)))
    quarter = (np.pi - half if large else half) / 2
    return float(np.tan(quarter)) * (1 if sweep else -1)
