"""Plates as solids: binary STL, watertight, its volume area times thickness."""

from __future__ import annotations

import numpy as np

from ..core.progress import report
from .cut import Cut
from .job import Job
from .mesh import solid, triangles

# A triangle in the format: single-precision numbers, then two unused bytes.
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER = 80
# Size in bytes from which a file is announced before it is written, since it takes seconds.
LARGE = 10_000_000


def write_stl(job: Job) -> dict[str, bytes]:
    """One file per part, named after it; the progress of large ones is reported."""

    def write(cut: Cut) -> bytes:
        size = HEADER + 4 + TRIANGLE.itemsize * triangles(cut)
        if size < LARGE:
            return stl(cut, job.stamp)
        name = f"{cut.part.name}.stl"
        report(0.0, f"{name}, about {size / 1e6:.0f} MB")
        content = stl(cut, job.stamp)
        report(1.0, name)
        return content

    return job.part_files("stl", job.solids, write)


def stl(cut: Cut, stamp: str = "") -> bytes:
    """The part as a binary STL, mm, with its lower face at z = 0 and the stamp in the file's header."""
    points, faces = solid(cut)
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1])
    records = np.zeros(len(corners), dtype=TRIANGLE)
    records["normal"], records["corners"] = normals / np.sqrt(np.vecdot(normals, normals))[:, None], corners
    header = stamp.encode("ascii", "replace").ljust(HEADER, b"\0")[:HEADER] + len(records).to_bytes(4, "little")
    return header + records.tobytes()
