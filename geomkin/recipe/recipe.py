"""What every recipe is: the text of one thing to make, and all that can be known of it."""

from __future__ import annotations

import copy
import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, Self

from ..core.arguments import checked
from ..core.errors import DesignError
from ..core.records import record
from ..core.reprs import moving
from ..core.scaling import with_lengths
from ..model.check import Check
from ..model.mass import Mass
from ..model.part import Bought, Part
from ..model.scene import Scene, SceneHandle
from ..model.table import Table
from ..model.walls import thinnest_walls, wall_checks
from ..plane.vec import Complex
from .settings import Files

# Tables of what is bought, cut from and written: a mechanism of another size has the same screws and sheets.
UNSCALED = ("stock", "base", "files")


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


class AbstractRecipe(_Shared, ABC):
    """A recipe: a frozen dataclass of keyword arguments, on which all that can be known of it hangs.

    A subclass has the field `kind`, a Literal with itself as default, then its tables, the mechanism's first, and
    `files` last; its docstring introduces the kind. What is asked of it is worked out then, and kept. Any of it may
    raise DesignError, whose field is a size of the mechanism or a dotted key of the recipe.
    """

    kind: str
    files: Files
    # Of the folder and the files that are made; "" for that of the kind. It is no field: no table may have its name,
    # and recipes that differ in nothing else are equal.
    name: str = ""
    # Whether a recipe of the kind takes the key `scale`, as those of linkages and cams do.
    can_be_scaled: ClassVar[bool] = False
    # What a template says of the kind, besides what it is.
    advice: ClassVar[str] = ""
    # Every subclass is a dataclass, which a type checker cannot know.
    __dataclass_fields__: ClassVar[dict[str, dataclasses.Field[Any]]]

    _repr_html_ = moving

    @property
    @abstractmethod
    def design(self) -> object:
        """The mechanism: sizes as the library takes them, such as FourBar, Cam or SpurGear."""

    @property
    @abstractmethod
    def table(self) -> Table:
        """What the mechanism does, over its frames."""

    @property
    @abstractmethod
    def parts(self) -> tuple[Part, ...]:
        """What is cut."""

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Bought items that join the parts; empty if a kind does not state them."""
        return ()

    @property
    def steps(self) -> tuple[str, ...]:
        """How the parts are put together, a line each, from the bottom up; empty if a kind does not state it."""
        return ()

    @property
    def assembly_summary(self) -> Mapping[str, object]:
        """Bought items, steps and masses, as entries of summary.json; empty ones are left out."""
        entries = {"bought": [item.data for item in self.bought], "steps": list(self.steps)}
        return {**{name: lines for name, lines in entries.items() if lines}, **self.mass_summary}

    @cached_property
    def body_masses(self) -> Mapping[str, Mass]:
        """Mass of each moving or fixed body, in its frame, by name; of bodies whose parts have a material."""
        return part_masses(self.parts)

    @property
    def mass_summary(self) -> Mapping[str, object]:
        """Masses as an entry of summary.json; empty without a material."""
        bodies = {
            name: {
                "mass_kg": float(f"{mass.mass:.9g}"),
                "centre_mm": [round(float(z), 6) + 0.0 for z in (mass.centre.real, mass.centre.imag)],
                "inertia_kg_mm2": float(f"{mass.inertia:.9g}"),
            }
            for name, mass in self.body_masses.items()
        }
        return {"masses": bodies} if bodies else {}

    @property
    @abstractmethod
    def design_checks(self) -> tuple[Check, ...]:
        """Whether the mechanism is good; the walls of its parts come besides."""

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """Whether the mechanism is good, and whether its parts hold when they are cut."""
        # Parts first: a refusal comes before failed checks.
        walls = wall_checks(self.parts, self.files.kerf, self.walls)
        reasons = self.expected_failures
        return tuple(replace(check, expected=reasons.get(check.id, "")) for check in (*self.design_checks, *walls))

    @property
    def unknown_expectations(self) -> tuple[str, ...]:
        """A sentence for each entry of `expected_failures` that is the id of no check."""
        from .messages import nearest

        ids = [check.id for check in self.checks]
        return tuple(
            f"expected_failures.{id}: no check has this id; {nearest(id, ids)}the checks are {', '.join(ids)}"
            for id in self.expected_failures
            if id not in ids
        )

    @cached_property
    def walls(self) -> Mapping[str, float]:
        """The thinnest wall of each part, mm, by the part's name; inf for one that has none.

        Between two openings, an opening and the edge, or two sides of a neck that is less than two of the limit wide
        that checks hold it to. Of what is twisted, the least that any slice may have.
        """
        return thinnest_walls(self.parts, self.files.kerf)

    @property
    def scene(self) -> Scene | None:
        """How it looks moving: None for a kind that shows nothing."""
        return None

    @property
    def handles(self) -> tuple[SceneHandle, ...]:
        """What an editor lets a user drag. It needs no plates and no search, since a drag computes it repeatedly."""
        return ()

    def handle_position(self, id: str) -> Complex:
        """Positions of the handle of this id at the frames, as `handles` has them."""
        return next(handle.at for handle in self.handles if handle.id == id)

    @classmethod
    def has_scene(cls) -> bool:
        """Whether the kind has a scene; known without computing it."""
        return cls.scene is not None and cls.scene is not AbstractRecipe.scene

    @property
    def notes(self) -> Mapping[str, object]:
        """Further entries of summary.json."""
        return {}

    @property
    def facts(self) -> tuple[str, ...]:
        """Lines that `geomkin check` prints below the checks."""
        return ()

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on the result that its page and the terminal show."""
        return ()

    @property
    def found_recipe(self) -> AbstractRecipe | None:
        """The recipe that a goal found, which is written beside its files; None for a kind that is no goal."""
        return None

    @classmethod
    def about(cls) -> str:
        """One line that introduces the kind."""
        return " ".join((cls.__doc__ or "").split("\n\n")[0].split())

    @property
    def subtitle(self) -> str:
        """One line that introduces what is made: that of the kind, where that says enough."""
        return self.about()

    @classmethod
    def example_values(cls, asked: Mapping[str, str]) -> Mapping[str, object]:
        """Sizes, by dotted key, that make an example of the tables that a template is asked to show.

        asked: dotted key -> kind of table. What this leaves out is made of the examples of its fields.
        """
        return {}

    def at_scale(self, scale: float) -> Self:
        """The same with every length multiplied, but for those of `UNSCALED` tables; see `gk.scaled`."""
        found: Self = with_lengths(self, scale, UNSCALED)
        return found.with_name(self.name)

    @checked
    def with_name(self, name: str) -> Self:
        """The same recipe under another name, that of its folder and files."""
        other = copy.copy(self)
        object.__setattr__(other, "name", name)
        return other


