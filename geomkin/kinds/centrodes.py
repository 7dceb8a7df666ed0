"""Recipe of a coupler's two centrodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from ..check import Check
from ..errors import DesignError
from ..judge.linkage import reached
from ..linkage.instant.centrodes import CentrodeCurve, Centrodes
from ..linkage.named.four_bar import FourBar
from ..linkage.solve.branch import Branch
from ..linkage.solve.move import move
from ..part import Part
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle
from ..recipe.recipe import AbstractRecipe
from ..recipe.settings import Files, Turn
from ..scene import Scene
from ..scenes.instant import centrodes_scene
from ..shop.drawing import PlateStock, engraved
from ..sizes import check_sizes, entry, quantity
from ..table import Column, Table, finite, xy_columns
from .linkage_tables import Branches, SideOrFollow, branch_of, branches_entry


@dataclass(frozen=True, kw_only=True)
class CentrodesRecipe(AbstractRecipe):
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

    def __post_init__(self) -> None:
        check_sizes(self)
        self.drive.check_rows()

    @property
    def design(self) -> FourBar:
        return self.linkage

    @cached_property
    def signs(self) -> Branch:
        """The branch asked for."""
        return branch_of(self.branch, self.branches)

    @cached_property
    def centrodes(self) -> Centrodes:
        """Both curves over the frames."""
        return Centrodes(move(self.linkage, self.drive.frames, self.signs, self.drive.speed), "coupler")

    @cached_property
    def runs(self) -> list[tuple[float, float]]:
        """Drives over which the centrodes are drawn unbroken."""
        drive = self.centrodes.motion.drive
        found = [drive[run] for run in self.centrodes.runs(self.reach)]
        if not found:
            raise DesignError("reach", f"found {self.reach:g} mm, within which no centrode lies", "give a larger one")
        return [(float(part[0]), float(part[-1])) for part in found]

    @cached_property
    def table(self) -> Table:
        centrodes = self.centrodes
        run = np.zeros(len(centrodes.motion.drive), dtype=int)
        for k, part in enumerate(centrodes.runs(self.reach)):
            run[part] = k + 1
        return Table(
            (
                Column("drive_angle", "deg", "angle of the driver", np.degrees(centrodes.motion.drive)),
                Column("run", "", "unbroken run that the frame belongs to, 0 for none", run),
                *xy_columns("fixed_centrode", "mm", "instant centre on the ground", finite(centrodes.fixed)),
                *xy_columns("moving_centrode", "mm", "instant centre on the coupler", finite(centrodes.moving)),
            )
        )

    @cached_property
    def curves(self) -> tuple[list[AbstractCurve], list[AbstractCurve]]:
        """The fixed centrode and the moving one, each in its runs."""
        linkage, start = self.linkage.linkage, float(self.centrodes.motion.drive[0])
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
        return centrodes_scene(self.centrodes.motion, self.table, "coupler", *self.curves, centre)

    @property
    def judged(self) -> tuple[Check, ...]:
        return (reached(self.centrodes.motion, "driver's turn"), *self.drive.checks)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        linkage, parts = self.linkage.linkage, []
        for name, moving, body in (("fixed-centrode", False, "ground"), ("moving-centrode", True, "coupler")):
            places = [z for pin, z in linkage.bodies[body].items() if pin in linkage.pins]
            if not moving:
                ground = self.centrodes.motion.bodies["ground"]
                places = [complex(ground.point(z).position[0]) for z in places]
            pins = [Circle(complex(z), self.stock.pin_diameter / 2) for z in places]
            parts.append(engraved(name, [*self.curves[moving], *pins], self.stock))
        return tuple(parts)
