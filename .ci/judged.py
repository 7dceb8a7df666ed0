"""Print the folders of the gallery that the judges read: the first with each kind, format, style, unit and printer.

A judge starts a browser, a slicer and a drawing program for each folder, half a minute in all; what one folder shows
of a kind or a format, the next shows again.
"""

import json
import pathlib


def aspects(recipe):
    files = recipe.get("files", {})
    yield "kind", recipe["kind"]
    yield "units", recipe.get("units")
    yield "style", files.get("style")
    yield "version", files.get("dxf_version")
    yield "printed", "printing" in recipe
    for name in files.get("write", ()):
        yield "format", name


seen = set()
for summary in sorted(pathlib.Path("out").glob("*/summary.json")):
    new = set(aspects(json.loads(summary.read_text())["recipe"])) - seen
    if new:
        seen |= new
        print(f"{summary.parent}/")
