"""DXF read back by ezdxf. No other module of this package loads it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from ezdxf.filemanagement import readfile

from ..core.errors import with_article
from .drawing import Drawing, Line, UnreadableError, circle, collected, polyline

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
    lines = collected(_lines(entities, error, problems, unit))
    problems += _wrong_extents(document, lines, error, unit)
    return Drawing(lines, document.ezdxf_metadata().get("STAMP", ""), tuple(problems))


def _lines(entities: list[Any], error: float, problems: list[str], unit: float) -> Iterator[Line]:
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
