"""Recipe of a disk cam."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from ..cam.base_circle import least_base_circle
from ..cam.cam import Cam, convex_curvature, pressure_angle
from ..cam.extremes import largest
from ..cam.follower import Roller
from ..cam.limits import cam_angles, segment_limits, tightest_convex
from ..cam.polar import polar_radius
from ..cam.undercut import Undercut, undercut
from ..check import Check
from ..errors import DesignError
from ..part import Part
from ..plane.vec import Array
from ..shop.cams import CamStock, cam_parts
from ..sizes import entry
from ..table import Column, Table, xy_columns
from .example_cams import fit
from .kind import Kind
from .settings import Drive, Files


# Share of the peak acceleration that the scatter of a table may add: more is felt and heard.
NOISE = 0.1
# Of the largest velocity, what counts as rest. A larger share would leave out angles at which the follower moves.
ROUNDING = 1e-9


@dataclass(frozen=True)
class DiskCamRecipe:
    """A disk cam and its follower, roller or flat face, straight or on an arm: plates, motion, profile coordinates."""

    kind: Literal["disk-cam"]
    cam: Cam
    drive: Drive = entry("how the cam turns", default=Drive())
    stock: CamStock = entry("what cam and follower are cut from", default=CamStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        self.drive.check_rows()

    @cached_property
    def cut(self) -> Undercut:
        """The cam that the follower leaves, trimmed where it undercuts."""
        return undercut(self.cam)

    @property
    def unit(self) -> tuple[str, float]:
        """Unit of the lift, and how many of it the programme's own unit is."""
        return ("deg", 180 / np.pi) if self.cam.follower.oscillates else ("mm", 1.0)


def _table(recipe: DiskCamRecipe) -> Table:
    """Follower motion, pressure angle and coordinates over one turn."""
    cam, speed, angle = recipe.cam, recipe.drive.speed, recipe.drive.angles
    motion, (unit, size) = cam.program.motion(angle), recipe.unit
    rate = "rad" if unit == "deg" else unit
    contact = cam.contact(angle)
    columns = [
        Column("cam_angle", "deg", "angle the cam has turned", np.degrees(angle)),
        Column("time", "s", "time at the recipe's speed", angle / speed),
        Column("lift", unit, "lift of the follower", motion.lift * size),
        Column("velocity", f"{rate}/s", "velocity of the follower", motion.velocity * speed),
        Column("acceleration", f"{rate}/s2", "acceleration of the follower", motion.acceleration * speed**2),
        Column("jerk", f"{rate}/s3", "jerk of the follower", motion.jerk * speed**3),
        Column("pressure_angle", "deg", "between path and force", np.degrees(contact.pressure_angle)),
        *_pitch(cam, angle),
        *xy_columns("profile", "mm", "profile on the cam", cam.profile.point(angle)),
        Column("profile_curvature", "1/mm", "curvature of the profile, convex +", _finite(_convex_curvature(cam, angle))),
        *xy_columns("contact", "mm", "where follower and cam touch, on the ground", contact.point),
        Column(
            "outline_radius", "mm", "outline of the cut cam in the direction of cam_angle from its x axis",
            polar_radius(recipe.cut.outline, angle),
        ),
    ]  # fmt: skip
    if recipe.cut.found:
        lost = recipe.cut.lost_lift(angle) * size
        columns.append(Column("lost_lift", unit, "how far undercut leaves the follower below its lift", lost))
    return Table(tuple(columns))


def _pitch(cam: Cam, angle: Array) -> Iterator[Column]:
    if isinstance(cam.follower, Roller):
        bend = convex_curvature(cam, angle)
        yield Column("pitch_curvature", "1/mm", "curvature of the pitch curve, convex +", bend)
        yield from xy_columns("pitch", "mm", "pitch curve on the cam", cam.pitch_curve.point(angle))


def _convex_curvature(cam: Cam, angle: Array) -> Array:
    return -cam.sense * cam.profile.curvature(angle)


def _finite(values: Array) -> Array:
    """Curvature at a point of the profile, which no number tells, left out."""
    return np.where(np.isfinite(values), values, np.nan)


