"""Many linkages of one kind that hold a body at given poses: sizes, defects and transmission angles."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import Literal

import numpy as np

from ...core.records import record
from ...linkage.linkage import AbstractLinkage
from ...linkage.named_linkages import EllipticTrammel, FourBar, SliderCrank
from ...plane.vec import Complex, Mask, Real, Whole, cross, dot, unit

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
    ground: Real, crank: Real, coupler: Real, rocker: Real, directions: tuple[Complex, Complex, Complex]
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


def four_bar_transmission(ground: Real, crank: Real, coupler: Real, rocker: Real, start: Real, end: Real) -> Real:
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


def slider_crank_transmission(crank: Real, coupler: Real, offset: Real, start: Real, end: Real) -> Real:
    """Driven by the crank: the angle between coupler and slide normal depends on the height of the crank pin."""
    turns = [start, end, _passed(start, end, np.pi / 2), _passed(start, end, -np.pi / 2)]
    least: Real = np.minimum.reduce([_beside(offset - crank * np.sin(t), coupler) for t in turns])
    return least


def driving_slide_transmission(crank: Real, coupler: Real, offset: Real, start: Real, end: Real) -> Real:
    """Driven by the slider: the angle between crank and coupler depends on the distance of their ends."""
    middle = np.where(start * end < 0, 0.0, start)
    least: Real = np.minimum.reduce([acute_at(crank, coupler, np.hypot(x, offset)) for x in (start, end, middle)])
    return least


def driving_shuttle_transmission(rod: Real, sine: Real, start: Real, end: Real) -> Real:
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


# Least angle between a trammel's slots, deg, that EllipticTrammel takes.
LEAST_SLOTS_DEG = 10


@record(eq=False, kw_only=True)
class AbstractGuides(ABC):
    """Linkages whose coupler has its two pins at two points of a body.

    `first` and `second` are the positions of these pins, (poses, linkages), mm; the driving link's pin is the first.
    """

    first: Complex
    second: Complex

    @property
    def bar(self) -> Complex:
        """Direction of the coupler, (poses, linkages)."""
        return unit(self.second - self.first)

    @property
    @abstractmethod
    def links(self) -> tuple[Real, ...]:
        """Lengths of the links, (linkages,)."""

    @cached_property
    @abstractmethod
    def defects(self) -> Defects:
        """Defects in the order of the poses."""

    @abstractmethod
    def least_angle(self, start: Real, end: Real) -> Real:
        """The least transmission angle from one drive to another, rad, (linkages,)."""

    @abstractmethod
    def linkage(self, k: int, point: complex) -> AbstractLinkage:
        """The k-th linkage with this coupler point."""

    @property
    @abstractmethod
    def joints(self) -> Complex:
        """Positions of pivots and of crossings of slides, (joints, linkages)."""

    @cached_property
    def ratio(self) -> Real:
        """The longest link over the shortest, (linkages,); nan if undefined."""
        with np.errstate(all="ignore"):
            lengths = np.array(self.links)
            ratios: Real = lengths.max(axis=0) / lengths.min(axis=0)
            return ratios

    @cached_property
    def angle(self) -> Real:
        """The least transmission angle of the motion, rad, (linkages,); nan if there is none."""
        found = self.defects
        with np.errstate(all="ignore"):
            least = self.least_angle(found.drive.min(axis=0), found.drive.max(axis=0))
        return np.where(found.circuit | found.branch, np.nan, least)

    def holds(self, k: int, origin: complex, direction: complex) -> tuple[complex, float]:
        """Position of a body and angle, rad, in the frame of the k-th coupler, from its first pose."""
        back = complex(np.conj(self.bar[0, k]))
        return (origin - complex(self.first[0, k])) * back, float(np.angle(direction * back))


@record(eq=False, kw_only=True)
class FourBars(AbstractGuides):
    """Four-bars with the pivots of crank and rocker, (linkages,)."""

    pivots: tuple[Complex, Complex]

    @cached_property
    def links(self) -> tuple[Real, Real, Real, Real]:
        # The mean, for poses met by least squares.
        crank, rocker = (np.abs(p - z).mean(axis=0) for p, z in zip((self.first, self.second), self.pivots))
        coupler = np.abs(self.second[0] - self.first[0])
        return np.abs(self.pivots[1] - self.pivots[0]), crank, coupler, rocker

    @property
    def joints(self) -> Complex:
        return np.array(self.pivots)

    @cached_property
    def _line(self) -> Complex:
        return unit(self.pivots[1] - self.pivots[0])

    @cached_property
    def defects(self) -> Defects:
        back = np.conj(self._line)
        crank, rocker = unit(self.first - self.pivots[0]), unit(self.second - self.pivots[1])
        return four_bar_defects(*self.links, (crank * back, self.bar * back, rocker * back))

    def least_angle(self, start: Real, end: Real) -> Real:
        return four_bar_transmission(*self.links, start, end)

    def linkage(self, k: int, point: complex) -> FourBar:
        ground, crank, coupler, rocker = (float(length[k]) for length in self.links)
        return FourBar(
            ground,
            crank,
            coupler,
            rocker,
            point,
            origin=complex(self.pivots[0][k]),
            ground_angle_deg=float(np.degrees(np.angle(self._line[k]))),
        )


@record(eq=False, kw_only=True)
class SliderCranks(AbstractGuides):
    """Slider-cranks driven by the crank or the slider, with the crank's pivot and the direction of the slide line."""

    pivot: Complex
    rail: Complex
    slides: bool

    @cached_property
    def _seen(self) -> tuple[Complex, Complex]:
        """Crank pin and slider pin relative to the pivot, with the slide line along +x."""
        crank, slider = ((p - self.pivot) * np.conj(self.rail) for p in (self.first, self.second))
        return crank, slider

    @cached_property
    def sizes(self) -> tuple[Real, Real, Real]:
        """Crank, coupler and offset."""
        crank, slider = self._seen
        return np.abs(crank).mean(axis=0), np.abs(self.second[0] - self.first[0]), slider.imag.mean(axis=0)

    @property
    def links(self) -> tuple[Real, Real]:
        return self.sizes[:2]

    @property
    def joints(self) -> Complex:
        return self.pivot[None]

    @cached_property
    def defects(self) -> Defects:
        crank, slider = self._seen
        driver = "slider" if self.slides else "crank"
        return slider_crank_defects(*self.sizes, (unit(crank), unit(slider - crank)), slider.real, driver)  # type: ignore[arg-type]

    def least_angle(self, start: Real, end: Real) -> Real:
        transmission_angle = driving_slide_transmission if self.slides else slider_crank_transmission
        return transmission_angle(*self.sizes, start, end)

    def linkage(self, k: int, point: complex) -> SliderCrank:
        crank, coupler, offset = (float(size[k]) for size in self.sizes)
        return SliderCrank(
            crank,
            coupler,
            offset,
            point,
            driver="slider" if self.slides else "crank",
            origin=complex(self.pivot[k]),
            ground_angle_deg=float(np.degrees(np.angle(self.rail[k]))),
        )


