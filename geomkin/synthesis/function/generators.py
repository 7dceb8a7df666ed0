"""Linkages that may follow a function, as unknowns: their errors with derivatives, their limits, where to begin."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import ClassVar

import numpy as np

from ...core.records import record
from ...linkage.linkage import AbstractLinkage
from ...linkage.named_linkages import FourBar, SliderCrank
from ...plane.vec import Complex, Mask, Real
from .minimax import AbstractTask


@record(eq=False, kw_only=True)
class AbstractGenerator(AbstractTask):
    """A task of function generation. Unknowns: three of its sizes, start of the input, start of the output, branch.

    share: the wanted output's share of its way over the input's. swing: of the input, rad, signed. starts: those that
    are given, nan where free. least_transmission, rad; largest_ratio of the links. through: shares of the input's way
    at which the error is to be nothing.
    """

    share: Callable[[Real], Real]
    swing: float
    starts: tuple[float, float]
    least_transmission: float
    largest_ratio: float
    through: tuple[float, ...] = ()
    # Columns of the unknowns that are angles, the same after a whole turn; of each of `bounds` what it limits.
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

    def way(self, p: Real) -> tuple[Real, Real]:
        """(many,) first and last angle of the input, in rising order."""
        return p[:, 3] + min(0.0, self.swing), p[:, 3] + max(0.0, self.swing)

    @abstractmethod
    def bounds(self, p: Real) -> tuple[Real, Real]:
        """Limits of transmission angle and ratio, as `limits` gives them."""

    @abstractmethod
    def spread(self, count: int) -> Real:
        """Candidates spread evenly over what the limits allow, whose error is least in the middle of its range."""

    @abstractmethod
    def fitted(self, count: int, s: Real) -> Real:
        """Candidates that fit the equation of the loop, linear in three ratios, at s (m,), over starts of any angle."""

    @abstractmethod
    def centred(self, p: Real, s: Real) -> Real:
        """The same with the start of the output, where it is free, such that the largest errors at s are alike."""

    @abstractmethod
    def transmission(self, p: Real) -> Real:
        """(many,) least transmission angle over the way, rad; nan where it does not close."""

    @abstractmethod
    def rounded(self, p: Real) -> Real:
        """Candidates whose lengths and starts have as many digits as are told."""

    @abstractmethod
    def linkage(self, p: Real) -> AbstractLinkage:
        """Of one candidate (unknowns,)."""


# Digits of a length, and decimals of an angle in deg, of what is found. More would hang on the last bit of a
# processor's sine; with fewer the peaks would not be of one height.
DIGITS, DECIMALS = 11, 10


def with_digits(values: Real) -> Real:
    """Rounded to as many digits as are told."""
    return np.array([float(f"{value:.{DIGITS}g}") for value in values.ravel().tolist()]).reshape(values.shape)


def with_decimals(angles: Real) -> Real:
    """Angles, rad, rounded to as many decimals of a degree as are told."""
    return np.radians(np.round(np.degrees(angles), DECIMALS))


# By how much more than asked the cosine of the transmission angle is kept: what the last step leaves is less.
HAIR = 2e-9


def evenly(count: int, size: int) -> Real:
    """(count, size) points spread evenly over 0 to 1, the same on every machine.

    Multiples of powers of a root of g**(size + 1) = g + 1, whole turns left out, which leave the least gaps known
    (M. Roberts' sequence; in one dimension the golden ratio's).
    """
    root = 2.0
    for _ in range(60):
        root = (1 + root) ** (1 / (size + 1))
    return (0.5 + np.outer(np.arange(1, count + 1), root ** -np.arange(1.0, size + 1))) % 1.0


def linear_fits(terms: Real, right: Real, steepness: Callable[[Real], Real]) -> Real:
    """Coefficients (many, 3) of least squares of terms (many, m, 3) to right (many, m), twice with better weights.

    steepness: from coefficients (many, 3) how fast the equation changes with the output, (many, m). Divided by that,
    the misfit is the output's error to first order; else the fit minds the equation where nobody asks.
    """
    weights = np.ones(right.shape)
    found = np.zeros((len(terms), 3))
    for _ in range(3):
        rows, values = terms * weights[..., None], right * weights
        normal = np.einsum("kmi,kmj->kij", rows, rows)
        normal += TINY * np.einsum("kii->k", normal)[:, None, None] * np.eye(3)
        found = np.linalg.solve(normal, np.einsum("kmi,km->ki", rows, values)[..., None])[..., 0]
        weights = 1 / np.maximum(np.abs(steepness(found)), FLATTEST)
    return found


# On the diagonal of normal equations, over what is there: without it, starts at which the three ratios are not told
# apart stop the rest.
TINY = 1e-14
# Steepness below which a place is not weighed any more. Smaller, and a place near a toggle outweighs all others.
FLATTEST = 1e-2


@record(eq=False, kw_only=True)
class SliderGenerator(AbstractGenerator):
    """Unknowns: logarithms of crank and connecting rod, offset, start of crank, rad, and of slider, branch.

    Lengths over the slider's way. sense: +1 or -1, its direction along x; way: its length, mm. Errors are of the
    slider's place, over its way.
    """

    sense: float
    length: float
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


# Pairs of the links ground, crank, coupler, rocker.
PAIRS = [(i, j) for i in range(4) for j in range(4) if i != j]


@record(eq=False, kw_only=True)
class FourBarGenerator(AbstractGenerator):
    """Unknowns: logarithms of crank, coupler and rocker over the ground, start of crank and of rocker, rad, branch.

    Angles from the ground line; the rocker's direction from its ground pivot. out: swing of the output, rad, signed.
    Errors are of the output's angle, rad. ground, mm.
    """

    out: float
    ground: float
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
