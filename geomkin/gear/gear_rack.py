"""Racks: gears with their axis at infinity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..plane.primitives import Polyline
from ..sizes import check_sizes, entry, quantity
from .rack import RackCutter

# Radius of the corners at the back of the bar, modules: sharp ones cut fingers and chip in a drop.
CORNER = 0.5


@dataclass(frozen=True)
class GearRack:
    """A straight bar with teeth on top; its reference line is the x axis, a tooth is centred on +y.

    The teeth are those that the cutting rack would leave on a gear of infinitely many teeth: straight flanks,
    roots rounded with the radius of the rack's tips. The bar ends in the middle of a space on both sides.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=1, at_most=10_000, example=12)
    module: float = quantity("pitch by pi", "mm", above=0, at_most=1e5, example=2)
    rack: RackCutter = entry("the rack that cuts its mating gears, and gives its proportions", default=RackCutter())
    height: float = quantity(
        "of the bar, from its back to the reference line", "modules", default=5.0, above=0, at_most=1e6
    )
    thinning: float = quantity(
        "how much thinner each tooth is along the reference line, for backlash", "mm", default=0.0, at_least=0
    )

    def __post_init__(self) -> None:
        check_sizes(self)
        if self.height <= self.rack.dedendum:
            raise DesignError(
                "height",
                f"found {self.height:g} modules, no more than the teeth are deep",
                f"give more than {self.rack.dedendum:g}",
            )
        if self._tip < 0:
            most = self.thinning + 2 * self.module * self._tip
            if most <= 0:
                raise DesignError(
                    "rack.addendum", "the flanks meet below the tips", "give a rack with a smaller addendum"
                )
            raise DesignError(
                "thinning",
                f"found {self.thinning:g} mm, which points the teeth",
                f"give at most {most * (1 - 1e-5):.6g}",
            )

    @property
    def pressure_angle(self) -> float:
        """Angle of the flanks, rad."""
        return self.rack.pressure_angle

    @property
    def pitch(self) -> float:
        """Distance of neighbouring teeth, mm."""
        return float(np.pi * self.module)

    @property
    def tip_height(self) -> float:
        """Of the teeth above the reference line, mm."""
        return self.module * self.rack.addendum

    @property
    def root_depth(self) -> float:
        """Of the spaces below the reference line, mm."""
        return self.module * self.rack.dedendum

    @property
    def form_depth(self) -> float:
        """Depth below the reference line where the straight flanks end, mm."""
        return self.module * self.rack.flank_depth

    @property
    def thickness(self) -> float:
        """Of a tooth along the reference line, mm."""
        return self.pitch / 2 - self.thinning

    @property
    def _tip(self) -> float:
        """Half the width of a tooth's tip, modules."""
        return self.thickness / self.module / 2 - self.rack.addendum * float(np.tan(self.pressure_angle))

    @property
    def outline(self) -> AbstractCurve:
        """The bar as one closed counterclockwise curve of straight edges and arcs, exact."""
        a, m, rack = self.pressure_angle, self.module, self.rack
        land = rack.corner_side + self.thinning / m / 2
        deep = -1j * rack.dedendum
        # One tooth's right-hand side, downwards: tip, end of the flank, start of the bottom land, modules.
        flank_end = np.pi / 2 - land - rack.tip_radius * np.cos(a) - 1j * rack.flank_depth
        side = np.array([self._tip + 1j * rack.addendum, flank_end, np.pi / 2 - land + deep])
        # The rounding turns from the flank's slope to the level: a quarter of it as tan.
        turn = np.tan((np.pi / 2 - a) / 4)
        tooth = np.concatenate([-np.conj(side)[::-1], side])
        bends = np.array([turn, 0, 0, 0, turn, 0])
        first = -((self.teeth - 1) // 2)
        places = np.pi * (first + np.arange(self.teeth))
        top = (places[:, None] + tooth).ravel()
        right, left, back = places[-1] + np.pi / 2, places[0] - np.pi / 2, -1j * self.height
        corner = min(CORNER, 0.4 * (self.height - rack.dedendum))
        ends = np.array([right + deep, right + back + 1j * corner, right + back - corner])
        ends = np.append(ends, [left + back + corner, left + back + 1j * corner, left + deep])
        quarter = -np.tan(np.pi / 8)
        # Left to right along the teeth is clockwise: the other way round, with arcs bent the other way.
        vertices, bulges = np.append(top, ends), np.append(np.tile(bends, self.teeth), [0, quarter, 0, quarter, 0, 0])
        keep = np.abs(np.roll(vertices, -1) - vertices) > 1e-12 * self.height
        vertices, bulges = vertices[keep], bulges[keep]
        return Polyline(m * vertices[::-1], -np.roll(bulges[::-1], -1))
