"""Search for linkages through three poses, and the regions of pins for which a four-bar need not change its branch."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import between, checked
from ...core.errors import DesignError, shown
from ...core.fields import FARTHEST
from ...core.processes import Watch
from ...core.records import record
from ...linkage.instant.centres import InstantCentre
from ...plane.curve import AbstractCurve
from ...plane.flatten import flatten
from ...plane.primitives import Circle, Polyline, Segment
from ...plane.vec import Complex, Mask, Real, cross, dot, unit
from .guides import AbstractGuides, guides_of, usable
from .poses import Poses, distinct_poses, image_poles

# Random pins per round, pairs of those that stay in the region, and largest number of rounds until some have no
# defects. With fewer in all rounds, a problem with one good pair in ten thousand may find none.
PINS, PAIRS, ROUNDS = 8000, 8000, 30
# Improved pairs, children of each per generation, and generations. With fewer the best angle is missed by more than
# half a degree; with five times as many children it rises by 0.05 deg in half of all problems.
STARTS, CHILDREN, GENERATIONS = 24, 32, 80
# Number of pairs that are improved up to the last generation; the others stop one after the other, the worst first.
FINALISTS = 4
# Factors of the spread of children after an improvement and after none. Faster changes stop early, slower ones do not
# converge.
WIDER, NARROWER = 1.5, 0.83
# First and least spread of children, as shares of the region's size.
SPREAD, FINEST = 0.05, 1e-6
# Decimals of a score, rad; further ones differ between processors.
DECIMALS = 9
# Rotation, rad, below which poses are parallel, and relative tolerance of a point on a circle. Larger values hide real
# differences; smaller ones show rounding.
PARALLEL, ROUND = 1e-12, 1e-9
# Least difference of listed linkages, as a share of the region's size.
DISTINCT = 0.04
# Number of listed linkages with defects.
DEFECTIVE = 5


@record(eq=False)
class Displacements:
    """Poses of a body as maps p + s z of its points, given by their positions z at the first pose."""

    origins: Complex
    directions: Complex

    @cached_property
    def turns(self) -> Complex:
        """s, (poses,)."""
        turns: Complex = self.directions * np.conj(self.directions[0])
        return turns

    @cached_property
    def shifts(self) -> Complex:
        """p, (poses,), relative to the first origin."""
        shifts: Complex = self.origins - self.origins[0]
        return shifts

    @cached_property
    def translated(self) -> bool:
        """Whether all poses are parallel, so that all points of the body move alike."""
        return bool(np.abs(self.turns - 1).max() <= PARALLEL)

    def pins(self, z: Complex) -> Complex:
        """Positions, (poses, points), of points that are at z at the first pose."""
        places: Complex = self.origins[:, None] + self.turns[:, None] * (z - self.origins[0])
        return places

    def pins_of(self, own: Complex) -> Complex:
        """Positions of the body's own points at the first pose."""
        places: Complex = self.origins[0] + self.directions[0] * own
        return places

    @staticmethod
    def centre(pins: Complex) -> Complex:
        """Centre of the circle through all positions; infinite if there is no such circle."""
        a, b = pins[1] - pins[0], pins[2] - pins[0]
        with np.errstate(all="ignore"):
            centres: Complex = pins[0] + 0.5j * (a * np.abs(b) ** 2 - b * np.abs(a) ** 2) / cross(a, b)
            if len(pins) == 3:
                return centres
            radii = np.abs(pins - centres)
            return np.where(np.ptp(radii, axis=0) <= ROUND * radii[0], centres, np.inf)

    def at_first(self, pivots: Complex) -> Complex:
        """Positions at the first of three poses of points that move about pivots; the inverse of `centre`."""
        seen = self.origins[0] + np.conj(self.turns)[:, None] * (pivots - self.origins[:, None])
        return self.centre(seen)

    @cached_property
    def _sliders(self) -> tuple[float, complex, float]:
        """The circle of sliders, a |z|^2 + 2 Re(conj(b) z) + c = 0 from the first origin; a line if a = 0."""
        s, p = self.turns[1:] - 1, self.shifts[1:]
        a, c = float((np.conj(s[0]) * s[1]).imag), float((np.conj(p[0]) * p[1]).imag)
        return a, complex(0.5j * (p[0] * np.conj(s[1]) - p[1] * np.conj(s[0]))), c

    def onto_sliders(self, z: Complex) -> Complex:
        """Points near z at the first of three poses whose positions are collinear; nan if there is none.

        They are found along the gradient of the circle's equation, so that a line needs no special case. Derived here.
        """
        a, b, c = self._sliders
        z = z - self.origins[0]
        gradient = a * z + b
        square = np.abs(gradient) ** 2
        value = a * np.abs(z) ** 2 + 2 * (np.conj(b) * z).real + c
        with np.errstate(all="ignore"):
            # Always real, since the circle exists: it passes through the image poles.
            root = np.sqrt(np.maximum((abs(b) ** 2 - a * c) / square, 0.0))
            found = z - gradient * value / (square * (1 + root))
        level = max(float(np.abs(np.prod(self.shifts[1:]))), np.finfo(float).tiny)
        # If all poses are parallel, either all points slide or none.
        still = np.where(abs(value) <= 1e-12 * level, z, np.nan) if self.translated else found
        return np.asarray(still + self.origins[0])

    def crank(self, z: Complex) -> tuple[Complex, Complex]:
        """Dyads of points at z at the first of three poses: positions of the pin, and pivots."""
        pins = self.pins(z)
        return pins, self.centre(pins)

    def slide(self, z: Complex) -> tuple[Complex, Complex]:
        """Dyads of sliding points near z: positions of the pin, and directions."""
        pins = self.pins(self.onto_sliders(z))
        return pins, rail_of(pins)


