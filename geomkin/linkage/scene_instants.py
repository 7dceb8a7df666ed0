"""Scenes of a body's motion at each instant: inflection circle, curvature of a path, centrodes, polygons, forces."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from ..core.arguments import checked
from ..model.scene import Plot, Role, Scene, SceneCurve, SceneMark, drawn_at
from ..model.table import Table
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Mask, Real
from .instant.curvature import path_curvature
from .instant.inflection import bobillier, inflection_circle
from .instant.polygons import polygon_parts, round_scale
from .motion import Motion
from .scene import FARTHEST_CENTRE, LONGEST_ARROW, linkage_scene, place_plot, with_components

# Size of an inflection circle, relative to the largest distance of a drawn centre, beyond which it is omitted.
LARGEST_CIRCLE = 100.0


@checked
def inflection_scene(motion: Motion, table: Table, body: str, point: complex) -> Scene:
    """A linkage with a body's inflection circle and the centre of curvature of the path of one of its points.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    table : Table
        Of the motion's frames, with the columns `inflection_diameter`, `path_curvature`, and x and y of
        `centre_of_curvature` and `instant_centre`.
    body : str
        Name of the body.
    point : complex
        The point, mm in the body's frame.

    Returns
    -------
    Scene
        Marks that are far away or very large, as they pass through infinity, are omitted.

    Notes
    -----
    Derived here.
    """
    circle, path = inflection_circle(motion, body), path_curvature(motion, body, point)
    farthest = FARTHEST_CENTRE * float(np.max(motion.linkage.size))
    centre, pole = circle.instant_centre.position, circle.pole

    def near(z: Complex, radius: float = farthest) -> Complex:
        with np.errstate(invalid="ignore"):
            return np.where(np.abs(z - path.position) < radius, z, np.nan)

    # A circle may pass nearby although its centre and pole are far away.
    visible = np.isfinite(near(circle.nearest)) & np.isfinite(near(pole, LARGEST_CIRCLE * farthest))
    middle = np.where(visible, (centre + pole) / 2, np.nan)
    centre, pole, path_centre = near(centre), near(pole), near(path.centre, farthest / FARTHEST_CENTRE)
    half = circle.tangent * farthest / 4
    marks = (
        SceneMark(
            "circle", middle, "inflection", "inflection circle", radius=np.where(visible, circle.diameter / 2, np.nan)
        ),
        SceneMark("point", centre, "centre", f"instant centre of the {body}"),
        SceneMark("point", pole, "inflection", "inflection pole"),
        SceneMark("line", centre - half, "inflection", "centrode tangent", vector=2 * half),
        SceneMark("line", centre, "inflection", "centrode normal", vector=pole - centre),
        SceneMark("point", path_centre, "wanted", "centre of curvature of the path"),
        SceneMark("line", path_centre, "wanted", "radius of curvature", vector=path.position - path_centre),
    )
    plotted = {
        "curvature of the path": ("path_curvature",),
        "diameter of the inflection circle": ("inflection_diameter",),
        "centre of curvature, place": ("centre_of_curvature_x", "centre_of_curvature_y"),
        "instant centre, place": ("instant_centre_x", "instant_centre_y"),
    }
    plots = tuple(Plot(title, ids) for title, ids in plotted.items())
    scene = linkage_scene(motion, _lengths_where(table, lambda length: np.abs(length) < farthest))
    return replace(scene, marks=(*scene.marks, *marks, *_bobillier(motion, body, near)), plots=plots)


def _bobillier(motion: Motion, body: str, near: Callable[[Complex], Complex]) -> Iterator[SceneMark]:
    """Bobillier's construction from the body's first two pins: rays, crossings, collineation axis and tangent.

    near: a position, or nan if it is too far away to be drawn.
    """
    pins = [z for name, z in motion.linkage.bodies[body].items() if name in motion.linkage.pins][:2]
    if len(pins) < 2:
        return
    one, two = (path_curvature(motion, body, z) for z in pins)
    construction = bobillier(one, two)
    centre, crossing = near(construction.instant_centre.position), near(construction.crossing)

    def line(start: Complex, end: Complex, label: str) -> SceneMark:
        return SceneMark("line", start, "bobillier", label, vector=end - start)

    # Rays from the instant centre to the farther one of pin and pivot; the lines likewise.
    for path in (one, two):
        yield line(centre, _farther(centre, path.position, near(path.centre)), "ray from the instant centre")
    for ends in ((one.position, two.position), (near(one.centre), near(two.centre))):
        yield line(crossing, _farther(crossing, *ends), "line to the crossing")
    yield SceneMark("point", crossing, "bobillier", "crossing of coupler and frame")
    yield line(centre, crossing, "collineation axis")
    # As long on both sides as the axis, so that the equal angles can be compared.
    half = construction.tangent * np.abs(crossing - centre)
    yield line(centre - half, centre + half, "centrode tangent")


def _farther(place: Complex, one: Complex, other: Complex) -> Complex:
    """The point farther from a place; the first if there is no other."""
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

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    table : Table
        Of the motion's frames.
    body : str
        Name of the body.
    fixed, moving : iterable of AbstractCurve
        The centrodes in their runs, on the ground and in the body's frame, mm.
    centre : array of complex, shape (frames,)
        The instant centre, at which they touch, mm; nan where neither is drawn.

    Returns
    -------
    Scene

    Notes
    -----
    Derived here.
    """
    curves = [SceneCurve(curve, "centrode", "fixed centrode") for curve in fixed]
    curves += [SceneCurve(curve, "centrode", "moving centrode", body) for curve in moving]
    plots = [place_plot("fixed_centrode"), place_plot("moving_centrode")]
    scene = linkage_scene(motion, _lengths_where(table, lambda length: np.isfinite(centre)), plots=plots)
    touch = SceneMark("point", centre, "centrode", "instant centre")
    return replace(scene, curves=(*scene.curves, *curves), marks=(*scene.marks, touch))


