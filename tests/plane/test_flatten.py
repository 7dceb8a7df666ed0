"""Chords: never farther from the curve than asked, and a point at every corner."""

import importlib
import re

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from geomkin.core.errors import DesignError
from geomkin.gear.cutters import RackCutter
from geomkin.gear.spur import SpurGear
from geomkin.plane.curve import Moved, Offset, Reversed, SubCurve
from geomkin.plane.flatten import flatten
from geomkin.plane.joined import Path, PolarArray
from geomkin.plane.measure import signed_area
from geomkin.plane.parallel import parallel
from geomkin.plane.primitives import Arc, Circle, Polyline, Segment, rounded_hull, slot
from geomkin.plane.vec import Pose, xy

from .curves import Bezier, Flower, cam_profile, examples, flank, off_chord, size
from .test_fewest import fewest_chords

flatten_module = importlib.import_module("geomkin.plane.flatten")
CURVES = [*examples(), "flower in one piece"]


def named(name, scale=1.0):
    return Flower(3.0 * scale, 1) if name == "flower in one piece" else examples(scale)[name]


def places(curve, z):
    """Parameter of each point of a curve: Newton's steps from the nearest of many, in every smooth piece.

    Fails where a point is not on the curve or the points do not go along it.
    """
    b = curve.breaks
    low, span = b[:-1, None], np.diff(b)[:, None]
    cells = low + span * (np.arange(64) + 0.5) / 64
    nearest = np.abs(curve.point(cells)[:, None, :] - z[None, :, None]).argmin(axis=2)
    t = np.take_along_axis(cells, nearest, 1)
    for _ in range(10):
        v = curve.velocity(t)
        step = np.real(np.conj(v) * (z - curve.point(t))) / np.maximum(np.abs(v) ** 2, 1e-300)
        t = np.clip(t + step, low * (1 + 1e-16), low + span)
    options = np.concatenate([np.repeat(b[:, None], len(z), 1), t])
    # The end of a closed curve is its start; a break is taken at its own parameter.
    off = np.abs(curve.point(options) - z)
    found = np.take_along_axis(options, off.argmin(axis=0)[None], 0)[0]
    if curve.closed and found[0] == b[-1]:
        found[0] = b[0]
    assert off.min(axis=0).max() < 1e-11 * size(curve), "a point lies off the curve"
    assert (np.diff(found) > 0).all(), "points out of order"
    return found


def deviation(curve, z):
    """Largest distance of the curve from its own chord, at 200 places along each."""
    t = places(curve, z)
    if curve.closed:
        t, z = np.append(t, curve.breaks[-1]), np.append(z, z[0])
    probes = t[:-1, None] + np.diff(t)[:, None] * np.linspace(0, 1, 202)[1:-1]
    return off_chord(z[:-1, None], z[1:, None], curve.point(probes)).max()


# Each as it is, and the smaller or the larger by turns.
SCALED = [(name, scale) for k, name in enumerate(CURVES) for scale in (1.0, (1e-3, 1e4)[k % 2])]


@pytest.mark.parametrize(("name", "scale"), SCALED)
def test_chords_keep_the_tolerance(name, scale):
    curve = named(name, scale)
    for tolerance in scale * np.array([1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6]):
        assert deviation(curve, flatten(curve, tolerance)) <= tolerance * (1 + 1e-3)


@pytest.mark.parametrize("make", [flank, cam_profile, lambda: Reversed(cam_profile())])
def test_chords_of_flanks_and_cams_keep_the_tolerance(make):
    curve = make()
    for tolerance in (1e-1, 1e-2, 1e-3, 1e-4):
        assert deviation(curve, flatten(curve, tolerance)) <= tolerance * (1 + 1e-3)


