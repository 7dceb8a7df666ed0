"""Measures of gears: span, over pins, chordal thickness (ISO 21771, DIN 3960); tables of a tooth and of a contact."""

from __future__ import annotations

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import Length, rounded_up
from ..core.records import record
from ..core.units import bare_mm, mm
from ..model.table import Column, Table, xy_columns
from ..plane.flatten import flatten
from ..plane.roulettes import inverse_involute, roll_at
from .contract import AbstractInvoluteGear
from .pair import GearPair
from .rack import RackPair

# Steps of the diameters of measuring pins from a diameter on, mm, as in usual sets; chosen here.
PIN_STEPS = ((10.0, 0.5), (1.5, 0.25), (0.0, 0.05))


@record
class SpanMeasure:
    """A span measurement.

    Parameters
    ----------
    teeth : int
        Number of teeth between the jaws.
    length : float
        Distance between the flat jaws, mm.
    radius : float
        Radius of the circle on which they touch, mm.
    """

    teeth: int
    length: float
    radius: float


@record
class PinMeasure:
    """A measurement with two pins in opposite spaces.

    Parameters
    ----------
    diameter : float
        Dimension over the two pins, mm; between them for a ring.
    pin : float
        Diameter of the pins, mm.
    radius : float
        Radius of the circle through the pins' centres, mm.
    contact : float
        Radius of the circle on which the pins touch the flanks, mm.
    """

    diameter: float
    pin: float
    radius: float
    contact: float


@record
class ChordMeasure:
    """Thickness of a tooth at a circle.

    Parameters
    ----------
    arc, chord : float
        Thickness along the arc and along the chord, mm.
    half_angle : float
        Half the angle of the tooth, rad.
    height : float
        Height of the tip above the chord, mm.
    """

    arc: float
    chord: float
    half_angle: float
    height: float


@checked
def span(gear: AbstractInvoluteGear, teeth: int | None = None) -> SpanMeasure:
    """Span measurement over a number of teeth.

    Parameters
    ----------
    gear : AbstractInvoluteGear
        An external gear.
    teeth : int, optional
        Number of teeth; by default the one for which the jaws touch closest to the middle of the flanks.

    Returns
    -------
    SpanMeasure
        Number of teeth, length and radius of contact, mm.

    Raises
    ------
    DesignError
        If the jaws would touch outside the involute, and for a ring.

    Notes
    -----
    The span is a number of base pitches plus the thickness of one tooth on the base circle (ISO 21771).

    Examples
    --------
    >>> measure = gk.gear.span(gk.SpurGear(24, 2))
    >>> measure.teeth, round(measure.length, 4)
    (3, 15.4329)
    """
    _refuse_ring(gear)
    start, end = gear.flank_lengths

    def length(k: float) -> float:
        return (k - 1) * gear.base_pitch + gear.thickness(gear.base_radius)

    # The line between the jaws touches the base circle at its middle: half the span is the tangent length there.
    fitting = [k for k in range(1, gear.teeth) if start <= length(k) / 2 <= end]
    if not fitting:
        raise DesignError("teeth", "no number of teeth can be spanned", "measure over pins")
    if teeth is None:
        teeth = min(fitting, key=lambda k: abs(length(k) - start - end))
    if teeth not in fitting:
        nearest = min(fitting, key=lambda k: abs(k - teeth))
        problem = f"found {teeth}, for which the jaws miss the involute"
        raise DesignError("teeth", problem, f"give {nearest}", "out-of-range")
    return SpanMeasure(teeth, length(teeth), float(np.hypot(gear.base_radius, length(teeth) / 2)))


