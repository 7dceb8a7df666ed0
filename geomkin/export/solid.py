"""Plates as solids of triangles, each watertight and of the volume that its area and thickness give."""

from __future__ import annotations

import numpy as np

from ..errors import GeomkinError
from ..plane import region
from ..plane.vec import Complex, Real, Whole, xy
from .cut import Cut, signed_area


def solid(cut: Cut) -> tuple[Real, Whole]:
    """Corners (n, 3), mm, from z = 0 up, and triangles (m, 3) of them, seen from outside counterclockwise.

    Raises GeomkinError rather than return a mesh that leaks or whose volume is not its area times its
    thickness: inverted hole walls pass for watertight.
    """
    loops = [_distinct(loop.points if k == 0 else loop.points[::-1]) for k, loop in enumerate(cut.loops)]
    plane, lid = region.triangulate(loops)
    edges, count = _boundary(lid, len(plane)), len(plane)
    floor = np.column_stack([xy(plane), np.zeros(count)])
    points = np.concatenate([floor, floor + np.array([0.0, 0.0, cut.part.thickness])])
    start, end = edges.T
    walls = np.stack([end + count, start + count, end, end, start + count, start], axis=1).reshape(-1, 3)
    faces = np.concatenate([lid[:, ::-1], lid + count, walls])
    a, b, c = points[faces].swapaxes(0, 1)
    volume = float(np.vecdot(np.cross(b - a, c - b), a).sum() / 6)
    # What the corners left out by rounding enclose is far below the tolerance, and not the mesh's fault.
    expected = sum(signed_area(loop) for loop in loops) * cut.part.thickness
    if len(edges) != sum(map(len, loops)) or not np.isclose(volume, expected, rtol=1e-6):
        raise GeomkinError(
            f"{cut.part.name}: its solid has volume {volume:.6g} mm3 where {expected:.6g} is right; "
            "please report this with the recipe"
        )
    return points, faces


def _boundary(faces: Whole, points: int) -> Whole:
    """Edges (n, 2) that one triangle (m, 3) alone has, as it runs through them; empty where two run alike."""
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, first, met = np.unique(high * points + low, return_index=True, return_counts=True)
    alike = len(np.unique(edges[:, 0] * points + edges[:, 1])) < len(edges)
    return edges[:0] if alike else edges[first[met == 1]]


def _distinct(z: Complex) -> Complex:
    """The corners that the format's 24-bit numbers can tell from a straight line: others leave flat triangles."""
    finest = 4 * np.finfo(np.float32).eps * np.abs(z).max()
    z = z[np.abs(z - np.roll(z, 1)) > finest]
    before, after = np.roll(z, 1), np.roll(z, -1)
    straight = np.abs(np.imag((z - before) * np.conj(after - before))) <= finest * np.abs(after - before)
    # Of neighbours only one goes at a time, so that a gentle curve keeps its shape.
    kept: Complex = z[~(straight & ~np.roll(straight, 1))]
    return kept
