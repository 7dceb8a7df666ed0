"""Acts that do not wait for the answers of the studio: each is done in its turn, on the recipe for which it was meant."""

import pytest

import geomkin as gk

from .test_by_mouse import on_stage
from .test_editor import FOUR_BAR, RECIPES, centre, fill, settle, studio, value  # noqa: F401  the fixture
from .test_newcomer import DESK, link_of, status, tool


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


@pytest.mark.parametrize("typed", ["1000", "-30", "32"])
def test_a_field_shows_what_was_typed_last_whatever_is_answered_late(studio, typed):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    page.click('[name="linkage.crank"]')
    page.keyboard.press("Control+a")
    held = Held(page, "answer")
    for key in typed:
        page.keyboard.press(key)
        page.wait_for_timeout(20)
    page.keyboard.press("Enter")
    held.go()
    assert f"crank = {typed}" in text_of(page) and page.input_value('[name="linkage.crank"]') == typed
    page.click("#undo")
    settle(page)
    assert value(page, "linkage.crank") == 30


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


GEARS = (RECIPES / "gear-pair.toml").read_text()
WALKER = (RECIPES / "motor-walker.toml").read_text()
STROKE = [(0, 60), (30, 80), (60, 90), (90, 80), (100, 60), (60, 50), (20, 50), (0, 60)]


def beside(editor, name, text):
    """Another recipe of the folder."""
    editor.file.with_name(f"{name}.toml").write_text(text)


def open_recipe(page, name):
    page.click("#gallery")
    page.click(f'#folder .card:has(b:text-is("{name}"))')
    page.wait_for_selector(f'#name:text-is("{name}")')


def draw(page, points):
    places = [on_stage(page, *point) for point in points]
    page.mouse.move(*places[0])
    page.mouse.down()
    for place in places[1:]:
        page.mouse.move(*place, steps=4)
    page.mouse.up()


# --- acts with the text that is typed ----------------------------------------------------------------------------------


def test_save_waits_for_what_is_typed(studio):  # noqa: F811
    editor = studio(WALKER, **DESK)
    page = editor.page
    held = Held(page, "answer")
    page.click('[name="drive.speed_rpm"]')
    page.keyboard.press("Control+a")
    page.keyboard.type("75", delay=90)
    page.keyboard.press("Control+s")
    held.go()
    page.wait_for_selector('#status:has-text("Saved")')
    assert gk.load(editor.file).drive.speed_rpm == 75 and page.is_hidden("#dirty")


