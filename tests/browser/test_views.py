"""What the studio's drawing and plots show: all of a mechanism and its handles, names that can be read, axes with a scale."""

import re
from itertools import combinations
from pathlib import Path

import pytest

from tests.texts import template_of

from .test_editor import FOUR_BAR, PHONE, RECIPES, fill, settle, studio  # noqa: F401  the fixture

DESK = {"viewport": {"width": 1280, "height": 800}}
# All bodies in the frame of the ground.
AS_DRAWN = """kind = "linkage"

[linkage]
driver = "crank"

[linkage.bodies]
ground = {A = [0, 0]}
crank = {A = [0, 0], B = [30, 0]}
bar_1 = {B = [30, 0], E = [111, -0.5]}
block_1 = {E = [111, -0.5]}

[[linkage.sliders]]
name = "slide_1"
body = "block_1"
along = "ground"
point = [111, -0.5]
through = [111, -0.5]
"""


def box(page, selector):
    return page.locator(selector).first.bounding_box()


def middle(page, selector):
    found = box(page, selector)
    return found["x"] + found["width"] / 2, found["y"] + found["height"] / 2


def view(page):
    return page.get_attribute("#player .world", "transform")


def fit_anew(page):
    """Another size of the window and back fits the drawing."""
    for width in (1200, 1280):
        page.set_viewport_size({"width": width, "height": 800})
        page.wait_for_timeout(200)


def plot(page, title):
    page.locator(".plot select").first.select_option(label=title)


