"""A recipe that is read once and then loaded many times, each time with other values of some keys."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..core.errors import DesignError, RecipeError
from ..core.records import record
from .keys import with_values
from .load import from_table, to_toml
from .recipe import AbstractRecipe
from .toml import parsed, table_of


@record
class VariedRecipe:
    """A recipe's table as TOML gives it, its name in messages, and the folder of the files that it names."""

    recipe: Mapping[str, Any]
    file: str
    folder: str

    def opened(self, changes: Mapping[str, Any]) -> AbstractRecipe:
        """The recipe with these changes. Raises the errors of `gk.load`, and DesignError for an impossible key."""
        return from_table(with_values(self.recipe, changes), self.file, self.folder)

    def check_keys(self, changes: Mapping[str, Any]) -> None:
        """Raise DesignError for a key that the kind of recipe does not have, with the message of `gk.load`."""
        try:
            self.opened(changes)
        except RecipeError as error:
            for problem in error.problems:
                asked = any(
                    key.startswith(problem.key) and key[len(problem.key) :][:1] in ("", ".", "[") for key in changes
                )
                if problem.id == "unknown-key" and asked:
                    raise DesignError(problem.key, problem.problem, problem.remedy, problem.id, problem.value) from None


def varied(source: AbstractRecipe | str | Path | Mapping[str, Any]) -> tuple[VariedRecipe, str]:
    """A recipe, or anything that `gk.load` reads, and the name of its files."""
    if isinstance(source, AbstractRecipe):
        data, file, name = tomllib.loads(to_toml(source)), source.name or source.kind, source.name
    elif isinstance(source, Mapping):
        data, file, name = dict(source), "recipe", ""
    elif isinstance(source, str) and "\n" in source:
        data, file, name = parsed(source), "recipe", ""
    else:
        path = Path(source)
        # Other processes may work in other folders.
        return VariedRecipe(table_of(path), str(path), str(path.absolute().parent)), path.stem
    return VariedRecipe(data, file, str(Path.cwd())), name or str(data.get("kind", "recipe"))
