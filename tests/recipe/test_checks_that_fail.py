"""Checks of what is always right: with one of many things spoilt they fail, and tell by how much."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.texts import parse, template_of


def spoilt(kind, **kept):
    """A recipe of the kind's template with things that it has worked out changed by functions."""
    recipe = parse(template_of(kind))
    for name, change in kept.items():
        vars(recipe)[name] = change(getattr(recipe, name))
    return recipe


def check(recipe, words):
    return next(one for one in recipe.design_checks if words in one.name)


@pytest.mark.parametrize("row", [0, -1])
def test_one_dyad_that_misses_a_pose(row):
    def moved(dyads):
        number, fixed, moving = dyads
        return number, fixed, np.concatenate([moving[:row], [moving[row] + 0.1], moving[row:][1:]])

    good = check(spoilt("burmester-curves"), "miss of a pose")
    bad = check(spoilt("burmester-curves", dyads=moved), "miss of a pose")
    assert good.passed and not bad.passed and 1e-6 < bad.value < 0.2


@pytest.mark.parametrize(("k", "frame"), [(1, 0), (2, -1)])
def test_one_cognate_that_is_off_at_one_frame(k, frame):
    def moved(motions):
        track = motions[k].point("coupler_point").position.copy()
        track[frame] += 0.3
        held = SimpleNamespace(point=lambda name: SimpleNamespace(position=track))
        return (*motions[:k], held, *motions[k + 1 :])

    good, bad = (check(spoilt("cognates", **kept), "traced points") for kept in ({}, {"motions": moved}))
    assert good.passed and not bad.passed
    assert bad.value == pytest.approx(0.3)


@pytest.mark.parametrize("frame", [0, -1])
def test_a_pivot_that_moves_at_one_frame(frame):
    def moved(figure):
        track = figure.point("third_pivot").position.copy()
        track[frame] += 0.2j
        return SimpleNamespace(point=lambda name: SimpleNamespace(position=track))

    recipe = spoilt("cognates")
    # The plates are those of the whole figure.
    recipe.stack
    good = check(recipe, "third pivot")
    vars(recipe)["figure"] = moved(recipe.figure)
    bad = check(recipe, "third pivot")
    assert good.passed and not bad.passed and bad.value == pytest.approx(0.2)
