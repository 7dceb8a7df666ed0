"""A picture under the stage that is moved, scaled to a true length and outlined, and poses placed by clicks."""

import numpy as np
import pytest

import geomkin as gk

from .test_by_mouse import Builder, empty_stage, on_stage  # noqa: F401  the fixture
from .test_editor import PHONE, settle, studio, swipe  # noqa: F401  the fixture
from .test_pages import go_to

# A dark ellipse, 200 by 120 pixels, with its middle at (150, 110) of a light picture of 320 by 240, and a smaller spot.
DROP = """async () => {
    const canvas = document.createElement("canvas"), paper = canvas.getContext("2d");
    [canvas.width, canvas.height] = [320, 240];
    paper.fillStyle = "#d8d0c0"; paper.fillRect(0, 0, 320, 240);
    paper.fillStyle = "#304858"; paper.beginPath(); paper.ellipse(150, 110, 100, 60, 0, 0, 7); paper.fill();
    paper.fillRect(280, 200, 12, 12);
    const content = await new Promise((resolve) => canvas.toBlob(resolve, "image/png")), data = new DataTransfer();
    data.items.add(new File([content], "part.png", { type: "image/png" }));
    document.querySelector("#player .stage").dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true }));
}"""
ELLIPSE_AT, ACROSS, DOWN = (150, 110), 100, 60


def picture(page):
    """Scale, px per pixel of the picture, and the place of its upper left corner in the window, as it is drawn."""
    page.wait_for_selector(".photo[transform]")
    box = page.locator(".photo").bounding_box()
    return box["width"] / 320, np.array([box["x"], box["y"]])


def stroke(page, *places):
    page.mouse.move(*places[0])
    page.mouse.down()
    for place in places[1:]:
        page.mouse.move(*place, steps=3)
    page.mouse.up()


def mm_per_pixel(page):
    one, other = (np.array(on_stage(page, x, 0)) for x in (0, 1))
    return 1 / (other - one)[0]


def test_a_picture_is_scaled_by_a_true_length_and_its_outline_is_the_wanted_path(empty_stage):  # noqa: F811
    page = empty_stage().page
    sent = []
    page.on("request", lambda request: sent.append(request))
    page.evaluate(DROP)
    scale, at = picture(page)
    assert page.get_attribute('[data-tool="photo"]', "aria-pressed") == "true"
    # It is moved, and enlarged by a corner about the opposite one.
    stroke(page, at + scale * np.array([160, 60]), at + scale * np.array([160, 60]) + np.array([30, -20]))
    assert picture(page)[1] == pytest.approx(at + np.array([30, -20]), abs=1)
    scale, at = picture(page)
    stroke(page, at + scale * np.array([320, 240]), at + 0.7 * scale * np.array([320, 240]))
    assert picture(page)[0] == pytest.approx(0.7 * scale, rel=0.01)
    assert picture(page)[1] == pytest.approx(at, abs=1)
    # A line across the ellipse is 50 mm long: then the ellipse is 50 by 30 mm.
    scale, at = picture(page)
    page.click('button:text-is("True length")')
    stroke(page, *(at + scale * np.array([x, ELLIPSE_AT[1]]) for x in (50, 250)))
    page.fill(".length", "5 cm")
    page.keyboard.press("Enter")
    scale, at = picture(page)
    assert scale * mm_per_pixel(page) == pytest.approx(0.25, rel=0.02)
    middle = (at + scale * np.array(ELLIPSE_AT) - on_stage(page, 0, 0)) * mm_per_pixel(page) * [1, -1]
    wanted = lambda request: "/answer" in request.url and '"draw"' in (request.post_data or "")  # noqa: E731
    with page.expect_request(wanted, timeout=60_000) as drawn:
        page.click('button:text-is("Outline")')
    points = np.array(drawn.value.post_data_json["draw"]["points"]) @ [1, 1j]
    turn = np.linspace(0, 2 * np.pi, 400)
    ellipse = complex(*middle) + 0.25 * (ACROSS * np.cos(turn) + 1j * DOWN * np.sin(turn))
    away = np.abs(points[:, None] - ellipse)
    assert max(away.min(axis=0).max(), away.min(axis=1).max()) < 0.6
    assert page.locator("#known button").count() >= 4
    # It stays under the linkage, and nothing of it was sent.
    page.click("#known button >> nth=0")
    page.wait_for_selector("#tools [data-tool=bar]")
    assert page.locator(".photo[href]").count() == 1
    assert {request.method for request in sent if "/answer" not in request.url and "/nearest" not in request.url} <= {
        "GET"
    }
    assert not any("image" in (request.post_data or "") or len(request.post_data or "") > 60_000 for request in sent)
    page.click('[data-tool="photo"]')
    page.click('button:text-is("Remove")')
    assert not page.locator(".photo[href]").count() and page.is_hidden('button:text-is("Outline")')


