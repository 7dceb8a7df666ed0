"""Tables: arrays of equal length, each with its unit and meaning."""

from __future__ import annotations

from difflib import get_close_matches
from functools import cached_property
from typing import Annotated, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..core.arguments import ArgumentType
from ..core.errors import DesignError, shown
from ..core.fields import clipped
from ..core.records import record
from ..core.units import MM, LengthUnit, as_sentences
from ..plane.vec import Array, Complex, Real, known, rounded

Number = TypeVar("Number", np.floating, np.complexfloating)
Frames = Annotated[Array, ArgumentType(lambda value: getattr(value, "ndim", 0) == 1, "an array (frames,)")]
Sizes = Annotated[
    Array, ArgumentType(lambda value: getattr(value, "ndim", 0) == 1 and value.dtype.kind in "fiu", "numbers (frames,)")
]

# Significant digits of a number in a file. More would print the last bit of a processor's sine, and the same recipe
# would no longer give the same bytes everywhere.
DIGITS = 10
# Digits after the first NOISE_DIGITS are rounding noise, counted from the leading digit of the terms whose sum a value
# is. If the terms are unknown, as in most columns, digits after DECIMALS decimals and below 1e-11 of the largest value
# count as noise. With one digit more, two processors wrote 0.0730111895 and 0.0730111896 for a sum of terms of 100 mm.
NOISE_DIGITS, DECIMALS = 14, 9


@record(checked=True, eq=False)
class Column:
    """One quantity over the frames.

    Parameters
    ----------
    id : str
        In snake case, such as `rocker_omega`; checks, plots and limits refer to it.
    unit, meaning : str
    values : array, shape (frames,)
        Numbers or text; nan if there is none.
    scale : float or array, shape (frames,)
        Size of the terms whose sum a value is, in its unit, for all frames or for each; 0 if unknown. In a file a
        value that is rounding noise of terms of this size is 0.

    See Also
    --------
    Table
    """

    id: str
    unit: str
    meaning: str
    values: Frames
    scale: float | Sizes = 0.0

    def __post_init__(self) -> None:
        as_sentences(self, "meaning")
        if np.shape(self.scale) not in ((), np.shape(self.values)):
            problem = f"found {np.size(self.scale)} numbers"
            raise DesignError("scale", problem, f"give one, or {len(self.values)}", "conflict")

    @property
    def written(self) -> Array:
        """The values as files state them: `DIGITS` significant digits of each real number, rounding noise as 0."""
        values = np.asarray(self.values)
        return significant(values, self.scale) if values.dtype.kind == "f" else values

    @property
    def header(self) -> str:
        """Name of the column in files: the id with its unit, such as `omega_rad_per_s`."""
        unit = self.unit.replace("/", "_per_").replace(" ", "_")
        return f"{self.id}_{unit}" if unit else self.id


