"""Masses of a linkage's own sheet: round counterweights of bars, and flywheels on shaft and pins of the driver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...core.records import record
from ...model.material import Material
from ...plane.measure import area_moments
from ...plane.primitives import Circle, rounded_hull
from ...plane.vec import Complex, spaced_directions
from ..linkage import Linkage
from .plates import LinkAssembly, LinkPlate, unused
from .stock import LinkStock

# Corners of a round end, each rounded with half of the bar's width: the outline is within 2 % of a circle.
CIRCLE_CORNERS = 16
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
    circle = np.exp(2j * np.pi / CIRCLE_CORNERS * np.arange(CIRCLE_CORNERS))

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


# Corners of the polygon round a disc that stands for it in tests of collisions, up to 0.3 % larger than the disc.
RIM_CORNERS = 48
# Digits to which the diameter of a disc is rounded up: the inertia grows by 0.4 % at most.
DIGITS = 4
# Name of a single disc; several have numbers.
FLYWHEEL = "flywheel"


@record
class Flywheel:
    """A flywheel of equal discs. radius: mm. sheets: number of discs."""

    radius: float
    sheets: int

    def mass(self, material: Material, thickness: float) -> float:
        """Of full discs, kg."""
        return float(1e-9 * material.density * thickness * self.sheets * np.pi * self.radius**2)


def flywheel_of(inertia: float, sheets: int, material: Material, linkage: Linkage, stock: LinkStock) -> Flywheel:
    """The flywheel with at least an inertia, kg mm2, on the driver of a linkage, in spite of the holes for its pins."""
    points = linkage.bodies[linkage.driver]
    pivot = complex(points[str(linkage.driver_pivot)])
    hole = max(stock.hole_diameter, stock.shaft.bore if stock.shaft else 0.0) / 2
    apart = np.array([abs(complex(points[name]) - pivot) for name in points if name in linkage.joint_points])
    lost = float(np.sum(np.pi * hole**2 * (hole**2 / 2 + apart**2)))
    # Half the mass times the square of the radius.
    diameter = 2 * (2 / np.pi * (inertia / (sheets * 1e-9 * material.density * stock.thickness) + lost)) ** 0.25
    step = 10.0 ** (np.floor(np.log10(diameter)) + 1 - DIGITS)
    return Flywheel(float(np.ceil(diameter / step) * step) / 2, sheets)


def with_flywheel(assembly: LinkAssembly, linkage: Linkage, stock: LinkStock, wheel: Flywheel) -> LinkAssembly:
    """Plates with the discs of a flywheel next to that of the driver, on its shaft and on all its other pins.

    A disc that does not reach round a pin of the driver has a lug that does, so that it is held in two places.
    """
    driver, crank = linkage.driver, assembly.plates[linkage.driver]
    pivot = complex(linkage.bodies[driver][str(linkage.driver_pivot)])
    holes = {pin.name: crank.openings[pin.name] for pin in assembly.pins if driver in pin.holes}
    middle = min((places[0] for places in holes.values()), key=lambda place: abs(place - pivot))
    half = stock.bar_width / 2
    disc = Circle(middle, max(wheel.radius, half))
    rim = middle + (disc.radius - half) / np.cos(np.pi / RIM_CORNERS) * spaced_directions(RIM_CORNERS)
    plates, names = dict(assembly.plates), []
    for number in range(wheel.sheets):
        names.append(unused(f"{FLYWHEEL}_{number + 1}" if wheel.sheets > 1 else FLYWHEEL, plates))
        plates[names[-1]] = LinkPlate(driver, dict(holes), crank.seat, rim, disc=disc)
    pins = (replace(pin, holes=(*pin.holes, *names)) if driver in pin.holes else pin for pin in assembly.pins)
    return replace(assembly, plates=plates, pins=tuple(pins), pack=(driver, *names))
