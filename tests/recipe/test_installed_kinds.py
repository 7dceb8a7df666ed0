"""A kind of another package, which an entry point of that package names."""

import json
import runpy
import subprocess
import sys
import tomllib
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.core.fields import entry, quantity
from geomkin.recipe import AbstractRecipe, Files
from geomkin.recipe.load import parse
from geomkin.recipe.template import template

MODULE = '''
"""A disc."""
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import geomkin as gk
from geomkin.core.fields import check_sizes, entry, quantity
from geomkin.recipe import AbstractRecipe, Files


@dataclass(frozen=True)
class Disc:
    radius: float = quantity("outer radius", "mm", above=0, at_most=1000, example=20)

    def __post_init__(self):
        check_sizes(self)


@dataclass(frozen=True, kw_only=True)
class DiscRecipe(AbstractRecipe):
    """A round plate."""

    kind: Literal["disc"] = "disc"
    disc: Disc
    files: Files = entry("files to write", default=Files(write=("dxf",)))
    scene = None

    @property
    def design(self):
        return self.disc

    @property
    def table(self):
        return gk.Table(())

    @cached_property
    def parts(self):
        return (gk.Part("disc", gk.plane.Circle(0, self.disc.radius), (), 3.0),)

    @property
    def design_checks(self):
        return (gk.Check("radius", "radius", self.disc.radius, "at least", 10.0, "mm"),)
'''


@pytest.fixture
def site(tmp_path, monkeypatch):
    """A folder on the path with a package that has the entry points given; the working folder is next to it."""

    def installed(entries):
        info = tmp_path / "site" / "disc_maker-1.0.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: disc-maker\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[geomkin.kinds]\n{entries}\n")
        (tmp_path / "site" / "disc_maker.py").write_text(MODULE)
        monkeypatch.syspath_prepend(tmp_path / "site")
        monkeypatch.chdir(tmp_path)
        return tmp_path / "site"

    yield installed
    sys.modules.pop("disc_maker", None)


def command(*words):
    return CliRunner().invoke(cli, words)


def test_the_command_lists_checks_and_makes_a_kind_of_another_package(site, tmp_path):
    folder = site("disc = disc_maker:DiscRecipe")
    (tmp_path / "a.toml").write_text(command("new", "disc").stdout)
    assert command("run", "a.toml").exit_code == 0 and (tmp_path / "out" / "a" / "a.dxf").is_file()
    assert "disc" in json.loads(command("schema").stdout)["properties"]["kind"]["enum"]
    (tmp_path / "b.toml").write_text('kind = "dics"\n')
    assert "did you mean disc?" in command("check", "b.toml").stderr
    # The same in a process of its own.
    code = f"import sys; sys.path.insert(0, {str(folder)!r}); from geomkin.__main__ import main; main()"
    listed = subprocess.run([sys.executable, "-c", code, "list"], capture_output=True, text=True).stdout.splitlines()
    assert listed[-2:] == ["other packages", listed[-1]] and listed[-1].split() == ["disc", "A", "round", "plate."]


def test_a_kind_of_the_table_stays_and_a_class_that_cannot_be_imported_gives_an_error_with_its_name(site):
    site("spur-gear = disc_maker:DiscRecipe\ndisc = disc_maker:Missing")
    assert 'kind = "spur-gear"' in command("new", "spur-gear").stdout
    result = command("new", "disc")
    assert isinstance(result.exception, gk.GeomkinError) and "disc_maker:Missing" in str(result.exception)


@dataclass(frozen=True, kw_only=True)
class Block(AbstractRecipe):
    """A block, most of whose keys have neither a default nor an example."""

    kind: Literal["spur-gear"] = "spur-gear"
    width: float
    count: int
    depth: float = quantity("depth", "mm", above=3)
    height: float = quantity("height", "mm", above=0, below=0.5)
    most: float = quantity("upper limit", "mm", at_most=-4)
    rows: int = quantity("number of rows", at_least=2, at_most=9, whole=True)
    side: Literal["left", "right"]
    is_long: bool = entry("whether it is long", default=True)
    names: dict[str, str] = field(default_factory=dict)
    files: Files = entry("what is written", default=Files())
    design = table = parts = design_checks = None


def test_a_template_has_a_value_for_each_required_key(monkeypatch):
    monkeypatch.setattr("geomkin.recipe.load.recipe_class", lambda kind: Block)
    recipe = parse(template(Block))
    assert recipe.depth > 3 and 0 < recipe.height < 0.5 and recipe.most <= -4 and 2 <= recipe.rows <= 9
    assert recipe.width > 0 and recipe.count > 0 and recipe.side == "left"


def test_a_required_text_without_an_example_is_named():
    @dataclass(frozen=True, kw_only=True)
    class Named(Block):
        title: str

    with pytest.raises(gk.GeomkinError, match=r"Named\.title"):
        template(Named)


def test_a_new_kind_runs_and_its_own_test_passes(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)

    def command(*words):
        result = CliRunner().invoke(cli, words)
        return result.exit_code, result.stdout

    assert command("new-kind", "geneva-drive")[0] == 0
    folder = tmp_path / "geomkin-geneva-drive"
    # What an installation adds: the folder on the path, and its entry points.
    points = tomllib.loads((folder / "pyproject.toml").read_text())["project"]["entry-points"]
    info = folder / "geomkin_geneva_drive-0.1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: geomkin-geneva-drive\nVersion: 0.1\n")
    lines = [f"[{group}]\n{name} = {home}\n" for group, row in points.items() for name, home in row.items()]
    (info / "entry_points.txt").write_text("".join(lines))
    monkeypatch.syspath_prepend(folder)
    assert command("check", "--strict", str(folder / "geneva-drive.toml"))[0] == 0
    code, text = command("new", "geneva-drive")
    assert code == 0 and gk.load(text).kind == "geneva-drive"
    tests = runpy.run_path(str(folder / "test_geomkin_geneva_drive.py"))
    assert [test() for name, test in tests.items() if name.startswith("test_")] == [None]
    # Nothing is overwritten.
    assert command("new-kind", "geneva-drive")[0] == 2
    for name in ("four-bar", "None", "../up", "a b", ""):
        assert command("new-kind", name)[0] == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["geomkin-geneva-drive"]


def test_the_eccentric_of_a_new_kind_is_lifted_as_its_disc_reaches():
    """The highest point of the disc, by brute force."""
    from geomkin.recipe.example_kind import Eccentric, ExampleRecipe

    recipe = ExampleRecipe(eccentric=Eccentric(radius=25, eccentricity=7))
    (body,) = recipe.scene.bodies
    rim = recipe.parts[0].outline
    points = rim.point(np.linspace(rim.breaks[0], rim.breaks[-1], 4001))
    highest = (body.origin[:, None] + body.direction[:, None] * points).imag.max(axis=1)
    assert recipe.table["lift"] == pytest.approx(highest - highest.min(), abs=1e-4)
    assert recipe.scene.marks[0].place.imag == pytest.approx(highest, abs=1e-4)
    with pytest.raises(gk.DesignError) as refused:
        Eccentric(radius=10, eccentricity=7, bore=6)
    assert refused.value.field == "eccentricity"
