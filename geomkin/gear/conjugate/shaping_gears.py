"""Gears of any tooth form, defined by one flank (a curve, points or a straight line) or by pins."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, ComplexPoint, Length, entry, inside, quantity, rounded_down, rounded_up, to_digits
from ...core.records import record
from ...core.units import PLURAL, bare_mm, mm, unit_name
from ...plane.curve import AbstractCurve, Mirrored, Moved, Reversed
from ...plane.flatten import direction, flatten
from ...plane.joined import Path, PolarArray, Spline
from ...plane.primitives import Arc, Circle, Segment
from ...plane.vec import Pose, spaced_directions
from ..contract import AbstractGear, AbstractShaper
from ..cutters import Settled, diametral_pitch, module, settle_module
from ..spur import toothed

# Largest radius of a flank, in pitch radii. Larger ones are no teeth, and could need any number of chords.
FARTHEST_OUT = 4
# Example of a flank: steep, and curved towards the tip.
EXAMPLE = (3.4 + 33.2j, 2.9 + 34.4j, 2.35 + 36j, 1.75 + 37.6j, 1.0 + 39j)
# Largest number of points of a flank. With more it takes minutes to generate a mate.
MOST_POINTS = 100


class AbstractFlankGear(AbstractGear, AbstractShaper):
    """Base class of gears with a symmetric tooth on +y, and with tip and bottom lands about the axis."""

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
        """Backlash at which adjacent teeth of the mate's cutter meet, mm: it equals the bottom lands."""
        return 2 * self.pitch_radius * self._half_land(self.flank)

    @checked
    def cutter(self, clearance: Length, backlash: Length = 0.0) -> AbstractCurve:
        """The cutter of a mate: the gear's tooth, longer and thicker. Piece 0 is its right-hand flank.

        Parameters
        ----------
        clearance : float
            Clearance at the mate's roots, mm along the radius; the flanks continue straight beyond the tip.
        backlash : float, optional
            Backlash of the pair, mm along the pitch circle; each flank is rotated about the axis, away from the tooth's
            middle, by backlash / (2 pitch_radius).

        Returns
        -------
        AbstractCurve
            One pitch of the cutter, mm.

        Raises
        ------
        DesignError
            If adjacent teeth of the cutter meet, or the extended flanks do.

        Notes
        -----
        The mate's flanks are rotated by the same angle, so both sides run at the same constant ratio. The gear's flank
        touches at the same point as the cutter's, at a rotation of the gear that differs by that angle: less,
        counterclockwise, for the right-hand flank, more for the left.
        """
        if clearance == 0 and backlash == 0:
            return self.outline.piece
        if backlash > self.most_backlash:
            problem = f"found {mm(backlash):.5g}, for which adjacent teeth of the mate's cutter meet"
            remedy = f"give at most {bare_mm(float(inside(self.most_backlash, 1, 6))):down6}"
            raise DesignError("backlash", problem, remedy, value=inside(self.most_backlash, 1, 6))
        flank = Moved(self.flank, Pose(0j, np.exp(-0.5j * backlash / self.pitch_radius)))
        if clearance == 0:
            return self._toothed([flank]).piece
        end = complex(flank.point(flank.breaks[-1]))
        along = complex(direction(flank, flank.breaks[-1:], after=False)[0])
        # Along the tangent to the larger circle: |end + s along| = tip + clearance.
        rise = (np.conj(along) * end).real
        grown = clearance * (2 * self.tip_radius + clearance)
        squared = rise**2 + grown
        s = float(grown / (rise + np.sqrt(squared))) if rise > 0 else np.inf
        if end.real + s * along.real < 0 or not np.isfinite(s):
            room = abs(end - along * end.real / along.real) - self.tip_radius if along.real < 0 else 0.0
            problem = f"found {mm(clearance):.5g}, but the flanks, extended beyond the tip, meet after {mm(room):.5g}"
            remedy = f"give at most {bare_mm(float(inside(room, 1, 6))):down6}"
            raise DesignError("clearance", problem, remedy, value=inside(room, 1, 6))
        return self._toothed([flank, Segment(end, end + s * along)]).piece

    def _half_land(self, flank: AbstractCurve) -> float:
        """Half the angle of the bottom land next to a flank, rad."""
        return max(0.0, np.pi / self.teeth - float(np.angle(1j / complex(flank.point(flank.breaks[0])))))

    def _toothed(self, side: list[AbstractCurve]) -> PolarArray:
        return toothed(side, self.teeth, self._half_land(side[0]))

    def _check_flank(self) -> None:
        """Raise DesignError if the flank does not cross the pitch circle, or leaves its half pitch."""
        self._check_reach()
        z = flatten(self.flank, 1e-4 * self.pitch_radius)
        angle = np.angle(1j / z)
        if not self.root_radius < self.pitch_radius < self.tip_radius:
            raise DesignError(
                "flank",
                f"it runs from {mm(self.root_radius, self.tip_radius, between=' to '):.5g} from the axis "
                f"and does not cross the pitch circle of {mm(self.pitch_radius):.5g}",
                "give it from the bottom land out to the tip, across the pitch circle",
            )
        # A flank may end in the middle of the tooth.
        if angle.min() < -1e-9:
            problem = "it crosses the middle of its tooth"
            raise DesignError("flank", problem, "give the side with x >= 0 and +y in the middle")
        if angle.max() > np.pi / self.teeth * (1 + 1e-9):
            problem = f"it is up to {np.degrees(angle.max()):.4g} deg from the middle of its tooth, beyond half a pitch"
            remedy = f"keep it within {180 / self.teeth:.4g} deg of +y: give thinner or fewer teeth"
            raise DesignError("flank", problem, remedy)

    def _check_reach(self) -> None:
        """Raise DesignError if the flank is closed, not finite, or extends far beyond the pitch circle."""
        b = self.flank.breaks
        z = self.flank.point(np.concatenate([b, 0.5 * (b[:-1] + b[1:])]))
        if self.flank.closed or not np.isfinite(z).all():
            raise DesignError("flank", "it is closed, or not finite", "give one open side of a tooth", "wrong-type")
        most = FARTHEST_OUT * self.pitch_radius
        if (far := float(np.abs(z).max())) > most:
            problem = f"it extends {mm(far):.5g} from the axis, but the pitch radius is {mm(self.pitch_radius):.5g}"
            remedy = f"keep it within {mm(float(inside(most, 1, 6))):down6} of the axis"
            raise DesignError("flank", problem, remedy, "out-of-range")


