"""The page of a mechanism: one HTML file with its moving drawing, which loads no other file."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping
from functools import cache
from hashlib import sha256
from importlib.resources import files

from ..export.job import Job
from ..export.still import MOST_FRAMES
from ..export.text import capital, text
from . import player
from .scene_json import scene_json
from .sections import all_of, verdict

# Scripts of the player, each after those that it uses.
SCRIPTS = (
    "uplot/uPlot.iife.min.js",
    *("shapes.js", "names.js", "pictures.js", "drawing.js", "hands.js", "plots.js", "player.js"),
)
ROW_SCRIPTS = ("uplot/uPlot.iife.min.js", "shapes.js", "pictures.js", "plots.js", "rows.js")
START = (
    'const player = mount(document.getElementById("player"), JSON.parse(document.getElementById("scene").textContent));'
)

# The further line of a page that plots the solutions from which its mechanism was chosen.
CHOICE = 'mountRows(document.getElementById("choice"), read(player.data.choice));'


def mechanism_page(job: Job) -> bytes:
    """The page. The player shows the drawing and the plots; all else is in tables that do not need it."""
    about = f"<p>{text(job.about)}</p>" if job.about else ""
    if entries := "; ".join(job.title.lines()):
        about += f"<p>{text(capital(entries))}</p>"
    frames = len(job.scene.time)
    if frames > MOST_FRAMES:
        about += f"<p>It shows {MOST_FRAMES} of {frames} frames, evenly chosen; the CSV file of the recipe has all.</p>"
    body = (
        '<section id="player" aria-label="The mechanism, moving, and its plots"></section>\n'
        "<noscript><p>The drawing moves by a script; without one, the tables below state the same.</p></noscript>\n"
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
    script = _script(scripts, start)
    page = f"""{head(title, player_file("style.css"), script)}<body>
<header><h1><bdi>{text(title)}</bdi></h1>{about}</header>
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
def _script(scripts: tuple[str, ...], start: str) -> str:
    """Files of the player joined to one module, without `import` lines and the word `export`."""
    return "\n".join([*(_without_links(player_file(name)) for name in scripts), start, ""])


def _without_links(source: str) -> str:
    lines = source.splitlines()
    return "\n".join(line.removeprefix("export ") for line in lines if not line.startswith("import "))


def player_file(name: str) -> str:
    """The text of a file of the player."""
    return files(player).joinpath(name).read_text("utf-8").strip()


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
