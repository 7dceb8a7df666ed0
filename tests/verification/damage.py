"""Damages of written files, each of which a certificate must find."""

import json
import re
import struct
import zipfile
from typing import NamedTuple

import numpy as np

import geomkin as gk

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


def wrong(folder):
    """Reports of the files that are not as designed, by name."""
    (certificate,) = gk.verify(folder)
    return {file.file: file for file in certificate.files if not file.passed}


def only(folder, *names):
    """Let the summary list these files, so that no other is measured."""
    data = json.loads((folder / "summary.json").read_text())
    (folder / "summary.json").write_text(json.dumps(data | {"files": names}))


class Damage(NamedTuple):
    name: str
    kind: str
    seed: int


KINDS = (
    "dxf vertex", "svg vertex", "stl vertex", "step radius", "hole dropped", "part dropped", "triangle turned",
    "dxf units", "svg units", "3mf unit", "scaled", "truncated dxf", "truncated stl", "truncated glb", "truncated 3mf",
    "csv number", "bill count", "svg hole dropped", "stl bits", "layer",
    "dxf bulge", "svg bulge", "glb bits", "glb scaled", "3mf triangle", "3mf vertex", "step digit", "truncated svg",
    "truncated step", "truncated csv",
)  # fmt: skip


def damages(rng, count):
    """So many damages, each kind in turn, at random places."""
    return [Damage(f"{KINDS[k % len(KINDS)]} {k}".replace(" ", "-"), KINDS[k % len(KINDS)], int(rng.integers(2**31)))
            for k in range(count)]  # fmt: skip


def damaged(folder, damage):
    """Damage a file of the folder; its name."""
    rng = np.random.default_rng(damage.seed)
    function = globals()[damage.kind.replace(" ", "_").replace("3mf", "threemf")]
    return function(folder, rng)


def _moved(points, k, by=2.2 * TOLERANCE):
    """A vertex moved across the curve by over twice the tolerance."""
    before, here, after = points[k - 1], points[k], points[(k + 1) % len(points)]
    normal = 1j * (after - before) / abs(after - before)
    return here + by * normal


def _dxf_outline(text, rng):
    """An outline of a DXF file, and the match and position of each of its vertices."""
    outlines = [m for m in re.finditer(r"LWPOLYLINE\n(?:.*\n.*\n)*?(?=  0\n)", text) if "\nCUT\n" in m.group()]
    outline = outlines[rng.integers(len(outlines))]
    rows = list(re.finditer(r" 10\n([-\d.]+)\n 20\n([-\d.]+)\n", outline.group()))
    return outline, rows, [complex(float(row.group(1)), float(row.group(2))) for row in rows]


def dxf_vertex(folder, rng, by=2.2 * TOLERANCE):
    path = folder / "bars.dxf"
    text = path.read_text()
    outline, rows, points = _dxf_outline(text, rng)
    k = int(rng.integers(len(rows)))
    moved = _moved(points, k, by)
    at = outline.start()
    row = f" 10\n{moved.real:.7f}\n 20\n{moved.imag:.7f}\n"
    path.write_text(text[: at + rows[k].start()] + row + text[at + rows[k].end() :])
    return path.name


def _long_edge(points, rng):
    """An edge among the longest of an outline, and the chord's share by which an arc in its place bulges too far."""
    lengths = [abs(b - a) for a, b in zip(points, points[1:])]
    k = int(rng.choice(np.argsort(lengths)[-6:]))
    return k, 2.2 * TOLERANCE / lengths[k]


def dxf_bulge(folder, rng):
    """An arc in place of a long edge: all vertices are as they were."""
    path = folder / "bars.dxf"
    text = path.read_text()
    outline, rows, points = _dxf_outline(text, rng)
    k, share = _long_edge(points, rng)
    at = outline.start() + rows[k].end()
    path.write_text(f"{text[:at]} 42\n{2 * share:.9f}\n{text[at:]}")
    return path.name


def svg_bulge(folder, rng):
    """An arc in place of a long edge: all vertices are as they were."""
    path = folder / "bars.svg"
    text = path.read_text()
    outlines = list(re.finditer(r'd="M([^"]+)Z" class="CUT"', text))
    outline = outlines[rng.integers(len(outlines))]
    pairs = outline.group(1).split()
    points = [complex(*map(float, pair.split(","))) for pair in pairs]
    k, share = _long_edge(points, rng)
    # Radius of an arc over a chord c that it leaves by s, small next to it: c^2 / (8 s) + s / 2.
    chord = abs(points[k + 1] - points[k])
    radius = chord / (8 * share) + chord * share / 2
    pairs[k + 1] = f"A{radius:.9f},{radius:.9f} 0 0 1 {pairs[k + 1]} L"
    path.write_text(text[: outline.start(1)] + " ".join(pairs).removesuffix("L") + text[outline.end(1) :])
    return path.name


