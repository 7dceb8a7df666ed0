"""How linkages through poses are looked for: where pins are tried, how pairs are made better, which are listed."""

import numpy as np
import pytest

from geomkin.core.progress import Watch, shown
from geomkin.synthesis import body_guides, circle_of_sliders
from geomkin.synthesis.guidance import guide_search
from geomkin.synthesis.guidance.guide_search import Displacements, Search, climbed
from tests.synthesis import driving
from tests.synthesis.test_guidance import KINDS, THREE

LOW, HIGH = -70 - 40j, 140 + 90j


def body_of(poses):
    return Displacements(np.array([z for z, _ in poses]), np.exp(1j * np.array([t for _, t in poses])))


def search_of(kind, **changed):
    asked = {"slides": kind == "slider-crank", "low": LOW, "high": HIGH, "least_angle": 0.0, "largest_ratio": 10.0}
    return Search(kind=kind, body=body_of(THREE), **asked | changed)


def places(poses, z):
    """Where the points that are at z at the first pose are at each, (poses, points)."""
    own = (z - poses[0][0]) * np.exp(-1j * poses[0][1])
    return np.array([origin + np.exp(1j * turn) * own for origin, turn in poses])


def inside(z):
    return (z.real >= LOW.real) & (z.real <= HIGH.real) & (z.imag >= LOW.imag) & (z.imag <= HIGH.imag)


def nearest(wanted, found):
    return np.abs(wanted[:, None] - found).min(axis=1)


@pytest.mark.parametrize("kind", KINDS[1:4:2])
def test_pins_are_tried_all_over_the_region_and_stay_in_it_with_their_pivots(kind):
    pairs = search_of(kind)._pairs(np.random.default_rng(3))
    assert pairs.shape == (guide_search.PAIRS, 2)
    x, y = np.meshgrid(np.linspace(LOW.real, HIGH.real, 43)[1:-1], np.linspace(LOW.imag, HIGH.imag, 33)[1:-1])
    for z, slides in zip(pairs.T, (kind == "elliptic-trammel", kind != "four-bar")):
        pins = places(THREE, z)
        assert inside(pins).all()
        if slides:
            way = (pins[1] - pins[0]) * np.conj(pins[2] - pins[0])
            assert np.abs(way.imag).max() < 1e-9 * np.abs(HIGH - LOW) ** 2
            net = circle_of_sliders(THREE).point(np.linspace(0, 1, 400))
        else:
            assert inside(driving.centre_of(pins)).all()
            net = (x + 1j * y).ravel()
            net = net[inside(driving.centre_of(places(THREE, net)))]
        # Every place from which all stays inside has one that was tried nearby.
        net = net[inside(places(THREE, net)).all(axis=0)]
        assert len(net) > 30 and nearest(net, z).max() < 6


def test_a_region_that_no_pin_stays_in_has_no_pairs():
    for kind in KINDS:
        assert search_of(kind, high=LOW + 1 + 1j)._pairs(np.random.default_rng(0)).shape == (0, 2)


def test_a_climb_ends_at_the_nearest_best_place():
    rng = np.random.default_rng(2)
    best = np.array([3 + 4j, -20 + 7j])
    starts = best + 10 * (rng.normal(size=(6, 2)) + 1j * rng.normal(size=(6, 2)))
    asked = []

    def score(pairs):
        asked.append(len(pairs))
        # The second pin tells less, and one side is out of question.
        off = np.abs(pairs - best)
        return np.where(pairs[:, 0].real < 2.5, -np.inf, -(off[:, 0] ** 2) - 0.1 * off[:, 1] ** 2)

    shares = []
    with shown(lambda share, what: shares.append(share)):
        found = climbed(starts, score, 5.0, rng, Watch(60, "climbing"))
    assert np.abs(found - best).max() < 0.02
    scores = score(found)
    assert (np.diff(scores) <= 0).all() and np.unique(scores).size == 6
    # Half of its share of the work is before it, and the rest goes on evenly.
    assert shares[0] == 0.5 and np.ptp(np.diff(shares)) < 1e-12 and shares[-1] + shares[1] == pytest.approx(1.5)
    assert asked[0] == 6 and set(asked[1:-1]) == {6 * guide_search.CHILDREN}
    # Without time they stay where they are, the best first.
    still = climbed(starts, score, 5.0, rng, Watch(0, "climbing"))
    order = np.argsort(-score(starts), kind="stable")
    assert (still == starts[order]).all()


@pytest.mark.parametrize("kind", ["slider-crank"])
def test_a_search_gives_sound_pairs_the_best_first_and_a_few_that_are_not(kind, monkeypatch):
    monkeypatch.setattr(guide_search, "GENERATIONS", 10)
    search = search_of(kind, least_angle=np.radians(20))
    good, bad = search.run(np.random.default_rng(7), Watch(60, "looking"))
    guides = search.made(good)
    assert (np.diff(search.score(guides)) <= 0).all() and 10 < len(good) <= guide_search.STARTS
    for k in range(len(good)):
        # By a linkage that is made and moved.
        poses = [(complex(z), float(t)) for z, t in THREE]
        own = (good[k] - poses[0][0]) * np.exp(-1j * poses[0][1])
        # The driving pin comes first.
        own = own[::-1] if kind == "slider-crank" else own
        (found, *_) = body_guides(poses, kind, moving_points=tuple(complex(z) for z in own))
        assert found.transmission_angle_deg >= 20 - 1e-6 and not found.defects and found.ratio <= 10 + 1e-9
    wrong = search.made(bad)
    assert len(bad) == guide_search.DEFECTIVE and not wrong.defects.none.any() and search.fits(wrong).all()
    apart = np.abs(bad[:, None] - bad).max(axis=2) + 1e9 * np.eye(len(bad))
    assert apart.min() > guide_search.DISTINCT * abs(HIGH - LOW)


@pytest.mark.parametrize("size", [1e-6])
def test_of_three_parallel_poses_all_points_slide_or_none(size):
    z = size * (np.arange(5) - 2 + 3j)
    for way in np.exp(1j * np.linspace(0, 3, 7)):
        straight = [(size * (0.3 - 0.1j + way * t), 0.4) for t in (0, 1.1, 2.7)]
        assert body_of(straight).onto_sliders(z) == pytest.approx(z)
        bent = [*straight[:2], (straight[2][0] + 1e-3j * size * way, 0.4)]
        assert np.isnan(body_of(bent).onto_sliders(z)).all()
