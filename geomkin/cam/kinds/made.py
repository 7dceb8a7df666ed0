"""A cam in its setting: its motion, plates, masses and assembly; and its loads, with their table in a recipe."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, ROUNDING, entry, quantity, rounded_up, to_digits
from ...core.records import record
from ...making.assembly import Assembly, BaseStock
from ...making.fasteners import pin_parts
from ...making.motors import (
    MOTORS,
    MotorKey,
    motor_check,
    motor_entry,
    motor_keys,
    motor_summary,
    nearest_motor,
    smallest_motor,
)
from ...model.check import Check, Suggestion
from ...model.material import Mass, Material
from ...model.motor import Motor, MotorDuty, effective_value
from ...model.part import Part
from ...model.scene import Limit, Plot, Scene, SceneMark, drawn_at
from ...model.table import Column, Table
from ...plane.vec import Real
from ...recipe.aspect import ALONE, AbstractAspect, Setting
from ...recipe.recipe import part_masses
from ...recipe.settings import BodyMass, Drive, Gravity, gravity_entry
from ..cam import Cam
from ..checks import at_jumps
from ..dynamics import (
    CamForces,
    FollowerLoads,
    GuideFriction,
    cam_forces,
    check_follower_loads,
    jump_speed,
    least_preload,
    least_stiffness,
)
from ..parts import CamStock, cam_assembly, cam_parts, follower_plates, pin_masses
from ..program.laws import largest
from ..undercut import Undercut, undercut


@record(eq=False)
class MadeCam:
    """A cam and its follower as plates, at the cam angles and the speed of a recipe or of its setting."""

    cam: Cam
    drive: Drive
    stock: CamStock
    base: BaseStock | None
    setting: Setting
    has_snap_pins: bool

    @property
    def speed(self) -> float:
        """Of the cam, rad/s, in the direction in which it turns; below 0 if a machine turns it backwards."""
        return self.drive.speed if self.setting.speed is None else self.setting.speed

    @property
    def acceleration(self) -> float:
        """Of the cam, rad/s2."""
        given = self.setting.acceleration
        return self.drive.acceleration_rad_per_s2 if given is None else given

    @cached_property
    def cut(self) -> Undercut:
        """The undercut of the cam and its trimmed outline."""
        return undercut(self.cam)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The plates of cam, follower and base."""
        return (*cam_parts(self.cam, self.stock, self.cut, self.base), *pin_parts(self.assembly.snap_pins))

    @cached_property
    def masses(self) -> Mapping[str, Mass]:
        """Mass of cam, roller and follower; that of the follower with the pins that are glued into it."""
        bodies = part_masses(self.parts)
        if bodies and not self.has_snap_pins:
            plates = follower_plates(self.cam, self.stock, self.base)
            for body, mass in pin_masses(plates, self.stock, self.base).items():
                bodies[body] += mass
        return bodies

    @cached_property
    def assembly(self) -> Assembly:
        """Shafts, pins and collars of cam and follower, and the assembly steps."""
        return cam_assembly(self.cam, self.stock, self.base, self.has_snap_pins)

    @property
    def mounted_motor(self) -> Motor | None:
        """The motor for which a plate has holes."""
        return MOTORS.get(str(self.stock.motor))


# Least contact force without friction of the guide over that with friction: at 0 the guide jams, and below a half
# friction takes more than the load; chosen here.
LEAST_GUIDE_SHARE = 0.5
# Least ratio of the pressure at which the material yields below the surface to the Hertz pressure; chosen here.
LEAST_CONTACT_SAFETY = 1.0
# Length of the longest arrow of the contact force, as a share of the prime radius.
LONGEST_ARROW = 0.7
# Keys of a follower that moves straight, and of an arm, with the field of `FollowerLoads` that each sets.
STRAIGHT = {"spring_rate_n_per_mm": "stiffness", "preload_n": "preload", "force_n": "force"}
ARM = {"spring_rate_n_mm_per_rad": "stiffness", "preload_n_mm": "preload", "torque_n_mm": "force"}


