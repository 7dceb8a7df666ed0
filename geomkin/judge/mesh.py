"""Whether gears run with each other."""

from __future__ import annotations

from ..arguments import checked
from ..check import Check
from ..gear.pair import GearPair
from ..gear.planetary import PlanetarySet
from ..gear.rack import RackPair

# Pairs of teeth in contact on the average, of involutes that may be a little apart: somewhat above 1, so that the next
# pair takes over before the last lets go (Roloff/Matek: 1.1; Shigley's Mechanical Engineering Design: about 1.2).
LEAST_CONTACT_RATIO = 1.1
# Modules between tips and roots: the least that DIN 867 gives a basic rack.
LEAST_CLEARANCE = 0.1
# Modules between the tips of neighbouring planets; derived here, of play and dirt.
LEAST_PLANET_GAP = 0.5


@checked
def mesh_checks(pair: GearPair | RackPair, name: str = "") -> tuple[Check, ...]:
    """Contact, clearance and interference of two gears. name: what the checks call the pair."""
    clear = min(pair.clearances) / pair.module
    before = f"{name}: " if name else ""
    teeth = "give more teeth, less shift or no undercut"
    meeting = f"at {', '.join(pair.interferences)}: cut the tips"
    return (
        Check(f"{before}contact ratio", pair.contact_ratio, "at least", LEAST_CONTACT_RATIO, "", teeth),
        Check(
            f"{before}clearance of tips from roots", clear, "at least", LEAST_CLEARANCE, "modules",
            "give a smaller addendum",
        ),
        Check(f"{before}interferences", len(pair.interferences), "at most", 0, "", meeting),
    )  # fmt: skip


@checked
def planetary_checks(gears: PlanetarySet) -> tuple[Check, ...]:
    """Both meshes of a planetary set, and the room between its planets where there are several."""
    room = gears.planet_gap / gears.sun.module
    beside = Check("room between planets", room, "at least", LEAST_PLANET_GAP, "modules", "give fewer planets")
    return (
        *mesh_checks(gears.inner, "sun"),
        *mesh_checks(gears.outer, "ring"),
        *((beside,) if gears.planets > 1 else ()),
    )
