"""Deviations by tolerances and clearances, against linkages solved at their limits by other formulas."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.tolerance_analysis import length_names
from tests.campaign import by_default
from tests.linkage.examples import ALL

DRIVE = np.linspace(0, 2 * np.pi, 24, endpoint=False)
SIZES = {"ground": 100.0, "crank": 30.0, "coupler": 90.0, "rocker": 70.0}
FOUR_BAR = gk.FourBar(**SIZES, coupler_point=40 + 25j)
MOTION = gk.move(FOUR_BAR, DRIVE)


def four_bar(ground=100, crank=30, coupler=90, rocker=70, point=40 + 25j, gaps=(0, 0, 0, 0), drive=DRIVE):
    """Coupler point and rocker angle by the intersection of two circles.

    gaps: displacements of the holes from their pins, mm: at the crank pivot, the crank pin, the rocker pin and the
    rocker pivot, each of the second body from the first in the order crank, coupler, rocker, ground.
    """
    start = gaps[0] + crank * np.exp(1j * drive) + gaps[1]
    end = ground - gaps[3] - gaps[2]
    apart = end - start
    distance = np.abs(apart)
    along = (coupler**2 - rocker**2 + distance**2) / (2 * distance)
    with np.errstate(invalid="ignore"):
        across = np.sqrt(coupler**2 - along**2)
    pin = start + apart / distance * (along + 1j * across)
    return start + point * (pin - start) / coupler, np.angle(pin - end)


EXACT = four_bar()


def test_worst_case_is_that_of_all_combinations_of_limits():
    tolerance = 1e-4
    corners = [
        four_bar(**{name: size + sign * tolerance for (name, size), sign in zip(SIZES.items(), signs)})
        for signs in product((1, -1), repeat=4)
    ]
    angle = gk.tolerances(MOTION, "rocker_angle", dict.fromkeys(SIZES, tolerance)).worst_case
    largest = np.max([np.abs(found - EXACT[1]) for _, found in corners], axis=0)
    assert angle == pytest.approx(largest, rel=1e-5)
    point = gk.tolerances(MOTION, "coupler_point", dict.fromkeys(SIZES, tolerance))
    distance = np.max([np.abs(found - EXACT[0]) for found, _ in corners], axis=0)
    assert point.worst_case == pytest.approx(distance, rel=1e-4)
    direction = np.exp(0.3j * np.arange(24))
    along = np.max([np.abs(((found - EXACT[0]) / direction).real) for found, _ in corners], axis=0)
    assert point.worst_case_along(direction) == pytest.approx(along, rel=1e-4)


def test_two_perpendicular_errors_of_a_point_span_a_square():
    analysis = gk.tolerances(MOTION, "coupler_point", {"coupler_point.x": 0.3, "coupler_point.y": 0.4})
    assert analysis.worst_case == pytest.approx(np.full(24, 0.5), rel=1e-4)
    assert analysis.contributions["coupler_point.x"] == pytest.approx(np.full(24, 0.3), rel=1e-4)


@pytest.mark.parametrize("number", range(4))
def test_clearance_lets_a_pin_go_round_in_its_circle(number):
    """Both holes of the pin are loose: they are at most one clearance apart, in any direction."""
    clearance, pin = 1e-3, ("crank_pivot", "crank_pin", "rocker_pin", "rocker_pivot")[number]
    rounds = [
        four_bar(gaps=[clearance * np.exp(1j * way) if k == number else 0 for k in range(4)])[1]
        for way in np.linspace(0, 2 * np.pi, 720, endpoint=False)
    ]
    analysis = gk.tolerances(MOTION, "rocker_angle", clearances={pin: clearance})
    assert analysis.worst_case == pytest.approx(np.max(np.abs(rounds - EXACT[1]), axis=0), rel=1e-3)


def test_derivatives_of_a_slider_crank_in_closed_form():
    crank, coupler = 30.0, 90.0
    motion = gk.move(gk.SliderCrank(crank, coupler), DRIVE)
    root = np.sqrt(coupler**2 - (crank * np.sin(DRIVE)) ** 2)
    by = {
        "crank": np.cos(DRIVE) - crank * np.sin(DRIVE) ** 2 / root,
        "coupler": coupler / root,
        "offset": crank * np.sin(DRIVE) / root,
    }
    given = {"crank": 0.05, "coupler": 0.1, "offset": 0.2}
    terms = [np.abs(by[name]) * tolerance for name, tolerance in given.items()]
    analysis = gk.tolerances(motion, "slide_displacement", given)
    assert analysis.worst_case == pytest.approx(sum(terms), rel=1e-12)
    assert analysis.root_sum_square == pytest.approx(np.sqrt(sum(term**2 for term in terms)), rel=1e-12)


@pytest.mark.parametrize("rule", ["worst_case", "root_sum_square"])
@pytest.mark.parametrize("of", ["rocker_angle", "coupler_point"])
def test_loosest_tolerance_just_keeps_within_the_bound(rule, of):
    bound = 0.01 if of == "rocker_angle" else 0.6
    tolerance = gk.tolerances(MOTION, of, 0.1, 0.05).loosest(bound, rule)
    assert getattr(gk.tolerances(MOTION, of, tolerance, 0.05), rule).max() == pytest.approx(bound, rel=1e-9)


def test_worst_case_of_a_swing_is_that_of_all_combinations_of_limits():
    """Ends of the swing where crank and coupler are in line, by the cosine rule."""

    def swing(ground, crank, coupler, rocker):
        ends = (coupler + crank, coupler - crank)
        far, near = (np.arccos((ground**2 + rocker**2 - d**2) / (2 * ground * rocker)) for d in ends)
        return far - near

    tolerance, exact = 1e-4, swing(**SIZES)
    corners = [
        swing(**{name: size + sign * tolerance for (name, size), sign in zip(SIZES.items(), signs)}) - exact
        for signs in product((1, -1), repeat=4)
    ]
    ends = gk.move(FOUR_BAR, gk.linkage.dead_centres(FOUR_BAR, "rocker"))
    analysis = gk.tolerances(ends, "rocker_angle", dict.fromkeys(SIZES, tolerance))
    assert analysis.range_worst_case == pytest.approx(np.max(corners), rel=1e-5)
    assert 0.5 * np.max(corners) <= analysis.range_root_sum_square < np.max(corners)


def test_clearance_beyond_the_bound_is_refused():
    with pytest.raises(gk.DesignError) as error:
        gk.tolerances(MOTION, "coupler_point", 0.1, 0.05).loosest(0.1)
    assert error.value.field == "bound"
    assert gk.tolerances(MOTION, "crank_angle", 0.1).loosest(0.1) == np.inf


def test_random_linkages_deviate_as_their_root_sum_square():
    """Linear in small tolerances: their three standard deviations are those of the Monte Carlo analysis."""
    analysis = gk.tolerances(MOTION, "rocker_angle", 0.01)
    sampled = analysis.monte_carlo(20_000, seed=3)
    assert 3 * sampled.deviation.std(axis=1) == pytest.approx(analysis.root_sum_square, rel=0.02)
    assert sampled.largest() == pytest.approx(analysis.root_sum_square, rel=0.06)
    assert np.all(sampled.largest(1.0) < analysis.worst_case) and not sampled.not_assembled.any()
    share = np.mean(np.all(np.abs(sampled.deviation) <= 1.5e-4, axis=0))
    assert sampled.share_within(1.5e-4) == pytest.approx(share) and 0.1 < share < 0.9


def test_random_holes_fill_the_circles_of_their_clearance():
    """One loose pin at the end of an arm: both holes are displaced, their difference has the variance of two discs."""
    motion = gk.move(gk.FourBar(100, 30, 90, 70), DRIVE[:1])
    analysis = gk.tolerances(motion, "rocker_angle", clearances={"rocker_pivot": 0.2})
    deviation = analysis.monte_carlo(20_000).deviation[0]
    # A disc of radius r has the variance r^2 / 4 in any direction.
    assert deviation.std() == pytest.approx(analysis.worst_case[0] / 0.2 * np.sqrt(2 * 0.1**2 / 4), rel=0.02)
    assert np.abs(deviation).max() <= analysis.worst_case[0] * 1.01


def test_random_linkages_that_do_not_assemble_are_counted():
    """Near the end of the crank's range, by the triangle inequality of coupler, rocker and diagonal."""
    linkage = gk.FourBar(100, 70, 60, 70)
    (_, limit), *_ = gk.driver_limits(linkage)
    motion = gk.move(linkage, [limit - 0.5, limit - 1e-3, limit + 0.5])
    assert list(motion.assembled) == [True, True, False]
    analysis = gk.tolerances(motion, "rocker_angle", 0.3)
    sampled = analysis.monte_carlo(5000, seed=1)
    assert sampled.not_assembled[0] == 0 and sampled.not_assembled[2] == 0
    rng = np.random.default_rng(5)
    ground, crank, coupler, rocker = (size + rng.normal(0, 0.1, 5000) for size in (100, 70, 60, 70))
    open_share = np.mean(np.abs(ground - crank * np.exp(1j * (limit - 1e-3))) > coupler + rocker)
    assert 0.05 < open_share < 0.95
    assert sampled.not_assembled[1] / 5000 == pytest.approx(open_share, abs=0.03)
    assert sampled.share_within(10.0) == pytest.approx(1 - sampled.not_assembled[1] / 5000)
    assert np.isnan(analysis.worst_case[2])


