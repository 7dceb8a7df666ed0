"""Linkages that may follow a function: unknowns, errors with derivatives, limits, and starting candidates."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import ClassVar

import numpy as np

from ...core.fields import to_digits
from ...core.records import record
from ...linkage.linkage import AbstractLinkage
from ...linkage.named_linkages import FourBar, SliderCrank
from ...plane.vec import Complex, Mask, Real
from .minimax import AbstractTask


@record(eq=False, kw_only=True)
class AbstractGenerator(AbstractTask):
    """A task of function generation. Unknowns: three sizes, start of the input, start of the output, branch.

    `share`: share of the output range over that of the input range. `swing`: range of the input, rad, signed. `starts`:
    given ones, nan if free. `least_transmission`: rad. `largest_ratio`: of the links. `through`: shares of the input
    range at which the error must be 0.
    """

    share: Callable[[Real], Real]
    swing: float
    starts: tuple[float, float]
    least_transmission: float
    largest_ratio: float
    through: tuple[float, ...] = ()
    # Columns of the unknowns that are angles, periodic in a turn; and the name of each limit of `bounds`.
    angles: ClassVar[list[int]]
    limit_names: ClassVar[list[str]]

    @cached_property
    def free(self) -> Mask:
        return np.array([True, True, True, *np.isnan(self.starts), False])

    def limits(self, p: Real) -> tuple[Real, Real]:
        values, slopes = self.bounds(p)
        if self.through:
            s = np.array(self.through)[None]
            e, de = self.error(p, s), self.slopes(p, s)
            values, slopes = np.concatenate([values, e, -e], axis=1), np.concatenate([slopes, de, -de], axis=1)
        return values, slopes

    def input_range(self, p: Real) -> tuple[Real, Real]:
        """(many,) first and last angle of the input, in rising order."""
        return p[:, 3] + min(0.0, self.swing), p[:, 3] + max(0.0, self.swing)

    @abstractmethod
    def bounds(self, p: Real) -> tuple[Real, Real]:
        """Limits of transmission angle and ratio, in the form of `limits`."""

    @abstractmethod
    def spread(self, count: int) -> Real:
        """Candidates spread evenly within the limits, with the least error in the middle of the range."""

    @abstractmethod
    def fitted(self, count: int, s: Real) -> Real:
        """Candidates that fit the loop equation, which is linear in three ratios, at s (m,), over all starts."""

    @abstractmethod
    def centred(self, p: Real, s: Real) -> Real:
        """Candidates with the start of the output, if free, chosen so that the largest errors at s are balanced."""

    @abstractmethod
    def transmission(self, p: Real) -> Real:
        """(many,) least transmission angle over the range, rad; nan if the linkage does not close."""

    @abstractmethod
    def rounded(self, p: Real) -> Real:
        """Candidates with lengths and starts rounded to the reported digits."""

    @abstractmethod
    def linkage(self, p: Real) -> AbstractLinkage:
        """The linkage of one candidate (unknowns,)."""


# Digits of a length and decimals of an angle in deg in results. With more the last bit of a processor's sine would
# decide; with fewer the peaks would not be of equal height.
DIGITS, DECIMALS = 11, 10


def with_digits(values: Real) -> Real:
    """Values rounded to the reported digits."""
    return np.array([to_digits(value, DIGITS) for value in values.ravel().tolist()]).reshape(values.shape)


def with_decimals(angles: Real) -> Real:
    """Angles, rad, rounded to the reported decimals of a degree."""
    return np.radians(np.round(np.degrees(angles), DECIMALS))


# Margin for the cosine of the transmission angle, larger than the error of the last step.
HAIR = 2e-9


def evenly(count: int, size: int) -> Real:
    """(count, size) points spread evenly over 0 to 1, equal on every machine.

    Multiples modulo 1 of powers of a root of g**(size + 1) = g + 1, which leave the smallest gaps known (M. Roberts'
    sequence; in one dimension that of the golden ratio).
    """
    root = 2.0
    for _ in range(60):
        root = (1 + root) ** (1 / (size + 1))
    return (0.5 + np.outer(np.arange(1, count + 1), root ** -np.arange(1.0, size + 1))) % 1.0


def linear_fits(terms: Real, right: Real, steepness: Callable[[Real], Real]) -> Real:
    """Coefficients (many, 3) of least squares of terms (many, m, 3) to right (many, m), with weights improved twice.

    `steepness` maps coefficients (many, 3) to the rate of the equation by the output, (many, m). Divided by it, the
    residual is the output's error to first order.
    """
    weights = np.ones(right.shape)
    coefficients = np.zeros((len(terms), 3))
    for _ in range(3):
        rows, values = terms * weights[..., None], right * weights
        normal = np.einsum("kmi,kmj->kij", rows, rows)
        normal += TINY * np.einsum("kii->k", normal)[:, None, None] * np.eye(3)
        coefficients = np.linalg.solve(normal, np.einsum("kmi,km->ki", rows, values)[..., None])[..., 0]
        weights = 1 / np.maximum(np.abs(steepness(coefficients)), FLATTEST)
    return coefficients


# Relative addition to the diagonal of normal equations, without which singular starts would stop the others.
TINY = 1e-14
# Steepness below which the weight does not grow further, so that a position near a toggle does not outweigh all others.
FLATTEST = 1e-2


@record(eq=False, kw_only=True)
class SliderGenerator(AbstractGenerator):
    """Unknowns: logarithms of crank and connecting rod, offset, start of crank, rad, and of slider, branch.

    Lengths are relative to the slider's travel `length`, mm; `sense` is its direction along x, +1 or -1. Errors are
    those of the slider's position, relative to its travel.
    """

    sense: float
    length: float
    angles: ClassVar[list[int]] = [3]
    limit_names: ClassVar[list[str]] = 8 * ["transmission angle"] + 2 * ["ratio"]

    def _placed(self, p: Real, s: Real) -> tuple[Real, Real, Real, Real, Real]:
        """Crank, rod (many, 1), crank angle, height of the slide line above the crank pin, and the rod's x extent."""
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
        rates = np.zeros((*angle.shape, 6))
        with np.errstate(all="ignore"):
            rates[..., 0] = a * (np.cos(angle) + w * np.sin(angle) / q)
            rates[..., 1] = b**2 / q
            rates[..., 2] = -w / q
            rates[..., 3] = a * (w * np.cos(angle) / q - np.sin(angle))
        rates[..., 4] = -1
        return rates

    def _sine(self, p: Real) -> tuple[Real, Real, Real, Real]:
        """Sine of the rod's angle to the slide line at its extremes, the crank angles there, crank, rod."""
        low, high = self.input_range(p)
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
        # First for a crank of 1; the wanted travel then gives the size.
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
        # The slider's start may be anywhere; the tangent spaces the candidates wider outwards.
        grids = [
            np.pi * even if free[0] else self.starts[:1],
            np.tan(np.pi * (even - 0.5)) if free[1] else self.starts[1:],
        ]
        first, place = (axis.ravel()[:, None] for axis in np.meshgrid(*grids))
        angle, x = first + self.swing * s, place + self.sense * self.share(s)
        terms = np.stack([x * np.cos(angle), np.sin(angle), np.ones(x.shape)], axis=-1)
        coefficients = linear_fits(terms, x**2, lambda k: 2 * x - k[:, :1] * np.cos(angle))
        with np.errstate(all="ignore"):
            a, h = coefficients[:, 0] / 2, coefficients[:, 1] / coefficients[:, 0]
            logs = np.log(np.stack([np.abs(a), np.sqrt(coefficients[:, 2] + a**2 + h**2)], axis=1))
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


