"""Whether gears are strong enough, and whether they run with each other."""

from __future__ import annotations

from ..arguments import checked
from ..check import Check
from ..gear.contract import AbstractGear
from ..gear.pair import GearPair
from ..gear.planetary import PlanetarySet
from ..gear.rack import RackPair

# Modules. A thinner tip chips, and breaks off when it is hardened (Roloff/Matek, Maschinenelemente: 0.2, hardened 0.4).
LEAST_TIP_THICKNESS = 0.2
# Modules of rim under or outside the teeth. A rim bears fully from 1.2 tooth heights on, and under half a height, which
# this is, cracks run through it instead of through the tooth (rim thickness factor of ISO 6336-3 and AGMA 2001-D04).
LEAST_RIM = 1
# Pairs of teeth in contact on the average, of involutes that may be a little apart: somewhat above 1, so that the next
# pair takes over before the last lets go (Roloff/Matek: 1.1; Shigley's Mechanical Engineering Design: about 1.2).
LEAST_CONTACT_RATIO = 1.1
# Modules between tips and roots: the least that DIN 867 gives a basic rack.
LEAST_CLEARANCE = 0.1
# Modules between the tips of neighbouring planets; derived here, of play and dirt.
LEAST_PLANET_GAP = 0.5
# What stands in for the room beside a lone planet, which is without end, modules: any number that is far above all.
LONE_PLANET = 1e6


@checked
def gear_checks(gear: AbstractGear, rim: float | None = None, name: str = "") -> tuple[Check, ...]:
    """Tip, undercut, and what holds the teeth of one gear.

    rim: thickness under the teeth, mm, of a ring outside them; left out, the gear is solid, and a ring's is not
    judged. name: what the checks call the gear.
    """
    before, module = f"{name} " if name else "", gear.module
    thinner = "give less profile_shift, addendum or thinning"
    tip = gear.tip_thickness / module
    checks = [Check(f"{before}tip thickness", tip, "at least", LEAST_TIP_THICKNESS, "modules", thinner)]
    if gear.lost_to_undercut is not None:
        lost, more = gear.lost_to_undercut / module, "give more teeth or profile_shift"
        checks.append(Check(f"{before}involute lost to undercut", lost, "at most", 0, "modules", more))
    rim = gear.solid_rim if rim is None else rim
    if rim is not None:
        where, advice = ("outside", "give a thicker rim") if gear.is_ring else ("under", "give a smaller bore")
        advice = advice if gear.hole_room else "give a higher bar"
        checks.append(Check(f"{before}rim {where} the teeth", rim / module, "at least", LEAST_RIM, "modules", advice))
    return tuple(checks)


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
    """Both meshes of a planetary set, and the room between its planets."""
    room = min(gears.planet_gap / gears.sun.module, LONE_PLANET)
    return (
        *mesh_checks(gears.inner, "sun"),
        *mesh_checks(gears.outer, "ring"),
        Check("room between planets", room, "at least", LEAST_PLANET_GAP, "modules", "give fewer planets"),
    )
