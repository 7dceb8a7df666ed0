"""Curves in small: a picture of a few pixels, on a page or in a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from ..errors import GeomkinError
from ..plane.curve import AbstractCurve, reach
from ..plane.flatten import flatten
from .path import path

# Distance between a curve and its chords, pixels. More shows as corners; less only makes pictures longer.
FINE = 0.25
# Pixels kept free on each side.
MARGIN = 2
# Of a picture that stands alone: pixels, and the colours of the page's first body.
WIDE, HIGH = 360, 240
STROKE = 'stroke="#2c343b" stroke-width="1.2" vector-effect="non-scaling-stroke"'
FILLED, LINE = f'fill="#cfe4f3" fill-rule="evenodd" {STROKE}', f'fill="none" {STROKE}'


def picture(name: str, curves: Sequence[AbstractCurve], marks: Sequence[AbstractCurve]) -> str | None:
    """An SVG that stands alone: curves, filled if closed, the outermost first, and marks; None if none can be drawn."""
    layers = [(curves, FILLED if curves[0].closed else LINE), (marks, LINE)]
    size = f'width="{WIDE}" height="{HIGH}"'
    told = f'{size} xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{escape(name)}" style="background:#fff"'
    try:
        return thumbnail([layer for layer in layers if layer[0]], WIDE, HIGH, told)
    except GeomkinError:
        return None


def thumbnail(layers: Sequence[tuple[Sequence[AbstractCurve], str]], wide: int, high: int, told: str) -> str:
    """Curves as an SVG element of so many pixels, y up.

    layers: rows of curves, each with the attributes of its path, a class or colours; the first curve is the largest.
    told: attributes of the element, which say what it is, and how large, where no style does.
    """
    outline = layers[0][0][0]
    low, high_end = extent(outline, FINE * reach(outline) / min(wide, high))
    across, middle = high_end - low, (low + high_end) / 2
    # mm a pixel.
    room = max(across.real / (wide - 2 * MARGIN), across.imag / (high - 2 * MARGIN))
    digits = 1 - int(np.floor(np.log10(room)))
    box = (middle.real - wide / 2 * room, -middle.imag - high / 2 * room, wide * room, high * room)
    drawn = "".join(
        f'<path {look} transform="scale(1 -1)" d="{path(curves, FINE * room, digits)}"/>' for curves, look in layers
    )
    numbers = " ".join(f"{value:.{max(0, digits)}f}" for value in box)
    return f'<svg viewBox="{numbers}" {told}>{drawn}</svg>'


def extent(curve: AbstractCurve, tolerance: float) -> tuple[complex, complex]:
    """Lower left and upper right corner of a curve's chords within `tolerance`, mm."""
    points = flatten(curve, tolerance)
    return complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
