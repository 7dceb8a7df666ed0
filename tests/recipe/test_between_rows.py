"""Extremes of checks and summaries are those of the motion, not of the rows of its table."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.drive_limits import largest_between
from tests.gallery import RECIPES

FOUR_BAR = {"ground": 100, "crank": 30, "coupler": 90, "rocker": 70, "coupler_point": [40, 25]}
OPEN = {"ground": 100, "crank": 60, "coupler": 50, "rocker": 70}
PUSHED = {"forces": [{"body": "rocker", "point": "rocker_pin", "force_n": [3, 0]}]}


def four_bar(step, linkage=FOUR_BAR, **more):
    return gk.load({"kind": "four-bar", "linkage": linkage, "drive": {"step_deg": step}, **more})


def numbers_of(checks):
    return {check.id: check.value for check in checks}


@pytest.mark.parametrize("step", [30, 7])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_share_that_is_reached_follows_from_the_cosine_rule(step, direction):
    recipe = gk.load({"kind": "four-bar", "linkage": OPEN, "drive": {"step_deg": step, "speed_rpm": direction}})
    limit = np.degrees(np.arccos((100**2 + 60**2 - (50 + 70) ** 2) / (2 * 100 * 60)))
    check = next(check for check in recipe.motion_checks if check.id == "share_reached")
    assert check.value == pytest.approx(100 * limit / 180, rel=1e-9)
    assert check.at == pytest.approx(direction * limit, rel=1e-9)


def test_a_gap_between_two_rows_is_found():
    """The linkage opens for less than a row near 180 deg, where coupler and rocker are too short by 0.01 mm."""
    bars = {"ground": 100, "crank": 30, "coupler": 60, "rocker": 69.99}
    recipe = gk.load({"kind": "four-bar", "linkage": bars, "drive": {"step_deg": 8}})
    assert recipe.motion.assembled.all()
    gap = np.pi - np.arccos((100**2 + 30**2 - 129.99**2) / (2 * 100 * 30))
    check = next(check for check in recipe.motion_checks if check.id == "share_reached")
    assert check.value == pytest.approx(100 * (1 - gap / np.pi), rel=1e-9) and not check.passed


@pytest.mark.parametrize("step", [30, 7])
def test_the_transmission_angle_passes_90_deg_and_is_0_at_a_limit(step):
    assert four_bar(step).quantities["transmission angle"].split()[2] == "90"
    least, _, largest = four_bar(step, OPEN).quantities["transmission angle"].split()[:3]
    assert (least, largest) == ("0", "90")


@pytest.mark.parametrize(
    "more",
    [
        {"tolerances": {"of": "rocker_angle", "limit": 0.2}},
        {"loads": PUSHED, "stock": {"material": "steel-S235"}},
        {"loads": PUSHED, "copies": [{"phase_deg": 77}, {"phase_deg": 90, "mirrored": True}]},
    ],
    ids=["tolerances", "loads", "copies"],
)
def test_extremes_do_not_depend_on_the_rows(more):
    fine, coarse = four_bar(8, **more), four_bar(30, **more)
    values = numbers_of(fine.design_checks)
    for id, value in numbers_of(coarse.design_checks).items():
        # The margin of the motor also depends on a mean over the rows.
        assert value == pytest.approx(values[id], rel=1e-2 if id == "motor_torque" else 1e-8), id


def test_checks_of_a_walker_are_the_same_at_every_step():
    walker = gk.load(RECIPES / "motor-walker.toml")

    def values(step):
        recipe = dataclasses.replace(walker, drive=dataclasses.replace(walker.drive, step_deg=step))
        return numbers_of([*recipe.aspect("foot").checks, *recipe.aspect("loads").checks])

    assert values(90) == pytest.approx(values(4), rel=1e-9)


def test_strength_and_peaks_are_the_same_at_every_step():
    crank_rocker = gk.load(RECIPES / "loaded-crank-rocker.toml")
    loads = [
        dataclasses.replace(crank_rocker, drive=dataclasses.replace(crank_rocker.drive, step_deg=step)).aspect("loads")
        for step in (1, 90)
    ]
    fine, coarse = (numbers_of(aspect.checks) for aspect in loads)
    assert coarse == pytest.approx(fine, rel=1e-9)
    peaks, other = ({name: value for name, (value, _) in aspect.peaks.items()} for aspect in loads)
    assert other == pytest.approx(peaks, rel=1e-9)


def test_peaks_of_forces_are_those_of_a_fine_table():
    peaks = four_bar(24, loads=PUSHED).aspect("loads").peaks
    fine = four_bar(0.1, loads=PUSHED)
    driver, pin = np.abs(fine.table["driver_torque"]), fine.aspect("loads").analysis.pin("rocker_pin", "rocker")
    assert peaks["driver"][0] == pytest.approx(driver.max(), rel=1e-5)
    assert peaks["driver"][1] == pytest.approx(fine.motion.drive[np.argmax(driver)], abs=2e-3)
    assert peaks["rocker_pin"][0] == pytest.approx(np.abs(pin).max(), rel=1e-5)


@pytest.mark.campaign
def test_the_tilt_of_a_walker_jumps_between_two_rows():
    walker = gk.load(RECIPES / "motor-walker.toml")

    def tilts(step):
        return dataclasses.replace(walker, drive=dataclasses.replace(walker.drive, step_deg=step)).aspect("foot").stance

    fine = tilts(0.25)
    for direction, (low, high) in tilts(12).tilt_range_deg.items():
        rows = fine.tilt_deg[direction]
        assert low == pytest.approx(rows.min(), abs=0.02 * np.ptp(rows)) and low <= rows.min() + 1e-9
        assert high == pytest.approx(rows.max(), abs=0.02 * np.ptp(rows)) and high >= rows.max() - 1e-9


def test_each_output_has_its_own_peak():
    motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 14))
    waves = [
        lambda q: np.cos(q - 1),
        lambda q: -np.abs(q - 2.0),
        lambda q: np.full(q.shape, np.nan),
        lambda q: 0 * q + 3,
    ]
    values, drives = largest_between(motion, lambda moved: np.array([wave(moved.drive) for wave in waves]))
    assert values == pytest.approx([1, 0, np.nan, 3], abs=1e-12, nan_ok=True)
    assert drives == pytest.approx([1, 2, np.nan, 0], abs=1e-6, nan_ok=True)
