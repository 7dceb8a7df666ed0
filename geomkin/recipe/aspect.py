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
from ..plane.vec import Complex, Pose, Real, Whole

M = TypeVar("M")
T = TypeVar("T")


@record(eq=False)
class FootForces:
    """The forces of the ground on the feet of a mechanism and of its copies, each in its own frame, over a turn.

    point: that stands. drives, forces: for each foot the positions of the driver of its leg, rad, and the forces, N;
    empty if the walker falls over.
    """

    point: str
    drives: tuple[Real, ...] = ()
    forces: tuple[Complex, ...] = ()


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
    feet : FootForces, optional
        The forces of the ground on its feet, if it is a leg of a machine that walks.

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
    feet: FootForces | None = None

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
class Foot:
    """A foot at rotations of the driver of its mechanism.

    drive: of its own leg, rad. position, velocity: of the foot, mm and mm/s. across: its place along the shaft, from
    the lower face of the mechanism, mm. mirrored: whether its leg is turned over.
    """

    drive: Real
    position: Complex
    velocity: Complex
    across: float
    mirrored: bool = False


@record(eq=False)
class Standing:
    """What stands, and what is carried, at rotations of the driver of a mechanism.

    feet: on which it stands. masses: for each the mass, kg, the position of its centre, mm, (frames,) or (), and its
    place along the shaft, mm. pivots: positions of the fixed pivots, mm. height: along the shaft, mm; nan if unknown.
    """

    feet: tuple[Foot, ...]
    masses: tuple[tuple[float, Complex, float], ...]
    pivots: tuple[complex, ...]
    height: float

    def at_frames(self, rows: Whole | slice) -> Standing:
        """The same at some of its frames."""
        feet = (
            replace(foot, drive=foot.drive[rows], position=foot.position[rows], velocity=foot.velocity[rows])
            for foot in self.feet
        )
        masses = ((mass, place[rows], across) for mass, place, across in self.masses)
        return Standing(tuple(feet), tuple(masses), self.pivots, self.height)

    def placed(self, placement: ShaftPlacement, is_reversed: bool, face: float) -> Standing:
        """The same in its place in a machine, in the frame of this. face: the lower one of the mechanism, mm."""

        def height(across: float) -> float:
            return face + (self.height - across if is_reversed else across)

        feet = (
            Foot(foot.drive, placement.place(foot.position), placement.vector(foot.velocity), height(foot.across),
                 foot.mirrored != placement.mirrored)
            for foot in self.feet
        )  # fmt: skip
        masses = ((mass, placement.place(place), height(across)) for mass, place, across in self.masses)
        pivots = (complex(placement.place(place)) for place in self.pivots)
        return Standing(tuple(feet), tuple(masses), tuple(pivots), self.height)


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