@pytest.mark.parametrize("name", by_default(list(ALL)[::2], slice(1, None, 3)))
def test_random_linkages_of_every_example_agree_with_derivatives(name):
    linkage, drive, branch = ALL[name]
    motion = gk.move(linkage, drive[3:-1:9], branch)
    point = list(motion.linkage.bodies[list(motion.linkage.bodies)[-1]])[-1]
    analysis = gk.tolerances(motion, f"{point}_x", 1e-4, 1e-4)
    try:
        deviation = analysis.monte_carlo(600).deviation
    except gk.DesignError as error:
        assert error.field == "linkages" and name in ("loops", "actuator between moving bars")
        return
    # The standard deviation of a length is a third of its tolerance, that of a hole a quarter of its clearance.
    assert set(length_names(linkage)) == set(analysis.lengths)
    holes = [f"{body}.{pin}" for pin, bodies in motion.linkage.pins.items() for body in bodies]
    steps = [*((name, 1 / 3) for name in analysis.lengths), *((f"{h}.{axis}", 1 / 4) for h in holes for axis in "xy")]
    terms = [motion.sensitivity(f"{point}_x", name) * 1e-4 * step for name, step in steps]
    expected = np.sqrt(sum(term**2 for term in terms))
    assert deviation.std(axis=1) == pytest.approx(expected, rel=0.12, abs=1e-9)


