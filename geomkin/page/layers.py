"""Section of a page with a picture of each layer of parts; the outline of a part is written only once."""

from __future__ import annotations

import numpy as np

from ..export.job import Job
from ..export.picture import MARGIN, TURN_DIGITS
from ..export.steps_svg import LayerPicture, layer_pictures
from ..export.svg_path import FINE, decimal, path
from ..export.text import text
from ..plane.vec import rounded

# Width and height, in pixels, into which the largest picture is fitted, without its margin.
ROOM = 280.0


def layers_section(job: Job, tints: dict[str, str]) -> str:
    """A picture of each layer, its parts over those below, which are faint; "" for one layer, or if never assembled.

    tints: the CSS class of each part's colour.
    """
    pictures = layer_pictures(job) if job.scene.assembled.any() else []
    if len(pictures) < 2:
        return ""
    outlines = dict[str, str]()
    pixel = max(max((high - low).real, (high - low).imag) for low, high in (p.still.bounds for p in pictures)) / ROOM
    figures = "".join(_figure(picture, pixel, tints, outlines) for picture in pictures)
    effect = 'vector-effect="non-scaling-stroke"'
    defined = "".join(f'<path id="{name}" {effect} d="{d}"/>' for d, name in outlines.items())
    defs = f'<svg width="0" height="0" aria-hidden="true"><defs>{defined}</defs></svg>'
    lead = "<p>From the lowest up. The parts to add are coloured, and letters mark their holes.</p>"
    return f'<section id="layers"><h2>Layers</h2>{lead}{defs}<div class="layers">{figures}</div></section>'


def _figure(picture: LayerPicture, pixel: float, tints: dict[str, str], outlines: dict[str, str]) -> str:
    """A picture at `pixel` mm a pixel. outlines: names of the outlines written so far, to which new ones are added."""
    still, k, digits = picture.still, picture.still.frame, -int(np.floor(np.log10(FINE * pixel)))
    low, high = still.bounds
    drawn, texts = [], []
    for body in (body for body in still.bodies if body.layer <= picture.layer):
        place = rounded(complex(body.origin[k]), digits).item()
        angle = rounded(float(np.degrees(np.angle(body.direction[k]))), TURN_DIGITS).item()
        moved = f"translate({decimal(place.real, digits)} {decimal(place.imag, digits)})" if place else ""
        moved += f"rotate({decimal(angle, TURN_DIGITS)})" if angle else ""
        where = f' transform="{moved}"' if moved else ""
        for part in body.parts:
            outline = path((part.outline, *part.holes), FINE * pixel, digits)
            name = outlines.setdefault(outline, f"outline{len(outlines)}")
            look = f"plate {tints.get(part.name, 't0')}{' below' * (body.layer < picture.layer)}"
            drawn.append(f'<use href="#{name}" class="{look}"{where}/>')
    for words, place in picture.texts:
        x, y = (place.real - low.real) / pixel, (high.imag - place.imag) / pixel
        texts.append(f'<text x="{x:.0f}" y="{y + 4:.0f}">{text(words)}</text>')
    width, height = ((high - low).real / pixel, (high - low).imag / pixel)
    box = f"-{MARGIN:.0f} -{MARGIN:.0f} {width + 2 * MARGIN:.0f} {height + 2 * MARGIN:.0f}"
    corner = f"{-low.real / pixel:.1f} {high.imag / pixel:.1f}"
    scale = f"{1 / pixel:.4g}"
    return (
        f'<figure><svg viewBox="{box}" width="{width + 2 * MARGIN:.0f}" aria-hidden="true">'
        f'<g transform="translate({corner})scale({scale} -{scale})">{"".join(drawn)}</g>{"".join(texts)}</svg>'
        f"<figcaption>{text(picture.heading.replace('_', ' '))}</figcaption></figure>"
    )
