"""The Pareto front of several objectives, designs of which none is better than another in all of them; its files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from glob import escape
from pathlib import Path
from typing import Any

import numpy as np

from ..core.errors import harmless, printable
from ..core.fields import to_digits
from ..core.records import record
from ..export.files import remove, write_whole
from ..export.tables import csv, plot_file
from ..export.text import number, text
from ..model.scene import Plot
from ..model.table import Column, Table
from ..page.page import rows_document
from ..page.sections import html_section, wide
from ..plane.vec import Real
from ..recipe.load import to_toml
from ..recipe.recipe import AbstractRecipe
from .designs import Trials, TriedDesign
from .search import Box, targets

# Most objectives. With more of them each point of the front says less.
MOST_OBJECTIVES = 4
# Digits of the objectives, as shares of their ranges, in which designs that are equal count as one.
DIGITS = 6


@record(eq=False)
class FrontDesign:
    """A design of a Pareto front.

    Parameters
    ----------
    recipe : AbstractRecipe
        The recipe with the values of the design.
    values : mapping of str to float or int
        By key.
    objectives : tuple of float
        The value of each objective.
    """

    recipe: AbstractRecipe
    values: Mapping[str, float]
    objectives: tuple[float, ...]


@record(eq=False)
class ParetoFront:
    """The designs that an optimisation with several objectives found.

    Parameters
    ----------
    minimised : tuple of str
        The formulas of the objectives.
    designs : tuple of FrontDesign
        By rising first objective; none is better than another in all objectives.
    evaluations : int
        Number of designs that were tried.
    cut_short : bool
        Whether the time limit or an interruption ended the search.
    files : mapping of Path to int
        Written files with their size in bytes.
    """

    minimised: tuple[str, ...]
    designs: tuple[FrontDesign, ...]
    evaluations: int
    cut_short: bool = False
    files: Mapping[Path, int] = field(default_factory=dict)

    @property
    def table(self) -> Table:
        """A row for each design: its number from 1, its objectives and the values of its keys."""
        results = np.array([design.objectives for design in self.designs]).T
        numbers = Column("design", "", "number of the design", np.arange(1, len(self.designs) + 1))
        return Table((numbers, *self._columns(results), *self._keys))

    @property
    def _keys(self) -> Iterator[Column]:
        for key in self.designs[0].values:
            yield Column(key, "", "value under this key", np.array([design.values[key] for design in self.designs]))

    def _columns(self, results: Real) -> Iterator[Column]:
        for objective, row in zip(self.minimised, results):
            yield Column(objective, "", "objective", row)

    @property
    def lines(self) -> list[str]:
        """The table as lines of text."""
        heads = [printable(column.id) for column in self.table.columns]
        rows = zip(*(column.values.tolist() for column in self.table.columns))
        lines = ["  ".join(f"{value:{max(len(head), 8)}.6g}" for value, head in zip(row, heads)) for row in rows]
        return ["  ".join(f"{head:>8}" for head in heads), *lines]

    def picture(self) -> bytes:
        """The other objectives over the first one, as an SVG file."""
        results = np.array([design.objectives for design in self.designs]).T
        columns = tuple(self._columns(results))
        return plot_file(Table(columns), Plot("Pareto front", self.minimised[1:]), dots=True)


def front_of(trials: Trials, boxes: Sequence[Box]) -> list[TriedDesign]:
    """The front of all designs that were tried, thinned to one for each target unless all keys are whole numbers."""
    designs = [design for design in trials.designs if design.violation == 0]
    results = np.array([design.objectives for design in designs])
    size = np.ptp(results, axis=0)
    front = [designs[k] for k in undominated(np.round(results / np.where(size > 0, size, 1.0), DIGITS))]
    if any(box.free for box in boxes):
        chosen = [min(front, key=target.rank) for target in targets(trials.designs, len(trials.objectives))]
        front = [design for design in front if any(design is one for one in chosen)]
    return sorted(front, key=lambda design: tuple(design.objectives))


def undominated(results: Real) -> list[int]:
    """Numbers of the rows (n, objectives) to which no other row is equal or better in all columns, but one of twins."""
    left = np.lexsort(results.T[::-1])
    front = []
    while len(left):
        first, left = left[0], left[1:]
        front.append(int(first))
        left = left[(results[left] < results[first]).any(axis=1)]
    return front


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
