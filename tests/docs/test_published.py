"""Worked examples in print: each number of `docs/published.toml`, which is also that of its page on the site."""

from dataclasses import replace

import pytest
from published import GROUPS, examples, half_digit, published_pages, values

import geomkin as gk
from tests.campaign import by_default

IDS = by_default(examples(), [id for id, example in examples().items() if not example.get("campaign")])


@pytest.mark.parametrize("id", IDS)
def test_numbers_are_the_printed_ones_or_the_right_ones_of_misprints(id):
    assert [value for value in values(id) if not value.agrees] == []


@pytest.mark.parametrize("id", [id for id, example in examples().items() if "recipe" in example])
def test_recipe_fails_only_the_checks_that_it_expects_to_fail(id):
    recipe = gk.load(examples()[id]["recipe"])
    assert {check.id for check in recipe.checks if not check.passed} == set(recipe.expected_failures)


def test_a_wrong_digit_and_a_misprint_that_is_none_are_noticed():
    value = values("theory-of-machines-four-bar")[0]
    assert value.printed == "114.62" and value.within == half_digit("114.62") == pytest.approx(0.005, rel=1e-3)
    assert value.agrees and not replace(value, printed="114.63").agrees
    assert not replace(value, right="114.62").agrees and replace(value, printed="114.36", right="114.62").agrees
    assert half_digit("41e2") == pytest.approx(50, rel=1e-3)


def test_larger_deviations_have_a_reason_and_groups_are_known():
    wanting = [(id, value) for id, one in examples().items() for value in one["value"] if "within" in value]
    assert [id for id, value in wanting if not value.get("note")] == []
    assert {one["group"] for one in examples().values()} == set(GROUPS)


@pytest.mark.campaign
def test_each_page_has_its_numbers():
    pages = published_pages()
    for id, example in examples().items():
        assert f"]({id}.md)" in pages["published/index.md"]
        assert all(value.printed in pages[f"published/{id}.md"] for value in values(id)), id
        assert example["source"] in pages[f"published/{id}.md"]