def test_save_takes_the_text_that_is_typed_still(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    page.click('[data-view="text"]')
    page.fill("#text textarea", FOUR_BAR.replace("30.00", "35"))
    page.keyboard.press("Control+s")
    page.wait_for_selector('#status:has-text("Saved")')
    assert editor.file.read_text() == FOUR_BAR.replace("30.00", "35") and page.is_hidden("#dirty")
    assert undone(page, ["30.00"]) == [["30.00"]]


@pytest.mark.parametrize("what", ["link", "python"])
def test_what_is_copied_has_what_is_typed(studio, what):  # noqa: F811
    page = studio(FOUR_BAR, permissions=["clipboard-read", "clipboard-write"], **DESK).page
    held = Held(page, "answer")
    page.fill('[name="linkage.crank"]', "35.25")
    page.click("#share summary")
    page.click(f"#share-{what}")
    page.wait_for_timeout(50)
    held.go()
    page.wait_for_selector('#status:has-text("copied")')
    copied = page.evaluate("navigator.clipboard.readText()")
    wanted = link_of(page, FOUR_BAR.replace("30.00", "35.25")) if what == "link" else "crank = 35.25"
    assert wanted in copied


def test_nothing_is_saved_or_made_of_a_field_that_is_wrong(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    page.fill('[name="linkage.crank"]', "abc")
    page.keyboard.press("Control+s")
    assert status(page).startswith("Not saved") and editor.file.read_text() == FOUR_BAR
    page.click("#make")
    assert status(page).startswith("No files made")
    fill(page, "linkage.crank", "31")
    page.keyboard.press("Control+s")
    page.wait_for_selector('#status:has-text("Saved")')
    assert gk.load(editor.file).linkage.crank == 31


# --- acts and another recipe ----------------------------------------------------------------------------------------------


def test_a_path_is_followed_by_no_other_recipe(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page, other = editor.page, FOUR_BAR.replace("30.00", "32")
    beside(editor, "other", other)
    with page.expect_response("**/nearest"):
        tool(page, "path")
    held = Held(page, "nearest")
    draw(page, STROKE)
    page.wait_for_timeout(50)
    assert held.routes
    open_recipe(page, "other")
    with page.expect_response("**/nearest"):
        held.go()
    page.wait_for_timeout(100)
    assert not page.locator("body.solving").count() and page.is_hidden("#known") and text_of(page) == other


@pytest.mark.parametrize("act", ["build", "typed", "drag"])
def test_what_waits_is_dropped_with_its_recipe(studio, act):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page, other = editor.page, FOUR_BAR.replace("30.00", "32")
    beside(editor, "other", other)
    x, y = centre(page, "point:coupler_point")
    opened, held = Held(page, "open"), Held(page, "answer")
    page.click("#gallery")
    page.click('#folder .card:has(b:text-is("other"))')
    # The other recipe is not there yet.
    if act == "build":
        tool(page, "bar")
        for place in ((30, 0), (60, 90)) * 2:
            page.mouse.click(*on_stage(page, *place))
    elif act == "typed":
        page.fill('[name="linkage.rocker"]', "71")
        page.click('[data-view="text"]')
        page.fill("#text textarea", FOUR_BAR.replace("30.00", "35"))
    else:
        page.fill('[name="linkage.rocker"]', "71")
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 20, y - 20, steps=4)
    opened.is_open = True
    with page.expect_response("**/open"):
        opened.routes[0].continue_()
    page.wait_for_timeout(50)
    if act == "drag":
        page.mouse.move(x + 30, y - 20, steps=2)
        page.mouse.up()
    page.wait_for_timeout(400)
    held.go()
    settle(page)
    assert text_of(page) == other and page.is_hidden("#dirty") and page.is_disabled("#undo")


def test_files_are_listed_with_their_recipe(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    beside(editor, "gears", GEARS)
    page.click("#make")
    page.wait_for_selector("#files li")
    open_recipe(page, "gears")
    settle(page)
    assert page.is_hidden("#files-part")
    open_recipe(page, "it")
    settle(page)
    held = Held(page, "job?*")
    page.click("#make")
    page.wait_for_timeout(300)
    open_recipe(page, "gears")
    held.go()
    page.wait_for_selector("#work", state="hidden")
    assert page.is_hidden("#files-part") and "files" not in status(page)


def test_a_file_that_is_read_late_replaces_no_other_recipe(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    beside(editor, "gears", GEARS)
    held = Held(page, "open")
    editor.file.write_text(FOUR_BAR + "# by another program\n")
    page.wait_for_timeout(1000)
    assert held.routes
    held.is_open = True
    open_recipe(page, "gears")
    held.go()
    page.wait_for_timeout(200)
    settle(page)
    assert page.inner_text("#name") == "gears" and text_of(page) == GEARS and "it" not in status(page).split()


def test_a_film_ends_with_its_recipe(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    beside(editor, "gears", GEARS)
    film = page.locator('button[title="The motion as a film"], button[aria-label="The motion as a film"]')
    film.click()
    page.wait_for_timeout(100)
    assert "%" in film.inner_text()
    open_recipe(page, "gears")
    page.wait_for_timeout(300)
    assert film.inner_text() == "Film"


def test_a_save_that_is_refused_late_asks_nothing_of_another_recipe(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    beside(editor, "gears", GEARS)
    fill(page, "linkage.crank", "35")
    held, _ = Held(page, "save"), Held(page, "changed*")
    editor.file.write_text(FOUR_BAR + "# by another program\n")
    page.click("#save")
    page.wait_for_timeout(100)
    assert held.routes
    open_recipe(page, "gears")
    settle(page)
    with page.expect_response("**/save"):
        held.go()
    page.wait_for_selector('#status:has-text("it.toml")')
    assert page.is_hidden("#conflict") and "not saved" in status(page)
    assert editor.file.read_text() == FOUR_BAR + "# by another program\n"


def test_changes_that_are_offered_stay_until_they_are_answered(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    fill(page, "linkage.crank", "33")
    page.on("dialog", lambda dialog: dialog.accept())
    page.reload()
    page.wait_for_selector("#conflict button")
    settle(page)
    fill(page, "linkage.rocker", "71")
    page.reload()
    page.wait_for_selector("#conflict button")
    page.click("#gallery")
    page.wait_for_selector("#drafts li")
    assert page.locator("#drafts li").count() == 2
    page.keyboard.press("Escape")
    page.click('#conflict button:has-text("Discard")')
    fill(page, "linkage.crank", "34")
    page.click("#gallery")
    page.wait_for_selector("#drafts li")
    assert page.locator("#drafts li").count() == 1


# --- tools, undo and lists ----------------------------------------------------------------------------------------------


def test_the_motor_tool_asks_once_for_another_driver(studio):  # noqa: F811
    chain = (
        'kind = "linkage"\n[linkage]\ndriver = "crank"\n[linkage.bodies]\nground = { A = [-50, 0], C = [50, 0] }\n'
        "left = { A = [-50, 0], B = [-40, 30] }\ncoupler = { B = [-40, 30], D = [40, 60] }\n"
        'crank = { C = [50, 0], D = [40, 60] }\n[stock]\nmotor = "nema17"\n'
    )
    page, asked = studio(chain, **DESK).page, []
    tool(page, "motor")
    page.on("request", lambda request: asked.append(request) if request.url.endswith("/answer") else None)
    page.mouse.click(*on_stage(page, 0, 45))
    settle(page)
    page.wait_for_timeout(400)
    assert not asked and status(page) and page.is_disabled("#undo")
    page.mouse.click(*on_stage(page, -45, 15))
    settle(page)
    page.wait_for_timeout(400)
    assert len(asked) <= 4


def test_undo_stops_a_search_and_takes_one_step(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    fill(page, "linkage.crank", "31")
    before = text_of(page)
    with page.expect_response("**/nearest"):
        tool(page, "path")
    draw(page, STROKE)
    page.wait_for_selector("#stop", state="visible")
    page.keyboard.press("Control+z")
    page.wait_for_selector("#work", state="hidden", timeout=3000)
    settle(page)
    assert status(page) == "Undone" and text_of(page) == before
    assert undone(page, ["30.00"]) == [["30.00"]]


def test_a_known_linkage_is_taken_while_the_search_runs(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    with page.expect_response("**/nearest"):
        tool(page, "path")
    draw(page, STROKE)
    page.wait_for_selector("#stop", state="visible")
    page.click("#known button >> nth=0")
    page.wait_for_selector("#work", state="hidden", timeout=3000)
    settle(page)
    assert "it.toml" in status(page) and "Undo" in status(page)
    assert "wanted" not in text_of(page) and text_of(page) != FOUR_BAR
    assert undone(page, ["30.00"]) == [["30.00"]] and text_of(page) == FOUR_BAR


def test_values_that_are_set_during_a_search_are_searched_together(studio):  # noqa: F811
    page = studio((RECIPES / "slider-path.toml").read_text(), **DESK).page
    held, typed = Held(page, "job?*"), {"bounds.crank[0]": 16, "bounds.crank[1]": 39}
    for key, number in typed.items():
        page.fill(f'[name="{key}"]', str(number))
        page.dispatch_event(f'[name="{key}"]', "change")
        page.wait_for_timeout(600)
    held.go()
    assert {key: value(page, key) for key in typed} == typed


def test_lists_of_the_gallery_do_not_mix(studio):  # noqa: F811
    page, late = studio(GEARS, **DESK).page, []
    page.route("**/examples*", lambda route: route.continue_() if late else late.append(route))
    page.click("#join")
    page.wait_for_selector("#kinds .card")
    page.keyboard.press("Escape")
    page.click("#new")
    page.wait_for_selector("#examples .card")
    count = page.locator("#examples .card").count()
    with page.expect_response("**/examples*"):
        late[0].continue_()
    page.wait_for_timeout(100)
    assert page.locator("#examples .card").count() == count


def test_the_gallery_does_not_open_over_another_dialog(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    held = Held(page, "gallery*")
    page.click("#gallery")
    page.click("#save-as")
    page.fill("#file-name", "mine")
    with page.expect_response("**/gallery*"):
        held.go()
    page.wait_for_timeout(100)
    assert not page.locator("#gallery-dialog[open]").count() and page.input_value("#file-name") == "mine"
