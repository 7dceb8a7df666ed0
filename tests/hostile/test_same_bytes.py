"""The same recipe gives the same bytes, whatever the run."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

RECIPES = Path(__file__).parent.parent.parent / "recipes"


def make(out, *recipes, cwd, flags=(), **environment):
    """Files made by a process of its own, by their path in `out`."""
    call = [sys.executable, *flags, "-m", "geomkin", "run", *map(str, recipes), "--out", str(out)]
    done = subprocess.run(call, cwd=cwd, env=os.environ | environment, capture_output=True, text=True, timeout=30)
    assert done.returncode == 0, done.stderr
    files = {p.relative_to(out).as_posix(): p.read_bytes() for p in sorted(out.rglob("*")) if p.is_file()}
    assert files
    return files


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """What the recipes of the package make."""
    folder = tmp_path_factory.mktemp("plain")
    return make(folder / "out", RECIPES, cwd=folder, PYTHONHASHSEED="0")


@pytest.mark.parametrize(
    ("flags", "environment"),
    [
        ((), {"PYTHONHASHSEED": "1", "TZ": "Asia/Tokyo", "LC_ALL": "C"}),
        (("-O",), {"PYTHONHASHSEED": "2", "OPENBLAS_NUM_THREADS": "2"}),
        (("-X", "dev", "-W", "error"), {"PYTHONHASHSEED": "3"}),
    ],
    ids=["seed, zone, language", "optimised", "development mode"],
)
def test_seed_folder_zone_and_flags_do_not_matter(here, plain, flags, environment):
    assert make(here / "out", RECIPES, cwd=here, flags=flags, **environment) == plain


def test_what_was_made_before_does_not_matter(here, recipe):
    # Each loads libraries that the next does without.
    texts = [recipe("four-bar"), recipe("spur-gear", {"files.write": '["svg"]'})]
    for k, text in enumerate(texts):
        (here / f"{k}.toml").write_text(text)
    together = make(here / "a", "0.toml", "1.toml", cwd=here)
    alone = make(here / "b", "0.toml", cwd=here) | make(here / "b", "1.toml", cwd=here)
    assert together == alone


def test_formats_asked_for_do_not_change_each_other(here, recipe):
    (here / "r.toml").write_text(recipe("disk-cam"))
    whole = make(here / "a", "r.toml", cwd=here)
    for suffix in ("dxf", "csv"):
        part = make(here / suffix, "r.toml", "--only", suffix, cwd=here)
        assert part[f"r/r.{suffix}"] == whole[f"r/r.{suffix}"]
        assert sorted(part) == [f"r/r.{suffix}", "r/summary.json"]
