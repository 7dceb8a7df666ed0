"""The stretches of a tooth that never touch its mate, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...plane.curve import AbstractCurve
from .conjugate_curve import ConjugateCurve, Run
from .envelope import Step, Swept

MISSES = "its normals miss the pitch circle"
CUTS = "touching it would cut the mate's own flank away"
TRIMMED = "another part of the tooth cuts away what it would touch"
BEYOND = "the mate's teeth end before it"


@dataclass(frozen=True)
class Untouched:
    """A stretch of a tooth that never touches its mate.

    start, end: parameters of the tooth's curve; inner_radius, outer_radius: its least and largest distance from
    the gear's axis, mm; why: what keeps it from touching.
    """

    start: float
    end: float
    inner_radius: float
    outer_radius: float
    why: str


def touched(steps: tuple[Step, ...] | list[Step]) -> list[tuple[ConjugateCurve, float, float]]:
    """Curves of the boundary that stretches of the tooth left, and the tooth's parameters between which they did."""
    found = []
    for step in steps:
        if isinstance(step.curve.side, Run):
            low, high = np.sort(step.curve.tooth_parameter([step.start, step.end])).tolist()
            found.append((step.curve, low, high))
    return found


def untouched(tooth: AbstractCurve, swept: Swept, steps: list[Step], tip: float, rising: bool) -> tuple[Untouched, ...]:
    """In order along the tooth; lands about the axis, which meet nothing but bottom lands, are left out.

    tip: radius of the mate's tips, which lie outside its flanks where `rising`.
    """
    kept = touched(steps)
    curves = [c for c in swept.curves if isinstance(c.side, Run)]
    ends = [c.tooth_parameter([c.start, c.end]) for c in curves]
    reached = [[c.first, c.last] for c in curves]
    edges = np.unique(np.concatenate([tooth.breaks, *reached, *ends, *([low, high] for _, low, high in kept)]))
    # Ends that differ by rounding bound nothing.
    edges = edges[np.append(True, np.diff(edges) > 1e-9 * (edges[-1] - edges[0]))]
    found: list[Untouched] = []
    for low, high in zip(edges.tolist(), edges[1:].tolist()):
        t = 0.5 * (low + high)
        if any(first <= t <= last for _, first, last in kept):
            continue
        radius = np.abs(tooth.point(np.linspace(low, high, 17)))
        if np.ptp(radius) <= 1e-9 * radius.max():
            continue
        why = _why(t, curves, ends, tip, rising)
        if found and found[-1].end == low and found[-1].why == why:
            before = found.pop()
            low, radius = before.start, np.append(radius, [before.inner_radius, before.outer_radius])
        found.append(Untouched(low, high, float(radius.min()), float(radius.max()), why))
    return tuple(found)


def _why(t: float, curves: list[ConjugateCurve], ends: list, tip: float, rising: bool) -> str:
    over = [c for c, (low, high) in zip(curves, ends) if low < t < high]
    if over:
        radii = [abs(complex(c.point(c.parameter_of(t)))) for c in over]
        beyond = [r > tip if rising else r < tip for r in radii]
        return BEYOND if all(beyond) else TRIMMED
    return CUTS if any(c.first < t < c.last for c in curves) else MISSES
