"""Counterweights that are part of a bar's own plate: round ends that give the plate a wanted first moment."""

from __future__ import annotations

import numpy as np

from ...core.records import record
from ...model.material import Material
from ...plane.measure import area_moments
from ...plane.primitives import rounded_hull
from ...plane.vec import Complex
from .plates import LinkPlate
from .stock import LinkStock

# Corners of a round end, each rounded with half of the bar's width: the outline is within 2 % of a circle.
CORNERS = 16
# Relative error of the first moment at which the search ends, and its most rounds.
SETTLED, ROUNDS = 1e-12, 40


@record(eq=False)
class RoundEnd:
    """A round end of a plate, in the frame of its body.

    rim: points that the plate's outline encloses at half of the bar's width, complex mm. centre, radius: of the disc,
    mm. added_mass: what the plate gains, kg.
    """

    rim: Complex
    centre: complex
    radius: float
    added_mass: float


def round_end(
    plate: LinkPlate, stock: LinkStock, material: Material, pivot: complex, moment: complex, distance: float
) -> RoundEnd:
    """The round end by which a plate gains a first moment about its pivot.

    The plate becomes the convex hull of the bar and a disc. For small moments the disc is as wide as the bar and nearer
    to the pivot than `distance`, otherwise it has this distance. If no such plate has the moment, the result is the one
    found nearest to it. Derived here.

    moment: kg mm, in the body's frame. distance: largest one of the disc's centre from the pivot, mm.
    """
    half, areal_density = stock.bar_width / 2, material.density * 1e-9 * stock.thickness
    # Positions are from the pivot.
    bar, wanted = plate.centres - pivot, moment / areal_density
    bare = area_moments(rounded_hull(bar, half))
    circle = np.exp(2j * np.pi / CORNERS * np.arange(CORNERS))

    def disc(place: complex) -> tuple[complex, float]:
        """Centre and radius of the corners' circle; beyond the largest distance the disc grows instead."""
        size = abs(place)
        return place * min(1.0, distance / size), max(size - distance, 0.0)

    def gained(place: complex) -> tuple[float, complex]:
        """Area that the plate gains, mm2, and its first moment, mm3."""
        centre, spread = disc(place)
        change = area_moments(rounded_hull([*bar, *(centre + spread * circle)], half)) + -bare
        return change.area, change.first

    place = distance * moment / abs(moment)
    area, first = gained(place)
    # Newton's method, with shorter steps as long as a step does not help.
    for _ in range(ROUNDS):
        if abs(first - wanted) <= SETTLED * abs(wanted):
            break
        small = 1e-6 * abs(place)
        slopes = [(gained(place + small * unit)[1] - first) / small for unit in (1, 1j)]
        matrix = np.array([[z.real for z in slopes], [z.imag for z in slopes]])
        missing = wanted - first
        step = complex(*np.linalg.lstsq(matrix, [missing.real, missing.imag], rcond=None)[0])
        step *= min(1.0, abs(place) / 2 / abs(step)) if step else 0.0
        for _ in range(ROUNDS):
            next_area, next_first = gained(place + step)
            if abs(next_first - wanted) < abs(missing):
                place, area, first = place + step, next_area, next_first
                break
            step /= 2
    centre, spread = disc(place)
    return RoundEnd(pivot + centre + spread * circle, pivot + centre, half + spread, areal_density * area)
