"""The studio in a real browser: what is dragged or typed is what is shown, and what is saved."""

import threading
from pathlib import Path
from types import SimpleNamespace
from zipfile import ZipFile

import numpy as np
import pytest

import geomkin as gk
from geomkin.page.page import scene_data
from geomkin.studio.server import StudioServer
from geomkin.studio.service import Studio
from geomkin.studio.workspace import Workspace

RECIPES = Path(__file__).parent.parent.parent / "recipes"
FOUR_BAR = """# A comment at the top.
kind = "four-bar"

[linkage]  # lengths in mm
ground = 100
crank = 30.00  # driven
coupler = 90
rocker = 70
coupler_point = [40, 25]  # the pen
"""
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}


@pytest.fixture
def studio(chromium, tmp_path):
    """Opens the studio with a recipe's text; afterwards its console must be empty."""
    # A save that is refused is no fault of the page.
    ended, said, allowed = [], [], ["409 (Conflict)"]

    def start(text, reduced_motion="reduce", **options):
        file = tmp_path / "it.toml"
        file.write_text(text)
        server = StudioServer(Studio(Workspace(tmp_path), "it" if text else ""), 18300)
        threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
        context = chromium.new_context(reduced_motion=reduced_motion, **options)
        page = context.new_page()
        ended.append(lambda: (context.close(), server.shutdown(), server.server_close()))
        answers = []
        page.on("console", lambda message: said.append(message.text) if message.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on(
            "response", lambda reply: answers.append(reply) if "/answer" in reply.url or "/job" in reply.url else None
        )
        page.goto(server.url)
        page.wait_for_selector("body[data-checked]" if text else "dialog[open] .card")
        return SimpleNamespace(page=page, answers=answers, file=file, server=server, allowed=allowed)

    yield start
    for end in ended:
        end()
    assert not [message for message in said if not any(words in message for words in allowed)]


def settle(page):
    page.wait_for_timeout(30)
    page.wait_for_selector("body:not(.solving)")


def value(page, key):
    return float(page.input_value(f'[name="{key}"]'))


def centre(page, handle):
    box = page.locator(f'[data-handle="{handle}"] .knob').bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(page, handle, right, up):
    x, y = centre(page, handle)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + right, y - up, steps=4)
    page.mouse.up()
    settle(page)


def swipe(page, start, end):
    """A finger on the screen."""
    finger = page.context.new_cdp_session(page)
    places = [[a + share * (b - a) for a, b in zip(start, end)] for share in (0, 1 / 3, 2 / 3, 1)]
    for k, (x, y) in enumerate(places):
        points = [{"x": float(x), "y": float(y)}]
        finger.send("Input.dispatchTouchEvent", {"type": "touchMove" if k else "touchStart", "touchPoints": points})
    finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    settle(page)


def fill(page, key, text):
    page.fill(f'[name="{key}"]', text)
    assert page.is_enabled("#undo")
    page.dispatch_event(f'[name="{key}"]', "change")
    settle(page)


def save(editor):
    """Saves by the keyboard and holds that the saved recipe, run anew, is what is shown; returns its text."""
    page = editor.page
    plates = page.eval_on_selector_all("#player .plate", "plates => plates.map(plate => plate.getAttribute('d'))")
    page.keyboard.press("Control+s")
    page.wait_for_selector("#dirty", state="hidden")
    settle(page)
    # The answer of a search is the result of its job.
    answers = [reply.json() for reply in editor.answers]
    scenes = [scene for answer in answers if (scene := (answer.get("result") or answer).get("scene"))]
    text = editor.file.read_text()
    run = scene_data(gk.load(editor.file).scene, "it")
    assert scenes[-1] == run
    assert plates and set(plates) <= set(run["paths"])
    return text


