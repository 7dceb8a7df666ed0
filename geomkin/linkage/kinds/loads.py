"""Loads in a recipe of a linkage."""

from __future__ import annotations

from abc import ABC
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from ...core.errors import DesignError
from ...core.fields import FARTHEST, Coordinate, PlaceOnBody, entry, quantity
from ...core.records import record
from ...making.attachments import ActuatorKey, actuator_entry
from ...making.motors import MotorKey, motor_entry
from ...model.material import Mass
from ...model.scene import SceneHandle, point_handle
from ...recipe.aspect import ALONE, Setting
from ...recipe.settings import BodyMass, Gravity, gravity_entry
from ..dynamics.inverse import ForceAnalysis, forces
from ..dynamics.loads import DriveTable, Force, GasSpring, Loads, SlideForce, Spring, Torque, TorsionSpring
from ..dynamics.wrenches import PinFriction, SlideFriction, Wrenches, known_body, known_place
from ..motion import Motion
from ..parts.stock import LinkStock
from ..scene_handles import body_point
from .load_tables import CounterweightsTable, RunTable

# Distance of the handle of a force of about 1 N from its point, as a share of the size of the linkage.
ARROW = 0.05


# Most motors that are compared.
MOST_MOTORS = 6
# Most sheets of a flywheel: each is a plate of the search for layers, whose time grows with all subsets of them.
MOST_FLYWHEEL_SHEETS = 6
# A turn of the driver, rad.
TURN = 2 * np.pi
# Positions of the driver over which the mean of a force is taken.
MEAN_FRAMES = 3600
# Keys of rows over the angle of a driver that turns, and over the position of one that slides.
OVER_DRIVE = ("over_deg", "over_stroke")


def over_drive_entry(what: str, unit: str, columns: str = "value", slides: bool = False) -> Any:
    """Field for a load over the driver's angle, or over the position of a slide that drives."""
    drive, place, steps, beyond = "deg", "the driver's angle", "angles", "repeated every turn"
    if slides:
        drive, place, steps, beyond = "mm", "the position of a slide that drives", "positions", "constant beyond"
    rows = f"rows [{drive}, {columns}] in {unit}: linear between, a step at two equal {steps}, {beyond}"
    units = (drive, *(unit for _ in columns.split(", ")))
    return entry(f"further {what} over {place}, {rows}", default=(), units=units)


class AbstractDriveLoad(ABC):
    """A load of a recipe: a constant, and rows over the driver's angle or stroke."""

    # Key of the constant, and what it is.
    constant_key: ClassVar[str]
    constant_words: ClassVar[str]
    over_deg: tuple[tuple[float, ...], ...]
    over_stroke: tuple[tuple[float, ...], ...]

    def check_rows(self) -> None:
        """DesignError if none of them is given, or the drive of the rows does not rise, or by more than a turn."""
        if getattr(self, self.constant_key) is None and not (self.over_deg or self.over_stroke):
            remedy = f"give {self.constant_words}, or rows of over_deg, or of over_stroke if a slide drives"
            raise DesignError(self.constant_key, "is missing", remedy, "missing-key")
        for key in OVER_DRIVE:
            if any(later[0] < earlier[0] for earlier, later in pairwise(getattr(self, key))):
                raise DesignError(key, "its first numbers fall", "give rising ones", "conflict")
        if self.over_deg and (turn := self.over_deg[-1][0] - self.over_deg[0][0]) > 360:
            raise DesignError("over_deg", f"covers {turn:g} deg", "give at most 360 deg", "conflict")

    def value(self, constant: float | complex | None) -> float | complex | DriveTable:
        """The load with its constant, as the library has it; a row of two values is a complex number."""
        constant = constant or 0.0
        if not (rows := self.over_deg or self.over_stroke):
            return constant
        drive, *values = np.array(rows, dtype=float).T
        load = constant + (values[0] + 1j * values[1] if values[1:] else values[0])
        return DriveTable(np.radians(drive), load, TURN) if self.over_deg else DriveTable(drive, load)


