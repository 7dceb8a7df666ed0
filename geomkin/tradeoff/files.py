"""The chart as files: all points as CSV, a picture of each family, and a page with tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping

import numpy as np

from ..core.fields import to_digits
from ..export.text import text
from ..page.page import head
from .family import Method
from .picture import chart_picture, chart_svg
from .results import Chart, FamilyChart, Measurement
from .study import Stability

# Columns of `chart.csv`, after which come the versions and the processor.
COLUMNS = (
    "family", "method", "default", "on_front", "setting_name", "setting", "error_unit", "largest_error", "rms_error",
    "missed_share", "per", "seconds_per_result", "results_per_call", "calls_per_batch", "batches", "spread",
    "weight_name", "weight", "on_weight_front",
)  # fmt: skip
STYLE = """
:root { color-scheme: light dark; --paper: #fff; --ink: #1b2127; --soft: #55606b; --edge: #c9d0d6; --key: #0064a0; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #14181c; --ink: #e8ecef; --soft: #a9b4bd; --edge: #3d464e; --key: #6fbdf2; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 16px clamp(10px, 3vw, 32px) 48px; max-width: 1000px; background: var(--paper);
  color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", sans-serif; }
h1 { margin: 0; font-size: 26px; }
h2 { margin: 44px 0 8px; font-size: 20px; }
p, dd, li { max-width: 75ch; }
a { color: var(--key); }
:focus-visible { outline: 2px solid var(--key); outline-offset: 2px; }
.soft { color: var(--soft); }
.wide { overflow-x: auto; margin: 12px 0; }
svg { display: block; background: #fff; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 10px; text-align: right; border-bottom: 1px solid var(--edge); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
tr.default th { font-weight: 700; } tbody th { font-weight: 400; }
summary { cursor: pointer; min-height: 28px; }
dt { font-weight: 600; margin-top: 8px; } dd { margin: 0 0 0 1.2em; }
@media print { details > * { display: block; } }
""".strip()


def chart_files(chart: Chart, study: Stability | None = None) -> Mapping[str, bytes]:
    """Contents of the files of a chart.

    Parameters
    ----------
    chart : Chart
        The measured points.
    study : Stability, optional
        Adds a table to the page, and `stability.csv`.

    Returns
    -------
    mapping of str to bytes
        `chart.csv`, `chart.html`, and a picture `<family>.svg` of each family, or also `<family>-by-bytes.svg` if its
        results have a weight such as bytes.
    """
    pictures = {f"{measured.family.name}.svg": chart_picture(measured) for measured in chart.families}
    pictures |= {
        f"{measured.family.name}-by-{measured.family.weighed}.svg": chart_picture(measured, True)
        for measured in chart.families
        if measured.family.weigh
    }
    broken = {} if study is None else {"stability.csv": study.csv()}
    return {"chart.csv": _csv(chart), "chart.html": chart_page(chart, study), **broken, **pictures}


def _csv(chart: Chart) -> bytes:
    """All points as UTF-8 CSV; nan is an empty cell."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*COLUMNS, *(f"{name}_version" for name in chart.versions), "processor"])
    for measured in chart.families:
        writer.writerows([*row, *chart.versions.values(), chart.processor] for row in _rows(measured))
    return stream.getvalue().encode("utf-8")


def _rows(measured: FamilyChart) -> Iterator[list[object]]:
    methods = {method.name: method for method in measured.family.methods}
    fronts = zip(measured.points, measured.on_front.tolist(), measured.on_weight_front.tolist())
    for p, on, light in fronts:
        method = methods[p.method]
        yield [
            p.family, p.method, int(method.is_default), int(on), method.setting, _n(p.setting), measured.family.unit,
            _n(p.largest), _n(p.rms), _n(p.missed), measured.family.per, _n(p.seconds), p.results, p.calls, p.batches,
            _n(p.spread), measured.family.weighed, _n(p.weight), int(light) if measured.family.weigh else "",
        ]  # fmt: skip


def _n(value: float) -> str:
    return f"{value:.6g}" if np.isfinite(value) else ""


def chart_page(chart: Chart, study: Stability | None = None) -> bytes:
    """One HTML file without scripts or references to other files."""
    hurried = " This is a quick chart with fewer settings and noisier times." if chart.quick else ""
    versions = ", ".join(f"{name} {version}" for name, version in chart.versions.items())
    links = "".join(
        f'<li><a href="#{_id(measured)}">{text(measured.family.title)}</a></li>' for measured in chart.families
    )
    links += '<li><a href="#stability">Where methods break</a></li>' if study else ""
    html = f"""{head("geomkin: speed against accuracy", STYLE)}<body>
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
{"".join(_section(measured) for measured in chart.families)}{study.section() if study else ""}</main>
</body>
</html>
"""
    return html.encode("utf-8", "replace")


def _section(one: FamilyChart) -> str:
    family = one.family
    return f"""<section id="{_id(one)}">
<h2>{text(family.title)}</h2>
<p>{text(family.about)}</p>
{_verdict(one)}
<div class="wide" tabindex="0" role="region" aria-label="Picture: {text(family.title)}">{chart_svg(one)}</div>
{_weights(one)}<p class="soft">Reference: {text(family.reference)}. Errors below
{_number(family.floor)} {text(family.unit)} are rounding.</p>
<details><summary>The methods</summary><dl>{"".join(_definition(method) for method in family.methods)}</dl></details>
<details><summary>The numbers</summary>
<div class="wide" tabindex="0" role="region" aria-label="Numbers: {text(family.title)}">{_table(one)}</div></details>
</section>
"""


def _weights(one: FamilyChart) -> str:
    """A picture with the weight of the results in place of their time, if they have one."""
    family = one.family
    if not family.weigh:
        return ""
    label, weighed = f"Picture: {text(family.title)}, {text(family.weighed)}", text(family.weighed)
    light = [bool(on) for p, on in zip(one.points, one.on_weight_front) if p in [q for q, _ in one.defaults]]
    verdict = f"Here the default is on the front at {sum(light)} of {len(light)} settings." if light else ""
    return f"""<p>The {weighed} of the results are a further cost. {verdict}</p>
<div class="wide" tabindex="0" role="region" aria-label="{label}">{chart_svg(one, True)}</div>
"""


def _verdict(one: FamilyChart) -> str:
    """The default method, its rationale, and whether it is on the front."""
    lines = []
    for method in one.family.methods:
        on_front = [on for point, on in one.defaults if point.method == method.name]
        if not on_front:
            continue
        verdict = "It is on the front."
        if not all(on_front):
            summary = (
                "It is not on the front"
                if not any(on_front)
                else f"It is on the front at {sum(on_front)} of {len(on_front)}"
            )
            verdict = f"{summary}: {_beaten(one, method)}. {text(method.caveat)}"
        lines.append(f"<p>The default is <strong>{text(method.name)}</strong>: {text(method.rationale)} {verdict}</p>")
    return "\n".join(lines)


def _beaten(one: FamilyChart, method: Method[object, object]) -> str:
    """The methods that beat the default, and by how much."""
    messages: dict[str, str] = {}
    for point, on in one.defaults:
        if on or point.method != method.name:
            continue
        error, seconds = one.shown_error(point), to_digits(point.seconds, 6)
        better = [p for p, q in zip(one.points, one.on_front) if q and to_digits(p.seconds, 6) <= seconds]
        better = [p for p in better if one.shown_error(p) <= error]
        if better:
            best = min(better, key=lambda p: p.seconds)
            messages.setdefault(best.method, f"{best.method} takes {best.seconds / point.seconds:.0%} of its time")
    return text("; ".join(messages.values()) or "it misses results")


def _definition(method: Method[object, object]) -> str:
    left_out = " It is slow; a quick chart leaves it out." if method.slow else ""
    return f"<dt>{text(method.name)}</dt><dd>{text(method.about)}{left_out}</dd>"


def _table(one: FamilyChart) -> str:
    methods = {method.name: method for method in one.family.methods}
    unit, per = text(one.family.unit), text(one.family.per)
    heads = (
        "method", "setting", f"largest error, {unit}", f"rms error, {unit}", f"time per {per}", "on the front",
        "measured", "spread", *([text(one.family.weighed)] if one.family.weigh else ()),
    )  # fmt: skip
    rows = "".join(_row(methods[p.method], p, bool(on)) for p, on in zip(one.points, one.on_front))
    head = "".join(f'<th scope="col">{name}</th>' for name in heads)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _row(method: Method[object, object], p: Measurement, on: bool) -> str:
    name = text(method.name) + (" (default)" if method.is_default else "")
    setting = f"{text(method.setting)} {p.setting:g}" if method.setting else ""
    missed = f", misses {p.missed:.1%}" if p.missed else ""
    weight = f"<td>{p.weight:g}</td>" if np.isfinite(p.weight) else ""
    often = f"{p.batches} times {p.calls} calls of {p.results}"
    return (
        f'<tr{" class=default" if method.is_default else ""}><th scope="row">{name}</th><td>{setting}</td>'
        f"<td>{_number(p.largest)}{missed}</td><td>{_number(p.rms)}</td><td>{_time(p.seconds)}</td>"
        f"<td>{'yes' if on else 'no'}</td><td>{often}</td><td>{p.spread:.0%}</td>{weight}</tr>"
    )


def _time(seconds: float) -> str:
    for unit, scale in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _number(value: float) -> str:
    return f"{value:.2g}".replace("-", "\N{MINUS SIGN}") if np.isfinite(value) else "none"


def _id(one: FamilyChart) -> str:
    return text(one.family.name)