def test_the_same_seed_gives_the_same_linkages():
    analysis = gk.tolerances(MOTION, "coupler_point", 0.1, 0.1)
    one, two, other = (analysis.monte_carlo(50, seed).deviation for seed in (1, 1, 2))
    assert np.array_equal(one, two) and not np.array_equal(one, other)


def test_a_general_linkage_has_the_deviations_of_the_named_one():
    general = replace(FOUR_BAR.linkage, bodies=FOUR_BAR.linkage.bodies)
    named, listed = (gk.tolerances(gk.move(linkage, DRIVE), "coupler_point", 0.1) for linkage in (FOUR_BAR, general))
    assert listed.worst_case == pytest.approx(named.worst_case, rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "field", "part"),
    [
        ({"of": "cuopler_point"}, "of", "coupler_point"),
        ({"of": "coupler_point", "lengths": {"crnak": 0.1}}, "lengths", "crank"),
        ({"of": "coupler_point", "lengths": {"ground_angle_deg": 0.1}}, "lengths", "ground"),
        ({"of": "coupler_point", "lengths": -0.1}, "lengths", "0"),
        ({"of": "coupler_point", "clearances": {"crank": 0.1}}, "clearances", "crank_pin"),
    ],
)
def test_unknown_names_are_refused(arguments, field, part):
    with pytest.raises(gk.DesignError) as error:
        gk.tolerances(MOTION, **arguments)
    assert error.value.field == field and part in error.value.remedy


def test_too_many_linkages_are_refused_before_they_are_moved():
    with pytest.raises(gk.DesignError) as error:
        gk.tolerances(MOTION, "coupler_point", 0.1).monte_carlo(9_000_000)
    assert error.value.id == "too-much-work"
    many = gk.move(gk.FourBar(100, np.array([30.0, 31.0]), 90, 70), DRIVE)
    with pytest.raises(gk.DesignError):
        gk.tolerances(many, "rocker_angle", 0.1)


def test_many_linkages_are_not_followed_from_frame_to_frame():
    followed = gk.move(MOTION.linkage, MOTION.drive, "follow")
    with pytest.raises(gk.DesignError) as error:
        gk.tolerances(followed, "coupler_point", 0.1).monte_carlo(10)
    assert error.value.field == "branch" and error.value.id == "too-much-work"


def test_shares_within_the_root_sum_square_follow_from_the_distributions():
    """Two equal lengths in line, and a point that deviates in two directions, in closed form."""
    slider = gk.move(gk.SliderCrank(crank=30, coupler=90), [0.0])
    sum_of_two = gk.tolerances(slider, "slide_displacement", {"crank": 0.1, "coupler": 0.1})
    assert sum_of_two.share_within_root_sum_square("uniform") == pytest.approx(1 - (2 - 2**0.5) ** 2 / 4, abs=0.004)
    assert sum_of_two.share_within_root_sum_square() == pytest.approx(0.9973, abs=0.001)
    bars = gk.move(gk.FourBar(100, 30, 90, 70, coupler_point=40 + 25j), [1.0])
    around = gk.tolerances(bars, "coupler_point", {"coupler_point.x": 0.1, "coupler_point.y": 0.1})
    assert around.share_within_root_sum_square("uniform") == pytest.approx(np.pi / 4, abs=0.005)
    assert around.share_within_root_sum_square("normal") == pytest.approx(1 - np.exp(-4.5), abs=0.002)
    # The hole of a pin lies anywhere in a circle, whose radius is the root sum square of the crank's pin.
    hole = gk.tolerances(bars, "crank_pin", 0.0, {"crank_pivot": 0.2})
    assert hole.share_within_root_sum_square("uniform") == 1
