"""The plate that a mechanism stands on: shafts in holes, what slides in slots, and screws in its corners."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, quantity
from ..core.records import record
from ..model.part import HoleFit, Part
from ..plane.curve import AbstractCurve
from ..plane.measure import separation
from ..plane.primitives import Circle, rounded_hull, slot
from ..plane.vec import Complex
from .bores import SMALLEST, clearance, widened
from .motors import MOTORS, MotorName


@record(checked=True)
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


@record
class RackBaseStock(BaseStock):
    """The plate under a pinion and its rack, which two pins in a slot of the plate guide."""

    guide_pin: float = quantity(
        "diameter of the two pins on which the rack slides in the base's slot", "mm", default=4.0, at_least=0.01
    )


@record
class BaseOpening:
    """A hole for a shaft, pin or screw, or a slot in which pins slide.

    what: goes through it; key: what a recipe calls its diameter, mm. places: of the hole's middle, or of both ends of
    the slot's middle line, mm. letter: engraved beside it. head: diameter, mm, of what stands out below, 0 for
    nothing. motor: what turns the shaft from below; its boss and screws have holes instead of the shaft.
    """

    what: str
    key: str
    diameter: float
    places: tuple[complex, ...]
    letter: str = ""
    head: float = 0.0
    motor: MotorName | None = None

    @property
    def face(self) -> Complex:
        """Corners of the motor's face, mm; none without a motor."""
        return MOTORS[self.motor].corners(self.places[0]) if self.motor else np.zeros(0, dtype=complex)

    def curves(self, clearance: float) -> tuple[AbstractCurve, ...]:
        """What is cut, wider by the clearance. DesignError where it is too narrow to cut."""
        if self.diameter < SMALLEST:
            raise DesignError(
                self.key,
                f"found {self.diameter:g} mm, but the base has a hole for {self.what}",
                f"give at least {SMALLEST:g} mm, or leave out base",
            )
        if self.motor:
            return MOTORS[self.motor].holes(clearance, self.places[0])
        radius = widened(self.diameter, clearance) / 2
        start, end = self.places[0], self.places[-1]
        return (Circle(start, radius) if len(self.places) == 1 else slot(start, end, radius),)

    def fits(self, clearance: float) -> tuple[HoleFit, ...]:
        """How what goes through sits in each of these."""
        if self.motor:
            return MOTORS[self.motor].fits(clearance)
        return (HoleFit(self.diameter, clearance, travel=abs(self.places[-1] - self.places[0])),)

    def distance(self, other: BaseOpening) -> float:
        """From middle to middle, mm; 0 or less of two slots that cross."""
        return float(separation(np.array(self.places), np.array(other.places)))


def standing_plate(
    box: tuple[complex, complex], openings: Sequence[BaseOpening], stock: BaseStock, thickness: float
) -> Part:
    """The base of the body "ground": openings, and a screw beyond each corner of a box, so that its head is clear.

    box: lower left and upper right corner, mm, of all openings and of what moves over the plate; the face of a motor is
    added. DesignError where openings meet, or lie over the face of a motor.
    """
    for opening in openings:
        if opening.motor:
            MOTORS[opening.motor].check_plate(opening.motor, thickness, _motor_key(opening))
    places = np.concatenate([np.array(box), *(opening.face for opening in openings)])
    # Heads of screws are at most twice as wide as the screws (ISO 7045, 4762, 4017).
    beyond = stock.screw * (1 + 1j)
    low = complex(places.real.min(), places.imag.min()) - beyond
    high = complex(places.real.max(), places.imag.max()) + beyond
    corners = (low, complex(high.real, low.imag), high, complex(low.real, high.imag))
    screws = [BaseOpening("a screw", "base.screw", stock.screw, (corner,)) for corner in corners if stock.screw]
    all_openings = (*openings, *screws)
    cut = [opening.curves(stock.clearance) for opening in all_openings]
    for one, two in combinations(all_openings, 2):
        _check_apart(one, two, stock.clearance)
    outline = rounded_hull(corners, widened(stock.screw, stock.clearance) / 2 + stock.edge)
    # Of a motor's holes the one round its shaft has the letter.
    letters = [
        name for opening, curves in zip(all_openings, cut) for name in (opening.letter, *("" for _ in curves[1:]))
    ]
    holes = tuple(curve for curves in cut for curve in curves)
    fits = tuple(fit for opening in all_openings for fit in opening.fits(stock.clearance))
    shown = tuple(letters) if any(letters) else ()
    return Part("base", outline, holes, thickness, body="ground", hole_names=shown, fits=fits)


def _motor_key(opening: BaseOpening) -> str:
    return f"{opening.key.rpartition('.')[0]}.motor"


def _check_apart(one: BaseOpening, two: BaseOpening, clearance: float) -> None:
    for held, other in ((one, two), (two, one)):
        if held.motor:
            _check_beside(held, other, clearance)
    apart, wide = one.distance(two), (one.diameter + two.diameter) / 2 + clearance
    if apart > wide:
        return
    small, large = sorted((one, two), key=lambda opening: opening.diameter)
    if (free := apart - (small.diameter + large.diameter) / 2) > 0:
        key, found, most = "base.clearance", clearance, free
    else:
        key, found, most = large.key, large.diameter, 2 * (apart - clearance) - small.diameter
    raise DesignError(
        key,
        f"found {found:g} mm: the holes for {one.what} and {two.what} in the base are {apart:.6g} mm apart, and "
        f"{2 * wide:.6g} mm wide together, so that they meet",
        f"give less than {most:.6g} mm" if most > 0 else "move them apart",
    )


def _check_beside(held: BaseOpening, other: BaseOpening, clearance: float) -> None:
    """Refuse an opening over the face of a motor: what goes through it would meet the motor, or its holes."""
    face = MOTORS[held.motor or ""]
    missing = max(widened(other.diameter, clearance), other.head) / 2 - float(
        separation(held.face, np.array(other.places))
    )
    if missing > 0:
        raise DesignError(
            _motor_key(held),
            f"found {held.motor}, whose face, {face.side:g} mm wide, reaches {missing:.4g} mm under what the base has "
            f"for {other.what}",
            "move the axes apart, or leave out motor or base",
        )
