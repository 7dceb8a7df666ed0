"""A net of kept results: what some hundred short recipes gave when they were last looked over, number by number.

The recipes stand in `<room>.toml`, written out in full; what became of each stands in `<room>.json` beside it: of a made
one its checks, parts, notes, table and drawings, of a refused one the whole message. Between them they use every kind,
every key and every choice of a key at least once, and reach nearly every line of the package.

Such a net tells that something has changed, not what is right: that the numbers are right is for the direct tests to
prove, each by a second road. The net holds while files move and code is put in another shape, and catches the slip
of a hand where no direct test looks. A change that is meant is written down with

    python -m tests.kept.net                 # all recipes, or
    python -m tests.kept.net crank rocker-3  # those whose names begin so

and the difference of the files is looked over before it is committed.

Numbers are kept to nine digits. Of a column: the first and last, least and largest, and a sum with weights that differ
from row to row, so that no two rows can change places unseen.
"""

import contextlib
import csv
import json
import re
import sys
import tempfile
import tomllib
from pathlib import Path

import numpy as np

import geomkin as gk

HERE = Path(__file__).parent
ROOMS = ["linkages", "drawings", "cams", "gears", "goals", "refused"]
# Of the scale of what a number was made from: the last digit kept, where another processor's rounding may turn a half
# the other way, and some of that rounding.
NEAR = 2e-8
# What a check finds where it should find nothing is rounding, which another order of the same sums makes anew.
NOTHING = 1e-11


def recipes():
    """Name -> (text, {file name: text of a file beside it}) of every recipe."""
    return {name: found for room in ROOMS for name, found in of_room(room).items()}


def of_room(room):
    held = tomllib.loads((HERE / f"{room}.toml").read_text("utf-8"))
    return {name: (about["text"], about.get("beside", {})) for name, about in held.items()}


def kept():
    """Name -> what the recipe gave when it was last looked over."""
    files = [HERE / f"{room}.json" for room in ROOMS]
    return {name: found for file in files for name, found in json.loads(file.read_text("utf-8")).items()}


def outcome(name, text, beside, folder):
    """What becomes of a recipe, made in an empty folder: {heading: {label: list of texts and numbers}}."""
    for file, content in {f"{name}.toml": text, **beside}.items():
        (folder / file).write_text(content, "utf-8")
    with contextlib.chdir(folder):
        try:
            # Pages and pictures are tried by themselves, and take longer than all else.
            asked = gk.load(f"{name}.toml").files.write
            wanted = [ending for ending in asked if gk.export.WRITERS[ending].needs != "scene"]
            made = gk.make(f"{name}.toml", "out", wanted or None)
        except gk.GeomkinError as error:
            lines, problems = str(error).splitlines(), getattr(error, "problems", ())
            if len(lines) >= len(problems):
                return {"refused": {"": lines}}
            # The message tells the first and the number of the rest.
            return {"refused": {"": [lines[0], lines[-1]], "problems": [str(problem) for problem in problems]}}
        contents = {path.name: path.read_bytes() for path in made.files}
    summary = json.loads(contents.pop("summary.json"))
    found = {
        "checks": {c.name: [number(c.value), c.side, number(c.limit), c.unit, c.advice] for c in made.checks},
        "parts": {p.pop("name"): list(flat(p)) for p in summary["parts"]},
        "notes": {key: list(flat(summary[key])) for key in summary if key not in NO_NOTES},
        "files": {"": [file for file in summary["files"] if Path(file).suffix in READERS]},
    }
    # What a goal found is made of what is kept here already.
    for file, content in contents.items():
        if Path(file).suffix in READERS:
            found[file.removeprefix(name)] = READERS[Path(file).suffix](content)
    return found


NO_NOTES = ["name", "recipe", "checks", "parts", "files", "versions"]


def number(value, scale=0.0):
    """A number with nine digits, counted from a scale where that is larger; None for nan."""
    if isinstance(value, bool | str) or value is None:
        return value
    if not np.isfinite(value):
        return None if np.isnan(value) else str(value)
    largest = max(abs(value), scale)
    return round(float(value), 8 - int(np.floor(np.log10(largest)))) + 0.0 if largest > 1e-280 else 0.0


def flat(held):
    """Texts and numbers of a nest of tables and lists, with the keys before them."""
    if isinstance(held, dict):
        for key, value in held.items():
            yield key
            yield from flat(value)
    elif isinstance(held, list):
        for value in held:
            yield from flat(value)
    else:
        yield number(held)


def sizes(values):
    """[how many are numbers, scale, first, last, least, largest, sum with weights] of numbers, nan where there is none."""
    values = np.asarray(values, dtype=float)
    there = np.isfinite(values)
    if not there.any():
        return [0]
    scale = float(np.abs(values[there]).max())
    weights = np.cos(0.7 * np.arange(len(values)) ** 1.1) + 0.3
    told = values[there]
    found = [told[0], told[-1], told.min(), told.max(), (told * weights[there]).sum() / len(told)]
    return [int(there.sum()), number(scale), *[number(v, scale) for v in found]]


