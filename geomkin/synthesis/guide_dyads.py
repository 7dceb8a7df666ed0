"""Dyads that linkages through four and more poses are made of, and their pairs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..brief import one_line
from ..plane.vec import Complex, Mask, Real, Whole
from ..progress import Watch
from .constraint import Pairs, normalised, pairs_of, pairs_of_least, rows
from .dyads import Dyads
from .guide_search import DEFECTIVE, DISTINCT, Displacements, Search, distinct
from .guides import AbstractGuides, guides_of

# Fifth poses that are tried with the four, each of which gives up to four dyads of the curves; dyads that are paired
# each with each, and the nearest of all dyads to each of a good pair that are tried besides. Fewer, and a narrow range
# of good pairs is missed; more take seconds.
FIFTHS, PAIRED, NEAREST = 1500, 300, 40
# Good pairs that are made better so.
STARTS = 24


@dataclass(frozen=True, eq=False, kw_only=True)
class HeldPins:
    """Dyads with a pin on the body: its places, (poses, dyads), pivots, and directions of slides, (dyads,).

    One is either a crank, with a pivot, or a slide, whose pivot is not finite.
    """

    pins: Complex
    pivots: Complex
    rails: Complex

    __repr__ = one_line

    @property
    def cranks(self) -> Whole:
        """Numbers of those that turn."""
        return np.flatnonzero(np.isfinite(self.pivots))

    @property
    def slides(self) -> Whole:
        """Numbers of those that slide."""
        return np.flatnonzero(~np.isfinite(self.pivots))

    def paired(self, kind: str, slides: bool, one: Whole, other: Whole) -> AbstractGuides:
        """Linkages of these dyads and those; slides: whether a slide drives."""
        held = np.where(np.isfinite(self.pivots), self.pivots, self.rails)
        return guides_of(kind, slides, (self.pins[:, one], held[one]), (self.pins[:, other], held[other]))

    def each(self, kind: str) -> tuple[Whole, Whole]:
        """Numbers of the two dyads of every linkage of a kind, the driving one's of a four-bar first."""
        first = self.slides if kind == "elliptic-trammel" else self.cranks
        second = self.cranks if kind == "four-bar" else self.slides
        one, other = (k.ravel() for k in np.meshgrid(first, second, indexing="ij"))
        return one[one != other], other[one != other]


def held_pins(body: Displacements, dyads: Dyads | Pairs, most: int | None = None) -> HeldPins:
    """Those dyads, the first `most` of each sort, that have a pin on the body: a line of it over a pivot has none."""
    pinned = np.isfinite(dyads.moving) if isinstance(dyads, Dyads) else ~dyads.moving_far
    far = ~np.isfinite(dyads.fixed) if isinstance(dyads, Dyads) else dyads.fixed_far
    rails = dyads.fixed_direction if isinstance(dyads, Dyads) else dyads.fixed
    pivots = np.where(far, complex(np.inf, 0), dyads.fixed)
    kept = np.concatenate([np.flatnonzero(pinned & sort)[:most] for sort in (~far, far)])
    pins = body.pins(body.pins_of(dyads.moving[kept]))
    return HeldPins(pins=pins, pivots=pivots[kept], rails=rails[kept])


