"""What every search returns: a linkage, and how well it does what was wanted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Self

import numpy as np

from ..core.records import record
from ..core.reprs import moving
from ..linkage.linkage import AbstractLinkage
from ..linkage.measures import least_transmission_angle
from ..linkage.moving import move
from ..plane.vec import Real
from .rounding import Rounding, lengths_of

# Frames of a motion, besides its extremes, in which it is seen whether the linkage closes all the way.
FRAMES = 361


@record(eq=False, kw_only=True)
class Found:
    """A linkage that a search found.

    linkage: placed in the plane, one that can be moved, drawn and cut. branch: +1 or -1, as `move` takes it. drive:
    (n,) where its driver stands at each of the wanted places, in their order, rad from the ground line, unwrapped, or
    mm where a slide drives; of a motion over a range its two ends. transmission_angle_deg: the least over the motion
    from the first to the last of them, and over the full turn where the search was for one; nan where the linkage
    does not close all the way. defects: those of "circuit", "branch", "order" that it has, in this order; empty where
    the linkage really goes from place to place in one drive of one sense.
    """

    linkage: AbstractLinkage
    branch: int
    drive: Real
    transmission_angle_deg: float
    defects: tuple[str, ...] = ()

    _repr_html_ = moving

    @property
    def lengths(self) -> Mapping[str, float]:
        """The links' lengths by name, mm; of a slider-crank its offset too, which may be negative."""
        return lengths_of(self.linkage)

    @property
    def ratio(self) -> float:
        """The longest link over the shortest: 1 and more. An offset is no link."""
        lengths = [length for name, length in self.lengths.items() if name != "offset"]
        return max(lengths) / min(lengths)

    @property
    def size(self) -> float:
        """The longest link, mm."""
        return max(length for name, length in self.lengths.items() if name != "offset")

    @property
    def drive_range(self) -> tuple[float, float]:
        """From where to where the driver goes, rad or mm."""
        return float(np.min(self.drive)), float(np.max(self.drive))

    def rounded(self, rounding: Rounding) -> Self:
        """The same with rounded sizes, and what it does with these.

        Raises
        ------
        DesignError
            If no linkage has these sizes, as when one is rounded to 0.
        """
        if self.linkage.linkage.driven_slider is not None:
            drive = np.array([rounding.length("drive", place) for place in self.drive.tolist()])
        else:
            first, *others = np.degrees(self.drive).tolist()
            drive = np.radians([rounding.angle("start_deg", first), *(rounding.angle("", turn) for turn in others)])
        other = replace(self, linkage=rounding.linkage(self.linkage), drive=drive)
        return replace(other, transmission_angle_deg=np.nan if self.defects else _least_angle_deg(other))

    def summary(self) -> Mapping[str, object]:
        """As `summary.json` lists it: sizes in mm and deg, with ten digits. A search adds its error in front."""
        return sizes_told(self.linkage) | {
            "branch": self.branch,
            "transmission_angle_deg": ten_digits(self.transmission_angle_deg),
            "ratio": ten_digits(self.ratio),
            "defects": list(self.defects),
        }


def _least_angle_deg(found: Found) -> float:
    """The least transmission angle over the motion, deg; nan if the linkage does not close all the way."""
    low, high = found.drive_range
    # Where it can be least: crank and ground in line, crank square to a slide line, a driving slide beside the pivot.
    quarters = [0.0] if found.linkage.linkage.driven_slider is not None else 0.5 * np.pi * np.arange(-40, 41)
    within = [place for place in quarters if low < place < high]
    motion = move(found.linkage, np.sort([*np.linspace(low, high, FRAMES), *within]), found.branch)
    return float(np.degrees(least_transmission_angle(motion))) if motion.assembled.all() else np.nan


def sizes_told(linkage: AbstractLinkage) -> dict[str, object]:
    """A linkage as `summary.json` lists it: lengths, traced point and place in mm, angles in deg, with ten digits."""
    told: dict[str, object] = {name: ten_digits(length) for name, length in lengths_of(linkage).items()}
    for name in ("coupler_point", "rod_point", "origin"):
        if hasattr(linkage, name):
            place = complex(getattr(linkage, name))
            told[f"{name}_mm"] = [ten_digits(place.real), ten_digits(place.imag)]
    for name in ("ground_angle_deg", "angle_deg"):
        if hasattr(linkage, name):
            told[name] = ten_digits(getattr(linkage, name))
    return told


def ten_digits(value: float) -> float | None:
    """Ten digits of a number; None, as JSON has no other word for it, for what cannot be told."""
    return float(f"{value:.10g}") if np.isfinite(value) else None
