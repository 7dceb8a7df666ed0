"""Tables as CSV, with units in their header, and the plots of a scene as SVG files."""

from __future__ import annotations

import csv as text_csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from math import inf, isnan

import numpy as np

from ..core.errors import harmless
from ..model.scene import Hodograph, Limit, Plot
from ..model.table import Column, Table, table_in
from ..plane.vec import Real
from .job import Job
from .still import kept_frames, palette
from .text import number, text, unit_sign


def table_file(job: Job) -> bytes:
    """The table of the motion as CSV."""
    return csv(job.table)


def csv(table: Table, infinite: str = "") -> bytes:
    """The table as UTF-8 CSV. nan becomes an empty cell; so does infinity, unless a text for it is given."""
    stream = io.StringIO()
    writer = text_csv.writer(stream, lineterminator="\n")
    writer.writerow([_harmless(c.header) for c in table.columns])
    writer.writerows(zip(*[_cells(c, infinite) for c in table.columns]))
    return stream.getvalue().encode("utf-8")


def _cells(column: Column, infinite: str) -> list[str]:
    values = column.written
    if values.dtype.kind in "iub":
        return [str(int(v)) for v in values.tolist()]
    if values.dtype.kind != "f":
        return [_harmless(str(v)) for v in values.tolist()]
    words = {inf: infinite, -inf: infinite and f"-{infinite}"}
    return ["" if isnan(v) else words.get(v, repr(v)) for v in values.tolist()]


def _harmless(text: str) -> str:
    """Text that a spreadsheet does not execute and a terminal does not interpret; formulas are quoted."""
    return f"'{harmless(text)}" if text.lstrip()[:1] in tuple("=+-@\uff1d\uff0b\uff0d\uff20|") else harmless(text)


def bill_file(job: Job) -> bytes:
    """The bill of materials as CSV."""
    return csv(table_in(job.unit, bill(job)))


def bill(job: Job) -> Table:
    """The bill of materials: a row for each part, with its drawn width and height, mm, and for each bought item."""
    cuts, bought = job.solids, job.source.bought
    sizes = np.array([cut.box[1] - cut.box[0] for cut in cuts], dtype=complex)
    no_sizes = [np.nan] * len(bought)
    joints = [" ".join(letters) for letters in (*(cut.part.joints for cut in cuts), *(b.joints for b in bought))]
    return Table(
        (
            Column("item", "", "part or item", np.array([*(cut.part.name for cut in cuts), *(b.name for b in bought)])),
            Column("count", "", "quantity", np.array([*(cut.part.count for cut in cuts), *(b.count for b in bought)])),
            Column(
                "thickness",
                "mm",
                "thickness of the sheet",
                np.array([*(cut.part.thickness for cut in cuts), *no_sizes]),
            ),
            Column("width", "mm", "width along x", np.array([*sizes.real.tolist(), *no_sizes])),
            Column("height", "mm", "height along y", np.array([*sizes.imag.tolist(), *no_sizes])),
            Column("joints", "", "joints or parts it belongs to", np.array(joints)),
        )
    )


# Width of a file, mm, that of a text column, and in the units of all sizes inside it. Letters are 2.8 mm high.
WIDTH, WIDE = 160, 640
# Margins on the left, above, on the right and below the axes, height of the axes, and of a line of the legend.
LEFT, TOP, RIGHT, BELOW, HIGH, ROW = 74, 34, 18, 46, 240, 18
# Largest numbers of intervals between the ticks of the horizontal and of the vertical axis.
MOST_ACROSS, MOST_UP = 9, 6
# Steps between ticks of an axis in deg, and of any other one in a decade.
DEGREES, STEPS = (1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360), (1, 2, 5, 10)
# Colours in the page's palette, and dashes, which distinguish the curves without colour.
STROKES = ("wanted", "traced", "velocity", "acceleration", "s4", "s5")
DASHES = ("none", "7 3", "2 3", "9 3 2 3", "13 4", "4 2 1 2")
# Width of a dot.
DOT = 7
# Room above and below the curves as a share of their range.
MARGIN = 0.06


def write_plots(job: Job) -> dict[str, bytes]:
    """One file per plot and hodograph, named after the recipe and its title."""
    scene = job.scene
    files = [(plot.title, plot_file(scene.table, plot)) for plot in scene.plots]
    files += [(hodograph.title, hodograph_file(scene.table, hodograph)) for hodograph in scene.hodographs]
    if scene.choice is not None:
        files += [(plot.title, plot_file(scene.choice.table, plot)) for plot in scene.choice.plots]
    contents: dict[str, bytes] = {}
    for title, content in files:
        stem = re.sub(r"\W+", "-", title).strip("-")
        names = (f"{job.name}-{stem}{suffix}-plot.svg" for suffix in ("", *(f"-{k}" for k in range(2, 100))))
        contents[next(name for name in names if name not in contents)] = content
    return contents


