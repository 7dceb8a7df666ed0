"""Recipes of coupler curves: an atlas of them, and the three cognates of one, joined as Roberts' ten-bar figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, ComplexPoint, entry, quantity, rounded_up, to_digits
from ...core.records import record
from ...model.check import Check
from ...model.part import Bought, Part
from ...model.scene import Plot, Scene, SceneHandle, SceneMark, point_handle
from ...model.table import Column, Table, xy_columns
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle
from ...plane.vec import Complex, Real, without_rounding
from ...recipe.recipe import Additions
from ...recipe.settings import Files, Turn
from ..checks import SAME_CURVE, collision_advice, collision_check, reached
from ..cognate_linkages import cognates, roberts_linkage, third_pivot
from ..coupler_curve import CouplerCurve, coupler_curves, coupler_grid, dashes
from ..drive_limits import driver_limits
from ..motion import Motion
from ..moving import move
from ..named_linkages import FourBar, SliderCrank
from ..parts.stack import Stack, link_parts, stack_links
from ..parts.stock import LinkStock, PlateStock, engraved, skeleton, strokes
from ..scene import linkage_scene, place_plot
from ..scene_handles import body_point
from .moved import AbstractMovedRecipe, JointAdditions, Side

# Largest number of engraved dashes: more take minutes, and a laser days.
MOST_DASHES = 5_000
# Names of the three cognates.
NAMES = ("given", "left", "right")


@record(checked=True)
class Grid:
    """Coupler points, evenly over a rectangle in the coupler's frame: origin at the crank pin, x to the other pin."""

    length: float = quantity(
        "length of the rectangle along the coupler", "mm", at_least=0, at_most=FARTHEST, example=90
    )
    height: float = quantity("height of the rectangle", "mm", at_least=0, at_most=FARTHEST, example=60)
    rows: int = quantity("rows of points", whole=True, at_least=1, at_most=50, example=3)
    columns: int = quantity("columns of points", whole=True, at_least=1, at_most=50, example=4)
    centre: ComplexPoint = entry("middle of the rectangle, [x, y] in mm", default=0j, example=45 + 0j)
    dash_deg: float = quantity(
        "rotation of the crank for a dash, and for a gap", "deg", default=5.0, at_least=0.5, at_most=90
    )
    chosen: tuple[tuple[int, int], ...] = entry(
        "points, as [row, column] from 1, whose velocity and acceleration go into the table", default=()
    )

    def __post_init__(self) -> None:
        for row, column in self.chosen:
            if not (1 <= row <= self.rows and 1 <= column <= self.columns):
                remedy = f"give rows from 1 to {self.rows}, columns from 1 to {self.columns}"
                raise DesignError("chosen", f"found [{row}, {column}]", remedy, "out-of-range")

    @cached_property
    def points(self) -> Complex:
        """(rows, columns), complex mm."""
        return coupler_grid(self.length, self.height, self.rows, self.columns, self.centre)

    def check_work(self, drive: Turn) -> None:
        """Refuse more dashes or cells of the table than are useful, before anything is computed."""
        points, turn = self.rows * self.columns, drive.turn_deg
        if points * np.ceil(turn / (2 * self.dash_deg)) > MOST_DASHES:
            found = f"found {self.dash_deg:g} deg, which for {points} points over {turn:g} deg makes more than "
            most = MOST_DASHES // points
            enough = rounded_up(turn / (2 * most), 4)
            remedy, value = f"give at least {enough} deg", None if turn > 180 * most else enough
            if turn > 180 * most:
                remedy = f"give 90 deg and at most {MOST_DASHES // int(np.ceil(turn / 180))} points"
            raise DesignError("grid.dash_deg", f"{found}{MOST_DASHES:,} dashes", remedy, "too-much-work", value)
        drive.check_rows(1 + 2 * points + 4 * len(self.chosen))


