"""Linkages that may follow a function, as unknowns: their errors with derivatives, their limits, where to begin."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...cached import cached_property
from ...linkage.linkage import AbstractLinkage
from ...plane.vec import Mask, Real
from .minimax import AbstractTask


@dataclass(frozen=True, eq=False, kw_only=True)
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
