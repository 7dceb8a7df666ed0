"""Recipe of a ratchet: its plates and assembly, its checks, and its loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, inside, quantity, to_digits
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
from ..making.motors import TURN, mounted_motor_checks
from ..model.check import Check
from ..model.motor import RotatingBody
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneBody, SceneCurve, SceneHandle, SceneMark, circle_handle, point_handle
from ..model.table import Column, Table
from ..plane.primitives import Circle
from ..plane.vec import Complex, Real, cross
from ..recipe.aspect import AbstractAspect
from ..recipe.composed import AbstractPlatesRecipe
from ..recipe.recipe import assembly_summary
from ..recipe.settings import Drive, Files
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


# Frames of the drawing for each tooth, and most teeth that it shows.
FRAMES, MOST_TEETH_DRAWN = 15, 24


@record(checked=True, kw_only=True)
class RatchetLoads:
    """What the pawl holds."""

    torque_n_mm: float = quantity(
        "torque on the wheel against the direction in which it turns freely",
        "N mm",
        above=0,
        at_most=1e12,
        example=2000,
    )
    allowed_force_n: float | None = quantity(
        "force that the pawl and its pin carry; not checked if omitted", "N", default=None, above=0, at_most=FARTHEST
    )


@record(kw_only=True)
class RatchetRecipe(AbstractPlatesRecipe):
    """A ratchet: a toothed wheel that turns one way, and a pawl that draws itself into its teeth against the other."""

    without_loads: ClassVar[str] = "The force on the pawl is computed with the table loads."
    can_be_scaled: ClassVar[bool] = True

    kind: Literal["ratchet"] = "ratchet"
    ratchet: Ratchet = entry("teeth of the wheel, and place and sizes of the pawl")
    drive: Drive = entry("how the wheel turns, counterclockwise", default=Drive())
    loads: RatchetLoads | None = entry("torque that the pawl holds", default=None)
    stock: RatchetStock = entry("sheet, bore and motor of the wheel, pins of pawl and spring", default=RatchetStock())
    base: BaseStock = entry("the plate that holds wheel and pawl", default=BaseStock())
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.drive.check_rows()
        self.plates.check()
        if self.drive.speed_rpm < 0:
            problem = f"found {self.drive.speed_rpm:g}, against which the pawl holds the wheel"
            raise DesignError("drive.speed_rpm", problem, f"give {-self.drive.speed_rpm:g}", "conflict")
        for aspect in self.aspects:
            aspect.check()

    @property
    def design(self) -> Ratchet:
        return self.ratchet

    @cached_property
    def plates(self) -> RatchetPlates:
        """The plates and their pins."""
        return RatchetPlates(self.ratchet, self.stock, self.base)

    @property
    def speed(self) -> float:
        """Of the wheel, rad/s."""
        return self.drive.speed if self.setting.speed is None else self.setting.speed

    @property
    def depends_on_setting(self) -> bool:
        return True

    def columns(self, turn: Real) -> Iterator[Column]:
        """Angles of wheel and pawl, and what the wheel loses if it stops, at rotations of the wheel, rad."""
        ratchet = self.ratchet
        yield Column("wheel_angle", "deg", "angle of the wheel from where the pawl has just dropped", np.degrees(turn))
        yield Column("pawl_angle", "deg", "rotation of the pawl out of the teeth", np.degrees(ratchet.lift(turn)))
        rate = ratchet.lift_ratio(turn) * self.speed
        yield Column("pawl_velocity", "rad/s", "angular velocity of the pawl, which jumps where it drops", rate)
        lost = np.degrees(ratchet.passed(turn))
        yield Column(
            "lost_angle", "deg", "angle by which the wheel turns back, if it stops, until the pawl holds it", lost
        )

    @property
    def own_table(self) -> Table:
        return Table(tuple(self.columns(self.drive.angles)))

    @property
    def own_scene(self) -> Scene:
        """One turn of the wheel or, with many teeth, some of them."""
        teeth = min(self.ratchet.teeth, MOST_TEETH_DRAWN)
        turn = self.ratchet.pitch * np.arange(FRAMES * teeth + 1) / FRAMES
        return replace(self._scene(turn, turn / self.drive.speed), cyclic=teeth == self.ratchet.teeth)

    def scene_at(self, turn: Real) -> Scene:
        return self._scene(turn, turn * 0)

    def _scene(self, turn: Real, time: Real) -> Scene:
        ratchet, still = self.ratchet, turn * 0j
        table = self.with_aspects(Table(tuple(self.columns(turn))))
        tips = SceneCurve(Circle(0j, ratchet.radius), "construction", "circle of the tips")
        axes = (
            SceneMark("fixed pin", still + place, "construction", f"axis of the {name}")
            for name, place in (("wheel", 0), ("pawl", ratchet.pivot))
        )
        tail = self.plates.tail(turn)
        spring = SceneMark("line", tail, "construction", "spring", vector=self.plates.post - tail)
        plots = tuple(
            Plot(title, (id,))
            for title, id in (
                ("rotation of the pawl", "pawl_angle"),
                ("angle that the wheel turns back if it stops", "lost_angle"),
            )
        )
        marks = (*axes, *([spring] if self.stock.spring else []))
        return Scene(table, time, np.ones(turn.shape, bool), tuple(self.plates.bodies(turn)), (tips,), marks, plots)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """The wheel, which others may turn counterclockwise."""
        return {"wheel": RotatingBody(0j, Fraction(1))}

    @property
    def own_checks(self) -> tuple[Check, ...]:
        ratchet = self.ratchet
        least = float(np.degrees(np.arctan(ratchet.friction)))
        advice = f"give a ratchet.undercut_deg of at least {np.ceil(100 * (least - ratchet.pivot_deg)) / 100:g}"
        engages = Check(
            "self_engagement", "angle by which a load draws the pawl into the teeth, more than that of friction",
            float(np.degrees(ratchet.engagement)), "at least", least, "deg", advice,
        )  # fmt: skip
        if self.setting.speed is None:
            return (engages,)
        return engages, Check(
            "free_direction", "speed of the wheel in the direction in which it turns freely", self.speed * 30 / np.pi,
            "at least", 0, "rpm", "turn the ratchet over with mirrored = true, or reverse what turns it",
        )  # fmt: skip

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        ratchet = self.ratchet
        return (
            circle_handle("ratchet.diameter", radius=ratchet.radius, label="wheel"),
            point_handle("ratchet.pawl_length", "ratchet.pivot_deg", at=ratchet.pivot, label="pivot of the pawl"),
        )

    @property
    def quantities(self) -> Mapping[str, str]:
        return self.plates.items

    @property
    def facts(self) -> tuple[str, ...]:
        """When the pawl draws itself in, and what the wheel loses."""
        ratchet = self.ratchet
        engagement, friction = np.degrees(ratchet.engagement), np.degrees(np.arctan(ratchet.friction))
        verb = "draws" if engagement >= friction else "does not draw"
        return (
            f"a load {verb} the pawl in: {engagement:.4g} deg for {friction:.4g} deg of friction",
            f"the wheel stops in steps of {np.degrees(ratchet.pitch):.4g} deg; a tooth must pass the pawl by "
            f"{np.degrees(ratchet.backlash):.3g} deg before it drops, and turns back by as much",
        )

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        ratchet = self.ratchet
        own = {
            "pitch_deg": to_digits(np.degrees(ratchet.pitch)),
            "depth_mm": to_digits(ratchet.tooth_depth),
            "engagement_deg": to_digits(np.degrees(ratchet.engagement)),
            "friction_angle_deg": to_digits(np.degrees(np.arctan(ratchet.friction))),
            "backlash_deg": to_digits(np.degrees(ratchet.backlash)),
            "largest_lift_deg": to_digits(np.degrees(ratchet.lifts[1])),
        }
        return {"ratchet": own}, assembly_summary(self)


@record(eq=False)
class RatchetLoadsAspect(AbstractAspect[RatchetRecipe, RatchetLoads]):
    """Force on the pawl that holds a tooth, without friction, and the torque to turn the wheel against the load."""

    key = "loads"

    @cached_property
    def force(self) -> float:
        """Force of a tooth on the pawl and of the pawl on its pin, N, at the middle of the face."""
        ratchet = self.mechanism.ratchet
        middle = (ratchet.root + ratchet.tip) / 2
        return self.given.torque_n_mm / abs(float(cross(middle, -1j * ratchet.face)))

    @property
    def checks(self) -> Iterator[Check]:
        yield from mounted_motor_checks(self.mechanism, self.torque_at(TURN))
        if (allowed := self.given.allowed_force_n) is not None:
            advice = "give a larger ratchet.diameter, or a smaller load"
            yield Check("pawl_load", "force on the pawl", self.force, "at most", allowed, "N", advice)

    @property
    def entries(self) -> Mapping[str, object]:
        ratchet, stock = self.mechanism.ratchet, self.mechanism.stock
        area = stock.thickness * abs(ratchet.tip - ratchet.root)
        return {"loads": {"pawl_force_N": to_digits(self.force), "face_pressure_MPa": to_digits(self.force / area)}}

    def torque_at(self, turn: Real) -> Real:
        return np.full(turn.shape, np.copysign(self.given.torque_n_mm, self.mechanism.speed))


# Set here, since the aspect names the class of its recipe.
RatchetRecipe.aspect_kinds = (RatchetLoadsAspect,)