def test_a_dragged_pin_follows_the_mouse_is_undone_and_saved_with_all_comments(studio):
    editor = studio(FOUR_BAR)
    page = editor.page
    x, y = centre(page, "point:rocker_pin")
    drag(page, "point:rocker_pin", 24, 16)
    there = centre(page, "point:rocker_pin")
    assert abs(there[0] - x - 24) < 2 and abs(there[1] - y + 16) < 2
    lengths = [value(page, key) for key in ("linkage.coupler", "linkage.rocker")]
    assert lengths[0] != 90 and lengths[1] != 70
    assert page.get_attribute('[data-handle="point:rocker_pin"]', "data-keys") == "linkage.coupler|linkage.rocker"

    page.keyboard.press("Control+z")
    settle(page)
    assert (value(page, "linkage.coupler"), value(page, "linkage.rocker")) == (90, 70)
    assert page.is_hidden("#dirty") and page.is_disabled("#undo")
    page.keyboard.press("Control+y")
    settle(page)
    assert [value(page, key) for key in ("linkage.coupler", "linkage.rocker")] == lengths

    lines = save(editor).splitlines()
    kept = FOUR_BAR.splitlines()
    changed = {k for k, line in enumerate(lines) if line != kept[k]}
    assert len(lines) == len(kept) and {kept[k] for k in changed} == {"coupler = 90", "rocker = 70"}


def test_a_finger_drags_on_a_phone(studio):
    page = studio(FOUR_BAR, **PHONE).page
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    x, y = centre(page, "point:coupler_point")
    swipe(page, (x, y), (x + 12, y - 12))
    there = centre(page, "point:coupler_point")
    assert abs(there[0] - x - 12) < 2 and abs(there[1] - y + 12) < 2
    assert value(page, "linkage.coupler_point[0]") != 40 and page.evaluate("scrollY") == 0


def test_arrow_keys_move_a_handle_in_one_step_of_undo_and_a_lock_holds_it(studio):
    page = studio(FOUR_BAR).page
    handle = '[data-handle="point:coupler_point"]'
    x, _ = centre(page, "point:coupler_point")
    page.focus(handle)
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    settle(page)
    assert centre(page, "point:coupler_point")[0] > x + 6
    page.click("#undo")
    settle(page)
    assert value(page, "linkage.coupler_point[0]") == 40 and page.is_disabled("#undo")
    page.click('button[aria-label="Lock linkage.coupler_point"]')
    settle(page)
    page.focus(handle)
    page.keyboard.press("ArrowRight")
    settle(page)
    assert page.get_attribute(handle, "aria-disabled") == "true"
    assert value(page, "linkage.coupler_point[0]") == 40 and page.is_disabled("#undo")


def test_a_refused_value_leaves_the_last_good_mechanism_greyed(studio):
    editor = studio(FOUR_BAR)
    page = editor.page
    plates = page.inner_html("#player .stages")
    fill(page, "linkage.crank", "-3")
    assert page.inner_html("#player .stages") == plates
    assert float(page.eval_on_selector("#player .stages", "stages => getComputedStyle(stages).opacity")) < 1
    assert page.get_attribute('[name="linkage.crank"]', "aria-invalid") == "true"
    assert page.inner_text('.problem[data-of="linkage.crank"]') and page.input_value('[name="linkage.crank"]') == "-3"
    page.keyboard.press("Control+s")
    settle(page)
    assert editor.file.read_text() == FOUR_BAR
    page.click('button[aria-label^="Reset linkage.crank"]')
    settle(page)
    assert value(page, "linkage.crank") == 30 and not page.locator(".stale").count()
    fill(page, "linkage.crank", "31.5")
    assert not page.locator(".stale").count() and not page.get_attribute('[name="linkage.crank"]', "aria-invalid")
    assert "crank = 31.5  # driven" in save(editor)


@pytest.mark.parametrize(
    ("recipe", "key", "typed"),
    [
        ("walking-leg", "linkage.bodies.crank.M[0]", "14.5"),
        ("roller-cam", "cam.base_radius", "42"),
        ("gear-pair", "second.teeth", "25"),
        ("three-poses", "wanted.poses[1][0]", "-18"),
    ],
)
def test_a_typed_value_is_shown_and_saved(studio, recipe, key, typed):
    editor = studio((RECIPES / f"{recipe}.toml").read_text())
    fill(editor.page, key, typed)
    assert typed in save(editor) and value(editor.page, key) == float(typed)


def test_a_point_of_a_body_has_two_numbers_and_no_buttons_for_more(studio):
    page = studio((RECIPES / "walking-leg.toml").read_text()).page
    row = page.locator(".field", has=page.locator('[name="linkage.bodies.crank.M[0]"]'))
    assert row.locator("input").count() == 2 and not row.locator(".small-button").count()
    fill(page, "linkage.bodies.crank.M[1]", "1.5")
    assert value(page, "linkage.bodies.crank.M[1]") == 1.5 and value(page, "linkage.bodies.crank.M[0]") == 15


