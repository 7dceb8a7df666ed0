"""What a machine and an editor ask of a recipe besides its results."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Self

from ..model.check import Check
from ..model.motor import RotatingBody
from ..model.scene import Scene, SceneHandle
from ..plane.vec import Complex, Real
from .aspect import ALONE, Setting


class AbstractPlaced:
    """What a machine asks of a mechanism that it places on a shaft."""

    # Where and how fast it runs; a machine places it elsewhere, see `in_setting`.
    setting: Setting = ALONE
    # Whether its loads count the torques of its setting.
    carries_torques: ClassVar[bool] = False
    # Every subclass is a dataclass, which a type checker cannot know.
    __dataclass_fields__: ClassVar[dict[str, dataclasses.Field[object]]]

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        """Bodies that turn in a constant ratio to the driver, by name, the driver first.

        By these a machine joins the mechanism to others; empty if it cannot be part of a machine.
        """
        return {}

    def scene_at(self, turn: Real) -> Scene:
        """The scene at rotations of the driver from its first position, rad, (frames,), of any size and order.

        A kind with `rotating_bodies` has it. The table holds positions and angles; the time is that of a machine.
        """
        raise NotImplementedError

    def torque_at(self, turn: Real) -> Real | None:
        """Torque on the driver under the loads, N mm, at rotations as in `scene_at`; None without loads.

        Positive in the direction in which the rotations count.
        """
        return None

    @property
    def depends_on_setting(self) -> bool:
        """Whether what a machine shows of it changes with the setting, as what aspects add does."""
        return False

    def in_setting(self, setting: Setting) -> Self:
        """The same recipe where it is placed; all its results are then those of this speed and position."""
        if not self.depends_on_setting or setting == self.setting:
            return self
        kept = {*(field.name for field in dataclasses.fields(self)), "name", "loaded_table"}
        other = object.__new__(type(self))
        vars(other).update({key: value for key, value in vars(self).items() if key in kept}, setting=setting)
        return other


class AbstractEdited(ABC):
    """What an editor shows and drags."""

    @property
    @abstractmethod
    def design_checks(self) -> tuple[Check, ...]:
        """Checks of the mechanism, without those of the walls of its parts."""

    @property
    def motion_checks(self) -> tuple[Check, ...]:
        """Checks that an editor shows during a drag: `design_checks`, without those of plates if they take long."""
        return self.design_checks

    @property
    def quantities(self) -> Mapping[str, str]:
        """Lengths, types and ranges that an editor shows next to the scene and the checks, by label."""
        return {}

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        """Handles that a user can drag in an editor. An editor computes them again at each step of a drag."""
        return ()

    def preview(self, has_rates: bool = True) -> Mapping[str, object] | None:
        """What an editor needs to move the mechanism until the exact answer comes; None if it only waits.

        has_rates: whether to include how the sizes place what moves.
        """
        return None

    def handle_position(self, id: str) -> Complex:
        """Positions of one of the `handles` at the frames."""
        return next(handle.at for handle in self.handles if handle.id == id)
