"""The plate that holds planets round their sun."""

from __future__ import annotations

import numpy as np

from ...arguments import Positive, checked
from ...gear.planetary import PlanetarySet
from ...part import Part
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, rounded_hull
from ..bore import bore


@checked
def carrier(gears: PlanetarySet, diameters: tuple[float, float], margin: Positive, thickness: Positive) -> Part:
    """The plate that holds the planets at their distance, the sun's shaft passing its middle.

    diameters: of the holes for the shafts of sun and planets, mm.
    """
    sun, planet = diameters
    around = 1j * gears.inner.centre_distance * np.exp(2j * np.pi * np.arange(gears.planets) / gears.planets)
    outline: AbstractCurve = rounded_hull([0j, *around], max(diameters) / 2 + margin)
    holes = [*bore(sun, 0.0, 2 * gears.inner.centre_distance - planet, "sun_stock.bore")]
    holes += [Circle(complex(z), planet / 2) for z in around if planet]
    return Part("carrier", outline, tuple(holes), thickness, body="carrier")
