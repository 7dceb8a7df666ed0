"""What the hostile tests share: recipes to spoil, the command inside this process or in one of its own."""

import csv
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.recipe.kinds import KINDS
from tests.texts import template_of

DWELL = '{kind = "dwell", end_deg = 90}'
RISE = '{kind = "rise", law = "cycloidal", rise = 20, end_deg = 180}'
REST = '{kind = "dwell", duration_deg = 90}'
RETURN = '{kind = "return", law = "harmonic", end_deg = 360}'
# Good recipes as dotted key -> TOML value, so that a test names only what it spoils.
GOOD = {
    "four-bar": {
        "linkage.ground": "100",
        "linkage.crank": "30",
        "linkage.coupler": "90",
        "linkage.rocker": "70",
        "linkage.coupler_point": "[40, 25]",
        "drive.step_deg": "5",
    },
    "disk-cam": {
        "cam.base_radius": "40",
        "cam.follower": '{kind = "translating-roller", roller_radius = 10, offset = 5}',
        "cam.program": f"[{DWELL}, {RISE}, {REST}, {RETURN}]",
        "drive.step_deg": "5",
    },
    "spur-gear": {"gear.teeth": "24", "gear.module": "2", "stock.bore": "8"},
    "ring-gear": {"gear.teeth": "60", "gear.module": "2"},
}
# Runs before every command in a process of its own, and keeps a greedy failure off the machine.
LIMIT = """
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
except (ImportError, OSError, ValueError):
    pass
"""


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """An empty working folder of its own for every test."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def recipe():
    """recipe(kind, {dotted key: TOML value, or None to leave the key out}): a TOML text."""

    def text(kind, changes=None):
        keys = GOOD[kind] | (changes or {})
        return f'kind = "{kind}"\n' + "".join(f"{key} = {value}\n" for key, value in keys.items() if value is not None)

    return text


@pytest.fixture
def geomkin():
    """geomkin(*arguments): the command in this process, where a warning counts as an error."""

    def call(*arguments):
        result = CliRunner().invoke(cli, [str(a) for a in arguments])
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise AssertionError("the command let an exception through") from result.exception
        return result

    return call


@pytest.fixture
def run(geomkin, here):
    """run(text or bytes, *options): `geomkin run r.toml` with that content."""

    def call(content, *options):
        (here / "r.toml").write_bytes(content if isinstance(content, bytes) else content.encode())
        return geomkin("run", "r.toml", *options)

    return call


@pytest.fixture
def command(here):
    """command(*arguments, before="", ...): the command in a process of its own, after the code in `before`."""

    def call(*arguments, before="", timeout=100, **options):
        code = f"{LIMIT}\n{before}\nfrom geomkin.__main__ import main\nmain()"
        where = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
        done = subprocess.run([sys.executable, "-c", code, *map(str, arguments)], text=True, timeout=timeout, **where)
        assert "Traceback" not in (done.stderr or ""), done.stderr
        assert "Warning" not in (done.stderr or "") and "please report" not in (done.stderr or ""), done.stderr
        return done

    return call


@pytest.fixture(scope="session")
def known_keys():
    """Every key that a recipe may have, dotted, as the templates list them."""
    keys = {"(whole file)", "kind"}
    for kind in KINDS:
        table = ""
        for line in template_of(kind).splitlines():
            if line.startswith("["):
                table = line.strip("[]")
                keys |= {table, table.split(".")[0]}
            elif match := re.match(r"(?:# )?(\w+) +=", line):
                keys.add(f"{table}.{match[1]}".lstrip("."))
    return keys


@pytest.fixture
def refused(here, known_keys):
    """refused(result, key, word): one line that names file, key and remedy; exit 1; nothing written.

    With many=True several lines, each of them such.
    """

    def judge(result, key="", word="", many=False):
        assert result.exit_code == 1
        # Splitting at every kind of line end shows what would break a terminal's line.
        lines = result.stderr.splitlines()
        assert len(lines) == 1 or (many and lines), lines
        for line in lines:
            assert line.isprintable() and "please report" not in line, line
            named, found_key, rest = line.split(": ", 2)
            assert named == "r.toml"
            assert found_key == key or found_key.startswith((f"{key}.", f"{key}[")) or not key, line
            assert "unknown key" in rest or re.sub(r"\[\d+\]", "", found_key) in known_keys, line
            assert word in rest and "; " in rest, line
        assert not (here / "out").exists()

    return judge


@pytest.fixture
def sound():
    """sound(folder): every file in it is whole and holds only finite numbers; returns their names.

    With gaps=True cells of tables may be empty, as they are where a mechanism does not reach.
    """

    def judge(folder, gaps=False):
        files = sorted(p for p in Path(folder).rglob("*") if p.is_file())
        for file in files:
            JUDGES[file.suffix](file, *([gaps] if file.suffix == ".csv" else []))
        return [file.name for file in files]

    return judge


def _json(file):
    def refuse(word):
        raise AssertionError(f"{file.name} holds {word}, which JSON does not know")

    assert json.loads(file.read_text(encoding="utf-8"), parse_constant=refuse)


def _csv(file, gaps):
    header, *rows = csv.reader(file.read_text(encoding="utf-8").splitlines())
    assert rows and {len(row) for row in rows} == {len(header)}
    if file.name.endswith("-bom.csv"):
        # A part may be named nan, and only what has one has a thickness: of a bill the numbers are judged.
        assert all(np.isfinite(float(cell)) for row in rows for cell in row[1:5] if cell), file.name
        return
    cells = [(name, cell) for row in rows for name, cell in zip(header, row, strict=True)]
    assert not {"nan", "inf", "-inf"} & {cell for _, cell in cells}, file.name
    # At a step of a cam's motion acceleration and jerk are infinite, and left empty.
    assert gaps or all(cell or "acceleration" in name or "jerk" in name for name, cell in cells), file.name


def _svg(file):
    drawing = ElementTree.fromstring(file.read_text(encoding="utf-8"))
    assert drawing.get("width").endswith(("mm", "in"))
    # A part may be named nan; no number may.
    numbers = [value for element in drawing.iter() for name, value in element.attrib.items() if name != "id"]
    assert not [value for value in numbers if re.search(r"\b(nan|inf)\b", value)]


def _stl(file):
    layout = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    corners = np.frombuffer(file.read_bytes()[84:], layout)["corners"]
    assert len(corners) and np.isfinite(corners).all(), file.name
    # Single precision can merge corners that were apart when the mesh was checked: such triangles are gaps.
    assert (corners != np.roll(corners, 1, axis=1)).any(axis=2).all(), f"{file.name}: triangles without area"


def _3mf(file):
    package = zipfile.ZipFile(file)
    assert package.testzip() is None
    model = ElementTree.fromstring(package.read("3D/3dmodel.model"))
    core = model.tag.removesuffix("model")
    for mesh in model.iter(f"{core}mesh"):
        points = np.array([[float(v.get(k)) for k in "xyz"] for v in mesh.iter(f"{core}vertex")])
        faces = np.array([[int(t.get(f"v{k}")) for k in (1, 2, 3)] for t in mesh.iter(f"{core}triangle")])
        assert np.isfinite(points).all() and len(faces) and 0 <= faces.min() and faces.max() < len(points)
        # Each edge is run along once each way.
        edges = np.concatenate([faces, faces[:, [1, 2, 0]]]).reshape(2, -1).T
        assert {tuple(edge) for edge in edges} == {tuple(edge[::-1]) for edge in edges}, file.name


def _dxf(file):
    for entity in ezdxf.readfile(file).modelspace():
        if entity.dxftype() == "CIRCLE":
            assert 0 < entity.dxf.radius < np.inf
        elif entity.dxftype() == "TEXT":
            assert (
                file.stem.endswith("-assembly") and np.isfinite(entity.dxf.insert.xyz).all() and entity.dxf.height > 0
            )
        else:
            # R12 has no LWPOLYLINE.
            is_old = entity.dxftype() == "POLYLINE"
            points = np.array([v.vec2 for v in entity.points()] if is_old else entity.get_points("xy"))
            assert np.isfinite(points).all() and len(points) >= 2
            # An open line may end where it began.
            before = np.roll(points, 1, axis=0) if entity.is_closed else points[:-1]
            assert (points[-len(before) :] != before).any(axis=1).all(), f"{file.name}: a point twice in a row"


def _html(file):
    text = file.read_text(encoding="utf-8")
    # Hashes and links in attributes may have these three letters.
    above = re.sub(r"<[^>]*>", " ", text.split("<main>")[0])
    assert text.startswith("<!doctype html>") and text.endswith("</html>\n")
    # A title of the recipe may be this word.
    assert not re.search(r"\bnan\b", above) or re.search(r"(\"|&quot;|&#x27;|')nan\1", text)
    data = re.search(r'<script type="application/json" id="scene">(.*?)</script>', text, re.DOTALL)[1]
    summary = json.loads(data, parse_constant=_refused)
    assert summary["frames"] > 1 and all(
        row is None or isinstance(row, (str, list, dict)) or np.isfinite(row) for row in summary["series"]
    )


def _refused(word):
    raise AssertionError(f"a page holds {word}, which JSON does not know")


def _toml(file):
    """What a goal found is a recipe that reads."""
    assert gk.load(file).kind


JUDGES = {
    ".toml": _toml,
    ".html": _html,
    ".json": _json,
    ".csv": _csv,
    ".svg": _svg,
    ".stl": _stl,
    ".3mf": _3mf,
    ".dxf": _dxf,
}
