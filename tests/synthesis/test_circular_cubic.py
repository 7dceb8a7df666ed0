"""Cubics traced whole, whatever they are made of: all points on them, none missed in the plane, rates by differences."""

from itertools import permutations

import numpy as np
import pytest

from geomkin.synthesis.guidance.burmester import Cubic, intervals_inside


def cubic_of(terms):
    """From the factors of x^i y^j, by (i, j): the symmetric tensor, every order of the indices having its share."""
    tensor = np.zeros((3, 3, 3))
    for (i, j), factor in terms.items():
        orders = set(permutations((0,) * i + (1,) * j + (2,) * (3 - i - j)))
        for order in orders:
            tensor[order] += factor / len(orders)
    return Cubic(tensor)


def value(terms, z):
    return sum(factor * z.real**i * z.imag**j for (i, j), factor in terms.items())


def circular(lead, conic):
    """(x^2 + y^2)(l x + m y) and the terms of lower degree."""
    (el, em), (a, b, c, d, e, f) = lead, conic
    high = {(3, 0): el, (1, 2): el, (2, 1): em, (0, 3): em}
    return high | {(2, 0): a, (1, 1): b, (0, 2): c, (1, 0): d, (0, 1): e, (0, 0): f}


def times(line, conic):
    """A line and a circle, whose axis of symmetry the line is where it goes through the circle's centre."""
    (p, q, r), (s, t, u) = line, conic
    high = {(3, 0): p, (1, 2): p, (2, 1): q, (0, 3): q, (2, 0): r + p * s, (0, 2): r + q * t, (1, 1): p * t + q * s}
    return high | {(1, 0): p * u + r * s, (0, 1): q * u + r * t, (0, 0): r * u}


RNG = np.random.default_rng(6)
CUBICS = [
    circular(size * RNG.normal(size=2), RNG.normal(size=6))
    for size in (0, 1e-13, 1e-10, 1e-9, 1e-6, 1e-3, 1, 1, 10)
    for _ in range(6)
]
# A line and a circle, a line beside a circle, and conics and the line at infinity: ellipse, hyperbola, two lines.
CUBICS += [times((1.0, 2.0, 0.3), (0.4, -1.1, 0.2)), times((1.0, 0.5, 6.0), (0.2, 0.1, -2.0))]
CUBICS += [circular((0, 0), conic) for conic in [(1, 0, 2, 0.3, 0, -3), (1, 0, -2, 0, 0.2, 1), (1, 0.5, -1, 0, 0, 0)]]
# Cubics of another kind, of which every line through the known point meets two branches.
CUBICS += [
    {(3, 0): 1, (1, 2): -4, (0, 1): 1},
    {(3, 0): 1, (1, 2): -3, (0, 1): 2, (1, 0): 0.3, (1, 1): 0.2, (0, 0): 0.4},
]


def traced(terms, count):
    """Places and weights along every loop, (loops, count), of size 1 together, with their rates."""
    cubic, t = cubic_of(terms), np.linspace(0, 2 * np.pi, count)
    return cubic, t, [(loop, *cubic.run(loop, t)) for loop in cubic.loops]


@pytest.mark.parametrize("terms", [*CUBICS[:-7:5], *CUBICS[-7:]])
def test_a_cubic_is_traced_whole(terms):
    cubic, _, loops = traced(terms, 8001)
    largest = max(abs(factor) for factor in terms.values())
    side = np.linspace(-4, 4, 66)
    net = side + 1j * side[:, None]
    positive = value(terms, net) > 0
    corner = [positive[:-1, :-1], positive[1:, :-1], positive[:-1, 1:], positive[1:, 1:]]
    mixed = ~(np.all(corner, axis=0) | ~np.any(corner, axis=0))
    middles = (net[:-1, :-1] + net[1:, 1:])[mixed] / 2
    assert loops or not len(middles)
    drawn = []
    for loop, place, weight, _, _ in loops:
        v = np.stack([place.real, place.imag, weight], axis=-1)
        size = np.linalg.norm(v, axis=-1)
        off = np.einsum("abc,ka,kb,kc->k", cubic.tensor, v, v, v) / size**3
        rounding = 1e-13 if abs(cubic.tensor[0, 0, 0]) > 1e-2 else 1e-7
        assert size.min() > 0 and np.abs(off).max() < rounding * largest
        # Each closes as a line through the middle of space does.
        ends = v[[0, -1]] / size[[0, -1], None]
        apart = min(np.abs(ends[0] - ends[1]).max(), np.abs(ends[0] + ends[1]).max())
        # For a nearly degenerate cubic, rounding decides where it is at infinity.
        assert apart < 1e-4 or (0 < abs(cubic.tensor[0, 0, 0]) < 1e-8 and not np.isnan(loop.half))
        near = np.abs(weight) * 20 > np.abs(place)
        drawn.append(place[near] / weight[near])
    if len(middles):
        every = np.concatenate(drawn)
        assert max(np.abs(every - z).min() for z in middles[::3]) < 1.5 * np.hypot(*2 * [side[1] - side[0]])


