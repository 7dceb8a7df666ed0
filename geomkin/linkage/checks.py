"""Whether a linkage runs through, how well it drives, and whether its plates can be cut and pass each other."""

from __future__ import annotations

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..model.check import Check
from .assembly_failures import assembly_failure
from .drive_limits import share_reached
from .measures import transmission_extreme
from .motion import Motion

# deg. Below it the coupler pushes the rocker into its pivot more than round it, and play and friction grow quickly
# (Norton, Design of Machinery, on the transmission angle: above about 40 deg; the angle itself: Alt, Der
# Übertragungswinkel, Werkstattstechnik 26, 1932).
LEAST_TRANSMISSION_ANGLE_DEG = 40
# deg, the same of polygons, which only have to be drawn. At less, their vectors run off the plate; derived here, of
# polygons drawn at many positions.
LEAST_ANGLE_OF_POLYGONS_DEG = 5
# Hole to thickness. Smaller ones burn shut or break out; what cutting services ask for of laser and water jet alike.
LEAST_HOLE_TO_THICKNESS = 0.5
# mm. Traces of one curve by three linkages that are farther apart are not the same; derived here, of rounding.
SAME_CURVE = 1e-6
# Largest force over the least that it could be; chosen here.
MOST_FORCE_TO_BEST = 1.05
# Diameters and radii that are drawn, in longest links. Larger ones leave nothing else to be seen; derived here.
LARGEST_DRAWN = 5.0


def reached(motion: Motion, what: str, advice: str = "") -> Check:
    """Share of the driver's range that a motion reaches. what: whose range, such as "crank's turn"."""
    share, end = share_reached(motion)
    at = None if end is None else in_driver_unit(motion, end)
    return Check("share_reached", f"share of the {what} reached", 100 * share, "at least", 100, "%", advice, at=at)


def in_driver_unit(motion: Motion, drive: float) -> float:
    """A drive as tables state it: deg, or mm if it slides."""
    return drive if motion.linkage.driven_slider else float(np.degrees(drive))


def driver_at(motion: Motion, frame: int) -> float:
    """The driver at a frame as tables state it: deg, or mm if it slides."""
    return in_driver_unit(motion, float(motion.drive[frame]))


def transmission_check(motion: Motion, advice: str = "") -> Check:
    """The least transmission angle over the motion, deg."""
    least, drive = transmission_extreme(motion, -1)
    at = None if np.isnan(least) else in_driver_unit(motion, drive)
    name, column, limit = "least transmission angle", "transmission_angle", LEAST_TRANSMISSION_ANGLE_DEG
    return Check("transmission_angle", name, least, "at least", limit, "deg", advice, column, at)


@checked
def linkage_checks(motion: Motion) -> tuple[Check, ...]:
    """Check that the driver moves through all frames, and how well it drives.

    Parameters
    ----------
    motion : Motion
        Motion of one linkage.

    Returns
    -------
    tuple of Check
        The share of the driver's range that is reached, %, and the least transmission angle, deg, both also between
        frames. The second is missing if the driver drives nothing else. The advice of a failed check names the dyad
        that opens first.

    Raises
    ------
    DesignError
        If the motion is of many linkages at once.

    Notes
    -----
    The limits are constants of this module, each with its source.
    """
    if motion.linkage.is_batch:
        raise DesignError(
            "motion", "found many linkages at once", "give one, for each has checks of its own", "wrong-type"
        )
    driver, turns, opens = motion.linkage.driver, motion.linkage.driven_slider is None, assembly_failure(motion)
    advice = (
        f"change the lengths, as that of the {driver}, or give a smaller range of the driver"
        if turns
        else "give a shorter stroke"
    )
    share = reached(motion, f"{driver}'s {'turn' if turns else 'stroke'}", f"{opens}; {advice}" if opens else advice)
    transmission = transmission_check(motion, "near a dead centre: change the link lengths")
    return (share,) if motion.assembled.any() and np.isnan(transmission.value) else (share, transmission)


@checked
def hole_check(hole_diameter: PositiveFloat, thickness: PositiveFloat) -> Check:
    """Check that pin holes can be cut in a sheet, by the rule of cutting services.

    Parameters
    ----------
    hole_diameter, thickness : float
        Diameter of the holes and thickness of the sheet, mm.

    Returns
    -------
    Check
        Hole diameter to thickness.
    """
    advice = "smaller holes burn or break out when cut"
    ratio, least = hole_diameter / thickness, LEAST_HOLE_TO_THICKNESS
    return Check("pin_hole", "pin hole to thickness", ratio, "at least", least, "", advice)


@checked
def collision_check(collisions: int, advice: str = "") -> Check:
    """Check that plates and pins pass each other.

    Parameters
    ----------
    collisions : int
        Number of pairs that do not, `len(stack.collisions)`.
    advice : str
        Advice of the check if it fails.

    Returns
    -------
    Check
    """
    return Check("collisions", "plates and pins that collide", collisions, "at most", 0, "", advice)
