"""Fields of recipes that take the name of an entry of a table, or a table of its values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from typing import Any

from ..core.errors import DesignError, shown
from ..core.field_visitor import WrittenForm


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
