"""Linkages that carry a body through poses: four-bars, slider-cranks, elliptic trammels, ranked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal, get_args

import numpy as np

from ..arguments import Sort, between, checked, is_complex, whole_between
from ..brief import one_line
from ..errors import DesignError
from ..linkage.linkage import AbstractLinkage
from ..linkage.solve.move import move
from ..plane.vec import Complex, Mask, Real, Whole, rounded
from ..progress import Watch
from .dyads import Dyads, dyads_through
from .found import Found
from .guide_dyads import ALONG, best_pairs, held_pins, those_inside
from .guide_search import Displacements, Search, pair_of
from .guides import AbstractGuides, usable
from .poses import Poses, placed

Kind = Literal["four-bar"] | Literal["crank-slider"] | Literal["slider-crank"] | Literal["elliptic-trammel"]
# Linkages that are listed of a search without end: more are like those before.
LISTED = 12
# The longest link over the shortest, where a search may choose: more are hard to build. The library's own, as the
# optimum of a search without such a limit may run to pins that all but meet.
LARGEST_RATIO = 10.0
# Half of the side of the region, in extents of the poses' origins and near poles; the next if nothing sound is found.
ROOMS = 1.0, 3.0, 9.0
# Extents from their middle within which a pole is near. Larger, and one far pole makes a region of little else.
NEAR = 3.0
# Dyads of each sort that are paired where poses are met by least squares alone: the nearest. There is no end of others.
NEAREST = 8
# Share of the poses' size that an exact linkage misses them by, at most: rounding of dyads that lie close together.
EXACT = 1e-8
# Share of the longest link that a link has at least: less is rounding of two pins at one place.
LEAST_LINK = 1e-9
# Decimals of a degree to which transmission angles count as the same. Fewer, and a better one may come second.
ALIKE = 2
KINDS: tuple[Kind, ...] = tuple(get_args(one)[0] for one in get_args(Kind))

Pair = Annotated[
    tuple[complex, complex],
    Sort(
        lambda value: isinstance(value, (tuple, list)) and len(value) == 2 and all(is_complex(z) for z in value),
        "two places x + yj, mm",
    ),
]


@dataclass(frozen=True, eq=False, kw_only=True)
class BodyGuide(Found):
    """A linkage whose coupler carries a body through poses.

    Its coupler point (a trammel's rod point) is the body's origin, and body_angle_deg the body's angle in the
    coupler's frame. kind: by what drives: of a "crank-slider" the crank, of a "slider-crank" the slider. pose_error:
    the farthest that the body's origin is from where it is wanted, mm, and angle_error_deg the most that its angle is
    off, when the linkage is moved to `drive`. cut_short: whether the search was stopped by its time.
    """

    kind: str
    body_angle_deg: float
    pose_error: float
    angle_error_deg: float
    cut_short: bool = False

    __repr__ = one_line

    def summary(self) -> Mapping[str, object]:
        error = {"pose_error_mm": self.pose_error, "angle_error_deg": self.angle_error_deg}
        # Of exact poses nothing is left but rounding, of which no two processors have the same.
        told = {name: float(f"{rounded(value, 9):.6g}") for name, value in error.items()}
        return told | {"body_angle_deg": float(f"{self.body_angle_deg:.10g}")} | dict(super().summary())


@checked
def body_guides(
    poses: Poses,
    kind: Kind | None = None,
    moving_points: Pair | None = None,
    fixed_points: Pair | None = None,
    region: Pair | None = None,
    trammel_driver: Literal["shuttle", "rod"] = "shuttle",
    least_transmission_angle_deg: Annotated[float, between(0, 89, "deg")] = 0.0,
    largest_ratio: Annotated[float, between(1, 1e9)] | None = None,
    seed: Annotated[int, whole_between(0, 2**32 - 1)] = 0,
    seconds: Annotated[float, between(0, 3600, "s")] = 10.0,
) -> tuple[BodyGuide, ...]:
    """Linkages that carry a body through poses, three or more: those without defects first, the best angle first.

    poses: (origin x + yj in mm, angle in rad) each, to be passed in this order. kind: a "crank-slider" is a
    slider-crank that its crank drives, a "slider-crank" one that its slider drives; an "elliptic-trammel" is driven by
    `trammel_driver`. Where it is left out, a four-bar through three poses, and through more whatever their dyads make.

    Three poses: many linkages. moving_points: the body's two points, in its own frame, the driving link's and the
    driven one's; for a slide the nearest point that slides is taken. fixed_points: ground pivots of a four-bar instead.
    What is chosen so is listed whatever its defects, with either link driving. Else pins are searched for in a region,
    corners (low, high), that holds all joints at all poses; left out, it is taken about the origins and near poles.
    Four: pairs of dyads along the Burmester curves, in the region. Five: pairs of all dyads there are. More: pairs of
    dyads that come near the poses in the sense of least squares, `pose_error` being what is missed.
    least_transmission_angle_deg, and largest_ratio of the longest link to the shortest (10 in a search, where none is
    given), leave others out. Linkages with defects, by name, come after those without.
    DesignError for fewer poses and equal ones, and where there is no such linkage.

    McCarthy and Soh, Geometric Design of Linkages, 2010, chapters 5 and 6; the search and the verdict on defects are
    derived here. Transmission angles are the least on the way from the first pose to the last.
    """
    origins, directions = placed(poses, 3)
    watch = Watch(seconds, "looking for linkages through the poses")
    body = Displacements(origins, directions)
    chosen = moving_points is not None or fixed_points is not None
    free = len(origins) == 3 or body.translated
    kinds: Sequence[Kind] = (kind,) if kind else KINDS[:1] if free or chosen else KINDS
    ask = _Asked(
        body=body,
        kinds=kinds,
        shuttle=trammel_driver == "shuttle",
        region=region,
        least_angle=float(np.radians(least_transmission_angle_deg)),
        largest_ratio=largest_ratio,
        rng=np.random.default_rng(seed),
        watch=watch,
    )
    if chosen:
        groups = _chosen(ask, moving_points, fixed_points)
    elif free:
        # Any point of the body will do: of many parallel poses, if their origins are on a circle, for cranks alone.
        groups = _searched(ask) if len(origins) == 3 or kinds == KINDS[:1] else []
    else:
        groups = _along_curves(ask, poses) if len(origins) == 4 else _pairs(ask, dyads_through(poses))
    return _ranked(ask, groups)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Asked:
    """What is asked of the search."""

    body: Displacements
    kinds: Sequence[Kind]
    shuttle: bool
    region: tuple[complex, complex] | None
    least_angle: float
    largest_ratio: float | None
    rng: np.random.Generator
    watch: Watch

    __repr__ = one_line

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


def _searched(ask: _Asked) -> list[Group]:
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


def _chosen(ask: _Asked, moving: tuple[complex, complex] | None, fixed: tuple[complex, complex] | None) -> list[Group]:
    """With the two points that were given, either link driving."""
    body, kind = ask.body, ask.kinds[0]
    if moving is not None and fixed is not None:
        raise DesignError("fixed_points", "are given besides moving_points", "give one of them")
    if fixed is not None and kind != "four-bar":
        raise DesignError("fixed_points", f"are given of {kind}, which has not two", "give moving_points")
    if len(body.origins) > 3:
        poses = list(zip(body.origins.tolist(), np.angle(body.directions).tolist()))
        pins, pivots = (None if points is None else np.array(points) for points in (moving, fixed))
        return _pairs(ask, dyads_through(poses, fixed=pivots, moving=pins))
    z = body.at_first(np.array(fixed)) if fixed is not None else body.pins_of(np.array(moving))
    if not np.isfinite(z).all():
        raise DesignError("fixed_points", "one is seen in one line by the body", "give another")
    # Of a slider-crank the second is the slider's; of the others either may drive.
    orders = [z] if kind in ("crank-slider", "slider-crank") else [z, z[::-1]]
    return [(kind, pair_of(kind, ask.slides(kind), body, np.array(orders)))]


def _along_curves(ask: _Asked, poses: Poses) -> list[Group]:
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


def _pairs(ask: _Asked, dyads: Dyads) -> list[Group]:
    """Every two dyads whose pins sit on the body, as linkages of the kinds that they can make."""
    held = held_pins(ask.body, dyads, None if len(ask.body.origins) <= 5 else NEAREST)
    groups: list[Group] = [(kind, held.paired(kind, ask.slides(kind), *held.each(kind))) for kind in ask.kinds]
    if ask.region is None:
        return groups
    low, high = ask.room
    kept = [(kind, guides, np.flatnonzero(usable(guides, low, high))) for kind, guides in groups]
    return [(kind, held.paired(kind, ask.slides(kind), *(n[k] for n in held.each(kind)))) for kind, _, k in kept]


def _ranked(ask: _Asked, groups: Sequence[Group]) -> tuple[BodyGuide, ...]:
    """The linkages of all groups that keep the limits, the best first."""
    ratio = np.inf if ask.largest_ratio is None else ask.largest_ratio
    found: list[BodyGuide] = []
    for kind, guides in groups:
        with np.errstate(all="ignore"):
            none, angle = guides.defects.none, guides.angle
            kept = _possible(guides) & (guides.ratio <= ratio) & ~(none & (angle < ask.least_angle))
        found += [_made(ask, kind, guides, k) for k in np.flatnonzero(kept).tolist()]
    if not found:
        raise DesignError(
            "poses",
            f"found no {' or '.join(ask.kinds)} through them that keeps the limits",
            "give a larger region, weaker limits, another kind or other poses",
        )
    size = float(np.abs(ask.body.ways).max()) or 1.0

    def rank(guide: BodyGuide) -> tuple[float, ...]:
        # What is met by least squares goes by how nearly; where many have the same angle, as that of a body that turns
        # by so much must, the most even links come first.
        missed = guide.pose_error if np.isfinite(guide.pose_error) else np.inf
        angle = np.nan_to_num(guide.transmission_angle_deg, nan=-1.0)
        return len(guide.defects) > 0, 0.0 if missed <= EXACT * size else missed, -round(angle, ALIKE), guide.ratio

    return tuple(sorted(found, key=rank))


def _possible(guides: AbstractGuides) -> Mask:
    """Which are linkages at all: finite, and no link a point."""
    sizes = np.array(guides.links)
    whole = np.isfinite(np.concatenate([guides.joints, sizes])).all(axis=0)
    told = np.isfinite(guides.defects.drive).all(axis=0)
    return np.asarray(whole & told & (sizes.min(axis=0) > LEAST_LINK * sizes.max(axis=0)))


def _made(ask: _Asked, kind: Kind, guides: AbstractGuides, k: int) -> BodyGuide:
    origins, directions = ask.body.origins, ask.body.directions
    point, angle = guides.holds(k, complex(origins[0]), complex(directions[0]))
    linkage, found = guides.linkage(k, point), guides.defects
    drive, signs = found.drive[:, k], found.sign[:, k]
    places, turns = _moved(linkage, drive, signs)
    off = np.abs(np.angle(turns * np.exp(1j * angle) * np.conj(directions)))
    return BodyGuide(
        linkage=linkage,
        branch=int(signs[0]),
        drive=drive,
        transmission_angle_deg=float(np.degrees(guides.angle[k])),
        defects=found.named(k),
        kind=kind,
        body_angle_deg=float(np.degrees(angle)),
        pose_error=float(np.abs(places - origins).max()),
        angle_error_deg=float(np.degrees(off.max())),
        cut_short=ask.watch.cut,
    )


def _moved(linkage: AbstractLinkage, drive: Real, signs: Whole) -> tuple[Complex, Complex]:
    """Places of the body's origin and directions of the coupler, when the linkage is moved there."""
    body, point = ("rod", "rod_point") if "rod" in linkage.linkage.bodies else ("coupler", "coupler_point")
    both = [move(linkage, drive, sign) for sign in (1, -1)]
    up = signs > 0
    places = [motion.point(point).position for motion in both]
    turns = [motion.bodies[body].direction for motion in both]
    return np.where(up, *places), np.where(up, *turns)
