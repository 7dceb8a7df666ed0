"""What the commands print and write of recipes that pass, fail a check, or cannot be made; each recipe once."""

import pickle
import re
import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin import cli as commands
from geomkin.build import check_recipe
from geomkin.core.errors import Problem
from geomkin.recipe.kinds import kind_names
from geomkin.recipe.load import plain_table
from geomkin.recipe.search import (
    ALSO_KNOWN_AS,
    ENDINGS,
    FILLERS,
    LIMIT,
    MOST_RECIPES,
    NOT_OFFERED,
    STEM,
    did_you_mean,
    nearest_kind,
)
from tests.campaign import by_default

GALLERY = Path(__file__).parent.parent / "recipes"
PAIR = str(Path(__file__).parent / "cases/pair-without-backlash.toml")
GEAR = 'kind = "spur-gear"\nfiles = {{ write = ["csv", "svg"] }}\n[gear]\nteeth = {}\nmodule = 2\n'


@pytest.fixture
def command(tmp_path, monkeypatch):
    """command(*words, given=): exit status, stdout and stderr of a run in a folder with three gears.

    `a` passes, `b` fails a check, `c` cannot be made.
    """
    monkeypatch.chdir(tmp_path)
    # New processes would take longer than the recipes.
    monkeypatch.setattr("geomkin.core.processes.worker_count", lambda: 1)
    (tmp_path / "in").mkdir()
    for name, teeth in {"a": 24, "b": 9, "c": 1}.items():
        (tmp_path / f"in/{name}.toml").write_text(GEAR.format(teeth))

    def call(*words, given=None):
        result = CliRunner().invoke(commands.cli, words, input=given)
        return result.exit_code, result.stdout, result.stderr

    return call


def lines_of(made, every=True):
    """The lines of a recipe: its checks, remarks and facts; of several recipes, without passed checks and facts."""
    passed = sum(check.passed for check in made.checks)
    checks = [f"  {'pass' if c.passed else 'FAIL'}  {c}" for c in made.checks if every or not c.passed]
    if failed := [check.id for check in made.checks if not check.passed]:
        checks.append(f"  more  geomkin explain {' '.join(failed[:6])}")
    remarks, facts = [f"  note  {remark}" for remark in made.remarks], [f"        {fact}" for fact in made.facts]
    return [f"{made.name}: {passed} of {len(made.checks)} checks passed", *checks, *remarks, *(facts if every else [])]


def test_check_prints_every_check_of_one_recipe_and_those_that_failed_of_several(command, tmp_path):
    made = [check_recipe(tmp_path / f"in/{name}.toml") for name in "ab"]
    assert command("check", "in/b.toml") == (0, "\n".join([*lines_of(made[1]), ""]), "")
    several = [line for one in made for line in lines_of(one, every=False)]
    code, output, wrong = command("check", "in/a.toml", "in/b.toml")
    assert (code, wrong, output.splitlines()) == (0, "", several)
    assert "  FAIL  " in output and "  pass  " not in output and [path.name for path in tmp_path.iterdir()] == ["in"]
    code, output, wrong = command("check", "in")
    assert code == 1 and output.splitlines() == several and wrong.startswith("in/c.toml: gear.teeth: found 1; give ")


def test_run_prints_the_lines_of_check_and_where_the_files_are(command):
    for recipes in ([PAIR], ["in/b.toml"], ["in/a.toml", "in/b.toml", PAIR]):
        _, checked, _ = command("check", *recipes)
        code, printed, wrong = command("run", *recipes, "--only", "csv")
        lines = printed.splitlines()
        made = [line for line in lines if line.startswith("  made  ")]
        assert code == 0 and wrong == "" and [line for line in lines if line not in made] == checked.splitlines()
        assert [line.split()[1] for line in made] == [f"out/{Path(name).stem}:" for name in recipes]


def test_the_place_of_the_page_over_all_recipes_is_printed(command, tmp_path):
    _, printed, _ = command("run", "in/a.toml", "in/b.toml", "--out", "all")
    assert printed.splitlines()[-1].startswith("all/index.html") and (tmp_path / "all/index.html").is_file()


