"""The plate that a mechanism stands on: shafts in holes, what slides in slots, and screws in its corners."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..brief import one_line
from ..errors import DesignError
from ..part import HoleFit, Part
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle, rounded_hull, slot
from ..plane.vec import dot
from ..sizes import FARTHEST, check_sizes, quantity
from .bore import SMALLEST, clearance, widened


@dataclass(frozen=True)
class BaseStock:
    """The plate under a mechanism: as thick as the first of its parts, and as large as all that moves over it."""

    screw: float = quantity(
        "diameter of the screws that hold it, 0 for none; their holes are wider by the clearance",
        "mm",
        default=4.0,
        at_least=0,
        at_most=100,
    )
    edge: float = quantity(
        "width of the plate outside the screws in its corners", "mm", default=6.0, at_least=0.01, at_most=FARTHEST
    )
    clearance: float = clearance(0.2)

    def __post_init__(self) -> None:
        check_sizes(self)


@dataclass(frozen=True)
class RackBaseStock(BaseStock):
    """The plate under a pinion and its rack, which two pins in a slot of the plate guide."""

    guide_pin: float = quantity(
        "diameter of the two pins on which the rack slides in the base's slot", "mm", default=4.0, at_least=0.01
    )


def check_no_motor(base: BaseStock | None, motor: str | None, key: str) -> None:
    """Refuse a motor, of a key in a recipe, over a base: both would hold the shaft, each by holes the other lacks."""
    if base is not None and motor is not None:
        raise DesignError(key, f"found {motor} over a base, which has no holes for it", "leave out motor or base")


@dataclass(frozen=True)
class BaseOpening:
    """A hole for a shaft, pin or screw, or a slot in which pins slide.

    what: goes through it; key: what a recipe calls its diameter, mm. places: of the hole's middle, or of both ends of
    the slot's middle line, mm. letter: engraved beside it.
    """

    what: str
    key: str
    diameter: float
    places: tuple[complex, ...]
    letter: str = ""

    __repr__ = one_line

    def curve(self, clearance: float) -> AbstractCurve:
        """What is cut, wider by the clearance. DesignError where it is too narrow to cut."""
        if self.diameter < SMALLEST:
            raise DesignError(
                self.key,
                f"found {self.diameter:g} mm, but the base has a hole for {self.what}",
                f"give at least {SMALLEST:g} mm, or leave out base",
            )
        radius = widened(self.diameter, clearance) / 2
        start, end = self.places[0], self.places[-1]
        return Circle(start, radius) if len(self.places) == 1 else slot(start, end, radius)

    def fit(self, clearance: float) -> HoleFit:
        """How what goes through sits in it."""
        return HoleFit(self.diameter, clearance, travel=abs(self.places[-1] - self.places[0]))

    def distance(self, other: BaseOpening) -> float:
        """From middle to middle, mm; of two slots they must not cross."""
        ways = ((one, place) for one, two in ((self, other), (other, self)) for place in two.places)
        return min(_beside(one.places, place) for one, place in ways)


def _beside(line: tuple[complex, ...], place: complex) -> float:
    """Distance of a place from a point, or from the line between two."""
    along = line[-1] - line[0]
    share = float(np.clip(dot(along, place - line[0]) / abs(along) ** 2, 0, 1)) if along else 0.0
    return abs(place - line[0] - share * along)


def standing_plate(
    box: tuple[complex, complex], openings: Sequence[BaseOpening], stock: BaseStock, thickness: float
) -> Part:
    """The base of the body "ground": openings, and a screw beyond each corner of a box, so that its head is clear.

    box: lower left and upper right corner, mm, of all openings and of what moves over the plate. DesignError where
    openings meet.
    """
    # Heads of screws are at most twice as wide as the screws (ISO 7045, 4762, 4017).
    beyond = stock.screw * (1 + 1j)
    low, high = box[0] - beyond, box[1] + beyond
    corners = (low, complex(high.real, low.imag), high, complex(low.real, high.imag))
    screws = [BaseOpening("a screw", "base.screw", stock.screw, (corner,)) for corner in corners if stock.screw]
    all_openings = (*openings, *screws)
    holes = tuple(opening.curve(stock.clearance) for opening in all_openings)
    for one, two in combinations(all_openings, 2):
        _check_apart(one, two, stock.clearance)
    outline = rounded_hull(corners, widened(stock.screw, stock.clearance) / 2 + stock.edge)
    letters = tuple(opening.letter for opening in all_openings)
    fits = tuple(opening.fit(stock.clearance) for opening in all_openings)
    shown = letters if any(letters) else ()
    return Part("base", outline, holes, thickness, body="ground", hole_names=shown, fits=fits)


def _check_apart(one: BaseOpening, two: BaseOpening, clearance: float) -> None:
    apart, wide = one.distance(two), (one.diameter + two.diameter) / 2 + clearance
    if apart > wide:
        return
    together = 2 * (apart - clearance)
    raise DesignError(
        one.key,
        f"the holes for {one.what} and {two.what} in the base are {apart:.6g} mm apart, and {2 * wide:.6g} mm wide "
        "together, so that they meet",
        f"give diameters of less than {together:.6g} mm together" if together > 0 else "move them apart",
    )
