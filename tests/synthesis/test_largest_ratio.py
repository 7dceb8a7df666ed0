"""The best of a family at its limits: what is said where a longer link would be better, or where links get too long."""

import pytest

import geomkin as gk
from geomkin.synthesis import double_rocker, slider_crank_stroke

WISHES = [
    (gk.crank_rocker, (40, 180)),
    (gk.crank_rocker, (40, 160)),
    (slider_crank_stroke, (80, 180)),
    (slider_crank_stroke, (80, 150)),
    (double_rocker, (60, 60, 80, 40)),
    (double_rocker, (-80, -70, 60, 50)),
]


@pytest.mark.parametrize(("made", "wish"), WISHES)
@pytest.mark.parametrize("ratio", [3.0, 6.0])
def test_the_largest_ratio_is_reported_where_more_would_be_better(made, wish, ratio):
    found, more = (made(*wish, largest_ratio=r) for r in (ratio, 1.1 * ratio))
    assert found.ratio <= ratio * (1 + 1e-9)
    better = more.transmission_angle_deg > found.transmission_angle_deg + 1e-6
    assert found.at_largest_ratio == found.summary()["at_largest_ratio"] == better
    assert better == (found.ratio > ratio * (1 - 1e-6))
    # One that is chosen is no best, and is at no limit, even where it is the same linkage.
    same = made(*wish, free_angle_deg=found.free_angle_deg)
    assert same.ratio == pytest.approx(found.ratio, rel=1e-9) and not same.at_largest_ratio
    assert same.transmission_angle_deg == pytest.approx(found.transmission_angle_deg, abs=1e-6)
    if made is not gk.crank_rocker:
        name = "crank" if made is double_rocker else "coupler"
        assert not made(*wish, **{name: getattr(found.linkage, name)}).at_largest_ratio


def test_small_swings_may_have_twice_the_ratio_that_they_need():
    """Below a swing of 1.146 deg no crank-rocker has its links within a hundred."""
    found = gk.crank_rocker(1.0, 180)
    with pytest.raises(gk.DesignError) as caught:
        gk.crank_rocker(1.0, 180, largest_ratio=100.0)
    least = float(caught.value.remedy.rsplit(" ", 1)[1])
    assert gk.crank_rocker(1.0, 180, largest_ratio=least).ratio <= least * (1 + 1e-9)
    assert found.at_largest_ratio and found.ratio == pytest.approx(2 * least, rel=1e-3)


@pytest.mark.parametrize("name", ["coupler"])
def test_the_length_that_a_refusal_names_is_the_last_that_keeps_all_links_within_bounds(name):
    with pytest.raises(gk.DesignError) as caught:
        gk.crank_rocker(50, 200, **{name: 9.9e8})
    most = float(caught.value.remedy.split()[1])
    assert float(caught.value.problem.split()[-2]) / 1e9 == pytest.approx(9.9e8 / most, rel=1e-4)
    assert max(gk.crank_rocker(50, 200, **{name: most}).lengths.values()) == pytest.approx(1e9, rel=1e-6)
    with pytest.raises(gk.DesignError):
        gk.crank_rocker(50, 200, **{name: 1.000001 * most})


@pytest.mark.parametrize("name", ["rocker"])
def test_a_link_that_would_be_too_short_is_refused_with_the_length_that_works(name):
    with pytest.raises(
        gk.DesignError, match=f"{name}: found 1.1e-12 mm, which makes a link of .*; give at least"
    ) as caught:
        gk.crank_rocker(50, 200, **{name: 1.1e-12})
    least = float(caught.value.remedy.split()[-2])
    assert float(caught.value.problem.split()[-2]) / 1e-12 == pytest.approx(1.1e-12 / least, rel=1e-4)
    assert min(gk.crank_rocker(50, 200, **{name: least}).lengths.values()) == pytest.approx(1e-12, rel=1e-6)
    with pytest.raises(gk.DesignError):
        gk.crank_rocker(50, 200, **{name: 0.999999 * least})
