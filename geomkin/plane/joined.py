"""Curves made of pieces: a path end to end, a ring of equal copies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.arguments import Count
from ..core.errors import DesignError
from ..core.records import record
from .curve import AbstractCurve, Mirrored, Reversed
from .vec import Complex, Real, Whole

# Ends of neighbouring pieces may differ by this share of their distance from the origin: larger lets
# a visible gap pass as closed, smaller refuses pieces that differ by rounding.
GAP = 1e-9
# Of a curve's parameter: the points there tell its place and its size.
_SHARES = np.array([0.0, 0.5, 1.0])
Number = TypeVar("Number", np.complex128, np.float64)


@record(checked=True, eq=False)
class Path(AbstractCurve):
    """Pieces end to end; piece k runs over k <= t <= k + 1, whatever its own parameter."""

    pieces: tuple[AbstractCurve, ...]

    def __post_init__(self) -> None:
        if not len(self.pieces):
            raise DesignError("pieces", "found none", "give at least one")
        gaps = np.abs(self._samples[1:, 0] - self._samples[:-1, 2])
        if len(gaps) and gaps.max() > self._rounding:
            worst = int(gaps.argmax())
            raise DesignError(
                "pieces",
                f"piece {worst} ends {gaps[worst]:.3g} mm from the start of the next",
                "give pieces that join end to end",
            )

    @cached_property
    def _samples(self) -> Complex:
        """Start, middle and end of each piece, (n, 3)."""
        return np.array([_start_middle_end(piece) for piece in self.pieces])

    @property
    def _rounding(self) -> float:
        """Largest distance between ends, mm, that rounding explains."""
        return float(GAP * np.abs(self._samples).max())

    @cached_property
    def breaks(self) -> Real:
        found = [0.0]
        for k, piece in enumerate(self.pieces):
            b = piece.breaks
            found += [k + 1.0] if len(b) == 2 else (k + (b[1:] - b[0]) / (b[-1] - b[0])).tolist()
        return np.array(found)

    @cached_property
    def closed(self) -> bool:
        return bool(abs(self._samples[-1, 2] - self._samples[0, 0]) <= self._rounding)

    def point(self, t: ArrayLike) -> Complex:
        return self._each(t, lambda piece, s, span: piece.point(s), np.complex128)

    def velocity(self, t: ArrayLike) -> Complex:
        return self._each(t, lambda piece, s, span: piece.velocity(s) * span, np.complex128)

    def curvature(self, t: ArrayLike) -> Real:
        return self._each(t, lambda piece, s, span: piece.curvature(s), np.float64)

    def _each(
        self, t: ArrayLike, value: Callable[[AbstractCurve, Real, float], Complex | Real], dtype: type[Number]
    ) -> NDArray[Number]:
        """What `value` gives of each piece at its own parameters, per unit of which t moves 1 / span."""
        t = np.asarray(t, dtype=float)
        out = np.empty(t.shape, dtype)
        if not t.size:
            return out
        flat, places, (inner, firsts, lasts) = out.ravel(), t.ravel(), self._ends
        which: Whole = inner.searchsorted(places, side="right")
        # Most calls ask for rising parameters, of which each piece has a stretch.
        rising = bool((which[1:] >= which[:-1]).all())
        least: int = int(which[0] if rising else which.min())
        most: int = int(which[-1] if rising else which.max())
        if least == most:
            s, (breaks, first, last, rounding) = t - least, self._domains[least]
            s = first * (1 - s) + last * s
            s = np.minimum(np.maximum(s, first), last) if breaks is None else _at_breaks(s, breaks, rounding)
            out[...] = value(self.pieces[least], s, last - first)
            return out
        # The place of all in their pieces at once: calls cost, not places.
        share, first_of, last_of = places - which, firsts[which], lasts[which]
        own = first_of * (1 - share) + last_of * share
        inside = np.minimum(np.maximum(own, first_of), last_of)
        masks: Iterable[Any]
        if rising:
            ends = [0, *which.searchsorted(range(least + 1, most + 1)).tolist(), t.size]
            masks = map(slice, ends, ends[1:])
        else:
            masks = (which == k for k in range(least, most + 1))
        for k, mask in enumerate(masks, least):
            breaks, first, last, rounding = self._domains[k]
            s = inside[mask] if breaks is None else _at_breaks(own[mask], breaks, rounding)
            if s.size:
                flat[mask] = value(self.pieces[k], s, last - first)
        return out

    @cached_property
    def _domains(self) -> list[tuple[Real | None, float, float, float]]:
        """Of each piece its breaks where it has inner ones, the first and the last, and what rounding moves t by."""
        found: list[tuple[Real | None, float, float, float]] = []
        for k, b in enumerate(piece.breaks for piece in self.pieces):
            first, last = float(b[0]), float(b[-1])
            found.append((b if len(b) > 2 else None, first, last, (last - first) * math.ulp(k + 1.0)))
        return found

    @cached_property
    def _ends(self) -> tuple[Real, Real, Real]:
        """Where pieces meet; the first and the last of each piece's own parameters."""
        _, first, last, _ = zip(*self._domains)
        return np.arange(1.0, len(self.pieces)), np.array(first), np.array(last)


