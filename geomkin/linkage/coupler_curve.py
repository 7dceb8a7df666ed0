"""Paths of a body's points: one as an exact curve, many over frames, and dashed as an atlas draws them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import Points, Reals, checked
from ..core.errors import DesignError, shown
from ..core.fields import rounded_up
from ..core.records import record
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Real, Whole, cross, direction_deg, unit
from .linkage import AbstractLinkage, Linkage, OneLinkage
from .measures import driver_limits
from .motion import Motion, PointMotion
from .moving import move
from .named_linkages import FourBar
from .solve.branch import Branch, as_branch_spec

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


def motion_at(linkage: AbstractLinkage, t: ArrayLike, branch: Branch, start: float) -> tuple[Motion, Whole]:
    """The motion at drives of any shape and order, and which of its frames each of them is.

    A branch that is followed is followed from `start`, whatever drives on one side of it are asked for.
    """
    drive = np.asarray(t, dtype=float)
    order = np.argsort(abs(drive - start), axis=None, kind="stable")
    frames = np.empty(drive.size, dtype=int)
    frames[order] = np.arange(1, drive.size + 1)
    return move(linkage, np.append(start, drive.ravel()[order]), branch), frames.reshape(drive.shape)


@record(checked=True, eq=False)
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

    def __post_init__(self) -> None:
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
        motion, frames = motion_at(self.linkage, t, self.branch, self.way[0])
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
    if as_branch_spec(branch).follow:
        raise DesignError("branch", f"found {shown(branch)}", "give +1, -1 or a table of signs by joint")
    _check_body(linkage.linkage.bodies, body)
    if as_branch_spec(branch).branch_points:
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
        if not motion.assembled.all():
            opened = nodes.ravel()[~motion.assembled][0]
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


Link = Literal["crank", "coupler", "rocker"]

# Distance of the coupler point from a pin, as a share of the coupler, below which a cognate counts as shrunk to
# a point. Smaller takes the rounding of a pin's own place for a linkage; larger refuses a tiny but real one.
AT_PIN = 1e-12

# What turns with what. P = A + w AB is the coupler point as a ratio w of the coupler AB. With a e1, b e3, c e4 and
# d e0 the links crank, coupler, rocker and ground as vectors, a e1 + b e3 = d e0 + c e4, and parallelograms on both
# sides of P make, about the third pivot O_A + w d e0:
#     left   w b e3       + w a e1       = w d e0       + w c e4         from the crank pivot to the third
#     right  (1-w) a e1   + (w-1) c e4   = (1-w) d e0   + (w-1) b e3     from the third to the rocker pivot
LEFT: Mapping[Link, Link] = MappingProxyType({"crank": "coupler", "coupler": "crank", "rocker": "rocker"})
RIGHT: Mapping[Link, Link] = MappingProxyType({"crank": "crank", "coupler": "rocker", "rocker": "coupler"})


@record
class Cognate:
    """One of the three four-bars of a coupler curve, and how it moves to be at the same point at the same moment.

    Move `linkage` at the given linkage's drive plus `drive_offset`, rad, on the given branch times `branch`.
    turns_with: for each of its links, the link of the given linkage that it keeps its angle to.
    """

    linkage: FourBar
    drive_offset: float
    branch: int
    turns_with: Mapping[Link, Link]


@checked
def cognates(four_bar: FourBar) -> tuple[Cognate, Cognate, Cognate]:
    """The given four-bar and its two cognates: three linkages whose coupler points trace one curve.

    The second stands on the crank pivot and the third pivot, the third on the third pivot and the rocker
    pivot. Each is driven by the link that turns with the given linkage's driver, which need not be its crank.
    A coupler point on the line of the coupler is an ordinary case; at a pin one cognate shrinks to that pin's
    pivot, which is a DesignError. Roberts, On three-bar motion in plane space, Proc. London Math. Soc. 7, 1875;
    Chebyshev 1878. Drivers and branches are derived here.
    """
    given, w = four_bar, _ratio(four_bar)
    same = MappingProxyType({link: link for link in LEFT})
    # Turned and scaled, never mirrored: the branch's sign changes only where the two links of the dyad change places.
    left = Cognate(_left(given, w), 0.0, -1 if given.driver == "rocker" else 1, LEFT)
    # Coupler and rocker of the right one point against the links that they turn with: they have w - 1, not 1 - w.
    half_turn = 0.0 if given.driver == "crank" else np.pi
    right = Cognate(_right(given, w), half_turn, -1 if given.driver == "crank" else 1, RIGHT)
    return Cognate(given, 0.0, 1, same), left, right


@checked
def third_pivot(four_bar: FourBar) -> complex:
    """The fixed point, mm, at which the two cognates meet: it makes with the pivots the coupler's triangle.

    Roberts 1875, as in `cognates`.
    """
    ground = four_bar.ground * direction_deg(four_bar.ground_angle_deg)
    return complex(four_bar.origin + four_bar.coupler_point / four_bar.coupler * ground)


@checked
def roberts_linkage(four_bar: FourBar, start: float = 0.0, branch: Branch = 1) -> Linkage:
    """Roberts' figure: the three cognates as one linkage of ten bars, joined at the coupler point.

    Their third pivot is a pin of two links and not of the ground: that it stays put is Roberts' theorem (pinned
    to the ground too, the linkage counts as rigid). Bodies crank, coupler, rocker; left_crank, left_coupler,
    left_rocker; right_crank, right_coupler, right_rocker; new pins left_pin, left_rocker_pin, right_crank_pin,
    right_pin, third_pivot. Its parallelograms pass change points: move it with branch "follow" from the
    drive `start`, rad, where the given linkage stands on `branch`. DesignError as for `cognates`, and where the
    linkage is open at `start`. The figure: Roberts 1875; that it runs through change points is derived here.
    """
    a, b, c, d = four_bar.crank, four_bar.coupler, four_bar.rocker, four_bar.ground
    w = _ratio(four_bar)
    motion = move(replace(four_bar, origin=0j, ground_angle_deg=0.0), [start], branch)
    if not motion.assembled[0]:
        raise DesignError("start", f"found {start:g} rad, where the linkage is open", "give a drive that it reaches")
    e1, e3, e4 = (complex(motion.bodies[link].direction[0]) for link in ("crank", "coupler", "rocker"))
    point = {
        "crank_pivot": 0j,
        "rocker_pivot": d + 0j,
        "third_pivot": w * d,
        "crank_pin": a * e1,
        "rocker_pin": d + c * e4,
        "coupler_point": a * e1 + w * b * e3,
        "left_pin": w * b * e3,
        "left_rocker_pin": w * b * e3 + w * a * e1,
        "right_pin": d + (w - 1) * b * e3,
        "right_crank_pin": w * d + (1 - w) * a * e1,
    }
    # Each body's points, the frame's origin first and a point on its x axis second.
    made_of = {
        "ground": ("crank_pivot", "rocker_pivot"),
        "crank": ("crank_pivot", "crank_pin"),
        "coupler": ("crank_pin", "rocker_pin", "coupler_point"),
        "rocker": ("rocker_pivot", "rocker_pin"),
        "left_crank": ("crank_pivot", "left_pin"),
        "left_coupler": ("left_pin", "left_rocker_pin", "coupler_point"),
        "left_rocker": ("third_pivot", "left_rocker_pin"),
        "right_crank": ("third_pivot", "right_crank_pin"),
        "right_coupler": ("right_crank_pin", "right_pin", "coupler_point"),
        "right_rocker": ("rocker_pivot", "right_pin"),
    }
    # Where the coupler drives, crank and rocker close as a dyad whose second pivot is set back by the coupler.
    back = point["rocker_pivot"] - (point["rocker_pin"] - point["crank_pin"])
    point |= {"driver_back": back}
    own = {
        "crank": ("coupler", "rocker", ("crank_pin", "rocker_pin", "rocker_pivot")),
        "coupler": ("crank", "rocker", ("crank_pivot", "crank_pin", "driver_back")),
        "rocker": ("crank", "coupler", ("crank_pivot", "crank_pin", "rocker_pin")),
    }
    dyads = [
        own[four_bar.driver],
        ("left_crank", "left_coupler", ("crank_pivot", "left_pin", "coupler_point")),
        ("right_coupler", "right_rocker", ("coupler_point", "right_pin", "rocker_pivot")),
        ("left_rocker", "right_crank", ("left_rocker_pin", "third_pivot", "right_crank_pin")),
    ]
    order = ["ground", four_bar.driver]
    for one, two, (first, joint, last) in dyads:
        # "follow" starts with every joint on the left of its dyad, seen from the body named first.
        on_left = cross(point[last] - point[first], point[joint] - point[first]) >= 0
        order += [one, two] if on_left else [two, one]

    def local(body: str) -> dict[str, complex | Complex]:
        origin, ahead = (point[name] for name in made_of[body][:2])
        x_axis = (ahead - origin) / abs(complex(ahead - origin))
        return {name: (point[name] - origin) * x_axis.conjugate() for name in made_of[body]}

    return Linkage(
        bodies={body: local(body) for body in order},
        driver=four_bar.driver,
        origin=four_bar.origin,
        ground_angle_deg=four_bar.ground_angle_deg,
    )


def _ratio(four_bar: FourBar) -> complex:
    w = complex(four_bar.coupler_point / four_bar.coupler)
    for distance, pin in ((abs(w), "crank"), (abs(w - 1), "rocker")):
        if distance <= AT_PIN:
            raise DesignError(
                "coupler_point",
                f"found {four_bar.coupler_point:g} mm, at the {pin} pin, where one cognate shrinks to a point",
                "give a point away from both pins: at a pin the coupler curve is an arc, which the one link traces",
            )
    return w


def _left(given: FourBar, w: complex) -> FourBar:
    size = abs(w)
    return replace(
        given,
        ground=size * given.ground,
        crank=size * given.coupler,
        coupler=size * given.crank,
        rocker=size * given.rocker,
        coupler_point=size * given.crank / w,
        driver=LEFT[given.driver],
        ground_angle_deg=_turned(given, w),
    )


def _right(given: FourBar, w: complex) -> FourBar:
    size = abs(1 - w)
    return replace(
        given,
        ground=size * given.ground,
        crank=size * given.crank,
        coupler=size * given.rocker,
        rocker=size * given.coupler,
        coupler_point=size * given.rocker * w / (w - 1),
        driver=RIGHT[given.driver],
        origin=third_pivot(given),
        ground_angle_deg=_turned(given, 1 - w),
    )


def _turned(given: FourBar, by: complex) -> float:
    """Angle of the ground line turned by a ratio, deg, within half a turn."""
    return float(np.degrees(np.angle(direction_deg(given.ground_angle_deg) * by)))
