"""Checks of gears: tips, undercut, rims, contact, clearance and strength."""

from __future__ import annotations

import numpy as np

from ..core.arguments import FloatOrNan, PositiveFloat, checked
from ..core.fields import ROUNDING, rounded_down
from ..model.check import Check, Suggestion
from .conjugate.conjugate import BEYOND, Conjugate
from .contract import AbstractGear
from .pair import GearPair
from .planetary import PlanetarySet
from .rack import RackPair
from .strength import LEAST_CONTACT_SAFETY, LEAST_ROOT_SAFETY, UNKNOWN, AbstractMeshStrength

# Modules. A thinner tip chips (Roloff/Matek, Maschinenelemente: 0.2, for hardened teeth 0.4).
LEAST_TIP_THICKNESS = 0.2
# Modules of rim under or outside the teeth: half a tooth height. In a thinner rim cracks run through the rim instead of
# the tooth; from 1.2 heights on it has its full strength (rim thickness factor of ISO 6336-3 and AGMA 2001-D04).
LEAST_RIM = 1


@checked
def gear_checks(gear: AbstractGear, rim: float | None = None, name: str = "") -> tuple[Check, ...]:
    """Check the tips, the undercut and the rim of one gear.

    Parameters
    ----------
    gear : AbstractGear
        The gear.
    rim : float, optional
        Thickness of material under the teeth, mm; outside them for a ring. By default the gear is solid, and the rim of
        a ring is not checked.
    name : str
        Name of the gear in the ids and names of the checks.

    Returns
    -------
    tuple of Check
        Values in modules.

    Notes
    -----
    The limits are constants of this module, each with its source.
    """
    before, prefix, module = f"{name} " if name else "", f"{name}_" if name else "", gear.module
    thinner = "give less profile_shift, addendum or tooth_thickness_allowance"
    tip = gear.tip_thickness / module
    least = LEAST_TIP_THICKNESS
    checks = [Check(f"{prefix}tip_thickness", f"{before}tip thickness", tip, "at least", least, "modules", thinner)]
    if gear.lost_to_undercut is not None:
        lost, more = gear.lost_to_undercut / module, "give more teeth or profile_shift"
        words = f"{before}involute lost to undercut"
        checks.append(Check(f"{prefix}undercut", words, lost, "at most", 0, "modules", more))
    rim = gear.solid_rim if rim is None else rim
    if rim is not None:
        where, advice = ("outside", "give a thicker rim") if gear.is_ring else ("under", "give a smaller bore")
        advice = advice if gear.hole_room else "give a higher bar"
        words = f"{before}rim {where} the teeth"
        checks.append(Check(f"{prefix}rim", words, rim / module, "at least", LEAST_RIM, "modules", advice))
    return tuple(checks)


# Contact ratio of involutes, whose distance may deviate a little: above 1, so that a pair of teeth comes into contact
# before the last one leaves it (Roloff/Matek: 1.1; Shigley's Mechanical Engineering Design: about 1.2).
LEAST_CONTACT_RATIO = 1.1
# Modules between tips and roots: the least clearance of a basic rack by DIN 867.
LEAST_CLEARANCE = 0.1
# Modules between the tips of adjacent planets; derived here from play and dirt.
LEAST_PLANET_GAP = 0.5


@checked
def mesh_checks(pair: GearPair | RackPair, name: str = "") -> tuple[Check, ...]:
    """Check contact, clearance and interference of two gears.

    Parameters
    ----------
    pair : GearPair or RackPair
        The gears in mesh.
    name : str
        Name of the pair in the ids and names of the checks.

    Returns
    -------
    tuple of Check
        Contact ratio, clearance of the tips in modules, and number of interferences.
    """
    clear = min(pair.clearances) / pair.module
    before, prefix = (f"{name}: ", f"{name}_") if name else ("", "")
    teeth = "give more teeth, less shift or no undercut"
    meeting = f"at {', '.join(pair.interferences)}: give a smaller addendum, or other profile shifts"
    return (
        Check(
            f"{prefix}contact_ratio", f"{before}contact ratio", pair.contact_ratio,
            "at least", LEAST_CONTACT_RATIO, "", teeth,
        ),
        Check(
            f"{prefix}tip_clearance", f"{before}clearance of tips from roots", clear,
            "at least", LEAST_CLEARANCE, "modules", "give a smaller addendum",
        ),
        Check(
            f"{prefix}interferences", f"{before}interferences", len(pair.interferences), "at most", 0, "", meeting
        ),
    )  # fmt: skip


