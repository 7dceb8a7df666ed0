"""Undercut by second roads: half-planes and offset polygons of another library, followers let down on the result."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.cam.checks import segment_limits, tightest_convex
from geomkin.cam.followers.flat import TranslatingFlat
from geomkin.cam.followers.roller import TranslatingRoller
from geomkin.cam.undercut import undercut
from tests.campaign import by_default

from .cams import UNDERCUT, depth, programme, resting, rolls, seen_from_cam

each_undercut = pytest.mark.parametrize("cam", by_default(UNDERCUT, slice(None, None, 3)), indirect=True)


@pytest.fixture
def cam(request):
    return UNDERCUT[request.param]


def polygon(curve, tolerance=1e-5):
    return shapely.Polygon(gk.plane.xy(gk.flatten(curve, tolerance)))


def cut_by_shapely(cam, count=20_000):
    """What the follower leaves: the pitch polygon shrunk by the roller, or the half-planes behind the face."""
    angles = np.unique(np.concatenate([np.linspace(0, 2 * np.pi, count)[:-1], cam.program.breaks[:-1]]))
    if rolls(cam):
        shrunk = shapely.Polygon(gk.plane.xy(seen_from_cam(cam, angles))).buffer(
            -cam.follower.roller_radius, quad_segs=500
        )
        return next(part for part in shapely.get_parts(shrunk) if part.contains(shapely.Point(0, 0)))
    # Half-planes Re(conj(w) z) <= 1 have in common the polygon whose corners are the edges of the hull of all w.
    foot, normal = seen_from_cam(cam, angles[np.append(True, np.diff(angles) > 1e-9)])
    hull = shapely.MultiPoint(gk.plane.xy(normal / np.real(np.conj(normal) * foot))).convex_hull
    w = shapely.get_coordinates(hull.exterior).view(complex)[:-1, 0]
    following = np.roll(w, -1)
    return shapely.Polygon(gk.plane.xy(1j * (w - following) / np.imag(np.conj(w) * following)))


@each_undercut
def test_outline_agrees_with_shapely(cam):
    mine, other = polygon(undercut(cam).outline), cut_by_shapely(cam)
    assert mine.is_valid
    # The other library drops detail of a share of the roller's radius before it shrinks; half-planes are exact.
    share, far = (1e-4, 2e-3) if rolls(cam) else (1e-6, 3e-5)
    assert mine.symmetric_difference(other).area < share * mine.area
    # Each boundary lies in a band about the other, whose rounded corners reach a little less far.
    assert mine.exterior.buffer(far).covers(other.exterior) and other.exterior.buffer(far).covers(mine.exterior)


@each_undercut
def test_no_follower_enters_the_outline_and_each_corner_touches_two(cam):
    cut = undercut(cam)
    z = cut.outline.point(np.linspace(0, cut.outline.breaks[-1], 1500))
    angles = np.unique(np.concatenate([np.linspace(0, 2 * np.pi, 3000), cam.program.breaks]))
    inside = depth(cam, seen_from_cam(cam, angles), z[:, None])
    assert inside.max() < 1e-11
    assert len(cut.corners) == len(cut.spans) > 0
    for corner, span in zip(cut.corners, cut.spans):
        assert depth(cam, seen_from_cam(cam, span % (2 * np.pi)), corner) == pytest.approx(0, abs=1e-11)
        assert np.abs(cut.outline.point(cut.outline.breaks) - corner).min() < 1e-11


@each_undercut
def test_lost_lift_is_what_a_follower_on_the_outline_loses(cam):
    cut, angles = undercut(cam), np.radians(np.arange(0, 360, 5))
    lost = cam.program.motion(angles).lift - resting(cam, gk.flatten(cut.outline, 1e-4), angles)
    # On an arm the lift is an angle, and no contact is nearer to its pivot than 20 mm.
    assert cut.lost_lift(angles) == pytest.approx(lost, abs=3e-4 / (20 if cam.follower.oscillates else 1))
    most, angle = cut.worst
    many = np.union1d(np.linspace(0, 2 * np.pi, 40001), cam.program.breaks)
    assert most == pytest.approx(cut.lost_lift(many).max(), rel=1e-4)
    assert cut.lost_lift(angle) == pytest.approx(most, abs=1e-13) and most > 0
    assert cut.lost_lift(angle + 2 * np.pi) == pytest.approx(most)


@pytest.mark.campaign
def test_undercut_is_found_from_the_first_and_grows_with_the_square():
    """At its limit a roller cuts nothing, and beyond it by e it takes a lift in proportion to e^2."""
    program, lost = programme(20, ends=(60, 150, 170, 280)), {}
    least, angle = tightest_convex(gk.Cam(TranslatingRoller(0, 5), program, 60))
    for e in (-1e-13, 1e-13, 1e-11, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2):
        # Larger rollers on smaller base circles: the same pitch curve.
        cut = undercut(gk.Cam(TranslatingRoller(least * (1 + e), 5), program, 60 - least * (1 + e)))
        assert cut.found == (e > 0), e
        assert polygon(cut.outline, 1e-3).is_valid and gk.to_arcs(cut.outline, 1e-3).closed
        lost[e] = cut.worst[0]
        if e > 0:
            (start, end) = cut.spans[0]
            assert start < angle < end and end - start < 20 * np.sqrt(e) + 1e-6
    for smaller, larger in ((1e-6, 1e-5), (1e-5, 1e-4), (1e-4, 1e-3)):
        assert lost[larger] / lost[smaller] == pytest.approx(100, rel=0.05)
    assert all(lost[e] < 2e-12 for e in lost if e < 1e-6)


def test_a_flat_face_cuts_from_its_least_base_radius_on():
    program = programme(20, ends=(60, 150, 170, 280))
    for tilt in (0, 20):
        least = TranslatingFlat(tilt).least_base_radius(program, 0)
        for e in (-1e-2, -1e-5, -1e-9, 1e-12, 1e-6):
            cam = gk.Cam(TranslatingFlat(tilt), program, least * (1 + e))
            assert undercut(cam).found == (e < 0) == bool((segment_limits(cam).convex_radius <= 0).any())


@pytest.mark.parametrize(
    "follower", by_default([TranslatingRoller(14, 3), TranslatingFlat(10)], slice(1)), ids=["roller", "flat"]
)
def test_lift_lost_by_a_velocity_jump_grows_with_its_square(follower):
    lost = []
    for jump in (1, 1e-1, 1e-2, 1e-3, 1e-5, 1e-7):
        program = gk.Program([gk.Dwell(end_deg=60), gk.Rise("uniform", rise=jump, end_deg=150),
                              gk.Return("uniform", end_deg=240), gk.Dwell(end_deg=360)])  # fmt: skip
        cut = undercut(gk.Cam(follower, program, 40))
        assert len(cut.spans) == 1 and np.degrees(cut.spans.mean()) == pytest.approx(150, abs=0.1)
        assert polygon(cut.outline, 1e-3).is_valid
        lost.append(cut.worst[0])
        assert np.degrees(cut.worst[1]) == pytest.approx(150, abs=1e-4)
    assert lost[0] / lost[1] == pytest.approx(100, rel=0.1) and lost[2] / lost[3] == pytest.approx(100, rel=1e-2)
    assert max(lost[4:]) < 1e-11


def test_a_jump_of_velocity_to_faster_leaves_an_edge_or_a_hollow():
    """The follower stands still while the contact runs along it: a straight edge, or an arc of the roller's radius."""
    program = programme(15, laws=("uniform", "uniform"))
    for follower, bend in [(TranslatingFlat(), 0), (TranslatingRoller(14), -1 / 14)]:
        outline = undercut(gk.Cam(follower, program, 40)).outline
        pieces = [p for p in outline.pieces if len(p.breaks) == 2 and gk.length(p) > 1e-3]
        assert any(
            p.curvature(p.breaks.mean()) * np.sign(gk.plane.signed_area(outline)) == pytest.approx(bend) for p in pieces
        )


@pytest.mark.parametrize("seed", [*range(2), *(pytest.param(k, marks=pytest.mark.campaign) for k in range(2, 30))])
def test_random_cams_agree_with_shapely(seed):
    rng = np.random.default_rng(seed)
    ends = np.sort(rng.choice(np.arange(5, 355, 5), 4, replace=False)).tolist()
    laws = rng.choice(["cycloidal", "harmonic", "3-4-5", "uniform"], 2).tolist()
    base, roller, rise = rng.uniform(10, 60), rng.uniform(0, 40), rng.uniform(2, 40)
    direction = str(rng.choice(["clockwise", "counterclockwise"]))
    offset, tilt = rng.uniform(-0.6, 0.6) * (base + roller), rng.uniform(-30, 30)
    for follower in (TranslatingRoller(roller, offset), TranslatingFlat(tilt)):
        cam = gk.Cam(follower, programme(rise, False, ends, laws), base, direction)
        mine, other = polygon(undercut(cam).outline, 1e-4), cut_by_shapely(cam, 7000)
        assert mine.is_valid and mine.symmetric_difference(other).area < 1e-4 * mine.area
