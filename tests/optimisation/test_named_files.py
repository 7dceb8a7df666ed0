"""Optima of recipes that name other files: these are next to the written recipes, which load and are the best designs."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.optimisation.designs import Trials

CAM = """kind = "disk-cam"
[cam]
base_radius = 20
follower = { kind = "translating-roller", roller_radius = 5 }
program = [{ kind = "table", file = "FILE", within = 0.1 }]
"""
LIFTS = "cam_angle_deg;lift_mm\n" + "".join(
    f"{angle};{5 - 5 * np.cos(np.radians(angle)):.6f}\n" for angle in range(0, 361, 30)
)
LEG = '# A leg.\nkind = "four-bar"\nlinkage = { ground = 100, crank = 30, coupler = 90, rocker = 70 }\n'
MACHINE = 'kind = "machine"\nmechanisms = { cam = { recipe = "cam.toml" }, leg = { recipe = "leg.toml", TURNED } }\n'
TASKS = {
    "cam.toml": ({"cam.base_radius": (20, 25)}, "max(pressure_angle)"),
    "both.toml": ({"mechanisms.leg.phase_deg": (10, 20)}, "max(leg_rocker_angle)"),
}


@pytest.fixture
def home(tmp_path):
    home = tmp_path / "home"
    (home / "lifts").mkdir(parents=True)
    (home / "lifts" / "rise.csv").write_text(LIFTS)
    (home / "cam.toml").write_text(CAM.replace("FILE", "lifts/rise.csv"))
    (home / "leg.toml").write_text(LEG)
    (home / "both.toml").write_text(MACHINE.replace("TURNED", 'turned_by = "cam.cam"'))
    return home


@pytest.fixture(autouse=True)
def few_designs(monkeypatch):
    monkeypatch.setattr(Trials, "over", lambda self: len(self.designs) >= 2)
    monkeypatch.setattr("geomkin.optimisation.search.MOST_POINTS", 2)


@pytest.mark.campaign
@pytest.mark.parametrize("name, is_opened", [("cam.toml", False), ("both.toml", False), ("both.toml", True)])
def test_written_optimum_loads_with_the_files_that_it_names(home, tmp_path, name, is_opened):
    source = gk.load(home / name) if is_opened else home / name
    best = gk.optimise(source, *TASKS[name], starts=1, out=tmp_path / "out")
    folder = tmp_path / "out" / name.removesuffix(".toml")
    assert gk.load(folder / name.replace(".", ".optimum.")) == best.recipe
    further = {folder / file for file in ("cam.toml", "leg.toml") if name == "both.toml"}
    assert {folder / "lifts" / "rise.csv", *further} < best.files.keys()


@pytest.mark.campaign
def test_written_recipes_of_a_front_load_with_the_files_that_they_name(home, tmp_path):
    vary, objective = TASKS["cam.toml"]
    front = gk.optimise(home / "cam.toml", vary, [objective, "-min(pitch_curvature)"], starts=1, out=tmp_path)
    assert gk.load(tmp_path / "cam" / "cam.front-1.toml") == front.designs[0].recipe


@pytest.mark.parametrize(
    "call", [gk.sweep, lambda source, values: gk.optimise(source, values, "max(leg_rocker_angle)")]
)
def test_key_of_a_recipe_in_a_file_is_refused_with_the_file(home, call):
    key = "mechanisms.leg.recipe.linkage.crank"
    with pytest.raises(gk.DesignError, match="leg.toml") as refused:
        call(home / "both.toml", {key: (20, 30)})
    assert refused.value.field == key
    table = 'recipe = { kind = "four-bar", linkage = { ground = 100, crank = 30, coupler = 90, rocker = 70 } }'
    text = (home / "both.toml").read_text().replace('recipe = "leg.toml"', table)
    (home / "both.toml").write_text(text)
    call(home / "both.toml", {key: (20, 30)})


def test_recipe_in_its_own_output_folder_keeps_its_files(home):
    before = {path: path.read_bytes() for path in home.rglob("*.*")}
    (home / "both.toml").rename(home / "home.toml")
    best = gk.optimise(home / "home.toml", *TASKS["both.toml"], starts=1, out=home.parent)
    assert [path.name for path in best.files] == ["home.optimum.toml"]
    assert all(path.read_bytes() == content for path, content in before.items() if path.name != "both.toml")


@pytest.mark.parametrize("file", ["lifts/../lifts/rise.csv", "ABSOLUTE"])
def test_file_that_cannot_be_copied_is_refused_before_the_search(home, tmp_path, monkeypatch, file):
    (home / "cam.toml").write_text(CAM.replace("FILE", file.replace("ABSOLUTE", str(home / "lifts" / "rise.csv"))))
    monkeypatch.setattr(Trials, "tried", lambda *_: pytest.fail("it searches"))
    with pytest.raises(gk.FileError, match="rise.csv"):
        gk.optimise(home / "cam.toml", *TASKS["cam.toml"], out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_sweep_of_an_opened_recipe_reads_its_files_and_continues_only_with_the_same(home, tmp_path):
    values, out = {"mechanisms.leg.phase_deg": [10, 20]}, tmp_path / "out"
    assert gk.sweep(gk.load(home / "both.toml"), values, out=out).reused == 0
    again = gk.sweep(gk.load(home / "both.toml"), values, out=out)
    assert again.reused == 2 and not any(row.refused for row in again.rows)
    (home / "leg.toml").write_text(LEG.replace("90", "85"))
    assert gk.sweep(gk.load(home / "both.toml"), values, out=out).reused == 0
