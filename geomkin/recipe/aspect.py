"""What is asked of a mechanism besides its motion and parts, and the setting in which it is placed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import ClassVar, Generic, TypeVar

import numpy as np

from ..core.records import record
from ..model.check import Check
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
