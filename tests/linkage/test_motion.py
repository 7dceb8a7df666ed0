"""A motion as a person and a data frame have it: names that complete, one line in a shell, columns by name and unit."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from tests.linkage.examples import ALL, FEW

TURN = np.linspace(0, 2 * np.pi, 37)
FOUR_BAR = gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j)


def test_columns_are_those_of_the_table_by_name_and_unit():
    motion = gk.move(FOUR_BAR, TURN, speed=10.0)
    columns = motion.to_columns()
    assert list(columns) == [column.header for column in gk.linkage.motion_table(motion).columns]
    assert np.array_equal(columns["rocker_omega_rad_per_s"], motion.rocker.omega)
    assert np.array_equal(columns["coupler_point_y_mm"], motion.point("coupler_point").position.imag)
    assert columns["crank_angle_deg"] == pytest.approx(np.degrees(TURN))
    assert columns["time_s"] == pytest.approx(TURN / 10)
    assert {values.shape for values in columns.values()} == {TURN.shape}
    assert all(not len(values) for values in gk.move(FOUR_BAR, []).to_columns().values())


def test_a_shaper_whose_lever_would_turn_over_is_refused():
    """At a crank as long as the distance of the pivots, too: there the lever has no direction at one place."""
    for crank in (90.0, 90.5):
        with pytest.raises(gk.DesignError) as caught:
            gk.Shaper(90, crank, 180, 60, 85)
        assert caught.value.field == "crank" and "90" in caught.value.remedy
    assert gk.Shaper(90, 89.999, 180, 60, 85).crank == 89.999


def test_batch_of_four_bars_equals_single_ones():
    cranks = np.linspace(20, 40, 50)
    many = gk.move(gk.FourBar(ground=100, crank=cranks, coupler=90, rocker=70, coupler_point=40 + 25j), TURN, speed=2.0)
    least = gk.least_transmission_angle(many)
    assert many.assembled.shape == (37, 50) and least.shape == (50,)
    for k, crank in enumerate(cranks.tolist()):
        alone = gk.move(replace(FOUR_BAR, crank=crank), TURN, speed=2.0)
        assert np.array_equal(many.assembled[:, k], alone.assembled)
        assert many.rocker.alpha[:, k] == pytest.approx(alone.rocker.alpha, rel=1e-12, abs=1e-12, nan_ok=True)
        assert least[k] == pytest.approx(gk.least_transmission_angle(alone), rel=1e-12)


@pytest.mark.parametrize("name", FEW)
def test_a_driver_turns_about_its_pivot_or_has_none(name):
    """By its motion: of all its places that alone stands still, and nothing stands still where it slides or floats."""
    linkage, drive, branch = ALL[name]
    motion, general = gk.move(linkage, drive, branch), linkage.linkage
    reported = general.driver_pivot
    if general.driven_slider is not None:
        assert reported is None
        return
    points = general.bodies[general.driver]
    still = [p for p in points if np.ptp(np.abs(motion.point(p).position - motion.point(p).position[0])) < 1e-9]
    assert {complex(points[p]) for p in still} == ({complex(points[reported])} if reported else set())
    assert reported is None or reported in general.bodies[general.ground]


def test_a_root_is_found_with_its_path_and_residual():
    root = gk.linkage.newton_raphson(
        lambda x: [x[0] ** 2 + x[1] - 3, x[0] - x[1]], lambda x: [[2 * x[0], 1], [1, -1]], [1, 1]
    )
    golden = (np.sqrt(13) - 1) / 2
    assert root.converged and root.value == pytest.approx([golden, golden], rel=1e-14)
    assert root.residual < 1e-14 and np.array_equal(root.path[0], [1, 1]) and np.array_equal(root.path[-1], root.value)


def test_no_root_is_said_and_not_made_up():
    root = gk.linkage.newton_raphson(lambda x: x**2 + 1, lambda x: 2 * x, 0.7)
    assert not root.converged and root.residual >= 1


def test_double_root_converges_slowly_until_the_step_limit():
    few = gk.linkage.newton_raphson(lambda x: (x - 1) ** 2, lambda x: 2 * (x - 1), 2.0, steps=10)
    assert not few.converged and few.value[0] == pytest.approx(1, abs=2e-3)
