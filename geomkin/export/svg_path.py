"""Curves as the text of an SVG path, as short as possible."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from ..core.errors import GeomkinError
from ..plane.approximation import to_arcs
from ..plane.curve import AbstractCurve, extent
from ..plane.flatten import flatten
from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, box_of, rounded


def path(curves: Iterable[AbstractCurve], tolerance: float, digits: int) -> str:
    """The curves, mm, y up, within `tolerance`, with `digits` decimals; in arcs where they are shorter than steps."""
    return "".join(_curve(curve, tolerance, digits) for curve in curves)


def _curve(curve: AbstractCurve, tolerance: float, digits: int) -> str:
    match curve:
        case Circle():
            return _circle(curve, digits)
        case Polyline() if curve.bulges is None:
            return _steps(curve, tolerance, digits)
        case _:
            return min(_arcs(curve, tolerance, digits), _steps(curve, tolerance, digits), key=len)


def _arcs(curve: AbstractCurve, tolerance: float, digits: int) -> str:
    """Arcs of at most half a turn, each with its radius and side, and lines."""
    chain = to_arcs(curve, tolerance)
    # The closing step of an open path has no bulge and is left out by zip.
    points = rounded(np.append(chain.vertices, chain.vertices[:1]), digits)
    bulges = np.zeros(0) if chain.bulges is None else np.asarray(chain.bulges)
    text = f"M{_pair(points[0].item(), digits)}"
    for step, bulge in zip(rounded(np.diff(points), digits).tolist(), bulges.tolist()):
        if bulge:
            radius = decimal(rounded(abs(step) * (1 + bulge**2) / (4 * abs(bulge)), digits).item(), digits)
            text += f"a{radius} {radius} 0 0 {int(bulge > 0)} {_pair(step, digits)}"
        else:
            text += f"l{_pair(step, digits)}"
    return text.replace(" -", "-") + "z" * curve.closed


def _steps(curve: AbstractCurve, tolerance: float, digits: int) -> str:
    """A start and relative steps; rounded steps between rounded points add up without error."""
    points = rounded(flatten(curve, tolerance), digits)
    steps = rounded(np.diff(points), digits)
    text = " ".join([f"M{_pair(points[0], digits)}l", *(_pair(step, digits) for step in steps.tolist())])
    return text.replace("l ", "l").replace(" -", "-") + "z" * curve.closed


def _circle(circle: Circle, digits: int) -> str:
    radius = rounded(circle.radius, digits).item()
    start: Complex = rounded(circle.centre - radius, digits)
    arc, across = f"a{decimal(radius, digits)} {decimal(radius, digits)} 0 0 1 ", decimal(2 * radius, digits)
    return f"M{_pair(start.item(), digits)}{arc}{across} 0{arc[:-1]}-{across} 0z"


def _pair(z: complex, digits: int) -> str:
    return f"{decimal(z.real, digits)} {decimal(z.imag, digits)}"


def decimal(value: float, digits: int) -> str:
    """A rounded number as its shortest decimal text, without the zero before its point."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".") if digits > 0 else f"{value:.0f}"
    if -1 < value < 1:
        text = text.replace("0.", ".", 1)
    return "0" if text == "-0" else text


# Distance between a curve and its chords, pixels. Larger values show corners; smaller ones only enlarge the file.
FINE = 0.33
# Pixels kept free on each side.
MARGIN = 2
# Size in pixels of a stand-alone picture, and the colours of the page's first body.
WIDE, HIGH = 360, 240
STROKE = 'stroke="#2c343b" stroke-width="1.2" vector-effect="non-scaling-stroke"'
FILLED, LINE = f'fill="#cfe4f3" fill-rule="evenodd" {STROKE}', f'fill="none" {STROKE}'


def picture(name: str, curves: Sequence[AbstractCurve], marks: Sequence[AbstractCurve]) -> str | None:
    """A stand-alone SVG of curves, filled if closed, the outermost first, and marks; None if none can be drawn."""
    layers = [(curves, FILLED if curves[0].closed else LINE), (marks, LINE)]
    size = f'width="{WIDE}" height="{HIGH}"'
    attributes = (
        f'{size} xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{escape(name)}" style="background:#fff"'
    )
    try:
        return thumbnail([layer for layer in layers if layer[0]], WIDE, HIGH, attributes)
    except GeomkinError:
        return None


def thumbnail(layers: Sequence[tuple[Sequence[AbstractCurve], str]], width: int, height: int, attributes: str) -> str:
    """Curves as an SVG element of the given size in pixels, y up.

    `layers` are rows of curves, each with the attributes of its path; the first curve is the largest. `attributes` are
    those of the element.
    """
    outline = layers[0][0][0]
    low, high_end = bounding_box(outline, FINE * extent(outline) / min(width, height))
    across, middle = high_end - low, (low + high_end) / 2
    # mm a pixel.
    room = max(across.real / (width - 2 * MARGIN), across.imag / (height - 2 * MARGIN))
    digits = 1 - int(np.floor(np.log10(room)))
    box = (middle.real - width / 2 * room, -middle.imag - height / 2 * room, width * room, height * room)
    drawn = "".join(
        f'<path {look} transform="scale(1 -1)" d="{path(curves, FINE * room, digits)}"/>' for curves, look in layers
    )
    numbers = " ".join(f"{value:.{max(0, digits)}f}" for value in box)
    return f'<svg viewBox="{numbers}" {attributes}>{drawn}</svg>'


def bounding_box(curve: AbstractCurve, tolerance: float) -> tuple[complex, complex]:
    """Lower left and upper right corner of a curve's chords within `tolerance`, mm."""
    return box_of(flatten(curve, tolerance))