def test_a_picture_is_moved_by_keys_and_traced(empty_stage):  # noqa: F811
    page = empty_stage().page
    page.set_input_files("input[type=file]", {"name": "a.txt", "mimeType": "image/png", "buffer": b"no picture"})
    page.wait_for_selector('#status:has-text("cannot read")')
    page.evaluate(DROP)
    scale, at = picture(page)
    page.focus(".tool-layer")
    for key in ("ArrowRight", "ArrowUp", "+"):
        page.keyboard.press(key)
    moved, corner = picture(page)
    assert moved == pytest.approx(1.05 * scale, rel=1e-3)
    assert corner + moved * np.array([160, 120]) == pytest.approx(
        at + scale * np.array([160, 120]) + np.array([10, -10]), abs=1
    )
    # The length of its width.
    page.focus('button:text-is("True length")')
    page.keyboard.press("Enter")
    page.keyboard.type("80")
    page.keyboard.press("Enter")
    page.click('[data-tool="path"]')
    scale, at = picture(page)
    assert 320 * scale * mm_per_pixel(page) == pytest.approx(80, rel=0.02)
    # A stroke over it is the path.
    turn = np.linspace(0, 6.2, 60)
    rim = at + scale * (np.array(ELLIPSE_AT) + np.transpose([ACROSS * np.cos(turn), DOWN * np.sin(turn)]))
    wanted = lambda request: "/answer" in request.url and '"draw"' in (request.post_data or "")  # noqa: E731
    with page.expect_request(wanted, timeout=60_000) as drawn:
        stroke(page, *rim)
    xs, ys = np.array(drawn.value.post_data_json["draw"]["points"]).T
    assert np.ptp(xs) == pytest.approx(80 * 2 * ACROSS / 320, rel=0.03)
    assert np.ptp(ys) == pytest.approx(80 * 2 * DOWN / 320, rel=0.03)
    page.click("#stop")


def test_three_clicks_are_poses_of_a_body_that_are_moved_turned_and_taken_away(empty_stage):  # noqa: F811
    hand = empty_stage()
    page = hand.page
    hand.use("pose", (-40, 0))
    for place, to in (((0, 40), (12, 52)), ((60, 30), (60, 60))):
        stroke(page, *(on_stage(page, *z) for z in (place, to)))
    page.wait_for_selector("body:not(.unchecked) #candidates button", timeout=60_000)
    assert page.locator(".tool-layer .copy:not(.carried)").count() == 3
    # The outline is drawn in the pose that is turned by 90 deg, and moves with the body.
    page.click("text=Draw the outline")
    stroke(page, *(on_stage(page, 60 + u, 30 + v) for u, v in ((0, 0), (0, 20), (-8, 20), (-8, 0), (-1, 0))))
    for k, corners in ((0, [(-40, 8), (-20, 0)]), (2, [(52, 50), (60, 30)])):
        box, (upper, lower) = page.locator(f".copy >> nth={k}").bounding_box(), (on_stage(page, *z) for z in corners)
        ends = [box["x"], box["y"], box["x"] + box["width"], box["y"] + box["height"]]
        assert ends == pytest.approx([*upper, *lower], abs=4)
    go_to(page, 0)
    first = page.get_attribute(".carried", "d")
    go_to(page, 60)
    assert page.get_attribute(".carried", "d") != first
    # A handle of a pose lies above the layer that takes clicks.
    handle = "point:wanted.poses[1][2]"
    hand.drag(handle, -10, 10)
    hand.use("pose", (90, -10))
    page.wait_for_selector("body:not(.unchecked) .cross")
    assert page.locator(".copy:not(.carried)").count() == 4
    page.focus('[data-handle="point:wanted.poses[0][0]"]')
    page.keyboard.press("Delete")
    settle(page)
    assert page.locator(".copy:not(.carried)").count() == 3 and not page.locator(".cross").count()
    page.keyboard.press("Control+z")
    settle(page)
    x, y = (box := page.locator("circle.cross >> nth=3").bounding_box())["x"], box["y"]
    page.mouse.click(x + 9, y + 9)
    settle(page)
    recipe = hand.kept("body-guidance")
    (at, angle), (second, turned), (third, up) = recipe.wanted.pairs
    assert np.abs(np.array([at, second, third]) - [-40, 40j, 60 + 30j]).max() < 1
    assert np.degrees([angle, up]) == pytest.approx([0, 90], abs=2) and 50 < np.degrees(turned) < 90
    motion = gk.move(recipe.found.linkage, recipe.found.drive, recipe.found.branch)
    assert np.allclose(motion.point("coupler_point").position, [at, second, third], atol=0.01)


def test_a_finger_and_keys_place_poses(studio):  # noqa: F811
    page = studio("", **PHONE).page
    page.tap("text=empty linkage")
    page.wait_for_selector('[data-tool="pivot"][aria-pressed="true"]')
    page.tap('[data-tool="pose"]')
    box = page.locator(".tool-layer").bounding_box()
    page.touchscreen.tap(box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"])
    assert page.locator(".copy").count() == 1
    x, y = box["x"] + 0.7 * box["width"], box["y"] + 0.6 * box["height"]
    swipe(page, (x, y), (x, y - 40))
    assert page.locator(".copy").count() == 2
    # Turned upwards.
    outline = page.locator(".copy >> nth=1").bounding_box()
    assert outline["height"] > 1.3 * outline["width"]
    page.click('[data-tool="move"]')
    page.evaluate(DROP)
    scale, at = picture(page)
    swipe(page, at + scale * np.array([160, 100]), at + scale * np.array([160, 100]) + np.array([20, 30]))
    assert picture(page)[1] == pytest.approx(at + np.array([20, 30]), abs=1.5) and page.evaluate("scrollY") == 0
    page.tap('[data-tool="pose"]')
    page.focus(".tool-layer")
    page.keyboard.press("Enter")
    assert page.locator(".copy").count() >= 1
    page.keyboard.press("Escape")
    assert page.locator(".copy").count() == 0
