"""Many linkages of one kind that hold a body at given poses: sizes, defects and transmission angles."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property

import numpy as np

from ...core.records import record
from ...linkage.linkage import AbstractLinkage
from ...linkage.named_linkages import EllipticTrammel, FourBar, SliderCrank
from ...plane.vec import Complex, Mask, Real, dot, unit
from . import defects as transmission
from .defects import Defects, four_bar_defects, slider_crank_defects, trammel_defects

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
        return transmission.of_four_bars(*self.links, start, end)

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
        transmission_angle = transmission.of_driving_slides if self.slides else transmission.of_slider_cranks
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
            transmission.of_driving_shuttles(self.links[0], self._second.imag, start, end)
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
