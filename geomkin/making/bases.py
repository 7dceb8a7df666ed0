"""The base plate of a mechanism: holes for shafts, slots for sliding pins, and screws in its corners."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, inside, quantity, rounded_down, to_digits
from ..core.records import record
from ..model.part import HoleFit, Part
from ..plane.curve import AbstractCurve
from ..plane.measure import separation
from ..plane.primitives import Circle, rounded_hull, slot
from ..plane.vec import Complex
from .bores import SMALLEST, clearance, widened
from .fasteners import ThreadDiameter
from .motor_faces import MountedMotorKey, face_of


@record(checked=True)
class BaseStock:
    """The base plate under a mechanism. It is as thick as the first part and covers everything that moves over it.

    Parameters
    ----------
    screw : float, optional
        Diameter of the screws in its corners, mm; 0 for none.
    edge : float, optional
        Width of the plate outside those screws, mm.
    clearance : float, optional
        How much wider a hole is than its pin or shaft, mm.
    """

    screw: ThreadDiameter = quantity(
        'diameter of the screws in its corners, or their thread, as "#6-32"; 0 for none; their holes are wider by the '
        "clearance",
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
    """The base plate under a pinion and its rack. Two pins guide the rack in a slot of the plate.

    Parameters
    ----------
    screw, edge, clearance : float, optional
        As of `BaseStock`, mm.
    guide_pin : float, optional
        Diameter of the two pins of the rack, mm.
    """

    guide_pin: float = quantity(
        "diameter of the two pins on which the rack slides in the base's slot", "mm", default=4.0, at_least=0.01
    )


@record
class BaseOpening:
    """A hole for a shaft, pin or screw, or a slot in which pins slide.

    Parameters
    ----------
    item : str
        The shaft, pin or screw, for messages.
    key : str
        Key of its diameter in the recipe.
    diameter : float
        mm.
    points : tuple of complex
        Centre of the hole, or both ends of the slot's centre line, mm.
    letter : str
        Letter engraved next to the opening.
    head : float
        Diameter of a collar or head below the plate, mm; 0 for none.
    motor : str or MotorFace, optional
        Motor that drives the shaft from below; the plate then has holes for its boss and screws.
    """

    item: str
    key: str
    diameter: float
    points: tuple[complex, ...]
    letter: str = ""
    head: float = 0.0
    motor: MountedMotorKey | None = None

    @property
    def face(self) -> Complex:
        """Corners of the motor's face, mm; none without a motor."""
        return face_of(self.motor).corners(self.points[0]) if self.motor else np.zeros(0, dtype=complex)

    def curves(self, clearance: float) -> tuple[AbstractCurve, ...]:
        """The hole or slot, wider than the item by the clearance. Raises DesignError if it is too narrow to cut."""
        if self.diameter < SMALLEST:
            raise DesignError(
                self.key,
                f"found {self.diameter:g} mm, but the base has a hole for {self.item}",
                f"give at least {SMALLEST:g} mm, or omit base",
                "conflict",
                SMALLEST,
            )
        if self.motor:
            return face_of(self.motor).holes(clearance, self.points[0])
        radius = widened(self.diameter, clearance) / 2
        start, end = self.points[0], self.points[-1]
        return (Circle(start, radius) if len(self.points) == 1 else slot(start, end, radius),)

    def fits(self, clearance: float) -> tuple[HoleFit, ...]:
        """The fit of each of the `curves`."""
        if self.motor:
            return face_of(self.motor).fits(clearance)
        return (HoleFit(self.diameter, clearance, travel=abs(self.points[-1] - self.points[0])),)

    def distance(self, other: BaseOpening) -> float:
        """Distance of the two centres or centre lines, mm; 0 or less if two slots cross."""
        return float(separation(np.array(self.points), np.array(other.points)))


def standing_plate(
    box: tuple[complex, complex], openings: Sequence[BaseOpening], stock: BaseStock, thickness: float
) -> Part:
    """The base plate, a part of the body "ground", with openings, and a screw outside each corner of a box.

    box: lower left and upper right corner, mm, of all openings and of everything that moves over the plate; it is
    extended by the face of a motor. Raises DesignError if openings meet or lie over the face of a motor.
    """
    for opening in openings:
        if opening.motor:
            face_of(opening.motor).check_plate(thickness, _motor_key(opening))
    points = np.concatenate([np.array(box), *(opening.face for opening in openings)])
    # Heads of screws are at most twice as wide as the screws (ISO 7045, 4762, 4017).
    beyond = stock.screw * (1 + 1j)
    low = complex(points.real.min(), points.imag.min()) - beyond
    high = complex(points.real.max(), points.imag.max()) + beyond
    corners = (low, complex(high.real, low.imag), high, complex(low.real, high.imag))
    screws = [BaseOpening("a screw", "base.screw", stock.screw, (corner,)) for corner in corners if stock.screw]
    all_openings = (*openings, *screws)
    cut = [opening.curves(stock.clearance) for opening in all_openings]
    for first, second in combinations(all_openings, 2):
        _check_apart(first, second, stock.clearance)
    outline = rounded_hull(corners, widened(stock.screw, stock.clearance) / 2 + stock.edge)
    # A motor has several holes; the letter is at the first one, for its boss.
    letters = [
        name for opening, curves in zip(all_openings, cut) for name in (opening.letter, *("" for _ in curves[1:]))
    ]
    holes = tuple(curve for curves in cut for curve in curves)
    fits = tuple(fit for opening in all_openings for fit in opening.fits(stock.clearance))
    hole_names = tuple(letters) if any(letters) else ()
    marks = tuple(
        ring for opening in openings if opening.motor for ring in face_of(opening.motor).countersinks(opening.points[0])
    )
    return Part("base", outline, holes, thickness, marks=marks, body="ground", hole_names=hole_names, fits=fits)


def _motor_key(opening: BaseOpening) -> str:
    return f"{opening.key.rpartition('.')[0]}.motor"


def _check_apart(first: BaseOpening, second: BaseOpening, clearance: float) -> None:
    for motor_opening, other in ((first, second), (second, first)):
        if motor_opening.motor:
            _check_off_motor(motor_opening, other, clearance)
    apart, wide = first.distance(second), (first.diameter + second.diameter) / 2 + clearance
    if apart > wide:
        return
    small, large = sorted((first, second), key=lambda opening: opening.diameter)
    if (free := apart - (small.diameter + large.diameter) / 2) > 0:
        key, value, most = "base.clearance", clearance, free
    else:
        key, value, most = large.key, large.diameter, 2 * (apart - clearance) - small.diameter
    raise DesignError(
        key,
        f"found {value:g} mm: the holes for {first.item} and {second.item} in the base are {apart:.6g} mm apart "
        f"and together {2 * wide:.6g} mm wide, so they meet",
        f"give less than {rounded_down(to_digits(most, 12))} mm" if most > 0 else "move them apart",
        value=inside(most, 1) if most > 0 else None,
    )


def _check_off_motor(motor_opening: BaseOpening, other: BaseOpening, clearance: float) -> None:
    """DesignError for an opening over the face of a motor, where its item would meet the motor or the motor's holes."""
    assert motor_opening.motor is not None
    face = face_of(motor_opening.motor)
    overlap = max(widened(other.diameter, clearance), other.head) / 2 - float(
        separation(motor_opening.face, np.array(other.points))
    )
    if overlap > 0:
        raise DesignError(
            _motor_key(motor_opening),
            f"found {motor_opening.motor}, whose face, {face.face_width:g} mm wide, overlaps the opening for "
            f"{other.item} in the base by {overlap:.4g} mm",
            "move the axes apart, or omit motor or base",
        )
