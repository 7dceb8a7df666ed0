"""Damages of written files: one thing of a file's syntax tree changed at random, without knowing what a reader reads."""

import csv
import io
import json
import re
import struct
import zipfile
from importlib.util import find_spec

import geomkin as gk
from geomkin.export.formats import WRITERS

TOLERANCE = 0.005
RECIPE = """
kind = "four-bar"
[linkage]
ground = 100
crank = 30
coupler = 90
rocker = 70
[files]
write = ["dxf", "svg", "stl", "csv", "bom", "step", "3mf", "glb"]
"""
GEAR = """
kind = "spur-gear"
[gear]
teeth = 8
module = 2
[files]
tolerance = 0.02
write = ["dxf", "svg", "stl", "csv", "bom", "step", "3mf", "glb", "page", "assembly-svg"]
"""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
# Elements, attributes and groups of the formats that a person may add.
ELEMENTS = [
    '<rect x="3" y="3" width="9" height="5" class="CUT" stroke="#ff0000"/>', '<line x1="1" y1="1" x2="9" y2="9"/>',
    '<polygon points="1,1 9,1 5,8" stroke="#ff0000"/>', "<style>*{display:none}</style>", "<!-- checked -->",
    '<circle cx="7" cy="7" r="2" class="HOLE" stroke="#0072b2"/>', '<use href="#a"/>', '<text x="4" y="4">cut</text>',
    '<g transform="scale(1.5)"/>', '<path d="M1,1 9,1 5,8Z" class="CUT" visibility="hidden"/>', "<script>1</script>",
]  # fmt: skip
ATTRIBUTES = [
    'transform="scale(1.5)"', 'style="transform: scale(1.5)"', 'style="display:none"', 'visibility="hidden"',
    'transform="translate(20,0)"', 'stroke-dasharray="1 1"', 'opacity="0"', 'preserveAspectRatio="none"',
    'clip-path="url(#a)"',
]  # fmt: skip
GROUPS = [
    "60\n1",
    "62\n7",
    "8\nOTHER",
    "39\n5.0",
    "210\n1.0",
    "370\n200",
    "48\n2.0",
    "6\nDASHED",
    "43\n3.0",
    "230\n-1.0",
]
ENTITIES = [
    "0\nLINE\n8\nCUT\n10\n1.0\n20\n1.0\n11\n9.0\n21\n9.0", "0\nPOINT\n8\nCUT\n10\n1.0\n20\n1.0",
    "0\nCIRCLE\n8\nHOLE\n10\n5.0\n20\n5.0\n40\n2.0", "0\nTEXT\n8\nCUT\n10\n1.0\n20\n1.0\n40\n5.0\n1\nx",
    "0\nINSERT\n8\nCUT\n2\n*Model_Space\n10\n1.0\n20\n1.0", "0\nARC\n8\nCUT\n10\n5.0\n20\n5.0\n40\n2.0\n50\n0.0\n51\n90.0",
]  # fmt: skip


def wrong(folder):
    """Reports of the files that are not as designed, by name."""
    (certificate,) = gk.verify(folder)
    return {file.file: file for file in certificate.files if not file.passed}


def made_in_every_format(recipe, name, out):
    """Make a recipe in every format that its kind has; its folder."""
    scene = [name for name in WRITERS if WRITERS[name].needs == "scene"]
    # Formats of an extra are made where it is installed.
    missing = [name for name in WRITERS if not all(map(find_spec, WRITERS[name].packages))]
    for dropped in ([], ["step"], scene, [*scene, "step"], [*scene, "step", "csv"]):
        write = [name for name in WRITERS if name not in [*dropped, *missing]]
        try:
            gk.make(gk.load({**recipe, "files": {**recipe.get("files", {}), "write": write}}).with_name(name), out)
        except gk.GeomkinError:
            continue
        return out / name
    raise AssertionError(f"{name} is made in no format")


def number(text, rng):
    """Another number: a part of it more or less, moved, turned over, or another power of ten."""
    value = float(text)
    if not {".", "e", "E"} & set(text):
        return str(int(value) + rng.choice([-2, -1, 1, 2, 10]))
    other = [value * rng.uniform(1.02, 1.5), value + rng.choice([-1, 1]) * rng.uniform(0.05, 20), -value, 25.4 * value]
    value = rng.choice(other if value else [1.0, -2.5])
    return repr(round(value, 7))


