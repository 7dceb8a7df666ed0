"""Plates of a ratchet, the plate that holds wheel and pawl, and the assembly."""

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
from ..plane.vec import Complex, Real
from .wheel import POSITIONS, Ratchet


@record(checked=True)
class RatchetStock(AbstractBored):
    """Sheet, bores, and the pins of pawl and spring; all lengths in mm.

    Parameters
    ----------
    thickness, bore, bore_form, flat, keyway_width, keyway_depth, fit, interference, clearance, motor, material : opt.
        As of `AbstractBored`: thickness of the sheet, and bore of the wheel, mm.
    pin : float, optional
        Diameter of the pin on which the pawl turns, mm.
    spring : float, optional
        Distance of the spring's hooks as the pawl holds a tooth, mm; 0 for no spring.
    spring_pin : float, optional
        Diameter of the two pins on which the spring is hooked, mm.
    """

    bore: float = shaft("the wheel's shaft", 8.0, fitted=True)
    clearance: float = clearance(0.1)
    pin: float = quantity(
        "diameter of the pin on which the pawl turns", "mm", default=4.0, at_least=0.01, at_most=FARTHEST
    )
    spring: float = quantity(
        "distance of the spring's hooks as the pawl holds a tooth, 0 for no spring", "mm", default=20.0, at_least=0,
        at_most=FARTHEST,
    )  # fmt: skip
    spring_pin: float = quantity(
        "diameter of the two pins on which the spring is hooked", "mm", default=2.0, at_least=0.01, at_most=FARTHEST
    )

    @property
    def of_pawl(self) -> RatchetStock:
        """The stock with the bore of the pawl, which turns on its pin."""
        return self.with_round_bore(self.pin, fit="running", bore_tolerance="")