def _lengths_where(table: Table, kept: Callable[[Real], Mask]) -> Table:
    """A table without the lengths that are not kept: near infinity they would flatten all plots."""
    columns = (
        replace(c, values=np.where(kept(np.asarray(c.values)), c.values, np.nan)) if c.unit == "mm" else c
        for c in table.columns
    )
    return Table(tuple(columns))


# Room between the linkage and its polygons, as a share of its size.
GAP = 0.2
# Multiple of the typical length beyond which sides of a polygon are omitted, as near a dead centre.
LONGEST_SIDE = 2.0

# Force, N, below which no arrow is drawn, since its scale would overflow.
NO_FORCE = 1e-200


@checked
def polygons_scene(motion: Motion, table: Table, components: bool = False) -> Scene:
    """A linkage with its velocity and acceleration polygons at each frame.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    table : Table
        Of the motion's frames.
    components : bool
        Whether velocities and accelerations also have their components along and across each link.

    Returns
    -------
    Scene
        The tips of the vectors leave trails, the hodographs of the points. Each polygon is about as large as the
        linkage, at a round scale.

    Notes
    -----
    Derived here.
    """
    scene = linkage_scene(motion, table)
    if components:
        scene = with_components(scene, motion)
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
    # One above the other, since side by side they would be small on a narrow screen.
    tall = sum(float(np.ptp(ends.imag)) for _, ends, *_ in drawn) + GAP * size * (len(drawn) - 1)
    marks, left, top = list(scene.marks), high.real + GAP * size, (low.imag + high.imag + tall) / 2
    for sides, ends, scale, rate, words in drawn:
        marks += _polygon(sides, complex(left - ends.real.min(), top - ends.imag.max()), scale, rate, words)
        top -= float(np.ptp(ends.imag)) + GAP * size
    return replace(scene, marks=tuple(marks))


def _sides(motion: Motion, order: Literal[1, 2]) -> Iterator[tuple[str, str, Complex, Complex]]:
    """Kind, name of the end, tail and tip, (frames,), mm/s or mm/s2 from the pole; nan where they are too long."""
    parts, _, _ = polygon_parts(motion, order, slice(None))
    lengths = [np.abs(part.tip) for part in parts]
    finite = [row[np.isfinite(row)] for row in lengths]
    typical = max((float(np.percentile(row, 95)) for row in finite if row.size), default=0.0)
    for part, length in zip(parts, lengths):
        with np.errstate(invalid="ignore"):
            drawn = length <= LONGEST_SIDE * typical
        tail, tip = (np.where(drawn, z, np.nan) for z in (part.tail, part.tip))
        yield part.kind, part.end, tail, tip


def _polygon(
    sides: list[tuple[str, str, Complex, Complex]], pole: complex, scale: float, rate: str, words: str
) -> Iterator[SceneMark]:
    """Marks of a polygon in the colour of traced points; only vectors from the pole have labels."""
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
    """A scene with forces at a point of the ground, and plots of them before its own.

    Parameters
    ----------
    scene : Scene
        The scene.
    place : complex
        Point on the ground, mm.
    forces : mapping of role to array of complex, shape (frames,)
        N; all are drawn at one scale.
    what : mapping of role to str
        Labels of the forces.
    plots : tuple of Plot
        Plots of the forces.

    Returns
    -------
    Scene

    Notes
    -----
    Derived here.
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