def rail_of(pins: Complex) -> Complex:
    """Direction, to the right or up, of the line through positions, (points,), from the two farthest apart."""
    a, b, c = pins[1] - pins[0], pins[2] - pins[0], pins[2] - pins[1]
    longest = np.where(np.abs(b) > np.abs(a), b, a)
    line = unit(np.where(np.abs(c) > np.abs(longest), c, longest))
    return np.where((line.real < 0) | ((line.real == 0) & (line.imag < 0)), -line, line)


def pair_of(kind: str, slides: bool, body: Displacements, pairs: Complex) -> AbstractGuides:
    """Linkages through three poses with pins near these positions, (linkages, 2), at the first."""
    first = body.slide if kind == "elliptic-trammel" else body.crank
    second = body.crank if kind == "four-bar" else body.slide
    return guides_of(kind, slides, first(pairs[:, 0]), second(pairs[:, 1]))


@record(eq=False, kw_only=True)
class GuideSearch:
    """A search through three poses in the box from `low` to `high`, with the least angle in rad."""

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
        """Least transmission angle, rad; -inf for linkages that are not acceptable."""
        fits = self.fits(guides) & guides.defects.none
        # Rounded, since many linkages may have equal angles, for instance if the body's rotation alone sets them.
        angle = np.round(np.where(fits, guides.angle, -np.inf), DECIMALS)
        return np.where(angle >= self.least_angle, angle, -np.inf)

    def fits(self, guides: AbstractGuides) -> Mask:
        """Whether linkages are in the region and within the ratio of links, whatever their defects."""
        return usable(guides, self.low, self.high) & (guides.ratio <= self.largest_ratio)

    def made(self, pairs: Complex) -> AbstractGuides:
        """Linkages of pairs of pins, (linkages, 2)."""
        return pair_of(self.kind, self.slides, self.body, pairs)

    def run(self, rng: np.random.Generator, watch: Watch) -> tuple[Complex, Complex]:
        """Pairs of pins, (linkages, 2): those without defects, the best first, and some with defects."""
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
            # One round suffices if it gives enough starts.
            if len(sound) >= 4 * STARTS or watch.over():
                break
        order = np.argsort(-scores, kind="stable")
        starts = sound[order][self.distinct(sound[order], STARTS)]
        if len(starts):
            starts = self._improved(starts, rng, watch)
        watch.report(1.0)
        return starts, bad[self.distinct(bad, DEFECTIVE)]

    def _pairs(self, rng: np.random.Generator) -> Complex:
        """Random pairs of pins that, like their pivots, stay in the region."""
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
        """Indices of at most `most` distinct pairs, earlier pairs first."""
        return distinct(pairs, most, DISTINCT * self.size)

    def _improved(self, pairs: Complex, rng: np.random.Generator, watch: Watch) -> Complex:
        """Each pair improved by random children, the best first."""

        def score(tried: Complex) -> Real:
            with np.errstate(all="ignore"):
                return self.score(self.made(tried))

        return climbed(pairs, score, SPREAD * self.size, rng, watch)


