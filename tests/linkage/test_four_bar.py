"""The four-bar by second roads: circles that meet, central differences, 50-digit arithmetic, print."""

from decimal import Decimal, getcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import geomkin as gk

CRANK_ROCKER = gk.FourBar(ground=100, crank=30, coupler=90, rocker=70, coupler_point=40 + 25j)
TURN = np.linspace(0, 2 * np.pi, 361)


def pins(motion):
    return motion.point("crank_pin").position, motion.point("rocker_pin").position


@pytest.mark.parametrize("branch", [1, -1])
def test_links_keep_their_lengths_and_the_loop_closes(branch):
    motion = gk.move(CRANK_ROCKER, TURN, branch)
    crank_pin, rocker_pin = pins(motion)
    by_coupler = motion.coupler.point(90).position
    assert np.abs(np.abs(crank_pin) - 30).max() < 1e-12
    assert np.abs(np.abs(rocker_pin - 100) - 70).max() < 1e-12
    assert np.abs(by_coupler - rocker_pin).max() < 1e-12 * 100
    side = np.imag(np.conj(100 - crank_pin) * (rocker_pin - crank_pin))
    assert np.all(branch * side > 0)


@given(st.lists(st.floats(0.1, 10), min_size=4, max_size=4), st.floats(0, 6.28), st.sampled_from([1, -1]))
def test_the_pin_lies_on_both_circles_wherever_the_linkage_closes(lengths, angle, branch):
    ground, crank, coupler, rocker = lengths
    if max(lengths) >= sum(lengths) - max(lengths):
        with pytest.raises(gk.DesignError):
            gk.FourBar(*lengths)
        return
    motion = gk.move(gk.FourBar(*lengths), [angle], branch)
    diagonal = abs(ground - crank * np.exp(1j * angle))
    clearly_open = diagonal > coupler + rocker + 1e-9 or diagonal < abs(coupler - rocker) - 1e-9
    clearly_closed = abs(coupler - rocker) + 1e-9 < diagonal < coupler + rocker - 1e-9
    if clearly_open:
        assert not motion.assembled[0] and np.isnan(motion.rocker.direction[0]) and np.isnan(motion.rocker.omega[0])
    if clearly_closed:
        assert motion.assembled[0]
        assert abs(motion.coupler.point(coupler).position[0] - motion.point("rocker_pin").position[0]) < 1e-12 * sum(
            lengths
        )


def test_rates_are_the_derivatives_of_positions():
    speed, gain, step = 7.0, -3.0, 1e-4
    motion = gk.move(CRANK_ROCKER, TURN, speed=speed, acceleration=gain)
    # The drive at three moments of time, by the constant acceleration asked for.
    early, late = (TURN + speed * dt + gain * dt**2 / 2 for dt in (-step, step))
    rates = [gk.move(CRANK_ROCKER, drive) for drive in (early, late)]
    for name in ("crank_pin", "rocker_pin", "coupler_point"):
        here = motion.point(name)
        before, after = (r.point(name).position for r in rates)
        assert np.abs((after - before) / (2 * step) - here.velocity).max() < 1e-3
        assert np.abs((after - 2 * here.position + before) / step**2 - here.acceleration).max() < 1e-3 * 3e3
    for name in ("coupler", "rocker"):
        body = motion.bodies[name]
        turned = np.angle(rates[1].bodies[name].direction / rates[0].bodies[name].direction)
        assert np.abs(turned / (2 * step) - body.omega).max() < 1e-4


def test_origin_and_ground_angle_turn_the_whole():
    turned = gk.FourBar(100, 30, 90, 70, 40 + 25j, origin=5 - 3j, ground_angle_deg=37)
    plain, moved = (gk.move(f, TURN, speed=2.0).point("coupler_point") for f in (CRANK_ROCKER, turned))
    frame = np.exp(1j * np.radians(37))
    assert np.abs(moved.position - (5 - 3j + frame * plain.position)).max() < 1e-12
    assert np.abs(moved.acceleration - frame * plain.acceleration).max() < 1e-10


@pytest.mark.parametrize("scale", [1e-7, 1.0, 1e7])
def test_size_does_not_matter(scale):
    plain = gk.move(CRANK_ROCKER, TURN)
    scaled = gk.move(gk.FourBar(100 * scale, 30 * scale, 90 * scale, 70 * scale), TURN)
    assert np.abs(scaled.rocker.direction - plain.rocker.direction).max() < 1e-15 * 20
    assert np.abs(scaled.rocker.alpha - plain.rocker.alpha).max() < 1e-13