@pytest.mark.parametrize("terms", CUBICS[24::6])
def test_rates_are_those_of_the_places(terms):
    cubic, _, loops = traced(terms, 3)
    t, h, seen = np.linspace(0.2, 6.1, 60), 1e-6, 0
    for loop, *_ in loops:
        (ahead, ahead_weight, *_), (behind, behind_weight, *_) = cubic.run(loop, t + h), cubic.run(loop, t - h)
        place, weight, place_rate, weight_rate = cubic.run(loop, t)
        # Homogeneous numbers may be of any size: what counts is how the place moves.
        moved = (ahead / ahead_weight - behind / behind_weight) / (2 * h)
        rate = (place_rate * weight - place * weight_rate) / weight**2
        near = np.abs(place / weight) < 30
        assert (np.abs(moved - rate) / (1 + np.abs(moved)))[near].max(initial=0) < 1e-3
        seen += near.sum()
    assert seen > 20


@pytest.mark.campaign
def test_point_of_a_loop_with_a_given_direction_is_found():
    seen = set()
    for terms in CUBICS:
        cubic, _, loops = traced(terms, 3)
        for loop, *_ in loops:
            t = np.linspace(1e-3, 2 * np.pi + 1e-3, 4001)
            for psi in (-4.0, 0.3, 2.9):
                found = np.array(loop.at(psi))
                if loop.half != 0:
                    # As often as the lines come past it.
                    side = np.sin(loop.angle_and_root(t)[0] - psi) > 0
                    different = np.unique(np.round(found % (2 * np.pi), 9))
                    assert len(different) == np.count_nonzero(side[1:] != side[:-1])
                seen.add((len(found), bool(np.isnan(loop.half)), loop.half == 0))
                place, weight, _, _ = cubic.run(loop, found)
                # Across the way to infinity, x : 1 is as sin : cos.
                if loop.half != 0:
                    off = (place * np.conj(cubic.axis)).real * np.cos(psi) - weight * np.sin(psi)
                    assert np.abs(off).max(initial=0) < 1e-6
                else:
                    assert abs(weight[0]) < 1e-12
    assert {(2, False, False), (0, False, False), (2, True, False), (1, False, True)} <= seen


def test_a_cubic_without_real_points_has_no_loops():
    assert cubic_of(circular((0, 0), (1, 0, 2, 0, 0, 1))).loops == ()
    assert cubic_of(circular((0, 0), (1, 2, 1, 0, 0, 0))).loops == ()


def test_stretches_that_are_inside_are_found_round_the_start():
    grid = np.linspace(0, 2 * np.pi, 40)
    for inside, wanted in (
        (lambda t: np.cos(t) - 0.5, [(5 * np.pi / 3, 7 * np.pi / 3)]),
        (lambda t: 0.5 - np.cos(t), [(np.pi / 3, 5 * np.pi / 3)]),
        (lambda t: np.sin(2 * t - 0.2), [(0.1, 0.1 + np.pi / 2), (0.1 + np.pi, 0.1 + 1.5 * np.pi)]),
        (lambda t: np.cos(2 * t), [(0.75 * np.pi, 1.25 * np.pi), (1.75 * np.pi, 2.25 * np.pi)]),
        (lambda t: 1 + 0 * t, [(0, 2 * np.pi)]),
        (lambda t: -1 + 0 * t, []),
    ):
        # Wherever the looks begin, and beyond one turn.
        for begin in (0.01, 0.12, 1.0, 7.0):
            found = intervals_inside(inside, grid + begin)
            # One in the first cell of the samples may be reported a turn later.
            reported = sorted((low % (2 * np.pi), low % (2 * np.pi) + high - low) for low, high in found)
            assert np.array(reported) == pytest.approx(np.array(wanted), abs=1e-9)
            assert all((inside(np.array(stretch)) > -1e-12).all() for stretch in found)
