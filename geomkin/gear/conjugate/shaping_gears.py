"""Gears of any tooth form, told by one flank: as a curve, by points, or straight."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Annotated

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, Length, PointXY, entry, quantity, rounded_down, rounded_up
from ...core.records import record
from ...plane.curve import AbstractCurve, Mirrored, Moved, Reversed
from ...plane.flatten import flatten
from ...plane.joined import Path, PolarArray
from ...plane.primitives import Arc, Circle, Segment
from ...plane.spline import Spline
from ...plane.subdivision import direction
from ...plane.vec import Pose
from ..contract import AbstractGear, AbstractShaper
from ..module import Settled, diametral_pitch, module, settle_module
from ..tooth import toothed

# Pitch radii from the axis that a flank may reach. More is no tooth, and its chords could be without number.
FARTHEST_OUT = 4
# A flank that runs out a little, stays steep and rounds over towards the tip.
EXAMPLE = (3.4 + 33.2j, 2.9 + 34.4j, 2.35 + 36j, 1.75 + 37.6j, 1.0 + 39j)
# Points of a flank. More, each with its own bend, take minutes to shape a mate.
MOST_POINTS = 100


class AbstractFlankGear(AbstractGear, AbstractShaper):
    """A gear whose tooth on +y is symmetric, with lands about the axis at tips and bottoms."""

    if TYPE_CHECKING:

        @property
        @abstractmethod
        def flank(self) -> AbstractCurve:
            """Right-hand side of the tooth on +y, from the bottom land out to the tip, x >= 0."""

    @property
    def root_radius(self) -> float:
        """Radius of the bottom lands, mm."""
        return float(abs(self.flank.point(self.flank.breaks[0])))

    @property
    def tip_radius(self) -> float:
        """Radius of the tip lands, mm."""
        return float(abs(self.flank.point(self.flank.breaks[-1])))

    @property
    def tip_thickness(self) -> float:
        """Thickness of the tooth along its tip circle, mm."""
        return 2 * self.tip_radius * float(np.angle(1j / complex(self.flank.point(self.flank.breaks[-1]))))

    @cached_property
    def outline(self) -> PolarArray:
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
        return max(0.0, np.pi / self.teeth - float(np.angle(1j / complex(flank.point(flank.breaks[0])))))

    def _toothed(self, side: list[AbstractCurve]) -> PolarArray:
        """All teeth from the right-hand side of one."""
        return toothed(side, self.teeth, self._half_land(side[0]))

    def _check_flank(self) -> None:
        """The flank must make a tooth: past the pitch circle, on its own side, within half a pitch."""
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


@record(checked=True, eq=False)
class FlankGear(AbstractFlankGear):
    """A gear about the origin, its tooth on +y symmetric, with lands about the axis at tips and bottoms.

    flank: its right-hand side from the bottom land out to the tip, in the half plane x >= 0 and within half a
    pitch of +y. pitch_radius, mm: of the circle that rolls on the mate's.
    Raises DesignError where the flank makes no tooth.
    """

    flank: AbstractCurve
    teeth: int = quantity("number of teeth", whole=True, at_least=2, at_most=10_000)
    pitch_radius: float = quantity("radius of the circle that rolls on the mate's", "mm", above=0, at_most=FARTHEST)

    def __post_init__(self) -> None:
        self._check_flank()

    @property
    def module(self) -> float:
        """Pitch diameter per tooth, mm."""
        return 2 * self.pitch_radius / self.teeth


@record(checked=True)
class StraightSidedGear(AbstractFlankGear):
    """A gear whose teeth have straight flanks, about the origin, a tooth on +y; heights in modules.

    Heights and thicknesses are those of the straight tooth itself: along its middle from the pitch circle, and
    square to that, so that at the pitch circle the tooth is half a pitch, pi / 2 modules, thick.
    Raises DesignError where the flanks meet below the tip, or neighbouring teeth run into each other.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=1000, example=40)
    module: Settled = module(example=3)
    flank_angle_deg: float = quantity(
        "angle between a flank and the middle of its tooth", "deg", default=25.0, at_least=0, at_most=60
    )
    addendum: float = quantity("height of the teeth above the pitch circle", "modules", default=1.0, above=0, at_most=5)
    dedendum: float = quantity("depth of the spaces below the pitch circle", "modules", default=1.2, above=0, at_most=5)
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        settle_module(self)
        if self.tip_thickness < 0:
            largest = np.pi / 4 / self._slope
            raise DesignError(
                "addendum",
                f"found {self.addendum:g}, but the flanks meet {largest:.4g} modules above the pitch circle",
                f"give at most {rounded_down(largest)}, or a smaller flank_angle_deg",
            )
        half = np.arctan2(self.root_thickness / 2, self.pitch_radius - self.dedendum * self.module)
        if half > np.pi / self.teeth:
            raise DesignError(
                "dedendum",
                f"found {self.dedendum:g}, at which neighbouring teeth run into each other",
                f"give at most {rounded_down(self._deepest())}, or a smaller flank_angle_deg",
            )
        if self.root_radius >= self.pitch_radius:
            problem = f"found {self.dedendum:g}, so little that the bottom lands lie outside the pitch circle"
            raise DesignError("dedendum", problem, f"give {self._shallowest()}")

    @property
    def _slope(self) -> float:
        return float(max(np.tan(np.radians(self.flank_angle_deg)), 1e-300))

    def _deepest(self) -> float:
        """The dedendum at which the bottom lands vanish, modules: where a flank meets the line between two teeth."""
        a = np.tan(np.pi / self.teeth)
        return float((self.teeth / 2 * a - np.pi / 4) / (self._slope + a) * (1 - 1e-12))

    def _shallowest(self) -> str:
        """The dedendum at which the straight flank passes the pitch circle once more, if it does, in words."""
        # The smaller d of (pi / 4 + slope d)^2 + (teeth / 2 - d)^2 = (teeth / 2)^2, in the form that keeps its digits.
        square, half = 1 + self._slope**2, self.teeth / 2 - np.pi / 4 * self._slope
        under = half**2 - square * (np.pi / 4) ** 2
        if half <= 0 or under < 0:
            return "more teeth, or a smaller flank_angle_deg"
        return f"at least {rounded_up((np.pi / 4) ** 2 / (half + np.sqrt(under)) * (1 + 1e-9))}"

    @property
    def pitch_radius(self) -> float:
        """Radius of the pitch circle, mm."""
        return self.module * self.teeth / 2

    @property
    def tip_thickness(self) -> float:
        """Thickness of the tooth at its tip, mm; negative where the flanks would have met below."""
        return self.module * (np.pi / 2 - 2 * self.addendum * self._slope)

    @property
    def root_thickness(self) -> float:
        """Thickness of the tooth at its root, mm."""
        return self.module * (np.pi / 2 + 2 * self.dedendum * self._slope)

    @cached_property
    def flank(self) -> Segment:
        """Right-hand flank of the tooth on +y, from the bottom land up to the tip."""
        r, m = self.pitch_radius, self.module
        root = complex(self.root_thickness / 2, r - self.dedendum * m)
        return Segment(root, complex(self.tip_thickness / 2, r + self.addendum * m))