def plot_file(table: Table, plot: Plot, dots: bool = False) -> bytes:
    """A plot of columns of a table over its first column, as an SVG file; with `dots` each value is a dot."""
    drive, columns = table.columns[0], [table.column(id) for id in plot.columns]
    frames = kept_frames(len(drive.values))
    x = np.asarray(drive.values, dtype=float)[frames]
    rows = [np.asarray(column.values, dtype=float)[frames] for column in columns]
    rows = [np.where(np.abs(row) <= plot.most, row, np.nan) for row in rows]
    low, high = _range(rows, plot.limits)
    across = _Axis(*_ends(x), LEFT, WIDE - RIGHT)
    up = _Axis(low, high, TOP + HIGH, TOP)
    colours = palette()
    lines = [
        *(_limit(limit, up, colours["wanted"]) for limit in plot.limits),
        *(_curve(across, up, x, row, _look(k, colours, dots), dots) for k, row in enumerate(rows)),
    ]
    grid = _grid(across, up, drive.unit, columns[0].unit, colours["grid"])
    titles = _axis_titles(up, _column_title(drive), _quantity(columns))
    return _file(plot.title, (*grid, *titles), lines, _legend(columns, up, colours, dots), up.start, len(columns))


def hodograph_file(table: Table, hodograph: Hodograph) -> bytes:
    """The paths of the tips of vectors drawn from the origin, at one scale on both axes, as an SVG file."""
    columns = [table.column(id) for id in hodograph.columns]
    frames = kept_frames(len(table.columns[0].values))
    x, y = ([np.asarray(table[f"{id}_{axis}"], dtype=float)[frames] for id in hodograph.columns] for axis in "xy")
    ends = [_ends(np.append(np.concatenate(values), 0.0)) for values in (x, y)]
    half = (0.5 + MARGIN) * max(high - low for low, high in ends)
    middles = [(low + high) / 2 for low, high in ends]
    across = _Axis(middles[0] - half, middles[0] + half, LEFT, WIDE - RIGHT)
    up = _Axis(middles[1] - half, middles[1] + half, TOP + WIDE - RIGHT - LEFT, TOP)
    colours, unit = palette(), columns[0].unit
    curves = [_curve(across, up, *row, _look(k, colours, False), False) for k, row in enumerate(zip(x, y))]
    origin = f'<circle cx="{across.at(0.0):.2f}" cy="{up.at(0.0):.2f}" r="3"/>'
    names = (text(f"{axis}, {unit_sign(unit)}") for axis in "xy")
    grid = _grid(across, up, unit, unit, colours["grid"])
    axes = (*grid, *_axis_titles(up, *names))
    return _file(hodograph.title, axes, [origin, *curves], _legend(columns, up, colours, False), up.start, len(columns))


def _axis_titles(up: _Axis, across_title: str, up_title: str) -> Iterator[str]:
    yield f'<text x="{(LEFT + WIDE - RIGHT) / 2:g}" y="{up.start + 36:g}" text-anchor="middle">{across_title}</text>'
    yield f'<text transform="translate(16 {(up.start + up.end) / 2:g}) rotate(-90)" text-anchor="middle">'
    yield f"{up_title}</text>"


def _file(
    title: str, axes: Iterable[str], curves: Iterable[str], legend: Iterable[str], below: float, names: int
) -> bytes:
    """The SVG file of a plot: title, axes that end at a height, curves, and a legend of so many names."""
    height, colours = below + BELOW + ROW * (names + 1) // 2, palette()
    body = [f'<text x="{LEFT}" y="20" font-size="14" font-weight="bold">{text(title)}</text>', *axes, *curves, *legend]
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}mm" height="{WIDTH * height / WIDE:g}mm" '
        f'viewBox="0 0 {WIDE} {height:g}" style="background:#fff" font-family="DejaVu Sans, Verdana, sans-serif" '
        f'font-size="12" fill="{colours["ink"]}">\n<title>{text(title)}</title>'
    )
    return "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', head, *body, "</svg>\n"]).encode()


