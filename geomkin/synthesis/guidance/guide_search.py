"""Guides through three poses: pins anywhere in a region are tried, paired, and the best made better."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from ...core.progress import Watch
from ...core.records import record
from ...plane.vec import Complex, Mask, Real, cross, unit
from .guides import AbstractGuides, guides_of, usable

# Pins that are tried at once, pairs made of those that stay in the region, and rounds of both until some are sound.
# Fewer, and a problem of which one pair in ten thousand is sound goes without.
PINS, PAIRS, ROUNDS = 20_000, 20_000, 12
# Pairs that are made better, children of each in a generation, and generations. Fewer, and the best angle is missed by
# more than half a degree; more, and a search takes longer than anyone wants to wait.
STARTS, CHILDREN, GENERATIONS = 24, 40, 150
# How children spread out from generation to generation, after a better one and after none. Faster, and pairs stop on
# the way; slower, and they do not get there.
WIDER, NARROWER = 1.5, 0.87
# Share of the region's size that children are spread over at first, and least.
SPREAD, FINEST = 0.05, 1e-6
# Decimals of a score, rad. More, and the last bits that processors differ by decide between equals.
DECIMALS = 9
# Turn, rad, below which poses are parallel, and share of a circle's radius that a place may be off it. Larger, and
# poses or places that differ on purpose count as that; smaller, and rounding does not.
PARALLEL, ROUND = 1e-12, 1e-9
# Share of the region's size by which linkages differ that are listed both.
DISTINCT = 0.04
# Defective linkages that are listed where there are others.
DEFECTIVE = 5


@record(eq=False)
class Displacements:
    """Poses of a body by where they carry its points, which are told by their places at the first pose: p + s z."""

    origins: Complex
    directions: Complex

    @cached_property
    def turns(self) -> Complex:
        """s, (poses,)."""
        turns: Complex = self.directions * np.conj(self.directions[0])
        return turns

    @cached_property
    def ways(self) -> Complex:
        """p, (poses,), seen from the first origin."""
        ways: Complex = self.origins - self.origins[0]
        return ways

    @cached_property
    def translated(self) -> bool:
        """Whether all poses are parallel, so that all points of the body move alike."""
        return bool(np.abs(self.turns - 1).max() <= PARALLEL)

    def pins(self, z: Complex) -> Complex:
        """Places, (poses, points), of points that stand at z at the first pose."""
        places: Complex = self.origins[:, None] + self.turns[:, None] * (z - self.origins[0])
        return places

    def pins_of(self, own: Complex) -> Complex:
        """Where the body's own points stand at the first pose."""
        places: Complex = self.origins[0] + self.directions[0] * own
        return places

    @staticmethod
    def centre(pins: Complex) -> Complex:
        """Of the circle through three places; not finite where they lie in one line, or one more is not on it."""
        a, b = pins[1] - pins[0], pins[2] - pins[0]
        with np.errstate(all="ignore"):
            centres: Complex = pins[0] + 0.5j * (a * np.abs(b) ** 2 - b * np.abs(a) ** 2) / cross(a, b)
            reach = np.abs(pins - centres)
            on = (len(pins) == 3) | (np.ptp(reach, axis=0) <= ROUND * reach[0])
            return np.where(on, centres, np.inf)

    def at_first(self, pivots: Complex) -> Complex:
        """Where the points are at the first of three poses that go round fixed points: the inverse of `centre`."""
        seen = self.origins[0] + np.conj(self.turns)[:, None] * (pivots - self.origins[:, None])
        return self.centre(seen)

    @cached_property
    def _sliders(self) -> tuple[float, complex, float]:
        """The circle of sliders, a |z|^2 + 2 Re(conj(b) z) + c = 0 from the first origin; a line where a = 0."""
        s, p = self.turns[1:] - 1, self.ways[1:]
        a, c = float((np.conj(s[0]) * s[1]).imag), float((np.conj(p[0]) * p[1]).imag)
        return a, complex(0.5j * (p[0] * np.conj(s[1]) - p[1] * np.conj(s[0]))), c

    def onto_sliders(self, z: Complex) -> Complex:
        """Points at the first of three poses whose places lie in one line, each beside one of z; nan where none does.

        Along the gradient of the circle's equation, so that a line is an ordinary case. Derived here.
        """
        a, b, c = self._sliders
        z = z - self.origins[0]
        way = a * z + b
        square = np.abs(way) ** 2
        value = a * np.abs(z) ** 2 + 2 * (np.conj(b) * z).real + c
        with np.errstate(all="ignore"):
            # Real where the circle is, as it always is: it goes through the image poles.
            root = np.sqrt(np.maximum((abs(b) ** 2 - a * c) / square, 0.0))
            found = z - way * value / (square * (1 + root))
        level = max(float(np.abs(np.prod(self.ways[1:]))), np.finfo(float).tiny)
        # Poses that are all parallel: either all points slide, or none.
        still = np.where(abs(value) <= 1e-12 * level, z, np.nan) if self.translated else found
        return np.asarray(still + self.origins[0])

    def crank(self, z: Complex) -> tuple[Complex, Complex]:
        """The dyads of points that stand at z at the first of three poses: places of the pin, and pivots."""
        pins = self.pins(z)
        return pins, self.centre(pins)

    def slide(self, z: Complex) -> tuple[Complex, Complex]:
        """The same of points beside these that slide: places of the pin, and directions."""
        pins = self.pins(self.onto_sliders(z))
        return pins, rail_of(pins)


