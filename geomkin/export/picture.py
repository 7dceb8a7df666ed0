"""A scene as SVG for viewing: bodies, paths and marks as items, each in its own frame, at full size in mm."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from html import escape

import numpy as np

from ..core.errors import harmless
from ..core.records import record
from ..core.units import MM, LengthUnit
from ..model.scene import SceneBody, SceneMark
from ..plane.curve import AbstractCurve
from ..plane.primitives import Polyline
from ..plane.vec import Complex, Real, rounded
from .still import LETTER, Name, Still, palette
from .svg_path import decimal, path

# Driver rotation, deg, of a dash of a trail, as on the page, and the most dashes of a whole motion.
DASH_DEG, MOST_DASHES = 5.0, 72
# Pixels around the picture.
MARGIN = 14.0
# A support of a ground pivot, if no plate shows the ground, and a slider block, in pixels, y up.
SUPPORT = "M-2.6 -3.8L-8 -13H8L2.6 -3.8M-12 -13H12M-10 -13l-4 -5M-4 -13l-4 -5M2 -13l-4 -5"
BLOCK = "M-10 -6.5h20v13h-20z"
# Radius of a pin without a hole, and least and greatest radius of one in a hole, in pixels.
PIN, LEAST_PIN, MOST_PIN = 3.8, 3.2, 8.0
# Decimals of degrees: a hundredth of a mm at one metre.
TURN_DIGITS = 3
# Decimals of a scale: an element drawn at ten times its usual size has an error of at most a hundredth.
SCALE_DIGITS = 5


@record(eq=False)
class Item:
    """A drawn element in its own frame, y up, mm.

    `body` is the name of its body or "". `origin` is (frames,) complex, mm; `direction` (frames,) unit complex, None if
    it does not rotate; `scale` (frames,), None if its size is fixed. `radius` is its largest distance from the origin
    of its frame, mm.
    """

    drawn: str
    origin: Complex
    direction: Complex | None = None
    scale: Real | None = None
    body: str = ""
    radius: float = 0.0


def svg_document(
    still: Still, box: tuple[complex, complex], title: str, about: str, css: str, body: Sequence[str],
    unit: LengthUnit = MM,
) -> bytes:  # fmt: skip
    """An SVG file in true size, y down; `box` is the visible region, mm, y up; unit: that of width and height."""
    low, upper = box
    digits = still.digits
    left, top, width, height = (
        decimal(v, digits) for v in (low.real, -upper.imag, (upper - low).real, (upper - low).imag)
    )
    width, height = (size if not size.startswith(".") else f"0{size}" for size in (width, height))
    wide, high = (size if unit is MM else f"{unit.of(float(size)):.9g}" for size in (width, height))
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}{unit.name}" height="{high}{unit.name}" '
        f'viewBox="{left} {top} {width} {height}" style="background:#fff">',
        f"<title>{escape(harmless(title))}</title>",
        f"<desc>{escape(harmless(about))}</desc>",
        f"<style>{css}</style>",
        *_hatch(still),
        *body,
        "</svg>\n",
    ]
    return "\n".join(lines).encode("utf-8", "replace")


def page_box(still: Still, names: Sequence[Name] = (), below: float = 0.0) -> tuple[complex, complex]:
    """Lower left and upper right corner of the picture, mm, with names, margins and a strip of `below` pixels."""
    low, high = still.bounds
    corners = [low, high]
    corners += [corner for name in names for corner in (name.place - name.half, name.place + name.half)]
    x, y = np.real(corners), np.imag(corners)
    margin = MARGIN * still.pixel
    bottom = y.min() - margin - below * still.pixel
    box = rounded(np.array([x.min() - margin, bottom, x.max() + margin, y.max() + margin]), still.digits)
    left, bottom, right, top = box.tolist()
    return complex(left, bottom), complex(right, top)


def style(still: Still, drawn: str) -> str:
    """The style sheet of the elements and classes in the text of a drawing, in the page's colours on white."""
    c, px = palette(), still.pixel

    def w(pixels: float) -> str:
        return f"{pixels * px:.3g}"

    tints = "".join(f".t{k}{{fill:{c[f't{k}']}}}" for k in range(8))
    css = (
        f"path,circle{{fill:none;stroke:{c['line']};stroke-width:{w(1)};stroke-linejoin:round}}"
        f".plate{{fill-rule:evenodd;fill-opacity:.85}}{tints}.ground{{fill:{c['ground']}}}"
        f".hatch{{fill:url(#hatch);fill-rule:evenodd;stroke:none}}.over{{opacity:.35}}"
        f".engraved,.rail,.trail,.line{{stroke:{c['soft']};stroke-width:{w(0.8)}}}"
        f".pin,.slide{{fill:#fff}}.core{{fill:{c['line']};stroke:none}}.free{{vector-effect:non-scaling-stroke}}"
        f".link{{stroke-width:{w(1.8)}}}"
        f".dot{{fill:{c['soft']};stroke:#fff}}"
        f".construction.line,.pitch.line{{stroke-dasharray:{w(7)} {w(2.5)} {w(2)} {w(2.5)}}}"
        f".traced{{stroke:{c['traced']};stroke-width:{w(1.6)}}}.dot.traced{{fill:{c['traced']};stroke:#fff}}"
        f".wanted{{stroke:{c['wanted']};stroke-width:{w(1.6)}}}.wanted.line{{stroke-dasharray:{w(2)} {w(2.5)}}}"
        f".dot.wanted{{fill:none;stroke:{c['wanted']}}}"
        f".contact{{stroke:{c['acceleration']}}}.centrode{{stroke:{c['velocity']};stroke-width:{w(1.2)}}}"
        f".inflection{{stroke:{c['wanted']};stroke-dasharray:{w(4)} {w(2.5)}}}"
        f'text{{font:{w(LETTER)}px "DejaVu Sans",Arial,sans-serif;fill:{c["ink"]};stroke:#fff;stroke-width:{w(2.4)};'
        f"stroke-linejoin:round;paint-order:stroke;text-anchor:middle}}.of{{font-style:italic}}"
        f"text.traced{{fill:{c['traced']};stroke:#fff;stroke-width:{w(2.4)}}}"
        f"text.wanted{{fill:{c['wanted']};stroke:#fff;stroke-width:{w(2.4)}}}"
        f"text.contact,text.centrode,text.inflection{{stroke:#fff;stroke-width:{w(2.4)};stroke-dasharray:none}}"
        ".scale{text-anchor:start}"
    )
    names = set(re.findall(r"\w+", " ".join(re.findall(r'<\w+| class="[^"]*"', drawn))))
    rules = re.findall(r"([^{}]+)({[^{}]*})", css)
    return "".join(
        f"{selectors}{values}"
        for selectors, values in rules
        if any(names.issuperset(re.findall(r"\w+", selector)) for selector in selectors.split(","))
    )


