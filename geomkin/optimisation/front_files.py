"""The files of a Pareto front: table, picture, a recipe for each design, and a page on which they are chosen."""

from __future__ import annotations

from collections.abc import Sequence
from glob import escape
from pathlib import Path
from typing import Any

from ..core.errors import harmless
from ..core.fields import to_digits
from ..export.csv import csv
from ..export.files import remove, write_whole
from ..export.text import number, text
from ..model.table import Column
from ..page.page import rows_document
from ..page.sections import html_section, wide
from ..recipe.load import to_toml
from .front import FrontDesign, ParetoFront

# A click on a design, or Enter, opens its recipe and closes the others.
CHOOSE = """(row) => {
  const designs = [...document.querySelectorAll("#designs details")];
  designs.forEach((design, k) => { design.open = k === row; });
  designs[row].scrollIntoView({ block: "nearest" });
}"""


def write_front(front: ParetoFront, folder: Path, name: str) -> dict[Path, int]:
    """Write the table, the picture, the page and a recipe for each design.

    Recipes of an earlier, longer front are removed.
    """
    contents = {
        f"{name}.front.csv": csv(front.table),
        f"{name}.front.svg": front.picture(),
        f"{name}.front.html": front_page(name, front),
    }
    for k, design in enumerate(front.designs, 1):
        contents[f"{name}.front-{k}.toml"] = to_toml(design.recipe).encode()
    write_whole(folder, contents)
    for path in folder.glob(f"{escape(name)}.front-*.toml"):
        if path.name not in contents:
            remove(path)
    return {folder / file: len(content) for file, content in contents.items()}


def front_page(name: str, front: ParetoFront) -> bytes:
    """The page of a front. name: of the recipe."""
    numbers, *columns = front.table.columns
    objectives, keys = columns[: len(front.minimised)], columns[len(front.minimised) :]
    data = {
        "name": harmless(name),
        "frames": len(front.designs),
        "spots": True,
        "columns": [_column(column) for column in columns],
        "plots": [{"title": harmless(column.id), "columns": [k]} for k, column in enumerate(columns[1:], 1)],
    }
    about = (
        f"<p>{len(front.designs)} designs, none of which is better than another in all of {_names(objectives)}. Click "
        "a design in a plot, or choose it with the arrow keys and Enter: its recipe opens below.</p>"
    )
    heads = "".join(f'<th scope="col">{text(column.id)}</th>' for column in (numbers, *columns))
    cells = [[f"<td>{number(float(value))}</td>" for value in column.values] for column in columns]
    rows = "".join(f'<tr><th scope="row">{k}</th>{"".join(row)}</tr>' for k, row in enumerate(zip(*cells), 1))
    table = f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"
    recipes = "".join(_design(k, design, keys) for k, design in enumerate(front.designs, 1))
    body = (
        '<section id="plots" class="values" aria-label="Plots"></section>\n'
        f"{html_section('designs', 'Recipes', recipes)}{html_section('table', 'All designs', wide('Designs', table))}\n"
    )
    return rows_document(f"{name}: Pareto front", about, body, data, CHOOSE)


def _names(columns: Sequence[Column]) -> str:
    return " and ".join(f"<code>{text(column.id)}</code>" for column in columns)


def _column(column: Column) -> dict[str, Any]:
    row = [to_digits(float(value), 6) for value in column.values]
    return {"name": harmless(column.id), "unit": "", "meaning": column.meaning, "row": row}


def _design(k: int, design: FrontDesign, keys: Sequence[Column]) -> str:
    values = ", ".join(f"{text(key.id)} = {number(float(key.values[k - 1]))}" for key in keys)
    recipe = "\n".join(map(text, to_toml(design.recipe).splitlines()))
    return f'<details><summary>Design {k}: {values}</summary><pre tabindex="0"><code>{recipe}</code></pre></details>\n'
