"""What a body's motion looks like at an instant, as it goes: inflection circle, curvature of a path, centrodes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from ..arguments import checked
from ..linkage.instant.curvature import path_curvature
from ..linkage.instant.inflection import bobillier, inflection_circle
from ..linkage.motion import Motion
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Mask, Real
from ..scene import Plot, Scene, SceneCurve, SceneMark
from ..table import Table
from .linkage import FARTHEST_CENTRE, linkage_scene

# Times as far as centres, which are left out beyond, that an inflection circle may reach: a larger one is a line.
LARGEST_CIRCLE = 100.0


@checked
def inflection_scene(motion: Motion, table: Table, body: str, point: complex) -> Scene:
    """A linkage with a body's inflection circle, and the centre of curvature of the path of a point of the body.

    table: of the motion's frames, with the columns `inflection_diameter`, `path_curvature`, and x and y of
    `centre_of_curvature` and `instant_centre`. point: mm in the body's own frame. What is far off or large beside the
    linkage, as it passes through infinity, is left out. Derived here.
    """
    circle, path = inflection_circle(motion, body), path_curvature(motion, body, point)
    reach = FARTHEST_CENTRE * float(np.max(motion.linkage.size))
    centre, pole = circle.instant_centre.position, circle.pole

    def near(z: Complex, radius: float = reach) -> Complex:
        with np.errstate(invalid="ignore"):
            return np.where(np.abs(z - path.position) < radius, z, np.nan)

    # Of a circle that passes near by, centre and pole may be far away.
    seen = np.isfinite(near(circle.nearest)) & np.isfinite(near(pole, LARGEST_CIRCLE * reach))
    middle = np.where(seen, (centre + pole) / 2, np.nan)
    centre, pole, bent = near(centre), near(pole), near(path.centre, reach / FARTHEST_CENTRE)
    half = circle.tangent * reach / 4
    marks = (
        SceneMark(
            "circle", middle, "inflection", "inflection circle", radius=np.where(seen, circle.diameter / 2, np.nan)
        ),
        SceneMark("point", centre, "centre", f"instant centre of the {body}"),
        SceneMark("point", pole, "inflection", "inflection pole"),
        SceneMark("line", centre - half, "inflection", "centrode tangent", vector=2 * half),
        SceneMark("line", centre, "inflection", "centrode normal", vector=pole - centre),
        SceneMark("point", bent, "wanted", "centre of curvature of the path"),
        SceneMark("line", bent, "wanted", "radius of curvature", vector=path.position - bent),
    )
    told = {column.name: column.header for column in table.columns}
    shown = {
        "curvature of the path": ("path_curvature",),
        "diameter of the inflection circle": ("inflection_diameter",),
        "centre of curvature, place": ("centre_of_curvature_x", "centre_of_curvature_y"),
        "instant centre, place": ("instant_centre_x", "instant_centre_y"),
    }
    plots = tuple(Plot(title, tuple(told[name] for name in names)) for title, names in shown.items())
    scene = linkage_scene(motion, _lengths_where(table, lambda length: np.abs(length) < reach))
    return replace(scene, marks=(*scene.marks, *marks, *_bobillier(motion, body, near)), plots=plots)


def _bobillier(motion: Motion, body: str, near: Callable[[Complex], Complex]) -> Iterator[SceneMark]:
    """Bobillier's construction from the body's first two pins: rays, their crossings, collineation axis and tangent.

    near: a place, or nan where it is too far away to be seen.
    """
    held = [z for name, z in motion.linkage.bodies[body].items() if name in motion.linkage.pins][:2]
    if len(held) < 2:
        return
    one, two = (path_curvature(motion, body, z) for z in held)
    found = bobillier(one, two)
    centre, crossing = near(found.instant_centre.position), near(found.crossing)

    def line(start: Complex, end: Complex, label: str) -> SceneMark:
        return SceneMark("line", start, "bobillier", label, vector=end - start)

    # Whole rays: from the instant centre to whichever of pin and pivot is farther away; and so the lines.
    for path in (one, two):
        yield line(centre, _farther(centre, path.position, near(path.centre)), "ray from the instant centre")
    for ends in ((one.position, two.position), (near(one.centre), near(two.centre))):
        yield line(crossing, _farther(crossing, *ends), "line to the crossing")
    yield SceneMark("point", crossing, "bobillier", "crossing of coupler and frame")
    yield line(centre, crossing, "collineation axis")
    # As far to both sides as the axis is long, so that the equal angles are seen beside each other.
    half = found.tangent * np.abs(crossing - centre)
    yield line(centre - half, centre + half, "centrode tangent")


def _farther(place: Complex, one: Complex, other: Complex) -> Complex:
    """Of two points the one farther from a place; the first where there is no other."""
    return np.where(np.abs(other - place) > np.abs(one - place), other, one)


@checked
def centrodes_scene(
    motion: Motion,
    table: Table,
    body: str,
    fixed: Iterable[AbstractCurve],
    moving: Iterable[AbstractCurve],
    centre: Complex,
) -> Scene:
    """A linkage with a body's centrodes: the moving one, on the body, rolls on the fixed one.

    table: of the motion's frames. fixed: on the ground, moving: in the body's own frame, mm, each in its runs. centre:
    the instant centre, in which they touch, (frames,), mm; nan where neither is drawn. Derived here.
    """
    curves = [SceneCurve(curve, "centrode", "fixed centrode") for curve in fixed]
    curves += [SceneCurve(curve, "centrode", "moving centrode", body) for curve in moving]
    scene = linkage_scene(motion, _lengths_where(table, lambda length: np.isfinite(centre)))
    touch = SceneMark("point", centre, "centrode", "instant centre")
    return replace(scene, curves=(*scene.curves, *curves), marks=(*scene.marks, touch))


def _lengths_where(table: Table, kept: Callable[[Real], Mask]) -> Table:
    """A table whose lengths are left out where they are not kept: near infinity nothing else would be seen in plots."""
    columns = (
        replace(c, values=np.where(kept(np.asarray(c.values)), c.values, np.nan)) if c.unit == "mm" else c
        for c in table.columns
    )
    return Table(tuple(columns))
