"""Dyads of linkages through three and more poses, their pairs, and the groups of linkages that are ranked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from ...core.errors import DesignError, with_article
from ...core.processes import Watch
from ...core.records import record
from ...plane.vec import Complex, Real, Whole
from .dyads import Dyads, dyads_through
from .guide_search import DEFECTIVE, DISTINCT, Displacements, GuideSearch, distinct, pair_of
from .guides import AbstractGuides, guides_of, usable
from .poses import Poses

# Number of dyads along the curves of four poses, of those that are all paired with each other, and of neighbours of a
# good pair that are tried too. With fewer a narrow range of good pairs is missed; more take seconds.
ALONG, PAIRED, NEAREST_PINS = 4000, 300, 40
# Number of good pairs that are improved.
STARTS = 24


@record(eq=False, kw_only=True)
class HeldPins:
    """Dyads with a pin on the body: its positions, (poses, dyads), pivots, and directions of slides, (dyads,).

    Each is a crank with a pivot, or a slide, whose pivot is not finite.
    """

    pins: Complex
    pivots: Complex
    rails: Complex

    @property
    def cranks(self) -> Whole:
        """Indices of the cranks."""
        return np.flatnonzero(np.isfinite(self.pivots))

    @property
    def slides(self) -> Whole:
        """Indices of the slides."""
        return np.flatnonzero(~np.isfinite(self.pivots))

    def paired(self, kind: str, slides: bool, one: Whole, other: Whole) -> AbstractGuides:
        """Linkages of pairs of dyads; `slides` is true if a slide drives."""
        held = np.where(np.isfinite(self.pivots), self.pivots, self.rails)
        return guides_of(kind, slides, (self.pins[:, one], held[one]), (self.pins[:, other], held[other]))

    def each(self, kind: str) -> tuple[Whole, Whole]:
        """Indices of both dyads of every linkage of a kind, the driving one of a four-bar first."""
        first = self.slides if kind == "elliptic-trammel" else self.cranks
        second = self.cranks if kind == "four-bar" else self.slides
        one, other = (k.ravel() for k in np.meshgrid(first, second, indexing="ij"))
        return one[one != other], other[one != other]


def held_pins(body: Displacements, dyads: Dyads, most: int | None = None) -> HeldPins:
    """Dyads with a pin on the body, at most `most` of each type; a line of the body over a pivot has none."""
    pinned, far = np.isfinite(dyads.moving), ~np.isfinite(dyads.fixed)
    chosen = np.concatenate([np.flatnonzero(pinned & sort)[:most] for sort in (~far, far)])
    pins = body.pins(body.pins_of(dyads.moving[chosen]))
    return HeldPins(pins=pins, pivots=dyads.fixed[chosen], rails=dyads.fixed_direction[chosen])


def inside_box(held: HeldPins, low: complex, high: complex) -> HeldPins:
    """Dyads whose pins, at every pose, and pivots are inside a box."""
    middle, box = 0.5 * (low + high), high - low
    pivots = np.where(np.isfinite(held.pivots), held.pivots, middle)
    off = np.concatenate([held.pins, pivots[None]]) - middle
    is_inside = ((np.abs(off.real) <= 0.5 * box.real) & (np.abs(off.imag) <= 0.5 * box.imag)).all(axis=0)
    return HeldPins(pins=held.pins[:, is_inside], pivots=held.pivots[is_inside], rails=held.rails[is_inside])


def best_pairs(
    search: GuideSearch, held: HeldPins, most: int, rng: np.random.Generator, watch: Watch
) -> AbstractGuides:
    """The best linkages of dyads along the curves of four poses, and some with defects."""
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
    results: list[tuple[float, int, int]] = []
    for at in starts.tolist():
        if results and watch.over():
            break
        ones, others = _near(held, one[at]), _near(held, other[at])
        pairs = [k.ravel() for k in np.meshgrid(ones, others, indexing="ij")]
        scores = _scored(search, held, *pairs)
        best = int(scores.argmax())
        results.append((-float(scores[best]), int(pairs[0][best]), int(pairs[1][best])))
    results.sort()
    firsts, seconds = (np.array([row[k] for row in results], dtype=int) for k in (1, 2))
    chosen = distinct(_at_first(held, firsts, seconds), most, DISTINCT * search.size)
    guides = held.paired(search.kind, search.slides, one[bad], other[bad])
    with np.errstate(all="ignore"):
        wrong = bad[search.fits(guides) & ~guides.defects.none][:DEFECTIVE]
    return held.paired(
        search.kind,
        search.slides,
        np.concatenate([firsts[chosen], one[wrong]]),
        np.concatenate([seconds[chosen], other[wrong]]),
    )


def _scored(search: GuideSearch, held: HeldPins, one: Whole, other: Whole) -> Real:
    with np.errstate(all="ignore"):
        return search.score(held.paired(search.kind, search.slides, one, other))


def _at_first(held: HeldPins, one: Whole, other: Whole) -> Complex:
    return np.stack([held.pins[0, one], held.pins[0, other]], axis=1)


def _near(held: HeldPins, k: int) -> Whole:
    """Indices of the dyads of the same type whose pins are nearest to the k-th's, itself included."""
    alike = held.cranks if np.isfinite(held.pivots[k]) else held.slides
    return alike[np.argsort(np.abs(held.pins[0, alike] - held.pins[0, k]), kind="stable")[:NEAREST_PINS]]