@checked
def over_pins(gear: AbstractInvoluteGear, pin: Length | None = None) -> PinMeasure:
    """Dimension over two pins, or between them in a ring, in opposite spaces (nearly opposite for an odd number).

    Parameters
    ----------
    gear : AbstractInvoluteGear
        An external gear or a ring.
    pin : float, optional
        Diameter of the pins, mm; by default pins that touch the flanks at the shifted reference line.

    Returns
    -------
    PinMeasure
        Dimension, pin diameter and radii, mm.

    Raises
    ------
    DesignError
        If a pin would touch outside the involute, or not project beyond the tips.

    Notes
    -----
    ISO 21771 and DIN 3960.

    Examples
    --------
    >>> round(gk.gear.over_pins(gk.SpurGear(24, 2), pin=3.5).diameter, 3)
    52.951
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
        remedy = "measure the span instead" if pin == best else f"give about {mm(best):.4g}"
        value = None if pin == best else best
        problem = f"found {mm(pin):g}, for which the pin is below the tips or misses the flanks"
        raise DesignError("pin", problem, remedy, "out-of-range", value)
    across = 2 * radius * (np.cos(np.pi / (2 * gear.teeth)) if gear.teeth % 2 else 1.0)
    return PinMeasure(float(across + sign * pin), float(pin), radius, float(np.hypot(base, touching)))


def _pin(gear: AbstractInvoluteGear, sign: int, half_space: float) -> float:
    """Diameter of the pin that touches the flanks at the shifted reference line, mm.

    The pin's centre is on the flank's normal there and in the middle of the space: with roll angles m of the contact
    and c of the centre, inv(c) = |c - m| -+ the half space, so that arctan(c) = m +- the half space.
    """
    base = gear.base_radius
    low, high = (length / base for length in gear.flank_lengths)
    m = min(max(roll_at(gear.pitch_radius + gear.profile_shift * gear.module, base), low), high)
    angle = m + sign * half_space
    return 2 * base * sign * (float(np.tan(angle)) - m) if angle < np.pi / 2 else float("inf")


def over_stock_pins(gear: AbstractInvoluteGear, wanted: float | None = None) -> PinMeasure:
    """The dimension over pins of a wanted diameter, mm, or of the nearest usual one, or over the best ones.

    Raises DesignError if the gear cannot be measured over pins.
    """
    best = over_pins(gear)
    step = next(step for least, step in PIN_STEPS if best.pin >= least)
    nearest = round(best.pin / step) * step
    for pin in (wanted, *sorted((nearest + k * step for k in range(-2, 3)), key=lambda pin: abs(pin - best.pin))):
        try:
            if pin is not None and pin > 0:
                return over_pins(gear, pin)
        except DesignError:
            continue
    return best


@checked
def chord(gear: AbstractInvoluteGear, radius: float | None = None) -> ChordMeasure:
    """Chordal thickness of a tooth at a circle, as measured by a tooth caliper.

    Parameters
    ----------
    gear : AbstractInvoluteGear
        An external gear.
    radius : float, optional
        Radius of the circle, mm; by default the pitch radius.

    Returns
    -------
    ChordMeasure
        Thickness, half angle and height.

    Raises
    ------
    DesignError
        If the circle does not cross the involute, and for a ring.

    Examples
    --------
    >>> round(gk.gear.chord(gk.SpurGear(24, 2)).chord, 4)
    3.1394
    """
    _refuse_ring(gear)
    r = gear.pitch_radius if radius is None else radius
    low, high = (float(np.hypot(gear.base_radius, s)) for s in gear.flank_lengths)
    if not low <= r <= high:
        remedy = f"give {bare_mm(low):up} to {mm(high):down}"
        raise DesignError("radius", f"found {mm(r):g}, outside the involute", remedy, "out-of-range", rounded_up(low))
    arc = gear.thickness(r)
    half = arc / (2 * r)
    return ChordMeasure(arc, 2 * r * float(np.sin(half)), half, gear.tip_radius - r * float(np.cos(half)))


def _refuse_ring(gear: AbstractInvoluteGear) -> None:
    if gear.is_ring:
        problem = "found a ring, whose teeth cannot be measured with jaws"
        raise DesignError("gear", problem, "measure between pins", "wrong-type")


@checked
def tooth_table(gear: AbstractInvoluteGear, tolerance: PositiveFloat) -> Table:
    """Coordinates of the right-hand half of the tooth on +y, from the inside outwards.

    Parameters
    ----------
    gear : AbstractInvoluteGear
        The gear.
    tolerance : float
        Largest distance between curve and chords, mm, above 0.

    Returns
    -------
    Table
        One row for each point; the last column is the name of its region, as in `regions` of the gear.
    """
    sides = gear.regions
    chords = [flatten(curve, tolerance) for curve in sides.values()]
    chords[1:] = [side[1:] for side in chords[1:]]  # adjacent curves share a point
    z = np.concatenate(chords)
    half = np.degrees(np.arctan2(z.real, z.imag))
    along = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    return Table(
        (
            Column("along", "mm", "length of the side from its inner end, by chords", along),
            Column("radius", "mm", "distance from the gear's axis", np.abs(z)),
            *xy_columns("tooth", "mm", "right-hand side of the tooth centred on +y", z),
            Column("half_thickness_angle", "deg", "angle from the tooth's centre line", half),
            Column("region", "", "region of the tooth", np.repeat(list(sides), [len(side) for side in chords])),
        )
    )


# Points along the path of contact: enough to draw its curves.
ROWS = 101
# Base pitches to either side in which other pairs of flanks are counted: more than any gears have in contact.
NEIGHBOURS = 9


@checked
def contact_table(pair: GearPair | RackPair) -> Table:
    """Contact of one pair of flanks from start to end, with specific sliding.

    Parameters
    ----------
    pair : GearPair or RackPair
        The pair.

    Returns
    -------
    Table
        Rotation of the driver, length on the line of action, radius, specific sliding of both, and the number of pairs
        of flanks in contact.

    Examples
    --------
    >>> pair = gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(40, 2))
    >>> int(gk.gear.contact_table(pair)["pairs"].max())
    2
    """
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
            Column(f"{names[0]}_turn", "deg", f"rotation of the {names[0]} since contact at the pitch point", turn),
            Column("along", "mm", f"contact on the line of action, from the base circle of the {names[0]}", along),
            Column(
                f"{names[0]}_radius",
                "mm",
                f"radius of the contact on the {names[0]}",
                np.hypot(gear.base_radius, along),
            ),
            Column(f"{names[0]}_sliding", "", f"specific sliding of the {names[0]}", first),
            Column(f"{names[1]}_sliding", "", f"specific sliding of the {names[1]}", second),
            Column("pairs", "", "pairs of flanks in contact", count),
        )
    )