def one_number(text, rng):
    """A text with one of its numbers changed; another word if it has none."""
    found = list(NUMBER.finditer(text))
    if not found:
        return f"{text}x" if rng.random() < 0.5 or len(text) < 2 else text[::-1] if text[::-1] != text else f"x{text}"
    chosen = rng.choice(found)
    return text[: chosen.start()] + number(chosen.group(), rng) + text[chosen.end() :]


def pieces(items, rng, change, added):
    """One of several pieces changed, removed, doubled or added, or two of them exchanged."""
    items, k = list(items), rng.randrange(len(items))
    order = rng.choice(["change", "change", "change", "remove", "double", "swap", "add"])
    if order == "swap":
        others = [j for j, item in enumerate(items) if item != items[k]]
        if others:
            j = rng.choice(others)
            items[k], items[j] = items[j], items[k]
            return items, f"swap {k} {j}"
        order = "change"
    if order == "change":
        items[k] = change(items[k], rng)
    else:
        items[k : k + 1] = {"remove": [], "double": [items[k]] * 2, "add": [items[k], added(rng)]}[order]
    return items, f"{order} {k}"


def xml(text, rng):
    """An element (with those inside it) or an attribute of a document, or a text between two tags."""
    tags = list(re.finditer(r"<[^>]*>|[^<]+", text))
    spans, opened = [], []
    for k, tag in enumerate(tags):
        name = tag.group()
        if name.startswith("</"):
            spans += [(opened.pop(), k)] if opened else []
        elif name.endswith("/>") or not name.startswith("<") or name[1] in "?!":
            spans += [(k, k)] if name.strip() else []
        else:
            opened.append(k)
    first, last = rng.choice(spans)
    start, end = tags[first].start(), tags[last].end()
    order = rng.choice(["change", "change", "attribute", "remove", "double", "swap", "add", "drop"])
    tag = tags[first].group()
    if order == "swap":
        alike = [
            s
            for s in spans
            if tags[s[0]].start() >= end and text[tags[s[0]].start() : tags[s[1]].end()] != text[start:end]
        ]
        if alike:
            a, b = (tags[j] for j in rng.choice(alike))
            return text[:start] + text[a.start() : b.end()] + text[end : a.start()] + text[start:end] + text[
                b.end() :
            ], (f"swap {tag[:40]} {a.group()[:40]}")
        order = "remove"
    if order == "remove":
        return text[:start] + text[end:], f"remove {tag[:60]}"
    if order == "double":
        return text[:end] + text[start:end] + text[end:], f"double {tag[:60]}"
    if order == "add":
        element = rng.choice(ELEMENTS)
        return text[:end] + element + text[end:], f"add {element} after {tag[:40]}"
    attributes = list(re.finditer(r'\s([\w:.-]+)="([^"]*)"', tag))
    if order == "attribute" and tag.startswith("<") and tag[1] not in "?!":
        attribute = rng.choice(ATTRIBUTES)
        at = start + len(tag) - (2 if tag.endswith("/>") else 1)
        return text[:at] + f" {attribute}" + text[at:], f"attribute {attribute} to {tag[:40]}"
    if attributes:
        chosen = rng.choice(attributes)
        if order == "drop":
            return text[: start + chosen.start()] + text[
                start + chosen.end() :
            ], f"drop {chosen.group(1)} of {tag[:40]}"
        value = one_number(chosen.group(2), rng)
        return text[: start + chosen.start(2)] + value + text[
            start + chosen.end(2) :
        ], f"change {chosen.group(1)} of {tag[:40]}"
    return text[:start] + one_number(tag, rng) + text[start + len(tag) :], f"change {tag[:60]}"


def dxf(text, rng):
    """An entity, table entry or group of a drawing."""
    pairs = re.findall(r"([^\n]*)\n([^\n]*)\n", text)
    if rng.random() < 0.5:
        starts = [k for k, (code, _) in enumerate(pairs) if code.strip() == "0"] + [len(pairs)]
        entities = ["".join(f"{c}\n{v}\n" for c, v in pairs[a:b]) for a, b in zip(starts, starts[1:])]
        entities, order = pieces(
            entities, rng, lambda entity, rng: dxf_group(entity, rng), lambda rng: rng.choice(ENTITIES) + "\n"
        )
        return "".join(entities), f"entity {order}"
    groups, order = pieces(
        pairs, rng, lambda pair, rng: (pair[0], one_number(pair[1], rng)), lambda rng: rng.choice(GROUPS).split("\n")
    )
    return "".join(f"{code}\n{value}\n" for code, value in groups), f"group {order} {pairs[int(order.split()[1])]}"