Kind = Literal["four-bar"] | Literal["crank-slider"] | Literal["slider-crank"] | Literal["elliptic-trammel"]
# Linkages listed by a search over infinitely many; further ones are similar.
LISTED = 12
# Default limit of the longest link over the shortest in a search. Without it the optimum may have pins that nearly
# coincide.
LARGEST_RATIO = 10.0
# Half the side of the region, in extents of the poses' origins and near poles; the next one if all have defects.
ROOMS = 1.0, 3.0, 9.0
# Number of successively larger regions, by a factor of three, in which an error message looks for solutions.
LARGER = 6
# Distance from the middle, in extents, within which a pole counts; a far pole would make the region too large.
NEAR = 3.0
# Number of dyads of each type that are paired for least-squares fits, the best first.
NEAREST = 8
KINDS: tuple[Kind, ...] = tuple(get_args(literal)[0] for literal in get_args(Kind))


@record(eq=False, kw_only=True)
class GuideRequest:
    """The arguments of a search."""

    body: Displacements
    kinds: Sequence[Kind]
    shuttle: bool
    region: tuple[complex, complex] | None
    # Whether either of two given points may drive, not only the first.
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
                raise DesignError(
                    "region", f"found corners {low:g} and {high:g}", "give the lower left one first", "out-of-range"
                )
            return low, high
        origins, directions = self.body.origins, self.body.directions
        middle = origins.mean()
        extent = float(np.abs(origins - middle).max())
        if extent == 0:
            raise DesignError(
                "poses", "all have the same origin, which determines no region", "give the region", "missing-key"
            )
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
        """Corners of regions larger than those tried, in short numbers."""
        low, high = self.room
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        tried = ROOMS[-1] if self.region is None else 1.0
        for room in (tried * 3.0**k for k in range(1, LARGER + 1)):
            unit = 10.0 ** np.floor(np.log10(room * min(half.real, half.imag)) - 1)
            ends = [middle - room * half, middle + room * half]
            low, high = (complex(f(z.real / unit), f(z.imag / unit)) * unit for f, z in zip((np.floor, np.ceil), ends))
            yield low, high

    def search(self, kind: Kind, room: float) -> GuideSearch:
        """The search through three poses in the region scaled by `room`."""
        low, high = self.room
        middle, half = 0.5 * (low + high), 0.5 * room * (high - low)
        low, high = middle - half, middle + half
        ratio = LARGEST_RATIO if self.largest_ratio is None else self.largest_ratio
        return GuideSearch(
            kind=kind,
            slides=self.slides(kind),
            body=self.body,
            low=low,
            high=high,
            least_angle=self.least_angle,
            largest_ratio=ratio,
        )


