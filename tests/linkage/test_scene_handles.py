"""The page's plot of what each size does: against motions of linkages whose sizes are changed."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.scene_handles import size_columns

TURN = np.linspace(0, 2 * np.pi, 25)
FOUR_BAR = gk.FourBar(100, 30, 90, 70)


def by_difference(linkage, size, reported):
    ends = [
        reported(gk.move(replace(linkage, **{size: getattr(linkage, size) + step}), TURN)) for step in (1e-4, -1e-4)
    ]
    return np.abs(ends[0] - ends[1]) / 2e-4


@pytest.mark.parametrize(
    ("linkage", "prefix", "reported"),
    [
        (replace(FOUR_BAR, coupler_point=40 + 25j), "coupler_point", lambda m: m.point("coupler_point").position),
        (
            gk.SliderCrank(30, 90, 5.0, coupler_point=20 + 5j),
            "coupler_point",
            lambda m: m.point("coupler_point").position,
        ),
        (gk.SliderCrank(30, 90, 5.0), "slide_displacement", lambda m: m.slide("slide").displacement),
    ],
)
def test_effects_agree_with_changed_sizes_and_the_largest_comes_first(linkage, prefix, reported):
    columns = size_columns(gk.move(linkage, TURN))
    largest = [column.values.max() for column in columns]
    assert columns and max(np.diff(largest)) < 1e-5 and largest[-1] > 1e-6
    for column in columns:
        owner, _, size = column.id.partition("_by_")
        assert owner == prefix and column.unit == "mm/mm"
        if not size.startswith("coupler_point"):
            np.testing.assert_allclose(column.values, by_difference(linkage, size, reported), atol=1e-6)


def test_a_linkage_without_traced_points_shows_its_output():
    six_bar = gk.StephensonSixBar(gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j), 80, 60, 60 + 120j)
    (column,) = (c for c in size_columns(gk.move(six_bar, TURN)) if c.id == "output_angle_by_link")
    turned = by_difference(six_bar, "link", lambda m: np.unwrap(np.angle(m.output.direction)))
    np.testing.assert_allclose(column.values, np.degrees(turned), atol=1e-5)
    assert size_columns(gk.move(six_bar.linkage, TURN)) == ()
