"""The base classes of all recipes: a recipe describes one mechanism, and computes all results on request."""

from __future__ import annotations

import copy
import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, Self

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.field_visitor import DeclaredField, fields_of, with_lengths
from ..core.fields import entry, moving_picture, quantity, to_digits
from ..core.records import record
from ..core.units import Units, in_sentences
from ..model.check import Check, WorkedFormula
from ..model.machinability import ADVICE, beam_checks, relieved, thinnest_walls, wall_checks
from ..model.material import Mass
from ..model.motor import RotatingBody
from ..model.part import Bought, Part
from ..model.scene import Candidate, Scene
from ..model.table import Table
from ..plane.vec import Real
from .aspect import AbstractEdited, AbstractPlaced
from .printing import PRINT_IN_PLACE, Printing, apply_clearance, gap_check
from .settings import Files, OptimiseTable

# Properties of recipes that hold sentences.
TEXTS = frozenset({"steps", "notes", "facts", "forces_missing", "remarks", "subtitle", "quantities"})
# Tables that `scale` does not change: a mechanism of another size has the same screws, sheets and tolerances.
UNSCALED = ("stock", "base", "files", "tolerances", "optimise", "printing")
# Keys of stocks and bases that make a wall thicker: of openings and the sheet, and of the material around openings.
SMALLER = ("bore", "mate_bore", "roller_bore", "pivot_bore", "pin_diameter", "pin", "screw", "thickness")
LARGER = ("bar_width", "rim", "edge", "margin")
# Keys of stocks and bases that a workshop file has for each material.
FITS = frozenset({"clearance", "interference"})


def is_stock(key: str) -> bool:
    """Whether a key of a recipe is that of a stock or of the base, the tables that have fits."""
    return key == "base" or key.endswith("stock")


def _have_clearance(parts: Iterable[Part]) -> bool:
    """Whether a hole of these parts is wider by a clearance, not by a fit of ISO 286."""
    return any(fit and not fit.iso_fit and not fit.is_press for part in parts for fit in part.fits)


@record(kw_only=True)
class _Shared:
    """Keys of every kind."""

    expected_failures: Mapping[str, str] = dataclasses.field(
        default_factory=dict,
        hash=False,
        metadata={
            "description": 'checks that fail on purpose, by id: transmission_angle = "the reason"',
            "examples": [{}],
        },
    )
    units: Units = entry("unit of all lengths in the recipe, its files and its messages", default="mm")
    optimise: OptimiseTable | None = entry(
        "what `geomkin optimise` varies, minimises and keeps; `geomkin run` does not use it", default=None
    )
    printing: Printing | None = entry(
        "printed parts: the clearance of all that turns or meshes, and the shape of solids", default=None
    )

    def __post_init__(self) -> None:
        apply_clearance(self)

    @property
    def has_snap_pins(self) -> bool:
        """Whether pins are printed."""
        return self.printing is not None and self.printing.pins == "snap"

    @property
    def is_in_place(self) -> bool:
        """Whether the assembly is printed in one piece."""
        return self.printing is not None and self.printing.in_place


# Keys of every kind. Recipes list them after the mechanism's own keys; summaries omit them if they are empty.
SHARED = tuple(field.name for field in dataclasses.fields(_Shared))


@record
class _Applied:
    """Keys that loading applies, so that no class has them as fields."""

    workshop: str | None = entry(
        "file with the kerf and the fits of your materials, such as workshop/laser.toml", default=None
    )
    scale: float = quantity(
        "multiplies all lengths, also in units: torques and speeds in mm/s by it, inertias in kg mm2 by its square, "
        "stiffnesses in N/mm by its inverse; not masses, forces and angles, nor what is bought, stock, base, files, "
        "tolerances, printing and optimise",
        default=1.0, at_least=1e-6, at_most=1e6,
    )  # fmt: skip


def _in_sentences(texts: property) -> property:
    """A property of texts whose lengths are marked, as one of sentences."""
    return property(lambda recipe: in_sentences(texts.__get__(recipe)), doc=texts.__doc__)


