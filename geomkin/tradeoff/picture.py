"""A family's chart as an SVG picture: time per result, or weight, on x, error on y, both logarithmic."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..core.records import record
from ..export.text import text
from .family import Method
from .measurement import FamilyChart

# Sizes in pixels. A narrower picture would cut off names of the legend.
WIDTH, LEFT, PLOT, TOP, LEAST_HEIGHT, ROW = 820, 74, 440, 46, 400, 19
RIGHT = LEFT + PLOT
# Colours that differ in lightness too, each with a contrast of at least 4.5 to white.
COLOURS = ("#0064a0", "#b83200", "#00664a", "#9a3d77", "#6b5100", "#444c54")
# Marks about the origin; their number has no common factor with that of the colours, so that pairs repeat late.
SHAPES = (
    "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z",
    "M-4.5 -4.5h9v9h-9z",
    "M0 -5.5L5.5 4.5H-5.5z",
    "M0 -6L5.5 0L0 6L-5.5 0z",
    "M0 5.5L5.5 -4.5H-5.5z",
    "M-2 -5.5h4v3.5h3.5v4h-3.5v3.5h-4v-3.5h-3.5v-4h3.5z",
    "M0 -6L1.8 -2H6L2.8 1.2L4 5.8L0 3.2L-4 5.8L-2.8 1.2L-6 -2H-1.8z",
)
PREFIXES = {-12: "ps", -9: "ns", -6: "µs", -3: "ms", 0: "s", 3: "ks"}
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
DEFAULT, FRONT = ('fill="none" stroke="#1b2127" stroke-width="2"',
                  'fill="none" stroke="#8d979f" stroke-width="4" stroke-linejoin="round"')  # fmt: skip


def chart_svg(one: FamilyChart, weighed: bool = False, alone: bool = False) -> str:
    """The picture as one `svg` element, `alone` in a file; with `weighed`, the results' weight replaces the time."""
    family, points = one.family, one.view(weighed)
    across = f"{family.weighed if weighed else 'time'} per {family.per}"
    label = f"{family.title}: {len(points)} points, {across} against error in {family.unit}"
    shown = [(k, m) for k, m in enumerate(family.methods) if any(p.method == m.name for p in one.points)]
    height = max(LEAST_HEIGHT, TOP + ROW * (len(shown) + 4)) + 54
    errors = [e for p in one.points if np.isfinite(e := one.shown_error(p))] or [family.floor]
    axes = _Axes(_decades([cost for _, cost, _ in points]), _decades(errors), height - TOP - 54)
    unit, paper = ("mm", ' style="background:#fff"') if alone else ("", "")
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}{unit}" '
            f'height="{height}{unit}"{paper} role="img" aria-label="{text(label)}" '
            'font-family="DejaVu Sans, Verdana, sans-serif" font-size="12" fill="#1b2127">',
            f'<text x="{LEFT}" y="24" font-size="16" font-weight="bold">{text(family.title)}</text>',
            *_grid(axes, across, family.unit, (lambda power: f"{10**power:,}") if weighed else _seconds),
            *_front(axes, sorted({(cost, one.shown_error(p)) for p, cost, on in points if on})),
            *(line for k, m in enumerate(family.methods) for line in _marks(one, weighed, axes, m, k)),
            *_legend(shown),
            "</svg>",
        ]
    )


@record
class _Axes:
    """Decades shown, across and upwards: from the first to the last of each pair."""

    across: tuple[int, int]
    upwards: tuple[int, int]
    height: int

    def x(self, cost: float) -> float:
        first, last = self.across
        return LEFT + PLOT * (float(np.log10(cost)) - first) / (last - first)

    def y(self, error: float) -> float:
        first, last = self.upwards
        return TOP + self.height * (last - float(np.log10(error))) / (last - first)


def _decades(values: list[float]) -> tuple[int, int]:
    """From a little below the least value to a little above the largest."""
    return int(np.floor(np.log10(min(values)) - 0.15)), int(np.ceil(np.log10(max(values)) + 0.15))


