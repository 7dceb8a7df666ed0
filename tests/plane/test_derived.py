"""Curves made of other curves: moved, reversed, mirrored, parallel, end to end and in a ring."""

import numpy as np
import pytest

from geomkin.core.errors import DesignError
from geomkin.plane import measure
from geomkin.plane.curve import Mirrored, Moved, Offset, Reversed, SubCurve
from geomkin.plane.joined import Path, PolarArray
from geomkin.plane.primitives import Arc, Polyline, Segment
from geomkin.plane.roulettes import Involute
from geomkin.plane.vec import Pose, xy

from .curves import Bezier, Flower

ZIGZAG = Bezier((0j, 3 + 4j, 1 - 4j, 4 + 0j))
T = np.linspace(0, 1, 21)


def test_moved_turns_then_shifts():
    """Against the rotation matrix in coordinates."""
    c, s = np.cos(0.7), np.sin(0.7)
    out = Moved(ZIGZAG, Pose(3 - 2j, complex(c, s)))
    assert np.allclose(xy(out.point(T)), xy(ZIGZAG.point(T)) @ np.array([[c, s], [-s, c]]) + [3, -2])
    assert np.allclose(out.pose.locate(out.point(T)), ZIGZAG.point(T))


def test_reversed_is_the_same_trace_backwards():
    back = Reversed(ZIGZAG)
    t = np.linspace(*back.breaks, 21)
    assert np.allclose(back.point(t)[::-1], ZIGZAG.point(T), rtol=0, atol=1e-14)
    assert np.allclose(np.sign(back.curvature(t))[::-1], -np.sign(ZIGZAG.curvature(T)))
    twice = Reversed(back)
    assert np.array_equal(twice.breaks, ZIGZAG.breaks) and np.allclose(twice.point(T), ZIGZAG.point(T), atol=1e-14)


def test_mirrored_swaps_left_and_right():
    assert np.array_equal(xy(Mirrored(ZIGZAG).point(T)), xy(ZIGZAG.point(T)) * [-1, 1])
    loop = Flower(3.0)
    assert np.isclose(measure.signed_area(Mirrored(loop)), -measure.signed_area(loop))


@pytest.mark.parametrize("distance", [0.3, -0.2])
def test_offset_lies_square_to_the_curve_on_its_right(distance):
    """Its nearest point of the curve is as far as the distance; left and right by the sign of a cross product."""
    beside = Offset(ZIGZAG, distance)
    z = beside.point(T[1:-1])
    foot, away = measure.nearest(ZIGZAG, z)
    assert np.allclose(away, abs(distance), rtol=1e-12) and np.allclose(foot, T[1:-1], atol=1e-6)
    left = np.imag(np.conj(ZIGZAG.velocity(T[1:-1])) * (z - ZIGZAG.point(T[1:-1])))
    assert (np.sign(left) == -np.sign(distance)).all()


def test_offset_of_an_involute_is_the_string_cut_shorter():
    """Parallels of an involute are the same involute turned: also the one that starts at the cusp."""
    radius, distance = 3.0, 0.6
    beside = Offset(Involute(radius, 0.0, 1.2), distance)
    t = np.linspace(0, 1.2, 13)
    turned = Involute(radius, 0.0, 2.0).point(t + distance / radius) * np.exp(-1j * distance / radius)
    assert np.allclose(beside.point(t[1:]), turned[1:])
    assert np.allclose(beside.point(t), turned), "at the cusp the direction is that of the curve just after it"
    back = Offset(Reversed(Involute(radius, 0.0, 1.2)), -distance)
    assert np.allclose(back.point(-t), turned), "or just before it, where the curve ends there"


def test_offset_of_a_path_of_cusps_leaves_each_along_the_piece_that_answers_there():
    """Where pieces meet in a cusp, that of the one that starts there; at the very end, that of the one before."""
    unwound = Involute(3.0, 0.0, 1.2)
    pieces = [unwound]
    for k in range(1, 5):
        # There and back, each turned by a little more.
        piece = Moved(unwound if k % 2 == 0 else Reversed(unwound), Pose(0j, np.exp(0.4j * k)))
        end, start = pieces[-1].point(pieces[-1].breaks[-1]), piece.point(piece.breaks[0])
        pieces.append(Moved(piece, Pose(complex(end - start))))
    for curve in (Path(tuple(pieces)), Path(tuple(pieces[1:4])), Path(tuple(pieces[:4])), Path(tuple(pieces[2:4]))):
        beside, inner, end = Offset(curve, 0.6), curve.breaks[:-1], curve.breaks[-1]
        assert np.abs(beside.point(inner) - beside.point(inner + 1e-7)).max() < 1e-5
        assert abs(beside.point(end) - beside.point(end - 1e-7)) < 1e-5


def test_part_of_a_ring_ends_along_its_last_piece_however_many_follow():
    """The ring moves parameters onto its breaks by the rounding of its last one, not by that of the part's end."""
    ring = PolarArray(Polyline(np.exp([0, np.log(0.9) + 0.02j * np.pi, 0.04j * np.pi]), None, False), 50)
    part = SubCurve(ring, ring.breaks[:2])
    assert np.allclose(part.velocity(part.run[-1]), ring.velocity(0.5))


def test_path_runs_each_piece_over_one_unit():
    pieces = (Segment(0j, 2 + 0j), Arc(2 + 1j, 2 + 0j, np.pi / 2), Moved(ZIGZAG, Pose(3 + 1j)))
    path = Path(pieces)
    assert not path.closed and np.array_equal(path.breaks, [0, 1, 2, 3])
    for k, piece in enumerate(pieces):
        assert np.allclose(path.point(k + T[:-1]), piece.point(T[:-1]))
    assert np.isclose(measure.length(path), sum(measure.length(p) for p in pieces))


def test_ring_is_its_copies_turned():
    count = 7
    piece = Segment(2 + 0j, 2 * np.exp(2j * np.pi / count))
    heptagon = 2 * np.exp(2j * np.pi * np.arange(count) / count)
    ring = PolarArray(piece, count)
    assert ring.closed and np.allclose(ring.point(np.arange(count)), heptagon)
    assert np.isclose(measure.signed_area(ring), 0.5 * count * 4 * np.sin(2 * np.pi / count))


def test_pieces_that_do_not_meet_are_refused():
    with pytest.raises(DesignError, match=r"0\.1"):
        Path((Segment(0j, 1 + 0j), Segment(1 + 0j, 2 + 0j), Segment(2.1 + 0j, 3 + 0j)))
    with pytest.raises(DesignError) as refusal:
        PolarArray(Segment(2 + 0j, 2j), 5)
    assert refusal.value.field == "piece"
