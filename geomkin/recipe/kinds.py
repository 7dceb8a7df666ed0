"""The table of kinds: those of the face, `geomkin/face.py`, and those of installed packages."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from importlib.metadata import entry_points
from itertools import takewhile
from pathlib import Path

from ..core.errors import GeomkinError, printable
from ..core.named import KINDS_BY_GROUP, named
from .recipe import AbstractRecipe

# Other packages add kinds by entry points of this group, each `name = "module:RecipeClass"`.
ENTRY_POINTS = "geomkin.kinds"


@dataclass(frozen=True)
class KindRow:
    """One kind of recipe.

    Parameters
    ----------
    group : str
        Heading under which `geomkin list` shows the kind.
    recipe : str
        Class of its recipes, as `module:Class`. It is imported when the kind is first used.
    """

    group: str
    recipe: str


KINDS: dict[str, KindRow] = {
    kind: KindRow(group, home) for group, kinds in KINDS_BY_GROUP.items() for kind, home in kinds.items()
}


def recipe_class(kind: str) -> type[AbstractRecipe]:
    """Class of the recipes of a kind.

    Parameters
    ----------
    kind : str
        Name in the table `KINDS`, or of an entry point of the group `geomkin.kinds` of an installed package.

    Returns
    -------
    type
        A subclass of `AbstractRecipe`.

    Raises
    ------
    KeyError
        If no kind has this name.
    GeomkinError
        If the class of another package cannot be imported.
    """
    row = KINDS.get(kind) or _installed()[kind]
    try:
        recipe: type[AbstractRecipe] = named(row.recipe)
    except Exception as error:
        fault = printable(f"{type(error).__name__}: {error}", 200)
        raise GeomkinError(f"kind {kind}: {row.recipe} cannot be imported ({fault}); correct its package") from error
    return recipe


def all_kinds() -> dict[str, KindRow]:
    """The rows of all kinds by name: those of the table, then those of installed packages."""
    return KINDS | {kind: row for kind, row in _installed().items() if kind not in KINDS}


def gallery() -> tuple[Path, dict[str, tuple[str, str]]]:
    """The folder of the gallery, and the kind and the description of its recipes by file name.

    An installed package holds the gallery; in a copy of the project it is next to the package.
    """
    package = Path(__file__).parents[1]
    folder = next((f for f in (package / "gallery", package.parent / "recipes") if f.is_dir()), package)
    recipes: dict[str, tuple[str, str]] = {}
    for file in sorted(folder.glob("*.toml")):
        text = file.read_text("utf-8")
        comment = takewhile(lambda line: line.startswith("# "), text.splitlines())
        first = " ".join(line[2:] for line in comment).partition(". ")[0].rstrip(".:")
        recipes[file.name] = str(tomllib.loads(text)["kind"]), first
    return folder, recipes


def kind_names() -> list[str]:
    """Names of all kinds.

    Returns
    -------
    list of str
        Those of the table, then those of installed packages.
    """
    return list(all_kinds())


def _installed() -> dict[str, KindRow]:
    return {point.name: KindRow("other packages", point.value) for point in entry_points(group=ENTRY_POINTS)}
