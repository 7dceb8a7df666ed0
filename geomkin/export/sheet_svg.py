"""SVG of the parts with their sizes, to look at, in mm of paper."""

from __future__ import annotations

from html import escape

from ..errors import harmless
from ..plane.vec import rounded
from .dimensioned import COLOURS, drawing
from .job import Job
from .svg import STROKE, shape_of

# Decimals of mm on paper: a thousandth is far below what is seen.
DIGITS = 3
# Height of capitals in that of a font.
CAPITAL = 0.72


def write(job: Job) -> dict[str, bytes]:
    """One file, named after the recipe."""
    return {f"{job.name}-sheet.svg": sheet(job)}


def sheet(job: Job) -> bytes:
    """The drawing on paper; its scale is told in the title."""
    made = drawing(job)
    colours = {name: "#{:02x}{:02x}{:02x}".format(*rgb) for name, (_, rgb) in COLOURS.items()}
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{made.width:g}mm" height="{made.height:g}mm" '
        f'viewBox="0 0 {made.width:g} {made.height:g}" fill="none" stroke-width="{STROKE}" '
        'font-family="sans-serif" style="background:#fff">',
        f"<title>{escape(harmless(job.name))}, the parts with their sizes</title>",
    ]
    for layer, shape in made.shapes:
        lines.append(f'{shape_of(shape, made.height, DIGITS)} class="{layer}" stroke="{colours[layer]}"/>')
    for text in made.texts:
        place: complex = rounded(text.place.conjugate() + 1j * made.height + 0.5j * text.height, DIGITS).item()
        anchor = "start" if text.starts else "middle"
        lines.append(
            f'<text x="{place.real:g}" y="{place.imag:g}" font-size="{text.height / CAPITAL:.3g}" '
            f'text-anchor="{anchor}" fill="{colours[text.layer]}">{escape(text.text)}</text>'
        )
    lines.append("</svg>\n")
    return "\n".join(lines).encode("utf-8", "replace")
