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