# Pairs of the links ground, crank, coupler, rocker.
PAIRS = [(i, j) for i in range(4) for j in range(4) if i != j]


@record(eq=False, kw_only=True)
class FourBarGenerator(AbstractGenerator):
    """Unknowns: logarithms of crank, coupler and rocker over the ground, start of crank and of rocker, rad, branch.

    Angles are from the ground line, the rocker's at its ground pivot. `out` is the range of the output, rad, signed;
    `ground` is in mm. Errors are those of the output angle, rad.
    """

    out: float
    ground: float
    angles: ClassVar[list[int]] = [3, 4]
    limit_names: ClassVar[list[str]] = 8 * ["transmission angle"] + len(PAIRS) * ["ratio"]

    def _placed(self, p: Real, s: Real) -> tuple[Real, Real, Real, Real, Complex, Real]:
        """Crank, coupler, rocker (many, 1); crank angle, vector from crank pin to rocker pivot, rocker angle."""
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
        # The loop a e^(i angle) + b e^(i t) = 1 + c e^(i out), differentiated and projected on the coupler.
        a, b, c, angle, u, out = self._placed(p, s)
        with np.errstate(all="ignore"):
            t = np.angle(u + c * np.exp(1j * out))
            over = 1 / (c * np.sin(out - t))
            rates = np.zeros((*over.shape, 6))
            rates[..., 0] = -a * np.cos(angle - t) * over
            rates[..., 1] = -b * over
            rates[..., 2] = c * np.cos(out - t) * over
            rates[..., 3] = a * np.sin(angle - t) * over
        rates[..., 4] = -1
        return rates

    def _extreme(self, p: Real) -> Real:
        """(many, 4) crank angles between which the transmission angle is monotonic: the ends, and crank in line with
        ground.
        """
        low, high = self.input_range(p)
        half = np.ceil(low / np.pi)
        return np.stack([low, high, np.minimum(half * np.pi, high), np.minimum((half + 1) * np.pi, high)], axis=1)

    def _cosine(self, p: Real) -> tuple[Real, Real, Real, Real, Real]:
        """Cosine of the angle between coupler and rocker at these angles, the angles, and crank, coupler, rocker."""
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
        starts = np.stack([axis.ravel() for axis in grid], axis=1)
        angle, out = starts[:, :1] + self.swing * s, starts[:, 1:] + self.out * self.share(s)
        terms = np.stack([np.cos(out), -np.cos(angle), np.ones(out.shape)], axis=-1)
        coefficients = linear_fits(terms, np.cos(angle - out), lambda k: -k[:, :1] * np.sin(out) - np.sin(angle - out))
        with np.errstate(all="ignore"):
            a, c = 1 / coefficients[:, 0], 1 / coefficients[:, 1]
            square = 1 + a**2 + c**2 - 2 * a * c * coefficients[:, 2]
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
