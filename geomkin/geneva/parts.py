"""Plates of a Geneva drive, the plate that holds its shafts, and the assembly."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
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
    collar_bill,
    collar_width,
    glue_bill,
    pin_bill,
    seated,
    shaft_bill,
    standing_plate,
)
from ..making.bores import AbstractBored, bore, clearance, fits_of, shaft, widened
from ..making.motors import face_of, fixed_under
from ..model.part import Part
from ..model.scene import SceneBody
from ..plane.primitives import Circle, rounded_hull
from ..plane.vec import Complex, Real, spaced_directions
from .wheel import GenevaWheel, lock_inside


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
        return self.with_round_bore(self.wheel_bore)


@record(eq=False)
class GenevaPlates:
    """The plates of a Geneva drive: base below, wheel and locking disc above it, the crank on top.

    An internal wheel passes over the crank's axis. So its crank lies on the base, the wheel and the lock above it, and
    a disc on top joins the wheel to its shaft.
    """

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
        collar, wheel = collar_across(bore) / 2 if bore else 0.0, self.wheel
        arm = max(self.arm_radius, wheel.roller / 2) if wheel.internal else self.arm_radius
        return wheel.distance - wheel.crank_radius - arm - collar

    @property
    def lock_pins(self) -> Complex:
        """Pins that hold the lock of an internal wheel on the crank, mm about its axis; none for an external one."""
        wheel = self.wheel
        if not wheel.internal:
            return np.zeros(0, dtype=complex)
        direction = np.exp(1j * (np.pi - wheel.half_motion) / 2)
        radius = (lock_inside(wheel) / direction.real + wheel.lock_radius) / 2
        return np.array([-radius * direction, -radius * direction.conjugate()])

    @property
    def _lock_wall(self) -> float:
        """Least distance of those pins from the sides of the lock, mm."""
        wheel, place = self.wheel, complex(self.lock_pins[0])
        side = abs(place) * float(np.sin((np.pi - wheel.half_motion) / 2))
        return min(wheel.lock_radius - abs(place), -place.real - lock_inside(wheel), side)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Wheel, the disc of an internal one, lock, crank and base; A is the crank's shaft, B that of the wheel."""
        wheel, stock, own = self.wheel, self.stock, self.stock.of_wheel
        bored = stock.hole(1j, 2 * (self.arm_radius if wheel.internal else wheel.relief_radius), "stock")
        try:
            hole = own.hole(1j, 2 * self._hub, "stock")
        except DesignError as error:
            key = self.wheel_key if error.field == "stock.bore" else error.field
            raise DesignError(key, error.problem, error.remedy, error.id, error.value) from None
        of_pin, places = fits_of(stock.pin, stock.clearance), (*wheel.pin_places, *self.lock_pins)

        def pins(places: Iterable[complex], wall: float) -> tuple[Circle, ...]:
            return tuple(bore(stock.pin, stock.clearance, 2 * wall, "stock.pin", place)[0] for place in places)

        lock = Part("lock", wheel.lock_outline, bored, stock.thickness, body="crank", hole_names=("A",) * len(bored))
        lock = replace(lock, fits=stock.fits[: len(bored)], material=stock.material)
        arm, letters = rounded_hull((0j, *places), self.arm_radius), (*lock.hole_names, *("" for _ in places))
        crank = replace(lock, name="crank", outline=arm, holes=(*bored, *pins(places, self.arm_radius)))
        crank = replace(crank, hole_names=letters if bored else (), fits=(*lock.fits, *(of_pin * len(places))))
        plate = replace(lock, name="wheel", outline=wheel.outline, holes=hole, body="wheel", fits=own.fits[: len(hole)])
        plate = replace(plate, hole_names=("B",) * len(hole))
        if not wheel.internal:
            return plate, lock, crank, self._base
        held = pins(self.lock_pins, self._lock_wall)
        lock = replace(lock, holes=held, hole_names=(), fits=of_pin * len(held))
        letters = (*plate.hole_names, *("" for _ in self._windows)) if hole else ()
        disc = replace(plate, name="disc", holes=(*hole, *self._windows), hole_names=letters)
        return replace(plate, holes=(wheel.opening,), hole_names=(), fits=()), disc, lock, crank, self._base

    @property
    def _hub(self) -> float:
        """Radius round the wheel's axis that is free for its bore, mm."""
        wheel = self.wheel
        return wheel.distance - wheel.lock_radius if wheel.internal else wheel.hub

    @property
    def _windows(self) -> tuple[Circle, ...]:
        """Openings in the disc of an internal wheel, over its locking arcs."""
        wheel, edge = self.wheel, self.stock.edge
        bored = self.stock.of_wheel.hole_reach
        radius = min(wheel.lock_radius, wheel.distance - bored - edge) - edge
        centres = wheel.distance * spaced_directions(wheel.numbers[0])
        return tuple(Circle(complex(centre), radius) for centre in centres) if radius > edge else ()

    @property
    def _base(self) -> Part:
        wheel, own = self.wheel, self.stock.of_wheel
        rows = (("A", self.stock, "stock.bore", 0j), ("B", own, self.wheel_key, wheel.distance + 0j))
        openings = [
            BaseOpening("a shaft", key, stock.bore, (axis,), letter, head=collar_across(stock.bore), motor=stock.motor)
            for letter, stock, key, axis in rows
            if stock.bore or stock.motor
        ]
        extent, rim = max(wheel.crank_radius + self.arm_radius, wheel.lock_radius), wheel.outer_radius
        high, left = max(extent, rim), max(extent, rim - wheel.distance)
        box = complex(-left, -high), complex(max(wheel.distance + rim, extent), high)
        return standing_plate(box, openings, self.base, self.stock.thickness, self.stock.material)

    @property
    def assembly(self) -> Assembly:
        """Shafts, collars, rollers on their pins, and the steps of assembly."""
        stock, own, pins = self.stock, self.stock.of_wheel, self.wheel.numbers[1]
        thick = stock.thickness
        builder = AssemblyBuilder("base", thick, self.base, True, stock.motor)
        roller = f"roller {mm(self.wheel.roller):g} outside, {mm(stock.pin):g} inside, {mm(thick):g} high"
        if self.wheel.internal:
            self._assemble_internal(builder, roller)
            return builder.build()
        builder.shaft("A", "crank", stock, 3 * thick, 2, keys=2)
        builder.shaft("B", "wheel", own, 2 * thick, 1)
        builder.add_step(1, seated("wheel", "B" if own.bore else "", own))
        on = "A" if stock.bore else ""
        builder.add_step(1, f"{seated('lock', on, stock)}, its longest arc in an arc of wheel")
        builder.buy("crank", (*pin_bill(stock.pin, 2 * thick, pins), (roller, pins), *glue_bill(pins + 1)))
        builder.add_step(2, "glue the pins into crank, a roller on each below it")
        builder.add_step(2, f"{seated('crank', on, stock)}, glued to lock, a pin over the middle of each gap of lock")
        return builder.build()

    def _assemble_internal(self, builder: AssemblyBuilder, roller: str) -> None:
        stock, own, thick = self.stock, self.stock.of_wheel, self.stock.thickness
        if stock.motor:
            builder.buy("A", shaft_bill(stock, 2 * thick, base=thick, is_cut=True))
            builder.add_step(0, fixed_under("base", "A", len(face_of(stock.motor).screws)))
        elif stock.bore:
            width = collar_width(stock.bore)
            builder.buy("A", (*shaft_bill(stock, 2 * thick + width), *collar_bill(stock.bore), *glue_bill(1)))
            builder.keep_free_below(width)
        on = "A" if stock.bore else ""
        builder.shaft("B", "wheel", own, 4 * thick, 3, gap=2 * thick)
        builder.buy("crank", (*pin_bill(stock.pin, 2 * thick, 3), (roller, 1), *glue_bill(3)))
        builder.add_step(1, f"glue the pins into crank and lay it, pins up; {seated('crank', on, stock)}")
        if on and not stock.motor:
            builder.add_step(1, "glue it on A, whose upper end is level with it; fit a collar on A below base")
        builder.add_step(2, "lay lock on its two pins, its arc outwards, and glue it; a roller on the third pin")
        builder.add_step(2, "lay wheel, a locking arc round lock")
        seat = seated("disc", "B" if own.bore else "", own)
        builder.add_step(3, f"{seat}; glue it to wheel, edge on edge, a window over each locking arc")
        builder.buy("wheel", glue_bill(1))

    def bodies(self, turn: Real) -> Iterator[SceneBody]:
        """Base, wheel, locking disc and crank in their layers, at rotations of the crank, rad, (frames,)."""
        wheel, *disc, lock, crank, base = self.parts
        still, internal = turn * 0j, self.wheel.internal
        yield SceneBody("ground", (base,), still, still + 1, 0, fixed=True)
        # A locking arc, not a slot, is on the wheel's x axis.
        pose = still + self.wheel.distance, -np.exp(1j * self.wheel.rotation(turn))
        yield SceneBody("wheel", (wheel,), *pose, 1 + internal)
        for part in disc:
            yield SceneBody("disc", (part,), *pose, 3, named=False)
        yield SceneBody("lock", (lock,), still, self.crank_direction(turn), 1 + internal, named=False)
        yield SceneBody("crank", (crank,), still, self.crank_direction(turn), 1 if internal else 2)

    def crank_direction(self, turn: Real) -> Complex:
        """Direction of the first pin; the drive starts in the middle of a dwell."""
        return np.asarray(self.wheel.sense * np.exp(1j * (turn - np.pi / self.wheel.numbers[1])))

    @property
    def items(self) -> Mapping[str, str]:
        """Sizes by name, for people."""
        wheel = self.wheel
        return {
            "distance of the axes": f"{mm(wheel.distance):.5g}",
            "crank radius": f"{mm(wheel.crank_radius):.5g}",
            "locking disc": f"{mm(2 * wheel.lock_radius):.5g}",
            "wheel": f"{mm(2 * wheel.outer_radius):.5g}, {wheel.numbers[0]} slots",
            "dwell": f"{100 * wheel.dwell:.4g} % of a turn",
        }
