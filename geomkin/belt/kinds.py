"""Recipes of belt and chain drives, their checks, and their loads."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np

from ..core.arguments import between
from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, quantity, rounded_down, to_digits
from ..core.records import record
from ..core.units import UNITS, mm
from ..making.assembly import BaseStock
from ..making.motors import (
    MOTORS,
    MotorFace,
    MotorKey,
    motor_check,
    motor_entry,
    motor_keys,
    motor_summary,
    nearest_motor,
    smallest_motor,
)
from ..model.check import Check, WorkedFormula
from ..model.motor import RPM, Motor, MotorDuty, RotatingBody
from ..model.scene import Scene, SceneHandle, SceneMark, circle_handle, drawn_at, point_handle
from ..model.table import Table
from ..plane.vec import Real
from ..recipe.aspect import AbstractAspect
from ..recipe.composed import AbstractPlatesRecipe
from ..recipe.recipe import Additions, assembly_summary
from ..recipe.settings import Files, efficiency_entry
from .drive import LoopDrive, LoopTensions, Pulley, loop_drive, loop_formulas
from .parts import LoopPlates, PulleyStock, SprocketStock, loop_scene, turned_loop_scene
from .profiles import BELTS, CHAINS, PROFILES, AbstractProfile

# Teeth of a belt in mesh: with fewer its teeth shear off before its cords tear (makers' handbooks).
LEAST_IN_MESH = 6
# Angle of a chain on a sprocket that it drives, deg, by makers' handbooks.
LEAST_WRAP = 120.0
# Share of the width between the inner plates that a sprocket may be thick (ISO 606, pitches up to 12.7 mm).
CHAIN_FACE = 0.93
# Largest share by which a chain's speed varies, as its links form a polygon; chosen here: 11 teeth have 0.041.
MOST_RIPPLE = 0.042
# Slack tension over the pull of a belt, by default: tight and slack strand as 5 to 1, usual for timing belts.
SLACK_SHARE = 0.25
# Length of the arrow of the largest shaft load, as a share of the drive's extent.
ARROW = 0.3


@record(checked=True)
class Belt:
    """A timing belt."""

    profile: Literal["GT2-2M", "GT2-3M", "HTD-3M", "HTD-5M", "HTD-8M", "T2.5", "T5", "T10", "MXL", "XL"] = entry(
        "profile of belt and pulleys", default="GT2-2M"
    )
    width: float = quantity("width of the belt", "mm", default=6.0, above=0, at_most=1000)
    teeth: int | None = quantity(
        "number of teeth of the closed belt; if omitted, that with which the last pulley moves least",
        whole=True, default=None, at_least=1, at_most=100_000,
    )  # fmt: skip


@record(checked=True)
class Chain:
    """A roller chain."""

    profile: Literal["04B", "05B", "06B", "08B", "25", "35", "40"] = entry(
        "chain by ISO 606 or, with two digits alone, ASME B29.1", default="06B"
    )
    links: int | None = quantity(
        "number of links of the closed chain, even; if omitted, that with which the last sprocket moves least",
        whole=True, default=None, at_least=1, at_most=100_000,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if self.links is not None and self.links % 2:
            remedy = f"give {self.links + 1}, since a chain closes with an even number of links"
            raise DesignError("links", f"found {self.links}", remedy, "out-of-range", self.links + 1)


Torque = Annotated[float, between(0, 1e12)]


@record(checked=True, kw_only=True)
class LoopLoads:
    """Torques against which the driven wheels turn."""

    torques_n_mm: tuple[Torque, ...] = entry(
        "torque against the rotation of each toothed wheel after the driver, in order",
        example=(500.0,),
        units=("N mm",),
    )
    slack_tension_n: float | None = quantity(
        "tension of the slack strand; if omitted, a quarter of the pull for a belt, 0 for a chain",
        "N", default=None, at_least=0, at_most=FARTHEST,
    )  # fmt: skip
    allowed_tension_n: float | None = quantity(
        "tension that belt or chain carries, from its maker; not checked if omitted",
        "N", default=None, above=0, at_most=FARTHEST,
    )  # fmt: skip
    speed_rpm: float = quantity(
        "speed of the driver, for its motor; in a machine that of the machine", "rpm", default=60.0, above=0,
        at_most=1e6,
    )  # fmt: skip
    motor: MotorKey | None = motor_entry("the driver")


class LoopAdditions(Additions):
    """A smooth idler that tightens the strand from the last wheel to the driver: it presses in, or lifts it."""

    def changes(self, recipe: AbstractLoopRecipe, key: str) -> Iterator[Mapping[str, Any]]:
        if key != recipe.wheels_key:
            return
        first, *_, last = recipe.given_wheels
        along, size = first.at - last.at, recipe.design.wheels[0].radius
        for (side, sign), share in product((("outside", 1), ("inside", -1)), (0.3, 0.5, 0.8, 0.0, 1.2, 2.0)):
            at = (first.at + last.at) / 2 + sign * along / abs(along) * 1j * share * size
            idler = {"diameter": float(f"{size:.2g}"), "at": [round(at.real, 2), round(at.imag, 2)], "side": side}
            yield {f"{key}[{len(recipe.given_wheels)}]": idler}


class AbstractLoopRecipe(AbstractPlatesRecipe):
    """Base class of recipes of a loop round toothed wheels."""

    carries_torques: ClassVar[bool] = True

    without_loads: ClassVar[str] = (
        "Wheels are balanced about their axes; tensions and shaft loads are computed with the table loads."
    )
    additions: ClassVar[Additions] = LoopAdditions(("stock.motor",))
    # Key of the belt or chain, of the wheels, and of the number of teeth or links; step of this number.
    loop_name: ClassVar[str]
    wheels_key: ClassVar[str]
    count_word: ClassVar[str]
    count_step: ClassVar[int] = 1
    # Slack tension over the pull, by default.
    slack_share: ClassVar[float] = 0.0
    if TYPE_CHECKING:
        # Declared for the type checker only, since the order of fields is that of their first declaration.
        stock: PulleyStock | SprocketStock
        first_stock: PulleyStock | SprocketStock | None
        base: BaseStock
        efficiency: float
        loads: LoopLoads | None
        files: Files

    def __post_init__(self) -> None:
        super().__post_init__()
        self.plates.check()
        for aspect in self.aspects:
            aspect.check()

    @property
    def _loop_table(self) -> Any:
        """The table of the belt or chain."""
        return getattr(self, self.loop_name)

    @property
    def given_wheels(self) -> tuple[Pulley, ...]:
        """The wheels as the recipe states them."""
        return getattr(self, self.wheels_key)  # type: ignore[no-any-return]

    @property
    def profile(self) -> AbstractProfile:
        """Sizes of the belt or chain."""
        return PROFILES[self._loop_table.profile]

    @property
    @abstractmethod
    def loop_item(self) -> str:
        """The belt or chain to buy."""

    @cached_property
    def design(self) -> LoopDrive:
        """The wheels in their places, and the loop that fits."""
        keys = self.wheels_key, f"{self.loop_name}.{self.count_word}"
        count, flange = getattr(self._loop_table, self.count_word), self.stock.flange_height
        return loop_drive(self.profile, self.given_wheels, count, self.count_step, flange, keys)

    @property
    def plates(self) -> LoopPlates:
        """Stocks of the wheels and the plate that holds them."""
        stocks = self.stock, self.first_stock, self.base
        return LoopPlates(self.design, *stocks, self.loop_name, self.wheels_key, self.loop_item)

    @property
    def own_table(self) -> Table:
        return self.design.table

    @property
    def own_scene(self) -> Scene:
        """All wheels and the loop."""
        return loop_scene(self.plates, self.parts)

    def scene_at(self, turn: Real) -> Scene:
        return turned_loop_scene(self.plates, self.parts, turn)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """All toothed wheels."""
        drive = self.design
        loads = (0.0, *self.loads.torques_n_mm) if self.loads else (None,) * len(drive.toothed)
        return {
            name: RotatingBody(drive.axes[k], drive.speed(name), True, self.efficiency if k else 1.0, load=load)
            for (name, k), load in zip(drive.toothed.items(), loads)
        }

    @property
    def wheel_checks(self) -> Iterator[Check]:
        """Checks of the loop on its wheels and of their thickness."""
        return iter(())

    @property
    def own_checks(self) -> tuple[Check, ...]:
        room, words = min(self.design.loop.gaps(max(self.profile.back, self.profile.front)))
        advice = "move the wheels apart, or give smaller flanges"
        return (*self.wheel_checks, Check("room", f"distance of {words}", room, "at least", 0, "mm", advice))

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        return tuple(self._handles())

    def _handles(self) -> Iterator[SceneHandle]:
        for k, (item, wheel) in enumerate(zip(self.given_wheels, self.design.wheels)):
            key = f"{self.wheels_key}[{k}]"
            size = "teeth" if wheel.teeth else "diameter"
            yield circle_handle(
                f"{key}.{size}", radius=wheel.solid_radius, centre=self.design.axes[k], label=f"{size} of {wheel.name}"
            )
            # The last wheel is where the loop fits; its handle stays where the recipe has it.
            yield point_handle(f"{key}.at", at=item.at, label=f"axis of {wheel.name}")

    @property
    def quantities(self) -> Mapping[str, str]:
        lines = {self.loop_name: self.loop_item}
        for wheel in self.design.wheels:
            lines[wheel.name] = f"{'idler' if not wheel.teeth else f'{wheel.teeth} teeth'}, {mm(2 * wheel.radius):.5g}"
        return lines

    @property
    def facts(self) -> tuple[str, ...]:
        """The loop, and the place of the last wheel."""
        last, axis = self.design.wheels[-1].name, self.design.axes[-1]
        moved = f", moved by {mm(self.design.moved):.4g}" if self.design.moved > 5e-7 else ""
        loads = self.aspect("loads")
        return (
            self.loop_item,
            f"{last} at x {mm(axis.real + 0.0):.6g}, y {mm(axis.imag + 0.0):.6g}{moved}",
            *((f"torque on the driver {loads.tensions.driver_torque:.4g} N mm",) if loads else ()),
        )

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        """Ratios, and the length of the loop."""
        return loop_formulas(self.design, UNITS[self.units])

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        drive, loop = self.design, self.design.loop
        wheels = {
            wheel.name: {
                **({"teeth": wheel.teeth, "teeth_in_mesh": drive.in_mesh[wheel.name]} if wheel.teeth else {}),
                "axis_mm": [round(z, 6) + 0.0 for z in (axis.real, axis.imag)],
                "pitch_diameter_mm": to_digits(2 * wheel.radius),
                "outer_diameter_mm": to_digits(2 * wheel.solid_radius),
                "wrap_deg": to_digits(np.degrees(wrap)),
                "strand_after_mm": to_digits(span),
            }
            for wheel, axis, wrap, span in zip(drive.wheels, drive.axes, loop.wraps, loop.spans)
        }
        own = {
            "profile": self.profile.name,
            self.count_word: drive.count,
            "length_mm": to_digits(drive.count * self.profile.pitch),
            "last_wheel_moved_mm": to_digits(drive.moved, 6) if drive.moved > 5e-7 else 0.0,
        }
        return {self.loop_name: own, "wheels": wheels}, assembly_summary(self)


@record(eq=False)
class LoopLoadsAspect(AbstractAspect[AbstractLoopRecipe, LoopLoads]):
    """Tensions and shaft loads of a drive."""

    key = "loads"

    def check(self) -> None:
        driven, found = len(self.mechanism.design.toothed) - 1, len(self.given.torques_n_mm)
        if found != driven:
            problem = f"found {found} for {driven} toothed wheels after the driver"
            raise DesignError("loads.torques_n_mm", problem, f"give {driven}, 0 for one without load", "conflict")
        motor_keys(*self._given_motors)

    @property
    def _given_motors(self) -> tuple[Motor | None, str | MotorFace | None, str]:
        """The motor of the table, the mounted one, and the key of the latter."""
        key = "first_stock" if self.mechanism.first_stock else "stock"
        return self.given.motor, getattr(self.mechanism, key).motor, f"{key}.motor"

    @cached_property
    def tensions(self) -> LoopTensions:
        """Tensions under the torques."""
        drive, torques, setting = self.mechanism.design, iter((0.0, *self.given.torques_n_mm)), self.mechanism.setting
        taken = [0.0, *(setting.torque_on(wheel.name) for wheel in drive.wheels[1:])]
        each = tuple(float(next(torques)) + more if wheel.teeth else 0.0 for wheel, more in zip(drive.wheels, taken))
        tensions = LoopTensions(drive, each, 0.0, self.mechanism.efficiency)
        slack = self.given.slack_tension_n
        return replace(tensions, slack=self.mechanism.slack_share * tensions.pull if slack is None else slack)

    @property
    def duty(self) -> MotorDuty:
        """Torque and speed of the driver over a turn, which are constant."""
        speed = abs(self.mechanism.setting.speed or RPM * self.given.speed_rpm)
        return MotorDuty(np.full(2, self.tensions.driver_torque), np.full(2, speed), np.array([0.0, 2 * np.pi]))

    @property
    def motor(self) -> Motor:
        """The given or mounted motor, the lightest that suffices, or the nearest."""
        named, mounted, _ = self._given_motors
        motor = named or MOTORS.get(str(mounted)) or smallest_motor(self.duty) or nearest_motor(self.duty)
        assert motor is not None
        return motor

    @property
    def checks(self) -> Iterator[Check]:
        yield motor_check(self.motor, self.duty, keys=motor_keys(*self._given_motors))
        if (allowed := self.given.allowed_tension_n) is not None:
            words = f"tension of the tight strand of the {self.mechanism.loop_name}"
            # A given slack tension stays, another one is in proportion to the torques.
            fixed = self.given.slack_tension_n or 0.0
            share = (allowed - fixed) / (self.largest - fixed) if self.largest > fixed else 1.0
            torques = ", ".join(rounded_down(share * torque, 4) for torque in self.given.torques_n_mm)
            smaller = f"torques_n_mm = [{torques}]" if share > 0 else f"a slack_tension_n below {allowed:g} N"
            advice = f"give {smaller}, larger wheels or a stronger {self.mechanism.loop_name}"
            yield Check("tension", words, self.largest, "at most", allowed, "N", advice)

    @property
    def largest(self) -> float:
        """Largest tension, N."""
        return float(self.tensions.tensions.max())

    @property
    def entries(self) -> Mapping[str, object]:
        tensions, names = self.tensions, [wheel.name for wheel in self.mechanism.design.wheels]
        loads = zip(names, tensions.tensions, np.abs(tensions.shaft_loads))
        wheels = {n: {"tension_after_N": to_digits(t), "shaft_load_N": to_digits(f)} for n, t, f in loads}
        own = {"pull_N": to_digits(tensions.pull), "driver_torque_n_mm": to_digits(tensions.driver_torque)}
        power = 1e-3 * tensions.driver_torque * float(self.duty.speed[0])
        driver = {"power_W": to_digits(power), "motor": motor_summary(self.motor, self.duty)}
        return {"loads": {**own, **driver, "wheels": wheels}}

    def on_scene(self, scene: Scene) -> Scene:
        """The scene with arrows of the shaft loads."""
        loads, axes = self.tensions.shaft_loads, np.array(self.mechanism.design.axes)
        most, size = np.abs(loads).max(), np.abs(axes - axes.mean()).max()
        if not most:
            return scene
        scale = ARROW * size / most
        still = np.zeros(scene.time.shape, complex)
        names = [wheel.name for wheel in self.mechanism.design.wheels]
        label = drawn_at(scale, "N")
        arrows = (
            SceneMark("vector", still + axis, "force", f"shaft load of {name}, {label}", vector=still + scale * load)
            for name, axis, load in zip(names, axes, loads)
        )
        return replace(scene, marks=(*scene.marks, *arrows))


# Set here, since the aspect names the class of its recipe.
AbstractLoopRecipe.aspect_kinds = (LoopLoadsAspect,)


def _base() -> Any:
    return entry("the plate that holds the shafts", default=BaseStock())


def _loads() -> Any:
    return entry("torques on the driven wheels, for tensions and shaft loads", default=None)


def _files() -> Any:
    return entry("formats and tolerance of the files", default=Files())


@record(kw_only=True)
class BeltDriveRecipe(AbstractLoopRecipe):
    """A timing belt round toothed pulleys and idlers: pulleys with flanges, and the plate that holds their shafts.

    The last pulley is moved on its line from the first one, so that the belt fits.
    """

    loop_name, wheels_key, count_word, slack_share = "belt", "pulleys", "teeth", SLACK_SHARE

    kind: Literal["belt-drive"] = "belt-drive"
    belt: Belt = entry("profile, width and teeth of the belt", default=Belt())
    pulleys: tuple[Pulley, ...] = entry(
        "the pulleys in the order in which the belt passes them counterclockwise, the driver first",
        example=(Pulley(24), Pulley(60, at=100 + 0j)),
    )
    stock: PulleyStock = entry("sheet, bore and flanges of all pulleys", default=PulleyStock())
    first_stock: PulleyStock | None = entry(
        "sheet, bore and motor of the driver; if omitted, those of the others", default=None
    )
    base: BaseStock = _base()
    efficiency: float = efficiency_entry("the driver")
    loads: LoopLoads | None = _loads()
    files: Files = _files()

    @property
    def loop_item(self) -> str:
        count, pitch = self.design.count, self.profile.pitch
        long, wide = f"{mm(count * pitch):.7g}", f"{mm(self.belt.width):g}"
        return f"timing belt {self.profile.name}, {count} teeth, {long} long, {wide} wide"

    @property
    def wheel_checks(self) -> Iterator[Check]:
        for name, count in self.design.in_mesh.items():
            advice = "give more teeth, move it away from larger pulleys, or put an idler outside next to it"
            yield Check(f"{name}_in_mesh", f"teeth of {name} in mesh", count, "at least", LEAST_IN_MESH, "", advice)
        thick, width = self.stock.thickness, self.belt.width
        advice = f"give a stock.thickness of at least {mm(width):up}, or a narrower belt"
        yield Check("face_width", "thickness of the pulleys", thick, "at least", width, "mm", advice)
        if self.stock.flange_height:
            least = self.profile.back + BELTS[self.belt.profile].line
            advice = f"give a stock.flange_height of at least {mm(least):up}"
            height = self.stock.flange_height
            yield Check("flange_height", "height of the flanges", height, "at least", least, "mm", advice)


@record(kw_only=True)
class ChainDriveRecipe(AbstractLoopRecipe):
    """A roller chain round sprockets by ISO 606: sprockets, and the plate that holds their shafts.

    The last sprocket is moved on its line from the first one, so that the chain fits.
    """

    loop_name, wheels_key, count_word, count_step = "chain", "sprockets", "links", 2

    kind: Literal["chain-drive"] = "chain-drive"
    chain: Chain = entry("profile and links of the chain", default=Chain())
    sprockets: tuple[Pulley, ...] = entry(
        "the sprockets in the order in which the chain passes them counterclockwise, the driver first",
        example=(Pulley(17), Pulley(38, at=200 + 0j)),
    )
    stock: SprocketStock = entry("sheet and bore of all sprockets", default=SprocketStock())
    first_stock: SprocketStock | None = entry(
        "sheet, bore and motor of the driver; if omitted, those of the others", default=None
    )
    base: BaseStock = _base()
    efficiency: float = efficiency_entry("the driver")
    loads: LoopLoads | None = _loads()
    files: Files = _files()

    @property
    def loop_item(self) -> str:
        count, pitch = self.design.count, self.profile.pitch
        return (
            f"roller chain {self.profile.name}, {count} links, {mm(count * pitch):.7g} long, with its connecting link"
        )

    @property
    def wheel_checks(self) -> Iterator[Check]:
        drive, wraps = self.design, np.degrees(self.design.loop.wraps)
        for name, k in drive.toothed.items():
            if drive.wheels[k].is_outside:
                continue
            advice = "move it away from larger sprockets, or put a sprocket outside next to it"
            words = f"angle of the chain on {name}"
            yield Check(f"{name}_wrap", words, float(wraps[k]), "at least", LEAST_WRAP, "deg", advice)
        fewest = min(teeth for wheel in drive.wheels if (teeth := wheel.teeth))
        ripple = 1 - float(np.cos(np.pi / fewest))
        words = f"variation of the chain's speed on {fewest} teeth"
        yield Check("speed_ripple", words, ripple, "at most", MOST_RIPPLE, "", "give more teeth")
        most = CHAIN_FACE * CHAINS[self.chain.profile].inner_width
        advice = f"give a stock.thickness of at most {mm(most):down}"
        yield Check("face_width", "thickness of the sprockets", self.stock.thickness, "at most", most, "mm", advice)
