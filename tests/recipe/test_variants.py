"""Templates with tables of another kind, and with those that may be left out: every one runs as it is."""

import tomllib

import pytest

import geomkin as gk
from geomkin.recipe.kinds import KINDS
from tests.texts import choices_of, template_of

# Each choice once, of the first kind that offers it.
OFFERED = {
    (key, which): (name, key, which)
    for name in reversed(list(KINDS))
    for key, kinds in choices_of(name).items()
    for which in kinds
}.values()


def at(recipe, key):
    for part in key.split("."):
        recipe = recipe[part]
    return recipe


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


def test_a_short_name_stands_for_all_tables_of_that_name():
    recipe = tomllib.loads(template_of("planetary", ["web"]))
    assert "web" in recipe["sun_stock"] and "web" in recipe["planet_stock"]
    only = tomllib.loads(template_of("planetary", ["sun_stock.web"]))
    assert "web" in only["sun_stock"] and "web" not in only.get("planet_stock", {})


@pytest.mark.parametrize(
    "arguments",
    [
        ["spur-gear", "--with", "foo"],
        ["disk-cam", "--with", "follower=oscilating-roller"],
        ["disk-cam", "--with", "follower"],
        ["spur-gear", "--with", "web=spokes"],
    ],
)
def test_a_table_or_value_that_the_kind_has_not_is_wrong_usage(arguments):
    from click.testing import CliRunner

    from geomkin.cli import cli

    result = CliRunner().invoke(cli, ["new", *arguments])
    assert result.exit_code == 2 and result.stderr and result.stdout == ""
