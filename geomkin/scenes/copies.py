"""Further ones of a linkage in its scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..linkage.motion import Motion
from ..part import Part
from ..plane.curve import Mirrored
from ..plane.vec import Complex, Whole
from ..scene import Scene, SceneBody, SceneMark
from .linkage import placed_bodies, traced_points


@dataclass(frozen=True, eq=False)
class Copied:
    """Where a copy is.

    rows: of the motion, one for each frame of the scene. mirror: x of the line in which it is mirrored, mm, or None.
    """

    motion: Motion
    rows: Whole
    mirror: float | None

    def place(self, z: Complex) -> Complex:
        """Places of the motion, (its frames,), as they are in the copy, (frames,)."""
        here = z[self.rows]
        return here if self.mirror is None else np.asarray(2 * self.mirror - np.conj(here), dtype=complex)

    def turn(self, direction: Complex) -> Complex:
        """The same of the directions of bodies, whose parts are turned over with them."""
        return direction[self.rows] if self.mirror is None else np.conj(direction[self.rows])

    def part(self, part: Part) -> Part:
        """A part as it is seen from the front of the copy."""
        if self.mirror is None:
            return part
        holes, marks = (tuple(Mirrored(curve) for curve in curves) for curves in (part.holes, part.marks))
        return replace(part, outline=Mirrored(part.outline), holes=holes, marks=marks)


def with_copies(scene: Scene, copies: Sequence[Copied], parts: Sequence[Part], layers: Mapping[str, int]) -> Scene:
    """A linkage's scene with further ones of it, one over the other along the shaft.

    parts: of one of them. layers: of its stack, by the plates' names; turned over, the lowest is the highest. Names
    of bodies are shown on the first only: on all of them they would hide the plates.
    """
    high = 1 + max(layers.values())
    bodies: list[SceneBody] = []
    marks: list[SceneMark] = []
    closed = scene.closed
    for number, copy in enumerate(copies, 1):
        named = f", copy {number + 1}"
        closed = closed & copy.motion.closed[copy.rows]
        for body in placed_bodies(copy.motion, parts, layers):
            layer = number * high + (body.layer if copy.mirror is None else high - 1 - body.layer)
            held = tuple(copy.part(part) for part in body.parts)
            place, turn = copy.place(np.asarray(body.origin)), copy.turn(np.asarray(body.direction))
            bodies.append(SceneBody(body.name + named, held, place, turn, layer, body.fixed, named=False))
        marks += [
            replace(mark, place=copy.place(mark.place), label=mark.label + named) for mark in traced_points(copy.motion)
        ]
    return replace(scene, closed=closed, bodies=(*scene.bodies, *bodies), marks=(*scene.marks, *marks))
