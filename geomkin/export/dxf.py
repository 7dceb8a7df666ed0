"""DXF: cut parts and sheets, one layer per operation, and the assembly. The only writer that loads ezdxf."""

from __future__ import annotations

import io
import logging
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Literal

import numpy as np
from ezdxf import options, units  # type: ignore[attr-defined]  # documented, though not exported
from ezdxf.colors import DXF_DEFAULT_COLORS, int2rgb
from ezdxf.document import Drawing
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new
from ezdxf.layouts.base import BaseLayout

from ..core.errors import harmless
from ..core.fields import to_digits
from ..core.names import folded_name
from ..core.units import MM, LengthUnit
from ..model.scene import Scene, SceneMark
from ..plane.flatten import flatten
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, box_of, rounded
from .cut import FORBIDDEN, LAYERS, LayerStyles, cut, decimals, shape_box
from .dimensioned import COLOURS, FRAME, dimensioned_drawing
from .dimensions import CENTRE, DIM, Dimension, rounded_shape
from .dimensions import LETTER as SHEET_LETTER
from .job import Job
from .layout import Sheet
from .still import LETTER, SCREEN, Name, Still, frame_at, place_labels, rgb
from .text import Text

# The number of the old version in files, and the versions that are written.
R12 = "AC1009"
# Style of dimensions, and decimals of mm of their places on paper.
SHEET_STYLE, PAPER_DIGITS = "SHEET", 6
DxfVersion = Literal["R2000", "R12"]


def write_dxf(job: Job) -> dict[str, bytes]:
    """All parts in one file, or one for each sheet."""
    return job.sheet_files("dxf", lambda sheet: dxf(sheet, job.stamp, job.unit, job.layers, job.dxf_version))


def dxf(
    sheet: Sheet,
    stamp: str = "",
    unit: LengthUnit = MM,
    styles: LayerStyles = LayerStyles(),
    version: DxfVersion = "R2000",
) -> bytes:
    """The sheet as a DXF file: AC1015 (R2000), the first version with units, or AC1009 (R12) for older programs.

    The same sheet gives the same bytes.
    """
    names, colours = styles.names, styles.colours
    shapes = [(names[loop.layer], loop.shape) for placed in sheet.placed for loop in placed.loops]
    layers = {names[layer]: _with_index(colours[layer]) if layer in colours else LAYERS[layer] for layer in LAYERS}
    if not any(layer == names["TAB"] for layer, _ in shapes):
        del layers[names["TAB"]]
    return drawn(layers, shapes, (), sheet.extents, (0j, complex(sheet.width, sheet.height)), stamp, unit, version)


def _with_index(rgb: tuple[int, int, int]) -> tuple[int, tuple[int, int, int]]:
    """A colour with its index, or that of the nearest one, in the palette of programs without RGB."""
    palette = np.array([tuple(int2rgb(colour)) for colour in DXF_DEFAULT_COLORS[1:256]])
    return 1 + int(np.argmin(((palette - np.array(rgb)) ** 2).sum(axis=1))), rgb


