"""Recipe of a cam with a groove, which moves its roller both ways, with its plates and its loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, inside, last_fit, quantity
from ...core.records import record
from ...core.units import mm
from ...making.assembly import Assembly, AssemblyBuilder, collar_across, glue_bill, pin_bill, seated, tube_bill
from ...making.bores import bore, fits_of, widened
from ...model.check import Check
from ...model.material import hertz_pressure
from ...model.part import Part
from ...model.scene import Limit, Scene, SceneHandle, circle_handle
from ...model.table import Column, Table, xy_columns
from ...plane.curve import AbstractCurve, Offset
from ...plane.primitives import Circle, rounded_hull
from ...plane.vec import Complex, Real
from ...recipe.composed import AspectKinds
from ..checks import LEAST_PITCH_TO_ROLLER, convex_curvature, tightest_concave
from ..followers.follower import FollowerPlate, Hole
from ..parts import LETTERS, TIMING_STEP, cam_base, cam_plate, follower_part, unheld
from ..program.laws import samples
from .positive import AbstractPositiveCam, AbstractPositiveCamRecipe, PositiveLoadsAspect

# Dowels that hold the core and the ring on the disc; two would do, and in a ring they would leave its far side loose.
CORE_DOWELS, RING_DOWELS = 2, 4


@record(checked=True)
class Groove:
    """The groove of a cam and the plates that form it.

    Parameters
    ----------
    clearance : float, optional
        How much wider the groove is than the roller, mm.
    rim : float, optional
        Width of the ring outside the groove where it is narrowest, mm.
    dowel : float, optional
        Diameter of the dowels that hold core and ring on the disc, mm.
    """

    clearance: float = quantity(
        "how much wider the groove is than the roller", "mm", default=0.1, above=0, at_most=FARTHEST
    )
    rim: float = quantity(
        "width of the ring outside the groove where it is narrowest", "mm", default=10.0, above=0, at_most=FARTHEST
    )
    dowel: float = quantity(
        "diameter of the dowels that hold core and ring on the disc, 0 for none", "mm",
        default=3.0, at_least=0, at_most=100,
    )  # fmt: skip


@record(eq=False)
class MadeGrooveCam(AbstractPositiveCam):
    """A cam whose roller runs in a groove between a core and a ring, both on a disc.

    From below: base, disc, core and ring with the roller between them, stem or arm.
    """

    groove: Groove

    pin_layers = 4

    @property
    def clearance(self) -> float:
        return self.groove.clearance

    def check_walls(self) -> None:
        if self.concave_radius[0] <= self.half_width:
            self._refuse_roller()
        dowel, room = widened(self.groove.dowel, self.stock.clearance), self.groove.rim
        if dowel >= room:
            problem = f"found {mm(self.groove.dowel):g} in a rim {mm(room):g} wide"
            raise DesignError("groove.dowel", problem, "give thinner dowels or a wider rim", "conflict")

    @cached_property
    def concave_radius(self) -> tuple[float, float]:
        """Least radius of curvature of the concave parts of the pitch curve, mm, inf if none, and its angle, rad."""
        return tightest_concave(self.cam)

    def _refuse_roller(self) -> None:
        """DesignError with the largest roller for which the ring is not cut away."""

        def fits(radius: float) -> bool:
            smaller = replace(self.cam, follower=replace(self.roller, roller_radius=radius))
            return tightest_concave(smaller)[0] > radius + self.groove.clearance / 2

        found, least = self.roller.roller_radius, self.groove.clearance
        problem = f"found {mm(found):g}: the outer wall is undercut at {np.degrees(self.concave_radius[1]):.4g} deg"
        remedy, value = "give a larger base_radius or longer segments", None
        if fits(least):
            most = last_fit(fits, least, found)
            remedy, value = (
                f"give less than {mm(most):down}, or a larger base_radius or longer segments",
                inside(most, 1),
            )
        raise DesignError("cam.follower.roller_radius", problem, remedy, "out-of-range", value)

    @cached_property
    def outer_wall(self) -> AbstractCurve:
        """The wall outside the roller, in the cam's frame."""
        return Offset(self.cam.pitch_curve, -self.cam.sense * self.half_width)

    @cached_property
    def disc_radius(self) -> float:
        """Radius of disc and ring, mm."""
        wall = np.abs(self.outer_wall.point(samples(self.cam.program.breaks).ravel()))
        return float(wall.max()) + self.groove.rim

    @property
    def curves(self) -> tuple[tuple[AbstractCurve, complex], ...]:
        """Core and ring, with the roller between them."""
        return (self.cut.outline, self.roller.centre), (self.outer_wall, self.roller.centre)

    @cached_property
    def bars(self) -> tuple[FollowerPlate, ...]:
        """The arm; over a base, the stem with two guide pins beyond the disc."""
        cam, stock = self.cam, self.stock
        if cam.follower.oscillates:
            _, arm = cam.follower.plates(stock.bars, cam.program, cam.base_radius, cam.sense)
            return (arm,)
        if self.base is None:
            return ()
        outline = rounded_hull([0j, 1j * stock.stem_length], stock.bar_width / 2)
        pin = Hole("roller_bore", stock.roller_bore, stock.bar_width)
        return (FollowerPlate("follower", outline, (pin, *self.guide_pins(self.disc_radius))),)

    def _dowels(self, count: int, at: float, room: float) -> tuple[AbstractCurve, ...]:
        """Holes for dowels on a circle, mm; room: width of the plate there."""
        places = at * np.exp(2j * np.pi * (np.arange(count) + 0.5) / count)
        diameter, clearance = self.groove.dowel, self.stock.clearance
        holes = (bore(diameter, clearance, room, "groove.dowel", complex(place)) for place in places)
        return tuple(circle for circles in holes for circle in circles)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Core, ring, disc and roller, the stem or arm, and the base or the motor's plate."""
        stock, cam, dowel = self.stock, self.cam, self.groove.dowel
        core = cam_plate(cam, stock, self.cut)
        narrowest = float(np.abs(self.cut.outline.point(samples(self.cut.outline.breaks))).min())
        room = narrowest - stock.hole_reach
        inner = self._dowels(CORE_DOWELS, narrowest - room / 2, room)
        outer = self._dowels(RING_DOWELS, self.disc_radius - self.groove.rim / 2, self.groove.rim)
        play, letters = fits_of(dowel, stock.clearance), ("A",) * bool(core.holes) if self.base else ()
        edge = Circle(0j, self.disc_radius)

        def lettered(count: int) -> tuple[str, ...]:
            return (*letters, *("" for _ in range(count - len(letters)))) if letters else ()

        bored, fits = core.holes, core.fits
        core = replace(core, holes=(*bored, *inner), fits=(*fits, *(play * len(inner))))
        core = replace(core, hole_names=lettered(len(core.holes)))
        ring = replace(core, name="ring", outline=edge, holes=(self.outer_wall, *outer), marks=(), hole_names=())
        ring = replace(ring, fits=(None, *(play * len(outer))))
        disc_holes = (*bored, *inner, *outer)
        disc = replace(core, name="disc", outline=edge, holes=disc_holes, marks=())
        disc = replace(disc, hole_names=lettered(len(disc_holes)), fits=(*fits, *(play * len((*inner, *outer)))))
        roller, *_ = cam.follower.plates(stock.bars, cam.program, cam.base_radius, cam.sense)
        names = LETTERS if self.base else None
        plates = [core, ring, disc, *(follower_part(plate, stock, names) for plate in (roller, *self.bars))]
        if self.base is None:
            return (*plates, *stock.motor_parts)
        shafts = {"bore": stock.bore, "pivot_bore": stock.pivot_bore}
        whole = replace(self.cut, outline=edge)
        collar = collar_across(stock.bore) if stock.bore and not stock.motor else 0.0
        base = cam_base(cam, whole, self.bars, shafts, stock, self.base, collar)
        return (*plates, base)

    @cached_property
    def assembly(self) -> Assembly:
        """Shafts, dowels, pins and collars, and the assembly steps."""
        stock, thick, base = self.stock, self.stock.thickness, self.base
        builder = AssemblyBuilder("" if base is None else "base", thick, base, base is not None, stock.motor)
        layer = builder.lowest
        builder.shaft("A", "disc", stock, (0.0 if base is None else thick) + 2 * thick, layer + 1, keys=2)
        count = CORE_DOWELS + RING_DOWELS
        builder.buy("disc", (*pin_bill(self.groove.dowel, 2 * thick, count, "dowel"), *glue_bill(2)))
        builder.add_step(layer, seated("disc", "A" if builder.lettered else "", stock))
        dowels = f", with {count} dowels through both, flush" if self.groove.dowel else ""
        builder.add_step(layer + 1, f"glue cam and ring on disc{dowels}")
        if stock.timing_mark:
            builder.add_step(layer + 1, TIMING_STEP)
        for step in self._bar_steps(builder):
            builder.add_step(layer + 2, step)
        if base is None:
            builder.add_last_step(unheld(self.cam, bool(self.bars), stock))
        return builder.build()

    def _bar_steps(self, builder: AssemblyBuilder) -> Iterator[str]:
        """Steps for roller and bar: the bar lies on the groove, two sheets above the base."""
        stock, thick, bar = self.stock, self.stock.thickness, self.bars[0].name if self.bars else ""
        builder.buy(builder.joint_name("C", "roller"), pin_bill(stock.roller_bore, 2 * thick))
        if not bar:
            yield "lay roller on its pin into the groove"
            return
        builder.buy(builder.joint_name("C", "roller"), glue_bill(1))
        yield f"glue the pin of roller into {bar}, flush at the top; put roller on it, so that it turns freely"
        count = sum(hole.key == "pivot_bore" for hole in self.bars[0].holes)
        if self.base is None:
            builder.buy(bar, pin_bill(stock.pivot_bore, thick, count))
            yield f"lay {bar}, with roller in the groove and its pin into your support"
            return
        builder.pins("B", bar, stock.pivot_bore, 4 * thick, count, under=True)
        if stock.pivot_bore:
            builder.buy("B", tube_bill(stock.pivot_bore, 2 * thick, count))
        pins = f"{count} pins B" if count > 1 else "pin B"
        yield f"glue {pins} into {bar}, flush at the top, with a tube of {mm(2 * thick):g} under it on each"
        where = "the slot B of base" if count > 1 else "base"
        yield f"lay {bar}, roller in the groove and {pins} through {where}; fit a collar on each below base, with play"


