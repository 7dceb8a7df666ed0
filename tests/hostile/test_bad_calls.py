"""Calls whose arguments are sound one by one and cannot be together."""

import numpy as np
import pytest

import geomkin as gk

MOTION = gk.move(gk.FourBar(100, 30, 90, 70), [0.1, 0.2])


def test_conflicting_values_are_refused():
    for call, field, found in [
        (lambda: gk.FourBar(100, np.full(3, 30.0), np.full(4, 90.0), 70), "coupler", "4 sizes, but 3 of crank"),
        (lambda: gk.FourBar(np.full(1, 100.0), np.full(3, 30.0), 90, np.full(2, 70.0)), "rocker", "2 sizes, but 3 of"),
        (
            lambda: gk.move(gk.FourBar(100, np.full(3, 30.0), 90, 70, coupler_point=np.full(4, 1j)), [0.1]),
            "bodies",
            "points of 3 and 4 linkages",
        ),
        (lambda: gk.move(gk.FourBar(100, np.ones(0), 90, 70), [0.1]), "bodies", "points of 0 linkages"),
        (lambda: gk.linkage.circuits(gk.FourBar(100, 31, 90, 70), MOTION), "motion", "another linkage"),
        (lambda: gk.linkage.circuits(gk.SliderCrank(30, 90), MOTION), "motion", "another linkage"),
        (lambda: gk.linkage.velocity_polygon(MOTION, 2), "frame", "found 2"),
        (lambda: gk.linkage.acceleration_polygon(MOTION, -3), "frame", "found -3"),
        (lambda: gk.gear.base_plate("base", [0j], [5.0, 6.0], 5.0, 3.0), "axes", "found 1"),
        (lambda: gk.flatten(gk.plane.Circle(0, 10), 1e-14), "tolerance", "70,248,147 chords"),
    ]:
        with pytest.raises(gk.DesignError, match=found) as refused:
            call()
        assert refused.value.field == field


def test_what_is_named_as_a_remedy_works():
    assert len(gk.FourBar(np.full(1, 100.0), np.full(3, 30.0), 90, 70).crank) == 3
    assert gk.linkage.circuits(gk.FourBar(100, 30, 90, 70, coupler_point=5j), MOTION).tolist() == [1, 1]
    assert gk.linkage.velocity_polygon(MOTION, 1).points and gk.linkage.velocity_polygon(MOTION, -1).points
    assert len(gk.flatten(gk.plane.Circle(0, 10), 1.974e-12)) == pytest.approx(5_000_000, rel=1e-3)


@pytest.mark.parametrize(
    ("wrong", "at", "step"), [(np.nan, 0, 1), (np.inf, 8191, -3), (-np.inf, 8192, 1), (1e61, 19_999, -3)]
)
def test_one_wrong_number_in_a_long_row_is_seen_wherever_it_stands(wrong, at, step):
    drive = np.linspace(0, 6, 60_000)[::step][:20_000]
    drive[at] = wrong
    with pytest.raises(gk.DesignError) as refused:
        gk.move(gk.FourBar(100, 30, 90, 70), drive)
    assert refused.value.field == "drive"
    sizes = np.full(20_000, 30.0)
    sizes[at] = wrong
    with pytest.raises(gk.DesignError, match="crank"):
        gk.FourBar(100, sizes, 90, 70)
