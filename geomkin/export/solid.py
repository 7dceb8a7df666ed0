"""Plates as solids of triangles, each watertight and of the volume that its sections give."""

from __future__ import annotations

import numpy as np

from ..errors import GeomkinError
from ..plane import region
from ..plane.vec import Complex, Real, Whole, xy
from .cut import Cut, signed_area
from .twisted import moving_triangles, twisted
from .twisted import volume as twisted_volume


def solid(cut: Cut) -> tuple[Real, Whole]:
    """Corners (n, 3), mm, from z = 0 up, and triangles (m, 3) of them, seen from outside counterclockwise.

    Raises GeomkinError rather than return a mesh that leaks or whose volume is not that of its sections: inverted hole
    walls pass for watertight.
    """
    loops = [_distinct(loop) for loop in _boundaries(cut)]
    if twist := cut.part.twist:
        points, faces = twisted(cut, twist, loops)
        expected = twisted_volume(cut, twist, loops)
    else:
        points, faces = _straight(loops, cut.part.thickness)
        # What the corners left out by rounding enclose is far below the tolerance, and not the mesh's fault.
        expected = sum(signed_area(loop) for loop in loops) * cut.part.thickness
    a, b, c = points[faces].swapaxes(0, 1)
    found = float(np.vecdot(np.cross(b - a, c - b), a).sum() / 6)
    if not _is_closed(faces, len(points)) or not np.isclose(found, expected, rtol=1e-6):
        raise GeomkinError(
            f"{cut.part.name}: its solid has volume {found:.6g} mm3 where {expected:.6g} is right; "
            "please report this with the recipe"
        )
    return points, faces


def triangles(cut: Cut) -> int:
    """About how many triangles the solid of a cut takes: two for each point of its walls, and those of both ends."""
    points = sum(len(loop.points) for loop in cut.loops)
    walls = moving_triangles(cut, cut.part.twist) if cut.part.twist else 2 * points
    return walls + 2 * points


def volume(cut: Cut) -> float:
    """Of the solid that is made of a cut, mm3."""
    twist = cut.part.twist
    return twisted_volume(cut, twist, _boundaries(cut)) if twist else cut.chord_area * cut.part.thickness


def _boundaries(cut: Cut) -> list[Complex]:
    """The loops with the material on their left."""
    return [loop.points if k == 0 else loop.points[::-1] for k, loop in enumerate(cut.loops)]


def _straight(loops: list[Complex], thickness: float) -> tuple[Real, Whole]:
    plane, lid = region.triangulate(loops)
    edges, count = _boundary(lid, len(plane)), len(plane)
    floor = np.column_stack([xy(plane), np.zeros(count)])
    points = np.concatenate([floor, floor + np.array([0.0, 0.0, thickness])])
    start, end = edges.T
    walls = np.stack([end + count, start + count, end, end, start + count, start], axis=1).reshape(-1, 3)
    return points, np.concatenate([lid[:, ::-1], lid + count, walls])


def _is_closed(faces: Whole, points: int) -> bool:
    """Whether each edge of a triangle is that of one other, which runs along it the other way."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    there, back = np.sort(start * points + end), np.sort(end * points + start)
    return bool((there == back).all() and (there[1:] != there[:-1]).all())


def _boundary(faces: Whole, points: int) -> Whole:
    """Edges (n, 2) that one triangle (m, 3) alone has, as it runs through them; empty where two run alike."""
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, first, met = np.unique(high * points + low, return_index=True, return_counts=True)
    run = np.sort(edges[:, 0] * points + edges[:, 1])
    alike = (run[1:] == run[:-1]).any()
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
