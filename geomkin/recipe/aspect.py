"""What is asked of a mechanism besides motion and parts: aspects, and its setting and place in a machine."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import ClassVar, Generic, Self, TypeVar

import numpy as np

from ..core.errors import DesignError, shown
from ..core.records import record
from ..model.check import Check
from ..model.motor import RotatingBody
from ..model.part import Part
from ..model.scene import Plot, Scene, SceneBody, SceneHandle
from ..model.table import Column, Table
from ..plane.curve import AbstractCurve
from ..plane.primitives import mirrored, moved
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
        seen = mirrored(curve) if self.mirrored else curve
        return seen if of_body else moved(seen, self.pose)

    def part(self, part: Part) -> Part:
        """A part as it is seen where it is placed."""
        if not self.mirrored:
            return part
        holes, marks = (tuple(map(mirrored, curves)) for curves in (part.holes, part.marks))
        return replace(part, outline=mirrored(part.outline), holes=holes, marks=marks)

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
    def quantities(self) -> Mapping[str, str]:
        """Results that an editor shows next to the checks, by label."""
        return {}

    @property
    def remarks(self) -> Iterator[str]:
        """Sentences on the result for page and terminal."""
        return iter(())

    def torque_at(self, turn: Real) -> Real | None:
        """Torque that this aspect demands of the driver, N mm, at rotations from its first position; None if none."""
        return None


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

        Positive in the direction in which the rotations count; without the `load` of its rotating bodies.
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
