"""Results of goals with a family: members ranked, and those along the free angle with the one that is made."""

import numpy as np
import pytest

from tests.campaign import by_default
from tests.texts import recipe_of

KINDS = ["crank-rocker-synthesis", "double-rocker-synthesis", "slider-crank-stroke"]


@pytest.mark.parametrize("kind", by_default(KINDS, [kind for kind in KINDS if kind != "slider-crank-stroke"]))
def test_the_choice_is_the_family_with_the_one_that_is_made_among_it(kind):
    recipe = recipe_of(kind)
    found, choice = recipe.found, recipe.choice
    reported = {column.id: np.asarray(column.values) for column in choice.table.columns}
    angle, chosen = reported["free_angle"], choice.chosen
    assert len(angle) == len(found.family.free_angle_deg) + 1 and (np.diff(angle) >= 0).all()
    assert angle[chosen] == found.free_angle_deg
    for every, made, own in (
        ("every_one", "made", found.transmission_angle_deg),
        ("ratio_of_every_one", "ratio_of_the_made", found.ratio),
    ):
        assert np.flatnonzero(np.isfinite(reported[made])).tolist() == [chosen]
        assert reported[made][chosen] == reported[every][chosen] == pytest.approx(float(own), rel=1e-9)
    for name, length in found.lengths.items():
        assert reported[name][chosen] == length
    # Every other row is what the search finds at its angle.
    known = np.flatnonzero(np.isfinite(reported["every_one"]))
    for k in known[[1, len(known) // 3, -2]]:
        one = recipe.wanted.search(float(angle[k]))
        assert reported["every_one"][k] == pytest.approx(float(one.transmission_angle_deg), rel=1e-6, abs=1e-6)
        assert reported["ratio_of_every_one"][k] == pytest.approx(float(one.ratio), rel=1e-6)
        assert [reported[name][k] for name in one.lengths] == pytest.approx(list(one.lengths.values()), rel=1e-6)
    first, last = recipe.notes["family"]["free_angle_deg"]
    assert first <= angle[0] <= angle[-1] <= last
