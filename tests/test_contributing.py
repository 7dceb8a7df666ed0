"""CONTRIBUTING.md names files and folders that exist, and every folder of the package; docs have all keys."""

import dataclasses
import re
from pathlib import Path

from geomkin.recipe.kinds import kind_names, recipe_class

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def test_named_files_exist():
    paths = re.findall(r"`((?:geomkin|tests|recipes|docs)/[\w./-]*)`", TEXT)
    assert len(paths) >= 5
    for path in paths:
        assert (ROOT / path).exists(), path


def test_every_folder_is_named():
    folders = {path.parent.name for path in (ROOT / "geomkin").glob("*/__init__.py")}
    assert [name for name in folders if f"{name}/" not in TEXT] == []


def test_every_key_of_a_kind_is_in_the_docs():
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    words = {word for page in pages for word in re.findall(r"\w+", page.read_text("utf-8"))}
    keys = {field.name: kind for kind in kind_names() for field in dataclasses.fields(recipe_class(kind)) if field.init}
    assert {key: kind for key, kind in keys.items() if key not in words and not key.startswith("_")} == {}
