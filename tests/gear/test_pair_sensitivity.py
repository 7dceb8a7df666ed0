"""Sensitivities of gear pairs against differences of 40 digits, or of the library's own pairs."""

from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp, mpf

import geomkin as gk

PAIRS = {
    "plain": gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(40, 2)),
    "shifted, apart": gk.GearPair(
        gk.SpurGear(17, 3, profile_shift=0.3, tooth_thickness_allowance=0.05),
        gk.SpurGear(53, 3, profile_shift=-0.1),
        106,
    ),
    "ring": gk.GearPair(gk.SpurGear(24, 2, profile_shift=0.2), gk.RingGear(70, 2, profile_shift=0.2), 45.95),
}
SIZES = "centre_distance", "first.profile_shift", "second.profile_shift"


def changed(pair, by, step):
    if by == "centre_distance":
        return replace(pair, centre_distance=pair.centre_distance + step)
    name = by.split(".")[0]
    gear = getattr(pair, name)
    return replace(pair, **{name: replace(gear, profile_shift=gear.profile_shift + step)})


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("of", ["contact_ratio", "backlash"])
def test_sensitivities_agree_with_differences_of_pairs(name, of):
    # Some backlash more, so that pairs on both sides do not jam.
    pair = replace(PAIRS[name], centre_distance=PAIRS[name].centre_distance + (-0.01 if name == "ring" else 0.01))
    for by in SIZES:
        slopes = [
            (getattr(changed(pair, by, h), of) - getattr(changed(pair, by, -h), of)) / (2 * h) for h in (2e-4, 1e-4)
        ]
        assert pair.sensitivity(of, by=by) == pytest.approx((4 * slopes[1] - slopes[0]) / 3, rel=1e-8, abs=1e-9)


def textbook(of, a, x1, x2):
    """Contact ratio and backlash of the external pair of 17 and 53 teeth by the formulas of ISO 21771, 40 digits."""
    m, z1, z2, alpha = mpf(3), 17, 53, mp.radians(20)
    rb1, rb2 = m * z1 / 2 * mp.cos(alpha), m * z2 / 2 * mp.cos(alpha)
    working = mp.acos((rb1 + rb2) / a)
    if of == "contact_ratio":
        tips = [mp.sqrt((m * (mpf(z) / 2 + 1 + x)) ** 2 - rb**2) for z, x, rb in ((z1, x1, rb1), (z2, x2, rb2))]
        return (sum(tips) - a * mp.sin(working)) / (mp.pi * m * mp.cos(alpha))
    involute = [mp.tan(t) - t for t in (alpha, working)]
    teeth = 0
    for z, x, less in ((z1, x1, mpf(0.05)), (z2, x2, 0)):
        r, working_r = m * z / 2, a * z / (z1 + z2)
        thickness = m * (mp.pi / 2 + 2 * x * mp.tan(alpha)) - less
        teeth += working_r * (thickness / r + 2 * (involute[0] - involute[1]))
    return 2 * mp.pi * a / (z1 + z2) - teeth


@pytest.mark.parametrize("of", ["contact_ratio", "backlash"])
def test_sensitivities_have_twelve_digits(of):
    pair = PAIRS["shifted, apart"]
    with mp.workdps(40):
        sizes = [mpf(pair.centre_distance), mpf(0.3), mpf(-0.1)]
        assert getattr(pair, of) == pytest.approx(float(textbook(of, *sizes)), rel=1e-12)
        for k, by in enumerate(SIZES):
            ends = [
                textbook(of, *(v + sign * mpf(10) ** -15 * (j == k) for j, v in enumerate(sizes))) for sign in (1, -1)
            ]
            exact = float((ends[0] - ends[1]) / (2 * mpf(10) ** -15))
            assert pair.sensitivity(of, by=by) == pytest.approx(exact, rel=1e-12)


def test_contact_that_ends_at_a_rounded_tip_has_no_sensitivity_by_its_shift():
    pair = gk.GearPair(gk.SpurGear(20, 2, tip_rounding=0.1), gk.SpurGear(40, 2))
    assert np.isnan(pair.sensitivity("contact_ratio", by="first.profile_shift"))
    assert pair.sensitivity("contact_ratio", by="second.profile_shift") > 0


@pytest.mark.parametrize(("of", "by"), [("backlash", "module"), ("ratio", "centre_distance")])
def test_unknown_names_are_refused(of, by):
    with pytest.raises(gk.DesignError):
        PAIRS["plain"].sensitivity(of, by=by)
