"""Cams a little below the least radius that does not undercut: closed, as large as the next one, wherever they begin."""

import numpy as np
import pytest

import geomkin as gk
from tests.campaign import by_default

from .cams import running_back

# Shares by which the base radius lies below the limit; the loops of the profile shrink to rounding.
SHARES = 10.0 ** -np.arange(3.0, 14, 2)
FOLLOWERS = {
    "flat": gk.TranslatingFlat(0),
    "tilted": gk.TranslatingFlat(8),
    "roller": gk.TranslatingRoller(8),
    "offset": gk.TranslatingRoller(14, 5),
}


def program(law):
    segments = (
        gk.Dwell(end_deg=40),
        gk.Rise(law, rise=12, end_deg=110),
        gk.Dwell(end_deg=200),
        gk.Return(law, end_deg=360),
    )
    return gk.Program(segments)


@pytest.mark.parametrize(
    ("follower", "law"),
    by_default(
        [("flat", "harmonic"), ("tilted", "parabolic"), ("roller", "3-4-5"), ("offset", "harmonic")], slice(1, 3)
    ),
)
def test_the_outline_is_closed_and_grows_with_the_base_circle(follower, law):
    follower, made, areas = FOLLOWERS[follower], program(law), []
    radius = gk.cam.least_base_circle(follower, made, "clockwise", 89.0).radius
    for share in SHARES:
        cut = gk.undercut(gk.Cam(follower, made, radius * (1 - share), "clockwise"))
        assert cut.outline.closed
        areas.append(gk.area(cut.outline))
    assert (np.diff(areas) > -1e-9 * areas[0]).all()


# Lifts every 20 deg of a hump too sharp for a small cam.
HUMP = [2 + 10 * np.sin(np.pi * k / 18) ** 8 for k in range(18)]


def hump(turned):
    lifts = HUMP[turned:] + HUMP[:turned]
    return gk.Program((gk.cam.LiftSpline(tuple((20.0 * k, lift) for k, lift in enumerate([*lifts, lifts[0]]))),))


@pytest.mark.parametrize("follower", by_default([gk.TranslatingFlat(8), gk.TranslatingRoller(60)], slice(1)))
def test_start_of_the_program_does_not_matter(follower):
    """The hump stands in the middle, or the turn ends and begins on one of its sides, or on its top."""
    radius = gk.cam.least_base_circle(follower, hump(0), "clockwise", 89.0).radius
    for share in SHARES[::3]:
        cuts = [gk.undercut(gk.Cam(follower, hump(k), radius * (1 - share), "clockwise")) for k in (0, 6, 9, 12)]
        areas = np.array([gk.area(cut.outline) for cut in cuts])
        assert np.ptp(areas) < 1e-9 * areas[0]
        assert np.ptp([cut.worst[0] for cut in cuts]) < 1e-9 * radius


@pytest.mark.parametrize(("jump", "back"), [(1e-7, 1e-10), (1e-6, 1e-3), (1e-5, 3e-8), (1e-2, 1e-6)])
@pytest.mark.parametrize(("tilt", "direction"), [(0, "counterclockwise"), (10, "clockwise")])
def test_double_run_back_loses_only_the_tip(jump, back, tilt, direction):
    """At 70 mm its radius of curvature at the joint would be 0; below, contact runs back before it and after it."""
    base = 70 * np.cos(np.radians(tilt)) * (1 - back)
    cut = gk.undercut(gk.Cam(gk.TranslatingFlat(tilt), running_back(jump), base, direction))
    # Less than 1e-9 mm may be lost in rounding, but never more than there is.
    assert len(cut.spans) == 1 or (not cut.found and max(jump, back) < 2e-6)
    assert all(low < np.radians(120) < high for low, high in cut.spans)
    assert 0 <= cut.worst[0] < 0.02 * (jump + 70 * back)
    assert abs(gk.area(cut.outline)) > np.pi * base**2
