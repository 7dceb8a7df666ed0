"""Whether a cam drives its follower well, and whether the follower can follow it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..core.arguments import checked
from ..model.check import Check
from ..plane.vec import Real, first_largest
from .cam import Cam
from .extrema import largest
from .measures import cam_angles, segment_limits, tightest_convex
from .undercut import Undercut, undercut

# deg. Larger lets a guide bind on a force that leans; smaller asks for larger cams. 30 for followers that move
# straight is the rule of Rothbart, Cams (1956). An arm swings away from the force and bears more: how much, rules
# differ (Norton, Design of Machinery, ch. 8, gives about 35); 45 is chosen here.
MOST_PRESSURE_ANGLE_DEG = {"straight": 30, "arm": 45}
# Least radius of the pitch curve over the roller's. At 1 the cam has a point, and on the way there the stress in its
# flank rises without limit. Norton, Design of Machinery, ch. 8, advises 2 to 3; below 1.5, chosen here, is poor.
LEAST_PITCH_TO_ROLLER = 1.5
# mm. A sharper edge wears off under a flat face, or a knife edge; chosen here, as the corner that a file breaks.
LEAST_CONVEX_RADIUS = 1
# Share of the peak acceleration that the scatter of a table may add: more is felt and heard; chosen here.
MOST_NOISE = 0.1

# Places at which the acceleration jumps that are named: more make no better advice.
MOST_PLACES = 4
# Laws that begin and end without acceleration, as a dwell does.
SMOOTH = "cycloidal, modified-sine, modified-trapezoid or 3-4-5"

# Of the largest velocity, what counts as rest. A larger share would leave out angles at which the follower moves.
ROUNDING = 1e-9


def most_pressure_angle(cam: Cam) -> float:
    """The usual limit of the pressure angle, deg, of a cam with such a follower."""
    return MOST_PRESSURE_ANGLE_DEG["arm" if cam.follower.oscillates else "straight"]


@checked
def cam_checks(cam: Cam, cut: Undercut | None = None) -> tuple[Check, ...]:
    """Check whether a cam drives its follower well.

    Parameters
    ----------
    cam : Cam
        The cam.
    cut : Undercut, optional
        Result of `undercut(cam)`, if it is known already.

    Returns
    -------
    tuple of Check
        Pressure angles of rise and return, deg; jumps of velocity and acceleration; scatter of tables; the distance
        from undercut, and the lift that undercut takes. A failed check is advice: the cam can be made all the same.

    Notes
    -----
    The limits are constants of this module, with their sources: Rothbart, Cams (1956), and Norton, Design of Machinery.

    Examples
    --------
    >>> import geomkin as gk
    >>> program = gk.Program([gk.Rise("cycloidal", 20, end_deg=180), gk.Return("cycloidal", end_deg=360)])
    >>> cam = gk.Cam(gk.TranslatingRoller(10), program, base_radius=40)
    >>> [check.id for check in gk.cam.cam_checks(cam) if not check.passed]
    []
    """
    return tuple(_checks(cam, cut or undercut(cam)))


def _checks(cam: Cam, cut: Undercut) -> Iterator[Check]:
    for name, way in (("rise", 1), ("return", -1)):
        if (found := _most_leaning(cam, way)) is not None:
            (leaning, at), most = found, most_pressure_angle(cam)
            id, words = f"pressure_angle_{name}", f"pressure angle on the {name}"
            advice = "give a larger base_radius or a longer segment"
            yield Check(id, words, leaning, "at most", most, "deg", advice, "pressure_angle", at)
    jumps = np.abs(cam.program.jumps.velocity)
    if jumps.any():
        at = float(np.degrees(cam.program.breaks[:-1][first_largest(jumps)]))
        advice = f"infinite acceleration, worst at {at:.4g} deg: start and end the motion with a law that rests there"
        unit = "mm/rad or rad/rad"
        yield Check("velocity_jump", "jump in velocity", jumps.max(), "at most", 0, unit, advice, "velocity", at)
    jumps = np.abs(cam.program.jumps.acceleration)
    if jumps.any():
        joints = np.degrees(cam.program.breaks[:-1])
        angles, at = joints[jumps > 0], float(joints[first_largest(jumps)])
        places = ", ".join(f"{angle:.4g}" for angle in angles[:MOST_PLACES])
        places += " and more" * (len(angles) > MOST_PLACES)
        advice = f"infinite jerk at {places} deg: give laws that meet there in acceleration, such as {SMOOTH}"
        unit = f"{'rad' if cam.follower.oscillates else 'mm'}/rad2"
        name, column = "jump in acceleration", "acceleration"
        yield Check("acceleration_jump", name, jumps.max(), "at most", 0, unit, advice, column, at)
    for k, table in cam.program.tables.items():
        # Unknown scatter gives no check.
        if not np.isnan(table.noise):
            advice = f"the curve follows the scatter of the rows: give within = {_above(table.wide)} in program[{k}]"
            if np.isinf(table.noise):
                advice += ", or a dwell or a steady motion in its place, for they show no other"
            name = f"acceleration from scatter of the rows of program[{k}]"
            yield Check(f"scatter_{k}", name, table.noise, "at most", MOST_NOISE, "of the peak", advice)
    yield from _room(cam, cut)


def _room(cam: Cam, cut: Undercut) -> Iterator[Check]:
    """Margin before undercut, or the lost lift if the cam is undercut."""
    roller = cam.follower.roller_radius
    if roller:
        tightest, angle = tightest_convex(cam)
        at = float(np.degrees(angle)) if np.isfinite(tightest) else None
        name, least = "least pitch radius to roller radius", LEAST_PITCH_TO_ROLLER
        advice = "near 1 the profile becomes pointed: enlarge the base circle"
        yield Check("pitch_radius", name, tightest / roller, "at least", least, "", advice, at=at)
    if cut.found:
        (lost, angle), (unit, size) = cut.worst, cam.follower.lift_unit
        at = float(np.degrees(angle))
        advice = f"undercut, worst at {at:.4g} deg: give a larger base_radius or a longer segment there"
        yield Check("lost_lift", "lift lost to undercut", lost * size, "at most", 0, unit, advice, "lost_lift", at)
    elif not roller:
        sharpest = float(segment_limits(cam).convex_radius.min())
        advice = "a sharp edge wears: give a larger base_radius"
        name, least = "least convex radius of the profile", LEAST_CONVEX_RADIUS
        yield Check("convex_radius", name, sharpest, "at least", least, "mm", advice)


def _above(value: float) -> str:
    """A little more, in two digits."""
    step = 10.0 ** (np.floor(np.log10(value)) - 1)
    return f"{np.ceil(value / step) * step:.2g}"


def _most_leaning(cam: Cam, way: int) -> tuple[float, float] | None:
    """Largest pressure angle, and the cam angle there, deg, while the follower moves outward, way 1, or inward, -1.

    None if it never does.
    """
    # At rest what is left of the velocity is rounding, whose sign says nothing.
    rest = ROUNDING * np.abs(cam.program.motion(cam_angles(cam)).velocity).max()

    def leaning(angle: Real) -> Real:
        motion = cam.program.motion(angle)
        contact = cam.follower.contact(motion, cam.base_radius, cam.sense)
        return np.where(way * motion.velocity > rest, np.abs(contact.pressure_angle), -1.0)

    most, at = largest(cam.program.breaks, leaning)
    return (float(np.degrees(most)), float(np.degrees(at))) if most >= 0 else None
