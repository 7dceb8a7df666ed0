"""Names and files from recipes: data, never a path, a formula or an order to the terminal."""

import csv
import json
import os
import re
import sys

import numpy as np
import pytest

from geomkin.export.tables import csv as written
from geomkin.model.table import Column, Table

EVIL = [
    "../../evil",
    "/tmp/geomkin-evil/x",
    "a/b",
    "x\\u001b[31m",
    "a\\n",
    "",
    ".",
    "..",
    "-rf",
    "CON",
    "com1:x",
    "\\u202ex",
]
LINKAGE = """kind = "linkage"
[linkage]
driver = "{crank}"
[linkage.bodies]
ground = {{ O = [0, 0], C = [100, 0] }}
"{crank}" = {{ O = [0, 0], "{pin}" = [30, 0] }}
coupler = {{ "{pin}" = [0, 0], B = [90, 0], "{point}" = [40, 25] }}
rocker = {{ C = [0, 0], B = [70, 0] }}
[drive]
step_deg = 10
"""


def everything(folder):
    return {path: path.is_file() and path.read_bytes() for path in folder.rglob("*")}


@pytest.mark.parametrize(("name", "place"), list(zip(EVIL, 4 * ("crank", "pin", "point"))))
def test_a_name_in_a_recipe_never_leaves_its_folder(geomkin, here, name, place):
    (here / "deep/er").mkdir(parents=True)
    file = here / "deep/er/r.toml"
    file.write_text(LINKAGE.format(**({"crank": "crank", "pin": "A", "point": "P"} | {place: name})))
    before = everything(here)
    result = geomkin("run", file, "--out", here / "deep/er/out")
    assert result.exit_code == 1 and everything(here) == before and not os.path.exists("/tmp/geomkin-evil")
    # A body and a pin of two bodies may be named in more than one place.
    lines = result.stderr.splitlines()
    assert lines and all(line.isprintable() and re.search(r"linkage\.bodies[.:]", line) for line in lines)


def test_no_spreadsheet_runs_a_header_or_a_text():
    for name in ("=HYPERLINK(1)", "+1+cmd", "-2+3", "@SUM(1)", "\t=1", "\uff1d1"):
        header, row = csv.reader(written(Table((Column(name, "deg", "", np.array([name])),))).decode().splitlines())
        for cell in header + row:
            assert cell.startswith("'") and cell.isprintable()


TABLE = """kind = "disk-cam"
[cam]
base_radius = 30
program = [{{ kind = "table", decimals = 3, file = {name} }}]
follower = {{ kind = "translating-roller", roller_radius = 5 }}
"""
ROWS = "cam_angle_deg,lift_mm\n" + "".join(f"{a},{5 - 5 * np.cos(np.radians(a)):.3f}\n" for a in range(0, 361, 5))


@pytest.fixture
def cam(here, geomkin):
    """cam(name): run a cam in `home` whose table is the file of that name, with secrets around."""

    def run(name):
        (here / "home/below").mkdir(parents=True, exist_ok=True)
        for file in ("home/lift.csv", "home/below/lift.csv", "outside.csv"):
            (here / file).write_text(ROWS)
        (here / "secret.txt").write_text("password hunter2\n")
        (here / "home/r.toml").write_text(TABLE.format(name=json.dumps(name)))
        return geomkin("run", "home/r.toml", "--only", "csv")

    return run


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes by name here")
def test_links_out_of_the_folder_and_special_files_are_refused(cam, here):
    (here / "home").mkdir()
    (here / "home/link.csv").symlink_to(here / "outside.csv")
    (here / "home/way").symlink_to(here)
    (here / "home/zero.csv").symlink_to("/dev/zero")
    (here / "home/round.csv").symlink_to("round.csv")
    os.mkfifo(here / "home/pipe.csv")
    for name in ("link.csv", "way/outside.csv", "zero.csv", "pipe.csv", "round.csv"):
        result = cam(name)
        assert result.exit_code == 1 and "cam.program[0].file: " in result.stderr, name


# What may lie where a run looks for the summary of the run before, and what makes it.
OLD = {
    "pipe": "os.mkfifo(old)",
    "endless": 'os.symlink("/dev/zero", old)',
    "terminal": 'os.symlink("/dev/tty", old)',
    "huge": 'open(old, "wb").truncate(3 << 30)',
    "deep": 'open(old, "w").write("[" * 1_000_000)',
    "long": 'open(old, "w").write(\'{"files": ["\' + "x" * 9_000_000 + \'.dxf"]}\')',
    "folder": "os.mkdir(old)",
}


@pytest.mark.campaign
@pytest.mark.skipif(sys.platform != "linux", reason="devices and pipes by these names are its own")
def test_whatever_an_old_summary_is_a_run_ends(command, recipe, here):
    before = "import os"
    for name, made in OLD.items():
        (here / f"{name}.toml").write_text(recipe("spur-gear", {"files.write": '["csv"]'}))
        before += f'\nold = "out/{name}/summary.json"\nos.makedirs(os.path.dirname(old))\n{made}'
    done = command("run", ".", before=before)
    reported = re.findall(r"^out/(\w+)/summary.json: ", done.stderr, re.MULTILINE)
    assert len(reported) == len(done.stderr.splitlines()) and done.returncode == bool(reported)
    for name in OLD.keys() - reported:
        assert json.loads((here / "out" / name / "summary.json").read_text())["name"] == name
