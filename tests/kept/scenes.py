"""The net's fourth part: how recipes look moving, and what is drawn of that.

Of two recipes of every kind and some more of the net, the scene is told: each body's parts and places, each curve, mark, region and
plot; and of the drawings that no recipe of the net asks for, what `net.py` tells of a drawing. What such a net is for,
`net.py` says. A change that is meant is written down with

    python -m tests.kept.scenes                 # all recipes, or
    python -m tests.kept.scenes crank rocker-3  # those whose names begin so
"""

import contextlib
import json
import sys
import tempfile
import tomllib
from collections import Counter
from pathlib import Path

import numpy as np

import geomkin as gk
from tests.kept import calls, net

HERE = Path(__file__).parent
TAILS = ["-assembly.svg", "-assembly.dxf", "-animation.svg", "-sheet.dxf", "-sheet.svg", "-bom.csv"]
# Places of a curve that are looked at, of all that its stretches share.
SHARES = np.array([0, 0.31, 0.77, 1])


# Of the further recipes of a kind, every so many is tried: all would take a minute, and tell little more.
EVERY = 5
# A search among many that are alike to the last bits: which of them it shows hangs on the processor.
LEFT_OUT = ["body-guidance-1", "body-guidance-2", "function-generator-1"]
# Rounding of what would be 0, mm as drawn: a number this small tells nothing.
NOTHING = 1e-5


def recipes():
    """Name -> (text, {file name: text of a file beside it}) of those of the net whose scenes are told."""
    held, chosen, seen = net.recipes(), {}, Counter()
    for name, found in net.kept().items():
        if "refused" in found or name in LEFT_OUT:
            continue
        kind = tomllib.loads(held[name][0])["kind"]
        if seen[kind] < 2 or seen[kind] % EVERY == 0:
            chosen[name] = held[name]
        seen[kind] += 1
    return chosen


def kept():
    return json.loads((HERE / "scenes.json").read_text("utf-8"))


def outcome(name, text, beside, folder):
    """{heading: {label: list of texts and numbers}} of a recipe's scene and of the drawings made of it."""
    for file, content in {f"{name}.toml": text, **beside}.items():
        (folder / file).write_text(content, "utf-8")
    with contextlib.chdir(folder):
        recipe = gk.load(f"{name}.toml")
        found = {"scene": dict(told(recipe.scene))} if recipe.scene is not None else {}
        for tail in TAILS:
            found |= _drawn(recipe, name + tail, tail)
    return found


def _drawn(recipe, file, tail):
    try:
        gk.write(recipe, file)
    except gk.GeomkinError as error:
        return {tail: {"refused": str(error).splitlines()}}
    return {tail: net.READERS[Path(tail).suffix](Path(file).read_bytes())}


def told(scene):
    """(label, row) for everything that a scene shows."""
    yield "time", _row(scene.time)
    yield "closed", [int(scene.closed.sum()), bool(scene.cyclic)]
    yield "box", _row(np.array(scene.box))
    yield "drive", [scene.drive.header, *_row(np.asarray(scene.drive.values, dtype=float))]
    for body in scene.bodies:
        parts = [f"{part.name} {part.count}" for part in body.parts]
        yield f"body {body.name}", [int(body.layer), bool(body.fixed), *parts]
        yield f"body {body.name} origin", _row(body.origin)
        yield f"body {body.name} direction", _row(body.direction)
    for k, curve in enumerate(scene.curves):
        yield f"curve {k} {curve.role} {curve.label} on {curve.body}", _of_curve(curve.curve)
    for k, region in enumerate(scene.regions):
        for m, curve in enumerate(region.curves):
            yield f"region {k} {region.role} {region.label} {m}", _of_curve(curve)
    for k, mark in enumerate(scene.marks):
        rows = {"at": mark.place, "vector": mark.vector, "direction": mark.direction, "radius": mark.radius}
        label = f"mark {k} {mark.sort} {mark.role} {mark.label}" + " with a trail" * mark.trail
        for what, row in rows.items():
            if row is not None:
                yield f"{label} {what}", _row(row)
    yield from _plots("", scene.plots)
    if scene.choice is not None:
        yield "chosen", [int(scene.choice.chosen), *scene.choice.table.to_columns()]
        yield from _plots("choice ", scene.choice.plots)
    for label, other in scene.others.items():
        for inner, row in told(other):
            yield f"{label}: {inner}", row


def _plots(before, plots):
    for plot in plots:
        limits = [text for limit in plot.limits for text in (net.number(limit.value), limit.label)]
        yield f"{before}plot {plot.title}", [*plot.columns, *limits]


def _row(values):
    """What is told of an array, without rounding of nothing."""
    values = np.array(values)
    for part in (values.real, values.imag) if values.dtype.kind == "c" else (values,):
        part[np.abs(part) < NOTHING] = 0
    return calls.of_array(values)


def _of_curve(curve):
    b = np.asarray(curve.breaks, dtype=float)
    return _row(curve.point(np.unique((b[:-1, None] + np.diff(b)[:, None] * SHARES).ravel())))


def main(wanted):
    before = kept() if (HERE / "scenes.json").exists() else {}
    found = {}
    for name, (text, beside) in recipes().items():
        if name in before and wanted and not name.startswith(tuple(wanted)):
            found[name] = before[name]
            continue
        with tempfile.TemporaryDirectory() as folder:
            found[name] = json.loads(json.dumps(outcome(name, text, beside, Path(folder))))
        for line in net.differences(before.get(name, {}), found[name]):
            print(f"{name}: {line}")
    net.write("scenes", found)


if __name__ == "__main__":
    main(sys.argv[1:])
