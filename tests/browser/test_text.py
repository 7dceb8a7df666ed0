"""The recipe as text beside the form: each shows what the other changed, and problems are marked at their lines."""

import pytest

from geomkin.recipe.kinds import recipe_class
from geomkin.recipe.template import template

from .test_by_mouse import SMALL_CAM
from .test_editor import FOUR_BAR, RECIPES, fill, settle, studio, value  # noqa: F401  the fixture


@pytest.fixture
def typed(studio):  # noqa: F811
    """Opens the text of a recipe; returns the page, and a function that replaces a part of the text."""

    def start(text):
        page = studio(text).page
        page.click("[data-view=text]")

        def replace(old, new):
            before = page.input_value("#text textarea")
            assert old in before
            page.fill("#text textarea", before.replace(old, new, 1))
            page.wait_for_timeout(450)
            settle(page)

        return page, replace

    return start


def marked(page):
    """Lines with a mark, and what is stated below."""
    return [line.strip() for line in page.locator(".code .wrong").all_inner_texts()], page.inner_text("#text .problems")


def test_the_text_and_the_form_change_each_other(typed):
    page, replace = typed(FOUR_BAR)
    assert page.input_value("#text textarea") == FOUR_BAR and marked(page) == ([], "")
    replace("crank = 30.00", "crank = 31")
    assert page.input_value("#text textarea") == FOUR_BAR.replace("30.00", "31")
    page.click("[data-view=form]")
    assert value(page, "linkage.crank") == 31
    fill(page, "linkage.crank", "32")
    page.click("[data-view=text]")
    assert page.input_value("#text textarea") == FOUR_BAR.replace("30.00", "32")
    for text in ("31", "30.00"):
        page.click("#undo")
        settle(page)
        assert page.input_value("#text textarea") == FOUR_BAR.replace("30.00", text)
    assert page.is_disabled("#undo")


@pytest.mark.parametrize(
    ("recipe", "old", "new", "line"),
    [
        ("", "crank = 30.00", "crank = -3", 6),
        ("", "rocker = 70", "rocker = 7 0", 8),
        ("", "coupler_point = [40, 25]", "coupler_point = [40, 25", 9),
        ("", "rocker = 70\n", "", 4),
        ("", "rocker = 70", "rocker = 70\nsize = 3", 9),
        ("roller-cam", "rise = ", "rise = -", None),
    ],
)
def test_a_problem_is_marked_at_its_line(typed, recipe, old, new, line):
    text = (RECIPES / f"{recipe}.toml").read_text() if recipe else FOUR_BAR
    page, replace = typed(text)
    replace(old, new)
    if line is None:
        line = 1 + next(k for k, row in enumerate(text.splitlines()) if old in row)
    lines, stated = marked(page)
    assert lines == [str(line)] and f"line {line}" in stated
    # What is wrong stays as it was typed.
    assert page.input_value("#text textarea") == text.replace(old, new, 1)
    replace(new, old) if new else page.click("#undo")
    settle(page)
    assert marked(page) == ([], "") and page.input_value("#text textarea") == text


def test_keys_and_values_are_offered_at_the_caret(typed):
    page, _ = typed(FOUR_BAR)
    page.focus("#text textarea")
    page.evaluate("document.querySelector('#text textarea').setSelectionRange(1e6, 1e6)")
    page.keyboard.type("gr")
    # The ground's length is there already.
    assert page.locator(".offers button").all_inner_texts() == ["ground_angle_deg"]
    page.keyboard.press("Tab")
    page.keyboard.type("12\n[fi")
    page.keyboard.press("Tab")
    page.keyboard.type("\ndxf_ver")
    page.keyboard.press("Tab")
    page.keyboard.type('"')
    assert "R12" in page.locator(".offers button").all_inner_texts()
    page.click('.offers button:text-is("R12")')
    page.wait_for_timeout(450)
    settle(page)
    assert marked(page) == ([], "")
    assert page.input_value("#text textarea").endswith('ground_angle_deg = 12\n[files]\ndxf_version = "R12"')


def test_a_form_offers_no_kind_that_the_mechanism_refuses(studio):  # noqa: F811
    choices = {}
    for kind in ("disk-cam", "groove-cam"):
        page = studio(template(recipe_class(kind))).page
        select = page.locator('[name="cam.follower.kind"]')
        choices[kind] = set(select.locator("option").all_inner_texts())
        page.context.close()
    flat = {"translating-flat", "oscillating-flat"}
    assert flat < choices["disk-cam"] and choices["groove-cam"] == choices["disk-cam"] - flat


def test_a_table_becomes_one_of_another_kind(studio):  # noqa: F811
    page = studio(SMALL_CAM).page
    page.select_option('[name="cam.follower.kind"]', '"translating-flat"')
    settle(page)
    assert page.input_value('[name="cam.follower.kind"]') == '"translating-flat"' and not page.locator(".stale").count()
    # The lifts are in mm: the reason is shown, and all is as before.
    page.select_option('[name="cam.follower.kind"]', '"oscillating-roller"')
    settle(page)
    assert page.is_visible("#limit") and not page.locator(".stale").count()
    assert page.input_value('[name="cam.follower.kind"]') == '"translating-flat"'


def test_pictures_of_candidates_move(studio):  # noqa: F811
    page = studio((RECIPES / "poses-by-crank.toml").read_text()).page
    page.wait_for_selector("#candidates button")
    picture = page.locator("#candidates button >> nth=0")
    label = picture.inner_text()
    assert "4 bars" in label and "transmission angle" in label

    def links():
        return picture.locator(".link").evaluate_all("all => all.map(path => path.getAttribute('d'))")

    still = links()
    page.wait_for_timeout(200)
    assert links() == still and len(still) == 2
    page.emulate_media(reduced_motion="no-preference")
    page.wait_for_timeout(200)
    assert links() != still
