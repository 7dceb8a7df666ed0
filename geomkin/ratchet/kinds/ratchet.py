"""Recipe of a ratchet, its checks, and its loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, entry, quantity, to_digits
from ...core.records import record
from ...making.assembly import BaseStock
from ...making.motors import mounted_motor_checks
from ...model.check import Check
from ...model.motor import RotatingBody
from ...model.scene import Plot, Scene, SceneCurve, SceneHandle, SceneMark, circle_handle, point_handle
from ...model.table import Column, Table
from ...plane.primitives import Circle
from ...plane.vec import Real, cross
from ...recipe.aspect import AbstractAspect
from ...recipe.composed import AbstractPlatesRecipe
from ...recipe.recipe import assembly_summary
from ...recipe.settings import Drive, Files
from ..parts import RatchetPlates, RatchetStock
from ..wheel import Ratchet

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
        yield from mounted_motor_checks(self.mechanism)
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