@settings(deadline=None, derandomize=True, max_examples=60)
@given(st.lists(st.builds(complex, *[st.integers(-5, 5)] * 2), min_size=4, max_size=4, unique=True), st.floats(-4, -1))
def test_chords_of_any_cubic_keep_the_tolerance(control, power):
    """Zigzags, loops and near cusps; distance to the nearest of all chords, since a loop passes points twice.

    The same cubics on every run: one in some thousands has an edge sharper than any fixed number of probes sees.
    """
    # On one line a cubic may double back, which is a corner inside a piece.
    assume(np.linalg.matrix_rank(xy(np.array(control) - control[0])) == 2)
    curve, tolerance = Bezier(tuple(control)), 10**power
    z = flatten(curve, tolerance)
    dense = curve.point(np.linspace(0, 1, 2001))
    assert off_chord(z[:-1, None], z[1:, None], dense).min(axis=0).max() <= tolerance * (1 + 1e-3)


@pytest.mark.parametrize("seed", range(8))
def test_chords_over_smooth_breaks_keep_the_tolerance(seed):
    """Straight, arc, straight of any sizes: the parameter's speed jumps, so even steps of it look at one side only."""
    rng = np.random.default_rng(seed)
    for _ in range(15):
        before, radius, after, tolerance = 10 ** rng.uniform([-1, -1, -1, -4], [2, 1.5, 2, -1])
        side = rng.choice([-1, 1])
        bend = Arc(1j * side * radius, 0j, side * rng.uniform(0.2, 3))
        end, ahead = complex(bend.point(1.0)), np.exp(1j * bend.sweep)
        curve = Path((Segment(-before, 0j), bend, Segment(end, end + after * ahead)))
        assert deviation(curve, flatten(curve, tolerance)) <= tolerance * (1 + 1e-3)


@pytest.mark.parametrize("tolerance", [1.0, 0.3, 1e-2, 1e-4])
def test_circle_takes_the_least_regular_polygon(tolerance):
    """Its sides stand off by radius (1 - cos(pi / n)); one side fewer would stand off too far."""
    count = len(flatten(Circle(1 + 1j, 3.0), tolerance))

    def sagitta(n):
        return 3 * (1 - np.cos(np.pi / n))

    assert sagitta(count) <= tolerance * (1 + 1e-6) and (count == 3 or sagitta(count - 1) > tolerance)


@pytest.mark.parametrize("name", ["polygon", "bulged", "hull of three", "reversed", "ring", "stretch", "open polyline"])
def test_every_corner_is_a_point(name):
    curve = examples()[name]
    b, h = curve.breaks, 1e-6
    before = curve.point(b[1:-1]) - curve.point(b[1:-1] - h)
    after = curve.point(b[1:-1] + h) - curve.point(b[1:-1])
    corners = curve.point(b[1:-1])[np.abs(np.angle(after / before)) > 1e-3]
    if name != "hull of three":
        assert len(corners)
    for tolerance in (10.0, 1e-1, 1e-3):
        z = flatten(curve, tolerance)
        assert all(np.abs(z - corner).min() < 1e-12 for corner in corners)


def test_straight_stays_two_points():
    line = Segment(1j, 4 + 3j)
    two_in_line = Path((Segment(0j, 1 + 2j), Segment(1 + 2j, 3 + 6j)))
    for curve in (line, Moved(line, Pose(1j, 1j)), Reversed(line), Offset(line, 0.7), Path((line,)), two_in_line):
        assert np.allclose(flatten(curve, 1e-6), curve.point(curve.breaks[[0, -1]]))


@pytest.mark.parametrize("name", [n for n in CURVES if named(n).closed])
@pytest.mark.parametrize("tolerance", [1e9, 5.0, 0.1])
def test_closed_keeps_an_area_and_repeats_no_point(name, tolerance):
    curve = named(name)
    z = flatten(curve, tolerance)
    assert len(z) >= 3 and np.abs(z - np.roll(z, 1)).min() > 1e-9
    assert abs(np.imag(np.conj(z - z[0]) * np.roll(z - z[0], -1)).sum()) > 0.1


def test_open_has_both_ends():
    for name in CURVES:
        curve = named(name)
        if not curve.closed:
            assert np.allclose(flatten(curve, 0.01)[[0, -1]], curve.point(curve.breaks[[0, -1]]))


def lens():
    """Two shallow arcs, each the other turned by half a turn."""
    return PolarArray(Arc(-2j, 1 + 0j, 2 * np.arctan(0.5)), 2)


