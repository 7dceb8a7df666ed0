"""Gear trains: stages of two gears, of which the driven one shares its arbor with the next driver."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property
from itertools import accumulate
from math import prod
from typing import Annotated

import numpy as np

from ..core.arguments import FloatOrNan, between, checked, whole_between
from ..core.errors import DesignError
from ..core.fields import entry, quantity
from ..core.records import record
from ..core.reprs import moving_picture
from ..model.table import Column, Table
from ..plane.vec import Complex, Pose, Real
from .cutters import RackCutter
from .module import LARGEST
from .pair import GearPair
from .spur import SpurGear

# Teeth of a gear of a train: with fewer, no profile shift leaves teeth that mesh well; with more, searches are slow.
FEWEST_TEETH, MOST_TEETH = 6, 1000
MOST_STAGES = 8

Teeth = Annotated[int, whole_between(FEWEST_TEETH, MOST_TEETH)]
Direction = Annotated[float, between(-3600, 3600, "deg")]
Stages = tuple[tuple[Teeth, Teeth], ...]


@record(checked=True)
class GearTrain:
    """A train of spur gears. The first arbor is at the origin; each stage is in its own layer.

    Small gears have the least profile shift without undercut. Their mates have the opposite shift, or the part of it
    that leaves them without undercut.

    Parameters
    ----------
    stages : tuple of tuple of int
        Teeth of the driver and of the driven gear of each stage, 1 to 8 stages. The driven gear is fixed to the driver
        of the next stage.
    module : float
        Pitch diameter per tooth of all gears, mm, above 0.
    directions_deg : tuple of float, optional
        Direction from each arbor to the next one, deg; by default all arbors are on +x. With 0 and 180 two stages of
        equal centre distances form a reverted train: input and output are on one axis.
    backlash : float, optional
        Backlash of each mesh along the working pitch circles, modules, 0 to 0.5.
    friction : float, optional
        Mean coefficient of friction of the flanks, 0 to 1.

    Raises
    ------
    DesignError
        If a number of teeth is out of range, or there are more or fewer directions than stages.

    Examples
    --------
    >>> train = gk.GearTrain(((10, 30), (8, 32)), module=2, directions_deg=(0, 180))
    >>> train.ratio, train.axes.round(9)
    (12.0, array([ 0.+0.j, 40.+0.j,  0.+0.j]))
    """

    stages: Stages = entry("teeth of driver and driven gear of each stage", example=((10, 30), (8, 32)))
    module: float = quantity("pitch diameter per tooth", "mm", above=0, at_most=LARGEST, example=2)
    directions_deg: tuple[Direction, ...] = entry("direction from each arbor to the next one, deg", default=())
    backlash: float = quantity(
        "backlash of each mesh along the pitch circles", "modules", default=0.04, at_least=0, at_most=0.5
    )
    friction: float = quantity("mean coefficient of friction of the flanks", default=0.1, at_least=0, at_most=1)

    _repr_html_ = moving_picture

    def __post_init__(self) -> None:
        if not 1 <= len(self.stages) <= MOST_STAGES:
            problem = f"found {len(self.stages)} stages"
            raise DesignError("stages", problem, f"give 1 to {MOST_STAGES}", "out-of-range")
        if len(self.directions_deg) not in (0, len(self.stages)):
            problem = f"found {len(self.directions_deg)} for {len(self.stages)} stages"
            raise DesignError("directions_deg", problem, "give one for each stage, or none", "conflict")
        self.pairs  # noqa: B018  raises for gears that cannot be made or do not mesh

    @cached_property
    def pairs(self) -> tuple[GearPair, ...]:
        """The gears of each stage in mesh."""
        allowance = self.backlash * self.module / 2
        pairs = []
        for teeth in self.stages:
            first, second = (
                SpurGear(z, self.module, x, tooth_thickness_allowance=allowance, on_pointed_tip="cut")
                for z, x in zip(teeth, _shifts(*teeth))
            )
            pairs.append(GearPair(first, second))
        return tuple(pairs)

    @property
    def ratio(self) -> float:
        """Rotations of the first gear for one of the last; negative if they turn in opposite directions."""
        return float(prod(Fraction(-driven, driver) for driver, driven in self.stages))

    @property
    def speeds(self) -> tuple[Fraction, ...]:
        """Rotations of each arbor's gears for one rotation of the first gear, (stages + 1,), exact."""
        return tuple(accumulate((Fraction(-a, b) for a, b in self.stages), lambda x, y: x * y, initial=Fraction(1)))

    @property
    def directions(self) -> Complex:
        """Unit directions from each arbor to the next one, (stages,)."""
        given = self.directions_deg if len(self.directions_deg) else (0.0,) * len(self.stages)
        # Whole quarter turns are exact, so that reverted trains have coaxial arbors.
        return np.array([1j ** (d // 90) * np.exp(1j * np.radians(d % 90)) for d in given])

    @property
    def axes(self) -> Complex:
        """Axes of the first gear and of the driven gear of each stage, mm, (stages + 1,)."""
        steps = np.array([pair.centre_distance for pair in self.pairs]) * self.directions
        return np.concatenate([[0j], np.cumsum(steps)])

    @cached_property
    def arbors(self) -> tuple[str, ...]:
        """Letter of the arbor of each axis, from A, (stages + 1,); coaxial gears have one arbor."""
        axes, limit, arbors = self.axes, 1e-9 * self.module, list[str]()
        for k, axis in enumerate(axes):
            coaxial = next((j for j in range(k) if abs(axes[j] - axis) <= limit), None)
            arbors.append(chr(ord("A") + len(set(arbors))) if coaxial is None else arbors[coaxial])
        return tuple(arbors)

    @property
    def arbor_axes(self) -> dict[str, complex]:
        """Axes of the arbors by their letters from A, mm."""
        axes: dict[str, complex] = {}
        for arbor, axis in zip(self.arbors, self.axes):
            axes.setdefault(arbor, complex(axis))
        return axes

    @property
    def efficiencies(self) -> tuple[float, ...]:
        """Efficiency of each mesh at the given friction.

        Notes
        -----
        1 - friction H_V, with the tooth loss factor H_V = pi (1/z1 + 1/z2) (1 - e + e1^2 + e2^2), where e1 and e2 are
        the contact ratios on either side of the pitch point and e their sum (Niemann and Winter, Maschinenelemente II;
        ISO/TR 14179-2). Two pairs of flanks in contact share the force equally. Friction of the bearings is not
        included.
        """
        return tuple(1 - self.friction * loss_factor(pair) for pair in self.pairs)

    @property
    def efficiency(self) -> float:
        """Efficiency of the train: the product of those of its meshes."""
        return prod(max(efficiency, 0.0) for efficiency in self.efficiencies)

    @checked
    def poses(self, turn: FloatOrNan) -> tuple[Pose, ...]:
        """Poses of the gears on each axis at rotations of the first gear.

        Parameters
        ----------
        turn : float or array_like
            Rotations of the first gear, rad, any shape; at 0 it has a tooth on +y.

        Returns
        -------
        tuple of Pose, length stages + 1
            The first gear, then the driven gear of each stage and the driver fixed to it, whose teeth on +y of their
            frame coincide. Teeth are in the middle of the spaces of their mates.
        """
        angle = np.asarray(turn, dtype=float)
        poses = [Pose(np.zeros(angle.shape, complex), np.exp(1j * angle))]
        for pair, direction, axis in zip(self.pairs, self.directions, self.axes[1:]):
            # A pair's contact is on +y of its driver.
            incline = float(np.angle(direction / 1j))
            angle = (angle - incline) / pair.ratio + np.pi / pair.second.teeth + np.pi + incline
            poses.append(Pose(np.full(angle.shape, axis), np.exp(1j * angle)))
        return tuple(poses)


def _shifts(first: int, second: int) -> tuple[float, float]:
    """Profile shifts of two gears, modules: opposite ones if that leaves neither undercut, else the least ones."""
    rack = RackCutter()
    # Negative limits are the room of large gears.
    limits = [rack.flank_depth - z / 2 * np.sin(rack.pressure_angle) ** 2 for z in (first, second)]
    x1, x2 = (max(0.0, float(limit)) for limit in limits)
    return (x1 or max(-x2, limits[0])) + 0.0, (x2 or max(-x1, limits[1])) + 0.0


@checked
def loss_factor(pair: GearPair) -> float:
    """Tooth loss factor of a mesh: lost power over transmitted power, per unit of friction.

    Parameters
    ----------
    pair : GearPair
        Two external gears in mesh.

    Returns
    -------
    float
        H_V of `GearTrain.efficiencies`.

    Examples
    --------
    >>> round(gk.gear.loss_factor(gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(40, 2))), 4)
    0.1661
    """
    start, end = pair.contact_lengths
    pitch_point = pair.first.base_radius * np.tan(pair.working_pressure_angle)
    before, after = (pitch_point - start) / pair.first.base_pitch, (end - pitch_point) / pair.first.base_pitch
    lengths = 1 - before - after + before**2 + after**2
    return float(np.pi * (1 / pair.first.teeth + 1 / pair.second.teeth) * lengths)


# Rows of the table of a train: one rotation of the first gear in degrees.
ROWS = 361


@checked
def train_table(train: GearTrain) -> Table:
    """Rotations of all gears of a train during one rotation of the first.

    Parameters
    ----------
    train : GearTrain
        The train.

    Returns
    -------
    Table
        One row for each degree.

    Examples
    --------
    >>> float(gk.gear.train_table(gk.GearTrain(((12, 36), (12, 48)), 2))["driven_2_turn"][-1])
    30.0
    """
    return Table(tuple(turn_columns(train, np.linspace(0, 2 * np.pi, ROWS))))


def turn_columns(train: GearTrain, turn: Real) -> Iterator[Column]:
    """Rotations of all gears, deg, at rotations of the first gear, rad."""
    yield Column("driver_1_turn", "deg", "rotation of the first gear", np.degrees(turn))
    for k, speed in enumerate(train.speeds[1:], start=1):
        on = f" and driver_{k + 1}" if k < len(train.stages) else ""
        yield Column(f"driven_{k}_turn", "deg", f"rotation of driven_{k}{on}", np.degrees(turn) * float(speed))
