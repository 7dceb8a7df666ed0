"""Flywheels: discs of the sheet of a linkage on the shaft and the pins of its driver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...core.records import record
from ...model.material import Material
from ...plane.primitives import Circle
from ...plane.vec import spaced_directions
from ..linkage import Linkage
from .plates import LinkAssembly, LinkPlate, unused
from .stock import LinkStock

# Corners of the polygon round a disc that stands for it in tests of collisions, up to 0.3 % larger than the disc.
CORNERS = 48
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
    rim = middle + (disc.radius - half) / np.cos(np.pi / CORNERS) * spaced_directions(CORNERS)
    plates, names = dict(assembly.plates), []
    for number in range(wheel.sheets):
        names.append(unused(f"{FLYWHEEL}_{number + 1}" if wheel.sheets > 1 else FLYWHEEL, plates))
        plates[names[-1]] = LinkPlate(driver, dict(holes), crank.seat, rim, disc=disc)
    pins = (replace(pin, holes=(*pin.holes, *names)) if driver in pin.holes else pin for pin in assembly.pins)
    return replace(assembly, plates=plates, pins=tuple(pins), pack=(driver, *names))
