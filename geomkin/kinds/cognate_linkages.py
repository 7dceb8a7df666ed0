"""Recipe of the three cognates of a four-bar, joined as Roberts' ten-bar figure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ..check import Check
from ..judge.linkage import SAME_CURVE, collision_check, reached
from ..linkage.cognate_linkages import cognates, roberts_linkage, third_pivot
from ..linkage.coupler_curve import CouplerCurve
from ..linkage.motion import Motion
from ..linkage.named.four_bar import FourBar
from ..linkage.solve.move import move
from ..part import Bought, Part
from ..plane.vec import Real
from ..recipe.recipe import AbstractRecipe
from ..recipe.settings import Files, Turn
from ..scene import Scene, SceneMark
from ..scenes.linkage import linkage_scene
from ..shop.drawing import PlateStock, engraved, skeleton
from ..shop.linkage.plates import LinkStock
from ..shop.linkage.stack import Stack, link_parts, stack_links
from ..sizes import entry
from ..table import Column, Table, xy_columns
from .linkage_tables import Side

# What the three are called.
NAMES = ("given", "left", "right")


@dataclass(frozen=True, kw_only=True)
class CognatesRecipe(AbstractRecipe):
    """Three four-bars that draw one coupler curve, as plates of Roberts' ten-bar figure and as an engraved drawing."""

    kind: Literal["cognates"] = "cognates"
    linkage: FourBar = entry("the given four-bar", example=FourBar(100, 30, 90, 70, 50 + 45j))
    branch: Side = entry("1 or -1: rocker pin left or right of the line to its pivot", default=1)
    drive: Turn = entry("how the driver turns", default=Turn())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    advice: ClassVar[str] = (
        "One check fails on purpose (plates and pins that collide): in most of these figures a pin of one cognate "
        "sweeps a link of another, whatever the order of the plates, and the figure is shown all the same."
    )

    def __post_init__(self) -> None:
        self.drive.check_rows()

    @property
    def design(self) -> FourBar:
        return self.linkage

    @cached_property
    def motions(self) -> tuple[Motion, ...]:
        """The three, each moved to be at the same point at the same moment."""
        return self._moved(self.drive.frames)

    def _moved(self, drive: Real) -> tuple[Motion, ...]:
        return tuple(
            move(c.linkage, drive + c.drive_offset, self.branch * c.branch, self.drive.speed)
            for c in cognates(self.linkage)
        )

    @cached_property
    def figure(self) -> Motion:
        """Roberts' figure over the same drive, in steps in which nothing slips through between two plates."""
        # Ten bars take an iteration at each frame: steps are no finer than plates need.
        drive = replace(self.drive, step_deg=max(1.0, self.drive.step_deg)).fine
        return move(roberts_linkage(self.linkage, float(drive[0]), self.branch), drive, "follow", self.drive.speed)

    @cached_property
    def stack(self) -> Stack:
        return stack_links(self.figure, self.stock)

    @property
    def bought(self) -> tuple[Bought, ...]:
        return self.stack.bought

    @property
    def steps(self) -> tuple[str, ...]:
        return self.stack.steps

    @cached_property
    def table(self) -> Table:
        return self._told(self.motions)

    def _told(self, motions: tuple[Motion, ...]) -> Table:
        drive = motions[0].drive
        columns = [Column("drive_angle", "deg", "angle of the given linkage's driver", np.degrees(drive))]
        for name, motion in zip(NAMES, motions):
            for body in ("crank", "coupler", "rocker"):
                angle = np.degrees(np.unwrap(np.angle(motion.bodies[body].direction)))
                columns.append(Column(f"{name}_{body}_angle", "deg", f"{body} of the {name} linkage from +x", angle))
            track = motion.point("coupler_point").position
            columns += xy_columns(f"{name}_coupler_point", "mm", f"coupler point of the {name} linkage", track)
        return Table(tuple(columns))

    @cached_property
    def scene(self) -> Scene:
        """Roberts' figure moving; the three tables in one, at its frames."""
        figure = self.figure
        table = self.table if len(figure.drive) == len(self.drive.frames) else self._told(self._moved(figure.drive))
        scene = linkage_scene(figure, table, self.parts, self.stack.layers)
        point = figure.point("coupler_point").position
        return replace(scene, marks=(*scene.marks, SceneMark("point", point, "traced", "coupler_point", trail=True)))

    @property
    def judged(self) -> tuple[Check, ...]:
        tracks = [m.point("coupler_point").position for m in self.motions]
        apart = max(np.abs(t - tracks[0]).max() for t in tracks)
        pivot = np.abs(self.figure.point("third_pivot").position - third_pivot(self.linkage)).max()
        return (
            reached(self.motions[0], "driver's turn", "give a shorter way"),
            Check("distance between the three traced points", apart, "at most", SAME_CURVE, "mm"),
            Check("way of the third pivot", pivot, "at most", SAME_CURVE, "mm"),
            collision_check(len(self.stack.collisions), "summary.json names them"),
            *self.drive.checks,
        )

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        plate = PlateStock(thickness=self.stock.thickness, pin_diameter=self.stock.pin_diameter)
        turn = self.drive
        span = (float(np.radians(turn.start_deg)), float(np.radians(turn.end_deg)))
        curve = CouplerCurve(self.linkage, "coupler_point", self.branch, span)
        drawing = engraved("drawing", [curve, *skeleton(self.figure, 0, plate)], plate)
        return (*link_parts(self.figure, self.stock, self.stack), drawing)

    @property
    def notes(self) -> Mapping[str, object]:
        three = {name: _sizes(c.linkage) for name, c in zip(NAMES, cognates(self.linkage))}
        return {"cognates": three, "stack": self.stack.summary()}


def _sizes(linkage: FourBar) -> Mapping[str, object]:
    lengths = {name: getattr(linkage, name) for name in ("ground", "crank", "coupler", "rocker", "ground_angle_deg")}
    return {name: float(f"{length:.10g}") for name, length in lengths.items()} | {
        "driver": linkage.driver,
        "coupler_point": _pair(complex(linkage.coupler_point)),
        "origin": _pair(linkage.origin),
    }


def _pair(z: complex) -> list[float]:
    return [float(f"{z.real:.10g}"), float(f"{z.imag:.10g}")]
