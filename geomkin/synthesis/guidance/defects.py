"""Exact rules that decide whether a linkage that reaches all positions can also move from each one to the next."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole, cross

# Relative distance from a change point below which a limit of the driver counts as one. With a smaller value the
# rounding of a parallelogram's sides decides; a larger one hides narrow real gaps.
CHANGE_POINT = 1e-9


@record(eq=False, kw_only=True)
class Defects:
    """Defects that keep linkages from passing positions in order with the driver moving in one sense.

    Arrays have the shape (linkages,) unless stated otherwise.

    `circuit`: some positions are reached only by disassembly. `branch`: between positions of one circuit the driver
    must pass a dead centre or a change point, where the motion is undetermined. `order`: the positions are passed in
    another order; reported only without the other two. `drive`: (positions, linkages), unwrapped along the possible
    motion, rad from the ground line or mm. `sign`: (positions, linkages), the branch as `move` takes it. `margin`:
    least distance from a decision by a sign, as a share of the linkage's size or in rad; below 1e-9 rounding decided.
    """

    circuit: Mask
    branch: Mask
    order: Mask
    drive: Real
    sign: Whole
    margin: Real

    @property
    def none(self) -> Mask:
        """Whether there are no defects, (linkages,)."""
        return ~(self.circuit | self.branch | self.order)

    def named(self, k: int) -> tuple[str, ...]:
        """Names of the defects of the k-th linkage."""
        return tuple(name for name in ("circuit", "branch", "order") if getattr(self, name)[k])


def four_bar_defects(
    ground: Real,
    crank: Real,
    coupler: Real,
    rocker: Real,
    directions: tuple[Complex, Complex, Complex],
) -> Defects:
    """Defects of four-bars driven by the crank, lengths (linkages,), at positions with the given directions.

    `directions` of crank, coupler and rocker are unit complex, (positions, linkages), from the ground line. The crank
    is blocked around the direction folded on the ground if |ground - crank| < |coupler - rocker|, and around the
    stretched one if ground + crank > coupler + rocker; so it turns fully, or has one range, or two. A circuit is then
    one side of the rocker pin, or everything, or one range. This is the rule of Grashof's joints (Chase and Mirth,
    Circuits and branches of single-degree-of-freedom planar linkages, Journal of Mechanical Design 115, 1993) in a form
    that also gives the ranges; derived here. A change point counts as a limit.
    """
    at_crank, at_coupler, at_rocker = directions
    size = ground + crank + coupler + rocker
    folded = (np.abs(ground - crank) - np.abs(coupler - rocker)) / size
    stretched = (coupler + rocker - ground - crank) / size
    return _of_turning(at_crank, cross(at_coupler, at_rocker), folded, stretched)


def slider_crank_defects(
    crank: Real,
    coupler: Real,
    offset: Real,
    directions: tuple[Complex, Complex],
    slide: Real,
    driver: Literal["crank", "slider"] = "crank",
) -> Defects:
    """Defects of slider-cranks, (linkages,), at positions with the given directions of crank and coupler.

    `directions` are unit complex, (positions, linkages), from the slide line; `slide` is the slider's x, mm,
    (positions, linkages). A crank is blocked around the normal of the slide line that points to it if crank - offset >
    coupler, and around the other if crank + offset > coupler. A slider has two ranges, one on each side, if |crank -
    coupler| > |offset|, else one. Derived here.
    """
    at_crank, at_coupler = directions
    size = crank + coupler + np.abs(offset)
    if driver == "crank":
        towards, away = (coupler - crank + offset) / size, (coupler - crank - offset) / size
        return _turned(_of_turning(-1j * at_crank, at_coupler.real, towards, away), np.pi / 2)
    folded = (np.abs(offset) - np.abs(crank - coupler)) / size
    return _of_sliding(slide, cross(at_coupler, at_crank), folded, size)


def trammel_defects(rod: Real, directions: Complex, slot: Complex, shuttle: Real, driver: str = "rod") -> Defects:
    """Defects of elliptic trammels, (linkages,), at positions with the given directions of the rod from the first slot.

    `directions` are unit complex, (positions, linkages); `slot` is the direction of the second slot, unit complex,
    (linkages,); `shuttle` is the position of the first shuttle on its slot, mm, (positions, linkages). The rod turns
    fully with one position at each angle; a shuttle has one range. Derived here.
    """
    free = np.ones_like(rod)
    if driver == "rod":
        return _of_turning(directions, np.ones(np.shape(directions)), free, free)
    return _of_sliding(shuttle, (directions * np.conj(slot)).real, free, rod)


def _of_turning(ahead: Complex, side: Real, near: Real, far: Real) -> Defects:
    """Defects with a rotating driver.

    `ahead` is its direction from that of one limit, `side` the sine of the angle that separates branches. `near` and
    `far` are negative if it is blocked straight ahead and straight behind, as shares of the size.
    """
    before, behind, meets = (
        near < CHANGE_POINT,
        far < CHANGE_POINT,
        (np.abs(near) < CHANGE_POINT) | (np.abs(far) < CHANGE_POINT),
    )
    angle, both, whole = np.angle(ahead), before & behind, ~before & ~behind
    part = np.where(both, np.sign(angle), 1.0)
    angle = np.where(before & ~behind, np.mod(angle, 2 * np.pi), angle)
    sign = np.where(side < 0, -1, 1)
    circuit = np.where(meets, 1, np.where(whole, sign, part))
    # On a full turn the motion starts anywhere and covers at most one turn.
    left, right = (np.mod(sense * np.diff(angle, axis=0), 2 * np.pi) for sense in (1, -1))
    totals = left.sum(axis=0), right.sum(axis=0)
    steps = np.where(totals[0] <= totals[1], left, -right)
    round_trip = np.concatenate([angle[:1], angle[:1] + np.cumsum(steps, axis=0)])
    drive = np.where(whole, round_trip, angle)
    order = np.where(whole, np.minimum(*totals) >= 2 * np.pi, ~_one_way(angle))
    edge = np.where(both, np.abs(ahead.imag).min(axis=0), 1.0)
    apart = np.abs(np.angle(ahead[1:] * np.conj(ahead[:-1]))).min(axis=0, initial=1.0)
    limits = np.minimum(np.abs(near), np.abs(far))
    return _defects(circuit, sign, part, drive, order, side, np.minimum.reduce([edge, apart, limits]))


def _of_sliding(place: Real, side: Real, near: Real, size: Real) -> Defects:
    """Defects with a driver that slides between two limits and is blocked about the middle if `near` is negative."""
    blocked = near < CHANGE_POINT
    part = np.where(blocked, np.sign(place), 1.0)
    circuit = np.where(np.abs(near) < CHANGE_POINT, 1.0, part)
    edge = np.where(blocked, np.abs(place / size).min(axis=0), 1.0)
    apart = np.abs(np.diff(place / size, axis=0)).min(axis=0, initial=1.0)
    sign = np.where(side < 0, -1, 1)
    margin = np.minimum.reduce([edge, apart, np.abs(near)])
    return _defects(circuit, sign, part, place, ~_one_way(place), side, margin)


def _defects(circuit: Real, sign: Whole, part: Real, drive: Real, order: Mask, side: Real, margin: Real) -> Defects:
    apart = _differ(circuit)
    # The positions of a circuit are on one branch if they have the same sign and the same range of the drive.
    branch = np.zeros_like(apart)
    for sign_of_circuit in (1, -1):
        for label in (sign, part):
            here = np.where(circuit == sign_of_circuit, label, 0)
            branch |= (here > 0).any(axis=0) & (here < 0).any(axis=0)
    margin = np.minimum(margin, np.abs(side).min(axis=0))
    return Defects(circuit=apart, branch=branch, order=order & ~apart & ~branch, drive=drive, sign=sign, margin=margin)


def _turned(found: Defects, by: float) -> Defects:
    return Defects(**{**vars(found), "drive": found.drive + by})


def _differ(labels: Real) -> Mask:
    apart: Mask = (labels != labels[:1]).any(axis=0)
    return apart


def _one_way(values: Real) -> Mask:
    steps = np.diff(values, axis=0)
    return np.asarray((steps > 0).all(axis=0) | (steps < 0).all(axis=0))


# The functions below take sizes (linkages,), mm, and start and end of the drive (linkages,), unwrapped, and return the
# least acute transmission angle between, rad. It is monotonic between the drives listed, so its minimum is at one.


def of_four_bars(ground: Real, crank: Real, coupler: Real, rocker: Real, start: Real, end: Real) -> Real:
    """Driven by the crank: the angle at the rocker pin depends on the diagonal, which is monotonic from 0 to pi."""
    turns = [start, end, _passed(start, end, 0.0), _passed(start, end, np.pi)]
    # By half angles, so that the distance keeps its digits when crank and ground are folded. The acute angle rises up
    # to a right one and falls from there on, so its minimum is at the shortest or the longest diagonal.
    sines = [np.abs(np.sin(t / 2)) for t in turns]
    ends = (
        np.hypot(ground - crank, 2 * np.sqrt(ground * crank) * sine)
        for sine in (np.minimum.reduce(sines), np.maximum.reduce(sines))
    )
    return np.minimum(*(acute_at(coupler, rocker, end) for end in ends))


def of_slider_cranks(crank: Real, coupler: Real, offset: Real, start: Real, end: Real) -> Real:
    """Driven by the crank: the angle between coupler and slide normal depends on the height of the crank pin."""
    turns = [start, end, _passed(start, end, np.pi / 2), _passed(start, end, -np.pi / 2)]
    least: Real = np.minimum.reduce([_beside(offset - crank * np.sin(t), coupler) for t in turns])
    return least


def of_driving_slides(crank: Real, coupler: Real, offset: Real, start: Real, end: Real) -> Real:
    """Driven by the slider: the angle between crank and coupler depends on the distance of their ends."""
    middle = np.where(start * end < 0, 0.0, start)
    least: Real = np.minimum.reduce([acute_at(crank, coupler, np.hypot(x, offset)) for x in (start, end, middle)])
    return least


def of_driving_shuttles(rod: Real, sine: Real, start: Real, end: Real) -> Real:
    """Driven by a trammel's first shuttle: the angle between the rod and the second slot's normal; `sine` is of the
    slots.
    """
    return np.minimum(*(_beside(x * sine, rod) for x in (start, end)))


def acute_at(one: Real, other: Real, across: Real) -> Real:
    """The acute angle between two sides of a triangle with the given third side; 0 if they do not close."""
    inner = np.maximum((across - one + other) * (across + one - other), 0.0)
    outer = np.maximum((one + other - across) * (one + other + across), 0.0)
    half: Real = np.arctan2(np.sqrt(np.minimum(inner, outer)), np.sqrt(np.maximum(inner, outer)))
    return 2 * half


def _beside(height: Real, length: Real) -> Real:
    """Complement of the angle at which a bar of a given length reaches a given height."""
    return np.arctan2(np.sqrt(np.maximum((length - height) * (length + height), 0.0)), np.abs(height))


def _passed(start: Real, end: Real, angle: float) -> Real:
    """The drive at `angle`, if the motion passes it up to full turns, else its start."""
    low, high = np.minimum(start, end), np.maximum(start, end)
    over = np.floor((high - angle) / (2 * np.pi)) >= np.ceil((low - angle) / (2 * np.pi))
    return np.where(over, angle, start)
