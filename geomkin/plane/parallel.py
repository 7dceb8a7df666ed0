"""The outline at a distance from an outline, as exact curves."""

from __future__ import annotations

import numpy as np

from .curve import AbstractCurve, Mirrored, Offset, Reversed, SubCurve
from .flatten import CORNER, direction, smooth_runs
from .joined import Path, PolarArray
from .primitives import Arc, Polyline, Segment
from .vec import Real, cross

# Newton steps to the intersection of two curves. Four suffice if neighbours overlap by far less than their length.
STEPS = 20
Known = dict[tuple[AbstractCurve, float], AbstractCurve]


def parallel(curve: AbstractCurve, distance: float) -> AbstractCurve | None:
    """A closed curve moved by `distance`, mm, to its right, with an arc around every corner that opens.

    At a corner that closes both sides end at their intersection; None if one of them ends before. A distance larger
    than a radius of curvature, or half the width of a gap, gives loops, which are not trimmed.
    """
    if distance == 0:
        return curve
    if isinstance(curve, PolarArray):
        rotation = complex(curve.turns[1 % curve.count])
        pieces = _pieces(curve.piece, distance, first_after=rotation)
        return PolarArray(Path(tuple(pieces)), curve.count) if pieces else None
    if len(runs := smooth_runs(curve)) == 1 and _turn(curve, curve.breaks[-1], curve.breaks[0]) == 0:
        offset = _offset_run(curve, runs[0], distance, {})
        return Path(tuple(offset)) if len(offset) > 1 else Offset(curve, distance)
    pieces = _pieces(curve, distance, first_after=1 + 0j)
    return Path(tuple(pieces)) if pieces else None


def _pieces(curve: AbstractCurve, distance: float, first_after: complex) -> list[AbstractCurve] | None:
    """Offset runs and corner arcs, including the arc at the end; the start follows, rotated by `first_after`.

    None if a side of a corner that closes would be trimmed as a whole.
    """
    runs = smooth_runs(curve)
    pieces: list[AbstractCurve] = []
    closing: list[tuple[int, complex]] = []
    known: Known = {}
    for k, run in enumerate(runs):
        pieces.extend(_offset_run(curve, run, distance, known))
        following = runs[(k + 1) % len(runs)][0]
        turned = first_after if k == len(runs) - 1 else 1 + 0j
        turn = _turn(curve, run[-1], following, turned)
        if turn * distance < 0:
            closing.append((len(pieces) - 1, turned))
        elif turn:
            corner = complex(curve.point(run[-1]))
            start = complex(pieces[-1].point(pieces[-1].breaks[-1]))
            pieces.append(Arc(corner, start, turn))
    return _trimmed(pieces, closing)


def _trimmed(pieces: list[AbstractCurve], closing: list[tuple[int, complex]]) -> list[AbstractCurve] | None:
    """The pieces, with those before and after a corner that closes cut at their intersection.

    closing: index of the piece before each such corner, and the rotation of the piece after it.
    """
    spans = [[float(p.breaks[0]), float(p.breaks[-1])] for p in pieces]
    for before, turned in closing:
        after = (before + 1) % len(pieces)
        spans[before][1], spans[after][0] = _intersection(pieces[before], pieces[after], turned)
    # If there is no intersection (nan), or nothing is left, the comparison is False.
    if not all(low < high for low, high in spans):
        return None
    touched = {k for before, _ in closing for k in (before, (before + 1) % len(pieces))}
    return [_part(piece, *spans[k]) if k in touched else piece for k, piece in enumerate(pieces)]


def _intersection(one: AbstractCurve, two: AbstractCurve, turned: complex) -> tuple[float, float]:
    """Parameters at which the end of one curve meets the start of another, turned about the origin; nan if none."""
    (first, last), (start, end) = one.breaks[[0, -1]], two.breaks[[0, -1]]
    s, t, rounding = last, start, 1e-13 * float(np.abs(one.point(one.breaks)).max())
    for _ in range(STEPS):
        gap = turned * two.point(t) - one.point(s)
        if abs(gap) <= rounding:
            return float(s), float(t)
        u, v = one.velocity(s), turned * two.velocity(t)
        with np.errstate(divide="ignore", invalid="ignore"):
            s, t = s + cross(gap, v) / cross(u, v), t + cross(gap, u) / cross(u, v)
        if not (first <= s <= last and start <= t <= end):
            break
    return np.nan, np.nan


def _part(curve: AbstractCurve, low: float, high: float) -> AbstractCurve:
    """The part of a curve between two parameters; of an arc or a segment again an arc or a segment."""
    match curve:
        case Segment():
            return Segment(complex(curve.point(low)), complex(curve.point(high)))
        case Arc():
            return Arc(curve.centre, complex(curve.point(low)), curve.sweep * (high - low))
    inner = curve.breaks[(curve.breaks > low) & (curve.breaks < high)]
    return SubCurve(curve, np.array([low, *inner, high]))


def _offset_run(curve: AbstractCurve, run: Real, distance: float, known: Known) -> list[AbstractCurve]:
    """A run without a corner moved to its right; piece by piece if it consists of whole pieces."""
    first, last = int(run[0]), int(run[-1])
    if isinstance(curve, (Path, Polyline)) and (run[0], run[-1]) == (first, last):
        return [_offset_piece(piece, distance, known) for piece in curve.pieces[first:last]]
    return [Offset(SubCurve(curve, run), distance)]


def _offset_piece(curve: AbstractCurve, distance: float, known: Known) -> AbstractCurve:
    """A curve moved to its right in its own form: arcs remain arcs, and congruent pieces remain congruent.

    known: the results for earlier curves.
    """
    match curve:
        case Reversed():
            return Reversed(_offset_piece(curve.curve, -distance, known))
        case Mirrored():
            return Mirrored(_offset_piece(curve.curve, -distance, known))
        case Segment() if curve.start != curve.end:
            shift = -1j * distance * (curve.end - curve.start) / abs(curve.end - curve.start)
            return Segment(curve.start + shift, curve.end + shift)
        case Arc() if (grown := 1 + np.sign(curve.sweep) * distance / abs(curve.start - curve.centre)) > 0:
            return Arc(curve.centre, curve.centre + (curve.start - curve.centre) * float(grown), curve.sweep)
    return known.setdefault((curve, distance), Offset(curve, distance))


def _turn(curve: AbstractCurve, before: float, after: float, turned: complex = 1 + 0j) -> float:
    """Rotation at a corner, rad, from the end of one run to the start of the next; 0 if it is smooth."""
    incoming = direction(curve, np.array([before]), after=False)[0]
    outgoing = direction(curve, np.array([after]), after=True)[0] * turned
    turn = float(np.angle(outgoing * incoming.conjugate()))
    return turn if abs(turn) > CORNER else 0.0
