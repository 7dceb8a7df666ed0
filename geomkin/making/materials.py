"""Materials that parts are cut or printed from, and the key of a recipe that names one."""

from __future__ import annotations

from typing import Annotated, Any

from ..core.fields import entry
from ..model.material import Material
from .named import NamedIn

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