def part_masses(parts: Iterable[Part]) -> dict[str, Mass]:
    """Sum of the masses of one copy of each part by body; without parts that have no body or no material."""
    bodies: dict[str, Mass] = {}
    for part in parts:
        if part.body and part.mass is not None:
            bodies[part.body] = bodies[part.body] + part.mass if part.body in bodies else part.mass
    return bodies


@checked
def masses(recipe: AbstractRecipe) -> dict[str, Mass]:
    """Mass properties of the bodies of a recipe, from its parts as they are cut.

    Parameters
    ----------
    recipe : AbstractRecipe
        A recipe whose stock names a material.

    Returns
    -------
    dict of str to Mass
        Of each body, in its own frame: plates from their exact outlines and holes; in linkages and cams also screws,
        rods and pins, of steel. A pin belongs to the body of its lowest plate. With several copies, of one.

    Raises
    ------
    DesignError
        If no part has a material.

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
    """A recipe that finds another one: its `design` is that recipe, and what is known of that one is handed on.

    A subclass finds the design, and adds the facts of the search to `design_checks`, `parts` and `notes`.
    """

    @property
    @abstractmethod
    def design(self) -> AbstractRecipe:
        """The recipe that was found."""

    @property
    def facts(self) -> tuple[str, ...]:
        """Lines that `geomkin check` prints below the checks."""
        return ()

    @property
    def found_recipe(self) -> AbstractRecipe:
        return self.design

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
    def steps(self) -> tuple[str, ...]:
        """Those of the recipe found; drawings that the goal adds are joined to nothing."""
        held = {part.name for part in self.design.parts}
        drawn = [part.name for part in self.parts if part.name not in held]
        return (*self.design.steps, *(f"{name} is a drawing, joined to nothing" for name in drawn))

    @property
    def body_masses(self) -> Mapping[str, Mass]:
        return self.design.body_masses

    @property
    def design_checks(self) -> tuple[Check, ...]:
        return self.design.design_checks

    @property
    def scene(self) -> Scene | None:
        return self.design.scene

    @property
    def notes(self) -> Mapping[str, object]:
        notes = self.design.notes
        stack = notes.get("stack")
        return {**notes, "stack": {**stack, "steps": list(self.steps)}} if isinstance(stack, Mapping) else notes


class Assembly(Protocol):
    """Bought parts and assembly steps of a mechanism, as `making` and `linkage` have them."""

    @property
    def bought(self) -> tuple[Bought, ...]:
        """Shafts, screws and keys."""

    @property
    def steps(self) -> tuple[str, ...]:
        """A line for each step, from the bottom up."""


class AbstractAssembledRecipe(AbstractRecipe):
    """A recipe of gears or of a cam. Bill and steps come from one thing, so that names and letters agree."""

    @property
    @abstractmethod
    def assembly(self) -> Assembly:
        """Shafts and keys, what holds them and the base, and how all of it goes together."""

    @property
    def bought(self) -> tuple[Bought, ...]:
        return self.assembly.bought

    @property
    def steps(self) -> tuple[str, ...]:
        return self.assembly.steps
