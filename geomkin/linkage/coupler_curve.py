"""Paths of a body's points: one as an exact curve, many over frames, and dashed as an atlas draws them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Points, Reals, check_fields, checked
from ..brief import one_line
from ..cached import cached_property
from ..errors import DesignError, shown
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Real, Whole, cross, unit
from ..sizes import rounded_up
from .body_motion import PointMotion
from .linkage import AbstractLinkage, OneLinkage
from .measures import driver_limits
from .motion import Motion
from .solve.branch import Branch, chosen
from .solve.move import move

# Share of the tolerance that is aimed at. A chord's distance is sampled in three places, which may miss 3 % of it.
# Nearer to 1, and such a chord exceeds the tolerance; smaller takes more chords than need be.
AIM = 0.95
# From five nodes to 33 places on the quartic through them: fewer places miss more of how far a path turns back.
FINER = np.linalg.solve(np.vander(np.linspace(0, 1, 5)).T, np.vander(np.linspace(0, 1, 33), 5).T)
# Chords of a dash at most, as a power of 2. More would take a tolerance that no machine can cut for a real one.
FINEST = 12
# Points of all dashes together that are looked at, at most: what takes some seconds and half a GB. More takes minutes,
# fewer refuses tolerances that can be cut.
MOST_POINTS = 2_000_000
# Spacings of floating point that a dash ends short of a limit of the linkage: at the very limit, rounding decides
# whether it is closed. More would show as a dash that ends early.
SHORT = 8


def moved_at(linkage: AbstractLinkage, t: ArrayLike, branch: Branch, start: float) -> tuple[Motion, Whole]:
    """The motion at drives of any shape and order, and which of its frames each of them is.

    A branch that is followed is followed from `start`, whatever drives on one side of it are asked for.
    """
    drive = np.asarray(t, dtype=float)
    order = np.argsort(abs(drive - start), axis=None, kind="stable")
    frames = np.empty(drive.size, dtype=int)
    frames[order] = np.arange(1, drive.size + 1)
    return move(linkage, np.append(start, drive.ravel()[order]), branch), frames.reshape(drive.shape)


@dataclass(frozen=True, eq=False)
class CouplerCurve(AbstractCurve):
    """The path of the point named `point_name`; t is the driver's angle, rad, or place, mm, over `span`.

    Exact: each point of it solves the linkage. span: one turn unless given; where a slide drives it must be. branch as
    in `move`. DesignError for a point that the linkage has not, and where it does not reach the whole span. Derived
    here.
    """

    linkage: OneLinkage
    point_name: str
    branch: Branch = 1
    span: tuple[float, float] | None = None

    __repr__ = one_line

    def __post_init__(self) -> None:
        check_fields(self)
        named = dict.fromkeys(point for points in self.linkage.linkage.bodies.values() for point in points)
        if self.point_name not in named:
            raise DesignError("point_name", f"found {self.point_name!r}", f"give one of {', '.join(named)}")
        if self.way[0] >= self.way[1]:
            raise DesignError("span", f"found {self.span}", "give a rising pair")
        untold = self.span is None and self.linkage.linkage.driven_slider is not None
        parts = driver_limits(self.linkage, self.branch, None if untold else self.way)
        reached = " and ".join(f"{low:.6g} to {high:.6g}" for low, high in parts) or "nowhere"
        if untold:
            remedy = f"give its first and last place, mm: the linkage closes from {reached}"
            raise DesignError("span", "is missing where a slide drives", remedy)
        if parts != (self.way,):
            raise DesignError("span", f"the linkage closes only from {reached}", "give a span inside it")

    @property
    def way(self) -> tuple[float, float]:
        """The driver's first and last angle or place."""
        return (0.0, 2 * np.pi) if self.span is None else (self.span[0], self.span[1])

    def _track(self, t: ArrayLike) -> tuple[PointMotion, Whole]:
        motion, frames = moved_at(self.linkage, t, self.branch, self.way[0])
        return motion.point(self.point_name), frames

    def point(self, t: ArrayLike) -> Complex:
        track, frames = self._track(t)
        return track.position[frames]

    def velocity(self, t: ArrayLike) -> Complex:
        track, frames = self._track(t)
        return track.first[frames]

    def curvature(self, t: ArrayLike) -> Real:
        track, frames = self._track(t)
        first: Complex = track.first[frames]
        bend: Real = cross(first, track.second[frames])
        with np.errstate(divide="ignore", invalid="ignore"):
            return bend / abs(first) ** 3

    @property
    def breaks(self) -> Real:
        return np.array(self.way, dtype=float)

    @cached_property
    def closed(self) -> bool:
        ends = self.point(np.array(self.way))
        return bool(abs(ends[1] - ends[0]) <= 1e-9 * abs(self.velocity(self.way[0])) * (self.way[1] - self.way[0]))