def rail_of(pins: Complex) -> Complex:
    """Direction, to the right or up, of the line that places lie on, (points,): between the two farthest apart."""
    a, b, c = pins[1] - pins[0], pins[2] - pins[0], pins[2] - pins[1]
    way = np.where(np.abs(b) > np.abs(a), b, a)
    way = unit(np.where(np.abs(c) > np.abs(way), c, way))
    return np.where((way.real < 0) | ((way.real == 0) & (way.imag < 0)), -way, way)


def pair_of(kind: str, slides: bool, body: Displacements, pairs: Complex) -> AbstractGuides:
    """Linkages through three poses with their pins beside these places, (linkages, 2), at the first."""
    first = body.slide if kind == "elliptic-trammel" else body.crank
    second = body.crank if kind == "four-bar" else body.slide
    return guides_of(kind, slides, first(pairs[:, 0]), second(pairs[:, 1]))


@record(eq=False, kw_only=True)
class Search:
    """A search through three poses. low, high: corners of the region; least_angle: rad; body: the poses."""

    kind: str
    slides: bool
    body: Displacements
    low: complex
    high: complex
    least_angle: float
    largest_ratio: float

    @property
    def size(self) -> float:
        """The region's diagonal, mm."""
        return abs(self.high - self.low)

    def score(self, guides: AbstractGuides) -> Real:
        """How good they are, rad: the least transmission angle; -inf of those that are out of question."""
        fits = self.fits(guides) & guides.defects.none
        # Where many have the same, as where a body's turn alone sets it, rounding must not choose.
        angle = np.round(np.where(fits, guides.angle, -np.inf), DECIMALS)
        return np.where(angle >= self.least_angle, angle, -np.inf)

    def fits(self, guides: AbstractGuides) -> Mask:
        """Whether they are in the region and bearable, defects or not."""
        return usable(guides, self.low, self.high) & (guides.ratio <= self.largest_ratio)

    def made(self, pairs: Complex) -> AbstractGuides:
        """Of pairs of pins, (linkages, 2)."""
        return pair_of(self.kind, self.slides, self.body, pairs)

    def run(self, rng: np.random.Generator, watch: Watch) -> tuple[Complex, Complex]:
        """Pairs of pins, (linkages, 2): the sound, the best first, and some of the defective."""
        sound, scores, bad = np.zeros((0, 2), dtype=complex), np.zeros(0), np.zeros((0, 2), dtype=complex)
        for done in range(ROUNDS):
            watch.report(0.5 * done / ROUNDS)
            pairs = self._pairs(rng)
            guides = self.made(pairs)
            with np.errstate(all="ignore"):
                score = self.score(guides)
                defective = self.fits(guides) & ~guides.defects.none
            best = np.argsort(-score, kind="stable")[:2000]
            best = best[np.isfinite(score[best])]
            sound, scores = np.concatenate([sound, pairs[best]]), np.concatenate([scores, score[best]])
            bad = np.concatenate([bad, pairs[defective][:200]])
            # A first round with enough to start from is enough; else on, for as long as it takes to find some.
            if len(sound) >= 4 * STARTS or watch.over():
                break
        order = np.argsort(-scores, kind="stable")
        starts = sound[order][self.distinct(sound[order], STARTS)]
        if len(starts):
            starts = self._bettered(starts, rng, watch)
        watch.report(1.0)
        return starts, bad[self.distinct(bad, DEFECTIVE)]

    def _pairs(self, rng: np.random.Generator) -> Complex:
        """Pairs of pins, each of which stays in the region with its pivot."""
        box = self.high - self.low
        tries = self.low + box.real * rng.random(PINS) + 1j * box.imag * rng.random(PINS)
        rails = self.body.onto_sliders(tries) if self.kind != "four-bar" else tries
        pools = []
        for slides in (self.kind == "elliptic-trammel", self.kind != "four-bar"):
            at = rails if slides else tries
            pins = self.body.pins(at)
            joints = pins if slides else np.concatenate([pins, self.body.centre(pins)[None]])
            with np.errstate(invalid="ignore"):
                off = joints - 0.5 * (self.low + self.high)
                inside = (np.abs(off.real) <= 0.5 * box.real) & (np.abs(off.imag) <= 0.5 * box.imag)
            pools.append(at[inside.all(axis=0)])
        if not all(len(pool) for pool in pools):
            return np.zeros((0, 2), dtype=complex)
        return np.stack([pool[rng.integers(len(pool), size=PAIRS)] for pool in pools], axis=1)

    def distinct(self, pairs: Complex, most: int) -> list[int]:
        """Numbers of at most so many pairs, the first first, that are not like one before."""
        return distinct(pairs, most, DISTINCT * self.size)

    def _bettered(self, pairs: Complex, rng: np.random.Generator, watch: Watch) -> Complex:
        """Each pair climbed up from: children about it, nearer ones where none is better; the best first."""

        def score(tried: Complex) -> Real:
            with np.errstate(all="ignore"):
                return self.score(self.made(tried))

        return climbed(pairs, score, SPREAD * self.size, rng, watch)


