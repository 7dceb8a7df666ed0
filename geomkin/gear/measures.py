"""What is measured on gears: span, over pins, chord of a tooth (ISO 21771, DIN 3960); teeth as a table."""

from __future__ import annotations

import numpy as np

from ..core.arguments import Positive, checked
from ..core.errors import DesignError
from ..core.fields import Length, rounded_down, rounded_up
from ..core.records import record
from ..model.table import Column, Table, xy_columns
from ..plane.flatten import flatten
from ..plane.roulettes import inverse_involute, roll_at
from .contract import AbstractInvoluteGear


@record
class SpanMeasure:
    """length: mm, between flat jaws over `teeth` teeth; radius: of the circle on which they touch, mm."""

    teeth: int
    length: float
    radius: float


@record
class PinMeasure:
    """What two pins in opposite spaces measure.

    diameter: over the two pins, mm, between them for a ring; pin: their diameter, mm;
    radius: of the circle through the pins' centres, mm; contact: of the circle on which they touch the flanks, mm.
    """

    diameter: float
    pin: float
    radius: float
    contact: float


@record
class ChordMeasure:
    """Of a tooth at a circle: thickness along the arc and the chord, mm, half its angle, rad, height of the tip, mm."""

    arc: float
    chord: float
    half_angle: float
    height: float


@checked
def span(gear: AbstractInvoluteGear, teeth: int | None = None) -> SpanMeasure:
    """The span over a number of teeth: base pitches between, and one tooth on the base circle.

    teeth: left out, the number with which the jaws touch nearest to the middle of the flanks. Raises
    DesignError where the jaws would touch beside the involute, and for a ring.
    """
    _refuse_ring(gear)
    start, end = gear.flank_lengths

    def length(k: float) -> float:
        return (k - 1) * gear.base_pitch + gear.thickness(gear.base_radius)

    # The jaws' line touches the base circle in its middle: half the span is the tangent length at the contacts.
    fitting = [k for k in range(1, gear.teeth) if start <= length(k) / 2 <= end]
    if not fitting:
        raise DesignError("teeth", "no number of teeth can be spanned", "measure over pins")
    if teeth is None:
        teeth = min(fitting, key=lambda k: abs(length(k) - start - end))
    if teeth not in fitting:
        near = min(fitting, key=lambda k: abs(k - teeth))
        raise DesignError("teeth", f"found {teeth}, over which the jaws touch beside the involute", f"give {near}")
    return SpanMeasure(teeth, length(teeth), float(np.hypot(gear.base_radius, length(teeth) / 2)))


@checked
def over_pins(gear: AbstractInvoluteGear, pin: Length | None = None) -> PinMeasure:
    """The measure over two pins, or between them in a ring, in spaces as opposite as an odd count allows.

    pin: diameter, mm; left out, the one that touches the flanks where reference line and shift put their middle.
    Raises DesignError where the pin would touch beside the involute, or not stand proud of the tips.
    """
    sign = -1 if gear.is_ring else 1
    base = gear.base_radius
    half_space = np.pi / gear.teeth - gear.thickness(base) / (2 * base)
    best = _pin(gear, sign, half_space)
    pin = best if pin is None else pin
    angle = sign * (pin / (2 * base) - half_space)
    roll = inverse_involute(angle) if angle > 0 else 0.0
    radius, touching = base * float(np.hypot(1, roll)), base * roll - sign * pin / 2
    start, end = gear.flank_lengths
    slack = 1e-9 * gear.module
    if not (start - slack <= touching <= end + slack and sign * (radius - gear.tip_radius) + pin / 2 > 0):
        remedy = "measure the span instead" if pin == best else f"give about {best:.4g} mm"
        raise DesignError(
            "pin", f"found {pin:g} mm, which does not stand out of the spaces or misses the flanks", remedy
        )
    across = 2 * radius * (np.cos(np.pi / (2 * gear.teeth)) if gear.teeth % 2 else 1.0)
    return PinMeasure(float(across + sign * pin), float(pin), radius, float(np.hypot(base, touching)))


def _pin(gear: AbstractInvoluteGear, sign: int, half_space: float) -> float:
    """Diameter of the pin that touches the flanks where the shifted reference line crosses them, mm.

    Along the flank's normal there the pin's centre lies in the space's middle: with roll angles m of the contact
    and c of the centre, inv(c) = |c - m| -+ the half space, so that arctan(c) = m +- the half space.
    """
    base = gear.base_radius
    low, high = (length / base for length in gear.flank_lengths)
    m = min(max(roll_at(gear.pitch_radius + gear.profile_shift * gear.module, base), low), high)
    lean = m + sign * half_space
    return 2 * base * sign * (float(np.tan(lean)) - m) if lean < np.pi / 2 else float("inf")


@checked
def chord(gear: AbstractInvoluteGear, radius: float | None = None) -> ChordMeasure:
    """Thickness of a tooth at a circle as a tooth caliper sees it; at the pitch circle if none is given.

    Raises DesignError where the circle passes beside the involute, and for a ring.
    """
    _refuse_ring(gear)
    r = gear.pitch_radius if radius is None else radius
    low, high = (float(np.hypot(gear.base_radius, s)) for s in gear.flank_lengths)
    if not low <= r <= high:
        raise DesignError(
            "radius", f"found {r:g} mm, beside the involute", f"give {rounded_up(low)} to {rounded_down(high)} mm"
        )
    arc = gear.thickness(r)
    half = arc / (2 * r)
    return ChordMeasure(arc, 2 * r * float(np.sin(half)), half, gear.tip_radius - r * float(np.cos(half)))


def _refuse_ring(gear: AbstractInvoluteGear) -> None:
    if gear.is_ring:
        raise DesignError("gear", "found a ring, whose teeth no jaws reach", "measure between pins")


@checked
def tooth_table(gear: AbstractInvoluteGear, tolerance: Positive) -> Table:
    """The right-hand half of the tooth on +y, from the inside out, as finely as the tolerance, mm, asks.

    The last column names the region of each point, as `regions` of the gear has them.
    """
    sides = gear.regions
    chords = [flatten(curve, tolerance) for curve in sides.values()]
    chords[1:] = [side[1:] for side in chords[1:]]  # neighbouring curves share a point
    z = np.concatenate(chords)
    half = np.degrees(np.arctan2(z.real, z.imag))
    along = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    return Table(
        (
            Column("along", "mm", "length of the side from its inner end, by chords", along),
            Column("radius", "mm", "distance from the gear's axis", np.abs(z)),
            *xy_columns("tooth", "mm", "right-hand side of the tooth centred on +y", z),
            Column("half_thickness_angle", "deg", "angle from the tooth's centre line", half),
            Column(
                "region",
                "",
                "region of the tooth",
                np.repeat(list(sides), [len(side) for side in chords]),
            ),
        )
    )