def _hatch(still: Still) -> list[str]:
    if not still.shows_ground:
        return []
    step, stroke = f"{5 * still.pixel:.3g}", f"{1.2 * still.pixel:.3g}"
    return [
        f'<defs><pattern id="hatch" patternUnits="userSpaceOnUse" width="{step}" height="{step}" '
        f'patternTransform="rotate(45)"><path d="M0 0V{step}" style="stroke:{palette()["hatch"]};'
        f'stroke-width:{stroke}"/></pattern></defs>'
    ]


def items(still: Still) -> Iterator[Item]:
    """All elements except the names, in the order in which they are drawn."""
    for mark in still.marks:
        if mark.sort == "slide" and not still.shows_ground and (rail := _rail(still, mark)):
            yield _on_ground(rail)
    for body in still.bodies:
        if drawn := _body(still, body):
            yield Item(drawn, body.origin, body.direction, body=body.name, radius=_radius(still, body))
    for curve in still.scene.curves:
        if curve.body not in {body.name for body in still.scene.bodies}:
            yield _on_ground(_line(still, curve.curve, f"line {curve.role}"))
    for mark in still.marks:
        if mark.trail:
            yield _on_ground(f'<path class="trail {mark.role}" d="{_trail(still, mark)}"/>')
    for mark in still.marks:
        yield from _mark(still, mark)


def _on_ground(drawn: str) -> Item:
    return Item(drawn, np.zeros(1, dtype=complex))


