"""Cognates against the curve of the linkage they come from, and Roberts' figure against his theorem."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.cognate_linkages import cognates, roberts_linkage, third_pivot

TURN = np.linspace(0.03, 0.03 + 2 * np.pi, 181)
PLACED = {"origin": 12 - 7j, "ground_angle_deg": 33.0}
LINKAGES = {
    "crank-rocker": gk.FourBar(100, 30, 90, 70, 40 + 25j, **PLACED),
    "double-crank": gk.FourBar(30, 100, 90, 70, -30 - 10j),
    "double-rocker": gk.FourBar(100, 70, 30, 90, 130 + 5j),
    "point on the coupler": gk.FourBar(100, 30, 90, 70, 45),
    "point on the coupler's line": gk.FourBar(100, 30, 90, 70, -20, **PLACED),
}


@pytest.mark.parametrize("driver", ["crank", "coupler", "rocker"])
@pytest.mark.parametrize(("name", "branch"), [(n, (-1) ** k) for k, n in enumerate(LINKAGES)])
def test_cognates_trace_the_same_point_at_the_same_time(name, driver, branch):
    given = replace(LINKAGES[name], driver=driver)
    traced = gk.move(given, TURN, branch).point("coupler_point")
    reached = np.isfinite(traced.position)
    assert reached.any()
    for cognate in cognates(given):
        links = cognate.linkage
        motion = gk.move(links, TURN + cognate.drive_offset, branch * cognate.branch)
        size = max(links.ground, links.crank, links.coupler, links.rocker)
        assert np.array_equal(motion.assembled, reached)
        own = motion.point("coupler_point")
        assert np.abs(own.position - traced.position)[reached].max() < 1e-12 * size
        far = np.abs(own.first - traced.first)[reached] / (size + np.abs(traced.first[reached]))
        # Velocities lose digits next to a dead centre of the driver, as they should.
        assert np.median(far) < 1e-13 and far.max() < 1e-9


@pytest.mark.parametrize("name", LINKAGES)
def test_turns_with(name):
    given = LINKAGES[name]
    motion = gk.move(given, TURN)
    seen = motion.assembled
    for cognate in cognates(given):
        own = gk.move(cognate.linkage, TURN + cognate.drive_offset, cognate.branch)
        assert set(cognate.turns_with) == {"crank", "coupler", "rocker"} == set(cognate.turns_with.values())
        for link, other in cognate.turns_with.items():
            between = own.bodies[link].direction[seen] * np.conj(motion.bodies[other].direction[seen])
            assert np.abs(between - between[0]).max() < 1e-11


def test_types_are_those_of_the_textbooks():
    """A crank-rocker has one crank-rocker and one double-rocker cognate; all three of a double-crank are one."""
    types = [
        [gk.linkage.grashof_type(c.linkage) for c in cognates(LINKAGES[n])] for n in ("crank-rocker", "double-crank")
    ]
    assert types == [["crank-rocker", "double-rocker", "crank-rocker"], ["double-crank"] * 3]


def test_the_third_pivot_makes_the_couplers_triangle_with_the_others():
    given = LINKAGES["crank-rocker"]
    _, left, right = (c.linkage for c in cognates(given))
    rocker_pivot = given.origin + 100 * np.exp(1j * np.radians(33))
    side = np.array([abs(third_pivot(given) - given.origin), abs(third_pivot(given) - rocker_pivot)])
    assert side == pytest.approx([left.ground, right.ground])
    assert side / 100 == pytest.approx(np.array([abs(40 + 25j), abs(40 + 25j - 90)]) / 90)
    # Left of the ground line as the coupler point is left of the coupler.
    assert np.imag(np.conj(rocker_pivot - given.origin) * (third_pivot(given) - given.origin)) > 0


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(
    ("name", "driver"), [("crank-rocker", "crank"), ("double-rocker", "coupler"), ("double-crank", "rocker")]
)
def test_roberts_figure_keeps_its_third_pivot_though_nothing_holds_it(name, driver, branch):
    given = replace(LINKAGES[name], driver=driver)
    figure = roberts_linkage(given, TURN[0], branch)
    assert len(figure.bodies) == 10 and len(figure.pins["coupler_point"]) == 3
    assert figure.ground not in figure.pins["third_pivot"]
    motion = gk.move(figure, TURN, "follow")
    assert motion.assembled.all()
    assert motion.residual.max() < 1e-9
    # 1e-9: where a parallelogram passes its change point, its dyad has lost half the digits.
    assert np.abs(motion.point("third_pivot").position - third_pivot(given)).max() < 1e-9
    traced = gk.move(given, TURN, branch).point("coupler_point").position
    assert np.abs(motion.point("coupler_point").position - traced).max() < 1e-10


@pytest.mark.parametrize("point", [0, 90, 90 + 1e-12j])
def test_a_point_at_a_pin_has_no_three_cognates(point):
    for build in (cognates, roberts_linkage):
        with pytest.raises(gk.DesignError) as caught:
            build(gk.FourBar(100, 30, 90, 70, point))
        assert caught.value.field == "coupler_point" and caught.value.remedy
