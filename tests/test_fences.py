"""Limits of what the repository holds."""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
# Bytes of a tracked file.
LARGEST = 100_000
# Larger files, each with the reason.
NEEDED = {
    "out/geared-legs/geared-legs.svg": "kept output of a recipe",
    "out/motor-walker/motor-walker-2.svg": "kept output of a recipe",
    "out/planetary/planetary.svg": "kept output of a recipe",
    "out/traced-heart/traced-heart.svg": "kept output of a recipe",
    "out/traced-letter/traced-letter.svg": "kept output of a recipe",
    "out/walker/walker.svg": "kept output of a recipe",
}


def test_no_tracked_file_is_larger_than_needed():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("no git repository")
    files = [ROOT / name for name in listed.stdout.split("\0") if name]
    large = {file.relative_to(ROOT).as_posix() for file in files if file.is_file() and file.stat().st_size > LARGEST}
    assert large <= set(NEEDED)