def svg_vertex(folder, rng):
    path = folder / "bars.svg"
    text = path.read_text()
    outlines = list(re.finditer(r'd="M([^"]+)Z" class="CUT"', text))
    outline = outlines[rng.integers(len(outlines))]
    pairs = outline.group(1).split()
    points = [complex(*map(float, pair.split(","))) for pair in pairs]
    k = int(rng.integers(len(points)))
    moved = _moved(points, k)
    pairs[k] = f"{moved.real:.7f},{moved.imag:.7f}"
    path.write_text(text[: outline.start(1)] + " ".join(pairs) + text[outline.end(1) :])
    return path.name


STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])


def _stl(folder, rng):
    path = rng.choice(sorted(folder.glob("*.stl")))
    content = path.read_bytes()
    return path, content, np.frombuffer(content[84:], STL).copy()


def stl_vertex(folder, rng):
    """A corner moved outwards in all triangles that meet there: still watertight."""
    path, content, rows = _stl(folder, rng)
    corners = rows["corners"].reshape(-1, 3).copy()
    # A corner of a round end: its neighbours along the outline are close.
    least = corners[:, 0].min()
    chosen = corners[corners[:, 0] < least + 1.0]
    corner = chosen[rng.integers(len(chosen))].copy()
    corners[(corners == corner).all(axis=1)] += np.array([-2.2 * TOLERANCE, 0, 0], dtype="<f4")
    rows["corners"] = corners.reshape(-1, 3, 3)
    path.write_bytes(content[:84] + rows.tobytes())
    return path.name


def stl_bits(folder, rng):
    """A bit that changes a coordinate by a large share of itself."""
    path, content, rows = _stl(folder, rng)
    corners = rows["corners"].reshape(-1, 3).copy()
    place = rng.integers(len(corners)), int(rng.integers(2))
    bits = corners[place].view("<u4")
    corners[place] = np.uint32(bits ^ np.uint32(1 << int(rng.integers(20, 30)))).view("<f4")
    rows["corners"] = corners.reshape(-1, 3, 3)
    path.write_bytes(content[:84] + rows.tobytes())
    return path.name


def triangle_turned(folder, rng):
    path, content, rows = _stl(folder, rng)
    k = rng.integers(len(rows))
    rows["corners"][k] = rows["corners"][k][::-1]
    path.write_bytes(content[:84] + rows.tobytes())
    return path.name


def step_radius(folder, rng):
    """All ends of one part's arcs at a radius that is too large."""
    path = rng.choice(sorted(folder.glob("*.step")))
    text = path.read_text()
    points = list(re.finditer(r"CARTESIAN_POINT\('',\(([-\d.E]+),([-\d.E]+),", text))
    chosen = points[rng.integers(len(points))]
    path.write_text(f"{text[: chosen.start(1)]}{float(chosen.group(1)) + 0.02:.9f}{text[chosen.end(1) :]}")
    return path.name


def hole_dropped(folder, rng):
    path = folder / "bars.dxf"
    text = path.read_text()
    holes = [m for m in re.finditer(r"  0\nCIRCLE\n(?:.*\n.*\n)*?(?=  0\n)", text) if "\nHOLE\n" in m.group()]
    hole = holes[rng.integers(len(holes))]
    path.write_text(text[: hole.start()] + text[hole.end() :])
    return path.name


def svg_hole_dropped(folder, rng):
    path = folder / "bars.svg"
    text = path.read_text()
    holes = list(re.finditer(r'<circle[^>]*class="HOLE"[^>]*/>\n', text))
    hole = holes[rng.integers(len(holes))]
    path.write_text(text[: hole.start()] + text[hole.end() :])
    return path.name


def part_dropped(folder, rng):
    path = folder / "bars.svg"
    text = path.read_text()
    groups = list(re.finditer(r"<g .*?</g>\n", text, re.DOTALL))
    group = groups[rng.integers(len(groups))]
    path.write_text(text[: group.start()] + text[group.end() :])
    return path.name


def dxf_units(folder, rng):
    path = folder / "bars.dxf"
    text = path.read_text()
    path.write_text(re.sub(r"(\$INSUNITS\n 70\n\s*)4", rf"\g<1>{rng.choice([1, 5, 6])}", text))
    return path.name


def svg_units(folder, rng):
    path = folder / "bars.svg"
    text = path.read_text()
    path.write_text(re.sub(r'width="(\d+)mm" height="(\d+)mm"', r'width="\1" height="\2"', text))
    return path.name