@record(checked=True, eq=False)
class FlankGear(AbstractFlankGear):
    """A gear about the origin whose symmetric tooth on +y has a given flank.

    Parameters
    ----------
    flank : AbstractCurve
        Right-hand flank of the tooth from the bottom land out to the tip, mm, with x >= 0 and within half a pitch of
        +y.
    teeth : int
        Number of teeth, 2 to 10,000.
    pitch_radius : float
        Radius of the pitch circle, mm, above 0.

    Raises
    ------
    DesignError
        If the flank does not define a tooth.
    """

    flank: AbstractCurve
    teeth: int = quantity("number of teeth", whole=True, at_least=2, at_most=10_000)
    pitch_radius: float = quantity("radius of the pitch circle", "mm", above=0, at_most=FARTHEST)

    def __post_init__(self) -> None:
        self._check_flank()

    @property
    def module(self) -> float:
        """Pitch diameter per tooth, mm."""
        return 2 * self.pitch_radius / self.teeth


@record(checked=True)
class StraightSidedGear(AbstractFlankGear):
    """A gear with straight-sided teeth about the origin, with a tooth on +y.

    Parameters
    ----------
    teeth : int
        Number of teeth, 4 to 1000.
    module : float
        Pitch diameter per tooth, mm, above 0. Give either `module` or `diametral_pitch`.
    flank_angle_deg : float, optional
        Angle between a flank and the middle of its tooth, 0 to 60 deg.
    addendum : float, optional
        Height of the teeth above the pitch circle, modules, above 0.
    dedendum : float, optional
        Depth of the spaces below the pitch circle, modules, above 0.
    diametral_pitch : float, optional
        Teeth per inch of pitch diameter, 1/in.

    Raises
    ------
    DesignError
        If the flanks meet below the tip, or adjacent teeth meet.

    Notes
    -----
    Heights are measured along the middle of the tooth, thicknesses perpendicular to it. At the pitch circle the tooth
    is pi / 2 modules, half a pitch, thick.
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
            problem = f"found {self.addendum:g}, but the flanks meet {largest:.4g} modules above the pitch circle"
            remedy = f"give at most {rounded_down(largest)}, or a smaller flank_angle_deg"
            raise DesignError("addendum", problem, remedy, value=rounded_down(largest))
        half = np.arctan2(self.root_thickness / 2, self.pitch_radius - self.dedendum * self.module)
        if half > np.pi / self.teeth:
            problem = f"found {self.dedendum:g}, for which adjacent teeth meet"
            remedy = f"give at most {rounded_down(self._deepest())}, or a smaller flank_angle_deg"
            raise DesignError("dedendum", problem, remedy, value=rounded_down(self._deepest()))
        if self.root_radius >= self.pitch_radius:
            problem = f"found {self.dedendum:g}, for which the bottom lands are outside the pitch circle"
            raise DesignError("dedendum", problem, f"give {self._shallowest()}")

    @property
    def _slope(self) -> float:
        return float(max(np.tan(np.radians(self.flank_angle_deg)), 1e-300))

    def _deepest(self) -> float:
        """The dedendum at which the bottom lands vanish, modules."""
        a = np.tan(np.pi / self.teeth)
        return float((self.teeth / 2 * a - np.pi / 4) / (self._slope + a) * (1 - 1e-12))

    def _shallowest(self) -> str:
        """A remedy: the dedendum at which the straight flank crosses the pitch circle again, if it does."""
        # The smaller solution d of (pi / 4 + slope d)^2 + (teeth / 2 - d)^2 = (teeth / 2)^2, without cancellation.
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
        """Thickness of the tooth at its tip, mm; negative if the flanks meet below the tip."""
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
    """A gear about the origin whose symmetric tooth on +y has a flank through given points, a spline.

    Parameters
    ----------
    teeth : int
        Number of teeth, 4 to 1000.
    module : float
        Pitch diameter per tooth, mm, above 0. Give either `module` or `diametral_pitch`.
    points : tuple of complex
        Right-hand flank from the bottom land out to the tip, mm; at most 100 points.
    diametral_pitch : float, optional
        Teeth per inch of pitch diameter, 1/in.

    Raises
    ------
    DesignError
        If the flank does not define a tooth.
    """

    teeth: int = quantity("number of teeth", whole=True, at_least=4, at_most=1000, example=24)
    module: Settled = module(example=3)
    points: tuple[ComplexPoint, ...] = entry(
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
            raise error.named("points") from None

    def _check_points(self) -> None:
        """Raise DesignError for too many points, or points that no tooth could have."""
        points = self.points
        if len(points) > MOST_POINTS:
            raise DesignError("points", f"found {len(points)}", f"give at most {MOST_POINTS}", "too-much-work")
        most = FARTHEST_OUT * self.pitch_radius
        if max((abs(z) for z in points), default=0.0) <= self.pitch_radius:
            remedy = "give them from the bottom land out to the tip, across the pitch circle"
            raise DesignError("points", f"none is outside the pitch circle of {mm(self.pitch_radius):.5g}", remedy)
        far = [k for k, z in enumerate(points) if abs(z) > most]
        if far:
            raise DesignError(
                "points",
                f"point {far[0] + 1} is {mm(abs(points[far[0]])):.5g} from the axis, but the pitch radius is "
                f"{mm(self.pitch_radius):.5g}",
                f"give points within {mm(float(inside(most, 1, 6))):down6} of the axis",
                "out-of-range",
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
    """A lantern pinion: round pins on a circle about the origin, one of them on +y, between two discs.

    Parameters
    ----------
    pins : int
        Number of pins, 4 to 1000.
    module : float
        Diameter of the pin circle per pin, mm, above 0. Give either `module` or `diametral_pitch`.
    pin_diameter : float
        Diameter of the pins, mm, above 0.
    diametral_pitch : float, optional
        Pins per inch of the pin circle's diameter, 1/in.

    Raises
    ------
    DesignError
        If adjacent pins meet.
    """

    pins: int = quantity("number of pins", whole=True, at_least=4, at_most=1000, example=12)
    module: Settled = module("pin circle's diameter per pin", example=4)
    pin_diameter: Settled = quantity("diameter of the pins", "mm", default=None, above=0, at_most=1e5, example=5)
    diametral_pitch: float | None = diametral_pitch()

    def __post_init__(self) -> None:
        settle_module(self)
        if self.pin_diameter is None:
            remedy = f"give it in {unit_name(PLURAL)}, about {bare_mm(1.25 * self.module):.3g}"
            raise DesignError("pin_diameter", "is missing", remedy, "missing-key", to_digits(1.25 * self.module, 3))
        chord = 2 * self.pitch_radius * np.sin(np.pi / self.pins)
        if self.pin_diameter >= chord:
            problem = f"found {mm(self.pin_diameter):g}, but adjacent pins are {mm(chord):.4g} apart"
            remedy = f"give less than {mm(chord):down}, about {bare_mm(chord / 2):.3g}"
            raise DesignError("pin_diameter", problem, remedy, value=to_digits(chord / 2, 3))

    @property
    def teeth(self) -> int:
        """Number of pins."""
        return self.pins

    @property
    def pitch_radius(self) -> float:
        """Radius of the pitch circle, which passes through the pins' centres, mm."""
        return self.module * self.pins / 2

    @property
    def pin(self) -> AbstractCurve:
        """The pin on +y, counterclockwise from its innermost point, as four quarters."""
        return self.cutter(0.0)

    @property
    def circles(self) -> tuple[Circle, ...]:
        """The circles of all pins, mm."""
        places = 1j * self.pitch_radius * spaced_directions(self.pins)
        return tuple(Circle(complex(z), self.pin_diameter / 2) for z in places)

    @property
    def most_backlash(self) -> float:
        """Backlash at which adjacent pins of the wheel's cutter meet, mm."""
        pin = float(np.arcsin(self.pin_diameter / 2 / self.pitch_radius))
        return 2 * self.pitch_radius * (np.pi / self.pins - pin)

    @checked
    def cutter(self, clearance: Length, backlash: Length = 0.0) -> AbstractCurve:
        """The cutter of a wheel: the pin, longer and thicker, counterclockwise from its innermost point.

        Parameters
        ----------
        clearance : float
            Clearance at the wheel's roots, mm, by which the pin is longer along the radius.
        backlash : float, optional
            Backlash of the pair, mm along the pitch circle. The two halves of the pin are rotated apart about the
            pinion's axis, each by backlash / (2 pitch_radius), and joined by arcs.

        Returns
        -------
        AbstractCurve
            Closed, mm. Piece 0 is the driving quarter, from the innermost point to the rightmost.

        Raises
        ------
        DesignError
            If adjacent pins of the cutter meet.

        Notes
        -----
        The pin touches at the same point as its rotated half, at a rotation of the pinion that differs by that angle:
        less, counterclockwise, for the right-hand half, more for the left.
        """
        if backlash >= self.most_backlash:
            problem = f"found {mm(backlash):.5g}, for which no teeth of the wheel remain between two pins"
            remedy = f"give at most {bare_mm(float(inside(self.most_backlash, 1, 6))):down6}"
            raise DesignError("backlash", problem, remedy, value=inside(self.most_backlash, 1, 6))
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
