"""Slips that people make, told in a person's words with the key they stand under."""

import dataclasses
import tomllib
from pathlib import Path

import pytest

import geomkin as gk
from geomkin.recipe import load
from geomkin.recipe.kinds import KINDS, recipe_class
from geomkin.recipe.messages import hints_of, kind_of, tables_in
from tests.texts import parse, template_of

BAR = 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30\ncoupler = 90\nrocker = 70\n'
CAM = 'kind = "disk-cam"\n[cam]\nbase_radius = 40\n'


def told(text):
    with pytest.raises(gk.RecipeError) as caught:
        parse(text)
    return {problem.key: f"{problem.problem}; {problem.remedy}" for problem in caught.value.problems}


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ("kind = four-bar", "kind", 'a text needs quotes: write kind = "four-bar"'),
        (BAR + "driver = crank # by hand", "linkage.driver", 'write driver = "crank"'),
        (BAR.replace("= 30", "= 30,5"), "linkage.crank", "found 30,5; write 30.5, a number with a point"),
        (BAR.replace("= 30", "= 30mm"), "linkage.crank", "found 30mm; write 30, a number"),
        (BAR.replace("= 30", "= 30 mm  # short"), "linkage.crank", "found 30 mm; write 30, a number"),
        (BAR.replace("= 30", "= 3cm"), "linkage.crank", "lengths are in mm, angles in deg, not in cm"),
        (BAR.replace("= 30", '= "30,5"'), "linkage.crank", "found '30,5'; write 30.5, a number"),
        (BAR.replace("= 30", '= "30mm"'), "linkage.crank", "found '30mm'; write 30, a number"),
        (BAR.replace("= 30", '= "30"'), "linkage.crank", "write 30, a number with a point and without unit or quotes"),
        (BAR.replace("= 30", "= .5"), "linkage.crank", "write 0.5"),
        (BAR.replace("= 30", "= 30."), "linkage.crank", "write 30.0"),
        (BAR.replace("= 30", "="), "linkage.crank", "found nothing; give a value"),
        (BAR.replace('"four-bar"', "“four-bar”"), "kind", "curly quotes"),
        (CAM + "[stock]\ntiming_mark = True", "stock.timing_mark", "write true"),
        (CAM + "follower = { kind = translating-flat, tilt_deg = 3 }", "cam.kind", 'kind = "translating-flat"'),
        (CAM + 'follower = { kind = "translating-flat", tilt_deg = 2,5 }', "cam.tilt_deg", "write 2.5"),
    ],
)
def test_a_slip_is_told_with_what_to_write(text, key, words):
    found = told(text)
    assert list(found) == [key] and words in found[key], found


@pytest.mark.parametrize(
    "text",
    [
        "kind = [",
        "x = 1 2",
        "kind = = 3",
        'x = "' + "y" * 5000,
        "x = " + "y" * 5000,
        "x = 1979-05-27T",
        "[a\nb = 1",
        "a = '''",
        # Numbers and answers that are right are not what is wrong in their line.
        "x = 12\nx = 12",
        "x = true\nx = true",
        "x = { a = 3, a = false }",
    ],
)
def test_what_is_no_such_slip_is_told_as_before(text):
    ((key, words),) = told(text).items()
    assert key == "" and "not TOML" in words


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_the_line_is_found_whatever_the_line_ends(tmp_path, ends, mark):
    (tmp_path / "r.toml").write_bytes((mark + BAR.replace("= 30", "= 30,5")).replace("\n", ends).encode())
    with pytest.raises(gk.RecipeError, match="linkage.crank: found 30,5; write 30.5"):
        gk.load(tmp_path / "r.toml")


def test_the_near_name_comes_before_the_list():
    for text, key, near in (
        ('kind = "for-bar"', "kind", "did you mean four-bar? give one of "),
        (BAR + "drivr = 3", "linkage.drivr", "did you mean driver? known here: "),
        (BAR + 'driver = "crnk"', "linkage.driver", "did you mean crank? give 'crank'"),
    ):
        assert f"; {near}" in told(text)[key]
    assert all(name in told('kind = "for-bar"')["kind"] for name in KINDS)


