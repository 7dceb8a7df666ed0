"""The contact of conjugate mates as tables."""

from __future__ import annotations

import numpy as np

from ...arguments import checked
from ...plane.vec import Real
from ...sizes import Length
from ...table import Column, Table, xy_columns
from .conjugate import Conjugate

# Places on a flank or pin: half a percent of it apart.
PLACES = 201


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
