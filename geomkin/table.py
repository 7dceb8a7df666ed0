"""Tables: arrays of equal length, each with its unit and meaning."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from typing import Annotated, TypeVar

import numpy as np
from numpy.typing import NDArray

from .arguments import Sort, check_fields
from .brief import clipped, one_line
from .errors import DesignError, shown
from .plane.vec import Array, Complex, known

Number = TypeVar("Number", np.floating, np.complexfloating)
Frames = Annotated[Array, Sort(lambda value: getattr(value, "ndim", 0) == 1, "an array (frames,)")]


@dataclass(frozen=True, eq=False)
class Column:
    """One quantity over the frames. values: (frames,), numbers or text; nan where there is none.

    scale: how large it could be, in its unit, where all of it may be no more than rounding: a file counts its digits
    from there, or from its largest value, whichever is larger.
    """

    name: str
    unit: str
    meaning: str
    values: Frames
    scale: float = 0.0
    __repr__ = one_line

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def header(self) -> str:
        """Name with its unit, `omega_rad_per_s`, so that a file explains itself."""
        unit = self.unit.replace("/", "_per_")
        return f"{self.name}_{unit}" if unit else self.name


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of equal length; the first one rises.

    `table["rocker_omega"]` gives the values of a column, by its name or its header; `table.to_columns()` gives all,
    as data frames take them.
    """

    columns: tuple[Column, ...]

    def __post_init__(self) -> None:
        check_fields(self)
        lengths = {len(c.values) for c in self.columns}
        if len(lengths) != 1:
            raise DesignError("columns", f"found lengths {sorted(lengths)}", "give columns of one length")
        headers = [c.header for c in self.columns]
        twin = next((h for h in headers if headers.count(h) > 1), None)
        if twin is not None:
            raise DesignError(
                "columns", f"two columns would be named {shown(twin)}", "give one body or point another name"
            )

    def __getitem__(self, name: str) -> Array:
        """Values (frames,) of the column of this name or header, in the unit that its header tells."""
        for column in self.columns:
            if name in (column.name, column.header):
                return column.values
        near = get_close_matches(str(name), [column.name for column in self.columns], 3, 0.4)
        remedy = f"give {' or '.join(near)}" if near else "give a name that `to_columns` tells"
        raise DesignError("name", f"found {shown(name)}, which names no column", remedy)

    def to_columns(self) -> dict[str, Array]:
        """Header, such as `rocker_omega_rad_per_s`, to values (frames,), in order: what any data frame is made from."""
        return {column.header: column.values for column in self.columns}

    def __repr__(self) -> str:
        headers = ", ".join(self.to_columns())
        return clipped(f"Table({len(self.columns[0].values)} rows: {headers})")


def xy_columns(name: str, unit: str, meaning: str, values: Complex) -> tuple[Column, Column]:
    """A complex quantity as its x and y columns, with the digits of both counted from the larger."""
    values = np.asarray(values)
    size = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    return (
        Column(f"{name}_x", unit, f"{meaning}, x", values.real, float(size)),
        Column(f"{name}_y", unit, f"{meaning}, y", values.imag, float(size)),
    )


def finite(values: NDArray[Number]) -> NDArray[Number]:
    """The values with what lies at infinity, which no number tells, left out; of complex ones both coordinates."""
    return known(np.isfinite(values), values)
