"""Pictures that move without a script, and the page over a folder, as a browser shows them."""

from pathlib import Path

import numpy as np
import pytest

import geomkin as gk

RECIPES = Path(__file__).parent.parent.parent / "recipes"
# Where the picture has the origin of a titled group's own frame, mm, y up, at a share of the first pass.
SEEN = """([name, share]) => {
  for (const motion of document.getAnimations()) {
    motion.pause();
    motion.currentTime = share * motion.effect.getTiming().duration;
  }
  const title = [...document.querySelectorAll("title")].find((other) => other.textContent === name);
  const svg = document.documentElement, point = svg.createSVGPoint();
  const there = point.matrixTransform(svg.getScreenCTM().inverse().multiply(title.parentNode.getScreenCTM()));
  return [there.x, -there.y];
}"""


@pytest.fixture
def tab(chromium):
    contexts = []

    def open_file(file, motion="no-preference", **options):
        context = chromium.new_context(offline=True, reduced_motion=motion, **options)
        contexts.append(context)
        page = context.new_page()
        page.said, page.asked = [], []
        page.on("console", lambda message: page.said.append(message.text))
        page.on("pageerror", lambda error: page.said.append(str(error)))
        page.on("request", lambda request: page.asked.append(request.url))
        page.goto(file.resolve().as_uri())
        return page

    yield open_file
    for context in contexts:
        context.close()


def test_a_browser_moves_the_foot_as_the_table_has_it(tab, tmp_path):
    recipe = gk.load(RECIPES / "walking-leg.toml")
    (file,) = gk.write(recipe, tmp_path / "leg-animation.svg")
    page = tab(file)
    foot = recipe.table["foot_x_mm"] + 1j * recipe.table["foot_y_mm"]
    size = np.ptp(foot.real)
    frames = len(foot) - 1
    for frame in (0, 25, 66, 100, 145, frames - 1):
        x, y = page.evaluate(SEEN, ["foot", frame / frames])
        assert abs(x + 1j * y - foot[frame]) < 5e-3 * size
    assert not page.said and len(page.asked) == 1


def test_it_stands_still_where_less_motion_is_wanted(tab, tmp_path):
    (file,) = gk.write(gk.load(RECIPES / "crank-rocker.toml"), tmp_path / "bars-animation.svg")
    assert tab(file).evaluate("document.getAnimations().length") > 2
    calm = tab(file, motion="reduce")
    assert calm.evaluate("document.getAnimations().length") == 0
    # As the still has it, whose frame is 47 deg.
    x, y = calm.evaluate(SEEN, ["coupler", 0])
    assert abs(x + 1j * y - 30 * np.exp(1j * np.radians(47))) < 0.05


def test_the_page_over_a_folder_opens_without_a_complaint(tab, tmp_path):
    for name in ("crank-rocker", "spur-gear"):
        gk.make(RECIPES / f"{name}.toml", tmp_path)
    (file,) = gk.index(tmp_path)
    for width, scheme in ((320, "light"), (1400, "dark")):
        page = tab(file, viewport={"width": width, "height": 800}, color_scheme=scheme)
        assert not page.said and {url for url in page.asked if not url.startswith("data:")} == {file.resolve().as_uri()}
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        assert page.evaluate("[...document.images].every((image) => image.complete && image.naturalWidth > 0)")
    page.click("summary")
    page.click("h3 a")
    assert page.title() == "crank-rocker"