def through_four(body: Displacements, low: complex, high: complex, rng: np.random.Generator) -> HeldPins:
    """Dyads all along the curves of four poses, with pivots and pins between two corners, and the one that slides.

    Each is one of those through the four and a fifth pose, which is taken at random. Derived here.
    """
    z, u = (np.repeat(part[None], FIFTHS, axis=0) for part in (body.origins, body.directions))
    box = high - low
    fifth = low + box.real * rng.random(FIFTHS) + 1j * box.imag * rng.random(FIFTHS)
    turn = np.exp(2j * np.pi * rng.random(FIFTHS))
    found, there = pairs_of_least(np.column_stack([z, fifth]), np.column_stack([u, turn]))
    cranks = held_pins(body, _picked(found, there & ~found.fixed_far & ~found.moving_far))
    places = np.concatenate([cranks.pins, cranks.pivots[None]]) - 0.5 * (low + high)
    inside = (np.abs(places.real) <= 0.5 * box.real) & (np.abs(places.imag) <= 0.5 * box.imag)
    kept = np.flatnonzero(inside.all(axis=0))
    # A slide's pin has four places in one line: what is asked of it is linear, and leaves one.
    scaled, _, size = normalised(body.origins)
    told = np.zeros((1, 8))
    told[0, 3:] = np.linalg.svd(rows(scaled, body.directions)[:, 3:])[2][-1]
    slide, good = pairs_of(told)
    slides = held_pins(body, _picked(Pairs(slide.fixed, size * slide.moving, slide.fixed_far, slide.moving_far), good))
    return HeldPins(
        pins=np.concatenate([cranks.pins[:, kept], slides.pins], axis=1),
        pivots=np.concatenate([cranks.pivots[kept], slides.pivots]),
        rails=np.concatenate([cranks.rails[kept], slides.rails]),
    )


def _picked(pairs: Pairs, kept: Mask) -> Pairs:
    return Pairs(pairs.fixed[kept], pairs.moving[kept], pairs.fixed_far[kept], pairs.moving_far[kept])


def best_pairs(search: Search, held: HeldPins, most: int, rng: np.random.Generator, watch: Watch) -> AbstractGuides:
    """The best linkages of dyads along the curves of four poses, and some of the defective."""
    cranks, slides = held.cranks, held.slides
    few = np.concatenate([rng.permutation(cranks)[:PAIRED], slides])
    part = HeldPins(pins=held.pins[:, few], pivots=held.pivots[few], rails=held.rails[few])
    one, other = (few[k] for k in part.each(search.kind))
    score = _scored(search, held, one, other)
    order = np.argsort(-score, kind="stable")
    bad = rng.permutation(np.flatnonzero(~np.isfinite(score)))[: 20 * DEFECTIVE]
    watch.tell(0.5)
    starts = order[np.isfinite(score[order])]
    starts = starts[distinct(_at_first(held, one[starts], other[starts]), STARTS, DISTINCT * search.size)]
    found: list[tuple[float, int, int]] = []
    for at in starts.tolist():
        if found and watch.over():
            break
        ones, others = _near(held, one[at]), _near(held, other[at])
        pairs = [k.ravel() for k in np.meshgrid(ones, others, indexing="ij")]
        scores = _scored(search, held, *pairs)
        best = int(scores.argmax())
        found.append((-float(scores[best]), int(pairs[0][best]), int(pairs[1][best])))
    found.sort()
    firsts, seconds = (np.array([row[k] for row in found], dtype=int) for k in (1, 2))
    kept = distinct(_at_first(held, firsts, seconds), most, DISTINCT * search.size)
    guides = held.paired(search.kind, search.slides, one[bad], other[bad])
    with np.errstate(all="ignore"):
        wrong = bad[search.fits(guides) & ~guides.defects.none][:DEFECTIVE]
    return held.paired(
        search.kind,
        search.slides,
        np.concatenate([firsts[kept], one[wrong]]),
        np.concatenate([seconds[kept], other[wrong]]),
    )


def _scored(search: Search, held: HeldPins, one: Whole, other: Whole) -> Real:
    with np.errstate(all="ignore"):
        return search.score(held.paired(search.kind, search.slides, one, other))


def _at_first(held: HeldPins, one: Whole, other: Whole) -> Complex:
    return np.stack([held.pins[0, one], held.pins[0, other]], axis=1)


def _near(held: HeldPins, k: int) -> Whole:
    """Numbers of the dyads of the same sort whose pins are nearest to the k-th's, itself among them."""
    alike = held.cranks if np.isfinite(held.pivots[k]) else held.slides
    return alike[np.argsort(np.abs(held.pins[0, alike] - held.pins[0, k]), kind="stable")[:NEAREST]]
