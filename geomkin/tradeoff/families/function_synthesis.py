"""A four-bar that follows a function: precision points by hand and by search, least squares, minimax."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...linkage.named_linkages import FourBar
from ...plane.vec import Real
from ...synthesis.function.function import Method as Aim
from ...synthesis.function.function import chebyshev_points, function_generator
from ..family import Method, MethodFamily

# Where the output is held against the function, and where the textbook's linkages are, to choose between them.
PLACES, FEW = 2001, 33
# Limits that all keep: least transmission angle, and ratio of the longest link to the shortest.
TRANSMISSION_DEG, RATIO = 30.0, 10.0


class LogarithmTask(NamedTuple):
    """log10(x) from 1 to 2, as shares of the output's swing over those of the input's; swings in rad."""

    share: Callable[[Real], Real]
    swing: float
    out: float


# Four-bars (6, ...): crank, coupler and rocker over the ground, starts of crank and rocker, rad, and branch.
Generators = Real


def problem() -> LogarithmTask:
    """Input 60 deg, output 90 deg."""
    return LogarithmTask(lambda s: np.log10(1 + s) / np.log10(2.0), np.radians(60.0), np.radians(90.0))


def structural_error(wanted: LogarithmTask, found: Generators, s: Real) -> Real:
    """Output less function, rad, (..., places) at shares s of the input's way; nan where the four-bar is open.

    The rocker's pin is where two circles meet, about the crank's pin and about the rocker's pivot.
    """
    a, b, c, start, output_start, branch = found[..., None]
    pin = a * np.exp(1j * (start + wanted.swing * s))
    across = 1 - pin
    gap = np.abs(across)
    along = (gap**2 + b**2 - c**2) / (2 * gap)
    with np.errstate(invalid="ignore"):
        aside = np.sqrt(b**2 - along**2)
    rocker = pin + across / gap * (along + 1j * branch * aside) - 1
    error: Real = np.angle(rocker * np.exp(-1j * (output_start + wanted.out * wanted.share(s))))
    return error


def by_hand(wanted: LogarithmTask, starts: Real) -> Generators:
    """Four-bars through three precision points of Chebyshev's spacing, for each pair of starts (n, 2), rad.

    Freudenstein, Approximate synthesis of four-bar linkages, Transactions of the ASME 77, 1955: three linear equations
    in ground/crank, ground/rocker and a third number. A negative length starts half a turn on.
    """
    s = chebyshev_points((0.0, 1.0), 3)
    angle, out = starts[:, :1] + wanted.swing * s, starts[:, 1:] + wanted.out * wanted.share(s)
    terms = np.stack([np.cos(out), -np.cos(angle), np.ones(out.shape)], axis=-1)
    k = np.linalg.solve(terms, np.cos(angle - out)[..., None])[..., 0]
    with np.errstate(all="ignore"):
        crank, rocker = 1 / k[:, 0], 1 / k[:, 1]
        coupler = np.sqrt(1 + crank**2 + rocker**2 - 2 * crank * rocker * k[:, 2])
    start, output = starts[:, 0] + np.pi * (crank < 0), starts[:, 1] + np.pi * (rocker < 0)
    sizes = [np.abs(crank), coupler, np.abs(rocker), start, output]
    return np.concatenate([[*sizes, np.full(len(starts), branch)] for branch in (1.0, -1.0)], axis=1)


def _best(wanted: LogarithmTask, found: Generators) -> Generators:
    """Of many (6, n) the one (6,) that errs least within the limits, nan if none is."""
    s = np.linspace(0, 1, FEW)
    worst = np.abs(structural_error(wanted, found, s)).max(axis=-1)
    lengths = np.concatenate([np.ones_like(found[:1]), found[:3]])
    a, b, c, start = found[:4, :, None]
    gap = np.abs(1 - a * np.exp(1j * (start + wanted.swing * s))) ** 2
    with np.errstate(invalid="ignore"):
        cosine = np.abs((b**2 + c**2 - gap) / (2 * b * c)).max(axis=-1)
        kept = (cosine <= np.cos(np.radians(TRANSMISSION_DEG))) & (lengths.max(axis=0) <= RATIO * lengths.min(axis=0))
    worst = np.where(kept & np.isfinite(worst), worst, np.inf)
    best = int(worst.argmin())
    return found[:, best] if np.isfinite(worst[best]) else np.full(6, np.nan)


def _over_starts(wanted: LogarithmTask, count: float) -> Callable[[], Generators]:
    """By hand from each pair of starts on a square grid of so many."""
    each = round(count**0.5)
    halves = np.pi * (np.arange(each) + 0.5) / each
    starts = np.stack([axis.ravel() for axis in np.meshgrid(halves, halves)], axis=1)
    return lambda: _best(wanted, by_hand(wanted, starts))


def _searched(aim: Aim, points: int = 3) -> Callable[[LogarithmTask, float], Callable[[], Generators]]:
    def make(wanted: LogarithmTask, _: float) -> Callable[[], Generators]:
        def found() -> Generators:
            swings = float(np.degrees(wanted.swing)), float(np.degrees(wanted.out))
            one = function_generator("log10(x)", (1.0, 2.0), *swings, method=aim, points=points)
            bar = one.linkage
            assert isinstance(bar, FourBar)
            lengths = np.array([bar.crank, bar.coupler, bar.rocker]) / bar.ground
            return np.array([*lengths, *np.radians(one.starts_deg), one.branch])

        return found

    return make


FUNCTION_SYNTHESIS: MethodFamily[LogarithmTask, Generators] = MethodFamily(
    name="function-synthesis",
    title="Function synthesis",
    about="A four-bar whose rocker follows log10(x), 1 to 2, through 90 deg while its crank turns by 60; transmission "
    f"angle {TRANSMISSION_DEG:g} deg, ratio of links {RATIO:g}.",
    per="linkage",
    unit="deg",
    reference=f"the linkage that is found, closed by the meeting of two circles at {PLACES} places, and the logarithm",
    floor=1e-9,
    problem=problem,
    count=lambda _, found: 1,
    error=lambda wanted, found: np.degrees(np.abs(structural_error(wanted, found, np.linspace(0, 1, PLACES)))),
    methods=(
        Method(
            "minimax",
            "Thousands of fits, the best few dozen followed to where no small change makes the largest error less "
            "(`function_generator`).",
            _searched("minimax"),
            rationale="No other method comes near its error, and it proves that no small change reduces it.",
        ),
        Method(
            "least squares",
            'The same search for the least mean square (`method="least-squares"`).',
            _searched("least-squares"),
            slow=True,
        ),
        Method(
            "three points searched",
            "Three precision points of Chebyshev's spacing; what they leave free makes the largest error least.",
            _searched("points", 3),
            slow=True,
        ),
        Method(
            "four points searched",
            "The same with four, for which a start must be right.",
            _searched("points", 4),
            slow=True,
        ),
        Method(
            "three points by hand",
            "Freudenstein's equations for three precision points of Chebyshev's spacing, from as many pairs of starts "
            "on a grid; the best within the limits is kept.",
            _over_starts,
            "pairs of starts",
            (16.0, 64.0, 256.0, 1024.0, 4096.0, 16384.0),
        ),
    ),
)
