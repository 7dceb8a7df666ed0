"""Tables are read by name, and handed on whole."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.model.table import significant


def test_unreachable_points_are_empty_in_both_coordinates(tmp_path):
    """Of places, velocities and accelerations at frames that a linkage does not reach; and so in the file."""
    linkage = gk.FourBar(100, 80, 60, 50, coupler_point=20 + 10j)
    motion = gk.move(linkage, np.radians(np.arange(0, 361, 15)))
    assert 0 < motion.assembled.sum() < len(motion.assembled)
    table = gk.linkage.motion_table(motion)
    gk.write(table, tmp_path / "t.csv")
    header, *rows = [line.split(",") for line in (tmp_path / "t.csv").read_text().splitlines()]
    reported = {name: [row[k] != "" for row in rows] for k, name in enumerate(header)}
    for column in table.columns:
        if column.id not in ("crank_angle", "time", "rocker_pin_branch"):
            assert np.isfinite(column.values).tolist() == reported[column.header] == motion.assembled.tolist(), (
                column.id
            )


HUGE = np.array([1e17, 1e17, -133.33333333333, 1.23456789012e-5, np.nan, np.inf, 0.0, 2e300])


def test_ten_digits_of_each_value_however_large_others_are():
    reported = significant(HUGE)
    assert reported == pytest.approx(HUGE, rel=5e-10, abs=1e-9, nan_ok=True) and reported[2] == -133.3333333
    assert [float(f"{value:.9e}") for value in reported[:4]] == reported[:4].tolist()


@pytest.mark.parametrize("size", [1e-9, 1e-3, 1.0, 1e9])
def test_rounding_noise_is_written_as_0(size):
    values = size * np.array([2e-16, -3e-15, 1.0, 1e-11, -1e-17])
    known = significant(values, size)
    assert known.tolist()[:2] == [0, 0] and known[4] == 0 and not np.signbit(known[[0, 1, 4]]).any()
    assert known[3] == pytest.approx(values[3], rel=0.1) or size > 1
