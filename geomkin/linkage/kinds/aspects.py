"""The base class of aspects of linkages, and the short ones: dwell, other assembly mode, copies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Generic, TypeVar

from ...core.errors import DesignError
from ...core.fields import to_digits
from ...core.records import record
from ...model.check import Check
from ...model.scene import Scene
from ...model.table import Column, Table
from ...recipe.aspect import AbstractAspect
from ..measures import transmission_extreme
from ..motion import Motion
from ..parts.counterweight_plates import RoundEnd
from ..parts.flywheel import Flywheel
from ..scene import linkage_scene
from .copies import Copy, check_copies, driven_check, with_copies
from .dwell_bands import DwellBand
from .made import MadeLinkage

T = TypeVar("T")


@record(eq=False)
class AbstractLinkageAspect(AbstractAspect[MadeLinkage, T], Generic[T]):
    """Base class of aspects of linkages."""

    @property
    def round_ends(self) -> Mapping[str, RoundEnd]:
        """Counterweights of the plates of bodies."""
        return {}

    @property
    def flywheel(self) -> Flywheel | None:
        """The flywheel on the driver."""
        return None

    def with_bodies(self, scene: Scene, motion: Motion) -> Scene:
        """The scene of a motion with the bodies that this aspect adds."""
        return scene


@record(eq=False)
class DwellAspect(AbstractLinkageAspect[DwellBand]):
    """The longest dwell of an output."""

    key = "dwell"

    def check(self) -> None:
        self.given.body(self.mechanism.linkage.linkage)

    @property
    def entries(self) -> Mapping[str, object]:
        return {"dwell": self.given.found(self.mechanism.motion)}


@record(eq=False)
class BothModesAspect(AbstractLinkageAspect[bool]):
    """The other assembly mode."""

    key = "both_modes"

    @property
    def most_columns(self) -> int:
        return self.mechanism.most_columns

    def check(self) -> None:
        if self.mechanism.other is None:
            problem = "found true, but there is no other mode: it cannot be assembled, or there are more than two dyads"
            raise DesignError("both_modes", problem, "omit it", "conflict")

    @property
    def other(self) -> tuple[str, Motion]:
        """The joint on its other side, and the motion."""
        assert self.mechanism.other is not None
        return self.mechanism.other

    def columns(self, table: Table) -> Iterator[Column]:
        # Both modes have the same columns of driver and time.
        for column in self.mechanism.table_of(self.other[1]).columns[2:]:
            yield replace(column, id=f"other_{column.id}", meaning=f"in the other mode, {column.meaning}")

    @property
    def entries(self) -> Mapping[str, object]:
        joint, motion = self.other
        angle = {"least_transmission_angle_deg": to_digits(transmission_extreme(motion, -1)[0], 10)}
        return {"other_mode": {"joint": joint, **self.mechanism.reaches(motion.solution.spec), **angle}}


@record(eq=False)
class CopiesAspect(AbstractLinkageAspect[tuple[Copy, ...]]):
    """Copies on the same shaft."""

    key = "copies"

    def check(self) -> None:
        check_copies(self.given, self.mechanism.linkage, self.mechanism.input_range)

    def with_bodies(self, scene: Scene, motion: Motion) -> Scene:
        made = self.mechanism
        copies = made.moving_copies if motion is made.motion else made.copies_of(motion)
        lowest = 1 + max(made.stack.layers.values())
        return with_copies(scene, copies, made.copy_parts, made.copy_stack.layers, lowest)

    def on_scene(self, scene: Scene) -> Scene:
        return self.with_bodies(scene, self.mechanism.motion)

    @property
    def checks(self) -> Iterator[Check]:
        if self.mechanism.stock.motor:
            yield driven_check(self.mechanism.shared)


def other_mode_scene(made: MadeLinkage) -> dict[str, Scene]:
    """The plates in the other assembly mode, by its name; empty if it is open."""
    if made.other is None:
        return {}
    joint, motion = made.other
    # The slots of a ground are for the requested mode only.
    slotted = made.motion.linkage.ground if made.motion.linkage.slides else ""
    parts = [part for part in made.own_parts if not slotted or part.body != slotted]
    # Plots are those of the requested mode, or of both.
    table = Table(made.table_of(made.motion).columns[:2])
    return {f"{joint} on its other side": linkage_scene(motion, table, parts, made.stack.layers, rates=False)}
