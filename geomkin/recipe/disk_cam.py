"""Recipe of a disk cam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..cam.cam import Cam, convex_curvature, pressure_angle
from ..cam.limits import cam_angles, tightest_convex
from ..check import Check
from ..part import Part
from ..shop.cams import CamStock, cam_parts
from ..sizes import entry
from ..table import Column, Table, xy_columns
from .kind import Kind
from .settings import Drive, Files


@dataclass(frozen=True)
class DiskCamRecipe:
    """A disk cam with a translating roller: cam plate, roller, follower motion and profile coordinates."""

    kind: Literal["disk-cam"]
    cam: Cam
    drive: Drive = entry("how the cam turns", default=Drive())
    stock: CamStock = entry("what cam and roller are cut from", default=CamStock())
    files: Files = entry("what is written", default=Files())


def _table(recipe: DiskCamRecipe) -> Table:
    """Follower motion, pressure angle and coordinates over one turn."""
    cam, speed, angle = recipe.cam, recipe.drive.speed, recipe.drive.angles
    motion = cam.program.motion(angle)
    return Table(
        (
            Column("cam_angle", "deg", "angle the cam has turned", np.degrees(angle)),
            Column("time", "s", "time at the recipe's speed", angle / speed),
            Column("lift", "mm", "lift of the follower", motion.lift),
            Column("velocity", "mm/s", "velocity of the follower", motion.velocity * speed),
            Column("acceleration", "mm/s2", "acceleration of the follower", motion.acceleration * speed**2),
            Column("jerk", "mm/s3", "jerk of the follower", motion.jerk * speed**3),
            Column("pressure_angle", "deg", "between path and force", np.degrees(pressure_angle(cam, angle))),
            Column("pitch_curvature", "1/mm", "curvature of the pitch curve, convex +", convex_curvature(cam, angle)),
            *xy_columns("pitch", "mm", "pitch curve on the cam", cam.pitch_curve.point(angle)),
            *xy_columns("profile", "mm", "profile on the cam", cam.profile.point(angle)),
        )
    )


def _checks(recipe: DiskCamRecipe) -> list[Check]:
    """Pressure angles of rise and return, and the room left before undercut."""
    cam = recipe.cam
    angles = cam_angles(cam)
    leaning = np.degrees(np.abs(pressure_angle(cam, angles)))
    velocity = cam.program.motion(angles).velocity
    checks = []
    for name, moving in (("rise", velocity > 0), ("return", velocity < 0)):
        if moving.any():
            advice = "give a larger base_radius or a longer segment"
            checks.append(Check(f"pressure angle on the {name}", leaning[moving].max(), "at most", 30, "deg", advice))
    if recipe.stock.bore:
        wall = np.abs(cam.profile.point(angles)).min() - recipe.stock.bore / 2
        checks.append(Check("wall around the bore", wall, "at least", 1, "mm", "give a smaller bore"))
    roller = cam.follower.roller_radius
    if roller:
        room = tightest_convex(cam)[0] / roller
        checks.append(
            Check("least pitch radius to roller radius", room, "at least", 1.5, "", "near 1 the cam gets a point")
        )
    return checks


def _parts(recipe: DiskCamRecipe) -> list[Part]:
    """Cam and roller."""
    return cam_parts(recipe.cam, recipe.stock)


KINDS = {"disk-cam": Kind(DiskCamRecipe, _table, _checks, _parts)}