def climbed(
    pairs: Complex, score: Callable[[Complex], Real], spread: float, rng: np.random.Generator, watch: Watch
) -> Complex:
    """Pairs of pins, (n, 2), each moved to a local maximum of its score by random children, the best first."""
    pairs, best, wide = pairs.copy(), score(pairs), np.full(len(pairs), spread)
    for generation in range(GENERATIONS):
        if watch.over():
            break
        share = generation / GENERATIONS
        watch.report(0.5 + 0.5 * share)
        parents = np.argsort(-best, kind="stable")[: max(FINALISTS, round(len(pairs) * (1 - share) ** 2))]
        shape = (len(parents), CHILDREN, 2)
        moves = (rng.normal(size=shape) + 1j * rng.normal(size=shape)) * wide[parents, None, None]
        # Half of them move a single pin.
        moves[:, ::4, 0] = moves[:, 1::4, 1] = 0
        children = pairs[parents, None] + moves
        scores = score(children.reshape(-1, 2)).reshape(shape[:2])
        k, top = scores.argmax(axis=1), scores.max(axis=1)
        better = top > best[parents]
        pairs[parents[better]], best[parents[better]] = children[better, k[better]], top[better]
        wide[parents] *= np.where(better, WIDER, NARROWER)
        wide = np.clip(wide, FINEST / SPREAD * spread, spread)
    return pairs[np.argsort(-best, kind="stable")]


def distinct(pairs: Complex, most: int, apart: float) -> list[int]:
    """Indices of at most `most` pairs, in order, that differ by more than `apart` from all earlier ones chosen."""
    chosen: list[int] = []
    remaining = np.arange(len(pairs))
    while len(remaining) and len(chosen) < most:
        chosen.append(int(remaining[0]))
        remaining = remaining[np.abs(pairs[remaining] - pairs[remaining[0]]).max(axis=1) > apart]
    return chosen


# Sine of the angle between the ends of three positions, seen from the middle one, below which they are collinear.
STRAIGHT = 1e-9
# Largest distance of a circle's chords from it in a drawn region, as a share of the box; more shows corners.
NEAR = 5e-4


@record(eq=False, kw_only=True)
class Rectification:
    """Regions of the pins of a four-bar, with the body at the first of three poses, mm on the ground.

    Parameters
    ----------
    image_poles : tuple of three InstantCentre
        The image poles; at infinity if two poses are parallel.
    circles : tuple of AbstractCurve
        Circles with the sides of the triangle of image poles as diameters, to draw. A side that runs to infinity gives
        a line, a side at infinity nothing. A driven pin inside an odd number of them has no driver; see `drivable`.
    driven : complex or None
        Pin of the driven link, if given.
    lines : tuple of AbstractCurve
        Lines through it along the driven link at the three poses, as seen from the body. The driving pin must be on the
        same side of all three, each oriented as the link; see `drives`.
    directions : array of complex, shape (3,)
        Directions of these lines.
    """

    image_poles: tuple[InstantCentre, InstantCentre, InstantCentre]
    circles: tuple[AbstractCurve, ...]
    driven: complex | None
    lines: tuple[AbstractCurve, ...]
    directions: Complex

    @checked
    def drivable(self, points: complex | ArrayLike) -> Mask:
        """Whether a driven link at each point has some driver with which the branch need not change.

        Parameters
        ----------
        points : array_like of complex
            Driven pins at the first pose, mm.

        Returns
        -------
        array of bool
            By Waldron's circles; poles at infinity need no special case, since only the sign of a product counts.
        """
        z = np.asarray(points, dtype=complex)
        a, b, c = (pole.arm + pole.weight * (pole.reference - z) for pole in self.image_poles)
        return np.asarray(np.sign(dot(a, b)) * np.sign(dot(b, c)) * np.sign(dot(c, a)) > 0)

    @checked
    def drives(self, points: complex | ArrayLike) -> Mask:
        """Whether a driving link at each point moves the driven one on one branch (Filemon's region).

        Parameters
        ----------
        points : array_like of complex
            Driving pins at the first pose, mm.

        Returns
        -------
        array of bool
            Other defects, of circuit or order, are not covered.

        Raises
        ------
        DesignError
            If no driven pin was given.
        """
        if self.driven is None:
            raise DesignError(
                "driven", "is missing", "give the driven link's pin when the regions are made", "missing-key"
            )
        side = cross(self.driven - np.asarray(points, dtype=complex)[..., None], self.directions)
        return np.asarray((side > 0).all(axis=-1) | (side < 0).all(axis=-1))

    @checked
    def no_driven(self, low: complex, high: complex) -> tuple[AbstractCurve, ...]:
        """Outlines of the region without `drivable` points, to draw.

        Parameters
        ----------
        low, high : complex
            Opposite corners of the box that is covered, mm.

        Returns
        -------
        tuple of AbstractCurve
            Closed curves; a point is in the region if an odd number of them surround it. Circles are drawn by chords
            with an error of at most a thousandth of the box.
        """
        return self._outlines(self.circles, low, high, lambda points: ~self.drivable(points))

    @checked
    def no_driver(self, low: complex, high: complex) -> tuple[AbstractCurve, ...]:
        """Outlines of the region in which a pin does not drive the driven one: all but two opposite wedges, or all.

        Parameters
        ----------
        low, high : complex
            Opposite corners of the box that is covered, mm.

        Returns
        -------
        tuple of AbstractCurve
            Closed curves, as for `no_driven`.
        """
        return self._outlines(self.lines, low, high, lambda points: ~self.drives(points))

    def _outlines(
        self, borders: Iterable[AbstractCurve], low: complex, high: complex, holds: Callable[[Complex], Mask]
    ) -> tuple[AbstractCurve, ...]:
        from ...plane.region import where  # loads shapely, which only a drawing needs

        diagonal, centre = high - low, (low + high) / 2
        if not diagonal.real or not diagonal.imag:
            raise DesignError(
                "high", f"found {shown(high)}, on a line with {shown(low)}", "give the opposite corner", "conflict"
            )
        box = low + np.array([0, diagonal.real, diagonal, 1j * diagonal.imag])
        lines = []
        for border in borders:
            if isinstance(border, Segment):
                # Long enough to cross the box.
                direction = unit(np.array(border.end - border.start))
                foot = centre - 1j * direction * np.imag((centre - border.start) / direction)
                lines.append(foot + abs(diagonal) * direction * np.array([-1, 1]))
            else:
                points = flatten(border, NEAR * abs(diagonal))
                lines.append(np.append(points, points[:1]))
        return tuple(Polyline(loop) for loops in where(box, lines, holds) for loop in loops)


