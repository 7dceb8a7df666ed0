"""Previews of linkages in the browser agree with the library, keep their assembly mode, and show gaps."""

import json
from pathlib import Path

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.errors import GeomkinError
from geomkin.recipe.keys import with_values
from geomkin.recipe.load import from_table, shown_numbers
from geomkin.recipe.recipe import AbstractGoal
from geomkin.recipe.toml import parsed
from tests.browser.test_editor import FOUR_BAR, centre, drag, settle, studio, value  # noqa: F401  a fixture
from tests.campaign import by_default

RECIPES = Path(__file__).parent.parent.parent / "recipes"
# Width of a drawing, px, and the share by which each length changes at once: about 6 px of the longest link.
WIDE, CHANGE = 600, 0.01


def previewed():
    for file in sorted(RECIPES.glob("*.toml")):
        recipe = gk.load(file)
        if not isinstance(recipe, AbstractGoal) and recipe.preview(False):
            yield file.stem


def poses_of(recipe, frames):
    bodies = [recipe.motion.bodies[name] for name in recipe.preview(False)["bodies"]]
    rows = [np.stack([b.origin.position.real, b.origin.position.imag, np.angle(b.direction)]) for b in bodies]
    known = np.where(recipe.motion.assembled, np.stack(rows), np.nan)[..., frames]
    return [
        [[None if np.isnan(x) else x for x in pose] for pose in frame] for frame in known.transpose(2, 0, 1).tolist()
    ]


def changes_of(name):
    """A recipe, and each of its first lengths changed by a little: the key, the change, and the recipe with it.

    Without changes of the Grashof type: at a change point two assembly modes meet.
    """
    file = RECIPES / f"{name}.toml"
    table, recipe = parsed(file.read_text()), gk.load(file)
    lengths = [n for n in shown_numbers(recipe) if n.key.startswith("linkage.") and n.unit == "mm" and n.value]
    for number in lengths[:8]:
        change = CHANGE * number.value
        try:
            changed = from_table(with_values(table, {number.key: number.value + change}), "recipe", {})
            is_same = recipe.quantities.get("Grashof type") == changed.quantities.get("Grashof type")
        except GeomkinError:
            continue
        if is_same:
            yield recipe, number.key, change, changed


FOLLOW = """async (cases) => {
    const { Linkage } = await import("./editor/preview.js");
    return cases.map(({ preview, poses, exact, key, change }) => {
        const linkage = new Linkage(preview, poses.map((frame) => frame.map((pose) => pose.map((x) => x ?? NaN))));
        const numbers = linkage.changed({ [key]: change });
        return exact.map((frame, k) => {
            const base = linkage.baseAt(k);
            if (!base || frame[0][0] === null) return 0;
            const found = linkage.follow(numbers, base, base);
            if (!found) return null;
            const off = linkage.points.map((_, index) => {
                const [a, b] = [found, frame].map((held) => linkage.place(index, numbers, held));
                return Math.hypot(a[0] - b[0], a[1] - b[1]);
            });
            return Math.max(...off) / linkage.size;
        });
    });
}"""


NAMES = list(previewed())


@pytest.mark.parametrize("name", by_default(NAMES, ["crank-rocker", "inch-wiper", "sieve", "shaper", "walker"]))
def test_a_preview_agrees_with_the_library_to_a_tenth_of_a_pixel(studio, name):  # noqa: F811
    page, cases = studio(FOUR_BAR).page, []
    for recipe, key, change, changed in changes_of(name):
        frames = np.linspace(0, len(recipe.motion.drive) - 1, 13).astype(int)
        exact, poses = poses_of(changed, frames), poses_of(recipe, frames)
        cases.append({"preview": recipe.preview(), "poses": poses, "exact": exact, "key": key, "change": change})
    off = page.evaluate(FOLLOW, json.loads(json.dumps(cases, default=float)))
    # Every length of the rolling ellipses keeps them at a change point.
    assert off or name == "rolling-ellipses"
    assert all(x is not None and x * WIDE < 0.1 for row in off for x in row)