@record(checked=True, eq=False)
class Table:
    """Columns of equal length; the first one rises.

    `table["rocker_omega"]` returns the values of a column, by its id or its header; `table.to_columns()` returns all of
    them, for a data frame.

    Parameters
    ----------
    columns : tuple of Column
        The columns.

    See Also
    --------
    Column, write
    """

    columns: tuple[Column, ...]

    def __post_init__(self) -> None:
        lengths = {len(c.values) for c in self.columns}
        if len(lengths) != 1:
            raise DesignError("columns", f"found lengths {sorted(lengths)}", "give columns of one length", "conflict")
        for names in (self.ids, tuple(column.header for column in self.columns)):
            twin = next((name for name in names if names.count(name) > 1), None)
            if twin is not None:
                problem = f"two columns would be named {shown(twin)}"
                raise DesignError("columns", problem, "give one body or point another name", "conflict")

    @cached_property
    def ids(self) -> tuple[str, ...]:
        """Ids of the columns, in order."""
        return tuple(column.id for column in self.columns)

    def column(self, id: str) -> Column:
        """The column of this id or header; if there is none, a DesignError names similar ids."""
        if isinstance(id, str) and id in self._by_name:
            return self._by_name[id]
        near = get_close_matches(str(id), self.ids, 3, 0.4)
        remedy = f"give {' or '.join(near)}" if near else "give one of `Table.ids`"
        raise DesignError("id", f"found {shown(id)}, which is the id of no column", remedy, "unknown-key")

    @cached_property
    def _by_name(self) -> dict[str, Column]:
        by_header = {column.header: column for column in self.columns}
        return by_header | {column.id: column for column in self.columns}

    def __getitem__(self, id: str) -> Array:
        """Values (frames,) of the column of this id or header, in the unit that its header states."""
        return self.column(id).values

    def to_columns(self) -> dict[str, Array]:
        """The values (frames,) by header, such as `rocker_omega_rad_per_s`, in order; data frames are made from it."""
        return {column.header: column.values for column in self.columns}

    def __repr__(self) -> str:
        headers = ", ".join(self.to_columns())
        return clipped(f"Table({len(self.columns[0].values)} rows: {headers})")


def significant(values: Array, scale: float | Array = 0.0) -> Real:
    """Values rounded to `DIGITS` significant digits each, however large others are; rounding noise is 0.

    Parameters
    ----------
    values : array, shape (frames,)
        nan and inf are kept.
    scale : float or array, shape (frames,)
        As of a `Column`.
    """
    values = np.asarray(values, dtype=float)
    scale = np.where(np.isfinite(scale), scale, 0.0)
    largest = max(np.abs(values[np.isfinite(values)]).max(initial=0.0), scale.max(initial=0.0))
    most = max(DECIMALS, float(NOISE_DIGITS - 3 - _exponent(largest)))
    noise = np.minimum(NOISE_DIGITS - 1 - _exponent(scale), most)
    # Rounding to more than 290 decimals overflows.
    decimals = np.clip(np.minimum(DIGITS - 1 - _exponent(values), noise), -290, 290)
    written = values.copy()
    for count in set(decimals[np.isfinite(values)].tolist()):
        alike = decimals == count
        written[alike] = rounded(values[alike], int(count))
    return written


def _exponent(values: Array | float) -> Array:
    """Power of ten of the leading digit; a number slightly below a power of ten counts as that power."""
    with np.errstate(divide="ignore", over="ignore"):
        exponent: Array = np.floor(np.log10(np.abs(values) * (1 + 1e-9)))
    return exponent


def xy_columns(id: str, unit: str, meaning: str, values: Complex) -> tuple[Column, Column]:
    """The x and y columns of a complex quantity; their `scale` is its absolute value."""
    values = np.asarray(values)
    size = np.abs(values)
    return (
        Column(f"{id}_x", unit, f"{meaning}, x", values.real, size),
        Column(f"{id}_y", unit, f"{meaning}, y", values.imag, size),
    )


def vector_columns(id: str, unit: str, meaning: str, values: Complex) -> tuple[Column, Column, Column]:
    """The x and y columns of a complex quantity, and the column of its absolute value."""
    return (*xy_columns(id, unit, meaning, values), Column(id, unit, f"{meaning}, its size", np.abs(values)))


def finite(values: NDArray[Number]) -> NDArray[Number]:
    """The values, with nan in place of infinite ones; in complex values both coordinates become nan."""
    return known(np.isfinite(values), values)


def column_in(unit: LengthUnit, column: Column) -> Column:
    """The column in this unit."""
    if unit.factor(column.unit) == 1:
        return column
    values, scale = (unit.of(numbers, column.unit) for numbers in (column.values, column.scale))
    return Column(column.id, unit.unit(column.unit), unit.text(column.meaning), values, scale)


def table_in(unit: LengthUnit, table: Table) -> Table:
    """The table in this unit."""
    return table if unit is MM else Table(tuple(column_in(unit, column) for column in table.columns))