@checked
def rectification(
    poses: Poses, driven: complex | None = None, reach: Annotated[float, between(0, FARTHEST, "mm")] | None = None
) -> Rectification:
    """Find the regions of the pins of a four-bar, or of the crank pin of a slider-crank, for three poses.

    Parameters
    ----------
    poses : sequence of (complex, float)
        Three poses, each an origin x + yj in mm and an angle in rad.
    driven : complex, optional
        Driven pin with the body at the first pose, mm on the ground. A pin that can slide along a line is taken as a
        slider's.
    reach : float, optional
        Half the length of drawn lines, mm.

    Returns
    -------
    Rectification
        The regions.

    Raises
    ------
    DesignError
        For other than three poses.

    Notes
    -----
    Filemon, Useful ranges of centerpoint curves, Mechanism and Machine Theory 7, 1972; Waldron, Elimination of the
    branch problem in graphical Burmester mechanism synthesis, Journal of Engineering for Industry 98, 1976.
    """
    origins, directions = distinct_poses(poses, 3, 3)
    images = tuple(image_poles(poses).values())
    size = np.abs(origins - origins.mean()).max()
    places = np.array([complex(image.position) for image in images])
    finite = places[np.isfinite(places)]
    if reach is None:
        reach = 2 * float(max(size, np.abs(finite - finite.mean()).max() if len(finite) else 0.0)) or 1.0
    sides = [(images[0], images[1]), (images[1], images[2]), (images[2], images[0])]
    circles = [circle for side in sides if (circle := _circle_over(*side, reach)) is not None]
    link_directions, lines = np.zeros(3, dtype=complex), []
    if driven is not None:
        link_directions = _driven_directions(Displacements(origins, directions), driven)
        lines = [Segment(driven - reach * along, driven + reach * along) for along in link_directions.tolist()]
    return Rectification(
        image_poles=(images[0], images[1], images[2]),
        circles=tuple(circles),
        driven=driven,
        lines=tuple(lines),
        directions=link_directions,
    )


def _circle_over(one: InstantCentre, other: InstantCentre, reach: float) -> AbstractCurve | None:
    """The circle whose diameter is the side between two image poles; a line if one of them is at infinity."""
    start, end = complex(one.position), complex(other.position)
    if np.isfinite(start) and np.isfinite(end):
        return Circle((start + end) / 2, abs(end - start) / 2) if start != end else None
    if not np.isfinite(start) and not np.isfinite(end):
        return None
    finite, far = (start, other) if np.isfinite(start) else (end, one)
    across = 1j * complex(far.direction)
    return Segment(finite - reach * across, finite + reach * across)


def _driven_directions(body: Displacements, driven: complex) -> Complex:
    """Directions of the driven link from pivot to pin at three poses, seen from the body; of a slider its normal."""
    pins = body.pins(np.array([driven]))
    a, b = pins[1] - pins[0], pins[2] - pins[0]
    straight = np.abs(cross(a, b)) <= STRAIGHT * np.maximum(np.abs(a), np.abs(b)) ** 2
    arms = 1j * rail_of(pins) * np.ones(3) if straight[0] else (pins - body.centre(pins))[:, 0]
    return unit(arms * np.conj(body.turns))
