"""Names engraved on parts: read back from the drawing, and held against the cuts by another library."""

import ezdxf
import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.export.text import MARGIN, lettered, strokes_of

BAR = gk.plane.rounded_hull([0, 60j], 7)
HOLES = (gk.plane.Circle(0, 2.1), gk.plane.Circle(60j, 2.1))


def solid(part):
    rings = [gk.plane.xy(gk.flatten(curve, 0.01)) for curve in (part.outline, *part.holes)]
    return shapely.Polygon(rings[0], rings[1:])


@pytest.mark.parametrize(
    "part",
    [
        gk.Part("crank", BAR, HOLES, 3.0, hole_names=("A", "B")),
        gk.Part("wheel_2", gk.SpurGear(24, 2).outline, (gk.plane.Circle(0, 4),), 3.0),
        gk.Part("turned", gk.plane.rounded_hull([0, -50 + 50j, -10 + 60j], 8), (gk.plane.slot(0, -20 + 20j, 2),), 3.0),
    ],
    ids=lambda part: part.name,
)
def test_strokes_keep_off_every_cut(part):
    words, strokes = lettered(part, 1)
    assert words == part.name
    lines = shapely.MultiLineString([gk.plane.xy(line) for line in strokes])
    assert solid(part).contains(lines)
    boundary = solid(part).boundary
    assert boundary.distance(lines) >= MARGIN - 0.06


def test_each_hole_has_its_letter_next_to_it():
    part = gk.Part("crank", BAR, HOLES, 3.0, hole_names=("A", "B"))
    _, named = lettered(part, 1)
    _, bare = lettered(gk.Part("crank", BAR, HOLES, 3.0), 1)
    letters = named[: len(named) - len(bare)]
    for line in letters:
        nearest = min(abs(line).min(), abs(line - 60j).min())
        assert 2.1 + MARGIN - 0.06 <= nearest < 2.1 + MARGIN + 1.5
    count = len(strokes_of("A"))
    assert all(abs(line).max() < 10 for line in letters[:count])
    assert all(abs(line - 60j).max() < 10 for line in letters[count:])


def test_lettering_keeps_off_engravings():
    cross = gk.plane.Segment(-30 + 0j, 30 + 0j)
    _, strokes = lettered(gk.Part("name", gk.plane.Circle(0, 40), (), 3.0, marks=(cross,)), 1)
    assert min(abs(line.imag).min() for line in strokes) > MARGIN / 2


def test_the_drawing_has_them_on_their_own_layer_and_a_key_leaves_them_out(tmp_path):
    text = (
        'kind = "four-bar"\nlinkage = {{ ground = 100, crank = 30, coupler = 90, rocker = 70 }}\n[files]\nlabels = {}\n'
    )
    counts = {}
    for labels in ("true", "false"):
        recipe = gk.load(text.format(labels))
        gk.write(recipe, tmp_path / f"{labels}.dxf")
        layers = [e.dxf.layer for e in ezdxf.readfile(tmp_path / f"{labels}.dxf").modelspace()]
        counts[labels] = {layer: layers.count(layer) for layer in set(layers)}
    words = ["ground", "crank", "coupler", "rocker"]
    strokes = sum(len(strokes_of(word)) for word in words)
    assert counts["true"].pop("LABEL") > strokes
    assert counts["true"] == counts["false"]


@pytest.mark.parametrize(("size", "longer", "along"), [(20.0, 1.015, False), (400.0, 1.03, True)])
def test_a_part_that_is_hardly_longer_than_wide_is_lettered_level_whatever_its_size(size, longer, along):
    """Ellipses at an angle: of the squares of both half axes, the difference to the sum is the share that counts."""
    turn = np.exp(0.6j)
    angle = np.linspace(0, 2 * np.pi, 201)[:-1]
    outline = gk.plane.Polyline(turn * size * (longer * np.cos(angle) + 1j * np.sin(angle)))
    _, strokes = lettered(gk.Part("LLL", outline, (), 3.0), 1)
    stem, *_ = strokes
    way = stem[1] - stem[0]
    assert abs(np.angle((way / (turn if along else 1)) ** 4)) < 0.05
