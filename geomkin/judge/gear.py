"""Whether a gear is strong enough."""

from __future__ import annotations

from ..arguments import checked
from ..check import Check
from ..gear.contract import AbstractGear

# Modules. A thinner tip chips, and breaks off when it is hardened (Roloff/Matek, Maschinenelemente: 0.2, hardened 0.4).
LEAST_TIP_THICKNESS = 0.2
# Modules of rim under or outside the teeth. A rim bears fully from 1.2 tooth heights on, and under half a height, which
# this is, cracks run through it instead of through the tooth (rim thickness factor of ISO 6336-3 and AGMA 2001-D04).
LEAST_RIM = 1


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
