"""Pages in a real browser: headless Chromium without a network. Skipped where there is none, or no playwright."""

import shutil
from types import SimpleNamespace

import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def pytest_collection_modifyitems(items):
    for item in items:
        if "browser" in item.path.parts:
            item.add_marker(pytest.mark.browser)


@pytest.fixture(scope="session")
def chromium():
    """One browser for all tests of a run."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if not CHROMIUM:
        pytest.skip("no Chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def opened(chromium):
    """Opens a page: its handle, what the console said, and what was asked for besides the page itself."""
    contexts = []

    def open_page(file, still=True, **options):
        motion = "reduce" if still else "no-preference"
        context = chromium.new_context(offline=True, reduced_motion=motion, **options)
        contexts.append(context)
        page = context.new_page()
        said, asked = [], []
        page.on("console", lambda message: said.append(message.text) if message.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(file.resolve().as_uri())
        page.wait_for_selector("[data-ready]")
        asked = SimpleNamespace(urls=asked, own=file.resolve().as_uri())
        return SimpleNamespace(page=page, said=said, asked=asked)

    yield open_page
    for context in contexts:
        context.close()