@record(eq=False)
class GrooveLoadsAspect(PositiveLoadsAspect):
    """The forces of a groove and its roller: the core pushes it outwards, the ring pulls it inwards."""

    mechanism: MadeGrooveCam

    def pressure(self, angle: Real) -> Real:
        """Hertz pressure on the wall that carries the roller, N/mm2; nan if it is unknown."""
        core = super().pressure(angle)
        if self.material is None:
            return core
        curvature, radius = convex_curvature(self.cam, angle), self.cam.follower.roller_radius
        outer = 1 / radius - curvature / (1 + curvature * self.mechanism.half_width)
        force = self.contact(angle)
        ring = hertz_pressure(-force, self.mechanism.stock.thickness, outer, self.material, self.material)
        return np.where(force < 0, ring, core)

    @property
    def carried(self) -> tuple[Complex, Complex]:
        at, is_on_ring = self.cam.contact(self.angles), self.forces.contact < 0
        place = at.point + np.where(is_on_ring, 2 * self.cam.follower.roller_radius, 0.0) * at.normal
        return place, np.where(is_on_ring, -at.normal, at.normal)


@record(kw_only=True)
class GrooveCamRecipe(AbstractPositiveCamRecipe):
    """A cam with a groove that moves its roller both ways: core and ring on a disc, stem or arm, motion, play."""

    aspect_kinds: ClassVar[AspectKinds] = (GrooveLoadsAspect,)
    kind: Literal["groove-cam"] = "groove-cam"
    groove: Groove = entry("clearance of the roller, and the ring round the groove", default=Groove())

    @cached_property
    def made(self) -> MadeGrooveCam:
        """The cam with its groove in its setting."""
        return MadeGrooveCam(self.cam, self.drive, self.stock, self.base, self.setting, self.has_snap_pins, self.groove)

    def wall_columns(self, angle: Real) -> Iterator[Column]:
        wall = self.made.outer_wall.point(angle)
        yield from xy_columns("outer_wall", "mm", "wall outside the roller, in the cam's frame", wall)

    @property
    def wall_checks(self) -> Iterator[Check]:
        (radius, at), limit = self.made.concave_radius, LEAST_PITCH_TO_ROLLER
        name, share = "least concave pitch radius to that of the outer wall", radius / self.made.half_width
        advice = "give a larger cam.base_radius, a smaller roller or longer segments"
        at_deg = float(np.degrees(at)) if np.isfinite(radius) else None
        yield Check("concave_radius", name, share, "at least", limit, "", advice, at=at_deg)

    def shown(self, table: Table, limits: Sequence[Limit] = ()) -> Scene:
        """Disc, core and ring, and stem or arm above each other."""
        scene = self.layered(table, limits, ["disc"], 1, 2)
        cam = next(body for body in scene.bodies if body.name == "cam")
        disc = tuple(part for part in self.parts if part.name == "disc")
        under = replace(cam, name="disc", parts=disc, layer=cam.layer - 1, named=False)
        return replace(scene, bodies=(*scene.bodies, under))

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        contact = self.cam.contact(self.drive.angles)
        centre = contact.point + self.cam.follower.roller_radius * contact.normal
        return (
            *super().handles,
            circle_handle("groove.rim", radius=self.made.disc_radius, label="rim of the disc"),
            circle_handle("groove.clearance", radius=self.made.half_width, centre=centre, label="groove"),
        )

    @property
    def quantities(self) -> Mapping[str, str]:
        return {**super().quantities, "disc": f"{mm(2 * self.made.disc_radius):.5g}"}
