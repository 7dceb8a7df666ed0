"""Loads in recipes of gears: their checks, columns and summaries, and why they are not computed."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from ...core.errors import DesignError
from ...core.fields import to_digits
from ...core.records import record
from ...making.materials import MATERIALS
from ...model.check import Check
from ...model.material import Material
from ...model.table import Column, Table
from ...recipe.aspect import AbstractAspect
from ...recipe.composed import AbstractComposedRecipe
from ..checks import RackStrength, TrainStrength, strength_checks
from ..strength import AbstractMeshStrength, LoadFactors, PairStrength, PlanetaryStrength, pressure_column
from .helical import backlash_remarks

# Why recipes of gears report no forces.
BALANCED = "Gears are balanced about their axes, so gravity needs no torque"
ONLY_WITH_LOADS = f"{BALANCED}; tooth forces and stresses are computed with the table loads."
RACK_WITHOUT_LOADS = (
    "Gravity acts across the rack and needs no torque; torque and tooth forces are computed with the table loads."
)
NO_INVOLUTE = f"{BALANCED}; tooth forces and stresses are not computed for teeth that are no involutes."
HELICAL = f"{BALANCED}; tooth forces and stresses are not computed, as their formulas are those of straight teeth."


@record(eq=False)
class LoadedMeshes:
    """The meshes of a recipe under its loads.

    strength: of the pair, train or set. meshes: by the name that their checks have in front. limit: load of the key at
    which a safety falls to its limit. summary: entries of summary.json. torque: on the driver, N mm.
    """

    strength: PairStrength | RackStrength | TrainStrength | PlanetaryStrength
    meshes: Mapping[str, AbstractMeshStrength]
    limit: float
    summary: Mapping[str, object]
    torque: float
    key: str = "loads.torque_n_mm"


class AbstractLoadedRecipe(AbstractComposedRecipe):
    """Base class of recipes of involute gears in mesh, whose one aspect is their loads."""

    carries_torques: ClassVar[bool] = True
    # Why there are no forces without loads.
    without_loads: ClassVar[str] = ONLY_WITH_LOADS

    @abstractmethod
    def loaded(self, loads: Any) -> LoadedMeshes | None:
        """Forces and stresses under loads; None if the teeth are helical. DesignError if a material is missing."""

    @property
    def own_remarks(self) -> tuple[str, ...]:
        return backlash_remarks(self.own_notes[0])

    @property
    def forces_missing(self) -> str:
        aspect = self.aspect(GearLoadsAspect.key)
        if aspect is None:
            return self.without_loads
        return HELICAL if aspect.meshes is None else ""


@record(eq=False)
class GearLoadsAspect(AbstractAspect[AbstractLoadedRecipe, LoadFactors]):
    """Forces and stresses of gears in mesh."""

    key = "loads"

    @cached_property
    def meshes(self) -> LoadedMeshes | None:
        """The meshes under the loads, or the larger ones of a machine; None if the teeth are helical."""
        meshes = self.mechanism.loaded(self.given)
        if meshes is None or self._torque_of_machine <= meshes.torque:
            return meshes
        key = meshes.key.removeprefix("loads.")
        larger = getattr(self.given, key) * self._torque_of_machine / meshes.torque
        return self.mechanism.loaded(replace(self.given, **{key: larger}))

    @property
    def _torque_of_machine(self) -> float:
        """Torque on the driver by what its other gears turn in a machine, N mm; the largest ones of each together."""
        setting = self.mechanism.setting
        if not setting.torques:
            return 0.0
        (_, *driven) = self.mechanism.rotating_bodies.items()
        return sum(abs(float(body.speed)) / body.efficiency * setting.torque_on(name) for name, body in driven)

    def check(self) -> None:
        self.meshes  # noqa: B018  raises if a material is missing, or friction locks a train

    def columns(self, table: Table) -> Iterator[Column]:
        if self.meshes and isinstance(self.meshes.strength, PairStrength):
            yield pressure_column(self.meshes.strength, table)

    @property
    def checks(self) -> Iterator[Check]:
        if self.meshes:
            for name, mesh in self.meshes.meshes.items():
                yield from strength_checks(mesh, name, self.meshes.limit, self.meshes.key)

    @property
    def entries(self) -> Mapping[str, object]:
        return {"loads": self.meshes.summary} if self.meshes else {}


# Set here, since the aspect names the class of its recipe.
AbstractLoadedRecipe.aspect_kinds = (GearLoadsAspect,)


def loaded_materials(**stocks: Material | None) -> tuple[Material, ...]:
    """The materials of all gears, given by the keys of their stocks; DesignError for a missing one."""
    for key, material in stocks.items():
        if material is None:
            problem = "is missing, and the strength under [loads] depends on it"
            remedy = f"give {' or '.join(MATERIALS)}, or omit loads"
            raise DesignError(f"{key}.material", problem, remedy, "missing-key")
    return tuple(material for material in stocks.values() if material is not None)


def factor_notes(loads: LoadFactors) -> Mapping[str, float]:
    """The load factors."""
    factors = {"application": loads.application_factor, "dynamic": loads.dynamic_factor}
    return factors | {"face_load": loads.face_load_factor}


def mesh_strength_notes(loaded: AbstractMeshStrength, gears: tuple[str, str] | None = None) -> Mapping[str, object]:
    """Forces and stresses of a mesh under its load. gears: their names, by default those of the pair."""
    names = dict(zip(gears or loaded.pair.names, zip(loaded.teeth, loaded.materials)))
    return {
        "tangential_force_N": to_digits(loaded.tangential_force),
        "radial_force_N": to_digits(loaded.radial_force),
        "contact_pressure_n_per_mm2": to_digits(loaded.contact_pressure),
        "contact_safety": to_digits(loaded.contact_safety),
        "teeth": {
            name: {
                "material": material.name,
                "root_stress_n_per_mm2": to_digits(teeth.root_stress),
                "lewis_stress_n_per_mm2": to_digits(teeth.lewis_stress),
                "root_safety": to_digits(teeth.root_safety),
            }
            for name, (teeth, material) in names.items()
        },
    }


def pair_strength_notes(loaded: PairStrength) -> Mapping[str, object]:
    """Torques, forces and stresses of a pair under its loads."""
    torques = (loaded.torque, loaded.torque * abs(loaded.pair.ratio))
    return {
        "torque_n_mm": {name: to_digits(torque) for name, torque in zip(loaded.pair.names, torques)},
        "load_factors": factor_notes(loaded.factors),
        "bearing_load_N": to_digits(loaded.normal_force),
        "torque_limit_n_mm": to_digits(loaded.torque_limit),
        **mesh_strength_notes(loaded),
    }


def rack_strength_notes(loaded: RackStrength) -> Mapping[str, object]:
    """Pinion torque, forces and stresses of a rack and pinion under its loads."""
    return {
        "force_n": to_digits(loaded.loads.force_n),
        "pinion_torque_n_mm": to_digits(loaded.torque),
        "load_factors": factor_notes(loaded.loads),
        "bearing_load_N": to_digits(loaded.normal_force),
        "force_limit_n": to_digits(loaded.force_limit),
        **mesh_strength_notes(loaded),
    }


def planetary_strength_notes(loaded: PlanetaryStrength) -> Mapping[str, object]:
    """Torques, bearing loads and stresses of a planetary set under its loads."""
    meshes = {("sun", "planet"): loaded.inner, ("planet", "ring"): loaded.outer}
    return {
        "torque_n_mm": {name: to_digits(torque) for name, torque in loaded.torques.items()},
        "load_factors": factor_notes(loaded.loads),
        "planet_bearing_load_N": to_digits(loaded.planet_bearing_load),
        "sun_bearing_load_N": to_digits(loaded.sun_bearing_load),
        "torque_limit_n_mm": to_digits(loaded.torque_limit),
        **{"_and_".join(gears): mesh_strength_notes(mesh, gears) for gears, mesh in meshes.items()},
    }


def train_strength_notes(loaded: TrainStrength) -> Mapping[str, object]:
    """Torques, bearing loads and stresses of a gear train under its loads."""
    turning = ["driver_1", *(f"driven_{k}" for k, _ in enumerate(loaded.stages, 1))]
    return {
        "input_torque_n_mm": to_digits(loaded.input_torque),
        "torque_n_mm": {name: to_digits(torque) for name, torque in zip(turning, loaded.torques)},
        "load_factors": factor_notes(loaded.loads),
        "bearing_load_N": {name: to_digits(load) for name, load in zip(turning, np.abs(loaded.bearing_loads))},
        "output_torque_limit_n_mm": to_digits(loaded.torque_limit),
        **{
            f"stage_{k}": mesh_strength_notes(stage, (f"driver_{k}", f"driven_{k}"))
            for k, stage in enumerate(loaded.stages, 1)
        },
    }