def drawn(
    layers: Mapping[str, tuple[int, tuple[int, int, int]]],
    shapes: Iterable[tuple[str, Circle | Polyline]],
    texts: Iterable[Text],
    extents: tuple[complex, complex],
    limits: tuple[complex, complex],
    stamp: str = "",
    unit: LengthUnit = MM,
    version: DxfVersion = "R2000",
    dimensions: Sequence[Dimension] = (),
    scale: float = 1.0,
) -> bytes:
    """A DXF file of shapes and texts on their layers.

    `layers` maps names to colour index and RGB; `extents` and `limits` are the corners of the shapes and of the paper,
    mm. The stamp is in the dictionary EZDXF_META. unit: of the numbers in the file. Dimensions are of
    a part drawn at a scale.
    """
    with _fixed_stamps():
        # The library's default is metres, and programs would read the file 1000 times too large.
        document = new(version, units=units.MM if unit is MM else units.IN)
        document.header["$MEASUREMENT"] = int(unit is MM)
        if stamp:
            document.ezdxf_metadata()["STAMP"] = stamp
        # Without a plot scale one program prints a blank page.
        document.header["$PSVPSCALE"] = 1.0
        for name, (index, rgb) in layers.items():
            # Every file has the layer 0.
            table = document.layers
            row = table.get(name) if name in table else table.add(name)
            row.color, row.rgb = index, rgb
        space = document.modelspace()
        for layer, shape in shapes:
            _add(space, layer, _in_unit(shape, unit))
        for text in texts:
            _add_text(space, text, unit)
        if dimensions:
            document.linetypes.add(CENTRE, [unit.of(7.0), *map(unit.of, (4.0, -1.0, 1.0, -1.0))])
            document.layers.get(CENTRE).dxf.linetype = CENTRE
            # Numbers are lengths of the part; the lines are on paper at a scale.
            style = {
                "dimlfac": 1 / scale,
                "dimtxt": unit.of(SHEET_LETTER),
                "dimdec": 3 if unit is MM else 4,
                "dimzin": 8,
            }
            document.dimstyles.new(SHEET_STYLE, dxfattribs=style)
        for dimension in dimensions:
            _add_dimension(document, dimension, unit, PAPER_DIGITS)
        # The library copies these from the layout to the header when it writes, except extents that begin at 0, 0.
        low, high, *corners = (unit.of(corner) for corner in (*extents, *limits))
        document.header["$EXTMIN"], document.header["$EXTMAX"] = ends = tuple(
            (z.real, z.imag, 0.0) for z in (low, high)
        )
        space.reset_extents(*ends)
        space.reset_limits(*((corner.real, corner.imag) for corner in corners))
        return _bytes(document)


def _in_unit(shape: Circle | Polyline, unit: LengthUnit) -> Circle | Polyline:
    """The shape with its lengths, mm, in this unit."""
    if unit is MM:
        return shape
    if isinstance(shape, Circle):
        return Circle(unit.of(shape.centre), unit.of(shape.radius))
    return Polyline(unit.of(np.asarray(shape.vertices)), shape.bulges, shape.closed)


def _add(space: BaseLayout, layer: str, shape: Circle | Polyline) -> None:
    attributes = {"layer": layer}
    if isinstance(shape, Circle):
        space.add_circle((shape.centre.real, shape.centre.imag), shape.radius, dxfattribs=attributes)
        return
    vertices = np.asarray(shape.vertices)
    if space.doc is not None and space.doc.dxfversion == R12:
        bulges = np.zeros(len(vertices)) if shape.bulges is None else np.append(shape.bulges, 0.0)[: len(vertices)]
        points = list(zip(vertices.real.tolist(), vertices.imag.tolist(), bulges.tolist()))
        space.add_polyline2d(points, format="xyb", close=shape.closed, dxfattribs=attributes)
        return
    polyline = space.add_lwpolyline([], close=shape.closed, dxfattribs=attributes)
    rows = np.zeros((len(vertices), 5))  # x, y, start width, end width, bulge
    rows[:, 0], rows[:, 1] = vertices.real, vertices.imag
    if shape.bulges is not None:
        # An open one has no bulge at its last vertex.
        rows[: len(shape.bulges), 4] = shape.bulges
    # Appending points one by one takes quadratic time: 19 s for 1e5 points, against 0.9 s.
    polyline.lwpoints.values = rows


def _bytes(document: Drawing) -> bytes:
    # Sorted, since the order of a set differs between runs.
    for name in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(name)
    stream = io.StringIO()
    document.write(stream)
    return document.encode(stream.getvalue())


@contextmanager
def _fixed_stamps() -> Iterator[None]:
    """Suppress time stamps and random identifiers, which differ between runs, and a remark on units that R12 lacks."""
    logger = logging.getLogger("ezdxf")
    before = options.write_fixed_meta_data_for_testing, logger.level
    options.write_fixed_meta_data_for_testing = True
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before[0]
        logger.setLevel(before[1])