@pytest.mark.parametrize("power", range(0, 16, 3))
@pytest.mark.parametrize("away", [0.1, 1.0, 10.0])
def test_digits_survive_near_a_toggle(power, away):
    """Direction and velocity against 60-digit arithmetic, folded to within 10^-power of a toggle."""
    gap = 10.0**-power
    sizes = 3.0, 1.0, 4.0 - gap, 2.0  # coupler - rocker is nearly ground - crank
    angle = min(1.0, away * gap**0.5)  # within reach of the toggle at 0, where digits are lost
    motion = gk.move(gk.FourBar(*sizes), [angle])
    coupler, rate = fold(*sizes, angle)
    assert abs(motion.coupler.direction[0] - coupler) < 8 * 2.3e-16
    assert motion.rocker.omega[0] == pytest.approx(rate, rel=8 * 2.3e-16)


def fold(ground, crank, coupler, rocker, angle):
    """Coupler direction and rocker rate per crank rate, by two circles and by velocities, in 60 digits."""
    getcontext().prec = 60
    d, a, b, c, t = map(Decimal, (ground, crank, coupler, rocker, angle))
    terms = [Decimal(1)]
    for k in range(1, 60):
        terms.append(terms[-1] * t / k)
    cos = sum((-1) ** (k // 2) * terms[k] for k in range(0, 60, 2))
    sin = sum((-1) ** (k // 2) * terms[k] for k in range(1, 60, 2))
    px, py = a * cos, a * sin
    ux, uy = d - px, -py
    s = ux * ux + uy * uy
    along = (s + b * b - c * c) / (2 * s)
    left = ((b * b - along * along * s) / s).sqrt()
    x, y = along * ux - left * uy, along * uy + left * ux  # crank pin to rocker pin
    rx, ry = px + x - d, py + y
    # The pin's velocity w (-ry, rx) less the crank pin's (-py, px) is square to the coupler.
    rate = (-py * x + px * y) / (-ry * x + rx * y)
    return complex(float(x / b), float(y / b)), float(rate)


def test_change_of_branch_mirrors_a_symmetric_pose():
    plus, minus = (gk.move(CRANK_ROCKER, [0.0], branch) for branch in (1, -1))
    assert plus.rocker.direction[0] == pytest.approx(np.conj(minus.rocker.direction[0]))


def test_coincident_circles_have_no_single_answer():
    rhombus = gk.FourBar(1, 1, 1, 1)
    motion = gk.move(rhombus, [0.0])
    assert not motion.assembled[0] and np.isnan(motion.coupler.direction[0])


@pytest.mark.parametrize(
    ("lengths", "kind"),
    [
        ((100, 30, 90, 70), "crank-rocker"),
        ((30, 100, 90, 70), "double-crank"),
        ((100, 70, 90, 30), "rocker-crank"),
        ((100, 70, 30, 90), "double-rocker"),
        ((3, 2, 3, 2), "change-point"),
        ((3, 2, 2.5, 4), "triple-rocker"),
    ],
)
def test_grashof_type_agrees_with_what_turns(lengths, kind):
    linkage = gk.FourBar(*lengths)
    assert gk.linkage.grashof_type(linkage) == kind
    turns_fully = bool(gk.move(linkage, TURN + 1e-3).assembled.all())
    assert turns_fully == (kind in ("crank-rocker", "double-crank", "change-point"))


@pytest.mark.parametrize(
    ("lengths", "field"),
    [
        ((1, 1, 1, 5), "rocker"),
        ((0, 1, 1, 1), "ground"),
        ((1, -2, 1, 1), "crank"),
        ((1, 1, np.nan, 1), "coupler"),
        ((1, 1, 1, "a"), "rocker"),
    ],
)
def test_impossible_lengths_are_refused_by_name(lengths, field):
    with pytest.raises(gk.DesignError) as caught:
        gk.FourBar(*lengths)
    assert caught.value.field == field and caught.value.remedy


def test_unknown_names_say_what_there_is():
    motion = gk.move(CRANK_ROCKER, [0.0])
    with pytest.raises(AttributeError, match="coupler"):
        motion.slider
    with pytest.raises(gk.DesignError, match="coupler_point"):
        motion.point("pen")
    with pytest.raises(gk.DesignError):
        gk.move(CRANK_ROCKER, [0.0], branch=2)


@pytest.mark.parametrize("size", [1e-7, 0.1, 0.7 / 3, 13.07, 3e6 / 7])
def test_a_change_point_is_told_to_rounding_and_no_farther_at_any_size(size):
    for lengths in ((7, 3, 3, 7), (5, 2, 5, 2), (4, 1, 3, 6), (6, 3, 1, 4)):
        assert gk.linkage.grashof_type(gk.FourBar(*(size * n for n in lengths))) == "change-point"
        for k in range(4):
            for share in (1e-9, -1e-9):
                near = [size * n * (1 + share * (j == k)) for j, n in enumerate(lengths)]
                assert gk.linkage.grashof_type(gk.FourBar(*near)) != "change-point"