def test_the_drawing_follows_the_pointer_before_the_answer_comes(studio):  # noqa: F811
    page = studio(FOUR_BAR).page
    page.evaluate("""() => {
        const fetched = window.fetch;
        window.fetch = async (path, options) => {
            if (path === "answer") await new Promise((resolve) => { setTimeout(resolve, 1500); });
            return fetched(path, options);
        };
    }""")
    trail = page.locator(".trail.traced").first.get_attribute("d")
    x, y = centre(page, "point:rocker_pin")
    page.mouse.move(x, y)
    page.mouse.down()
    for step in (6, 12, 18):
        page.mouse.move(x + step, y - step)
        at = centre(page, "point:rocker_pin")
        assert np.hypot(at[0] - x - step, at[1] - y + step) < 0.5
    # The pin of the drawing is there too, and the text is not yet changed.
    pin = page.locator('.mark.pin:has(title:text-is("rocker pin"))').first.bounding_box()
    assert np.hypot(pin["x"] + pin["width"] / 2 - x - 18, pin["y"] + pin["height"] / 2 - y + 18) < 1
    # The plate of 70 mm is stretched to it, and the path of the coupler point is another one.
    pivot, stretched = centre(page, "point:rocker_pivot"), page.locator('.body[data-body="rocker"]').first
    a, b, *_ = map(float, stretched.get_attribute("transform").removeprefix("matrix(").strip(")").split())
    assert 70 * np.hypot(a, b) == pytest.approx(np.hypot(at[0] - pivot[0], at[1] - pivot[1]), abs=0.5)
    assert page.locator(".trail.traced").first.get_attribute("d") != trail
    assert page.input_value('[name="linkage.rocker"]') == "70"
    page.mouse.up()
    page.wait_for_timeout(1600)
    settle(page)
    at = centre(page, "point:rocker_pin")
    assert np.hypot(at[0] - x - 18, at[1] - y + 18) < 2


def test_a_moving_mechanism_stops_while_the_pointer_is_on_a_handle(studio):  # noqa: F811
    page = studio(FOUR_BAR).page
    page.click('button[aria-label="Play"]')
    is_playing = 'document.querySelector(".playing") !== null'
    # A pivot, which does not move away.
    x, y = centre(page, "point:rocker_pivot")
    assert page.evaluate(is_playing)
    page.mouse.move(x, y)
    assert not page.evaluate(is_playing) and page.is_visible('[data-handle="point:rocker_pivot"] .tip')
    # Also after a drag.
    page.mouse.down()
    page.mouse.move(x + 5, y)
    page.mouse.up()
    page.mouse.move(x, y + 150)
    settle(page)
    assert page.evaluate(is_playing) and not page.is_visible('[data-handle="point:rocker_pivot"] .tip')


def test_sizes_that_cannot_be_assembled_show_what_fits_and_the_gap(studio):  # noqa: F811
    page = studio(FOUR_BAR).page
    for key, size in (("coupler", "20"), ("rocker", "25")):
        page.fill(f'[name="linkage.{key}"]', size)
        settle(page)
    # 100 - 30 - 20 - 25
    assert page.text_content(".gap text") == "25 mm" and page.locator(".gap .link").count() == 3
    handles = [centre(page, f"point:{name}") for name in ("crank_pin", "rocker_pin", "rocker_pivot", "coupler_point")]
    assert min(np.hypot(a[0] - b[0], a[1] - b[1]) for k, a in enumerate(handles) for b in handles[:k]) > 20
    page.fill('[name="linkage.coupler"]', "60")
    settle(page)
    assert not page.locator(".gap *").count()
    # A drag leads out of them too, from the last sizes that could be assembled.
    page.fill('[name="linkage.coupler"]', "20")
    settle(page)
    assert page.locator(".gap .missing").count()
    drag(page, "point:coupler_point", 10, 5)
    assert not page.locator(".gap *").count() and value(page, "linkage.coupler") == 60


def test_where_the_driver_cannot_go_the_gap_is_shown(studio):  # noqa: F811
    page = studio(FOUR_BAR.replace("coupler = 90", "coupler = 60").replace("rocker = 70", "rocker = 50")).page
    page.evaluate("""() => {
        const slider = document.querySelector("input[type=range]");
        slider.value = slider.max / 2;
        slider.dispatchEvent(new Event("input"));
    }""")
    # At 180 deg: 100 + 30 - 60 - 50
    assert page.text_content(".gap text") == "20 mm"