def transform(still: Still, item: Item, frame: int) -> str:
    """The attribute that moves an item to its position at a frame; "" if it does not move."""
    if len(item.origin) == 1:
        return ""
    place = rounded(complex(item.origin[frame]), still.digits).item()
    moved = f"translate({decimal(place.real, still.digits)} {decimal(place.imag, still.digits)})" if place else ""
    angle = 0.0
    if item.direction is not None:
        angle = rounded(float(np.degrees(np.angle(item.direction[frame]))), TURN_DIGITS).item()
    turned = f"rotate({decimal(angle, TURN_DIGITS)})" if angle else ""
    size = 1.0 if item.scale is None else rounded(float(item.scale[frame]), SCALE_DIGITS).item()
    sized = f"scale({decimal(size, SCALE_DIGITS)})" if size != 1 else ""
    return f' transform="{moved}{turned}{sized}"' if moved or turned or sized else ""


def _radius(still: Still, body: SceneBody) -> float:
    return max((float(np.abs(points).max()) for points in still.points_of(body)), default=0.1 * still.size)


def _body(still: Still, body: SceneBody) -> str:
    """The item of a body: its parts, engravings and curves; a fixed body over moving ones is transparent."""
    over = body.fixed and any(not other.fixed and other.layer < body.layer for other in still.bodies)
    drawn = []
    for part in body.parts:
        d = _path(still, (part.outline, *part.holes))
        drawn.append(f'<path class="plate {still.tint(body)}" d="{d}"/>')
        if body.fixed:
            drawn.append(f'<path class="hatch" d="{d}"/>')
        if part.marks:
            drawn.append(f'<path class="engraved" d="{_path(still, part.marks)}"/>')
    text = "".join(drawn)
    if over:
        text = f'<g class="over">{text}</g>'
    text += "".join(
        _line(still, curve.curve, f"line {curve.role}") for curve in still.scene.curves if curve.body == body.name
    )
    return f"<title>{escape(harmless(body.name.replace('_', ' ')))}</title>{text}" if text else ""


def _path(still: Still, curves: Sequence[AbstractCurve]) -> str:
    """The curves with decimals that move no point by more than the tolerance."""
    return path(curves, still.tolerance, -int(np.floor(np.log10(still.tolerance))))


def _line(still: Still, curve: AbstractCurve, shown: str) -> str:
    return f'<path class="{shown}" d="{_path(still, (curve,))}"/>'


def _trail(still: Still, mark: SceneMark) -> str:
    """A dash for every second of equal steps of the drive, so that long dashes show a fast point."""
    drive = np.asarray(still.scene.drive.values, dtype=float)
    passed = np.abs(drive - drive[0])
    every = max(DASH_DEG if still.scene.drive.unit == "deg" else 0.0, passed[-1] / MOST_DASHES)
    place = np.asarray(mark.place)
    step = passed / every if every > 0 else np.zeros(len(drive))
    dashes = []
    for start in range(0, int(np.ceil(step[-1])), 2):
        ends = np.array([start, min(start + 1, step[-1])])
        inside = step[(step > ends[0]) & (step < ends[1])]
        at = np.concatenate([ends[:1], inside, ends[1:]])
        points = np.interp(at, step, place.real) + 1j * np.interp(at, step, place.imag)
        if np.isfinite(points).all():
            dashes.append(Polyline(_thinned(points, still.tolerance), is_closed=False))
    return _path(still, dashes)


def _thinned(points: Complex, tolerance: float) -> Complex:
    """The points of a line; only its ends, if it is straight on a screen."""
    chord = points[-1] - points[0]
    off = np.abs(np.imag((points - points[0]) * np.conj(chord))) / (abs(chord) or 1.0)
    return points[[0, -1]] if off.max() < tolerance else points


def _mark(still: Still, mark: SceneMark) -> Iterator[Item]:
    title = f"<title>{escape(harmless(mark.label.replace('_', ' ')))}</title>" if mark.label else ""
    place, px = np.asarray(mark.place), still.pixel
    if mark.vector is not None:
        item = _arrow(still, mark, mark.vector)
    elif mark.radius is not None:
        item = _circle(still, mark, mark.radius)
    elif mark.sort == "slide":
        item = Item(f'<path class="slide" {_pixels(px)} d="{BLOCK}"/>', place, mark.direction, radius=10 * px)
    elif mark.sort == "point":
        item = Item(f'<circle class="dot {mark.role}" r="{3.2 * px:.3g}"/>', place)
    else:
        item = Item(_pin(still, mark), place)
    if item.drawn:
        yield replace(item, drawn=title + item.drawn)