def climbed(
    pairs: Complex, score: Callable[[Complex], Real], spread: float, rng: np.random.Generator, watch: Watch
) -> Complex:
    """Pairs of pins, (n, 2), each moved to where its score is best nearby: random children, ever nearer; best first."""
    best, wide = score(pairs), np.full(len(pairs), spread)
    for generation in range(GENERATIONS):
        if watch.over():
            break
        watch.report(0.5 + 0.5 * generation / GENERATIONS)
        shape = (len(pairs), CHILDREN, 2)
        moves = (rng.normal(size=shape) + 1j * rng.normal(size=shape)) * wide[:, None, None]
        # Half of them move one pin alone.
        moves[:, ::4, 0] = moves[:, 1::4, 1] = 0
        children = pairs[:, None] + moves
        scores = score(children.reshape(-1, 2)).reshape(shape[:2])
        k = scores.argmax(axis=1)
        rows = np.arange(len(pairs))
        better = scores[rows, k] > best
        pairs = np.where(better[:, None], children[rows, k], pairs)
        best = np.where(better, scores[rows, k], best)
        wide = np.clip(np.where(better, WIDER * wide, NARROWER * wide), FINEST / SPREAD * spread, spread)
    return pairs[np.argsort(-best, kind="stable")]


def distinct(pairs: Complex, most: int, apart: float) -> list[int]:
    """Numbers of at most so many pairs, the first first, that lie that far from all before."""
    kept: list[int] = []
    left = np.arange(len(pairs))
    while len(left) and len(kept) < most:
        kept.append(int(left[0]))
        left = left[np.abs(pairs[left] - pairs[left[0]]).max(axis=1) > apart]
    return kept
