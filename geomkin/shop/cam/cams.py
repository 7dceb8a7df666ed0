"""Cam plate, roller, and the plate that carries roller or face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...cam.cam import Cam
from ...cam.extremes import samples
from ...cam.followers.follower import OscillatingFlat, OscillatingRoller, Roller, TranslatingFlat
from ...cam.limits import contact_travel
from ...cam.followers.pivot import side_sign
from ...cam.undercut import Undercut, undercut
from ...part import Part
from ...plane.primitives import Circle, rounded_hull
from ...sizes import FARTHEST, check_sizes, entry, quantity
from ..bore import bore, clearance, keyed_bore, shaft, widened
from .cam_followers import CORNER, faced_arm, rounded, stemmed_face
from .timing import timing_marks


@dataclass(frozen=True)
class CamStock:
    """What a cam and its follower are cut from."""

    thickness: float = quantity("thickness of the sheet", "mm", default=5.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the cam shaft", 8.0)
    roller_bore: float = shaft("the roller's pin", 4.0)
    keyway_width: float = quantity(
        "width of the keyway in the bore, 0 for none", "mm", default=0.0, at_least=0, at_most=FARTHEST
    )
    keyway_depth: float = quantity(
        "depth of the keyway beyond the bore, along its middle", "mm", default=0.0, at_least=0, at_most=FARTHEST
    )
    timing_mark: bool = entry(
        "engrave a line towards where the follower touches at cam angle 0, and the way the cam turns", default=False
    )
    bar_width: float = quantity(
        "width of a flat follower's bars and of arms", "mm", default=12.0, at_least=0.01, at_most=FARTHEST
    )
    overhang: float = quantity(
        "how far a flat face runs beyond where the cam touches it", "mm", default=2.0, at_least=0, at_most=FARTHEST
    )
    stem_length: float = quantity(
        "distance from a translating flat face to the hole in its stem", "mm", default=40.0, above=0, at_most=FARTHEST
    )
    pivot_bore: float = shaft("an arm's pivot, or of the pin in a stem", 6.0)
    clearance: float = clearance(0.0)

    def __post_init__(self) -> None:
        check_sizes(self)


def cam_parts(cam: Cam, stock: CamStock, cut: Undercut | None = None) -> list[Part]:
    """The cam plate about its axis, a roller, and a flat follower or an arm.

    Where the follower undercuts, the plate is what it leaves; `undercut` tells what lift that costs. cut: what it
    found, where that is known already.
    """
    return [_plate(cam, stock, cut or undercut(cam)), *_rollers(cam, stock), *_carriers(cam, stock)]


def _plate(cam: Cam, stock: CamStock, cut: Undercut) -> Part:
    narrowest = 2 * float(np.abs(cut.outline.point(samples(cut.outline.breaks))).min())
    start = complex(cam.profile.point(0.0))
    towards = start / abs(start)
    play, width, depth = stock.clearance, stock.keyway_width, stock.keyway_depth
    holes = keyed_bore(stock.bore, play, width, depth, towards, narrowest, "stock")
    if not stock.timing_mark:
        return Part("cam", cut.outline, holes, stock.thickness)
    inner = abs(complex(widened(stock.bore, play) / 2 + depth, width / 2))
    marks = timing_marks(towards, inner, narrowest / 2, cam.sense)
    return Part("cam", cut.outline, holes, stock.thickness, marks=marks)


def _rollers(cam: Cam, stock: CamStock) -> list[Part]:
    if not isinstance(cam.follower, Roller) or cam.follower.roller_radius == 0:
        return []
    radius = cam.follower.roller_radius
    hole = bore(stock.roller_bore, stock.clearance, 2 * radius, "stock.roller_bore")
    return [Part("roller", Circle(0j, radius), hole, stock.thickness)]


def _carriers(cam: Cam, stock: CamStock) -> list[Part]:
    """The plate of a follower in its own frame; none of a roller that moves straight, which needs a guide to fit."""
    follower, width = cam.follower, stock.bar_width

    def hole(diameter: float, key: str, place: complex = 0j) -> tuple[Circle, ...]:
        return bore(diameter, stock.clearance, width, f"stock.{key}", place)

    # The corners of a face lie beyond what the cam touches.
    corner = min(CORNER, stock.overhang)
    match follower:
        case TranslatingFlat():
            outline, place = stemmed_face(_face(cam, stock), follower.tilt, width, stock.stem_length)
            holes = hole(stock.pivot_bore, "pivot_bore", place)
            return [Part("follower", rounded(outline, corner), holes, stock.thickness)]
        case OscillatingFlat():
            arm = faced_arm(_face(cam, stock), follower.face_offset, width, side_sign(follower.side))
            holes = hole(stock.pivot_bore, "pivot_bore")
            return [Part("arm", rounded(arm, corner), holes, stock.thickness)]
        case OscillatingRoller():
            end = complex(follower.arm_length)
            holes = hole(stock.pivot_bore, "pivot_bore")
            if follower.roller_radius:
                holes += hole(stock.roller_bore, "roller_bore", end)
            return [Part("arm", rounded_hull([0j, end], width / 2), holes, stock.thickness)]
    return []


def _face(cam: Cam, stock: CamStock) -> tuple[float, float]:
    low, high = contact_travel(cam)
    return low - stock.overhang, high + stock.overhang
