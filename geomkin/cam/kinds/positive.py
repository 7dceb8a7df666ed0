"""Cams that move their follower both ways: rollers between walls, their play, and what recipes of such cams share."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from ...core.errors import DesignError
from ...core.fields import rounded_up, to_digits
from ...core.records import record
from ...core.units import mm
from ...model.check import Check
from ...model.material import Mass
from ...model.scene import Limit, Plot, Scene, SceneBody, SceneMark, drawn_at
from ...model.table import Column, Table
from ...plane.curve import AbstractCurve
from ...plane.flatten import flatten
from ...plane.vec import Complex, Real
from ...recipe.recipe import Additions, part_masses
from ..cam import Cam
from ..checks import cam_table
from ..followers.follower import FollowerPlate, Hole
from ..followers.roller import AbstractRoller
from ..parts import pin_masses
from ..program.laws import samples
from ..scene import cam_scene, with_size_plot
from ..undercut import Undercut, undercut
from .disk_cam import AbstractCamRecipe, CamAdditions
from .made import LONGEST_ARROW, CamLoadsAspect, MadeCam

# Steps of the approach to a wall. Each leaves 1 - cos(pressure angle) of the distance: 1e-9 of it at 45 deg.
STEPS = 17
# Change, as a share of the largest one, with which the approach ends.
NEAR = 1e-6
# Positions in each smooth piece of the programme at which the play is computed; it varies slowly.
POSITIONS = 25
# Shares of a piece at which it begins and ends, so that no position is at a joint.
INSIDE = 1e-6


@record(eq=False)
class Wall:
    """A plate of a cam as cut, and the roller that runs along it.

    outline: closed polygon of the wall, in the cam's frame, mm. centre: of the roller in the follower's frame, mm.
    radius: of the roller, mm.
    """

    outline: Complex
    centre: complex
    radius: float


def play_angles(cam: Cam) -> Real:
    """Cam angles, rad, between the joints of a programme."""
    shares = np.linspace(INSIDE, 1 - INSIDE, POSITIONS)
    return np.concatenate([a + (b - a) * shares for a, b in pairwise(cam.program.breaks)])


def roller_play(cam: Cam, walls: Sequence[Wall], angle: Real, most: float) -> tuple[Real, Real]:
    """Changes of the lift, mm or rad, to either side of the programme's at which a roller meets a wall.

    The first is negative and the second positive; with the other sign they are changes that free a roller that jams.
    most: largest change, mm or rad, for a roller that no wall stops.
    """
    from ...plane.region import Edges

    lift, back = cam.program.motion(angle).lift, np.exp(-1j * cam.sense * angle)
    edges = [Edges(wall.outline, np.roll(wall.outline, -1)) for wall in walls]
    # A roller moves by no more than this per unit of lift.
    reach = max(abs(wall.centre) for wall in walls) if cam.follower.oscillates else 1.0

    def room(shift: Real) -> Real:
        pose = cam.follower.pose(lift + shift, cam.base_radius)
        places = (back * np.asarray(pose.place(wall.centre)) for wall in walls)
        rooms: Real = np.min([near.nearest(z)[1] - wall.radius for near, z, wall in zip(edges, places, walls)], axis=0)
        return rooms

    sides = []
    for side in (-1, 1):
        shift = np.zeros(np.shape(angle))
        for _ in range(STEPS):
            before, shift = shift, np.clip(shift + side * room(shift) / reach, -most, most)
            if np.abs(shift - before).max() < NEAR * most:
                break
        sides.append(shift)
    return sides[0], sides[1]


# Chord tolerance of the walls whose play is computed, as a share of the clearance, and its least value, mm.
CHORDS, LEAST_CHORDS = 0.005, 1e-4
# Largest radius of cams whose play is computed, mm: their walls have 60,000 chords.
WIDEST = 1e5
# Free distance of guide pins from a turning plate, mm.
FREE = 1.0
# Largest play of the roller along its path, in clearances: between parallel walls it is 1 over the cosine of the
# pressure angle, 1.41 at 45 deg. With more, a wall is cut away; chosen here.
MOST_PLAY = 2.0


@record(eq=False)
class AbstractPositiveCam(MadeCam):
    """A cam whose rollers run between two walls, which push the follower away from the axis and towards it."""

    # Number of sheets that a pin of the bar passes over a base.
    pin_layers = 2

    @property
    @abstractmethod
    def clearance(self) -> float:
        """How much farther apart the walls are than the rollers between them, mm."""

    @property
    @abstractmethod
    def curves(self) -> Sequence[tuple[AbstractCurve, complex]]:
        """Each wall as cut, in the cam's frame, and the centre of its roller in the follower's frame, mm."""

    @property
    @abstractmethod
    def bars(self) -> tuple[FollowerPlate, ...]:
        """The plates that carry the rollers."""

    @abstractmethod
    def check_walls(self) -> None:
        """DesignError if the other wall cannot be cut, or meets something."""

    def check(self) -> None:
        """DesignError if no roller can run between such walls."""
        follower, jumps = self.cam.follower, self.cam.program.jumps.velocity
        if not isinstance(follower, AbstractRoller) or not follower.roller_radius:
            problem = f"found {follower.kind}, which no walls move both ways"
            remedy = 'give kind = "translating-roller" or "oscillating-roller" with a roller_radius above 0'
            raise DesignError("cam.follower", problem, remedy, "conflict")
        if jumps.any():
            at = float(np.degrees(self.cam.program.breaks[:-1][np.abs(jumps).argmax()]))
            problem = f"its velocity jumps at {at:.4g} deg, where the walls would not meet"
            remedy = "start and end the motion with a law that rests there"
            raise DesignError("cam.program", problem, remedy, "conflict")
        widest = float(np.abs(self.cam.contact(samples(self.cam.program.breaks).ravel()).point).max())
        if not widest <= WIDEST:
            problem = f"found a cam that reaches {mm(widest):.4g} from its axis, too large for the sweep of its play"
            raise DesignError("cam", problem, "give smaller lifts, or a smaller base_radius", "too-much-work")
        self.check_walls()
        self.bars  # noqa: B018  raises if a stem is too short

    @property
    def roller(self) -> AbstractRoller:
        """The follower, as `check` accepts it."""
        assert isinstance(self.cam.follower, AbstractRoller)
        return self.cam.follower

    @property
    def half_width(self) -> float:
        """Distance of a wall from the pitch curve of its roller, mm."""
        return self.roller.roller_radius + self.clearance / 2

    @cached_property
    def cut(self) -> Undercut:
        """The first cam as cut. A roller between walls loses no lift by undercut: it gets play there."""
        return Undercut(self.cam, self.narrowed(self.cam), np.empty((0, 2)), np.empty(0, complex))

    def narrowed(self, cam: Cam) -> AbstractCurve:
        """Outline of a cam as cut, half the clearance inside its profile."""
        wider = replace(cam.follower, roller_radius=self.half_width)  # type: ignore[type-var]
        return undercut(replace(cam, follower=wider, base_radius=cam.base_radius - self.clearance / 2)).outline

    @cached_property
    def walls(self) -> tuple[Wall, ...]:
        """The walls as cut, each with its roller."""
        chords = max(CHORDS * self.clearance, LEAST_CHORDS)
        return tuple(Wall(flatten(curve, chords), centre, self.roller.roller_radius) for curve, centre in self.curves)

    def play(self, angle: Real) -> Real:
        """Play of the roller along its path at given cam angles, mm."""
        reach = abs(self.roller.centre) if self.roller.oscillates else 1.0
        low, high = roller_play(self.cam, self.walls, angle, 10 * self.clearance / reach)
        return (high - low) * reach

    @cached_property
    def play_range(self) -> tuple[float, float]:
        """Least and largest play over a turn, mm."""
        play = self.play(play_angles(self.cam))
        return float(play.min()), float(play.max())

    def guide_pins(self, radius: float) -> tuple[Hole, Hole]:
        """Holes of the two pins that guide a stem, beyond a turning plate of a radius, mm."""
        cam, stock = self.cam, self.stock
        lifts = cam.program.motion(samples(cam.program.breaks).ravel()).lift
        lowest = complex(np.asarray(cam.follower.pose(lifts.min(), cam.base_radius).origin))
        clear = radius + stock.pivot_bore / 2 + FREE
        first = float(np.sqrt(max(clear**2 - lowest.real**2, 0.0))) - lowest.imag
        least = first + 2 * stock.bar_width
        if stock.stem_length < least:
            problem = f"found {mm(stock.stem_length):g}, too short for two guide pins beyond the cam"
            value = rounded_up(least)
            raise DesignError("stock.stem_length", problem, f"give at least {mm(least):up}, or omit base", value=value)
        inner, outer = (
            Hole("pivot_bore", stock.pivot_bore, stock.bar_width, 1j * at) for at in (first, stock.stem_length)
        )
        return inner, outer

    @cached_property
    def masses(self) -> Mapping[str, Mass]:
        bodies = part_masses(self.parts)
        for body, mass in pin_masses(self.bars, self.stock, self.base, self.pin_layers).items() if bodies else ():
            bodies[body] += mass
        return bodies


@record(eq=False)
class PositiveLoadsAspect(CamLoadsAspect):
    """The forces of walls and rollers: the first wall pushes outwards, the other one pulls inwards."""

    # Of the two walls, for the texts.
    names = ("core", "ring")

    @property
    @abstractmethod
    def carried(self) -> tuple[Complex, Complex]:
        """Place and direction of the force at each frame, from the wall that carries the roller."""

    @property
    def arrow(self) -> Iterator[SceneMark]:
        """The force on the roller at each frame."""
        force = np.abs(np.nan_to_num(self.forces.contact))
        if force.any():
            scale, (place, direction) = LONGEST_ARROW * self.cam.prime_radius / force.max(), self.carried
            label = f"contact force, {drawn_at(float(scale), 'N')}"
            yield SceneMark("vector", place, "force", label, vector=scale * force * direction)

    @property
    def contact_checks(self) -> Iterator[Check]:
        """None: the walls hold the follower."""
        return iter(())

    @property
    def spring_summary(self) -> Mapping[str, object]:
        """Cam angles at which the load changes from one wall to the other."""
        force = self.forces.contact
        changes = np.flatnonzero((force[1:] * force[:-1] < 0) & np.isfinite(force[1:] * force[:-1]))
        return {"wall_changes_at_deg": [to_digits(np.degrees(self.angles[k + 1]), 5) for k in changes]}

    def columns(self, table: Table) -> Iterator[Column]:
        first, second = self.names
        meaning = f"force on the roller along the normal of its wall, from the {first}, or below 0 from the {second}"
        for column in super().columns(table):
            yield replace(column, meaning=meaning) if column.id == "contact_force" else column

    def plots(self, table: Table) -> Iterator[Plot]:
        for plot in super().plots(table):
            lines = tuple(replace(line, label=f"below, the {self.names[1]} carries it") for line in plot.limits)
            yield replace(plot, limits=lines) if plot.columns == ("contact_force",) else plot


# Walls move rollers only.
FLAT_FOLLOWERS = ("cam.follower=translating-flat", "cam.follower=oscillating-flat")


@record(kw_only=True)
class AbstractPositiveCamRecipe(AbstractCamRecipe):
    """Base class of recipes of cams that move their follower both ways."""

    additions: ClassVar[Additions] = CamAdditions(refused=FLAT_FOLLOWERS)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.made.check()

    @property
    @abstractmethod
    def made(self) -> AbstractPositiveCam:
        """The cam in its setting."""

    @abstractmethod
    def wall_columns(self, angle: Real) -> Iterator[Column]:
        """Columns of the other wall."""

    @property
    @abstractmethod
    def wall_checks(self) -> Iterator[Check]:
        """Checks of the other wall."""

    @abstractmethod
    def shown(self, table: Table, limits: Sequence[Limit] = ()) -> Scene:
        """The scene without the plots of a recipe."""

    @property
    def own_table(self) -> Table:
        angle = self.drive.angles
        play = Column("play", "mm", "play of the roller along its path", self.made.play(angle))
        return Table((*super().own_table.columns, *self.wall_columns(angle), play))

    @property
    def own_checks(self) -> tuple[Check, ...]:
        (least, largest), most = self.made.play_range, MOST_PLAY * self.made.clearance
        advice = "a wall is cut away: give a larger base_radius, a smaller roller or longer segments"
        jams = "the roller jams: give a larger clearance"
        return (
            *super().own_checks,
            *self.wall_checks,
            Check("least_play", "least play of the roller along its path", least, "at least", 0, "mm", jams, "play"),
            Check("play", "largest play of the roller along its path", largest, "at most", most, "mm", advice, "play"),
        )

    def layered(self, table: Table, limits: Sequence[Limit], hidden: Sequence[str], cam: int, bar: int) -> Scene:
        """The scene of the first cam, its follower without some parts, in layers counted from the lowest one."""
        parts = [part for part in self.parts if part.name not in hidden]
        scene = cam_scene(self.cam, table, parts, self.made.cut, limits)
        first = int(self.base is not None)

        def placed(body: SceneBody) -> SceneBody:
            layers = {"cam": first + cam, "roller": first + cam, "ground": 0, "motor_plate": body.layer}
            return replace(body, layer=layers.get(body.name, first + bar))

        return replace(scene, bodies=tuple(map(placed, scene.bodies)))

    @property
    def own_scene(self) -> Scene:
        scene = with_size_plot(self.shown(self.table, self._limits()), self.cam)
        most = Limit("play", MOST_PLAY * self.made.clearance, "more if a wall is cut away")
        return replace(scene, plots=(*scene.plots, Plot("play of the roller", ("play",), (most,))))

    def scene_at(self, turn: Real) -> Scene:
        return self.shown(cam_table(self.cam, self.made.speed, np.remainder(turn, 2 * np.pi), self.made.cut))

    @property
    def quantities(self) -> Mapping[str, str]:
        least, most = self.made.play_range
        own = {key: value for key, value in super().quantities.items() if key != "undercut"}
        return {**own, "play": f"{mm(least, most, between=' to '):.3g}"}

    @property
    def own_notes(self) -> tuple[Mapping[str, object], Mapping[str, object]]:
        before, after = super().own_notes
        least, most = self.made.play_range
        return {"play": {"least_mm": to_digits(least, 4), "largest_mm": to_digits(most, 4)}, **before}, after

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, Any]:
        return {**super().example_values(tables), **({"stock.stem_length": 120.0} if "base" in tables else {})}
