"""The one contract for curves.

A curve is a point that depends on a parameter. Everything that measures, flattens or writes a
curve uses this contract alone, so a cam profile, a gear tooth and a bar are treated alike.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike

from .vec import Array


class AbstractCurve(ABC):
    """A plane curve, smooth between its breaks.

    `point(t)`, mm, and `velocity(t)` = dP/dt take arrays of any shape, inside the domain
    [breaks[0], breaks[-1]]. At a break both answer for the piece that starts there.
    """

    @abstractmethod
    def point(self, t: ArrayLike) -> Array:
        """Points (...,) complex, mm."""

    @abstractmethod
    def velocity(self, t: ArrayLike) -> Array:
        """dP/dt (...,) complex, mm per unit of t; analytic."""

    @property
    @abstractmethod
    def breaks(self) -> Array:
        """Rising parameters between which the curve is smooth; the first and last are the domain."""

    @property
    @abstractmethod
    def closed(self) -> bool:
        """Whether the end is the start."""

    def curvature(self, t: ArrayLike) -> Array:
        """Signed curvature, 1/mm, positive where the curve turns left along rising t.

        Unless a curve knows better, from the analytic velocity: the derivative of the polynomial of
        degree 8 through nine neighbours inside the same smooth piece, good to about 1e-9 of the
        largest value where the piece is smooth on a scale of a sixteenth of its length.
        """
        t, breaks = np.asarray(t, dtype=float), self.breaks
        piece = np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(breaks) - 2)
        start, end = breaks[piece], breaks[piece + 1]
        # Half the window: wider loses smoothness, narrower loses digits to rounding.
        half = (end - start) / 32
        middle = np.clip(t, start + half, end - half)
        # 0.999 keeps the outer neighbours off a break, where the velocity belongs to the next piece.
        nodes = 0.999 * np.cos(np.pi * np.arange(8.5, 0, -1) / 9)
        v = self.velocity(middle[..., None] + half[..., None] * nodes)
        x = ((t - middle) / half)[..., None]
        powers = np.linalg.inv(np.vander(nodes, increasing=True))
        slope = np.concatenate([x**0 * 0, *[k * x ** (k - 1) for k in range(1, 9)]], axis=-1) @ powers
        value = np.concatenate([x**k for k in range(9)], axis=-1) @ powers
        v0, acceleration = np.sum(value * v, axis=-1), np.sum(slope * v, axis=-1) / half
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.imag(np.conj(v0) * acceleration) / np.abs(v0) ** 3


def just_before(t: Array, breaks: Array) -> Array:
    """Parameters, with those at a break moved before it: by more than the rounding that finds a piece again."""
    at = t == breaks[0] if len(breaks) == 1 else np.isin(t, breaks)
    return np.where(at, t - 64 * np.spacing(np.abs(breaks).max()), t) if at.any() else t


def reach(curve: AbstractCurve) -> float:
    """Largest distance of a coarse sample of the curve from its start, mm: its size, for relative limits."""
    b = curve.breaks
    sample = curve.point(np.concatenate([b[:-1] + f * np.diff(b) for f in (0.0, 0.25, 0.5, 0.75)]))
    return float(np.abs(sample - sample[0]).max())
