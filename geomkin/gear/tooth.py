"""One tooth from bottom land to bottom land: tip, flanks and the root curves the rack's corner leaves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import DesignError
from ..plane.curve import AbstractCurve
from ..plane.derived import Mirrored, Moved, Reversed
from ..plane.joined import Path, Ring
from ..plane.pose import Pose
from ..plane.primitives import Arc
from ..plane.roulettes import Involute, Trochoid


def involute_function(roll: float) -> float:
    """inv(alpha) = tan(alpha) - alpha with roll = tan(alpha): the polar angle of the involute at a roll angle."""
    return float(roll - np.arctan(roll))


@dataclass(frozen=True)
class Tooth:
    """Sizes of a tooth centred on +y, mm and rad; the corner's place is measured from the rolling pitch line."""

    teeth: int
    pitch_radius: float
    base_radius: float
    tip_radius: float
    root_radius: float
    pressure_angle: float
    half_angle_at_base: float
    corner_depth: float
    corner_side: float
    corner_rounding: float
    flank_depth: float

    def __post_init__(self) -> None:
        if self.flank_start >= self.flank_end:
            raise DesignError(
                "profile_shift",
                f"with {self.teeth} teeth the rack's tip cuts away the whole involute",
                "give more teeth or a larger profile_shift",
            )

    @cached_property
    def _rack_start(self) -> float:
        """Roll angle of the involute where the straight flank of the rack ends; negative if undercut."""
        a = self.pressure_angle
        return float(np.tan(a) - self.flank_depth / (self.base_radius * np.sin(a)))

    @property
    def is_undercut(self) -> bool:
        """Whether the root curve crosses the involute instead of touching it."""
        return self._rack_start < 0

    @cached_property
    def _junction(self) -> tuple[float, float]:
        """Lean of the root curve's normal and roll angle of the involute where the two meet."""
        lean = -(np.pi / 2 - self.pressure_angle)
        return self._crossing(lean) if self.is_undercut else (lean, self._rack_start)

    @property
    def flank_start(self) -> float:
        """Roll angle where the involute begins."""
        return self._junction[1]

    @property
    def flank_end(self) -> float:
        """Roll angle at the tip circle."""
        return float(np.sqrt((self.tip_radius / self.base_radius) ** 2 - 1))

    @property
    def root_curve(self) -> AbstractCurve:
        """Right-hand root curve, from the bottom land up to the flank."""
        return Moved(Reversed(self._trochoid(self._junction[0])), self._root_pose)

    @property
    def flank(self) -> AbstractCurve:
        """Right-hand flank, from the root curve up to the tip."""
        cusp = np.exp(1j * (np.pi / 2 - self.half_angle_at_base))
        return Moved(Involute(self.base_radius, *sorted((self.flank_start, self.flank_end))), Pose(0j, cusp))

    def _trochoid(self, lean: float) -> Trochoid:
        return Trochoid(self.pitch_radius, self.corner_depth, self.corner_rounding, lean, 0.0)

    @property
    def _root_pose(self) -> Pose:
        # The corner is deepest where the rack has rolled by its distance from the middle of the space.
        angle = np.pi / 2 - np.pi / self.teeth + self.corner_side / self.pitch_radius
        return Pose(0j, np.exp(1j * angle))

    def _crossing(self, lean_end: float) -> tuple[float, float]:
        """Where the root curve of an undercut tooth leaves the involute, to rounding.

        The root curve passes the base circle inside the tooth and ends, at the flank's own normal, on
        the far branch of the involute outside it; in between it crosses the near branch once.
        """
        curve = Moved(self._trochoid(lean_end), self._root_pose)
        cusp_angle = np.pi / 2 - self.half_angle_at_base

        def beyond_base(lean: float) -> float:
            return abs(complex(curve.point(lean))) - self.base_radius

        def inside_tooth(lean: float) -> float:
            z = complex(curve.point(lean))
            return float(np.angle(z * np.exp(-1j * cusp_angle))) - involute_function(self._roll(abs(z)))

        base = _root(beyond_base, 0.0, lean_end)
        if inside_tooth(base) <= 0:
            return lean_end, 0.0  # at the very limit: the two meet at the cusp
        lean = _root(inside_tooth, base, lean_end)
        return lean, self._roll(abs(complex(curve.point(lean))))

    def _roll(self, radius: float) -> float:
        ratio = radius / self.base_radius
        return float(np.sqrt(max((ratio - 1) * (ratio + 1), 0.0)))


def outline(tooth: Tooth) -> AbstractCurve:
    """All teeth: root curve, flank, tip, flank, root curve and bottom land, as often as there are teeth."""
    rising = [tooth.root_curve, tooth.flank]
    falling = [Reversed(Mirrored(curve)) for curve in reversed(rising)]
    pieces = [*rising, _arc(rising[-1], falling[0]), *falling]
    if tooth.corner_side > 0:
        last = pieces[-1].point(pieces[-1].breaks[-1])
        sweep = 2 * tooth.corner_side / tooth.pitch_radius
        pieces.append(Arc(0j, complex(last), sweep))
    if abs(complex(rising[-1].point(rising[-1].breaks[-1])).real) < 1e-12 * tooth.tip_radius:
        pieces.pop(2)  # a pointed tooth has no tip land
    return Ring(Path(tuple(pieces)), tooth.teeth)


def _arc(before: AbstractCurve, after: AbstractCurve) -> Arc:
    """Arc about the origin from the end of one curve to the start of the next."""
    start, end = complex(before.point(before.breaks[-1])), complex(after.point(after.breaks[0]))
    return Arc(0j, start, float(np.angle(end / start)))


def _root(f, a: float, b: float) -> float:
    """Root of f between a and b, where it changes sign: false position that halves a stale end (Illinois)."""
    fa, fb = f(a), f(b)
    for _ in range(100):
        if fb == fa:
            break
        c = b - fb * (b - a) / (fb - fa)
        fc = f(c)
        if fc == 0 or abs(b - a) <= 4e-16 * (abs(a) + abs(b)):
            return c
        if (fc > 0) != (fb > 0):
            a, fa = b, fb
        else:
            fa /= 2
        b, fb = c, fc
    return b
