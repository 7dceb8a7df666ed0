"""Each type of page under axe-core, in light and dark and on the phone: no finding.

`npm install axe-core` in the project's folder, or GEOMKIN_AXE, the path of `axe.min.js`; pages of the book after its site
was built into `site/`. What is missing is skipped.
"""

import os
from pathlib import Path

import pytest
from click.testing import CliRunner

from geomkin.cli import cli

from .test_editor import FOUR_BAR, studio  # noqa: F401

ROOT = Path(__file__).parents[2]
AXE = Path(os.environ.get("GEOMKIN_AXE", ROOT / "node_modules/axe-core/axe.min.js"))
SITE = Path(os.environ.get("GEOMKIN_SITE", ROOT / "site"))
VIEWS = {
    "light": {"viewport": {"width": 1400, "height": 900}},
    "dark": {"viewport": {"width": 1400, "height": 900}, "color_scheme": "dark"},
    "phone": {"viewport": {"width": 390, "height": 844}},
}
BOOK = (
    "index", "start", "how-to", "which-mechanism", "linkages", "trust", "coming-from", "limits", "reference", "search",
    "generated/gallery", "generated/keys/four-bar", "generated/keys/index", "generated/checks", "generated/glossary",
    "generated/commands", "generated/python", "generated/python/geomkin.FourBar", "generated/published/index",
    "generated/published/theory-of-machines-four-bar",
)  # fmt: skip
pytestmark = pytest.mark.skipif(not AXE.is_file(), reason="axe-core is not installed")


def findings(page):
    """What axe-core finds on a page: rule, impact, and the first elements."""
    page.evaluate(AXE.read_text("utf-8"))
    found = page.evaluate("axe.run(document, {iframes: false}).then(result => result.violations)")
    return [(rule["id"], rule["impact"], [node["target"] for node in rule["nodes"]][:3]) for rule in found]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Pages of each type: of a linkage, a cam, gears, a machine, the index, a sweep, a front, and a certificate."""
    folder = tmp_path_factory.mktemp("made")
    recipes = [
        str(ROOT / f"recipes/{name}.toml") for name in ("crank-rocker", "undercut-cam", "gear-pair", "geared-legs")
    ]
    runner = CliRunner()
    rocker = recipes[0]
    for words in (
        ["run", *recipes, "--out", str(folder), "--only", "page"],
        ["run", rocker, "--out", str(folder / "proven"), "--only", "page,csv", "--verify"],
        ["sweep", rocker, "--set", "linkage.crank=20,25,30", "--out", str(folder / "sweep")],
    ):
        result = runner.invoke(cli, words)
        assert result.exit_code == 0, result.output
    return sorted(folder.rglob("*.html"))


def test_pages_that_geomkin_makes(made, chromium):
    assert len(made) >= 7
    for view in VIEWS.values():
        with_axe(chromium, view, made)


def test_embedded_page(made, chromium):
    (file,) = [file for file in made if file.stem == "crank-rocker" and "proven" not in file.parts]
    with_axe(chromium, VIEWS["light"], [f"{file.resolve().as_uri()}#embed"])


@pytest.mark.parametrize("view", VIEWS)
def test_studio(studio, view):  # noqa: F811
    for text in (FOUR_BAR, ""):
        page = studio(text, **VIEWS[view]).page
        assert findings(page) == []
        if text:
            page.click("#build")
            for tool in ("photo", "pose"):
                page.click(f"[data-tool={tool}]")
                assert findings(page) == []
            page.click("[data-view=text]")
            assert findings(page) == []
            page.fill("#text textarea", f"{text}rocker = ")
            page.wait_for_selector(".code .wrong")
            # The plots of the last valid recipe are greyed on purpose.
            assert [finding for finding in findings(page) if finding[0] != "color-contrast"] == []


@pytest.mark.parametrize("view", VIEWS)
def test_book(chromium, view):
    if not (SITE / "index.html").is_file():
        pytest.skip("the site is not built")
    with_axe(chromium, VIEWS[view], [SITE / f"{name}.html" for name in BOOK])


def with_axe(chromium, view, files):
    """Open each page and expect no finding."""
    context = chromium.new_context(offline=True, reduced_motion="reduce", **view)
    wrong = {}
    for file in files:
        page = context.new_page()
        page.goto(file if isinstance(file, str) else file.resolve().as_uri())
        page.wait_for_timeout(300)
        if found := findings(page):
            wrong[Path(str(file)).name] = found
        page.close()
    context.close()
    assert wrong == {}
