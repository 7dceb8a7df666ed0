"""How far a driver goes, and where what it drives stands still."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..errors import DesignError
from ..plane.vec import Array, dot
from .closure import Driven
from .dyads import Dyad
from .loops import Loops
from .solve import Branch, Named, move, planned
from .steps import Step

# Parts that a whole way is looked at in. A gap, or a pair of dead centres, narrower than one is missed unless
# only the driver moves the dyad, whose limits are known in closed form.
LOOKS = 1440


def driver_limits(
    linkage: Named, branch: Branch = 1, span: tuple[float, float] = (0.0, 2 * np.pi)
) -> tuple[tuple[float, float], ...]:
    """The parts of `span` in which the linkage closes, each from its first to its last drive, rad or mm.

    A part ends at a limit of the driver, where a dyad is stretched or folded; there is none where
    the whole span is reached. Empty where nothing is.
    """
    start, end = span
    if not end > start:
        raise DesignError("span", f"found {span}", "give a rising pair")

    def closed(q: Array) -> Array:
        # From the start on, where a branch that is followed, or near given pins, is told.
        return move(linkage, np.append(start, q), branch).closed[1:]

    looks = np.linspace(start, end, LOOKS + 1)
    steps = planned(linkage.linkage, branch)
    ends = [start, end, *_exact(steps, span)]
    cuts = np.unique(ends + ([] if _all_driven(steps) else _changes(closed, looks)))
    middles = 0.5 * (cuts[:-1] + cuts[1:])
    parts: list[list[float]] = []
    for low, high, inside in zip(cuts[:-1].tolist(), cuts[1:].tolist(), closed(middles).tolist()):
        if inside and parts and parts[-1][1] == low:
            parts[-1][1] = high
        elif inside:
            parts.append([low, high])
    return tuple((low, high) for low, high in parts)


def dead_centres(
    linkage: Named, output: str, branch: Branch = 1, span: tuple[float, float] = (0.0, 2 * np.pi)
) -> Array:
    """Drives, rising, (n,), at which the body `output` stands still and turns back: the ends of its swing or stroke."""
    general = linkage.linkage
    if output not in general.bodies or output == general.ground:
        raise DesignError("output", f"found {output!r}", f"give one of {', '.join(list(general.bodies)[1:])}")

    looks = np.linspace(*span, LOOKS + 1)
    body = move(linkage, looks, branch).bodies[output]
    # A body that only slides goes along one line: that of its largest step.
    steps = np.nan_to_num(body.origin.first, nan=0.0, posinf=0.0, neginf=0.0)
    line = None if np.nan_to_num(body.first).any() else steps[np.argmax(np.abs(steps))]

    def way(q: Array) -> Array:
        moved = move(linkage, np.append(span[0], q), branch).bodies[output]
        return (moved.first if line is None else dot(line, moved.origin.first))[1:]

    values = way(looks)
    found = [*looks[values == 0].tolist(), *_crossings(way, looks, values)]
    return np.unique(np.array(found))


def _all_driven(steps: Sequence[Step]) -> bool:
    return all(isinstance(s, Driven) or not isinstance(s, (Dyad, Loops)) for s in steps)


def _exact(steps: Sequence[Step], span: tuple[float, float]) -> list[float]:
    """Limits of the dyads that the driver alone moves, in closed form, inside the span."""
    found: list[float] = []
    for step in steps:
        if isinstance(step, Driven):
            for limit in step.limits():
                turns = np.arange(
                    np.floor((span[0] - limit) / (2 * np.pi)), np.ceil((span[1] - limit) / (2 * np.pi)) + 1
                )
                found += [q for q in (limit + 2 * np.pi * turns).tolist() if span[0] < q < span[1]]
    return found


def _changes(closed: Callable[[Array], Array], looks: Array) -> list[float]:
    """Where `closed` changes between two looks, by halving to the last bit."""
    state = closed(looks)
    at = np.flatnonzero(state[1:] != state[:-1])
    low, high, inside = looks[at], looks[at + 1], state[at]
    for _ in range(60 if at.size else 0):
        middle = 0.5 * (low + high)
        same = closed(middle) == inside
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return np.where(inside, low, high).tolist()


def _crossings(f: Callable[[Array], Array], looks: Array, values: Array) -> list[float]:
    """Zeros of f between neighbouring looks of opposite sign, by halving; a jump through infinity is none."""
    with np.errstate(invalid="ignore"):
        at = np.flatnonzero(values[1:] * values[:-1] < 0)
    low, high, sign = looks[at], looks[at + 1], np.sign(values[at])
    for _ in range(60 if at.size else 0):
        middle = 0.5 * (low + high)
        same = np.sign(f(middle)) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    ends = np.abs(f(low)) if at.size else np.empty(0)
    calm = ends <= np.minimum(np.abs(values[at]), np.abs(values[at + 1]))
    return low[calm].tolist()