def read_csv(content):
    rows = list(csv.reader(content.decode("utf-8").splitlines()))
    columns = {}
    for name, *cells in zip(*rows, strict=True):
        try:
            columns[name] = [len(cells), *sizes([float(cell or "nan") for cell in cells])]
        except ValueError:
            runs = [cell for k, cell in enumerate(cells) if k == 0 or cells[k - 1] != cell]
            columns[name] = [len(cells), *runs[:20]]
    return columns


def read_dxf(content):
    """Of every layer and type of entity: how many, then the sizes of their coordinates, radii and bulges."""
    lines = content.decode("utf-8").split("\n")
    pairs = [(code.strip(), value.strip()) for code, value in zip(lines[::2], lines[1::2])]
    begin = pairs.index(("2", "ENTITIES"))
    entities, found = [], {}
    for code, value in pairs[begin + 1 : pairs.index(("0", "ENDSEC"), begin)]:
        if code == "0":
            entities.append((value, []))
        else:
            entities[-1][1].append((code, value))
    for kind, codes in entities:
        layer = dict(codes)["8"]
        held = found.setdefault(f"{layer} {kind}", [[], [], [], []])
        for k, wanted in enumerate([("10",), ("20",), ("40", "42"), ("70",)]):
            held[k] += [float(value) for code, value in codes if code in wanted]
    count = {label: sum(1 for kind, codes in entities if f"{dict(codes)['8']} {kind}" == label) for label in found}
    named = {f"{label} {what}": sizes(held[k]) for label, held in found.items() for k, what in enumerate("xyrf")}
    extents = [pairs[pairs.index(("9", end)) + k][1] for end in ("$EXTMIN", "$EXTMAX") for k in (1, 2)]
    return {"count": list(flat(count)), "extents": [number(float(v)) for v in extents], **named}


def read_svg(content):
    text = content.decode("utf-8")
    head = re.search(r'<svg[^>]*?width="([^"]*)"[^>]*?height="([^"]*)"[^>]*?viewBox="([^"]*)"', text)
    tags = re.findall(r"<(\w+)", text)
    drawn = " ".join(re.findall(r'(?: d| c?[xyr]|points)="([^"]*)"', text))
    return {
        "sheet": list(head.groups()) if head else [],
        "tags": [f"{tag} {tags.count(tag)}" for tag in sorted(set(tags))],
        "numbers": sizes([float(v) for v in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", drawn)]),
    }


def read_stl(content):
    corners = np.frombuffer(content[84:], np.dtype([("n", "<3f4"), ("v", "<9f4"), ("_", "<u2")]))["v"].reshape(-1, 3)
    ends = [*corners.min(axis=0), *corners.max(axis=0)]
    return {"": [len(corners) // 3, *[float(f"{v:.5g}") for v in ends]]}


READERS = {".csv": read_csv, ".dxf": read_dxf, ".svg": read_svg, ".stl": read_stl}


def differences(old, new):
    """Lines that say what is no longer as it was kept."""
    for heading in dict.fromkeys([*old, *new]):
        before, after = old.get(heading, {}), new.get(heading, {})
        if list(before) != list(after):
            yield f"{heading}: {list(before)} became {list(after)}"
        for label in before:
            if label in after and not _alike(before[label], after[label], heading):
                yield f"{heading} {label}:\n    {before[label]}\n    {after[label]}"


def _alike(before, after, heading):
    if len(before) != len(after):
        return False
    numbers = [abs(v) for v in before if isinstance(v, float)]
    # What is written in single precision is kept so; numbers of unlike sizes stand side by side in parts and notes.
    near = 2e-5 if heading.endswith(".stl") else NEAR
    nothing = NOTHING if heading in ("checks", "notes") else 0.0
    shared = max(numbers, default=0.0) if heading[:1] == "." else 0.0
    for old, new in zip(before, after, strict=True):
        if isinstance(old, float) and isinstance(new, float):
            if abs(old - new) > max(near * max(abs(old), shared), nothing):
                return False
        elif old != new:
            return False
    return True


def write(room, found):
    """The kept results of a room, a line for each label."""
    lines = []
    for name, about in found.items():
        headings = []
        for heading, rows in about.items():
            told = ",\n".join(
                f"   {json.dumps(k, ensure_ascii=False)}: {json.dumps(v, ensure_ascii=False)}" for k, v in rows.items()
            )
            headings.append(f"  {json.dumps(heading)}: {{\n{told}\n  }}" if rows else f"  {json.dumps(heading)}: {{}}")
        lines.append(f" {json.dumps(name)}: {{\n" + ",\n".join(headings) + "\n }")
    (HERE / f"{room}.json").write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")


def main(wanted):
    before = kept() if all((HERE / f"{room}.json").exists() for room in ROOMS) else {}
    for room in ROOMS:
        found = {}
        for name, (text, beside) in of_room(room).items():
            if name in before and wanted and not name.startswith(tuple(wanted)):
                found[name] = before[name]
                continue
            with tempfile.TemporaryDirectory() as folder:
                found[name] = json.loads(json.dumps(outcome(name, text, beside, Path(folder))))
            for line in differences(before.get(name, {}), found[name]):
                print(f"{name}: {line}")
        write(room, found)


if __name__ == "__main__":
    main(sys.argv[1:])