def test_a_machine_has_fields_for_its_mechanisms_and_for_the_recipes_in_it(studio, tmp_path):
    (tmp_path / "walker.toml").write_text((RECIPES / "walker.toml").read_text())
    editor = studio((RECIPES / "geared-legs.toml").read_text())
    page, module = editor.page, "mechanisms.train.recipe.train.module"
    fill(page, "mechanisms.right.phase_deg", "150")
    page.click('details[data-key="mechanisms.train.recipe.train"] summary')
    fill(page, module, "1.1")
    assert value(page, module) == 1.1 and not page.locator('[name^="mechanisms.left.recipe."]').count()
    # A value that the inner recipe refuses is reported at its field.
    fill(page, module, "-1")
    assert page.inner_text(f'.problem[data-of="{module}"]')
    page.click("#undo")
    settle(page)
    text = save(editor)
    assert "phase_deg = 150" in text and "module = 1.1" in text


def test_a_template_of_the_gallery_is_edited_and_saved_under_a_new_name(studio):
    editor = studio("")
    page = editor.page
    page.click('#kinds .card:has-text("pantograph")')
    page.wait_for_selector("body[data-checked]")
    page.keyboard.press("Control+s")
    page.fill("#file-name", "copy")
    page.keyboard.press("Enter")
    page.wait_for_selector("#dirty", state="hidden")
    assert gk.load(editor.file.with_name("copy.toml")).kind == "pantograph"


def test_the_template_that_was_chosen_last_is_shown(studio):
    """Whatever arrives late: the first of two templates, or the answer to the text before."""
    page = studio(FOUR_BAR).page
    page.evaluate("""() => {
        const fetched = window.fetch;
        window.fetch = async (path, options) => {
            const isLate = options?.body?.includes('"pantograph"') || (path === "answer" && options.body.includes("four-bar"));
            if (isLate) await new Promise((resolve) => { setTimeout(resolve, 250); });
            return fetched(path, options);
        };
    }""")
    page.fill('[name="linkage.crank"]', "31")
    for kind in ("pantograph", "scotch-yoke"):
        page.click("#new")
        page.click(f'#kinds .card:has(b:text-is("{kind}"))')
    page.wait_for_timeout(600)
    settle(page)
    assert page.text_content("#name") == "new scotch-yoke"
    assert page.locator('[name="linkage.crank"]').count() and not page.locator('[name="linkage.rocker"]').count()


def test_a_link_holds_the_recipe_that_is_shown(studio):
    text = FOUR_BAR.replace("A comment", "Größe ½, ein Kommentar")
    editor = studio(text, permissions=["clipboard-read", "clipboard-write"])
    page = editor.page
    page.fill('[name="linkage.crank"]', "31")
    settle(page)
    page.click("#share summary")
    page.click("#share-link")
    page.wait_for_selector('#status:has-text("copied")')
    link = page.evaluate("navigator.clipboard.readText()")
    # It holds no secret, and leads to this studio, or to another one of this browser on the same port.
    assert link.startswith(f"http://127.0.0.1:{editor.server.server_port}/open#recipe=")
    here = link.replace("/open", f"/{editor.server.token}/")
    # In a page that is loaded with it, and in one that is open already.
    for act in (
        lambda: (page.goto("about:blank"), page.goto(link)),
        lambda: page.evaluate("link => location.assign(link)", here),
    ):
        act()
        page.wait_for_selector('#name:has-text("new four-bar")')
        settle(page)
        assert value(page, "linkage.crank") == 31 and "#" not in page.url and page.is_visible("#dirty")
        page.keyboard.press("Control+s")
        page.fill("#file-name", f"copy{len(list(editor.file.parent.iterdir()))}")
        page.keyboard.press("Enter")
        page.wait_for_selector("#dirty", state="hidden")
    saved = [file.read_text() for file in editor.file.parent.glob("copy*.toml")]
    assert saved == [text.replace("30.00", "31")] * 2


def test_a_link_without_a_studio_says_what_to_do(studio):
    editor = studio(FOUR_BAR)
    page, other = editor.page, editor.page.context.browser.new_context().new_page()
    other.goto(f"http://127.0.0.1:{editor.server.server_port}/open#recipe=a2luZA")
    other.wait_for_selector('#said:has-text("geomkin studio")')
    # A token that is no longer right is not followed either.
    page.evaluate("localStorage.setItem('geomkin-studio', '/gone/')")
    editor.allowed.append("404 (Not Found)")
    page.goto(f"http://127.0.0.1:{editor.server.server_port}/open#recipe=a2luZA")
    page.wait_for_selector('#said:has-text("geomkin studio")')
    other.context.close()


