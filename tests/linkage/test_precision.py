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


def long_crank_and_ground(ratio, count=10):
    """Arrays (ground, crank, coupler, rocker, angle) that close, crank and ground longer than the others by a ratio."""
    rng = np.random.default_rng(1)
    coupler, rocker = rng.uniform(1.0, 2.0, (2, 100))
    crank = ratio * rng.uniform(1.0, 2.0, 100)
    ground = crank + rng.uniform(-1.0, 1.0, 100)
    angle = rng.uniform(-0.6, 0.6, 100) / ratio
    apart = np.abs(ground - crank * np.exp(1j * angle))
    closes = (apart > np.abs(coupler - rocker) + 0.1) & (apart < coupler + rocker - 0.1)
    return tuple(sizes[closes][:count] for sizes in (ground, crank, coupler, rocker, angle))


@pytest.mark.parametrize("ratio", [1e3, 1e4, 1e5, 1e6])
def test_short_coupler_and_rocker_keep_their_digits_at_any_ratio(ratio):
    for ground, crank, coupler, rocker, angle in zip(*long_crank_and_ground(ratio)):
        motion = gk.move(gk.FourBar(ground, crank, coupler, rocker), [angle])
        for body, *exact in zip((motion.coupler, motion.rocker), *four_bar(ground, crank, coupler, rocker, angle, 1)):
            values = body.direction[0], body.first[0], body.second[0]
            # 1e-14 allows for the angle between coupler and rocker, which is not controlled.
            assert np.abs(np.array(values) - exact).max() < 1e-14 * max(1.0, *np.abs(exact))


@pytest.mark.parametrize("ratio", [1e3, 1e6])
@pytest.mark.parametrize("side", [1, -1])
def test_a_short_rod_keeps_its_digits_on_a_long_crank_with_a_large_offset(ratio, side):
    rng = np.random.default_rng(2)
    for _ in range(10):
        crank, coupler = ratio * rng.uniform(1.0, 2.0), rng.uniform(1.0, 2.0)
        offset, angle = (
            side * (crank + rng.uniform(-0.5, 0.4)),
            side * np.pi / 2 + rng.uniform(-0.3, 0.3) / np.sqrt(ratio),
        )
        motion = gk.move(gk.SliderCrank(crank, coupler, offset), [angle])
        (direction, _), (first, slide), (second, slide_second) = slider_crank(crank, coupler, offset, angle, 1)
        assert abs(motion.coupler.direction[0] - direction) < 2e-15
        slider = motion.slider.origin
        for found, exact in (
            (motion.coupler.first[0], first),
            (slider.first[0].real, slide),
            (motion.coupler.second[0], second),
            (slider.second[0].real, slide_second),
        ):
            assert found == pytest.approx(exact, rel=2e-14, abs=1e-14 * ratio)


def test_many_linkages_choose_their_form_one_by_one():
    ground, crank, coupler, rocker, angle = long_crank_and_ground(1e6, 1)
    sizes = [np.append(size, usual) for size, usual in zip((ground, crank, coupler, rocker), (100, 30, 90, 70))]
    both = gk.move(gk.FourBar(*sizes), angle)
    for k in range(2):
        alone = gk.move(gk.FourBar(*(float(size[k]) for size in sizes)), angle)
        assert both.rocker.direction[:, k] == pytest.approx(alone.rocker.direction, rel=1e-15)


def test_limits_of_a_driver_that_hardly_turns_are_exact():
    """At the limit coupler and rocker are in line: 4 a d sin^2(t / 2) = (b + c)^2 - (d - a)^2."""
    ground, crank, coupler, rocker = 1e6, 1e6 + 0.75, 1.25, 1.75
    exact = 2 * np.arcsin(np.sqrt((3.0**2 - 0.75**2) / (4 * crank * ground)))
    limits = gk.driver_limits(gk.FourBar(ground, crank, coupler, rocker), span=(-1.0, 1.0))
    assert limits == (pytest.approx((-exact, exact), rel=1e-14),)


def test_the_residual_shows_bodies_that_close_but_are_not_rigid():
    motion = gk.move(gk.FourBar(100, 30, 90, 70), [1.0])
    apart = 0.1 * motion.point("rocker_pin").position / np.abs(motion.point("rocker_pin").position)
    for body, length in (("coupler", 90), ("rocker", 70)):
        motion.solution._values["direction", body] = motion[body].direction + apart / length
    residual = gk.linkage.Motion(motion.linkage, motion.drive, motion.timing, motion.solution, motion.given).residual
    stretch = max(
        abs(abs(motion[body].direction[0]) - 1) * length for body, length in (("coupler", 90), ("rocker", 70))
    )
    assert residual == pytest.approx([stretch]) and stretch > 0.01


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
