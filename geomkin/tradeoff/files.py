"""The chart as files: all points as CSV, a picture of each family, and a page with tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import numpy as np

from ..core.fields import to_digits
from ..core.records import record
from ..export.text import text
from ..page.page import head, player_file
from .families import FAMILIES
from .family import Method
from .measurement import EXPLANATION, HEADS, MISSING, Chart, FamilyChart, Measurement, Stability

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
        x = _count(axes.x(10.0**power))
        yield f'<path d="M{x} {TOP}V{_count(bottom)}" stroke="#dde2e6"/>'
        yield f'<text x="{x}" y="{_count(bottom + 17)}" text-anchor="middle">{label(power)}</text>'
    for power in _ticks(axes.upwards, 9):
        y = _count(axes.y(10.0**power))
        yield f'<path d="M{LEFT} {y}H{RIGHT}" stroke="#dde2e6"/>'
        name = "10" + str(power).translate(RAISED) if abs(power) > 3 else f"{10.0**power:g}"
        yield f'<text x="{LEFT - 7}" y="{y}" dy="4" text-anchor="end">{name}</text>'
    yield f'<path d="M{LEFT} {TOP}V{_count(bottom)}H{RIGHT}" fill="none" stroke="#1b2127"/>'
    yield f'<text x="{LEFT + PLOT / 2:g}" y="{_count(bottom + 40)}" text-anchor="middle">{text(across)}</text>'
    turned = f'transform="translate(16 {_count(TOP + axes.height / 2)}) rotate(-90)"'
    yield f'<text {turned} text-anchor="middle">largest error, {text(unit)}</text>'


def _seconds(power: int) -> str:
    """10^power seconds with a prefix."""
    prefix = min(max(3 * (power // 3), min(PREFIXES)), max(PREFIXES))
    return f"{10.0 ** (power - prefix):g} {PREFIXES[prefix]}"


def _front(axes: _Axes, best: list[tuple[float, float]]) -> Iterator[str]:
    """Steps along the front: the least error for each cost."""
    if best:
        steps = "".join(f"H{_count(axes.x(cost))}V{_count(axes.y(error))}" for cost, error in best)
        yield f'<path class="front" d="M{_count(axes.x(best[0][0]))} {TOP}{steps}H{RIGHT}" {FRONT}/>'


def _marks(one: FamilyChart, weighed: bool, axes: _Axes, method: Method, k: int) -> Iterator[str]:
    """A method's points, connected by a line; full on the front, hollow off it."""
    points = [v for v in one.view(weighed) if v[0].method == method.name and np.isfinite(v[0].largest)]
    places = [(_count(axes.x(cost)), _count(axes.y(one.shown_error(p)))) for p, cost, _ in points]
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


def _count(value: float) -> str:
    return f"{value:.1f}".removesuffix(".0")


# Columns of `chart.csv`, after which come the versions and the processor.
COLUMNS = (
    "family", "method", "default", "on_front", "setting_name", "setting", "error_unit", "largest_error", "rms_error",
    "missed_share", "per", "seconds_per_result", "results_per_call", "calls_per_batch", "batches", "spread",
    "weight_name", "weight", "on_weight_front",
)  # fmt: skip
# What this page adds to the style of all pages.
STYLE = """
body { max-width: 1000px; } main, dl { display: block; } .soft { color: var(--soft); } dt { font-weight: 600; }
.wide { margin: 12px 0; } .wide svg { display: block; background: #fff; } .wide :is(th, td) { white-space: nowrap; }
@media print { details > * { display: block; } }
"""


