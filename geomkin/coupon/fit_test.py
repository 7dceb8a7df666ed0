"""Sizes of a fit test: holes stepped around a pin's diameter, and slots stepped around a sheet's thickness."""

from __future__ import annotations

import numpy as np

from ..core.errors import DesignError
from ..core.fields import quantity, rounded_down
from ..core.records import record
from ..model.table import Column, Table
from ..plane.vec import Real

# Smallest opening, mm: a narrower one is closed by most beams and printers.
NARROWEST_OPENING = 0.2


@record(checked=True)
class FitTest:
    """Openings of a fit test, in equal steps around the size of what goes into them.

    Parameters
    ----------
    pin : float
        Diameter of the pin, screw or shaft, mm; from 0.5 to 50.
    thickness : float, optional
        Measured thickness of the sheet, mm; from 0.5 to 20.
    step : float, optional
        Difference between neighbouring openings, mm; from 0.01 to 1.
    count : int, optional
        Number of holes, and of slots; from 5 to 25. Half of them, rounded down, are smaller than the pin.

    Raises
    ------
    DesignError
        If a size is out of range, or the smallest opening would be narrower than 0.2 mm.

    Examples
    --------
    >>> gk.coupon.FitTest(pin=3, step=0.1, count=5).hole_diameters
    array([2.8, 2.9, 3. , 3.1, 3.2])
    """

    pin: float = quantity("diameter of the pin, screw or shaft to try", "mm", at_least=0.5, at_most=50, example=3.0)
    thickness: float = quantity("thickness of the sheet, as measured", "mm", default=3.0, at_least=0.5, at_most=20)
    step: float = quantity("difference between neighbouring openings", "mm", default=0.1, at_least=0.01, at_most=1)
    count: int = quantity("number of holes, and of slots", default=9, whole=True, at_least=5, at_most=25)

    def __post_init__(self) -> None:
        below = self.count // 2
        for name, size in (("pin", self.pin), ("thickness", self.thickness)):
            largest = (size - NARROWEST_OPENING) / below
            if self.step > largest * (1 + 1e-9):
                opening = size - below * self.step
                problem = f"found {self.step:g} mm, with which the smallest opening for {name} = {size:g} mm and "
                problem += f"count = {self.count} would be {opening:.4g} mm wide"
                most = rounded_down(largest, 3)
                raise DesignError("step", problem, f"give at most {most} mm", "conflict", most)

    @property
    def offsets(self) -> Real:
        """Difference of each opening from the nominal size, mm, shape (count,)."""
        return np.round(self.step * (np.arange(self.count) - self.count // 2), 9)

    @property
    def hole_diameters(self) -> Real:
        """Diameter of each hole, mm, shape (count,)."""
        return np.round(self.pin + self.offsets, 9)

    @property
    def slot_widths(self) -> Real:
        """Width of each slot, mm, shape (count,)."""
        return np.round(self.thickness + self.offsets, 9)

    @property
    def table(self) -> Table:
        """The openings, one row for each hole and its slot."""
        return Table(
            (
                Column("number", "", "number of the hole and of the slot, from the left", np.arange(1, self.count + 1)),
                Column("hole_diameter", "mm", "diameter of the hole", self.hole_diameters),
                Column("slot_width", "mm", "width of the slot", self.slot_widths),
                Column("difference", "mm", "hole minus pin, and slot minus sheet", self.offsets),
            )
        )
