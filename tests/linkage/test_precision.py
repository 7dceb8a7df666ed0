"""Digits near toggles, against 60-digit arithmetic: position, velocity, acceleration, normwise."""

import numpy as np
import pytest

import geomkin as gk
from tests.linkage.exact import four_bar, slider_crank

# Units in the last place that an error may have, relative to the largest of its kind at that frame.
ULPS = 8 * np.finfo(float).eps
GAPS = [10.0**-k for k in range(16)]


def toggles():
    """(sizes, toggle angle): near-toggle four-bars of balanced lengths, by the gap, scale and kind of toggle."""
    rng = np.random.default_rng(11)
    for gap in GAPS:
        for scale in (1e-7, 1.0, 1e7):
            for stretched in (False, True):
                crank, ground = rng.uniform(1.0, 1.5), rng.uniform(2.2, 3.0)
                rocker = rng.uniform(1.5, 2.5)
                folded = ground - crank - gap * min(1.0, 0.5 * (ground - crank))
                coupler = crank + ground - rocker + gap if stretched else rocker + folded
                yield gap, np.array([ground, crank, coupler, rocker]) * scale, np.pi if stretched else 0.0


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("away", [0.1, 10.0])
def test_four_bar_keeps_eight_units_at_every_toggle_gap_and_size(branch, away):
    worst = np.zeros(3)
    for gap, sizes, toggle in toggles():
        angle = toggle + branch * min(1.0, away * np.sqrt(gap))
        motion = gk.move(gk.FourBar(*sizes), [angle], branch)
        directions, first, second = four_bar(*sizes, angle, branch)
        got = [
            [getattr(motion.bodies[b], what)[0] for b in ("coupler", "rocker")]
            for what in ("direction", "first", "second")
        ]
        for k, (found, exact) in enumerate(zip(got, (directions, first, second))):
            size = max(1.0, *np.abs(exact))
            worst[k] = max(worst[k], np.abs(np.array(found) - exact).max() / size)
    assert np.all(worst < ULPS)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("away", [1.0])
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_slider_crank_keeps_eight_units_at_every_toggle_gap_and_size(branch, away, offset):
    worst = np.zeros(3)
    for gap in GAPS:
        for scale in (1e-7, 1.0, 1e7):
            for top in (1, -1):
                sizes = scale * np.array([1.3, 1.3 - top * offset + gap, offset])
                angle = top * 0.5 * np.pi + branch * min(1.0, away * np.sqrt(gap))
                motion = gk.move(gk.SliderCrank(*sizes), [angle], branch)
                exact = slider_crank(*sizes, angle, branch)
                slider = motion.slider.origin
                got = [
                    (motion.coupler.direction[0], slider.position[0].real / sizes[0]),
                    (motion.coupler.first[0], slider.first[0].real / sizes[0]),
                    (motion.coupler.second[0], slider.second[0].real / sizes[0]),
                ]
                for k, (turn, place) in enumerate(exact):
                    place = place / sizes[0]
                    size = max(1.0, abs(turn), abs(place))
                    worst[k] = max(worst[k], abs(got[k][0] - turn) / size, abs(got[k][1] - place) / size)
    assert np.all(worst < ULPS)


@pytest.mark.parametrize("scale", [1e-7, 1e7])
@pytest.mark.parametrize("away", [1e-15, 1e-3])
def test_equal_crank_and_rod_in_line_keep_their_digits_to_the_singular_point(scale, away):
    angle = 0.5 * np.pi - away
    motion = gk.move(gk.SliderCrank(2 * scale, 2 * scale), [angle])
    # The rod mirrors the crank: the slider is at 4 cos, its rates follow.
    assert motion.coupler.direction[0] == pytest.approx(np.exp(-1j * angle), abs=ULPS)
    assert motion.coupler.first[0] == pytest.approx(-1, abs=ULPS)
    assert motion.slider.origin.first[0].real == pytest.approx(-4 * scale * np.sin(angle), rel=ULPS)
    assert motion.slider.origin.second[0].real == pytest.approx(-4 * scale * np.cos(angle), abs=ULPS * 4 * scale)


WORST = {
    "four-bar": (lambda e: gk.FourBar(100, 30, 90 + e, 70), np.linspace(0.1, 6.2, 40), "rocker_pin"),
    "slider-crank": (lambda e: gk.SliderCrank(30, 90 + e, 12), np.linspace(0.1, 6.2, 40), "slider_pin"),
    "slotted lever": (lambda e: gk.InvertedSliderCrank(80, 30, 40 + e), np.linspace(0.1, 6.2, 40), None),
    "piston": (lambda e: gk.SliderCrank(30, 90 + e, 12, driver="slider"), np.linspace(60, 110, 40), "crank_pin"),
}


@pytest.mark.parametrize("name", WORST)
def test_error_amplification_agrees_with_differences(name):
    """By a bar that is a little too long, or an offset too large: how far that takes its joint."""
    build, drive, pin = WORST[name]
    step = 1e-6
    short, right, long = (gk.move(build(e), drive) for e in (-step, 0.0, step))
    if pin:
        moved = np.abs(long.point(pin).position - short.point(pin).position) / (2 * step)
    else:
        # How far the turning lever takes the crank pin across the line of the pins.
        turned = np.angle(long.rocker.direction / short.rocker.direction) / (2 * step)
        moved = np.abs(turned) * np.abs(right.point("crank_pin").position - 80)
    assert right.error_amplification == pytest.approx(moved, rel=1e-6) and np.ptp(moved) > 0.01
