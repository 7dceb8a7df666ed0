"""How far a driver goes, and where what it drives stands still."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..arguments import checked
from ..errors import DesignError
from ..plane.vec import Array, dot
from .closure import Driven
from .dyads import Dyad
from .loops import Loops
from .solve import Branch, OneLinkage, move, planned
from .steps import Step

# Parts that a whole way is looked at in. A gap, or a pair of dead centres, narrower than one is missed unless
# only the driver moves the dyad, whose limits are known in closed form.
LOOKS = 1440
# Turning over the linkage's size as a share of sliding: what is less is rounding of a body that only slides, what
# is more a body that turns.
STILL = 1e-9


@checked
def driver_limits(
    linkage: OneLinkage, branch: Branch = 1, span: tuple[float, float] = (0.0, 2 * np.pi)
) -> tuple[tuple[float, float], ...]:
    """The parts of `span` in which the linkage closes, each from its first to its last drive, rad or mm.

    A part ends at a limit of the driver, where a dyad is stretched or folded; there is none where
    the whole span is reached. Empty where nothing is. A linkage that is no chain of dyads is followed from the start of
    the span, where its estimate holds, to its first limit.
    """
    start, end = span
    if not end > start:
        raise DesignError("span", f"found {span}", "give a rising pair")

    def closed(q: Array) -> Array:
        # From the start on, where a branch that is followed, or near given pins, is told, and where an estimate holds.
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


@checked
def dead_centres(
    linkage: OneLinkage, output: str, branch: Branch = 1, span: tuple[float, float] = (0.0, 2 * np.pi)
) -> Array:
    """Drives, rising, (n,), at which the body `output` stands still and turns back: the ends of its swing or stroke."""
    general = linkage.linkage
    if output not in general.bodies or output == general.ground:
        raise DesignError("output", f"found {output!r}", f"give one of {', '.join(list(general.bodies)[1:])}")

    looks = np.linspace(*span, LOOKS + 1)
    body = move(linkage, looks, branch).bodies[output]
    # A body that only slides goes along one line: that of its largest step.
    steps = np.nan_to_num(body.origin.first, nan=0.0, posinf=0.0, neginf=0.0)
    largest = steps[np.argmax(np.abs(steps))]
    turning = np.abs(np.nan_to_num(body.first, nan=0.0, posinf=0.0, neginf=0.0)).max()
    places = (z for points in general.bodies.values() for z in points.values())
    reach = max((float(np.abs(z).max()) for z in places), default=0.0) or 1.0
    line = None if turning * reach > STILL * abs(largest) else largest

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
                turns = np.zeros(1)
                if step.period:
                    turns = np.arange(
                        np.floor((span[0] - limit) / step.period), np.ceil((span[1] - limit) / step.period) + 1
                    )
                found += [q for q in (limit + step.period * turns).tolist() if span[0] < q < span[1]]
    return found


def _changes(closed: Callable[[Array], Array], looks: Array) -> list[float]:
    """Where `closed` changes between two looks, to the last bit."""
    state = closed(looks)
    at = np.flatnonzero(state[1:] != state[:-1])
    low, high = _narrowed(closed, looks[at], looks[at + 1], state[at])
    return np.where(state[at], low, high).tolist()


def _crossings(f: Callable[[Array], Array], looks: Array, values: Array) -> list[float]:
    """Zeros of f between neighbouring looks of opposite sign; a jump through infinity is none."""
    with np.errstate(invalid="ignore"):
        at = np.flatnonzero(values[1:] * values[:-1] < 0)
    low, _ = _narrowed(lambda q: np.sign(f(q)), looks[at], looks[at + 1], np.sign(values[at]))
    ends = np.abs(f(low)) if at.size else np.empty(0)
    calm = ends <= np.minimum(np.abs(values[at]), np.abs(values[at + 1]))
    return low[calm].tolist()


def _narrowed(f: Callable[[Array], Array], low: Array, high: Array, start: Array) -> tuple[Array, Array]:
    """Neighbouring numbers between which f, `start` at each low end and something else at the high one, changes."""
    # Sixteen parts at a time: four bits for one call of f, which costs little more for a row than for one place.
    while np.any(np.nextafter(low, high) < high):
        places = np.linspace(low, high, 17)
        same = (f(places.ravel()).reshape(places.shape) == start) & (places < high)
        same[0] = True
        last = np.argmin(same, axis=0) - 1
        low, high = (np.take_along_axis(places, k[None], axis=0)[0] for k in (last, last + 1))
    return low, high
