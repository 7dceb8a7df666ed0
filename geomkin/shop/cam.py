"""Parts of a cam and its follower: cam plate, roller, and the plate that carries roller or face."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..arguments import checked
from ..brief import one_line
from ..cam.cam import Cam
from ..cam.followers.plates import Bars, Plate
from ..cam.maxima import samples
from ..cam.undercut import Undercut, undercut
from ..part import HoleFit, Part
from ..plane.curve import AbstractCurve
from ..plane.primitives import Arc, Circle, Polyline, Segment
from ..sizes import FARTHEST, entry, quantity
from .base import BaseStock
from .bore import bore, fits_of, shaft
from .cam_base import LETTERS, cam_base
from .fits import AbstractBored

# Of the timing mark, as shares of the ring between the hole and the base circle: the line's ends, and where the arrow
# runs across it.
LINE, ARROW = (0.2, 0.9), 0.55
# Sweep of the arrow, rad, and length of its head as a share of the ring: seen at a glance, and clear of both edges.
SWEEP, HEAD = np.pi / 4, 0.15


@dataclass(frozen=True)
class CamStock(AbstractBored):
    """What a cam and its follower are cut from, and what they turn on; all lengths in mm.

    Fit and form are those of the cam's bore; other holes run on their pins. Source: keyways as DIN 6885-1 gives them,
    depth in the hub along the middle; the defaults are chosen here.
    """

    thickness: float = quantity("thickness of the sheet", "mm", default=5.0, at_least=0.01, at_most=1000)
    bore: float = shaft("the cam shaft", 8.0, fitted=True)
    roller_bore: float = shaft("the roller's pin", 4.0)
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
        "distance from a translating flat face, or over a base from a translating roller, to the hole in its stem",
        "mm",
        default=40.0,
        above=0,
        at_most=FARTHEST,
    )
    pivot_bore: float = shaft("an arm's pivot, or of the pin in a stem", 6.0)

    __repr__ = one_line

    @property
    def bars(self) -> Bars:
        """What followers need to know of it."""
        return Bars(self.bar_width, self.overhang, self.stem_length, self.pivot_bore, self.roller_bore)


@checked
def cam_parts(
    cam: Cam, stock: CamStock = CamStock(), cut: Undercut | None = None, base: BaseStock | None = None
) -> list[Part]:
    """The parts to cut: `cam`, the plate about its axis, then those of its follower, each in its own frame, mm.

    They are `roller` and, of an arm or a flat face, `arm` or `follower`; a roller that moves straight needs a guide to
    fit and gets no plate. With a base, such a roller has a `follower` too, whose two pins slide in the base's slot, and
    holes that belong together have the same letter. Last comes the base, which then has the holes of the stock's motor,
    or the `motor_plate`. Where the follower undercuts, the cam plate is what it leaves; `undercut` tells what lift that
    costs. cut: what it found, where that is known already. Raises DesignError, its field a size of the stock, where
    holes or bars do not fit.

        gk.write(gk.shop.cam_parts(cam, gk.shop.CamStock(thickness=6, bore=10)), "cam.dxf")

    Source: derived here.
    """
    cut = cut or undercut(cam)
    plate, follower = _cam_plate(cam, stock, cut), cam.follower
    bars = stock.bars, cam.program, cam.base_radius, cam.sense
    if base is None:
        return [plate, *(_cut(other, stock) for other in follower.plates(*bars)), *stock.motor_parts]
    plates = follower.guided_plates(*bars)
    parts = [replace(plate, hole_names=("A",)), *(_cut(other, stock, LETTERS) for other in plates)]
    shafts = {"bore": stock.bore, "pivot_bore": stock.pivot_bore}
    return [*parts, cam_base(cam, cut, plates, shafts, stock.thickness, base, stock.motor)]


def _cut(plate: Plate, stock: CamStock, letters: Mapping[str, str] | None = None) -> Part:
    circles: list[Circle] = []
    names: list[str] = []
    fits: list[HoleFit] = []
    for hole in plate.holes:
        one = bore(hole.diameter, stock.clearance, hole.widest, f"stock.{hole.key}", hole.centre)
        circles += one
        fits += fits_of(hole.diameter, stock.clearance)
        names += [letters.get(hole.key, "") for _ in one] if letters else []
    return Part(
        plate.name,
        plate.outline,
        tuple(circles),
        stock.thickness,
        body=plate.name,
        hole_names=tuple(names),
        fits=tuple(fits),
    )


def _cam_plate(cam: Cam, stock: CamStock, cut: Undercut) -> Part:
    narrowest = 2 * float(np.abs(cut.outline.point(samples(cut.outline.breaks))).min())
    start = complex(cam.profile.point(0.0))
    towards = start / abs(start)
    holes = stock.hole(towards, narrowest, "stock")
    if not stock.timing_mark:
        return Part("cam", cut.outline, holes, stock.thickness, body="cam", fits=stock.fits)
    marks = _timing_marks(towards, stock.hole_reach, narrowest / 2, cam.sense)
    return Part("cam", cut.outline, holes, stock.thickness, marks=marks, body="cam", fits=stock.fits)


def _timing_marks(towards: complex, inner: float, outer: float, sense: int) -> tuple[AbstractCurve, ...]:
    """How the cam is put on its shaft, and which way it turns: a radial line in the unit direction `towards`, and from
    it an arrow.

    Both lie between two circles about the axis, mm. sense: +1 counterclockwise, -1 clockwise.
    """
    ring = outer - inner
    start, end = (towards * (inner + share * ring) for share in LINE)
    arrow = Arc(0j, towards * (inner + ARROW * ring), sense * SWEEP)
    tip = complex(arrow.point(1.0))
    back = -1j * sense * tip / abs(tip) * HEAD * ring
    barbs = np.array([tip + back * np.exp(0.5j), tip, tip + back * np.exp(-0.5j)])
    return Segment(start, end), arrow, Polyline(barbs, is_closed=False)