@record(eq=False, kw_only=True)
class Trammels(AbstractGuides):
    """Elliptic trammels driven by the rod or by the first shuttle, with the directions of both slots."""

    slots: tuple[Complex, Complex]
    slides: bool

    @cached_property
    def _second(self) -> Complex:
        """Direction of the second slot from the first, to its left."""
        across = self.slots[1] * np.conj(self.slots[0])
        return np.where(across.imag < 0, -across, across)

    @cached_property
    def crossing(self) -> Complex:
        """Intersection of the slots."""
        back = np.conj(self.slots[0])
        apart = ((self.second - self.first) * back).mean(axis=0)
        with np.errstate(all="ignore"):
            along = apart.real - apart.imag * self._second.real / self._second.imag
        at: Complex = self.first.mean(axis=0) + along * self.slots[0]
        return at

    @property
    def links(self) -> tuple[Real]:
        return (np.abs(self.second[0] - self.first[0]),)

    @property
    def joints(self) -> Complex:
        steep = np.abs(self._second.imag) >= np.sin(np.radians(LEAST_SLOTS_DEG))
        return np.where(steep, self.crossing, np.inf)[None]

    @cached_property
    def defects(self) -> Defects:
        shuttle = dot(self.slots[0], self.first - self.crossing)
        driver = "shuttle" if self.slides else "rod"
        return trammel_defects(self.links[0], self.bar * np.conj(self.slots[0]), self._second, shuttle, driver)

    def least_angle(self, start: Real, end: Real) -> Real:
        slots = np.arctan2(self._second.imag, np.abs(self._second.real))
        return (
            driving_shuttle_transmission(self.links[0], self._second.imag, start, end)
            if self.slides
            else slots + 0 * start
        )

    def linkage(self, k: int, point: complex) -> EllipticTrammel:
        return EllipticTrammel(
            float(self.links[0][k]),
            point,
            float(np.degrees(np.angle(self._second[k]))),
            driver="shuttle" if self.slides else "rod",
            origin=complex(self.crossing[k]),
            ground_angle_deg=float(np.degrees(np.angle(self.slots[0][k]))),
        )


def guides_of(
    kind: str, slides: bool, first: tuple[Complex, Complex], second: tuple[Complex, Complex]
) -> AbstractGuides:
    """Linkages of two dyads each: positions of its pin, (poses, linkages), and its pivot or the direction of its slide.

    `kind` is that of `body_guides`, whose slider belongs to the second dyad; `slides` is true if a slide drives.
    """
    pins = {"first": first[0], "second": second[0]}
    if kind == "elliptic-trammel":
        return Trammels(slots=(first[1], second[1]), slides=slides, **pins)
    if kind == "four-bar":
        return FourBars(pivots=(first[1], second[1]), **pins)
    return SliderCranks(pivot=first[1], rail=second[1], slides=slides, **pins)


def usable(guides: AbstractGuides, low: complex, high: complex) -> Mask:
    """Linkages of nonzero links whose joints are inside a box at every pose, (linkages,)."""
    places = np.concatenate([guides.joints, guides.first, guides.second])
    with np.errstate(invalid="ignore"):
        inside = (places.real >= low.real) & (places.real <= high.real)
        inside &= (places.imag >= low.imag) & (places.imag <= high.imag)
    shortest = np.min(guides.links, axis=0)
    return np.asarray(inside.all(axis=0) & (shortest > 1e-9 * abs(high - low)))
