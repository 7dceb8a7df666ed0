"""The table `printing`: the clearance of everything that turns or meshes, and the shape of printed parts."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any, Literal

from ..core.errors import DesignError
from ..core.field_visitor import Number, with_numbers
from ..core.fields import entry, quantity
from ..core.records import record
from ..core.units import marked, mm
from ..model.check import Check

# Largest widening and chamfer of prints, mm. Nozzles are at most 2 mm wide; a larger number is a mistake of units.
MOST = 2.0
# Least chamfer, mm. The corners of a smaller one coincide.
LEAST_FOOT = 0.01
# Least gap of parts that are printed in place, mm: printers join what is nearer; chosen here. 0.2 is safer.
LEAST_GAP = 0.1
# The one assembly step.
PRINT_IN_PLACE = (
    "print the file of the format assembly-3mf as it is; turn the parts until they are free; supply shafts for bores"
)


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
        "chamfer of the lower edges of solids in STL and 3MF, since the first layer spreads; 0 for none", "mm",
        default=0.0, at_least=0, at_most=MOST,
    )  # fmt: skip
    pins: Literal["bought", "snap"] = entry(
        "pins, screws and shafts that are bought, or printed pins that snap into the plates", default="bought"
    )
    in_place: bool = entry(
        "print the assembly in one piece, by the format assembly-3mf; its parts must not touch", default=False
    )

    def __post_init__(self) -> None:
        if 0 < self.foot < LEAST_FOOT:
            remedy = f"give 0 for none, or at least {mm(LEAST_FOOT):up}"
            raise DesignError("foot", f"found {mm(self.foot):.4g}", remedy, "out-of-range", value=0.0)


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
    if recipe.printing.in_place and not recipe.prints_in_place:
        problem = f"found true, but the parts of a {recipe.kind} are not held by each other in one layer"
        raise DesignError("printing.in_place", problem, "omit it", "conflict")
    if recipe.printing.in_place and getattr(recipe, "base", None) is not None:
        problem = "found true, but the gears would be printed onto a base"
        raise DesignError("printing.in_place", problem, "omit it, or base", "conflict")

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


def gap_check(recipe: Any) -> Check:
    """Check of the smallest gap between the parts of an assembly that is printed in one piece, where it is printed."""
    # Imported only if needed, since the readers of recipes need no solids.
    from ..export.in_place_gap import smallest_gap
    from ..export.job import Job
    from ..export.still import in_place

    files = recipe.files
    _, placed = in_place(Job(recipe.name, recipe, files.tolerance, assembly_at=files.assembly_at))
    gap = smallest_gap(placed, files.tolerance)
    size, parts = (gap.size, " and ".join(gap.parts)) if gap else (float("inf"), "a single part")
    advice = f"of {parts}: give a larger printing.clearance, and no part that lies on another, such as a carrier"
    return Check("gap_in_place", "smallest gap of parts in place", size, "at least", LEAST_GAP, "mm", advice)