@pytest.mark.parametrize("recipe", ["wiper", "double-rocker"])
def test_a_click_or_enter_on_the_plot_of_a_family_chooses_the_free_angle(studio, recipe):
    # A rank is given, and is replaced by the angle.
    editor = studio((RECIPES / f"{recipe}.toml").read_text().replace("\n[", "\nchoose = 2\n[", 1))
    page, key = editor.page, "wanted.free_angle_deg"
    plot = page.locator('#choice [role="slider"]').first
    plot.scroll_into_view_if_needed()
    family = gk.load(editor.file).found.family
    assert page.input_value(f'[name="{key}"]') == ""
    box = plot.bounding_box()
    page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    settle(page)
    clicked, gap = value(page, key), np.diff(family.free_angle_deg).max()
    assert np.abs(family.free_angle_deg - clicked).min() < 0.5 * gap
    low, high = np.sort(family.free_angle_deg)[[0, -1]]
    assert low < clicked < high and abs(clicked - (low + 0.6 * (high - low))) < 0.1 * (high - low)

    # The focus stays on the plot, on which the arrows go to the next members.
    for name in ("ArrowRight", "ArrowRight", "Enter"):
        page.keyboard.press(name)
    settle(page)
    assert clicked < value(page, key) <= clicked + 2.5 * gap
    text = save(editor)
    assert "choose" not in text and gk.load(editor.file).found.free_angle_deg == pytest.approx(
        value(page, key), abs=gap
    )
    assert gk.load(editor.file).ranked[0].free_angle_deg == pytest.approx(value(page, key), abs=1e-9)
    for _ in range(2):
        page.click("#undo")
        settle(page)
    assert page.input_value(f'[name="{key}"]') == "" and page.input_value('[name="choose"]') == "2"


def test_a_click_on_the_plot_of_the_linkages_through_poses_chooses_a_rank(studio):
    editor = studio((RECIPES / "three-poses.toml").read_text())
    page, ranked = editor.page, gk.load(editor.file).ranked
    plot = page.locator('#choice [role="slider"]').first
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    settle(page)
    clicked = value(page, "choose")
    assert clicked.is_integer() and abs(clicked - (1 + len(ranked)) / 2) <= 1
    for name in ("ArrowRight", "Enter"):
        page.keyboard.press(name)
    settle(page)
    assert value(page, "choose") == clicked + 1
    assert f"choose = {clicked + 1:.0f}\n" in save(editor)
    found, chosen = gk.load(editor.file).found, ranked[int(clicked)]
    assert found.transmission_angle_deg == pytest.approx(chosen.transmission_angle_deg, abs=0.01)


def test_a_click_on_a_picture_chooses_a_linkage(studio):
    editor = studio((RECIPES / "poses-by-crank.toml").read_text())
    page = editor.page
    page.wait_for_selector("#candidates button")
    page.click("#candidates button >> nth=2")
    settle(page)
    page.wait_for_selector("#candidates button:nth-child(3)[aria-pressed=true]")
    assert value(page, "choose") == 3 and "choose = 3" in save(editor)


def test_arithmetic_and_units_are_typed(studio):
    editor = studio(FOUR_BAR)
    page = editor.page
    typed_numbers = {
        "2*15.5": 31,
        "(10 + 52)/2": 31,
        "3.2 cm": 32,
        "1/4 in + 25 mm": 31.35,
        "(20 mm + 1e1)*(3 cm)/(30 mm)": 30,
    }
    for typed, number in typed_numbers.items():
        fill(page, "linkage.crank", typed)
        assert value(page, "linkage.crank") == pytest.approx(number)
    fill(page, "linkage.ground_angle_deg", "0.5 rad")
    assert value(page, "linkage.ground_angle_deg") == pytest.approx(np.degrees(0.5))
    fill(page, "drive.start_deg", "180° - 1 rad*3/3 - 90/2 deg")
    assert value(page, "drive.start_deg") == pytest.approx(135 - np.degrees(1))
    wrong_of = {
        "linkage.crank": "2*|3 deg|0.5 rad|alert(1)|1 2|30 mm mm|(30 mm) mm|3 mm * 10 mm|30/(1 mm)|30 N",
        "drive.start_deg": "10 mm",
        "drive.speed_rpm": "60 deg",
    }
    for key, wrong in ((key, wrong) for key, texts in wrong_of.items() for wrong in texts.split("|")):
        fill(page, key, wrong)
        assert page.locator(".field.wrong").count() == 1
        # What is advised is taken.
        advised = page.inner_text(".field.wrong .problem").split(" or ")[-1]
        fill(page, key, advised)
        assert value(page, key) > 0 and not page.locator(".field.wrong").count()


