"""The text of a recipe that is edited, and what follows from it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from ..core.errors import GeomkinError
from ..core.field_visitor import key_parts
from ..core.units import UNITS, LengthUnit
from ..recipe.keys import edited_text
from ..recipe.load import from_table, whole_table
from ..recipe.recipe import AbstractRecipe
from ..recipe.toml import parsed

# The key of an item of a list.
ITEM = re.compile(r"(.+)\[(\d+)\]")


def read(draft: Draft) -> AbstractRecipe:
    """The recipe of a draft; raises RecipeError."""
    return draft.opened(draft.table)


@dataclass(frozen=True)
class Draft:
    """A recipe's text that is being edited, and the texts of the files that it names.

    Parameters
    ----------
    text : str
        TOML; it may be wrong, and then what follows from it raises RecipeError.
    files : mapping of str to str
        Texts of files by their names in the recipe.
    name : str
        Name of the recipe.
    reader : callable
        Gives the recipe of a draft; a caller may keep the last ones.
    """

    text: str
    files: Mapping[str, str]
    name: str = ""
    reader: Callable[[Draft], AbstractRecipe] = read

    def with_text(self, text: str) -> Draft:
        """The draft with another text."""
        return self if text == self.text else replace(self, text=text)

    def with_changes(self, changes: Mapping[str, Any]) -> Draft:
        """The draft with other values by dotted key, None to remove one."""
        return self.with_text(edited_text(self.text, changes))

    def opened(self, table: Mapping[str, Any]) -> AbstractRecipe:
        """The recipe in another table; raises RecipeError."""
        recipe = from_table(table, "recipe", self.files)
        return recipe.with_name(self.name) if self.name else recipe

    @cached_property
    def table(self) -> dict[str, Any]:
        """The parsed text."""
        return parsed(self.text.replace("\r\n", "\n"))

    @cached_property
    def recipe(self) -> AbstractRecipe:
        """The recipe."""
        return self.reader(self)

    @cached_property
    def written(self) -> AbstractRecipe:
        """The recipe with the sizes that the text states, before its `scale` multiplies them."""
        if "scale" not in self.table or not self.recipe.can_be_scaled:
            return self.recipe
        return self.opened({key: value for key, value in self.table.items() if key != "scale"})

    @cached_property
    def values(self) -> dict[str, Any]:
        """Every key with its value as it stands, also those that the text leaves out."""
        return flat(whole_table(self.written))

    @property
    def unit(self) -> LengthUnit:
        """The unit of length of the text."""
        return UNITS[self.table.get("units", "mm")]

    @property
    def scale(self) -> float:
        """The factor of all sizes."""
        return float(self.table.get("scale", 1.0))

    def whole_lists(self, changes: Mapping[str, Any]) -> Mapping[str, Any]:
        """Changes with whole points and lists for those items that belong to a list which the text leaves out."""
        if not any("[" in key for key in changes):
            return changes
        try:
            table, values = self.table, self.values
        except GeomkinError:
            # Without a recipe no default is known.
            return changes
        whole: dict[str, Any] = {}
        for key, value in changes.items():
            field, item = match.groups() if (match := ITEM.fullmatch(key)) else ("", "0")
            items = values.get(field)
            if value is not None and isinstance(items, list) and int(item) < len(items) and not _is_there(table, field):
                whole.setdefault(field, [int(v) if isinstance(v, float) and v == int(v) else v for v in items])
                whole[field][int(item)] = value
            else:
                whole[key] = value
        return whole


def _is_there(table: Mapping[str, Any], field: str) -> bool:
    place: Any = table
    try:
        for part in key_parts(field):
            place = place[part]
    except (LookupError, TypeError):
        return False
    return True


def flat(table: Mapping[str, Any]) -> dict[str, Any]:
    """The values of a table by dotted key."""
    return dict(_flat(table, ""))


def _flat(value: Any, key: str) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict) and (value or not key):
        for name, held in value.items():
            yield from _flat(held, f"{key}.{name}" if key else name)
    elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
        for k, item in enumerate(value):
            yield from _flat(item, f"{key}[{k}]")
    else:
        yield key, value