def test_a_pair_without_backlash_is_advised_an_allowance_that_leaves_some(command):
    (advice,) = check_recipe(PAIR).remarks
    for words in (["check"], ["run", "--only", "csv"]):
        assert f"  note  {advice}" in command(*words, PAIR)[1].splitlines()
    pair = gk.load(PAIR)
    thinner = {key: replace(getattr(pair, key), tooth_thickness_allowance=0.05) for key in ("first", "second")}
    assert "tooth_thickness_allowance" in advice and not replace(pair, **thinner).remarks
    machine = gk.recipe.recipe_class("machine").remarks.fget
    assert machine(SimpleNamespace(recipes={"gears": pair}, torques=SimpleNamespace(walking=None))) == (
        f"gears: {advice}",
    )


def test_strict_gives_failed_checks_an_exit_status_of_their_own(command, tmp_path):
    for words in (("run", "--only", "csv"), ("check", "--json")):
        assert command(*words, "--strict", "in/a.toml")[0] == 0
        code, printed, _ = command(*words, "--strict", "in/b.toml")
        assert code == 3 and printed == command(*words, "in/b.toml")[1]
        # A recipe that cannot be made counts for more.
        assert command(*words, "--strict", "in")[0] == 1
    assert (tmp_path / "out/b/b.csv").is_file()
    with pytest.raises(gk.FailedChecksError) as failed:
        gk.make("in/b.toml", "made", ["csv"], strict=True)
    made = failed.value.made
    assert made.failed_checks and all(path.is_file() for path in made.files)
    assert str(pickle.loads(pickle.dumps(failed.value))) == str(failed.value)
    expected = "".join(f'{check.id} = "so few teeth"\n' for check in made.failed_checks)
    (tmp_path / "in/b.toml").write_text(f"{GEAR.format(9)}[expected_failures]\n{expected}")
    assert command("check", "--strict", "in/b.toml")[0] == 0
    assert not gk.make("in/b.toml", "made", ["csv"], strict=True).failed_checks


@pytest.mark.parametrize(
    "words", [["check"], ["run", "--only", "csv"], ["columns"], ["sweep", "--set", "gear.module=2"]]
)
def test_a_recipe_is_read_from_the_standard_input(command, tmp_path, words):
    for text in (GEAR.format(24), GEAR.format(24).strip(), GEAR.format(24).replace("\n", "\r\n")):
        code, printed, wrong = command(*words, "-", given=text)
        assert (code, wrong) == (0, "") and printed
    assert words[0] in ("check", "columns") or (tmp_path / "out/spur-gear").is_dir()
    code, printed, wrong = command(*words, "-", given=GEAR.format(1))
    assert code == 1 and "gear.teeth" in wrong + printed
    assert command(*words, "-", given=b"\xff")[0] == 2


def test_check_accepts_what_run_accepts(tmp_path):
    """A herringbone has no smooth faces, as STEP needs them: both refuse it."""
    pair = plain_table(gk.load(PAIR))
    for helical in ({}, {"helix_angle_deg": 20, "herringbone": True}):
        for format in ("csv", "dxf", "step"):
            recipe = {**pair, **helical, "files": {"write": [format]}}
            results = []
            for action in (check_recipe, lambda given: gk.make(given, tmp_path)):
                try:
                    results.append(action(recipe).remarks)
                except gk.RecipeError as error:
                    results.append(error.problems)
            assert results[0] == results[1]
            assert bool(helical) or not isinstance(results[0][0], Problem)


def names_listed(command, *words):
    return {line.split()[0] for line in command("list", *words)[1].splitlines() if line.startswith("  ")}


def test_list_searches_names_and_descriptions_of_kinds_and_recipes_of_the_gallery(command):
    assert names_listed(command) == set(kind_names())
    recipes = {path.name: tomllib.loads(path.read_text())["kind"] for path in GALLERY.glob("*.toml")}
    for words in (["planetary"], ["scotch-yoke"], ["SCOTCH", "yoke"]):
        found = names_listed(command, *words)
        kind = "-".join(words).lower()
        assert {kind, *(name for name, other in recipes.items() if other == kind)} <= found < {*recipes, *kind_names()}
    # In the description only: a kind, and the first sentence of a recipe.
    assert "slider-crank-stroke" in names_listed(command, "stroke", "time ratio")
    assert "motor-walker.toml" in names_listed(command, "plywood")
    code, printed, wrong = command("list", "no such thing")
    assert code == 2 and not printed and wrong


@pytest.mark.parametrize(
    ("name", "kind"),
    [("planetary-gear", "planetary"), ("four-bar-linkage", "four-bar"), ("worm-gear", ""), ("bevel-gear", "")],
)
def test_a_longer_name_of_a_kind_is_recognised_and_another_mechanism_is_not(name, kind):
    assert did_you_mean(name, kind_names()).rstrip("? ").removeprefix("did you mean ") == kind


