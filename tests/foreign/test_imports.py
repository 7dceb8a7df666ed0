"""Imported linkages move as Newton's method on their distances does; what is not understood is refused by name."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli
from geomkin.core.errors import RecipeError
from geomkin.foreign.programs import imported

from .written import ALL, FOUR_BAR, SIX_BAR, linkage2, pmks, positions, pylinkage

# Format: text of a linkage, mm of its unit, and the names that joints get.
FORMATS = {
    "pylinkage": (lambda linkage: pylinkage(linkage, 10.0), 10.0, lambda id, k: id),
    "pmks": (pmks, 10.0, lambda id, k: id),
    "linkage2": (linkage2, 10.0, lambda id, k: f"P{k}"),
}
# pylinkage has slides in the frame only.
CASES = [(form, name) for form in FORMATS for name in ALL if (form, name) != ("pylinkage", "quick return")]


@pytest.fixture
def recipe(tmp_path):
    """recipe(text): the recipe with the linkage of a file, and its text."""

    def read(text):
        file = tmp_path / "drawn"
        file.write_text(text, encoding="utf-8")
        made = imported(file)
        return gk.load(made), made

    return read


@pytest.mark.parametrize(("form", "name"), CASES)
def test_linkage_moves_as_it_was_drawn(recipe, form, name):
    write, unit, name_of = FORMATS[form]
    joints, _, (pivot, _), _ = linkage = ALL[name]
    loaded, _ = recipe(write(linkage))
    step = np.arange(0, 361, 6) * (-1 if loaded.drive.speed_rpm < 0 else 1)
    wanted = unit * (positions(linkage, np.radians(step)) - joints[pivot])
    motion = gk.move(loaded.design, np.radians(loaded.drive.start_deg + step), dict(loaded.branches))
    for k, id in enumerate(joints):
        point = name_of(id, k)
        if any(point in points for points in loaded.design.bodies.values()):
            # PMKS+ keeps three decimals of a cm, and of the angle of a slide in rad.
            assert np.abs(motion.point(point).position - wanted[:, k]).max() < (0.15 if form == "pmks" else 1e-4), id


def test_speeds_keep_their_sense(recipe):
    assert recipe(pmks(FOUR_BAR))[0].drive.speed_rpm == 20
    assert recipe(pmks(FOUR_BAR, clockwise=True))[0].drive.speed_rpm == -20
    assert recipe(linkage2(FOUR_BAR))[0].drive.speed_rpm == 30
    assert recipe(pylinkage(FOUR_BAR).replace("0.1", "-0.1"))[0].drive.speed_rpm == -60


def test_units_and_scale(recipe):
    drawn = [recipe(pylinkage(FOUR_BAR, unit)) for unit in (0.1, 10)]
    assert ["scale = " in text for _, text in drawn] == [True, False]
    assert [abs(one.design.bodies["ground"]["C"]) for one, _ in drawn] == pytest.approx([100, 100])
    assert abs(recipe(linkage2(FOUR_BAR, 96 / 25.4))[0].design.bodies["ground"]["P1"]) == pytest.approx(10)


def test_point_that_follows_two_joints_is_one_of_their_link(recipe):
    data = json.loads(pylinkage(FOUR_BAR))
    data["joints"].append(
        {"id": "pen", "type": "tracker", "position": [0, 0], "ref_joint1_id": "a", "ref_joint2_id": "b", "distance": 3.0, "angle": 0.5}
    )  # fmt: skip
    loaded, _ = recipe(json.dumps(data))
    pen = loaded.table["pen_x"] + 1j * loaded.table["pen_y"]
    motion = gk.move(loaded.design, np.radians(loaded.table["crank_angle"]), dict(loaded.branches))
    a, b = (motion.point(name).position for name in "ab")
    assert pen == pytest.approx(a + 30 * np.exp(0.5j) * (b - a) / abs(b - a), abs=1e-3)


def test_links_with_two_common_joints_are_one_body(recipe):
    joints, links, driver, slots = FOUR_BAR
    twice = (joints, {**links, "brace": "ap", "base": "OC"}, driver, slots)
    assert recipe(linkage2(twice))[0].design.bodies == recipe(linkage2(FOUR_BAR))[0].design.bodies


def test_the_command_prints_a_recipe_that_runs(tmp_path):
    file = tmp_path / "drawn.linkage2"
    file.write_text(linkage2(SIX_BAR))
    printed = CliRunner().invoke(cli, ["import", str(file)])
    assert printed.exit_code == 0 and gk.load(printed.stdout).kind == "linkage"
    gk.make(gk.load(printed.stdout), tmp_path / "out", only=["svg"])
    assert len([*(tmp_path / "out").rglob("*.svg")]) == 1
    missing = CliRunner().invoke(cli, ["import", str(tmp_path / "nothing")])
    assert missing.exit_code == 1 and "Traceback" not in missing.output


def changed(change):
    data = json.loads(pylinkage(FOUR_BAR))
    change(data)
    return json.dumps(data)


REFUSED = {
    "legacy": (changed(lambda d: d["joints"][0].update(type="Crank")), "O"),
    "unknown joint": (changed(lambda d: d["joints"][0].update(type="cam")), "O"),
    "unknown key": (changed(lambda d: d["links"][1].update(spring=3)), "spring"),
    "no position": (changed(lambda d: d["joints"][2].update(position=[None, None])), "a.position"),
    "endless": (pylinkage(FOUR_BAR).replace("2.5", "1e999"), "a.position"),
    "two drivers": (changed(lambda d: d["links"][2].update(type="driver", motor_joint="C")), "links"),
    "unknown pin": (changed(lambda d: d["links"][2].update(joints=["a", "zz"])), "coupler"),
    "nested": ("{" + '"a":[' * 100_000, ""),
    "cut link": (pmks(FOUR_BAR)[:-3], ""),
    "no link": ("some text", ""),
    "entities": ('<!DOCTYPE a [<!ENTITY b "c">]><linkage2/>', ""),
    "no xml": ("<linkage2>", ""),
    "other xml": ("<svg/>", "svg"),
    "actuator": (linkage2(FOUR_BAR, of_link=' actuator="true"'), "link 0"),
    "gears": (linkage2(FOUR_BAR, more='<ratios><ratio type="gears"/></ratios>'), "ratios"),
    "fastened": (linkage2(FOUR_BAR, of_link=' fastenlink="2"'), "Link 0"),
    "arc": (linkage2(ALL["slider-crank"]).replace('slider="true"', 'slider="true" slideradius="9"'), "connector 2"),
    "unknown element": (linkage2(FOUR_BAR, more="<motor/>"), "motor"),
    "two inputs": (linkage2(FOUR_BAR).replace('y="0.000000" anchor="true"/>', 'y="0" anchor="true" input="true"/>'), "input"),
    "not a number": (linkage2(FOUR_BAR).replace('x="0.000000"', 'x="1e400"'), "connector 0"),
    "binary": ("\x00\x01", ""),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_understood_is_refused_by_name(recipe, case):
    text, key = REFUSED[case]
    with pytest.raises(RecipeError) as caught:
        recipe(text)
    (problem,) = caught.value.problems
    assert problem.key == key and problem.problem and problem.remedy


def test_loose_linkage_and_large_file_are_refused(recipe, tmp_path):
    joints, links, driver, _ = FOUR_BAR
    with pytest.raises(RecipeError):
        recipe(linkage2((joints, {name: links[name] for name in ("crank", "coupler")}, driver, {})))
    with pytest.raises(RecipeError):
        recipe("{" + " " * 1_000_001)


@pytest.mark.parametrize("seed", range(3))
def test_damaged_files_are_refused_or_read_but_never_crash(recipe, seed):
    rng = np.random.default_rng(seed)
    for write in (pylinkage, pmks, linkage2):
        text = write(SIX_BAR)
        for _ in range(25):
            k, cut = rng.integers(len(text)), rng.integers(1, 6)
            damaged = text[:k] + "".join(map(chr, rng.integers(32, 127, rng.integers(0, 4)))) + text[k + cut :]
            try:
                recipe(damaged)
            except RecipeError as error:
                assert error.problems
