"""What designers judge a linkage by: which links turn fully, circuits, transmission angle, limits and dead centres."""

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

# Parts that a whole way is looked at in. A gap, or a pair of dead centres, narrower than one is missed unless
# only the driver moves the dyad, whose limits are known in closed form.
LOOKS = 1440
TURN = (0.0, 2 * np.pi)
# Reaches of the linkage within which a driving slide is looked for, ever coarser outwards: a slide whose limits lie
# farther is taken for one without limits. Larger, and rails that rounding alone turns would give it some.
FARTHEST = 1e6
# Times that the place where a dyad comes nearest to closing is narrowed to an eighth: its gap is flat there, so that
# half of all digits tell all of them. Fewer, and a linkage that closes at hardly more than one place is missed.
NARROWED = 10
# Share of its largest speed below which a body that does not turn counts as standing still, where its speed along one
# line changes its sign. Smaller, and what such a place is told with is lost; larger tells where it goes square to that.
RESTING = 1e-6
# Share of a part at which it is looked at whether it closes: half of it may be where two guides stand parallel for a
# moment, and the part would be lost. Nearer to an end, and rounding of that end may decide.
WITHIN = 0.381966


class Grashof(NamedTuple):
    """Grashof's inequality of a four-bar: the shortest link can turn fully if `spare` is not negative.

    shortest, longest: names of the links. shortest_and_longest, other_two: their lengths together, mm. type: as
    `grashof_type` has it.
    """

    type: str
    shortest: str
    longest: str
    shortest_and_longest: float
    other_two: float

    @property
    def spare(self) -> float:
        """By how much the other two are longer than shortest and longest together, mm."""
        return self.other_two - self.shortest_and_longest


@checked
def grashof(linkage: FourBar) -> Grashof:
    """Grashof's inequality with its numbers: shortest + longest against the other two links (Grashof, 1883)."""
    lengths = {name: float(getattr(linkage, name)) for name in ("ground", "crank", "coupler", "rocker")}
    shortest, *others, longest = sorted(lengths, key=lengths.__getitem__)
    sums = lengths[shortest] + lengths[longest], lengths[others[0]] + lengths[others[1]]
    spare = sums[1] - sums[0]
    types = {"crank": "crank-rocker", "ground": "double-crank", "rocker": "rocker-crank", "coupler": "double-rocker"}
    name = types[shortest] if spare > 0 else "triple-rocker"
    if abs(spare) <= 1e-12 * lengths[longest]:
        name = "change-point"
    return Grashof(name, shortest, longest, *sums)


@checked
def grashof_type(linkage: FourBar) -> str:
    """Which links turn fully: by the shortest link if shortest + longest is no more than the other two (Grashof, 1883).

    crank-rocker, double-crank, rocker-crank, double-rocker (the coupler turns), change-point (the sums
    are equal, to rounding), triple-rocker.
    """
    return grashof(linkage).type


@checked
def circuits(linkage: FourBar | SliderCrank, motion: Motion) -> Whole:
    """The circuit of each frame, +1 or -1: poses of one sign are reached from each other without taking it apart.

    0 where open; +1 throughout where there is one circuit only. Of a Grashof four-bar the sign of the angle at a
    joint not adjacent to the shortest link; of a slider-crank whose crank turns fully the side on which the
    slider stands, and where the connecting rod turns fully the side on which the crank does (Chase and Mirth, Circuits
    and branches of single-degree-of-freedom planar linkages, Journal of Mechanical Design 115, 1993).
    """
    if not _is_of(motion, linkage):
        raise DesignError("motion", "it is of another linkage", "give the motion of this one")
    if isinstance(linkage, FourBar):
        inequality = grashof(linkage)
        # Each joint by the two links that meet there, the first one's x axis and the second's.
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
    """Whether a motion is of a linkage with these sizes, wherever it stands and whatever drives it."""
    one, two, pins = motion.linkage.bodies, linkage.linkage.bodies, linkage.linkage.pins
    return motion.linkage.pins == pins and all(
        np.array_equal(one[body][pin], two[body][pin]) for pin, bodies in pins.items() for body in bodies
    )


@checked
def least_transmission_angle(motion: Motion) -> Real:
    """Least transmission angle over the frames that are reached, rad, () or (linkages,); nan where none is."""
    least: Real = np.fmin.reduce(np.where(motion.assembled, motion.transmission_angle, np.nan), axis=0)
    return least