@pytest.mark.parametrize("name", ["klann", "peaucellier", "wiper-pair"])
def test_new_prints_a_recipe_of_the_gallery_by_its_name(name):
    result = CliRunner().invoke(commands.cli, ["new", name])
    assert result.exit_code == 0 and gk.load(result.output).design == gk.load(GALLERY / f"{name}.toml").design


@pytest.mark.parametrize(
    "name", by_default(["geared-legs", "table-cam", "pressed-gear", "traced-eight", "klann"], slice(2, 4))
)
def test_new_names_the_files_that_a_recipe_of_the_gallery_reads(command, tmp_path, name):
    code, text, wrong = command("new", name)
    files = [file for folder in (".", "workshop") for file in (GALLERY / folder).iterdir() if file.is_file()]
    named = [file for file in map(str, (file.relative_to(GALLERY) for file in files)) if f" {file}" in wrong]
    assert code == 0 and bool(named) == bool(wrong) == (name != "klann")
    for file in named:
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_bytes((GALLERY / file).read_bytes())
    (tmp_path / "own.toml").write_text(text)
    own, original = (gk.load(path) for path in (tmp_path / "own.toml", GALLERY / f"{name}.toml"))
    assert gk.recipe.to_toml(own) == gk.recipe.to_toml(original) and own.sources == original.sources


@pytest.mark.parametrize(
    "name, recipes",
    [
        ("klann-linkage", ["klann"]),
        ("hoeken", ["hoecken"]),
        ("straight line", ["hoecken", "peaucellier", "roberts"]),
        ("../recipes/klann", ["klann"]),
        ("gripper", ["parallel-gripper"]),
    ],
)
def test_a_name_that_is_no_kind_names_the_recipes_of_the_gallery_that_fit(name, recipes):
    result = CliRunner().invoke(commands.cli, ["new", name])
    assert result.exit_code == 2 and all(recipe in result.output for recipe in recipes)


@pytest.mark.parametrize("name", ["hypoid", "lead screw", "universal joint", "strain-wave", "v-belt", "barrel-cam"])
def test_mechanisms_that_are_not_planar_have_a_nearest_kind(name):
    nearest = nearest_kind(name, kind_names())
    assert any(kind in nearest for kind in kind_names())


@pytest.mark.parametrize(
    "name, meant",
    [
        ("timing-pulley", "belt-drive"), ("sprockets", "chain-drive"), ("epicyclic", "planetary"),
        ("maltese-cross", "geneva"), ("cycloidal reducer", "cycloidal-drive"), ("gearbox", "gear-train"),
        ("lazy tongs", "lift-table"), ("strandbeest", "walker"), ("5-bar", "linkage"), ("annulus", "ring-gear"),
    ],
)  # fmt: skip
def test_a_name_that_people_search_for_answers_with_what_makes_it(command, name, meant):
    code, _, wrong = command("new", name)
    assert code == 2 and meant in wrong.partition("choose from")[0]


@pytest.mark.campaign
def test_every_other_name_is_that_of_one_kind_or_recipe_and_of_nothing_else():
    known = {*kind_names(), *(path.stem for path in GALLERY.glob("*.toml"))}
    names = [name for names in ALSO_KNOWN_AS.values() for name in names]
    assert set(ALSO_KNOWN_AS) <= known and len({*names}) == len(names) and not {*names} & known
    for one, names in ALSO_KNOWN_AS.items():
        for name in (*names, f"{names[0]}s".upper()):
            assert {*re.findall(r"[\w-]+", nearest_kind(name, kind_names()))} & known == {one}


def test_words_without_meaning_name_nothing():
    assert nearest_kind("the", kind_names()) == nearest_kind("of it", kind_names()) == ""


def test_a_list_of_an_id_leads_to_its_explanation(command):
    code, _, message = command("list", "tip_width")
    assert code == 2 and "geomkin explain" in message


