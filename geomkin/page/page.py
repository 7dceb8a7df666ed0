"""The page of a mechanism, one HTML file with its scene as JSON."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import sha256
from importlib.resources import files

import numpy as np

from ..core.errors import harmless
from ..core.fields import to_digits
from ..core.units import MM, LengthUnit
from ..export.job import Job
from ..export.still import MOST_FRAMES, SCREEN, kept_frames
from ..export.svg_path import path
from ..export.text import capital, text
from ..model.scene import ROLES, Plot, Role, Scene, SceneBody, SceneCurve, SceneMark, SceneRegion, shown_columns
from ..model.table import Column, significant
from ..plane.curve import AbstractCurve
from ..plane.vec import Array, Complex, Real, Whole
from .sections import all_of, html_section, verdict

# Digits of positions, counted from the scene's size. With fewer, plates tremble from frame to frame on a large screen;
# one more makes a page a fifth longer.
DIGITS = 6
# Largest step that JavaScript adds up exactly.
MOST_STEPS = 2**50


def scene_json(scene: Scene, name: str, unit: LengthUnit = MM) -> str:
    """The JSON text of a scene, safe within a script element."""
    text = json.dumps(scene_data(scene, name, unit), ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    # Base64 spells "nan" by chance, which whoever looks for unknown numbers in a page would take for one.
    text = re.sub("(?<=n)a(?=n)", lambda letter: f"\\u{ord(letter[0]):04x}", text, flags=re.IGNORECASE)
    return text.replace("<", "\\u003c")


def scene_data(scene: Scene, name: str, unit: LengthUnit = MM) -> dict[str, object]:
    """A scene as plain values, the input of the player.

    `series` holds rows of numbers over the frames: the table's values and angles in deg as `floats`, coordinates in mm
    as `steps`. All other entries refer to a row by its index. Equal rows, such as the angle of a body, which is also in
    the table, are stored once. unit: of the scale below the drawing.
    """
    low, high = scene.box
    encoder = _Encoder(kept_frames(len(scene.time)), abs(high - low) or 1.0)
    scenes = [encoder.scene("", scene), *(encoder.scene(label, other) for label, other in scene.others.items())]
    data: dict[str, object] = {
        "name": harmless(name),
        "cyclic": bool(scene.cyclic),
        "frames": len(encoder.frames),
        "time": encoder.row(floats(significant(scene.time)[encoder.frames])),
        "scenes": scenes,
        "roles": _roles(scene),
        **encoder.plotted(shown_columns(scene), scene.plots),
        "paths": encoder.paths,
        "series": encoder.series,
    }
    if unit is not MM:
        data["unit"] = [unit.name, unit.mm]
    if scene.choice is not None:
        columns = scene.choice.table.columns
        solutions = _Encoder(np.arange(len(columns[0].values)), 1.0)
        data["choice"] = {
            **solutions.plotted(columns, scene.choice.plots),
            "frames": len(solutions.frames),
            "chosen": scene.choice.chosen,
            "key": scene.choice.key,
            "instead_of": list(scene.choice.instead_of),
            "series": solutions.series,
        }
    return data


def _roles(scene: Scene) -> list[dict[str, object]]:
    """The roles that a scene and its alternatives use, in the order of their switches."""
    labels: dict[Role, dict[str, None]] = {}
    for one in (scene, *scene.others.values()):
        elements: tuple[SceneCurve | SceneMark | SceneRegion, ...] = (*one.curves, *one.marks, *one.regions)
        for element in elements:
            is_vector = isinstance(element, SceneMark) and element.sort == "vector"
            # The label of a vector ends with its scale, which the player appends to that of the switch.
            label = element.label.rpartition(", ")[0] if is_vector else element.label
            labels.setdefault(element.role, {})[harmless(label)] = None
    used = [{"id": role, **style._asdict()} for role, style in ROLES.items() if role in labels]
    # What is wanted is another thing in each kind, so its switch names it, the first and the last of many.
    names = [label for label in labels.get("wanted", ()) if label]
    for entry in used:
        if entry["id"] == "wanted" and names:
            entry["label"] = ", ".join(names) if len(names) < 3 else f"{names[0]} to {names[-1]}"
    return used


class _Encoder:
    """Encodes the scenes of a page; equal rows of numbers and equal paths are stored once."""

    def __init__(self, frames: Whole, size: float):
        self.frames, self.tolerance = frames, SCREEN * size
        self.decimals = DIGITS - 1 - int(np.floor(np.log10(size)))
        self.paths: list[str] = []
        self.series: list[object] = []
        # Indices of stored rows and paths. Many are equal, as plates in both assembly modes or pins of several links.
        self._indices: dict[object, int] = {}

    def plotted(self, columns: Sequence[Column], plots: Sequence[Plot]) -> dict[str, object]:
        """Columns of numbers, and the plots that show them."""
        ids = [column.id for column in columns]
        return {
            "columns": [
                {
                    "name": harmless(column.id),
                    "unit": harmless(column.unit),
                    "meaning": harmless(column.meaning),
                    "row": self.row(floats(column.written[self.frames].astype(float))),
                }
                for column in columns
            ],
            "plots": [
                {"title": harmless(plot.title), "columns": [ids.index(id) for id in plot.columns if id in ids]}
                | (
                    {"limits": [[float(limit.value), harmless(limit.label)] for limit in plot.limits]}
                    if plot.limits
                    else {}
                )
                | ({"bars": True} if plot.bars else {})
                | ({"most": plot.most} if np.isfinite(plot.most) else {})
                for plot in plots
            ],
        }

    def scene(self, label: str, scene: Scene) -> dict[str, object]:
        return {
            "label": harmless(label),
            "open": np.flatnonzero(~np.asarray(scene.assembled)[self.frames]).tolist(),
            "bodies": [self._body(body) for body in scene.bodies],
            "curves": [*map(self._region, scene.regions), *map(self._curve, scene.curves)],
            "marks": [self._mark(mark) for mark in scene.marks],
        }

    def _body(self, body: SceneBody) -> dict[str, object]:
        engraved = [self._path(part.marks) for part in body.parts if part.marks]
        return (
            {
                "name": harmless(body.name),
                "at": self._points(body.origin),
                "turn": self._angles(body.direction),
                "layer": body.layer,
                "cut": [self._path((part.outline, *part.holes)) for part in body.parts],
            }
            | ({} if body.named else {"unnamed": True})
            | ({"fixed": True} if body.fixed else {})
            | ({"engraved": engraved} if engraved else {})
        )

    def _curve(self, curve: SceneCurve) -> dict[str, object]:
        entry: dict[str, object] = {
            "path": self._path((curve.curve,)),
            "role": curve.role,
            "label": harmless(curve.label),
        }
        return entry | ({"body": harmless(curve.body)} if curve.body else {})

    def _region(self, region: SceneRegion) -> dict[str, object]:
        return {"path": self._path(region.curves), "role": region.role, "label": harmless(region.label)}

    def _mark(self, mark: SceneMark) -> dict[str, object]:
        # Entries that have their usual value are omitted.
        entry: dict[str, object] = {"sort": mark.sort, "at": self._points(mark.place)}
        if mark.label:
            entry["label"] = harmless(mark.label)
        if mark.role != "construction":
            entry["role"] = mark.role
        if mark.trail:
            entry["trail"] = True
        if mark.vector is not None:
            entry["vector"] = self._points(mark.vector)
        if mark.direction is not None:
            entry["turn"] = self._angles(mark.direction)
        if mark.radius is not None:
            entry["radius"] = self.row(second_differences(mark.radius[self.frames], self.decimals))
        return entry

    def _points(self, points: Complex) -> list[int]:
        points = np.asarray(points)[self.frames]
        unknown = ~np.isfinite(points)
        return [
            self.row(second_differences(np.where(unknown, np.nan, part), self.decimals))
            for part in (points.real, points.imag)
        ]

    def _angles(self, directions: Complex) -> int:
        angles = np.angle(directions)
        known = np.isfinite(angles)
        angles[known] = np.unwrap(angles[known])
        return self.row(floats(significant(np.degrees(angles), 1.0)[self.frames]))

    def _path(self, curves: tuple[AbstractCurve, ...]) -> int:
        if curves not in self._indices:
            # Paths have one digit less than positions, which is still a twentieth of the tolerance.
            text = path(curves, self.tolerance, self.decimals - 1)
            if text not in self.paths:
                self.paths.append(text)
            self._indices[curves] = self.paths.index(text)
        return self._indices[curves]

    def row(self, row: object) -> int:
        """The index of a row, which is stored if it is new."""
        key = tuple(row) if isinstance(row, list) else row
        if key not in self._indices:
            self._indices[key] = len(self.series)
            self.series.append(row)
        return self._indices[key]


def floats(row: Real) -> object:
    """A row in single precision, seven digits of each number, as base64 of its little-endian bytes.

    A constant row becomes one number, a row of nan None.
    """
    with np.errstate(over="ignore"):
        single = row.astype("<f4")
    if not np.isfinite(single).any():
        return None
    return to_digits(row[0], 7) if (single == single[0]).all() else b64encode(single.tobytes()).decode()


def second_differences(row: Real, decimals: int) -> object:
    """A smooth row, rounded: the number of decimals, then the second differences in units of the last decimal.

    nan becomes None. A constant row becomes one number, a row of nan None.
    """
    known = np.isfinite(row)
    whole = np.clip(np.rint(row[known] * 10.0**decimals), -MOST_STEPS, MOST_STEPS).astype(np.int64)
    if not len(whole):
        return None
    if known.all() and (whole == whole[0]).all():
        return round(float(row[0]), decimals) + 0.0
    differences: Array = np.full(len(row), None)
    differences[known] = np.diff(whole, n=2, prepend=[0, 0])
    return [decimals, *differences.tolist()]


# Scripts of the player, each after those that it uses.
SCRIPTS = (
    "uplot/uPlot.iife.min.js",
    *("shapes.js", "names.js", "pictures.js", "film.js", "links.js", "drawing.js", "hands.js", "plots.js", "player.js"),
)
ROW_SCRIPTS = ("uplot/uPlot.iife.min.js", "shapes.js", "pictures.js", "plots.js", "rows.js")
START = (
    'const player = mount(document.getElementById("player"), JSON.parse(document.getElementById("scene").textContent));'
)

# Number of characters from which the remarks of the head of a page are below its drawing, about six lines.
LONG_TEXT = 500
# The further line of a page that plots the solutions from which its mechanism was chosen.
CHOICE = 'mountRows(document.getElementById("choice"), read(player.data.choice));'


def mechanism_page(job: Job) -> bytes:
    """The page. The player shows the drawing and the plots; all else is in tables that do not need it."""
    # Below a long text the drawing would not be seen at once.
    opening, stop, remarks = job.about.partition(". ") if len(job.about) > LONG_TEXT else (job.about, "", "")
    about = f"<p>{text(opening + stop.strip())}</p>" if opening else ""
    if entries := "; ".join(job.title.lines()):
        about += f"<p>{text(capital(entries))}</p>"
    frames = len(job.scene.time)
    if frames > MOST_FRAMES:
        about += f"<p>It shows {MOST_FRAMES} of {frames} frames, evenly chosen; the CSV file of the recipe has all.</p>"
    body = (
        '<section id="player" aria-label="The mechanism, moving, and its plots"></section>\n'
        "<noscript><p>The drawing moves by a script; without one, the tables below state the same.</p></noscript>\n"
        f"{html_section('remarks', 'Remarks', f'<p>{text(remarks)}</p>') + chr(10) if remarks else ''}"
        f"{''.join(f'{section}{chr(10)}' for section in all_of(job) if section)}"
    )
    scripts: tuple[str, ...] = SCRIPTS
    start = START
    if job.scene.choice is not None:
        scripts, start = (*SCRIPTS, "rows.js"), f"{START}{CHOICE}"
    return html_document(
        job.name, about + verdict(job.source.checks), body, scene_json(job.scene, job.name, job.unit), scripts, start
    )


def html_document(title: str, about: str, body: str, data: str, scripts: tuple[str, ...], start: str) -> bytes:
    """A page of one file. title: plain text; about, body: HTML; data: JSON that is safe in a script element.

    scripts: files of `player`, the plot library first; start: the line that calls them. The page's content security
    policy allows only these scripts, whatever the texts of a recipe contain.
    """
    script = script_of(scripts, start)
    page = f"""{head(title, player_file("style.css"), script)}<body>
