"""What every search returns: a linkage, and how well it does what was wanted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..brief import one_line
from ..display import moving
from ..linkage.bars import FourBar
from ..linkage.linkage import AbstractLinkage
from ..linkage.sliders import EllipticTrammel, SliderCrank
from ..plane.vec import Real


@dataclass(frozen=True, eq=False, kw_only=True)
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

    __repr__ = one_line
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

    def summary(self) -> Mapping[str, object]:
        """As `summary.json` lists it: sizes in mm and deg, with ten digits. A search adds its error in front."""
        return sizes_told(self.linkage) | {
            "branch": self.branch,
            "transmission_angle_deg": ten_digits(self.transmission_angle_deg),
            "ratio": ten_digits(self.ratio),
            "defects": list(self.defects),
        }


def lengths_of(linkage: AbstractLinkage) -> dict[str, float]:
    """Lengths of a linkage's links by name, mm; of a slider-crank its offset too."""
    names = {
        FourBar: ("ground", "crank", "coupler", "rocker"),
        SliderCrank: ("crank", "coupler", "offset"),
        EllipticTrammel: ("rod",),
    }[type(linkage)]
    return {name: float(getattr(linkage, name)) for name in names}


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
