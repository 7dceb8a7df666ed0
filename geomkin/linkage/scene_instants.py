"""What a body's motion looks like at an instant, as it goes: inflection circle, curvature of a path, centrodes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from ..core.arguments import checked
from ..model.roles import Role
from ..model.scene import Plot, Scene, SceneCurve, SceneMark
from ..model.table import Table
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Mask, Real
from .instant.curvature import path_curvature
from .instant.inflection import bobillier, inflection_circle
from .instant.polygons import polygon_parts, round_scale
from .motion import Motion
from .scene import FARTHEST_CENTRE, LONGEST_ARROW, drawn_at, linkage_scene, place_plot

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
    shown = {
        "curvature of the path": ("path_curvature",),
        "diameter of the inflection circle": ("inflection_diameter",),
        "centre of curvature, place": ("centre_of_curvature_x", "centre_of_curvature_y"),
        "instant centre, place": ("instant_centre_x", "instant_centre_y"),
    }
    plots = tuple(Plot(title, ids) for title, ids in shown.items())
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
    plots = [place_plot("fixed_centrode"), place_plot("moving_centrode")]
    scene = linkage_scene(motion, _lengths_where(table, lambda length: np.isfinite(centre)), plots=plots)
    touch = SceneMark("point", centre, "centrode", "instant centre")
    return replace(scene, curves=(*scene.curves, *curves), marks=(*scene.marks, touch))


def _lengths_where(table: Table, kept: Callable[[Real], Mask]) -> Table:
    """A table whose lengths are left out where they are not kept: near infinity nothing else would be seen in plots."""
    columns = (
        replace(c, values=np.where(kept(np.asarray(c.values)), c.values, np.nan)) if c.unit == "mm" else c
        for c in table.columns
    )
    return Table(tuple(columns))


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