def test_ring_of_two_shallow_arcs_keeps_an_area():
    z = flatten(lens(), 10.0)
    assert len(z) >= 3 and abs(np.imag(np.conj(z) * np.roll(z, -1)).sum()) > 0


def test_ring_of_one_closed_piece_loses_no_point():
    ring = PolarArray(Flower(3.0), 1)
    assert deviation(ring, flatten(ring, 1e-3)) <= 1e-3 * (1 + 1e-3)


def test_ring_of_copies_has_copies_of_points():
    gear = SpurGear(13, 2).outline
    z = flatten(gear, 1e-3).reshape(13, -1)
    assert np.allclose(z[1:], z[:-1] * np.exp(2j * np.pi / 13), rtol=0, atol=1e-12)
    one = gear.piece
    assert deviation(one, np.append(z[0], z[1, 0])) <= 1e-3 * (1 + 1e-3)


def test_both_sides_of_a_tooth_are_alike():
    z = flatten(SpurGear(24, 2).outline, 1e-2).reshape(24, -1)[0]
    tooth = np.append(z, z[0] * np.exp(2j * np.pi / 24))
    assert np.allclose(-tooth[::-1].conj(), tooth, rtol=0, atol=1e-13)


def bumps(count):
    """A closed path of `count` straights, each with a tangent arc of another size at its end, that meet in corners."""
    pieces, at = [], 0j
    for k in range(count):
        ahead = np.exp(2j * np.pi * k / count)
        line = Segment(at, at + (3 + k) * ahead)
        bend = Arc(line.end - (1 + k) * 1j * ahead, line.end, -1.0)
        at = complex(bend.point(1.0))
        pieces += [line, bend]
    return Path((*pieces, Segment(at, 0j)))


@pytest.mark.parametrize("count", [3, 4, 7])
def test_every_stretch_of_a_path_is_its_own(count):
    curve = bumps(count)
    for tolerance in (1e-1, 1e-3, 1e-5):
        assert deviation(curve, flatten(curve, tolerance)) <= tolerance * (1 + 1e-3)


def test_polygon_comes_back_as_it_is():
    z = np.array([0, 4, 4 + 3j, 2 + 1j])
    assert np.array_equal(flatten(Polyline(z), 1e-3), z)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, np.inf])
def test_a_tolerance_is_a_distance(tolerance):
    with pytest.raises(DesignError) as refusal:
        flatten(Circle(0j, 1.0), tolerance)
    assert refusal.value.field == "tolerance"


def rounded_plate():
    return rounded_hull(np.array([0, 40, 31 + 22j, 5 + 30j]), 6.0)


@pytest.mark.parametrize("kerf", [0.0, 0.2], ids=["cut", "cut wide"])
@pytest.mark.parametrize(
    "curve",
    [SpurGear(24, 2).outline, SpurGear(9, 2).outline, rounded_plate(), slot(0j, 40 + 9j, 5.0), cam_profile()],
    ids=["gear", "undercut gear", "plate", "slot", "cam"],
)
def test_the_last_bits_of_distances_move_no_point(curve, kerf, monkeypatch):
    """Or another processor's sine would give other files."""
    from geomkin.plane import flatten as module

    moved = parallel(curve, kerf)
    sound, z = module._distance, flatten(moved, 0.005)
    for seed in range(3):
        rng = np.random.default_rng(seed)

        def noisy(a, b, p, rng=rng):
            off = sound(a, b, p)
            return off * (1 + 1e-14 * rng.uniform(-1, 1, off.shape)) + 1e-15 * np.abs(p) * rng.random(off.shape)

        monkeypatch.setattr(module, "_distance", noisy)
        again = flatten(moved, 0.005)
        monkeypatch.setattr(module, "_distance", sound)
        # Files carry 1e-7 mm.
        assert len(again) == len(z) and np.abs(again - z).max() < 2e-9


