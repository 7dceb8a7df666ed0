"""SVG of the sheet at full size, for viewing, or with the colours of laser cutting programs."""

from __future__ import annotations

from html import escape

import numpy as np

from ..core.errors import harmless
from ..core.units import MM, LengthUnit
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Real, rounded
from .cut import LAYERS, LayerStyles
from .dimensioned import COLOURS, dimensioned_drawing
from .dimensions import CENTRE, DIM, rounded_shape
from .job import Job
from .layout import Sheet

# Stroke width, mm: thin, as cutting programs expect, and visible on a screen.
STROKE = 0.25
# Colours and width by which laser cutting programs recognise cuts and engraved lines.
LASER = {"CUT": "#ff0000", "HOLE": "#ff0000", "ENGRAVE": "#0000ff", "LABEL": "#0000ff", "TAB": "#00ff00"}
HAIRLINE = 0.01


def write_svg(job: Job) -> dict[str, bytes]:
    """All parts in one file, or one for each sheet."""
    return job.sheet_files("svg", lambda sheet: svg(sheet, job.name, job.laser, job.stamp, job.unit, job.layers))


def _hexadecimal(rgb: tuple[int, int, int]) -> str:
    return "#{:02x}{:02x}{:02x}".format(*rgb)


def svg(
    sheet: Sheet,
    title: str,
    laser: bool = False,
    stamp: str = "",
    unit: LengthUnit = MM,
    styles: LayerStyles = LayerStyles(),
) -> bytes:
    """The sheet as an SVG file; y up becomes the format's y down.

    Width and height are in the given unit, and coordinates in mm.

    The white background is a style of the page and no shape, since every shape is cut. With `laser` the file has the
    colours and strokes of laser cutting programs, and only shapes to cut or engrave.
    `styles` may give layers other colours.
    """
    colours = LASER if laser else {name: _hexadecimal(rgb) for name, (_, rgb) in LAYERS.items()}
    colours = colours | {name: _hexadecimal(rgb) for name, rgb in styles.colours.items()}
    stroke = HAIRLINE if laser else STROKE
    size = f"{sheet.width:g}", f"{sheet.height:g}"
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" {svg_size(sheet.width, sheet.height, unit)} '
        f'viewBox="0 0 {size[0]} {size[1]}" fill="none" stroke-width="{stroke}" style="background:#fff">',
        # XML forbids control characters.
        f"<title>{escape(''.join(c if c.isprintable() else ' ' for c in title))}</title>",
        *([f"<desc>{escape(stamp)}</desc>"] if stamp else []),
    ]
    for number, placed in enumerate(sheet.placed, 1):
        lines.append(f'<g id="{escape(placed.cut.part.name)}-{number}">')
        for loop in (loop for loop in placed.loops if loop.layer in colours):
            shape = shape_of(loop.shape, sheet.height, placed.cut.digits)
            lines.append(f'{shape} class="{loop.layer}" stroke="{colours[loop.layer]}"/>')
        lines.append("</g>")
    lines.append("</svg>\n")
    return "\n".join(lines).encode("utf-8", "replace")


def svg_size(width: float, height: float, unit: LengthUnit) -> str:
    """Width and height of a file of a size in mm, as attributes in the given unit."""
    wide, high = (f"{size:g}" if unit is MM else f"{unit.of(size):.9g}" for size in (width, height))
    return f'width="{wide}{unit.name}" height="{high}{unit.name}"'


def shape_of(shape: Circle | Polyline, height: float, digits: int) -> str:
    """The start of an element without its style, with `digits` decimals, y measured down from `height`, mm."""
    if isinstance(shape, Circle):
        c = shape.centre
        return f'<circle cx="{_n(c.real, digits)}" cy="{_n(height - c.imag, digits)}" r="{_n(shape.radius, digits)}"'
    z = np.asarray(shape.vertices)
    points = [f"{_n(x, digits)},{_n(height - y, digits)}" for x, y in zip(z.real.tolist(), z.imag.tolist())]
    bulges = shape.bulges
    if bulges is None:
        return f'<path d="M{" ".join(points)}{"Z" if shape.closed else ""}"'
    ends = points[1:] + points[:1] * shape.closed
    return f'<path d="M{points[0]}{"".join(_arcs(shape, bulges, ends, digits))}{"Z" if shape.closed else ""}"'


def _arcs(shape: Polyline, bulges: Real, ends: list[str], digits: int) -> list[str]:
    radii = 1 / np.where(bulges == 0, np.inf, np.abs(shape.curvature(np.arange(len(ends)) + 0.5)))
    steps = []
    for bulge, radius, end in zip(bulges.tolist(), radii.tolist(), ends):
        # No arc exceeds half a turn; with y down, counterclockwise is the format's negative sweep.
        steps.append(f"A{_n(radius, digits)} {_n(radius, digits)} 0 0 {int(bulge < 0)} {end}" if bulge else f"L{end}")
    return steps


def _n(value: float, digits: int) -> str:
    """Shortest decimal text of a number already rounded to `digits`."""
    text = f"{value:.{digits}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text


# Decimals of mm on paper; a thousandth is invisible.
DIGITS = 3
# Height of capitals over that of the font.
CAPITAL = 0.72


def sheet(job: Job) -> bytes:
    """The dimensioned drawing on paper; the title gives its scale."""
    page = dimensioned_drawing(job)
    colours = {name: _hexadecimal(rgb) for name, (_, rgb) in COLOURS.items()}
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" {svg_size(page.width, page.height, job.unit)} '
        f'viewBox="0 0 {page.width:g} {page.height:g}" fill="none" stroke-width="{STROKE}" '
        'font-family="sans-serif" style="background:#fff">',
        f"<title>{escape(harmless(job.name))}, the parts with their sizes</title>",
    ]
    lines_of_dimensions = [(DIM, line) for dimension in page.dimensions for line in dimension.lines]
    for layer, shape in (*page.shapes, *lines_of_dimensions):
        dashes = ' stroke-dasharray="4 1 1 1"' if layer == CENTRE else ""
        shape = rounded_shape(shape, DIGITS)
        lines.append(f'{shape_of(shape, page.height, DIGITS)} class="{layer}" stroke="{colours[layer]}"{dashes}/>')
    for text in (*page.texts, *(dimension.text for dimension in page.dimensions)):
        place = text.place.conjugate() + 1j * page.height + (0.5 if text.turned else 0.5j) * text.height
        place = rounded(place, DIGITS).item()
        anchor = "start" if text.starts else "end" if text.ends else "middle"
        turn = f' transform="rotate(-90 {place.real:g} {place.imag:g})"' if text.turned else ""
        lines.append(
            f'<text x="{place.real:g}" y="{place.imag:g}" font-size="{text.height / CAPITAL:.3g}" '
            f'text-anchor="{anchor}" fill="{colours[text.layer]}"{turn}>{escape(text.text)}</text>'
        )
    lines.append("</svg>\n")
    return "\n".join(lines).encode("utf-8", "replace")
