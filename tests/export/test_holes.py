"""Holes within their plate and apart from each other, against every edge held against every other in NumPy."""

import dataclasses

import numpy as np
import pytest

import geomkin as gk
from geomkin.export.cut import cut
from geomkin.plane import region


def ends(loop):
    return loop, np.roll(loop, -1)


def crossing(one, two):
    """Whether any edge of one polygon crosses any of the other."""
    (a, b), (c, d) = ([z[:, None] for z in ends(one)], ends(two))

    def side(p, q, r):
        return np.sign(((q - p).conj() * (r - p)).imag)

    return bool(((side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)).any())


def winds(loop, place):
    seen = loop - place
    return abs(np.angle(np.roll(seen, -1) / seen).sum()) > np.pi


def meet(one, two):
    return crossing(one, two) or winds(one, two[0]) or winds(two, one[0])


def away(one, two):
    """Least distance of two boundaries that do not cross: from the corners of each to the edges of the other."""

    def least(places, loop):
        a, b = ends(loop)
        share = np.clip(((b - a).conj() * (places[:, None] - a)).real / np.abs(b - a) ** 2, 0, 1)
        return np.abs(a + share * (b - a) - places[:, None]).min()

    return min(least(one, two), least(two, one))


def star(turns, corners, centre, size):
    angle = np.sort(turns.uniform(0, 2 * np.pi, corners)) + 0.1 * np.arange(corners)
    return centre + size * turns.uniform(0.4, 1, corners) * np.exp(2j * np.pi * angle / (angle[-1] + 0.3))


def random_plate(seed, size, count=14):
    turns = np.random.default_rng(seed)
    outer = 10 * np.exp(2j * np.pi * np.arange(30) / 30) * turns.uniform(0.8, 1.2, 30)
    places = 9.5 * np.sqrt(turns.uniform(0, 1, count)) * np.exp(2j * np.pi * turns.uniform(0, 1, count))
    return outer, [star(turns, 7, place, size) for place in places]


@pytest.mark.parametrize("size", [0.6, 1.2])
def test_verdicts_on_random_holes_are_those_of_every_pair(size):
    seen = set()
    for seed in range(12):
        outer, holes = random_plate(seed, size)
        inside = [not crossing(outer, h) and winds(outer, h[0]) and away(outer, h) >= 0.4 for h in holes]
        assert region.apart_inside(outer, holes, 0.4).tolist() == inside
        pairs = {(j, k) for k in range(len(holes)) for j in range(k) if meet(holes[j], holes[k])}
        assert set(map(tuple, region.overlapping(holes).tolist())) == pairs
        seen |= {("inside", x) for x in inside} | {("meets", bool(pairs))}
    assert {("inside", True), ("inside", False), ("meets", True)} <= seen


def test_holes_that_share_a_side_or_an_area_overlap_and_those_that_meet_at_a_corner_do_not():
    square = np.array([0, 1, 1 + 1j, 1j])
    assert sorted(region.overlapping([square, square + 1, square + 1 + 1j]).tolist()) == [[0, 1], [1, 2]]
    nested = [square, square + 5, 0.5 * square + 0.2 + 0.2j, square]
    assert sorted(region.overlapping(nested).tolist()) == [[0, 2], [0, 3], [2, 3]]
    assert region.overlapping([]).tolist() == []


def test_a_solid_whose_walls_are_turned_inside_out_is_never_written():
    """Such walls pass for watertight: the volume shows it, and either alone is enough to refuse."""
    from geomkin.export.solids import stl

    sound = cut(gk.Part("plate", gk.plane.Circle(0, 20), (gk.plane.Circle(5, 4),), 3.0), 0.01)
    assert stl(sound)
    outline, hole = sound.loops
    turned = dataclasses.replace(sound, loops=(outline, dataclasses.replace(hole, points=hole.points[::-1])))
    with pytest.raises(gk.GeomkinError, match="volume"):
        stl(turned)
