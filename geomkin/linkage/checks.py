"""Whether a linkage runs through, how well it drives, and whether its plates can be cut and pass each other."""

from __future__ import annotations

import numpy as np

from ..core.arguments import Positive, checked
from ..core.errors import DesignError
from ..model.check import Check
from .measures import assembly_failure, least_transmission_angle
from .motion import Motion

# deg. Below it the coupler pushes the rocker into its pivot more than round it, and play and friction grow quickly
# (Norton, Design of Machinery, on the transmission angle: above about 40 deg; the angle itself: Alt, Der
# Übertragungswinkel, Werkstattstechnik 26, 1932).
LEAST_TRANSMISSION_ANGLE_DEG = 40
# The name of its check.
TRANSMISSION = "least transmission angle"
# deg, the same of polygons, which only have to be drawn. At less, their vectors run off the plate; derived here, of
# polygons drawn at many positions.
LEAST_ANGLE_OF_POLYGONS_DEG = 5
# Hole to thickness. Smaller ones burn shut or break out; what cutting services ask for of laser and water jet alike.
LEAST_HOLE_TO_THICKNESS = 0.5
# mm. Traces of one curve by three linkages that are farther apart are not the same; derived here, of rounding.
SAME_CURVE = 1e-6
# Largest force over the least that it could be. Nobody feels five percent; derived here.
MOST_FORCE_TO_BEST = 1.05
# Diameters and radii that are drawn, in longest links. Larger ones leave nothing else to be seen; derived here.
LARGEST_DRAWN = 5.0


def reached(motion: Motion, what: str, advice: str = "") -> Check:
    """Share of the frames that a motion reaches. what: whose way they are, such as "crank's turn"."""
    return Check(f"share of the {what} reached", 100 * float(motion.assembled.mean()), "at least", 100, "%", advice)


@checked
def linkage_checks(motion: Motion) -> tuple[Check, ...]:
    """Whether the driver runs through all frames, and how well it drives: the least transmission angle, deg.

    A failed check says which dyad opens first and what would mend it, or is advice. Where the driver drives nothing
    else there is no angle to judge, and no check of it. DesignError for many linkages at once. Limits: as at
    `LEAST_TRANSMISSION_ANGLE_DEG`.
    """
    if motion.linkage.is_batch:
        raise DesignError("motion", "found many linkages at once", "give one, for each has checks of its own")
    driver, turns, opens = motion.linkage.driver, motion.linkage.driven_slider is None, assembly_failure(motion)
    advice = f"shorten the {driver} or give a shorter way" if turns else "give a shorter stroke"
    share = reached(motion, f"{driver}'s {'turn' if turns else 'stroke'}", f"{opens}; {advice}" if opens else advice)
    least = float(np.degrees(least_transmission_angle(motion)))
    if motion.assembled.any() and np.isnan(least):
        return (share,)
    along = "a driving link pushes the driven one along itself"
    return share, Check(TRANSMISSION, least, "at least", LEAST_TRANSMISSION_ANGLE_DEG, "deg", along)


@checked
def hole_check(hole_diameter: Positive, thickness: Positive) -> Check:
    """Whether pin holes, mm, can be cut in a sheet of a thickness, mm: what cutting services ask for."""
    advice = "smaller holes burn or break out when cut"
    return Check("pin hole to thickness", hole_diameter / thickness, "at least", LEAST_HOLE_TO_THICKNESS, "", advice)


@checked
def collision_check(collisions: int, advice: str = "") -> Check:
    """Whether plates and pins pass each other. collisions: how many do not, `len(stack.collisions)`. Derived here."""
    return Check("plates and pins that collide", collisions, "at most", 0, "", advice)
