"""Strength of gears in mesh: tooth force, root stress, Lewis stress, Hertz pressure, and the torque they carry."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..core.arguments import PositiveFloat, checked
from ..core.errors import DesignError
from ..core.fields import last_fit, quantity, rounded_down
from ..core.records import record
from ..core.units import bare_mm, mm
from ..model.material import Material, hertz_pressure
from ..model.table import Column, Table
from ..plane.vec import Real, cross
from .contract import AbstractInvoluteGear
from .pair import GearPair
from .planetary import Member, PlanetarySet
from .rack import RackPair

# Least ratio of a material's yield strength, or of its strength, to the nominal root stress: teeth that pulsate for
# long endure about half of what they carry once; chosen here.
LEAST_ROOT_SAFETY = 2.0
# Least ratio of the pressure at which the material yields below the surface to the Hertz pressure; chosen here.
LEAST_CONTACT_SAFETY = 1.0
# Slope of the tangent at the critical section to the middle of the tooth, rad (ISO 6336-3, external gears).
SECTION_TANGENT = np.radians(30)
# Samples of a root curve, and rounds of sampling, each of which narrows the interval of a point to 1/32.
SAMPLES, ROUNDS = 65, 8


@record(checked=True, kw_only=True)
class LoadFactors:
    """Factors that multiply the tooth force for stresses.

    Parameters
    ----------
    application_factor : float, optional
        For shocks of motor and machine.
    dynamic_factor : float, optional
        For vibration of the teeth.
    face_load_factor : float, optional
        For load that is uneven over the width.
    """

    application_factor: float = quantity(
        "factor on the tooth force for shocks of motor and machine", default=1.0, at_least=0.1, at_most=100
    )
    dynamic_factor: float = quantity(
        "factor on the tooth force for vibration of the teeth", default=1.0, at_least=0.1, at_most=100
    )
    face_load_factor: float = quantity(
        "factor on the tooth force for load that is uneven over the width", default=1.0, at_least=0.1, at_most=100
    )

    @property
    def factor(self) -> float:
        """Product of the factors."""
        return self.application_factor * self.dynamic_factor * self.face_load_factor


@record(checked=True, kw_only=True)
class GearLoads(LoadFactors):
    """Torque on the driving gear, and the factors that multiply the tooth force.

    Parameters
    ----------
    torque_n_mm : float
        Torque on the driving gear, N mm, above 0.
    application_factor, dynamic_factor, face_load_factor : float, optional
        As of `LoadFactors`.
    """

    torque_n_mm: float = quantity("torque on the driving gear", "N mm", above=0, at_most=1e12, example=500)


@record
class RootSection:
    """Critical section of an external tooth, where the tangent of its root is inclined by 30 deg to the tooth's middle.

    Parameters
    ----------
    thickness : float
        Chord between both roots, mm.
    height : float
        Distance of the section from the gear's axis, mm.
    fillet_radius : float
        Radius of curvature of the root there, mm.
    """

    thickness: float
    height: float
    fillet_radius: float


@checked
def root_section(gear: AbstractInvoluteGear) -> RootSection:
    """The critical section of a gear's teeth, from their exact root curves.

    Parameters
    ----------
    gear : SpurGear
        An external gear.

    Returns
    -------
    RootSection

    Raises
    ------
    DesignError
        If the gear is a ring, or its roots have no such tangent.

    Notes
    -----
    ISO 6336-3 finds the same section from the cutting rack; here it is a point of the root as it is cut, whatever the
    tool.

    Examples
    --------
    >>> round(gk.gear.root_section(gk.SpurGear(17, 1)).thickness, 6)
    1.884016
    """
    if gear.is_ring:
        raise DesignError("gear", "found a ring, whose roots have another critical section", "give an external gear")
    root = gear.root_curve
    tangent = 1j * np.exp(1j * SECTION_TANGENT)
    edges = np.concatenate([np.linspace(a, b, SAMPLES)[:-1] for a, b in pairwise(root.breaks)] + [root.breaks[-1:]])
    side = cross(tangent, root.velocity(edges))
    crossings = np.flatnonzero(side[:-1] * side[1:] <= 0)
    if not len(crossings):
        problem = "its roots have no tangent at 30 deg to the tooth"
        raise DesignError("gear", problem, "give a smaller pressure angle", "out-of-range")

    def crossing(k: int) -> float:
        return last_fit(lambda t: bool(cross(tangent, root.velocity(t)) * side[k] > 0), edges[k], edges[k + 1])

    t = min(map(crossing, crossings.tolist()), key=lambda t: float(root.point(t).real))
    z = complex(root.point(t))
    return RootSection(2 * z.real, z.imag, float(1 / np.abs(root.curvature(t))))


@record
class ToothForm:
    """Factors that turn the tooth force into stresses of the root, for a load at a point of the flank.

    Parameters
    ----------
    section : RootSection
        The critical section.
    lever : float
        Distance from the section to where the line of the force crosses the tooth's middle, mm.
    form_factor : float
        Y_F: bending stress at the section, from the force along the pitch circle over face width and module.
    stress_correction : float
        Y_S: peak of the stress in the fillet over that bending stress.
    lewis_factor : float
        Y of Lewis, for the same load.
    """

    section: RootSection
    lever: float
    form_factor: float
    stress_correction: float
    lewis_factor: float


@checked
def tooth_form(gear: AbstractInvoluteGear, radius: PositiveFloat | None = None) -> ToothForm:
    """Form factors of a gear's teeth, from their exact root curves.

    Parameters
    ----------
    gear : SpurGear
        An external gear.
    radius : float, optional
        Radius at which the load acts, mm; by default the end of the involute at the tip.

    Returns
    -------
    ToothForm

    Raises
    ------
    DesignError
        If the gear is a ring, its roots have no critical section, or the load is not on the involute.

    Notes
    -----
    Y_F and Y_S as in ISO 6336-3 for straight teeth; Y_S is stated for 1 <= s_F / 2 rho_F < 8. Lewis's parabola is that
    of least width inside the tooth (Lewis, 1892).

    Examples
    --------
    >>> form = gk.gear.tooth_form(gk.SpurGear(17, 1))
    >>> round(form.form_factor, 4), round(form.stress_correction, 4), round(form.lewis_factor, 3)
    (2.9575, 1.5219, 0.292)
    """
    section, tooth = root_section(gear), gear.tooth
    inner, outer = (gear.base_radius * float(np.hypot(1, roll)) for roll in tooth.rolls)
    radius = outer if radius is None else radius
    if not inner * (1 - 1e-9) <= radius <= outer * (1 + 1e-9):
        remedy = f"give {bare_mm(inner):up} to {bare_mm(outer):down}, on the involute"
        raise DesignError("radius", f"found {mm(radius):g}", remedy, "out-of-range", rounded_down(outer))
    # Direction of the force, which is tangent to the base circle, from the normal of the tooth's middle.
    incline = float(np.arccos(gear.base_radius / radius)) - tooth.half_angle(radius)
    apex = gear.base_radius / np.cos(incline)
    lever, s, module = apex - section.height, section.thickness, gear.module
    form_factor = 6 * lever * module * np.cos(incline) / (s**2 * np.cos(gear.pressure_angle))
    slenderness, notch = s / lever, s / (2 * section.fillet_radius)
    correction = (1.2 + 0.13 * slenderness) * notch ** (1 / (1.21 + 2.3 / slenderness))
    lewis = _least_parabola(gear, apex) / module
    return ToothForm(section, float(lever), float(form_factor), float(correction), lewis)


def _least_parabola(gear: AbstractInvoluteGear, apex: float) -> float:
    """Least (2/3) x2 / (apex - y) of the points of the root below the apex, mm."""
    root = gear.root_curve

    def width(t: Real) -> Real:
        z = root.point(t)
        below = apex - z.imag
        return np.where(below > 0, 2 / 3 * z.real**2 / np.where(below > 0, below, 1.0), np.inf)

    t = np.concatenate([np.linspace(a, b, SAMPLES) for a, b in pairwise(root.breaks)])
    for _ in range(ROUNDS):
        k = int(np.argmin(width(t)))
        t = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], SAMPLES)
    return float(width(t).min())


@record
class ToothStrength:
    """Stresses of one gear's teeth; nan if they are unknown.

    Parameters
    ----------
    root_stress : float
        Nominal stress in the root for the load at the outer point of single contact, N/mm2.
    lewis_stress : float
        Bending stress by Lewis for the load at the tip, N/mm2.
    root_safety : float
        Stress that the material carries, over the root stress.
    """

    root_stress: float
    lewis_stress: float
    root_safety: float


UNKNOWN = ToothStrength(np.nan, np.nan, np.nan)


class AbstractMeshStrength(ABC):
    """Base class of the forces and stresses of two gears in mesh under a load.

    A subclass has the fields `pair`, `face_width` and `materials`, of the driving and of the driven gear.
    """

    pair: GearPair | RackPair
    face_width: float
    materials: tuple[Material, Material]

    @property
    @abstractmethod
    def torque(self) -> float:
        """Torque on the driving gear, N mm."""

    @property
    @abstractmethod
    def factor(self) -> float:
        """Factor on the tooth force for stresses."""

    @property
    @abstractmethod
    def pressure_angle(self) -> float:
        """Working pressure angle, rad."""

    @property
    @abstractmethod
    def teeth(self) -> tuple[ToothStrength, ToothStrength]:
        """Stresses of the teeth of both gears."""

    @property
    @abstractmethod
    def contact_pressure(self) -> float:
        """Hertz pressure at the pitch point if one pair of teeth carries the force, N/mm2."""

    @property
    def normal_force(self) -> float:
        """Force along the line of action, which also loads the bearings of each gear, N, without load factors."""
        return self.torque / self.pair.driver.base_radius

    @property
    def tangential_force(self) -> float:
        """Its part along the working pitch circles, N."""
        return self.normal_force * float(np.cos(self.pressure_angle))

    @property
    def radial_force(self) -> float:
        """Its part that pushes both gears apart, N; of a ring together."""
        return self.normal_force * float(np.sin(self.pressure_angle))

    @property
    def contact_safety(self) -> float:
        """Pressure at which the weaker material yields below its surface, over the Hertz pressure."""
        return min(material.yielding_pressure for material in self.materials) / self.contact_pressure

    @property
    def load_margin(self) -> float:
        """Load at which a safety falls to its limit, over the given one; nan if a strength is unknown."""
        roots = [tooth.root_safety for tooth in self.teeth if tooth is not UNKNOWN]
        shares = [*(safety / LEAST_ROOT_SAFETY for safety in roots), (self.contact_safety / LEAST_CONTACT_SAFETY) ** 2]
        return float(np.min(shares))

    def tooth_strength(self, gear: AbstractInvoluteGear, along: float, material: Material) -> ToothStrength:
        """Stresses of a gear's teeth for a load on the line of action, `along` mm from the gear's base circle."""
        per_module = self.factor * self.normal_force * np.cos(gear.pressure_angle)
        per_module /= self.face_width * gear.module
        tip = tooth_form(gear)
        inner, outer = gear.flank_lengths
        form = tooth_form(gear, float(np.hypot(gear.base_radius, np.clip(along, inner, outer))))
        root = float(per_module * form.form_factor * form.stress_correction)
        return ToothStrength(root, float(per_module / tip.lewis_factor), (material.carried_stress or np.nan) / root)


@record(checked=True)
class PairStrength(AbstractMeshStrength):
    """Forces and stresses of two spur gears in mesh under a torque.

    Parameters
    ----------
    pair : GearPair
        The gears; the second may be a ring, whose root stress is not computed.
    torque_n_mm : float
        Torque on the first gear, N mm, above 0.
    face_width : float
        Width of the faces in contact, mm.
    materials : tuple of Material
        Of the first and the second gear.
    factors : LoadFactors, optional
        Factors on the tooth force for stresses, 1 by default.

    Notes
    -----
    Nominal stresses by the formulas of ISO 6336 for straight teeth, with load factors 1 unless others are given; this
    is no rating by that standard. One pair of teeth carries all of the force. Friction is not considered. Results that
    depend on an unknown value of a material are nan.

    Examples
    --------
    >>> steel = gk.making.material("steel-C45")
    >>> pair = gk.GearPair(gk.SpurGear(20, 2), gk.SpurGear(40, 2))
    >>> loaded = gk.gear.PairStrength(pair, 5000, 20, (steel, steel))
    >>> round(loaded.tangential_force), round(loaded.contact_pressure), round(loaded.teeth[0].root_stress, 1)
    (250, 327, 18.1)
    """

    pair: GearPair
    torque_n_mm: PositiveFloat
    face_width: PositiveFloat
    materials: tuple[Material, Material]
    factors: LoadFactors = LoadFactors()

    @property
    def torque(self) -> float:
        return self.torque_n_mm

    @property
    def factor(self) -> float:
        return self.factors.factor

    @property
    def pressure_angle(self) -> float:
        return self.pair.working_pressure_angle

    @cached_property
    def teeth(self) -> tuple[ToothStrength, ToothStrength]:
        start, end = self.pair.contact_lengths
        pitch, between = self.pair.first.base_pitch, self.pair.line_of_action
        # The outermost point of each flank at which its pair is alone.
        points = min(start + pitch, end), between - max(end - pitch, start)
        first, second = self.pair.first, self.pair.second
        return (
            self.tooth_strength(first, points[0], self.materials[0]),
            UNKNOWN if second.is_ring else self.tooth_strength(second, points[1], self.materials[1]),
        )

    @property
    def contact_pressure(self) -> float:
        pair, slope = self.pair, np.sin(self.pair.working_pressure_angle)
        return float(self.pressure_at(pair.working_radii[0] * slope))

    def pressure_at(self, along: float | Real, pairs: int | Real = 1) -> Real:
        """Hertz pressure at points of the line of action.

        Parameters
        ----------
        along : float or ndarray
            Length on the line of action, mm from the first gear's base circle.
        pairs : int or ndarray
            Number of pairs of teeth that share the force equally.

        Returns
        -------
        ndarray
            N/mm2; infinite at a base circle.
        """
        s1 = np.asarray(along, dtype=float)
        between = self.pair.line_of_action
        # The flank of a ring is concave.
        s2 = -(s1 + between) if self.pair.is_internal else between - s1
        with np.errstate(divide="ignore"):
            curvature = 1 / s1 + 1 / s2
        force = self.factor * self.normal_force / pairs
        return hertz_pressure(force, self.face_width, curvature, *self.materials)

    @property
    def torque_limit(self) -> float:
        """Torque on the first gear at which a safety falls to its limit, N mm; nan if a strength is unknown."""
        return self.torque * self.load_margin


@record
class PlanetaryStrength:
    """Forces and stresses of a planetary set, the same whichever member is fixed.

    Parameters
    ----------
    gears : PlanetarySet
        The gears; the planets share the torque equally.
    loads : GearLoads
        Torque on the driver, and load factors.
    face_widths : tuple of float
        Of sun and planet in contact, and of planet and ring, mm.
    materials : tuple of Material
        Of sun, planet and ring.
    driver : {"sun", "carrier", "ring"}, optional
        The member that drives.
    """

    gears: PlanetarySet
    loads: GearLoads
    face_widths: tuple[float, float]
    materials: tuple[Material, ...]
    driver: Member = "sun"

    @property
    def torques(self) -> dict[str, float]:
        """Torques that act on the set from outside, N mm, in the direction of the driver's; their sum is 0."""
        ring = self.gears.ring.teeth / self.gears.sun.teeth
        shares = {"sun": 1.0, "ring": ring, "carrier": -(1 + ring)}
        return {name: self.loads.torque_n_mm * share / shares[self.driver] for name, share in shares.items()}

    @cached_property
    def inner(self) -> PairStrength:
        """Sun and one planet."""
        torque, (sun, planet, _) = abs(self.torques["sun"]) / self.gears.planets, self.materials
        return PairStrength(self.gears.inner, torque, self.face_widths[0], (sun, planet), self.loads)

    @cached_property
    def outer(self) -> PairStrength:
        """One planet and the ring, with the same force between the teeth."""
        torque, (_, planet, ring) = self.inner.normal_force * self.gears.planet.base_radius, self.materials
        return PairStrength(self.gears.outer, torque, self.face_widths[1], (planet, ring), self.loads)

    @property
    def planet_bearing_load(self) -> float:
        """Force of the carrier on each planet, N: both forces on its teeth together."""
        along = self.inner.tangential_force + self.outer.tangential_force
        return float(np.hypot(along, self.outer.radial_force - self.inner.radial_force))

    @property
    def sun_bearing_load(self) -> float:
        """Force on the sun's bearing, N: those of several planets balance each other."""
        return 0.0 if self.gears.planets > 1 else self.inner.normal_force

    @property
    def torque_limit(self) -> float:
        """Torque on the driver at which a safety falls to its limit, N mm; nan if a strength is unknown."""
        return self.loads.torque_n_mm * float(np.min([self.inner.load_margin, self.outer.load_margin]))


def pressure_column(loaded: PairStrength, contact: Table) -> Column:
    """Hertz pressure at the points of a `contact_table`, shared equally by the pairs of flanks in contact."""
    pressure = loaded.pressure_at(np.asarray(contact["along"]), np.asarray(contact["pairs"]))
    meaning = "pressure of the flanks by Hertz, if pairs in contact share the force equally"
    return Column("contact_pressure", "N/mm2", meaning, pressure)