def test_escape_cancels_a_drag(studio):
    page = studio(FOUR_BAR).page
    x, y = centre(page, "point:rocker_pin")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 30, y - 10, steps=3)
    page.keyboard.press("Escape")
    page.mouse.move(x + 40, y)
    page.mouse.up()
    settle(page)
    assert value(page, "linkage.coupler") == 90 and page.is_disabled("#undo") and page.is_hidden("#dirty")


def test_unsaved_changes_are_offered_again(studio):
    editor = studio(FOUR_BAR)
    page = editor.page
    fill(page, "linkage.crank", "33")
    page.on("dialog", lambda dialog: dialog.accept())
    page.reload()
    page.wait_for_selector("#conflict button")
    assert value(page, "linkage.crank") == 30
    page.click('#conflict button:has-text("Continue")')
    settle(page)
    assert value(page, "linkage.crank") == 33 and page.is_visible("#dirty")
    # A template that is opened instead loses nothing either.
    page.click("#new")
    page.click('#kinds .card:has-text("pantograph")')
    page.wait_for_selector('#name:has-text("new pantograph")')
    settle(page)
    page.click("#gallery")
    page.click("#drafts button >> nth=0")
    page.wait_for_selector('#name:text-is("it")')
    settle(page)
    assert value(page, "linkage.crank") == 33


def test_save_never_overwrites_a_change_of_another_program(studio):
    editor = studio(FOUR_BAR)
    page = editor.page
    fill(page, "linkage.crank", "33")
    other = FOUR_BAR + "# by another program\n"
    editor.file.write_text(other)
    page.wait_for_selector("#conflict button")
    for _ in range(2):
        page.keyboard.press("Control+s")
        settle(page)
        assert editor.file.read_text() == other
    page.click('#conflict button:has-text("Overwrite")')
    page.wait_for_selector("#dirty", state="hidden")
    assert "crank = 33" in editor.file.read_text()


def test_every_button_adds_a_table_or_gives_the_reason(studio):
    page = studio(FOUR_BAR).page
    tried = set()
    while new := [
        key
        for key in page.eval_on_selector_all("#form [data-add]", "all => all.map(button => button.dataset.add)")
        if key not in tried
    ]:
        tried.add(new[0])
        page.evaluate("for (const group of document.querySelectorAll('#form details')) group.open = true")
        page.click(f'[data-add="{new[0]}"]')
        settle(page)
        page.wait_for_selector("body:not(.solving)")
        assert not page.locator(".stale").count() and not page.locator(".field.wrong").count()
        is_there = page.locator(f'#form details[data-key^="{new[0]}"]').count() > 0
        assert is_there or page.is_visible("#limit"), new[0]
    assert {"loads", "loads.forces", "loads.springs", "tolerances", "copies", "dwell"} < tried
    page.select_option('[name="stock.motor"]', '"nema17"')
    settle(page)
    assert page.locator(".face circle").count() > 4 and not page.locator(".stale").count()


def test_a_table_of_defaults_is_removed_once(studio):
    editor = studio(FOUR_BAR + "[drive]\n# Nothing else.\n\n[files.title]\n")
    page = editor.page
    page.evaluate("for (const group of document.querySelectorAll('#form details')) group.open = true")
    for left in (["files", "files.title"], []):
        page.click("#form .remove >> nth=0")
        settle(page)
        parts = page.locator("#form details:has(> .remove)")
        assert parts.evaluate_all("all => all.map(part => part.dataset.key)") == left
    assert save(editor).strip() == FOUR_BAR.strip()