<header id="embed"><h1><bdi>{text(title)}</bdi></h1>{about}</header>
<main>
{body}</main>
<script type="application/json" id="scene">{data}</script>
<script type="module">{script}</script>
</body>
</html>
"""
    return page.encode("utf-8", "replace")


def rows_document(title: str, about: str, body: str, data: Mapping[str, object], choose: str = "undefined") -> bytes:
    """A page with plots of rows that do not move, in the element of the id `plots` in its body.

    data: of the plots, for `rows.js`; choose: JavaScript of the function that is called with the row that is chosen.
    """
    element = 'document.getElementById("plots")'
    start = f'mountRows({element}, JSON.parse(document.getElementById("scene").textContent), {choose});'
    json_text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    return html_document(title, about, body, json_text, ROW_SCRIPTS, start)


@cache
def script_of(scripts: tuple[str, ...], start: str) -> str:
    """Files of the player joined to one module, without `import` lines, the word `export` and lines of comment."""
    return "\n".join([*(_inlined(player_file(name)) for name in scripts), start, ""])


def _inlined(source: str) -> str:
    lines = (line.removeprefix("export ") for line in source.splitlines() if not line.startswith("import "))
    return "\n".join(line for line in lines if line.strip() and not line.lstrip().startswith("//"))


def player_file(name: str) -> str:
    """The text of a file of the player."""
    return files(__package__).joinpath("player", name).read_text("utf-8").strip()


def colours() -> str:
    """The colours and fonts at the start of the page's style sheet."""
    return player_file("style.css").partition("\n* {")[0]


def head(title: str, style: str, script: str = "", mark: str = "") -> str:
    """The head of a page of one file. Its content security policy allows no loading and no script but this one.

    title: plain text. mark: a line of HTML near its start.
    """
    runs = f"script-src {_hashed(script)}; " if script else ""
    line = f"{mark}\n" if mark else ""
    policy = f"{runs}style-src {_hashed(style)}; img-src data:; base-uri 'none'; form-action 'none'"
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
{line}<meta http-equiv="Content-Security-Policy" content="default-src 'none'; {policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{text(title)}</title>
<link rel="icon" href="data:,">
<style>{style}</style>
</head>
"""


def _hashed(content: str) -> str:
    """Source of a script or style, as a content security policy names it."""
    return f"'sha256-{b64encode(sha256(content.encode()).digest()).decode()}'"
