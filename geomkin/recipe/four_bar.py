"""Recipe of a four-bar linkage."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..check import Check
from ..errors import DesignError
from ..linkage.four_bar import FourBar
from ..linkage.motion import Motion
from ..linkage.solve import move
from ..part import Part
from ..plane.vec import Array
from ..shop.links import LinkStock, four_bar_parts
from ..sizes import entry, quantity
from ..table import Column, Table, xy_columns
from .kind import Kind
from .settings import Drive, Files


@dataclass(frozen=True)
class FourBarRecipe:
    """A four-bar linkage: plates with pin holes, and the motion of every link and of a coupler point."""

    kind: Literal["four-bar"]
    linkage: FourBar
    branch: int = quantity(
        "1 or -1: coupler-rocker pin left or right of the line from crank pin to rocker pivot",
        default=1,
        whole=True,
        at_least=-1,
        at_most=1,
    )
    drive: Drive = entry("how the crank turns", default=Drive())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        if self.branch == 0:
            raise DesignError("branch", "found 0", "give 1 or -1")


def _table(recipe: FourBarRecipe) -> Table:
    """One turn of the crank."""
    motion = _motion(recipe)
    point = motion.point("coupler_point")
    angle = np.degrees(motion.drive)
    columns = [
        Column("crank_angle", "deg", "angle of the crank from the ground line", angle),
        Column("time", "s", "time at the recipe's speed", motion.drive / recipe.drive.speed),
    ]
    for name in ("coupler", "rocker"):
        body = motion.bodies[name]
        columns += [
            Column(f"{name}_angle", "deg", f"direction of the {name} from +x", _unwrapped_deg(body.direction)),
            Column(f"{name}_omega", "rad/s", f"angular velocity of the {name}", body.omega),
            Column(f"{name}_alpha", "rad/s2", f"angular acceleration of the {name}", body.alpha),
        ]
    columns += [
        Column("transmission_angle", "deg", "between coupler and rocker", np.degrees(motion.transmission_angle)),
        *xy_columns("coupler_point", "mm", "coupler point", point.position),
        *xy_columns("coupler_point_velocity", "mm/s", "velocity of the coupler point", point.velocity),
        *xy_columns("coupler_point_acceleration", "mm/s2", "acceleration of the coupler point", point.acceleration),
    ]
    return Table(tuple(columns))


def _checks(recipe: FourBarRecipe) -> list[Check]:
    """Whether the crank turns fully, and how well the coupler drives the rocker."""
    motion = _motion(recipe)
    reached = 100 * motion.closed.mean()
    # An open linkage has no least angle: what it never reaches is nan, and fails.
    angle = np.degrees(motion.transmission_angle)
    least = angle.min() if motion.closed.all() else np.nan
    return [
        Check("share of the crank's turn reached", reached, "at least", 100, "%", "shorten the crank"),
        Check("least transmission angle", least, "at least", 40, "deg", "the coupler pushes the rocker along itself"),
        Check(
            "pin hole to thickness",
            recipe.stock.hole_diameter / recipe.stock.thickness,
            "at least",
            0.5,
            "",
            "smaller holes burn or break out when cut",
        ),
    ]


def _parts(recipe: FourBarRecipe) -> list[Part]:
    """Ground, crank, coupler and rocker."""
    return four_bar_parts(recipe.linkage, recipe.stock)


def _motion(recipe: FourBarRecipe) -> Motion:
    return move(recipe.linkage, recipe.drive.angles, recipe.branch, recipe.drive.speed)


def _unwrapped_deg(direction: Array) -> Array:
    """Angles without jumps by a turn, nan kept."""
    angle, known = np.angle(direction), np.isfinite(direction)
    angle[known] = np.unwrap(angle[known])
    return np.degrees(angle)


KIND = Kind(FourBarRecipe, _table, _checks, _parts)
