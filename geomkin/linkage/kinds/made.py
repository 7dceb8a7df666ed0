"""A linkage in its setting: its motion over the driver's range, and its plates with those of its copies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cached_property

import numpy as np

from ...core.fields import to_digits
from ...core.records import record
from ...core.units import MM, LengthUnit
from ...making.fasteners import gathered, snap_checks
from ...making.motors import MOTORS
from ...model.check import Check
from ...model.material import Mass
from ...model.motor import Motor
from ...model.part import Bought, Part
from ...model.table import Table
from ...plane.vec import Real, Whole
from ...recipe.aspect import Setting
from ...recipe.settings import Stroke, Turn
from ..drive_limits import driver_limits
from ..instant.polygons import component_columns, number_of_components
from ..linkage import AbstractLinkage
from ..measures import Travel, strokes, swings
from ..motion import Motion, motion_table
from ..moving import move
from ..parts.rotating_masses import Flywheel, RoundEnd
from ..parts.stack import Stack, link_parts
from ..parts.stock import LinkStock
from ..solve.branch import BranchSpec, as_branch_spec
from .copies import (
    Copied,
    Copy,
    Shared,
    copied,
    copying,
    counted,
    frame_places,
    joint_bills,
    shared_rods,
    stacks_for_rods,
    with_frame,
    without_motor,
)
from .load_tables import linkage_masses, stack_with_ends
from .loads import CarriedMass

# Largest number of dyads of a linkage whose other assembly mode is shown.
MOST_DYADS = 2
# Decimals of rad to which angles of the driver count as one.
SAME_ANGLE = 12


def no_flywheel() -> None:
    """None: most linkages have no flywheel."""


@record(eq=False)
class DrivenLinkage:
    """A linkage that moves on a branch over the range of its driver, at the speed of its setting.

    has_coefficients, has_components: whether its tables have kinematic coefficients, and effective components.
    length_unit: in which the recipe is written.
    """

    linkage: AbstractLinkage
    branch: BranchSpec
    input_range: Turn | Stroke
    setting: Setting
    has_coefficients: bool = False
    has_components: bool = False
    length_unit: LengthUnit = MM

    @property
    def speed(self) -> float:
        """Of the driver, rad/s, or mm/s if it slides."""
        return self.input_range.speed if self.setting.speed is None else self.setting.speed

    @property
    def acceleration(self) -> float:
        """Of the driver, rad/s2, or mm/s2 if it slides."""
        given = self.setting.acceleration
        return self.input_range.acceleration if given is None else given

    def moved(self, frames: Real, branch: BranchSpec | None = None) -> Motion:
        """The linkage at some frames; branch: by default its own."""
        return move(self.linkage, frames, branch or self.branch, self.speed, self.acceleration)

    @cached_property
    def motion(self) -> Motion:
        """The linkage at the frames of the table."""
        return self.moved(self.input_range.frames)

    @cached_property
    def swings(self) -> Mapping[str, Travel]:
        """Least and largest direction, deg, of each body that swings about a fixed pin."""
        return swings(self.motion)

    @cached_property
    def strokes(self) -> Mapping[str, Travel]:
        """Least and largest place, mm, of each slide on the ground."""
        return strokes(self.motion)

    @cached_property
    def fine_motion(self) -> Motion:
        """The motion in steps so small that no collision of plates is missed."""
        return self.moved(self.input_range.collision_samples)

    def table_of(self, motion: Motion) -> Table:
        """The table of one of its motions."""
        table = motion_table(motion, self.has_coefficients)
        return Table((*table.columns, *component_columns(motion))) if self.has_components else table

    @property
    def most_columns(self) -> int:
        """Upper limit of the columns of such a table."""
        linkage = self.linkage.linkage
        points = sum(len(names) for names in linkage.bodies.values()) - sum(map(len, linkage.pins.values()))
        columns_each = np.array([4, 5, 6]) + self.has_coefficients * np.array([2, 2, 4])
        columns = 3 + int(columns_each @ [len(linkage.bodies), len(linkage.slides), points]) + len(linkage.pins)
        return columns + (number_of_components(linkage) if self.has_components else 0)

    def reaches(self, branch: BranchSpec) -> Mapping[str, object]:
        """The ranges of the driver in which the linkage closes on a branch, as an entry of summary.json."""
        drives, in_deg = self.input_range.collision_samples, isinstance(self.input_range, Turn)
        limits = driver_limits(self.linkage, branch, (float(drives[0]), float(drives[-1])))
        reached = [[to_digits(np.degrees(q) if in_deg else q, 10) for q in part] for part in limits]
        return {f"driver_reaches_{'deg' if in_deg else 'mm'}": reached}

    def moved_at(self, turn: Real) -> tuple[Motion, Whole]:
        """The motion over one turn of the driver, and its frames at rotations from the first position, rad, (frames,).

        The motion has the recipe's own steps too, so that it stays on its branch.
        """
        first, steps = self.input_range.frames[0], self.input_range.frames - self.input_range.frames[0]
        angles, rows = np.unique(
            np.round(np.abs(np.concatenate([steps, np.remainder(turn, steps[-1])])), SAME_ANGLE), return_inverse=True
        )
        return self.moved(first + np.sign(steps[-1]) * angles), rows[len(steps) :]

    @cached_property
    def other(self) -> tuple[str, Motion] | None:
        """The joint of the last of one or two dyads, and the motion with its other branch; None if that is open."""
        branches = self.motion.branches
        if not 1 <= len(branches) <= MOST_DYADS:
            return None
        joint, sides = list(branches.items())[-1]
        if joint in (slide.name for slide in self.motion.linkage.slides):
            # The other branch is the same lever turned by 180 deg, which would need another slot.
            return None
        # The sign is 0 where both branches meet; a followed branch starts on the first other sign.
        signs, spec = sides[sides != 0], as_branch_spec(self.branch)
        points = {name: place for name, place in spec.branch_points.items() if name != joint}
        opposite = {**spec.branch, joint: -int(signs[0]) if signs.size else -1}
        motion = self.moved(self.input_range.frames, replace(spec, branch=opposite, branch_points=points))
        return (joint, motion) if motion.assembled.any() else None


@record(eq=False)
class MadeLinkage(DrivenLinkage):
    """A linkage with its copies as plates in layers.

    stock: sheet and pins. foot: the point on which it walks; rods then join the grounds of its copies. round_ends: the
    counterweights of bodies, which may depend on the plates without them. flywheel: likewise. given_masses: of bodies,
    instead of those of their parts. carried: on the frame of a walker.
    """

    stock: LinkStock = LinkStock()
    copies: tuple[Copy, ...] = ()
    foot: str | None = None
    round_ends: Callable[[], Mapping[str, RoundEnd]] = dict
    flywheel: Callable[[], Flywheel | None] = no_flywheel
    given_masses: Mapping[str, Mass] = field(default_factory=dict)
    carried: tuple[CarriedMass, ...] = ()

    @property
    def mounted_motor(self) -> Motor | None:
        """The motor for which a plate has holes."""
        return MOTORS.get(str(self.stock.motor))

    @cached_property
    def _unframed(self) -> tuple[Stack, Stack]:
        """The stacks of the first linkage and of a copy, without the frame of a walker."""
        ends = self.round_ends()

        def stacks(open_pin: str) -> tuple[Stack, Stack]:
            own = stack_with_ends(self.fine_motion, self.stock, ends, self.flywheel(), open_pin)
            if self.stock.motor is None:
                return own, own
            return own, stack_with_ends(self.fine_motion, self.copy_stock, ends, open_pin=open_pin)

        return stacks_for_rods(self.copies, self.linkage, stacks)

    @cached_property
    def frame(self) -> tuple[complex, ...]:
        """Places of the rods that join the grounds of a walker, mm; empty without feet, or if they are not known."""
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
        return self.stock if self.stock.motor is None else replace(self.stock, motor=None, fit="running")

    @property
    def stacks(self) -> tuple[Stack, ...]:
        """Those of the first linkage and of its copies."""
        return (self.stack, *(self.copy_stack for _ in self.copies))

    @cached_property
    def shared(self) -> tuple[Shared, ...]:
        """The rods by which neighbouring copies drive each other."""
        return shared_rods(self.copies, self.linkage, self._unframed, self.stock.thickness)

    def copies_of(self, motion: Motion) -> tuple[Copied, ...]:
        """The motion of each copy; motion: of the first linkage, over one turn."""
        return tuple(copied(self.copies, motion, self.linkage, self.branch)) if self.copies else ()

    @cached_property
    def moving_copies(self) -> tuple[Copied, ...]:
        """The motion of each copy at the frames of the table."""
        return self.copies_of(self.motion)

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
        return tuple(replace(own.get(part.name, part), count=part.count) for part in parts)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The parts of the linkage and its copies, equal ones once."""
        return counted(self.own_parts, self.copy_parts, len(self.copies)) if self.copies else self.own_parts

    @cached_property
    def masses(self) -> Mapping[str, Mass]:
        """Mass of each body, with its screws or rods, of one linkage; empty without a material."""
        return linkage_masses(self.own_parts, self.fine_motion, self.stock, self.stack)

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Screws, rods, tubes, glue and attachments."""
        attached = [(item.body, item.bill(self.stock.thickness)) for item in self.stock.attachments]
        return gathered([*joint_bills(self.stacks, self.shared, self.stock.thickness), *len(self.stacks) * attached])

    @property
    def snap_checks(self) -> tuple[Check, ...]:
        """Checks of printed pins."""
        return snap_checks(self.stack.snap_pins)

    @property
    def shaft_items(self) -> tuple[Bought, ...]:
        """Items of `bought` that a shaft through their joint replaces, each for one joint of the first linkage."""
        stack, rod = self.stack, self.shared[0].pin if self.shared else ""
        bills = ((stack.letters[pin.name], stack.bill(pin)) for pin in stack.pins if not pin.motor and pin.name != rod)
        return tuple(Bought(name, count, (joint,)) for joint, bill in bills for name, count in bill)

    @property
    def steps(self) -> tuple[str, ...]:
        """Attachments, then assembly steps from the bottom up."""
        attached = tuple(item.step(item.body) for item in self.stock.attachments)
        if not self.copies:
            return (*attached, *self.stack.steps)
        return (*attached, *copying(self.copies, self.shared, self.stacks, self.stock.thickness))

    @property
    def stack_summary(self) -> dict[str, object]:
        """Layers, items to buy and assembly steps, as an entry of summary.json."""
        entry = dict(self.stack.summary())
        if self.copies or self.stock.attachments:
            entry |= {"bought": [item.data for item in self.bought], "steps": list(self.steps)}
        if self.copies and self.stock.motor:
            entry["copy"] = self.copy_stack.summary()
        return entry
