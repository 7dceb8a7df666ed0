"""One tooth from bottom land to bottom land: tip, flanks, their roundings, and the root curves of a rack's corner."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..core.fields import last_fit
from ..core.records import record
from ..plane.curve import AbstractCurve, Mirrored, Moved, Reversed
from ..plane.joined import Path, PolarArray
from ..plane.primitives import Arc, Segment
from ..plane.roulettes import Involute, Trochoid, involute_function, roll_at
from ..plane.vec import Pose
from .contract import NARROW, AbstractTooth


@record
class TipRounding:
    """The arc that rounds a tooth's tip.

    radius: distance of its centre from the gear's axis, mm; angle: of the centre from the tooth's middle, rad;
    roll: angle of the flank's involute where the rounding begins.
    """

    radius: float
    angle: float
    roll: float


def tip_rounding(base_radius: float, half_angle_at_base: float, tip_radius: float, rounding: float) -> TipRounding:
    """The arc of radius `rounding`, mm, that touches the flank and the tip circle from inside the tooth.

    Its centre lies on the parallel curve of the flank, which is the same involute turned by
    rounding / base_radius. The angle is negative where the two roundings of a tooth would overlap.
    Asks for rounding <= tip_radius - base_radius.
    """
    radius = tip_radius - rounding
    roll = roll_at(radius, base_radius)
    angle = half_angle_at_base - involute_function(roll) - rounding / base_radius
    return TipRounding(radius, angle, roll + rounding / base_radius)


def largest_rounding(base_radius: float, half_angle_at_base: float, tip_radius: float) -> float:
    """The largest rounding, mm, of a tooth's tip: where its two roundings, or its base circle, meet."""

    def fits(rounding: float) -> bool:
        return tip_rounding(base_radius, half_angle_at_base, tip_radius, rounding).angle >= 0

    high = tip_radius - base_radius
    return high if fits(high) else last_fit(fits, 0.0, high)


def envelope_end(
    envelope: AbstractCurve,
    speed: Callable[[float], float],
    end: float,
    half_angle: Callable[[float], float],
    land: float,
) -> float:
    """Where a tip that a tool's root fillet rounds leaves the flank: the parameter of the fillet's envelope.

    envelope: on the tip circle at 0, which is turned to +x, on the flank at `end`; speed: along it. half_angle: of the
    involute's tooth at a radius; land: half the angle that the envelope leaves of the tip circle, rad. nan where the
    flanks alone cut the tip. Between a cusp and the flank the envelope runs back through the tooth: then it crosses the
    flank and leaves a blunt edge.
    """

    def inside(t: float) -> float:
        z = complex(envelope.point(t))
        return half_angle(abs(z)) - land - abs(float(np.angle(z)))

    if inside(0.0) <= 0:
        return float("nan")
    if speed(end) * speed(0.0) > 0:
        return end
    cusp = _root(speed, 0.0, end)
    return _root(inside, 0.0, cusp) if inside(cusp) < 0 else end


