"""Rates from samples and values from rates, against the exact motion of linkages and of polynomials."""

import numpy as np
import pytest

import geomkin as gk

LINKAGE = gk.FourBar(100, 30, 90, 70, 40 + 25j)


def tracked(count, shift=0.0):
    """Step, and a coupler point's exact motion over one turn at 1 rad/s, at even times."""
    step = 2 * np.pi / count
    return step, gk.move(LINKAGE, (np.arange(count) + shift) * step).point("coupler_point")


def order_found(miss):
    """The power of the step by which errors fall when it is halved."""
    return np.log2(miss[0] / miss[1])


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("derivative", [1, 2])
@pytest.mark.parametrize("order", [2, 8])
def test_central_differences_are_of_the_given_order_with_a_true_error(order, derivative, periodic):
    miss, reported = [], []
    for count in (90, 180):
        step, point = tracked(count)
        found = gk.linkage.central_difference(point.position, step, derivative, order, periodic)
        off = np.abs(found.values - (point.velocity if derivative == 1 else point.acceleration))
        assert found.times == pytest.approx(np.arange(count) * step)
        assert (off <= 2 * found.error).all()
        miss.append(off.max()), reported.append(found.error.max())
    assert order_found(miss) == pytest.approx(order, abs=0.6)
    assert reported == pytest.approx(miss, rel=0.2)


def test_velocity_differences_are_of_second_order_with_a_true_error():
    miss, bent = [], []
    for count in (90, 180):
        step, point = tracked(count)
        _, middle = tracked(count, 0.5)
        found = gk.linkage.velocity_difference(point.position, step)
        off = np.abs(found.values - middle.velocity[:-1])
        assert found.times == pytest.approx((np.arange(count - 1) + 0.5) * step) and (off <= 1.5 * found.error).all()
        miss.append(off.max())
        assert miss[-1] == pytest.approx(found.error.max(), rel=0.1)
        # Of those again, at the samples.
        again = gk.linkage.velocity_difference(found.values, step)
        bent.append(np.abs(again.values - point.acceleration[1:-1]).max())
    assert order_found(miss) == pytest.approx(2, abs=0.1) and order_found(bent) == pytest.approx(2, abs=0.1)


def test_mid_ordinate_integral_has_a_true_error():
    miss = []
    for count in (90, 180):
        step, point = tracked(count)
        _, middle = tracked(count, 0.5)
        found = gk.linkage.mid_ordinate_integral(middle.velocity, step, point.position[0])
        off = np.abs(found.values[:-1] - point.position)
        # Near the start there is hardly any error.
        assert found.values[0] == point.position[0] and (off <= 1.5 * found.error[:-1] + 0.1 * off.max()).all()
        miss.append(off.max())
        assert miss[-1] == pytest.approx(found.error.max(), rel=0.3)
    assert order_found(miss) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("order", [4, 6])
def test_polynomials_that_the_weights_go_through_are_exact_up_to_the_ends(order):
    t = np.arange(order + 5) * 0.25
    powers = np.polynomial.Polynomial(np.arange(1.0, order + 2))
    for derivative in (1, 2):
        found = gk.linkage.central_difference(powers(t), 0.25, derivative, order)
        assert found.values == pytest.approx(powers.deriv(derivative)(t), rel=1e-9)


@pytest.mark.parametrize("step", [0.5])
def test_error_estimate_is_the_true_error_if_the_higher_formula_is_exact(step):
    """By polynomials of one degree more than a formula takes: their next derivative is the same everywhere."""
    t = np.arange(16) * step
    for order in (2, 4, 6):
        for derivative in (1, 2):
            power = np.polynomial.Polynomial([1, -2, 3, 0.5] + (order + derivative - 4) * [0] + [1])
            found = gk.linkage.central_difference(power(t), step, derivative, order)
            missed = np.abs(found.values - power.deriv(derivative)(t))
            assert found.error == pytest.approx(missed, rel=1e-3) and missed.max() > 1e-3
    cubic = np.polynomial.Polynomial([1, -2, 3, 0.5])
    found = gk.linkage.velocity_difference(cubic(t), step)
    assert found.error == pytest.approx(np.abs(found.values - cubic.deriv()(found.times)), rel=1e-9)
    bent = np.polynomial.Polynomial([1, -2, 3])
    found = gk.linkage.mid_ordinate_integral(bent(t + step / 2), step, 7.0)
    assert found.error == pytest.approx(np.abs(found.values - 7 - bent.integ()(found.times)), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("complex_unit", [1, 1j])
def test_inexact_samples_add_to_the_error_by_their_weights(complex_unit):
    """Samples that are all off to the worse side, of what stands still."""
    off = 0.01 * (-1.0) ** np.arange(12) * complex_unit
    still = gk.linkage.velocity_difference(off, 0.5, inexact=0.01)
    assert np.abs(still.values) == pytest.approx(np.full(11, 0.04))
    # The cubic through alternating samples bends as much as it can: eight of them over 24.
    assert still.error == pytest.approx(np.full(11, 0.04 + 8 * 0.01 / (24 * 0.5)))
    second = gk.linkage.central_difference(off, 0.5, 2, 2, True, inexact=0.01)
    assert np.abs(second.values) == pytest.approx(np.full(12, 0.16))
    # The finer one, of order 4, finds 16/3 times as much as a sample is off.
    assert second.error == pytest.approx(np.full(12, 0.16 + (16 / 3 - 4) * 0.01 / 0.25))


def test_error_bounds_noise():
    """Noise of known size stays within the error, which is worse for the smaller step."""
    noise = np.random.default_rng(1)
    reported = []
    for count in (90, 3600):
        step, point = tracked(count)
        read = np.round(point.position, 2) + noise.uniform(-1e-3, 1e-3, count)
        found = gk.linkage.central_difference(read, step, 2, 4, True, inexact=0.005 * 2**0.5 + 1e-3)
        assert (np.abs(found.values - point.acceleration) <= found.error).all()
        reported.append(found.error.max())
    assert reported[1] > 100 * reported[0]


def test_too_few_samples_are_refused_with_the_number_needed():
    for call, least in (
        (lambda: gk.linkage.central_difference(np.zeros(12), 0.1, 1, 8), "13"),
        (lambda: gk.linkage.velocity_difference([1.0, 2.0], 0.1), "4"),
    ):
        with pytest.raises(gk.DesignError) as caught:
            call()
        assert least in caught.value.remedy
