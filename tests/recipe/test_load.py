"""Recipes as text: what is read, what is refused, what templates and the schema promise."""

import re

import pytest

import geomkin as gk
from geomkin.recipe.kinds import KINDS
from geomkin.recipe.toml import LARGEST
from tests.campaign import by_default
from tests.texts import parse, recipe_of, template_of

GEAR = 'kind = "spur-gear"\n[gear]\nteeth = 24\nmodule = 2\n'
CAM = 'kind = "disk-cam"\n[cam]\nbase_radius = 40\nfollower = {kind = "translating-flat"}\n'


def test_every_problem_is_reported_at_once_with_key_found_and_remedy():
    gear = '[gear]\nteeth = 2.5\nmodule = "2"\nprofil_shift = 0.1\n'
    text = f'kind = "spur-gear"\nspeed = 1\n{gear}[stock]\nthickness = -1\n'
    with pytest.raises(gk.RecipeError) as caught:
        parse(text, "wrong.toml")
    problems = {p.key: p for p in caught.value.problems}
    assert set(problems) == {"speed", "gear.teeth", "gear.module", "gear.profil_shift", "stock.thickness"}
    assert "2.5" in problems["gear.teeth"].problem and "profile_shift" in problems["gear.profil_shift"].remedy
    assert all(line.startswith("wrong.toml: ") for line in str(caught.value).splitlines())


def test_bad_text_names_its_key():
    for text, key, words in [
        ("", "kind", "is missing"),
        ('kind = "spur-gaer"', "kind", "did you mean spur-gear?"),
        ("kind = 3", "kind", "found 3"),
        ('kind = "spur-gear"', "gear", "is missing"),
        ('kind = "spur-gear"\ngear = 3', "gear", "give a table with teeth"),
        (GEAR + '[files]\ncurves = "arc"\n', "files.curves", "did you mean arcs?"),
        (GEAR + '[files]\nwrite = ["dfx"]\n', "files.write[0]", "did you mean dxf?"),
        (GEAR + "stokc = 1\n", "gear.stokc", "known here"),
        (GEAR + "[stokc]\n", "stokc", "did you mean stock?"),
        (CAM + '[[cam.program]]\nkind = "rise"\nend_deg = 360\n', "cam.program[0].law", "3-4-5"),
        ('kind = "linkage"\nlinkage = {driver = "a", bodies = 3}\n', "linkage.bodies", "each a table of points"),
        ('kind = "linkage"\nlinkage = {driver = "a", bodies = {a = 3}}\n', "linkage.bodies.a", "points [x, y]"),
        (GEAR.replace("2\n", "nan\n"), "gear.module", "above 0"),
        (GEAR.replace("24", "10000000"), "gear.teeth", "at most 10000"),
        (GEAR.replace("24", "0"), "gear.teeth", "at least 4"),
        (GEAR.replace("24", "true"), "gear.teeth", "found True"),
        ("kind = [", "", "not TOML"),
        ("a = " + "[" * 10_000, "", "nests too deep"),
        ("kind = " + "9" * 5000, "", "not TOML"),
    ]:
        with pytest.raises(gk.RecipeError) as caught:
            parse(text)
        assert [p.key for p in caught.value.problems] == [key]
        assert words in str(caught.value)


@pytest.mark.parametrize(
    "name",
    by_default(KINDS, ["four-bar"]),
)
def test_templates_run_as_they_are_and_with_every_comment_taken_off_that_has_a_value(name, tmp_path):
    text = template_of(name)
    assert parse(text).kind == name
    lines = [
        line
        for line in text.splitlines()
        if not line.split("#")[1 if line.startswith("# ") else 0].rstrip().endswith("=")
    ]
    opened = "\n".join(line.removeprefix("# ") if " = " in line else line for line in lines)
    assert parse(opened) == parse(text)
    made = gk.make(recipe_of(name), tmp_path / "out")
    assert {p.suffix for p in made.files} - {".toml"} == {".dxf", ".stl", ".svg", ".csv", ".json", ".html"}
    comment = " ".join(line.lstrip("# ") for line in text.splitlines() if line.startswith("#"))
    said = re.findall(r"One check fails on purpose \(([^)]*)\)", comment)
    assert [check.name for check in made.checks if not check.passed] == said
    assert bool(said) == (name == "cognates")


@pytest.mark.parametrize(("size", "fits"), [(LARGEST, True), (LARGEST + 1, False)])
def test_a_recipe_is_read_to_its_last_byte_or_refused(tmp_path, size, fits):
    file, text = tmp_path / "a.toml", 'kind = "spur-gear"\ngear = {module = 2, teeth = 20}\n#'
    file.write_text(text + "." * (size - len(text)))
    if fits:
        # In the very last byte something that cannot be.
        file.write_text(text + "." * (size - len(text) - 2) + "\n=")
    with pytest.raises(gk.RecipeError, match="not TOML|line" if fits else f"{LARGEST:,} bytes"):
        gk.load(file)
