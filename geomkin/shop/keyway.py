"""A shaft's hole with a slot for its key."""

from __future__ import annotations

import numpy as np

from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..plane.primitives import Circle, Polyline
from .bore import bore


def keyed_bore(
    diameter: float, clearance: float, width: float, depth: float, towards: complex, widest: float, key: str
) -> tuple[AbstractCurve, ...]:
    """The hole for a shaft about a part's axis, with a keyway of a width and depth, mm, on one side.

    diameter: of the shaft; the bore is wider by the clearance. depth: of the slot beyond the bore, along its middle.
    towards: unit direction of that middle. The slot has square corners and opens into the bore, as one outline.
    Width and depth 0: a plain bore; diameter 0: no hole.
    Raises DesignError, of sizes named `key`.bore and so on, where the hole does not leave a part of `widest` mm
    across where it is narrowest.
    """
    holes: tuple[Circle, ...] = bore(diameter, clearance, widest, f"{key}.bore")
    if width == 0 and depth == 0:
        return holes
    if width == 0 or depth == 0:
        missing = "width" if width == 0 else "depth"
        raise DesignError(f"{key}.keyway_{missing}", "found 0 mm", "give width and depth of the keyway, or neither")
    across = diameter + clearance
    if width >= across:
        raise DesignError(
            f"{key}.keyway_width",
            f"found {width:g} mm in a bore of {across:g} mm",
            "give a keyway narrower than the bore",
        )
    radius = across / 2
    corner = radius + depth + 0.5j * width
    if abs(corner) >= widest / 2:
        raise DesignError(
            f"{key}.keyway_depth",
            f"found {depth:g} mm, so the keyway reaches {abs(corner):.4g} mm from the axis of a part {widest:.4g} mm "
            "wide where it is narrowest",
            "give a shallower keyway or a smaller bore",
        )
    mouth = np.sqrt(radius**2 - width**2 / 4) + 0.5j * width
    # Round the bore from one side of the mouth to the other, and along the slot's three sides.
    sweep = 2 * np.pi - 2 * float(np.angle(mouth))
    corners = np.array([mouth, np.conj(mouth), np.conj(corner), corner])
    return (Polyline(corners * towards, np.array([np.tan(sweep / 4), 0, 0, 0])),)