def dxf_group(entity, rng):
    return f"{entity}{rng.choice(GROUPS)}\n"


def step(text, rng):
    """An entity of a STEP file, one of its arguments, or a letter of its header."""
    lines = text.split(";\n")

    def change(line, rng):
        words = list(re.finditer(r"#\d+|\.[TF]\.|" + NUMBER.pattern, line.partition("=")[2] or line))
        if not words:
            return f"{line}x"
        base = len(line) - len(line.partition("=")[2] or line)
        chosen = rng.choice(words)
        word = chosen.group()
        other = {".T.": ".F.", ".F.": ".T."}.get(word) or (
            f"#{max(1, int(word[1:]) + rng.choice([-1, 1]))}" if word[0] == "#" else number(word, rng)
        )
        return line[: base + chosen.start()] + other + line[base + chosen.end() :]

    lines, order = pieces(
        lines, rng, change, lambda rng: f"#{rng.randrange(90000, 99999)}=CARTESIAN_POINT('',(1.,2.,3.))"
    )
    return ";\n".join(lines), order


def values(data, rng):
    """A value, key or entry of JSON data."""
    places = []

    def walk(inner):
        for key in inner if isinstance(inner, dict) else range(len(inner)):
            places.append((inner, key))
            if isinstance(inner[key], dict | list):
                walk(inner[key])

    walk(data)
    inner, key = rng.choice(places)
    value = inner[key]
    order = rng.choice(["change", "change", "change", "remove", "double", "empty"])
    if order == "remove":
        inner.pop(key)
    elif order == "double" and isinstance(inner, list):
        inner.insert(key, value)
    elif order == "empty" and isinstance(value, dict | list) and value:
        value.clear()
    elif isinstance(value, bool) or value is None:
        inner[key] = not value
    elif isinstance(value, int | float):
        inner[key] = json.loads(number(json.dumps(value), rng))
    elif isinstance(value, str):
        inner[key] = one_number(value, rng)
    else:
        inner.update(further=1) if isinstance(inner, dict) else inner.append(1)
    return f"{order} {key}"


def js(text, rng):
    data = json.loads(text)
    order = values(data, rng)
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n", order


def lines(text, rng):
    rows, order = pieces(text.splitlines(keepends=True), rng, one_number, lambda rng: "x = 1\n")
    return "".join(rows), order


def cells(text, rng):
    """A row, a cell or a column of a table."""
    rows = list(csv.reader(text.splitlines()))
    if rng.random() < 0.5:
        rows, order = pieces(
            rows, rng, lambda row, rng: pieces(row, rng, one_number, lambda rng: "1")[0], lambda rng: rows[0]
        )
    else:
        k = rng.randrange(len(rows))
        rows[k], order = pieces(rows[k], rng, one_number, lambda rng: "1.5")
        order = f"row {k} {order}"
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue(), order


def stl(content, rng):
    """A triangle or one of its fields, all of them moved, or a byte of the header or after the end."""
    count = (len(content) - 84) // 50
    rows = [content[84 + 50 * k : 134 + 50 * k] for k in range(count)]

    def change(row, rng):
        fields = list(struct.unpack("<12fH", row))
        k = rng.randrange(13)
        fields[k] = (fields[k] + 1) % 65536 if k == 12 else fields[k] + rng.choice([-1, 1]) * rng.uniform(0.05, 5)
        return struct.pack("<12fH", *fields)

    order = rng.choice(["rows", "rows", "rows", "header", "tail", "scale", "move", "mirror"])
    if order == "rows":
        rows, order = pieces(
            rows, rng, change, lambda rng: struct.pack("<12fH", *[0.0, 0, 1] + [float(k) for k in range(9)], 0)
        )
    elif order in ("scale", "move", "mirror"):
        axis, size = rng.randrange(3), {"scale": 1.01, "move": 1.0, "mirror": -1.0}[order]

        def moved(row):
            fields = list(struct.unpack("<12fH", row))
            for k in range(3 + axis, 12, 3):
                fields[k] = fields[k] + 0.5 if order == "move" else fields[k] * size
            return struct.pack("<12fH", *fields)

        rows = [moved(row) for row in rows]
    head = content[:80]
    if order == "header":
        k = rng.randrange(60)
        head = head[:k] + bytes([head[k] ^ 1]) + head[k + 1 :]
    return head + struct.pack("<I", len(rows)) + b"".join(rows) + b"x" * (order == "tail"), order


