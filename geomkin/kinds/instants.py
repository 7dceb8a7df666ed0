"""Recipes of a coupler's motion at an instant: its inflection circle at one position, its two centrodes over all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..cached import cached_property
from ..check import Check
from ..errors import DesignError
from ..judge.linkage import LARGEST_DRAWN, reached
from ..linkage.bars import FourBar
from ..linkage.coupler_curve import CouplerCurve
from ..linkage.instant.centrodes import CentrodeCurve, Centrodes
from ..linkage.instant.curvature import path_curvature
from ..linkage.instant.inflection import inflection_circle
from ..linkage.motion import Motion
from ..linkage.solve.move import move
from ..part import Part
from ..plane.curve import AbstractCurve
from ..plane.primitives import Arc, Circle, Segment
from ..recipe.settings import Files, Turn
from ..scene import Scene
from ..scenes.instant import centrodes_scene, inflection_scene
from ..shop.drawing import PlateStock, arrow, engraved, skeleton
from ..sizes import entry, quantity
from ..table import Column, Table, finite, xy_columns
from .linkage_tables import AbstractMovedRecipe, Branches, Side, SideOrFollow, branches_entry


@dataclass(frozen=True, kw_only=True)
class InflectionCircleRecipe(AbstractMovedRecipe):
    """A four-bar at one position with the coupler's instant centre, inflection circle and centres of curvature."""

    kind: Literal["inflection-circle"] = "inflection-circle"
    linkage: FourBar
    position_deg: float = quantity("driver's angle that is drawn", "deg", default=15.0, at_least=-360, at_most=360)
    branch: Side = entry("1 or -1: rocker pin left or right of the line to its pivot", default=1)
    drive: Turn = entry("how the driver turns, for the table", default=Turn())
    stock: PlateStock = entry("the plate", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    @cached_property
    def position(self) -> Motion:
        """The linkage where it is drawn."""
        motion = move(self.linkage, [np.radians(self.position_deg)], self.branch)
        if not motion.closed[0]:
            raise DesignError(
                "position_deg", f"found {self.position_deg:g}, which is not reached", "give another angle"
            )
        return motion

    @property
    def longest(self) -> float:
        """Longest link, mm."""
        sizes = self.linkage
        return float(max(sizes.ground, sizes.crank, sizes.coupler, sizes.rocker))

    @cached_property
    def table(self) -> Table:
        motion = self.motion
        circle = inflection_circle(motion, "coupler")
        path = path_curvature(motion, "coupler", self.linkage.coupler_point)
        centre = finite(circle.instant_centre.position)
        return Table(
            (
                Column("drive_angle", "deg", "angle of the driver from the ground line", np.degrees(motion.drive)),
                *xy_columns("instant_centre", "mm", "instant centre of the coupler", centre),
                *xy_columns("inflection_pole", "mm", "inflection pole", finite(circle.pole)),
                Column("inflection_diameter", "mm", "diameter of the inflection circle", finite(circle.diameter)),
                *xy_columns("centrode_tangent", "", "direction of the centrode tangent", finite(circle.tangent)),
                *xy_columns("coupler_point", "mm", "coupler point", path.position),
                Column("path_curvature", "1/mm", "curvature of its path, left +", finite(path.curvature)),
                *xy_columns("centre_of_curvature", "mm", "centre of curvature of its path", finite(path.centre)),
            )
        )

    @cached_property
    def scene(self) -> Scene:
        """The circle as the linkage moves."""
        return inflection_scene(self.motion, self.table, "coupler", complex(self.linkage.coupler_point))

    @property
    def judged(self) -> tuple[Check, ...]:
        size = inflection_circle(self.position, "coupler").diameter[0] / self.longest
        advice = "near a position with parallel cranks the circle does not fit a plate; give another position_deg"
        check = Check("inflection diameter to longest link", size, "at most", LARGEST_DRAWN, "", advice)
        return (check, *self.drive.checks)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        motion, stock = self.position, self.stock
        circle = inflection_circle(motion, "coupler")
        centre, pole = complex(circle.instant_centre.position[0]), complex(circle.pole[0])
        diameter = circle.diameter[0]
        marks = skeleton(motion, 0, stock)
        if 0 < diameter <= LARGEST_DRAWN * self.longest:
            tangent, dot = complex(circle.tangent[0]), stock.pin_diameter / 4
            marks += [Circle((centre + pole) / 2, float(diameter) / 2), Circle(centre, dot), Circle(pole, dot)]
            marks += [*arrow(centre, pole), Segment(centre - tangent * diameter / 2, centre + tangent * diameter / 2)]
        return (engraved("inflection-circle", marks + self._path(), stock),)

    def _path(self) -> list[AbstractCurve]:
        """The coupler point, its path near by, and the arc about its centre of curvature that the path hugs."""
        motion = self.position
        path = path_curvature(motion, "coupler", self.linkage.coupler_point)
        point, here = complex(path.position[0]), float(motion.drive[0])
        near = (here - np.pi / 4, here + np.pi / 4)
        try:
            marks: list[AbstractCurve] = [CouplerCurve(self.linkage, "coupler_point", self.branch, near)]
        except DesignError:
            marks = []
        centre, radius = complex(path.centre[0]), abs(float(path.radius[0]))
        if 1e-3 < radius < LARGEST_DRAWN * self.longest:
            half = min(np.pi, 0.5 * float(self.linkage.crank) / radius)
            marks += [Arc(centre, centre + (point - centre) * np.exp(-1j * half), 2 * half)]
            marks += [Circle(centre, self.stock.pin_diameter / 4), Segment(centre, point)]
        return [*marks, Circle(point, self.stock.pin_diameter / 4)]


@dataclass(frozen=True, kw_only=True)
class CentrodesRecipe(AbstractMovedRecipe):
    """Fixed and moving centrode of a four-bar's coupler on two plates: the second curve rolls on the first."""

    kind: Literal["centrodes"] = "centrodes"
    linkage: FourBar
    branch: SideOrFollow = entry(
        "1 or -1; follow: smoothly on from 1, or from what branches says, also through change points", default=1
    )
    branches: Branches = branches_entry()
    reach: float = quantity(
        "farthest from the crank pin that the centrodes are drawn", "mm", default=200.0, above=0, at_most=10_000
    )
    drive: Turn = entry("how the driver turns", default=Turn())
    stock: PlateStock = entry("the plates", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    @cached_property
    def centrodes(self) -> Centrodes:
        """Both curves over the frames."""
        return Centrodes(self.motion, "coupler")

    @cached_property
    def runs(self) -> list[tuple[float, float]]:
        """Drives over which the centrodes are drawn unbroken."""
        drive = self.motion.drive
        found = [drive[run] for run in self.centrodes.runs(self.reach)]
        if not found:
            raise DesignError("reach", f"found {self.reach:g} mm, within which no centrode lies", "give a larger one")
        return [(float(part.min()), float(part.max())) for part in found]

    @cached_property
    def table(self) -> Table:
        centrodes = self.centrodes
        run = np.zeros(len(self.motion.drive), dtype=int)
        for k, part in enumerate(centrodes.runs(self.reach)):
            run[part] = k + 1
        return Table(
            (
                Column("drive_angle", "deg", "angle of the driver", np.degrees(self.motion.drive)),
                Column("run", "", "unbroken run that the frame belongs to, 0 for none", run),
                *xy_columns("fixed_centrode", "mm", "instant centre on the ground", finite(centrodes.fixed)),
                *xy_columns("moving_centrode", "mm", "instant centre on the coupler", finite(centrodes.moving)),
            )
        )

    @cached_property
    def curves(self) -> tuple[list[AbstractCurve], list[AbstractCurve]]:
        """The fixed centrode and the moving one, each in its runs."""
        linkage, start = self.linkage.linkage, float(self.motion.drive[0])
        fixed, moving = (
            [CentrodeCurve(linkage, "coupler", run, moving, self.signs, start) for run in self.runs]
            for moving in (False, True)
        )
        return list(fixed), list(moving)

    @cached_property
    def scene(self) -> Scene:
        """The moving centrode, on the coupler, rolling on the fixed one."""
        drawn = np.asarray(self.table["run"]) > 0
        centre = np.where(drawn, self.centrodes.fixed, np.nan)
        return centrodes_scene(self.motion, self.table, "coupler", *self.curves, centre)

    @property
    def judged(self) -> tuple[Check, ...]:
        return (reached(self.motion, "driver's turn"), *self.drive.checks)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        linkage, parts = self.linkage.linkage, []
        for name, moving, body in (("fixed-centrode", False, "ground"), ("moving-centrode", True, "coupler")):
            places = [z for pin, z in linkage.bodies[body].items() if pin in linkage.pins]
            if not moving:
                ground = self.motion.bodies["ground"]
                places = [complex(ground.point(z).position[0]) for z in places]
            pins = [Circle(complex(z), self.stock.pin_diameter / 2) for z in places]
            parts.append(engraved(name, [*self.curves[moving], *pins], self.stock))
        return tuple(parts)
