"""A kind of another package, which an entry point of that package names."""

import json
import subprocess
import sys

import pytest

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
def command(tmp_path):
    """Runs geomkin in a process whose path holds a package with the entry points given."""

    def run(entries, *words):
        info = tmp_path / "site" / "disc_maker-1.0.dist-info"
        info.mkdir(parents=True, exist_ok=True)
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: disc-maker\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[geomkin.kinds]\n{entries}\n")
        (tmp_path / "site" / "disc_maker.py").write_text(MODULE)
        code = f"import sys; sys.path.insert(0, {str(tmp_path / 'site')!r}); from geomkin.__main__ import main; main()"
        return subprocess.run([sys.executable, "-c", code, *words], cwd=tmp_path, capture_output=True, text=True)

    return run


def test_the_command_lists_checks_and_makes_a_kind_of_another_package(command, tmp_path):
    entries = "disc = disc_maker:DiscRecipe"
    listed = command(entries, "list").stdout.splitlines()
    assert listed[-2:] == ["other packages", listed[-1]] and listed[-1].split() == ["disc", "A", "round", "plate."]
    (tmp_path / "a.toml").write_text(command(entries, "new", "disc").stdout)
    assert command(entries, "run", "a.toml").returncode == 0 and (tmp_path / "out" / "a" / "a.dxf").is_file()
    assert "disc" in json.loads(command(entries, "schema").stdout)["properties"]["kind"]["enum"]
    (tmp_path / "b.toml").write_text('kind = "dics"\n')
    assert "did you mean disc?" in command(entries, "check", "b.toml").stderr


def test_a_kind_of_the_table_stays_and_a_class_that_cannot_be_imported_gives_an_error_with_its_name(command):
    entries = "spur-gear = disc_maker:DiscRecipe\ndisc = disc_maker:Missing"
    assert 'kind = "spur-gear"' in command(entries, "new", "spur-gear").stdout
    result = command(entries, "new", "disc")
    assert result.returncode == 1 and "disc_maker:Missing" in result.stderr and "Traceback" not in result.stderr
