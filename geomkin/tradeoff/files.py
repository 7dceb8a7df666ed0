"""The chart as files: all points as CSV, a picture of each family, and a page."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping

import numpy as np

from .page import page
from .picture import picture
from .results import Chart, FamilyChart
from .study import Stability

# Columns of `chart.csv`, after which come the versions and the processor.
COLUMNS = (
    "family", "method", "default", "on_front", "setting_name", "setting", "error_unit", "largest_error", "rms_error",
    "missed_share", "per", "seconds_per_result", "results_per_call", "calls_per_batch", "batches", "spread",
    "weight_name", "weight", "on_weight_front",
)  # fmt: skip


def chart_files(chart: Chart, study: Stability | None = None) -> Mapping[str, bytes]:
    """`chart.csv`, `chart.html`, and a picture `<family>.svg` of each family: name to content.

    Where results have a weight, such as bytes, there is `<family>-by-bytes.svg` too. study: of where methods break, for
    a table of the page and `stability.csv`.
    """
    pictures = {f"{one.family.name}.svg": picture(one) for one in chart.families}
    pictures |= {
        f"{one.family.name}-by-{one.family.weighed}.svg": picture(one, True)
        for one in chart.families
        if one.family.weigh
    }
    broken = {} if study is None else {"stability.csv": study.csv()}
    return {"chart.csv": _csv(chart), "chart.html": page(chart, study), **broken, **pictures}


def _csv(chart: Chart) -> bytes:
    """Every point with all that is known of it, as UTF-8 CSV; what is nan is left empty."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*COLUMNS, *(f"{name}_version" for name in chart.versions), "processor"])
    for one in chart.families:
        writer.writerows([*row, *chart.versions.values(), chart.processor] for row in _rows(one))
    return stream.getvalue().encode("utf-8")


def _rows(one: FamilyChart) -> Iterator[list[object]]:
    methods = {method.name: method for method in one.family.methods}
    fronts = zip(one.points, one.on_front.tolist(), one.on_weight_front.tolist())
    for p, on, light in fronts:
        method = methods[p.method]
        yield [
            p.family, p.method, int(method.is_default), int(on), method.setting, _n(p.setting), one.family.unit,
            _n(p.largest), _n(p.rms), _n(p.missed), one.family.per, _n(p.seconds), p.results, p.calls, p.batches,
            _n(p.spread), one.family.weighed, _n(p.weight), int(light) if one.family.weigh else "",
        ]  # fmt: skip


def _n(value: float) -> str:
    return f"{value:.6g}" if np.isfinite(value) else ""
