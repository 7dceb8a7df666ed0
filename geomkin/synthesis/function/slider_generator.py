"""The slider-crank as a function generator: its crank is the input, its slide the output."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...brief import one_line
from ...linkage.sliders import SliderCrank
from ...plane.vec import Real
from .generators import HAIR, AbstractGenerator, evenly, linear_fits, with_decimals, with_digits


@dataclass(frozen=True, eq=False, kw_only=True)
class SliderGenerator(AbstractGenerator):
    """Unknowns: logarithms of crank and connecting rod, offset, start of crank, rad, and of slider, branch.

    Lengths over the slider's way. sense: +1 or -1, its direction along x; way: its length, mm. Errors are of the
    slider's place, over its way.
    """

    sense: float
    length: float
    __repr__ = one_line
    angles: ClassVar[list[int]] = [3]
    limit_names: ClassVar[list[str]] = 8 * ["transmission angle"] + 2 * ["ratio"]

    def _placed(self, p: Real, s: Real) -> tuple[Real, Real, Real, Real, Real]:
        """Crank, rod (many, 1), crank's angle, slide line's height over its pin, reach of the rod along x."""
        a, b, h = np.exp(p[:, :1]), np.exp(p[:, 1:2]), p[:, 2:3]
        angle = p[:, 3, None] + self.swing * s
        w = h - a * np.sin(angle)
        with np.errstate(all="ignore"):
            return a, b, angle, w, p[:, 5, None] * np.sqrt(b**2 - w**2)

    def error(self, p: Real, s: Real) -> Real:
        a, _, angle, _, q = self._placed(p, s)
        e: Real = a * np.cos(angle) + q - p[:, 4, None] - self.sense * self.share(s)
        return e

    def slopes(self, p: Real, s: Real) -> Real:
        a, b, angle, w, q = self._placed(p, s)
        found = np.zeros((*angle.shape, 6))
        with np.errstate(all="ignore"):
            found[..., 0] = a * (np.cos(angle) + w * np.sin(angle) / q)
            found[..., 1] = b**2 / q
            found[..., 2] = -w / q
            found[..., 3] = a * (w * np.cos(angle) / q - np.sin(angle))
        found[..., 4] = -1
        return found

    def _sine(self, p: Real) -> tuple[Real, Real, Real, Real]:
        """Sine of the rod's angle to the slide line where it is largest or smallest, crank's angles, crank, rod."""
        low, high = self.way(p)
        half = np.ceil(low / np.pi - 0.5)
        inner = [np.minimum((half + k + 0.5) * np.pi, high) for k in (0, 1)]
        angle = np.stack([low, high, *inner], axis=1)
        a, b = np.exp(p[:, :1]), np.exp(p[:, 1:2])
        return (p[:, 2:3] - a * np.sin(angle)) / b, angle, a, b

    def bounds(self, p: Real) -> tuple[Real, Real]:
        sine, angle, a, b = self._sine(p)
        slope = np.zeros((*sine.shape, 6))
        slope[..., 0] = -a * np.sin(angle) / b
        slope[..., 1] = -sine
        slope[..., 2] = 1 / b
        slope[..., 3] = -a * np.cos(angle) / b
        most = np.cos(self.least_transmission) - HAIR
        one = np.zeros((len(p), 1, 6))
        one[..., 0], one[..., 1] = 1, -1
        gap = p[:, :1] - p[:, 1:2]
        room = np.log(self.largest_ratio)
        return (
            np.concatenate([sine - most, -sine - most, gap - room, -gap - room], axis=1),
            np.concatenate([slope, -slope, one, -one], axis=1),
        )

    def transmission(self, p: Real) -> Real:
        with np.errstate(invalid="ignore"):
            least: Real = np.arccos(np.abs(self._sine(p)[0]).max(axis=1))
            return least

    def spread(self, count: int) -> Real:
        q = evenly(count, 3)
        p = np.zeros((count, 6))
        # First of a crank of 1, whose slider goes so far that the size is told by the way wanted.
        p[:, 1] = (2 * q[:, 0] - 1) * np.log(self.largest_ratio)
        p[:, 2] = (2 * q[:, 1] - 1) * (1 + np.exp(p[:, 1]))
        p[:, 3] = 2 * np.pi * q[:, 2] if np.isnan(self.starts[0]) else self.starts[0]
        p = p[self.bounds(p)[0].max(axis=1) <= 0]
        p = np.concatenate([p + side * np.eye(6)[5] for side in (1, -1)])
        s: Real = np.linspace(0, 1, 17)
        place = self.error(p, s[None]) + self.sense * self.share(s)
        wanted = self.sense * (self.share(s) - self.share(s).mean())
        along = (place - place.mean(axis=1, keepdims=True)) @ wanted / (wanted @ wanted)
        p, along = p[along > 0], along[along > 0]
        p[:, :2] -= np.log(along)[:, None]
        p[:, 2] /= along
        return np.asarray(p)

    def fitted(self, count: int, s: Real) -> Real:
        # The loop: x2 = 2 a x cos(in) + 2 a h sin(in) + b2 - a2 - h2 (Hartenberg and Denavit, Kinematic Synthesis of
        # Linkages, chapter 10, of the slider-crank). A crank of negative length is one that starts half a turn on.
        free = np.isnan(self.starts)
        each = round(count ** (1 / max(free.sum(), 1)))
        even = (np.arange(each) + 0.5) / each
        # The slider's start may lie anywhere: as the tangent goes, in parts that widen outwards.
        grids = [
            np.pi * even if free[0] else self.starts[:1],
            np.tan(np.pi * (even - 0.5)) if free[1] else self.starts[1:],
        ]
        first, place = (one.ravel()[:, None] for one in np.meshgrid(*grids))
        angle, x = first + self.swing * s, place + self.sense * self.share(s)
        terms = np.stack([x * np.cos(angle), np.sin(angle), np.ones(x.shape)], axis=-1)
        found = linear_fits(terms, x**2, lambda k: 2 * x - k[:, :1] * np.cos(angle))
        with np.errstate(all="ignore"):
            a, h = found[:, 0] / 2, found[:, 1] / found[:, 0]
            logs = np.log(np.stack([np.abs(a), np.sqrt(found[:, 2] + a**2 + h**2)], axis=1))
        turned = a < 0
        fits = np.isfinite(logs).all(axis=1) & np.isfinite(h) & ~(turned & ~free[0])
        start = first[:, 0] + np.pi * turned
        p = np.column_stack([logs, h, start, place[:, 0], np.zeros(len(logs))])[fits]
        return np.concatenate([p + side * np.eye(6)[5] for side in (1, -1)])

    def centred(self, p: Real, s: Real) -> Real:
        p = p.copy()
        p[:, 4] = 0.0 if np.isnan(self.starts[1]) else self.starts[1]
        if np.isnan(self.starts[1]):
            e = self.error(p, s[None])
            p[:, 4] = 0.5 * (e.max(axis=1) + e.min(axis=1))
        return p

    def rounded(self, p: Real) -> Real:
        p = p.copy()
        p[:, :2] = np.log(with_digits(np.exp(p[:, :2])))
        p[:, 2] = with_digits(p[:, 2])
        begun = np.stack([with_decimals(p[:, 3]), with_digits(p[:, 4])], axis=1)
        p[:, 3:5] = np.where(self.free[3:5], begun, p[:, 3:5])
        return p

    def linkage(self, p: Real) -> SliderCrank:
        crank, rod = (self.length * with_digits(np.exp(p[:2]))).tolist()
        return SliderCrank(crank, rod, self.length * float(p[2]))
