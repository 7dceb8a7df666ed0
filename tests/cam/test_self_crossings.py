"""Crossings of chords against all pairs one by one, crossings of curves against what their equations say."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.cam.undercut import undercut
from geomkin.cam.untrimmed_outline import chord_crossings, self_crossings
from geomkin.plane.curve import AbstractCurve
from tests.campaign import by_default


class CurveFromFunctions(AbstractCurve):
    """A closed curve by its equations; counts how many points are asked for."""

    def __init__(self, point, velocity, end=2 * np.pi):
        self._point, self._velocity, self._end = point, velocity, end
        self.calls = 0

    def point(self, t):
        self.calls += 1
        return self._point(np.asarray(t, dtype=float))

    def velocity(self, t):
        return self._velocity(np.asarray(t, dtype=float))

    @property
    def breaks(self):
        return np.array([0, self._end])

    @property
    def closed(self):
        return True


# A limacon crosses itself at the origin where cos t = -1/2.
LIMACON = CurveFromFunctions(
    lambda t: (1 + 2 * np.cos(t)) * np.exp(1j * t), lambda t: (-2 * np.sin(t) + 1j * (1 + 2 * np.cos(t))) * np.exp(1j * t)
)  # fmt: skip


def found(curve, pairs, room=0.3):
    pairs = np.atleast_2d(pairs).astype(float)
    return self_crossings(curve, pairs, pairs - room, pairs + room)


def all_pairs(z):
    """Chords i < j that cross, by orientations of every pair."""
    n, after = len(z), np.roll(z, -1)
    side = lambda a, b, c: np.sign(np.imag(np.conj(b - a) * (c - a)))  # noqa: E731
    return [
        (i, j)
        for i in range(n)
        for j in range(i + 2, n)
        if (i, j) != (0, n - 1)
        and side(z[i], after[i], z[j]) != side(z[i], after[i], after[j])
        and side(z[j], after[j], z[i]) != side(z[j], after[j], after[i])
    ]


@pytest.mark.parametrize("seed", range(1))
@pytest.mark.parametrize("shape", ["wild", "long and thin", "one long chord", "tiny", "huge"])
def test_every_crossing_of_chords_is_found_once(seed, shape):
    rng = np.random.default_rng(seed)
    z = np.cumsum(rng.normal(size=60) + 1j * rng.normal(size=60))
    if shape == "long and thin":
        z = z.real + 1e-6j * z.imag
    if shape == "one long chord":
        z[17] *= 50
    z = z * {"tiny": 1e-7, "huge": 1e7}.get(shape, 1)
    i, j, s, t = chord_crossings(z)
    assert list(zip(i.tolist(), j.tolist())) == all_pairs(z) and len(i) > 5
    after = np.roll(z, -1)
    there = z[i] + s * (after[i] - z[i]), z[j] + t * (after[j] - z[j])
    assert np.abs(there[0] - there[1]).max() < 1e-9 * np.abs(z).max()


def test_within_a_reach_none_is_left_out_and_chords_farther_away_are():
    rng = np.random.default_rng(1)
    z = np.cumsum(rng.normal(size=600) + 1j * rng.normal(size=600))
    reach = np.median(np.abs(z))
    i, j, s, _ = chord_crossings(z)
    place = np.abs(z[i] + s * (np.roll(z, -1)[i] - z[i]))
    near = set(zip(*(a.tolist() for a in chord_crossings(z, reach)[:2])))
    assert {(a, b) for a, b, far in zip(i.tolist(), j.tolist(), place) if far < reach} <= near
    assert len(near) < 0.8 * len(i)


def test_many_crossings_are_found_at_once_and_where_there_is_none_it_says_so():
    exact = np.array([2, 4]) * np.pi / 3
    pairs = np.array([exact + 0.05, [0.1, 0.5], exact - 0.02, [1.0, 5.0]])
    here = found(LIMACON, pairs, room=0.2)
    assert np.isnan(here[[1, 3]]).all() and here[[0, 2]] == pytest.approx(np.stack([exact, exact]), abs=1e-15)


def test_no_crossing_beyond_the_limits_is_found():
    assert np.isnan(found(LIMACON, np.array([2, 4]) * np.pi / 3 + 0.3, room=0.2)).all()


def test_branches_that_run_the_same_way_have_no_crossing_and_no_step():
    """Two lines, one beside the other, of one direction to the last bit."""
    beside = CurveFromFunctions(lambda t: t % 1 + 0.1j * np.floor(t), lambda t: np.ones(t.shape, complex), 2.0)
    assert np.isnan(found(beside, [[0.4, 1.3], [0.5, 1.5]], 0.2)).all()


def waves(count, follower, law="cycloidal"):
    ends = 360 * np.arange(1, count + 1) / count
    return gk.Cam(follower, gk.Program([
        gk.Rise(law, rise=5, end_deg=end) if k % 2 == 0 else gk.Return(law, end_deg=end)
        for k, end in enumerate(ends.tolist())
    ]), 40)  # fmt: skip


@pytest.mark.parametrize(
    "follower", by_default([gk.TranslatingRoller(10), gk.TranslatingFlat()], slice(1)), ids=["roller", "flat"]
)
def test_a_cam_of_many_waves_leaves_its_valleys_as_corners(follower):
    """By symmetry each corner lies where a valley does, as far from the axis as the two waves beside it leave it."""
    cut = undercut(waves(80, follower))
    order = np.argsort(np.angle(cut.corners))
    assert np.diff(np.angle(cut.corners[order])) == pytest.approx(2 * np.pi / 40, abs=1e-9)
    assert np.abs(cut.corners) == pytest.approx(np.abs(cut.corners[0]), abs=1e-10)
    # Nothing of it is inside the follower, wherever that stands.
    angles = np.linspace(0, 2 * np.pi, 4001)
    contact = cut.cam.contact(angles)
    z = cut.corners[:, None] * np.exp(1j * angles)
    if isinstance(follower, gk.TranslatingFlat):
        assert z.imag.max() < 45 + 1e-9 and (z.imag - contact.point.imag).max() < 1e-9
    else:
        assert np.abs(z - (contact.point + 10 * contact.normal)).min() > 10 - 1e-9
