"""A material: what parts weigh, and what stresses they carry."""

from __future__ import annotations

from ..core.fields import entry, quantity
from ..core.records import record


@record(checked=True)
class Material:
    """Density, stiffness and strength of a material; what is None is unknown.

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

    Examples
    --------
    >>> gk.Material("oak", density=700, modulus=11000, strength=60).carried_stress
    60
    """

    name: str = entry("name of the material", example="oak")
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
    source: str = entry("where the values are from", default="")

    @property
    def carried_stress(self) -> float | None:
        """Stress at which a part yields, or breaks if its yield strength is not known, N/mm2; None if neither is."""
        return self.yield_strength or self.strength
