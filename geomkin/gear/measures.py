"""What is measured on gears: span, over pins, chord of a tooth (ISO 21771, DIN 3960); teeth and contact as tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arguments import Positive, checked
from ..brief import one_line
from ..errors import DesignError
from ..plane.curve import AbstractCurve, Reversed
from ..plane.flatten import flatten
from ..plane.vec import Real
from ..sizes import Length, rounded_down, rounded_up
from ..table import Column, Table, xy_columns
from .conjugate.conjugate import Conjugate
from .contract import AbstractInvoluteGear
from .involute import inverse_involute, roll_at
from .pair import GearPair
from .rack import RackPair

# Places along the path of contact: enough to draw its curves.
ROWS = 101
# Base pitches to either side at which other pairs of flanks are looked for: no gears have as many in contact.
NEIGHBOURS = 9
# Places on a flank or pin: half a percent of it apart.
PLACES = 201


@dataclass(frozen=True)
class SpanMeasure:
    """length: mm, between flat jaws over `teeth` teeth; radius: of the circle on which they touch, mm."""

    teeth: int
    length: float
    radius: float

    __repr__ = one_line


@dataclass(frozen=True)
class PinMeasure:
    """What two pins in opposite spaces measure.

    diameter: over the two pins, mm, between them for a ring; pin: their diameter, mm;
    radius: of the circle through the pins' centres, mm; contact: of the circle on which they touch the flanks, mm.
    """

    diameter: float
    pin: float
    radius: float
    contact: float

    __repr__ = one_line


@dataclass(frozen=True)
class ChordMeasure:
    """Of a tooth at a circle: thickness along the arc and the chord, mm, half its angle, rad, height of the tip, mm."""

    arc: float
    chord: float
    half_angle: float
    height: float

    __repr__ = one_line


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
    """The right-hand side of the tooth on +y, outwards, as finely as the tolerance, mm, asks."""
    sides = _sides(gear)
    chords = [flatten(curve, tolerance) for curve in sides.values()]
    chords[1:] = [side[1:] for side in chords[1:]]  # neighbouring curves share a point
    z = np.concatenate(chords)
    half = np.degrees(np.arctan2(z.real, z.imag))
    return Table(
        (
            Column("radius", "mm", "distance from the gear's axis", np.abs(z)),
            *xy_columns("tooth", "mm", "right-hand side of the tooth centred on +y", z),
            Column("half_thickness_angle", "deg", "angle from the tooth's centre line", half),
            Column("region", "", "curve the point lies on", np.repeat(list(sides), [len(side) for side in chords])),
        )
    )


def _sides(gear: AbstractInvoluteGear) -> Mapping[str, AbstractCurve]:
    """The curves of half a tooth by name, outwards."""
    if gear.is_ring:
        return {"involute": Reversed(gear.flank), "root": Reversed(gear.root_curve)}
    sides = {"root": gear.root_curve, "involute": gear.flank}
    return sides | {"tip": gear.tip_edge} if gear.tip_edge else sides


@checked
def contact_table(pair: GearPair | RackPair) -> Table:
    """Contact of one pair of flanks from its beginning to its end, sliding included."""
    names, gear = pair.names, pair.driver
    start, end = pair.contact_lengths
    along = np.linspace(start, end, ROWS)
    turn = np.degrees((along - np.sqrt(gear.pitch_radius**2 - gear.base_radius**2)) / gear.base_radius)
    first, second = pair.sliding(along)
    # Other pairs of flanks are whole base pitches away.
    other = along[:, None] + gear.base_pitch * np.arange(-NEIGHBOURS, NEIGHBOURS + 1)
    count = ((other >= start - 1e-9) & (other <= end + 1e-9)).sum(axis=1)
    return Table(
        (
            Column(
                f"{names[0]}_turn", "deg", "turn since its pitch circle's flank point was on the line of action", turn
            ),
            Column("along", "mm", f"place on the line of action, from the base circle of the {names[0]}", along),
            Column(f"{names[0]}_radius", "mm", "radius of the contact", np.hypot(gear.base_radius, along)),
            Column(f"{names[0]}_sliding", "", "specific sliding", first),
            Column(f"{names[1]}_sliding", "", "specific sliding", second),
            Column("pairs", "", "pairs of flanks in contact", count),
        )
    )


@checked
def flank_table(mate: Conjugate, backlash: Length = 0.0) -> Table:
    """Contact along the gear's flank. backlash: mm along the pitch circle, as the mate was made with."""
    share = np.linspace(0, 1, PLACES)
    where = Column("flank_share", "", "place on the right-hand flank, 0 at the bottom land, 1 at the tip", share)
    return _table(where, mate, share, backlash)


@checked
def pin_table(mate: Conjugate, quarters: int, backlash: Length = 0.0) -> Table:
    """Contact along a lantern pin's right-hand side, as many quarters of it as are the pin itself, 1 or 2."""
    angle = np.linspace(-90, 90 * (quarters - 1), PLACES)
    where = Column("pin_angle", "deg", "place on the pin, -90 its innermost", angle)
    return _table(where, mate, 1 + angle / 90, backlash)


def _table(where: Column, mate: Conjugate, t: Real, backlash: float) -> Table:
    """Contact at places t of piece 0 of the mate's cutter, the turned right-hand flank of the gear.

    Both angles count from where the gear's tooth stands on +y in the very middle of the mate's space. The gear's is
    the gear's own, the same as without backlash; the mate's is half the play off the ratio, on the side on which the
    right-hand flanks touch, and so over the whole contact.
    """
    ahead = backlash * mate.teeth / (2 * mate.gear_teeth * mate.pitch_radius)
    contact = mate.contact(t)
    tooth = mate.tooth.point(t) * np.exp(1j * ahead)
    # Outside each other two gears turn against each other.
    ratio = mate.gear_teeth / mate.teeth * (1 if mate.is_ring else -1)
    turned = np.degrees(contact.angle - ahead)
    followed = np.degrees(contact.angle) * ratio
    words = "mate's turn then, 0 with the play shared by both sides of the tooth on +y"
    return Table(
        (
            where,
            *xy_columns("tooth", "mm", "that place on the gear's tooth centred on +y", tooth),
            Column("gear_angle", "deg", "gear's turn when it touches, 0 with the tooth on +y", turned),
            Column("mate_angle", "deg", words, followed),
            *xy_columns("contact", "mm", "path of contact, gear's axis at 0, pitch point on +y", contact.place),
            *xy_columns("mate_tooth", "mm", "the same place in the mate's own frame", contact.mate),
            Column("sliding", "mm/rad", "of the gear along the mate's flank, per turn of the gear", contact.sliding),
            Column("pressure_angle", "deg", "of the common normal", np.degrees(contact.pressure_angle)),
        )
    )