@checked
def coupler_grid(length: float, height: float, rows: int, columns: int, centre: complex = 0j) -> Complex:
    """Points (rows, columns), mm in a body's own frame, evenly over a rectangle about `centre`.

    length along the body's x axis, height along its y; the first row is the lowest. One row or column
    stands in the middle. DesignError for sides below 0, and for no row or column. Derived here.
    """
    for name, value, least in (
        ("length", length, 0),
        ("height", height, 0),
        ("rows", rows, 1),
        ("columns", columns, 1),
    ):
        if not least <= value < np.inf:
            raise DesignError(name, f"found {value}", f"give a finite number of at least {least}")
    x, y = (
        np.linspace(-side / 2, side / 2, n) if n > 1 else np.zeros(1) for side, n in ((length, columns), (height, rows))
    )
    return centre + x + 1j * y[:, None]


@checked
def coupler_curves(motion: Motion, points: Points, body: str = "coupler") -> Complex:
    """Paths (..., frames) of a body's own points (...,), mm; nan where the linkage is open.

    DesignError for a body that the linkage has not. Derived here.
    """
    _check_body(motion.linkage.bodies, body)
    pose = motion.bodies[body]
    arms: Complex = np.asarray(points, dtype=complex)[..., None]
    return pose.origin.position + pose.direction * arms


@checked
def dashes(
    linkage: OneLinkage, points: Points, drive: Reals, tolerance: float, branch: Branch = 1, body: str = "coupler"
) -> list[list[Complex]]:
    """Each point's path as dashes: one for the first step of the drive, a gap for the next, and so on.

    With equal steps a long dash is a fast stretch. points: (n,) complex, mm in the body's own frame.
    drive: rising limits of the steps, rad or mm, `np.radians(np.arange(0, 361, 5))` for a dash each other 5 deg.
    For each point its dashes in order: points (m,) of the curve itself, no farther than `tolerance` mm from it
    along their chords. A dash ends where the linkage opens and goes on where it closes again. branch: as of
    `move`, but not "follow", and the linkage is to be a chain of dyads: poses must not hang on the frames before.
    DesignError where any of these is not so, and for a tolerance too fine to reach. The dashes are those of Hrones and
    Nelson, Analysis of the Four-Bar Linkage, 1951; how they are found is derived here.
    """
    local, steps = np.atleast_1d(np.asarray(points, dtype=complex)), np.asarray(drive, dtype=float)
    if not 0 < tolerance < np.inf:
        raise DesignError("tolerance", f"found {tolerance}", "give a distance above 0, in mm")
    if steps.ndim != 1 or len(steps) < 2 or not np.all(np.diff(steps) > 0):
        raise DesignError("drive", "found no rising row", "give the limits of the steps in rising order, at least two")
    if local.ndim != 1 or not local.size or not np.isfinite(local).all():
        raise DesignError("points", "found no row of finite points", "give finite points; ravel a grid")
    if chosen(branch).follow:
        raise DesignError("branch", f"found {shown(branch)}", "give +1, -1 or a table of signs by joint")
    _check_body(linkage.linkage.bodies, body)
    if chosen(branch).near:
        # Near the places given at the first step, whatever drives a dash is looked at.
        branch = {joint: int(signs[0]) or 1 for joint, signs in move(linkage, steps, branch).solution.signs.items()}
    return _drawn(linkage, local, _dash_limits(linkage, steps, branch), tolerance, branch, body)