def test_all_of_it_is_shown_of_what_it_is_now(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    page.click("#build")
    pivots = 'document.querySelectorAll(".fixed-pin")'
    apart = f"{pivots}[1].getBoundingClientRect().x - {pivots}[0].getBoundingClientRect().x"
    before = page.evaluate(apart)
    page.click('[data-view="text"]')
    page.fill(
        "#text textarea", re.sub(r"\b(\d+)\b", lambda digits: f"{0.4 * int(digits[1])}", FOUR_BAR.replace(".00", ""))
    )
    page.wait_for_timeout(500)
    settle(page)
    assert page.evaluate(apart) < 0.5 * before
    page.click('[aria-label="Show all of it"]')
    assert page.evaluate(apart) > 0.8 * before


def test_another_candidate_fills_the_stage(studio):  # noqa: F811
    page = studio((RECIPES / "poses-by-crank.toml").read_text(), **DESK).page
    page.wait_for_selector("#candidates button")
    before = view(page)
    page.click("#candidates button >> nth=2")
    page.wait_for_selector("#candidates button:nth-child(3)[aria-pressed=true]")
    settle(page)
    shown = view(page)
    fit_anew(page)
    assert before != shown == view(page)


@pytest.mark.parametrize("options", [PHONE, {"viewport": {"width": 820, "height": 1180}}], ids=["phone", "tablet"])
def test_all_handles_are_inside_the_drawing(studio, options):  # noqa: F811
    page = studio((RECIPES / "klann.toml").read_text(), **options).page
    stage = box(page, ".stage")
    knobs = page.locator(".stage .knob")
    assert knobs.count() > 5
    for k in range(knobs.count()):
        knob = knobs.nth(k).bounding_box()
        assert stage["x"] <= knob["x"] and knob["x"] + knob["width"] <= stage["x"] + stage["width"]
        assert stage["y"] <= knob["y"] and knob["y"] + knob["height"] <= stage["y"] + stage["height"]


def test_the_name_of_a_block_is_beside_it(studio):  # noqa: F811
    page = studio(AS_DRAWN, **DESK).page
    (x, y), (u, v) = middle(page, ".mark.slide rect"), middle(page, '.name.of-body:text("block")')
    assert abs(u - x) < 40 and abs(v - y) < 40


@pytest.mark.parametrize("name", ["klann", "crank-rocker"])
def test_names_and_labels_of_handles_do_not_overlap_while_it_is_built(studio, name):  # noqa: F811
    page = studio((RECIPES / f"{name}.toml").read_text(), **PHONE).page
    page.click("#build")
    settle(page)
    texts = page.locator(".stage .tip, .drawing .name")
    shown = [texts.nth(k).bounding_box() for k in range(texts.count()) if texts.nth(k).is_visible()]
    assert len(shown) > 3
    for one, other in combinations(shown, 2):
        across = min(one["x"] + one["width"], other["x"] + other["width"]) - max(one["x"], other["x"])
        up = min(one["y"] + one["height"], other["y"] + other["height"]) - max(one["y"], other["y"])
        assert min(across, up) < 3
    hidden = page.locator(".handle.crowded").first
    assert hidden.locator(".tip").is_hidden()
    page.keyboard.press("Tab")
    hidden.focus()
    assert hidden.locator(".tip").is_visible()


def test_low_plots_have_a_scale(studio):  # noqa: F811
    for recipe, title in (("stephenson-dwell", "angles"), ("klann", "foot, place")):
        page = studio((RECIPES / f"{recipe}.toml").read_text(), **DESK).page
        plot(page, title)
        with page.expect_download() as download:
            page.click('[aria-label="This plot as SVG"] >> nth=0')
        picture = Path(download.value.path()).read_text()
        assert len(re.findall(r'<text [^>]*text-anchor="end">[−\d.]+</text>', picture)) >= 2


def test_a_value_at_the_end_of_a_turn_belongs_to_its_start(studio):  # noqa: F811
    """The last position of a gear pair begins another contact; its curve has no other value there, but at the left."""
    page = studio(template_of("gear-pair"), **DESK).page
    plot(page, "specific sliding")
    page.wait_for_timeout(200)
    coloured = """() => {
        const canvas = document.querySelector(".uplot canvas"), over = document.querySelector(".u-over"), dpr = devicePixelRatio;
        const from = over.offsetLeft + 0.8 * over.offsetWidth;
        const { data } = canvas.getContext("2d").getImageData(from * dpr, 0, (canvas.width - from) * dpr, over.offsetHeight * dpr);
        let count = 0;
        for (let k = 0; k < data.length; k += 4) count += data[k + 3] > 200 && Math.abs(data[k + 2] - data[k]) > 80;
        return count;
    }"""
    assert page.evaluate(coloured) == 0
    slider, legend = page.locator("#player .drive input"), page.locator(".legend li:first-child b").first
    at_start = legend.inner_text()
    slider.press("End")
    assert at_start == legend.inner_text() != "–"


def test_a_recipe_that_is_opened_while_plots_are_folded_has_all_of_them(studio):  # noqa: F811
    page = studio("", **DESK).page
    page.click("text=empty linkage")
    page.wait_for_selector("#tools:not([hidden])")
    settle(page)
    page.click("#new")
    page.locator("dialog[open] .card", has_text="klann").first.click()
    page.wait_for_selector('[data-handle="point:foot"]')
    settle(page)
    page.click('[data-panel="plots"]')
    assert page.locator(".right .plot").count() == 2


def test_no_verdict_on_former_values_is_shown(studio):  # noqa: F811
    page, held = studio(FOUR_BAR, **DESK).page, []
    verdicts = page.locator("#quantities tr.pass td:nth-child(3)")
    assert verdicts.first.is_visible()
    is_check = re.compile('"lane": ?"checks"')
    page.route(
        "**/answer", lambda route: held.append(route) if is_check.search(route.request.post_data) else route.continue_()
    )
    fill(page, "linkage.crank", "29")
    page.wait_for_timeout(300)
    assert held and verdicts.count() and not any(verdicts.nth(k).is_visible() for k in range(verdicts.count()))
    held[0].continue_()
    page.wait_for_selector("body:not(.unchecked)")
    assert verdicts.first.is_visible()
