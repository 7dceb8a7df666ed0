"""A mechanism of a machine in a recipe: its own recipe, inline or in a file, and its place on the shafts."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Annotated, Any, NoReturn

from ..core.errors import DesignError, RecipeError, shown
from ..core.field_visitor import WrittenForm
from ..core.fields import FARTHEST, entry, quantity
from ..core.names import read_text_file
from ..core.records import record
from ..recipe.load import from_table
from ..recipe.recipe import AbstractRecipe
from ..recipe.toml import LARGEST, parsed

# The name of a recipe's file: no folder.
FILE_NAME = re.compile(r"[^/\\]+\.toml")


class RecipeOrFile(WrittenForm):
    """Marks a recipe that a table gives inline, or by the name of a file next to the file of the table."""

    def read(self, given: Any, folder: Any) -> Any:
        return _read(given, folder)

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        return f"{value.name}.toml" if value.name else write(value)


def _read(given: object, folder: Any) -> AbstractRecipe:
    """The recipe of an inline table or of a file in the folder."""
    if isinstance(given, AbstractRecipe):
        return given
    try:
        file, table = "recipe", given
        if isinstance(given, str):
            if not FILE_NAME.fullmatch(given):
                remedy = 'give the name of a file next to this one, such as "leg.toml"'
                raise DesignError("", f"found {shown(given)}", remedy, "out-of-range")
            file = given
            text = read_text_file(given, folder, "the file of a recipe")
            if len(text) > LARGEST:
                problem = f"{given} is larger than {LARGEST:,} bytes"
                raise DesignError("", problem, "give a recipe, a short TOML file", "too-much-work")
            table = parsed(text, given)
        if not isinstance(table, Mapping):
            remedy = 'give a file next to this one, such as "leg.toml", or a table with kind'
            raise DesignError("", f"found {shown(given)}", remedy, "wrong-type")
        # A machine is refused before its own mechanisms are read, for files may name each other in a circle.
        if table.get("kind") == "machine":
            refuse_machine()
        recipe = from_table(table, file, folder)
        return recipe.with_name(file.removesuffix(".toml")) if isinstance(given, str) else recipe
    except RecipeError as error:
        first = error.problems[0]
        raise DesignError(first.key, first.problem, first.remedy, first.id, first.value) from None


def refuse_machine(key: str = "kind") -> NoReturn:
    """DesignError for a machine as a mechanism of a machine. key: of its kind."""
    remedy = "give its mechanisms in this recipe, or a recipe of another kind"
    raise DesignError(key, "found a machine in a machine", remedy, "conflict")


@record(checked=True, kw_only=True)
class Mechanism:
    """A mechanism of a machine."""

    recipe: Annotated[AbstractRecipe, RecipeOrFile()] = entry(
        'its recipe: a file next to this one, such as "leg.toml", or a table with kind',
        example="leg.toml",
    )
    turned_by: str | None = entry(
        'the body that turns its driver, such as "pair.second"; omitted for the one that a motor or a hand drives',
        default=None,
    )
    phase_deg: float = quantity(
        "rotation of its driver from its own first position when the machine is at its first",
        "deg",
        default=0.0,
        at_least=-360,
        at_most=360,
    )
    angle_deg: float = quantity(
        "rotation of the whole mechanism about the axis of its driver", "deg", default=0.0, at_least=-360, at_most=360
    )
    mirrored: bool = entry(
        "whether it is turned over, left for right, about the axis of its driver; its layers are then reversed too",
        default=False,
    )
    foot: str | None = entry(
        "point of its linkage that stands on the ground and carries its share of the weight of the machine; by default "
        "the foot of its recipe",
        default=None,
    )
    gap: float = quantity(
        "height of the tubes between it and the mechanism below, mm: of nuts, collars and a motor", "mm", default=0.0,
        at_least=0, at_most=FARTHEST,
    )  # fmt: skip
    upside_down: bool = entry("whether its layers are in the reverse order, its ground on top", default=False)

    @property
    def is_reversed(self) -> bool:
        """Whether its layers are in the reverse order in the machine."""
        return self.mirrored != self.upside_down


@contextmanager
def errors_of(name: str) -> Iterator[None]:
    """Name the mechanism in a DesignError of its recipe."""
    try:
        yield
    except DesignError as error:
        field = error.field if error.field.startswith("mechanisms") else f"mechanisms.{name}.recipe.{error.field}"
        raise error.named(field) from None
