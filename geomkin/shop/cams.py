"""Cam plate and roller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..cam.cam import Cam
from ..cam.limits import cam_angles, tightest_convex
from ..errors import DesignError
from ..part import Part
from ..plane.primitives import Circle
from ..sizes import check_sizes, quantity
from .bore import bore


@dataclass(frozen=True)
class CamStock:
    """What a cam and its roller are cut from."""

    thickness: float = quantity("thickness of the sheet", "mm", default=5.0, at_least=0.01, at_most=1000)
    bore: float = quantity("diameter of the hole for the cam shaft, 0 for none", "mm", default=8.0, at_least=0)
    roller_bore: float = quantity(
        "diameter of the hole for the roller's pin, 0 for none", "mm", default=4.0, at_least=0
    )

    def __post_init__(self) -> None:
        check_sizes(self)


def cam_parts(cam: Cam, stock: CamStock) -> list[Part]:
    """The cam plate about its axis, and the roller. Refuses a roller larger than the pitch curve can bear."""
    roller = cam.follower.roller_radius
    largest, angle = tightest_convex(cam)
    if roller >= largest:
        raise DesignError(
            "cam.follower.roller_radius",
            f"found {roller:g} mm, but at {angle * 57.29577951308232:.4g} deg the pitch curve bends with a radius of "
            f"{largest:.4g} mm, so the cam would be undercut",
            f"give less than {largest:.4g} mm, a larger base_radius or a longer segment there",
        )
    narrowest = 2 * float(np.abs(cam.profile.point(cam_angles(cam))).min())
    parts = [Part("cam", cam.profile, bore(stock.bore, narrowest, "stock.bore"), stock.thickness)]
    if roller > 0:
        hole = bore(stock.roller_bore, 2 * roller, "stock.roller_bore")
        parts.append(Part("roller", Circle(0j, roller), hole, stock.thickness))
    return parts
