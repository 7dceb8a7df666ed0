"""Aspects, the setting in which a mechanism is placed, and what a machine and an editor ask of a recipe."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import ClassVar, Generic, Self, TypeVar

import numpy as np

from ..core.records import record
from ..model.check import Check
from ..model.motor import RotatingBody
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneHandle
from ..model.table import Column, Table
from ..plane.curve import AbstractCurve, Mirrored, Moved
from ..plane.vec import Complex, Pose, Real

M = TypeVar("M")
T = TypeVar("T")


@record
class Setting:
    """How a mechanism is placed: by default alone, at the origin, as its own recipe drives it.

    Parameters
    ----------
    speed, acceleration : float, optional
        Of its driver, in the direction in which its recipe counts, rad/s and rad/s2 (mm/s and mm/s2 for a slide); by
        default those of the recipe.
    direction : complex
        Direction of its x axis in the world, a unit complex number.
    mirrored : bool
        Whether it is turned over, left for right.
    torques : tuple of (str, float)
        Bodies that turn other mechanisms, and the largest torque that these take, N mm.

    Examples
    --------
    >>> Setting(direction=1j).of_world(-9.81j)
    (-9.81+0j)
    """

    speed: float | None = None
    acceleration: float | None = None
    direction: complex = 1 + 0j
    mirrored: bool = False
    torques: tuple[tuple[str, float], ...] = ()

    def of_world(self, vector: complex) -> complex:
        """A vector of the world, such as gravity, in the frame of the mechanism."""
        turned = vector * self.direction.conjugate()
        return -turned.conjugate() if self.mirrored else turned

    def torque_on(self, body: str) -> float:
        """Largest torque that other mechanisms take from a body, N mm."""
        return dict(self.torques).get(body, 0.0)

    @property
    def turned_over(self) -> Setting:
        """The setting of a copy that is turned over, left for right, in this one."""
        return replace(self, mirrored=not self.mirrored)


# Of a recipe that is placed by nothing.
ALONE = Setting()


@record(eq=False)
class ShaftPlacement:
    """Where a copy, or a mechanism of a machine, lies on a shaft: turned over or not, then moved by a pose.

    pose: of its frame, mm. mirrored: whether it is first turned over about its y axis, left for right.
    """

    pose: Pose = Pose()
    mirrored: bool = False

    def _over(self, z: Complex | complex) -> Complex | complex:
        return -np.conj(z) if self.mirrored else z

    def place(self, z: Complex | complex) -> Complex:
        """Positions in the frame of the mechanism, placed."""
        return self.pose.place(self._over(z))

    def vector(self, vector: Complex | complex) -> Complex:
        """Vectors in the frame of the mechanism, placed."""
        return np.asarray(self.pose.direction * self._over(vector))

    def rotated(self, direction: Complex | complex) -> Complex:
        """Directions of bodies, placed; their parts are those of `part`."""
        return np.asarray(self.pose.direction * (np.conj(direction) if self.mirrored else direction))

    def curve(self, curve: AbstractCurve, of_body: bool = False) -> AbstractCurve:
        """A curve, placed; of_body: in the frame of a body."""
        seen = Mirrored(curve) if self.mirrored else curve
        return seen if of_body else Moved(seen, self.pose)

    def part(self, part: Part) -> Part:
        """A part as it is seen where it is placed."""
        if not self.mirrored:
            return part
        holes, marks = (tuple(map(Mirrored, curves)) for curves in (part.holes, part.marks))
        return replace(part, outline=Mirrored(part.outline), holes=holes, marks=marks)

    def setting(self, speed: float) -> Setting:
        """The setting of a mechanism at a speed of its driver, in its own direction."""
        return Setting(speed, 0.0, complex(np.asarray(self.pose.direction)), self.mirrored)


@record(eq=False)
class AbstractAspect(Generic[M, T]):
    """One key of a recipe, and what it adds to the results of the mechanism; by default nothing.

    A recipe asks its aspects in their order for columns, entries and remarks, and in the reverse order for checks and
    plots, so that the last one stands first.

    Parameters
    ----------
    mechanism : M
        The mechanism in its setting, as the kind of recipe describes it.
    given : T
        The value of the key.
    """

    key: ClassVar[str]

    mechanism: M
    given: T

    @property
    def most_columns(self) -> int:
        """Upper limit of the number of columns, known before anything is computed."""
        return 0

    def check(self) -> None:
        """DesignError with the key that the mechanism cannot have; called when the recipe is read."""

    def columns(self, table: Table) -> Iterator[Column]:
        """Columns that follow those of the mechanism and of the aspects before this one, in `table`."""
        return iter(())

    def plots(self, table: Table) -> Iterator[Plot]:
        """Plots of the columns."""
        return iter(())

    def on_scene(self, scene: Scene) -> Scene:
        """The scene with what this aspect draws."""
        return scene

    @property
    def handles(self) -> Iterator[SceneHandle]:
        """Handles of the values of the key."""
        return iter(())

    @property
    def checks(self) -> Iterator[Check]:
        """Checks of the design."""
        return iter(())

    @property
    def entries(self) -> Mapping[str, object]:
        """Entries of summary.json."""
        return {}

    @property
    def remarks(self) -> Iterator[str]:
        """Sentences on the result for page and terminal."""
        return iter(())

    def torque_at(self, turn: Real) -> Real | None:
        """Torque that this aspect demands of the driver, N mm, at rotations from its first position; None if none."""
        return None


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
