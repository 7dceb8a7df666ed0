"""Solids of an assembly where they stand: turned and placed as the scene has them, each layer on those below it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..brief import one_line
from ..part import Part
from ..scene import Scene, SceneBody
from .job import Job
from .still import Still, frame_at


@dataclass(frozen=True, eq=False)
class InPlace:
    """A part where it stands.

    name: of the part, with a number where another has it; body: that it belongs to. origin, mm, and direction, a unit
    complex number: of the part's frame in the assembly's; height: of its lower face, mm.
    """

    name: str
    part: Part
    body: SceneBody
    origin: complex
    direction: complex
    height: float

    __repr__ = one_line


def in_place(job: Job) -> tuple[Still, tuple[InPlace, ...]]:
    """The assembly as it stands where the job wants its driver, and its parts, body by body."""
    scene = job.scene
    still = Still(scene, np.array([frame_at(scene, job.assembly_at)]))
    heights, names, found = _heights(scene), list[str](), list[InPlace]()
    for body in scene.bodies:
        origin, direction = (
            complex(np.broadcast_to(row, scene.closed.shape)[still.frame]) for row in (body.origin, body.direction)
        )
        for part in body.parts:
            name = f"{part.name} {names.count(part.name) + 1}" if part.name in names else part.name
            names.append(part.name)
            found.append(InPlace(name, part, body, origin, direction, heights[body.layer]))
    return still, tuple(found)


def _heights(scene: Scene) -> dict[int, float]:
    """Height of the lower face of each layer, mm: the lowest that has a part stands on 0, each is as thick as its
    thickest part, and one that stays empty as the thickest of all.
    """
    thick: dict[int, float] = {}
    for body in scene.bodies:
        for part in body.parts:
            thick[body.layer] = max(part.thickness, thick.get(body.layer, 0.0))
    heights, height = dict[int, float](), 0.0
    for layer in range(min(thick, default=0), max(thick, default=-1) + 1):
        heights[layer] = height
        height += thick.get(layer, max(thick.values()))
    return heights
