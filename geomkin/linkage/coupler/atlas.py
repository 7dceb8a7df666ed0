"""Atlas of coupler curves: the paths of a grid of points on one moving body, dashed by the steps of the drive."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ...arguments import Points, Reals, checked
from ...errors import DesignError, shown
from ...plane.vec import Array, unit
from ...sizes import rounded_up
from ..solve.branch import Branch, chosen
from ..limits import driver_limits
from ..motion import Motion
from ..linkage import AbstractLinkage, OneLinkage
from ..solve.move import move

# Share of the tolerance that is aimed at. Chords are looked at in three places, which see an S as well as an arc,
# but 3 % too small; nearer to 1, such a chord may exceed the tolerance.
AIM = 0.95
# Chords of a dash at most, as a power of 2. More would take a tolerance that no machine can cut for a real one.
FINEST = 12
# Points of all dashes together that are looked at, at most: what takes some seconds and half a GB.
MOST_POINTS = 2_000_000
# Spacings of floating point that a dash ends short of a limit of the linkage: at the very limit, rounding decides
# whether it is closed. More would show as a dash that ends early.
SHORT = 8


@checked
def coupler_grid(length: float, height: float, rows: int, columns: int, centre: complex = 0j) -> Array:
    """Points (rows, columns), mm in a body's own frame, evenly over a rectangle about `centre`.

    length along the body's x axis, height along its y; the first row is the lowest. One row or column
    stands in the middle.
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
def coupler_curves(motion: Motion, points: Points, body: str = "coupler") -> Array:
    """Paths (..., frames) of a body's own points (...,), mm; nan where the linkage is open."""
    _check_body(motion.linkage.bodies, body)
    pose = motion.bodies[body]
    return pose.origin.position + pose.direction * np.asarray(points, dtype=complex)[..., None]


@checked
def dashes(
    linkage: OneLinkage, points: Points, drive: Reals, tolerance: float, branch: Branch = 1, body: str = "coupler"
) -> list[list[Array]]:
    """Each point's path as dashes: one for the first step of the drive, a gap for the next, and so on.

    With equal steps a long dash is a fast stretch. points: (n,) complex, mm in the body's own frame.
    drive: rising limits of the steps, rad or mm, `np.radians(np.arange(0, 361, 5))` for a dash each other 5 deg.
    For each point its dashes in order: points (m,) of the curve itself, no farther than `tolerance` mm from it
    along their chords. A dash ends where the linkage opens and goes on where it closes again. branch: as of
    `move`, but not "follow", and the linkage is to be a chain of dyads: poses must not hang on the frames before.
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


def _dash_limits(linkage: AbstractLinkage, steps: Array, branch: Branch) -> Array:
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
    linkage: AbstractLinkage, local: Array, limits: Array, tolerance: float, branch: Branch, body: str
) -> list[list[Array]]:
    found: list[dict[int, Array]] = [{} for _ in local]
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


def _distance(path: Array) -> Array:
    """Largest distance of (..., 4 chords + 1) nodes from the chords over each four of them, (...,)."""
    start, end = path[..., :-1:4, None], path[..., 4::4, None]
    between = path[..., :-1].reshape(*path.shape[:-1], -1, 4)[..., 1:]
    chord = end - start
    across = (between - start) * np.conj(np.where(chord == 0, 0, unit(chord)))
    beyond = np.maximum(np.maximum(-across.real, across.real - np.abs(chord)), 0)
    off = np.where(chord == 0, np.abs(between - start), np.hypot(across.imag, beyond))
    return off.max(axis=(-1, -2))