@record(checked=True)
class PointForce(AbstractDriveLoad):
    """A force at a point of a body, in a recipe: constant, or given over the driver's angle."""

    constant_key, constant_words = "force_n", "[x, y] in N"

    body: str = entry("the body it acts on", example="rocker")
    point: PlaceOnBody = entry("point of that body, by name or [x, y]", example="rocker_pin")
    force_n: tuple[Coordinate, Coordinate] | None = entry(
        "constant force on the ground, [x, y] in N", default=None, example=(0.0, -50.0), units=("N", "N")
    )
    over_deg: tuple[tuple[Coordinate, Coordinate, Coordinate], ...] = over_drive_entry("force", "N", "x, y")
    over_stroke: tuple[tuple[Coordinate, Coordinate, Coordinate], ...] = over_drive_entry(
        "force", "N", "x, y", slides=True
    )

    def __post_init__(self) -> None:
        self.check_rows()

    def mean_over_turn(self) -> complex:
        """Mean of the force over a turn of the driver, N."""
        force = self.force().force
        turn = np.linspace(0, TURN, MEAN_FRAMES, endpoint=False)
        return complex(np.mean(force.at(turn))) if isinstance(force, DriveTable) else complex(force)

    def force(self) -> Force:
        """The force as the library has it."""
        return Force(self.body, self.point, self.value(complex(*(self.force_n or (0.0, 0.0)))))


@record(checked=True)
class BodyTorque(AbstractDriveLoad):
    """A torque on a body, in a recipe; the ground takes the opposite one."""

    constant_key, constant_words = "torque_n_mm", "a torque in N mm"

    body: str = entry("the body it acts on", example="rocker")
    torque_n_mm: float | None = quantity(
        "constant torque, counterclockwise positive", "N mm", default=None, at_least=-FARTHEST, at_most=FARTHEST,
        example=-500,
    )  # fmt: skip
    over_deg: tuple[tuple[Coordinate, Coordinate], ...] = over_drive_entry("torque", "N mm")
    over_stroke: tuple[tuple[Coordinate, Coordinate], ...] = over_drive_entry("torque", "N mm", slides=True)

    def __post_init__(self) -> None:
        self.check_rows()


@record(checked=True)
class CylinderForce(AbstractDriveLoad):
    """A force along a slide, such as that of a cylinder or of gas, in a recipe; its guide takes the opposite one."""

    constant_key, constant_words = "force_n", "a force in N"

    slide: str = entry("name of the slider", example="slide")
    force_n: float | None = quantity(
        "constant force on the sliding body, positive along the line", "N", default=None, at_least=-FARTHEST,
        at_most=FARTHEST, example=-100,
    )  # fmt: skip
    over_deg: tuple[tuple[Coordinate, Coordinate], ...] = over_drive_entry("force", "N")
    over_stroke: tuple[tuple[Coordinate, Coordinate], ...] = over_drive_entry("force", "N", slides=True)

    def __post_init__(self) -> None:
        self.check_rows()