def test_a_missing_table_says_what_it_must_hold():
    words = told('kind = "four-bar"')["linkage"]
    assert words.startswith("is missing; give a table with ground, crank, coupler, rocker (and, as wanted, coupler_po")
    assert words.endswith("headed [linkage]")
    found = told('kind = "disk-cam"\n[cam]\nbase_radius = 40')
    assert "a table with kind = 'translating-roller' or " in found["cam.follower"]
    assert found["cam.follower"].endswith("headed [cam.follower]")
    assert "tables, each with kind = 'dwell' or " in found["cam.program"]
    assert found["cam.program"].endswith("headed [[cam.program]]")
    assert "bodies" in told('kind = "linkage"')["linkage"]


@pytest.mark.parametrize(
    ("text", "key", "home"),
    [
        (BAR.replace("[linkage]\n", ""), "ground", "[linkage]"),
        (BAR + "tolerance = 0.1", "linkage.tolerance", "[files]"),
        (BAR + "step_deg = 5", "linkage.step_deg", "[drive]"),
        (CAM + "roller_radius = 3", "cam.roller_radius", "[cam.follower]"),
        (CAM + "rise = 3", "cam.rise", "[[cam.program]]"),
        ('kind = "gear-pair"\nteeth = 3', "teeth", "[first] or [second]"),
        ('kind = "linkage"\nbase = ["A", "B"]', "base", "[[linkage.corners]]"),
    ],
)
def test_a_key_outside_its_table_is_told_where_it_belongs(text, key, home):
    assert f"unknown key; it belongs under {home}; known here: " in told(text)[key]


def test_a_kind_under_a_table_is_told_where_it_belongs():
    text = "\n".join([*BAR.splitlines()[1:], 'kind = "four-bar"'])
    assert "is missing; it stands under [linkage]: put it above the first table" in told(text)["kind"]
    assert "is missing" in told("[a]\nkind = [3]")["kind"]


def test_of_very_many_problems_only_those_that_are_read_get_a_hint(monkeypatch):
    from geomkin.recipe import messages as explain

    asked = []
    monkeypatch.setattr(explain, "nearest", lambda *a: asked.append(a) or "")
    found = told(BAR + "".join(f"k{i} = 1\n" for i in range(3000)))
    assert len(found) == 3000 and 0 < len(asked) < 100
    assert found["linkage.k2999"]


def test_of_very_many_problems_only_some_are_looked_into(monkeypatch):
    from geomkin.recipe import messages as explain

    looked, real = [], explain._place
    monkeypatch.setattr(explain, "_place", lambda *a: looked.append(a) or real(*a))
    bodies = "".join(f'b{i} = {{ O = [0, ""] }}\n' for i in range(3000))
    found = told('kind = "linkage"\n[linkage]\ndriver = "b1"\n[linkage.bodies]\n' + bodies)
    assert len(found) == 3000 and len(looked) == explain.EXPLAINED


@pytest.mark.parametrize(
    ("written", "right"),
    [("no", "false"), ("off", "false"), ("False", "false"), ("yes", "true"), ("on", "true"), ("True", "true")],
)
def test_words_for_true_and_false_are_told_how_toml_writes_them(written, right):
    with pytest.raises(gk.RecipeError) as caught:
        parse(f'kind = "cognates"\n[figure]\nshown = {written}\n')
    assert str(caught.value).endswith(f"found {written}; write {right}")


