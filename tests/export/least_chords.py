"""The least number of chords that a curve can do with, told without the library's way of placing them."""

import numpy as np

import geomkin as gk
from geomkin.plane import Arc, Mirrored, Moved, Path, PolarArray, Polyline, Reversed, Segment
from geomkin.plane.curve import SubCurve

# Samples for each chord: a chord ends at one of them, so that it lacks half a sample of its reach.
SAMPLES = 160


def least_chords(curve, tolerance, known):
    """Chords, of a walker who always steps as far as the tolerance lets one; none with points on the curve needs fewer.

    Each smooth piece by itself, and arcs beside straight edges too, as the edges have to stay. known: of pieces met
    before.
    """
    if isinstance(curve, PolarArray):
        return curve.count * least_chords(curve.piece, tolerance, known)
    if isinstance(curve, (Moved, Mirrored, Reversed)):
        return least_chords(curve.curve, tolerance, known)
    if isinstance(curve, Polyline) and curve.bulges is None:
        return len(curve.vertices) - (not curve.closed)
    pieces = curve.pieces if isinstance(curve, (Path, Polyline)) else (curve,)
    if all(isinstance(piece, (Arc, Segment)) for piece in pieces):
        return sum(arc_chords(piece, tolerance) for piece in pieces)
    if id(curve) not in known:
        breaks = np.asarray(curve.breaks)
        known[id(curve)] = curve, sum(walked(curve, *ends, tolerance) for ends in zip(breaks, breaks[1:]))
    return known[id(curve)][1]


def arc_chords(piece, tolerance):
    if isinstance(piece, Segment):
        return 1
    return np.ceil(abs(piece.sweep) / (2 * np.arccos(1 - tolerance / abs(piece.start - piece.centre))) - 1e-9)


def walked(curve, start, end, tolerance):
    guess = len(gk.flatten(SubCurve(curve, np.array([start, end])), tolerance))
    t = np.linspace(start, end, SAMPLES * guess + 1)
    t[-1] = np.nextafter(t[-1], start)
    z = curve.point(t)
    here, count, reach = 0, 0, SAMPLES

    def kept(last):
        way = z[last] - z[here]
        seen = (z[here : last + 1] - z[here]) * np.conj(way) / (abs(way) or 1)
        beyond = np.maximum(np.maximum(-seen.real, seen.real - abs(way)), 0)
        return np.hypot(beyond, seen.imag).max() <= tolerance

    while here < len(z) - 1:
        low, high = here + 1, here + reach
        while high < len(z) - 1 and kept(high):
            low, high = high, here + 2 * (high - here)
        high = min(high, len(z))
        if high >= len(z) - 1 and kept(len(z) - 1):
            low, high = len(z) - 1, len(z)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if kept(middle) else (low, middle)
        here, count, reach = low, count + 1, low - here
    return count
