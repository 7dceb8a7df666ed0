"""The four-bar as a function generator: its crank is the input, its rocker the output."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...brief import one_line
from ...linkage.bars import FourBar
from ...plane.vec import Complex, Real
from .generators import HAIR, AbstractGenerator, evenly, linear_fits, with_decimals, with_digits

# Pairs of the links ground, crank, coupler, rocker.
PAIRS = [(i, j) for i in range(4) for j in range(4) if i != j]


@dataclass(frozen=True, eq=False, kw_only=True)
class FourBarGenerator(AbstractGenerator):
    """Unknowns: logarithms of crank, coupler and rocker over the ground, start of crank and of rocker, rad, branch.

    Angles from the ground line; the rocker's direction from its ground pivot. out: swing of the output, rad, signed.
    Errors are of the output's angle, rad. ground, mm.
    """

    out: float
    ground: float
    __repr__ = one_line
    angles: ClassVar[list[int]] = [3, 4]
    limit_names: ClassVar[list[str]] = 8 * ["transmission angle"] + len(PAIRS) * ["ratio"]

    def _placed(self, p: Real, s: Real) -> tuple[Real, Real, Real, Real, Complex, Real]:
        """Crank, coupler, rocker (many, 1); crank's angle, from the crank pin to the rocker pivot, rocker's angle."""
        a, b, c = (np.exp(p[:, k, None]) for k in range(3))
        angle = p[:, 3, None] + self.swing * s
        u = 1 - a * np.exp(1j * angle)
        with np.errstate(all="ignore"):
            inner = np.arccos((np.abs(u) ** 2 + c**2 - b**2) / (2 * np.abs(u) * c))
        return a, b, c, angle, u, np.angle(-u) - p[:, 5, None] * inner

    def error(self, p: Real, s: Real) -> Real:
        e = self._placed(p, s)[-1] - p[:, 4, None] - self.out * self.share(s)
        whole: Real = e - 2 * np.pi * np.round(e / (2 * np.pi))
        return whole

    def slopes(self, p: Real, s: Real) -> Real:
        # The closed loop a e^(i angle) + b e^(i t) = 1 + c e^(i out) differentiated, and taken along the coupler.
        a, b, c, angle, u, out = self._placed(p, s)
        with np.errstate(all="ignore"):
            t = np.angle(u + c * np.exp(1j * out))
            over = 1 / (c * np.sin(out - t))
            found = np.zeros((*over.shape, 6))
            found[..., 0] = -a * np.cos(angle - t) * over
            found[..., 1] = -b * over
            found[..., 2] = c * np.cos(out - t) * over
            found[..., 3] = a * np.sin(angle - t) * over
        found[..., 4] = -1
        return found

    def _extreme(self, p: Real) -> Real:
        """(many, 4) crank angles between which the transmission angle rises or falls: the ends, and where in line."""
        low, high = self.way(p)
        half = np.ceil(low / np.pi)
        return np.stack([low, high, np.minimum(half * np.pi, high), np.minimum((half + 1) * np.pi, high)], axis=1)

    def _cosine(self, p: Real) -> tuple[Real, Real, Real, Real, Real]:
        """Cosine of the angle between coupler and rocker at the extremes, their angles, and crank, coupler, rocker."""
        a, b, c = (np.exp(p[:, k, None]) for k in range(3))
        angle = self._extreme(p)
        return (b**2 + c**2 - 1 - a**2 + 2 * a * np.cos(angle)) / (2 * b * c), angle, a, b, c

    def bounds(self, p: Real) -> tuple[Real, Real]:
        cosine, angle, a, b, c = self._cosine(p)
        slope = np.zeros((*cosine.shape, 6))
        slope[..., 0] = (a * np.cos(angle) - a**2) / (b * c)
        slope[..., 1] = b / c - cosine
        slope[..., 2] = c / b - cosine
        slope[..., 3] = -a * np.sin(angle) / (b * c)
        most = np.cos(self.least_transmission) - HAIR
        logs = np.concatenate([np.zeros((len(p), 1)), p[:, :3]], axis=1)
        of = np.vstack([np.zeros(6), np.eye(6)[:3]])
        ratios = np.stack([logs[:, i] - logs[:, j] for i, j in PAIRS], axis=1) - np.log(self.largest_ratio)
        steep = np.broadcast_to(np.stack([of[i] - of[j] for i, j in PAIRS]), (len(p), len(PAIRS), 6))
        return (
            np.concatenate([cosine - most, -cosine - most, ratios], axis=1),
            np.concatenate([slope, -slope, steep], axis=1),
        )

    def transmission(self, p: Real) -> Real:
        with np.errstate(invalid="ignore"):
            least: Real = np.arccos(np.abs(self._cosine(p)[0]).max(axis=1))
            return least

    def spread(self, count: int) -> Real:
        q = evenly(count, 4)
        p = np.zeros((count, 6))
        p[:, :3] = (2 * q[:, :3] - 1) * np.log(self.largest_ratio)
        p[:, 3] = 2 * np.pi * q[:, 3] if np.isnan(self.starts[0]) else self.starts[0]
        p = p[self.bounds(p)[0].max(axis=1) <= 0]
        return np.concatenate([p + side * np.eye(6)[5] for side in (1, -1)])

    def fitted(self, count: int, s: Real) -> Real:
        # Freudenstein, Approximate synthesis of four-bar linkages, Transactions of the ASME 77, 1955:
        # cos(out) ground/crank - cos(in) ground/rocker + (ground2 + crank2 - coupler2 + rocker2)/(2 crank rocker)
        # = cos(in - out). A link of negative length is one that starts half a turn on.
        free = np.isnan(self.starts)
        each = round(count ** (1 / max(free.sum(), 1)))
        halves = np.pi * (np.arange(each) + 0.5) / each
        grid = np.meshgrid(*(halves if gap else np.array([start]) for start, gap in zip(self.starts, free)))
        starts = np.stack([one.ravel() for one in grid], axis=1)
        angle, out = starts[:, :1] + self.swing * s, starts[:, 1:] + self.out * self.share(s)
        terms = np.stack([np.cos(out), -np.cos(angle), np.ones(out.shape)], axis=-1)
        found = linear_fits(terms, np.cos(angle - out), lambda k: -k[:, :1] * np.sin(out) - np.sin(angle - out))
        with np.errstate(all="ignore"):
            a, c = 1 / found[:, 0], 1 / found[:, 1]
            square = 1 + a**2 + c**2 - 2 * a * c * found[:, 2]
            turned = np.stack([a < 0, c < 0], axis=1)
            logs = np.log(np.stack([np.abs(a), np.sqrt(square), np.abs(c)], axis=1))
        fits = np.isfinite(logs).all(axis=1) & ~(turned & ~free).any(axis=1)
        p = np.column_stack([logs, starts + np.pi * turned, np.zeros(len(logs))])[fits]
        return np.concatenate([p + side * np.eye(6)[5] for side in (1, -1)])

    def centred(self, p: Real, s: Real) -> Real:
        p = p.copy()
        p[:, 4] = 0.0 if np.isnan(self.starts[1]) else self.starts[1]
        if np.isnan(self.starts[1]):
            e = np.unwrap(self.error(p, s[None]), axis=1)
            p[:, 4] = 0.5 * (e.max(axis=1) + e.min(axis=1))
        return p

    def rounded(self, p: Real) -> Real:
        p = p.copy()
        p[:, :3] = np.log(with_digits(np.exp(p[:, :3])))
        p[:, 3:5] = np.where(self.free[3:5], with_decimals(p[:, 3:5]), p[:, 3:5])
        return p

    def linkage(self, p: Real) -> FourBar:
        crank, coupler, rocker = (self.ground * with_digits(np.exp(p[:3]))).tolist()
        return FourBar(self.ground, crank, coupler, rocker)
