"""Dyads that linkages through four and more poses are made of, and their pairs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from ...core.errors import DesignError
from ...core.progress import Watch
from ...core.records import record
from ...plane.vec import Complex, Real, Whole
from .dyads import Dyads, dyads_through
from .guide_search import DEFECTIVE, DISTINCT, Displacements, Search, distinct, pair_of
from .guides import AbstractGuides, guides_of, usable
from .poses import Poses

# Dyads along the curves of four poses; those that are paired each with each, and the nearest of all to each of a good
# pair that are tried besides. Fewer, and a narrow range of good pairs is missed; more take seconds.
ALONG, PAIRED, NEAREST_PINS = 4000, 300, 40
# Good pairs that are made better so.
STARTS = 24


@record(eq=False, kw_only=True)
class HeldPins:
    """Dyads with a pin on the body: its places, (poses, dyads), pivots, and directions of slides, (dyads,).

    One is either a crank, with a pivot, or a slide, whose pivot is not finite.
    """

    pins: Complex
    pivots: Complex
    rails: Complex

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
    watch.report(0.5)
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
    return alike[np.argsort(np.abs(held.pins[0, alike] - held.pins[0, k]), kind="stable")[:NEAREST_PINS]]


Kind = Literal["four-bar"] | Literal["crank-slider"] | Literal["slider-crank"] | Literal["elliptic-trammel"]
# Linkages that are listed of a search without end: more are like those before.
LISTED = 12
# The longest link over the shortest, where a search may choose: more are hard to build. The library's own, as the
# optimum of a search without such a limit may run to pins that all but meet.
LARGEST_RATIO = 10.0
# Half of the side of the region, in extents of the poses' origins and near poles; the next if nothing sound is found.
ROOMS = 1.0, 3.0, 9.0
# Regions, each three times as large as the one before, in which a refusal looks for what there would be.
LARGER = 6
# Extents from their middle within which a pole is near. Larger, and one far pole makes a region of little else.
NEAR = 3.0
# Dyads of each sort that are paired where poses are met by least squares alone: the nearest. There is no end of others.
NEAREST = 8
KINDS: tuple[Kind, ...] = tuple(get_args(one)[0] for one in get_args(Kind))


@record(eq=False, kw_only=True)
class Asked:
    """What is asked of the search."""

    body: Displacements
    kinds: Sequence[Kind]
    shuttle: bool
    region: tuple[complex, complex] | None
    # Whether either of two points that are given may drive, and not the first alone.
    either: bool
    least_angle: float
    largest_ratio: float | None
    rng: np.random.Generator
    watch: Watch

    def slides(self, kind: Kind) -> bool:
        """Whether a slide drives."""
        return kind == "slider-crank" or (kind == "elliptic-trammel" and self.shuttle)

    @cached_property
    def room(self) -> tuple[complex, complex]:
        """Corners of the region."""
        if self.region is not None:
            low, high = (complex(z) for z in self.region)
            if not (low.real < high.real and low.imag < high.imag):
                raise DesignError("region", f"found corners {low:g} and {high:g}", "give the lower left one first")
            return low, high
        origins, directions = self.body.origins, self.body.directions
        middle = origins.mean()
        extent = float(np.abs(origins - middle).max())
        if extent == 0:
            raise DesignError("poses", "all have one origin, so no region can be told", "give the region")
        places = [*origins]
        for j in range(len(origins)):
            turn = directions[j] - directions[:j]
            with np.errstate(all="ignore"):
                poles = (directions[j] * origins[:j] - directions[:j] * origins[j]) / turn
            places += [pole for pole in poles if abs(pole - middle) <= NEAR * extent]
        xs, ys = np.real(places), np.imag(places)
        centre = complex(xs.min() + xs.max(), ys.min() + ys.max()) / 2
        half = max(np.ptp(xs), np.ptp(ys))
        return centre - half * (1 + 1j), centre + half * (1 + 1j)

    @property
    def larger_regions(self) -> Iterator[tuple[complex, complex]]:
        """Corners of regions larger than those that were tried, in short numbers."""
        low, high = self.room
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        tried = ROOMS[-1] if self.region is None else 1.0
        for room in (tried * 3.0**k for k in range(1, LARGER + 1)):
            unit = 10.0 ** np.floor(np.log10(room * min(half.real, half.imag)) - 1)
            ends = [middle - room * half, middle + room * half]
            low, high = (complex(f(z.real / unit), f(z.imag / unit)) * unit for f, z in zip((np.floor, np.ceil), ends))
            yield low, high

    def search(self, kind: Kind, room: float) -> Search:
        """The search through three poses, in a region so many times as large."""
        low, high = self.room
        middle, half = 0.5 * (low + high), 0.5 * room * (high - low)
        low, high = middle - half, middle + half
        ratio = LARGEST_RATIO if self.largest_ratio is None else self.largest_ratio
        return Search(
            kind=kind,
            slides=self.slides(kind),
            body=self.body,
            low=low,
            high=high,
            least_angle=self.least_angle,
            largest_ratio=ratio,
        )


# What is ranked: linkages of one kind.
Group = tuple[Kind, AbstractGuides]


def searched(ask: Asked) -> list[Group]:
    """Through three poses, pins anywhere in the region."""
    groups: list[Group] = []
    for kind in ask.kinds:
        # A region that nobody asked for may be too small.
        for room in ROOMS if ask.region is None else ROOMS[:1]:
            search = ask.search(kind, room)
            sound, bad = search.run(ask.rng, ask.watch)
            if len(sound) or ask.watch.over():
                break
        sound = sound[search.distinct(sound, LISTED)]
        groups.append((kind, search.made(np.concatenate([sound, bad]))))
    return groups


def of_chosen(ask: Asked, moving: tuple[complex, complex] | None, fixed: tuple[complex, complex] | None) -> list[Group]:
    """With the two points that were given, the first driving, or either of them."""
    body, kind = ask.body, ask.kinds[0]
    if moving is not None and fixed is not None:
        raise DesignError("fixed_points", "are given besides moving_points", "give one of them")
    if fixed is not None and kind != "four-bar":
        raise DesignError("fixed_points", f"are given of {kind}, which has not two", "give moving_points")
    if len(body.origins) > 3:
        poses = list(zip(body.origins.tolist(), np.angle(body.directions).tolist()))
        pins, pivots = (None if points is None else np.array(points) for points in (moving, fixed))
        return of_dyads(ask, dyads_through(poses, fixed=pivots, moving=pins), chosen=True)
    z = body.at_first(np.array(fixed)) if fixed is not None else body.pins_of(np.array(moving))
    if not np.isfinite(z).all():
        raise DesignError("fixed_points", "one is seen in one line by the body", "give another")
    # A slider-crank's second pin is the slider's, whether it drives or not.
    first = z[::-1] if kind == "slider-crank" else z
    orders = [first, first[::-1]] if ask.either else [first]
    return [(kind, pair_of(kind, ask.slides(kind), body, np.array(orders)))]


def along_curves(ask: Asked, poses: Poses) -> list[Group]:
    """Through four poses: pairs of dyads along the Burmester curves."""
    groups: list[Group] = []
    dyads = held_pins(ask.body, dyads_through(poses, count=ALONG))
    for room in ROOMS if ask.region is None else ROOMS[:1]:
        searches = [ask.search(kind, room) for kind in ask.kinds]
        held = those_inside(dyads, searches[0].low, searches[0].high)
        groups = [(s.kind, best_pairs(s, held, LISTED, ask.rng, ask.watch)) for s in searches]  # type: ignore[misc]
        if any(guides.defects.none.any() for _, guides in groups) or ask.watch.over():
            break
    return groups


def of_dyads(ask: Asked, dyads: Dyads, chosen: bool = False) -> list[Group]:
    """Every two dyads whose pins sit on the body, as linkages of the kinds that they can make.

    chosen: the dyads are two that were given, and the first drives unless either may.
    """
    held = held_pins(ask.body, dyads, None if len(ask.body.origins) <= 5 else NEAREST)
    groups: list[Group] = []
    for kind in ask.kinds:
        one, other = held.each(kind)
        if chosen and not ask.either:
            driving = other if kind == "slider-crank" else one
            kept = (held.pins[:, driving] == ask.body.pins(ask.body.pins_of(dyads.moving[:1]))).all(axis=0)
            one, other = one[kept], other[kept]
        if ask.region is not None:
            inside = usable(held.paired(kind, ask.slides(kind), one, other), *ask.room)
            one, other = one[inside], other[inside]
        groups.append((kind, held.paired(kind, ask.slides(kind), one, other)))
    return groups
