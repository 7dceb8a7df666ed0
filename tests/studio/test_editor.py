"""The editor of a notebook without a browser: the recipe follows what the page sends, and closing leaves nothing."""

import http.client
import json
import os
import threading
import time
from contextlib import closing
from pathlib import Path
from urllib.parse import urlsplit

import pytest

import geomkin as gk

FOUR_BAR = 'kind = "four-bar"\n[linkage]\nground = 100\ncrank = 30  # driven\ncoupler = 90\nrocker = 70\n'
TABLE = {"kind": "four-bar", "linkage": {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70}}
GOAL = Path(__file__).parents[2] / "recipes" / "path-generator.toml"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bar.toml").write_text(FOUR_BAR)
    return tmp_path


def sent(editor, name, body=None):
    """A connection on which a request was sent."""
    url = urlsplit(editor.url)
    connection = http.client.HTTPConnection(url.hostname, url.port, timeout=20)
    content = None if body is None else json.dumps(body)
    connection.request("POST" if body else "GET", url.path + name, content, {"Content-Type": "application/json"})
    return connection


def ask(editor, name, body=None):
    with closing(sent(editor, name, body)) as connection:
        return json.loads(connection.getresponse().read())


@pytest.mark.parametrize("source", [FOUR_BAR, Path("bar.toml"), "bar.toml", gk.load(FOUR_BAR), TABLE])
def test_the_recipe_is_what_was_edited_last(folder, source):
    with gk.edit(source) as editor:
        assert editor.recipe.linkage == gk.load(FOUR_BAR).linkage
        name = ask(editor, "start")["first"]
        ask(editor, "answer", {"text": editor.text, "recipe": name, "set": {"linkage.crank": 31.5}})
        assert editor.recipe.linkage.crank == 31.5
        # Checks of another text, which are asked for later, change nothing.
        ask(editor, "answer", {"text": FOUR_BAR, "recipe": name, "lane": "checks"})
        assert editor.recipe.linkage.crank == 31.5 and ask(editor, "start")["text"] == editor.text
        ask(editor, "answer", {"text": editor.text, "recipe": name, "set": {"linkage.crank": -1}})
        with pytest.raises(gk.RecipeError):
            editor.recipe
        ask(editor, "answer", {"text": editor.text, "recipe": name, "set": {"linkage.crank": 32}})
    assert editor.recipe.linkage.crank == 32


def test_a_recipe_keeps_its_name_and_its_comments(folder):
    assert gk.edit("bar.toml").recipe.name == gk.edit(gk.load("bar.toml")).recipe.name == "bar"
    assert "# driven" in gk.edit("bar.toml").text


def test_a_file_that_is_no_recipe_is_refused_and_mistakes_in_one_are_not(folder):
    (folder / "wrong.toml").write_text('kind = "four-bar"\n[linkage]\ncrank = -1\n')
    with pytest.raises(gk.FileError):
        gk.edit("none.toml")
    editor = gk.edit("wrong.toml")
    with pytest.raises(gk.RecipeError):
        editor.recipe


def test_closing_leaves_no_thread_port_or_file(folder):
    threads, files = set(threading.enumerate()), sorted(os.listdir())
    editor = gk.edit("bar.toml")
    # It starts nothing before it is shown.
    assert repr(editor) and set(threading.enumerate()) == threads
    assert editor.url in editor._repr_html_()
    port = urlsplit(editor.url).port
    # A connection that the browser keeps open, one that waits for changes of the file, and a search that goes on.
    idle = sent(editor, "start")
    idle.getresponse().read()
    waiting = sent(editor, f"changed?recipe=bar&base={ask(editor, 'open', {'recipe': 'bar'})['base']}")
    assert "job" in ask(editor, "answer", {"text": GOAL.read_text()})
    assert len(set(threading.enumerate()) - threads) >= 4
    start = time.monotonic()
    editor.close()
    assert set(threading.enumerate()) == threads and sorted(os.listdir()) == files
    assert time.monotonic() - start < 5
    with pytest.raises(OSError):
        http.client.HTTPConnection("127.0.0.1", port, timeout=2).connect()
    for connection in (idle, waiting):
        connection.close()
    editor.close()


def test_a_closed_editor_is_shown_again_with_what_was_edited(folder):
    editor = gk.edit(FOUR_BAR)
    ask(editor, "answer", {"text": editor.text, "set": {"linkage.crank": 33}})
    first = editor.url
    editor.close()
    assert editor.url != first and "crank = 33" in ask(editor, "start")["text"]
    editor.close()


def test_only_pages_of_this_machine_may_frame_it(folder):
    with gk.edit(FOUR_BAR) as editor, closing(sent(editor, "")) as connection:
        policy = connection.getresponse().headers["Content-Security-Policy"]
    (sources,) = [part for part in policy.split("; ") if "ancestors" in part]
    assert {urlsplit(source).hostname for source in sources.split()[1:]} == {"localhost", "127.0.0.1", None}
    assert "*" not in sources.split()
