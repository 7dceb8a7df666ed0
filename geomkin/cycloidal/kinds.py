"""Recipe of a cycloidal drive, its plates, its checks, and its loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ..core.fields import FARTHEST, entry, quantity, to_digits
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
from ..making.materials import MATERIALS
from ..making.motors import mounted_motor_checks
from ..model.check import Check
from ..model.material import hertz_pressure
from ..model.motor import RotatingBody
from ..model.part import HoleFit, Part
from ..model.scene import Plot, Scene, SceneBody, SceneCurve, SceneHandle, SceneMark, circle_handle, point_handle
from ..model.table import Column, Table
from ..plane.primitives import Circle, mirrored
from ..plane.vec import Complex, Real, spaced_directions
from ..recipe.aspect import AbstractAspect
from ..recipe.composed import AbstractPlatesRecipe
from ..recipe.recipe import assembly_summary
from ..recipe.settings import Drive, Files, efficiency_entry
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
        return standing_plate((-extent, extent), openings, self.base, stock.thickness, stock.material)

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
                    eccentric, outline=mirrored(eccentric.outline), holes=tuple(map(mirrored, eccentric.holes))
                )
            part = plates.get("disc_2", plates["disc"]) if k else plates["disc"]
            yield SceneBody(name, (part,), *drive.disc_pose(turn, k), k + 1)
            yield SceneBody(("input", "input 2")[k], (eccentric,), still, np.exp(1j * turn), k + 1, named=k == 0)
        yield SceneBody("output", (plates["output"],), still, np.exp(-1j * turn / drive.lobes), drive.discs + 1)


# Largest share of the eccentricity with which the epitrochoid has cusps; makers use 0.5 to 0.8.
MOST_SHORTENING = 0.8
# Share of the torque that one of two discs carries at most (handbooks).
SHARE_OF_TWO = 0.55
# Least ratio of the pressure at which the disc yields below the surface to the Hertz pressure; chosen here.
LEAST_CONTACT_SAFETY = 1.0
# Frames of the drawing, at least those of a turn of the input.
FRAMES, FRAMES_PER_TURN, MOST_TURNS_DRAWN = 240, 24, 20
# Positions of the input, over the passage of a pin, at which forces are compared.
POSITIONS = 200


@record(checked=True, kw_only=True)
class CycloidalLoads:
    """Torque of the output."""

    torque_n_mm: float = quantity(
        "torque against the rotation of the output", "N mm", above=0, at_most=1e12, example=2000
    )


@record(kw_only=True)
class CycloidalDriveRecipe(AbstractPlatesRecipe):
    """A cycloidal drive: a disc of lobes on an eccentric that rolls in a ring of pins and turns an output slowly."""

    carries_torques: ClassVar[bool] = True
    without_loads: ClassVar[str] = (
        "The forces of the pins and the torque on the input are computed with the table loads."
    )
    can_be_scaled: ClassVar[bool] = True

    kind: Literal["cycloidal-drive"] = "cycloidal-drive"
    cycloidal: CycloidalDrive = entry("pins, eccentricity, discs and output pins")
    drive: Drive = entry("how the input turns", default=Drive())
    efficiency: float = efficiency_entry("the input")
    loads: CycloidalLoads | None = entry("torque of the output, for the forces of the pins", default=None)
    stock: CycloidalStock = entry("sheet, bore of the eccentric, and motor", default=CycloidalStock())
    base: BaseStock = entry("the plate that holds the ring of pins", default=BaseStock())
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.drive.check_rows(self.cycloidal.lobes)
        for aspect in self.aspects:
            aspect.check()

    @property
    def design(self) -> CycloidalDrive:
        return self.cycloidal

    @cached_property
    def plates(self) -> CycloidalPlates:
        """The plates and the pins between them."""
        return CycloidalPlates(self.cycloidal, self.stock, self.base)

    def columns(self, turn: Real) -> Iterator[Column]:
        """Rotations of input and output, deg, at rotations of the input, rad."""
        yield Column("input_angle", "deg", "rotation of the input", np.degrees(turn))
        yield Column("output_angle", "deg", "rotation of the output", np.degrees(turn) / self.cycloidal.ratio)

    @property
    def own_table(self) -> Table:
        return Table(tuple(self.columns(self.drive.angles * np.sign(self.drive.speed))))

    @property
    def own_scene(self) -> Scene:
        """Until the output is where it began or, with a large ratio, for some turns of the input."""
        turns = min(self.cycloidal.lobes, MOST_TURNS_DRAWN)
        frames = max(FRAMES, FRAMES_PER_TURN * turns)
        turn = 2 * np.pi * turns * np.arange(frames + 1) / frames * np.sign(self.drive.speed)
        return replace(self._scene(turn, turn / self.drive.speed), cyclic=turns == self.cycloidal.lobes)

    def scene_at(self, turn: Real) -> Scene:
        return self._scene(turn, turn * 0)

    def _scene(self, turn: Real, time: Real) -> Scene:
        drive, still = self.cycloidal, turn * 0j
        table = self.with_aspects(Table(tuple(self.columns(turn))))
        ring = SceneCurve(Circle(0j, drive.circle / 2), "construction", "circle of the pins")
        rolling = drive.eccentricity * drive.pins
        pitch = SceneCurve(Circle(0j, rolling), "pitch", "pitch circle of the ring")
        own = SceneCurve(Circle(0j, rolling - drive.eccentricity), "pitch", "pitch circle of the disc", "disc")
        places = drive.circle / 2 * spaced_directions(drive.pins)
        rows = [("contact", still + z, drive.pin) for z in places]
        outputs = drive.output_circle / 2 * spaced_directions(drive.output_pins)
        rows += [("contact", np.exp(-1j * turn / drive.lobes) * z, drive.output_pin) for z in outputs]
        marks = [
            SceneMark("circle", place, "contact", "pin", radius=np.full(turn.shape, diameter / 2))
            for _, place, diameter in rows
        ]
        axis = SceneMark("fixed pin", still, "construction", "axis of input and output")
        plots = (Plot("rotation of the output", ("output_angle",)),)
        ok = np.ones(turn.shape, bool)
        return Scene(table, time, ok, tuple(self.plates.bodies(turn)), (ring, pitch, own), (axis, *marks), plots)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """The input, whose discs are not round, and the output."""
        load = self.loads.torque_n_mm if self.loads else None
        output = RotatingBody(0j, Fraction(1, self.cycloidal.ratio), True, self.efficiency, load=load)
        return {"input": RotatingBody(0j, Fraction(1)), "output": output}

    @property
    def depends_on_setting(self) -> bool:
        return True

    def shaking_at(self, turn: Real) -> tuple[Complex, Real] | None:
        if self.stock.material is None:
            return None
        # Discs and eccentrics run round the axis, and the output is balanced.
        speed = self.setting.speed or self.drive.speed
        places = [
            mass.mass * (body.origin + body.direction * mass.centre)
            for body in self.plates.bodies(turn)
            for part in body.parts
            if not body.fixed and (mass := part.mass) is not None
        ]
        return np.asarray(1e-3 * speed**2 * np.sum(places, axis=0)), 0.0 * turn

    @property
    def own_checks(self) -> tuple[Check, ...]:
        drive = self.cycloidal
        most = MOST_SHORTENING * drive.circle / (2 * drive.pins)
        words = "eccentricity over that with which the profile has cusps"
        advice = f"give a cycloidal.eccentricity of at most {mm(most):down}, or a larger cycloidal.circle"
        return (Check("shortening", words, drive.shortening, "at most", MOST_SHORTENING, "", advice),)

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        drive, turn = self.cycloidal, np.radians(self.scene.drive.values)
        axis, _ = drive.disc_pose(turn, 0)
        return (
            circle_handle("cycloidal.circle", radius=drive.circle / 2, label="circle of the pins"),
            circle_handle("cycloidal.pin", radius=drive.pin / 2, centre=drive.circle / 2 + 0j, label="pin of the ring"),
            circle_handle("cycloidal.output_circle", radius=drive.output_circle / 2, label="circle of output pins"),
            circle_handle("cycloidal.eccentric", radius=drive.eccentric / 2, centre=axis),
            point_handle("cycloidal.eccentricity", at=axis, label="axis of the disc"),
        )

    @property
    def quantities(self) -> Mapping[str, str]:
        drive = self.cycloidal
        return {
            "ratio": f"{drive.ratio}",
            "least radius of curvature": f"{mm(drive.least_radius):.4g}",
            "holes for the output pins": f"{mm(drive.output_hole):.5g}",
        }

    @property
    def facts(self) -> tuple[str, ...]:
        """Ratio, and the room that the pins leave before the profile is undercut."""
        drive = self.cycloidal
        room = drive.least_radius - drive.pin / 2 - drive.clearance
        return (
            f"{drive.lobes} turns of the input turn the output once, the other way",
            f"pins may be {mm(2 * room):.4g} thicker until the profile is undercut",
        )

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        drive = self.cycloidal
        own = {
            "ratio": drive.ratio,
            "lobes": drive.lobes,
            "shortening": to_digits(drive.shortening),
            "least_radius_mm": to_digits(drive.least_radius),
            "root_radius_mm": to_digits(drive.root_radius),
            "output_hole_mm": to_digits(drive.output_hole),
        }
        return {"cycloidal": own}, assembly_summary(self)


@record(eq=False)
class CycloidalLoadsAspect(AbstractAspect[CycloidalDriveRecipe, CycloidalLoads]):
    """Forces of the pins, without friction, for a rigid disc and equal pins without clearance."""

    key = "loads"

    @property
    def most_columns(self) -> int:
        return 1

    @property
    def torque(self) -> float:
        """Torque of the output, N mm, with that of what it turns in a machine."""
        return self.given.torque_n_mm + self.mechanism.setting.torque_on("output")

    @property
    def input_torque(self) -> float:
        """Torque on the input, N mm."""
        return self.torque / (self.mechanism.cycloidal.lobes * self.mechanism.efficiency)

    @property
    def disc_torque(self) -> float:
        """Largest torque that one disc carries, N mm."""
        return self.torque * (1.0 if self.mechanism.cycloidal.discs == 1 else SHARE_OF_TWO)

    def columns(self, table: Table) -> Iterator[Column]:
        force, _ = self.mechanism.cycloidal.pin_forces(self.disc_torque, np.radians(table["input_angle"]))
        yield Column("pin_force", "N", "largest force of a pin of the ring", force.max(axis=-1))

    def plots(self, table: Table) -> Iterator[Plot]:
        yield Plot("largest force of a pin of the ring", ("pin_force",))

    @cached_property
    def largest(self) -> tuple[float, float, float, float]:
        """Largest force of a pin and on the eccentric, N, force of an output pin, N, and Hertz pressure, N/mm2."""
        recipe = self.mechanism
        drive, stock = recipe.cycloidal, recipe.stock
        turn = np.linspace(0, 2 * np.pi / drive.pins * drive.lobes, POSITIONS)
        force, bearing = drive.pin_forces(self.disc_torque, turn)
        output = 8 * self.disc_torque / (drive.output_pins * drive.output_circle)
        pressure = np.nan
        if stock.material is not None and stock.material.modulus:
            curvature = drive.contact_curvature(turn)
            steel = MATERIALS["steel-C45"]
            pressure = float(hertz_pressure(force, stock.thickness, curvature, stock.material, steel).max())
        return float(force.max()), float(bearing.max()), output, pressure

    @property
    def checks(self) -> Iterator[Check]:
        yield from mounted_motor_checks(self.mechanism, self.input_torque)
        material, pressure = self.mechanism.stock.material, self.largest[-1]
        if material is not None and pressure > 0 and np.isfinite(material.yielding_pressure):
            words = f"pressure at which {material.name} yields over that of disc and pin"
            advice = "give a smaller loads.torque_n_mm, a thicker stock.thickness, or a larger cycloidal.circle"
            safety = material.yielding_pressure / pressure
            yield Check("contact_safety", words, safety, "at least", LEAST_CONTACT_SAFETY, "", advice)

    @property
    def entries(self) -> Mapping[str, object]:
        force, bearing, output, pressure = self.largest
        torque = self.input_torque
        own = {"pin_force_N": force, "eccentric_force_N": bearing, "output_pin_force_N": output}
        own |= {"input_torque_n_mm": torque} | ({"contact_pressure_N_per_mm2": pressure} if pressure > 0 else {})
        return {"loads": {name: to_digits(value) for name, value in own.items()}}


# Set here, since the aspect names the class of its recipe.
CycloidalDriveRecipe.aspect_kinds = (CycloidalLoadsAspect,)
