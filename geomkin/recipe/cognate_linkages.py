"""Recipe of the three cognates of a four-bar, joined as Roberts' ten-bar figure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np

from ..check import Check
from ..linkage.cognates import cognates, roberts_linkage, third_pivot
from ..linkage.coupler import CouplerCurve
from ..linkage.four_bar import FourBar
from ..linkage.motion import Motion
from ..linkage.solve import move
from ..part import Part
from ..shop.drawing import PlateStock, engraved, skeleton
from ..shop.links import link_parts
from ..shop.stack import Stack, stack_links
from ..shop.stock import LinkStock
from ..sizes import NotBoolean, entry
from ..table import Column, Table, xy_columns
from .kind import Kind
from .settings import Files, Turn


@dataclass(frozen=True)
class CognatesRecipe:
    """Three four-bars that draw one coupler curve, as plates of Roberts' ten-bar figure and as an engraved drawing."""

    kind: Literal["cognates"]
    linkage: FourBar = entry("the given four-bar", example=FourBar(100, 30, 90, 70, 50 + 45j))
    branch: Annotated[Literal[1, -1], NotBoolean()] = entry(
        "1 or -1: rocker pin left or right of the line to its pivot", default=1
    )
    drive: Turn = entry("how the driver turns", default=Turn())
    stock: LinkStock = entry("what the links are cut from", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        self.drive.check_rows()

    @cached_property
    def motions(self) -> tuple[Motion, ...]:
        """The three, each moved to be at the same point at the same moment."""
        drive, speed = self.drive.frames, self.drive.speed
        return tuple(
            move(c.linkage, drive + c.drive_offset, self.branch * c.branch, speed) for c in cognates(self.linkage)
        )

    @cached_property
    def figure(self) -> Motion:
        """Roberts' figure over the same drive, in steps in which nothing slips through between two plates."""
        # Ten bars take a Newton iteration for each frame, so there are no finer ones than plates need.
        drive = replace(self.drive, step_deg=max(1.0, self.drive.step_deg)).fine
        return move(roberts_linkage(self.linkage, float(drive[0]), self.branch), drive, "follow", self.drive.speed)

    @cached_property
    def stack(self) -> Stack:
        return stack_links(self.figure, self.stock)


NAMES = ("given", "left", "right")


def _table(recipe: CognatesRecipe) -> Table:
    drive = recipe.drive.frames
    columns = [Column("drive_angle", "deg", "angle of the given linkage's driver", np.degrees(drive))]
    for name, motion in zip(NAMES, recipe.motions):
        for body in ("crank", "coupler", "rocker"):
            angle = np.degrees(np.unwrap(np.angle(motion.bodies[body].direction)))
            columns.append(Column(f"{name}_{body}_angle", "deg", f"{body} of the {name} linkage from +x", angle))
        track = motion.point("coupler_point").position
        columns += xy_columns(f"{name}_coupler_point", "mm", f"coupler point of the {name} linkage", track)
    return Table(tuple(columns))


def _checks(recipe: CognatesRecipe) -> list[Check]:
    tracks = [m.point("coupler_point").position for m in recipe.motions]
    apart = max(np.abs(t - tracks[0]).max() for t in tracks)
    pivot = np.abs(recipe.figure.point("third_pivot").position - third_pivot(recipe.linkage)).max()
    reached = 100 * recipe.motions[0].closed.mean()
    return [
        Check("share of the driver's turn reached", reached, "at least", 100, "%", "give a shorter way"),
        Check("distance between the three traced points", apart, "at most", 1e-6, "mm"),
        Check("way of the third pivot", pivot, "at most", 1e-6, "mm"),
        Check(
            "plates and pins that collide", len(recipe.stack.collisions), "at most", 0, "", "summary.json names them"
        ),
        *recipe.drive.checks,
    ]


def _parts(recipe: CognatesRecipe) -> list[Part]:
    plate = PlateStock(thickness=recipe.stock.thickness, pin_diameter=recipe.stock.pin_diameter)
    turn = recipe.drive
    span = (float(np.radians(turn.start_deg)), float(np.radians(turn.end_deg)))
    curve = CouplerCurve(recipe.linkage, "coupler_point", recipe.branch, span)
    drawing = engraved("drawing", [curve, *skeleton(recipe.figure, 0, plate)], plate)
    return [*link_parts(recipe.figure, recipe.stock, recipe.stack), drawing]


def _notes(recipe: CognatesRecipe) -> dict[str, Any]:
    three = {
        name: {
            field: float(f"{getattr(c.linkage, field):.10g}")
            for field in ("ground", "crank", "coupler", "rocker", "ground_angle_deg")
        }
        | {
            "driver": c.linkage.driver,
            "coupler_point": _pair(c.linkage.coupler_point),
            "origin": _pair(c.linkage.origin),
        }
        for name, c in zip(NAMES, cognates(recipe.linkage))
    }
    return {"cognates": three, "stack": recipe.stack.summary()}


def _pair(z: complex) -> list[float]:
    return [float(f"{z.real:.10g}"), float(f"{z.imag:.10g}")]


ADVICE = (
    "One check fails on purpose (plates and pins that collide): in most of these figures a pin of one cognate sweeps a "
    "link of another, whatever the order of the plates, and the figure is shown all the same."
)
KINDS = {"cognates": Kind(CognatesRecipe, _table, _checks, _parts, _notes, advice=ADVICE)}
