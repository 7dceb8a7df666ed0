"""Path searches in their own units and in mm: bounds, what is made of a row of numbers, what is ranked as one."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.path import search
from geomkin.synthesis.path.coupler_paths import FREE, LONGEST, SHORTEST, bounds_of
from geomkin.synthesis.path.crank_motion import crank_motion
from geomkin.synthesis.path.path_found import PathFound
from tests.synthesis.test_path_fits import CROSSING, at, task_of

PLACES = {"coupler_point_x": 4, "coupler_point_y": 5, "origin_x": 6, "origin_y": 7}
ANGLES = {"ground_angle_deg": 8, "start_deg": 9}
LINKS = {"ground": 0, "crank": 1, "coupler": 2, "rocker": 3}
SLIDER = {"offset": 0, "crank": 1, "coupler": 2}
MIDDLE, SIZE = 30 - 70j, 4.0


@pytest.mark.parametrize("slides", [False, True])
def test_bounds_are_converted_to_the_units_of_the_search(slides):
    plain = np.array(bounds_of(None, slides, True, MIDDLE, SIZE))
    wide = [[-LONGEST, LONGEST]] * 10
    wide[0:4] = [[SHORTEST, LONGEST]] * 4
    wide[8:] = [[-FREE, FREE]] * 2
    if slides:
        wide[0], wide[3] = [-LONGEST, LONGEST], [1, 1]
    assert plain.T.tolist() == wide
    for name, k in {**(SLIDER if slides else LINKS), **PLACES, **ANGLES}.items():
        low, high = bounds_of({name: (10, 34)}, slides, True, MIDDLE, SIZE)
        shift = {"origin_x": MIDDLE.real, "origin_y": MIDDLE.imag}.get(name, 0.0)
        unit = 180 / np.pi if name in ANGLES else SIZE
        assert [low[k] * unit + shift, high[k] * unit + shift] == pytest.approx([10, 34])
        others = np.arange(10) != k
        assert (low[others] == plain[0, others]).all() and (high[others] == plain[1, others]).all()
        # From below the least, or to beyond the greatest that there is: that stays.
        least = 0 if name != "offset" and name in {**LINKS, **SLIDER} else -9e8
        low, high = bounds_of({name: (least, 9e8)}, slides, True, MIDDLE, SIZE)
        if name not in ANGLES:
            assert [low[k], high[k]] == plain[:, k].tolist()
    # One value may be given, too, and one in each direction of a place; a length has to be above 0.
    for name in ("offset" if slides else "coupler_point_x", "origin_y", "ground_angle_deg"):
        for value in (0, -3):
            low, high = bounds_of({name: (value, value)}, slides, False, MIDDLE, SIZE)
            assert (low == high).sum() == 1 + slides
    for name in ("crank", "coupler") if slides else LINKS:
        for bounds in ((-1, 0), (0, 0), (-5, 10)):
            with pytest.raises(gk.DesignError):
                bounds_of({name: bounds}, slides, False, MIDDLE, SIZE)
        low, _ = bounds_of({name: (0, 1e-3)}, slides, False, MIDDLE, SIZE)
        assert low[SLIDER[name] if slides else LINKS[name]] == SHORTEST
        with pytest.raises(gk.DesignError):
            bounds_of({name: (1e-9, 1e-7)}, slides, False, MIDDLE, SIZE)


def found_of(linkage, branch=1):
    return PathFound(
        linkage=linkage, branch=branch, drive=np.zeros(3), transmission_angle_deg=40.0, defects=(),
        points=np.zeros(3), square_error=0.0, largest_distance=0.0, rms_distance=0.0,
    )  # fmt: skip


def test_usable_linkages_have_no_defect_and_keep_both_limits():
    good = dataclasses.replace(found_of(gk.FourBar(90, 9, 80, 85, 40 + 45j)), transmission_angle_deg=30.0)
    assert good.ratio == pytest.approx(10) and good.is_usable and good.usable is good and good.coupler_point == 40 + 45j
    assert dataclasses.replace(good, transmission_angle_deg=30 - 2e-5).is_usable
    long = gk.FourBar(90.001, 9, 80, 85)
    for worse in ({"transmission_angle_deg": 29.99}, {"linkage": long}, {"defects": ("order",)}):
        other = dataclasses.replace(good, **worse)
        assert not other.is_usable and other.usable is None
        assert dataclasses.replace(other, again=lambda: good).usable is good
    reported = dataclasses.replace(good, square_error=1.23456789e-3, largest_distance=0.0123456789).summary()
    assert (reported["square_error_mm2"], reported["largest_distance_mm"]) == (1.23457e-3, 0.0123457)
    assert dataclasses.replace(good, drive=np.array([0, np.pi / 2, 7])).drive_deg == pytest.approx([0, 90, 401.0704566])


def search_of(task, **changed):
    asked = {"points": task.wanted * 4 + MIDDLE, "middle": MIDDLE, "size": SIZE, "task": task, "bounded": frozenset()}
    return search.PathSearch(**asked | {"all_nine": False, "seed": 0, "time_limit": 60.0} | changed)


@pytest.mark.parametrize("slides", [False, True])
@pytest.mark.parametrize("asked", ["open", "closed", "timed"])
def test_row_of_the_search_is_converted_to_a_linkage_in_mm(asked, slides):
    x = CROSSING.copy()
    x[[0, 6, 7, 8, 9]] = 0.3 if slides else 3.0, 0.5, -2.0, 3.5, -7.0
    drive = np.linspace(0, 4.0, 6) - 7
    wanted = at(x, drive, 1.0, slides) + 0.01j
    task = task_of(wanted, closed=asked == "closed", turns=drive + 7 if asked == "timed" else None, slides=slides)
    found = search_of(task).made(x, drive, np.ones(6, dtype=int))
    assert isinstance(found.linkage, gk.SliderCrank if slides else gk.FourBar) and not found.defects
    # A ground angle within half a turn, unless bounds say where it is; a drive that begins in the first turn likewise.
    assert found.linkage.ground_angle_deg == pytest.approx(np.degrees(3.5) - 360)
    reported = search_of(task, bounded=frozenset({"ground_angle_deg", "start_deg"})).made(
        x, drive, np.ones(6, dtype=int)
    )
    assert reported.linkage.ground_angle_deg == pytest.approx(np.degrees(3.5))
    if asked == "closed":
        assert found.drive == pytest.approx(drive % (2 * np.pi)) and reported.drive == pytest.approx(found.drive)
    else:
        assert found.drive == pytest.approx(drive + 4 * np.pi) and reported.drive == pytest.approx(drive)
    places = gk.move(found.linkage, found.drive, found.branch).point("coupler_point").position
    assert places == pytest.approx(found.points - 0.04j) and found.points == pytest.approx(SIZE * wanted + MIDDLE)
    assert found.square_error == pytest.approx(6 * 0.04**2) and found.largest_distance == pytest.approx(0.04)
    span = (0, 2 * np.pi) if asked == "closed" else (drive[0], drive[-1])
    least = gk.least_transmission_angle(gk.move(found.linkage, np.linspace(*span, 5001)))
    assert found.transmission_angle_deg == pytest.approx(np.degrees(least), abs=1e-3) and found.at_limits == ()
    # What is no linkage in mm is none.
    x[1] = 1e-20
    assert search_of(task).made(x, drive, np.ones(6, dtype=int)) is None


@pytest.mark.parametrize("sense", [1, -1])
def test_a_crank_that_stays_for_a_point_goes_no_turn_for_it(sense):
    task = task_of(np.ones(4))
    for hair in (0.0, 1e-12, -1e-12):
        cranks = 3 + sense * np.array([-1, 0, hair, 1])
        way = crank_motion(task, CROSSING, cranks, np.ones(4, dtype=int))
        assert way.defects == () and way.drive == pytest.approx(cranks, abs=1e-9)


def test_of_both_senses_the_shorter_is_taken_if_it_closes():
    # A crank that turns fully can go either way; the one of a double rocker only the way that it swings.
    task, ones = task_of(np.ones(3)), np.ones(3, dtype=int)
    for cranks, drive in (
        ([0.2, 1.0, 2.0], [0.2, 1.0, 2.0]),
        ([0.2, 6.0, 5.0], [0.2, 6.0 - 2 * np.pi, 5.0 - 2 * np.pi]),
    ):
        for turned in (0, 2, -4):
            way = crank_motion(task, CROSSING, np.array(cranks) + np.array([0, 0, turned * np.pi]), ones)
            assert way.defects == () and way.drive == pytest.approx(drive)
    swinging = np.array([3.0, 1.0, 1.9, 1.7, 1.5, -1.6, 0, 0, 0, 0])
    reach = [q for q in np.linspace(0, 2 * np.pi, 721) if np.isfinite(at(swinging, [q]))[0]]
    gap = np.argmax(np.diff(reach))
    # From one end of its range to the other, the long way round, as the short one goes over the gap.
    ends = np.array([reach[gap] - 0.01, reach[gap] - 0.01, reach[gap + 1] + 0.01 - 2 * np.pi])
    assert ends[0] - ends[2] > np.pi + 0.3
    for there in (ends, -ends):
        way = crank_motion(task, swinging, there % (2 * np.pi), ones)
        assert way.defects == () and np.diff(way.drive) == pytest.approx(np.diff(there)) and way.transmission > 0
    # Where both close the shorter one is taken.
    for there in ([1.0, 1.0, 0.2], [0.2, 1.0, 1.0], [0.2, 0.2, -0.5]):
        assert crank_motion(task, CROSSING, np.array(there), ones).drive == pytest.approx(there)