@record(eq=False)
class RatchetPlates:
    """The plates of a ratchet: the base below, wheel and pawl above it."""

    ratchet: Ratchet
    stock: RatchetStock
    base: BaseStock

    def check(self) -> None:
        """DesignError if the spring's pin in the base meets the pawl, which turns in the same layer."""
        stock = self.stock
        if not stock.spring:
            return
        # The round end of the pawl about its hook comes nearest to that pin.
        least = (self.ratchet.pawl_width + widened(stock.spring_pin, stock.clearance)) / 2
        room = float(self.spring_length(self.ratchet.pitch * np.linspace(0, 1, POSITIONS)).min()) - least
        if room <= 0:
            problem = f"found {mm(stock.spring):g}, at which the spring's pin in the base meets the pawl"
            enough = stock.spring - room
            remedy = f"give more than {mm(enough):up}, or 0 for no spring"
            raise DesignError("stock.spring", problem, remedy, "conflict", inside(enough, -1))

    @property
    def post(self) -> complex:
        """Pin in the base on which the spring is hooked, mm: it pulls the tail outwards, and so the nose inwards."""
        pawl = self.ratchet.pawl
        return self.ratchet.pivot + pawl.tail - 1j * pawl.bar * self.stock.spring

    def spring_length(self, turn: Real) -> Real:
        """Distance of the spring's hooks, mm, at rotations of the wheel from where the pawl has just dropped."""
        return np.asarray(np.abs(self.tail(turn) - self.post))

    def tail(self, turn: Real) -> Complex:
        """The spring's pin in the pawl, mm."""
        pawl = self.ratchet.pawl
        return np.asarray(self.ratchet.pivot + pawl.tail * pawl.direction(turn))

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Wheel, pawl and base; A is the wheel's shaft, B the pawl's pin, C on either end of the spring."""
        ratchet, stock = self.ratchet, self.stock
        root = ratchet.radius - ratchet.tooth_depth
        wheel = Part("wheel", ratchet.outline, stock.hole(1j, 2 * root, "stock"), stock.thickness, body="wheel")
        wheel = replace(wheel, hole_names=("A",) * len(wheel.holes), fits=stock.fits, material=stock.material)
        width = ratchet.pawl_width
        holes = bore(stock.pin, stock.clearance, width, "stock.pin")
        fits = fits_of(stock.pin, stock.clearance)
        if stock.spring:
            holes += bore(stock.spring_pin, stock.clearance, width, "stock.spring_pin", ratchet.pawl.tail)
            fits += fits_of(stock.spring_pin, stock.clearance)
        names = ("B", "C")[: len(holes)]
        pawl = replace(wheel, name="pawl", outline=ratchet.pawl.outline, holes=holes, body="pawl", hole_names=names)
        return wheel, replace(pawl, fits=fits), self._base

    @property
    def _base(self) -> Part:
        ratchet, stock = self.ratchet, self.stock
        openings = [
            BaseOpening("the pawl's pin", "stock.pin", stock.pin, (ratchet.pivot,), "B", collar_across(stock.pin))
        ]
        if stock.bore or stock.motor:
            head = collar_across(stock.bore)
            openings.append(BaseOpening("a shaft", "stock.bore", stock.bore, (0j,), "A", head, stock.motor))
        points = np.array(
            [ratchet.pivot, ratchet.pivot + ratchet.pawl.tail, ratchet.tip + 1j * (ratchet.pawl_width + ratchet.gap)]
        )
        if stock.spring:
            openings.append(BaseOpening("the spring's pin", "stock.spring_pin", stock.spring_pin, (self.post,), "C"))
            points = np.append(points, self.post)
        half, round_wheel = ratchet.pawl_width / 2 * (1 + 1j), ratchet.radius * (1 + 1j)
        points = np.concatenate([points - half, points + half, [-round_wheel, round_wheel]])
        low, high = complex(points.real.min(), points.imag.min()), complex(points.real.max(), points.imag.max())
        return standing_plate((low, high), openings, self.base, stock.thickness, stock.material)

    @property
    def assembly(self) -> Assembly:
        """Shaft and pins with collars, the spring, and the steps of assembly."""
        stock, pawl, thick = self.stock, self.stock.of_pawl, self.stock.thickness
        builder = AssemblyBuilder("base", thick, self.base, True, stock.motor)
        builder.shaft("A", "wheel", stock, 2 * thick, 1)
        builder.shaft("B", "pawl", pawl, 2 * thick, 1)
        builder.add_step(1, seated("wheel", "A" if stock.bore else "", stock))
        builder.add_step(1, "lay pawl on B, on which it turns, its nose in a tooth of wheel")
        if stock.spring:
            turn = np.linspace(0, self.ratchet.pitch, 64, endpoint=False)
            lengths = mm(stock.spring), mm(float(self.spring_length(turn).max()))
            spring = f"tension spring, taut at {lengths[0]:.4g} between its hooks and stretched to {lengths[1]:up4}"
            builder.buy("C", ((spring, 1), *pin_bill(stock.spring_pin, 2 * thick, 2), *glue_bill(2)))
            builder.add_step(1, "glue a pin into each C, of base and pawl; hook the spring between them")
        return builder.build()

    def bodies(self, turn: Real) -> Iterator[SceneBody]:
        """Base, wheel and pawl, at rotations of the wheel from where the pawl has just dropped, rad, (frames,)."""
        wheel, pawl, base = self.parts
        still = turn * 0j
        yield SceneBody("ground", (base,), still, still + 1, 0, fixed=True)
        yield SceneBody("wheel", (wheel,), still, np.exp(1j * (turn + self.ratchet.backlash)), 1)
        yield SceneBody("pawl", (pawl,), still + self.ratchet.pivot, self.ratchet.pawl.direction(turn), 1)

    @property
    def items(self) -> Mapping[str, str]:
        """Sizes by name, for people."""
        ratchet = self.ratchet
        return {
            "wheel": f"{mm(ratchet.diameter):.5g}, {ratchet.teeth} teeth {mm(ratchet.tooth_depth):.4g} deep",
            "pawl": f"{mm(ratchet.pawl_length):.5g} from pivot to tip",
            "angle that draws the pawl in": f"{np.degrees(ratchet.engagement):.4g} deg",
            "backlash": f"{np.degrees(ratchet.backlash):.4g} deg",
        }
