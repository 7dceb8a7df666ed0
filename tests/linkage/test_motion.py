"""A motion as a person and a data frame have it: names that complete, one line in a shell, columns by name and unit."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import geomkin as gk
from tests.linkage.examples import ALL

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


@pytest.mark.parametrize("timing", [{"speed": 0.0}, {"acceleration": 2.0}, {"speed": 1 + TURN}])
def test_a_time_that_the_drive_does_not_tell_is_nan(timing):
    assert np.isnan(gk.move(FOUR_BAR, TURN, **timing).to_columns()["time_s"]).all()


def test_a_shaper_whose_lever_would_turn_over_is_refused():
    """At a crank as long as the distance of the pivots, too: there the lever has no direction at one place."""
    for crank in (90.0, 90.5):
        with pytest.raises(gk.DesignError, match="crank: .*turns over.*give less than 90 mm"):
            gk.Shaper(90, crank, 180, 60, 85)
    assert gk.Shaper(90, 89.999, 180, 60, 85).crank == 89.999


def test_columns_of_many_linkages_are_refused():
    many = gk.move(replace(FOUR_BAR, crank=np.linspace(20, 40, 5)), TURN)
    with pytest.raises(gk.DesignError, match=r"\(5,\) linkages.*one at a time"):
        many.to_columns()


def test_bodies_complete_in_a_shell():
    motion = gk.move(FOUR_BAR, TURN)
    assert {"crank", "coupler", "rocker", "ground", "point", "to_columns"} <= set(dir(motion))
    assert all(hasattr(motion, name) for name in dir(motion))
    with pytest.raises(AttributeError, match="no body named 'coupeler'; there are ground, crank, coupler, rocker"):
        motion.coupeler
    with pytest.raises(gk.DesignError, match="pen.*crank_pivot, rocker_pivot, crank_pin"):
        motion.point("pen")
    with pytest.raises(gk.DesignError, match="slide"):
        motion.slide("slide")


def test_all_that_a_motion_offers_is_one_line_in_a_shell():
    for linkage, drive, branch in ALL.values():
        motion = gk.move(linkage, drive, branch)
        slides = [motion.slide(slider.name) for slider in motion.linkage.sliders]
        points = [motion.point(point) for points in motion.linkage.bodies.values() for point in points]
        things = [linkage, motion, motion.timing, motion.linkage, *motion.bodies.values(), *points]
        things += [*motion.linkage.sliders, *slides, motion.solution]
        for text in map(repr, things):
            assert "\n" not in text and len(text) <= 120
    assert repr(gk.move(FOUR_BAR, TURN).coupler) == "Body(name='coupler')"
    opened = gk.linkage.assembly_failure(gk.move(gk.FourBar(4, 3, 2, 2.5), [2]))
    root = gk.linkage.newton_raphson(lambda x: x**2 - 2, lambda x: np.diag(2 * x), np.ones(40))
    many = gk.FourBar(100, np.linspace(20, 40, 50), 90, 70)
    for thing in (opened, root, many, many.linkage, gk.move(many, TURN), gk.move(many, TURN).rocker):
        assert "\n" not in repr(thing) and len(repr(thing)) <= 120


def test_sizes_are_shown_as_they_are_made():
    assert repr(FOUR_BAR) == "FourBar(ground=100, crank=30, coupler=90, rocker=70, coupler_point=(40+25j))"
    assert eval(repr(FOUR_BAR), {"FourBar": gk.FourBar}) == FOUR_BAR


def test_many_four_bars_at_once_are_each_what_it_is_alone():
    cranks = np.linspace(20, 40, 50)
    many = gk.move(gk.FourBar(ground=100, crank=cranks, coupler=90, rocker=70, coupler_point=40 + 25j), TURN, speed=2.0)
    least = gk.least_transmission_angle(many)
    assert many.assembled.shape == (37, 50) and least.shape == (50,)
    for k, crank in enumerate(cranks.tolist()):
        alone = gk.move(replace(FOUR_BAR, crank=crank), TURN, speed=2.0)
        assert np.array_equal(many.assembled[:, k], alone.assembled)
        assert many.rocker.alpha[:, k] == pytest.approx(alone.rocker.alpha, rel=1e-12, abs=1e-12, nan_ok=True)
        assert least[k] == pytest.approx(gk.least_transmission_angle(alone), rel=1e-12)


@dataclass(frozen=True)
class Parallelogram(gk.linkage.AbstractLinkage):
    """A linkage of one's own: what it is made of, as bodies with named points."""

    ground: float
    crank: float

    @property
    def linkage(self):
        return gk.FourBar(self.ground, self.crank, self.ground, self.crank).linkage


def test_a_linkage_of_ones_own_moves_like_any():
    motion = gk.move(Parallelogram(100, 30), TURN, "follow")
    assert motion.rocker.direction == pytest.approx(np.exp(1j * TURN))
    with pytest.raises(TypeError, match="abstract"):
        gk.linkage.AbstractLinkage()


def test_the_allocator_of_the_host_is_left_as_it_was():
    """A block of many megabytes that is freed makes glibc keep all smaller ones for the rest of the process."""
    import subprocess
    import sys

    code = (
        "import tracemalloc; import numpy; tracemalloc.start(); import geomkin as gk; gk.move\n"
        "print(tracemalloc.get_traced_memory()[1])"
    )
    peak = int(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
    assert peak < 16e6


@pytest.mark.parametrize("name", ALL)
def test_a_driver_turns_about_its_pivot_or_has_none(name):
    """By its motion: of all its places that alone stands still, and nothing stands still where it slides or floats."""
    linkage, drive, branch = ALL[name]
    motion, general = gk.move(linkage, drive, branch), linkage.linkage
    told = general.driver_pivot
    if general.driven_slider is not None:
        assert told is None
        return
    points = general.bodies[general.driver]
    still = [p for p in points if np.ptp(np.abs(motion.point(p).position - motion.point(p).position[0])) < 1e-9]
    assert {complex(points[p]) for p in still} == ({complex(points[told])} if told else set())
    assert told is None or told in general.bodies[general.ground]