@checked
def driver_limits(
    linkage: OneLinkage, branch: Branch = 1, span: tuple[float, float] | None = None
) -> tuple[tuple[float, float], ...]:
    """The parts of `span` in which the linkage closes, each from its first to its last drive, rad or mm.

    Without a span it is one turn from 0, and of a driver that slides all places at which the linkage closes.
    DesignError where these have no end, and where a start has to be told: for a branch that is followed or near given
    pins, and for a linkage that is no chain of dyads. A span may fall, as a clockwise driver goes; the parts rise all
    the same. A part ends at a limit of the driver, where a dyad is stretched or folded; there is none where the whole
    span is reached. Empty where nothing is. A linkage that is no chain of dyads is followed from the start of the span,
    where its estimate holds, to its first limit. Derived here: in closed form where the driver alone moves a dyad, by
    bisection to the last bit elsewhere.
    """
    if span is None:
        span = _whole(linkage, branch)
        if span is None:
            return ()
    first, (low, high) = span[0], sorted(span)
    if not high > low:
        raise DesignError("span", f"found {span}", "give two different ends")

    def closed(q: Real) -> Mask:
        # From the start on, where a branch that is followed, or near given pins, is told, and where an estimate holds.
        way = 1 if first == low else -1
        return move(linkage, np.append(first, q[::way]), branch).assembled[1:][::way]

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
    """Drives, rising, (n,), at which the body `output` stands still and turns back: the ends of its swing or stroke.

    Without a span they are looked for in the one that `driver_limits` takes. Derived here: zeros of the body's
    first kinematic coefficient.
    """
    general = linkage.linkage
    if output not in general.bodies or output == general.ground:
        raise DesignError("output", f"found {output!r}", f"give one of {', '.join(list(general.bodies)[1:])}")
    if span is None:
        span = _whole(linkage, branch)
        if span is None:
            return np.empty(0)
    looks = np.linspace(*span, LOOKS + 1)
    motion = move(linkage, looks, branch)
    line = None
    if is_translating(motion, output):
        # It goes along one line: that of its largest step.
        steps = np.nan_to_num(motion.bodies[output].origin.first, nan=0.0, posinf=0.0, neginf=0.0)
        line = steps[np.argmax(np.abs(steps))]

    def way(q: Real) -> Real:
        moved = move(linkage, np.append(span[0], q), branch).bodies[output]
        return (moved.first if line is None else dot(line, moved.origin.first))[1:]

    values = way(looks)
    found = np.unique(np.array([*looks[values == 0].tolist(), *_crossings(way, looks, values)]))
    if line is not None and found.size:
        # Along a curve it may go square to that line, and go on.
        speed = np.abs(move(linkage, np.append(span[0], found), branch).bodies[output].origin.first)[1:]
        found = found[speed <= RESTING * np.abs(line)]
    return found


