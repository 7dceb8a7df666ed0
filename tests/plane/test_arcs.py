"""Arcs: as near to the curve as asked, without kinks, and exact where the curve is made of arcs."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from geomkin.gear.spur import SpurGear
from geomkin.plane import measure
from geomkin.plane.approximation import to_arcs
from geomkin.plane.curve import Moved, Offset, Reversed
from geomkin.plane.primitives import Arc, Circle, Segment, rounded_hull, slot
from geomkin.plane.vec import Pose, xy
from tests.campaign import by_default

from .curves import Bezier, cam_profile, edges, examples, flank, off_arcs, off_chord, size

CURVES = examples() | {"flank": flank(), "cam": cam_profile(), "cam reversed": Reversed(cam_profile())}
TOLERANCES = (1e-1, 1e-3, 1e-4)


def along_arcs(line, count=24):
    """Points on every arc, its centre and sweep from the bulge: (edges, count)."""
    a, b, bulge = (x[:, None] for x in edges(line))
    share = np.linspace(0, 1, count)
    flat = np.abs(bulge) < 1e-7
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = (a + b) / 2 + 1j * (b - a) * (1 - bulge**2) / (4 * bulge)
        bent = centre + (a - centre) * np.exp(4j * np.arctan(bulge) * share)
    return np.where(flat, a + (b - a) * share, bent)


def deviation(curve, line):
    """Larger of the two: how far the curve strays from the arcs, and the arcs from the curve."""
    span = np.diff(curve.breaks)[:, None]
    dense = curve.point(curve.breaks[:-1, None] + span * np.linspace(0, 1, 400, endpoint=False)).ravel()
    from_arcs = off_arcs(*(x[:, None] for x in edges(line)), dense).min(axis=0).max()
    from_curve = measure.nearest(curve, along_arcs(line).ravel())[1].max()
    return max(from_arcs, from_curve)


def kinks(line):
    """Turn at each vertex between two edges, rad, and the vertices."""
    a, b, bulge = edges(line)
    sweep = 4 * np.arctan(bulge)
    out, into = (b - a) * np.exp(0.5j * sweep), (b - a) * np.exp(-0.5j * sweep)
    if not line.closed:
        return np.angle(into[1:] / out[:-1]), a[1:]
    return np.angle(into / np.roll(out, 1)), a


def corners(curve):
    """Points of a curve where its direction jumps, by differences."""
    b, h = curve.breaks, 1e-7 * np.diff(curve.breaks)
    before, after = curve.point(b[1:]) - curve.point(b[1:] - h), curve.point(b[:-1] + h) - curve.point(b[:-1])
    jump = np.abs(np.angle(np.roll(after, -1) / before))
    return curve.point(b[1:])[jump > 1e-4]


@pytest.mark.parametrize("name", by_default(CURVES, slice(0, None, 4)))
def test_arcs_of_every_curve(name):
    """Within the tolerance both ways, kinks only at the curve's corners, no arc over half a turn, ends kept."""
    curve = CURVES[name]
    allowed = np.append(corners(curve), np.inf)
    for tolerance in (10.0, *TOLERANCES):
        line = to_arcs(curve, tolerance)
        turn, at = kinks(line)
        ends = line.point(np.array([line.breaks[0], line.breaks[-1]]))
        # Readers of bulges differ above 1.
        assert np.abs(edges(line)[2]).max() <= 1 + 1e-7 and line.closed == curve.closed
        assert np.allclose(ends, curve.point(curve.breaks[[0, -1]]), rtol=0, atol=1e-11 * size(curve))
        if tolerance < 1:
            smooth = np.abs(at[:, None] - allowed).min(axis=1, initial=np.inf) > 1e-9
            assert np.abs(turn[smooth]).max(initial=0) < 1e-6
            assert deviation(curve, line) <= tolerance * (1 + 1e-3) + 1e-12 * size(curve)


def strays(curve, line):
    """How far the curve strays from the arcs, densely."""
    return off_arcs(*(x[:, None] for x in edges(line)), curve.point(np.linspace(0, 1, 2001))).min(axis=0).max()


