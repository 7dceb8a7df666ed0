"""Dyads through poses: known linkages are given back, and every dyad is looked at by its distances alone."""

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import circle_of_sliders, dyads_through, image_poles, poles
from tests.synthesis.known import apart, known_linkages


def places(poses, point):
    """Where a body's point is at each pose, (n,) or (points, n)."""
    z, angle = np.array([p[0] for p in poses]), np.array([p[1] for p in poses])
    return z + np.exp(1j * np.real(angle)) * np.asarray(point)[..., None]


def misses(poses, dyads):
    """The second road: distances by plain subtraction, each dyad by itself."""
    back = [(-z * np.exp(-1j * angle), -angle) for z, angle in poses]
    out = []
    for k in range(len(dyads)):
        if np.isinf(dyads.fixed[k]):
            along = (places(poses, dyads.moving[k]) * np.conj(dyads.fixed_direction[k])).imag
        elif np.isinf(dyads.moving[k]):
            along = (places(back, dyads.fixed[k]) * np.conj(dyads.moving_direction[k])).imag
        else:
            along = np.abs(places(poses, dyads.moving[k]) - dyads.fixed[k])
        out.append(np.ptp(along) / 2)
    return np.array(out)


def some_poses(rng, count, size=1.0):
    return [(size * complex(*rng.normal(size=2)), rng.uniform(0, 2 * np.pi)) for _ in range(count)]


def missed(seed, count, poses, size=1.0):
    lost = []
    for known in known_linkages(np.random.default_rng(seed), count, poses, size):
        dyads = dyads_through(known.poses)
        lost += [(known, which) for which in (0, 1) if not apart(known, which, dyads, size) < 1e-6]
        assert count > 1000 or (misses(known.poses, dyads)[dyads.exact] < 1e-7 * size).all()
    return lost


@pytest.mark.parametrize(
    ("count", "poses", "size"),
    [(100, 5, 1.0), (20, 5, 1e-6), (6, 6, 100.0), pytest.param(4, 8, 1.0, marks=pytest.mark.campaign)],
)
def test_known_linkages_are_given_back(count, poses, size):
    assert not missed(poses, count, poses, size)


@pytest.mark.campaign
def test_ten_thousand_known_linkages_are_given_back():
    assert not missed(1, 10_000, 5)


def test_slides_of_known_linkages_are_recognised():
    for known in known_linkages(np.random.default_rng(3), 50, 5):
        dyads = dyads_through(known.poses)
        assert np.isinf(dyads.fixed).sum() >= sum(known.fixed_far)
        assert np.isinf(dyads.moving).sum() >= sum(known.moving_far)
        assert (np.isnan(dyads.fixed_direction) != np.isinf(dyads.fixed)).all()
        assert (np.isnan(dyads.moving_direction) != np.isinf(dyads.moving)).all()


@pytest.mark.campaign
def test_random_poses_have_none_two_or_four_and_all_are_true():
    rng = np.random.default_rng(4)
    counts = []
    for _ in range(300):
        poses = some_poses(rng, 5)
        dyads = dyads_through(poses)
        counts.append(len(dyads))
        assert dyads.exact.all()
        assert (misses(poses, dyads) <= 1e-12 * (10 + np.abs(dyads.moving) + np.abs(dyads.fixed))).all()
        assert dyads.residual == pytest.approx(misses(poses, dyads), abs=1e-9)
    shares = np.bincount(counts, minlength=5) / len(counts)
    # 10, 73 and 17 % of many.
    assert shares[[1, 3]].max() == 0
    assert shares[[0, 2, 4]] == pytest.approx([0.10, 0.73, 0.17], abs=0.06)


