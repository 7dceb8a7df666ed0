"""Fields of recipes that take the name of an entry of a table, or a table of its values."""

from __future__ import annotations

from collections.abc import Mapping
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
    """

    def __init__(self, entries: Mapping[str, Any], key: str) -> None:
        self.entries, self.key = entries, key

    def find(self, name: object, key: str = "name") -> Any:
        """The entry of a name; DesignError with the key if there is none."""
        if not isinstance(name, str) or name not in self.entries:
            raise DesignError(key, f"found {shown(name)}", f"give {', '.join(self.entries)}, or a table of values")
        return self.entries[name]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        def named(value: object) -> object:
            return self.find(value, self.key) if isinstance(value, str) else value

        def written(value: Any, handler: Any) -> Any:
            return next((name for name, known in self.entries.items() if known == value), None) or handler(value)

        return core_schema.no_info_before_validator_function(
            named, handler(source), serialization=core_schema.wrap_serializer_function_ser_schema(written)
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [{"type": "string", "enum": list(self.entries)}, handler(schema)]}