@record(checked=True)
class PointToothGear(AbstractFlankGear):
    """A gear about the origin whose tooth on +y has a flank through given points and its mirror image.

    The flank is the spline through the points. Raises DesignError where it makes no tooth.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=1000, example=24)
    module: Settled = module(example=3)
    points: tuple[Annotated[complex, PointXY()], ...] = entry(
        "right-hand flank of the tooth on +y as [x, y] in mm, from the bottom land out to the tip",
        default=(),
        example=EXAMPLE,
    )
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        settle_module(self)
        self._check_points()
        try:
            self._check_flank()
        except DesignError as error:
            raise DesignError("points", error.problem, error.remedy, error.id) from None

    def _check_points(self) -> None:
        """Neither so many points nor so far off that no tooth could have them."""
        points = self.points
        if len(points) > MOST_POINTS:
            raise DesignError("points", f"found {len(points)}", f"give at most {MOST_POINTS}", "too-much-work")
        most = FARTHEST_OUT * self.pitch_radius
        if max((abs(z) for z in points), default=0.0) <= self.pitch_radius:
            raise DesignError(
                "points",
                f"none lies outside the pitch circle of {self.pitch_radius:.5g} mm",
                "give them from the bottom land out to the tip, across the pitch circle",
            )
        far = [k for k, z in enumerate(points) if abs(z) > most]
        if far:
            raise DesignError(
                "points",
                f"point {far[0] + 1} lies {abs(points[far[0]]):.5g} mm from the axis, with a pitch circle of "
                f"{self.pitch_radius:.5g} mm",
                f"give points within {most * (1 - 1e-5):.6g} mm of the axis",
            )

    @property
    def pitch_radius(self) -> float:
        """Radius of the pitch circle, mm."""
        return self.module * self.teeth / 2

    @cached_property
    def flank(self) -> Spline:
        """The spline through the points."""
        return Spline(np.array(self.points, dtype=complex))


@record(checked=True)
class LanternPinion(AbstractShaper):
    """Round pins on a circle about the origin, one of them on +y, held between two discs.

    Raises DesignError where neighbouring pins meet.
    """

    pins: int = quantity("number of pins", whole=True, at_least=4, at_most=1000, example=12)
    module: Settled = module("pin circle's diameter per pin", example=4)
    pin_diameter: Settled = quantity("diameter of the pins", "mm", default=None, above=0, at_most=1e5, example=5)
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        settle_module(self)
        if self.pin_diameter is None:
            raise DesignError("pin_diameter", "is missing", f"give it in mm, about {1.25 * self.module:.3g}")
        chord = 2 * self.pitch_radius * np.sin(np.pi / self.pins)
        if self.pin_diameter >= chord:
            raise DesignError(
                "pin_diameter",
                f"found {self.pin_diameter:g} mm, but neighbouring pins are {chord:.4g} mm apart",
                f"give less than {rounded_down(chord)} mm, about {chord / 2:.3g}",
            )

    @property
    def teeth(self) -> int:
        """Number of pins."""
        return self.pins

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle through the pins' centres, which rolls on the wheel's pitch circle, mm."""
        return self.module * self.pins / 2

    @property
    def pin(self) -> AbstractCurve:
        """The pin on +y, counterclockwise from its innermost point, as four quarters."""
        return self.cutter(0.0)

    @property
    def circles(self) -> tuple[Circle, ...]:
        """All pins."""
        places = 1j * self.pitch_radius * np.exp(2j * np.pi * np.arange(self.pins) / self.pins)
        return tuple(Circle(complex(z), self.pin_diameter / 2) for z in places)

    @property
    def most_backlash(self) -> float:
        """Backlash, mm, for which neighbouring pins of the wheel's cutter meet."""
        pin = float(np.arcsin(self.pin_diameter / 2 / self.pitch_radius))
        return 2 * self.pitch_radius * (np.pi / self.pins - pin)

    @checked
    def cutter(self, clearance: Length, backlash: Length = 0.0) -> AbstractCurve:
        """What cuts a wheel: the pin drawn out and made thicker, counterclockwise from its innermost point.

        Piece 0 is the quarter that drives, from the innermost point to the rightmost. clearance: room at the wheel's
        roots, mm, by which the pin is drawn out along the radius. backlash: play of the pair, mm along the pitch
        circle, for which the two halves are turned apart about the pinion's axis, each by
        backlash / (2 pitch_radius), and joined by arcs about it. The pin itself touches where its turned half does,
        when the pinion has turned less by that angle, counterclockwise, for the right-hand half, and more for the left.
        """
        if backlash >= self.most_backlash:
            raise DesignError(
                "backlash",
                f"found {backlash:.5g} mm, which leaves nothing of the wheel between two pins",
                f"give at most {self.most_backlash * (1 - 1e-5):.6g}",
            )
        centre, radius, turn = 1j * self.pitch_radius, self.pin_diameter / 2, 0.5 * backlash / self.pitch_radius
        right: list[AbstractCurve] = [Arc(centre, centre - 1j * radius, np.pi / 2)]
        if clearance > 0:
            right.append(Segment(centre + radius, centre + radius + 1j * clearance))
        right.append(Arc(centre + 1j * clearance, centre + 1j * clearance + radius, np.pi / 2))
        if backlash > 0:
            right = [Moved(curve, Pose(0j, np.exp(-1j * turn))) for curve in right]
        left = [Reversed(Mirrored(curve)) for curve in reversed(right)]
        if backlash == 0:
            return Path((*right, *left))
        outer, inner = right[-1].point(right[-1].breaks[-1]), left[-1].point(left[-1].breaks[-1])
        return Path((*right, Arc(0j, complex(outer), 2 * turn), *left, Arc(0j, complex(inner), -2 * turn)))
