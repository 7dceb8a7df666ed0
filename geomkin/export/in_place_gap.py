"""The smallest gap between the parts of an assembly that is printed in one piece."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from ..core.records import record
from ..plane import region
from ..plane.flatten import flatten
from ..plane.vec import Complex, box_of
from .still import InPlace

# Heights at which the sections of twisted parts are compared, over half of a herringbone: at each the teeth are in
# another phase of their mesh, in which the gaps of involutes are the same.
LEVELS = 16


@record
class Gap:
    """A lower bound of the smallest gap, mm, and the names of the two parts."""

    size: float
    parts: tuple[str, str]


def smallest_gap(placed: Sequence[InPlace], tolerance: float) -> Gap | None:
    """The smallest gap of any two parts, in all layers that both are in; None for a single part.

    Parts that lie on each other have none. tolerance: of the chords that are compared, mm, which counts as lost.
    """
    loops = [[flatten(curve, tolerance) for curve in (one.part.outline, *one.part.holes)] for one in placed]
    least: Gap | None = None
    for (one, its), (other, others) in combinations(zip(placed, loops), 2):
        for share in _shares(one, other):
            a, b = _section(one, its, share), _section(other, others, share)
            if least is None or _boxes_apart(a[0], b[0]) < least.size + 2 * tolerance:
                size = max(0.0, region.apart(a, b) - 2 * tolerance)
                if least is None or size < least.size:
                    least = Gap(size, (one.name, other.name))
    return least


def _shares(one: InPlace, other: InPlace) -> Iterator[float]:
    """Shares of the height at which sections are compared; none for parts with air between them."""
    low, high = max(one.height, other.height), min(part.height + part.part.thickness for part in (one, other))
    if high < low - 1e-9:
        return
    if one.part.twist is None and other.part.twist is None:
        yield 0.0
    else:
        yield from np.linspace(0, 0.5 if one.part.twist and one.part.twist.herringbone else 1, LEVELS).tolist()


def _section(one: InPlace, loops: Sequence[Complex], share: float) -> list[Complex]:
    """The outline and the holes of a part in its place, at a share of its height."""
    twist = one.part.twist
    moved = [
        loop if twist is None or (k == 0) != (twist.moves == "outline") else np.asarray(twist.at(share).place(loop))
        for k, loop in enumerate(loops)
    ]
    return [one.origin + one.direction * loop for loop in moved]


def _boxes_apart(a: Complex, b: Complex) -> float:
    """Distance of the boxes of two loops, mm."""
    (low, high), (other_low, other_high) = box_of(a), box_of(b)
    gap = np.array([other_low - high, low - other_high])
    return float(np.hypot(max(gap.real.max(), 0.0), max(gap.imag.max(), 0.0)))
