"""Curves as the text of an SVG path, as short as it can be told."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..plane.curve import AbstractCurve
from ..plane.flatten import flatten
from ..plane.primitives import Circle
from ..plane.vec import Complex, rounded


def path(curves: Iterable[AbstractCurve], tolerance: float, digits: int) -> str:
    """The curves, mm, y up as they are, within `tolerance`, in numbers of so many decimals; a circle stays one."""
    return "".join(_circle(c, digits) if isinstance(c, Circle) else _steps(c, tolerance, digits) for c in curves)


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