@pytest.mark.parametrize("tolerance", [1.0, 0.3, 0.05, 0.01, 1e-3])
def test_straight_edges_stay_and_arcs_take_no_more_points_than_a_greedy_walker(tolerance):
    plate = rounded_plate()
    z = flatten(plate, tolerance)
    straights = [piece for piece in plate.pieces if isinstance(piece, Segment)]
    assert all(np.abs(z - end).min() < 1e-12 for piece in straights for end in (piece.start, piece.end))
    assert len(z) == sum(fewest_chords(piece, tolerance) for piece in plate.pieces)


def test_no_count_of_chords_is_special():
    """Not even as many as the cells of the first look, here 64 for the root and bottom land of an undercut tooth."""
    side = SpurGear(6, 7.3, -0.21, RackCutter(16, 0.9, 1.25, 0.06)).outline.piece.pieces[0]
    root = Path(side.pieces[:2])
    counts = []
    for tolerance in np.geomspace(8e-4, 1e-3, 25):
        z = flatten(root, tolerance)
        counts.append(len(z) - 1)
        assert deviation(root, z) <= tolerance * (1 + 1e-3)
    assert min(counts) < 64 < max(counts)


@pytest.mark.parametrize("tolerance", [1e-2, 1.0, 1e3])
@pytest.mark.parametrize("bulges", [(0.1, 0.1), (0.1, 0.5), (0.5, -0.1), (0.5, 0.0)])
def test_what_two_edges_enclose_keeps_an_area_at_any_tolerance(bulges, tolerance):
    """A lens, a moon and half a disc: their two corners alone would be a line there and back."""
    lens = Polyline(np.array([0, 4 + 3j]), np.array(bulges))
    z = flatten(lens, tolerance)
    assert len(z) >= 3 and len(set(z.tolist())) == len(z)
    assert {0, 4 + 3j} <= set(z.tolist())
    assert deviation(lens, z) <= tolerance
    assert np.imag(np.conj(z) * np.roll(z, -1)).sum() / 2 > 0.4 * lens.swept


@pytest.mark.parametrize("radius", [0.3, 50.0, 2000.0])
@pytest.mark.parametrize("finer", [1.5, 300.0])
def test_more_chords_than_are_drawn_are_refused_with_the_least_tolerance(monkeypatch, radius, finer):
    monkeypatch.setattr(flatten_module, "MOST_CHORDS", 1000)
    # As high as a thousandth of a turn rises over its chord.
    least = radius * (1 - np.cos(np.pi / 1000))
    for curve in (Circle(1 + 2j, radius), slot(0j, 3 * radius + 0j, radius)):
        with pytest.raises(DesignError) as refusal:
            flatten(curve, least / finer)
        told = re.fullmatch(
            r"tolerance: found (\S+) mm, which takes (\S+) chords; give at least (\S+) mm", str(refusal.value)
        )
        found, chords, advised = (float(one.replace(",", "")) for one in told.groups())
        assert found == pytest.approx(least / finer, rel=1e-5)
        assert chords == pytest.approx(1000 * finer**0.5, rel=2e-3)
        assert least * 0.999 < advised < least * 1.002
        assert 997 <= len(flatten(curve, advised)) <= 1004


@pytest.mark.parametrize("breaks", [1, 2, 3])
def test_two_bows_keep_a_triangle_each_at_any_tolerance(breaks):
    """Of a parabola that three even chords follow a ninth of the area is left out."""
    bow = Bezier((-3 + 0j, -1 - 2j, 1 - 2j, 3 + 0j))
    pieces = tuple(SubCurve(bow, np.linspace(a, a + 1 / breaks, 2)) for a in np.arange(breaks) / breaks)
    side = Path(pieces) if breaks > 1 else SubCurve(bow, np.array([0, 0.3, 1.0]))
    lens = Path((SubCurve(side, side.breaks), Moved(SubCurve(side, side.breaks), Pose(0j, -1 + 0j))))
    z = flatten(lens, 1e3)
    assert len(z) == 6 and {-3, 3} <= set(np.round(z, 12).tolist())
    places(lens, z)
    assert np.imag(np.conj(z) * np.roll(z, -1)).sum() / 2 == pytest.approx(8 / 9 * signed_area(lens), rel=1e-9)
