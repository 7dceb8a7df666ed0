"""Closed curves by their harmonics: a wanted curve, and a library of curves of random chains that are similar to it."""

from __future__ import annotations

from functools import cache, cached_property
from itertools import product

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole
from .closed_lines import evenly
from .dyad_chains import ANGLES, Chains, joined, random_chains, traced

# Points of a wanted curve at equal arc lengths, and harmonics that are compared.
POINTS, HARMONICS = 1024, 32
# Random chains in the library by number of bars, and how many are drawn at once.
STORED, AT_ONCE = {4: 12_000, 5: 15_000, 6: 30_000, 7: 40_000, 8: 50_000}, 4_000
# Crank angles at which the limits of chains for timed points are checked; starts of the crank and points with which
# they are compared, and chains at once.
LIMITED, STARTS, COMPARED, TIMED_AT_ONCE = 72, 32, 12, 1_000
# Size of a wanted curve in the search: the diagonal of its box.
SIZE = 100.0


@record(eq=False)
class TargetCurve:
    """A wanted closed curve, scaled to a box with the diagonal `SIZE` about 0.

    points: (POINTS,) at equal arc lengths; scale: mm of a unit; middle: mm; weight: (POINTS,), in the mean 1.
    """

    points: Complex
    scale: float
    middle: complex
    weight: Real

    @cached_property
    def tangent(self) -> Complex:
        """Unit tangents at the points."""
        ahead = np.roll(self.points, -1) - np.roll(self.points, 1)
        return ahead / np.maximum(np.abs(ahead), 1e-12)

    @cached_property
    def looped(self) -> tuple[Complex, Complex]:
        """Points and tangents with the first one again at the end."""
        return np.append(self.points, self.points[0]), np.append(self.tangent, self.tangent[0])

    @cached_property
    def perimeter(self) -> float:
        """Length in units of the search."""
        return float(np.abs(np.diff(self.looped[0])).sum())

    def at(self, share: Real) -> tuple[Complex, Complex]:
        """Points and unit tangents at shares of the length, any shape."""
        place = (share % 1.0) * POINTS
        index = np.minimum(place.astype(int), POINTS - 1)
        part = place - index
        points, tangents = self.looped
        return points[index] * (1 - part) + points[index + 1] * part, tangents[index]

    def weight_at(self, share: Real) -> Real:
        """Weights of the distances at shares of the length, any shape."""
        weight: Real = self.weight[((share % 1.0) * POINTS).astype(int) % POINTS]
        return weight

    @cached_property
    def harmonics(self) -> Complex:
        """As `harmonics_of`, (HARMONICS,)."""
        harmonics: Complex = harmonics_of(np.append(self.points[:: POINTS // ANGLES], self.points[0])[None])[0][0]
        return harmonics


@record(eq=False)
class TimedPoints:
    """Wanted points (n,) in units of the search at crank angles (n,) from the first on, rad, and weights (n,)."""

    places: Complex
    turns: Real
    weights: Real

    def thinned(self, most: int) -> TimedPoints:
        """At most so many of the points, evenly chosen."""
        some = np.unique(np.linspace(0, len(self.places) - 1, most).round().astype(int))
        return TimedPoints(self.places[some], self.turns[some], self.weights[some])

    def cranks(self, starts: Real) -> Real:
        """Crank angles (s, n + LIMITED) of the points from starts (s,) on, and others at which limits are checked."""
        over = 2 * np.pi * np.arange(LIMITED) / LIMITED
        angles: Real = starts[:, None] + np.append(self.turns, over)
        return angles

    def nearest(self, library: CurveLibrary, count: int) -> tuple[Chains, Real]:
        """The chains that come nearest to the points after the best rotation, scaling and shift, and their starts (s,).

        Compared at few of the points from `STARTS` starts of the crank, also mirrored; the best first. Derived here.
        """
        if len(self.places) > COMPARED:
            return self.thinned(COMPARED).nearest(library, count)
        chains, share = library.chains, self.weights / self.weights.sum()
        middle, place = share @ self.places, self.turns * ANGLES / (2 * np.pi)
        before = np.floor(place).astype(int)
        part, row = place - before, (np.arange(0, ANGLES, ANGLES // STARTS)[:, None] + before) % ANGLES
        best = np.zeros(len(chains))
        start, mirrored = np.zeros(len(chains), dtype=int), np.zeros(len(chains), dtype=bool)
        factor, centre = np.zeros(len(chains), dtype=complex), np.zeros(len(chains), dtype=complex)
        for k, is_mirrored in product(range(0, len(chains), TIMED_AT_ONCE), (False, True)):
            some = slice(k, k + TIMED_AT_ONCE)
            path = closed_paths(chains[some])[:, :-1]
            # A mirrored chain is at an angle where the chain was at its opposite.
            path = np.roll(path[:, ::-1], 1, axis=1).conj() if is_mirrored else path
            at = path[:, row] * (1 - part) + path[:, (row + 1) % ANGLES] * part
            mean = at @ share
            at = at - mean[..., None]
            along, power = at.conj() @ (share * (self.places - middle)), np.abs(at) ** 2 @ share
            # Points at nearly one angle may have no size.
            with np.errstate(invalid="ignore", divide="ignore"):
                likeness, scaled = np.nan_to_num(np.abs(along) / np.sqrt(power), posinf=0.0), along / power
            top, one = np.argmax(likeness, axis=1), np.arange(len(path))
            better = likeness[one, top] > best[some]
            new = likeness[one, top], top, np.full(len(path), is_mirrored), scaled[one, top], mean[one, top]
            for kept, values in zip((best, start, mirrored, factor, centre), new):
                kept[some] = np.where(better, values, kept[some])
        chosen = _mixed(chains, best, count)
        chosen = chosen[best[chosen] > 0]
        chains, factor, centre = chains[chosen], factor[chosen], centre[chosen]
        chains = chains.placed(factor**0, 0 * factor, mirrored[chosen])
        chains = chains.placed(factor, middle - factor * centre, np.zeros(len(chosen), dtype=bool))
        return chains, 2 * np.pi * start[chosen] / STARTS


def target_curve(line: Complex, weight: Real | None = None) -> TargetCurve:
    """The wanted curve of a closed line (k,), whose end is its start, and weights (k,) of the distances from it."""
    share = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(line)))])
    at = share[-1] * np.arange(POINTS) / POINTS
    points = np.interp(at, share, line)
    corners = [complex(f(points.real), f(points.imag)) for f in (np.min, np.max)]
    scale, middle = abs(corners[1] - corners[0]) / SIZE, sum(corners) / 2
    weights = np.ones(POINTS) if weight is None else np.interp(at, share, weight)
    return TargetCurve((points - middle) / max(scale, 1e-300), scale, middle, weights / weights.mean())


def harmonics_of(path: Complex) -> tuple[Complex, Real]:
    """Harmonics (s, HARMONICS) of closed paths at equal arc lengths, without the middle, of norm 1; and the norms."""
    all_of_them = np.fft.fft(evenly(path, ANGLES)[0], axis=1) / ANGLES
    half = HARMONICS // 2
    kept = np.concatenate([all_of_them[:, :half], all_of_them[:, -half:]], axis=1)
    kept[:, 0] = 0
    norm = np.sqrt(np.sum(np.abs(kept) ** 2, axis=1))
    with np.errstate(invalid="ignore", divide="ignore"):
        return kept / norm[:, None], norm


@record(eq=False)
class CurveLibrary:
    """Random chains and the harmonics (s, HARMONICS) of their curves."""

    chains: Chains
    harmonics: Complex

    def nearest(self, target: TargetCurve, count: int) -> tuple[Chains, Real]:
        """The most similar chains, laid over the target, and their likeness (s,), at most 1; the best first.

        Curves are compared after the best rotation, scaling and shift, from every start and in both senses, also
        mirrored. At most a quarter are of one kind.
        """
        likeness = np.zeros(len(self.chains))
        mirrored = np.zeros(len(self.chains), dtype=bool)
        for is_mirrored, wanted in product((False, True), (target.harmonics, backwards(target.harmonics))):
            # Mirroring a curve and running it backwards conjugates its harmonics.
            products = (self.harmonics if is_mirrored else np.conj(self.harmonics)) * wanted.astype(np.complex64)
            best = np.abs(np.fft.ifft(products, axis=1)).max(axis=1) * HARMONICS
            better = best > likeness
            likeness, mirrored = np.where(better, best, likeness), np.where(better, is_mirrored, mirrored)
        chosen = _mixed(self.chains, likeness, count)
        return laid_over(self.chains[chosen], mirrored[chosen], target), likeness[chosen]


def backwards(harmonics: Complex) -> Complex:
    """Harmonics of a curve that is run backwards."""
    return np.roll(harmonics[::-1], 1)


def _mixed(chains: Chains, likeness: Real, count: int) -> Whole:
    """The rows of the best, at most a quarter of one kind."""
    order = np.argsort(-likeness, kind="stable")[: 8 * count]
    kinds = np.unique(chains.bodies[order].reshape(len(order), -1), axis=0, return_inverse=True)[1].ravel()
    most = max(count // 4, count // (kinds.max() + 1) + 1)
    rank = np.zeros(len(order), dtype=int)
    for kind in range(kinds.max() + 1):
        rows = np.flatnonzero(kinds == kind)
        rank[rows] = np.arange(len(rows))
    mixed: Whole = order[rank < most][:count]
    return mixed


def laid_over(chains: Chains, mirrored: Mask, target: TargetCurve) -> Chains:
    """The chains, mirrored where asked, with rotation, scale and position such that their curves are on the target."""
    one = np.ones(len(chains), dtype=complex)
    chains = chains.placed(one, 0 * one, mirrored)
    path = closed_paths(chains)
    harmonics, norm = harmonics_of(path)
    best, factor = np.zeros(len(chains)), one.copy()
    for wanted in (target.harmonics, backwards(target.harmonics)):
        fits = np.fft.ifft(np.conj(harmonics) * wanted, axis=1) * HARMONICS
        peak = np.take_along_axis(fits, np.argmax(np.abs(fits), axis=1)[:, None], axis=1)[:, 0]
        factor, best = np.where(np.abs(peak) > best, peak, factor), np.maximum(np.abs(peak), best)
    size = np.sqrt(np.mean(np.abs(target.points - target.points.mean()) ** 2))
    factor = factor * size / norm
    middle = evenly(path, ANGLES)[0].mean(axis=1)
    return chains.placed(factor, target.points.mean() - factor * middle, np.zeros(len(chains), dtype=bool))


def closed_paths(chains: Chains, angles: int = ANGLES) -> Complex:
    """Traced points (s, angles + 1) over a turn, the first one again at the end."""
    cranks = np.broadcast_to(2 * np.pi * np.arange(angles + 1) / angles, (len(chains), angles + 1))
    return traced(chains, cranks, derivatives=False).point


@cache
def curve_library(bars: int) -> CurveLibrary:
    """The library of all kinds with so many bars; it is made on first use, in about two seconds, and kept."""
    rng, chains, harmonics, count = np.random.default_rng(bars // 2 - 1), [], [], 0
    while count < STORED[bars]:
        drawn = random_chains(bars, rng, AT_ONCE)
        of_them = harmonics_of(closed_paths(drawn))[0]
        good = np.flatnonzero(np.isfinite(of_them).all(axis=1))
        chains.append(drawn[good])
        harmonics.append(of_them[good].astype(np.complex64))
        count += len(good)
    return CurveLibrary(joined(chains), np.concatenate(harmonics))
