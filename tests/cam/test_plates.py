"""Plates of followers against unions of plain shapes by another library, and holes against where a stem must be held."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.cam.followers.follower import Bars, faced_arm, stemmed_face, with_rounded_corners

from .cams import LIFTS

BARS = Bars(bar_width=12.0, overhang=3.0, stem_length=70.0, pivot_bore=5.0, roller_bore=4.0)


def polygon(curve):
    return shapely.Polygon(gk.plane.xy(gk.flatten(curve, 1e-4)))


def differ(one, other):
    """How far the boundaries of two shapes are apart, mm."""
    return max(one.exterior.hausdorff_distance(other.exterior), other.exterior.hausdorff_distance(one.exterior))


@pytest.mark.parametrize("tilt_deg", [25.0, -40.0])
def test_a_stem_is_held_beyond_the_bar_of_its_face_and_at_its_end(tilt_deg):
    """The bar is as high as it is wide, square to the face; two widths on along the stem is the nearest for a pin."""
    follower = gk.TranslatingFlat(tilt_deg)
    (plate,) = follower.guided_plates(BARS, LIFTS, 60.0, 1)
    near, far = plate.holes
    along = 1j * np.exp(-1j * np.radians(tilt_deg))
    assert near.centre.imag == pytest.approx(12) and far.centre == pytest.approx(70 * along)
    assert near.centre / abs(near.centre) == pytest.approx(along)
    assert [(hole.key, hole.diameter, hole.widest) for hole in plate.holes] == [("pivot_bore", 5.0, 12.0)] * 2
    least = abs(near.centre) + 24
    follower.guided_plates(replace(BARS, stem_length=least + 1e-9), LIFTS, 60.0, 1)
    with pytest.raises(gk.DesignError) as refused:
        follower.guided_plates(replace(BARS, stem_length=least - 1e-9), LIFTS, 60.0, 1)
    assert refused.value.field == "stock.stem_length"
    advised = float(refused.value.remedy.split()[3])
    assert least <= advised < 1.001 * least


def test_a_roller_s_stem_is_held_above_it_and_carries_its_pin():
    roller, stem = gk.TranslatingRoller(8, 3).guided_plates(BARS, LIFTS, 40.0, 1)
    assert roller.name == "roller" and [hole.diameter for hole in roller.holes] == [4.0]
    assert roller.holes[0].widest == 16
    assert [(hole.key, hole.centre) for hole in stem.holes] == [
        ("roller_bore", 0j),
        ("pivot_bore", 12j),
        ("pivot_bore", 70j),
    ]
    assert differ(polygon(stem.outline), shapely.LineString([(0, 0), (0, 70)]).buffer(6, quad_segs=500)) < 1e-3
    (alone,) = gk.TranslatingRoller(0, 3).guided_plates(BARS, LIFTS, 40.0, 1)
    assert [hole.key for hole in alone.holes] == ["pivot_bore", "pivot_bore"]


@pytest.mark.parametrize(("face", "tilt_deg"), [((-20.0, 30.0), 0.0), ((-2.0, 30.0), 20.0), ((-25.0, 1.0), -35.0)])
def test_a_flat_follower_is_its_bar_and_its_stem(face, tilt_deg):
    """The bar goes as far as the face and as the stem's sides; the stem ends in a half disc about its hole."""
    tilt, width, stem = np.radians(tilt_deg), 10.0, 45.0
    outline, end = stemmed_face(face, tilt, width, stem)
    along = 1j * np.exp(-1j * tilt)
    strip = shapely.LineString(gk.plane.xy(np.array([-along * width, end]))).buffer(width / 2, quad_segs=500)
    top = shapely.LineString([(-100, width), (100, width)]).intersection(strip).bounds
    bar = shapely.box(min(face[0], top[0]), 0, max(face[1], top[2]), width)
    above = strip.intersection(shapely.box(-100, width, 100, 100))
    assert end == pytest.approx(stem * along)
    assert polygon(outline).symmetric_difference(bar.union(above)).area < 0.02
    least = 1.5 * width / along.imag
    stemmed_face(face, tilt, width, least * (1 + 1e-9))
    with pytest.raises(gk.DesignError) as refused:
        stemmed_face(face, tilt, width, least * (1 - 1e-9))
    assert refused.value.field == "stock.stem_length"
    assert least < refused.value.value == pytest.approx(least, rel=1e-4)


@pytest.mark.parametrize("tau", [1, -1])
@pytest.mark.parametrize("offset", [6.0, 2.0, 0.0, -9.0])
def test_an_arm_is_its_bar_behind_the_face_and_its_boss(offset, tau):
    width, reach, top = 10.0, 80.0, -offset
    boss, back = width / 2, min(top - width, -width / 2)
    # Where the face begins: at the boss's side, on its arc, or, in a bar that covers the boss, at its far side.
    start = boss if top <= 0 else np.sqrt(boss**2 - top**2) if top < boss else -boss
    outline = faced_arm((start, reach), offset, width, tau)
    bar = shapely.box(0 if top < boss else -boss, back, reach, top)
    whole = shapely.union_all([shapely.Point(0, 0).buffer(boss, quad_segs=500), bar, shapely.box(-boss, back, boss, 0)])
    mirrored = shapely.affinity.scale(whole, yfact=tau, origin=(0, 0))
    assert polygon(outline).symmetric_difference(mirrored).area < 0.02
    with pytest.raises(gk.DesignError) as refused:
        faced_arm((start - 1e-6, reach), offset, width, tau)
    assert refused.value.field == "stock.bar_width"


def test_corners_are_rounded_where_they_look_out_and_no_farther_than_their_edges_go():
    """By opening: what a disc inside sweeps. Corners that look in stay, and so do those beside an arc."""
    ell = gk.plane.Polyline(np.array([0, 20, 20 + 8j, 9 + 8j, 9 + 30j, 30j]))
    opened = polygon(ell).buffer(-2, quad_segs=500).buffer(2, quad_segs=500)
    assert (
        differ(
            polygon(with_rounded_corners(ell, 2.0)),
            opened.union(polygon(ell).intersection(shapely.Point(9, 8).buffer(3))),
        )
        < 1e-2
    )
    # An edge of 1 mm leaves its corners 0.4 mm each.
    thin = with_rounded_corners(gk.plane.Polyline(np.array([0, 20, 20 + 1j, 1j])), 3.0)
    assert np.abs(thin.vertices.real - 10).max() == pytest.approx(10) and len(thin.vertices) == 8
    assert sorted(set(np.round(thin.vertices.imag, 9))) == pytest.approx([0, 0.4, 0.6, 1])
    assert sorted(set(np.round(thin.vertices.real, 9))) == pytest.approx([0, 0.4, 19.6, 20])
