"""Plates as solids: binary STL, watertight, its volume area times thickness. Alone in loading trimesh."""

from __future__ import annotations

import numpy as np
import trimesh

from ..errors import GeomkinError
from ..plane import region
from ..plane.vec import xy
from .cut import Cut, polygon_area


def stl(cut: Cut) -> bytes:
    """The part as a binary STL, mm, standing on z = 0.

    Raises GeomkinError rather than return a mesh that leaks or whose volume is not its area times its
    thickness: inverted hole walls pass for watertight.
    """
    loops = [loop.points if k == 0 else loop.points[::-1] for k, loop in enumerate(cut.loops)]
    points, faces = region.triangulate(loops)
    mesh = trimesh.creation.extrude_triangulation(xy(points), faces, height=cut.part.thickness)
    expected = polygon_area(cut) * cut.part.thickness
    if not (mesh.is_watertight and np.isclose(mesh.volume, expected, rtol=1e-6)):
        raise GeomkinError(
            f"{cut.part.name}: its solid has volume {mesh.volume:.6g} mm3 where {expected:.6g} is right; "
            "please report this with the recipe"
        )
    return trimesh.exchange.stl.export_stl(mesh)