def chart_files(chart: Chart, study: Stability | None = None) -> Mapping[str, bytes]:
    """Contents of the files of a chart.

    Parameters
    ----------
    chart : Chart
        The measured points.
    study : Stability, optional
        Adds a table to the page, and `stability.csv`. A page of all families without it says how to get it.

    Returns
    -------
    mapping of str to bytes
        `chart.csv`, `chart.html`, and a picture `<family>.svg` of each family, or also `<family>-by-bytes.svg` if its
        results have a weight such as bytes.
    """
    contents = {"chart.csv": _csv(chart), "chart.html": _page(chart, study)}
    contents |= {} if study is None else {"stability.csv": study.csv()}
    for one in chart.families:
        for weighed in (False, True)[: 1 + bool(one.family.weigh)]:
            name = f"{one.family.name}-by-{one.family.weighed}" if weighed else one.family.name
            svg = f'<?xml version="1.0" encoding="UTF-8"?>\n{chart_svg(one, weighed, alone=True)}\n'
            contents[f"{name}.svg"] = svg.encode("utf-8")
    return contents


def _csv(chart: Chart) -> bytes:
    """All points as UTF-8 CSV; nan is an empty cell."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*COLUMNS, *(f"{name}_version" for name in chart.versions), "processor"])
    for one in chart.families:
        family, methods = one.family, {method.name: method for method in one.family.methods}
        for p, on, light in zip(one.points, one.on_front.tolist(), one.on_weight_front.tolist()):
            method = methods[p.method]
            writer.writerow([
                p.family, p.method, int(method.is_default), int(on), method.setting, _n(p.setting), family.unit,
                _n(p.largest), _n(p.rms), _n(p.missed), family.per, _n(p.seconds), p.results, p.calls, p.batches,
                _n(p.spread), family.weighed, _n(p.weight), int(light) if family.weigh else "",
                *chart.versions.values(), chart.processor,
            ])  # fmt: skip
    return stream.getvalue().encode("utf-8")


def _n(value: float) -> str:
    return f"{value:.6g}" if np.isfinite(value) else ""


def _page(chart: Chart, study: Stability | None) -> bytes:
    """One HTML file without scripts or references to other files."""
    hurried = " This is a quick chart with fewer settings and noisier times." if chart.quick else ""
    versions = ", ".join(f"{name} {version}" for name, version in chart.versions.items())
    titles = {one.family.name: one.family.title for one in chart.families}
    stability = ""
    if study or set(titles) == set(FAMILIES):
        titles["stability"] = "Where methods break"
        table = _html_table("Where methods break", HEADS, study.table) if study else ""
        content = f"<p>{EXPLANATION if study else MISSING}</p>{table}"
        stability = f'<section id="stability"><h2>{titles["stability"]}</h2>\n{content}</section>'
    links = "".join(f'<li><a href="#{text(name)}">{text(title)}</a></li>' for name, title in titles.items())
    html = f"""{head("geomkin: speed against accuracy", player_file("style.css") + STYLE)}<body>
<header><h1>Speed against accuracy</h1></header>
<main>
<p>Each picture below compares the methods for one kind of result: from left to right the time that a method takes,
from bottom to top the error of its results. Both axes are logarithmic.
The lower left is best: fast and accurate. The grey line is the Pareto front: no other method beats a point on it
in both time and error. Points off it are beaten, or miss results. A ring marks the default method of
the library.</p>
<p>Measured with {text(versions)} on {text(chart.processor)}.{hurried} Times are processor times: the least of
several batches of calls, divided by the number of results. Preparation that is done once is not included; the
description of the method names it. The spread is the relative excess of the median batch over the least: the noise
of a time. Errors below the level of rounding count as equal.</p>
<nav aria-label="Families"><ul>{links}</ul></nav>
{"".join(_section(measured) for measured in chart.families)}{stability}</main>
</body>
</html>
"""
    return html.encode("utf-8", "replace")


def _section(one: FamilyChart) -> str:
    family, title = one.family, text(one.family.title)
    verdicts = "\n".join(_verdict(one, method) for method in family.methods if method.is_default)
    slow = " It is slow; a quick chart leaves it out."
    methods = "".join(
        f"<dt>{text(m.name)}</dt><dd>{text(m.about)}{slow if m.slow else ''}</dd>" for m in family.methods
    )
    return f"""<section id="{text(family.name)}">
