"""The table `printing`: the clearance of everything that turns or meshes, and the shape of printed parts."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any, Literal

from ..core.errors import DesignError
from ..core.field_visitor import Number, with_numbers
from ..core.fields import entry, quantity
from ..core.records import record
from ..core.units import marked, mm

# Largest widening and chamfer of prints, mm. Nozzles are at most 2 mm wide; a larger number is a mistake of units.
MOST = 2.0


def growth(default: float | None) -> Any:
    """The field for the growth of prints."""
    meaning = "how much wider parts are printed than drawn; STL and 3MF move outlines in and holes out by half of it"
    return quantity(meaning, "mm", default=default, at_least=-MOST, at_most=MOST)


@record(checked=True)
class Printing:
    """How parts are printed."""

    clearance: float = quantity(
        "gap between everything that turns or meshes, half of it on each side: how much wider holes and slots are than "
        "pins and shafts, and the backlash of teeth; in place of the clearances and backlashes of all other tables",
        "mm",
        at_least=0,
        at_most=MOST,
        example=0.2,
    )
    growth: float = growth(0.0)
    foot: float = quantity(
        "chamfer of the lower edges of solids in STL and 3MF, since the first layer spreads; 0 for none",
        "mm",
        default=0.0,
        at_least=0,
        at_most=MOST,
    )
    pins: Literal["bought", "snap"] = entry(
        "pins, screws and shafts that are bought, or printed pins that snap into the plates", default="bought"
    )


def apply_clearance(recipe: Any) -> None:
    """Set the clearances and backlashes of a recipe that is being made to that of its table `printing`.

    Raises DesignError if a fit of ISO 286 states another one, or the recipe contains recipes.
    """
    if recipe.printing is None:
        return
    gap = recipe.printing.clearance
    if recipe.printing.pins == "snap" and not recipe.takes_snap_pins:
        problem = f"found snap, but a {recipe.kind} has no printed pins"
        raise DesignError("printing.pins", problem, 'give "bought", or omit it', "conflict")

    def changed(number: Number) -> Any:
        if not (share := number.declared.about.get("printed", 0.0)):
            return number.value
        table = getattr(recipe, number.key.partition(".")[0])
        return share * gap / (table.module if number.unit == "modules" else 1.0)

    for key in (field.name for field in fields(recipe)):
        table = getattr(recipe, key)
        for name in ("pin_fit", "iso_fit"):
            if getattr(table, name, ""):
                problem = f"found {mm(gap):g}, and {key} has the fit {getattr(table, name)}"
                raise DesignError("printing.clearance", problem, "omit that fit, or printing", "conflict")
        if key != "printing" and is_dataclass(table):
            try:
                object.__setattr__(recipe, key, with_numbers(table, changed, path=key))
            except DesignError as error:
                problem = f"found {mm(gap):g}, with which {key}.{error.field}: {marked(error.problem)}"
                raise DesignError("printing.clearance", problem, "give a smaller one", "conflict") from None
