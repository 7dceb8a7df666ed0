"""The chart as files: all points as CSV, a picture of each family, and a page with tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ..core.fields import to_digits
from ..export.text import text
from ..page.page import head, player_file
from .families import FAMILIES
from .family import Method
from .measurement import Chart, FamilyChart, Measurement
from .picture import chart_svg
from .study import EXPLANATION, HEADS, MISSING, Stability

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
