"""Effective components against differences of positions, the textbook's method, and linkages that are not rigid."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.linkage.instant.polygons import component_columns, components_check
from tests.linkage.examples import ALL

SPEED, ACCELERATION = 3.0, 2.0
LEVER = gk.InvertedSliderCrank(80, 30)


def at(linkage, drive, branch=1):
    return gk.move(linkage, drive, branch, SPEED, ACCELERATION)


@pytest.mark.parametrize("name", ["four-bar", "slider-crank", "shaper", "watt", "scotch yoke"])
def test_components_are_the_derivatives_of_positions_along_and_across_the_line(name):
    """By central differences in time, of points whose positions alone are used."""
    linkage, drive, branch = ALL[name]
    step, drive = 1e-4, np.asarray(drive)[2:-2]
    moved = [at(linkage, drive + SPEED * t + ACCELERATION * t**2 / 2, branch) for t in (-step, 0, step)]
    lines = [gk.linkage.effective_components(motion) for motion in moved]
    assert lines[1]
    for key, line in lines[1].items():
        if line.equal == "across":
            # The guide's point under the slider is another one at each frame.
            continue
        for pin in line.position:
            before, here, after = (each[key].position[pin] for each in lines)
            velocity, acceleration = (after - before) / (2 * step), (after - 2 * here + before) / step**2
            ends = list(line.position.values())
            along = (ends[1] - ends[0]) / np.abs(ends[1] - ends[0])
            size = np.abs(velocity).max() + np.abs(acceleration).max()
            assert line.velocity[pin] == pytest.approx(velocity * np.conj(along), abs=1e-5 * size + 1e-9)
            assert line.acceleration[pin] == pytest.approx(acceleration * np.conj(along), abs=1e-5 * size + 1e-9)


def test_the_textbook_method_gives_the_velocity_of_the_rocker_and_of_the_slider():
    """The pin's known path and the component along the coupler: v = v_along / cos of the angle between them."""
    drive = np.linspace(0.1, 6.2, 50)
    for linkage, pin, path in (
        (gk.FourBar(100, 30, 90, 70), "rocker_pin", lambda m: 1j * m["rocker"].direction),
        (gk.SliderCrank(30, 90, 12), "slider_pin", lambda m: np.ones(50)),
    ):
        motion = at(linkage, drive)
        coupler = motion.point(pin).position - motion.point("crank_pin").position
        line = coupler / np.abs(coupler)
        crank_velocity = 1j * SPEED * motion.point("crank_pin").position
        along = (crank_velocity * np.conj(line)).real
        by_method = along / (path(motion) * np.conj(line)).real * path(motion)
        components = gk.linkage.effective_components(motion)["coupler"]
        assert components.velocity[pin] == pytest.approx(by_method * np.conj(line), rel=1e-9)
        assert components.difference == pytest.approx(np.zeros(50), abs=1e-12 * np.abs(along).max())


def test_components_do_not_depend_on_the_direction_of_the_ground_and_are_those_of_each_of_many_linkages():
    drive = np.linspace(0.1, 6.2, 20)
    plain = gk.linkage.effective_components(at(gk.FourBar(100, 30, 90, 70), drive))
    turned = gk.linkage.effective_components(at(gk.FourBar(100, 30, 90, 70, ground_angle_deg=40), drive))
    many = gk.linkage.effective_components(at(gk.FourBar(100, np.array([20.0, 30.0]), 90, 70), drive))
    for link, line in plain.items():
        for pin in line.velocity:
            for rate in ("velocity", "acceleration"):
                values = getattr(line, rate)[pin]
                close = {"rel": 1e-9, "abs": 1e-9 * max(1.0, np.abs(values).max())}
                assert getattr(turned[link], rate)[pin] == pytest.approx(values, **close)
                assert getattr(many[link], rate)[pin][:, 1] == pytest.approx(values, **close)


def test_accelerations_differ_by_the_normal_and_the_tangential_part():
    motion = at(gk.FourBar(100, 30, 90, 70), np.linspace(0, 6, 30))
    coupler, (one, two) = motion["coupler"], ("crank_pin", "rocker_pin")
    acceleration = gk.linkage.effective_components(motion)["coupler"].acceleration
    expected = 90 * (-(coupler.omega**2) + 1j * coupler.alpha)
    assert acceleration[two] - acceleration[one] == pytest.approx(expected, rel=1e-9)


def test_across_a_slot_pin_and_lever_have_one_velocity_and_differ_by_the_coriolis_acceleration():
    motion = at(LEVER, np.linspace(0.1, 6.2, 40))
    (slot,) = (line for line in gk.linkage.effective_components(motion).values() if line.equal == "across")
    under, pin = slot.velocity
    slide, name = motion.slide("slide"), motion.linkage.sliders[0].along
    assert slot.velocity[pin].imag == pytest.approx(slot.velocity[under].imag, rel=1e-9)
    assert slot.velocity[pin].real - slot.velocity[under].real == pytest.approx(slide.velocity, rel=1e-9, abs=1e-9)
    across = (slot.acceleration[pin] - slot.acceleration[under]).imag
    assert across == pytest.approx(2 * motion[name].omega * slide.velocity, rel=1e-9, abs=1e-9)


def test_a_body_with_three_pins_has_its_sides_and_open_frames_are_nan():
    watt, drive, branch = ALL["watt"]
    motion = at(watt, drive, branch)
    sides = [key for key in gk.linkage.effective_components(motion) if key not in motion.bodies]
    assert len(sides) % 3 == 0 and sides
    motion = gk.move(gk.FourBar(20, 30, 100, 70), np.linspace(0, 6, 30))
    velocity = gk.linkage.effective_components(motion)["coupler"].velocity["crank_pin"]
    assert np.array_equal(np.isfinite(velocity), motion.assembled) and not motion.assembled.all()
    assert components_check(motion).passed


def test_components_that_are_only_rounding_have_no_column_and_the_others_hold_the_velocity():
    motion = at(gk.FourBar(100, 30, 90, 70), np.linspace(0, 6, 30))
    columns = {column.id: column.values for column in component_columns(motion)}
    assert "crank_pin_velocity_across_crank" in columns and "crank_pin_velocity_along_crank" not in columns
    assert "crank_pin_acceleration_along_crank" in columns
    size = np.hypot(columns["rocker_pin_velocity_along_coupler"], columns["rocker_pin_velocity_across_coupler"])
    assert size == pytest.approx(np.abs(motion.point("rocker_pin").velocity), rel=1e-12)


def test_the_check_fails_for_links_that_are_not_rigid():
    motion = at(gk.FourBar(100, 30, 90, 70), np.linspace(0, 6, 30))
    assert components_check(motion).passed and components_check(motion).value == 0
    motion.solution._values["first", "rocker"] = motion["rocker"].first * 1.001
    assert not components_check(
        gk.linkage.Motion(*(getattr(motion, f) for f in ("linkage", "drive", "timing")), motion.solution, motion.given)
    ).passed
