"""A linkage with what is drawn as vectors beside it or on it: its polygons as it moves, a force on its ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from ..arguments import checked
from ..linkage.instant.polygons import polygon_parts, round_scale
from ..linkage.motion import Motion
from ..plane.vec import Complex
from ..scene import Plot, Role, Scene, SceneMark
from ..table import Table
from .linkage import LONGEST_ARROW, drawn_at, linkage_scene

# Room between the linkage and its polygons, as a share of its size.
GAP = 0.2
# Times the usual length from which sides of a polygon are left out, as they run off at a dead centre.
LONGEST_SIDE = 2.0

# N below which there is no arrow: no scale would show it, and one over it overflows.
NO_FORCE = 1e-200


@checked
def polygons_scene(motion: Motion, table: Table) -> Scene:
    """A linkage with its velocity and acceleration polygons beside it at each frame.

    table: of the motion's frames. The tips of the vectors from the poles leave trails, the hodographs of the points;
    each polygon is about as large as the linkage, at a round scale. Derived here.
    """
    scene = linkage_scene(motion, table)
    low, high = scene.box
    size = max(abs(high - low), float(np.max(motion.linkage.size)))
    drawn = []
    rates: tuple[tuple[str, Literal[1, 2], str], ...] = ("velocity", 1, "mm/s"), ("acceleration", 2, "mm/s2")
    for rate, order, unit in rates:
        sides = list(_sides(motion, order))
        ends = np.array([0j, *(z for _, _, tail, tip in sides for row in (tail, tip) for z in row[np.isfinite(row)])])
        if extent := float(max(np.ptp(ends.real), np.ptp(ends.imag))):
            scale = round_scale(extent, size)
            drawn.append((sides, scale * ends, scale, rate, drawn_at(scale, unit)))
    # One above the other: side by side they would be small where a screen is narrow.
    tall = sum(float(np.ptp(ends.imag)) for _, ends, *_ in drawn) + GAP * size * (len(drawn) - 1)
    marks, left, top = list(scene.marks), high.real + GAP * size, (low.imag + high.imag + tall) / 2
    for sides, ends, scale, rate, words in drawn:
        marks += _polygon(sides, complex(left - ends.real.min(), top - ends.imag.max()), scale, rate, words)
        top -= float(np.ptp(ends.imag)) + GAP * size
    return replace(scene, marks=tuple(marks))


def _sides(motion: Motion, order: Literal[1, 2]) -> Iterator[tuple[str, str, Complex, Complex]]:
    """Kind, name of the end, tail and tip, (frames,), mm/s or mm/s2 from the pole; nan where they run off."""
    parts, _, _ = polygon_parts(motion, order, slice(None))
    lengths = [np.abs(part.tip) for part in parts]
    finite = [row[np.isfinite(row)] for row in lengths]
    usual = max((float(np.percentile(row, 95)) for row in finite if row.size), default=0.0)
    for part, length in zip(parts, lengths):
        with np.errstate(invalid="ignore"):
            kept = length <= LONGEST_SIDE * usual
        tail, tip = (np.where(kept, z, np.nan) for z in (part.tail, part.tip))
        yield part.kind, part.end, tail, tip


def _polygon(
    sides: list[tuple[str, str, Complex, Complex]], pole: complex, scale: float, rate: str, words: str
) -> Iterator[SceneMark]:
    """What the recipe is for, and so in the accent of what is traced; the sides between tips have no names."""
    for kind, name, tail, tip in sides:
        if not np.nanmax(np.abs(tip - tail), initial=0.0):
            continue
        start, side = pole + scale * tail, scale * (tip - tail)
        if kind == "absolute":
            yield SceneMark("vector", start, "traced", f"{rate[0]} {name}, {words}", vector=side)
            yield SceneMark("point", start + side, "traced", trail=True)
        else:
            yield SceneMark("line", start, "traced", vector=side)


@checked
def force_scene(
    scene: Scene, place: complex, forces: Mapping[Role, Complex], what: Mapping[Role, str], plots: tuple[Plot, ...]
) -> Scene:
    """A scene with forces at a place on the ground, mm, and plots of them before its own.

    forces: over the frames, (frames,) complex, N, by the role that each is drawn in; all at one scale. what: in words,
    by role. Derived here.
    """
    low, high = scene.box
    largest = max((float(np.nanmax(np.abs(force), initial=0.0)) for force in forces.values()), default=0.0)
    if largest < NO_FORCE:
        return replace(scene, plots=plots)
    scale = LONGEST_ARROW * abs(high - low) / largest
    at = np.full(len(scene.time), place)
    marks = tuple(
        SceneMark("vector", at, role, f"{what[role]}, {drawn_at(scale, 'N')}", vector=force * scale)
        for role, force in forces.items()
    )
    return replace(scene, marks=(*scene.marks, *marks), plots=plots)
