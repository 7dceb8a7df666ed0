"""The page over a folder: every link leads somewhere, and what else lies in the folder does no harm."""

import os
import re
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest
from click.testing import CliRunner

import geomkin as gk
from geomkin.cli import cli

RECIPES = Path(__file__).parents[2] / "recipes"


class Elements(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.found, self.text = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))

    def handle_data(self, data):
        self.text += data

    def of(self, tag):
        return [attributes for name, attributes in self.found if name == tag]


def read(out):
    return Elements((out / "index.html").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("out")
    for name in ("crank-rocker", "spur-gear"):
        gk.make(RECIPES / f"{name}.toml", out)
    return out


def test_a_card_for_each_recipe_whose_links_lead_somewhere(made):
    (file,) = gk.index(made)
    assert file == made / "index.html"
    page = read(made)
    links = [made / unquote(attributes["href"]) for attributes in page.of("a")]
    assert links and all(link.is_file() for link in links)
    on_disk = {p for name in ("crank-rocker", "spur-gear") for p in (made / name).iterdir()} - {
        made / name / "summary.json" for name in ("crank-rocker", "spur-gear")
    }
    assert {link.resolve() for link in links} == {p.resolve() for p in on_disk}
    assert "four-bar" in page.text and "spur-gear" in page.text
    pictures = [attributes["src"] for attributes in page.of("img")]
    for name, picture in zip(("crank-rocker", "spur-gear"), pictures, strict=True):
        head, _, content = picture.partition(",")
        assert head == "data:image/svg+xml"
        shown, drawn = elements(unquote(content)), elements((made / name / f"{name}-assembly.svg").read_text())
        # An image shows no titles.
        assert shown == [element for element in drawn if not element[0].endswith("title")] != drawn


def elements(svg):
    return [(e.tag, e.attrib, (e.text or "").strip()) for e in ET.fromstring(svg.encode()).iter()]


@pytest.fixture
def strange(made, tmp_path):
    """A folder with one sound recipe among what may lie in a folder."""
    for name in ("summary.json", "crank-rocker.html"):
        (tmp_path / "crank-rocker").mkdir(exist_ok=True)
        (tmp_path / "crank-rocker" / name).write_bytes((made / "crank-rocker" / name).read_bytes())
    contents = {
        "broken": "{",
        "list": "[1, 2]",
        "deep": "[" * 100_000,
        "none": '{"recipe": null}',
        "odd": '{"recipe": {"kind": 3}, "checks": {"a": 1}, "files": [3, "../x.svg", null, "odd.svg", "gone.stl"]}',
        "checks": '{"recipe": {"kind": "<b>&"}, "checks": [{"passed": "yes"}, 3], "files": "odd.svg"}',
        "failed": '{"recipe": {}, "checks": [{"name": "</p><script>x</script>", "passed": false}], "files": []}',
        "digits": '{"recipe": {}, "checks": [' + "9" * 6000 + "]}",
        "quote' & <i>": '{"recipe": {"kind": "\\u202e\\u0000x"}}',
    }
    for name, content in contents.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "summary.json").write_text(content, encoding="utf-8")
    (tmp_path / "odd" / "odd.svg").write_text("<svg/>")
    (tmp_path / "odd" / "odd-assembly.svg").write_bytes(b'\xff"><script>alert(1)</script>\n#%')
    (tmp_path / "failed" / "failed-assembly.svg").write_bytes(b"x" * 300_000)
    (tmp_path / "pipe").mkdir()
    os.mkfifo(tmp_path / "pipe" / "summary.json")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "summary.json").mkdir()
    (tmp_path / "notes.txt").write_text("mine")
    return tmp_path


def test_other_files_in_the_folder_do_no_harm(strange):
    before = {p: p.stat().st_mtime_ns for p in strange.rglob("*.json") if p.is_file()}
    gk.index(strange)
    page = read(strange)
    assert len(page.of("script")) == 1 and not page.of("i") and not page.of("b") and not page.of("svg")
    titles = re.findall(r"<h3><bdi>(?:<a[^>]*>)?([^<]*)", (strange / "index.html").read_text())
    # Those of known kinds first, by their groups.
    assert titles == ["crank-rocker", "checks", "failed", "odd"]
    links = [unquote(a["href"]) for a in page.of("a")]
    assert "./odd/odd.svg" in links and not any(".." in link or "gone" in link for link in links)
    assert all((strange / link).is_file() for link in links)
    (picture,) = [a["src"] for a in page.of("img")]
    assert "'" not in picture and "#" not in picture
    assert before == {p: p.stat().st_mtime_ns for p in before}


def test_somebody_else_s_page_is_left_alone(made, tmp_path):
    (tmp_path / "spur-gear").mkdir()
    (tmp_path / "spur-gear" / "summary.json").write_bytes((made / "spur-gear" / "summary.json").read_bytes())
    (tmp_path / "index.html").write_text("<title>mine</title>")
    with pytest.raises(gk.FileError):
        gk.index(tmp_path)
    assert (tmp_path / "index.html").read_text() == "<title>mine</title>"
    result = CliRunner().invoke(cli, ["run", *map(str, twice(tmp_path)), "--out", str(tmp_path)])
    assert result.exit_code == 0 and "index.html" in result.stderr and "index.html" not in result.stdout
    assert (tmp_path / "index.html").read_text() == "<title>mine</title>"


def twice(folder):
    text = 'kind = "spur-gear"\ngear = { teeth = 17, module = 2 }\nfiles = { write = ["csv"] }\n'
    for name in ("one", "two"):
        (folder / f"{name}.toml").write_text(text)
    return folder / "one.toml", folder / "two.toml"


def test_cards_are_in_groups_and_say_what_a_recipe_is(made):
    gk.index(made)
    page = read(made)
    assert [name for name, _ in page.found if name in ("h2", "h3")] == ["h2", "h3", "h2", "h3"]
    words = [attributes["data-words"] for attributes in page.of("li") if "data-words" in attributes]
    assert "pumpjack" in words[0] and "four-bar" in words[0] and "spur-gear" in words[1]