@dataclasses.dataclass(frozen=True)
class Additions:
    """How tables are added to recipes of a kind, besides by the examples of their fields.

    refused: keys of tables that no recipe of the kind can have, and `key=kind` of those that it cannot have of a kind.
    """

    refused: tuple[str, ...] = ()

    def unavailable(self, recipe: Any) -> Iterator[str]:
        """Keys of tables that a recipe cannot have as it is, such as what walks of a linkage without feet."""
        yield from self.refused

    def names(self, recipe: Any) -> Mapping[str, Sequence[Any]]:
        """Names in a recipe by the keys that state them in an added table, such as `body`, the most likely first."""
        return {}

    def changes(self, recipe: Any, key: str) -> Iterator[Mapping[str, Any]]:
        """Values by dotted key that add the table `key`, those to be tried first."""
        return iter(())


class _InSentences:
    """Base class of recipes: their texts read in mm, and know their lengths."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        for name in vars(cls).keys() & TEXTS:
            setattr(cls, name, _in_sentences(vars(cls)[name]))

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        """Formulas with their numbers put in, from which the results follow by hand; empty if the kind has none."""
        return ()


class AbstractRecipe(_Shared, _InSentences, AbstractPlaced, AbstractEdited, ABC):
    """A recipe: a frozen dataclass of keyword arguments, with all results as properties.

    A subclass has the field `kind`, a Literal with a single value, then its tables, the mechanism's first and `files`
    last; its docstring introduces the kind. A property is computed on first use and cached. It may raise DesignError,
    whose field is a size of the mechanism or a dotted key of the recipe.
    """

    kind: str
    files: Files
    # Name of the folder and the files; "" stands for the kind. It is not a field: recipes that differ only in their
    # names are equal.
    name: str = ""
    # The table that the recipe was loaded from, with the values of its workshop file; None if it was made in Python.
    loaded_table: Mapping[str, Any] | None = None
    # Whether a recipe of the kind takes the key `scale`, as those of linkages and cams do.
    can_be_scaled: ClassVar[bool] = False
    # Whether it takes the key `workshop`; a recipe of several recipes leaves it to these.
    takes_workshop: ClassVar[bool] = True
    # Whether its pins can be printed, and whether it can be printed as it is assembled.
    takes_snap_pins: ClassVar[bool] = False
    prints_in_place: ClassVar[bool] = False
    # A sentence that a template adds to the description of the kind.
    advice: ClassVar[str] = ""
    additions: ClassVar[Additions] = Additions()
    # Every subclass is a dataclass, which a type checker cannot know.
    __dataclass_fields__: ClassVar[dict[str, dataclasses.Field[Any]]]

    _repr_html_ = moving_picture

    @property
    def is_in_own_file(self) -> bool:
        """Whether it has a name, by which another recipe that contains it states it."""
        return bool(self.name)

    @property
    @abstractmethod
    def design(self) -> object:
        """The mechanism as a type of the library, such as FourBar, Cam or SpurGear."""

    @property
    @abstractmethod
    def table(self) -> Table:
        """Motion and quantities of the mechanism, one row for each frame."""

    @property
    @abstractmethod
    def parts(self) -> tuple[Part, ...]:
        """The parts to make."""

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Items to buy that join the parts; empty if the kind has none."""
        return ()

    @property
    def steps(self) -> tuple[str, ...]:
        """Assembly steps from the bottom up, one line each; empty if the kind has none."""
        return ()

    @cached_property
    def body_masses(self) -> Mapping[str, Mass]:
        """Mass of each body in its frame, by name, if its parts have a material."""
        return part_masses(self.parts)

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the mechanism, of the walls of its parts, and of the corners that a cutting beam does not reach."""
        # Parts first, since they may raise an error.
        walls = wall_checks(self.parts, self.files.kerf, self.walls, self.wall_advice)
        files = self.files
        cut = [relieved(part, files.cutter) for part in self.parts]
        checks = (*self.design_checks, *walls, *beam_checks(cut, max(files.kerf, files.cutter), files.tolerance))
        reasons = self.expected_failures
        return tuple(replace(check, expected=reasons.get(check.id, check.expected)) for check in checks)

    def wall_advice(self, part: Part) -> str:
        """What makes the walls of a part thicker: keys of the stock that is named after it, or else of all stocks."""
        stocks = [field.name for field in dataclasses.fields(self) if is_stock(field.name)]
        own = [key for key in stocks if key.removesuffix("stock").strip("_") == part.name]
        own = own or [key for key in stocks if key != "base"] or stocks
        smaller, larger = (
            " or ".join(f"{key}.{name}" for key in own for name in names if hasattr(getattr(self, key), name))
            for names in (SMALLER, LARGER)
        )
        if not smaller:
            return ADVICE
        return f"give a smaller {smaller}" + (f", or a larger {larger}" if larger else "")

    @cached_property
    def walls(self) -> Mapping[str, float]:
        """The thinnest wall of each part, mm, by the part's name; inf for one that has none.

        A wall is between two openings, between an opening and the edge, or between the sides of a neck narrower than
        twice the limit of its check. For a twisted part it is the thinnest of any slice.
        """
        return thinnest_walls(self.parts, self.files.kerf)

    @property
    def scene(self) -> Scene | None:
        """The moving drawing; None if the kind has none."""
        return None

    @property
    def notes(self) -> Mapping[str, object]:
        """Further entries of summary.json."""
        return {}

    @property
    def shaft_items(self) -> tuple[Bought, ...]:
        """Items of `bought` that a machine's shaft replaces if it is at their joint, each for one joint only."""
        return ()

    @property
    def sources(self) -> Mapping[str, str]:
        """Texts of the files that the recipe reads, by name; summary.json keeps them."""
        return {}

    @property
    def assumed_fits(self) -> Mapping[str, float]:
        """Kerf and fits that neither the recipe nor its workshop file states, mm, by dotted key.

        Empty for a recipe made in Python.
        """
        if self.loaded_table is None:
            return {}
        values: dict[str, float] = {}
        for key in (field.name for field in dataclasses.fields(self)):
            table, stated = getattr(self, key), self.loaded_table.get(key, {})
            if not isinstance(stated, Mapping) or not getattr(table, "has_fits", True):
                continue
            is_pressed = "press" in (getattr(table, "fit", ""), getattr(table, "mate_fit", ""))
            has_class = any(getattr(table, name, "") for name in ("pin_fit", "iso_fit"))
            has_class = has_class and not _have_clearance(self.parts)
            stock = ("interference",) * is_pressed if has_class else ("clearance", *["interference"] * is_pressed)
            stock = stock if self.printing is None else tuple(fit for fit in stock if fit != "clearance")
            fits = stock if is_stock(key) else ("kerf",) * (key == "files")
            values |= {f"{key}.{fit}": getattr(table, fit) for fit in fits if fit not in stated and hasattr(table, fit)}
        return values

    @property
    def facts(self) -> tuple[str, ...]:
        """Lines that `geomkin run` and `geomkin check` print below the checks."""
        return ()

    @property
    def forces_missing(self) -> str:
        """Why the effort of the driver and the forces are not reported; empty if they are, or if nothing moves."""
        return ""

    @property
    def further_values(self) -> Mapping[str, Real]:
        """Values at each frame, by id, that formulas may use besides the columns of the table."""
        return {}

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on the result that its page and the terminal show."""
        return ()

    @classmethod
    def applied_fields(cls) -> dict[str, DeclaredField]:
        """The keys of the kind that loading applies."""
        is_taken = {"workshop": cls.takes_workshop, "scale": cls.can_be_scaled}
        return {key: declared for key, declared in fields_of(_Applied).items() if is_taken[key]}

    @classmethod
    def about(cls) -> str:
        """One line that introduces the kind."""
        return " ".join((cls.__doc__ or "").split("\n\n")[0].split())

    @property
    def subtitle(self) -> str:
        """One line that introduces this mechanism; by default that of its kind."""
        return self.about()

    @classmethod
    def example_values(cls, tables: Mapping[str, str]) -> Mapping[str, object]:
        """Values by dotted key for a template with some optional tables; other keys take the examples of the fields.

        tables: kind of each of these tables, by dotted key.
        """
        return {}

    def at_scale(self, scale: float) -> Self:
        """The same recipe with every length multiplied, except in `UNSCALED` tables; see `gk.scaled`."""
        recipe: Self = with_lengths(self, scale, UNSCALED)
        return recipe.with_name(self.name)

    @checked
    def with_name(self, name: str) -> Self:
        """The same recipe with another name for its folder and files."""
        other = copy.copy(self)
        object.__setattr__(other, "name", name)
        return other


def part_masses(parts: Iterable[Part]) -> dict[str, Mass]:
    """Mass by body: the sum over one copy of each part that has a body and a material."""
    bodies: dict[str, Mass] = {}
    for part in parts:
        if part.body and part.mass is not None:
            bodies[part.body] = bodies[part.body] + part.mass if part.body in bodies else part.mass
    return bodies


def assembly_summary(recipe: AbstractRecipe) -> Mapping[str, object]:
    """Items to buy, assembly steps and masses, as entries of summary.json; empty ones are left out."""
    entries = {"bought": [item.data for item in recipe.bought], "steps": list(recipe.steps)}
    return {**{name: lines for name, lines in entries.items() if lines}, **mass_summary(recipe)}


def mass_summary(recipe: AbstractRecipe) -> Mapping[str, object]:
    """Masses as an entry of summary.json; empty without a material."""
    bodies = {
        name: {
            "mass_kg": to_digits(float(mass.mass)),
            "centre_mm": [round(float(z), 6) + 0.0 for z in (mass.centre.real, mass.centre.imag)],
            "inertia_kg_mm2": to_digits(float(mass.inertia)),
        }
        for name, mass in recipe.body_masses.items()
    }
    return {"masses": bodies} if bodies else {}


@checked
def masses(recipe: AbstractRecipe) -> dict[str, Mass]:
    """Mass properties of the bodies of a recipe, computed from its parts.

    Parameters
    ----------
    recipe : AbstractRecipe
        A recipe whose stock names a material.

    Returns
    -------
    dict of str to Mass
        Mass of each body in its frame: plates from their exact outlines and holes; in linkages and cams also screws,
        rods and pins, of steel. A pin belongs to the body of its lowest plate. With several copies, the mass of one.

    Raises
    ------
    DesignError
        If no part has a material.

    See Also
    --------
    Mass, forces, balance

    Examples
    --------
    >>> recipe = gk.load({
    ...     "kind": "spur-gear", "gear": {"teeth": 24, "module": 2}, "stock": {"material": "steel-C45"}
    ... })
    >>> gk.masses(recipe)["gear"]
    Mass(mass=0.0841871, inertia=24.4984)
    """
    if not recipe.body_masses:
        raise DesignError("stock.material", "is missing, so masses are unknown", "give a material", "missing-key")
    return dict(recipe.body_masses)


class AbstractGoal(AbstractRecipe):
    """A recipe that searches for another one, which is its `design` and supplies its parts, table and scene.

    A subclass finds the design, and adds the results of the search to `design_checks`, `parts` and `notes`.
    """

    @property
    @abstractmethod
    def design(self) -> AbstractRecipe:
        """The recipe that was found."""

    @property
    def cut_short(self) -> bool:
        """Whether a time limit ended the search, so that its result depends on the computer."""
        return False

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Designs among which one key of the recipe chooses; empty if there is nothing to choose."""
        return ()

    @property
    def table(self) -> Table:
        return self.design.table

    @property
    def parts(self) -> tuple[Part, ...]:
        return self.design.parts

    @property
    def bought(self) -> tuple[Bought, ...]:
        return self.design.bought

    @property
    def formulas(self) -> tuple[WorkedFormula, ...]:
        return self.design.formulas

    @property
    def steps(self) -> tuple[str, ...]:
        """Assembly steps of the found recipe, and a line for each drawing that the goal adds."""
        made = {part.name for part in self.design.parts}
        drawings = [part.name for part in self.parts if part.name not in made]
        return (*self.design.steps, *(f"{name} is a drawing, joined to nothing" for name in drawings))

    @property
    def body_masses(self) -> Mapping[str, Mass]:
        return self.design.body_masses

    @property
    def design_checks(self) -> tuple[Check, ...]:
        return self.design.design_checks

    @property
    def quantities(self) -> Mapping[str, str]:
        return self.design.quantities

    @property
    def shaft_items(self) -> tuple[Bought, ...]:
        return self.design.shaft_items

    @property
    def forces_missing(self) -> str:
        return "The search computes no driver effort and no joint forces; add the table loads to the found recipe."

    @property
    def remarks(self) -> tuple[str, ...]:
        return self.design.remarks

    @property
    def scene(self) -> Scene | None:
        return self.design.scene

    @property
    def rotating_bodies(self) -> Mapping[str, RotatingBody]:
        return self.design.rotating_bodies

    def scene_at(self, turn: Real) -> Scene:
        return self.design.scene_at(turn)

    def torque_at(self, turn: Real) -> Real | None:
        return self.design.torque_at(turn)

    @property
    def notes(self) -> Mapping[str, object]:
        notes = self.design.notes
        stack = notes.get("stack")
        return {**notes, "stack": {**stack, "steps": list(self.steps)}} if isinstance(stack, Mapping) else notes


