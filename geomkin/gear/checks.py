"""Checks of gears: tips, undercut, rims, contact, clearance and strength; and gears under a load at their output."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..core.arguments import FloatOrNan, PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import ROUNDING, quantity, rounded_down
from ..core.records import record
from ..model.check import Check, Suggestion
from ..model.material import Material, hertz_pressure
from ..plane.vec import Complex
from .conjugate.conjugate import BEYOND, Conjugate
from .contract import AbstractGear
from .pair import GearPair
from .planetary import PlanetarySet
from .rack import RackPair
from .strength import (
    LEAST_CONTACT_SAFETY,
    LEAST_ROOT_SAFETY,
    UNKNOWN,
    AbstractMeshStrength,
    LoadFactors,
    PairStrength,
    ToothStrength,
)
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


# Modules. A thinner tip chips (Roloff/Matek, Maschinenelemente: 0.2, for hardened teeth 0.4).
LEAST_TIP_THICKNESS = 0.2
# Modules of rim under or outside the teeth: half a tooth height. In a thinner rim cracks run through the rim instead of
# the tooth; from 1.2 heights on it has its full strength (rim thickness factor of ISO 6336-3 and AGMA 2001-D04).
LEAST_RIM = 1


@checked
def gear_checks(gear: AbstractGear, rim: float | None = None, name: str = "") -> tuple[Check, ...]:
    """Check the tips, the undercut and the rim of one gear.

    Parameters
    ----------
    gear : AbstractGear
        The gear.
    rim : float, optional
        Thickness of material under the teeth, mm; outside them for a ring. By default the gear is solid, and the rim of
        a ring is not checked.
    name : str
        Name of the gear in the ids and names of the checks.

    Returns
    -------
    tuple of Check
        Values in modules.

    Notes
    -----
    The limits are constants of this module, each with its source.
    """
    before, prefix, module = f"{name} " if name else "", f"{name}_" if name else "", gear.module
    thinner = "give less profile_shift, addendum or tooth_thickness_allowance"
    tip = gear.tip_thickness / module
    least = LEAST_TIP_THICKNESS
    checks = [Check(f"{prefix}tip_thickness", f"{before}tip thickness", tip, "at least", least, "modules", thinner)]
    if gear.lost_to_undercut is not None:
        lost, more = gear.lost_to_undercut / module, "give more teeth or profile_shift"
        words = f"{before}involute lost to undercut"
        checks.append(Check(f"{prefix}undercut", words, lost, "at most", 0, "modules", more))
    rim = gear.solid_rim if rim is None else rim
    if rim is not None:
        where, advice = ("outside", "give a thicker rim") if gear.is_ring else ("under", "give a smaller bore")
        advice = advice if gear.hole_room else "give a higher bar"
        words = f"{before}rim {where} the teeth"
        checks.append(Check(f"{prefix}rim", words, rim / module, "at least", LEAST_RIM, "modules", advice))
    return tuple(checks)


# Contact ratio of involutes, whose distance may deviate a little: above 1, so that a pair of teeth comes into contact
# before the last one leaves it (Roloff/Matek: 1.1; Shigley's Mechanical Engineering Design: about 1.2).
LEAST_CONTACT_RATIO = 1.1
# Modules between tips and roots: the least clearance of a basic rack by DIN 867.
LEAST_CLEARANCE = 0.1
# Modules between the tips of adjacent planets; derived here from play and dirt.
LEAST_PLANET_GAP = 0.5


@checked
def mesh_checks(pair: GearPair | RackPair, name: str = "") -> tuple[Check, ...]:
    """Check contact, clearance and interference of two gears.

    Parameters
    ----------
    pair : GearPair or RackPair
        The gears in mesh.
    name : str
        Name of the pair in the ids and names of the checks.

    Returns
    -------
    tuple of Check
        Contact ratio, clearance of the tips in modules, and number of interferences.
    """
    clear = min(pair.clearances) / pair.module
    before, prefix = (f"{name}: ", f"{name}_") if name else ("", "")
    teeth = "give more teeth, less shift or no undercut"
    meeting = f"at {', '.join(pair.interferences)}: give a smaller addendum, or other profile shifts"
    return (
        Check(
            f"{prefix}contact_ratio", f"{before}contact ratio", pair.contact_ratio,
            "at least", LEAST_CONTACT_RATIO, "", teeth,
        ),
        Check(
            f"{prefix}tip_clearance", f"{before}clearance of tips from roots", clear,
            "at least", LEAST_CLEARANCE, "modules", "give a smaller addendum",
        ),
        Check(
            f"{prefix}interferences", f"{before}interferences", len(pair.interferences), "at most", 0, "", meeting
        ),
    )  # fmt: skip


@checked
def strength_checks(
    loaded: AbstractMeshStrength, name: str = "", limit: FloatOrNan | None = None, key: str = "loads.torque_n_mm"
) -> tuple[Check, ...]:
    """Check the teeth of two gears under a load.

    Parameters
    ----------
    loaded : PairStrength or RackStrength
        The pair under its loads.
    name : str
        Name of the pair in the ids and names of the checks.
    limit : float, optional
        Load that the advice names; by default the torque on the driving gear at which a safety falls to its limit.
    key : str
        Key of that load in a recipe.

    Returns
    -------
    tuple of Check
        Safety of the roots of each gear, except of a ring, and of the flanks; failed if a strength is unknown.

    Notes
    -----
    Limits are constants of `geomkin.gear.strength`. Stresses are nominal ones, with the given load factors.
    """
    before, prefix = (f"{name}: ", f"{name}_") if name else ("", "")
    limit = float(loaded.torque * loaded.load_margin if limit is None else limit)  # type: ignore[arg-type]
    advice = "give strength, modulus and poisson_ratio of the material"
    suggestions: tuple[Suggestion, ...] = ()
    if np.isfinite(limit):
        most, unit = rounded_down(limit * (1 - ROUNDING), 4), "N" if key.endswith("force_n") else "N mm"
        advice = f"give at most {most} {unit}, a wider face, a larger module or a stronger material"
        suggestions = (Suggestion({key: float(most)}),)
    roots = (
        Check(
            f"{prefix}{gear}_root_safety", f"{before}strength of the {gear} gear's roots over their stress",
            teeth.root_safety, "at least", LEAST_ROOT_SAFETY, "", advice, suggestions=suggestions,
        )
        for gear, teeth in zip(loaded.pair.names, loaded.teeth)
        if teeth is not UNKNOWN
    )  # fmt: skip
    words = f"{before}pressure at which the flanks yield over their pressure"
    safety = loaded.contact_safety
    id, least = f"{prefix}contact_safety", LEAST_CONTACT_SAFETY
    return *roots, Check(id, words, safety, "at least", least, "", advice, suggestions=suggestions)


@checked
def planetary_checks(gears: PlanetarySet) -> tuple[Check, ...]:
    """Check both meshes of a planetary set, and the room between its planets.

    Parameters
    ----------
    gears : PlanetarySet
        The set.

    Returns
    -------
    tuple of Check
        `mesh_checks` of sun and ring; the gap between planets, in modules, if there are several.
    """
    room = gears.planet_gap / gears.sun.module
    fewer, least = "give fewer planets", LEAST_PLANET_GAP
    beside = Check("planet_gap", "room between planets", room, "at least", least, "modules", fewer)
    return (
        *mesh_checks(gears.inner, "sun"),
        *mesh_checks(gears.outer, "ring"),
        *((beside,) if gears.planets > 1 else ()),
    )


# Contact ratio of conjugate gears, whose contact is computed exactly: at 1 it is just continuous; derived here.
LEAST_CONJUGATE_CONTACT_RATIO = 1


@checked
def conjugate_checks(mate: Conjugate, module: PositiveFloat, pieces: int = 1, longer: str = "") -> tuple[Check, ...]:
    """Check the contact ratio and the tips of a conjugate gear.

    Parameters
    ----------
    mate : Conjugate
        The mate of a gear.
    module : float
        Module of the gear, mm.
    pieces : int
        Number of pieces of the cutter, from the first, that form the driving side of the gear's tooth.
    longer : str
        Further advice on how to lengthen the contact.

    Returns
    -------
    tuple of Check
        Contact ratio, and tip thickness in modules.
    """
    ratio, thickness = mate.contact_ratio(0.0, pieces), mate.tip_thickness / module
    thinner = "give a smaller mate.addendum or mate.backlash"
    teeth = f"give longer teeth, or more of them{longer}"
    return (
        Check("contact_ratio", "contact ratio", ratio, "at least", LEAST_CONJUGATE_CONTACT_RATIO, "", teeth),
        Check(
            "mate_tip_thickness", "mate's tip thickness", thickness, "at least", LEAST_TIP_THICKNESS, "modules", thinner
        ),
    )


@checked
def touch_check(mate: Conjugate, module: PositiveFloat) -> Check:
    """Check that all of the gear's flank touches its mate.

    Parameters
    ----------
    mate : Conjugate
        The mate of a gear.
    module : float
        Module of the gear, mm.

    Returns
    -------
    Check
        Height of the flank that does not touch, in modules.
    """
    lost = sum(u.outer_radius - u.inner_radius for u in mate.untouched if u.start < 1 and u.why != BEYOND)
    advice = "the mate is undercut: give it more teeth, or the gear's flanks less height or more lean"
    return Check("untouched_flank", "flank that cannot touch", lost / module, "at most", 0, "modules", advice)
