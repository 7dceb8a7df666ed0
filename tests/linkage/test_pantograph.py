"""The pantograph: pole, tracer and pen in line, at every frame and size."""

import numpy as np
import pytest

import geomkin as gk

SIZES = [
    {"arm": 150, "forearm": 150, "ratio": 3, "crank": 15, "crank_pivot": 65 + 0j},
    {"arm": 120, "forearm": 200, "ratio": 1.5, "crank": 30, "crank_pivot": -90 + 60j},
    {"arm": 300, "forearm": 260, "ratio": 8, "crank": 4, "crank_pivot": 20 - 40j, "ground_angle_deg": 25, "origin": 7j},
]


@pytest.mark.parametrize("sizes", SIZES)
def test_the_pen_copies_the_tracer_about_the_pole(sizes):
    motion = gk.move(gk.linkage.Pantograph(**sizes), np.linspace(0, 2 * np.pi, 73), speed=2.0)
    assert motion.assembled.all()
    pole, tracer, pen = (motion.point(name) for name in ("pole", "tracer", "pen"))
    np.testing.assert_allclose(
        pen.position - pole.position, sizes["ratio"] * (tracer.position - pole.position), atol=1e-9
    )
    np.testing.assert_allclose(pen.velocity, sizes["ratio"] * tracer.velocity, atol=1e-9)
    centre = np.mean(tracer.position[:-1])
    np.testing.assert_allclose(abs(tracer.position - centre), sizes["crank"], rtol=1e-9)


def test_crossed_bars_do_not_copy():
    linkage = gk.linkage.Pantograph(**SIZES[0])
    motion = gk.move(linkage, np.linspace(0, 2 * np.pi, 73), {"arm_joint": 1, "forearm_joint": -1})
    pen, tracer = motion.point("pen").position, motion.point("tracer").position
    assert np.abs(pen - 3 * tracer).max() > 10


def test_bars_out_of_reach_are_refused():
    with pytest.raises(gk.DesignError) as caught:
        gk.linkage.Pantograph(arm=100, forearm=100, ratio=4, crank=5, crank_pivot=60 + 0j)
    assert caught.value.field == "crank_pivot"
