"""Templates with tables of another kind, and with those that may be left out: every one runs as it is."""

import tomllib

import pytest

import geomkin as gk
from geomkin.recipe.kinds import KINDS
from tests.campaign import by_default
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


@pytest.mark.parametrize(("name", "key", "which"), by_default(OFFERED, slice(0, None, 5)))
def test_chosen_table_is_shown_and_passes_its_checks(tmp_path, name, key, which):
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
