"""What a newcomer does in the studio: clicks anywhere on a body, damaged links, other steps of the drive, messages."""

import re
import threading

import numpy as np
import pytest

import geomkin as gk
from geomkin.studio.server import StudioServer
from geomkin.studio.service import Studio
from geomkin.studio.workspace import Workspace

from .test_by_mouse import on_stage
from .test_editor import FOUR_BAR, PHONE, RECIPES, drag, fill, settle, studio, value  # noqa: F401  the fixture

DESK = {"viewport": {"width": 1280, "height": 800}}
PLATED = FOUR_BAR + "[stock]\nbar_width = 24\n"


def status(page):
    return page.inner_text("#status")


def tool(page, name):
    if page.locator("#tools").is_hidden():
        page.click("#build")
    page.click(f'[data-tool="{name}"]')


def inside(page, body):
    """Places in the window inside the uppermost drawn plate of a body, far from its axis."""
    find = """(body) => {
        const plate = document.querySelector(`[data-body="${body}"] .plate`), box = plate.getBBox(), matrix = plate.getScreenCTM(), found = [];
        for (let u = 1; u < 20; u++) for (let v = 1; v < 20; v++) {
            const [x, y] = [box.x + box.width * u / 20, box.y + box.height * v / 20];
            if (!plate.isPointInFill(new DOMPoint(x, y))) continue;
            const { x: left, y: top } = new DOMPoint(x, y).matrixTransform(matrix), plates = document.elementsFromPoint(left, top);
            const first = plates.find((element) => element.classList.contains("plate"));
            if (first === plate) found.push([left, top]);
        }
        return found;
    }"""
    return page.evaluate(find, body)


def test_a_body_is_clicked_anywhere_on_its_plate(studio):  # noqa: F811
    page = studio(PLATED, **DESK).page
    tool(page, "driver")
    spots = {body: inside(page, body) for body in ("rocker", "coupler")}
    pins = {
        body: [on_stage(page, *place) for place in places]
        for body, places in {"rocker": _pins(page, "rocker"), "coupler": _pins(page, "coupler")}.items()
    }
    for body, places in spots.items():
        assert len(places) > 10
        off = [apart(pins[body], place) for place in places]
        place = places[int(np.argmax(off))]
        assert max(off) > 9
        page.mouse.move(*place)
        assert page.text_content(".tool-layer text") == body
    page.mouse.click(*spots["rocker"][int(np.argmax([apart(pins["rocker"], p) for p in spots["rocker"]]))])
    settle(page)
    assert "no body" not in status(page) and page.is_visible("#dirty")


def _pins(page, body, text=PLATED):
    motion = gk.load(text).motion
    names = [*motion.linkage.bodies[body]]
    frame = int(page.get_attribute("#player", "data-frame"))
    frames = int(page.get_attribute("#player .drive input", "max")) + 1
    row = round(frame * (len(motion.drive) - 1) / (frames - 1))
    places = [motion.point(name).position[row] for name in names]
    return [(p.real, p.imag) for p in places]


def apart(pins, place):
    """Distance from the lines between pins, px."""
    z, points = complex(*place), [complex(*pin) for pin in pins]
    least = np.inf
    for k, a in enumerate(points):
        for b in points[k + 1 :]:
            share = min(1, max(0, ((z - a) * (b - a).conjugate()).real / abs(b - a) ** 2))
            least = min(least, abs(a + share * (b - a) - z))
    return least


def test_a_plate_that_is_still_built_is_clicked_in_its_middle(studio):  # noqa: F811
    page = studio("", **DESK).page
    page.click("text=empty linkage")
    page.wait_for_selector('[data-tool="plate"]')
    tool(page, "plate")
    for place in ((-60, -40), (60, -40), (0, 60)):
        page.mouse.click(*on_stage(page, *place))
        settle(page)
    tool(page, "delete")
    page.mouse.click(*on_stage(page, 0, -8))
    settle(page)
    assert "no" not in status(page) and not page.locator(".mark.line").count()