@pytest.mark.parametrize(
    ("command_name", "wish", "one", "most"),
    [
        ("list", "something that dwells", "stephenson-six-bar", 2),
        ("list", "a wiper that sweeps 80 degrees", "boxed-wiper.toml", 1),
        ("examples", "something that dwells", "geneva.toml", 20),
        ("examples", "a cam with springs", "loaded-cam.toml", 8),
        ("list", "intermittent motion", "geneva", 4),
        ("examples", "intermittent motion", "geneva.toml", 4),
        ("examples", "a cam with a pressure angle below 30", "loaded-cam.toml", 4),
        ("list", "a windscreen wiper", "wiper.toml", 4),
        ("examples", "windscreen wiper", "wiper.toml", 4),
    ],
)
def test_a_wish_finds_what_has_most_of_its_words(command, command_name, wish, one, most):
    code, printed, _ = command(command_name, wish)
    found = {line.split()[0] for line in printed.splitlines() if line.startswith("  ")}
    assert code == 0 and one in found and len(found) <= most


@pytest.mark.parametrize("wish", ["xyzzy gear", "xyzzy quux wiper", "xyzzy quux"])
def test_half_of_a_wish_finds_a_few_or_nothing(command, wish):
    assert command("list", wish)[0] == command("examples", wish)[0] == 2


def test_the_pages_search_by_the_same_words():
    script = (Path(gk.__file__).parent / "page/player/search.js").read_text("utf-8")
    parts = r'Set\("(.*?)"\.split.*?ENDINGS = \[(.*?)\], STEM = (\d);.*?MOST = (\d)'
    fillers, endings, stem, most = re.search(parts, script, re.DOTALL).groups()
    assert {*fillers.split()} == FILLERS and int(stem) == STEM and int(most) == MOST_RECIPES
    assert tuple(re.findall(r"\w+", endings)) == ENDINGS
    assert re.search("LIMIT = /(.*)/g;", script).group(1) == LIMIT.pattern


@pytest.mark.parametrize("words", [("new", "worm-gear"), ("list", "worm gear"), ("list", "hooke joint")])
def test_what_no_kind_makes_names_the_nearest_ones(words):
    result = CliRunner().invoke(commands.cli, words)
    kinds = NOT_OFFERED[re.findall(r"\w+", words[1])[0]].split(" or ")
    assert result.exit_code == 2 and set(kinds) < set(kind_names())
    assert all(kind in result.output for kind in kinds)


def test_the_command_alone_prints_its_help(command):
    assert command() == command("--help") and command()[0] == 0


def test_a_recipe_that_is_named_twice_is_made_once_and_a_folder_has_a_page_over_all(command, tmp_path):
    code, output, wrong = command("run", "in/b.toml", "in", "in/a.toml", "--out", "made", "--only", "csv")
    # In the order in which they are named, those of a folder by name.
    assert [line[0] for line in output.splitlines() if line[0] != " "] == ["b", "a"]
    assert code == 1 and wrong.splitlines()[0].startswith("in/c.toml: gear.teeth")
    (tmp_path / "in/c.toml").unlink()
    for words, index in ((["in/a.toml"], False), (["in/a.toml", "in/b.toml"], True)):
        folder = f"made{len(words)}{index}"
        assert command("run", *words, "--out", folder)[0] == 0
        assert (tmp_path / folder / "index.html").exists() == index, words
    (tmp_path / "in/b.toml").unlink()
    assert command("run", "in", "--out", "alone")[0] == 0 and (tmp_path / "alone/index.html").exists()


@pytest.mark.parametrize(
    "words",
    [["run", "empty"], ["run", "in/a.toml", "--only", "csv,stp"], ["run"], ["new", "spur-gaer"]],
)
def test_invalid_options_are_refused_and_nothing_is_made(command, tmp_path, words):
    (tmp_path / "empty").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "other/a.toml").write_text(GEAR.format(24))
    code, printed, wrong = command(*words)
    assert code == 2 and printed == "" and wrong
    assert not (tmp_path / "out").exists()


def test_a_certificate_holds_until_the_recipe_is_run_again(command, tmp_path):
    words = ("run", "in/a.toml", "in/b.toml", "--only", "svg")
    certificate = tmp_path / "out/a/verify.json"
    code, printed, _ = command(*words, "--verify")
    assert code == 0 and "out/b: 2 files made again, as designed" in printed and certificate.exists()
    first = certificate.read_bytes()
    assert command("verify", "out")[0] == 0 and certificate.read_bytes() == first
    drawing = tmp_path / "out/a/a.svg"
    drawing.write_text(drawing.read_text().replace('class="CUT"', 'class="HOLE"'))
    code, printed, _ = command("verify", "out")
    assert code == 1 and "out/a: 1 files made again, NOT" in printed and "out/b: 2 files made again, as" in printed
    assert certificate.read_bytes() != first
    assert command(*words)[0] == 0 and not certificate.exists()
