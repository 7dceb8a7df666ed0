"""GLB of the assembly for 3D viewers: parts in place, each in its layer. The only module for GLB that loads trimesh."""

from __future__ import annotations

import numpy as np
import trimesh

from ..plane.vec import Real
from .job import Job
from .mesh import solid, solid_cut
from .still import InPlace, in_place, rgb

# From mm, z up, to the format's metres, y up.
UPRIGHT = 1e-3 * np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1e3]])


def glb(job: Job) -> bytes:
    """The assembly: a node for each part, with its name, in the colour of its body on pages."""
    still, placements = in_place(job)
    assembly = trimesh.Scene(base_frame="assembly", metadata={"stamp": job.stamp} if job.stamp else None)
    for placement in placements:
        points, faces = solid(solid_cut(placement.part, job.tolerance))
        colour = np.array([*rgb(still.tint(placement.body)), 255], dtype=np.uint8)
        mesh = trimesh.Trimesh(points, faces, vertex_colors=np.tile(colour, (len(points), 1)), process=False)
        assembly.add_geometry(
            mesh, node_name=placement.name, geom_name=placement.name, transform=UPRIGHT @ _place(placement)
        )
    return bytes(trimesh.exchange.gltf.export_glb(assembly))  # type: ignore[no-untyped-call]


def _place(placement: InPlace) -> Real:
    """Transform from the part's frame to the assembly's, mm."""
    direction, origin = placement.direction, placement.origin
    return np.array(
        [
            [direction.real, -direction.imag, 0, origin.real],
            [direction.imag, direction.real, 0, origin.imag],
            [0, 0, 1, placement.height],
            [0, 0, 0, 1.0],
        ]
    )
