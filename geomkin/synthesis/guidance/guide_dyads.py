"""Dyads that linkages through four and more poses are made of, and their pairs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...brief import one_line
from ...plane.vec import Complex, Real, Whole
from ...progress import Watch
from .dyads import Dyads
from .guide_search import DEFECTIVE, DISTINCT, Displacements, Search, distinct
from .guides import AbstractGuides, guides_of

# Dyads along the curves of four poses; those that are paired each with each, and the nearest of all to each of a good
# pair that are tried besides. Fewer, and a narrow range of good pairs is missed; more take seconds.
ALONG, PAIRED, NEAREST = 4000, 300, 40
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


def held_pins(body: Displacements, dyads: Dyads, most: int | None = None) -> HeldPins:
    """Those dyads, the first `most` of each sort, that have a pin on the body: a line of it over a pivot has none."""
    pinned, far = np.isfinite(dyads.moving), ~np.isfinite(dyads.fixed)
    kept = np.concatenate([np.flatnonzero(pinned & sort)[:most] for sort in (~far, far)])
    pins = body.pins(body.pins_of(dyads.moving[kept]))
    return HeldPins(pins=pins, pivots=dyads.fixed[kept], rails=dyads.fixed_direction[kept])


def those_inside(held: HeldPins, low: complex, high: complex) -> HeldPins:
    """Those whose pins, at every pose, and pivots lie between two corners."""
    middle, box = 0.5 * (low + high), high - low
    pivots = np.where(np.isfinite(held.pivots), held.pivots, middle)
    off = np.concatenate([held.pins, pivots[None]]) - middle
    kept = ((np.abs(off.real) <= 0.5 * box.real) & (np.abs(off.imag) <= 0.5 * box.imag)).all(axis=0)
    return HeldPins(pins=held.pins[:, kept], pivots=held.pivots[kept], rails=held.rails[kept])


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
