"""Gears under a load at their output: a rack that pushes, and a train whose last gear turns against a torque."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..core.arguments import PositiveFloat
from ..core.errors import DesignError
from ..core.fields import quantity
from ..core.records import record
from ..model.material import Material, hertz_pressure
from ..plane.vec import Complex
from .rack import RackPair
from .strength import UNKNOWN, AbstractMeshStrength, LoadFactors, PairStrength, ToothStrength
from .train import GearTrain


@record(checked=True, kw_only=True)
class RackLoads(LoadFactors):
    """Force against which a rack moves, and the factors that multiply the tooth force.

    Parameters
    ----------
    force_n : float
        Force on the rack against its travel, N, above 0.
    application_factor, dynamic_factor, face_load_factor : float, optional
        As of `LoadFactors`.
    """

    force_n: float = quantity("force on the rack against its travel", "N", above=0, at_most=1e12, example=50)


@record(checked=True)
class RackStrength(AbstractMeshStrength):
    """Pinion torque, forces and stresses of a rack and pinion under a force on the rack.

    Parameters
    ----------
    pair : RackPair
        Pinion and rack; the root stress of the rack is not computed.
    loads : RackLoads
        Force on the rack, and load factors.
    face_width : float
        Width of the faces in contact, mm.
    materials : tuple of Material
        Of pinion and rack.

    Notes
    -----
    As of `PairStrength`: nominal stresses, one pair of teeth carries all of the force, and friction is not considered.

    Examples
    --------
    >>> pom = gk.making.material("POM")
    >>> pair = gk.gear.RackPair(gk.SpurGear(20, 2), gk.gear.GearRack(12, 2))
    >>> loaded = gk.gear.RackStrength(pair, gk.gear.RackLoads(force_n=100), 6, (pom, pom))
    >>> loaded.torque, round(loaded.teeth[0].root_stress, 1)
    (2000.0, 22.2)
    """

    pair: RackPair
    loads: RackLoads
    face_width: PositiveFloat
    materials: tuple[Material, Material]

    @property
    def torque(self) -> float:
        return self.loads.force_n * self.pair.pinion.pitch_radius

    @property
    def factor(self) -> float:
        return self.loads.factor

    @property
    def pressure_angle(self) -> float:
        return self.pair.pinion.pressure_angle

    @cached_property
    def teeth(self) -> tuple[ToothStrength, ToothStrength]:
        start, end = self.pair.contact_lengths
        # The outermost point of the pinion's flank at which its pair is alone.
        point = min(start + self.pair.pinion.base_pitch, end)
        return self.tooth_strength(self.pair.pinion, point, self.materials[0]), UNKNOWN

    @property
    def contact_pressure(self) -> float:
        pinion = self.pair.pinion
        curvature = 1 / (pinion.pitch_radius * np.sin(pinion.pressure_angle))
        force = self.factor * self.normal_force
        return float(hertz_pressure(force, self.face_width, curvature, *self.materials))

    @property
    def force_limit(self) -> float:
        """Force on the rack at which a safety falls to its limit, N; nan if a strength is unknown."""
        return self.loads.force_n * self.load_margin


@record(checked=True, kw_only=True)
class TrainLoads(LoadFactors):
    """Torque against which the last gear of a train turns, and the factors that multiply the tooth forces.

    Parameters
    ----------
    output_torque_n_mm : float
        Torque on the last gear against its rotation, N mm, above 0.
    application_factor, dynamic_factor, face_load_factor : float, optional
        As of `LoadFactors`.
    """

    output_torque_n_mm: float = quantity(
        "torque on the last gear against its rotation", "N mm", above=0, at_most=1e12, example=2000
    )


@record(checked=True)
class TrainStrength:
    """Torques, forces and stresses of a gear train under a torque on its last gear.

    Parameters
    ----------
    train : GearTrain
        The train, with the friction of its flanks.
    loads : TrainLoads
        Torque on the last gear, and load factors.
    face_width : float
        Width of the faces in contact, mm.
    materials : tuple of Material
        Of driver and driven gear of each stage, (2 stages,).

    Raises
    ------
    DesignError
        If there are more or fewer materials than gears.

    Examples
    --------
    >>> train = gk.GearTrain(((10, 30), (8, 32)), 2, friction=0)
    >>> steel = gk.making.material("steel-C45")
    >>> gk.gear.TrainStrength(train, gk.gear.TrainLoads(output_torque_n_mm=1200.0), 6, 4 * (steel,)).torques
    (100.0, 300.0, 1200.0)
    """

    train: GearTrain
    loads: TrainLoads
    face_width: PositiveFloat
    materials: tuple[Material, ...]

    def __post_init__(self) -> None:
        if len(self.materials) != 2 * len(self.train.stages):
            problem = f"found {len(self.materials)} for {len(self.train.stages)} stages"
            raise DesignError("materials", problem, "give one for each gear", "conflict")

    @cached_property
    def torques(self) -> tuple[float, ...]:
        """Torque that passes through the first gear and through the driven gear of each stage, N mm, (stages + 1,)."""
        torques = [self.loads.output_torque_n_mm]
        for (driver, driven), efficiency in zip(self.train.stages[::-1], self.train.efficiencies[::-1]):
            torques.append(torques[-1] * driver / (driven * efficiency))
        return tuple(torques[::-1])

    @property
    def input_torque(self) -> float:
        """Torque on the first gear, N mm: that of the output over ratio and efficiency."""
        return self.torques[0]

    @cached_property
    def stages(self) -> tuple[PairStrength, ...]:
        """Forces and stresses of each stage under the torque on its driver, which includes friction."""
        materials = zip(self.materials[::2], self.materials[1::2])
        return tuple(
            PairStrength(pair, torque, self.face_width, pair_materials, self.loads)
            for pair, torque, pair_materials in zip(self.train.pairs, self.torques, materials)
        )

    @property
    def bearing_loads(self) -> Complex:
        """Force of the teeth on the first gear, and on the driven gear of each stage with the driver fixed to it, N.

        Notes
        -----
        Sum of the forces of one or two meshes, as if they were in one plane, (stages + 1,). The first gear turns
        counterclockwise.
        """
        loads = np.zeros(len(self.stages) + 1, dtype=complex)
        for k, (stage, direction) in enumerate(zip(self.stages, self.train.directions)):
            # The driver pushes the driven gear in the direction in which its own teeth move.
            along = 1j * direction * (-1) ** k
            force = stage.tangential_force * along + stage.radial_force * direction
            loads[k] -= force
            loads[k + 1] += force
        return loads

    @property
    def torque_limit(self) -> float:
        """Torque on the last gear at which a safety falls to its limit, N mm; nan if a strength is unknown."""
        return self.loads.output_torque_n_mm * float(np.min([stage.load_margin for stage in self.stages]))
