"""Whether a linkage that can stand at every wanted place can also go from one to the next: the exact rule."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ...core.records import record
from ...plane.vec import Complex, Mask, Real, Whole, cross

# Share of the linkage's size by which a limit of the driver may miss a change point and still count as one. Smaller,
# and the rounding of a parallelogram's sides makes a gap of it, or a way through; larger, and narrow real gaps do.
MEETS = 1e-9


@record(eq=False, kw_only=True)
class Defects:
    """What keeps linkages from going through places in their order, in one drive of one sense; arrays (linkages,).

    circuit: some places are reached only by taking the linkage apart. branch: of two places on one circuit the
    driver would have to be helped over a dead centre, or through a change point, where nothing tells which way the
    linkage goes on. order: they are met in another order; told of linkages without the other two.
    drive: (places, linkages), the driver's, unwrapped on the way that is possible: rad from the ground line, or mm.
    sign: (places, linkages), the branch as `move` takes it. margin: the least distance, as a share of the linkage's
    size or in rad, of anything that was decided by a sign from the border: where it is below 1e-9 rounding decided.
    """

    circuit: Mask
    branch: Mask
    order: Mask
    drive: Real
    sign: Whole
    margin: Real

    @property
    def none(self) -> Mask:
        """Whether there are none, (linkages,)."""
        return ~(self.circuit | self.branch | self.order)

    def named(self, k: int) -> tuple[str, ...]:
        """Those of the k-th linkage by name."""
        return tuple(name for name in ("circuit", "branch", "order") if getattr(self, name)[k])


def four_bar_defects(
    ground: Real,
    crank: Real,
    coupler: Real,
    rocker: Real,
    directions: tuple[Complex, Complex, Complex],
) -> Defects:
    """Defects of four-bars that the crank drives, lengths (linkages,), at places where its links have `directions`.

    directions: of crank, coupler and rocker, unit, (places, linkages), from the ground line. The crank is blocked about
    the direction in which it lies folded on the ground where |ground - crank| < |coupler - rocker|, and about that in
    which it is stretched where ground + crank > coupler + rocker; so it turns fully, or has one range, or two. A
    circuit is then one side of the rocker pin, or all there is, or one range. That is the rule of Grashof's joints
    (Chase and Mirth, Circuits and branches of single-degree-of-freedom planar linkages, Journal of Mechanical Design
    115, 1993), written so that ranges are known as well; derived here. A change point counts as a limit.
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
    """Defects of slider-cranks, (linkages,), at places where crank and coupler have these `directions`.

    directions: unit, (places, linkages), from the slide line; slide: the slider's x, mm, (places, linkages). A crank
    is blocked about the normal of the slide line that points to it where crank - offset > coupler, and about the other
    where crank + offset > coupler. A slide has two ranges, one on each side, where |crank - coupler| > |offset|, else
    one. Derived here.
    """
    at_crank, at_coupler = directions
    size = crank + coupler + np.abs(offset)
    if driver == "crank":
        towards, away = (coupler - crank + offset) / size, (coupler - crank - offset) / size
        return _turned(_of_turning(-1j * at_crank, at_coupler.real, towards, away), np.pi / 2)
    folded = (np.abs(offset) - np.abs(crank - coupler)) / size
    return _of_sliding(slide, cross(at_coupler, at_crank), folded, size)


def trammel_defects(rod: Real, directions: Complex, slot: Complex, shuttle: Real, driver: str = "rod") -> Defects:
    """Defects of elliptic trammels, (linkages,), at places where the rod has these `directions`, from the first slot.

    directions: unit, (places, linkages); slot: direction of the second slot, unit, (linkages,); shuttle: the first
    shuttle's place on its slot, mm, (places, linkages). The rod turns fully, and there is one place at each angle; a
    shuttle has one range. Derived here.
    """
    free = np.ones_like(rod)
    if driver == "rod":
        return _of_turning(directions, np.ones(np.shape(directions)), free, free)
    return _of_sliding(shuttle, (directions * np.conj(slot)).real, free, rod)


def _of_turning(ahead: Complex, side: Real, near: Real, far: Real) -> Defects:
    """Of a driver that turns. ahead: its direction from that of one limit; side: sine of the angle that tells branches.

    near, far: below 0 where it is blocked straight ahead, and straight behind; shares of the size.
    """
    before, behind, meets = near < MEETS, far < MEETS, (np.abs(near) < MEETS) | (np.abs(far) < MEETS)
    angle, both, whole = np.angle(ahead), before & behind, ~before & ~behind
    part = np.where(both, np.sign(angle), 1.0)
    angle = np.where(before & ~behind, np.mod(angle, 2 * np.pi), angle)
    sign = np.where(side < 0, -1, 1)
    circuit = np.where(meets, 1, np.where(whole, sign, part))
    # On a full turn the way starts anywhere, and goes once round at most.
    left, right = (np.mod(way * np.diff(angle, axis=0), 2 * np.pi) for way in (1, -1))
    ways = left.sum(axis=0), right.sum(axis=0)
    steps = np.where(ways[0] <= ways[1], left, -right)
    round_trip = np.concatenate([angle[:1], angle[:1] + np.cumsum(steps, axis=0)])
    drive = np.where(whole, round_trip, angle)
    order = np.where(whole, np.minimum(*ways) >= 2 * np.pi, ~_one_way(angle))
    edge = np.where(both, np.abs(ahead.imag).min(axis=0), 1.0)
    apart = np.abs(np.angle(ahead[1:] * np.conj(ahead[:-1]))).min(axis=0, initial=1.0)
    limits = np.minimum(np.abs(near), np.abs(far))
    return _told(circuit, sign, part, drive, order, side, np.minimum.reduce([edge, apart, limits]))


