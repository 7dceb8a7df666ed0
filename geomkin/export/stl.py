"""Plates as solids: binary STL, watertight, its volume area times thickness."""

from __future__ import annotations

import numpy as np

from ..core.errors import DesignError, shown
from ..core.progress import report
from .cut import Cut
from .job import Job
from .mesh import solid, triangles

# A triangle in the format: single-precision numbers, then two unused bytes.
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER = bytes(80)
# Size in bytes from which a file is announced before it is written, since it takes seconds.
LARGE = 10_000_000


def write_stl(job: Job) -> dict[str, bytes]:
    """One file per part, named after it."""
    contents: dict[str, bytes] = {}
    for cut in job.solids:
        name = f"{cut.part.name}.stl"
        if name in contents:
            raise DesignError(
                "name", f"two parts are named {shown(cut.part.name)}", "give each a name of its own", "conflict"
            )
        if (size := len(HEADER) + 4 + TRIANGLE.itemsize * triangles(cut)) >= LARGE:
            report(0.0, f"{name}, about {size / 1e6:.0f} MB")
        contents[name] = stl(cut)
        if size >= LARGE:
            report(1.0, name)
    return contents


def stl(cut: Cut) -> bytes:
    """The part as a binary STL, mm, with its lower face at z = 0."""
    points, faces = solid(cut)
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1])
    records = np.zeros(len(corners), dtype=TRIANGLE)
    records["normal"], records["corners"] = normals / np.sqrt(np.vecdot(normals, normals))[:, None], corners
    header = HEADER + len(records).to_bytes(4, "little")
    return header + records.tobytes()