def sheet(job: Job) -> bytes:
    """The dimensioned drawing on paper, with dimensions that programs can edit; the title gives its scale."""
    page, digits = dimensioned_drawing(job), decimals(job.tolerance)
    shapes = [(layer, rounded_shape(shape, digits)) for layer, shape in page.shapes]
    texts = [replace(text, place=rounded(text.place, digits).item()) for text in page.texts]
    paper, frame = complex(page.width, page.height), FRAME * (1 + 1j)
    return drawn(
        COLOURS,
        shapes,
        texts,
        (frame, paper - frame),
        (0j, paper),
        unit=job.unit,
        dimensions=page.dimensions,
        scale=page.scale,
    )


# Types of dimensions in the format; 32: the block belongs to this one alone; 64: of an ordinate along x.
DIMENSION_TYPES = {"linear": 32, "diameter": 35, "radius": 36, "x": 38 + 64, "y": 38}
# Tags of the points of each kind, in their order. Those of a diameter and a radius are on the circle.
POINT_TAGS = {
    "linear": ("defpoint2", "defpoint3", "defpoint"),
    "diameter": ("defpoint", "defpoint4"),
    "radius": ("defpoint", "defpoint4"),
    "x": ("defpoint", "defpoint2", "defpoint3"),
    "y": ("defpoint", "defpoint2", "defpoint3"),
}


def _add_dimension(document: Drawing, dimension: Dimension, unit: LengthUnit, digits: int) -> None:
    """A dimension with its lines and its text in a block, so that it looks the same in every program."""
    block = document.blocks.new_anonymous_block("D")
    for line in dimension.lines:
        _add(block, DIM, _in_unit(rounded_shape(line, digits), unit))
    _add_text(block, dimension.text, unit)
    attributes = {"layer": DIM, "dimtype": DIMENSION_TYPES[dimension.kind], "geometry": block.name}
    attributes |= {"dimstyle": SHEET_STYLE, "text": "" if dimension.measured else dimension.text.text}
    points = (*dimension.points, dimension.text.place)
    for tag, point in zip((*POINT_TAGS[dimension.kind], "text_midpoint"), points):
        place = unit.of(rounded(point, digits).item())
        attributes[tag] = (place.real, place.imag, 0.0)
    if dimension.kind == "linear":
        along = dimension.points[1] - dimension.points[0]
        attributes["angle"] = round(float(np.degrees(np.angle(along))), 9)
    document.modelspace().new_entity("DIMENSION", attributes)


def _add_text(space: BaseLayout, text: Text, unit: LengthUnit) -> None:
    place, height = unit.of(text.place), unit.of(text.height)
    # In the format two per cent signs start a code.
    words = text.text.replace("%%", "% %")
    attributes = {"layer": text.layer, "rotation": 90.0} if text.turned else {"layer": text.layer}
    entity = space.add_text(words, height=height, dxfattribs=attributes)
    side = "LEFT" if text.starts else "RIGHT" if text.ends else "CENTER"
    align = TextEntityAlignment[f"MIDDLE_{side}"]
    entity.set_placement((place.real, place.imag), align=align)


# Layers besides those of bodies, which start with BODY, and their colours in the palette.
PINS, NAMES = "PINS", "NAMES"
ASSEMBLY_COLOURS = {PINS: "line", NAMES: "ink", "TRACED": "traced", "WANTED": "wanted", "CONTACT": "acceleration"}
# Colour index for programs without RGB: black on white, white on black.
EITHER = 7

Shape = tuple[str, Circle | Polyline]


def assembly_drawing(job: Job) -> bytes:
    """The drawing at full size: outlines with arcs on a layer for each body; paths, pins and names on others."""
    scene = job.scene
    still = Still(scene, np.array([frame_at(scene, job.assembly_at)]))
    layers = _layers(scene)
    shapes = [*_bodies(still, job.tolerance, layers), *_curves(still, job.tolerance), *_marks(still, job.tolerance)]
    names = place_labels(still)
    texts = [_text(name, still) for name in names]
    corners = [shape_box(shape) for _, shape in shapes]
    extents = box_of(np.array([*corners, *((name.place - name.half, name.place + name.half) for name in names)]))
    used = {layer for layer, _ in shapes} | {text.layer for text in texts}
    tints = {layer: still.tint(body) for body in scene.bodies for layer in [layers[body.name]]}
    colours = {layer: _colour(tints.get(layer, ASSEMBLY_COLOURS.get(layer, "soft"))) for layer in sorted(used)}
    return drawn(colours, shapes, texts, extents, extents, unit=job.unit)


