"""Chords: never farther from the curve than asked, and a point at every corner."""

import importlib
import re

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from geomkin.core.errors import DesignError
from geomkin.gear.spur import SpurGear
from geomkin.plane.curve import Moved, Offset, SubCurve
from geomkin.plane.flatten import flatten
from geomkin.plane.joined import Path, PolarArray
from geomkin.plane.measure import signed_area
from geomkin.plane.primitives import Arc, Circle, Segment, rounded_hull, slot
from geomkin.plane.region import parallel
from geomkin.plane.vec import Pose, xy
from tests.campaign import by_default

from .curves import Bezier, Flower, cam_profile, examples, off_chord, size
from .test_chord_count import fewest_chords

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


SCALED = [(name, (1.0, 1e-3, 1e4)[k % 3]) for k, name in enumerate(CURVES)]


@pytest.mark.parametrize(("name", "scale"), by_default(SCALED, slice(0, None, 5)))
def test_chords_keep_the_tolerance(name, scale):
    curve = named(name, scale)
    for tolerance in scale * np.array([1e-1, 1e-3, 1e-6]):
        assert deviation(curve, flatten(curve, tolerance)) <= tolerance * (1 + 1e-3)


@settings(deadline=None, derandomize=True, max_examples=30)
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


@pytest.mark.parametrize("seed", range(2))
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


@pytest.mark.parametrize("tolerance", [0.3, 1e-4])
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


@pytest.mark.parametrize("tolerance", [1e9, 5.0, 0.1])
def test_closed_keeps_an_area_and_repeats_no_point(tolerance):
    for name in (n for n in CURVES if named(n).closed):
        z = flatten(named(name), tolerance)
        assert len(z) >= 3 and np.abs(z - np.roll(z, 1)).min() > 1e-9, name
        assert abs(np.imag(np.conj(z - z[0]) * np.roll(z - z[0], -1)).sum()) > 0.1, name


def lens():
    """Two shallow arcs, each the other turned by half a turn."""
    return PolarArray(Arc(-2j, 1 + 0j, 2 * np.arctan(0.5)), 2)


def test_ring_of_copies_has_copies_of_points():
    gear = SpurGear(13, 2).outline
    z = flatten(gear, 1e-3).reshape(13, -1)
    assert np.allclose(z[1:], z[:-1] * np.exp(2j * np.pi / 13), rtol=0, atol=1e-12)
    one = gear.piece
    assert deviation(one, np.append(z[0], z[1, 0])) <= 1e-3 * (1 + 1e-3)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, np.inf])
def test_invalid_tolerance_is_refused(tolerance):
    with pytest.raises(DesignError) as refusal:
        flatten(Circle(0j, 1.0), tolerance)
    assert refusal.value.field == "tolerance"


def rounded_plate():
    return rounded_hull(np.array([0, 40, 31 + 22j, 5 + 30j]), 6.0)


@pytest.mark.parametrize("kerf", [0.2])
@pytest.mark.parametrize(
    "curve",
    [SpurGear(9, 2).outline, rounded_plate(), cam_profile()],
    ids=["undercut gear", "plate", "cam"],
)
def test_rounding_of_distances_moves_no_point(curve, kerf, monkeypatch):
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


@pytest.mark.parametrize("tolerance", [0.3, 1e-3])
def test_straight_edges_stay_and_arcs_take_the_fewest_points(tolerance):
    plate = rounded_plate()
    z = flatten(plate, tolerance)
    straights = [piece for piece in plate.pieces if isinstance(piece, Segment)]
    assert all(np.abs(z - end).min() < 1e-12 for piece in straights for end in (piece.start, piece.end))
    assert len(z) == sum(fewest_chords(piece, tolerance) for piece in plate.pieces)


@pytest.mark.parametrize("radius", [0.3, 2000.0])
def test_too_many_chords_are_refused_with_the_smallest_tolerance(monkeypatch, radius):
    monkeypatch.setattr(flatten_module, "MOST_CHORDS", 1000)
    # As high as a thousandth of a turn rises over its chord.
    least = radius * (1 - np.cos(np.pi / 1000))
    for curve in (Circle(1 + 2j, radius), slot(0j, 3 * radius + 0j, radius)):
        with pytest.raises(DesignError) as refusal:
            flatten(curve, least / 300)
        advised = float(re.search(r"[\d.][\d.e+-]*", refusal.value.remedy)[0])
        assert refusal.value.field == "tolerance" and least * 0.999 < advised < least * 1.002
        assert 997 <= len(flatten(curve, advised)) <= 1004


@pytest.mark.parametrize("breaks", [1, 2, 3])
def test_two_bows_keep_an_area_at_any_tolerance(breaks):
    """Of a parabola that three even chords follow a ninth of the area is left out."""
    bow = Bezier((-3 + 0j, -1 - 2j, 1 - 2j, 3 + 0j))
    pieces = tuple(SubCurve(bow, np.linspace(a, a + 1 / breaks, 2)) for a in np.arange(breaks) / breaks)
    side = Path(pieces) if breaks > 1 else SubCurve(bow, np.array([0, 0.3, 1.0]))
    lens = Path((SubCurve(side, side.breaks), Moved(SubCurve(side, side.breaks), Pose(0j, -1 + 0j))))
    z = flatten(lens, 1e3)
    assert len(z) == 6 and {-3, 3} <= set(np.round(z, 12).tolist())
    places(lens, z)
    assert np.imag(np.conj(z) * np.roll(z, -1)).sum() / 2 == pytest.approx(8 / 9 * signed_area(lens), rel=1e-9)


def test_an_arc_whose_offset_is_its_centre_takes_few_points():
    """There the tangent is rounding, and rotates at random."""
    corner = Arc(33.1 + 7.7j, 33.1 + 8.7j, np.pi / 2)
    line = Path((Segment(50 + 8.7j, 33.1 + 8.7j), corner, Segment(32.1 + 7.7j, 32.1 - 9j)))
    points = flatten(Offset(line, -1.0), 0.005)
    assert len(points) < 100 and np.abs(points - corner.centre).min() < 1e-9