# Linkages of one kind.
Group = tuple[Kind, AbstractGuides]


def guided_linkages(request: GuideRequest) -> list[Group]:
    """Linkages through three poses with pins anywhere in the region."""
    groups: list[Group] = []
    for kind in request.kinds:
        # A default region may be too small.
        for room in ROOMS if request.region is None else ROOMS[:1]:
            search = request.search(kind, room)
            sound, bad = search.run(request.rng, request.watch)
            if len(sound) or request.watch.over():
                break
        sound = sound[search.distinct(sound, LISTED)]
        groups.append((kind, search.made(np.concatenate([sound, bad]))))
    return groups


def of_chosen(
    request: GuideRequest, moving: tuple[complex, complex] | None, fixed: tuple[complex, complex] | None
) -> list[Group]:
    """Linkages with the two given points, the first driving, or either of them."""
    body, kind = request.body, request.kinds[0]
    if moving is not None and fixed is not None:
        raise DesignError("fixed_points", "are given together with moving_points", "give only one of them", "conflict")
    if fixed is not None and kind != "four-bar":
        problem = f"are given for {with_article(kind)}, which does not have two"
        raise DesignError("fixed_points", problem, "give moving_points", "conflict")
    if len(body.origins) > 3:
        poses = list(zip(body.origins.tolist(), np.angle(body.directions).tolist()))
        pins, pivots = (None if points is None else np.array(points) for points in (moving, fixed))
        return of_dyads(request, dyads_through(poses, fixed=pivots, moving=pins), chosen=True)
    z = body.at_first(np.array(fixed)) if fixed is not None else body.pins_of(np.array(moving))
    if not np.isfinite(z).all():
        raise DesignError("fixed_points", "the positions of one are collinear as seen from the body", "give another")
    # The second pin of a slider-crank is that of the slider, whether it drives or not.
    first = z[::-1] if kind == "slider-crank" else z
    orders = [first, first[::-1]] if request.either else [first]
    return [(kind, pair_of(kind, request.slides(kind), body, np.array(orders)))]


def along_curves(request: GuideRequest, poses: Poses) -> list[Group]:
    """Linkages through four poses: pairs of dyads along the Burmester curves."""
    groups: list[Group] = []
    dyads = held_pins(request.body, dyads_through(poses, count=ALONG))
    for room in ROOMS if request.region is None else ROOMS[:1]:
        searches = [request.search(kind, room) for kind in request.kinds]
        held = inside_box(dyads, searches[0].low, searches[0].high)
        groups = [(s.kind, best_pairs(s, held, LISTED, request.rng, request.watch)) for s in searches]  # type: ignore[misc]
        if any(guides.defects.none.any() for _, guides in groups) or request.watch.over():
            break
    return groups


def of_dyads(request: GuideRequest, dyads: Dyads, chosen: bool = False) -> list[Group]:
    """Every pair of dyads with pins on the body, as linkages of the possible kinds.

    If `chosen`, the dyads are two given ones, and the first drives unless either may.
    """
    held = held_pins(request.body, dyads, None if len(request.body.origins) <= 5 else NEAREST)
    groups: list[Group] = []
    for kind in request.kinds:
        one, other = held.each(kind)
        if chosen and not request.either:
            driving = other if kind == "slider-crank" else one
            kept = (held.pins[:, driving] == request.body.pins(request.body.pins_of(dyads.moving[:1]))).all(axis=0)
            one, other = one[kept], other[kept]
        if request.region is not None:
            inside = usable(held.paired(kind, request.slides(kind), one, other), *request.room)
            one, other = one[inside], other[inside]
        groups.append((kind, held.paired(kind, request.slides(kind), one, other)))
    return groups