@pytest.mark.campaign
def test_no_dyad_of_five_poses_is_missed_by_brute_force():
    """Pins over a fine net of the body, polished by a plain simplex of distances, find none that is missing."""
    rng = np.random.default_rng(5)
    seen = 0
    for _ in range(3):
        poses = some_poses(rng, 5)
        reported = dyads_through(poses)
        x, y = np.meshgrid(np.linspace(-3, 3, 41), np.linspace(-3, 3, 41))
        net = (x + 1j * y).ravel()
        for _ in range(60):
            # Gauss-Newton by differences on the two conditions that five places lie on a circle.
            value = _five_on_a_circle(poses, net)
            h = 1e-6
            slopes = [(_five_on_a_circle(poses, net + step) - value) / h for step in (h, 1j * h)]
            det = slopes[0][0] * slopes[1][1] - slopes[0][1] * slopes[1][0]
            step = (value[0] * slopes[1][1] - value[1] * slopes[1][0]) / det
            side = (slopes[0][0] * value[1] - slopes[0][1] * value[0]) / det
            way = step + 1j * side
            net = net - way / np.maximum(1, 4 * np.abs(way))
        good = (np.abs(_five_on_a_circle(poses, net)).max(axis=0) < 1e-11) & (np.abs(net) < 20)
        points = places(poses, net[good])
        apart_ = np.abs(points[:, :, None] - points[:, None, :]) + 9 * np.eye(5)
        # Pins that two poses share are roots of these conditions, and no dyads.
        net = net[good][apart_.min(axis=(1, 2)) > 1e-4]
        seen += len(net)
        for pin in net:
            assert np.abs(reported.moving - pin).min() < 1e-6
    assert seen > 50


def _five_on_a_circle(poses, pins):
    """Determinants of places 1 2 3 with 4 and with 5, (2, pins)."""
    p = places(poses, pins)
    rows = np.stack([np.abs(p) ** 2, p.real, p.imag, np.ones(p.shape)], axis=-1)
    return np.array([np.linalg.det(rows[:, [0, 1, 2, k]]) for k in (3, 4)])


def test_chosen_points_of_three_poses():
    rng = np.random.default_rng(6)
    poses = some_poses(rng, 3)
    points = rng.normal(size=20) + 1j * rng.normal(size=20)
    for given in ("moving", "fixed"):
        dyads = dyads_through(poses, **{given: points})
        assert getattr(dyads, given) == pytest.approx(points)
        assert dyads.exact.all() and misses(poses, dyads).max() < 1e-12 * 1e3
    one = dyads_through(poses, moving=2 + 1j)
    assert len(one) == 1 and one.exact[0]


def test_chosen_points_of_more_poses_are_met_as_well_as_can_be():
    rng = np.random.default_rng(7)
    poses = some_poses(rng, 6)
    dyads = dyads_through(poses, moving=[0.3 + 0.1j])
    assert not dyads.exact[0]
    pins = places(poses, 0.3 + 0.1j)

    def squares(pivot):
        return np.sum((np.abs(pins - pivot) - np.abs(pins - pivot).mean()) ** 2)

    least = squares(dyads.fixed[0])
    for step in 0.01 * np.exp(2j * np.pi * np.arange(12) / 12):
        assert squares(dyads.fixed[0] + step) > least
    assert misses(poses, dyads)[0] == pytest.approx(dyads.residual[0])


def test_pins_on_the_circle_of_sliders_slide():
    rng = np.random.default_rng(8)
    for poses in (some_poses(rng, 3), [(0j, 0.2), (1 + 2j, 0.2), (3j, 1.1)]):
        circle = circle_of_sliders(poses)
        on_ground = circle.point(np.linspace(0.03, 0.97, 9))
        pins = (on_ground - poses[0][0]) * np.exp(-1j * poses[0][1])
        dyads = dyads_through(poses, moving=pins)
        assert np.isinf(dyads.fixed).all()
        assert misses(poses, dyads).max() < 1e-11
        # It passes through the image poles.
        for pole in image_poles(poses).values():
            at = pole.position
            if np.isfinite(at):
                off = (
                    abs(at - circle.centre) - circle.radius
                    if np.isfinite(circle.radius)
                    else ((at - circle.foot) / circle.direction).imag
                )
                assert abs(off) < 1e-10
    assert circle.radius == np.inf


