"""Plates of a cycloidal drive, the plate that holds its ring of pins, and the assembly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np

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
    pin_bill,
    seated,
    standing_plate,
)
from ..making.bores import AbstractBored, bore, clearance, fits_of, shaft, widened
from ..model.part import HoleFit, Part
from ..model.scene import SceneBody
from ..plane.curve import Mirrored
from ..plane.primitives import Circle
from ..plane.vec import Real, spaced_directions
from .drive import CycloidalDrive


@record(checked=True)
class CycloidalStock(AbstractBored):
    """Sheet of all parts, and bore of the eccentric; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of the sheet, and bore of the eccentric for the input shaft, mm.
    edge : float, optional
        Width of the output plate outside its pins, mm.
    """

    bore: float = shaft("the input", 5.0, fitted=True)
    clearance: float = clearance(0.1)
    edge: float = quantity(
        "width of the output plate outside its pins", "mm", default=5.0, at_least=0.01, at_most=FARTHEST
    )


@record(eq=False)
class CycloidalPlates:
    """The plates of a drive: base with the ring of pins, the discs on their eccentrics, the output plate on top."""

    drive: CycloidalDrive
    stock: CycloidalStock
    base: BaseStock

    @property
    def output_radius(self) -> float:
        """Radius of the output plate, mm."""
        return (self.drive.output_circle + self.drive.output_pin) / 2 + self.stock.edge

    def _pins(self, count: int, circle: float, turn: float = 0.0) -> tuple[complex, ...]:
        return tuple((circle / 2 * np.exp(1j * turn) * spaced_directions(count)).tolist())

    def _disc(self, turn: float) -> Part:
        """A disc whose holes are turned back by an angle against its lobes."""
        drive, play = self.drive, self.stock.clearance
        middle = Circle(0j, widened(drive.eccentric, play) / 2)
        outputs = (Circle(z, drive.output_hole / 2) for z in self._pins(drive.output_pins, drive.output_circle, -turn))
        fits = (HoleFit(drive.eccentric, play),)
        return Part("disc", drive.outline, (middle, *outputs), self.stock.thickness, body="disc", fits=fits)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Discs, eccentric, output plate and base; A is the input shaft."""
        drive, stock = self.drive, self.stock
        turn, is_same = drive.second_turn
        discs: tuple[Part, ...] = (replace(self._disc(0.0), count=drive.discs if is_same else 1),)
        if drive.discs == 2 and not is_same:
            discs = (*discs, replace(self._disc(turn), name="disc_2", body="disc 2"))
        hole = stock.hole(1j, drive.eccentric - 2 * drive.eccentricity, "stock")
        letters = ("A",) * len(hole)
        eccentric = Part("eccentric", Circle(drive.eccentricity + 0j, drive.eccentric / 2), hole, stock.thickness)
        fits = stock.fits[: len(hole)]
        eccentric = replace(eccentric, count=drive.discs, body="input", hole_names=letters, fits=fits)
        places = self._pins(drive.output_pins, drive.output_circle)
        pins = [
            bore(drive.output_pin, stock.clearance, 2 * self.output_radius, "cycloidal.output_pin", z) for z in places
        ]
        middle = bore(stock.bore, stock.clearance, drive.output_circle - drive.output_pin, "stock.bore")
        own = (*fits_of(stock.bore, stock.clearance), *(fits_of(drive.output_pin, stock.clearance) * len(pins)))
        names = ("A", *("" for _ in pins)) if middle else ()
        holes = (*middle, *(circle for circles in pins for circle in circles))
        output = Part("output", Circle(0j, self.output_radius), holes, stock.thickness, body="output", fits=own)
        output = replace(output, hole_names=names)
        made = (*discs, eccentric, output, self._base)
        return tuple(replace(part, material=stock.material) for part in made)

    @property
    def _base(self) -> Part:
        drive, stock = self.drive, self.stock
        ring = [
            BaseOpening("a pin of the ring", "cycloidal.pin", drive.pin, (z,))
            for z in self._pins(drive.pins, drive.circle)
        ]
        axis = BaseOpening(
            "the input shaft", "stock.bore", stock.bore, (0j,), "A", head=collar_across(stock.bore), motor=stock.motor
        )
        extent = max((drive.circle + drive.pin) / 2, self.output_radius) * (1 + 1j)
        openings = [axis, *ring] if stock.bore or stock.motor else ring
        return standing_plate((-extent, extent), openings, self.base, stock.thickness)

    @property
    def assembly(self) -> Assembly:
        """Input shaft, pins, and the steps of assembly."""
        drive, stock, discs = self.drive, self.stock, self.drive.discs
        thick = stock.thickness
        builder = AssemblyBuilder("base", thick, self.base, True, stock.motor)
        builder.shaft("A", "eccentric", stock, (2 + discs) * thick, discs + 1, keys=discs)
        builder.buy("base", (*pin_bill(drive.pin, (1 + discs) * thick, drive.pins), *glue_bill(drive.pins)))
        builder.add_step(0, f"glue {drive.pins} pins {mm(drive.pin):g} into base, upright")
        for k in range(discs):
            name = "disc" if k == 0 or drive.second_turn[1] else "disc_2"
            over = ", turned over, its thick side opposite the first one" if k else ""
            builder.add_step(k + 1, f"{seated('eccentric', 'A' if stock.bore else '', stock)}{over}")
            turned = f", turned by {np.degrees(drive.second_turn[0]):.6g} deg against the first one" if k else ""
            builder.add_step(k + 1, f"lay {name} on eccentric, its lobes between the pins{turned}")
        bill = pin_bill(drive.output_pin, (1 + discs) * thick, drive.output_pins)
        builder.buy("output", (*bill, *glue_bill(drive.output_pins)))
        builder.add_step(discs + 1, f"glue {drive.output_pins} pins {mm(drive.output_pin):g} into output")
        on = " on A, where it turns freely," if stock.bore else ""
        builder.add_step(discs + 1, f"lay output{on} with its pins in the holes of every disc")
        return builder.build()

    def bodies(self, turn: Real) -> Iterator[SceneBody]:
        """All plates in their layers, at rotations of the input, rad, (frames,)."""
        plates, still, drive = {part.name: part for part in self.parts}, turn * 0j, self.drive
        yield SceneBody("ground", (plates["base"],), still, still + 1, 0, fixed=True)
        for k in range(drive.discs):
            name, eccentric = ("disc", "disc 2")[k], plates["eccentric"]
            if k:
                # Turned over, so that a flat of the shaft is on the same side.
                eccentric = replace(
                    eccentric, outline=Mirrored(eccentric.outline), holes=tuple(map(Mirrored, eccentric.holes))
                )
            part = plates.get("disc_2", plates["disc"]) if k else plates["disc"]
            yield SceneBody(name, (part,), *drive.disc_pose(turn, k), k + 1)
            yield SceneBody(("input", "input 2")[k], (eccentric,), still, np.exp(1j * turn), k + 1, named=k == 0)
        yield SceneBody("output", (plates["output"],), still, np.exp(-1j * turn / drive.lobes), drive.discs + 1)