@record(checked=True)
class CamLoadsTable:
    """Mass and loads of the follower in a recipe."""

    follower: BodyMass | None = entry(
        "mass of the follower with all that moves with it; by default that of its parts and pins", default=None
    )
    gravity_m_per_s2: Gravity = gravity_entry()
    spring_rate_n_per_mm: float = quantity(
        "rate of the spring that presses the follower on the cam", "N/mm", default=0.0, at_least=0, at_most=FARTHEST
    )
    preload_n: float = quantity("force of the spring at lift 0", "N", default=0.0, at_least=0, at_most=FARTHEST)
    force_n: float = quantity(
        "constant further force on the follower, positive towards the cam", "N",
        default=0.0, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    spring_rate_n_mm_per_rad: float = quantity(
        "rate of a torsion spring at an arm's pivot", "N mm/rad", default=0.0, at_least=0, at_most=FARTHEST
    )
    preload_n_mm: float = quantity("torque of that spring at lift 0", "N mm", default=0.0, at_least=0, at_most=FARTHEST)
    torque_n_mm: float = quantity(
        "constant further torque on an arm, positive towards the cam", "N mm",
        default=0.0, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    friction: GuideFriction | None = entry(
        "dry friction of a straight follower's guide, with coefficient, length and overhang", default=None
    )
    motor: MotorKey | None = motor_entry("the cam")

    def of_follower(self, cam: Cam, mass: Mass, setting: Setting = ALONE) -> FollowerLoads:
        """The loads as the library has them. DesignError if the follower cannot have them."""
        keys, others = (ARM, STRAIGHT) if cam.follower.oscillates else (STRAIGHT, ARM)
        for other, key in zip(others, keys):
            if getattr(self, other):
                what = "an arm, which turns" if cam.follower.oscillates else "a follower that moves straight"
                problem = f"found {getattr(self, other):g}, but the cam has {what}"
                raise DesignError(f"loads.{other}", problem, f"give {key} instead", "conflict")
        values = {field: getattr(self, key) for key, field in keys.items()}
        gravity = setting.of_world(1000 * complex(*self.gravity_m_per_s2))
        loads = FollowerLoads(mass, gravity=gravity, friction=self.friction, **values)
        check_follower_loads(cam, loads)
        return loads


def follower_mass(cam: Cam, bodies: Mapping[str, Mass]) -> Mass | None:
    """Mass of the follower's parts, with that of the roller at its centre; None if it has no other parts."""
    plates = [mass for name, mass in bodies.items() if name not in {"cam", "roller", "ground"}]
    if not plates:
        return None
    mass = sum(plates[1:], plates[0])
    if "roller" not in bodies:
        return mass
    at = cam.contact(np.zeros(()))
    centre = cam.follower_pose(np.zeros(())).locate(at.point + cam.follower.roller_radius * at.normal)
    return mass + Mass(bodies["roller"].mass, complex(centre))


@record(eq=False)
class CamLoadsAspect(AbstractAspect[MadeCam, CamLoadsTable]):
    """The forces of a cam and its follower under loads, at the cam angles of a recipe."""

    key = "loads"

    @property
    def cam(self) -> Cam:
        """The cam and its follower."""
        return self.mechanism.cam

    def check(self) -> None:
        made, given = self.mechanism, self.given.follower
        self.given.of_follower(self.cam, given.mass if given else Mass(0.0))
        plates = follower_plates(self.cam, made.stock, made.base)
        motor_keys(self.given.motor, made.stock.motor)
        if given is None and (made.stock.material is None or all(plate.name == "roller" for plate in plates)):
            remedy = "give mass_kg in loads.follower"
            if made.stock.material is None:
                problem, remedy = "is missing, and no material is given", f"{remedy}, or material in [stock]"
            else:
                problem = "is missing, and the follower has no parts besides its roller"
            raise DesignError("loads.follower", problem, remedy, "missing-key")

    @cached_property
    def loads(self) -> FollowerLoads:
        """Loads of the follower, with its own mass or that of its parts."""
        given = self.given.follower
        mass = given.mass if given else follower_mass(self.cam, self.mechanism.masses)
        return self.given.of_follower(self.cam, mass or Mass(0.0), self.mechanism.setting)

    @property
    def angles(self) -> Real:
        """Cam angles of the table, rad."""
        return self.mechanism.drive.angles

    @property
    def material(self) -> Material | None:
        """Of cam and follower."""
        return self.mechanism.stock.material

    def forces_at(self, angle: Real) -> CamForces:
        """The forces at any cam angles, rad."""
        made = self.mechanism
        return cam_forces(self.cam, self.loads, angle, speed=made.speed, acceleration=made.acceleration)

    def torque_at(self, turn: Real) -> Real:
        return self.forces_at(np.remainder(turn, 2 * np.pi)).torque

    def contact(self, angle: Real) -> Real:
        """Contact force, N."""
        return self.forces_at(angle).contact

    def pressure(self, angle: Real) -> Real:
        """Hertz pressure of the contact, N/mm2; nan if it is unknown."""
        if self.material is None:
            return np.full(np.shape(angle), np.nan)
        return self.forces_at(angle).pressure(self.mechanism.stock.thickness, self.material)

    @cached_property
    def forces(self) -> CamForces:
        """The forces at the angles of the table."""
        return self.forces_at(self.angles)

    @cached_property
    def motor(self) -> Motor | None:
        """The given motor; without one the smallest that suffices, None if no motor can drive the cam."""
        return self.given.motor or self.mechanism.mounted_motor or smallest_motor(self.duty)

    @cached_property
    def peak_torque(self) -> tuple[float, float]:
        """Largest torque of either sense over a turn, N mm, and its cam angle, deg; nan if none is known."""
        return self._extreme(lambda angle: np.abs(self.forces_at(angle).torque))

    @property
    def duty(self) -> MotorDuty:
        """Torque and speed of the camshaft."""
        peak = self.peak_torque[0]
        return replace(self.forces.duty, between=peak if np.isfinite(peak) else 0.0)

    def _extreme(self, values: Callable[[Real], Real], sign: int = 1) -> tuple[float, float]:
        """Largest known value over a turn, with sign -1 the least, and its cam angle, deg; nan if none is known."""

        def known(angle: Real) -> Real:
            value = sign * values(angle)
            return np.where(np.isnan(value), -np.inf, value)

        top, at = largest(self.cam.program.breaks, known)
        return (np.nan if top == -np.inf else sign * top), float(np.degrees(at))

    def columns(self, table: Table) -> Iterator[Column]:
        """Torque, contact force and pressure; unknown where the velocity of the follower jumps."""
        jump, _ = at_jumps(self.cam, self.angles)
        torque = "torque on the camshaft, positive in the direction in which the cam turns"
        yield Column("camshaft_torque", "N mm", torque, np.where(jump, np.nan, self.forces.torque))
        contact = "force between cam and follower along their normal, below 0 if the follower leaves the cam"
        yield Column("contact_force", "N", contact, np.where(jump, np.nan, self.forces.contact))
        pressure = self.pressure(self.angles)
        if np.isfinite(pressure).any():
            yield Column(
                "contact_pressure", "N/mm2", "pressure of cam and follower by Hertz", np.where(jump, np.nan, pressure)
            )

    def plots(self, table: Table) -> Iterator[Plot]:
        """A plot of each column, with the limits of the contact."""
        yield Plot("torque of the camshaft", ("camshaft_torque",))
        lost = Limit("contact_force", 0.0, "below, the follower leaves the cam")
        yield Plot("force between cam and follower", ("contact_force",), (lost,))
        most = self.material.yielding_pressure if self.material else np.nan
        yields = (Limit("contact_pressure", most, "above, the material yields"),) if np.isfinite(most) else ()
        yield Plot("pressure of the contact", ("contact_pressure",), yields)

    def on_scene(self, scene: Scene) -> Scene:
        return replace(scene, marks=(*scene.marks, *self.arrow))

    @property
    def arrow(self) -> Iterator[SceneMark]:
        """The contact force at each frame, at one scale; nothing if it is unknown."""
        force = np.nan_to_num(np.maximum(self.forces.contact, 0.0))
        if force.any():
            at, scale = self.cam.contact(self.angles), LONGEST_ARROW * self.cam.prime_radius / force.max()
            label = f"contact force, {drawn_at(float(scale), 'N')}"
            yield SceneMark("vector", at.point, "force", label, vector=scale * force * at.normal)

    @property
    def checks(self) -> Iterator[Check]:
        """The follower stays on the cam, its guide does not jam, the contact does not yield, and the motor suffices."""
        yield from self.contact_checks
        if self.loads.friction:
            share, at = self._extreme(lambda t: self.forces_at(t).guide_share, -1)
            advice = "friction jams the guide near 0: give a longer guide, less overhang or a larger base_radius"
            name = "force without friction of the guide over that with friction"
            yield Check("guide_share", name, share, "at least", LEAST_GUIDE_SHARE, "", advice, "contact_force", at)
        pressure, at = self._extreme(self.pressure)
        if self.material is not None and pressure > 0 and np.isfinite(self.material.yielding_pressure):
            name = f"pressure at which {self.material.name} yields over that of the contact"
            safety, least = self.material.yielding_pressure / pressure, LEAST_CONTACT_SAFETY
            advice = "give a thicker sheet, a stronger material, a weaker spring or a larger base_radius"
            yield Check("contact_safety", name, safety, "at least", least, "", advice, "contact_pressure", at)
        peak, at = self.peak_torque
        if motor := self.motor or nearest_motor(self.duty):
            position = at if np.isfinite(peak) else None
            keys = motor_keys(self.given.motor, self.mechanism.stock.motor)
            yield motor_check(motor, self.duty, "camshaft_torque", position, keys)

    @property
    def contact_checks(self) -> Iterator[Check]:
        """That nothing but the loads is needed to hold the follower on the cam."""
        least, at = self._extreme(self.contact, -1)
        if self.cam.program.jumps.velocity.any():
            least = -np.inf
        name, (advice, kept) = "least force between cam and follower", self._contact_advice()
        yield Check("follower_contact", name, least, "at least", 0, "N", advice, "contact_force", at, "", kept)

    def _contact_advice(self) -> tuple[str, tuple[Suggestion, ...]]:
        """Advice for a follower that leaves the cam, and recipe values that keep contact."""
        if self.cam.program.jumps.velocity.any():
            return "the velocity of the follower jumps: start and end the motion with a law that rests there", ()
        rate, preload, _ = ARM if self.cam.follower.oscillates else STRAIGHT
        speed = self.mechanism.speed
        values = {preload: least_preload(self.cam, self.loads, speed)}
        values[rate] = least_stiffness(self.cam, self.loads, speed)
        enough = {key: rounded_up(value * (1 + ROUNDING), 4) for key, value in values.items() if np.isfinite(value)}
        choices = [f"{key} = {value}" for key, value in enough.items()]
        advice = f"give {', '.join([*choices, 'a lighter follower or a lower speed'])}"
        return advice, tuple(Suggestion({f"loads.{key}": float(value)}) for key, value in enough.items())

    @property
    def entries(self) -> Mapping[str, object]:
        return {"loads": self.summary}

    @property
    def summary(self) -> Mapping[str, object]:
        """Peaks, limits of the contact, and the motor, as entries of summary.json."""
        torque = self.forces.torque
        result: dict[str, object] = {}
        peak, at = self.peak_torque
        if np.isfinite(peak):
            size = float(self.forces_at(np.radians([at])).torque[0])
            rms = to_digits(effective_value(torque, self.angles))
            result["camshaft_torque_N_mm"] = {"peak": to_digits(size), "peak_at_deg": to_digits(at, 5), "rms": rms}
        for name, values, ends in (
            ("contact_force_N", self.contact, ("least", "largest")),
            ("contact_pressure_N_per_mm2", self.pressure, ("largest",)),
        ):
            extremes = {end: self._extreme(values, -1 if end == "least" else 1) for end in ends}
            if all(np.isfinite(value) for value, _ in extremes.values()):
                sizes = {end: to_digits(value) for end, (value, _) in extremes.items()}
                result[name] = sizes | {f"{end}_at_deg": to_digits(at, 5) for end, (_, at) in extremes.items()}
        result |= self.spring_summary
        if self.motor:
            result["motor"] = motor_summary(self.motor, self.duty)
        return result

    @property
    def spring_summary(self) -> Mapping[str, object]:
        """What holds the follower on the cam, as entries of summary.json."""
        arm, speed = self.cam.follower.oscillates, self.mechanism.speed
        rate = f"least_spring_rate_{'N_mm_per_rad' if arm else 'N_per_mm'}"
        return {
            "jump_speed_rpm": to_digits(jump_speed(self.cam, self.loads) * 30 / np.pi),
            f"least_preload_{'N_mm' if arm else 'N'}": to_digits(least_preload(self.cam, self.loads, speed)),
            rate: to_digits(least_stiffness(self.cam, self.loads, speed)),
        }
