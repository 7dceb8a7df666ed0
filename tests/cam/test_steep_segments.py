"""Cams of random programmes with short steep segments: their outlines are simple and what another library cuts."""

import numpy as np
import pytest
import shapely

import geomkin as gk
from geomkin.cam.undercut import undercut

from .cams import rolls, seen_from_cam

LAWS = ("uniform", "harmonic", "parabolic", "cycloidal", "3-4-5", "4-5-6-7")
# Of 1,500 random cams those whose outlines once had loops, were no loop round the axis, or did not join.
DIFFICULT = (75, 128, 177, 188, 217, 228, 288, 316, 331, 334, 372, 574, 599, 645, 1201, 1768, 1949)


def random_cam(seed):
    """Three to seven segments, two in five of them a hundredth as long as the others; None if there is no such cam."""
    rng = np.random.default_rng(seed)
    swings = rng.random() < 0.3
    count = rng.integers(3, 8)
    widths = rng.uniform(5, 120, count)
    short = rng.random(count) < 0.4
    widths[short] = rng.uniform(0.1, 1.0, short.sum())
    widths[0] = 90 if short.all() else widths[0]
    ends = np.round(np.cumsum(widths) / widths.sum() * 360, 3)
    ends[-1] = 360
    rise, end_lift = ("rise_deg", "end_lift_deg") if swings else ("rise", "end_lift")
    lift, segments = 0.0, []
    for end in ends[:-1].tolist():
        law, choice = str(rng.choice(LAWS)), rng.random()
        step = round(float(rng.uniform(0.5, 4 if swings else 10)), 1)
        if choice < 0.15:
            segments.append(gk.Dwell(end_deg=end))
        elif choice < 0.6 or lift <= step:
            segments.append(gk.Rise(law, end_deg=end, **{rise: step}))
            lift = round(lift + step, 6)
        else:
            lift = round(lift - step, 6)
            segments.append(gk.Return(law, end_deg=end, **{end_lift: lift}))
    law = str(rng.choice(LAWS))
    segments.append(gk.Return(law, end_deg=360) if lift > 0 else gk.Dwell(end_deg=360))
    direction = str(rng.choice(["clockwise", "counterclockwise"]))
    base, roller = round(float(rng.uniform(20, 60)), 3), round(float(rng.uniform(2, 30)), 3)
    flat = rng.random() < 0.5
    if swings and flat:
        follower = gk.OscillatingFlat(110, round(float(rng.uniform(-10, 10)), 2))
    elif swings:
        follower = gk.OscillatingRoller(roller, 110, 80)
    elif flat:
        follower = gk.TranslatingFlat(round(float(rng.uniform(-15, 15)), 2))
    else:
        follower = gk.TranslatingRoller(roller, round(float(rng.uniform(-0.5, 0.5)) * base, 3))
    try:
        return gk.Cam(follower, gk.Program(segments), base, direction)
    except gk.DesignError:
        return None


def polygon_of(cam):
    """The outline's chords, once round the axis."""
    outline = undercut(cam).outline
    t = np.concatenate([np.linspace(a, b, 200)[:-1] for a, b in zip(outline.breaks, outline.breaks[1:])])
    z = outline.point(t)
    # A contour that does not go round the axis may be too small to be drawn in chords.
    assert abs(np.angle(np.roll(z, -1) / z).sum()) == pytest.approx(2 * np.pi)
    return shapely.Polygon(gk.plane.xy(gk.flatten(outline, 1e-4)))


def cut_by_shapely(cam):
    """What the follower leaves of a disc, at angles that see each segment as closely as the others."""
    breaks = cam.program.breaks
    angles = np.concatenate([np.linspace(a, b, 3000)[:-1] for a, b in zip(breaks, breaks[1:])])
    if rolls(cam):
        centres = shapely.Polygon(gk.plane.xy(seen_from_cam(cam, angles)))
        shrunk = shapely.make_valid(centres).buffer(-cam.follower.roller_radius, quad_segs=300)
        return next(part for part in shapely.get_parts(shrunk) if part.contains(shapely.Point(0, 0)))
    foot, normal = seen_from_cam(cam, angles)
    hull = shapely.MultiPoint(gk.plane.xy(normal / np.real(np.conj(normal) * foot))).convex_hull
    w = shapely.get_coordinates(hull.exterior).view(complex)[:-1, 0]
    following = np.roll(w, -1)
    return shapely.Polygon(gk.plane.xy(1j * (w - following) / np.imag(np.conj(w) * following)))


@pytest.mark.parametrize("seed", [*DIFFICULT[::4], *(pytest.param(k, marks=pytest.mark.campaign) for k in DIFFICULT)])
def test_difficult_outlines_agree_with_shapely(seed):
    cam = random_cam(seed)
    mine, other = polygon_of(cam), cut_by_shapely(cam)
    assert mine.is_valid
    assert mine.symmetric_difference(other).area < 2e-4 * mine.area


@pytest.mark.campaign
@pytest.mark.parametrize("first", range(0, 1500, 50))
def test_no_outline_of_a_random_cam_has_a_loop(first):
    cams = {seed: random_cam(seed) for seed in range(first, first + 50)}
    assert [seed for seed, cam in cams.items() if cam and not polygon_of(cam).is_valid] == []
