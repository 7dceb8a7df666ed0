"""Recipe of a Geneva drive, its checks, and its loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ..core.errors import DesignError
from ..core.fields import FARTHEST, entry, quantity, to_digits
from ..core.records import record
from ..core.units import UNITS, mm
from ..making.assembly import BaseStock
from ..making.motors import TURN, mounted_motor_checks
from ..model.check import Check, WorkedFormula, WorkedFormulas
from ..model.machinability import OF_KERF
from ..model.motor import RotatingBody
from ..model.scene import Plot, Scene, SceneCurve, SceneHandle, SceneMark, circle_handle, dimension, point_handle
from ..model.table import Column, Table
from ..plane.primitives import Circle
from ..plane.vec import Real
from ..recipe.aspect import AbstractAspect
from ..recipe.composed import AbstractPlatesRecipe
from ..recipe.recipe import assembly_summary
from ..recipe.settings import Drive, Files
from .parts import GenevaPlates, GenevaStock
from .wheel import GenevaWheel

# Largest acceleration of the wheel over the square of the crank's speed; chosen here: four slots have 5.41, three 31.4.
MOST_ACCELERATION = 6.0
# Largest play of the locked wheel to either side, deg; chosen here.
MOST_PLAY = 0.5
# Least width of the wheel's tips as a share of the sheet's thickness; chosen here. It is below that of walls, since the
# sides of a tip are parallel only beside the mouth of its slot, and the tip widens inwards.
LEAST_TIP = 1 / 3
# Frames of the drawing for each turn of the crank, and in total.
FRAMES_PER_TURN, FRAMES = 90, 360


@record(checked=True, kw_only=True)
class GenevaLoads:
    """What the wheel turns."""

    torque_n_mm: float = quantity(
        "torque against the rotation of the wheel while it moves", "N mm", default=0.0, at_least=0, at_most=FARTHEST,
        example=200,
    )  # fmt: skip
    inertia_kg_mm2: float = quantity(
        "moment of inertia of what turns with the wheel, besides its plate", "kg mm2", default=0.0, at_least=0,
        at_most=FARTHEST**2, example=100,
    )  # fmt: skip
    allowed_force_n: float | None = quantity(
        "force that a pin carries; not checked if omitted", "N", default=None, above=0, at_most=FARTHEST
    )


@record(kw_only=True)
class GenevaRecipe(AbstractPlatesRecipe):
    """A Geneva drive: a crank whose pins turn a slotted wheel by steps, and a disc that locks it between them."""

    without_loads: ClassVar[str] = (
        "The force on the pins and the torque on the crank are computed with the table loads."
    )
    can_be_scaled: ClassVar[bool] = True

    kind: Literal["geneva"] = "geneva"
    geneva: GenevaWheel = entry("distance, slots or share of dwell, pins and clearances")
    drive: Drive = entry("how the crank turns", default=Drive())
    loads: GenevaLoads | None = entry(
        "what the wheel turns; the table then has the force on a pin and the torque on the crank", default=None
    )
    stock: GenevaStock = entry("sheet, bores and motor, and the pins of the crank", default=GenevaStock())
    base: BaseStock = entry("the plate that holds the shafts", default=BaseStock())
    files: Files = entry("formats and tolerance of the files", default=Files())

    def __post_init__(self) -> None:
        super().__post_init__()
        self.drive.check_rows()
        self.plates.check()
        for aspect in self.aspects:
            aspect.check()

    @property
    def design(self) -> GenevaWheel:
        return self.geneva

    @cached_property
    def plates(self) -> GenevaPlates:
        """The plates and their shafts."""
        return GenevaPlates(self.geneva, self.stock, self.base)

    @property
    def rates(self) -> tuple[float, float]:
        """Speed and acceleration of the crank, rad/s and rad/s2."""
        speed, acceleration = self.setting.speed, self.setting.acceleration
        return (
            self.drive.speed if speed is None else speed,
            self.drive.acceleration_rad_per_s2 if acceleration is None else acceleration,
        )

    def columns(self, turn: Real) -> Iterator[Column]:
        """Angles of crank and wheel, and velocity and acceleration of the wheel, at rotations of the crank, rad."""
        speed, acceleration = self.rates
        first, second = self.geneva.derivatives(turn)
        yield Column("crank_angle", "deg", "angle of the crank from the middle of a dwell", np.degrees(turn))
        yield Column("wheel_angle", "deg", "rotation of the wheel", np.degrees(self.geneva.rotation(turn)))
        yield Column("wheel_velocity", "rad/s", "angular velocity of the wheel", first * speed)
        alpha = second * speed**2 + first * acceleration
        yield Column("wheel_acceleration", "rad/s2", "angular acceleration of the wheel", alpha)

    @property
    def depends_on_setting(self) -> bool:
        return True

    @property
    def own_table(self) -> Table:
        return Table(tuple(self.columns(self.drive.angles * np.sign(self.drive.speed))))

    @property
    def own_scene(self) -> Scene:
        """Crank and wheel until the wheel is where it began."""
        turns, speed = self.geneva.turns, self.drive.speed
        steps = max(FRAMES // turns, 24) if turns > FRAMES // FRAMES_PER_TURN else FRAMES_PER_TURN
        turn = 2 * np.pi * np.arange(turns * steps + 1) / steps * np.sign(speed)
        return self._scene(turn, turn / speed)

    def scene_at(self, turn: Real) -> Scene:
        return self._scene(turn, turn * 0)

    def _scene(self, turn: Real, time: Real) -> Scene:
        wheel, still = self.geneva, turn * 0j
        table = self.with_aspects(Table(tuple(self.columns(turn))))
        path = SceneCurve(Circle(0j, wheel.crank_radius), "construction", "path of the pins")
        size = dimension(0j, wheel.distance + 0j, f"{mm(wheel.distance):.5g} distance of the axes")
        direction = self.plates.crank_direction(turn)
        rollers = (
            SceneMark("circle", direction * place, "contact", "roller", radius=np.full(turn.shape, wheel.roller / 2))
            for place in wheel.pin_places
        )
        axes = (
            SceneMark("fixed pin", still + place, "construction", f"axis of the {name}")
            for name, place in (("crank", 0), ("wheel", wheel.distance))
        )
        plots = tuple(
            Plot(title, (id,))
            for title, id in (
                ("rotation of the wheel", "wheel_angle"),
                ("angular velocity of the wheel", "wheel_velocity"),
                ("angular acceleration of the wheel", "wheel_acceleration"),
            )
        )
        bodies, ok = tuple(self.plates.bodies(turn)), np.ones(turn.shape, bool)
        return Scene(table, time, ok, bodies, (path, size), (*axes, *rollers), plots)

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """The crank."""
        return {"crank": RotatingBody(0j, Fraction(1))}

    @property
    def own_checks(self) -> tuple[Check, ...]:
        wheel, room = self.geneva, self.plates.arm_room
        play = float(np.degrees(wheel.lock_play))
        most = wheel.clearance * MOST_PLAY / play if play else wheel.clearance
        thinnest = max(LEAST_TIP * self.stock.thickness, OF_KERF * self.files.kerf)
        decides = "stock.thickness" if thinnest > OF_KERF * self.files.kerf else "files.kerf"
        return (
            Check(
                "indexing_acceleration", "largest acceleration of the wheel, over the square of the crank's speed",
                wheel.peaks[1], "at most", MOST_ACCELERATION, "", "give geneva.slots of at least 4",
            ),
            Check(
                "lock_play", "play of the locked wheel to either side", play, "at most", MOST_PLAY, "deg",
                f"give a geneva.clearance of at most {mm(most):down}",
            ),
            Check(
                "arm_room", "distance of the crank from the collar on the wheel's shaft", room, "at least", 0, "mm",
                "give a larger geneva.distance, or a smaller stock.wheel_bore or stock.edge",
            ),
            Check(
                "tip_width", "width of the wheel's tips", wheel.tip_width, "at least", thinnest, "mm",
                f"give a geneva.tip_width of at least {mm(thinnest):up}, or a smaller {decides}",
            ),
        )  # fmt: skip

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        wheel, turn = self.geneva, np.radians(self.scene.drive.values)
        pin = self.plates.crank_direction(turn) * wheel.crank_radius
        return (
            point_handle("geneva.distance", at=wheel.distance + 0j, label="axis of the wheel"),
            circle_handle("geneva.roller", radius=wheel.roller / 2, centre=pin, label="roller"),
            circle_handle("geneva.tip_width", radius=wheel.lock_radius, label="locking disc"),
        )

    @property
    def quantities(self) -> Mapping[str, str]:
        return self.plates.items

    @property
    def facts(self) -> tuple[str, ...]:
        """Dwell, and the wheel's largest velocity and acceleration."""
        slots, pins = self.geneva.numbers
        velocity, acceleration, entry_jump, _ = self.geneva.peaks
        return (
            f"{slots} slots, {pins} {'pins' if pins > 1 else 'pin'}: "
            f"the wheel is locked for {100 * self.geneva.dwell:.4g} % of a turn",
            f"wheel over crank: speed up to {velocity:.4g}, acceleration up to {acceleration:.4g} and a jump of "
            f"{entry_jump:.4g} as a pin enters, over the square of the crank's speed",
        )

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        """Sizes, and the motion of the wheel as a pin is halfway from its entry to the line of centres."""
        wheel, unit, (speed, acceleration) = self.geneva, UNITS[self.units], self.rates
        (n, k), p = wheel.numbers, -wheel.half_motion / 2
        worked = WorkedFormulas("Bickford, Mechanisms for Intermittent Motion")
        worked.give("n", "slots", n)
        worked.give("k", "pins", k)
        distance = worked.give("c", "distance of the axes", unit.of(wheel.distance), unit.name)
        worked.give("p", "angle of the pin in this frame, from the line of the axes", np.degrees(p), "deg")
        worked.give("omega", "angular velocity of the crank", speed, "rad/s")
        worked.give("alpha", "angular acceleration of the crank", acceleration, "rad/s2")
        m = worked.add("crank radius over distance of the axes", "m", "sin(180 deg / {n})", wheel.ratio)
        worked.add("crank radius", "r", "{c} {m}", distance * m, unit.name)
        minus, out = ("-", "-") if wheel.sense == 1 else ("+", "")
        template = f"1 - {{k}} ({{n}} {minus} 2) / (2 {{n}})"
        worked.add("share of a turn in which the wheel rests", "d", template, wheel.dwell)
        largest = wheel.peaks[0]
        worked.add("largest velocity of the wheel over that of the crank", "u", f"{{m}} / (1 {minus} {{m}})", largest)
        signed = wheel.sense * m
        q = 1 - 2 * signed * np.cos(p) + m * m
        below = f"(1 {minus} 2 {{m}} cos({{p}} deg) + {{m}}^2)"
        template, value = f"{{m}} (cos({{p}} deg) {minus} {{m}}) / {below}", m * (np.cos(p) - signed) / q
        first = worked.add("this ratio with the pin at the angle p", "u_p", template, value)
        template = f"-{{m}} (1 - {{m}}^2) sin({{p}} deg) / {below}^2"
        second = worked.add("its derivative", "u_1", template, -m * (1 - m * m) * np.sin(p) / q**2)
        value = -wheel.sense * first * speed
        worked.add("angular velocity of the wheel", "omega_w", f"{out}{{u_p}} {{omega}}", value, "rad/s")
        template = f"{out}{{u_1}} {{omega}}^2 {minus} {{u_p}} {{alpha}}"
        value = -wheel.sense * (second * speed**2 + first * acceleration)
        worked.add("angular acceleration of the wheel", "alpha_w", template, value, "rad/s2")
        return tuple(worked.formulas)

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        wheel = self.geneva
        names = "velocity_ratio", "acceleration_ratio", "acceleration_jump_ratio", "jerk_ratio"
        own = {
            "slots": wheel.numbers[0],
            "pins": wheel.numbers[1],
            "dwell_share": to_digits(wheel.dwell),
            "crank_radius_mm": to_digits(wheel.crank_radius),
            "wheel_radius_mm": to_digits(wheel.outer_radius),
            "lock_radius_mm": to_digits(wheel.lock_radius),
            "lock_play_deg": to_digits(np.degrees(wheel.lock_play)),
            "peaks": {name: to_digits(value) for name, value in zip(names, wheel.peaks)},
        }
        return {"geneva": own}, assembly_summary(self)


