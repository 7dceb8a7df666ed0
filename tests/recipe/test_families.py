"""What goals with a family tell of it: members ranked, and those along the free angle with the one that is made."""

import numpy as np
import pytest

from tests.texts import parse, recipe_of, template_of

KINDS = ["crank-rocker-synthesis", "double-rocker-synthesis", "slider-crank-stroke"]


@pytest.mark.parametrize("kind", KINDS)
def test_the_choice_is_the_family_with_the_one_that_is_made_among_it(kind):
    recipe = recipe_of(kind)
    found, choice = recipe.found, recipe.choice
    told = {column.name: np.asarray(column.values) for column in choice.table.columns}
    angle, chosen = told["free_angle"], choice.chosen
    assert len(angle) == len(found.family.free_angle_deg) + 1 and (np.diff(angle) >= 0).all()
    assert angle[chosen] == found.free_angle_deg
    for every, made, own in (
        ("every_one", "made", found.transmission_angle_deg),
        ("ratio_of_every_one", "ratio_of_the_made", found.ratio),
    ):
        assert np.flatnonzero(np.isfinite(told[made])).tolist() == [chosen]
        assert told[made][chosen] == told[every][chosen] == pytest.approx(float(own), rel=1e-9)
    for name, length in found.lengths.items():
        assert told[name][chosen] == length
    # Every other row is what the search finds at its angle.
    known = np.flatnonzero(np.isfinite(told["every_one"]))
    for k in known[[1, len(known) // 3, -2]]:
        one = recipe.wanted.search(float(angle[k]))
        assert told["every_one"][k] == pytest.approx(float(one.transmission_angle_deg), rel=1e-6, abs=1e-6)
        assert told["ratio_of_every_one"][k] == pytest.approx(float(one.ratio), rel=1e-6)
        assert [told[name][k] for name in one.lengths] == pytest.approx(list(one.lengths.values()), rel=1e-6)
    first, last = recipe.notes["family"]["free_angle_deg"]
    assert first <= angle[0] <= angle[-1] <= last


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("limit", [None, 6.0])
def test_others_are_good_members_from_the_whole_family_the_best_first(kind, limit):
    text = template_of(kind)
    recipe = parse(text if limit is None else text.replace("[wanted]", f"[wanted]\nlargest_ratio = {limit}"))
    best, *others = recipe.ranked
    most = limit or (100.0 if kind == "double-rocker-synthesis" else 6.0)
    assert len(others) <= 20 and (limit or len(others) >= 10)
    assert [recipe.rank(one) for one in others] == sorted(recipe.rank(one) for one in others)
    if kind != "double-rocker-synthesis":
        angles = [one.transmission_angle_deg for one in others]
        assert angles == sorted(angles, reverse=True) and len(set(angles)) > 1
    assert all(one.ratio <= most and not one.defects for one in others)
    if limit is None:
        low, high = best.family.free_angle_deg[[0, -1]]
        low = max(low, np.degrees(np.arctan2(1, most)))
        angles = np.sort([one.free_angle_deg for one in others])
        # Half a step from either end, where the family has no defects there: double rockers stop half their way.
        near = 0.3 if kind == "double-rocker-synthesis" else 0.07
        assert angles[0] - low < near * (high - low) and high - angles[-1] < 0.04 * (high - low)
    limits = recipe.choice.plots[1].limits
    assert [one.value for one in limits] == [most]
