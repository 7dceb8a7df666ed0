"""DXF of the parts with their sizes, to look at: nothing on a cutting layer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, rounded
from .cut import decimals
from .dimensioned import COLOURS, drawing
from .dxf import drawn
from .job import Job


def write(job: Job) -> dict[str, bytes]:
    """One file, named after the recipe."""
    return {f"{job.name}-sheet.dxf": sheet(job)}


def sheet(job: Job) -> bytes:
    """The drawing on paper; its scale is told in the title."""
    made, digits = drawing(job), decimals(job.tolerance)
    shapes = [(layer, _rounded(shape, digits)) for layer, shape in made.shapes]
    # Two signs of per cent begin a code in the format.
    texts = [
        replace(text, text=text.text.replace("%%", "% %"), place=rounded(text.place, digits).item())
        for text in made.texts
    ]
    paper = 0j, complex(made.width, made.height)
    return drawn(COLOURS, shapes, texts, paper, paper)


def _rounded(shape: Circle | Polyline, digits: int) -> Circle | Polyline:
    if isinstance(shape, Circle):
        return Circle(rounded(shape.centre, digits).item(), rounded(shape.radius, digits).item())
    vertices: Complex = np.asarray(shape.vertices)
    return Polyline(rounded(vertices, digits), shape.bulges, shape.closed)
