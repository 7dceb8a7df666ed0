"""The table `printing`: clearance of what turns or meshes, shape of printed parts, and the gap between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from itertools import combinations
from typing import Any, Literal

import numpy as np

from ..core.errors import DesignError
from ..core.field_visitor import Number, with_numbers
from ..core.fields import entry, quantity
from ..core.records import record
from ..core.units import marked, mm
from ..export.still import InPlace
from ..model.check import Check
from ..plane import region
from ..plane.flatten import flatten
from ..plane.vec import Complex, box_of

# Heights at which the sections of twisted parts are compared, over half of a herringbone: at each the teeth are in
# another phase of their mesh, in which the gaps of involutes are the same.
LEVELS = 16


@record
class Gap:
    """A lower bound of the smallest gap, mm, and the names of the two parts."""

    size: float
    parts: tuple[str, str]


def smallest_gap(placed: Sequence[InPlace], tolerance: float) -> Gap | None:
    """The smallest gap of any two parts, in all layers that both are in; None for a single part.

    Parts that lie on each other have none. tolerance: of the chords that are compared, mm, which counts as lost.
    """
    loops = [[flatten(curve, tolerance) for curve in (one.part.outline, *one.part.holes)] for one in placed]
    least: Gap | None = None
    for (one, its), (other, others) in combinations(zip(placed, loops), 2):
        for share in _shares(one, other):
            a, b = _section(one, its, share), _section(other, others, share)
            if least is None or _boxes_apart(a[0], b[0]) < least.size + 2 * tolerance:
                size = max(0.0, region.apart(a, b) - 2 * tolerance)
                if least is None or size < least.size:
                    least = Gap(size, (one.name, other.name))
    return least


def _shares(one: InPlace, other: InPlace) -> Iterator[float]:
    """Shares of the height at which sections are compared; none for parts with air between them."""
    low, high = max(one.height, other.height), min(part.height + part.part.thickness for part in (one, other))
    if high < low - 1e-9:
        return
    if one.part.twist is None and other.part.twist is None:
        yield 0.0
    else:
        yield from np.linspace(0, 0.5 if one.part.twist and one.part.twist.herringbone else 1, LEVELS).tolist()


def _section(one: InPlace, loops: Sequence[Complex], share: float) -> list[Complex]:
    """The outline and the holes of a part in its place, at a share of its height."""
    twist = one.part.twist
    moved = [
        loop if twist is None or (k == 0) != (twist.moves == "outline") else np.asarray(twist.at(share).place(loop))
        for k, loop in enumerate(loops)
    ]
    return [one.origin + one.direction * loop for loop in moved]


def _boxes_apart(a: Complex, b: Complex) -> float:
    """Distance of the boxes of two loops, mm."""
    (low, high), (other_low, other_high) = box_of(a), box_of(b)
    gap = np.array([other_low - high, low - other_high])
    return float(np.hypot(max(gap.real.max(), 0.0), max(gap.imag.max(), 0.0)))


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
    from ..export.job import Job
    from ..export.still import in_place

    files = recipe.files
    _, placed = in_place(Job(recipe.name, recipe, files.tolerance, assembly_at=files.assembly_at))
    gap = smallest_gap(placed, files.tolerance)
    size, parts = (gap.size, " and ".join(gap.parts)) if gap else (float("inf"), "a single part")
    advice = f"of {parts}: give a larger printing.clearance, and no part that lies on another, such as a carrier"
    return Check("gap_in_place", "smallest gap of parts in place", size, "at least", LEAST_GAP, "mm", advice)