def _check_body(bodies: Collection[str], body: str) -> None:
    if body not in bodies:
        raise DesignError("body", f"found {body!r}", f"give one of {', '.join(bodies)}")


def _dash_limits(linkage: AbstractLinkage, steps: Real, branch: Branch) -> Real:
    """Limits (dashes, 2) of the drive over which the linkage is closed, none across the limits of a step."""
    first, last = float(steps[0]), float(steps[-1])
    short = SHORT * np.spacing(max(abs(first), abs(last)))
    reached = [
        (low if low == first else low + short, high if high == last else high - short)
        for low, high in driver_limits(linkage, branch, (first, last))
    ]
    cut = [(max(a, low), min(b, high)) for a, b in zip(steps[:-1:2], steps[1::2]) for low, high in reached]
    return np.array([(a, b) for a, b in cut if a < b]).reshape(-1, 2)


def _drawn(
    linkage: AbstractLinkage, local: Complex, limits: Real, tolerance: float, branch: Branch, body: str
) -> list[list[Complex]]:
    found: list[dict[int, Complex]] = [{} for _ in local]
    waiting, worst = np.arange(len(limits)), 0.0
    for level in range(_levels(len(local) * len(limits))):
        chords = 2**level
        # Crowded at both ends by cosines: at a limit of the linkage a path starts off with infinite speed.
        share = (1 - np.cos(np.pi * np.linspace(0, 1, 4 * chords + 1))) / 2
        nodes = limits[waiting, :1] + np.diff(limits[waiting]) * share
        nodes[:, -1] = limits[waiting, 1]
        motion = move(linkage, nodes.ravel(), branch)
        if not motion.closed.all():
            opened = nodes.ravel()[~motion.closed][0]
            raise DesignError("drive", f"the linkage opens at {opened:.6g} for a moment", "give steps that end there")
        path = coupler_curves(motion, local, body).reshape(len(local), *nodes.shape)
        distance = _distance(path)
        near, worst = distance <= AIM * tolerance, float(distance.max(initial=0.0))
        for k, dash in zip(*np.nonzero(near)):
            found[k].setdefault(int(waiting[dash]), path[k, dash, ::4])
        waiting = waiting[~near.all(axis=0)]
        if not waiting.size:
            return [[runs[dash] for dash in sorted(runs)] for runs in found]
    raise DesignError(
        "tolerance",
        f"found {tolerance:g} mm, finer than {chords} chords for each of {len(local) * len(limits)} dashes",
        f"give at least {rounded_up(worst / AIM, 4)} mm, or fewer points or dashes",
    )


def _levels(dashes: int) -> int:
    """How often the chords of so many dashes may be doubled, the first time included, however many come to need it."""
    nodes = MOST_POINTS / max(1, dashes)
    return 1 + int(np.clip(np.log2(max(1.0, (nodes - 1) / 4)), 0, FINEST))


def _distance(path: Complex) -> Real:
    """Largest distance of (..., 4 chords + 1) nodes from the chords over each four of them, (...,)."""
    start, end = path[..., :-1:4, None], path[..., 4::4, None]
    between = path[..., :-1].reshape(*path.shape[:-1], -1, 4)[..., 1:]
    chord = end - start
    # Of a path that comes back to where it began, the way out.
    way = np.where(chord == 0, between[..., 1:2] - start, chord)
    across = (between - start) * np.conj(np.where(way == 0, 0, unit(way)))
    length = abs(chord)
    # Where a path turns back is mostly between the nodes.
    along = np.concatenate([np.zeros_like(length), across.real, length], axis=-1) @ FINER
    beyond = np.maximum(np.maximum(-along, along - length).max(axis=-1, keepdims=True), 0)
    most: Real = np.hypot(across.imag, beyond).max(axis=(-1, -2))
    return most