def _ticks(decades: tuple[int, int], most: int) -> range:
    """At most so many powers of ten, evenly."""
    first, last = decades
    return range(first, last + 1, -(-(last - first) // most))


def _grid(axes: _Axes, across: str, unit: str, label: Callable[[int], str]) -> Iterator[str]:
    bottom = TOP + axes.height
    for power in _ticks(axes.across, 6):
        x = _n(axes.x(10.0**power))
        yield f'<path d="M{x} {TOP}V{_n(bottom)}" stroke="#dde2e6"/>'
        yield f'<text x="{x}" y="{_n(bottom + 17)}" text-anchor="middle">{label(power)}</text>'
    for power in _ticks(axes.upwards, 9):
        y = _n(axes.y(10.0**power))
        yield f'<path d="M{LEFT} {y}H{RIGHT}" stroke="#dde2e6"/>'
        name = "10" + str(power).translate(RAISED) if abs(power) > 3 else f"{10.0**power:g}"
        yield f'<text x="{LEFT - 7}" y="{y}" dy="4" text-anchor="end">{name}</text>'
    yield f'<path d="M{LEFT} {TOP}V{_n(bottom)}H{RIGHT}" fill="none" stroke="#1b2127"/>'
    yield f'<text x="{LEFT + PLOT / 2:g}" y="{_n(bottom + 40)}" text-anchor="middle">{text(across)}</text>'
    turned = f'transform="translate(16 {_n(TOP + axes.height / 2)}) rotate(-90)"'
    yield f'<text {turned} text-anchor="middle">largest error, {text(unit)}</text>'


def _seconds(power: int) -> str:
    """10^power seconds with a prefix."""
    prefix = min(max(3 * (power // 3), min(PREFIXES)), max(PREFIXES))
    return f"{10.0 ** (power - prefix):g} {PREFIXES[prefix]}"


def _front(axes: _Axes, best: list[tuple[float, float]]) -> Iterator[str]:
    """Steps along the front: the least error for each cost."""
    if best:
        steps = "".join(f"H{_n(axes.x(cost))}V{_n(axes.y(error))}" for cost, error in best)
        yield f'<path class="front" d="M{_n(axes.x(best[0][0]))} {TOP}{steps}H{RIGHT}" {FRONT}/>'


def _marks(one: FamilyChart, weighed: bool, axes: _Axes, method: Method, k: int) -> Iterator[str]:
    """A method's points, connected by a line; full on the front, hollow off it."""
    points = [v for v in one.view(weighed) if v[0].method == method.name and np.isfinite(v[0].largest)]
    places = [(_n(axes.x(cost)), _n(axes.y(one.shown_error(p)))) for p, cost, _ in points]
    colour, shape = _look(k)
    if len(places) > 1:
        line = "L".join(f"{x} {y}" for x, y in places)
        yield f'<path d="M{line}" fill="none" stroke="{colour}" stroke-width="1" stroke-dasharray="2 2"/>'
    for (p, cost, on), (x, y) in zip(points, places):
        place = f'transform="translate({x} {y})"'
        if method.is_default:
            yield f'<circle {place} r="10" {DEFAULT}/>'
        setting = f" ({method.setting} {p.setting:g})" if method.setting else ""
        said = f"{cost:g} {one.family.weighed}" if weighed else f"{cost:.2g} s"
        tooltip = f"{p.method}{setting}: {said} per {one.family.per}, error {p.largest:.2g}"
        yield (
            f'<path class="point" {place} d="{shape}" fill="{colour if on else "#fff"}" stroke="{colour}" '
            f'stroke-width="1.8"><title>{text(tooltip)}</title></path>'
        )


def _look(k: int) -> tuple[str, str]:
    """Colour and mark of the k-th method."""
    return COLOURS[k % len(COLOURS)], SHAPES[k % len(SHAPES)]


def _legend(methods: list[tuple[int, Method]]) -> Iterator[str]:
    x, y = RIGHT + 24, TOP + 8
    for k, method in methods:
        colour, shape = _look(k)
        yield f'<path transform="translate({x} {y})" d="{shape}" fill="{colour}" stroke="{colour}"/>'
        weight = ' font-weight="bold"' if method.is_default else ""
        if method.is_default:
            yield f'<circle cx="{x}" cy="{y}" r="9" {DEFAULT}/>'
        yield f'<text x="{x + 16}" y="{y}" dy="4"{weight}>{text(method.name)}</text>'
        y += ROW
    y += ROW // 2
    yield f'<path d="M{x - 8} {y}h16" {FRONT}/><text x="{x + 16}" y="{y}" dy="4">Pareto front: nothing beats it</text>'
    y += ROW
    yield f'<circle cx="{x}" cy="{y}" r="7" {DEFAULT}/>'
    yield f'<text x="{x + 16}" y="{y}" dy="4">the library&#8217;s default</text>'
    yield f'<text x="{x - 8}" y="{y + ROW}" dy="4">full: on the front; hollow: off it</text>'


def _n(value: float) -> str:
    return f"{value:.1f}".removesuffix(".0")
