"""Printed pins that snap in: flat, printed on their side, with a head, two legs and a barb on each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import hypot, pi, sqrt, tan

import numpy as np

from ..core.errors import DesignError
from ..core.fields import last_fit, to_digits
from ..core.records import record
from ..core.units import mm
from ..model.check import Check
from ..model.material import Material
from ..model.part import Part
from ..plane.measure import signed_area
from ..plane.primitives import Polyline
from .fasteners import Fastener

# Sizes in diameters of the pin, chosen here. Width and thickness of the shank, whose edges lie on the pin's circle:
# printed on its side, no layer lies across its axis. With a thicker one its legs become too thin.
WIDTH, THICKNESS = sqrt(3) / 2, 0.5
# Width and height of the head; width of the barbs beyond the hole, at their corners, and the length of their lands.
HEAD_WIDTH, HEAD_HEIGHT, CATCH, LAND = 1.6, 0.4, 0.12, 0.15
# Inclination of the tips that spread the hole's reaction: with a steeper one the pin needs a hammer.
TIP_ANGLE = pi / 6
# Thinnest leg that printers draw with two lines, mm.
THINNEST_LEG = 0.7
# Largest strain of the legs as they snap in: data sheets have 2 to 4 % at yield for PLA, PETG and ABS.
MOST_STRAIN = 0.03
# Axial play of pins in gears and cams, mm, as the default one of linkages.
PLAY = 0.2


# Diameter of a pin whose legs are thick enough with any clearance, mm.
WIDEST = 100.0


def _barb(diameter: float, clearance: float) -> float:
    return sqrt(((diameter + clearance) / 2 + CATCH * diameter) ** 2 - (THICKNESS * diameter / 2) ** 2)


def _deflection(diameter: float, clearance: float) -> float:
    hole = (diameter + clearance) / 2
    return _barb(diameter, clearance) - sqrt(hole**2 - (THICKNESS * diameter / 2) ** 2)


def _leg(diameter: float, clearance: float) -> float:
    return WIDTH * diameter / 2 - _deflection(diameter, clearance)


@record
class SnapPin(Fastener):
    """A printed pin; its holes are wider by the clearance, mm. density: of its material, kg/m3, 0 if unknown."""

    clearance: float = 0.0
    density: float = 0.0

    def __post_init__(self) -> None:
        if self.leg < THINNEST_LEG:
            problem = f"found snap, but legs of a pin of {mm(self.diameter):g} are {mm(max(self.leg, 0.0)):.2g} thick"
            least = last_fit(lambda diameter: _leg(diameter, self.clearance) >= THINNEST_LEG, WIDEST, self.diameter)
            raise DesignError("printing.pins", problem, f"give pins of at least {mm(least):up}", "conflict")

    @property
    def thickness(self) -> float:
        """Of the part as it lies on the bed, mm."""
        return THICKNESS * self.diameter

    @cached_property
    def barb(self) -> float:
        """Half the width across the barbs, mm."""
        return _barb(self.diameter, self.clearance)

    @property
    def deflection(self) -> float:
        """By how much each barb moves inwards to pass the hole, mm."""
        return _deflection(self.diameter, self.clearance)

    @property
    def leg(self) -> float:
        """Thickness of a leg, mm: the slit between both lets them meet."""
        return _leg(self.diameter, self.clearance)

    @property
    def across(self) -> float:
        return max(hypot(HEAD_WIDTH * self.diameter, self.thickness), 2 * hypot(self.barb, self.thickness / 2))

    @property
    def _tip(self) -> float:
        """Half the width of the pin at its tip, mm."""
        return self.deflection + self.leg / 2

    def length(self, grip: float) -> float | None:
        return grip + self.play

    def ends(self, grip: float) -> tuple[float, float]:
        tip = LAND * self.diameter + (self.barb - self._tip) / tan(TIP_ANGLE)
        return HEAD_HEIGHT * self.diameter + self.play, tip + self.play

    def bill(self, grip: float) -> tuple[tuple[str, int], ...]:
        return ()

    def volume(self, grip: float) -> float:
        return self.thickness * signed_area(self.outline(grip))

    def outline(self, grip: float) -> Polyline:
        """The pin seen from the bed, its head at x < 0, for plates of a thickness `grip`, mm."""
        d, slit, end = self.diameter, self.deflection, grip + self.play
        last = end + self.ends(grip)[1] - self.play
        shank, head = WIDTH * d / 2, HEAD_WIDTH * d / 2
        side = np.array(
            [-HEAD_HEIGHT * d + head * 1j, head * 1j, shank * 1j, end + shank * 1j, end + self.barb * 1j,
             end + LAND * d + self.barb * 1j, last + self._tip * 1j, last + slit * 1j, slit * (1 + 1j)]
        )  # fmt: skip
        # From below the head round the tip of the lower leg, then round the end of the slit, then back.
        bulges = np.zeros(2 * len(side))
        bulges[len(side) - 1] = -1.0
        return Polyline(np.concatenate([np.conj(side), side[::-1]]), bulges)

    def strain(self, grip: float) -> float:
        """Largest strain of a leg as it snaps in: of a beam of constant section, clamped at the end of the slit.

        Source: Bayer MaterialScience, Snap-Fit Joints for Plastics, deflection of a rectangular beam.
        """
        return 1.5 * self.leg * self.deflection / (grip + self.play - self.deflection) ** 2


@record(eq=False)
class PinPlace:
    """A snap pin at a joint: its letter, the thickness of the plates on it, mm, and the material to print it of."""

    letter: str
    pin: SnapPin
    grip: float
    material: Material | None = None


def alike(places: Sequence[PinPlace]) -> dict[str, list[PinPlace]]:
    """Equal pins, by the name of their part: that of their first joint."""
    groups: dict[tuple[SnapPin, float], list[PinPlace]] = {}
    for place in places:
        groups.setdefault((place.pin, round(place.grip, 9)), []).append(place)
    return {f"pin_{group[0].letter}": group for group in groups.values()}


def pin_parts(places: Sequence[PinPlace]) -> tuple[Part, ...]:
    """The parts of all pins."""
    return tuple(
        Part(
            name,
            group[0].pin.outline(group[0].grip),
            (),
            to_digits(group[0].pin.thickness),
            count=len(group),
            material=group[0].material,
            joints=tuple(place.letter for place in group),
        )
        for name, group in alike(places).items()
    )


def snap_checks(places: Sequence[PinPlace]) -> tuple[Check, ...]:
    """Check of the largest strain of all pins; empty without any."""
    if not places:
        return ()
    strain, letter = max((place.pin.strain(place.grip), place.letter) for place in places)
    advice = f"the shortest pins, such as {letter}, break: give thicker plates, or thinner pins"
    return (Check("snap_strain", "strain of snap pins", 100 * strain, "at most", 100 * MOST_STRAIN, "%", advice),)
