"""Few chords and few arcs: against a greedy walker, who always steps as far as the tolerance lets one."""

import numpy as np
import pytest

from geomkin.plane.arcs import to_arcs
from geomkin.plane.curve import SubCurve
from geomkin.plane.flatten import flatten

from .curves import Flower, cam_profile, edges, examples, flank, off_arcs, off_chord


def reach(curve, start, tolerance, guess):
    """Farthest parameter to which one chord from `start` keeps the tolerance, by bisection."""
    end = curve.breaks[-1]

    def kept(t):
        probes = start + (t - start) * np.linspace(0, 1, 34)[1:-1]
        return off_chord(curve.point(start), curve.point(t), curve.point(probes)).max() <= tolerance

    low, high = start, min(start + guess, end)
    while kept(high):
        if high == end:
            return end
        low, high = high, min(start + 1.3 * (high - start), end)
    for _ in range(18):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if kept(middle) else (low, middle)
    return low


def fewest_chords(curve, tolerance):
    """Chords of a greedy walker, who always steps as far as the tolerance lets one: none can do with fewer."""
    t, count, step = curve.breaks[0], 0, np.ptp(curve.breaks) / 50
    while t < curve.breaks[-1]:
        after = reach(curve, t, tolerance, step)
        t, count, step = after, count + 1, after - t
    return count


@pytest.mark.parametrize(
    "curve, tolerances",
    [
        (flank(), (1e-1, 1e-2, 1e-3, 1e-4)),
        (cam_profile(), (1e-1, 1e-2, 1e-3)),
        (examples()["bezier"], (1e-1, 1e-2, 1e-3)),
        (Flower(3.0, 1), (1e-3,)),
        (examples()["offset outline"], (1e-3,)),
    ],
    ids=["flank", "cam", "zigzag", "flower", "slot"],
)
def test_no_more_chords_than_needed(curve, tolerances):
    for tolerance in tolerances:
        chords = len(flatten(curve, tolerance)) - (not curve.closed)
        # The flower has ten inflections, where how far a chord reaches depends on where it starts.
        assert chords <= (1.08 if isinstance(curve, Flower) else 1.03) * fewest_chords(curve, tolerance) + 1


def biarc(p0, p1, t0, t1):
    """Edges of two arcs tangent at both ends, with equal tangent lengths d: |p1 - p0 - d (t0 + t1)| = 2 d, solved."""
    v, s = p1 - p0, t0 + t1
    quadratic = [abs(s) ** 2 - 4, -2 * np.real(np.conj(v) * s), abs(v) ** 2]
    roots = np.roots(quadratic)
    d = min(r.real for r in roots if abs(r.imag) < 1e-9 * abs(r) and r.real > 0)
    joint = (p0 + d * t0 + p1 - d * t1) / 2
    first, last = np.angle((joint - p0) / t0) / 2, np.angle(t1 / (p1 - joint)) / 2
    return np.array([p0, joint]), np.array([joint, p1]), np.tan([first, last])


def fewest_biarcs(curve, tolerance):
    """Biarcs of a greedy walker along one smooth piece."""

    def direction(t):
        v = curve.velocity(t)
        return v / abs(v)

    def kept(start, end):
        probes = curve.point(start + (end - start) * np.linspace(0, 1, 34)[1:-1])
        arcs = biarc(curve.point(start), curve.point(end), direction(start), direction(end))
        return off_arcs(*(x[:, None] for x in arcs), probes).min(axis=0).max() <= tolerance

    last = np.nextafter(curve.breaks[-1], -np.inf)
    t, count, step = curve.breaks[0], 0, np.ptp(curve.breaks) / 20
    while t < last:
        low, high = t, min(t + step, last)
        while kept(t, high) and high < last:
            low, high = high, min(t + 1.3 * (high - t), last)
        for _ in range(0 if kept(t, high) else 16):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if kept(t, middle) else (low, middle)
        after = high if kept(t, high) else low
        t, count, step = after, count + 1, after - t
    return count


def moving_pieces(curve):
    """The rise and the return of the cam, the second and the last quarter of its turn."""
    return [SubCurve(curve, curve.breaks[k : k + 2]) for k in (1, 3)]


@pytest.mark.parametrize("curve", [flank(), *moving_pieces(cam_profile())], ids=["flank", "cam rise", "cam return"])
def test_few_biarcs(curve):
    for tolerance in (1e-2, 1e-3, 1e-4):
        arcs = len(edges(to_arcs(curve, tolerance))[2])
        assert arcs / 2 <= 1.15 * fewest_biarcs(curve, tolerance) + 1
