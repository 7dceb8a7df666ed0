"""Contact of two gears as a table."""

from __future__ import annotations

import numpy as np

from ..arguments import checked
from ..table import Column, Table
from .pair import GearPair
from .rack import RackPair

# Places along the path of contact: enough to draw its curves.
ROWS = 101
# Base pitches to either side at which other pairs of flanks are looked for: no gears have as many in contact.
NEIGHBOURS = 9


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
