"""Whether a cam drives its follower well, and whether the follower can follow it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arguments import checked
from ..cam.cam import Cam
from ..cam.measures import cam_angles, pressure_angle, segment_limits, tightest_convex
from ..cam.undercut import Undercut, undercut
from ..check import Check

# deg. A guide binds on a force that leans more; an arm swings away from it, and bears more (Rothbart, Cams, 1956, on
# pressure angle: 30 deg for followers that move straight; 45 for arms is the common rule).
MOST_PRESSURE_ANGLE_DEG = {"straight": 30, "arm": 45}
# Least radius of the pitch curve over the roller's: at 1 the cam has a point, and the stress in its flank rises without
# limit on the way there (Norton, Cam Design and Manufacturing Handbook, on radius of curvature: 1.5 to 2).
LEAST_PITCH_TO_ROLLER = 1.5
# mm. A sharper edge wears off under a flat face; derived here.
LEAST_CONVEX_RADIUS = 1
# Share of the peak acceleration that the scatter of a table may add: more is felt and heard; derived here.
MOST_NOISE = 0.1


def most_pressure_angle(cam: Cam) -> float:
    """The usual limit of the pressure angle, deg, of a cam with such a follower."""
    return MOST_PRESSURE_ANGLE_DEG["arm" if cam.follower.oscillates else "straight"]


@checked
def cam_checks(cam: Cam, cut: Undercut | None = None) -> tuple[Check, ...]:
    """Pressure angles of rise and return, jumps, scatter of tables, room left before undercut, and what undercut takes.

    cut: what `undercut` found, where it is known already.
    """
    return tuple(_checks(cam, cut or undercut(cam)))


def _checks(cam: Cam, cut: Undercut) -> Iterator[Check]:
    angles = cam_angles(cam)
    leaning = np.degrees(np.abs(pressure_angle(cam, angles)))
    velocity = cam.program.motion(angles).velocity
    for name, moving in (("rise", velocity > 0), ("return", velocity < 0)):
        if moving.any():
            most, advice = most_pressure_angle(cam), "give a larger base_radius or a longer segment"
            yield Check(f"pressure angle on the {name}", leaning[moving].max(), "at most", most, "deg", advice)
    jumps = np.abs(cam.program.jumps.velocity)
    if jumps.any():
        at = np.degrees(cam.program.breaks[:-1][jumps.argmax()])
        advice = f"infinite acceleration, worst at {at:.4g} deg: start and end the motion with a law that rests there"
        yield Check("jump in velocity", jumps.max(), "at most", 0, "mm/rad or rad/rad", advice)
    for k, table in cam.program.tables.items():
        # What cannot be told is no check.
        if not np.isnan(table.noise):
            advice = f"the curve follows the scatter of the rows: give within = {_above(table.wide)} in program[{k}]"
            name = f"acceleration from scatter of the rows of program[{k}]"
            yield Check(name, table.noise, "at most", MOST_NOISE, "of the peak", advice)
    yield from _room(cam, cut)


def _room(cam: Cam, cut: Undercut) -> Iterator[Check]:
    """How far the cam is from undercut, or what undercut takes."""
    roller = cam.follower.rounding
    if roller:
        room = tightest_convex(cam)[0] / roller
        advice = "near 1 the cam gets a point"
        yield Check("least pitch radius to roller radius", room, "at least", LEAST_PITCH_TO_ROLLER, "", advice)
    if cut.found:
        lost, at = cut.worst
        advice = f"undercut, worst at {np.degrees(at):.4g} deg: give a larger base_radius or a longer segment there"
        size, unit = (float(np.degrees(lost)), "deg") if cam.follower.oscillates else (lost, "mm")
        yield Check("lift lost to undercut", size, "at most", 0, unit, advice)
    elif not roller:
        sharpest = float(segment_limits(cam).convex_radius.min())
        advice = "a sharp edge wears: give a larger base_radius"
        yield Check("least convex radius of the profile", sharpest, "at least", LEAST_CONVEX_RADIUS, "mm", advice)


def _above(value: float) -> str:
    """A little more, in two digits."""
    step = 10.0 ** (np.floor(np.log10(value)) - 1)
    return f"{np.ceil(value / step) * step:.2g}"
