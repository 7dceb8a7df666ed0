"""Drawings as engraved plates: a mechanism at one position, curves, vectors."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import quantity
from ...core.records import record
from ...model.part import Part
from ...plane.curve import AbstractCurve
from ...plane.primitives import Circle, Polyline, Segment, rounded_hull
from ...plane.vec import Complex
from ..motion import Motion

# Radius of the plate's corners and length of arrow heads, mm.
CORNER = 3.0
HEAD = 3.0
# Length of a pose's y axis relative to its x axis.
SHORTER = 0.5


@record(checked=True)
class PlateStock:
    """The plate on which a drawing is engraved.

    Parameters
    ----------
    thickness : float
        Thickness of the sheet, mm; from 0.01 to 1000.
    margin : float
        Clear edge around the drawing, mm; from 3 to 1000.
    pin_diameter : float
        Diameter of the circles drawn for pins, mm; above 0.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=3.0, at_least=0.01, at_most=1000)
    margin: float = quantity("clear edge around the drawing", "mm", default=8.0, at_least=3, at_most=1000)
    pin_diameter: float = quantity("diameter of the circles drawn for pins", "mm", default=4.0, above=0, at_most=1000)


@checked
def engraved(name: str, marks: Sequence[AbstractCurve], stock: PlateStock = PlateStock()) -> Part:
    """A plate that fits some marks and a margin, with the marks engraved; the coordinates of the drawing are kept.

    Parameters
    ----------
    name : str
        Name of the plate.
    marks : sequence of AbstractCurve
        Curves to engrave, mm.
    stock : PlateStock
        The plate.

    Returns
    -------
    Part

    Raises
    ------
    DesignError
        If there are no marks; its field is the plate's name.

    Notes
    -----
    Derived here.
    """
    curves = tuple(marks)
    if not curves:
        raise DesignError(
            name, "there is nothing to draw", "give a position that the linkage reaches", "does-not-assemble"
        )
    # Sixteenths of each smooth piece locate its extremes to far less than the margin.
    sampled = np.concatenate(
        [curve.point(np.linspace(curve.breaks[:-1], curve.breaks[1:], 17).ravel()) for curve in curves]
    )
    room = stock.margin - CORNER
    low = complex(sampled.real.min() - room, sampled.imag.min() - room)
    high = complex(sampled.real.max() + room, sampled.imag.max() + room)
    corners = [low, complex(high.real, low.imag), high, complex(low.real, high.imag)]
    return Part(name, rounded_hull(corners, CORNER), (), stock.thickness, marks=curves)


def skeleton(motion: Motion, frame: int, stock: PlateStock) -> list[AbstractCurve]:
    """The linkage at a frame: each body as lines between its points, with circles at the pins."""
    marks: list[AbstractCurve] = []
    radius = stock.pin_diameter / 2
    pins: dict[str, complex] = {}
    for name, points in motion.linkage.bodies.items():
        body = motion.bodies[name]
        places = {p: complex(body.point(z).position[frame]) for p, z in points.items()}
        pins |= {p: z for p, z in places.items() if p in motion.linkage.pins}
        if name == motion.linkage.ground:
            continue
        # Coincident points would draw their lines twice.
        corners = list(dict.fromkeys(places.values()))
        joints = list(zip(corners[:-1], corners[1:])) + ([(corners[-1], corners[0])] if len(corners) > 2 else [])
        marks += [line for a, b in joints for line in _between(a, b, radius)]
    return marks + [Circle(z, radius) for z in pins.values()]


def _between(a: complex, b: complex, radius: float) -> list[AbstractCurve]:
    """The line between two circles, if they leave room for one."""
    if abs(b - a) <= 2 * radius:
        return []
    offset = (b - a) / abs(b - a) * radius
    return [Segment(a + offset, b - offset)]


def pose_axes(poses: Iterable[tuple[complex, float]], length: float) -> list[AbstractCurve]:
    """Poses, position in mm and angle in rad, as axes: x of `length`, mm, and a shorter y."""
    x_axes = [(z, length * np.exp(1j * angle)) for z, angle in poses]
    return [Polyline(np.array([z + axis, z, z + SHORTER * 1j * axis]), is_closed=False) for z, axis in x_axes]


def arrow(tail: complex, tip: complex) -> list[AbstractCurve]:
    """A vector as a line with a head; nothing if it is too short for the files."""
    length = abs(tip - tail)
    if length < 1e-3:
        return []
    head = min(HEAD, length / 3) * (tail - tip) / length
    barbs = [tip + head * np.exp(1j * side * np.pi / 9) for side in (1, -1)]
    return [Segment(tail, tip), Polyline(np.array([barbs[0], tip, barbs[1]]), is_closed=False)]


def strokes(runs: Iterable[Complex]) -> list[AbstractCurve]:
    """Runs of points as open polylines."""
    return [Polyline(np.asarray(run), is_closed=False) for run in runs if len(run) > 1]