class AssemblyLike(Protocol):
    """Items to buy and assembly steps; `making.assembly.Assembly` is one."""

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Shafts, screws and keys."""

    @property
    def shaft_items(self) -> tuple[Bought, ...]:
        """Shafts and their collars, each for one joint only."""

    @property
    def steps(self) -> tuple[str, ...]:
        """Assembly steps from the bottom up, one line each."""

    @property
    def snap_checks(self) -> tuple[Check, ...]:
        """Checks of printed pins."""


class AbstractAssembledRecipe(AbstractRecipe):
    """A recipe of gears or of a cam, whose items to buy and assembly steps come from one `assembly`."""

    @property
    @abstractmethod
    def assembly(self) -> AssemblyLike:
        """Shafts, keys, collars and screws, and the assembly steps."""

    @property
    def engagement_checks(self) -> Iterator[Check]:
        """Whether what a motor turns engages its shaft."""
        for stock in (getattr(self, field.name) for field in dataclasses.fields(self) if is_stock(field.name)):
            if hasattr(stock, "engagement_checks"):
                yield from stock.engagement_checks(getattr(self, "base", None) is not None)
        if self.has_snap_pins:
            yield from self.assembly.snap_checks
        if self.is_in_place:
            yield gap_check(self)

    @property
    def attached(self) -> Iterator[tuple[str, Any, float, int]]:
        """What is screwed to a gear: the plate, the attachment, the thickness of the sheet, mm, and the count."""
        for field in dataclasses.fields(self):
            stock = getattr(self, field.name)
            own = field.name.removesuffix("stock").strip("_") or "gear"
            for name, key in ((own, "attachments"), ("mate", "mate_attachments")):
                for item in getattr(stock, key, ()):
                    counts = {part.name: part.count for part in self.parts}
                    plate = "ring" if name not in counts and "ring" in counts else name
                    yield plate, item, stock.thickness, counts.get(plate, 1)

    @property
    def bought(self) -> tuple[Bought, ...]:
        own = (
            Bought(name, number * count, (plate,))
            for plate, item, sheet, count in self.attached
            for name, number in item.bill(sheet)
        )
        return (*(() if self.is_in_place else self.assembly.bought), *own)

    @property
    def shaft_items(self) -> tuple[Bought, ...]:
        return self.assembly.shaft_items

    @property
    def steps(self) -> tuple[str, ...]:
        steps = (PRINT_IN_PLACE,) if self.is_in_place else self.assembly.steps
        return (*(item.step(plate) for plate, item, *_ in self.attached), *steps)
