"""A gear of any tooth form, given by one flank."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arguments import checked
from ...errors import DesignError
from ...plane.curve import AbstractCurve
from ...plane.derived import Moved
from ...plane.flatten import flatten
from ...plane.joined import Ring
from ...plane.pose import Pose
from ...plane.primitives import Segment
from ...plane.spread import direction
from ...sizes import FARTHEST, Length, check_sizes, quantity
from ..tooth import toothed

# Pitch radii from the axis that a flank may reach. More is no tooth, and its chords could be without number.
FARTHEST_OUT = 4


@dataclass(frozen=True, eq=False)
class FlankGear:
    """A gear about the origin, its tooth on +y symmetric, with lands about the axis at tips and bottoms.

    flank: its right-hand side from the bottom land out to the tip, in the half plane x >= 0 and within half a
    pitch of +y. pitch_radius, mm: of the circle that rolls on the mate's.
    """

    flank: AbstractCurve
    teeth: int = quantity("number of teeth", whole=True, at_least=2, at_most=10_000)
    pitch_radius: float = quantity("radius of the circle that rolls on the mate's", "mm", above=0, at_most=FARTHEST)

    def __post_init__(self) -> None:
        check_sizes(self)
        self._check_reach()
        z = flatten(self.flank, 1e-4 * self.pitch_radius)
        angle = np.angle(1j / z)
        if not self.root_radius < self.pitch_radius < self.tip_radius:
            raise DesignError(
                "flank",
                f"it runs from {self.root_radius:.5g} to {self.tip_radius:.5g} mm from the axis, "
                f"past no pitch circle of {self.pitch_radius:.5g} mm",
                "give it from the bottom land out to the tip, across the pitch circle",
            )
        # A flank may end in the tooth's middle, up to rounding.
        if angle.min() < -1e-9:
            raise DesignError(
                "flank", "it crosses the middle of its tooth", "give the side with x >= 0 and +y in the middle"
            )
        if angle.max() > np.pi / self.teeth * (1 + 1e-9):
            raise DesignError(
                "flank",
                f"it lies up to {np.degrees(angle.max()):.4g} deg from the middle of its tooth, beyond half a pitch",
                f"keep it within {180 / self.teeth:.4g} deg of +y: thinner teeth or fewer",
            )

    def _check_reach(self) -> None:
        """Far beyond the pitch circle there is no tooth, and no end to what it would take to look at it."""
        b = self.flank.breaks
        z = self.flank.point(np.concatenate([b, 0.5 * (b[:-1] + b[1:])]))
        if self.flank.closed or not np.isfinite(z).all():
            raise DesignError("flank", "it is closed, or not finite", "give one open side of a tooth")
        most = FARTHEST_OUT * self.pitch_radius
        if (far := float(np.abs(z).max())) > most:
            raise DesignError(
                "flank",
                f"it reaches {far:.5g} mm from the axis, with a pitch circle of {self.pitch_radius:.5g} mm",
                f"keep it within {most * (1 - 1e-5):.6g} mm of the axis",
            )

    @property
    def root_radius(self) -> float:
        """Radius of the bottom lands, mm."""
        return float(abs(self.flank.point(self.flank.breaks[0])))

    @property
    def tip_radius(self) -> float:
        """Radius of the tip lands, mm."""
        return float(abs(self.flank.point(self.flank.breaks[-1])))

    @cached_property
    def outline(self) -> Ring:
        """The whole gear as one closed counterclockwise curve of exact pieces; the flank is piece 0 of its tooth."""
        return self._toothed([self.flank])

    @property
    def most_backlash(self) -> float:
        """Backlash, mm, for which neighbouring teeth of the mate's cutter meet: it takes up the whole bottom lands."""
        return 2 * self.pitch_radius * self._half_land(self.flank)

    @checked
    def cutter(self, clearance: Length, backlash: Length = 0.0) -> AbstractCurve:
        """What cuts a mate: the tooth drawn out and made thicker; its right-hand flank is piece 0 all the same.

        clearance: room at the mate's roots, mm along the radius, for which the flanks are drawn out straight at the
        tip. backlash: play of the pair, mm along the pitch circle, for which each flank is turned about the axis,
        away from the tooth's middle, by backlash / (2 pitch_radius). The mate's flanks are as much turned, so that
        either runs at the same constant ratio. The gear's own flank touches where the cutter's does, when the gear
        has turned less by that angle, counterclockwise, for the right-hand flank, and more for the left.
        """
        if clearance == 0 and backlash == 0:
            return self.outline.piece
        if backlash > self.most_backlash:
            raise DesignError(
                "backlash",
                f"found {backlash:.5g} mm, for which neighbouring teeth of the mate's cutter run into each other",
                f"give at most {self.most_backlash * (1 - 1e-5):.6g}",
            )
        flank = Moved(self.flank, Pose(0j, np.exp(-0.5j * backlash / self.pitch_radius)))
        if clearance == 0:
            return self._toothed([flank]).piece
        end = complex(flank.point(flank.breaks[-1]))
        along = complex(direction(flank, flank.breaks[-1:], after=False)[0])
        # Up the tangent to the wider circle: |end + s along| = tip + clearance.
        rise = (np.conj(along) * end).real
        grown = clearance * (2 * self.tip_radius + clearance)
        squared = rise**2 + grown
        s = float(grown / (rise + np.sqrt(squared))) if rise > 0 else np.inf
        if end.real + s * along.real < 0 or not np.isfinite(s):
            room = abs(end - along * end.real / along.real) - self.tip_radius if along.real < 0 else 0.0
            raise DesignError(
                "clearance",
                f"found {clearance:.5g} mm, but the flanks drawn on beyond the tip meet after {room:.5g}",
                f"give at most {room * (1 - 1e-5):.6g}",
            )
        return self._toothed([flank, Segment(end, end + s * along)]).piece

    def _half_land(self, flank: AbstractCurve) -> float:
        """Half the angle of the bottom land that a flank leaves, rad."""
        return max(0.0, np.pi / self.teeth - float(np.angle(1j / flank.point(flank.breaks[0]))))

    def _toothed(self, side: list[AbstractCurve]) -> Ring:
        """All teeth from the right-hand side of one."""
        return toothed(side, self.teeth, self._half_land(side[0]))
