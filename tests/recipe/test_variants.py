"""Templates with tables of another kind, and with those that may be left out: every one runs as it is."""

import itertools
import tomllib

import pytest

import geomkin as gk
from geomkin.recipe.kinds import KINDS
from tests.texts import choices_of, parse, template_of

OFFERED = [
    (name, key, which)
    for name in KINDS
    for key, kinds in choices_of(name).items()
    for which in kinds
]  # fmt: skip


def at(recipe, key):
    for part in key.split("."):
        recipe = recipe[part]
    return recipe


def test_every_choice_between_tables_is_offered():
    assert {key for _, key, _ in OFFERED} == {
        "cam.follower", "cam.program", "stroke", "linkage.sliders", "stock.web", "first_stock.web", "second_stock.web",
        "sun_stock.web", "planet_stock.web", "base", "copies",
        "linkage", "dwell",
    }  # fmt: skip
    # Followers and segments grow in number.
    assert (
        sum(key not in ("cam.follower", "cam.program") for _, key, _ in OFFERED)
        == 3 + 2 + 2 + 2 + 2 + 7 + 9 + 2 * (9 + 1) + 10
    )
    assert len(OFFERED) >= 4 + 8 + 3 + 2 + 2 + 2 + 2


@pytest.mark.parametrize(("name", "key", "which"), OFFERED)
def test_what_is_asked_for_is_shown_and_passes_its_checks(tmp_path, name, key, which):
    text = template_of(name, [f"{key}={which}" if which else key])
    found = at(tomllib.loads(text), key)
    assert (
        which in [row["kind"] for row in (found if isinstance(found, list) else [found])]
        if which
        else found is not None
    )
    (tmp_path / "new.toml").write_text(text)
    made = gk.make(tmp_path / "new.toml", tmp_path / "out", ["csv"])
    assert [check.name for check in made.checks if not check.passed] == []


@pytest.mark.parametrize("which", ["polynomial", "spline", "table", "optimised-spline"])
@pytest.mark.parametrize("follower", ["oscillating-roller", "oscillating-flat", "translating-flat"])
def test_followers_and_segments_go_together(follower, which):
    text = template_of("disk-cam", [f"follower={follower}", f"program={which}"])
    recipe = parse(text)
    assert recipe.cam.follower.kind == follower and which in [s.kind for s in recipe.cam.program.segments]


def test_a_short_name_stands_for_all_tables_of_that_name():
    recipe = tomllib.loads(template_of("planetary", ["web"]))
    assert "web" in recipe["sun_stock"] and "web" in recipe["planet_stock"]
    only = tomllib.loads(template_of("planetary", ["sun_stock.web"]))
    assert "web" in only["sun_stock"] and "web" not in only.get("planet_stock", {})


@pytest.mark.parametrize("name", ["disk-cam", "spur-gear", "linkage"])
def test_the_template_says_how_to_see_the_others(name):
    text = template_of(name)
    offers = [line.split(f"geomkin new {name} ")[1] for line in text.splitlines() if "geomkin new" in line]
    assert len(offers) == len(choices_of(name))
    for offer, other in itertools.product(offers, offers):
        assert parse(template_of(name, {part for part in [*offer.split(), *other.split()] if part != "--with"}))


def test_the_first_line_is_the_schema_s():
    for name in KINDS:
        first, *rest = template_of(name).splitlines()
        assert first == "#:schema ./geomkin.schema.json"
        assert any("geomkin schema > geomkin.schema.json" in line for line in rest[:4])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["spur-gear", "--with", "foo"], "no such table: foo; spur-gear has web"),
        (["ring-gear", "--with", "foo"], "ring-gear has none"),
        (["disk-cam", "--with", "folower=oscillating-roller"], "did you mean follower?"),
        (["disk-cam", "--with", "follower=oscilating-roller"], "did you mean oscillating-roller? give follower=trans"),
        (["disk-cam", "--with", "follower"], "found follower; give follower=translating-roller or"),
        (["spur-gear", "--with", "web=spokes"], "give web"),
    ],
)
def test_what_there_is_not_is_wrong_usage(arguments, words):
    from click.testing import CliRunner

    from geomkin.cli import cli

    result = CliRunner().invoke(cli, ["new", *arguments])
    assert result.exit_code == 2 and words in " ".join(result.stderr.split()) and result.stdout == ""
