"""Scenes of gears and the mates that they shape."""

import numpy as np
import pytest

from tests.gallery import recipe


@pytest.mark.parametrize("name", ["straight-sided", "point-tooth", "straight-sided-ring"])
def test_a_conjugate_pair_slides_as_its_table_says(name):
    scene, table = recipe(name).scene, recipe(name).table
    heads = ("pressure_angle_deg", "sliding_mm_per_rad")
    rows = ({column.header: column.values for column in one.columns} for one in (scene.table, table))
    shown, reported = (np.stack([one[head] for head in heads]) for one in rows)
    shown, reported = (both[:, np.isfinite(both).all(axis=0)] for both in (shown, reported))
    size = np.ptp(reported, axis=1)[:, None]
    nearest = np.abs((shown[:, :, None] - reported[:, None]) / size[:, None]).max(axis=0).min(axis=1)
    assert nearest.max() < 0.03 and np.ptp(shown[1]) > 0.3 * size[1, 0]
