"""The same recipe gives the same bytes, whatever the run and the processor."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from geomkin.plane.vec import rounded
from tests.test_gallery import words_and_numbers

RECIPES = Path(__file__).parent.parent.parent / "recipes"
# All of the gallery takes half a minute each time: one is tried always, all of it in campaigns.
SOME = [RECIPES / "crank-rocker.toml"]


def make(out, *recipes, cwd, flags=(), **environment):
    """Files made by a process of its own, by their path in `out`."""
    call = [sys.executable, *flags, "-m", "geomkin", "run", *map(str, recipes), "--out", str(out)]
    done = subprocess.run(call, cwd=cwd, env=os.environ | environment, capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stderr
    files = {p.relative_to(out).as_posix(): p.read_bytes() for p in sorted(out.rglob("*")) if p.is_file()}
    assert files
    return files


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """What some recipes of the package make."""
    folder = tmp_path_factory.mktemp("plain")
    return make(folder / "out", *SOME, cwd=folder, PYTHONHASHSEED="0")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """What all of them make."""
    folder = tmp_path_factory.mktemp("whole")
    return make(folder / "out", RECIPES, cwd=folder, PYTHONHASHSEED="0")


@pytest.mark.parametrize(
    ("flags", "environment"),
    [
        (("-O",), {"PYTHONHASHSEED": "1", "TZ": "Asia/Tokyo", "LC_ALL": "C", "OPENBLAS_NUM_THREADS": "2"}),
        pytest.param(("-X", "dev", "-W", "error"), {"PYTHONHASHSEED": "3"}, marks=pytest.mark.campaign),
    ],
    ids=["seed, zone, language, optimised", "development mode"],
)
def test_seed_folder_zone_and_flags_do_not_matter(here, plain, flags, environment):
    assert make(here / "out", *SOME, cwd=here, flags=flags, **environment) == plain


@pytest.mark.campaign
def test_nor_do_they_for_all_of_the_gallery(here, whole):
    assert make(here / "out", RECIPES, cwd=here, flags=("-O",), PYTHONHASHSEED="4", TZ="Asia/Tokyo") == whole


# Kernels of the linear-algebra library that can be chosen, each with the features of the processor that it needs.
KERNELS = {
    "PRESCOTT": "SSE3",
    "NEHALEM": "SSE42",
    "SANDYBRIDGE": "AVX",
    "HASWELL": "FMA3",
    "ZEN": "FMA3",
    "SKYLAKEX": "AVX512_SKX",
    "COOPERLAKE": "AVX512BF16",
    "SAPPHIRERAPIDS": "AVX512_SPR",
}
# Processor features that NumPy's loops can be made to ignore here, from the newest on.
NEWEST_FIRST = [name for name in reversed(__cpu_dispatch__) if __cpu_features__.get(name)]
PROCESSORS = {
    **{name: {"OPENBLAS_CORETYPE": name} for name, needs in KERNELS.items() if __cpu_features__.get(needs)},
    **{
        f"without {name}": {"NPY_DISABLE_CPU_FEATURES": " ".join(NEWEST_FIRST[: k + 1])}
        for k, name in enumerate(NEWEST_FIRST)
    },
    # The C library has sines of its own for each.
    "C library": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"},
}
OLDEST = {
    "OPENBLAS_CORETYPE": "NEHALEM",
    "NPY_DISABLE_CPU_FEATURES": " ".join(NEWEST_FIRST),
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4",
}


@pytest.mark.campaign
@pytest.mark.parametrize("environment", PROCESSORS.values(), ids=PROCESSORS)
def test_the_processor_does_not_matter(here, whole, environment):
    """Byte for byte, but for pages and for curves of centre points: of those the last digits may differ, and no more."""
    made = make(here / "out", RECIPES, cwd=here, **environment)
    assert made.keys() == whole.keys()
    for file, content in made.items():
        if file.split("/")[0] != "burmester-curves" and not file.endswith(".html"):
            assert content == whole[file], file
        elif file.endswith(("summary.json", ".toml")):
            (words, numbers), (old_words, old_numbers) = (
                words_and_numbers(re.sub(r'"(written_)?(area|volume)_mm.*', "", text.decode()))
                for text in (content, whole[file])
            )
            assert words == old_words, file
            assert numbers == pytest.approx(old_numbers, rel=1e-5, abs=1e-5), file


@pytest.mark.campaign
def test_an_old_processor_makes_the_same_cams_gears_and_linkages(here):
    files = [RECIPES / f"{name}.toml" for name in ("table-cam", "roller-cam", "gear-pair", "walking-leg")]
    old, new = make(here / "old", *files, cwd=here, **OLDEST), make(here / "new", *files, cwd=here)
    # It states how large pages are, and those may differ.
    assert old.pop("index.html") and new.pop("index.html") and old == new


def test_halfway_values_round_alike_whatever_their_last_bits():
    # Numbers of few decimals, as recipes have them, with the noise that sines and sums differ by.
    halves = (np.arange(-4000, 4000) + 0.5) / 1000
    for noise in (0, 1, -1, 5, -5, 100, -100):
        near = halves + noise * np.spacing(4.0)
        assert (rounded(near, 3) == rounded(halves, 3)).all()
        assert (rounded(near + 1j * near[::-1], 3) == rounded(halves + 1j * halves[::-1], 3)).all()
    z = np.random.default_rng(3).normal(size=1000) * 1e3
    assert (np.abs(rounded(z, 6) - z) < 0.505e-6).all()
    assert not np.signbit(rounded([-0.0, -1e-9], 3)).any() and np.isnan(rounded([np.nan, 1.0], 3)).tolist() == [1, 0]