@pytest.mark.parametrize("held", ["", "%%%", "QUJD", "half"])
def test_a_damaged_link_says_so_and_shows_the_list(studio, held):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    whole = link_of(page, FOUR_BAR).removeprefix("recipe=")
    held = whole[: len(whole) // 2] if held == "half" else held
    for act in (
        lambda: (page.goto("about:blank"), page.goto(f"{editor.server.url}#recipe={held}")),
        lambda: page.evaluate("held => { location.hash = `#recipe=${held}`; }", held),
    ):
        act()
        page.wait_for_selector("#gallery-dialog[open] .card")
        assert "incomplete" in page.inner_text("#gallery-said") and status(page) != "Loading"
        page.keyboard.press("Escape")
    page.click("#gallery")
    page.wait_for_selector("#gallery-dialog[open] .card")
    assert not page.inner_text("#gallery-said")


def link_of(page, text):
    return page.evaluate("text => import('./player/links.js').then(({ linkOf }) => linkOf(text))", text).split("#")[1]


def test_a_link_with_an_unknown_kind_or_bad_values_is_no_blank_page(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    page.evaluate("held => { location.hash = held; }", link_of(page, 'kind = "five-bar"\n'))
    page.wait_for_selector("#gallery-dialog[open] .card")
    assert "five-bar" in page.inner_text("#gallery-said")
    # What was open is open still.
    page.keyboard.press("Escape")
    settle(page)
    assert page.inner_text("#name") == "it" and page.is_hidden("#dirty") and value(page, "linkage.crank") == 30
    page.goto("about:blank")
    page.goto(editor.server.url)
    page.wait_for_selector("body[data-checked]")
    link = link_of(page, FOUR_BAR.replace("ground = 100", "ground = 1e300"))
    page.goto("about:blank")
    page.goto(f"{editor.server.url}#{link}")
    page.wait_for_selector('[name="linkage.ground"]')
    assert value(page, "linkage.ground") == 1e300 and value(page, "linkage.rocker") == 70
    assert page.locator('[name="linkage.ground"][aria-invalid]').count()
    fill(page, "linkage.ground", "100")
    page.wait_for_selector("#player[data-ready]")
    assert value(page, "linkage.crank") == 30


def test_join_stays_after_a_drag(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    assert page.is_visible("#join")
    drag(page, "point:rocker_pin", 20, 10)
    assert page.is_visible("#dirty") and page.is_visible("#join")


@pytest.mark.parametrize(("before", "after"), [(1, 3), (2, 6), (2, 4), (4, 5)])
def test_ground_and_ghost_stay_where_they_are_with_another_step_of_the_drive(studio, before, after):  # noqa: F811
    page = studio(FOUR_BAR + f"[drive]\nstep_deg = {before}\n", **DESK).page
    slider = page.locator("#player .drive input")
    page.evaluate(
        "frame => { const s = document.querySelector('.drive input'); s.value = frame; s.dispatchEvent(new Event('input')); }",
        round(161 / before),
    )
    page.locator("#form summary", has_text="drive").click() if page.locator(
        '[name="drive.step_deg"]'
    ).is_hidden() else None
    fill(page, "drive.step_deg", str(after))
    assert int(slider.get_attribute("max")) == pytest.approx(360 / after, abs=1)
    ground = page.locator(".body.fixed").first
    assert ground.get_attribute("transform") and ground.get_attribute("visibility") != "hidden"
    # The ghost of the same linkage covers it: crank on crank, up to the position between two rows.
    ghosts = page.eval_on_selector_all(".ghost g", "groups => groups.map((group) => group.getAttribute('transform'))")
    bodies = page.eval_on_selector_all(
        "figure:first-child .body.moving", "groups => groups.map((group) => group.getAttribute('transform'))"
    )
    numbers = lambda text: np.array([float(x) for x in re.findall(r"-?[\d.]+", text)])  # noqa: E731
    assert ghosts and all(min(np.abs(numbers(g) - numbers(b)).max() for b in bodies) < 0.5 for g in ghosts)


def test_a_message_ends_with_the_next_act(studio):  # noqa: F811
    editor = studio(FOUR_BAR, permissions=["clipboard-read", "clipboard-write"], **DESK)
    page = editor.page
    page.click("#share summary")
    page.click("#share-link")
    page.wait_for_selector('#status:has-text("copied")')
    # It leads to this studio.
    assert page.evaluate("navigator.clipboard.readText()").startswith(
        f"http://127.0.0.1:{editor.server.server_port}/open#"
    )
    tool(page, "driver")
    assert status(page) == ""
    page.mouse.click(*on_stage(page, -20, -30))
    assert "no body" in status(page)
    page.click("#new")
    page.wait_for_selector("#gallery-dialog[open] .card")
    assert status(page) == ""
    # The tool does not stay for another recipe.
    page.click('#kinds .card:has(b:text-is("four-bar"))')
    settle(page)
    assert page.get_attribute('[data-tool="move"]', "aria-pressed") == "true"


def test_a_recipe_of_the_gallery_keeps_its_name(studio):  # noqa: F811
    page = studio("", **DESK).page
    page.click('#examples .card:has(b:text-is("klann"))')
    page.wait_for_selector("body[data-checked]")
    assert page.inner_text("#name") == "new klann"
    page.click("#save")
    assert page.input_value("#file-name") == "klann"


@pytest.mark.parametrize(
    ("name", "is_right"), [("my dwell", True), ("Mein Möbel", True), ("a/b", False), (".a", False), ("x?", False)]
)
def test_a_file_has_any_name_that_the_command_allows(studio, name, is_right):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page = editor.page
    page.click("#save-as")
    page.fill("#file-name", name)
    said = page.eval_on_selector("#file-name", "input => input.validationMessage")
    assert bool(said) != is_right
    if not is_right:
        return
    page.keyboard.press("Enter")
    page.wait_for_selector(f'#status:has-text("Saved {name}.toml")')
    assert gk.load(editor.file.with_name(f"{name}.toml")).linkage.crank == 30
    with page.expect_download() as download:
        page.click("#share summary")
        page.click("#share-zip")
    from zipfile import ZipFile

    with ZipFile(download.value.path()) as archive:
        assert archive.read(f"{name}.toml").decode() == FOUR_BAR


def test_one_draft_for_a_link_that_is_opened_again(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page, link = editor.page, None
    link = link_of(page, FOUR_BAR.replace("30.00", "31"))
    for _ in range(3):
        page.evaluate("held => { location.hash = held; }", link)
        page.wait_for_selector('#name:has-text("new four-bar")')
        settle(page)
    page.click("#gallery")
    page.wait_for_selector("#gallery-dialog[open] .card")
    assert page.locator("#drafts li").count() == 1 and page.evaluate("document.activeElement.id") == "search"
    page.keyboard.press("Escape")
    page.click("#new")
    page.wait_for_selector("#kinds .card")
    assert not page.locator("#drafts li").count() and not page.locator("#folder .card").count()


def test_another_recipe_begins_at_the_top_of_its_form(studio):  # noqa: F811
    page = studio(FOUR_BAR, viewport={"width": 1280, "height": 500}).page
    page.eval_on_selector("aside", "aside => { aside.scrollTop = 400; }")
    assert page.eval_on_selector("aside", "aside => aside.scrollTop") > 50
    page.click("#new")
    page.click('#kinds .card:has(b:text-is("four-bar"))')
    settle(page)
    assert page.eval_on_selector("aside", "aside => aside.scrollTop") == 0


def test_the_stage_of_a_phone_stays_where_it_is_when_a_linkage_begins_to_move(studio):  # noqa: F811
    page = studio("", **PHONE).page
    page.click("text=empty linkage")
    page.wait_for_selector('[data-tool="pivot"][aria-pressed="true"]')

    def top():
        box = page.locator("#player .stages").bounding_box()
        return box["y"] + page.evaluate("scrollY")

    tool(page, "pivot")
    for x in (50, -50):
        page.mouse.click(*on_stage(page, x, 0))
        settle(page)
    before = top()
    for name, places in {"bar": [(-50, 0), (-40, 20)], "dyad": [(-40, 20), (50, 0), (40, 40)]}.items():
        tool(page, name)
        for place in places:
            page.mouse.click(*on_stage(page, *place))
            settle(page)
    assert page.locator("#tools b").inner_text().startswith("1 degree")
    assert page.is_visible("#player .drive") and abs(top() - before) < 1


def test_a_linkage_does_not_begin_to_move_under_a_tool(studio):  # noqa: F811
    page = studio("", viewport={"width": 1280, "height": 720}, reduced_motion="no-preference").page
    page.click("text=empty linkage")
    page.wait_for_selector('[data-tool="pivot"][aria-pressed="true"]')
    for name, places in {
        "pivot": [(50, 0), (-50, 0)],
        "bar": [(-50, 0), (-40, 20)],
        "dyad": [(-40, 20), (50, 0), (40, 40)],
    }.items():
        tool(page, name)
        for place in places:
            page.mouse.click(*on_stage(page, *place))
            # Beside the stage: a pointer over it would stop a motion.
            page.mouse.move(5, 5)
            settle(page)
    page.wait_for_timeout(100)
    assert page.locator("#tools b").inner_text().startswith("1 degree") and not page.locator("#player.playing").count()


def test_a_leg_of_the_gallery_is_joined_to_a_gear(studio):  # noqa: F811
    page = studio((RECIPES / "gear-pair.toml").read_text(), **DESK).page
    page.click("#join")
    page.wait_for_selector("#examples .card")
    page.fill("#search", "leg")
    page.click('#examples .card:has(b:text-is("klann"))')
    page.mouse.click(*on_stage(page, 0, 0))
    settle(page)
    page.click('[data-view="text"]')
    text = page.input_value("#text textarea")
    machine = gk.load(text)
    assert machine.mechanisms["klann"].turned_by == "it.first" and len(machine.recipes["klann"].linkage.bodies) == 6


def test_nothing_is_cut_off_or_named_twice(studio):  # noqa: F811
    page = studio((RECIPES / "roller-cam.toml").read_text(), **DESK).page
    for k in range(page.locator(".handle.plot").count()):
        page.locator(".handle.plot").nth(k).hover(force=True)
        tip, chart = (
            page.locator(".handle.plot .tip").nth(k).bounding_box(),
            page.locator(".chart").first.bounding_box(),
        )
        assert tip["y"] >= chart["y"] and tip["x"] + tip["width"] <= chart["x"] + chart["width"]
    switches = page.eval_on_selector(".switches", "set => [set.scrollWidth, set.clientWidth]")
    assert switches[0] <= switches[1]
    page = studio((RECIPES / "gear-pair.toml").read_text(), **DESK).page
    wide = page.eval_on_selector("#quantities-part", "part => [part.scrollWidth, part.clientWidth]")
    assert wide[0] <= wide[1]
    page = studio(FOUR_BAR, **DESK).page

    def named():
        texts = page.locator(".name, .handle .tip").filter(has_text="coupler point")
        return sum(texts.nth(k).is_visible() for k in range(texts.count()))

    page.hover('[data-handle="point:coupler_point"] .grab', force=True)
    assert named() == 1
    page.click("#build")
    assert named() == 1


@pytest.mark.parametrize("is_refused", [True, False], ids=["sizes", "position"])
def test_a_body_is_clicked_where_a_linkage_is_open(studio, is_refused):  # noqa: F811
    """Either no position can be assembled, or the one that is shown cannot."""
    text = (
        FOUR_BAR
        if is_refused
        else FOUR_BAR.replace("crank = 30.00", "crank = 75") + "[drive]\nstart_deg = 0\nend_deg = 360\n"
    )
    page = studio(text, **DESK).page
    if is_refused:
        fill(page, "linkage.rocker", "12")
    else:
        page.locator("#player .drive input").fill("180")
    page.wait_for_selector(".gap .link", state="attached")
    tool(page, "driver")
    # The link with three points, as a polygon: its middle is off its sides.
    spots = page.eval_on_selector_all(
        ".gap .link",
        """paths => paths.filter((path) => path.getAttribute("d").endsWith("z")).map((path) => {
        const corners = path.getAttribute("d").slice(1, -1).split("L").map((place) => place.split(",").map(Number)), matrix = path.getScreenCTM();
        const { x, y } = new DOMPoint(...[0, 1].map((axis) => corners.reduce((sum, corner) => sum + corner[axis], 0) / 3)).matrixTransform(matrix);
        return [x, y];
    })""",
    )
    assert len(spots) == 1
    page.mouse.move(*spots[0])
    assert page.text_content(".tool-layer text") == "coupler"
    page.mouse.click(*spots[0])
    settle(page)
    assert "no body" not in status(page)


def test_a_save_that_is_answered_late_gives_its_name_to_no_other_recipe(studio):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    page, held = editor.page, []
    fill(page, "linkage.rocker", "71")
    page.route("**/save", lambda route: held.append(route))
    page.click("#save")
    page.click("#new")
    page.click('#kinds .card:has-text("disk-cam") >> nth=0')
    page.wait_for_selector("body[data-checked]:not(.solving)")
    assert held
    with page.expect_response("**/save"):
        held[0].continue_()
    settle(page)
    assert "disk-cam" in page.inner_text("#name") and "it" not in page.inner_text("#name").split()


@pytest.mark.parametrize("late", ["new", "answer"])
def test_a_tool_that_is_chosen_early_stays_chosen(studio, late):  # noqa: F811
    """The tools of the former recipe are still there while an empty linkage is opened."""
    page, held = studio(FOUR_BAR, **DESK).page, []
    page.click("#build")
    page.click("#new")
    page.route(f"**/{late}", lambda route: held.append(route))
    page.click("text=empty linkage")
    page.wait_for_timeout(100)
    assert held and page.locator("body.solving").count()
    if late == "answer":
        page.click('[data-tool="path"]')
    page.route(f"**/{late}", lambda route: route.continue_())
    held[0].continue_()
    page.wait_for_selector('[data-handle="point:coupler_point"]', state="detached")
    settle(page)
    chosen = page.locator('#tools [aria-pressed="true"]').get_attribute("data-tool")
    assert chosen == ("path" if late == "answer" else "pivot")


@pytest.mark.parametrize(("body", "drive"), [("coupler", ""), ("rocker", "[drive]\nstart_deg = 0\nend_deg = 90\n")])
def test_a_motor_that_is_refused_leaves_the_driver(studio, body, drive):  # noqa: F811
    page = studio(FOUR_BAR + drive, **DESK).page
    tool(page, "motor")
    (x, y), (u, v) = (on_stage(page, *place) for place in _pins(page, body, FOUR_BAR + drive)[:2])
    page.mouse.click(0.5 * (x + u), 0.5 * (y + v))
    page.wait_for_selector("#status:not(:empty)")
    settle(page)
    page.wait_for_timeout(100)
    assert page.is_hidden("#dirty") and page.is_disabled("#undo") and not page.locator(".stale, dialog[open]").count()
    assert body in status(page) or not drive


def test_a_name_that_the_recipe_cannot_have_is_refused_in_its_dialog(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    tool(page, "rename")
    page.mouse.click(*on_stage(page, *_pins(page, "coupler")[0]))
    field = page.locator("#rename-dialog input")
    for name, is_refused in (("a.b", True), (" a", True), ("pin 1", False), ("Kurbel-größe_2", False)):
        field.fill(name)
        assert field.evaluate("input => input.validity.valid") != is_refused
    field.fill("a/b")
    page.keyboard.press("Enter")
    assert page.is_visible("#rename-dialog") and page.is_hidden("#dirty")
    field.fill("a b")
    page.keyboard.press("Enter")
    page.wait_for_selector("#dirty", state="visible")
    assert not page.locator(".stale").count()


def test_a_problem_that_the_form_does_not_show_is_on_the_drawing(studio):  # noqa: F811
    page = studio(FOUR_BAR, viewport={"width": 1280, "height": 500}).page
    fill(page, "linkage.crank", "-1")
    assert page.is_visible(".field.wrong .problem") and not page.locator("#problems li").count()
    page.evaluate("document.querySelector('aside').scrollTop = 1e6")
    page.keyboard.press("Control+z")
    settle(page)
    page.keyboard.press("Control+Shift+z")
    settle(page)
    assert "crank" in page.inner_text("#problems li")
    page.click("[data-panel=form]")
    page.keyboard.press("Control+z")
    settle(page)
    assert not page.locator("#problems li").count()
    page.keyboard.press("Control+Shift+z")
    settle(page)
    assert page.is_visible("#problems li")


@pytest.mark.parametrize("is_file", [True, False])
def test_what_is_set_while_the_studio_is_away_is_done_when_it_is_back(studio, is_file):  # noqa: F811
    editor = studio(FOUR_BAR, **DESK)
    editor.allowed.append("ERR_CONNECTION_REFUSED")
    page, old = editor.page, editor.server
    if not is_file:
        page.evaluate("held => { location.hash = held; }", link_of(page, FOUR_BAR))
        page.wait_for_selector('#name:has-text("new four-bar")')
        settle(page)
    old.shutdown()
    old.server_close()
    page.fill('[name="linkage.crank"]', "31")
    page.fill('[name="linkage.rocker"]', "71")
    page.dispatch_event('[name="linkage.rocker"]', "change")
    page.wait_for_selector("#problems li")
    if is_file:
        page.keyboard.press("Control+s")
        page.wait_for_selector('#status:has-text("Not saved")')
        assert page.inner_text("#problems li").partition(";")[0] in status(page)
    new = StudioServer(Studio(Workspace(editor.file.parent), "it"), old.server_port, token=old.token)
    threading.Thread(target=new.serve_forever, args=(0.01,), daemon=True).start()
    try:
        page.wait_for_selector("body:not(.stale)", timeout=4000)
        settle(page)
        assert not page.locator("#problems li").count()
        assert [value(page, f"linkage.{key}") for key in ("crank", "rocker")] == [31, 71]
        if is_file:
            page.keyboard.press("Control+s")
            page.wait_for_selector("#dirty", state="hidden")
            assert gk.load(editor.file).linkage.crank == 31 and gk.load(editor.file).linkage.rocker == 71
    finally:
        new.shutdown()
        new.server_close()


def test_a_draft_has_the_time_of_its_last_change(studio):  # noqa: F811
    page = studio(FOUR_BAR, **DESK).page
    fill(page, "linkage.crank", "31")
    kept = "JSON.parse(localStorage.getItem('geomkin-drafts'))[0]"
    opened, first = page.evaluate(f"[+{kept}.id, {kept}.changed]")
    page.wait_for_timeout(50)
    fill(page, "linkage.crank", "32")
    second = page.evaluate(f"{kept}.changed")
    assert opened <= first < second
    # To look at it is no change.
    page.click('#form button[aria-label="Lock linkage.crank"]')
    settle(page)
    assert page.evaluate(f"{kept}.changed") == second
    page.evaluate(
        f"localStorage.setItem('geomkin-drafts', JSON.stringify([Object.assign({kept}, {{ changed: 1e12 }})]))"
    )
    page.click("#gallery")
    page.wait_for_selector("#drafts button")
    assert page.evaluate("new Date(1e12).toLocaleString()") in page.inner_text("#drafts")


@pytest.mark.parametrize("key", ["Enter", "Delete"])
def test_a_linkage_is_built_by_keys_on_its_handles(studio, key):  # noqa: F811
    page = studio("", **DESK).page
    page.click("text=empty linkage")
    settle(page)
    for x, name in ((-50, "pivot"), (50, "pivot")):
        tool(page, name)
        page.mouse.click(*on_stage(page, x, 0))
        settle(page)
    handles = page.locator('[data-handle^="point:"]')
    assert handles.count() == 2
    tool(page, "bar" if key == "Enter" else "move")
    for k in range(2):
        handles.nth(k if key == "Enter" else 0).focus()
        page.keyboard.press(key)
        settle(page)
    page.click('[data-view="text"]')
    text = page.input_value("#text textarea")
    assert ("crank" in text) == (key == "Enter") and handles.count() == (2 if key == "Enter" else 0)
