"""The references' decimal arithmetic against another road: other formulas, and differences in as many digits."""

from decimal import Decimal

import numpy as np
import pytest

from geomkin.tradeoff.exact import carried, circling, cosine_sine, fixed, many_digits, pinned, sliding
from tests.linkage import exact

ANGLES = [0.7, 4.4]


def known(place):
    """A place and its derivatives as complex numbers."""
    return [complex(z.x, z.y) for z in (place.at, place.first, place.second)]


@pytest.mark.parametrize("angle", ANGLES)
def test_four_bar_and_slider_crank_agree_with_the_loop_equations_in_decimals(angle):
    with many_digits():
        crank = circling(30, angle)
        pin = pinned(crank, fixed(100), 90, 70, 1)
        bar, arm = pin - crank, pin - fixed(100)
        slid = sliding(crank, 90, 10, 1)
        turning = [[float(rate) for rate in one.turning] for one in (bar, arm)]
        directions = [complex(bar.at.x, bar.at.y) / 90, complex(arm.at.x, arm.at.y) / 70]
    right = exact.four_bar(100, 30, 90, 70, angle, 1)
    assert directions == pytest.approx(right[0], rel=1e-15)
    assert np.array(turning).T == pytest.approx(np.array(right[1:]), rel=1e-14)
    right = exact.slider_crank(30, 90, 10, angle, 1)
    assert [z.real for z in known(slid)] == pytest.approx([order[1] for order in right], rel=1e-14)
    assert [z.imag for z in known(slid)] == [10, 0, 0]


@pytest.mark.parametrize("angle", ANGLES)
def test_rates_of_a_coupler_point_agree_with_differences(angle):
    """By central differences of a step so small that what they miss is far below a float's digits."""

    def at(t):
        crank = circling(30, t)
        return carried(crank, pinned(crank, fixed(100), 90, 70, -1), 40 + 25j)

    with many_digits():
        step = Decimal(10) ** -25
        here, before, after = at(angle), at(Decimal(angle) - step), at(Decimal(angle) + step)
        first = (after.at - before.at).times(1 / (2 * step))
        second = (after.at - here.at - (here.at - before.at)).times(1 / step**2)
        pin = pinned(circling(30, angle), fixed(100), 90, 70, -1)
    assert known(here)[1:] == pytest.approx([complex(first.x, first.y), complex(second.x, second.y)], rel=1e-14)
    # 40 + 25i seen from the coupler, whose pins are 90 apart.
    crank = known(circling(30, angle))[0]
    assert known(here)[0] == pytest.approx(crank + (known(pin)[0] - crank) / 90 * (40 + 25j), rel=1e-14)


def test_cosine_and_sine_have_all_their_digits():
    with many_digits():
        for angle in (Decimal("0.5"), Decimal("-7.25"), Decimal(30)):
            cosine, sine = cosine_sine(angle)
            assert abs(cosine**2 + sine**2 - 1) < Decimal(10) ** -90
            assert (float(cosine), float(sine)) == pytest.approx(
                (np.cos(float(angle)), np.sin(float(angle))), abs=1e-15
            )
