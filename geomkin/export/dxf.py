"""DXF: polylines and true circles in mm, one layer per cutting operation. The only module that loads ezdxf."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from ezdxf import options, units  # type: ignore[attr-defined]  # documented, though not exported
from ezdxf.document import Drawing
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new
from ezdxf.layouts.layout import Modelspace

from ..plane.primitives import Circle, Polyline
from ..plane.vec import rounded
from .cut import LAYERS, decimals
from .dimensioned import COLOURS, dimensioned_drawing
from .job import Job
from .layout import Sheet
from .text import Text


def write_dxf(job: Job) -> dict[str, bytes]:
    """All parts in one file, or one for each sheet."""
    return job.sheet_files("dxf", lambda sheet: dxf(sheet, job.stamp))


def dxf(sheet: Sheet, stamp: str = "") -> bytes:
    """The sheet as a DXF file, AC1015 (R2000): the first version with units, readable by every program.

    The same sheet gives the same bytes.
    """
    shapes = [(loop.layer, loop.shape) for placed in sheet.placed for loop in placed.loops]
    return drawn(LAYERS, shapes, (), sheet.extents, (0j, complex(sheet.width, sheet.height)), stamp)


def drawn(
    layers: Mapping[str, tuple[int, tuple[int, int, int]]],
    shapes: Iterable[tuple[str, Circle | Polyline]],
    texts: Iterable[Text],
    extents: tuple[complex, complex],
    limits: tuple[complex, complex],
    stamp: str = "",
) -> bytes:
    """A DXF file of shapes and texts on their layers.

    `layers` maps names to colour index and RGB; `extents` and `limits` are the corners of the shapes and of the paper,
    mm. The stamp is in the dictionary EZDXF_META.
    """
    with _fixed_stamps():
        # The library's default is metres, and programs would read the file 1000 times too large.
        document = new("R2000", units=units.MM)
        document.header["$MEASUREMENT"] = 1
        if stamp:
            document.ezdxf_metadata()["STAMP"] = stamp
        # Without a plot scale one program prints a blank page.
        document.header["$PSVPSCALE"] = 1.0
        for name, (index, rgb) in layers.items():
            document.layers.add(name, color=index).rgb = rgb
        space = document.modelspace()
        for layer, shape in shapes:
            _add(space, layer, shape)
        for text in texts:
            # In the format two per cent signs start a code.
            words = text.text.replace("%%", "% %")
            entity = space.add_text(words, height=text.height, dxfattribs={"layer": text.layer})
            align = TextEntityAlignment.MIDDLE_LEFT if text.starts else TextEntityAlignment.MIDDLE_CENTER
            entity.set_placement((text.place.real, text.place.imag), align=align)
        # The library copies these from the layout to the header when it writes.
        low, high = extents
        space.reset_extents((low.real, low.imag, 0.0), (high.real, high.imag, 0.0))
        space.reset_limits((limits[0].real, limits[0].imag), (limits[1].real, limits[1].imag))
        return _bytes(document)


def _add(space: Modelspace, layer: str, shape: Circle | Polyline) -> None:
    attributes = {"layer": layer}
    if isinstance(shape, Circle):
        space.add_circle((shape.centre.real, shape.centre.imag), shape.radius, dxfattribs=attributes)
        return
    vertices = np.asarray(shape.vertices)
    polyline = space.add_lwpolyline([], close=shape.closed, dxfattribs=attributes)
    rows = np.zeros((len(vertices), 5))  # x, y, start width, end width, bulge
    rows[:, 0], rows[:, 1] = vertices.real, vertices.imag
    if shape.bulges is not None:
        rows[:, 4] = shape.bulges
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
    """Suppress time stamps and random identifiers, which differ between runs."""
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def sheet(job: Job) -> bytes:
    """The dimensioned drawing on paper; the title gives its scale."""
    page, digits = dimensioned_drawing(job), decimals(job.tolerance)
    shapes = [(layer, _rounded(shape, digits)) for layer, shape in page.shapes]
    texts = [replace(text, place=rounded(text.place, digits).item()) for text in page.texts]
    paper = 0j, complex(page.width, page.height)
    return drawn(COLOURS, shapes, texts, paper, paper)


def _rounded(shape: Circle | Polyline, digits: int) -> Circle | Polyline:
    if isinstance(shape, Circle):
        return Circle(rounded(shape.centre, digits).item(), rounded(shape.radius, digits).item())
    return Polyline(rounded(shape.vertices, digits), shape.bulges, shape.closed)
