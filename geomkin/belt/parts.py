"""Plates of pulleys and sprockets with their flanges, the base plate, the assembly, and the moving drawing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from string import ascii_uppercase

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, quantity
from ..core.records import record
from ..core.units import mm
from ..making.assembly import (
    Assembly,
    AssemblyBuilder,
    BaseOpening,
    BaseStock,
    collar_across,
    glue_bill,
    seated,
    standing_plate,
)
from ..making.bores import AbstractBored, clearance, shaft
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneBody, SceneCurve, SceneMark, dimension
from ..model.table import Table
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle
from ..plane.vec import Real
from .drive import LoopDrive
from .profiles import ChainProfile, toothed_outline

# Layers of the flanges of a wheel.
FLANGE_LAYERS = ("lower", 1), ("upper", 3)


@record(checked=True)
class SprocketStock(AbstractBored):
    """Sheet and bore of sprockets; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of the sheet, and bore of the shafts, mm.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=5.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the shafts", 5.0, fitted=True)
    clearance: float = clearance(0.1)

    # A chain holds itself on its sprockets.
    flange_height = 0.0
    flange_thickness = 0.0


@record(checked=True)
class PulleyStock(SprocketStock):
    """Sheet and bore of pulleys, and their flanges; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of the sheet, and bore of the shafts, mm.
    flange_height : float, optional
        Height of the flanges above the pulley's tips, mm; 0 for none.
    flange_thickness : float, optional
        Thickness of each of the two flanges, mm.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=7.0, at_least=0.01, at_most=1000)
    flange_height: float = quantity(
        "height of the flanges above the tips, 0 for none", "mm", default=2.0, at_least=0, at_most=FARTHEST
    )
    flange_thickness: float = quantity(
        "thickness of each of the two flanges", "mm", default=1.5, at_least=0.01, at_most=1000
    )


@record(eq=False)
class LoopPlates:
    """The plates of a drive.

    drive: the drive. stock, first: of all wheels, and of the driver if different. base: the plate that holds the
    shafts. loop_name: "belt" or "chain". wheels_key: key of the wheels in the recipe. item: the belt or chain to buy.
    """

    drive: LoopDrive
    stock: PulleyStock | SprocketStock
    first: PulleyStock | SprocketStock | None
    base: BaseStock
    loop_name: str
    wheels_key: str
    item: str

    def check(self) -> None:
        """DesignError if the stocks contradict each other."""
        if self.stock.motor is not None:
            problem = "found a motor for wheels that are driven"
            raise DesignError("stock.motor", problem, "give first_stock.motor instead", "conflict")
        for name in ("thickness", "flange_height", "flange_thickness"):
            size, own = getattr(self.stock, name), getattr(self.first or self.stock, name)
            if size != own:
                problem = f"found {mm(own):g}, but the other wheels have {mm(size):g}"
                raise DesignError(f"first_stock.{name}", problem, f"give {mm(size):.15g}", "conflict", size)

    @property
    def has_flanges(self) -> bool:
        return self.stock.flange_height > 0

    def stock_of(self, k: int) -> tuple[PulleyStock | SprocketStock, str]:
        """Stock of a wheel, and its key in the recipe."""
        wheel = self.drive.wheels[k]
        stock, key = (self.first, "first_stock") if k == 0 and self.first else (self.stock, "stock")
        if not wheel.teeth:
            plain = {"flat": None, "keyway_width": 0.0, "keyway_depth": 0.0}
            stock = replace(stock, bore_form="round", fit="running", **plain)  # type: ignore[arg-type]
        if wheel.bore is None:
            return stock, key
        return replace(stock, bore=wheel.bore), f"{self.wheels_key}[{k}]"

    @property
    def parts(self) -> tuple[Part, ...]:
        """The wheels with their flanges, then the base, with the shafts A, B ..."""
        parts = [part for k in range(len(self.drive.wheels)) for part in self._wheel(k)]
        return (*parts, self._base)

    def _wheel(self, k: int) -> Iterator[Part]:
        wheel, (stock, key) = self.drive.wheels[k], self.stock_of(k)
        profile, root = self.drive.profile, wheel.solid_radius
        outline: AbstractCurve = Circle(0j, wheel.solid_radius)
        if wheel.teeth:
            outline, root = toothed_outline(profile.name, wheel.teeth), root - profile.depth(wheel.teeth)
        hole = stock.hole(1j, 2 * root, key)
        letter = (ascii_uppercase[k],) if hole else ()
        plate = Part(wheel.name, outline, hole, stock.thickness, body=wheel.name, hole_names=letter, fits=stock.fits)
        yield replace(plate, material=stock.material)
        if self.has_flanges:
            rim = Circle(0j, wheel.solid_radius + stock.flange_height)
            flange = replace(plate, name=f"{wheel.name}_flange", outline=rim, count=2, material=stock.material)
            yield replace(flange, thickness=stock.flange_thickness)

    @property
    def _base(self) -> Part:
        openings = []
        for k, axis in enumerate(self.drive.axes):
            stock, key = self.stock_of(k)
            head, letter = collar_across(stock.bore), ascii_uppercase[k]
            openings.append(
                BaseOpening("a shaft", f"{key}.bore", stock.bore, (axis,), letter, head=head, motor=stock.motor)
            )
        rooms = [(wheel.centre, wheel.room + self.drive.profile.back) for wheel in self.drive.loop.wheels]
        low = complex(min(z.real - r for z, r in rooms), min(z.imag - r for z, r in rooms))
        high = complex(max(z.real + r for z, r in rooms), max(z.imag + r for z, r in rooms))
        return standing_plate((low, high), openings, self.base, self.stock.thickness, self.stock.material)

    @property
    def assembly(self) -> Assembly:
        """Shafts, collars, flanges' glue, the belt or chain, and the steps of assembly."""
        thick = self.stock.thickness
        edge = self.stock.flange_thickness if self.has_flanges else 0.0
        builder = AssemblyBuilder("base", thick, self.base, True, self.stock_of(0)[0].motor)
        level = 2 if self.has_flanges else 1
        for k, wheel in enumerate(self.drive.wheels):
            (stock, _), letter = self.stock_of(k), ascii_uppercase[k]
            builder.shaft(letter, wheel.name, stock, 2 * thick + 2 * edge, 2 * level - 1)
            if self.has_flanges:
                builder.buy(wheel.name, glue_bill(2))
                builder.add_step(1, f"lay one {wheel.name}_flange on {letter}")
            glued = ", glued to its flange" if self.has_flanges else ""
            builder.add_step(level, f"{seated(wheel.name, letter, stock)}{glued}")
        builder.buy("A", ((self.item, 1),))
        builder.add_step(level, f"lay the {self.loop_name} round all wheels")
        if self.has_flanges:
            names = ", ".join(wheel.name for wheel in self.drive.wheels)
            builder.add_step(3, f"glue the second flanges on {names}")
        return builder.build()

    def bodies(self, parts: tuple[Part, ...], turn: Real) -> Iterator[SceneBody]:
        """The base and the wheels, in their layers, at rotations of the driver, rad, (frames,)."""
        level, still = 2 if self.has_flanges else 1, turn * 0j
        plates = {part.name: (part,) for part in parts}
        yield SceneBody("ground", plates["base"], still, still + 1, 0, fixed=True)
        for wheel, pose in zip(self.drive.wheels, self.drive.poses(turn)):
            shown = [(wheel.name, wheel.name, level)]
            if self.has_flanges:
                shown += [(f"{wheel.name} {side} flange", f"{wheel.name}_flange", k) for side, k in FLANGE_LAYERS]
            place, direction = np.asarray(pose.origin), np.asarray(pose.direction)
            for name, part, layer in shown:
                yield SceneBody(name, plates[part], place, direction, layer, named=name == wheel.name)


