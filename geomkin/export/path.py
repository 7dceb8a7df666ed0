"""Curves as the text of an SVG path, as short as it can be told."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..plane.arcs import to_arcs
from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..plane.joined import Path
from ..plane.primitives import Arc, Circle, Segment
from ..plane.vec import Complex, rounded


def path(curves: Iterable[AbstractCurve], tolerance: float, digits: int) -> str:
    """The curves, mm, y up as they are, within `tolerance`, in numbers of so many decimals; arcs stay what they are."""
    return "".join(_told(curve, tolerance, digits) for curve in curves)


def _told(curve: AbstractCurve, tolerance: float, digits: int) -> str:
    match curve:
        case Circle():
            return _circle(curve, digits)
        case Path() if all(isinstance(piece, Arc | Segment) for piece in curve.pieces):
            return _arcs(curve, tolerance, digits)
        case _:
            return _steps(curve, tolerance, digits)


def _arcs(curve: Path, tolerance: float, digits: int) -> str:
    """Each piece by the step to its end: an arc, of half a turn at most, with its radius and the side that it is on."""
    chain = to_arcs(curve, tolerance)
    # Of an open one the last step, back to the start, has no bulge and is not told.
    points = rounded(np.append(chain.vertices, chain.vertices[:1]), digits)
    bulges = np.zeros(0) if chain.bulges is None else np.asarray(chain.bulges)
    text = f"M{_pair(points[0].item(), digits)}"
    for step, bulge in zip(rounded(np.diff(points), digits).tolist(), bulges.tolist()):
        if bulge:
            radius = decimal(rounded(abs(step) * (1 + bulge**2) / (4 * abs(bulge)), digits).item(), digits)
            text += f"a{radius} {radius} 0 0 {int(bulge > 0)} {_pair(step, digits)}"
        else:
            text += f"l{_pair(step, digits)}"
    return text.replace(" -", "-") + "z" * curve.closed


def _steps(curve: AbstractCurve, tolerance: float, digits: int) -> str:
    """A start and the steps from there: sums of rounded steps between rounded points end where they should."""
    points = rounded(flatten(curve, tolerance), digits)
    steps = rounded(np.diff(points), digits)
    text = " ".join([f"M{_pair(points[0], digits)}l", *(_pair(step, digits) for step in steps.tolist())])
    return text.replace("l ", "l").replace(" -", "-") + "z" * curve.closed


def _circle(circle: Circle, digits: int) -> str:
    radius = rounded(circle.radius, digits).item()
    start: Complex = rounded(circle.centre - radius, digits)
    arc, across = f"a{decimal(radius, digits)} {decimal(radius, digits)} 0 0 1 ", decimal(2 * radius, digits)
    return f"M{_pair(start.item(), digits)}{arc}{across} 0{arc[:-1]}-{across} 0z"


def _pair(z: complex, digits: int) -> str:
    return f"{decimal(z.real, digits)} {decimal(z.imag, digits)}"


def decimal(value: float, digits: int) -> str:
    """A rounded number as its shortest decimal text, without the zero before its point."""
    text = f"{value:.{max(0, digits)}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    text = text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text
    return "0" if text in ("-0", "") else text
