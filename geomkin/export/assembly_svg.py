"""SVG of the assembly for viewing: parts in place at one driver position, filled and named, at full size in mm."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape

import numpy as np

from ..core.errors import harmless
from ..plane.vec import rounded
from .job import Job
from .labels import LETTER, Name, half_size, place_labels
from .picture import MARGIN, items, page_box, style, svg_document, transform
from .still import Still, frame_at
from .svg_path import decimal
from .text import number, with_unit

# Height in pixels of the strip below the picture for the scale.
BELOW = 22.0
# Largest width of the scale as a share of the picture.
SCALE = 0.3


def assembly_picture(job: Job) -> bytes:
    """The picture; its title names the assembly and the driver position."""
    frame = frame_at(job.scene, job.assembly_at)
    still = Still(job.scene, np.array([frame]))
    drive = job.scene.drive
    position = f"{drive.id.replace('_', ' ')} {with_unit(float(np.asarray(drive.values)[frame]), drive.unit)}"
    names = place_labels(still)
    box = _wide_enough(page_box(still, names, BELOW), f"{position} and a length", still)
    body = [
        '<g transform="scale(1 -1)">',
        *_placed(still),
        "</g>",
        *_names(still, names),
        _scale_bar(still, box, position),
    ]
    css = style(still, "".join(body))
    return svg_document(still, box, f"{job.name}, assembled", f"The parts in place at {position}.", css, body)


def _placed(still: Still) -> Iterator[str]:
    for item in items(still):
        place = item.origin[still.frame] if len(item.origin) > 1 else item.origin[0]
        if np.isfinite(place):
            yield f"<g{transform(still, item, still.frame)}>{item.drawn}</g>"


def _names(still: Still, names: Sequence[Name]) -> Iterator[str]:
    digits = still.digits
    for name in names:
        place = rounded(name.place - 0.35j * LETTER * still.pixel, digits).item()
        role = name.role or "of"
        yield (
            f'<text class="{role}" x="{decimal(place.real, digits)}" y="{decimal(-place.imag, digits)}">'
            f"{escape(harmless(name.text))}</text>"
        )


def _wide_enough(box: tuple[complex, complex], words: str, still: Still) -> tuple[complex, complex]:
    """The box, widened if the text next to the scale would not fit."""
    low, high = box
    width = 2 * half_size(words, LETTER * still.pixel).real + 2 * MARGIN * still.pixel
    widening = max(0.0, width - (1 - SCALE) * (high - low).real) / (1 - SCALE)
    return low, rounded(high + widening, still.digits).item()


def _scale_bar(still: Still, box: tuple[complex, complex], at: str) -> str:
    """A length for measuring, and the driver position."""
    px, digits = still.pixel, still.digits
    low, high = box
    most = SCALE * (high - low).real
    power = 10.0 ** np.floor(np.log10(most))
    length = float(next(step for step in (5, 2, 1) if step * power <= most) * power)
    x, y = low.real + MARGIN * px, -low.imag - 12 * px
    left, right, middle, top, bottom = (decimal(v, digits) for v in (x, x + length, y, y - 4 * px, y + 4 * px))
    text = f"{number(length)} mm, {at}"
    return (
        f'<path d="M{left} {top}V{bottom}M{left} {middle}H{right}M{right} {top}V{bottom}"/>'
        f'<text class="scale" x="{decimal(x + length + 6 * px, digits)}" y="{decimal(y + 4 * px, digits)}">'
        f"{escape(harmless(text))}</text>"
    )