# Largest number of pitches in a scene, frames per pitch and in total, and of drawn teeth; more make pages too large.
MOST_PITCHES, FINE, FRAMES, MOST_TEETH_DRAWN = 60, 8, 240, 24
# Time of a pitch, s: about what the eye follows.
PITCH_TIME = 0.15


def loop_scene(plates: LoopPlates, parts: tuple[Part, ...]) -> Scene:
    """The scene of a drive whose driver turns counterclockwise until all toothed wheels are where they began."""
    drive = plates.drive
    period, teeth = drive.period, drive.wheels[0].teeth or 1
    pitches = period if period <= MOST_PITCHES else teeth
    steps = max(2, min(FINE, FRAMES // pitches))
    passed = np.arange(pitches * steps + 1) / steps
    turn = 2 * np.pi * passed / teeth
    dimensions = (
        dimension(
            drive.axes[k - 1], drive.axes[k], f"distance {mm(abs(drive.axes[k] - drive.axes[k - 1])):.5g} of the axes"
        )
        for k in range(1, len(drive.axes))
    )
    # Only every few of the teeth are drawn, so that the last frame may have others than the first.
    is_cyclic = pitches == period and not drive.has_idlers and pitches % _every(drive) == 0
    return _scene(plates, parts, turn, PITCH_TIME * passed, tuple(dimensions), is_cyclic)


def turned_loop_scene(plates: LoopPlates, parts: tuple[Part, ...], turn: Real) -> Scene:
    """The scene at rotations of the driver, rad, (frames,), whose time a machine sets."""
    return _scene(plates, parts, turn, turn * 0, (), True)


def _scene(
    plates: LoopPlates, parts: tuple[Part, ...], turn: Real, time: Real, further: tuple[SceneCurve, ...], cyclic: bool
) -> Scene:
    drive = plates.drive
    table = Table(tuple(drive.columns(turn)))
    back = SceneCurve(drive.loop.path(drive.profile.back), "traced", f"outside of the {plates.loop_name}")
    lines = (SceneCurve(drive.loop.path(), "pitch", f"pitch line of the {plates.loop_name}"), back)
    circles = (
        SceneCurve(Circle(axis, wheel.radius), "construction", f"pitch circle of {wheel.name}")
        for axis, wheel in zip(drive.axes, drive.wheels)
    )
    axes = (
        SceneMark("fixed pin", turn * 0 + axis, "construction", f"axis of {wheel.name}")
        for axis, wheel in zip(drive.axes, drive.wheels)
    )
    plots = (Plot("rotations", tuple(column.id for column in table.columns[1:-1])),)
    curves, marks = (*lines, *circles, *further), (*axes, *_teeth(drive, turn))
    bodies = tuple(plates.bodies(parts, turn))
    return Scene(table, time, np.ones(turn.shape, bool), bodies, curves, marks, plots, cyclic)


def _every(drive: LoopDrive) -> int:
    """Every how many teeth of the loop one is drawn."""
    return -(-drive.count // MOST_TEETH_DRAWN)


def _teeth(drive: LoopDrive, turn: Real) -> Iterator[SceneMark]:
    """Teeth of the belt from the pitch line inwards, or rollers of the chain."""
    travel, profile = turn * drive.loop.wheels[0].pitches / (2 * np.pi), drive.profile
    for k in range(0, drive.count, _every(drive)):
        place, direction = drive.loop.place(drive.loop.first_tooth + travel + k)
        if isinstance(profile, ChainProfile):
            yield SceneMark("circle", place, "traced", radius=np.full(turn.shape, profile.roller / 2))
        else:
            yield SceneMark("line", place, "traced", vector=1j * profile.front * direction)
