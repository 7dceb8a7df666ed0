"""DXF for cutting: polylines and true circles, in mm, one layer per operation. Alone in loading ezdxf."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from ezdxf import options, units  # type: ignore[attr-defined]  # not told to be public, but documented
from ezdxf.document import Drawing
from ezdxf.filemanagement import new
from ezdxf.layouts.layout import Modelspace

from ..plane.primitives import Circle
from .cut import Loop
from .job import Job
from .layout import LAYERS, Sheet


def write(job: Job) -> dict[str, bytes]:
    """All parts in one file."""
    return {f"{job.name}.dxf": dxf(job.sheet)}


def dxf(sheet: Sheet) -> bytes:
    """The sheet as a DXF file, AC1015 (R2000): the first version with units, which every reader knows.

    The same sheet gives the same bytes.
    """
    with _fixed_stamps():
        return _bytes(_document(sheet))


def _document(sheet: Sheet) -> Drawing:
    # The library defaults to metres, which reading programs take at its word, 1000 times too large.
    document = new("R2000", units=units.MM)
    document.header["$MEASUREMENT"] = 1
    # Without a plot scale one reading program prints a blank page.
    document.header["$PSVPSCALE"] = 1.0
    for name, (index, rgb) in LAYERS.items():
        document.layers.add(name, color=index).rgb = rgb
    space = document.modelspace()
    for placed in sheet.placed:
        for loop in placed.loops:
            _add(space, loop)
    # The library fills the header from the layout when it writes.
    low, high = sheet.extents
    space.reset_extents((low.real, low.imag, 0.0), (high.real, high.imag, 0.0))
    space.reset_limits((0.0, 0.0), (sheet.width, sheet.height))
    return document


def _add(space: Modelspace, loop: Loop) -> None:
    attributes = {"layer": loop.layer}
    if isinstance(loop.shape, Circle):
        centre = loop.shape.centre
        space.add_circle((centre.real, centre.imag), loop.shape.radius, dxfattribs=attributes)
        return
    vertices = np.asarray(loop.shape.vertices)
    polyline = space.add_lwpolyline([], close=loop.shape.closed, dxfattribs=attributes)
    rows = np.zeros((len(vertices), 5))  # x, y, start width, end width, bulge
    rows[:, 0], rows[:, 1] = vertices.real, vertices.imag
    if loop.shape.bulges is not None:
        rows[:, 4] = loop.shape.bulges
    # Points given one by one are appended in quadratic time: 19 s for 1e5 of them, against 0.9 s.
    polyline.lwpoints.values = rows


def _bytes(document: Drawing) -> bytes:
    # The order of a set would make every run differ.
    for name in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(name)
    stream = io.StringIO()
    document.write(stream)
    return document.encode(stream.getvalue())


@contextmanager
def _fixed_stamps() -> Iterator[None]:
    """Without it, time stamps and random identifiers would make every run differ."""
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before
