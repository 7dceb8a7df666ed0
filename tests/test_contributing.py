"""What CONTRIBUTING says it takes to add a thing is what it takes, and its rooms are those there are."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^### (.*?)\n\n((?:- .*\n)+)", TEXT, flags=re.MULTILINE))
# The most files that each may take to make or change; a toy one is added from outside by the test that is named.
MOST = {"A kind": 5, "A goal": 5, "A follower": 7, "A gear": 6, "A format": 3, "A kind's scene": 1}


@pytest.mark.parametrize("heading", SECTIONS)
def test_the_lists_are_counted_and_short(heading):
    what, count = re.fullmatch(r"(.*): (\d+) files?", heading).groups()
    files = re.findall(r"^- `([^`]+)`", SECTIONS[heading], flags=re.MULTILINE)
    assert len(files) == int(count) == len(SECTIONS[heading].splitlines()) <= MOST[what]
    assert len(set(files)) == len(files)


def test_every_list_is_there():
    assert {heading.split(":")[0] for heading in SECTIONS} == set(MOST)


def test_files_that_are_named_are_there():
    for path in re.findall(r"`([\w./]+/[\w.]+)`", TEXT):
        assert any((root / path).exists() for root in (ROOT, ROOT / "geomkin")), path


def test_every_room_is_told():
    package = ROOT / "geomkin"
    rooms = {path.name for path in package.iterdir() if (path / "__init__.py").exists()}
    told = set(re.findall(r"^- (`.*`):", TEXT, flags=re.MULTILINE))
    named = {name.rstrip("/") for line in told for name in re.findall(r"`([\w/]+)`", line)}
    assert rooms <= named
    assert {path.stem for path in package.glob("*.py")} - {"__init__", "__main__", "lazy"} <= named
