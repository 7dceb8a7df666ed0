"""Plates as solids: binary STL, watertight, its volume area times thickness. Alone in loading trimesh."""

from __future__ import annotations

import numpy as np
import trimesh

from ..errors import DesignError, GeomkinError, shown
from ..plane import region
from ..plane.vec import Complex, xy
from .cut import Cut, signed_area
from .job import Job


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
    mesh = trimesh.creation.extrude_triangulation(xy(points), faces, height=cut.part.thickness)
    # What the corners left out by rounding enclose is far below the tolerance, and not the mesh's fault.
    expected = sum(signed_area(loop) for loop in loops) * cut.part.thickness
    if not (mesh.is_watertight and np.isclose(mesh.volume, expected, rtol=1e-6)):
        raise GeomkinError(
            f"{cut.part.name}: its solid has volume {mesh.volume:.6g} mm3 where {expected:.6g} is right; "
            "please report this with the recipe"
        )
    return trimesh.exchange.stl.export_stl(mesh)


def _distinct(z: Complex) -> Complex:
    """The corners that the format's 24-bit numbers can tell from a straight line: others leave flat triangles."""
    finest = 4 * np.finfo(np.float32).eps * np.abs(z).max()
    z = z[np.abs(z - np.roll(z, 1)) > finest]
    before, after = np.roll(z, 1), np.roll(z, -1)
    straight = np.abs(np.imag((z - before) * np.conj(after - before))) <= finest * np.abs(after - before)
    # Of neighbours only one goes at a time, so that a gentle curve keeps its shape.
    kept: Complex = z[~(straight & ~np.roll(straight, 1))]
    return kept