@record
class Tooth(AbstractTooth):
    """A tooth as a rack leaves it; the place of the rack's rounded corners is measured from the rolling pitch line."""

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
    tip_rounding: float = 0.0
    tip_chamfer: float = 0.0
    # Of the rack's root fillet, its centre and where its flank ends, above the rolling pitch line.
    fillet_radius: float = 0.0
    fillet_height: float = 0.0
    fillet_side: float = 0.0
    flank_height: float = 0.0

    @cached_property
    def stands(self) -> bool:
        """Whether there is a tooth: outside root and base circle something of the involute, and a neck under it."""
        if self.root_radius <= 0 or self.tip_radius <= max(self.root_radius, self.base_radius):
            return False
        if self.half_angle_at_base <= 0 or self.rolls[0] >= self.rolls[1]:
            return False
        root = self.root_curve
        # Only undercut makes a neck; a sample sees it to a thousandth of what would hold.
        return not self.is_undercut or root.point(np.linspace(root.breaks[0], root.breaks[-1], 65)).real.min() > 0

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
        lean = self._flank_lean
        return self._crossing(lean) if self.is_undercut else (lean, self._rack_start)

    @property
    def _flank_lean(self) -> float:
        """Lean of the rack's flank, as of the normals of its roundings where they end on it."""
        return -(np.pi / 2 - self.pressure_angle)

    @cached_property
    def _fillet(self) -> Trochoid | None:
        """What the rack's root fillet leaves of the tip, from the flank to the tip circle; None where it cuts none.

        Its centre stands above the rolling line and it cuts from outside: both lengths count as negative.
        """
        if not self.fillet_radius:
            return None
        whole = Trochoid(self.pitch_radius, -self.fillet_height, -self.fillet_radius, self._flank_lean, 0.0)
        land = self.fillet_side / self.pitch_radius
        start = envelope_end(whole, whole.speed, self._flank_lean, self.half_angle, land)
        return None if np.isnan(start) else replace(whole, start=start)

    @cached_property
    def rolls(self) -> tuple[float, float]:
        """Roll angles where the involute begins, and where it ends: at the tip circle, or where the tip is broken."""
        if self._fillet is not None:
            start = self._fillet.start
            if start == self._flank_lean:
                a = self.pressure_angle
                return self._junction[1], float(np.tan(a) + self.flank_height / (self.base_radius * np.sin(a)))
            return self._junction[1], roll_at(abs(complex(self._fillet.point(start))), self.base_radius)
        broken = (
            self._corner.roll if self.tip_rounding else roll_at(self.tip_radius - self.tip_chamfer, self.base_radius)
        )
        return self._junction[1], broken

    def half_angle(self, radius: float) -> float:
        return self.half_angle_at_base - involute_function(roll_at(radius, self.base_radius))

    @property
    def tip_land(self) -> float:
        """Half the angle of the tip circle's part of the tooth, rad; negative where nothing of it is left."""
        if self._fillet is not None:
            return self.fillet_side / self.pitch_radius
        if self.tip_rounding:
            return self._corner.angle
        return self.half_angle(self.tip_radius) - self.tip_chamfer / self.tip_radius

    @cached_property
    def root_curve(self) -> AbstractCurve:
        return Moved(Reversed(self._trochoid(self._junction[0])), self._root_pose)

    @cached_property
    def flank(self) -> AbstractCurve:
        cusp = np.exp(1j * (np.pi / 2 - self.half_angle_at_base))
        return Moved(Involute(self.base_radius, *self.rolls), Pose(0j, cusp))

    @property
    def tip_edge(self) -> AbstractCurve | None:
        """What breaks the tip's right-hand edge, from the flank to the tip circle; None where it is sharp."""
        if self._fillet is not None:
            return Moved(self._fillet, Pose(0j, 1j * np.exp(-1j * self.tip_land)))
        if not (self.tip_rounding or self.tip_chamfer):
            return None
        start = complex(self.flank.point(self.rolls[1]))
        # A full round ends in the tooth's very middle.
        towards = 1j * np.exp(-1j * max(0.0, self.tip_land))
        if self.tip_chamfer:
            return Segment(start, self.tip_radius * towards)
        centre = self._corner.radius * towards
        return Arc(centre, start, float(np.angle(towards / (start - centre))))

    @cached_property
    def _corner(self) -> TipRounding:
        return tip_rounding(self.base_radius, self.half_angle_at_base, self.tip_radius, self.tip_rounding)

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
        the far branch of the involute outside it; in between it crosses the near branch once. Seen from where the line
        of action touches the base circle, as the rack's corner cuts the point, so that nothing is
        told by a difference of large numbers where the crossing is near the base circle. Derived here.
        """
        base, far = self.base_radius, -self._rack_start
        end = self.corner_depth / np.cos(lean_end)

        def seen(turn: float) -> tuple[float, float, float]:
            """Of the point cut at a lean of `turn` from the end's: how far it lies along the line of action and outside
            it, mm, and by what the squares of its distance from the axis and of the base radius differ.
            """
            lean = lean_end + turn
            # 1 / cos(lean) less the same at the end, as a product.
            less = np.sin(0.5 * turn) * np.sin(lean_end + 0.5 * turn) / (np.cos(lean) * np.cos(lean_end))
            reach = 2 * self.corner_depth * less
            whole = end + self.corner_rounding + reach
            along = base * far + reach - 2 * whole * np.sin(0.5 * turn) ** 2
            across = -whole * np.sin(turn)
            return along, across, along**2 + (2 * base + across) * across

        def beyond_base(turn: float) -> float:
            return seen(turn)[2]

        def inside_tooth(turn: float) -> float:
            along, across, square = seen(turn)
            rolled = self.corner_depth * np.sin(turn) / (np.cos(lean_end + turn) * np.cos(lean_end) * self.pitch_radius)
            roll = np.sqrt(max(square, 0.0)) / base
            return float(np.arctan2(along, base + across) + rolled - far) - involute_function(roll)

        foot = _root(beyond_base, -lean_end, 0.0)
        if inside_tooth(foot) <= 0:
            return lean_end, 0.0  # at the very limit: the two meet at the cusp
        turn = _root(inside_tooth, foot, 0.0)
        return lean_end + turn, float(np.sqrt(max(seen(turn)[2], 0.0)) / base)


def outline(tooth: Tooth) -> PolarArray:
    """All teeth: half a bottom land, root curve, flank and tip, and the same back, as often as there are teeth."""
    side = [tooth.root_curve, tooth.flank, *([tooth.tip_edge] if tooth.tip_edge else [])]
    return toothed([with_land(side, tooth.corner_side / tooth.pitch_radius)], tooth.teeth)


def with_land(side: list[AbstractCurve], half_land: float) -> Path:
    """A tooth's right-hand side from the middle of the bottom land, of which it has half the angle, rad."""
    root = complex(side[0].point(side[0].breaks[0]))
    # A full-round rack leaves no bottom land.
    land = [Arc(0j, root * np.exp(-1j * half_land), half_land)] if half_land > NARROW else []
    return Path((*land, *side))


def toothed(side: list[AbstractCurve], teeth: int, half_land: float = 0.0) -> PolarArray:
    """The ring of `teeth` teeth of which `side` is the right-hand side of the one on +y, root to tip.

    half_land: half the angle, rad, of a bottom land from tooth to tooth that `side` does not begin with.
    """
    other = [Reversed(Mirrored(curve)) for curve in reversed(side)]
    tip = complex(side[-1].point(side[-1].breaks[-1]))
    # A pointed tooth has no tip land.
    top = [Arc(0j, tip, 2 * float(np.arctan2(tip.real, tip.imag)))] if tip.real > NARROW * abs(tip) else []
    bottom = []
    if half_land > NARROW:
        root = complex(side[0].point(side[0].breaks[0]))
        bottom = [Arc(0j, -root.conjugate(), 2 * half_land)]
    return PolarArray(Path((*side, *top, *other, *bottom)), teeth)


def _root(f: Callable[[float], float], a: float, b: float) -> float:
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
