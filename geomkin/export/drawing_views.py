"""Views and tables of a drawing besides the front view: half sections through the datum, and tables in frames."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..plane.primitives import Circle, Polyline
from ..plane.vec import Complex, Real
from .cut import Cut, Loop
from .dimensions import AWAY, CENTRE, DIM, LETTER, LINE, OVER, PART, DrawingCanvas, length_text, without_noise
from .text import width_of

# Distances of the lines of a hatching along the axis, and of the lines that show the direction of teeth, mm on paper.
HATCHED, TEETH_APART = 2.5, 2.0
# Points of a line that shows the direction of teeth, along the face.
ALONG = 9
# Shift of the section's plane off the datum, as a share of the part, so that no edge lies in it.
ASIDE = 1e-5
# Distance of a cam's profile from its base circle from which the circle is drawn, mm on paper.
OFF = 0.5
# Rows of a table in one column, and the distance of its frame from its words, mm on paper.
ROWS, INSET = 36, 1.5


def section_view(canvas: DrawingCanvas, exact: Cut, datum: complex, scale: float, pitch: float) -> None:
    """The half section through the datum, seen from the left at the right of the front view, with the thickness.

    Above the axis the part is cut, and below it is whole. `pitch` is the pitch radius of a gear, mm, 0 of other parts:
    its teeth are not hatched, and the lower half shows the direction of helical ones.
    """
    low, high = exact.box
    toothed = _toothed(exact) if pitch else None
    x = datum.real + ASIDE * (high - low).real
    cuts = [_crossings(loop.points, x) - datum.imag for loop in exact.loops if loop is not toothed]
    radii = np.abs(toothed.points - datum) if toothed else np.zeros(1)
    tip, root = float(radii.max()), float(radii.min())
    if toothed is not exact.loops[0]:
        tip, root = root, tip
    walls = np.sort(np.concatenate([*cuts, [tip] if toothed else []]))
    walls = walls[walls > 0]
    left, thick = canvas.box[1].real + 2 * AWAY, exact.part.thickness * scale
    at, right = complex(left, datum.imag * scale), complex(left + thick, datum.imag * scale)
    ends = left + 1j * low.imag * scale, left + thick + 1j * high.imag * scale
    canvas.add(PART, Polyline(np.array([ends[0], ends[0] + thick, ends[1], ends[1] - thick])))
    for wall in (*walls.tolist(), *([root] if toothed else [])):
        if abs(wall * scale - (ends[1] - at).imag) > OVER / 10:
            canvas.line(at + 1j * wall * scale, right + 1j * wall * scale, layer=PART)
    # An odd number of walls: material about the axis.
    bounds = [0.0, *walls.tolist()] if len(walls) % 2 else walls.tolist()
    solid = [root if toothed and bound == tip else bound for bound in bounds]
    for inner, outer in zip(solid[::2], solid[1::2]):
        _hatch(canvas, at + 1j * inner * scale, thick, (outer - inner) * scale)
    for radius in (0.0, pitch, -pitch) if pitch else (0.0,):
        canvas.line(at - OVER + 1j * radius * scale, right + OVER + 1j * radius * scale, layer=CENTRE)
    if pitch and exact.part.twist is not None and exact.part.twist.turn:
        for line in _tooth_lines(exact, pitch * scale, thick):
            canvas.line(*(at + line), layer=DIM)
    canvas.linear(complex(left, ends[1].imag), ends[1], 1j * AWAY, exact.part.thickness)


def _toothed(exact: Cut) -> Loop:
    """The contour with the teeth: the outline, or the widest opening of a ring."""
    if not isinstance(exact.loops[0].shape, Circle):
        return exact.loops[0]
    return max(exact.loops[1:], key=lambda loop: float(np.ptp(loop.points.real)))


def _crossings(points: Complex, x: float) -> Real:
    """Ordinates at which a closed contour crosses a vertical line."""
    following = np.roll(points, -1)
    crossed = (points.real > x) != (following.real > x)
    start, step = points[crossed], (following - points)[crossed]
    return np.asarray(start.imag + (x - start.real) / step.real * step.imag, dtype=float)


def _hatch(canvas: DrawingCanvas, corner: complex, width: float, height: float) -> None:
    """Lines at 45 degrees in a rectangle, by its lower left corner."""
    for start in np.arange(HATCHED - height, width, HATCHED).tolist():
        low, high = max(0.0, start), min(width, start + height)
        canvas.line(corner + complex(low, low - start), corner + complex(high, high - start))


def _tooth_lines(exact: Cut, pitch: float, thick: float) -> Iterator[Complex]:
    """The three lines that show the direction of helical teeth on the lower half, from the left end of the axis."""
    twist, share = exact.part.twist, np.linspace(0, 1, ALONG)
    assert twist is not None
    # Seen from the left, what turns counterclockwise about the axis moves downwards.
    down = pitch * np.angle(np.asarray(twist.at(share).direction))
    for k in (-1, 0, 1):
        line = thick * share - 1j * (down - down.mean() + pitch / 2 + k * TEETH_APART)
        yield line[np.abs(line.imag + pitch / 2) < pitch / 2]


def base_circle(
    canvas: DrawingCanvas, profile: Loop, datum: complex, radius: float, scale: float
) -> dict[str, list[tuple[complex, float, complex]]]:
    """Draw a cam's base circle where the profile is off it, and return the arc with its words, for a leader."""
    spokes = profile.points - datum
    order = np.argsort(np.angle(spokes))
    around = np.radians(np.arange(-180, 181, 2.0))
    heights = np.interp(around, np.angle(spokes)[order], np.abs(spokes)[order], period=2 * np.pi)
    is_off = (heights - radius) * scale > OFF
    runs = np.split(np.flatnonzero(is_off), np.flatnonzero(np.diff(np.flatnonzero(is_off)) > 1) + 1)
    for run in runs:
        if len(run) > 1:
            canvas.line(*(datum + radius * np.exp(1j * around[run])) * scale, layer=CENTRE)
    longest = max(runs, key=len)
    if len(longest) < 2:
        return {}
    middle = complex(np.exp(1j * around[longest[len(longest) // 2]]))
    return {f"base R{length_text(radius, canvas.unit)}": [(datum, radius, middle)]}


def draw_table(canvas: DrawingCanvas, rows: Sequence[Sequence[str]], corner: complex) -> float:
    """Draw rows of a table below its heading from an upper left corner in frames, and return its right end, mm."""
    heading, left = rows[0], corner.real
    columns = -(-(len(rows) - 1) // ROWS)
    length = -(-(len(rows) - 1) // columns)
    for start in range(1, len(rows), length):
        block = [heading, *rows[start : start + length]]
        bottom = corner.imag - len(block) * LINE
        widths = [max(width_of(row[k], LETTER) for row in block) + 2 * INSET for k in range(len(heading))]
        lefts = left + np.cumsum([0.0, *widths])
        for number, row in enumerate(block):
            for words, x in zip(row, lefts.tolist()):
                canvas.words(words, complex(x + INSET, corner.imag - (number + 0.5) * LINE))
        for x in lefts.tolist():
            canvas.line(complex(x, corner.imag), complex(x, bottom))
        for y in (corner.imag, corner.imag - LINE, bottom):
            canvas.line(complex(left, y), complex(lefts[-1], y))
        left = float(lefts[-1]) + LETTER
    return left


def point_table(
    canvas: DrawingCanvas, datum: complex, scale: float, located: Sequence[tuple[complex, float]]
) -> list[Sequence[str]]:
    """Coordinates of numbered points, whose numbers are written at them."""
    places = list({(round(p.real, 6), round(p.imag, 6)): p for p, _ in located}.values())
    rows: list[Sequence[str]] = [("point", "x", "y")]
    offsets = without_noise(np.array(places) - datum).tolist()
    for number, (place, offset) in enumerate(zip(places, offsets), 1):
        words = str(number) if canvas.label(str(number), place * scale) else f"{number} (not marked)"
        rows.append((words, *(length_text(value, canvas.unit) for value in (offset.real, offset.imag))))
    return rows