def _whole(linkage: OneLinkage, branch: Branch) -> tuple[float, float] | None:
    """One turn, or from the first to the last place of a driving slide at which the linkage closes; None if at none."""
    general = linkage.linkage
    if general.driven_slider is None:
        return TURN
    asked, placements = as_branch_spec(branch), placements_for(general, branch)
    if asked.follow or asked.branch_points or any(isinstance(one, Loops) for one in placements):
        first = "such a branch" if asked.follow or asked.branch_points else "the estimate"
        raise DesignError("span", f"a slide drives, and {first} needs a first place", "give a span that starts there")
    reach = extent_of(general)
    outwards = np.geomspace(reach, FARTHEST * reach, LOOKS // 2)
    looks = np.concatenate([-outwards[:0:-1], np.linspace(-reach, reach, LOOKS + 1), outwards[1:]])

    def closed(q: Real) -> Mask:
        return move(linkage, q, branch).assembled

    ends = looks[[0, -1]]
    if closed(ends).any():
        raise DesignError("span", "the linkage closes at places without end", f"give a span, such as {(-reach, reach)}")
    whole = with_branches(general, placements, looks, (), asked)
    looks = np.concatenate(
        [looks, _exact(placements, (float(ends[0]), float(ends[1]))), _nearest_to_closing(whole, looks)]
    )
    edges = _changes(closed, np.unique(looks))
    return (min(edges), max(edges)) if edges else None


def _nearest_to_closing(whole: DriveRange, looks: Real) -> Real:
    """Places between open looks at which a dyad comes nearest to closing, and there may close between two of them."""

    def least(q: Real) -> Real:
        """The least gap, mm, of those that are told; inf where none is."""
        with np.errstate(all="ignore"):
            p = whole.poses(q)
            dyads = [one for one in whole.placements if isinstance(one, Dyad)]
            gaps = [np.broadcast_to(gap, q.shape) for dyad in dyads for gap in dyad.gaps(p)]
        found: Real = np.fmin.reduce([*gaps, np.full(len(q), np.inf)])
        return found

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
    return all(isinstance(one, InputDyad) or not isinstance(one, (Dyad, Loops)) for one in placements)


def _exact(placements: Sequence[Placement], span: tuple[float, float]) -> list[float]:
    """Limits of the dyads that the driver alone moves, in closed form, inside the span."""
    found: list[float] = []
    for dyad in placements:
        if isinstance(dyad, InputDyad):
            for limit in dyad.limits():
                turns = np.zeros(1)
                if dyad.period:
                    turns = np.arange(
                        np.floor((span[0] - limit) / dyad.period), np.ceil((span[1] - limit) / dyad.period) + 1
                    )
                found += [q for q in (limit + dyad.period * turns).tolist() if span[0] < q < span[1]]
    return found


def _changes(closed: Callable[[Real], Mask], looks: Real) -> list[float]:
    """Where `closed` changes between two looks, to the last bit."""
    state = closed(looks)
    at = np.flatnonzero(state[1:] != state[:-1])
    low, high = _narrowed(closed, looks[at], looks[at + 1], state[at])
    changes: list[float] = np.where(state[at], low, high).tolist()
    return changes


def _crossings(f: Callable[[Real], Real], looks: Real, values: Real) -> list[float]:
    """Zeros of f between neighbouring looks of opposite sign; a jump through infinity is none."""
    with np.errstate(invalid="ignore"):
        at = np.flatnonzero(values[1:] * values[:-1] < 0)
    if not at.size:
        return []
    low, high = _narrowed(lambda q: np.sign(f(q)), looks[at], looks[at + 1], np.sign(values[at]))
    with np.errstate(invalid="ignore"):
        # Both ends together, as one may have been a last bit beside the zero from the start.
        grown = np.abs(f(low) / values[at]) * np.abs(f(high) / values[at + 1])
    zeros: list[float] = low[grown < 1].tolist()
    return zeros


def _narrowed(f: Callable[[Real], Real | Mask], low: Real, high: Real, start: Real | Mask) -> tuple[Real, Real]:
    """Neighbouring numbers between which f, `start` at each low end and something else at the high one, changes."""
    # Sixteen parts at a time: four bits for one call of f, which costs little more for a row than for one place.
    while np.any(np.nextafter(low, high) < high):
        places = np.linspace(low, high, 17)
        same = (f(places.ravel()).reshape(places.shape) == start) & (places < high)
        same[0] = True
        last = np.argmin(same, axis=0) - 1
        low, high = (np.take_along_axis(places, k[None], axis=0)[0] for k in (last, last + 1))
    return low, high


# Branches that are tried, those with the fewest changes first, and frames at which the ones that close are compared:
# six dyads have 64. More would make a message wait.
TRIED, FRAMES = 64, 60
# What each gap of a dyad is when it is below zero, and what would mend it.
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
    RPR: (("its pins are {} mm too near for its offset", "make the offset at least {} mm smaller"),),
}


