"""CONTRIBUTING.md names files and folders that exist, and every folder of the package."""

import re
from pathlib import Path

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