@pytest.mark.parametrize("name", KINDS)
def test_what_stands_for_a_table_is_told_what_a_table_holds(name):
    """Every key once: those that are needed, and the others only beside them."""
    kind, data = recipe_class(name), tomllib.loads(template_of(name))
    for key in (key for key, value in data.items() if isinstance(value, dict)):
        (hint,) = tables_in(hints_of(kind)[key])[:1]
        fields = dataclasses.fields(hint)
        needed = [f.name for f in fields if f.default is f.default_factory is dataclasses.MISSING]
        with pytest.raises(gk.RecipeError) as caught:
            load.told({**data, key: 3})
        ((place, found, words),) = [(p.key, p.problem, p.remedy) for p in caught.value.problems if p.key == key]
        assert (place, found) == (key, "found 3")
        held, heading = words.removeprefix("give a table with ").split(", headed ")
        if kind_of(hint):
            assert all(repr(other) in held for other in hint.KINDS) and heading == f"[{key}]"
            continue
        first, _, others = held.removesuffix(")").partition(" (and, as wanted, ")
        assert heading == f"[{key}]" and sorted(first.split(", ") + others.split(", ") * bool(others)) == sorted(
            f.name for f in fields
        )
        assert first.split(", ") == (needed or [f.name for f in fields])


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        (BAR + "coupler_point = [2e9, 0]", "linkage.coupler_point[0]", "found 2000000000.0; give numbers between -1e+09 and 1e+09 (point traced by the coupler"),
        (BAR + "coupler_point = [0, -2e9]", "linkage.coupler_point[1]", "found -2000000000.0; give numbers between -1e+09 and 1e+09 (point traced by the coupler"),
        (BAR + "coupler_point = 3", "linkage.coupler_point", "found 3; give point traced by the coupler"),
        (BAR + "[files]\nsheet = [5, 100]", "files.sheet", "give a row of 2, each a number from 10 to 100000, in mm"),
        (BAR + '[files]\nwrite = ["dfx"]', "files.write[0]", "found 'dfx'; did you mean dxf? give 'dxf', 'stl', "),
        (BAR.replace("100", '"100 furlongs"'), "linkage.ground", "not in furlongs); give a number above 0 and at most 1e+09, in mm (distance between the two ground pivots)"),
        (BAR.replace("100", '"abc"'), "linkage.ground", "found 'abc'; give a number above 0 and at most"),
        (BAR.replace("100", '"' + "1" * 99 + '"'), "linkage.ground", "; write 1111"),
        (BAR.replace("100", '"' + "1" * 101 + '"'), "linkage.ground", "; give a number above 0"),
        (BAR.replace("100", "true"), "linkage.ground", "found True; give a number above 0 and at most"),
        ("files = 3\n" + BAR, "files", "give a table with write, tolerance, curves"),
        (BAR + "files = 3", "linkage.files", "unknown key; it belongs above the first [table], beside kind; known here: ground, "),
        (CAM + "follower = {}\nprogram = [3, {}]", "cam.follower.kind", "is missing; give 'translating-roller' or 'translating-flat' or "),
        (CAM + "follower = {}\nprogram = [3, {}]", "cam.program[0]", "found 3; give tables, each with kind = 'dwell' or "),
        (CAM + "follower = {}\nprogram = [3, {}]", "cam.program[1].kind", "is missing; give 'dwell' or "),
        (CAM + 'program = [{kind = "rize"}]', "cam.program[0].kind", "found 'rize'; did you mean rise? give 'dwell' or "),
        (CAM + 'program = [{kind = "rise", rise = 3, end_deg = 3}]', "cam.program[0].law", "is missing; give law of motion: uniform, "),
        ('kind = "linkage"\n[linkage.bodies]\nground = { O = [0, 0] }\ncrank = { O = "x" }', "linkage.bodies.crank.O", "found 'x'; give bodies, the fixed one first"),
        ('kind = "linkage"\n[linkage.bodies]\nground = { "" = [0] }', 'linkage.bodies.ground."""[1]'.replace('"""', '""'), "is missing; give bodies, the fixed one first"),
    ],
)  # fmt: skip
def test_wrong_values_are_told_with_what_may_stand_there(text, key, words):
    found = told(text)
    assert words in found[key], found


def test_a_recipe_in_no_file_is_called_by_its_kind_and_one_in_a_file_by_its_path(tmp_path, monkeypatch):
    """The crank's holes run into each other; a text is not repeated before what is wrong with it."""
    monkeypatch.chdir(tmp_path)
    text = 'kind = "four-bar"\nlinkage = {ground = 100, crank = 4, coupler = 90, rocker = 70}\n'
    path = Path("short.toml")
    path.write_text(text)
    for recipe, called in ((text, "four-bar"), (gk.load(text), "four-bar"), (path, str(path)), (str(path), str(path))):
        with pytest.raises(gk.RecipeError) as caught:
            gk.make(recipe, tmp_path / "out")
        assert str(caught.value).startswith(f"{called}: linkage.crank: the hole of crank_p")
