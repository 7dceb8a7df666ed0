"""Prints what pages weigh, what they cost to build, and what they cost a browser. Never passes or fails.

.venv/bin/python tests/speed/pages.py [RECIPE ...]; the browser's columns need Chromium and `pip install -e '.[browser]'`.
"""

import re
import shutil
import sys
import tempfile
import time
from pathlib import Path

import geomkin as gk
from geomkin.page.page import SCRIPTS, player_file

RECIPES = Path(__file__).parent.parent.parent / "recipes"
NAMES = ["crank-rocker", "walking-leg", "roller-cam", "gear-pair"]
# Tells when the drawing is there, counted from when the page was asked for.
WATCH = """new MutationObserver((_, watch) => {
  if (!document.querySelector("#player[data-ready]")) return;
  watch.disconnect();
  requestAnimationFrame(() => setTimeout(() => { document.documentElement.dataset.first = performance.now(); }));
}).observe(document, { subtree: true, childList: true, attributes: true });"""


def least_ms(action, made=lambda: None, runs=9):
    """Least processor time of a call on what is made anew for each."""
    times = []
    for _ in range(runs):
        thing = made()
        start = time.process_time()
        action(thing) if thing else action()
        times.append(time.process_time() - start)
    return 1000 * min(times)


def loaded(name, *known):
    recipe = gk.load(RECIPES / f"{name}.toml")
    for what in known:
        getattr(recipe, what)
    return recipe


def in_browser(files):
    """Script ms a frame while it plays, and ms until the drawing is seen, of each page; nothing without a browser."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return {}
    if not (exe := shutil.which("chromium") or shutil.which("chromium-browser")):
        return {}
    found = {}
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=exe, args=["--no-sandbox"])
        for name, file in files.items():
            page = browser.new_context(offline=True, viewport={"width": 1400, "height": 900}).new_page()
            page.add_init_script(WATCH)
            page.goto(file.resolve().as_uri())
            page.wait_for_selector("#player[data-cost]", timeout=60_000)
            page.wait_for_timeout(2000)
            first = float(page.get_attribute("html", "data-first"))
            found[name] = float(page.get_attribute("#player", "data-cost")), first
            page.close()
        browser.close()
    return found


def main(names):
    library, own = len(player_file(SCRIPTS[0])), "player"
    rows, files = [], {}
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            (files[name],) = gk.write(loaded(name), Path(folder) / f"{name}.html")
            text = files[name].read_text()
            inside = {
                k: len(v) for k, v in re.findall(r'<(style|script type="?[a-z/]+"?)[^>]*>(.*?)</', text, re.DOTALL)
            }
            style, data, script = (
                inside[k] for k in ("style", 'script type="application/json"', 'script type="module"')
            )
            size = files[name].stat().st_size
            reported = ("design", "table", "parts", "checks")
            table = least_ms(lambda recipe: recipe.table, lambda name=name: loaded(name, "design"))
            scene = least_ms(lambda recipe: recipe.scene, lambda name=name: loaded(name, *reported))
            whole = loaded(name, *reported, "scene")
            page = least_ms(lambda whole=whole, name=name: gk.write(whole, files[name]))
            weights = (size, library, script - library, style, data, size - script - style - data)
            rows.append((name, *weights, table, scene, page, (scene + page) / table))
        seen = in_browser(files)
    print("bytes: all = plots' library + player + style + data + the rest; ms of processor time; build: scene and page")
    print(f"{'':16}{'all':>8}{'library':>8}{own:>8}{'style':>7}{'data':>7}{'rest':>7}", end="")
    print(f"{'table':>7}{'scene':>7}{'page':>7}{'/table':>7}{'ms/frame':>9}{'first':>7}")
    for name, *weights, table, scene, page, ratio in rows:
        cost, first = seen.get(name, (float("nan"),) * 2)
        print(f"{name:16}" + "".join(f"{w:{n}}" for w, n in zip(weights, (8, 8, 8, 7, 7, 7))), end="")
        print(f"{table:7.1f}{scene:7.1f}{page:7.1f}{ratio:7.1f}{cost:9.2f}{first:7.0f}")


if __name__ == "__main__":
    main(sys.argv[1:] or NAMES)
