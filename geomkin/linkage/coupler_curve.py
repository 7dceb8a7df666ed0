"""Coupler curves: paths of a body's points as exact curves, over frames, and as the dashes of an atlas."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError, shown
from ..core.fields import rounded_up
from ..core.records import record
from ..core.units import mm
from ..plane.curve import AbstractCurve
from ..plane.vec import Complex, Real, Whole, cross, unit
from .drive_limits import driver_limits
from .linkage import AbstractLinkage, OneLinkage
from .motion import Motion
from .moving import move
from .solve.branch import Branch, as_branch_spec
from .solve.solution import PointMotion

# Share of the tolerance that chords must keep. Their distance is sampled at three points, which may miss 3 % of it.
AIM = 0.95
# From five nodes to 33 points of the quartic through them, which locate a reversal of the path between the nodes.
FINER = np.linalg.solve(np.vander(np.linspace(0, 1, 5)).T, np.vander(np.linspace(0, 1, 33), 5).T)
# Largest number of chords of a dash, as a power of 2: finer than any machine can cut.
FINEST = 12
# Largest number of points of all dashes together: they take some seconds and half a GB.
MOST_POINTS = 2_000_000
# Units in the last place by which a dash ends before a limit of the linkage, where rounding decides if it is closed.
SHORT = 8


def motion_at(linkage: AbstractLinkage, t: ArrayLike, branch: Branch, start: float) -> tuple[Motion, Whole]:
    """The motion at drives of any shape and order, and the frame of each of them.

    A followed branch is followed from `start`, whatever drives are given.
    """
    drive = np.asarray(t, dtype=float)
    order = np.argsort(abs(drive - start), axis=None, kind="stable")
    frames = np.empty(drive.size, dtype=int)
    frames[order] = np.arange(1, drive.size + 1)
    return move(linkage, np.append(start, drive.ravel()[order]), branch), frames.reshape(drive.shape)


@record(checked=True, eq=False)
class CouplerCurve(AbstractCurve):
    """Path of a named point of a linkage, as a curve whose parameter t is the drive, rad or mm.

    Each point of the curve solves the linkage exactly.

    Parameters
    ----------
    linkage : Linkage or any named linkage
        One linkage, its sizes numbers.
    point_name : str
        Name of the point.
    branch : {+1, -1, "follow"}, mapping or Continuation
        As for `move`.
    span : (float, float), optional
        First and last drive, rad or mm, rising. By default one turn; required if a slider drives.

    Raises
    ------
    DesignError
        If the linkage has no such point, or cannot be assembled over the whole span.

    See Also
    --------
    move, path_generator, curvature

    Notes
    -----
    Derived here.

    Examples
    --------
    >>> import geomkin as gk
    >>> curve = gk.CouplerCurve(gk.FourBar(100, 30, 90, 70, coupler_point=45 + 40j), "coupler_point")
    >>> round(gk.length(curve), 2)
    167.19
    """

    linkage: OneLinkage
    point_name: str
    branch: Branch = 1
    span: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        named = dict.fromkeys(point for points in self.linkage.linkage.bodies.values() for point in points)
        if self.point_name not in named:
            raise DesignError(
                "point_name", f"found {self.point_name!r}", f"give one of {', '.join(named)}", "unknown-key"
            )
        if self.drive_span[0] >= self.drive_span[1]:
            raise DesignError("span", f"found {self.span}", "give a rising pair", "out-of-range")
        missing = self.span is None and self.linkage.linkage.driven_slider is not None
        parts = driver_limits(self.linkage, self.branch, None if missing else self.drive_span)
        reached = " and ".join(f"{low:.6g} to {high:.6g}" for low, high in parts) or "nowhere"
        if missing:
            remedy = f"give its first and last displacement, mm: the linkage closes from {reached}"
            raise DesignError("span", "is missing although a slide drives", remedy, "missing-key")
        if parts != (self.drive_span,):
            raise DesignError(
                "span", f"the linkage closes only from {reached}", "give a span inside it", "does-not-assemble"
            )

    @property
    def drive_span(self) -> tuple[float, float]:
        """First and last drive, rad or mm."""
        return (0.0, 2 * np.pi) if self.span is None else (self.span[0], self.span[1])

    def _track(self, t: ArrayLike) -> tuple[PointMotion, Whole]:
        motion, frames = motion_at(self.linkage, t, self.branch, self.drive_span[0])
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
        numerator: Real = cross(first, track.second[frames])
        with np.errstate(divide="ignore", invalid="ignore"):
            return numerator / abs(first) ** 3

    @property
    def breaks(self) -> Real:
        return np.array(self.drive_span, dtype=float)

    @cached_property
    def closed(self) -> bool:
        ends = self.point(np.array(self.drive_span))
        return bool(
            abs(ends[1] - ends[0])
            <= 1e-9 * abs(self.velocity(self.drive_span[0])) * (self.drive_span[1] - self.drive_span[0])
        )


@checked
def coupler_grid(length: float, height: float, rows: int, columns: int, centre: complex = 0j) -> Complex:
    """Points of a rectangular grid, for coupler curves.

    Parameters
    ----------
    length, height : float
        Sides along the body's x and y axes, mm; at least 0.
    rows, columns : int
        Number of rows and columns, at least 1; a single one is in the middle.
    centre : complex
        Centre of the rectangle, mm in the body's frame.

    Returns
    -------
    array of complex, shape (rows, columns)
        mm in the body's frame, the lowest row first.

    Raises
    ------
    DesignError
        If an argument is out of range.

    Notes
    -----
    Derived here.
    """
    for name, value, least in (
        ("length", length, 0),
        ("height", height, 0),
        ("rows", rows, 1),
        ("columns", columns, 1),
    ):
        if not least <= value < np.inf:
            raise DesignError(name, f"found {value}", f"give a finite number of at least {least}", "out-of-range")
    x, y = (
        np.linspace(-side / 2, side / 2, n) if n > 1 else np.zeros(1) for side, n in ((length, columns), (height, rows))
    )
    return centre + x + 1j * y[:, None]


@checked
def coupler_curves(motion: Motion, points: complex | ArrayLike, body: str = "coupler") -> Complex:
    """Paths of a body's points over the frames of a motion.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.
    points : complex or array_like, shape (...,)
        Points, mm in the body's frame.
    body : str
        Name of the body.

    Returns
    -------
    array of complex, shape (..., frames)
        mm; nan where the linkage is open.

    Raises
    ------
    DesignError
        If the linkage has no such body.

    Notes
    -----
    Derived here.
    """
    _check_body(motion.linkage.bodies, body)
    pose = motion.bodies[body]
    arms: Complex = np.asarray(points, dtype=complex)[..., None]
    return pose.origin.position + pose.direction * arms


@checked
def dashes(
    linkage: OneLinkage,
    points: complex | ArrayLike,
    drive: float | ArrayLike,
    tolerance: float,
    branch: Branch = 1,
    body: str = "coupler",
) -> list[list[Complex]]:
    """Dashed paths of a body's points, as in an atlas: one dash for every other step of the drive.

    With equal steps a long dash means a fast part of the path. A dash ends where the linkage opens and starts again
    where it closes.

    Parameters
    ----------
    linkage : Linkage or any named linkage
        One linkage that is a chain of dyads: its poses must not depend on earlier frames.
    points : complex or array_like, shape (n,)
        Points, mm in the body's frame.
    drive : array_like
        Rising limits of the steps, rad or mm; `np.radians(np.arange(0, 361, 5))` for dashes of 5 deg.
    tolerance : float
        Largest distance of the chords from the path, mm; above 0.
    branch : {+1, -1} or mapping
        As for `move`, but not "follow".
    body : str
        Name of the body.

    Returns
    -------
    list of list of array
        For each point its dashes in order, each a row of points of the path, complex, mm.

    Raises
    ------
    DesignError
        If an argument is not as described, or the tolerance is too fine to reach.

    Notes
    -----
    The dashes are those of Hrones and Nelson, Analysis of the Four-Bar Linkage, 1951; the algorithm is derived here.
    """
    local, steps = np.atleast_1d(np.asarray(points, dtype=complex)), np.asarray(drive, dtype=float)
    if not 0 < tolerance < np.inf:
        raise DesignError("tolerance", f"found {tolerance}", "give a distance above 0, in mm", "out-of-range")
    if steps.ndim != 1 or len(steps) < 2 or not np.all(np.diff(steps) > 0):
        remedy = "give the limits of the steps in rising order, at least two"
        raise DesignError("drive", "the values do not rise", remedy, "out-of-range")
    if local.ndim != 1 or not local.size or not np.isfinite(local).all():
        problem = "found something other than a 1-D array of finite points"
        raise DesignError("points", problem, "give finite points; ravel a grid", "wrong-type")
    if as_branch_spec(branch).follow:
        raise DesignError("branch", f"found {shown(branch)}", "give +1, -1 or a table of signs by joint", "wrong-type")
    _check_body(linkage.linkage.bodies, body)
    if as_branch_spec(branch).branch_points:
        # The branch nearest to the given positions at the first step serves for all dashes.
        branch = {joint: int(signs[0]) or 1 for joint, signs in move(linkage, steps, branch).solution.signs.items()}
    return _drawn(linkage, local, _dash_limits(linkage, steps, branch), tolerance, branch, body)


def _check_body(bodies: Collection[str], body: str) -> None:
    if body not in bodies:
        raise DesignError("body", f"found {body!r}", f"give one of {', '.join(bodies)}", "unknown-key")


def _dash_limits(linkage: AbstractLinkage, steps: Real, branch: Branch) -> Real:
    """Limits (dashes, 2) of the drive of each dash, within which the linkage is closed."""
    first, last = float(steps[0]), float(steps[-1])
    short = SHORT * np.spacing(max(abs(first), abs(last)))
    closed = [
        (low if low == first else low + short, high if high == last else high - short)
        for low, high in driver_limits(linkage, branch, (first, last))
    ]
    limits = [(max(a, low), min(b, high)) for a, b in zip(steps[:-1:2], steps[1::2]) for low, high in closed]
    return np.array([(a, b) for a, b in limits if a < b]).reshape(-1, 2)


def _drawn(
    linkage: AbstractLinkage, local: Complex, limits: Real, tolerance: float, branch: Branch, body: str
) -> list[list[Complex]]:
    finished: list[dict[int, Complex]] = [{} for _ in local]
    waiting, worst = np.arange(len(limits)), 0.0
    for level in range(_levels(len(local) * len(limits))):
        chords = 2**level
        # Cosine spacing, denser at both ends: at a limit of the linkage the speed is infinite.
        share = (1 - np.cos(np.pi * np.linspace(0, 1, 4 * chords + 1))) / 2
        nodes = limits[waiting, :1] + np.diff(limits[waiting]) * share
        nodes[:, -1] = limits[waiting, 1]
        motion = move(linkage, nodes.ravel(), branch)
        if not motion.assembled.all():
            opened = nodes.ravel()[~motion.assembled][0]
            problem = f"the linkage opens at {opened:.6g} for a moment"
            raise DesignError("drive", problem, "give steps that end there", "does-not-assemble")
        path = coupler_curves(motion, local, body).reshape(len(local), *nodes.shape)
        distance = _distance(path)
        near, worst = distance <= AIM * tolerance, float(distance.max(initial=0.0))
        for k, dash in zip(*np.nonzero(near)):
            finished[k].setdefault(int(waiting[dash]), path[k, dash, ::4])
        waiting = waiting[~near.all(axis=0)]
        if not waiting.size:
            return [[runs[dash] for dash in sorted(runs)] for runs in finished]
    problem = f"found {mm(tolerance):g}, finer than {chords} chords for each of {len(local) * len(limits)} dashes"
    remedy = f"give at least {mm(worst / AIM):up4}, or fewer points or dashes"
    raise DesignError("tolerance", problem, remedy, "too-much-work", rounded_up(worst / AIM, 4))


def _levels(dashes: int) -> int:
    """Number of times that the chords of so many dashes may be computed, each time with twice as many."""
    nodes = MOST_POINTS / max(1, dashes)
    return 1 + int(np.clip(np.log2(max(1.0, (nodes - 1) / 4)), 0, FINEST))


def _distance(path: Complex) -> Real:
    """Largest distance of (..., 4 chords + 1) nodes from the chords over each four of them, (...,)."""
    start, end = path[..., :-1:4, None], path[..., 4::4, None]
    between = path[..., :-1].reshape(*path.shape[:-1], -1, 4)[..., 1:]
    chord = end - start
    # For a path that returns to its start, the direction in which it leaves.
    direction = np.where(chord == 0, between[..., 1:2] - start, chord)
    across = (between - start) * np.conj(np.where(direction == 0, 0, unit(direction)))
    length = abs(chord)
    # The point at which a path reverses is mostly between the nodes.
    along = np.concatenate([np.zeros_like(length), across.real, length], axis=-1) @ FINER
    beyond = np.maximum(np.maximum(-along, along - length).max(axis=-1, keepdims=True), 0)
    most: Real = np.hypot(across.imag, beyond).max(axis=(-1, -2))
    return most
