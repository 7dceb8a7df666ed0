"""Burmester's curves: every point by its four distances, and that none is missed by brute force over the plane."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import burmester_curves, dyads_through, poles
from tests.campaign import by_default
from tests.synthesis.known import known_linkages
from tests.synthesis.test_dyads import misses, places, some_poses

GENERAL = {seed: some_poses(np.random.default_rng(seed), 4) for seed in range(2)}
KINDS = {f"random {seed}": poses for seed, poses in GENERAL.items()} | {
    "one pair parallel": [(0j, 0.1), (2 + 1j, 0.1), (1 + 3j, 1.0), (4j, 2.0)],
    "two pairs parallel": [(0j, 0.1), (2 + 1j, 0.1), (1 + 3j, 1.0), (4j, 1.0)],
    "three parallel": [(0j, 0.1), (2 + 1j, 0.1), (1 + 3j, 0.1), (4j, 1.0)],
    "half turns": [(0j, 0.0), (2 + 1j, np.pi), (1 + 3j, 1.0), (4j, 1.0 + np.pi)],
    "origins in line": [(0j, 0.0), (1 + 0j, 1.0), (2.5 + 0j, 2.0), (4 + 0j, 3.0)],
    "close together": [(0j, 0.0), (0.01 + 0j, 0.01), (0.02 + 0.001j, 0.025), (0.03 + 0.004j, 0.03)],
    "symmetrical": [(-2 + 1j, 0.6), (-1 + 2j, 0.2), (1 + 2j, -0.2), (2 + 1j, -0.6)],
}


def pieces(poses, **more):
    """Each piece, its points, their partners, and whether it is of the body."""
    curves = burmester_curves(poses, **more)
    for piece, on_body in [*((c, False) for c in curves.fixed), *((c, True) for c in curves.moving)]:
        t = np.linspace(piece.start, piece.end, 400)
        yield piece, t, on_body


@pytest.mark.parametrize("kind", KINDS)
def test_all_points_are_dyads_with_their_partners(kind):
    poses, seen = KINDS[kind], {False: 0, True: 0}
    for piece, t, on_body in pieces(poses):
        point, partner = piece.point(t), piece.partner(t)
        pivots, pins = (partner, point) if on_body else (point, partner)
        lengths = np.abs(places(poses, pins) - pivots[:, None])
        near = np.abs(partner) < 1e4
        assert near.sum() > 300
        off = np.ptp(lengths, axis=1) / (1 + np.abs(point) + np.abs(partner))
        assert off[near].max() < 1e-11
        seen[on_body] += 1
    assert min(seen.values())


@pytest.mark.parametrize("kind", by_default(list(KINDS)[::2], ["three parallel", "symmetrical"]))
def test_curves_are_complete(kind):
    """Where the determinant of a pivot's four places on the body changes its sign from cell to cell, there is a curve."""
    poses = KINDS[kind]
    back = [(-z * np.exp(-1j * angle), -angle) for z, angle in poses]
    for seen, on_body in ((back, False), (poses, True)):
        z = np.array([z for z, _ in (poses if not on_body else back)])
        size = np.abs(z - z.mean()).max()
        side = np.linspace(-4, 4, 41) * size
        net = z.mean() + side + 1j * side[:, None]
        p = places(seen, net) / size
        rows = np.stack([np.abs(p - p.mean()) ** 2, p.real, p.imag, np.ones(p.shape)], axis=-1)
        rows = rows - rows[..., :1, :]
        value = np.linalg.det(rows[..., 1:, :3])
        positive = value > 0
        corner = [positive[:-1, :-1], positive[1:, :-1], positive[:-1, 1:], positive[1:, 1:]]
        mixed = ~(np.all(corner, axis=0) | ~np.any(corner, axis=0))
        middles = (net[:-1, :-1] + net[1:, 1:])[mixed] / 2
        assert len(middles)
        curves = burmester_curves(poses, reach=10 * size)
        curves = curves.moving if on_body else curves.fixed
        nearest = np.min([gk.nearest(curve, middles)[1] for curve in curves], axis=0)
        assert nearest.max() < np.hypot(*np.diff(side[:2]), *np.diff(side[:2])) / 2 * (1 + 1e-6)


@pytest.mark.parametrize("kind", list(KINDS)[1::2])
def test_velocities_are_those_of_the_points(kind):
    for piece, t, _ in pieces(KINDS[kind], reach=30.0):
        t, h = t[1:-1], 1e-6
        for place, velocity in ((piece.point, piece.velocity), (piece.partner, piece.partner_velocity)):
            ahead, behind, exact = place(t + h), place(t - h), velocity(t)
            # Differences say little about points near infinity.
            near = np.abs(place(t)) < 300
            size = 1 + np.abs(place(t)) ** 2 + np.abs(exact)
            assert near.sum() > 200
            assert (np.abs((ahead - behind) / (2 * h) - exact) / size)[near].max() < 1e-5


@pytest.mark.parametrize("seed", GENERAL)
def test_the_centre_point_curve_passes_all_six_poles(seed):
    curves = burmester_curves(GENERAL[seed], reach=1000.0)
    drawn = np.concatenate([c.point(np.linspace(c.start, c.end, 20_000)) for c in curves.fixed])
    for pole in poles(GENERAL[seed]).values():
        assert np.abs(drawn - pole.position).min() < 2e-3 * (1 + abs(pole.position) ** 2)


@pytest.mark.parametrize("seed", GENERAL)
def test_slides_are_the_points_at_infinity(seed):
    poses = GENERAL[seed]
    slides = dyads_through(poses, count=1)
    assert np.isinf(slides.fixed[0]) and np.isinf(slides.moving[1])
    assert misses(poses, slides)[:2].max() < 1e-11
    # Far out the curve's partner comes near the sliding pin.
    far = [c for c in burmester_curves(poses, reach=1e5).fixed if not c.closed]
    ends = np.array([c.partner(np.array([c.start, c.end])) for c in far]).ravel()
    assert len(ends) == 2 and np.abs(ends - slides.moving[0]).max() < 1e-2


@pytest.mark.campaign
def test_known_linkages_lie_on_the_curves():
    for known in known_linkages(np.random.default_rng(20), 2, 4):
        curves = burmester_curves(known.poses, reach=1e3)
        for fixed, far in zip(known.fixed, known.fixed_far):
            if far:
                continue
            found = min(gk.nearest(c, np.array([fixed]))[1][0] for c in curves.fixed)
            assert found < 1e-6


@pytest.mark.parametrize(
    "poses",
    [
        GENERAL[0][:3],
        [*GENERAL[0], (9j, 0.3)],
        [(np.exp(1j * t), 0.4) for t in range(4)],
        [(1 + 2 * np.exp(1j * t), t) for t in range(4)],
        [*GENERAL[0][:3], GENERAL[0][1]],
    ],
    ids=["three", "five", "parallel on a circle", "turned about a point", "equal"],
)
def test_what_has_no_curve_is_refused(poses):
    with pytest.raises(gk.DesignError) as refusal:
        burmester_curves(poses)
    assert refusal.value.field == "poses"