@record(checked=True)
class CarriedMass:
    """A mass that the frame of a walker carries besides its parts and its motor, such as a battery, in a recipe."""

    mass_kg: float = quantity("mass", "kg", above=0, at_most=FARTHEST, example=0.5)
    along: float | None = quantity(
        "its position along the path, in the frame of the first linkage; by default the middle of all fixed pivots",
        "mm", default=None, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip
    across: float | None = quantity(
        "its position along the shaft, from the outer face of the first ground; by default the middle",
        "mm", default=None, at_least=-FARTHEST, at_most=FARTHEST,
    )  # fmt: skip

    def at_scale(self, scale: float) -> CarriedMass:
        """The same mass in a linkage of another size, whose stack along the shaft stays as it is."""
        return replace(self, along=None if self.along is None else scale * self.along)


@record(checked=True)
class LoadsTable:
    """What acts on a linkage besides its driver, in a recipe.

    A body without an entry in `masses` has the mass of its parts, if the stock names a material.
    """

    gravity_m_per_s2: Gravity = gravity_entry()
    masses: dict[str, BodyMass] = entry(
        "masses of bodies by name, each with mass_kg, centre and inertia_kg_mm2", default_factory=dict
    )
    forces: tuple[PointForce, ...] = entry(
        "forces, each with body, point, and force_n, over_deg or over_stroke", default=()
    )
    torques: tuple[BodyTorque, ...] = entry(
        "torques, each with body, and torque_n_mm, over_deg or over_stroke", default=()
    )
    slide_forces: tuple[CylinderForce, ...] = entry(
        "forces along slides, such as those of cylinders, each with slide, and force_n, over_deg or over_stroke",
        default=(),
    )
    springs: tuple[Spring, ...] = entry(
        "springs between two points, each with body, point, to_body, to_point, stiffness, free_length and preload",
        default=(),
    )
    gas_springs: tuple[GasSpring, ...] = entry(
        "gas springs, each with body, point, to_body, to_point, force, extended and gas_length", default=()
    )
    torsion_springs: tuple[TorsionSpring, ...] = entry(
        "torsion springs between two bodies, each with body, to_body, stiffness, free_angle_deg and preload", default=()
    )
    pin_friction: tuple[PinFriction, ...] = entry(
        "friction of pins, each with pin, coefficient, radius and viscous", default=()
    )
    slide_friction: tuple[SlideFriction, ...] = entry(
        "friction of slides, each with slide, coefficient, length and viscous", default=()
    )
    carried: tuple[CarriedMass, ...] = entry(
        "what a walker with foot carries besides its parts and its motor, each with mass_kg, along and across",
        default=(),
    )
    foot_friction: float = quantity(
        "coefficient of dry friction between the feet of a walker and the ground", default=0.0, at_least=0, at_most=10
    )
    motor: MotorKey | None = motor_entry("the driver")
    actuator: ActuatorKey | None = actuator_entry()
    motors: tuple[MotorKey, ...] = entry(
        "direct-current motors to compare at the speed of the drive: margin, largest speed, and time on a battery",
        default=(),
    )
    battery_wh: float | None = quantity(
        "energy of the battery from which these motors run", "Wh", default=None, above=0, at_most=1e9
    )
    speed_fluctuation: float | None = quantity(
        "allowed difference of the largest and the least speed over their mean, for a flywheel on the driver",
        default=None, above=0, at_most=1,
    )  # fmt: skip
    flywheel_sheets: int = quantity(
        "number of sheets of which the flywheel is cut, as discs on the driver; 0 if only its size is stated",
        whole=True, default=0, at_least=0, at_most=MOST_FLYWHEEL_SHEETS,
    )  # fmt: skip
    counterweights: CounterweightsTable | None = entry(
        "round ends of bars that reduce the shaking force, with bodies, distance and largest_radius", default=None
    )
    run: RunTable | None = entry(
        "motion that follows from a torque or from the motor, with torque_n_mm, start_rpm and turns", default=None
    )

    def pushes(self, point: str) -> bool:
        """Whether a force at a point is given."""
        return any(force.point == point for force in self.forces)

    @property
    def has_dry_friction(self) -> bool:
        """Whether a pin or a slide has dry friction."""
        pins, slides = self.pin_friction, self.slide_friction
        return any(pin.coefficient for pin in pins) or any(slide.coefficient for slide in slides)

    @property
    def by_key(self) -> dict[str, tuple[Any, ...]]:
        """The loads as the library has them, by the keys of this table."""
        return {
            "forces": tuple(force.force() for force in self.forces),
            "torques": tuple(Torque(torque.body, torque.value(torque.torque_n_mm)) for torque in self.torques),
            "slide_forces": tuple(SlideForce(force.slide, force.value(force.force_n)) for force in self.slide_forces),
            "springs": self.springs,
            "gas_springs": self.gas_springs,
            "torsion_springs": self.torsion_springs,
            "pin_friction": self.pin_friction,
            "slide_friction": self.slide_friction,
        }

    def handles(self, motion: Motion) -> Iterator[SceneHandle]:
        """Handles of constant forces, of the centres of mass, and of the points of forces and springs given as [x, y].

        The handle of a force lies in its direction from its point, at a distance that grows with the logarithm of its
        size: forces of 1 N and of 10,000 N are both within reach.
        """
        unit = ARROW * float(np.max(motion.linkage.size) or 1.0)
        for k, force in enumerate(self.forces):
            if force.force_n is not None:
                start = complex(known_place(motion.linkage, force.body, force.point, f"loads.forces[{k}]."))
                vector = complex(*force.force_n)
                arrow = unit * np.arcsinh(abs(vector)) * (vector / abs(vector) if vector else 0)
                at = body_point(motion, force.body, start) + arrow
                label = f"force {k + 1} on the {force.body}"
                yield point_handle(f"loads.forces[{k}].force_n", at=at, label=label, arrow=complex(arrow))
        for body, mass in self.masses.items():
            at = body_point(motion, body, mass.centre)
            yield point_handle(f"loads.masses.{body}.centre", at=at, label=f"centre of mass of the {body}")
        for key in ("forces", "springs", "gas_springs"):
            for k, load in enumerate(getattr(self, key)):
                for body, point in (("body", "point"), ("to_body", "to_point")):
                    place = getattr(load, point, "")
                    if isinstance(place, complex):
                        at = body_point(motion, getattr(load, body), place)
                        yield point_handle(f"loads.{key}[{k}].{point}", at=at, label=f"{point} of {key} {k + 1}")

    def check(self, motion: Motion) -> None:
        """DesignError with the key of the first load that the linkage cannot have in this motion."""
        wrenches = Wrenches(motion)
        for key, loads in self.by_key.items():
            for k, load in enumerate(loads):
                try:
                    load.apply(wrenches)
                except DesignError as error:
                    name = error.field.partition(".")[2]
                    field = f"loads.{key}[{k}]{f'.{name}' if name else ''}"
                    raise error.named(field) from None
        for body in self.masses:
            known_body(motion.linkage, body, "loads.masses")
        is_sliding = motion.linkage.driven_slider is not None
        wrong, right = OVER_DRIVE if is_sliding else OVER_DRIVE[::-1]
        for key in ("forces", "torques", "slide_forces"):
            for k, load in enumerate(getattr(self, key)):
                if getattr(load, wrong):
                    problem = f"is given, but {'a slide drives' if is_sliding else 'the driver turns'}"
                    raise DesignError(f"loads.{key}[{k}].{wrong}", problem, f"give {right} instead", "conflict")
        for key, motor in {"motor": self.motor, "motors": next(iter(self.motors), None)}.items():
            if motor and motion.linkage.driver_pivot is None:
                problem = f"found {motor.name}, but the driver turns on no fixed shaft"
                raise DesignError(f"loads.{key}", problem, "omit it, or let a body on a fixed pivot drive", "conflict")
        if self.actuator and motion.linkage.driven_slider is None:
            problem = f"found {self.actuator.name}, but the driver turns"
            raise DesignError("loads.actuator", problem, "omit it, or let a slide drive", "conflict")
        if len(self.motors) > MOST_MOTORS:
            raise DesignError(
                "loads.motors", f"found {len(self.motors)}", f"give at most {MOST_MOTORS}", "out-of-range"
            )
        if self.battery_wh and not self.motors:
            problem = "is given, but no motors that run from it"
            raise DesignError("loads.battery_wh", problem, "give motors, or omit it", "conflict")

    def check_flywheel(self, driver: str, stock: LinkStock, has_copies: bool) -> None:
        """DesignError if no flywheel can be cut. driver: name of the body on which it is."""
        key = "loads.flywheel_sheets"
        if self.speed_fluctuation is None:
            remedy = "give it, or omit loads.flywheel_sheets"
            problem = "is missing, and the flywheel's size depends on it"
            raise DesignError("loads.speed_fluctuation", problem, remedy, "missing-key")
        if stock.material is None:
            problem, remedy = "is missing, and the flywheel's size depends on it", f'give "steel-S235", or omit {key}'
            raise DesignError("stock.material", problem, remedy, "missing-key")
        if driver in self.masses:
            problem = f"is given, and the flywheel on the {driver} would change it"
            raise DesignError(f"loads.masses.{driver}", problem, f"omit it, or {key}", "conflict")
        if has_copies:
            problem = "is given, but copies share the shaft, and each would have its own"
            raise DesignError(key, problem, "omit it: summary.json states the flywheel of all together", "conflict")

    @property
    def given_masses(self) -> dict[str, Mass]:
        """Masses of bodies with an entry in `masses`."""
        return {body: mass.mass for body, mass in self.masses.items()}

    def gravity_in(self, setting: Setting) -> complex:
        """Gravity in the frame of a linkage in its setting, mm/s2."""
        return setting.of_world(1000 * complex(*self.gravity_m_per_s2))

    def forces_of(
        self, motion: Motion, part_masses: Mapping[str, Mass], setting: Setting = ALONE, further: tuple[Force, ...] = ()
    ) -> ForceAnalysis:
        """Driver effort and joint forces.

        part_masses: of the parts, for bodies without an entry in `masses`. setting: of the linkage, by which gravity is
        that of the world; the forces of the table keep their direction in the linkage. further: forces besides them.
        """
        return forces(motion, self.loads_of(motion, part_masses, setting, further))

    def loads_of(
        self, motion: Motion, part_masses: Mapping[str, Mass], setting: Setting = ALONE, further: tuple[Force, ...] = ()
    ) -> Loads:
        """The loads as the library has them, as for `forces_of`."""
        self.check(motion)
        loads = self.by_key
        loads["forces"] = (*loads["forces"], *further)
        friction = (*loads.pop("pin_friction"), *loads.pop("slide_friction"))
        loads["springs"] = (*loads["springs"], *loads.pop("gas_springs"), *loads.pop("torsion_springs"))
        masses = {**part_masses, **self.given_masses}
        if not masses and not any(loads.values()):
            problem = "no body has a mass, and nothing else acts"
            raise DesignError("loads", problem, 'give material = "steel-S235" in [stock], or masses', "missing-key")
        return Loads(self.gravity_in(setting), masses, friction=friction, **loads)


def loads_entry() -> Any:
    """Field for the loads."""
    return entry(
        "masses, gravity, forces, springs and friction; the table then has the driver effort and the joint forces",
        default=None,
    )
