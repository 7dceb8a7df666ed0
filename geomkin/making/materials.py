"""Entries of tables by name in a recipe, and the table of materials that parts are cut or printed from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from typing import Annotated, Any

from ..core.errors import DesignError, shown
from ..core.field_visitor import WrittenForm
from ..core.fields import entry
from ..model.material import Material


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
