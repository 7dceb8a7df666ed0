"""The editor in a page of a notebook: what is edited in its frame is the recipe in Python."""

import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

import geomkin as gk

from .test_editor import FOUR_BAR


@pytest.fixture
def notebook(chromium):
    """Shows HTML as the output of a cell on a page of this machine, at another port as a notebook's."""
    servers, said, contexts = [], [], []

    class Cell(BaseHTTPRequestHandler):
        html = ""

        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(f'<!doctype html><link rel="icon" href="data:,">{self.html}'.encode())

        def log_message(self, *_):
            pass

    def show(html):
        Cell.html = html
        servers.append(HTTPServer(("127.0.0.1", 0), Cell))
        threading.Thread(target=servers[-1].serve_forever, args=(0.01,), daemon=True).start()
        contexts.append(chromium.new_context(reduced_motion="reduce"))
        page = contexts[-1].new_page()
        page.on("console", lambda message: said.append(message.text) if message.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: said.append(str(error)))
        page.goto(f"http://localhost:{servers[-1].server_port}/")
        return page

    yield show
    for context in contexts:
        context.close()
    for server in servers:
        server.shutdown()
        server.server_close()
    assert not said


def test_the_recipe_edited_in_a_cell_is_read_back_and_a_reload_goes_on(notebook, tmp_path):
    file = tmp_path / "bar.toml"
    file.write_text(FOUR_BAR)
    with gk.edit(file) as editor:
        page = notebook(editor._repr_html_())
        frame = page.frame_locator("iframe")
        crank = frame.locator('[name="linkage.crank"]')
        crank.fill("31.5")
        frame.locator("#dirty:visible").wait_for()
        assert editor.recipe.linkage.crank == 31.5 and file.read_text() == FOUR_BAR
        frame.locator('[data-handle="point:coupler_point"]').press("ArrowRight")
        for _ in range(300):
            if editor.recipe.linkage.coupler_point.real > 40:
                break
            page.wait_for_timeout(20)
        else:
            pytest.fail("the recipe does not follow the handle")
        frame.locator("body:not(.solving)").wait_for()
        edited = editor.text

        page.reload()
        frame.locator("#dirty:visible").wait_for()
        assert crank.input_value() == "31.5" and editor.text == edited
        frame.locator("#undo").click()
        frame.locator("#dirty").wait_for(state="hidden")
        assert editor.text == FOUR_BAR
        frame.locator("#redo").click()
        frame.locator("#dirty:visible").wait_for()
        frame.locator("#save").click()
        frame.locator("#dirty").wait_for(state="hidden")
        page.close()
    assert file.read_text() == edited == editor.text and "# the pen" in edited