def glb(content, rng):
    """A value of the description of a GLB file, or four bytes of its numbers."""
    (length,) = struct.unpack_from("<I", content, 12)
    data, rest = json.loads(content[20 : 20 + length]), content[20 + length :]
    if rng.random() < 0.6:
        order = values(data, rng)
        inside = json.dumps(data, separators=(",", ":")).encode()
        inside += b" " * (-len(inside) % 4)
        head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(inside) + len(rest), len(inside), 0x4E4F534A)
        return head + inside + rest, order
    k = 8 + 4 * rng.randrange((len(rest) - 8) // 4)
    value = rest[k : k + 4]
    rest = rest[:k] + bytes([value[0], value[1], value[2] ^ 0x40, value[3]]) + rest[k + 4 :]
    return content[: 20 + length] + rest, f"bytes {k}"


def package(content, rng):
    """A member of a package, or its text."""
    with zipfile.ZipFile(io.BytesIO(content)) as opened:
        inside = [(name, opened.read(name).decode()) for name in opened.namelist()]
    order = "text"
    if rng.random() < 0.8:
        k = rng.choice([0, 1, 2, 2, 2, 2, 2, 2])
        text, order = xml(inside[k][1], rng)
        inside[k] = (inside[k][0], text)
    else:
        inside, order = pieces(inside, rng, lambda one, rng: (one[0] + "x", one[1]), lambda rng: ("more.txt", "x"))
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as opened:
        for name, text in dict(inside).items():
            opened.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), text)
    return stream.getvalue(), order


def one_byte(content, rng):
    """One byte of a file."""
    k = rng.randrange(len(content))
    return content[:k] + bytes([content[k] ^ 1]) + content[k + 1 :], f"byte {k}"


TEXTS = {
    ".svg": xml,
    ".html": xml,
    ".dxf": dxf,
    ".step": step,
    ".json": js,
    ".csv": cells,
    ".toml": lines,
    ".md": lines,
}
BINARY = {".stl": stl, ".glb": glb, ".3mf": package, ".pdf": one_byte}


def damaged(path, rng):
    """Change one thing of a file; a description of it."""
    content = path.read_bytes()
    for _ in range(20):
        if path.suffix in BINARY:
            changed, order = BINARY[path.suffix](content, rng)
        else:
            # Drawings of R2000 are not UTF-8.
            text, order = TEXTS[path.suffix](content.decode(errors="surrogateescape"), rng)
            changed = text.encode(errors="surrogateescape")
        if changed != content:
            path.write_bytes(changed)
            return f"{path.name}: {order}"
    raise AssertionError(f"{path.name} stays as it is")


def damage_folder(folder, others, rng):
    """Damage one file of a folder, remove, add or exchange one, or put one of another recipe in its place."""
    files = sorted(folder.iterdir())
    endings = sorted({path.suffix for path in files})
    path = rng.choice([path for path in files if path.suffix == rng.choice(endings)] or files)
    order = rng.choice(["change"] * 17 + ["remove", "other", "exchange"])
    if order == "remove":
        path.unlink()
        return f"remove {path.name}"
    if order == "other":
        other = rng.choice([one for one in others if one != folder])
        alike = [
            one
            for one in sorted(other.iterdir())
            if one.suffix == path.suffix and one.read_bytes() != path.read_bytes()
        ]
        if alike:
            source = rng.choice(alike)
            path.write_bytes(source.read_bytes())
            return f"{path.name} replaced by {source.parent.name}/{source.name}"
    alike = [one for one in files if one.suffix == path.suffix and one.read_bytes() != path.read_bytes()]
    if order == "exchange" and alike:
        other = rng.choice(alike)
        one, two = path.read_bytes(), other.read_bytes()
        path.write_bytes(two)
        other.write_bytes(one)
        return f"exchange {path.name} and {other.name}"
    return damaged(path, rng)