def _of_sliding(place: Real, side: Real, near: Real, size: Real) -> Defects:
    """Of a driver that slides between two limits, and where `near` is below 0 is blocked about its middle."""
    blocked = near < MEETS
    part = np.where(blocked, np.sign(place), 1.0)
    circuit = np.where(np.abs(near) < MEETS, 1.0, part)
    edge = np.where(blocked, np.abs(place / size).min(axis=0), 1.0)
    apart = np.abs(np.diff(place / size, axis=0)).min(axis=0, initial=1.0)
    sign = np.where(side < 0, -1, 1)
    margin = np.minimum.reduce([edge, apart, np.abs(near)])
    return _told(circuit, sign, part, place, ~_one_way(place), side, margin)


def _told(circuit: Real, sign: Whole, part: Real, drive: Real, order: Mask, side: Real, margin: Real) -> Defects:
    apart = _differ(circuit)
    # Of each circuit for itself: its places are on one branch if they have one sign, and one part of the drive.
    branch = np.zeros_like(apart)
    for one in (1, -1):
        for told in (sign, part):
            here = np.where(circuit == one, told, 0)
            branch |= (here > 0).any(axis=0) & (here < 0).any(axis=0)
    margin = np.minimum(margin, np.abs(side).min(axis=0))
    return Defects(circuit=apart, branch=branch, order=order & ~apart & ~branch, drive=drive, sign=sign, margin=margin)


def _turned(found: Defects, by: float) -> Defects:
    return Defects(**{**vars(found), "drive": found.drive + by})


def _differ(told: Real) -> Mask:
    apart: Mask = (told != told[:1]).any(axis=0)
    return apart


def _one_way(values: Real) -> Mask:
    steps = np.diff(values, axis=0)
    return np.asarray((steps > 0).all(axis=0) | (steps < 0).all(axis=0))


# All of these: sizes (linkages,), mm; start and end of the drive (linkages,), unwrapped; the least acute angle on all
# of the way, rad. What it hangs on is steady between the drives named here, so that its least is at one of them.


def of_four_bars(ground: Real, crank: Real, coupler: Real, rocker: Real, start: Real, end: Real) -> Real:
    """The crank drives: the angle at the rocker pin hangs on the distance across, which is steady from 0 to pi."""
    turns = [start, end, _passed(start, end, 0.0), _passed(start, end, np.pi)]
    # By half angles: the distance keeps its digits where crank and ground lie folded.
    across = [np.hypot(ground - crank, 2 * np.sqrt(ground * crank) * np.sin(t / 2)) for t in turns]
    least: Real = np.minimum.reduce([acute_at(coupler, rocker, one) for one in across])
    return least


def of_slider_cranks(crank: Real, coupler: Real, offset: Real, start: Real, end: Real) -> Real:
    """The crank drives: between the coupler and the slide's normal; the pin's height is steady between its normals."""
    turns = [start, end, _passed(start, end, np.pi / 2), _passed(start, end, -np.pi / 2)]
    least: Real = np.minimum.reduce([_beside(offset - crank * np.sin(t), coupler) for t in turns])
    return least


def of_driving_slides(crank: Real, coupler: Real, offset: Real, start: Real, end: Real) -> Real:
    """The slider drives: between crank and coupler, which are as far apart as their ends are."""
    middle = np.where(start * end < 0, 0.0, start)
    least: Real = np.minimum.reduce([acute_at(crank, coupler, np.hypot(x, offset)) for x in (start, end, middle)])
    return least


def of_driving_shuttles(rod: Real, sine: Real, start: Real, end: Real) -> Real:
    """A trammel's first shuttle drives: between the rod and the second slot's normal. sine: of the slots' angle."""
    return np.minimum(*(_beside(x * sine, rod) for x in (start, end)))


def acute_at(one: Real, other: Real, across: Real) -> Real:
    """The acute angle between two sides of a triangle, by the third; 0 where they do not reach."""
    inner = np.maximum((across - one + other) * (across + one - other), 0.0)
    outer = np.maximum((one + other - across) * (one + other + across), 0.0)
    half: Real = np.arctan2(np.sqrt(np.minimum(inner, outer)), np.sqrt(np.maximum(inner, outer)))
    return 2 * half


def _beside(height: Real, length: Real) -> Real:
    """What is left to a right angle of that at which a bar of a `length` climbs a `height`."""
    return np.arctan2(np.sqrt(np.maximum((length - height) * (length + height), 0.0)), np.abs(height))


def _passed(start: Real, end: Real, angle: float) -> Real:
    """The drive at `angle` where the way goes over it, a whole number of turns left out, else its start."""
    low, high = np.minimum(start, end), np.maximum(start, end)
    over = np.floor((high - angle) / (2 * np.pi)) >= np.ceil((low - angle) / (2 * np.pi))
    return np.where(over, angle, start)
