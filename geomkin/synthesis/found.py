"""The common base of all search results, a linkage with its motion and defects, and rounding of its sizes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from math import degrees, floor, log10
from typing import Self, TypeVar

import numpy as np

from ..core.fields import moving_picture, to_digits_or_none
from ..core.records import record
from ..linkage.linkage import AbstractLinkage, Linkage
from ..linkage.measures import least_transmission_angle
from ..linkage.moving import move
from ..linkage.named_linkages import EllipticTrammel, FourBar, SliderCrank
from ..plane.vec import Real

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
        """Round all sizes of a linkage, or of a general one all points."""
        if isinstance(linkage, Linkage):
            bodies = {
                body: {name: self.place(name, complex(place)) for name, place in points.items()}
                for body, points in linkage.bodies.items()
            }
            meshes = tuple(replace(mesh, angle_deg=self.angle("", mesh.angle_deg)) for mesh in linkage.meshes)
            return replace(linkage, bodies=bodies, origin=self.place("origin", complex(linkage.origin)), meshes=meshes)
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
    """Lengths of a linkage's links by name, mm; for a slider-crank also its offset.

    For a general linkage the distance of the first two points of each body.
    """
    if isinstance(linkage, Linkage):
        places = {body: list(points.values()) for body, points in linkage.bodies.items()}
        return {body: abs(complex(row[1] - row[0])) for body, row in places.items() if len(row) > 1}
    names = {
        FourBar: ("ground", "crank", "coupler", "rocker"),
        SliderCrank: ("crank", "coupler", "offset"),
        EllipticTrammel: ("rod",),
    }[type(linkage)]
    return {name: float(getattr(linkage, name)) for name in names}


def _decimals(error: float) -> int:
    """Least number of decimals whose rounding error does not exceed `error`."""
    return -floor(log10(2 * error))


# Frames of a motion, besides its extremes, that are checked for closure.
FRAMES = 361


@record(eq=False, kw_only=True)
class Found:
    """A linkage found by a search.

    Parameters
    ----------
    linkage : AbstractLinkage
        The linkage, placed in the plane; it can be moved, drawn and cut.
    branch : int
        +1 or -1, as `move` takes it.
    drive : array, shape (n,)
        Driver position at each of the wanted positions, in their order: rad from the ground line, unwrapped, or mm if a
        slider drives. For a motion over a range: its two ends.
    transmission_angle_deg : float
        Least transmission angle from the first to the last position, or over the full turn if the search was for one;
        nan if the linkage does not close everywhere.
    defects : tuple of str
        Those of "circuit", "branch" and "order" that the linkage has, in this order. Empty if it moves through the
        positions in order with the driver moving in one sense.
    """

    linkage: AbstractLinkage
    branch: int
    drive: Real
    transmission_angle_deg: float
    defects: tuple[str, ...] = ()

    _repr_html_ = moving_picture

    @property
    def bars(self) -> int:
        """Number of bars, with the ground."""
        return len(self.linkage.linkage.bodies)

    @property
    def accuracy(self) -> str:
        """How near it comes to what is wanted, at the start of a label; "" if it meets that exactly."""
        return ""

    @property
    def lengths(self) -> Mapping[str, float]:
        """Lengths of the links by name, mm; for a slider-crank also its offset, which may be negative."""
        return lengths_of(self.linkage)

    @property
    def ratio(self) -> float:
        """Longest link over the shortest, at least 1. An offset does not count as a link."""
        lengths = [length for name, length in self.lengths.items() if name != "offset"]
        return max(lengths) / min(lengths)

    @property
    def size(self) -> float:
        """The longest link, mm."""
        return max(length for name, length in self.lengths.items() if name != "offset")

    @property
    def drive_range(self) -> tuple[float, float]:
        """Least and greatest driver position, rad or mm."""
        return float(np.min(self.drive)), float(np.max(self.drive))

    def rounded(self, rounding: Rounding) -> Self:
        """The same with rounded sizes, and the results for these.

        Parameters
        ----------
        rounding : Rounding
            Rule by which each size is rounded.

        Raises
        ------
        DesignError
            If no linkage has the rounded sizes, for example if one is rounded to 0.
        """
        if self.linkage.linkage.driven_slider is not None:
            drive = np.array([rounding.length("drive", position) for position in self.drive.tolist()])
        else:
            first, *others = np.degrees(self.drive).tolist()
            drive = np.radians([rounding.angle("start_deg", first), *(rounding.angle("", angle) for angle in others)])
        other = replace(self, linkage=rounding.linkage(self.linkage), drive=drive)
        return replace(other, transmission_angle_deg=np.nan if self.defects else least_angle_deg(other))

    def summary(self) -> Mapping[str, object]:
        """Entries for `summary.json`: sizes in mm and deg with ten digits. Each search adds its error in front."""
        return size_entries(self.linkage) | {
            "branch": self.branch,
            "transmission_angle_deg": ten_digits(self.transmission_angle_deg),
            "ratio": ten_digits(self.ratio),
            "defects": list(self.defects),
        }


def least_angle_deg(found: Found) -> float:
    """Least transmission angle of the motion, deg; nan if the linkage does not close everywhere."""
    low, high = found.drive_range
    # The angle is least with crank and ground in line, a crank at right angles to a slide line, or a driving slider
    # next to the pivot.
    quarters = [0.0] if found.linkage.linkage.driven_slider is not None else 0.5 * np.pi * np.arange(-40, 41)
    within = [position for position in quarters if low < position < high]
    motion = move(found.linkage, np.sort([*np.linspace(low, high, FRAMES), *within]), found.branch)
    return float(np.degrees(least_transmission_angle(motion))) if motion.assembled.all() else np.nan


def size_entries(linkage: AbstractLinkage) -> dict[str, object]:
    """Entries for `summary.json`: lengths, traced point and origin in mm, angles in deg, with ten digits."""
    unit = "_mm" if isinstance(linkage, Linkage) else ""
    entries: dict[str, object] = {f"{name}{unit}": ten_digits(length) for name, length in lengths_of(linkage).items()}
    for name in ("coupler_point", "rod_point", "origin"):
        if hasattr(linkage, name):
            point = complex(getattr(linkage, name))
            entries[f"{name}_mm"] = [ten_digits(point.real), ten_digits(point.imag)]
    if isinstance(linkage, Linkage):
        places = {body: {p: complex(z) for p, z in points.items()} for body, points in linkage.bodies.items()}
        entries["bodies_mm"] = {
            body: {name: [ten_digits(z.real), ten_digits(z.imag)] for name, z in points.items()}
            for body, points in places.items()
        }
        if linkage.meshes:
            entries["meshes"] = [
                {"bodies": list(mesh.bodies), "teeth": list(mesh.teeth), "angle_deg": ten_digits(mesh.angle_deg)}
                for mesh in linkage.meshes
            ]
    for name in ("ground_angle_deg", "angle_deg"):
        if hasattr(linkage, name):
            entries[name] = ten_digits(getattr(linkage, name))
    return entries


def ten_digits(value: float) -> float | None:
    """A number with ten digits; None, which JSON writes as null, if it is not finite."""
    return to_digits_or_none(value, 10)
