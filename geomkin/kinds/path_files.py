"""Points of a path in a file beside the recipe: a CSV of x and y, or the first path of an SVG drawing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..beside import csv_cells, text_beside
from ..brief import clipped
from ..errors import DesignError, printable, shown
from ..plane.vec import Complex
from ..sizes import FARTHEST
from ..synthesis.path.drawings import drawing_points
from ..synthesis.path.path import MOST_POINTS
from ..synthesis.path.points import svg_path_points


class FileName:
    """The name of a file that lies beside a recipe or below; without a folder, as from a script, anywhere.

    No dataclass, since a recipe has the plain name and no table. Where a text lay is no part of what it says: the same
    recipe read from two folders is equal.
    """

    __slots__ = ("folder", "name")

    def __init__(self, name: str, folder: str | Path | None = None):
        self.name, self.folder = name, folder

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FileName) and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)

    def __repr__(self) -> str:
        return clipped(f"FileName({shown(self.name)})")

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """A recipe gives the name alone; the folder comes with the context it is validated in."""
        from pydantic_core import core_schema

        return core_schema.with_info_after_validator_function(
            lambda name, info: cls(name, (info.context or {}).get("folder", ".")),
            core_schema.str_schema(strict=True),
            serialization=core_schema.plain_serializer_function_ser_schema(lambda file: file.name),
        )

    def points(self, count: int) -> Complex:
        """The points, of a drawing so many."""
        text = text_beside(self.name, self.folder, "a CSV or an SVG file")
        if self.name.lower().endswith(".svg"):
            try:
                return drawing_points(text, count)
            except DesignError as error:
                raise DesignError("file", f"{printable(self.name)}: {error.problem}", error.remedy) from None
        return _rows(text, printable(self.name))


def as_field(name: str, path: str, count: int) -> Complex:
    """Points of a path's text, refused under the name of the field that holds it."""
    try:
        return svg_path_points(path, count)[0]
    except DesignError as error:
        raise DesignError(name, f"its path {error.problem}", error.remedy) from None


def _rows(text: str, name: str) -> Complex:
    """The rows of two numbers; a first line of words is their heading."""
    count = text.count("\n")
    if count > MOST_POINTS + 1:
        raise DesignError("file", f"{name} has {count:,} lines", f"give at most {MOST_POINTS:,} points")
    lines = [line for line in csv_cells(text, name) if "".join(line).strip()]
    points = []
    for k, line in enumerate(lines, 1):
        try:
            x, y = (float(cell) for cell in line)
        except ValueError:
            if k == 1:
                continue
            problem = f"row {k} of {name} holds {printable(repr(','.join(line)), 30)}"
            raise DesignError(
                "file", problem, "give two numbers in each row, x and y in mm, separated by a comma or a semicolon"
            ) from None
        if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):
            raise DesignError("file", f"row {k} of {name} holds {x:g}, {y:g}", f"give places within {FARTHEST:g} of 0")
        points.append(complex(x, y))
    return np.array(points, dtype=complex)
