"""Profile shifts chosen for a purpose, judged by the gears that they make."""

import numpy as np
import pytest

import geomkin as gk


@pytest.mark.parametrize(
    "rack", [gk.gear.RackCutter(), gk.gear.RackCutter(tip_radius=0), gk.gear.RackCutter(25, tip_radius=0.2)]
)
@pytest.mark.parametrize("teeth", [5, 16, 24])
def test_the_shift_just_avoids_undercut(teeth, rack):
    shift = gk.gear.undercut_free_shift(teeth, rack)
    assert not gk.SpurGear(teeth, 2, shift, rack, on_pointed_tip="cut").is_undercut
    if shift:
        assert gk.SpurGear(teeth, 2, shift - 1e-6, rack, on_pointed_tip="cut").is_undercut
    else:
        assert not gk.SpurGear(teeth, 2, 0, rack).is_undercut


@pytest.mark.parametrize("rack", [gk.gear.RackCutter(), gk.gear.RackCutter(25, 0.8, 1.0, 0.2)])
@pytest.mark.parametrize(("first", "second", "total"), [(15, 40, 0.0), (20, 20, 0.0), (12, 24, 0.96)])
def test_balanced_gears_slide_equally_at_both_ends_of_contact(first, second, total, rack):
    one, two = gk.gear.balanced_shifts(first, second, rack, total)
    assert one + two == pytest.approx(total)
    pair = gk.GearPair(gk.SpurGear(first, 2, one, rack), gk.SpurGear(second, 2, two, rack))
    start, end = pair.contact_lengths
    assert float(pair.sliding(start)[0]) == pytest.approx(float(pair.sliding(end)[1]), rel=1e-9)
    if first != second:
        plain = gk.GearPair(gk.SpurGear(first, 2, total / 2, rack), gk.SpurGear(second, 2, total / 2, rack))
        worst = [min(np.min(p.sliding(np.array(p.contact_lengths))) for _ in (0,)) for p in (pair, plain)]
        assert worst[0] > worst[1]
    assert gk.gear.balanced_shifts(second, first, rack, total) == pytest.approx((two, one), abs=1e-9)
