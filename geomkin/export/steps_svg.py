"""SVG of the order of assembly, to print: a picture of each layer, its parts coloured over those already in place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from html import escape
from textwrap import wrap

import numpy as np

from ..core.errors import harmless
from ..core.records import record
from ..model.scene import Scene, SceneBody, layer_name
from ..plane.vec import box_of, rounded
from .job import Job
from .labels import LETTER, NARROW, place_labels
from .picture import MARGIN, items, style, svg_document, transform
from .still import PIXELS, Still, frame_at, some_points
from .svg_path import decimal

# Number of pictures in a row.
COLUMNS = 4
# Height of a line of the heading above a picture, in pixels, and the number of lines reserved.
LINE, LINES = 15.0, 2
# Opacity of parts that are already in place.
FAINT = 0.25


@record(eq=False)
class LayerPicture:
    """A picture of the parts up to a layer.

    Parameters
    ----------
    still : Still
        The bodies that are assembled together, one for each part.
    layer : int
        The layer whose parts are to be added.
    heading : str
        The layer and its parts.
    """

    still: Still
    layer: int
    heading: str

    @cached_property
    def texts(self) -> tuple[tuple[str, complex], ...]:
        """Names of the parts of the layer and letters of their holes, each with the place of its middle, mm."""
        k, still = self.still.frame, self.still
        shown = tuple(
            replace(body, named=body.layer == self.layer) for body in still.bodies if body.layer <= self.layer
        )
        names = place_labels(Still(replace(still.scene, bodies=shown), still.frames))
        texts = [(name.text, name.place) for name in names]
        for body in (body for body in still.bodies if body.layer == self.layer):
            for part in body.parts:
                for letter, hole in zip(part.hole_names, part.holes):
                    low, high = box_of(some_points(hole))
                    texts.append((letter, complex(body.origin[k] + body.direction[k] * (high + low) / 2)))
        return tuple(texts)


def layer_pictures(job: Job) -> list[LayerPicture]:
    """A picture of each layer with parts, from the lowest up, of each unit that is assembled by itself."""
    scene = job.scene
    frames = np.array([frame_at(scene, job.assembly_at)])
    return [
        LayerPicture(still, layer, heading)
        for title, bodies in (scene.units or {"": scene.bodies}).items()
        for still in [Still(_bare(scene, bodies), frames)]
        for layer, heading in _layers(still, title)
    ]


def steps_picture(job: Job) -> bytes:
    """The pictures of all layers in rows; they have one scale."""
    scene, pictures = job.scene, layer_pictures(job)
    stills = [picture.still for picture in pictures] or [Still(scene, np.array([frame_at(scene, job.assembly_at)]))]
    largest = max(stills, key=lambda still: still.pixel)
    px, digits = largest.pixel, largest.digits
    low, high = box_of(np.array([still.bounds for still in stills]))
    size = high - low + px * complex(2 * MARGIN, 2 * MARGIN + LINES * LINE)
    body = []
    for number, picture in enumerate(pictures):
        row, column = divmod(number, COLUMNS)
        corner = rounded(complex(column * size.real, row * size.imag), digits).item()
        body += [
            f'<g transform="translate({decimal(corner.real, digits)} {decimal(corner.imag, digits)})">',
            *_heading(picture.heading, low.real, -high.imag - (MARGIN + (LINES - 1) * LINE) * px, largest),
            *_layer(picture),
            "</g>",
        ]
    columns, rows = min(COLUMNS, len(pictures) or 1), -(-len(pictures) // COLUMNS) or 1
    left, top = low.real - MARGIN * px, high.imag + (MARGIN + LINES * LINE) * px
    box = complex(left, top - rows * size.imag), complex(left + columns * size.real, top)
    box = rounded(np.array(box), digits).tolist()
    about = "Layers from the lowest up; the parts to add are coloured, and letters mark their holes."
    css = style(largest, "".join(body))
    return svg_document(largest, tuple(box), f"{job.name}, assembly", about, css, body)


def _bare(scene: Scene, bodies: tuple[SceneBody, ...]) -> Scene:
    """A scene of some bodies only, each with the name of its part."""
    named = (replace(body, name=part.name, parts=(part,), named=True) for body in bodies for part in body.parts)
    return replace(scene, bodies=tuple(named), marks=(), curves=(), regions=(), others={})


def _layers(still: Still, title: str) -> Iterator[tuple[int, str]]:
    """The layers with parts, and the heading of each."""
    for layer in sorted({body.layer for body in still.bodies}):
        names = ", ".join(body.name for body in still.bodies if body.layer == layer)
        yield layer, f"{title}{', ' if title else ''}{layer_name(layer)}: {names}"


def _heading(words: str, x: float, y: float, still: Still) -> Iterator[str]:
    px, digits = still.pixel, still.digits
    lines = wrap(words, int(PIXELS / (NARROW * LETTER)), max_lines=LINES)
    for k, line in enumerate(lines):
        place = decimal(rounded(x, digits).item(), digits), decimal(rounded(y + k * LINE * px, digits).item(), digits)
        yield f'<text class="scale" x="{place[0]}" y="{place[1]}">{escape(harmless(line))}</text>'


def _layer(picture: LayerPicture) -> Iterator[str]:
    """The parts up to a layer; those of the layer with their names and the letters of their holes."""
    still, layer = picture.still, picture.layer
    digits, tall = still.digits, LETTER * still.pixel
    layers = {body.name: body.layer for body in still.bodies}
    yield '<g transform="scale(1 -1)">'
    for item in items(still):
        if layers[item.body] <= layer:
            faint = f' opacity="{FAINT}"' if layers[item.body] < layer else ""
            yield f"<g{transform(still, item, still.frame)}{faint}>{item.drawn}</g>"
    yield "</g>"
    for words, place in picture.texts:
        at = rounded(place - 0.35j * tall, digits).item()
        yield f'<text x="{decimal(at.real, digits)}" y="{decimal(-at.imag, digits)}">{escape(harmless(words))}</text>'
