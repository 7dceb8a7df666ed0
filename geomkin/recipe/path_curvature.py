"""Recipes of a coupler's instantaneous motion: inflection circle at a position, centrodes over the turn."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal

import numpy as np

from ..check import Check
from ..errors import DesignError
from ..linkage.centrode_curve import CentrodeCurve
from ..linkage.centrodes import Centrodes
from ..linkage.coupler import CouplerCurve
from ..linkage.curvature import path_curvature
from ..linkage.four_bar import FourBar
from ..linkage.inflection import inflection_circle
from ..linkage.motion import Motion
from ..linkage.solve import move
from ..part import Part
from ..plane.curve import AbstractCurve
from ..plane.primitives import Arc, Circle, Segment
from ..plane.vec import Array
from ..shop.drawing import PlateStock, arrow, engraved, skeleton
from ..sizes import NotBoolean, check_sizes, entry, quantity
from ..table import Column, Table, xy_columns
from .branches import Branches, branch_of, branches_entry
from .kind import Kind
from .settings import Files, Turn

# Diameters and radii that are drawn, as a multiple of the longest link: larger ones leave nothing else to be seen.
LARGEST = 5.0


@dataclass(frozen=True)
class InflectionCircleRecipe:
    """A four-bar at one position with the coupler's instant centre, inflection circle and centres of curvature."""

    kind: Literal["inflection-circle"]
    linkage: FourBar
    position_deg: float = quantity("driver's angle that is drawn", "deg", default=15.0, at_least=-360, at_most=360)
    branch: Annotated[Literal[1, -1], NotBoolean()] = entry(
        "1 or -1: rocker pin left or right of the line to its pivot", default=1
    )
    drive: Turn = entry("how the driver turns, for the table", default=Turn())
    stock: PlateStock = entry("the plate", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows()

    @cached_property
    def position(self) -> Motion:
        """The linkage where it is drawn."""
        motion = move(self.linkage, [np.radians(self.position_deg)], self.branch)
        if not motion.closed[0]:
            raise DesignError(
                "position_deg", f"found {self.position_deg:g}, which is not reached", "give another angle"
            )
        return motion


def _inflection_table(recipe: InflectionCircleRecipe) -> Table:
    motion = move(recipe.linkage, recipe.drive.frames, recipe.branch, recipe.drive.speed)
    circle = inflection_circle(motion, "coupler")
    path = path_curvature(motion, "coupler", recipe.linkage.coupler_point)
    return Table(
        (
            Column("drive_angle", "deg", "angle of the driver from the ground line", np.degrees(motion.drive)),
            *xy_columns(
                "instant_centre", "mm", "instant centre of the coupler", _finite(circle.instant_centre.position)
            ),
            *xy_columns("inflection_pole", "mm", "inflection pole", _finite(circle.pole)),
            Column("inflection_diameter", "mm", "diameter of the inflection circle", _finite(circle.diameter)),
            *xy_columns("centrode_tangent", "", "direction of the centrode tangent", _finite(circle.tangent)),
            *xy_columns("coupler_point", "mm", "coupler point", path.position),
            Column("path_curvature", "1/mm", "curvature of its path, left +", _finite(path.curvature)),
            *xy_columns("centre_of_curvature", "mm", "centre of curvature of its path", _finite(path.centre)),
        )
    )


def _finite(values: Array) -> Array:
    """What lies at infinity is left out of tables."""
    return np.where(np.isfinite(values), values, np.nan)


def _inflection_checks(recipe: InflectionCircleRecipe) -> list[Check]:
    diameter = inflection_circle(recipe.position, "coupler").diameter[0]
    longest = _longest(recipe)
    advice = "near a position with parallel cranks the circle does not fit a plate; give another position_deg"
    size = Check("inflection diameter to longest link", diameter / longest, "at most", LARGEST, "", advice)
    return [size, *recipe.drive.checks]


def _longest(recipe: InflectionCircleRecipe) -> float:
    sizes = recipe.linkage
    return max(sizes.ground, sizes.crank, sizes.coupler, sizes.rocker)


def _inflection_parts(recipe: InflectionCircleRecipe) -> list[Part]:
    motion, stock = recipe.position, recipe.stock
    circle = inflection_circle(motion, "coupler")
    centre, pole, diameter = (complex(circle.instant_centre.position[0]), complex(circle.pole[0]), circle.diameter[0])
    marks = skeleton(motion, 0, stock)
    if 0 < diameter <= LARGEST * _longest(recipe):
        tangent, dot = complex(circle.tangent[0]), stock.pin_diameter / 4
        marks += [Circle((centre + pole) / 2, float(diameter) / 2), Circle(centre, dot), Circle(pole, dot)]
        marks += [*arrow(centre, pole), Segment(centre - tangent * diameter / 2, centre + tangent * diameter / 2)]
    marks += _path_at(recipe, motion)
    return [engraved("inflection-circle", marks, stock)]


def _path_at(recipe: InflectionCircleRecipe, motion: Motion) -> list[AbstractCurve]:
    """The coupler point, its path near by, and the arc about its centre of curvature that the path hugs."""
    local = recipe.linkage.coupler_point
    path = path_curvature(motion, "coupler", local)
    point, here = complex(path.position[0]), float(motion.drive[0])
    near = (here - np.pi / 4, here + np.pi / 4)
    try:
        marks: list[AbstractCurve] = [CouplerCurve(recipe.linkage, "coupler_point", recipe.branch, near)]
    except DesignError:
        marks = []
    centre, radius = complex(path.centre[0]), abs(float(path.radius[0]))
    if 1e-3 < radius < LARGEST * _longest(recipe):
        half = min(np.pi, 0.5 * recipe.linkage.crank / radius)
        marks += [Arc(centre, centre + (point - centre) * np.exp(-1j * half), 2 * half)]
        marks += [Circle(centre, recipe.stock.pin_diameter / 4), Segment(centre, point)]
    return [*marks, Circle(point, recipe.stock.pin_diameter / 4)]


@dataclass(frozen=True)
class CentrodesRecipe:
    """Fixed and moving centrode of a four-bar's coupler on two plates: the second curve rolls on the first."""

    kind: Literal["centrodes"]
    linkage: FourBar
    branch: Annotated[Literal[1, -1, "follow"], NotBoolean()] = entry(
        "1 or -1; follow: smoothly on from 1, or from what branches says, also through change points", default=1
    )
    branches: Branches = branches_entry()
    reach: float = quantity(
        "farthest from the crank pin that the centrodes are drawn", "mm", default=200.0, above=0, at_most=10_000
    )
    drive: Turn = entry("how the driver turns", default=Turn())
    stock: PlateStock = entry("the plates", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows()

    @cached_property
    def centrodes(self) -> Centrodes:
        return Centrodes(move(self.linkage, self.drive.frames, branch_of(self), self.drive.speed), "coupler")

    @cached_property
    def runs(self) -> list[tuple[float, float]]:
        """Drives over which the centrodes are drawn unbroken."""
        drive = self.centrodes.motion.drive
        found = [drive[run] for run in self.centrodes.runs(self.reach)]
        if not found:
            raise DesignError("reach", f"found {self.reach:g} mm, within which no centrode lies", "give a larger one")
        return [(float(part[0]), float(part[-1])) for part in found]


def _centrodes_table(recipe: CentrodesRecipe) -> Table:
    centrodes = recipe.centrodes
    run = np.zeros(len(centrodes.motion.drive), dtype=int)
    for k, part in enumerate(centrodes.runs(recipe.reach)):
        run[part] = k + 1
    return Table(
        (
            Column("drive_angle", "deg", "angle of the driver", np.degrees(centrodes.motion.drive)),
            Column("run", "", "unbroken run that the frame belongs to, 0 for none", run),
            *xy_columns("fixed_centrode", "mm", "instant centre on the ground", _finite(centrodes.fixed)),
            *xy_columns("moving_centrode", "mm", "instant centre on the coupler", _finite(centrodes.moving)),
        )
    )


def _centrodes_checks(recipe: CentrodesRecipe) -> list[Check]:
    motion = recipe.centrodes.motion
    reached = Check("share of the driver's turn reached", 100 * motion.closed.mean(), "at least", 100, "%")
    return [reached, *recipe.drive.checks]


def _centrodes_parts(recipe: CentrodesRecipe) -> list[Part]:
    linkage, radius = recipe.linkage.linkage, recipe.stock.pin_diameter / 2
    start = float(recipe.centrodes.motion.drive[0])
    parts = []
    for name, moving, body in (("fixed-centrode", False, "ground"), ("moving-centrode", True, "coupler")):
        curves: list[AbstractCurve] = [
            CentrodeCurve(linkage, "coupler", run, moving, branch_of(recipe), start) for run in recipe.runs
        ]
        pins = [p for p in linkage.bodies[body] if p in linkage.pins]
        frame = recipe.centrodes.motion.bodies["ground"]
        places = [
            complex(linkage.bodies["coupler"][p])
            if moving
            else complex(frame.point(linkage.bodies["ground"][p]).position[0])
            for p in pins
        ]
        parts.append(engraved(name, [*curves, *(Circle(z, radius) for z in places)], recipe.stock))
    return parts


KINDS = {
    "inflection-circle": Kind(InflectionCircleRecipe, _inflection_table, _inflection_checks, _inflection_parts),
    "centrodes": Kind(CentrodesRecipe, _centrodes_table, _centrodes_checks, _centrodes_parts),
}