def test_poles_are_where_two_poses_agree():
    rng = np.random.default_rng(9)
    poses = [*some_poses(rng, 4), (5j, 0.5), (3 + 1j, 0.5)]
    images = image_poles(poses, 2)
    for (j, k), pole in poles(poses).items():
        if (j, k) == (4, 5):
            assert np.isnan(pole.position)
            assert abs((np.conj(pole.direction) * (poses[5][0] - poses[4][0])).real) < 1e-12
            continue
        pin = (pole.position - poses[j][0]) * np.exp(-1j * poses[j][1])
        assert places(poses, pin)[[j, k]] == pytest.approx(np.full(2, pole.position))
        assert images[j, k].position == pytest.approx(complex(places(poses, pin)[2]))


@pytest.mark.parametrize(
    "angles", [(0.1, 0.1, 1, 2, 3), (0.1, 0.1, 1, 1, 2), (0.1, 0.1, 0.1, 1, 2), (0.1, 0.1, 0.1, 1, 1)], ids=str
)
def test_poses_parallel_in_part(angles):
    rng = np.random.default_rng(10)
    seen = 0
    for _ in range(20):
        poses = [(complex(*rng.normal(size=2)), angle) for angle in angles]
        dyads = dyads_through(poses)
        assert dyads.exact.all()
        assert (misses(poses, dyads) <= 1e-11 * (10 + np.abs(dyads.moving) + np.abs(dyads.fixed))).all()
        seen += len(dyads)
        four = dyads_through(poses[:4], count=40)
        assert four.exact.all() and len(four) >= 20
    assert seen > 10


def test_poses_of_a_trammel_have_the_middle_of_the_rod_besides_its_slides():
    """All points of a circle slide, so that two of them are reported; the middle of the rod moves on a circle."""
    motion = gk.move(gk.EllipticTrammel(60, origin=5 + 3j), [0.1, 0.5, 1, 2, 2.5, 3.1])
    rod = motion.bodies["rod"]
    poses = list(zip(rod.origin.position, np.angle(rod.direction)))
    for known in (poses[:5], [(-np.conj(np.exp(1j * angle)) * z, -angle) for z, angle in poses[:5]]):
        dyads = dyads_through(known)
        assert dyads.exact.all() and misses(known, dyads).max() < 1e-10
        pinned = np.isfinite(dyads.fixed) & np.isfinite(dyads.moving)
        assert len(dyads) == 3 and pinned.sum() == 1
        assert {complex(np.round(z[pinned][0], 9)) for z in (dyads.fixed, dyads.moving)} == {30 + 0j, 5 + 3j}


@pytest.mark.parametrize(
    ("poses", "more", "field"),
    [
        ([(0j, 0.0), (1j, 1.0)], {}, "poses"),
        ([(0j, 0.0), (1j, 1.0), (2j, 2.0)], {}, "poses"),
        ([(0j, 0.0), (1j, 1.0), (1j, 1.0)], {"moving": 1j}, "poses"),
        ([(0j, 0.0), (1j, 1.0), (1j, 1.0 + 2 * np.pi)], {"moving": 1j}, "poses"),
        ([(0j, 0.1 * k) for k in range(5)], {}, "poses"),
        ([(0j, 0.1 * k) for k in range(5)], {"moving": 1j, "fixed": 1j}, "moving"),
        ([(0j, 0.1 * k) for k in range(5)], {"moving": [[1j]]}, "moving"),
        ([(0j, 0.1 * k) for k in range(1001)], {"moving": 1j}, "poses"),
        ([0j, 1j, 2j], {"moving": 1j}, "poses"),
        ("none", {}, "poses"),
    ],
)
def test_invalid_poses_are_refused(poses, more, field):
    with pytest.raises(gk.DesignError) as refusal:
        dyads_through(poses, **more)
    assert refusal.value.field == field
