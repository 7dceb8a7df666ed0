"""What a machine and an editor ask of a recipe besides its results."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import ClassVar, Self

from ..core.errors import DesignError, shown
from ..model.check import Check
from ..model.motor import RotatingBody
from ..model.scene import Scene, SceneBody, SceneHandle
from ..plane.vec import Complex, Real
from .aspect import ALONE, Setting, Standing


def layer_heights(bodies: Iterable[SceneBody]) -> dict[int, float]:
    """Thickness of each layer, mm; a layer of spacers is as thick as the thickest."""
    heights: dict[int, float] = {}
    for body in bodies:
        for part in (None, *body.parts):
            heights[body.layer] = max(part.thickness if part else 0.0, heights.get(body.layer, 0.0))
    most = max(heights.values(), default=0.0)
    return {k: heights.get(k) or most for k in range(min(heights, default=0), max(heights, default=-1) + 1)}


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

    def shaking_at(self, turn: Real) -> tuple[Complex, Real] | None:
        """Force, N, and moment about the driver's axis, N mm, by which its masses shake its frame; None if unknown.

        At rotations as in `scene_at`, in its own frame.
        """
        return None

    @property
    def standing_point(self) -> str:
        """The point of its recipe on which it stands by the forces that carry its weight; empty if it is no walker."""
        return ""

    def number_of_feet(self, foot: str) -> int:
        """Of the mechanism and its copies; DesignError if this point cannot be a foot that carries weight."""
        problem, remedy = f"found {shown(foot)}, but no recipe of a linkage", "omit it, or let a linkage stand"
        raise DesignError("foot", problem, remedy, "conflict")

    def standing_at(self, turn: Real, foot: str, speed: float) -> Standing:
        """Its feet and its masses at rotations as in `scene_at`.

        foot: name of the point that stands; empty if it is only carried. speed: of its driver, in its own direction,
        rad/s. By default screws and shafts do not count.
        """
        scene = self.scene_at(turn)
        heights = layer_heights(scene.bodies)
        faces = {layer: sum(h for k, h in heights.items() if k < layer) for layer in heights}
        masses = (
            (float(part.mass.mass), body.origin + body.direction * part.mass.centre,
             faces[body.layer] + heights[body.layer] / 2)
            for body in scene.bodies
            for part in body.parts
            if part.mass is not None
        )  # fmt: skip
        return Standing((), tuple(masses), (), sum(heights.values()))

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
