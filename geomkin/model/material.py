"""Materials: density, stiffness and strength, mass, pressure in a contact; and their table, by name in a recipe."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from math import nan
from typing import Annotated, Any

import numpy as np

from ..core.arguments import AnyFloat, PositiveFloat, checked
from ..core.errors import DesignError, shown
from ..core.field_visitor import WrittenForm
from ..core.fields import FARTHEST, ComplexOrArray, FloatOrArray, entry, quantity
from ..core.names import VisibleText
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

    name: VisibleText = entry("name of the material", example="oak")
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


class NamedIn(WrittenForm):
    """Marks a field for an entry of a table: in a recipe, its name, or a table of its values.

    Parameters
    ----------
    entries : mapping of str to any
        The table.
    key : str
        Key of the field in an error.
    keeps_name : bool
        Whether the field holds the name itself; otherwise it holds the entry.
    """

    def __init__(self, entries: Mapping[str, Any], key: str, keeps_name: bool = False) -> None:
        self.entries, self.key, self.keeps_name = entries, key, keeps_name

    @property
    def names(self) -> list[str]:
        return list(self.entries)

    def find(self, name: object, key: str = "name") -> Any:
        """The entry of a name; DesignError with the key if there is none."""
        if not isinstance(name, str) or name not in self.entries:
            needed = [f.name for f in fields(next(iter(self.entries.values()))) if f.default is MISSING]
            values = f"a table with the values {', '.join(needed)}"
            raise DesignError(key, f"found {shown(name)}", f"give {', '.join(self.entries)}, or {values}")
        return self.entries[name]

    def read(self, given: Any, folder: Any) -> Any:
        if not isinstance(given, str):
            return given
        found = self.find(given, self.key)
        return given if self.keeps_name else found

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        names = (name for name, known in self.entries.items() if value in (name, known))
        return next(names, None) or write(value)

    def schema(self, plain: dict[str, Any]) -> dict[str, Any]:
        table = plain["anyOf"][1] if "anyOf" in plain else plain
        return {"anyOf": [{"type": "string", "enum": list(self.entries)}, table]}


_PRESSURE = "pressure of a slowly turning dry steel pin chosen here"
# Typical values for a first estimate: sheets and prints differ by 10 to 30 %. Strengths are the lower ends of ranges.
# Those of printed plastics are for parts printed flat; parts printed upright carry half. Bearing pressures are chosen
# here: a quarter of the strength, or less if the material creeps or wears.
MATERIALS: dict[str, Material] = {
    material.name.replace(" ", "-"): material
    for material in (
        Material(
            "birch plywood", 680, 10_700, 0.3, 43, None, 3.0,
            f"12 mm along the grain, Handbook of Finnish plywood and Riga Wood 2022; across 6800 and 33; {_PRESSURE}",
        ),
        Material("MDF", 750, 2700, 0.3, 23, None, 2.0, f"EN 622-5, over 6 to 9 mm thick; {_PRESSURE}"),
        Material("acrylic", 1190, 3300, 0.37, 61, None, 3.0, f"makers' sheets, cast PMMA; {_PRESSURE}"),
        Material("POM", 1410, 2700, 0.36, 60, 60, 8.0, f"makers' sheets, POM-C; {_PRESSURE}"),
        Material("PLA", 1240, 3000, 0.36, 50, None, 3.0, f"makers' sheets, printed flat; {_PRESSURE}"),
        Material("PETG", 1270, 2000, 0.36, 44, None, 3.0, f"makers' sheets, printed flat; {_PRESSURE}"),
        Material("ABS", 1050, 2100, 0.37, 39, None, 2.0, f"makers' sheets; {_PRESSURE}"),
        Material("aluminium 5754", 2670, 70_000, 0.33, 190, 80, 5.0, f"EN 485-2, temper H111; {_PRESSURE}"),
        Material("aluminium 6061", 2700, 68_900, 0.33, 310, 276, 5.0, f"Aluminum Association, temper T6; {_PRESSURE}"),
        Material("steel S235", 7850, 210_000, 0.3, 360, 235, 10.0, f"EN 10025-2; {_PRESSURE}, greased"),
        Material("steel C45", 7850, 210_000, 0.3, 580, 340, 10.0, f"EN ISO 683-1, normalised; {_PRESSURE}, greased"),
        Material("brass", 8490, 97_000, 0.31, 338, 124, 10.0, f"UNS C36000, soft, makers' sheets; {_PRESSURE}"),
    )
}  # fmt: skip
# Screws, rods, pins and shafts, kg/m3.
STEEL_DENSITY = 7850.0


_NAMED = NamedIn(MATERIALS, "material")
# Field type of a material in the tables of a recipe.
MaterialKey = Annotated[Material, _NAMED]


def material(name: str) -> Material:
    """A material of the table.

    Parameters
    ----------
    name : str
        Such as "birch-plywood"; `MATERIALS` lists all.

    Returns
    -------
    Material

    Raises
    ------
    DesignError
        If there is no such material.

    Examples
    --------
    >>> gk.making.material("steel-S235").density
    7850
    """
    found: Material = _NAMED.find(name)
    return found


def material_entry(item: str) -> Any:
    """The field for the material of an item."""
    meaning = f"material of {item}, for masses and strength: {', '.join(MATERIALS)}, or a table of values"
    return entry(meaning, default=None)
