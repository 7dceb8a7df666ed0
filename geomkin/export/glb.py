"""GLB of the assembly, for viewers of solids: parts in place, each on its layer. Alone in loading trimesh."""

from __future__ import annotations

import re

import numpy as np
import trimesh

from ..plane.vec import Real
from .job import Job
from .mesh import solid, solid_cut
from .still import InPlace, in_place, palette

# From mm, z up, to what the format has: metres, y up.
UPRIGHT = 1e-3 * np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1e3]])


def write_glb(job: Job) -> dict[str, bytes]:
    """One file, named after the recipe."""
    return {f"{job.name}-assembly.glb": glb(job)}


def glb(job: Job) -> bytes:
    """The assembly: a node for each part, by its name, in the colour that pages give its body."""
    still, placed = in_place(job)
    assembly = trimesh.Scene(base_frame="assembly")
    for one in placed:
        points, faces = solid(solid_cut(one.part, job.tolerance))
        colour = np.array(_colour(palette()[still.tint(one.body)]), dtype=np.uint8)
        mesh = trimesh.Trimesh(points, faces, vertex_colors=np.tile(colour, (len(points), 1)), process=False)
        assembly.add_geometry(mesh, node_name=one.name, geom_name=one.name, transform=UPRIGHT @ _place(one))
    return bytes(trimesh.exchange.gltf.export_glb(assembly))  # type: ignore[no-untyped-call]


def _place(one: InPlace) -> Real:
    """From the part's frame to the assembly's, mm."""
    ahead, origin = one.direction, one.origin
    return np.array(
        [
            [ahead.real, -ahead.imag, 0, origin.real],
            [ahead.imag, ahead.real, 0, origin.imag],
            [0, 0, 1, one.height],
            [0, 0, 0, 1.0],
        ]
    )


def _colour(text: str) -> list[int]:
    """Red, green, blue and opacity of a colour as pages write it."""
    digits = re.sub("[^0-9a-f]", "", text)
    digits = digits if len(digits) == 6 else "".join(2 * c for c in digits)
    return [*bytes.fromhex(digits), 255]
