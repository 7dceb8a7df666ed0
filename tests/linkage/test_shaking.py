"""Shaking forces against momentum differentiated, best counterbalances against the conditions of an optimum."""

from dataclasses import replace

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.dynamics.shaking import (
    SliderCrankMasses,
    best_counterbalance,
    judged_counterbalance,
    shaking_force,
)
from geomkin.linkage.named_linkages import SliderCrank
from tests.campaign import by_default

ENGINE = SliderCrank(crank=30, coupler=90)
OFFSET = SliderCrank(crank=30, coupler=90, offset=12, origin=5 + 3j, ground_angle_deg=40)
MASSES = SliderCrankMasses(0.5, 0.6, 0.8, crank_centre=10 + 3j, coupler_centre=30 + 5j)
TURN = np.linspace(0, 2 * np.pi, 721)
DENSE = np.linspace(0, 2 * np.pi, 100_001)
CASES = {
    "engine": (ENGINE, replace(MASSES, crank_centre=10 + 0j, coupler_centre=30 + 0j)),
    "offset": (OFFSET, MASSES),
    "rod scarcely longer than the crank": (SliderCrank(30, 30.01), SliderCrankMasses(slider=1.0)),
    "slider alone": (ENGINE, SliderCrankMasses(slider=1.0)),
    "rod alone": (OFFSET, SliderCrankMasses(coupler=1.0, coupler_centre=60 - 40j)),
}


def first_moment(linkage, masses, angle, counterbalance):
    """Sum of mass times place, kg mm, from the two sides of the triangle; slide line along x, crank pivot at 0."""
    crank = np.exp(1j * angle)
    pin = linkage.crank * crank
    sine = (linkage.offset - pin.imag) / linkage.coupler
    rod = np.sqrt(1 - sine**2) + 1j * sine
    return (
        masses.crank * masses.crank_centre * crank
        + masses.coupler * (pin + masses.coupler_centre * rod)
        + masses.slider * (pin + linkage.coupler * rod)
        - counterbalance * crank
    )


def largest_by_scan(linkage, masses, product):
    """Largest force, N at 1 rad/s, over angles so dense that the parabola through the top three adds nothing."""
    f = np.abs(shaking_force(gk.move(linkage, DENSE), masses, product))[:-1]
    k = int(np.argmax(f))
    before, top, after = f[k - 1], f[k], f[(k + 1) % len(f)]
    return top + (after - before) ** 2 / (8 * (2 * top - before - after))


@pytest.mark.parametrize("linkage", [ENGINE, OFFSET])
@pytest.mark.parametrize("product", [20 - 6j])
def test_the_force_is_the_rate_of_change_of_momentum(linkage, product):
    speed, gain, step = 40.0, -300.0, 2e-5
    moments = [first_moment(linkage, MASSES, TURN + speed * t + gain * t**2 / 2, product) for t in (-step, 0.0, step)]
    rate = np.exp(1j * np.radians(linkage.ground_angle_deg)) * (moments[0] - 2 * moments[1] + moments[2]) / step**2
    force = shaking_force(gk.move(linkage, TURN, speed=speed, acceleration=gain), MASSES, product)
    assert np.abs(force + 1e-3 * rate).max() < 1e-5 * np.abs(force).max()


def test_a_rod_lumped_at_its_pins_shakes_the_same():
    motion = gk.move(OFFSET, TURN, speed=10.0)
    rod = shaking_force(motion, SliderCrankMasses(coupler=0.9, coupler_centre=30 + 0j))
    lumped = shaking_force(motion, SliderCrankMasses(crank=0.6, crank_centre=30 + 0j, slider=0.3))
    assert np.abs(rod - lumped).max() < 1e-12 * np.abs(rod).max()


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("product", [0.0, 30 - 4j])
def test_the_largest_force_is_that_of_every_angle(name, product):
    linkage, masses = CASES[name]
    design_checks = judged_counterbalance(linkage, masses, product)
    assert design_checks.product == product
    assert design_checks.largest == pytest.approx(largest_by_scan(linkage, masses, product), rel=1e-9)
    there = np.abs(shaking_force(gk.move(linkage, design_checks.angles), masses, product))
    assert there == pytest.approx(design_checks.largest, rel=1e-8)


@pytest.mark.parametrize("name", by_default(CASES, slice(0, None, 2)))
def test_the_best_along_the_crank_is_that_of_a_search(name):
    linkage, masses = CASES[name]
    best = best_counterbalance(linkage, masses)
    motion = gk.move(linkage, np.union1d(DENSE, best.angles))
    none = shaking_force(motion, masses)
    change = shaking_force(motion, masses, 1.0) - none
    low, high = best.product - 30, best.product + 30
    for _ in range(100):  # the largest of many convex functions is convex: thirds are enough
        one, two = low + (high - low) / 3, high - (high - low) / 3
        if np.abs(none + one * change).max() < np.abs(none + two * change).max():
            high = two
        else:
            low = one
    least = np.abs(none + low * change).max()
    assert isinstance(best.product, float)
    assert best.largest == pytest.approx(least, rel=1e-9)
    assert best.largest < np.abs(none).max()


@pytest.mark.parametrize("name", by_default(CASES, slice(0, None, 2)))
def test_no_turn_or_size_lessens_all_the_deciding_forces(name):
    """The best at any angle: no direction leads away from all deciding forces at once, and none is exceeded."""
    linkage, masses = CASES[name]
    best = best_counterbalance(linkage, masses, turned=True)
    motion = gk.move(linkage, best.angles)
    force = shaking_force(motion, masses, best.product) * np.conj(motion.crank.direction)
    around = np.sort(np.angle(force))
    widest = np.max(np.diff(np.append(around, around[0] + 2 * np.pi)))
    assert len(around) > 1 and widest <= np.pi + 1e-4
    assert largest_by_scan(linkage, masses, best.product) <= best.largest * (1 + 1e-9)
    assert best.largest <= best_counterbalance(linkage, masses).largest * (1 + 1e-12)


def test_half_the_reciprocating_mass_for_a_very_long_rod():
    """The textbook rule: a counterbalance of half the sliding mass leaves half its force all round."""
    best = best_counterbalance(SliderCrank(30, 3e6), SliderCrankMasses(slider=2.0))
    assert best.product == pytest.approx(30, rel=1e-4) and best.largest == pytest.approx(0.03, rel=1e-4)


@pytest.mark.parametrize(("coupler", "offset"), [(30, 0), (20, 0), (40, 12)])
def test_a_crank_that_does_not_turn_fully_has_no_best(coupler, offset):
    with pytest.raises(gk.DesignError) as caught:
        best_counterbalance(SliderCrank(30, coupler, offset), MASSES)
    assert caught.value.field == "coupler" and caught.value.remedy


@pytest.mark.parametrize(("field", "value"), [("slider", -1.0), ("crank", np.nan), ("coupler_centre", np.inf)])
def test_impossible_masses_are_refused_by_name(field, value):
    with pytest.raises(gk.DesignError) as caught:
        SliderCrankMasses(**{field: value})
    assert caught.value.field == field
