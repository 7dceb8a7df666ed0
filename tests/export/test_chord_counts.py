"""The gallery's drawings have no more points than their tolerance needs."""

from pathlib import Path

import ezdxf
import pytest

import geomkin as gk
from geomkin.plane import Circle
from tests.export.least_chords import least_chords

RECIPES = sorted((Path(__file__).parents[2] / "recipes").glob("*.toml"))
SOME = ("spur-gear", "ring-gear", "crank-rocker")


@pytest.mark.parametrize(
    "file",
    [file if file.stem in SOME else pytest.param(file, marks=pytest.mark.campaign) for file in RECIPES],
    ids=lambda file: file.stem,
)
def test_drawings_have_at_most_3_percent_more_chords_than_any_needs(file, tmp_path):
    recipe = gk.load(file)
    gk.write(recipe, tmp_path / "all.dxf", kerf=0.0, curves="chords")
    lines = ezdxf.readfile(tmp_path / "all.dxf").modelspace().query("LWPOLYLINE[layer!='LABEL']")
    drawn = sum(len(line) - (not line.closed) for line in lines)
    known = {}
    curves = [
        (curve, part.count)
        for part in recipe.parts
        for curve in (part.outline, *part.holes, *part.marks)
        if not isinstance(curve, Circle)
    ]
    least = sum(count * least_chords(curve, recipe.files.tolerance, known) for curve, count in curves)
    # One more for each curve, and for each tooth of a ring: a part of a chord is one. Eight teeth take 3.6 % so.
    more = sum(count * getattr(curve, "count", 1) for curve, count in curves)
    assert drawn <= min(1.03 * least + more, 1.04 * least + 1), (drawn, least)
