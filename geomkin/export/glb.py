"""GLB of the assembly, for viewers of solids: parts in place, each on its layer. Alone in loading trimesh."""

from __future__ import annotations

import re

import numpy as np
import trimesh

from ..part import Part
from ..plane.vec import Real
from ..scene import SceneBody
from .job import Job
from .solid import solid
from .still import Still, frame_at, palette
from .twisted import solid_cut

# From mm, z up, to what the format has: metres, y up.
UPRIGHT = 1e-3 * np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1e3]])


def write(job: Job) -> dict[str, bytes]:
    """One file, named after the recipe."""
    return {f"{job.name}-assembly.glb": glb(job)}


def glb(job: Job) -> bytes:
    """The assembly: a node for each part, by its name, in the colour that pages give its body."""
    still = Still(job.scene, np.array([frame_at(job.scene, job.assembly_at)]))
    assembly = trimesh.Scene(base_frame="assembly")
    names: list[str] = []
    for body in job.scene.bodies:
        for part in body.parts:
            points, faces = solid(solid_cut(part, job.tolerance))
            colours = np.tile(np.array(_colour(palette()[still.tint(body)]), dtype=np.uint8), (len(points), 1))
            mesh = trimesh.Trimesh(points, faces, vertex_colors=colours, process=False)
            name = f"{part.name} {names.count(part.name) + 1}" if part.name in names else part.name
            names.append(part.name)
            assembly.add_geometry(mesh, node_name=name, geom_name=name, transform=UPRIGHT @ _place(body, part, still))
    return bytes(trimesh.exchange.gltf.export_glb(assembly))  # type: ignore[no-untyped-call]


def _place(body: SceneBody, part: Part, still: Still) -> Real:
    """From the part's frame to the assembly's, mm, its layer as high as the sheets below it."""
    origin = complex(np.broadcast_to(body.origin, still.scene.closed.shape)[still.frame])
    ahead = complex(np.broadcast_to(body.direction, still.scene.closed.shape)[still.frame])
    return np.array(
        [
            [ahead.real, -ahead.imag, 0, origin.real],
            [ahead.imag, ahead.real, 0, origin.imag],
            [0, 0, 1, body.layer * part.thickness],
            [0, 0, 0, 1.0],
        ]
    )


def _colour(text: str) -> list[int]:
    """Red, green, blue and opacity of a colour as pages write it."""
    digits = re.sub("[^0-9a-f]", "", text)
    digits = digits if len(digits) == 6 else "".join(2 * c for c in digits)
    return [*bytes.fromhex(digits), 255]