def test_the_gallery_is_searched_by_words(studio):
    page = studio("").page
    page.wait_for_selector("#examples .card")
    page.fill("#search", "walking leg")
    assert 1 <= page.locator(".card:visible").count() < 12
    page.fill("#search", "xyzzy quux")
    assert page.is_visible("#no-match") and not page.locator(".card:visible").count()
    page.fill("#search", "cam")
    assert page.locator('#kinds .card:visible:has-text("disk-cam")').count()
    # A wish, also by other names of a kind, or of which nothing has all words.
    for wish, kind in (
        ("something that dwells", "stephenson-six-bar"),
        ("an epicyclic", "planetary"),
        ("xyzzy epicyclic gears", "planetary"),
    ):
        page.fill("#search", wish)
        assert page.locator(f'#kinds .card:visible:has(b:text-is("{kind}"))').count() == 1
        assert page.locator("#kinds .card:visible").count() < 6
        assert page.is_visible("#no-match") == ("xyzzy" in wish)
    for wish, most in (("windscreen wiper", 4), ("xyzzy gears", 0)):
        page.fill("#search", wish)
        names = page.locator(".card:visible b").all_inner_texts()
        assert len(names) <= most and ("wiper" in names) == (most > 0)
    # A recipe of the gallery is a new one, without a file.
    page.fill("#search", "klann")
    page.click("#examples .card:visible >> nth=0")
    page.wait_for_selector("body[data-checked]")
    assert page.text_content("#name") == "new klann" and page.locator("#player .plate").count() >= 5


def test_the_recipes_that_were_opened_last_are_first_and_move_under_the_pointer(studio):
    editor = studio("")
    page = editor.page
    for name in ("a", "b", "c"):
        editor.file.with_name(f"{name}.toml").write_text(FOUR_BAR)
    for name in ("b", "c"):
        page.reload()
        page.click(f'#folder .card:has(b:text-is("{name}"))')
        page.wait_for_selector("body[data-checked]")
    page.emulate_media(reduced_motion="no-preference")
    page.click("#gallery")
    page.wait_for_selector("#gallery-dialog[open]")
    cards = page.locator("#folder .card")
    assert cards.locator("b").all_inner_texts()[:3] == ["c", "b", "a"]
    image = cards.nth(1).locator("img")
    shown = """(image) => new Promise((resolve) => {
        const look = () => (image.complete && image.src ? resolve([image.src, image.naturalWidth]) : setTimeout(look, 20));
        look();
    })"""
    address, width = image.evaluate(shown)
    assert "moving" not in address and width > 0
    with page.expect_response(lambda reply: "moving" in reply.url) as moving:
        cards.nth(1).hover()
    assert "@keyframes" in moving.value.text()
    page.focus("#search")
    page.mouse.move(0, 0)
    assert image.evaluate(shown)[0] == address
    # Not for those who want no motion.
    page.emulate_media(reduced_motion="reduce")
    cards.nth(1).hover()
    assert image.evaluate(shown)[0] == address


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1280, 720)])
def test_nothing_is_below_the_fold_of_a_desk(studio, width, height):
    page = studio(FOUR_BAR, viewport={"width": width, "height": height}).page
    assert page.evaluate("document.documentElement.scrollHeight") <= height
    for part in (".stages", ".drive input", "#player .chart >> nth=0", "#form"):
        assert 0 <= page.locator(part).bounding_box()["y"] < height - 100
    low = page.locator(".stages").bounding_box()["height"]
    for panel in ("plots", "form"):
        page.click(f"[data-panel={panel}]")
    box = page.locator(".stages").bounding_box()
    assert box["height"] > low + 100 and box["width"] > 0.95 * width
    assert box["width"] * box["height"] > 0.6 * width * height


def test_a_family_of_solutions_leaves_the_drawing_its_height(studio):
    page = studio((RECIPES / "three-poses.toml").read_text(), viewport={"width": 1280, "height": 720}).page
    parts = [".stages", ".controls", ".switches", "#player .right", "#choice"]
    for width, height in ((1280, 720), (1366, 768), (1440, 900)):
        page.set_viewport_size({"width": width, "height": height})
        stage, controls, switches, plots, family = (page.locator(part).bounding_box() for part in parts)
        assert stage["height"] > 0.4 * height
        # One below the other, the family beside the plots.
        for above, below in ((stage, controls), (controls, switches), (switches, plots), (switches, family)):
            assert above["y"] + above["height"] <= below["y"]
        assert plots["x"] + plots["width"] < family["x"]
        assert max(box["y"] + box["height"] for box in (plots, family)) <= height
        page.locator("#player .more").scroll_into_view_if_needed()
        more = page.locator("#player .more").bounding_box()
        assert plots["y"] <= more["y"] and more["y"] + more["height"] <= height