@record(kw_only=True)
class AbstractAtlasRecipe(AbstractMovedRecipe):
    """Base class of recipes of an atlas."""

    kind: str
    linkage: FourBar | SliderCrank
    grid: Grid
    branch: Side = 1
    drive: Turn = entry("how the driver turns", default=Turn(step_deg=5.0))
    stock: PlateStock = entry("the plate", default=PlateStock())
    files: Files = entry("what is written", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.grid.check_work(self.drive)

    @cached_property
    def table(self) -> Table:
        motion, grid = self.motion, self.grid
        columns = [Column(f"{motion.linkage.driver}_angle", "deg", "angle of the driver", np.degrees(motion.drive))]
        curves = coupler_curves(motion, grid.points)
        for k, (short, words, place) in enumerate(_grid_points(grid)):
            columns += xy_columns(short, "mm", f"coupler point in {words}", curves.reshape(-1, len(motion.drive))[k])
            if (k // grid.columns + 1, k % grid.columns + 1) in grid.chosen:
                moved = motion.bodies["coupler"].point(place)
                columns += xy_columns(f"{short}_velocity", "mm/s", f"its velocity, {words}", moved.velocity)
                columns += xy_columns(
                    f"{short}_acceleration", "mm/s2", f"its acceleration, {words}", moved.acceleration
                )
        return Table(tuple(columns))

    @cached_property
    def scene(self) -> Scene:
        """The linkage, and the paths of all points of the grid."""
        named = [short for short, _, _ in _grid_points(self.grid)]
        plots = [place_plot(short) for short in named]
        plots += [place_plot(short, rate) for short in named for rate in ("velocity", "acceleration")]
        scene = linkage_scene(self.motion, self.table, plots=plots)
        curves = coupler_curves(self.motion, self.grid.points).reshape(-1, len(self.motion.drive))
        marks = [
            SceneMark("point", curves[k], "traced", short, trail=True)
            for k, (short, _, _) in enumerate(_grid_points(self.grid))
        ]
        return replace(scene, marks=(*scene.marks, *marks))

    @cached_property
    def handles(self) -> tuple[SceneHandle, ...]:
        """Those of a linkage, without its single coupler point, which an atlas does not use."""
        return tuple(handle for handle in super().handles if handle.keys != ("linkage.coupler_point",))

    @property
    def further_handles(self) -> Iterator[SceneHandle]:
        """The middle and a corner of the grid, on the coupler."""
        grid, corner = self.grid, (self.grid.length + 1j * self.grid.height) / 2
        for keys, place in ((("grid.centre",), 0j), (("grid.length", "grid.height"), corner)):
            at = body_point(self.motion, "coupler", grid.centre + place)
            yield point_handle(*keys, at=at, label="corner of the grid" if place else "middle of the grid")

    @property
    def design_checks(self) -> tuple[Check, ...]:
        return (reached(self.motion, "driver's turn", "curves break where it opens"), *self.drive.checks)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        motion, (low, high) = self.motion, sorted(self.drive.span_deg)
        steps = np.radians(np.arange(low, high + 1e-9, self.grid.dash_deg))
        drawn = dashes(self.linkage, self.grid.points.ravel(), steps, self.files.tolerance, self.branch)
        # The linkage is drawn at its first closed frame, with the points of the grid on its coupler.
        marks: list[AbstractCurve] = strokes(run for runs in drawn for run in runs)
        if motion.assembled.any():
            frame = int(np.argmax(motion.assembled))
            marks += skeleton(motion, frame, self.stock)
            coupler = motion.bodies["coupler"]
            for _, _, place in _grid_points(self.grid):
                marks.append(Circle(complex(coupler.point(place).position[frame]), self.stock.pin_diameter / 8))
        return (engraved("atlas", marks, self.stock),)


def _grid_points(grid: Grid) -> Iterator[tuple[str, str, complex]]:
    for row in range(grid.rows):
        for column in range(grid.columns):
            name = f"row {row + 1}, column {column + 1}"
            yield f"r{row + 1}c{column + 1}", name, complex(grid.points[row, column])


@record(kw_only=True)
class FourBarAtlasRecipe(AbstractAtlasRecipe):
    """Coupler curves of a grid of points on a four-bar, dashed by the crank's steps, engraved on a plate."""

    kind: Literal["four-bar-atlas"] = "four-bar-atlas"
    linkage: FourBar
    branch: Side = entry("1 or -1: rocker pin left or right of the line to its pivot", default=1)


@record(kw_only=True)
class SliderCrankAtlasRecipe(AbstractAtlasRecipe):
    """Coupler curves of a grid of points on a slider-crank, dashed by the crank's steps, engraved on a plate."""

    kind: Literal["slider-crank-atlas"] = "slider-crank-atlas"
    linkage: SliderCrank
    branch: Side = entry("1 or -1: slider right or left of the crank pin", default=1)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.linkage.driver == "slider":
            raise DesignError(
                "linkage.driver", "found slider", "give crank or coupler: dashes are steps of an angle", "conflict"
            )


@record(kw_only=True)
class CognatesRecipe(AbstractMovedRecipe):
    """Three four-bars that draw one coupler curve, as plates of Roberts' ten-bar figure and as an engraved drawing."""

    additions: ClassVar[Additions] = JointAdditions(("stock.motor",))
    kind: Literal["cognates"] = "cognates"
    linkage: FourBar = entry("the given four-bar", example=FourBar(100, 30, 90, 70, 50 + 45j))
    branch: Side = entry("1 or -1: rocker pin left or right of the line to its pivot", default=1)
    drive: Turn = entry("how the driver turns", default=Turn())
    stock: LinkStock = entry("sheet and pins of the links", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    advice: ClassVar[str] = (
        "One check fails on purpose (plates and pins that collide): in most of these figures a pin of one cognate "
        "sweeps a link of another, whatever the order of the plates, and the figure is shown all the same."
    )

    @cached_property
    def motions(self) -> tuple[Motion, ...]:
        """The three motions, with the coupler points at the same position at each frame."""
        return self._moved(self.drive.frames)

    def _moved(self, drive: Real) -> tuple[Motion, ...]:
        return tuple(
            move(c.linkage, drive + c.drive_offset, self.branch * c.branch, self.drive.speed, self.drive.acceleration)
            for c in cognates(self.linkage)
        )

    @cached_property
    def figure(self) -> Motion:
        """Roberts' figure over the same drive, in steps so small that no collision of plates is missed."""
        # Ten bars are solved iteratively at each frame, so the steps are no finer than necessary.
        drive = replace(self.drive, step_deg=max(1.0, self.drive.step_deg)).collision_samples
        roberts = roberts_linkage(self.linkage, float(drive[0]), self.branch)
        return move(roberts, drive, "follow", self.drive.speed, self.drive.acceleration)

    @cached_property
    def stack(self) -> Stack:
        return stack_links(self.figure, self.stock)

    @property
    def bought(self) -> tuple[Bought, ...]:
        return self.stack.bought

    @property
    def steps(self) -> tuple[str, ...]:
        drawings = [f"{name}_drawing" for name in NAMES] + ["drawing"]
        return (*self.stack.steps, *(f"{name} is joined to nothing" for name in drawings))

    @cached_property
    def table(self) -> Table:
        return self._table(self.motions)

    def _table(self, motions: tuple[Motion, ...]) -> Table:
        drive = motions[0].drive
        columns = [Column("drive_angle", "deg", "angle of the given linkage's driver", np.degrees(drive))]
        for name, motion in zip(NAMES, motions):
            for body in ("crank", "coupler", "rocker"):
                angle = np.degrees(np.unwrap(np.angle(motion.bodies[body].direction)))
                columns.append(Column(f"{name}_{body}_angle", "deg", f"{body} of the {name} linkage from +x", angle))
            position = motion.point("coupler_point").position
            columns += xy_columns(f"{name}_coupler_point", "mm", f"coupler point of the {name} linkage", position)
        return Table(tuple(columns))

    @cached_property
    def scene(self) -> Scene:
        """Roberts' figure moving, and each cognate by itself; one table for the three, at the figure's frames."""
        figure, same = self.figure, len(self.figure.drive) == len(self.drive.frames)
        motions = self.motions if same else self._moved(figure.drive)
        table = self.table if same else self._table(motions)
        angles = tuple(f"{name}_{body}_angle" for name in NAMES for body in ("crank", "coupler", "rocker"))
        plots = [*(place_plot(f"{name}_coupler_point") for name in NAMES), Plot("angles", angles)]
        scene = linkage_scene(figure, table, self.parts, self.stack.layers, plots)
        point = figure.point("coupler_point").position
        traced = SceneMark("point", point, "traced", "coupler_point", trail=True)
        first = Table(table.columns[:1])
        others = {
            f"{name} four-bar alone": linkage_scene(motion, first, rates=False) for name, motion in zip(NAMES, motions)
        }
        return replace(scene, marks=(*scene.marks, traced), others=others)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        tracks = [m.point("coupler_point").position for m in self.motions]
        apart = max(np.abs(t - tracks[0]).max() for t in tracks)
        pivot = np.abs(self.figure.point("third_pivot").position - third_pivot(self.linkage)).max()
        size = float(np.max(self.figure.linkage.size))
        apart, pivot = without_rounding(apart, size), without_rounding(pivot, size)
        return (
            reached(self.motions[0], "driver's turn", "give a shorter range"),
            Check(
                "traced_points_apart", "distance between the three traced points", apart, "at most", SAME_CURVE, "mm"
            ),
            Check("third_pivot_displacement", "displacement of the third pivot", pivot, "at most", SAME_CURVE, "mm"),
            collision_check(len(self.stack.collisions), collision_advice(self.stack.collisions)),
            *self.drive.checks,
        )

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        plate = PlateStock(thickness=self.stock.thickness, pin_diameter=self.stock.pin_diameter)
        try:
            curve = CouplerCurve(self.linkage, "coupler_point", self.branch, self.drive.rising)
        except DesignError:
            turn, limits = self.drive, np.degrees(driver_limits(self.linkage, self.branch))
            closes = " and ".join(f"{low:.6g} to {high:.6g}" for low, high in limits.tolist()) or "nowhere"
            problem = f"found {turn.start_deg:g} to {turn.end_deg:g} deg, and the linkage closes only from {closes} deg"
            raise DesignError(
                "drive", problem, "give start_deg and end_deg inside it, or other lengths", "does-not-assemble"
            ) from None
        shown = {"drawing": self.figure} | {f"{name}_drawing": motion for name, motion in zip(NAMES, self.motions)}
        drawings = (engraved(name, [curve, *skeleton(motion, 0, plate)], plate) for name, motion in shown.items())
        return (*link_parts(self.figure, self.stock, self.stack), *drawings)

    @property
    def notes(self) -> Mapping[str, object]:
        three = {name: _sizes(c.linkage) for name, c in zip(NAMES, cognates(self.linkage))}
        return {"cognates": three, "stack": {**self.stack.summary(), "steps": list(self.steps)}}


def _sizes(linkage: FourBar) -> Mapping[str, object]:
    lengths = {name: getattr(linkage, name) for name in ("ground", "crank", "coupler", "rocker", "ground_angle_deg")}
    return {name: to_digits(length, 10) for name, length in lengths.items()} | {
        "driver": linkage.driver,
        "coupler_point": _pair(complex(linkage.coupler_point)),
        "origin": _pair(linkage.origin),
    }


def _pair(z: complex) -> list[float]:
    return [to_digits(z.real, 10), to_digits(z.imag, 10)]
