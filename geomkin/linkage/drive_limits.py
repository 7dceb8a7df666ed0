"""Limits of the driver and dead centres of an output, from a scan of the drive and bisection."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..core.arguments import checked
from ..core.errors import DesignError
from ..plane.vec import Mask, Real, dot, first_largest
from .linkage import OneLinkage
from .motion import Motion, is_translating
from .moving import move, placements_for
from .solve.branch import Branch, DriveRange, as_branch_spec
from .solve.dyads import Dyad
from .solve.input_dyads import InputDyad
from .solve.loops import Loops
from .solve.placement import Placement
from .solve.solution import extent_of, with_branches

# Number of intervals of a scan of the drive. A gap, or a pair of dead centres, within one interval is missed, unless
# only the driver moves the dyad, whose limits are known in closed form.
LOOKS = 1440
TURN = (0.0, 2 * np.pi)
# Extents of the linkage within which a driving slide is scanned, with growing steps: a slide whose limits are farther
# counts as unlimited. With a larger value rails that turn only by rounding would give it limits.
FARTHEST = 1e6
# Number of times that the drive at which a dyad is nearest to closing is narrowed, each to an eighth. The gap is flat
# there, so half of all digits suffice.
NARROWED = 10
# Share of its largest speed below which a body that does not turn counts as standing still, where its speed along one
# line changes sign. A larger value would accept points at which it moves perpendicular to that line.
RESTING = 1e-6
# Position within an interval, as a share of it, at which it is checked whether the linkage closes. In the middle two
# guides may be parallel for a moment; near an end rounding of that end may decide.
WITHIN = 0.381966
# Share of a range below which a gap in it is a rounding error: a limit moves by the square root of an error of lengths.
SMALLEST_GAP = 1e-7
# Largest number of peaks among the frames of a motion that are refined, and the largest number of times that they are
# narrowed, each to a 16th: to rounding also where the output has a corner, as an angle that is folded at 90 deg.
MOST_PEAKS, REFINED, PLACES = 8, 13, 33
# Relative difference of a peak and its neighbours below which it is found, and above which it exceeds a frame: smaller
# ones are rounding.
FLAT, HIGHER = 1e-13, 1e-12


@checked
def driver_limits(
    linkage: OneLinkage, branch: Branch = 1, span: tuple[float, float] | None = None
) -> tuple[tuple[float, float], ...]:
    """Ranges of the driver in which the linkage can be assembled.

    Parameters
    ----------
    linkage : Linkage or any named linkage
        One linkage, its sizes numbers.
    branch : {+1, -1, "follow"}, mapping or Continuation
        As for `move`.
    span : (float, float), optional
        Range of the driver to examine, rad or mm; it may fall, as for a clockwise driver. By default one turn from 0,
        or for a driving slider all positions at which the linkage closes.

    Returns
    -------
    tuple of (float, float)
        Each range from its first to its last drive, rising, rad or mm. A range ends at a limit of the driver, where a
        dyad is stretched or folded, or at an end of `span`. Empty if the linkage closes nowhere.

    Raises
    ------
    DesignError
        If the span is missing although the ranges have no end, or the branch or estimate needs a start.

    See Also
    --------
    move, least_transmission_angle

    Notes
    -----
    Derived here: in closed form if the driver alone moves a dyad, otherwise by bisection to the last bit. A
    linkage that is not a chain of dyads is followed from the start of the span, where its estimate holds, to its first
    limit.

    Examples
    --------
    >>> import geomkin as gk
    >>> gk.driver_limits(gk.FourBar(100, 30, 90, 70))
    ((0.0, 6.283185307179586),)
    """
    if span is None:
        span = _whole(linkage, branch)
        if span is None:
            return ()
    first, (low, high) = span[0], sorted(span)
    if not high > low:
        raise DesignError("span", f"found {span}", "give two different ends", "conflict")

    def closed(q: Real) -> Mask:
        # Starts at `first`, where a followed branch, given positions of pins, or an estimate is defined.
        order = 1 if first == low else -1
        return move(linkage, np.append(first, q[::order]), branch).assembled[1:][::order]

    looks = np.linspace(low, high, LOOKS + 1)
    placements = placements_for(linkage.linkage, branch)
    ends = [low, high, *_exact(placements, (low, high))]
    cuts = np.unique(ends + ([] if _all_driven(placements) else _changes(closed, looks)))
    within = cuts[:-1] + WITHIN * np.diff(cuts)
    ranges: list[list[float]] = []
    for low, high, inside in zip(cuts[:-1].tolist(), cuts[1:].tolist(), closed(within).tolist()):
        if inside and ranges and ranges[-1][1] == low:
            ranges[-1][1] = high
        elif inside:
            ranges.append([low, high])
    return tuple((low, high) for low, high in ranges)


@checked
def dead_centres(linkage: OneLinkage, output: str, branch: Branch = 1, span: tuple[float, float] | None = None) -> Real:
    """Drives at which a body momentarily stands still and reverses: the ends of its swing or stroke.

    Parameters
    ----------
    linkage : Linkage or any named linkage
        One linkage, its sizes numbers.
    output : str
        The body.
    branch : {+1, -1, "follow"}, mapping or Continuation
        As for `move`.
    span : (float, float), optional
        Range of the driver to examine, rad or mm; by default that of `driver_limits`.

    Returns
    -------
    array, shape (n,)
        Rising drives, rad or mm.

    Raises
    ------
    DesignError
        If `output` is not a moving body, or as for `driver_limits`.

    Notes
    -----
    Derived here: zeros of the body's first kinematic coefficient.

    Examples
    --------
    >>> import geomkin as gk
    >>> gk.linkage.dead_centres(gk.FourBar(100, 30, 90, 70), "rocker").round(4)
    array([0.6224, 3.9014])
    """
    general = linkage.linkage
    if output not in general.bodies or output == general.ground:
        raise DesignError(
            "output", f"found {output!r}", f"give one of {', '.join(list(general.bodies)[1:])}", "unknown-key"
        )
    if span is None:
        span = _whole(linkage, branch)
        if span is None:
            return np.empty(0)
    looks = np.linspace(*span, LOOKS + 1)
    motion = move(linkage, looks, branch)
    line = None
    if is_translating(motion, output):
        # A body that does not turn is measured along the direction of its largest step.
        steps = np.nan_to_num(motion.bodies[output].origin.first, nan=0.0, posinf=0.0, neginf=0.0)
        line = steps[np.argmax(np.abs(steps))]

    def rate(q: Real) -> Real:
        moved = move(linkage, np.append(span[0], q), branch).bodies[output]
        return (moved.first if line is None else dot(line, moved.origin.first))[1:]

    values = rate(looks)
    zeros = np.unique(np.array([*looks[values == 0].tolist(), *_crossings(rate, looks, values)]))
    if line is not None and zeros.size:
        # On a curved path the body may move perpendicular to that line without stopping.
        speed = np.abs(move(linkage, np.append(span[0], zeros), branch).bodies[output].origin.first)[1:]
        zeros = zeros[speed <= RESTING * np.abs(line)]
    return zeros


def share_reached(motion: Motion) -> tuple[float, float | None]:
    """Share of the driver's range, from 0 to 1, in which the linkage can be assembled, and the drive where it ends.

    The range is that of the frames, between which limits of the driver are solved for. The drive is None if all is
    reached.
    """
    start, reached, end = float(motion.drive[0]), 0.0, None
    ends = {float(q) for q in (motion.drive.min(), motion.drive.max())} - {start}
    for last in sorted(ends, key=lambda q: abs(q - motion.drive[-1])):
        parts = driver_limits(motion.given, motion.solution.spec, (start, last))
        length = sum(high - low for low, high in parts)
        if abs(last - start) - length <= SMALLEST_GAP * abs(last - start):
            length = abs(last - start)
        elif end is None:
            low, high = (parts[0] if last > start else parts[-1][::-1]) if parts else (start, start)
            end = high if low == start else start
        reached += length
    if not ends:
        return float(motion.assembled.mean()), None if motion.assembled.all() else start
    return reached / float(np.ptp(motion.drive)), end


def largest_between(motion: Motion, values: Callable[[Motion], Real], to_limits: bool = False) -> tuple[Real, Real]:
    """Largest values of outputs over the range of a motion, also between its frames, and the drives there.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage; a peak narrower than two of its steps is missed.
    values : callable
        The outputs at the frames of a motion, (outputs, frames) or (frames,); nan where they are unknown.
    to_limits : bool
        Whether limits of the driver beyond the last known frame count too. Forces and deviations are infinite there.

    Returns
    -------
    (array, array)
        Each of shape (outputs,), or () for a single output; nan if an output is known at no frame.

    Notes
    -----
    Derived here: the peaks among the frames are narrowed to rounding.
    """
    drive = motion.drive

    def values_at(drives: Real) -> Real:
        return values(motion) if drives is drive else values(moved_to(motion, drives))[..., 1:]

    return largest_over(drive, values_at, to_limits)


def largest_over(drive: Real, values: Callable[[Real], Real], to_limits: bool = False) -> tuple[Real, Real]:
    """As `largest_between`, of values at any positions of a driver; drive: those among which the peaks are found."""

    def known_values(drives: Real) -> Real:
        with np.errstate(all="ignore"):
            outputs = values(drives)
        return np.where(np.isfinite(outputs), outputs, -np.inf)

    outputs = known_values(drive)
    at_frames, is_single = np.atleast_2d(outputs), np.ndim(outputs) == 1
    first = np.array([first_largest(row) if np.isfinite(row).any() else -1 for row in at_frames])
    known = np.flatnonzero(first >= 0)
    largest, at = np.full((2, len(at_frames)), np.nan)
    largest[known], at[known] = at_frames[known, first[known]], drive[first[known]]
    around = np.pad(at_frames, ((0, 0), (1, 1)), constant_values=-np.inf)
    is_top = np.isfinite(at_frames) & (at_frames >= around[:, :-2]) & (at_frames >= around[:, 2:])
    tops = [np.flatnonzero(is_top[k]) for k in known]
    tops = [np.sort(top[np.argsort(-at_frames[k, top], kind="stable")[:MOST_PEAKS]]) for k, top in zip(known, tops)]
    owner = np.repeat(known, [len(top) for top in tops])
    if len(drive) < 2 or not owner.size:
        return (largest[0], at[0]) if is_single else (largest, at)
    top = np.concatenate(tops)
    before, after = np.maximum(top - 1, 0), np.minimum(top + 1, len(drive) - 1)
    if not to_limits:
        before, after = (np.where(np.isfinite(at_frames[owner, k]), k, top) for k in (before, after))
    low, high = drive[before], drive[after]
    for _ in range(REFINED):
        places = np.linspace(low, high, PLACES)
        heights = known_values(places.ravel()).reshape(-1, *places.shape)[owner, :, range(len(owner))].T
        best = np.argmax(heights, axis=0)
        before, after = np.maximum(best - 1, 0), np.minimum(best + 1, PLACES - 1)
        peak, below, beyond = (np.take_along_axis(heights, k[None], axis=0)[0] for k in (best, before, after))
        low, middle, high = (np.take_along_axis(places, k[None], axis=0)[0] for k in (before, best, after))
        if np.all(np.minimum(below, beyond) >= peak - FLAT * np.abs(peak)):
            break
    for k in known:
        peaks, middles = peak[owner == k], middle[owner == k]
        if peaks.max() > largest[k] + HIGHER * abs(largest[k]):
            one = first_largest(peaks)
            largest[k], at[k] = peaks[one], middles[one]
    return (largest[0], at[0]) if is_single else (largest, at)


def moved_to(motion: Motion, drives: ArrayLike) -> Motion:
    """The linkage of a motion at its first drive, where its branch is defined, and at other ones."""
    speed, acceleration = float(motion.timing.speed), float(motion.timing.acceleration)
    return move(motion.given, np.append(motion.drive[0], drives), motion.solution.spec, speed, acceleration)


def _whole(linkage: OneLinkage, branch: Branch) -> tuple[float, float] | None:
    """One turn, or the first and last displacement of a driving slide at which the linkage closes, or None."""
    general = linkage.linkage
    if general.driven_slider is None:
        return TURN
    spec, placements = as_branch_spec(branch), placements_for(general, branch)
    if spec.follow or spec.branch_points or any(isinstance(placement, Loops) for placement in placements):
        cause = "such a branch" if spec.follow or spec.branch_points else "the estimate"
        problem = f"a slide drives, and {cause} needs a first position"
        raise DesignError("span", problem, "give a span that starts there", "missing-key")
    extent = extent_of(general)
    outwards = np.geomspace(extent, FARTHEST * extent, LOOKS // 2)
    looks = np.concatenate([-outwards[:0:-1], np.linspace(-extent, extent, LOOKS + 1), outwards[1:]])

    def closed(q: Real) -> Mask:
        return move(linkage, q, branch).assembled

    ends = looks[[0, -1]]
    if closed(ends).any():
        problem = "the linkage closes at unlimited displacements"
        raise DesignError("span", problem, f"give a span, such as {(-extent, extent)}", "missing-key")
    drive_range = with_branches(general, placements, looks, (), spec)
    looks = np.concatenate(
        [looks, _exact(placements, (float(ends[0]), float(ends[1]))), _nearest_to_closing(drive_range, looks)]
    )
    edges = _changes(closed, np.unique(looks))
    return (min(edges), max(edges)) if edges else None


def _nearest_to_closing(drive_range: DriveRange, looks: Real) -> Real:
    """Open drives at which a dyad is nearest to closing, since it may close there between two drives of the scan."""

    def least(q: Real) -> Real:
        """The smallest gap, mm, that is not nan; inf if there is none."""
        with np.errstate(all="ignore"):
            p = drive_range.poses(q)
            dyads = [placement for placement in drive_range.placements if isinstance(placement, Dyad)]
            gaps = [np.broadcast_to(gap, q.shape) for dyad in dyads for gap in dyad.gaps(p)]
        smallest: Real = np.fmin.reduce([*gaps, np.full(len(q), np.inf)])
        return smallest

    gap = least(looks)
    at = 1 + np.flatnonzero((gap[1:-1] < 0) & (gap[1:-1] >= gap[:-2]) & (gap[1:-1] >= gap[2:]))
    low, high, best = looks[at - 1], looks[at + 1], looks[at]
    for _ in range(NARROWED):
        places = np.linspace(low, high, 17)
        top = np.argmax(least(places.ravel()).reshape(places.shape), axis=0)
        low, best, high = (
            np.take_along_axis(places, np.clip(k, 0, 16)[None], axis=0)[0] for k in (top - 1, top, top + 1)
        )
    return best


def _all_driven(placements: Sequence[Placement]) -> bool:
    return all(isinstance(placement, InputDyad) or not isinstance(placement, (Dyad, Loops)) for placement in placements)


def _exact(placements: Sequence[Placement], span: tuple[float, float]) -> list[float]:
    """Limits, in closed form, of the dyads that only the driver moves, inside the span."""
    limits: list[float] = []
    for dyad in placements:
        if isinstance(dyad, InputDyad):
            for limit in dyad.limits():
                periods = np.zeros(1)
                if dyad.period:
                    periods = np.arange(
                        np.floor((span[0] - limit) / dyad.period), np.ceil((span[1] - limit) / dyad.period) + 1
                    )
                limits += [q for q in (limit + dyad.period * periods).tolist() if span[0] < q < span[1]]
    return limits


def _changes(closed: Callable[[Real], Mask], looks: Real) -> list[float]:
    """Drives at which `closed` changes, to the last bit."""
    state = closed(looks)
    at = np.flatnonzero(state[1:] != state[:-1])
    low, high = _narrowed(closed, looks[at], looks[at + 1], state[at])
    changes: list[float] = np.where(state[at], low, high).tolist()
    return changes


def _crossings(f: Callable[[Real], Real], looks: Real, values: Real) -> list[float]:
    """Zeros of f between neighbouring drives of opposite sign; a jump through infinity is not a zero."""
    with np.errstate(invalid="ignore"):
        at = np.flatnonzero(values[1:] * values[:-1] < 0)
    if not at.size:
        return []
    low, high = _narrowed(lambda q: np.sign(f(q)), looks[at], looks[at + 1], np.sign(values[at]))
    with np.errstate(invalid="ignore"):
        # Both ends together, as one may have been next to the zero from the start.
        grown = np.abs(f(low) / values[at]) * np.abs(f(high) / values[at + 1])
    zeros: list[float] = low[grown < 1].tolist()
    return zeros


def _narrowed(f: Callable[[Real], Real | Mask], low: Real, high: Real, start: Real | Mask) -> tuple[Real, Real]:
    """Neighbouring numbers between which f changes; f is `start` at each low end and differs at the high end."""
    # Sixteen parts at a time: four bits for one call of f, which costs little more for an array than for one drive.
    while np.any(np.nextafter(low, high) < high):
        drives = np.linspace(low, high, 17)
        unchanged = (f(drives.ravel()).reshape(drives.shape) == start) & (drives < high)
        unchanged[0] = True
        last = np.argmin(unchanged, axis=0) - 1
        low, high = (np.take_along_axis(drives, k[None], axis=0)[0] for k in (last, last + 1))
    return low, high