@record(checked=True, eq=False)
class PolarArray(AbstractCurve):
    """`count` copies of a piece, each turned about the origin by one count-th of a turn more.

    The piece must end where its next copy starts. Each copy takes as much of t as the piece itself,
    from t = 0. Whatever is worked out for one copy serves all, and the copies are alike to the last bit.
    """

    piece: AbstractCurve
    count: Count

    def __post_init__(self) -> None:
        start, _, end = _start_middle_end(self.piece).tolist()
        gap = abs(end - start * self.turns[1 % self.count])
        if gap > GAP * abs(start):
            raise DesignError("piece", f"it ends {gap:.3g} mm from the start of its next copy", "close the gap")

    @cached_property
    def turns(self) -> Complex:
        """Direction of each copy, (count,)."""
        turns: Complex = np.exp(2j * np.pi * np.arange(self.count) / self.count)
        return turns

    @cached_property
    def breaks(self) -> Real:
        b = self.piece.breaks - self.piece.breaks[0]
        return np.append((np.arange(self.count)[:, None] * b[-1] + b[:-1]).ravel(), self.count * b[-1])

    @property
    def closed(self) -> bool:
        return True

    def point(self, t: ArrayLike) -> Complex:
        copy, s = self._local(t)
        return self.piece.point(s) * self.turns[copy]

    def velocity(self, t: ArrayLike) -> Complex:
        copy, s = self._local(t)
        return self.piece.velocity(s) * self.turns[copy]

    def curvature(self, t: ArrayLike) -> Real:
        return self.piece.curvature(self._local(t)[1])

    def _local(self, t: ArrayLike) -> tuple[Whole, Real]:
        t = np.asarray(t, dtype=float)
        span = self.piece.breaks[-1] - self.piece.breaks[0]
        # At a break between copies the quotient may fall short of the whole number by rounding.
        copy = np.clip(np.floor(t / span * (1 + 4e-16)), 0, self.count - 1).astype(int)
        return copy, _at_breaks(
            self.piece.breaks[0] + (t - copy * span), self.piece.breaks, np.spacing(self.count * span)
        )


def _start_middle_end(curve: AbstractCurve) -> Complex:
    """The points of a curve at the start, the middle and the end of its parameter, (3,): of a path, known already."""
    match curve:
        case Path():
            samples, half = curve._samples, len(curve.pieces) / 2
            return np.array([samples[0, 0], samples[int(half), int(half % 1 > 0)], samples[-1, 2]])
        case Mirrored():
            return -np.conj(_start_middle_end(curve.curve))
        case Reversed():
            return _start_middle_end(curve.curve)[::-1]
    return curve.point(curve.breaks[0] * (1 - _SHARES) + curve.breaks[-1] * _SHARES)


def _at_breaks(t: Real, breaks: Real, rounding: float) -> Real:
    """Parameters that rounding has moved off an inner break put back on it, so that the right piece answers."""
    if len(breaks) == 2:
        inside: Real = np.minimum(np.maximum(t, breaks[0]), breaks[1])
        return inside
    near = np.minimum(np.maximum(breaks.searchsorted(t), 1), len(breaks) - 1)
    near = near - (t - breaks[near - 1] < breaks[near] - t)
    return np.where(np.abs(t - breaks[near]) <= 8 * rounding, breaks[near], t)
