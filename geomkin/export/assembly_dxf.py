"""DXF of the assembly for viewing and measuring: exact parts at one driver position, none on a cutting layer."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..core.errors import harmless
from ..core.fields import to_digits
from ..core.names import folded_name
from ..model.scene import Scene, SceneMark
from ..plane.flatten import flatten
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, box_of, rounded
from .cut import cut, decimals, shape_box
from .dxf import drawn
from .job import Job
from .labels import LETTER, Name, place_labels
from .still import SCREEN, Still, frame_at, rgb
from .text import Text

# Layers besides those of bodies, which start with BODY, and their colours in the palette.
PINS, NAMES = "PINS", "NAMES"
COLOURS = {PINS: "line", NAMES: "ink", "TRACED": "traced", "WANTED": "wanted", "CONTACT": "acceleration"}
# Characters not allowed in names of layers.
FORBIDDEN = set('<>/\\":;?*=|,`')
# Colour index for programs without RGB: black on white, white on black.
EITHER = 7

Shape = tuple[str, Circle | Polyline]


def assembly_drawing(job: Job) -> bytes:
    """The drawing at full size: outlines with arcs on a layer for each body; paths, pins and names on others."""
    scene = job.scene
    still = Still(scene, np.array([frame_at(scene, job.assembly_at)]))
    layers = _layers(scene)
    shapes = [*_bodies(still, job.tolerance, layers), *_curves(still, job.tolerance), *_marks(still, job.tolerance)]
    names = place_labels(still)
    texts = [_text(name, still) for name in names]
    corners = [shape_box(shape) for _, shape in shapes]
    extents = box_of(np.array([*corners, *((name.place - name.half, name.place + name.half) for name in names)]))
    used = {layer for layer, _ in shapes} | {text.layer for text in texts}
    tints = {layer: still.tint(body) for body in scene.bodies for layer in [layers[body.name]]}
    colours = {layer: _colour(tints.get(layer, COLOURS.get(layer, "soft"))) for layer in sorted(used)}
    return drawn(colours, shapes, texts, extents, extents)


def _layers(scene: Scene) -> dict[str, str]:
    """The layer of each body by its name, all distinct, since layer names ignore case."""
    layers: dict[str, str] = {}
    for body in scene.bodies:
        plain = "".join("_" if c in FORBIDDEN or not c.isprintable() else c for c in body.name) or "body"
        layer, count = f"BODY {plain}", 1
        while folded_name(layer) in map(folded_name, layers.values()):
            count += 1
            layer = f"BODY {plain} {count}"
        layers[body.name] = layer
    return layers


def _colour(name: str) -> tuple[int, tuple[int, int, int]]:
    """A colour of the palette, with pale body tints darkened for lines."""
    darkening = 2 if name[0] == "t" and name[1:].isdigit() else 1
    red, green, blue = (channel // darkening for channel in rgb(name))
    return EITHER, (red, green, blue)


def _bodies(still: Still, tolerance: float, layers: dict[str, str]) -> Iterator[Shape]:
    k = still.frame
    for body in still.bodies:
        for part in body.parts:
            cut_part = cut(part, tolerance, arcs=True)
            for loop in (*cut_part.loops, *cut_part.marks):
                moved = loop.moved(complex(body.origin[k]), cut_part.digits, complex(body.direction[k]))
                yield layers[body.name], moved.shape


def _curves(still: Still, tolerance: float) -> Iterator[Shape]:
    poses, digits = {body.name: body for body in still.scene.bodies}, decimals(tolerance)
    for curve in still.scene.curves:
        points = flatten(curve.curve, max(tolerance, 0.1 * SCREEN * still.size))
        if body := poses.get(curve.body):
            points = body.origin[still.frame] + body.direction[still.frame] * points
        yield from _line(_layer(curve.role), points, digits, curve.curve.closed)


def _marks(still: Still, tolerance: float) -> Iterator[Shape]:
    for mark in still.marks:
        if mark.trail:
            for run in still.trail_runs(mark):
                yield from _line(_layer(mark.role), run, decimals(tolerance))
        yield from _mark(still, mark, tolerance)


def _mark(still: Still, mark: SceneMark, tolerance: float) -> Iterator[Shape]:
    k, px, digits = still.frame, still.pixel, decimals(tolerance)
    place = complex(mark.place[k])
    if not np.isfinite(place):
        return
    if mark.vector is not None:
        yield from _line(_layer(mark.role), np.array([place, place + mark.vector[k]]), digits)
        return
    if mark.sort == "slide" and mark.direction is not None:
        corners = px * np.array([-10 - 6.5j, 10 - 6.5j, 10 + 6.5j, -10 + 6.5j]) * complex(mark.direction[k])
        yield PINS, Polyline(rounded(place + corners, digits))
        return
    layer, radius = (PINS, still.hole_radii.get(mark, 3 * px)) if mark.sort.endswith("pin") else ("", 2.5 * px)
    if mark.radius is not None:
        radius = float(mark.radius[k])
    if radius > tolerance:
        yield layer or _layer(mark.role), Circle(rounded(place, digits).item(), radius)


def _layer(role: str) -> str:
    return role.upper()


def _line(layer: str, points: Complex, digits: int, closed: bool = False) -> Iterator[Shape]:
    """A line through points without repeats; none if it has a single point or is not finite."""
    points = rounded(points, digits)
    points = points[np.append(True, points[1:] != points[:-1])]
    points = points[:-1] if closed and points[-1] == points[0] else points
    if len(points) > 1 and np.isfinite(points).all():
        yield layer, Polyline(points, is_closed=closed)


def _text(name: Name, still: Still) -> Text:
    place, height = rounded(name.place, still.digits).item(), to_digits(0.72 * LETTER * still.pixel, 3)
    return Text(NAMES, harmless(name.text), place, height)
