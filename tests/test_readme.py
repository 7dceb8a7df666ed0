"""What the README says works: its code runs, its commands run, its pictures and recipe are those of the gallery."""

import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from geomkin.cli import cli

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_the_python_code_runs_and_its_comments_are_true(tmp_path, monkeypatch):
    shutil.copytree(ROOT / "recipes", tmp_path / "recipes")
    monkeypatch.chdir(tmp_path)
    names = {}
    for code in blocks("python"):
        exec(code, names)
    assert names["wheel"] == names["recipe"] and names["swings"].rocker.direction.shape == (361, 5)
    assert {path.name for path in Path().iterdir() if path.is_file()} == {"gear.dxf", "gear.csv", "wheel.stl"}
    assert (tmp_path / "made" / "spur-gear" / "summary.json").exists()
    assert names["gear"].is_undercut and names["gear"].form_radius == pytest.approx(11.3027, abs=5e-5)
    assert np.iscomplexobj(names["motion"].point("coupler_point").acceleration)
    assert len(names["points"]) > 100 and names["arcs"].bulges.any()


def test_the_commands_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    commands = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("geomkin ")]
    assert len(commands) >= 4
    for line in commands:
        words, _, target = line.partition(" > ")
        result = runner.invoke(cli, shlex.split(words)[1:])
        assert result.exit_code == 0, result.output
        if target:
            Path(target).write_text(result.output)
    assert {p.suffix for p in Path("made/my-cam").iterdir()} == {".dxf", ".svg", ".json"}


def test_the_messages_shown_are_the_messages_given(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("my-gear.toml").write_text('kind = "spur-gear"\n[gear]\nteeth = 2.5\nmodule = 2\nmodul = 2\n')
    result = CliRunner().invoke(cli, ["run", "my-gear.toml"])
    assert result.exit_code == 1
    assert result.output.strip() == blocks("text")[0].strip()


def test_pictures_and_recipe_are_the_gallery_s():
    for source in re.findall(r'src="([^"]+)"', README):
        assert (ROOT / source).exists(), source
    recipe = blocks("toml")[0]
    assert recipe.strip() in (ROOT / "recipes" / "spur-gear.toml").read_text()
    assert "geomkin run recipes" in blocks("sh")[0] and "pytest" in blocks("sh")[1]