def _glb(path, change):
    """Change the positions of the first mesh of a GLB file, a view of its bytes as floats (n, 3)."""
    content = bytearray(path.read_bytes())
    (length,) = struct.unpack_from("<I", content, 12)
    data = json.loads(content[20 : 20 + length])
    accessor = data["accessors"][data["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    view = data["bufferViews"][accessor["bufferView"]]
    start = 28 + length + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    change(np.frombuffer(content, "<f4", 3 * accessor["count"], start).reshape(-1, 3))
    path.write_bytes(content)
    return path.name


def glb_scaled(folder, rng):
    def change(corners):
        corners *= np.float32(rng.choice([1.01, 1e-3, 25.4]))

    return _glb(folder / "bars-assembly.glb", change)


def glb_bits(folder, rng):
    """A bit that changes a coordinate by a large share of itself."""

    def change(corners):
        k = rng.choice(np.flatnonzero(np.abs(corners[:, 0]) > 1e-3))
        bits = corners[k, :1].view("<u4")
        bits ^= np.uint32(1 << int(rng.integers(20, 30)))

    return _glb(folder / "bars-assembly.glb", change)


def scaled(folder, rng):
    path = folder / "bars.svg"
    text = path.read_text()
    path.write_text(re.sub(r'viewBox="0 0 (\d+)', lambda m: f'viewBox="0 0 {int(m.group(1)) * 1.01}', text)
                    .replace("<svg ", '<svg preserveAspectRatio="xMinYMin meet" '))  # fmt: skip
    return path.name


def _truncated(path, rng):
    content = path.read_bytes()
    path.write_bytes(content[: int(rng.integers(1, len(content) - 40))])
    return path.name


def truncated_dxf(folder, rng):
    return _truncated(folder / "bars.dxf", rng)


def truncated_stl(folder, rng):
    return _truncated(rng.choice(sorted(folder.glob("*.stl"))), rng)


def truncated_glb(folder, rng):
    return _truncated(folder / "bars-assembly.glb", rng)


def truncated_3mf(folder, rng):
    return _truncated(folder / "bars.3mf", rng)


truncated_threemf = truncated_3mf


def truncated_svg(folder, rng):
    return _truncated(folder / "bars.svg", rng)


def truncated_step(folder, rng):
    return _truncated(rng.choice(sorted(folder.glob("*.step"))), rng)


def truncated_csv(folder, rng):
    return _truncated(folder / "bars.csv", rng)


def _threemf(path, change):
    """Change the text of the model in a 3MF package."""
    with zipfile.ZipFile(path) as package:
        inside = {name: package.read(name) for name in package.namelist()}
    model = inside["3D/3dmodel.model"].decode()
    inside["3D/3dmodel.model"] = change(model).encode()
    assert inside["3D/3dmodel.model"].decode() != model
    with zipfile.ZipFile(path, "w") as package:
        for name, content in inside.items():
            package.writestr(name, content)
    return path.name


def threemf_unit(folder, rng):
    return _threemf(folder / "bars.3mf", lambda text: text.replace('unit="millimeter"', 'unit="inch"'))


def threemf_triangle(folder, rng):
    """A triangle whose corners run the other way round."""

    def change(text):
        chosen = rng.choice(list(re.finditer(r'v1="(\d+)" v2="(\d+)"', text)))
        return f'{text[: chosen.start()]}v1="{chosen.group(2)}" v2="{chosen.group(1)}"{text[chosen.end() :]}'

    return _threemf(folder / "bars.3mf", change)


def threemf_vertex(folder, rng):
    def change(text):
        chosen = rng.choice(list(re.finditer(r'<vertex x="([^"]+)"', text)))
        return f"{text[: chosen.start(1)]}{float(chosen.group(1)) + 0.05:.6f}{text[chosen.end(1) :]}"

    return _threemf(folder / "bars.3mf", change)


def step_digit(folder, rng):
    """Another digit of a coordinate, of tenths of a millimetre."""
    path = rng.choice(sorted(folder.glob("*.step")))
    text = path.read_text()
    points = list(re.finditer(r"CARTESIAN_POINT\('',\([-\d]+\.(\d)", text))
    chosen = points[rng.integers(len(points))]
    digit = (int(chosen.group(1)) + int(rng.integers(1, 9))) % 10
    path.write_text(f"{text[: chosen.start(1)]}{digit}{text[chosen.end(1) :]}")
    return path.name


def csv_number(folder, rng):
    path = folder / "bars.csv"
    lines = path.read_text().split("\n")
    k = int(rng.integers(1, len(lines) - 1))
    cells = lines[k].split(",")
    j = int(rng.integers(len(cells)))
    cells[j] = repr(float(cells[j] or 0) * (1 + 1e-6) + 1e-6)
    path.write_text("\n".join([*lines[:k], ",".join(cells), *lines[k + 1 :]]))
    return path.name


def bill_count(folder, rng):
    path = folder / "bars-bom.csv"
    lines = path.read_text().split("\n")
    k = int(rng.integers(1, len(lines) - 1))
    name, count, rest = lines[k].rsplit('"', 1)[-1].split(",", 2) if '"' in lines[k] else lines[k].split(",", 2)
    lines[k] = f"{name},{int(count) + 1},{rest}"
    path.write_text("\n".join(lines))
    return path.name


def layer(folder, rng):
    path = folder / "bars.dxf"
    text = path.read_text()
    holes = list(re.finditer(r"\n  8\nHOLE\n", text))
    hole = holes[rng.integers(len(holes))]
    path.write_text(f"{text[: hole.start()]}\n  8\nCUT\n{text[hole.end() :]}")
    return path.name
