"""A material and the mass of a body made of it: density, stiffness and strength, and the pressure in a contact."""

from __future__ import annotations

from math import nan

import numpy as np

from ..core.arguments import AnyFloat, PositiveFloat, checked
from ..core.fields import FARTHEST, ComplexOrArray, FloatOrArray, entry, quantity
from ..core.names import VisibleName, VisibleText
from ..core.records import record
from ..plane.vec import Real

# Pressure of a line contact over the yield strength at which the material first yields, below the surface, by Tresca:
# the greatest shear there is 0.3003 of the pressure (Johnson, Contact Mechanics, section 4.2).
YIELDING = 0.5 / 0.3003


@record(checked=True)
class Material:
    """Density, stiffness and strength of a material; None stands for unknown.

    Parameters
    ----------
    name : str
        For people, such as "birch plywood".
    density : float
        kg/m3, above 0.
    modulus : float, optional
        Modulus of elasticity, N/mm2.
    poisson_ratio : float, optional
        Ratio of lateral contraction to extension, 0 to 0.5.
    strength : float, optional
        Tensile strength, N/mm2; of wood the bending strength.
    yield_strength : float, optional
        Stress at which it yields, N/mm2; None for materials that break or creep first.
    bearing_pressure : float, optional
        Pressure that a pin turning slowly in a hole may exert, force over diameter and thickness, N/mm2.
    source : str, optional
        Where the values are from.

    See Also
    --------
    Mass, masses

    Examples
    --------
    >>> gk.Material("oak", density=700, modulus=11000, strength=60).carried_stress
    60
    """

    name: VisibleName = entry("name of the material", example="oak")
    density: float = quantity("density", "kg/m3", above=0, at_most=30_000, example=700)
    modulus: float | None = quantity("modulus of elasticity", "N/mm2", default=None, above=0, at_most=1e7)
    poisson_ratio: float = quantity("Poisson's ratio", default=0.3, at_least=0, at_most=0.5)
    strength: float | None = quantity(
        "tensile strength, of wood the bending strength", "N/mm2", default=None, above=0, at_most=1e5
    )
    yield_strength: float | None = quantity("yield strength", "N/mm2", default=None, above=0, at_most=1e5)
    bearing_pressure: float | None = quantity(
        "pressure that a slowly turning pin may exert in a hole", "N/mm2", default=None, above=0, at_most=1e5
    )
    source: VisibleText = entry("where the values are from", default="")

    @property
    def carried_stress(self) -> float | None:
        """Stress at which a part yields, or breaks if its yield strength is not known, N/mm2; None if neither is."""
        return self.yield_strength or self.strength

    @property
    def yielding_pressure(self) -> float:
        """Pressure of a line contact at which the material begins to yield, N/mm2; nan if its strength is unknown."""
        return YIELDING * (self.carried_stress or nan)


@checked
def hertz_pressure(force: AnyFloat, length: PositiveFloat, curvature: AnyFloat, one: Material, other: Material) -> Real:
    """Greatest pressure in the contact of two bodies along a line.

    Parameters
    ----------
    force : float or array_like
        Force that presses them together, N; no pressure if it is negative.
    length : float
        Length of the line, mm.
    curvature : float or array_like
        Sum of both curvatures across the line, 1/mm, negative for a concave body.
    one, other : Material
        Their materials.

    Returns
    -------
    ndarray
        N/mm2; nan if a modulus of elasticity is unknown.

    Notes
    -----
    Johnson, Contact Mechanics, section 4.2.

    Examples
    --------
    >>> steel = gk.Material("steel", 7850, modulus=206000)
    >>> float(gk.model.hertz_pressure(500, 10, 1 / 40 + 1 / 10, steel, steel).round(4))
    474.5293
    """
    compliance = sum((1 - body.poisson_ratio**2) / (body.modulus or nan) for body in (one, other))
    load = np.maximum(np.asarray(force, dtype=float), 0) / length
    pressure: Real = np.sqrt(load * np.maximum(np.asarray(curvature, dtype=float), 0) / (np.pi * compliance))
    return pressure


@record(checked=True, arrays=True)
class Mass:
    """Mass properties of a rigid body, in the body's own frame.

    Parameters
    ----------
    mass : float or array
        kg; at least 0.
    centre : complex or array
        Centre of mass, mm in the body's frame.
    inertia : float or array
        Moment of inertia about the centre, kg mm2; at least 0.

    See Also
    --------
    masses, Material, Loads

    Notes
    -----
    The sum of two is that of the rigid body made of both, in the frame that both are stated in. Arrays have the shape
    (linkages,): one value for each of many linkages.

    Examples
    --------
    >>> import geomkin as gk
    >>> gk.Mass(2.0, inertia=50.0) + gk.Mass(1.0, centre=30)
    Mass(mass=3, centre=10+0j, inertia=650)
    """

    mass: FloatOrArray = quantity("mass", "kg", at_least=0, at_most=FARTHEST, example=0.2)
    centre: ComplexOrArray = entry("centre of mass in the body's frame, [x, y] in mm", default=0j, example=20 + 0j)
    inertia: FloatOrArray = quantity(
        "moment of inertia about the centre", "kg mm2", default=0.0, at_least=0, at_most=FARTHEST**2, example=100
    )

    def __add__(self, other: Mass) -> Mass:
        mass = self.mass + other.mass
        share = other.mass / np.where(mass == 0, 1.0, mass)
        apart = other.centre - self.centre
        # Parallel axes: both masses together add mass x other mass / sum x distance squared about the common centre.
        inertia = self.inertia + other.inertia + self.mass * share * np.abs(apart) ** 2
        return Mass(mass, self.centre + share * apart, inertia)
