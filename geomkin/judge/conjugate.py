"""Whether mates by the law of gearing run with the gears that shape them."""

from __future__ import annotations

from ..arguments import Positive, checked
from ..check import Check
from ..gear.conjugate.conjugate import BEYOND, Conjugate
from .gear import LEAST_TIP_THICKNESS

# Pairs of teeth in contact on the average. The contact is found exactly: at 1 it just hands over; derived here.
LEAST_CONTACT_RATIO = 1


@checked
def conjugate_checks(mate: Conjugate, module: Positive, pieces: int = 1, longer: str = "") -> tuple[Check, ...]:
    """Contact ratio and tips of a mate.

    module: of its gear, mm. pieces: how many of its cutter's, from the first on, are the driving side of the gear's
    tooth. longer: what else makes the contact longer, for the advice.
    """
    ratio, thickness = mate.contact_ratio(0.0, pieces), mate.tip_thickness / module
    thinner = "give a smaller mate.addendum or mate.backlash"
    teeth = f"give longer teeth, or more of them{longer}"
    return (
        Check("contact ratio", ratio, "at least", LEAST_CONTACT_RATIO, "", teeth),
        Check("mate's tip thickness", thickness, "at least", LEAST_TIP_THICKNESS, "modules", thinner),
    )


@checked
def touch_check(mate: Conjugate, module: Positive) -> Check:
    """Whether all of the gear's flank touches the mate."""
    lost = sum(u.outer_radius - u.inner_radius for u in mate.untouched if u.start < 1 and u.why != BEYOND)
    advice = "the mate is undercut: give it more teeth, or the gear's flanks less height or more lean"
    return Check("flank that cannot touch", lost / module, "at most", 0, "modules", advice)
