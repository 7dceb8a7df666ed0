"""Where and why a linkage does not close: the first dyad that opens, by how much, and the branch that closes it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, islice

import numpy as np

from ..arguments import checked
from ..brief import one_line
from ..errors import DesignError, printable
from .measures import driver_limits
from .motion import Motion
from .solve.actuators import ActuatedRRP, ActuatedRRR
from .solve.branch import Chosen
from .solve.driver_dyads import DrivenRRP, DrivenRRR
from .solve.dyads import RPR, RRP, RRR, Crossed, Dyad
from .solve.loops import Loops
from .solve.move import move
from .solve.placement import Placement, Turned
from .solve.solution import LinkageSolution, reach_of

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


@dataclass(frozen=True)
class Opening:
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

    __repr__ = one_line

    def __str__(self) -> str:
        return self.text


@checked
def opening(motion: Motion) -> Opening | None:
    """Where a motion first opens and what opens there; None where every frame is closed.

    DesignError for arrays of linkages: take one. Derived here, from how far each dyad is from closing.
    """
    if motion.closed.ndim > 1:
        raise DesignError("motion", f"found {motion.closed.shape[1:]} linkages", "give one at a time")
    if motion.closed.all():
        return None
    frame = int(np.argmin(motion.closed))
    drive, solution = float(motion.drive[frame]), motion.solution
    opened = next(one for one in solution.placements if _open(one, solution, frame))
    turns = isinstance(solution.placements[0], Turned)
    at = f"at {printable(motion.linkage.driver)} {_shown(drive, turns)}"
    kind = type(opened.dyad) if isinstance(opened, DrivenRRR | DrivenRRP) else type(opened)
    if isinstance(opened, Dyad):
        gaps = [float(np.broadcast_to(gap, motion.closed.shape)[frame]) for gap in opened.gaps(solution.poses)]
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
    return Opening(name, frame, drive, lacking, branch, text, remedy)


def never_closed(motion: Motion) -> DesignError:
    """The refusal of a motion that is open at every frame, with the branch, the drives or the length that closes it."""
    found = opening(motion)
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
        closed = move(solution.linkage, row, _fixed(solution, signs)).closed
        if closed[0] and closed.mean() > best[0]:
            best = float(closed.mean()), signs
    return best[1] or None


def _fixed(solution: LinkageSolution, signs: Mapping[str, int]) -> Chosen:
    """These signs, with the places that were given, from which what is no dyad starts."""
    return Chosen(1, signs, solution.asked.near, False)


def _choices(joints: Sequence[str]) -> Iterator[tuple[str, ...]]:
    return (some for count in range(1, len(joints) + 1) for some in combinations(joints, count))


def _reached(motion: Motion, found: Opening) -> list[str]:
    """The driver's ranges in which the linkage closes on the branch it opened on, as words, rounded inwards."""
    solution = motion.solution
    turns = isinstance(solution.placements[0], Turned)
    reach = reach_of(solution.linkage)
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
