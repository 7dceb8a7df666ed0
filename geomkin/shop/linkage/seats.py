"""A motor at a linkage's crank: which joint its shaft is, and what it has of each plate there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ...brief import one_line
from ...errors import DesignError
from ...linkage.linkage import Linkage
from ...part import HoleFit
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, Polyline
from ...plane.vec import Complex
from ..motors import CORNER, MOTORS
from .stock import LinkStock


@dataclass(frozen=True, eq=False)
class Seat:
    """What a motor has of a plate, in the frame of the plate's body.

    pin: the joint of its shaft. holes: cut there instead of a pin's; fits: of each. corners: what keeps other openings
    off, complex mm, with `radius`, mm, round them. rim: where the plate's edge goes round, complex mm.
    """

    pin: str
    holes: tuple[AbstractCurve, ...]
    fits: tuple[HoleFit, ...]
    corners: Complex
    radius: float
    rim: Complex = field(default_factory=lambda: np.zeros(0, dtype=complex))

    __repr__ = one_line


def seats(linkage: Linkage, axes: Mapping[str, Mapping[str, complex]], stock: LinkStock) -> dict[str, Seat]:
    """Seats of the stock's motor by the bodies that its shaft goes through; none without a motor.

    axes: places of the pins, mm, by pin and body. The crank has a bore for the shaft, its flat towards the crank's next
    point; the ground has the motor's holes. Raises DesignError where no crank on the ground drives, and where another
    body is on its joint. Derived here.
    """
    shaft, pivot = stock.shaft, linkage.driver_pivot
    if shaft is None or stock.motor is None:
        return {}
    if pivot is None:
        raise DesignError(
            "stock.motor",
            f"found {stock.motor}, but {linkage.driver}, which drives, turns on no pin of the {linkage.ground}",
            "let a crank on the ground drive, or leave it out",
        )
    crank, ground = linkage.driver, linkage.ground
    on_crank = linkage.bodies[crank]
    # Points that fall together have one joint, at the place of the first.
    fixed = {name: abs(on[crank] - complex(on_crank[pivot])) for name, on in axes.items() if {crank, ground} <= set(on)}
    name = min(fixed, key=fixed.__getitem__)
    found = {}
    for body, place in axes[name].items():
        if body == ground:
            face = MOTORS[stock.motor]
            # Nuts under the ground must clear the motor; rods are cut flush.
            beside = max(stock.fastener_used.across, stock.hole_diameter) - stock.hole_diameter
            rim = face.corners(place, min(CORNER, stock.bar_width / 2))
            holes, fits = face.holes(stock.clearance, place), face.fits(stock.clearance)
            found[body] = Seat(name, holes, fits, face.corners(place), beside / 2, rim)
        elif body == crank:
            away = next((complex(z) - place for z in on_crank.values() if complex(z) != place), 1 + 0j)
            bores = tuple(_moved(hole, place) for hole in shaft.hole(away / abs(away), stock.bar_width, "stock"))
            found[body] = Seat(name, bores, shaft.fits, np.array([place]), (shaft.bore + shaft.play) / 2)
        else:
            raise DesignError(
                "stock.motor",
                f"found {stock.motor}, on whose shaft the {body} would turn, too",
                "give it a pin of its own, or leave out motor",
            )
    return found


def _moved(hole: Circle | Polyline, place: complex) -> AbstractCurve:
    return Circle(place, hole.radius) if isinstance(hole, Circle) else Polyline(hole.vertices + place, hole.bulges)