def _pixels(px: float) -> str:
    """Attributes of elements sized in pixels."""
    return f'style="stroke-width:1" transform="scale({px:.4g})"'


def _arrow(still: Still, mark: SceneMark, vector: Complex) -> Item:
    """A vector, or a line without a head, along its own x axis."""
    long, digits = np.abs(vector), still.digits
    usual = _usual_size(still, long)
    with np.errstate(invalid="ignore", divide="ignore"):
        direction = np.where(long > 0, vector / long, 1 + 0 * vector)
    scale = _scale(long, usual)
    shown = f"{'link' if mark.role == 'construction' and mark.sort == 'line' else 'arrow'} {mark.role}"
    head = min(7 * still.pixel, usual)
    end, back, up = (decimal(rounded(v, digits).item(), digits) for v in (usual, usual - head, 0.4 * head))
    d = f"M0 0H{end}" + (f"M{back} {up}L{end} 0L{back} -{up}" if mark.sort == "vector" else "")
    drawn = f'<path class="{shown}{"" if scale is None else " free"}" d="{d}"/>' if usual else ""
    return Item(drawn, np.asarray(mark.place), direction, scale, radius=usual)


def _circle(still: Still, mark: SceneMark, radius: Real) -> Item:
    usual = _usual_size(still, radius)
    scale, r = _scale(radius, usual), decimal(rounded(usual, still.digits).item(), still.digits)
    drawn = f'<circle class="line {mark.role}{"" if scale is None else " free"}" r="{r}"/>' if usual else ""
    return Item(drawn, np.asarray(mark.place), None, scale, radius=usual)


def _pin(still: Still, mark: SceneMark) -> str:
    """A circle that fills the hole; on the ground with a centre, and a support if no plate shows the ground."""
    px, hole_radius = still.pixel, still.hole_radii.get(mark, 0.0)
    radius = float(np.clip(hole_radius, LEAST_PIN * px, MOST_PIN * px)) if hole_radius else PIN * px
    support = f'<path {_pixels(px)} d="{SUPPORT}"/>' if mark.sort == "fixed pin" and not still.shows_ground else ""
    core = f'<circle class="core" r="{0.35 * radius:.3g}"/>' if mark.sort == "fixed pin" else ""
    return f'{support}<circle class="pin" r="{radius:.3g}"/>{core}'


def _scale(sizes: Real, usual: float) -> Real | None:
    """Sizes relative to the usual one; None if all are equal to it."""
    known = sizes[np.isfinite(sizes)]
    varies = usual and np.abs(known - usual).max(initial=0.0) > 1e-6 * usual
    return sizes / usual if varies else None


def _usual_size(still: Still, sizes: Real) -> float:
    """The size in which an element of varying size is drawn: that of the single frame, or the median; 0 if undefined.

    Scales are written relative to it with few decimals; relative to an outlier all other scales would be 0.
    """
    known = sizes[still.frames]
    known = known[np.isfinite(known) & (known > 0)]
    return float(np.median(known)) if len(known) else 0.0


def _rail(still: Still, mark: SceneMark) -> str:
    """The rail of a block that moves along one line of the ground, hatched below."""
    place, slide_direction = np.asarray(mark.place), np.asarray(mark.direction)
    known = np.isfinite(place) & np.isfinite(slide_direction)
    if not known.any():
        return ""
    first = slide_direction[known][0]
    along_rail = place[known] * np.conj(first)
    low, high, offset = float(along_rail.real.min()), float(along_rail.real.max()), float(along_rail[0].imag)
    is_straight = np.abs(np.imag(slide_direction[known] * np.conj(first))).max() < 1e-3
    if not is_straight or high == low or np.ptp(along_rail.imag) > 2e-3 * (high - low):
        return ""
    px = still.pixel
    start, end, y = low - 16 * px, high + 16 * px, offset - 8 * px
    marks = np.arange(start + 4 * px, end, 7 * px)
    lines = [np.array([start + 1j * y, end + 1j * y])]
    lines += [np.array([x + 1j * y, x - 4 * px + 1j * (y - 5 * px)]) for x in marks]
    strokes = [Polyline(line * first, is_closed=False) for line in lines]
    return f'<path class="rail" d="{_path(still, strokes)}"/>'
