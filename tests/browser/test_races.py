"""Acts that do not wait for the answers of the studio: each is done in its turn, on the recipe for which it was meant."""

import pytest

from .test_by_mouse import on_stage
from .test_editor import FOUR_BAR, RECIPES, centre, fill, settle, studio, value  # noqa: F401  the fixture
from .test_newcomer import DESK


class Held:
    """Requests that wait for `go()`."""

    def __init__(self, page, path):
        self.page, self.routes, self.is_open = page, [], False
        page.route(f"**/{path}", lambda route: route.continue_() if self.is_open else self.routes.append(route))

    def go(self):
        self.is_open = True
        for route in self.routes:
            route.continue_()
        settle(self.page)


def text_of(page):
    """The recipe's text as it is shown."""
    was = page.get_attribute('[data-view="text"]', "aria-pressed")
    page.click('[data-view="text"]')
    text = page.input_value("#text textarea")
    if was != "true":
        page.click('[data-view="form"]')
    return text


@pytest.mark.parametrize("before", ["", FOUR_BAR], ids=["first", "after a recipe"])
def test_an_empty_linkage_begins_with_a_tool_that_works(studio, before):  # noqa: F811
    page = studio(before, **DESK).page
    if before:
        page.click("#new")
    page.click("text=empty linkage")
    page.wait_for_selector('[data-tool="pivot"][aria-pressed="true"]')
    page.wait_for_selector("#tools:visible")
    settle(page)
    for x in (-50, 50):
        page.mouse.click(*on_stage(page, x, 0))
        settle(page)
    assert text_of(page).count("[-50") == 1 and text_of(page).count("[50") == 1


def add_button(page, title):
    return page.locator(f'#form button:text-is("Add {title}")')


def undone(page, keys):
    """Texts of the keys after each undo, until there is none."""
    states = []
    while page.is_enabled("#undo"):
        page.click("#undo")
        settle(page)
        text = text_of(page)
        states.append([key for key in keys if key in text])
    return states


def test_acts_wait_their_turn_and_are_undone_one_by_one(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    held = Held(page, "answer")
    for crank in ("3", "35"):
        page.fill('[name="linkage.crank"]', crank)
    for title in ("loads", "dwell", "copies"):
        add_button(page, title).click()
    page.fill('[name="linkage.rocker"]', "71")
    page.dispatch_event('[name="linkage.rocker"]', "change")
    held.go()
    keys = ["crank = 35", "[loads", "[dwell", "[[copies", "rocker = 71"]
    text = text_of(page)
    assert [key for key in keys if key in text] == keys
    assert undone(page, keys) == [keys[:k] for k in (4, 3, 2, 1, 0)] and text_of(page) == FOUR_BAR


def test_a_drag_begins_from_what_was_typed_before_it(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    held = Held(page, "answer")
    page.fill('[name="linkage.ground"]', "110")
    x, y = centre(page, "point:coupler_point")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 20, y - 20, steps=4)
    page.mouse.up()
    for _ in range(2):
        page.keyboard.press("ArrowRight")
    held.go()
    assert value(page, "linkage.ground") == 110 and value(page, "linkage.coupler_point[0]") != 40
    assert undone(page, ["ground = 110", "[40, 25]"]) == [["ground = 110"], ["ground = 110", "[40, 25]"], ["[40, 25]"]]


def test_a_length_and_presses_of_a_handle_wait_their_turn(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    page.check('input[name="dimension"]')
    box = page.locator('[data-dimension="1"]').bounding_box()
    held = Held(page, "answer")
    page.fill('[name="linkage.ground"]', "110")
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.keyboard.type("32")
    page.keyboard.press("Enter")
    page.focus('[data-handle="point:coupler_point"]')
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    held.go()
    keys = ["ground = 110", "crank = 32", "[40, 25]"]
    text = text_of(page)
    assert [key for key in keys if key in text] == keys[:2]
    assert undone(page, keys) == [keys, ["ground = 110", "[40, 25]"], ["[40, 25]"]]
