"""The best of a family, wherever it is; reported angles, rotations and sizes."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis.found import Found, ten_digits
from geomkin.synthesis.rockers.families import given_choice, maximise

LOW, HIGH, TOP = 0.2, 3.4, 1.2345678912345


@pytest.mark.parametrize(
    ("f", "top", "near"),
    [
        # At a flat maximum values give the place to only half of the digits.
        (lambda x: np.cos(x - TOP), TOP, 2e-9),
        (lambda x: 1e-3 * np.exp(-((x - TOP) ** 2)) + 7, TOP, 1e-7),
        (lambda x: -((x - TOP) ** 2) - 0.3 * (x - TOP) ** 3, TOP, 2e-9),
        # Corners, steps, ends, and what is out of question to one side.
        (lambda x: -np.abs(x - TOP), TOP, 1e-12),
        (lambda x: np.where(x <= TOP, x, -1.0), TOP, 1e-12),
        (lambda x: np.where(x < TOP, -np.inf, -x), TOP, 1e-12),
        (lambda x: x, HIGH, 0),
        (lambda x: -x, LOW, 0),
        (lambda x: -((x - HIGH - 1e-4) ** 2), HIGH, 0),
        (lambda x: -((x - LOW + 1e-4) ** 2), LOW, 0),
        # A narrow peak beside a broad one.
        (lambda x: np.exp(-((x - 2.9) ** 2)) + 2 * np.exp(-(((x - TOP) / 0.01) ** 2)), TOP, 1e-4),
    ],
)
def test_the_highest_place_is_found(f, top, near):
    found = maximise(f, LOW, HIGH)
    assert LOW <= found <= HIGH and abs(found - top) <= near
    fine = np.linspace(LOW, HIGH, 20_001)
    assert f(np.array([found]))[0] >= f(fine).max() - 1e-13


def test_one_thing_is_chosen_and_no_two():
    assert given_choice({"crank": None, "rocker": None}) is None
    assert given_choice({"crank": None, "rocker": 0.0}) == ("rocker", 0.0)
    with pytest.raises(gk.DesignError):
        given_choice({"crank": 1.0, "coupler": None, "rocker": 2.0, "free_angle_deg": 3.0})


@pytest.mark.parametrize(
    ("linkage", "reported"),
    [
        (
            gk.FourBar(100, 1 / 3, 90, 70, 1 / 7 - 2j, origin=3 + 1j, ground_angle_deg=20),
            {"ground": 100, "crank": 0.3333333333, "coupler": 90, "rocker": 70, "coupler_point_mm": [0.1428571429, -2],
             "origin_mm": [3, 1], "ground_angle_deg": 20},
        ),
        (
            gk.SliderCrank(30, 60, -12.5, 4j, origin=1j),
            {"crank": 30, "coupler": 60, "offset": -12.5, "coupler_point_mm": [0, 4], "origin_mm": [0, 1],
             "ground_angle_deg": 0},
        ),
        (
            gk.EllipticTrammel(60, 2 + 1j, 70.0, ground_angle_deg=-5),
            {"rod": 60, "rod_point_mm": [2, 1], "origin_mm": [0, 0], "ground_angle_deg": -5, "angle_deg": 70},
        ),
    ],
)  # fmt: skip
def test_a_summary_states_all_sizes_in_ten_digits(linkage, reported):
    found = Found(linkage=linkage, branch=-1, drive=np.zeros(2), transmission_angle_deg=np.nan, defects=("order",))
    links = [size for name, size in found.lengths.items() if name != "offset"]
    assert found.ratio == max(links) / min(links) and len(links) == len(found.lengths) - ("offset" in reported)
    rest = {"branch": -1, "transmission_angle_deg": None, "ratio": ten_digits(found.ratio), "defects": ["order"]}
    assert found.summary() == reported | rest
