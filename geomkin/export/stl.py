"""Plates as solids: binary STL, watertight, its volume area times thickness."""

from __future__ import annotations

import numpy as np

from ..errors import DesignError, GeomkinError, shown
from ..plane import region
from ..plane.vec import Complex, Real, Whole, xy
from .cut import Cut, signed_area
from .job import Job

# A triangle as the format has it: numbers of 24 bits, then two bytes without a meaning.
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write(job: Job) -> dict[str, bytes]:
    """A file for each part, named after it."""
    contents: dict[str, bytes] = {}
    for cut in job.solids:
        name = f"{cut.part.name}.stl"
        if name in contents:
            raise DesignError("name", f"two parts are named {shown(cut.part.name)}", "give each a name of its own")
        contents[name] = stl(cut)
    return contents


def stl(cut: Cut) -> bytes:
    """The part as a binary STL, mm, standing on z = 0.

    Raises GeomkinError rather than return a mesh that leaks or whose volume is not its area times its
    thickness: inverted hole walls pass for watertight.
    """
    loops = [_distinct(loop.points if k == 0 else loop.points[::-1]) for k, loop in enumerate(cut.loops)]
    points, faces = region.triangulate(loops)
    edges = _boundary(faces, len(points))
    corners = _solid(xy(points), faces, edges, cut.part.thickness)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1])
    volume = float(np.vecdot(normals, corners[:, 0]).sum() / 6)
    # What the corners left out by rounding enclose is far below the tolerance, and not the mesh's fault.
    expected = sum(signed_area(loop) for loop in loops) * cut.part.thickness
    if len(edges) != sum(map(len, loops)) or not np.isclose(volume, expected, rtol=1e-6):
        raise GeomkinError(
            f"{cut.part.name}: its solid has volume {volume:.6g} mm3 where {expected:.6g} is right; "
            "please report this with the recipe"
        )
    told = np.zeros(len(corners), dtype=TRIANGLE)
    told["normal"], told["corners"] = normals / np.sqrt(np.vecdot(normals, normals))[:, None], corners
    header = bytes(80) + len(told).to_bytes(4, "little")
    return header + told.tobytes()


def _boundary(faces: Whole, points: int) -> Whole:
    """Edges (n, 2) that one triangle (m, 3) alone has, as it runs through them; empty where two run alike."""
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, first, met = np.unique(high * points + low, return_index=True, return_counts=True)
    alike = len(np.unique(edges[:, 0] * points + edges[:, 1])) < len(edges)
    return edges[:0] if alike else edges[first[met == 1]]


def _solid(points: Real, faces: Whole, edges: Whole, height: float) -> Real:
    """Corners (m, 3, 3) of all triangles, seen from outside counterclockwise: floor, roof, and walls on the edges."""
    floor = np.column_stack([points, np.zeros(len(points))])
    roof = floor + np.array([0.0, 0.0, height])
    start, end = floor[edges[:, 0]], floor[edges[:, 1]]
    above, beyond = roof[edges[:, 0]], roof[edges[:, 1]]
    walls = np.stack([beyond, above, end, end, above, start], axis=1).reshape(-1, 3, 3)
    return np.concatenate([floor[faces[:, ::-1]], roof[faces], walls])


def _distinct(z: Complex) -> Complex:
    """The corners that the format's 24-bit numbers can tell from a straight line: others leave flat triangles."""
    finest = 4 * np.finfo(np.float32).eps * np.abs(z).max()
    z = z[np.abs(z - np.roll(z, 1)) > finest]
    before, after = np.roll(z, 1), np.roll(z, -1)
    straight = np.abs(np.imag((z - before) * np.conj(after - before))) <= finest * np.abs(after - before)
    # Of neighbours only one goes at a time, so that a gentle curve keeps its shape.
    kept: Complex = z[~(straight & ~np.roll(straight, 1))]
    return kept