@record
class AssemblyFailure:
    """The first frame of a motion that is open, and the first dyad, in the order they are placed, that opens there.

    joint: the dyad's inner joint; of what is no dyad the names of its bodies. frame: its index; drive: rad, or mm where
    a slider drives. lacking: mm by which the dyad does not close; nan where no length tells it (guides that stand
    parallel, loops that are no dyads). branch: signs by joint on which the linkage closes there, with the fewest
    changes of those that close at most frames; None where none was found. text: all this in words; remedy: what to
    change on this branch.
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
    """Where a motion first opens and what opens there; None where every frame is closed.

    DesignError for arrays of linkages: take one. Derived here, from how far each dyad is from closing.
    """
    if motion.assembled.ndim > 1:
        raise DesignError("motion", f"found {motion.assembled.shape[1:]} linkages", "give one at a time")
    if motion.assembled.all():
        return None
    frame = int(np.argmin(motion.assembled))
    drive, solution = float(motion.drive[frame]), motion.solution
    opened = next(one for one in solution.placements if _open(one, solution, frame))
    turns = isinstance(solution.placements[0], RevoluteInput)
    at = f"at {printable(motion.linkage.driver)} {_shown(drive, turns)}"
    kind = type(opened.dyad) if isinstance(opened, DrivenRRR | DrivenRRP) else type(opened)
    if isinstance(opened, Dyad):
        gaps = [float(np.broadcast_to(gap, motion.assembled.shape)[frame]) for gap in opened.gaps(solution.poses)]
        lacking, (problem, remedy) = min(zip([-gap for gap in gaps], LACKS[kind]), key=lambda row: -row[0])
        # Where rounding alone opens it there is no length to tell.
        lacking = max(lacking, 0.0)
        number = f"{lacking * 1.0005:.4g}"
        name, text, remedy = opened.joint, problem.format(f"{lacking:.4g}"), remedy.format(number)
        text = f"the dyad at {printable(name)} opens first, {at}: {text}"
    else:
        assert isinstance(opened, Loops | Crossed)
        bodies = opened.waiting if isinstance(opened, Loops) else (opened.body,)
        name, lacking = ", ".join(bodies), np.nan
        text = f"{printable(name)} cannot be placed, {at}"
        remedy = "turn its guides so that they do not stand parallel, or give another estimate of its pins"
    branch = _closing(motion, solution, frame, opened)
    if branch is not None:
        changed = {joint: sign for joint, sign in branch.items() if sign != solution.signs[joint][frame]}
        text += f"; it closes there with {', '.join(f'{printable(joint)} = {sign}' for joint, sign in changed.items())}"
    return AssemblyFailure(name, frame, drive, lacking, branch, text, remedy)


def assembly_error(motion: Motion) -> DesignError:
    """The refusal of a motion that is open at every frame, with the branch, the drives or the length that closes it."""
    found = assembly_failure(motion)
    assert found is not None
    remedy = found.remedy
    if found.branch is not None:
        remedy = "take that branch"
    elif not np.isnan(found.lacking) and (parts := _reached(motion, found)):
        driver = motion.linkage.driver
        remedy = f"drive the {printable(driver)} between {' or '.join(parts)}, where it closes"
    return DesignError("drive", f"the linkage closes at no frame; {found.text}", remedy)


def _open(one: Placement, solution: LinkageSolution, frame: int) -> bool:
    reached = one.reached(solution.poses)
    return reached is not None and not np.isfinite(np.broadcast_to(reached, solution.shape)[frame])


def _shown(drive: float, turns: bool) -> str:
    return f"{np.degrees(drive):.6g} deg" if turns else f"{drive:.6g} mm"


def _closing(motion: Motion, solution: LinkageSolution, frame: int, opened: Placement) -> dict[str, int] | None:
    """Signs on which the linkage closes at a frame: that of a dyad decides nothing of itself, but of those after it."""
    own = {joint: int(signs[frame]) or 1 for joint, signs in solution.signs.items()}
    placed = solution.placements[: solution.placements.index(opened)]
    before = [one.joint for one in placed if isinstance(one, Dyad)]
    row = np.append(motion.drive[frame], motion.drive[:: len(motion.drive) // FRAMES + 1])
    best: tuple[float, dict[str, int]] = (0.0, {})
    for flipped in islice(_choices(before), TRIED):
        signs = own | {joint: -own[joint] for joint in flipped}
        closed = move(solution.linkage, row, _fixed(solution, signs)).assembled
        if closed[0] and closed.mean() > best[0]:
            best = float(closed.mean()), signs
    return best[1] or None


def _fixed(solution: LinkageSolution, signs: Mapping[str, int]) -> BranchSpec:
    """These signs, with the places that were given, from which what is no dyad starts."""
    return BranchSpec(1, signs, solution.spec.branch_points, False)


def _choices(joints: Sequence[str]) -> Iterator[tuple[str, ...]]:
    return (some for count in range(1, len(joints) + 1) for some in combinations(joints, count))


def _reached(motion: Motion, found: AssemblyFailure) -> list[str]:
    """The driver's ranges in which the linkage closes on the branch it opened on, as words, rounded inwards."""
    solution = motion.solution
    turns = isinstance(solution.placements[0], RevoluteInput)
    reach = extent_of(solution.linkage)
    # From the open drive round to it again, so that no part is cut in two.
    span = (found.drive, found.drive + 2 * np.pi) if turns else (-reach, reach)
    signs = {joint: int(row[found.frame]) or 1 for joint, row in solution.signs.items()}
    words = []
    for part in driver_limits(solution.linkage, _fixed(solution, signs), span):
        whole = 2 * np.pi * np.round(np.mean(part) / (2 * np.pi)) if turns else 0.0
        part = (part[0] - whole, part[1] - whole)
        low, high = np.degrees(part) if turns else part
        step = 10.0 ** np.floor(np.log10(high - low) - 2)
        low, high = np.ceil(low / step) * step, np.floor(high / step) * step
        words.append(f"{low:.10g} and {high:.10g} {'deg' if turns else 'mm'}")
    return words