def test_plots_of_another_recipe_are_different_ones(studio):
    page = studio((RECIPES / "crank-rocker.toml").read_text()).page

    def shown():
        chosen = "all => all.map(select => select.selectedOptions[0].textContent)"
        return page.eval_on_selector_all(".right .plot select", chosen)

    for name in ("roller-cam", "gear-pair", "crank-rocker"):
        page.click("#new")
        page.click(f'#examples .card:has(b:text-is("{name}"))')
        page.wait_for_selector(f'#name:has-text("new {name}")')
        page.wait_for_selector("body[data-checked]")
        settle(page)
        assert len(shown()) == 2 and len({*shown()}) == 2, name
    page.select_option(".right .plot select >> nth=0", index=2)
    kept = shown()[0]
    fill(page, "linkage.crank", "45")
    assert shown()[0] == kept and shown()[1] != kept


def test_a_drag_crosses_a_change_point(studio):
    page = studio(FOUR_BAR).page
    assert not page.locator(".limited").count()
    drag(page, "point:crank_pin", 130, 0)
    settle(page)
    crank = value(page, "linkage.crank")
    # Longer than Grashof's condition allows for a crank that turns fully.
    assert crank > 60 and page.locator(".drive .limited").count() == 1
    assert "crank-rocker" not in page.inner_text("#quantities tr >> nth=0")


def test_an_open_page_goes_on_after_a_restart_of_the_server(studio, tmp_path):
    editor = studio(FOUR_BAR)
    page, old = editor.page, editor.server
    editor.allowed.append("ERR_CONNECTION_REFUSED")
    fill(page, "linkage.crank", "33")
    old.shutdown()
    old.server_close()
    new = StudioServer(Studio(Workspace(tmp_path), "it"), old.server_port, token=old.token)
    thread = threading.Thread(target=new.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    assert new.url == old.url
    page.wait_for_timeout(200)
    fill(page, "linkage.crank", "34")
    page.keyboard.press("Control+s")
    page.wait_for_selector("#dirty", state="hidden")
    assert "crank = 34" in editor.file.read_text()
    page.context.close()
    new.shutdown()
    new.server_close()


def test_a_recipe_is_taken_away_as_python_and_as_zip(studio):
    editor = studio(FOUR_BAR + '# "quoted", a \\\\ and ü\n', accept_downloads=True)
    page = editor.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.click("#share summary")
    page.click("#share-python")
    page.wait_for_selector('#status:has-text("copied")')
    script = page.evaluate("navigator.clipboard.readText()").replace('gk.make(recipe, "out")', "")
    names = {}
    exec(script, names)
    assert names["recipe"].linkage == gk.load(editor.file).linkage
    page.click("#share summary")
    with page.expect_download() as download:
        page.click("#share-zip")
    with ZipFile(download.value.path()) as archive:
        assert {"it.svg", "it.html", "summary.json"} & set(archive.namelist()) and archive.testzip() is None


def test_a_length_is_clicked_on_the_drawing_and_typed(studio):
    page = studio(FOUR_BAR).page
    page.check('input[name="dimension"]')
    for typed, expected in [("2*16", 32), ("1.5 in", 38.1)]:
        text = page.locator('[data-dimension="1"]')
        box = text.bounding_box()
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.keyboard.type(typed)
        page.keyboard.press("Enter")
        settle(page)
        assert value(page, "linkage.crank") == expected
        assert page.locator("input.length").count() == 0
    page.keyboard.press("Control+z")
    settle(page)
    assert value(page, "linkage.crank") == 32


def test_a_handle_beside_what_it_moves_has_a_line_to_it(studio):
    page = studio(FOUR_BAR).page
    box = page.locator('[data-handle="origin:ground"] .leash').bounding_box()
    pivot = centre(page, "point:rocker_pivot")
    length = [box["x"] + box["width"], box["y"]]
    # It ends at the pivot of the crank, 100 mm left of that of the rocker.
    scale = page.evaluate("document.querySelector('#player .world').transform.baseVal.consolidate().matrix.a")
    assert abs(length[0] - (pivot[0] - 100 * scale)) < 2 and abs(length[1] - pivot[1]) < 2
    assert page.locator('[data-handle="point:rocker_pin"] .leash').count() == 0