@checked
def strength_checks(
    loaded: AbstractMeshStrength, name: str = "", limit: FloatOrNan | None = None, key: str = "loads.torque_n_mm"
) -> tuple[Check, ...]:
    """Check the teeth of two gears under a load.

    Parameters
    ----------
    loaded : PairStrength or RackStrength
        The pair under its loads.
    name : str
        Name of the pair in the ids and names of the checks.
    limit : float, optional
        Load that the advice names; by default the torque on the driving gear at which a safety falls to its limit.
    key : str
        Key of that load in a recipe.

    Returns
    -------
    tuple of Check
        Safety of the roots of each gear, except of a ring, and of the flanks; failed if a strength is unknown.

    Notes
    -----
    Limits are constants of `geomkin.gear.strength`. Stresses are nominal ones, with the given load factors.
    """
    before, prefix = (f"{name}: ", f"{name}_") if name else ("", "")
    limit = float(loaded.torque * loaded.load_margin if limit is None else limit)  # type: ignore[arg-type]
    advice = "give strength, modulus and poisson_ratio of the material"
    suggestions: tuple[Suggestion, ...] = ()
    if np.isfinite(limit):
        most, unit = rounded_down(limit * (1 - ROUNDING), 4), "N" if key.endswith("force_n") else "N mm"
        advice = f"give at most {most} {unit}, a wider face, a larger module or a stronger material"
        suggestions = (Suggestion({key: float(most)}),)
    roots = (
        Check(
            f"{prefix}{gear}_root_safety", f"{before}strength of the {gear} gear's roots over their stress",
            teeth.root_safety, "at least", LEAST_ROOT_SAFETY, "", advice, suggestions=suggestions,
        )
        for gear, teeth in zip(loaded.pair.names, loaded.teeth)
        if teeth is not UNKNOWN
    )  # fmt: skip
    words = f"{before}pressure at which the flanks yield over their pressure"
    safety = loaded.contact_safety
    id, least = f"{prefix}contact_safety", LEAST_CONTACT_SAFETY
    return *roots, Check(id, words, safety, "at least", least, "", advice, suggestions=suggestions)


@checked
def planetary_checks(gears: PlanetarySet) -> tuple[Check, ...]:
    """Check both meshes of a planetary set, and the room between its planets.

    Parameters
    ----------
    gears : PlanetarySet
        The set.

    Returns
    -------
    tuple of Check
        `mesh_checks` of sun and ring; the gap between planets, in modules, if there are several.
    """
    room = gears.planet_gap / gears.sun.module
    fewer, least = "give fewer planets", LEAST_PLANET_GAP
    beside = Check("planet_gap", "room between planets", room, "at least", least, "modules", fewer)
    return (
        *mesh_checks(gears.inner, "sun"),
        *mesh_checks(gears.outer, "ring"),
        *((beside,) if gears.planets > 1 else ()),
    )


# Contact ratio of conjugate gears, whose contact is computed exactly: at 1 it is just continuous; derived here.
LEAST_CONJUGATE_CONTACT_RATIO = 1


@checked
def conjugate_checks(mate: Conjugate, module: PositiveFloat, pieces: int = 1, longer: str = "") -> tuple[Check, ...]:
    """Check the contact ratio and the tips of a conjugate gear.

    Parameters
    ----------
    mate : Conjugate
        The mate of a gear.
    module : float
        Module of the gear, mm.
    pieces : int
        Number of pieces of the cutter, from the first, that form the driving side of the gear's tooth.
    longer : str
        Further advice on how to lengthen the contact.

    Returns
    -------
    tuple of Check
        Contact ratio, and tip thickness in modules.
    """
    ratio, thickness = mate.contact_ratio(0.0, pieces), mate.tip_thickness / module
    thinner = "give a smaller mate.addendum or mate.backlash"
    teeth = f"give longer teeth, or more of them{longer}"
    return (
        Check("contact_ratio", "contact ratio", ratio, "at least", LEAST_CONJUGATE_CONTACT_RATIO, "", teeth),
        Check(
            "mate_tip_thickness", "mate's tip thickness", thickness, "at least", LEAST_TIP_THICKNESS, "modules", thinner
        ),
    )


@checked
def touch_check(mate: Conjugate, module: PositiveFloat) -> Check:
    """Check that all of the gear's flank touches its mate.

    Parameters
    ----------
    mate : Conjugate
        The mate of a gear.
    module : float
        Module of the gear, mm.

    Returns
    -------
    Check
        Height of the flank that does not touch, in modules.
    """
    lost = sum(u.outer_radius - u.inner_radius for u in mate.untouched if u.start < 1 and u.why != BEYOND)
    advice = "the mate is undercut: give it more teeth, or the gear's flanks less height or more lean"
    return Check("untouched_flank", "flank that cannot touch", lost / module, "at most", 0, "modules", advice)
