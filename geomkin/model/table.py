"""Tables: arrays of equal length, each with its unit and meaning."""

from __future__ import annotations

from difflib import get_close_matches
from typing import Annotated, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..core.arguments import ArgumentType
from ..core.errors import DesignError, shown
from ..core.records import record
from ..core.reprs import clipped
from ..plane.vec import Array, Complex, Real, known, rounded

Number = TypeVar("Number", np.floating, np.complexfloating)
Frames = Annotated[Array, ArgumentType(lambda value: getattr(value, "ndim", 0) == 1, "an array (frames,)")]
Sizes = Annotated[
    Array, ArgumentType(lambda value: getattr(value, "ndim", 0) == 1 and value.dtype.kind in "fiu", "numbers (frames,)")
]

# Significant digits of a number in a file. More would print the last bit of a processor's sine, and the same recipe
# would no longer give the same bytes everywhere.
DIGITS = 10
# A number is rounding noise beyond so many digits, counted from the size of the terms that it is the sum of. Of most
# columns these are unknown: what is beyond so many decimals, or 1e-12 of a column whose values are small, is noise.
NOISE_DIGITS, DECIMALS = 14, 9


@record(checked=True, eq=False)
class Column:
    """One quantity over the frames.

    Parameters
    ----------
    name, unit, meaning : str
    values : array, shape (frames,)
        Numbers or text; nan if there is none.
    scale : float or array, shape (frames,)
        Size of the terms that a value is the sum of, in its unit, for all frames or for each; 0 if unknown. A file
        writes a value that is rounding noise beside it as 0.
    """

    name: str
    unit: str
    meaning: str
    values: Frames
    scale: float | Sizes = 0.0

    def __post_init__(self) -> None:
        if np.shape(self.scale) not in ((), np.shape(self.values)):
            raise DesignError("scale", f"found {len(self.scale)} numbers", f"give one, or {len(self.values)}")  # type: ignore[arg-type]

    @property
    def written(self) -> Array:
        """The values as files state them: `DIGITS` significant digits of each real number, rounding noise as 0."""
        values = np.asarray(self.values)
        return significant(values, self.scale) if values.dtype.kind == "f" else values

    @property
    def header(self) -> str:
        """Name with its unit, `omega_rad_per_s`, so that a file explains itself."""
        unit = self.unit.replace("/", "_per_")
        return f"{self.name}_{unit}" if unit else self.name


@record(checked=True, eq=False)
class Table:
    """Columns of equal length; the first one rises.

    `table["rocker_omega"]` gives the values of a column, by its name or its header; `table.to_columns()` gives all,
    as data frames take them.
    """

    columns: tuple[Column, ...]

    def __post_init__(self) -> None:
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
    """Of ten, of the leading digit; a hair below a power of ten counts as that power."""
    with np.errstate(divide="ignore", over="ignore"):
        exponent: Array = np.floor(np.log10(np.abs(values) * (1 + 1e-9)))
    return exponent


def xy_columns(name: str, unit: str, meaning: str, values: Complex) -> tuple[Column, Column]:
    """A complex quantity as its x and y columns, each beside the length of the vector at its frame."""
    values = np.asarray(values)
    size = np.abs(values)
    return (
        Column(f"{name}_x", unit, f"{meaning}, x", values.real, size),
        Column(f"{name}_y", unit, f"{meaning}, y", values.imag, size),
    )


def finite(values: NDArray[Number]) -> NDArray[Number]:
    """The values with what lies at infinity, which no number tells, left out; of complex ones both coordinates."""
    return known(np.isfinite(values), values)
