"""An eccentric: a round disc that turns about a point off its centre and lifts a flat follower."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np

from geomkin.core.errors import DesignError
from geomkin.core.fields import check_sizes, entry, quantity
from geomkin.core.records import record
from geomkin.core.units import mm
from geomkin.model import Check, Column, Part, Table
from geomkin.model.scene import Plot, Scene, SceneBody, SceneMark
from geomkin.plane import Circle
from geomkin.plane.vec import Real
from geomkin.recipe import AbstractRecipe, Files

# Largest eccentricity, in radii; chosen here. The contact moves along the follower by the eccentricity to both sides.
LARGEST_RATIO = 0.5


@record(checked=True)
class Eccentric:
    """Sizes of an eccentric.

    Parameters
    ----------
    radius : float
        Radius of the disc, mm.
    eccentricity : float
        Distance of the axis from the centre of the disc, mm.
    bore : float, optional
        Diameter of the hole about the axis, mm.
    thickness : float, optional
        Thickness of the disc, mm.
    """

    radius: float = quantity("radius of the disc", "mm", above=0, at_most=1000, example=30)
    eccentricity: float = quantity("distance of the axis from the centre of the disc", "mm", above=0, example=10)
    bore: float = quantity("diameter of the hole about the axis", "mm", above=0, default=6)
    thickness: float = quantity("thickness of the disc", "mm", above=0, default=6)

    def __post_init__(self) -> None:
        check_sizes(self)
        most = self.radius - self.bore / 2
        if self.eccentricity >= most:
            problem = f"found {mm(self.eccentricity):g}, with which the bore meets the rim"
            raise DesignError("eccentricity", problem, f"give less than {mm(most):down6}")

    def lift(self, angle: Real) -> Real:
        """Lift of a flat follower above its lowest position, mm, at rotations of the disc, rad."""
        return self.eccentricity * (1 - np.cos(angle))


@record(kw_only=True)
class ExampleRecipe(AbstractRecipe):
    """An eccentric that lifts a flat follower.

    Parameters
    ----------
    eccentric : Eccentric
        Its sizes.
    files : Files, optional
        Formats, tolerance, kerf.
    """

    kind: Literal["example-kind"] = "example-kind"
    eccentric: Eccentric = entry("sizes of the disc")
    files: Files = entry("what is written", default=Files())

    @property
    def design(self) -> Eccentric:
        return self.eccentric

    @cached_property
    def table(self) -> Table:
        angle = np.linspace(0, 2 * np.pi, 361)
        return Table(
            (
                Column("angle", "deg", "rotation of the disc", np.degrees(angle)),
                Column("lift", "mm", "lift of the follower", self.design.lift(angle)),
            )
        )

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The disc, with its axis at 0 and its centre below it at the start."""
        sizes = self.design
        rim, hole = Circle(-1j * sizes.eccentricity, sizes.radius), Circle(0j, sizes.bore / 2)
        return (Part("disc", rim, (hole,), sizes.thickness, body="disc"),)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        ratio = self.design.eccentricity / self.design.radius
        advice = f"give an eccentricity of at most {mm(LARGEST_RATIO * self.design.radius):down}"
        return (Check("eccentricity", "eccentricity", ratio, "at most", LARGEST_RATIO, "radii", advice),)

    @cached_property
    def scene(self) -> Scene:
        angle = np.radians(self.table["angle"])
        disc = SceneBody("disc", self.parts, np.zeros(len(angle), dtype=complex), np.exp(1j * angle))
        lowest = self.design.radius - self.design.eccentricity
        follower = SceneMark("point", 1j * (lowest + self.table["lift"]), label="follower")
        plots = (Plot("Lift", ("lift",)),)
        return Scene(
            self.table, angle / (2 * np.pi), np.full(len(angle), True), (disc,), marks=(follower,), plots=plots
        )