@pytest.mark.campaign
@settings(deadline=None, derandomize=True, max_examples=20)
@given(st.lists(st.builds(complex, *[st.integers(-5, 5)] * 2), min_size=4, max_size=4, unique=True), st.floats(-3, -1))
def test_arcs_of_any_cubic_keep_the_tolerance(control, power):
    """Zigzags, loops and near cusps, the same on every run; to a hundredth, the examples below to a thousandth."""
    # On one line a cubic may double back, which is a corner inside a piece.
    assume(np.linalg.matrix_rank(xy(np.array(control) - control[0])) == 2)
    curve, tolerance = Bezier(tuple(control)), 10**power
    line = to_arcs(curve, tolerance)
    assert strays(curve, line) <= tolerance * (1 + 1e-2)
    # Back from the arcs to the curve, which is here its own 4000 chords: too sharp turns hide from fewer.
    dense = curve.point(np.linspace(0, 1, 4001))
    back = [off_chord(dense[:-1], dense[1:], p).min() for p in along_arcs(line, 12).ravel()]
    assert max(back) <= tolerance * (1 + 1e-2)
    assert np.abs(edges(line)[2]).max() <= 1 + 1e-7


def test_opposed_tangents_give_no_warning():
    """Somewhere on the way to few arcs, the ends of an interval ask for a biarc that does not exist."""
    curve, tolerance = Bezier((1 + 0j, 4 + 0j, 2j, 5 - 2j)), 4.2053185485452324e-2
    assert strays(curve, to_arcs(curve, tolerance)) <= tolerance * (1 + 1e-2)


@pytest.mark.parametrize("tolerance", [1e-2])
def test_circles_and_straight_pieces_come_back_exactly(tolerance):
    disc = to_arcs(Circle(1 + 1j, 3.0), tolerance)
    assert np.allclose(disc.vertices, [4 + 1j, -2 + 1j]) and np.array_equal(disc.bulges, [1, 1])
    line = to_arcs(Segment(1j, 4 + 3j), tolerance)
    assert np.allclose(line.vertices, [1j, 4 + 3j]) and np.array_equal(line.bulges, [0])
    pill = to_arcs(slot(0j, 4 + 0j, 1.0), tolerance)
    assert np.allclose(pill.vertices, [1j, -1j, 4 - 1j, 4 + 1j]) and np.allclose(pill.bulges, [1, 0, 1, 0], atol=1e-9)
    hull = rounded_hull([0, 5, 1 + 3j], 0.8)
    for curve, count in ((hull, 6), (Moved(hull, Pose(1j, 1j)), 6), (Reversed(hull), 6), (Offset(hull, 0.3), 6)):
        exact = to_arcs(curve, tolerance)
        assert len(exact.bulges) == count
        assert np.isclose(measure.signed_area(exact), measure.signed_area(curve), rtol=1e-9)
    three_quarters = to_arcs(Arc(0j, 2 + 0j, 1.5 * np.pi), tolerance)
    assert 2 <= len(three_quarters.bulges) <= 3
    assert np.allclose(np.abs(along_arcs(three_quarters)), 2)


def test_ring_of_copies_has_copies_of_arcs():
    gear = SpurGear(13, 2).outline
    line, one = to_arcs(gear, 1e-3), to_arcs(gear.piece, 1e-3)
    # The two halves of a bottom land, at both ends of a piece, are one arc of the whole.
    assert line.closed and len(line.vertices) == 13 * (len(one.bulges) - 1)
    z = np.asarray(line.vertices).reshape(13, -1)
    assert np.allclose(z[1:], z[:-1] * np.exp(2j * np.pi / 13), rtol=0, atol=1e-12)
    assert np.isclose(measure.signed_area(line), measure.signed_area(gear), atol=1e-3 * measure.length(gear))
    assert deviation(gear.piece, one) <= 1e-3 * (1 + 1e-3)
    # From copy to copy the bottom land goes on smoothly.
    turn, _ = kinks(line)
    assert np.abs(turn.reshape(13, -1)[:, 0]).max() < 1e-6
