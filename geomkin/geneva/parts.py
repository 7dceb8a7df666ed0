"""Plates of a Geneva drive, the plate that holds its shafts, and the assembly."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, inside, quantity
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
from ..model.part import Part
from ..model.scene import SceneBody
from ..plane.primitives import rounded_hull
from ..plane.vec import Complex, Real
from .wheel import GenevaWheel


@record(checked=True)
class GenevaStock(AbstractBored):
    """Sheet and bores of all parts, and the crank's pins; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of the sheet, and bore of crank and locking disc for the crank's shaft, mm.
    wheel_bore : float, optional
        Diameter of the wheel's shaft, mm, with a round bore; if omitted, its bore is that of the crank.
    pin : float, optional
        Diameter of the pins that are glued into the crank, and on which the rollers turn, mm.
    edge : float, optional
        Width of the crank round its pins and bore, mm.
    """

    bore: float = shaft("the crank's shaft", 5.0, fitted=True)
    clearance: float = clearance(0.1)
    wheel_bore: float | None = quantity(
        "diameter of the wheel's shaft, for a round bore, 0 for none; if omitted, its bore is that of the crank",
        "mm", default=None, at_least=0, at_most=FARTHEST,
    )  # fmt: skip
    pin: float = quantity(
        "diameter of the pins on which the rollers turn", "mm", default=3.0, at_least=0.01, at_most=FARTHEST
    )
    edge: float = quantity(
        "width of the crank round its pins and bore", "mm", default=4.0, at_least=0.01, at_most=FARTHEST
    )

    @property
    def of_wheel(self) -> GenevaStock:
        """The stock with the bore of the wheel, which no motor drives."""
        if self.wheel_bore is None:
            return replace(self, motor=None, flat=self.across_flat)
        plain = {"bore_form": "round", "flat": None, "keyway_width": 0.0, "keyway_depth": 0.0}
        return replace(self, motor=None, bore=self.wheel_bore, **plain)  # type: ignore[arg-type]


@record(eq=False)
class GenevaPlates:
    """The plates of a Geneva drive: base below, wheel and locking disc above it, the crank on top."""

    wheel: GenevaWheel
    stock: GenevaStock
    base: BaseStock

    def check(self) -> None:
        """DesignError if the stock contradicts the wheel."""
        if self.stock.pin >= self.wheel.roller:
            problem = f"found {mm(self.stock.pin):g} for rollers {mm(self.wheel.roller):g} wide"
            most = self.wheel.roller
            remedy = f"give less than {mm(most):down}, or a larger geneva.roller"
            raise DesignError("stock.pin", problem, remedy, "conflict", inside(most, 1))

    @property
    def wheel_key(self) -> str:
        """Key of the wheel's bore in the recipe."""
        return "stock.bore" if self.stock.wheel_bore is None else "stock.wheel_bore"

    @property
    def arm_radius(self) -> float:
        """Half the width of the crank, mm."""
        stock = self.stock
        return max(widened(stock.pin, stock.clearance) / 2, stock.hole_reach) + stock.edge

    @property
    def arm_room(self) -> float:
        """Distance of the turning crank from the collar on the wheel's shaft, mm."""
        bore = self.stock.of_wheel.bore
        collar = collar_across(bore) / 2 if bore else 0.0
        return self.wheel.distance - self.wheel.crank_radius - self.arm_radius - collar

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Wheel, locking disc, crank and base; A is the crank's shaft, B that of the wheel."""
        wheel, stock, own = self.wheel, self.stock, self.stock.of_wheel
        bored = stock.hole(1j, 2 * wheel.relief_radius, "stock")
        try:
            hole = own.hole(1j, 2 * wheel.hub, "stock")
        except DesignError as error:
            key = self.wheel_key if error.field == "stock.bore" else error.field
            raise DesignError(key, error.problem, error.remedy, error.id, error.value) from None
        pins = tuple(
            bore(stock.pin, stock.clearance, 2 * self.arm_radius, "stock.pin", place)[0] for place in wheel.pin_places
        )
        lock = Part("lock", wheel.lock_outline, bored, stock.thickness, body="crank", hole_names=("A",) * len(bored))
        lock = replace(lock, fits=stock.fits[: len(bored)], material=stock.material)
        fits = (*lock.fits, *(fits_of(stock.pin, stock.clearance) * len(pins)))
        arm = rounded_hull((0j, *wheel.pin_places), self.arm_radius)
        letters = (*lock.hole_names, *("" for _ in pins)) if bored else ()
        crank = replace(lock, name="crank", outline=arm, holes=(*bored, *pins), hole_names=letters, fits=fits)
        plate = replace(lock, name="wheel", outline=wheel.outline, holes=hole, body="wheel")
        plate = replace(plate, hole_names=("B",) * len(hole), fits=own.fits[: len(hole)])
        return plate, lock, crank, self._base

    @property
    def _base(self) -> Part:
        wheel, own = self.wheel, self.stock.of_wheel
        rows = (("A", self.stock, "stock.bore", 0j), ("B", own, self.wheel_key, wheel.distance + 0j))
        openings = [
            BaseOpening("a shaft", key, stock.bore, (axis,), letter, head=collar_across(stock.bore), motor=stock.motor)
            for letter, stock, key, axis in rows
            if stock.bore or stock.motor
        ]
        extent = max(wheel.crank_radius + self.arm_radius, wheel.lock_radius)
        high = max(extent, wheel.rim)
        box = complex(-extent, -high), complex(max(wheel.distance + wheel.rim, extent), high)
        return replace(standing_plate(box, openings, self.base, self.stock.thickness), material=self.stock.material)

    @property
    def assembly(self) -> Assembly:
        """Shafts, collars, rollers on their pins, and the steps of assembly."""
        stock, own, pins = self.stock, self.stock.of_wheel, self.wheel.numbers[1]
        thick = stock.thickness
        builder = AssemblyBuilder("base", thick, self.base, True, stock.motor)
        builder.shaft("A", "crank", stock, 3 * thick, 2, keys=2)
        builder.shaft("B", "wheel", own, 2 * thick, 1)
        builder.add_step(1, seated("wheel", "B" if own.bore else "", own))
        on = "A" if stock.bore else ""
        builder.add_step(1, f"{seated('lock', on, stock)}, its longest arc in an arc of wheel")
        roller = f"roller {mm(self.wheel.roller):g} outside, {mm(stock.pin):g} inside, {mm(thick):g} high"
        builder.buy("crank", (*pin_bill(stock.pin, 2 * thick, pins), (roller, pins), *glue_bill(pins + 1)))
        builder.add_step(2, "glue the pins into crank, a roller on each below it")
        builder.add_step(2, f"{seated('crank', on, stock)}, glued to lock, a pin over the middle of each gap of lock")
        return builder.build()

    def bodies(self, turn: Real) -> Iterator[SceneBody]:
        """Base, wheel, locking disc and crank in their layers, at rotations of the crank, rad, (frames,)."""
        wheel, lock, crank, base = self.parts
        still = turn * 0j
        yield SceneBody("ground", (base,), still, still + 1, 0, fixed=True)
        # A locking arc, not a slot, is on the wheel's x axis.
        yield SceneBody("wheel", (wheel,), still + self.wheel.distance, -np.exp(1j * self.wheel.rotation(turn)), 1)
        yield SceneBody("lock", (lock,), still, self.crank_direction(turn), 1, named=False)
        yield SceneBody("crank", (crank,), still, self.crank_direction(turn), 2)

    def crank_direction(self, turn: Real) -> Complex:
        """Direction of the first pin; the drive starts in the middle of a dwell."""
        return np.asarray(np.exp(1j * (turn - np.pi / self.wheel.numbers[1])))

    @property
    def items(self) -> Mapping[str, str]:
        """Sizes by name, for people."""
        wheel = self.wheel
        return {
            "distance of the axes": f"{mm(wheel.distance):.5g}",
            "crank radius": f"{mm(wheel.crank_radius):.5g}",
            "locking disc": f"{mm(2 * wheel.lock_radius):.5g}",
            "wheel": f"{mm(2 * wheel.rim):.5g}, {wheel.numbers[0]} slots",
            "dwell": f"{100 * wheel.dwell:.4g} % of a turn",
        }