<h2>{title}</h2>
<p>{text(family.about)}</p>
{verdicts}
<div class="wide" tabindex="0" role="region" aria-label="Picture: {title}">{chart_svg(one)}</div>
{_weights(one)}<p class="soft">Reference: {text(family.reference)}. Errors below
{_number(family.floor)} {text(family.unit)} are rounding.</p>
<details><summary>The methods</summary><dl>{methods}</dl></details>
<details><summary>The numbers</summary>
{_table(one)}</details>
</section>
"""


def _weights(one: FamilyChart) -> str:
    """A picture with the weight of the results in place of their time, if they have one."""
    if not one.family.weigh:
        return ""
    weighed, defaults = text(one.family.weighed), {m.name for m in one.family.methods if m.is_default}
    light = [on for p, _, on in one.view(weighed=True) if p.method in defaults]
    verdict = f"Here the default is on the front at {sum(light)} of {len(light)} settings." if light else ""
    return f"""<p>The {weighed} of the results are a further cost. {verdict}</p>
<div class="wide" tabindex="0" role="region" aria-label="Picture: {text(one.family.title)}, {weighed}">{
        chart_svg(one, True)
    }</div>
"""


def _verdict(one: FamilyChart, method: Method) -> str:
    """The default method, its rationale, and whether it is on the front."""
    view = one.view()
    on_front = [on for p, _, on in view if p.method == method.name]
    verdict, beaten = "It is on the front.", dict[str, str]()
    if not all(on_front):
        share = f"on the front at {sum(on_front)} of {len(on_front)}" if any(on_front) else "not on the front"
        for p in [p for p, _, on in view if p.method == method.name and not on]:
            seconds = to_digits(p.seconds, 6)
            better = [q for q, cost, on in view if on and to_digits(cost, 6) <= seconds]
            better = [q for q in better if one.shown_error(q) <= one.shown_error(p)]
            if better:
                best = min(better, key=lambda q: q.seconds)
                beaten.setdefault(best.method, f"{best.method} takes {best.seconds / p.seconds:.0%} of its time")
        verdict = f"It is {share}: {text('; '.join(beaten.values()) or 'it misses results')}. {text(method.caveat)}"
    return f"<p>The default is <strong>{text(method.name)}</strong>: {text(method.rationale)} {verdict}</p>"


def _table(one: FamilyChart) -> str:
    family, methods = one.family, {method.name: method for method in one.family.methods}
    heads = (
        "method", "setting", f"largest error, {family.unit}", f"rms error, {family.unit}", f"time per {family.per}",
        "on the front", "measured", "spread", *([family.weighed] if family.weigh else ()),
    )  # fmt: skip

    def row(p: Measurement, on: bool) -> tuple[str, ...]:
        method, missed = methods[p.method], f", misses {p.missed:.1%}" if p.missed else ""
        return (
            p.method + (" (default)" if method.is_default else ""),
            f"{method.setting} {p.setting:g}" if method.setting else "",
            _number(p.largest) + missed, _number(p.rms), _time(p.seconds), "yes" if on else "no",
            f"{p.batches} times {p.calls} calls of {p.results}", f"{p.spread:.0%}",
            *([f"{p.weight:g}"] if family.weigh else ()),
        )  # fmt: skip

    return _html_table(f"Numbers: {family.title}", heads, [row(p, on) for p, _, on in one.view()])


def _html_table(label: str, heads: Iterable[str], rows: Iterable[Sequence[str]]) -> str:
    """A table whose first column has the headings of its rows."""
    head = "".join(f'<th scope="col">{text(name)}</th>' for name in heads)
    body = "".join(
        f'<tr><th scope="row">{text(row[0])}</th>{"".join(f"<td>{text(cell)}</td>" for cell in row[1:])}</tr>'
        for row in rows
    )
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    return f'<div class="wide" tabindex="0" role="region" aria-label="{text(label)}">{table}</div>'


def _time(seconds: float) -> str:
    for unit, scale in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _number(value: float) -> str:
    return f"{value:.2g}".replace("-", "\N{MINUS SIGN}") if np.isfinite(value) else "none"
