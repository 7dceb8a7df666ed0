"""Fields of recipes that take the name of an entry of a table, or a table of its values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any

from ..core.errors import DesignError, shown

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic_core.core_schema import CoreSchema


class NamedIn:
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

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        def read(value: object, values: Any) -> object:
            if not isinstance(value, str):
                return values(value)
            found = self.find(value, self.key)
            return value if self.keeps_name else found

        def written(value: Any, values: Any) -> Any:
            names = (name for name, known in self.entries.items() if value in (name, known))
            return next(names, None) or values(value)

        schema = handler.generate_schema(type(next(iter(self.entries.values()))))
        return core_schema.no_info_wrap_validator_function(
            read, schema, serialization=core_schema.wrap_serializer_function_ser_schema(written)
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "enum": list(self.entries)}, handler(schema)]}
