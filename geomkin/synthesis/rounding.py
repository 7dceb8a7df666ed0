"""Rounding of a found linkage's sizes to short decimal numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from math import degrees, floor, log10
from typing import TypeVar

from ..core.records import record
from ..linkage.linkage import AbstractLinkage
from ..linkage.named_linkages import EllipticTrammel, FourBar, SliderCrank

L = TypeVar("L", bound=AbstractLinkage)
# Relative distance by which a number is moved away from 0 before it is rounded, so that a number half-way between two
# decimals, which closed forms produce, is rounded alike on every processor. Results of iterations differ by more and
# are half-way only by chance.
BESIDE_HALF = 1e-12


@record
class Rounding:
    """A rule for rounding sizes to decimals.

    Parameters
    ----------
    share : float
        Largest rounding error: for lengths, positions and strokes as a share of `size`, for angles in rad.
    size : float
        Longest link of the linkage, mm.
    bounds : mapping of str to (float, float), optional
        Least and greatest value of sizes by name. A size with equal bounds was given and keeps all its digits.
    longer : tuple of (str, int), optional
        Name of a length and the number of units of its last decimal that are added after rounding.
    """

    share: float
    size: float
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    longer: tuple[str, int] = ("", 0)

    def length(self, name: str, value: float) -> float:
        """Round a length, mm."""
        return self._within(name, value, _decimals(self.share * self.size))

    def angle(self, name: str, value: float) -> float:
        """Round an angle, deg."""
        return self._within(name, value, _decimals(degrees(self.share)))

    def place(self, name: str, value: complex) -> complex:
        """Round a point, mm."""
        return complex(self.length(f"{name}_x", value.real), self.length(f"{name}_y", value.imag))

    def linkage(self, linkage: L) -> L:
        """Round all sizes of a four-bar, a slider-crank or an elliptic trammel."""
        sizes: dict[str, float | complex] = {
            name: self.length(name, value) for name, value in lengths_of(linkage).items()
        }
        for name in ("coupler_point", "rod_point", "origin"):
            if hasattr(linkage, name):
                sizes[name] = self.place(name, complex(getattr(linkage, name)))
        for name in ("ground_angle_deg", "angle_deg"):
            if hasattr(linkage, name):
                sizes[name] = self.angle(name, float(getattr(linkage, name)))
        return replace(linkage, **sizes)  # type: ignore[type-var]

    def _within(self, name: str, value: float, decimals: int) -> float:
        low, high = self.bounds.get(name, (value, value))
        if name in self.bounds and low == high:
            return low
        rounded = round(value * (1 + BESIDE_HALF), decimals)
        if name == self.longer[0]:
            rounded = round(rounded + self.longer[1] * 10.0**-decimals, decimals)
        if name in self.bounds:
            rounded = min(max(rounded, low), high)
        return rounded + 0.0


def lengths_of(linkage: AbstractLinkage) -> dict[str, float]:
    """Lengths of a linkage's links by name, mm; for a slider-crank also its offset."""
    names = {
        FourBar: ("ground", "crank", "coupler", "rocker"),
        SliderCrank: ("crank", "coupler", "offset"),
        EllipticTrammel: ("rod",),
    }[type(linkage)]
    return {name: float(getattr(linkage, name)) for name in names}


def _decimals(error: float) -> int:
    """Least number of decimals whose rounding error does not exceed `error`."""
    return -floor(log10(2 * error))
