"""Names of a folder that are loaded when asked for: found, listed, starred, pickled, with and without the source."""

import copy
import importlib
import inspect
import pickle
import subprocess
import sys
import zipfile
from compileall import compile_dir
from pathlib import Path

import pytest

import geomkin as gk
from geomkin import lazy

PACKAGE = Path(gk.__file__).parent
ROOMS = [gk, gk.cam, gk.export, gk.gear, gk.judge, gk.linkage, gk.plane, gk.shop, gk.scenes, gk.synthesis]
every_room = pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.__name__)
# What says that a copy of geomkin works: its names are listed, loaded and run.
TRIED = "import geomkin as gk; print(gk.__file__, len(dir(gk)), len(dir(gk.plane)), gk.area(gk.plane.Circle(0j, 1)))"


def run(code, path=None, tmp_path=None):
    """What Python prints of this code in a fresh interpreter; path: where it finds geomkin."""
    found = f"import sys; sys.path.insert(0, {str(path)!r})\n" if path else ""
    return subprocess.run(
        [sys.executable, "-c", found + code], capture_output=True, text=True, check=True, cwd=tmp_path
    ).stdout.split()


def listed(room):
    """The names below `if TYPE_CHECKING:`, read from the text."""
    lines = Path(room.__file__).read_text().splitlines()
    return {line.split()[-1] for line in lines if line.startswith("    from .")} - {"attach"}


@every_room
def test_all_names_for_type_checkers_are_there_and_no_others(room):
    assert {name for name in dir(room) if not name.startswith("__")} == listed(room) == set(room.__all__)
    for name in listed(room):
        thing = getattr(room, name)
        assert getattr(thing, "__name__", name).split(".")[-1] == name or not callable(thing)
        assert vars(room)[name] is thing, "what was loaded is kept"


@every_room
def test_what_is_not_there_is_told_as_python_tells_it(room):
    with pytest.raises(AttributeError, match=f"module '{room.__name__}' has no attribute 'nothing'") as refusal:
        _ = room.nothing
    assert refusal.value.name == "nothing" and refusal.value.obj is room
    assert not hasattr(room, "_private") and not hasattr(room, "__wrapped__")
    with pytest.raises(ImportError):
        exec(f"from {room.__name__} import nothing")


@every_room
def test_a_star_takes_all_names(room):
    taken = {}
    exec(f"from {room.__name__} import *", taken)
    assert set(taken) - {"__builtins__"} == listed(room)


def test_asking_loads_what_is_asked_for_and_no_more():
    code = (
        "import sys, geomkin as gk\ndir(gk), hasattr(gk, 'nothing')\nprint('numpy' in sys.modules)\ngk.plane.Circle\n"
    )
    code += (
        "print('numpy' in sys.modules, any('linkage' in m for m in sys.modules), 'geomkin.plane.region' in sys.modules)"
    )
    assert run(code) == ["False", "True", "False", "False"]


def test_a_copy_in_a_zip_works(tmp_path):
    with zipfile.ZipFile(tmp_path / "geomkin.zip", "w") as archive:
        for file in PACKAGE.rglob("*.py"):
            archive.write(file, file.relative_to(PACKAGE.parent))
    where, *rest = run(TRIED, tmp_path / "geomkin.zip", tmp_path)
    assert "geomkin.zip" in where and rest == run(TRIED)[1:]


def test_a_copy_without_its_source_works(tmp_path):
    for file in PACKAGE.rglob("*.py"):
        copied = tmp_path / file.relative_to(PACKAGE.parent)
        copied.parent.mkdir(parents=True, exist_ok=True)
        copied.write_text(file.read_text())
    compile_dir(tmp_path, quiet=1, legacy=True)
    for file in tmp_path.rglob("*.py"):
        file.unlink()
    where, *rest = run(TRIED, tmp_path, tmp_path)
    assert where == str(tmp_path / "geomkin" / "__init__.pyc") and rest == run(TRIED)[1:]


def test_what_was_loaded_so_is_pickled_by_its_own_home():
    for thing in (gk.FourBar, gk.move, gk.plane.Circle, gk.area):
        assert pickle.loads(pickle.dumps(thing)) is thing and copy.deepcopy(thing) is thing
    circle = pickle.loads(pickle.dumps(gk.plane.Circle(1j, 2.0)))
    assert (circle.centre, circle.radius) == (1j, 2.0)


def test_a_name_is_known_to_shells_and_to_help():
    assert "FourBar" in dict(inspect.getmembers(gk))
    assert "signed_area" in "".join(run("import geomkin, pydoc; print(pydoc.plain(pydoc.render_doc(geomkin.plane)))"))


def test_a_name_may_have_another_there_and_what_is_private_stays_so(tmp_path, monkeypatch):
    home = tmp_path / "toyroom"
    home.mkdir()
    (home / "__init__.py").write_text(
        "from __future__ import annotations\nfrom typing import TYPE_CHECKING\nfrom .inner import VERSION as __version__\n"
        "if TYPE_CHECKING:\n    from . import inner as inside\n    from .inner import Thing as Renamed\n"
        "else:\n    from geomkin.lazy import attach\n    __getattr__, __dir__ = attach(__name__)\n"
    )
    (home / "inner.py").write_text("VERSION = 'one'\nclass Thing: pass\n")
    monkeypatch.syspath_prepend(tmp_path)
    toy = importlib.import_module("toyroom")
    assert sorted(toy.__all__) == ["Renamed", "inside"] and toy.__version__ == "one"
    assert toy.Renamed is toy.inside.Thing
    assert lazy.attach("toyroom")[1]() == dir(toy)
