"""Measures of a linkage: full rotation, circuits, transmission angle, limits, dead centres, assembly failures."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations, islice
from typing import NamedTuple

import numpy as np

from ..core.arguments import checked
from ..core.errors import DesignError, printable
from ..core.records import record
from ..plane.vec import Mask, Real, Whole, dot
from .linkage import OneLinkage
from .motion import Motion, is_translating
from .moving import move, placements_for
from .named_linkages import FourBar, SliderCrank
from .solve.actuators import ActuatedRRP, ActuatedRRR
from .solve.branch import Branch, BranchSpec, as_branch_spec
from .solve.drive_range import DriveRange
from .solve.dyads import RPR, RRP, RRR, Crossed, Dyad
from .solve.input_dyads import DrivenRRP, DrivenRRR, InputDyad
from .solve.loops import Loops
from .solve.placement import Placement, RevoluteInput
from .solve.solution import LinkageSolution, extent_of, with_branches

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


class Grashof(NamedTuple):
    """Grashof's inequality of a four-bar: the shortest link can turn fully if `spare` is not negative.

    Parameters
    ----------
    type : str
        As returned by `grashof_type`.
    shortest, longest : str
        Names of these links.
    shortest_and_longest, other_two : float
        Sums of lengths, mm.
    """

    type: str
    shortest: str
    longest: str
    shortest_and_longest: float
    other_two: float

    @property
    def spare(self) -> float:
        """Sum of the other two links less that of shortest and longest, mm."""
        return self.other_two - self.shortest_and_longest


@checked
def grashof(linkage: FourBar) -> Grashof:
    """Grashof's inequality with its numbers: shortest + longest against the sum of the other two links.

    Parameters
    ----------
    linkage : FourBar
        One four-bar; its lengths are numbers, not arrays.

    Returns
    -------
    Grashof

    Notes
    -----
    Grashof, 1883.

    Examples
    --------
    >>> import geomkin as gk
    >>> result = gk.linkage.grashof(gk.FourBar(ground=100, crank=30, coupler=90, rocker=70))
    >>> result.type, result.spare
    ('crank-rocker', 30.0)
    """
    lengths = {kind: float(getattr(linkage, kind)) for kind in ("ground", "crank", "coupler", "rocker")}
    shortest, *others, longest = sorted(lengths, key=lengths.__getitem__)
    sums = lengths[shortest] + lengths[longest], lengths[others[0]] + lengths[others[1]]
    spare = sums[1] - sums[0]
    types = {"crank": "crank-rocker", "ground": "double-crank", "rocker": "rocker-crank", "coupler": "double-rocker"}
    kind = types[shortest] if spare > 0 else "triple-rocker"
    if abs(spare) <= 1e-12 * lengths[longest]:
        kind = "change-point"
    return Grashof(kind, shortest, longest, *sums)


@checked
def grashof_type(linkage: FourBar) -> str:
    """Type of a four-bar by Grashof's inequality.

    Parameters
    ----------
    linkage : FourBar
        One four-bar.

    Returns
    -------
    str
        "crank-rocker", "double-crank", "rocker-crank", "double-rocker" (the coupler turns fully), "change-point" (the
        sums are equal, to rounding) or "triple-rocker" (no link turns fully).

    Notes
    -----
    Grashof, 1883.
    """
    return grashof(linkage).type


@checked
def circuits(linkage: FourBar | SliderCrank, motion: Motion) -> Whole:
    """Circuit of each frame; poses of one circuit are reached from each other without taking the linkage apart.

    Parameters
    ----------
    linkage : FourBar or SliderCrank
        The linkage.
    motion : Motion
        A motion of this linkage.

    Returns
    -------
    array of int, shape of the motion
        +1 or -1; 0 where open; +1 throughout if there is only one circuit. For a Grashof four-bar it is the sign of the
        angle at a joint not adjacent to the shortest link. For a slider-crank it is the side of the slider if the crank
        turns fully, and the side of the crank if the connecting rod does.

    Raises
    ------
    DesignError
        If the motion is of another linkage.

    Notes
    -----
    Chase and Mirth, Circuits and branches of single-degree-of-freedom planar linkages, Journal of
    Mechanical Design 115, 1993.
    """
    if not _is_of(motion, linkage):
        raise DesignError("motion", "it is of another linkage", "give a motion of this linkage", "conflict")
    if isinstance(linkage, FourBar):
        inequality = grashof(linkage)
        # Shortest link -> a joint that is not adjacent to it.
        joints = {"crank": "rocker_pin", "ground": "rocker_pin", "coupler": "crank_pivot", "rocker": "crank_pin"}
        if inequality.spare <= 0:
            sign = np.ones(motion.assembled.shape)
        else:
            crank, coupler, rocker = (motion.bodies[n].direction for n in ("crank", "coupler", "rocker"))
            ground = motion.bodies["ground"].direction
            pairs = {"rocker_pin": (coupler, rocker), "crank_pivot": (ground, crank), "crank_pin": (crank, coupler)}
            one, two = pairs[joints[inequality.shortest]]
            sign = np.sign(np.imag(np.conj(one) * two))
    elif linkage.crank + np.abs(linkage.offset) < linkage.coupler:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["coupler"].direction))
    elif linkage.coupler + np.abs(linkage.offset) < linkage.crank:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["crank"].direction))
    else:
        sign = np.ones(motion.assembled.shape)
    return np.where(motion.assembled, sign, 0).astype(int)


def _is_of(motion: Motion, linkage: FourBar | SliderCrank) -> bool:
    """Whether a motion is of a linkage with these sizes, at any position and with any driver."""
    moved, given, pins = motion.linkage.bodies, linkage.linkage.bodies, linkage.linkage.pins
    return motion.linkage.pins == pins and all(
        np.array_equal(moved[body][pin], given[body][pin]) for pin, bodies in pins.items() for body in bodies
    )


@checked
def least_transmission_angle(motion: Motion) -> Real:
    """Smallest transmission angle over the frames that are reached.

    Parameters
    ----------
    motion : Motion
        Motion of one or many linkages.

    Returns
    -------
    array, shape () or (linkages,)
        rad; nan if no frame has a transmission angle.

    Examples
    --------
    >>> import numpy as np
    >>> import geomkin as gk
    >>> motion = gk.move(gk.FourBar(100, 30, 90, 70), np.linspace(0, 2 * np.pi, 361))
    >>> float(np.degrees(gk.least_transmission_angle(motion)).round(1))
    50.0
    """
    least: Real = np.fmin.reduce(np.where(motion.assembled, motion.transmission_angle, np.nan), axis=0)
    return least


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
    parts: list[list[float]] = []
    for low, high, inside in zip(cuts[:-1].tolist(), cuts[1:].tolist(), closed(within).tolist()):
        if inside and parts and parts[-1][1] == low:
            parts[-1][1] = high
        elif inside:
            parts.append([low, high])
    return tuple((low, high) for low, high in parts)


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


def _whole(linkage: OneLinkage, branch: Branch) -> tuple[float, float] | None:
    """One turn, or the first and last displacement of a driving slide at which the linkage closes, or None."""
    general = linkage.linkage
    if general.driven_slider is None:
        return TURN
    spec, placements = as_branch_spec(branch), placements_for(general, branch)
    if spec.follow or spec.branch_points or any(isinstance(placement, Loops) for placement in placements):
        cause = "such a branch" if spec.follow or spec.branch_points else "the estimate"
        raise DesignError(
            "span",
            f"a slide drives, and {cause} needs a first position",
            "give a span that starts there",
            "missing-key",
        )
    extent = extent_of(general)
    outwards = np.geomspace(extent, FARTHEST * extent, LOOKS // 2)
    looks = np.concatenate([-outwards[:0:-1], np.linspace(-extent, extent, LOOKS + 1), outwards[1:]])

    def closed(q: Real) -> Mask:
        return move(linkage, q, branch).assembled

    ends = looks[[0, -1]]
    if closed(ends).any():
        raise DesignError(
            "span",
            "the linkage closes at unlimited displacements",
            f"give a span, such as {(-extent, extent)}",
            "missing-key",
        )
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


# Number of branches that are tried, those with the fewest changes first (six dyads have 64), and of frames at which
# they are compared.
TRIED, FRAMES = 64, 60
# Problem and remedy of each gap of a dyad that is below zero.
LACKS = {
    RRR: (
        ("its two links together are {} mm too short", "make one of them at least {} mm longer"),
        ("one of its two links is {} mm too long for the other", "make the longer one at least {} mm shorter"),
    ),
    RRP: (("its link is {} mm too short to reach the slide", "make it at least {} mm longer"),) * 2,
    ActuatedRRR: (
        ("the actuator is {} mm too long for its pins", "give a stroke at least {} mm shorter"),
        ("the actuator is {} mm too short for its pins", "give a stroke at least {} mm longer"),
    ),
    ActuatedRRP: (("the actuator is {} mm too short to reach the slide", "give a stroke at least {} mm longer"),),
    RPR: (("its pins are {} mm too close together for its offset", "make the offset at least {} mm smaller"),),
}


@record
class AssemblyFailure:
    """The first frame of a motion at which the linkage cannot be assembled, and the first dyad that is open there.

    Parameters
    ----------
    joint : str
        The dyad's inner joint; for bodies that are in no dyad their names.
    frame : int
        Index of the frame.
    drive : float
        The drive there, rad, or mm if a slider drives.
    lacking : float
        Length by which the dyad is open, mm; nan if there is none (parallel guides, loops that are not dyads).
    branch : mapping of str to int, or None
        Signs by joint for which the linkage can be assembled there, with the fewest changes among those that close at
        most frames; None if none was found.
    text : str
        The problem in words.
    remedy : str
        What to change on this branch.
    """

    joint: str
    frame: int
    drive: float
    lacking: float
    branch: Mapping[str, int] | None
    text: str
    remedy: str

    def __str__(self) -> str:
        return self.text


@checked
def assembly_failure(motion: Motion) -> AssemblyFailure | None:
    """The first frame of a motion that is open, and the reason.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.

    Returns
    -------
    AssemblyFailure or None
        None if every frame is closed.

    Raises
    ------
    DesignError
        If the motion is of arrays of linkages.

    Notes
    -----
    Derived here, from the gaps by which each dyad is open.
    """
    if motion.assembled.ndim > 1:
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time", "wrong-type")
    if motion.assembled.all():
        return None
    frame = int(np.argmin(motion.assembled))
    drive, solution = float(motion.drive[frame]), motion.solution
    open_placement = next(placement for placement in solution.placements if _open(placement, solution, frame))
    turns = isinstance(solution.placements[0], RevoluteInput)
    at = f"at {printable(motion.linkage.driver)} {_shown(drive, turns)}"
    kind = type(open_placement.dyad) if isinstance(open_placement, DrivenRRR | DrivenRRP) else type(open_placement)
    if isinstance(open_placement, Dyad):
        gaps = [
            float(np.broadcast_to(gap, motion.assembled.shape)[frame]) for gap in open_placement.gaps(solution.poses)
        ]
        lacking, (problem, remedy) = min(zip([-gap for gap in gaps], LACKS[kind]), key=lambda row: -row[0])
        # If only rounding opens it there is no length to report.
        lacking = max(lacking, 0.0)
        number = f"{lacking * 1.0005:.4g}"
        name, text, remedy = open_placement.joint, problem.format(f"{lacking:.4g}"), remedy.format(number)
        text = f"the dyad at {printable(name)} opens first, {at}: {text}"
    else:
        assert isinstance(open_placement, Loops | Crossed)
        bodies = open_placement.waiting if isinstance(open_placement, Loops) else (open_placement.body,)
        name, lacking = ", ".join(bodies), np.nan
        text = f"{printable(name)} cannot be placed, {at}"
        remedy = "turn its guides so that they are not parallel, or give another estimate of its pins"
    branch = _closing(motion, solution, frame, open_placement)
    if branch is not None:
        changed = {joint: sign for joint, sign in branch.items() if sign != solution.signs[joint][frame]}
        signs = ", ".join(f"{printable(joint)} = {sign}" for joint, sign in changed.items())
        text += f"; it closes there with {signs}"
    return AssemblyFailure(name, frame, drive, lacking, branch, text, remedy)


def assembly_error(motion: Motion) -> DesignError:
    """The error for a motion that is open at every frame, with the branch, the drives or the length that closes it."""
    failure = assembly_failure(motion)
    assert failure is not None
    remedy = failure.remedy
    if failure.branch is not None:
        remedy = "take that branch"
    elif not np.isnan(failure.lacking) and (parts := _reached(motion, failure)):
        driver = motion.linkage.driver
        remedy = f"drive the {printable(driver)} between {' or '.join(parts)}"
    return DesignError("drive", f"the linkage closes at no frame; {failure.text}", remedy, "does-not-assemble")


def _open(placement: Placement, solution: LinkageSolution, frame: int) -> bool:
    reached = placement.reached(solution.poses)
    return reached is not None and not np.isfinite(np.broadcast_to(reached, solution.shape)[frame])


def _shown(drive: float, turns: bool) -> str:
    return f"{np.degrees(drive):.6g} deg" if turns else f"{drive:.6g} mm"


def _closing(motion: Motion, solution: LinkageSolution, frame: int, opened: Placement) -> dict[str, int] | None:
    """Signs for which the linkage closes at a frame; the sign of a dyad only affects the dyads after it."""
    current = {joint: int(signs[frame]) or 1 for joint, signs in solution.signs.items()}
    before = solution.placements[: solution.placements.index(opened)]
    joints = [dyad.joint for dyad in before if isinstance(dyad, Dyad)]
    drives = np.append(motion.drive[frame], motion.drive[:: len(motion.drive) // FRAMES + 1])
    best: tuple[float, dict[str, int]] = (0.0, {})
    for changed in islice(_choices(joints), TRIED):
        signs = current | {joint: -current[joint] for joint in changed}
        closed = move(solution.linkage, drives, _fixed(solution, signs)).assembled
        if closed[0] and closed.mean() > best[0]:
            best = float(closed.mean()), signs
    return best[1] or None


def _fixed(solution: LinkageSolution, signs: Mapping[str, int]) -> BranchSpec:
    """These signs, with the given positions, from which loops start."""
    return BranchSpec(1, signs, solution.spec.branch_points, False)


def _choices(joints: Sequence[str]) -> Iterator[tuple[str, ...]]:
    return (some for count in range(1, len(joints) + 1) for some in combinations(joints, count))


def _reached(motion: Motion, failure: AssemblyFailure) -> list[str]:
    """The driver's ranges in which the linkage closes on the branch of the failure, as text, rounded inwards."""
    solution = motion.solution
    turns = isinstance(solution.placements[0], RevoluteInput)
    extent = extent_of(solution.linkage)
    # One turn that starts at the open drive, so that no range is cut in two.
    span = (failure.drive, failure.drive + 2 * np.pi) if turns else (-extent, extent)
    signs = {joint: int(row[failure.frame]) or 1 for joint, row in solution.signs.items()}
    texts = []
    for part in driver_limits(solution.linkage, _fixed(solution, signs), span):
        whole = 2 * np.pi * np.round(np.mean(part) / (2 * np.pi)) if turns else 0.0
        part = (part[0] - whole, part[1] - whole)
        low, high = np.degrees(part) if turns else part
        step = 10.0 ** np.floor(np.log10(high - low) - 2)
        low, high = np.ceil(low / step) * step, np.floor(high / step) * step
        texts.append(f"{low:.10g} and {high:.10g} {'deg' if turns else 'mm'}")
    return texts