class _Axis:
    """Values from `low` to `high` between two positions in the picture."""

    def __init__(self, low: float, high: float, start: float, end: float):
        self.low, self.high, self.start, self.end = low, high, start, end

    def at(self, value: float | Real) -> float | Real:
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self, unit: str, most: int) -> Iterator[float]:
        """Round values, at most `most` intervals."""
        size = self.high - self.low
        power = 10.0 ** np.floor(np.log10(size / most))
        steps = [*(DEGREES if unit == "deg" and size / most >= 0.5 else ()), *(step * power for step in STEPS)]
        step = next((step for step in steps if size / step <= most), steps[-1])
        for k in range(int(np.ceil(self.low / step - 1e-9)), int(np.floor(self.high / step + 1e-9)) + 1):
            yield k * step


def _ends(values: Real) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return (low, high) if high > low else (low - 1, low + 1)


def _range(rows: Sequence[Real], limits: Sequence[Limit]) -> tuple[float, float]:
    values = np.concatenate([*rows, np.array([limit.value for limit in limits])])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    room = MARGIN * (high - low) or abs(high) or 1.0
    return low - room, high + room


def _grid(across: _Axis, up: _Axis, drive_unit: str, unit: str, colour: str) -> Iterator[str]:
    for value in across.ticks(drive_unit, MOST_ACROSS):
        x = f"{across.at(value):.2f}"
        yield f'<path d="M{x} {TOP}V{up.start:g}" stroke="{colour}"/>'
        yield f'<text x="{x}" y="{up.start + 16:g}" text-anchor="middle">{number(value, 5)}</text>'
    for value in up.ticks(unit, MOST_UP):
        y = f"{up.at(value):.2f}"
        yield f'<path d="M{LEFT} {y}H{WIDE - RIGHT}" stroke="{colour}"/>'
        yield f'<text x="{LEFT - 6}" y="{up.at(value) + 4:.2f}" text-anchor="end">{number(value, 5)}</text>'


def _limit(limit: Limit, up: _Axis, colour: str) -> str:
    y = float(up.at(limit.value))
    return (
        f'<path d="M{LEFT} {y:.2f}H{WIDE - RIGHT}" stroke="{colour}" stroke-width="1.5" stroke-dasharray="8 4"/>\n'
        f'<text x="{WIDE - RIGHT - 6}" y="{y - 5:.2f}" text-anchor="end" fill="{colour}">'
        f"{text(unit_sign(limit.label).replace(' °', '°'))}</text>"
    )


def _curve(across: _Axis, up: _Axis, x: Real, row: Real, look: str, dots: bool) -> str:
    """A line through the known values, with gaps where there are none; a value without neighbours is a dot."""
    known = np.isfinite(x + row)
    path = ""
    ends = np.arange(1, len(row)) if dots else np.flatnonzero(np.diff(known)) + 1
    for run in np.split(np.arange(len(row)), ends):
        if known[run[0]]:
            points = [f"{u:.2f} {v:.2f}" for u, v in zip(across.at(x[run]), up.at(row[run]))]  # type: ignore[arg-type]
            path += f"M{'L'.join(points if len(points) > 1 else points * 2)}"
    caps = "" if dots else ' stroke-linecap="round" stroke-linejoin="round"'
    return f'<path d="{path}" {look}{caps}/>'


def _look(k: int, colours: dict[str, str], dots: bool) -> str:
    dashes = DASHES[k % len(DASHES)]
    colour = f'fill="none" stroke="{colours[STROKES[k % len(STROKES)]]}"'
    if dots:
        return f'{colour} stroke-width="{DOT}" stroke-linecap="round"'
    stroke = f'{colour} stroke-width="1.75"'
    return stroke if dashes == "none" else f'{stroke} stroke-dasharray="{dashes}"'


def _legend(columns: Sequence[Column], up: _Axis, colours: dict[str, str], dots: bool) -> Iterator[str]:
    """The curves with their names, two in a line."""
    for k, column in enumerate(columns):
        x, y = LEFT + k % 2 * (WIDE - LEFT - RIGHT) // 2, up.start + BELOW + 6 + k // 2 * ROW
        yield f'<path d="M{x + 14 * dots} {y}h{28 * (not dots)}" {_look(k, colours, dots)}/>'
        yield f'<text x="{x + 36}" y="{y + 4}">{text(column.id.replace("_", " "))}</text>'


def _column_title(column: Column) -> str:
    return text(", ".join(filter(None, (column.id.replace("_", " "), unit_sign(column.unit)))))


def _quantity(columns: Sequence[Column]) -> str:
    """The axis title upwards: the name if there is one curve, and the unit, which all curves share."""
    unit = "degrees" if columns[0].unit == "deg" else unit_sign(columns[0].unit) or "ratio"
    return _column_title(columns[0]) if len(columns) == 1 else text(unit)
