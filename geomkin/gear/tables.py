"""Coordinates of teeth, and the contact of gears and of conjugate mates, as tables."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..arguments import Positive, checked
from ..plane.curve import AbstractCurve
from ..plane.derived import Reversed
from ..plane.flatten import flatten
from ..plane.vec import Real
from ..sizes import Length
from ..table import Column, Table, xy_columns
from .conjugate.conjugate import Conjugate
from .contract import AbstractInvoluteGear
from .pair import GearPair
from .rack import RackPair

# Places along the path of contact: enough to draw its curves.
ROWS = 101
# Base pitches to either side at which other pairs of flanks are looked for: no gears have as many in contact.
NEIGHBOURS = 9
# Places on a flank or pin: half a percent of it apart.
PLACES = 201


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
