"""Recipes of linkages: the motion of every body, the plates, and how they are stacked."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from functools import cached_property, partial
from typing import ClassVar

import numpy as np

from ...core.errors import DesignError
from ...core.fields import entry, to_digits
from ...core.records import record
from ...making.fasteners import gathered
from ...making.materials import MATERIALS
from ...making.motors import MOTORS
from ...model.check import Check
from ...model.mass import Mass
from ...model.motor import Motor
from ...model.part import Bought, Part
from ...model.rotating import RotatingBody
from ...model.scene import Limit, Scene, SceneHandle
from ...model.table import Table
from ...plane.vec import Real
from ...recipe.recipe import part_masses
from ...recipe.settings import Files, Stroke, Turn
from ..checks import LEAST_TRANSMISSION_ANGLE_DEG, collision_check, hole_check, linkage_checks
from ..drive_limits import driver_limits
from ..linkage import AbstractLinkage
from ..measures import steady_bodies, transmission_extreme
from ..motion import Motion, motion_table
from ..parts.frame import frame_places, with_frame
from ..parts.stack import MOTOR_PLATE, Stack, fastener_masses, link_parts
from ..parts.stock import LinkStock
from ..parts.strength import linkage_strength_checks
from ..scene import linkage_scene, motion_plots
from ..scene_sizes import size_columns, size_plot
from ..solve.branch import Branch
from .copies import (
    Copied,
    Copy,
    Shared,
    check_copies,
    copied,
    copies_entry,
    copying,
    counted,
    driven_check,
    is_whole_turn,
    joint_bills,
    shared_rods,
    with_copies,
    without_motor,
)
from .counterweights import BalancedPlates, balanced_plates, stack_with_ends
from .dwell_bands import DwellBand
from .loaded import LoadedLinkage
from .loads import LoadsTable, loads_entry, number_of_columns
from .moved import (
    AbstractMovedRecipe,
    Branches,
    SideOrFollow,
    both_modes_entry,
    branch_entry,
    branches_entry,
    coefficients_entry,
)
from .stance import UNKNOWN_STANCE, Stance, check_foot, stance_of
from .tolerances import NUMBER_OF_COLUMNS, OutputDeviation, TolerancesTable, tolerances_entry


class AbstractLinkageRecipe(AbstractMovedRecipe):
    """Base class of recipes whose linkage is moved, checked, stacked and cut."""

    stock: LinkStock
    # Defaults for kinds without these keys.
    coefficients: bool = False
    both_modes: bool = False
    dwell: DwellBand | None = None
    copies: tuple[Copy, ...] = ()
    foot: str | None = None
    loads: LoadsTable | None = None
    tolerances: TolerancesTable | None = None

    def __post_init__(self) -> None:
        self.check_stroke()
        check_copies(self.copies, self.linkage, self.input_range)
        check_foot(self.foot, self.linkage.linkage, 1 + len(self.copies))
        # Upper limit of the columns of the bodies, the slides and the points that are not pins.
        linkage = self.linkage.linkage
        points = sum(len(names) for names in linkage.bodies.values()) - sum(map(len, linkage.pins.values()))
        joints = len(linkage.pins)
        columns_each = np.array([4, 5, 6]) + self.coefficients * np.array([2, 2, 4])
        columns = 3 + int(columns_each @ [len(linkage.bodies), len(linkage.sliders), points]) + joints
        columns = columns * (2 if self.both_modes else 1) + (number_of_columns(linkage) if self.loads else 0)
        columns += NUMBER_OF_COLUMNS if self.tolerances else 0
        self.input_range.check_rows(columns)
        if self.dwell:
            self.dwell.body(linkage)
        if self.both_modes and self.other is None:
            problem = "found true, but there is no other mode: it cannot be assembled, or there are more than two dyads"
            raise DesignError("both_modes", problem, "omit it", "conflict")
        if self.loads:
            self.loads.check(self.moved(self.input_range.frames[:1], self.signs))
            if self.loads.counterweights:
                self.loads.counterweights.check(linkage, self.stock, self.loads.masses)
            if self.loads.run:
                friction, copies = self.loads.has_dry_friction, bool(self.copies)
                self.loads.run.check(linkage, self.input_range, self.given_motor, friction, copies)
        if self.tolerances:
            self.tolerances.analysis(self.moved(self.input_range.frames[:1], self.signs), self.stock.clearance)

    @cached_property
    def output_deviation(self) -> OutputDeviation | None:
        """Deviation of an output by tolerances; None without them."""
        if self.tolerances is None:
            return None
        return OutputDeviation(self.tolerances, self.tolerances.analysis(self.motion, self.stock.clearance))

    @cached_property
    def loaded(self) -> LoadedLinkage | None:
        """The linkage and its copies under the loads; None without loads."""
        if self.loads is None:
            return None
        masses = self.body_masses if self.stock.material else {}
        on_plate = self.stock.motor is not None
        return LoadedLinkage(
            self.loads, self.motion, masses, self._copies_of, self.given_motor, on_plate, self.balanced
        )

    def _copies_of(self, motion: Motion) -> tuple[Copied, ...]:
        return tuple(copied(self.copies, motion, self.linkage, self.signs)) if self.copies else ()

    @property
    def given_motor(self) -> Motor | None:
        """The motor of the loads, or the mounted one."""
        return (self.loads and self.loads.motor) or MOTORS.get(str(self.stock.motor))

    @cached_property
    def balanced(self) -> BalancedPlates | None:
        """Plates with counterweights; None if none are requested."""
        if self.loads is None or self.loads.counterweights is None:
            return None
        forces_of = partial(self.loads.forces_of, self.motion)
        return balanced_plates(self.loads.counterweights, forces_of, self.fine_motion, self.stock)

    def _stacked(self, stock: LinkStock) -> Stack:
        """The plates with their counterweights in layers."""
        return stack_with_ends(self.fine_motion, stock, self.balanced.ends if self.balanced else {})

    @property
    def further_handles(self) -> Iterator[SceneHandle]:
        """The ends of the stroke, and the places of the loads."""
        yield from super().further_handles
        if self.loads is not None:
            yield from self.loads.handles(self.motion)

    @property
    def motor(self) -> Motor | None:
        """The motor that drives linkage and copies against the loads: given, or the smallest that suffices."""
        return self.loaded.motor if self.loaded else None

    @cached_property
    def fine_motion(self) -> Motion:
        """The motion in steps so small that no collision of plates is missed."""
        return self.moved(self.input_range.collision_samples, self.signs)

    @cached_property
    def _unframed(self) -> tuple[Stack, Stack]:
        """The stacks of the first linkage and of a copy, without the frame of a walker."""
        own = self._stacked(self.stock)
        return own, own if self.stock.motor is None else self._stacked(self.copy_stock)

    @cached_property
    def frame(self) -> tuple[complex, ...]:
        """Places of the rods that join the grounds of a walker, mm; empty without a foot, or if they are not known."""
        if self.foot is None or any(not rod.pin for rod in self.shared):
            return ()
        return frame_places(self.fine_motion, self.stock, self._unframed[0].plates)

    @cached_property
    def stack(self) -> Stack:
        """The plates in layers."""
        return with_frame(self._unframed[0], self.linkage.linkage.ground, self.frame)

    @cached_property
    def copy_stack(self) -> Stack:
        """The plates of a copy in layers; the motor is in the first linkage only."""
        if self.stock.motor is None:
            return self.stack
        return without_motor(with_frame(self._unframed[1], self.linkage.linkage.ground, self.frame), self.stack)

    @property
    def copy_stock(self) -> LinkStock:
        """Sheet and pins of a copy."""
        if self.stock.motor is None:
            return self.stock
        return dataclasses.replace(self.stock, motor=None, fit="running")

    @property
    def _stacks(self) -> tuple[Stack, ...]:
        """Those of the first linkage and of its copies."""
        return (self.stack, *(self.copy_stack for _ in self.copies))

    @cached_property
    def shared(self) -> tuple[Shared, ...]:
        """The rods by which neighbouring copies drive each other."""
        stacks = (self._unframed[0], *(self._unframed[1] for _ in self.copies))
        return tuple(shared_rods(self.copies, self.linkage, stacks, self.stock.thickness))

    @cached_property
    def moving_copies(self) -> tuple[Copied, ...]:
        """The motion of each copy."""
        return self._copies_of(self.motion)

    @cached_property
    def stance(self) -> Stance | None:
        """How a walker stands on its feet; None without feet, or if the distances of the copies are unknown."""
        if self.foot is None:
            return None
        return stance_of(self.foot, self.motion, self._copies_of, self.shared, self._stacks, self.stock.thickness)

    @property
    def bought(self) -> tuple[Bought, ...]:
        return gathered(joint_bills(self._stacks, self.shared, self.stock.thickness))

    @property
    def shaft_items(self) -> tuple[Bought, ...]:
        motors = {stack.letters[pin.name] for stack in self._stacks for pin in stack.pins if pin.motor}
        bills = joint_bills(self._stacks, self.shared, self.stock.thickness)
        return tuple(Bought(name, n, (joint,)) for joint, bill in bills if joint not in motors for name, n in bill)

    @property
    def steps(self) -> tuple[str, ...]:
        if not self.copies:
            return self.stack.steps
        return copying(self.copies, self.shared, self._stacks, self.stock.thickness)

    @cached_property
    def table(self) -> Table:
        table = motion_table(self.motion, self.coefficients)
        if self.loaded:
            table = Table((*table.columns, *self.loaded.columns))
        if self.output_deviation:
            table = Table((*table.columns, *self.output_deviation.columns(table)))
        if not (self.both_modes and self.other):
            return table
        # Both modes have the same columns of driver and time.
        others = motion_table(self.other[1], self.coefficients).columns[2:]
        words = "in the other mode, "
        renamed = (dataclasses.replace(c, id=f"other_{c.id}", meaning=words + c.meaning) for c in others)
        return Table((*table.columns, *renamed))

    @cached_property
    def scene(self) -> Scene:
        """The moving plates; also the other assembly mode, if there is one."""
        least = LEAST_TRANSMISSION_ANGLE_DEG
        limit = Limit("transmission_angle", least, f"at least {least:g} deg")
        plots = motion_plots(self.motion, self.table, [limit])
        if self.loaded:
            plots = (*self.loaded.plots, *plots)
        if self.output_deviation:
            plots = (*self.output_deviation.plots(self.table), *plots)
        # Only the page shows them, no file of numbers.
        effects = size_columns(self.motion)
        table, plots = Table((*self.table.columns, *effects)), (*plots, *size_plot(effects))
        layers = {MOTOR_PLATE: -1, **self.stack.layers}
        scene = linkage_scene(self.motion, table, self.own_parts, layers, plots, self._others())
        if self.loaded:
            marks = (*scene.marks, *self.loaded.marks)
            scene = dataclasses.replace(scene, marks=marks, hodographs=self.loaded.hodographs)
        if self.output_deviation:
            scene = dataclasses.replace(scene, regions=self.output_deviation.regions())
        if not self.copies:
            return scene
        return self._with_copies(scene, self.moving_copies)

    def _with_copies(self, scene: Scene, copies: tuple[Copied, ...]) -> Scene:
        lowest = 1 + max(self.stack.layers.values())
        return with_copies(scene, copies, self.copy_parts, self.copy_stack.layers, lowest)

    @cached_property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        pivot = self.linkage.linkage.driver_pivot if is_whole_turn(self.input_range) else None
        return steady_bodies(self.motion) if pivot and self.motion.assembled.all() else {}

    def scene_at(self, turn: Real) -> Scene:
        motion, rows = self.moved_at(turn)
        scene = linkage_scene(motion, motion_table(motion), self.own_parts, self.stack.layers, rates=False)
        if self.copies:
            scene = self._with_copies(scene, self._copies_of(motion))
        return scene.at_frames(rows)

    def torque_at(self, turn: Real) -> Real | None:
        """Between frames by linear interpolation."""
        if self.loaded is None:
            return None
        drive = self.motion.drive
        torque: Real = np.interp(drive[0] + turn, drive, self.loaded.effort, period=2 * np.pi)
        return torque

    def _others(self) -> dict[str, Scene]:
        """The same plates in the other assembly mode."""
        if self.other is None:
            return {}
        joint, motion = self.other
        # The slots of a ground are for the requested mode only.
        slotted = self.motion.linkage.ground if self.motion.linkage.sliders else ""
        parts = [part for part in self.own_parts if not slotted or part.body != slotted]
        # Plots are those of the requested mode, or of both.
        table = Table(self.table.columns[:2])
        return {f"{joint} on its other side": linkage_scene(motion, table, parts, self.stack.layers, rates=False)}

    @property
    def motion_checks(self) -> tuple[Check, ...]:
        return (*linkage_checks(self.motion), *self.input_range.checks)

    @property
    def design_checks(self) -> tuple[Check, ...]:
        advice = "summary.json names them under stack; give narrower bars or other lengths"
        return (
            *linkage_checks(self.motion),
            hole_check(self.stock.hole_diameter, self.stock.thickness),
            collision_check(sum(len(stack.collisions) for stack in dict.fromkeys(self._stacks)), advice),
            *((driven_check(self.shared),) if self.copies and self.stock.motor else ()),
            *(self.stance.checks if self.stance else ()),
            *(self.output_deviation.checks if self.output_deviation else ()),
            *self.input_range.checks,
            *self._load_checks(),
        )

    def _load_checks(self) -> tuple[Check, ...]:
        """Checks of the motor, and of pins and plates if the material is known; none without loads."""
        if self.loaded is None:
            return ()
        holds = linkage_strength_checks(self.loaded.analysis, self.stock, self.stack) if self.stock.material else ()
        return (*self.loaded.checks, *holds)

    @cached_property
    def own_parts(self) -> tuple[Part, ...]:
        """The parts of the first linkage."""
        return link_parts(self.fine_motion, self.stock, self.stack)

    @cached_property
    def copy_parts(self) -> tuple[Part, ...]:
        """The parts of a copy."""
        if self.stock.motor is None:
            return self.own_parts
        own = {part.name: part for part in self.own_parts}
        parts = link_parts(self.fine_motion, self.copy_stock, self.copy_stack)
        return tuple(dataclasses.replace(own.get(part.name, part), count=part.count) for part in parts)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        return counted(self.own_parts, self.copy_parts, len(self.copies)) if self.copies else self.own_parts

    @cached_property
    def body_masses(self) -> Mapping[str, Mass]:
        """Mass of each body, with its screws or rods; of one linkage if there are copies."""
        bodies = part_masses(self.own_parts)
        if bodies:
            for body, mass in fastener_masses(self.fine_motion, self.stock, self.stack).items():
                bodies[body] = bodies[body] + mass if body in bodies else mass
        return bodies

    @property
    def remarks(self) -> tuple[str, ...]:
        stance = tuple(self.stance.remarks) if self.stance else (UNKNOWN_STANCE,) if self.foot else ()
        return (*((self.output_deviation.remark,) if self.output_deviation else ()), *stance)

    @property
    def forces_missing(self) -> str:
        if self.loads is not None:
            return ""
        takes_loads = "loads" in self.__dataclass_fields__
        words = "Driver effort and joint forces are computed with the table loads."
        return words if takes_loads else super().forces_missing

    @property
    def notes(self) -> Mapping[str, object]:
        """Summary: range of the driver, links that turn fully, and the stack of plates."""
        stack = self.stack.summary()
        dwell = {"dwell": self.dwell.found(self.motion)} if self.dwell else {}
        tolerances = self.output_deviation.summary if self.output_deviation else {}
        loads = {"loads": self.loaded.summary} if self.loaded else {}
        if self.copies:
            stack |= {"bought": [item.data for item in self.bought], "steps": list(self.steps)}
            if self.stock.motor:
                stack["copy"] = self.copy_stack.summary()
        return {
            **self._reached(self.signs),
            **self.turning,
            **self._other_mode(),
            **dwell,
            **loads,
            **tolerances,
            **({"stance": self.stance.summary} if self.stance else {}),
            **self.mass_summary,
            "stack": stack,
        }

    def _reached(self, branch: Branch) -> Mapping[str, object]:
        """The ranges of the driver in which the linkage closes."""
        drives, in_deg = self.input_range.collision_samples, isinstance(self.input_range, Turn)
        limits = driver_limits(self.linkage, branch, (float(drives[0]), float(drives[-1])))
        reached = [[to_digits(np.degrees(q) if in_deg else q, 10) for q in part] for part in limits]
        return {f"driver_reaches_{'deg' if in_deg else 'mm'}": reached}

    def _other_mode(self) -> Mapping[str, object]:
        if not (self.both_modes and self.other):
            return {}
        joint, motion = self.other
        angle = {"least_transmission_angle_deg": to_digits(transmission_extreme(motion, -1)[0], 10)}
        return {"other_mode": {"joint": joint, **self._reached(motion.solution.spec), **angle}}

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        copies = {"copies": (Copy(180.0),)} if "copies" in tables else {}
        return {**copies, **({"stock.material": MATERIALS["steel-S235"]} if "loads" in tables else {})}

    @property
    def turning(self) -> Mapping[str, object]:
        """Summary of the links that turn fully, if there is a rule."""
        return {}


@record(kw_only=True)
class TurningLinkageRecipe(AbstractLinkageRecipe):
    """A linkage whose driver turns."""

    kind: str
    linkage: AbstractLinkage
    branch: SideOrFollow = branch_entry()
    branches: Branches = branches_entry()
    coefficients: bool = coefficients_entry()
    both_modes: bool = both_modes_entry()
    dwell: DwellBand | None = entry("longest dwell of an output, for the summary", default=None)
    drive: Turn = entry("how the driver turns", default=Turn())
    loads: LoadsTable | None = loads_entry()
    tolerances: TolerancesTable | None = tolerances_entry()
    copies: tuple[Copy, ...] = copies_entry()
    stock: LinkStock = entry("sheet and pins of the links", default=LinkStock())
    files: Files = entry("what is written", default=Files())


@record(kw_only=True)
class SlidingLinkageRecipe(AbstractLinkageRecipe):
    """A linkage whose driver turns or slides."""

    # The order of the fields is that of templates and summaries.
    kind: str
    linkage: AbstractLinkage
    branch: SideOrFollow = branch_entry()
    branches: Branches = branches_entry()
    coefficients: bool = coefficients_entry()
    both_modes: bool = both_modes_entry()
    dwell: DwellBand | None = entry("longest dwell of an output, for the summary", default=None)
    drive: Turn = entry("how the driver turns", default=Turn())
    stroke: Stroke | None = entry("how the driver slides, if a slide drives", default=None)
    loads: LoadsTable | None = loads_entry()
    tolerances: TolerancesTable | None = tolerances_entry()
    stock: LinkStock = entry("sheet and pins of the links", default=LinkStock())
    files: Files = entry("what is written", default=Files())

    # Values of the example in which a slide drives.
    sliding: ClassVar[Mapping[str, object]]

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        # A sliding driver has no shaft that copies could share.
        none = {"copies": ()} if "copies" in tables else {}
        values = super().example_values(tables)
        return {**values, **none, **cls.sliding} if "stroke" in tables else values
