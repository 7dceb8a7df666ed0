"""How linkages through poses are looked for: where pins are tried, how pairs are made better, which are listed."""

import numpy as np
import pytest

from geomkin.core.progress import Watch, shown
from geomkin.synthesis import body_guides, circle_of_sliders
from geomkin.synthesis.guidance import guide_search
from geomkin.synthesis.guidance.guide_search import Displacements, Search, climbed, distinct
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


@pytest.mark.parametrize("kind", KINDS)
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


def test_those_that_are_distinct_are_the_first_of_their_likes():
    rng = np.random.default_rng(1)
    pairs = rng.uniform(0, 10, (80, 2)) + 1j * rng.uniform(0, 10, (80, 2))
    kept = []
    for k, pair in enumerate(pairs):
        if all(max(abs(pair[0] - pairs[j, 0]), abs(pair[1] - pairs[j, 1])) > 3 for j in kept):
            kept.append(k)
    assert 10 < len(kept) < 60
    assert distinct(pairs, 80, 3.0) == kept and distinct(pairs, 7, 3.0) == kept[:7]
    assert distinct(pairs[:0], 7, 3.0) == [] and distinct(pairs, 0, 3.0) == []
    # Of a search it is a share of its region's diagonal.
    search = search_of("four-bar", high=LOW + 60 + 45j)
    assert search.size == 75 and search.distinct(pairs, 80) == distinct(pairs, 80, 3.0)


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


def test_a_climb_moves_each_pin_alone_and_both_and_never_by_more_than_it_is_spread():
    """Children about a place that nothing is better than: how far they are, generation after generation."""
    start = np.array([[5 + 1j, -3 + 2j], [50 + 10j, -30 + 20j]])
    seen = []

    def score(pairs):
        seen.append(pairs)
        return np.where(np.isin(pairs[:, 0], start[:, 0]) & np.isin(pairs[:, 1], start[:, 1]), 1.0, 0.0)

    assert (climbed(start, score, 8.0, np.random.default_rng(4), Watch(60, "")) == start).all()
    moves = np.array([pairs.reshape(2, -1, 2) - start[:, None] for pairs in seen[1:]])
    one, other = (moves[..., k] != 0 for k in (0, 1))
    assert (one & other).sum() == (one ^ other).sum() and (one & ~other).sum() == (other & ~one).sum()
    assert (one | other).all()
    # The root mean square of each part of a move is the spread, which shrinks until it is the finest.
    wide = [np.sqrt((np.abs(moves[k]) ** 2).sum() / (2 * np.count_nonzero(moves[k]))) for k in range(len(moves))]
    assert wide[0] == pytest.approx(8, rel=0.2)
    shrunk = np.array([8 * guide_search.NARROWER**k for k in range(len(wide))])
    finest = 8 * guide_search.FINEST / guide_search.SPREAD
    assert np.abs(np.array(wide) / np.maximum(shrunk, finest) - 1).max() < 0.5
    assert shrunk[-1] < finest


def test_children_spread_out_again_where_they_are_better():
    """Up a slope without end: moves grow to the spread that was given, and no farther."""
    shares = iter(range(10**6))

    def score(pairs):
        # First nothing is better for some time, so that moves are small, then everything is.
        call = next(shares)
        return np.zeros(len(pairs)) - call if call < 30 else pairs[:, 0].real + 1000.0

    seen = []

    def watched(pairs):
        seen.append(pairs)
        return score(pairs)

    found = climbed(np.array([[0j, 0j]]), watched, 4.0, np.random.default_rng(5), Watch(60, ""))
    reach = [np.ptp(pairs[:, 0].real) for pairs in seen[1:]]
    assert reach[28] < 0.1 * reach[0] and reach[60] > 0.5 * reach[0]
    assert max(reach) < 8 * 4.0 and found[0, 0].real > 100 * 4.0


def test_a_search_goes_on_until_there_is_something_to_start_from(monkeypatch):
    monkeypatch.setattr(guide_search, "PINS", 1500)
    monkeypatch.setattr(guide_search, "PAIRS", 1500)
    monkeypatch.setattr(guide_search, "GENERATIONS", 5)
    made = []
    pairs = Search._pairs
    monkeypatch.setattr(Search, "_pairs", lambda self, rng: made.append(1) or pairs(self, rng))
    for changed, rounds in (({}, 1), ({"largest_ratio": 1.0}, 12)):
        made.clear()
        shares = []
        with shown(lambda share, what: shares.append(share)):
            good, _ = search_of("four-bar", **changed).run(np.random.default_rng(6), Watch(60, "looking"))
        assert len(made) == rounds and shares[:rounds] == pytest.approx(np.arange(rounds) / 24)
        assert shares[-1] == 1 and shares == sorted(shares) and bool(len(good)) == (rounds == 1)
    # With time for nothing more there is one round.
    made.clear()
    search_of("four-bar", largest_ratio=1.0).run(np.random.default_rng(6), Watch(0, "looking"))
    assert len(made) == 1


@pytest.mark.parametrize("kind", ["four-bar", "slider-crank"])
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


def test_a_climb_begins_with_the_best_of_all_pairs_that_were_tried(monkeypatch):
    """Without generations nothing is left but to rank them: the best that differ, of all that were made."""
    monkeypatch.setattr(guide_search, "GENERATIONS", 0)
    tried, pairs = [], Search._pairs

    def watched(self, rng):
        tried.append(pairs(self, rng))
        return tried[-1]

    monkeypatch.setattr(Search, "_pairs", watched)
    # So few are sound that one round is not enough.
    search = search_of("four-bar", largest_ratio=1.3)
    good, bad = search.run(np.random.default_rng(8), Watch(60, "looking"))
    every = np.concatenate(tried)
    guides = search.made(every)
    with np.errstate(all="ignore"):
        score, fits = search.score(guides), search.fits(guides)
    best = [k for k in np.argsort(-score, kind="stable") if np.isfinite(score[k])]
    assert 1 < len(tried) < guide_search.ROUNDS and len(best) >= 4 * guide_search.STARTS
    kept = distinct(every[best], guide_search.STARTS, guide_search.DISTINCT * search.size)
    assert len(kept) > 5 and (good == every[best][kept]).all()
    wrong = every[fits & ~guides.defects.none]
    assert len(bad) and all((wrong == pair).all(axis=1).any() for pair in bad)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_of_three_parallel_poses_all_points_slide_or_none(size):
    z = size * (np.arange(5) - 2 + 3j)
    for way in np.exp(1j * np.linspace(0, 3, 7)):
        straight = [(size * (0.3 - 0.1j + way * t), 0.4) for t in (0, 1.1, 2.7)]
        assert body_of(straight).onto_sliders(z) == pytest.approx(z)
        bent = [*straight[:2], (straight[2][0] + 1e-3j * size * way, 0.4)]
        assert np.isnan(body_of(bent).onto_sliders(z)).all()
