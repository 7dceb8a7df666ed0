"""Curves made of pieces: a path of pieces end to end, and a polar array of equal copies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.arguments import PositiveInt
from ..core.errors import DesignError
from ..core.records import record
from .curve import AbstractCurve, Mirrored, Reversed
from .vec import Complex, Real, Whole

# Largest distance between the ends of neighbouring pieces, as a share of their distance from the origin.
GAP = 1e-9
# Shares of a curve's parameter range at which `_start_middle_end` takes points.
_SHARES = np.array([0.0, 0.5, 1.0])
Number = TypeVar("Number", np.complex128, np.float64)


@record(checked=True, eq=False)
class Path(AbstractCurve):
    """Pieces end to end; piece k runs over k <= t <= k + 1, whatever its own parameter.

    Parameters
    ----------
    pieces : tuple of AbstractCurve
        At least one; each starts where the previous one ends.

    Raises
    ------
    DesignError
        If there is a gap between two pieces; gives its number and length.
    """

    pieces: tuple[AbstractCurve, ...]

    def __post_init__(self) -> None:
        if not len(self.pieces):
            raise DesignError("pieces", "found none", "give at least one", "out-of-range")
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
        """Largest distance between ends, mm, that counts as rounding."""
        return float(GAP * np.abs(self._samples).max())

    @cached_property
    def breaks(self) -> Real:
        breaks = [0.0]
        for k, piece in enumerate(self.pieces):
            b = piece.breaks
            breaks += [k + 1.0] if len(b) == 2 else (k + (b[1:] - b[0]) / (b[-1] - b[0])).tolist()
        return np.array(breaks)

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
        """The values of each piece at its own parameters; its range is `span`, that of t is 1."""
        t = np.asarray(t, dtype=float)
        out = np.empty(t.shape, dtype)
        if not t.size:
            return out
        flat, places, (inner, firsts, lasts) = out.ravel(), t.ravel(), self._ends
        which: Whole = inner.searchsorted(places, side="right")
        # Most calls have rising parameters, of which each piece has a contiguous part.
        rising = bool((which[1:] >= which[:-1]).all())
        least: int = int(which[0] if rising else which.min())
        most: int = int(which[-1] if rising else which.max())
        if least == most:
            s, (breaks, first, last, rounding) = t - least, self._domains[least]
            s = first * (1 - s) + last * s
            s = np.minimum(np.maximum(s, first), last) if breaks is None else _at_breaks(s, breaks, rounding)
            out[...] = value(self.pieces[least], s, last - first)
            return out
        # All parameters of a piece in one call, since calls are expensive.
        share, first_of, last_of = places - which, firsts[which], lasts[which]
        local = first_of * (1 - share) + last_of * share
        inside = np.minimum(np.maximum(local, first_of), last_of)
        masks: Iterable[Any]
        if rising:
            ends = [0, *which.searchsorted(range(least + 1, most + 1)).tolist(), t.size]
            masks = map(slice, ends, ends[1:])
        else:
            masks = (which == k for k in range(least, most + 1))
        for k, mask in enumerate(masks, least):
            breaks, first, last, rounding = self._domains[k]
            s = inside[mask] if breaks is None else _at_breaks(local[mask], breaks, rounding)
            if s.size:
                flat[mask] = value(self.pieces[k], s, last - first)
        return out

    @cached_property
    def _domains(self) -> list[tuple[Real | None, float, float, float]]:
        """For each piece its breaks if it has inner ones, the first and the last, and the rounding of t."""
        domains: list[tuple[Real | None, float, float, float]] = []
        for k, b in enumerate(piece.breaks for piece in self.pieces):
            first, last = float(b[0]), float(b[-1])
            domains.append((b if len(b) > 2 else None, first, last, (last - first) * math.ulp(k + 1.0)))
        return domains

    @cached_property
    def _ends(self) -> tuple[Real, Real, Real]:
        """Parameters at which pieces meet; the first and the last of each piece's own parameters."""
        _, first, last, _ = zip(*self._domains)
        return np.arange(1.0, len(self.pieces)), np.array(first), np.array(last)


@record(checked=True, eq=False)
class PolarArray(AbstractCurve):
    """Equal copies of a piece around the origin, each turned by one count-th of a turn more; closed.

    Each copy takes the same range of t as the piece, from t = 0. The copies are equal to the last bit.

    Parameters
    ----------
    piece : AbstractCurve
        It must end where its next copy starts.
    count : int
        Number of copies; above 0.

    Raises
    ------
    DesignError
        If there is a gap between two copies.
    """

    piece: AbstractCurve
    count: PositiveInt

    def __post_init__(self) -> None:
        start, _, end = _start_middle_end(self.piece).tolist()
        gap = abs(end - start * self.turns[1 % self.count])
        if gap > GAP * abs(start):
            raise DesignError("piece", f"it ends {gap:.3g} mm from the start of its next copy", "close the gap")

    @cached_property
    def turns(self) -> Complex:
        """Direction of each copy, unit complex, (count,)."""
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
        # At a break between copies the quotient may be below the whole number by rounding.
        copy = np.clip(np.floor(t / span * (1 + 4e-16)), 0, self.count - 1).astype(int)
        return copy, _at_breaks(
            self.piece.breaks[0] + (t - copy * span), self.piece.breaks, np.spacing(self.count * span)
        )


def _start_middle_end(curve: AbstractCurve) -> Complex:
    """The points of a curve at the start, the middle and the end of its parameter, (3,); those of a path are cached."""
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
    """Parameters, with those near an inner break moved onto it, so that rounding does not select the wrong piece."""
    if len(breaks) == 2:
        inside: Real = np.minimum(np.maximum(t, breaks[0]), breaks[1])
        return inside
    k = np.minimum(np.maximum(breaks.searchsorted(t), 1), len(breaks) - 1)
    k = k - (t - breaks[k - 1] < breaks[k] - t)
    return np.where(np.abs(t - breaks[k]) <= 8 * rounding, breaks[k], t)