def _layers(scene: Scene) -> dict[str, str]:
    """The layer of each body by its name, all distinct, since layer names ignore case."""
    layers: dict[str, str] = {}
    for body in scene.bodies:
        plain = "".join("_" if c in FORBIDDEN or not c.isprintable() else c for c in body.name) or "body"
        layer, count = f"BODY {plain}", 1
        while folded_name(layer) in map(folded_name, layers.values()):
            count += 1
            layer = f"BODY {plain} {count}"
        layers[body.name] = layer
    return layers


def _colour(name: str) -> tuple[int, tuple[int, int, int]]:
    """A colour of the palette, with pale body tints darkened for lines."""
    darkening = 2 if name[0] == "t" and name[1:].isdigit() else 1
    red, green, blue = (channel // darkening for channel in rgb(name))
    return EITHER, (red, green, blue)


def _bodies(still: Still, tolerance: float, layers: dict[str, str]) -> Iterator[Shape]:
    k = still.frame
    for body in still.bodies:
        for part in body.parts:
            cut_part = cut(part, tolerance, arcs=True)
            for loop in (*cut_part.loops, *cut_part.marks):
                moved = loop.moved(complex(body.origin[k]), cut_part.digits, complex(body.direction[k]))
                yield layers[body.name], moved.shape


def _curves(still: Still, tolerance: float) -> Iterator[Shape]:
    poses, digits = {body.name: body for body in still.scene.bodies}, decimals(tolerance)
    for curve in still.scene.curves:
        points = flatten(curve.curve, max(tolerance, 0.1 * SCREEN * still.size))
        if body := poses.get(curve.body):
            points = body.origin[still.frame] + body.direction[still.frame] * points
        yield from _line(_layer(curve.role), points, digits, curve.curve.closed)


def _marks(still: Still, tolerance: float) -> Iterator[Shape]:
    for mark in still.marks:
        if mark.trail:
            for run in still.trail_runs(mark):
                yield from _line(_layer(mark.role), run, decimals(tolerance))
        yield from _mark(still, mark, tolerance)


def _mark(still: Still, mark: SceneMark, tolerance: float) -> Iterator[Shape]:
    k, px, digits = still.frame, still.pixel, decimals(tolerance)
    place = complex(mark.place[k])
    if not np.isfinite(place):
        return
    if mark.vector is not None:
        yield from _line(_layer(mark.role), np.array([place, place + mark.vector[k]]), digits)
        return
    if mark.sort == "slide" and mark.direction is not None:
        corners = px * np.array([-10 - 6.5j, 10 - 6.5j, 10 + 6.5j, -10 + 6.5j]) * complex(mark.direction[k])
        yield PINS, Polyline(rounded(place + corners, digits))
        return
    layer, radius = (PINS, still.hole_radii.get(mark, 3 * px)) if mark.sort.endswith("pin") else ("", 2.5 * px)
    if mark.radius is not None:
        radius = float(mark.radius[k])
    if radius > tolerance:
        yield layer or _layer(mark.role), Circle(rounded(place, digits).item(), radius)


def _layer(role: str) -> str:
    return role.upper()


def _line(layer: str, points: Complex, digits: int, closed: bool = False) -> Iterator[Shape]:
    """A line through points without repeats; none if it has a single point or is not finite."""
    points = rounded(points, digits)
    points = points[np.append(True, points[1:] != points[:-1])]
    points = points[:-1] if closed and points[-1] == points[0] else points
    if len(points) > 1 and np.isfinite(points).all():
        yield layer, Polyline(points, is_closed=closed)


def _text(name: Name, still: Still) -> Text:
    place, height = rounded(name.place, still.digits).item(), to_digits(0.72 * LETTER * still.pixel, 3)
    return Text(NAMES, harmless(name.text), place, height)