@record(eq=False)
class GenevaLoadsAspect(AbstractAspect[GenevaRecipe, GenevaLoads]):
    """Force on the pin in the slot, and torque on the crank, without friction."""

    key = "loads"

    @property
    def most_columns(self) -> int:
        return 2

    def check(self) -> None:
        if not self.given.torque_n_mm and not self.given.inertia_kg_mm2 and self._plate == 0:
            problem = "found neither torque nor inertia, and the wheel has no material"
            raise DesignError("loads.torque_n_mm", problem, "give one of them", "conflict")

    @property
    def _plate(self) -> float:
        """Moment of inertia of the wheel, kg mm2; 0 without a material."""
        mass = self.mechanism.body_masses.get("wheel")
        return 0.0 if mass is None else float(mass.inertia)

    def forces(self, turn: Real) -> tuple[Real, Real]:
        """Force of the leading pin on the wheel, N, negative if it brakes, and torque on the crank, N mm."""
        recipe = self.mechanism
        wheel, (speed, acceleration) = recipe.geneva, recipe.rates
        first, second = wheel.derivatives(turn)
        alpha = second * speed**2 + first * acceleration
        inertia = 1e-3 * (self.given.inertia_kg_mm2 + self._plate)
        torque = inertia * alpha + self.given.torque_n_mm * np.sign(first * speed)
        angle, _ = wheel.pin_angle(turn)
        arm = wheel.distance * np.sqrt(1 - 2 * wheel.sense * wheel.ratio * np.cos(angle) + wheel.ratio**2)
        force = np.where(first != 0, torque / arm, 0.0) * np.sign(first * speed)
        return force, torque * first

    def columns(self, table: Table) -> Iterator[Column]:
        force, torque = self.forces(np.radians(table["crank_angle"]))
        yield Column("pin_force", "N", "force of a pin on its slot, negative if it brakes the wheel", force)
        yield Column("crank_torque", "N mm", "torque on the crank", torque)

    def plots(self, table: Table) -> Iterator[Plot]:
        yield Plot("force of a pin on its slot", ("pin_force",))
        yield Plot("torque on the crank", ("crank_torque",))

    @cached_property
    def largest(self) -> tuple[float, float]:
        """Largest force on a pin, N, and largest torque on the crank, N mm, of either sense."""
        wheel = self.mechanism.geneva
        first = np.pi / wheel.numbers[1]
        force, torque = self.forces(first + np.linspace(-1, 1, 4001) * wheel.half_motion * (1 - 1e-9))
        return float(np.abs(force).max()), float(np.abs(torque).max())

    @property
    def checks(self) -> Iterator[Check]:
        yield from mounted_motor_checks(self.mechanism, self.torque_at(TURN))
        if (allowed := self.given.allowed_force_n) is not None:
            advice = "give a lower drive.speed_rpm, a smaller load, or more geneva.slots"
            yield Check("pin_load", "force of a pin on its slot", self.largest[0], "at most", allowed, "N", advice)

    @property
    def entries(self) -> Mapping[str, object]:
        force, torque = self.largest
        return {"loads": {"largest_pin_force_N": to_digits(force), "largest_crank_torque_n_mm": to_digits(torque)}}

    def torque_at(self, turn: Real) -> Real:
        return self.forces(turn)[1]


# Set here, since the aspect names the class of its recipe.
GenevaRecipe.aspect_kinds = (GenevaLoadsAspect,)