def _checks(recipe: DiskCamRecipe) -> list[Check]:
    """Pressure angles of rise and return, room left before undercut, and what undercut takes."""
    cam = recipe.cam
    # An arm swings away from a leaning force, a guide binds: the usual limits.
    limit = 45 if cam.follower.oscillates else 30
    checks = []
    for name, way in (("rise", 1), ("return", -1)):
        if (leaning := _most_leaning(cam, way)) is not None:
            advice = "give a larger base_radius or a longer segment"
            checks.append(Check(f"pressure angle on the {name}", leaning, "at most", limit, "deg", advice))
    jumps = np.abs(cam.program.jumps.velocity)
    if jumps.any():
        at = np.degrees(cam.program.breaks[:-1][jumps.argmax()])
        advice = f"infinite acceleration, worst at {at:.4g} deg: start and end the motion with a law that rests there"
        checks.append(Check("jump in velocity", jumps.max(), "at most", 0, "mm/rad or rad/rad", advice))
    for k, table in cam.program.tables.items():
        # What cannot be told is no check.
        if not np.isnan(table.noise):
            advice = f"the curve follows the scatter of the rows: give within = {_above(table.wide)} in program[{k}]"
            name = f"acceleration from scatter of the rows of program[{k}]"
            checks.append(Check(name, table.noise, "at most", NOISE, "of the peak", advice))
    roller = getattr(cam.follower, "roller_radius", 0.0)
    if roller:
        room = tightest_convex(cam)[0] / roller
        checks.append(
            Check("least pitch radius to roller radius", room, "at least", 1.5, "", "near 1 the cam gets a point")
        )
    if recipe.cut.found:
        (unit, size), (lost, at) = recipe.unit, recipe.cut.worst
        advice = f"undercut, worst at {np.degrees(at):.4g} deg: give a larger base_radius or a longer segment there"
        checks.append(Check("lift lost to undercut", lost * size, "at most", 0, unit, advice))
    elif not roller:
        sharpest = float(segment_limits(cam).convex_radius.min())
        advice = "a sharp edge wears: give a larger base_radius"
        checks.append(Check("least convex radius of the profile", sharpest, "at least", 1, "mm", advice))
    return checks


def _most_leaning(cam: Cam, way: int) -> float | None:
    """Largest pressure angle, deg, where the follower moves outward, way 1, or inward, -1; None where it never does."""
    # At rest what is left of the velocity is rounding, whose sign says nothing.
    rest = ROUNDING * np.abs(cam.program.motion(cam_angles(cam)).velocity).max()

    def leaning(angle: Array) -> Array:
        moving = way * cam.program.motion(angle).velocity > rest
        return np.where(moving, np.abs(pressure_angle(cam, angle)), -1.0)

    most, _ = largest(cam.program.breaks, leaning)
    return float(np.degrees(most)) if most >= 0 else None


def _above(value: float) -> str:
    """A little more, in two digits."""
    step = 10.0 ** (np.floor(np.log10(value)) - 1)
    return f"{np.ceil(value / step) * step:.2g}"


def _parts(recipe: DiskCamRecipe) -> list[Part]:
    """Cam and follower."""
    return cam_parts(recipe.cam, recipe.stock)


def _notes(recipe: DiskCamRecipe) -> dict[str, Any]:
    """The least base circle within the usual pressure angle, optimised segments, and what undercut does."""
    cam = recipe.cam
    notes: dict[str, Any] = {}
    try:
        least = least_base_circle(cam.follower, cam.program, cam.direction, 45 if cam.follower.oscillates else 30)
        notes["least_base_circle"] = {"radius_mm": float(f"{least.radius:.9g}"), "limit": least.limit}
    except DesignError as error:
        notes["least_base_circle"] = {"none": error.problem}
    if cam.program.optima:
        notes["optimised_segments"] = [
            {
                "segment": k + 1,
                "peak_acceleration": float(f"{best.peak_acceleration:.9g}"),
                "proven_least": float(f"{best.bound:.9g}"),
                "peak_jerk": float(f"{best.peak_jerk:.9g}"),
                "units": "rad/rad2, rad/rad3" if cam.follower.oscillates else "mm/rad2, mm/rad3",
            }
            for k, best in sorted(cam.program.optima.items())
        ]
    if recipe.cut.found:
        (unit, size), (lost, at) = recipe.unit, recipe.cut.worst
        notes["undercut"] = {
            f"lost_lift_{unit}": float(f"{lost * size:.9g}"),
            "worst_at_deg": float(f"{np.degrees(at):.5g}"),  # of a flat peak no more digits are sure
            "spans_deg": [[float(f"{np.degrees(a):.9g}") for a in span] for span in recipe.cut.spans],
        }
    return notes


KINDS = {"disk-cam": Kind(DiskCamRecipe, _table, _checks, _parts, _notes, fit)}
