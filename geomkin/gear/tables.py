"""Coordinates of teeth, and the contact of gears, as tables."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..arguments import Positive, checked
from ..plane.curve import AbstractCurve
from ..plane.derived import Reversed
from ..plane.flatten import flatten
from ..table import Column, Table, xy_columns
from .contract import AbstractInvoluteGear
from .pair import GearPair
from .rack import RackPair

# Places along the path of contact: enough to draw its curves.
ROWS = 101
# Base pitches to either side at which other pairs of flanks are looked for: no gears have as many in contact.
NEIGHBOURS = 9


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
