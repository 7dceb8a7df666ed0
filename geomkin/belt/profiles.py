"""Profiles of timing pulleys and sprockets: the gap between two teeth, from published sizes, and the whole outline."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import ClassVar

import numpy as np

from ..core.arguments import PositiveInt, checked
from ..core.errors import DesignError, shown
from ..core.records import record
from ..plane.primitives import Polyline
from ..plane.vec import spaced_directions

# Half of a gap, from its middle at the bottom to the tip circle: points with the axis at 0 and the middle of the gap on
# +y, x not below 0, and the centre of the arc that leads to each point; None for a straight line.
HalfGap = list[tuple[complex, complex | None]]
# Largest number of teeth, and of a pulley of series T with grooves of the form SE.
MOST_TEETH, SMALL = 500, 20


@record
class AbstractProfile(ABC):
    """Base class of the published sizes of a belt or chain and of its wheels; all lengths in mm.

    Parameters
    ----------
    name : str
        Name by which the trade knows it.
    pitch : float
        Distance of two teeth of the belt, or of two rollers of the chain, on the pitch line.
    back, front : float
        Extent of belt or chain beyond its pitch line, away from a wheel inside it and towards it.
    """

    # Fewest teeth of a wheel.
    fewest_teeth: ClassVar[int]

    name: str
    pitch: float
    back: float
    front: float

    @abstractmethod
    def pitch_radius(self, teeth: int) -> float:
        """Radius of the pitch line on a wheel, mm."""

    @abstractmethod
    def tip_radius(self, teeth: int) -> float:
        """Radius of the tips of a wheel, mm."""

    @abstractmethod
    def depth(self, teeth: int) -> float:
        """Depth of a gap below the tips, mm."""

    @abstractmethod
    def half_gap(self, teeth: int) -> HalfGap:
        """Half of a gap of a wheel."""

    def land(self, teeth: int) -> float:
        """Width of the tip of a tooth, mm along the tip circle; 0 or less if two gaps meet."""
        end = self.half_gap(teeth)[-1][0]
        return float(abs(end) * (2 * np.pi / teeth - 2 * np.arctan2(end.real, end.imag)))


@record
class BeltProfile(AbstractProfile):
    """Sizes of a timing belt and its pulleys, mm.

    line: distance of the pitch line from the tips of a pulley. gap: depth of a groove. tip: radius of the tips' edges.
    """

    # The smallest pulleys in makers' tables of XL and T5; smaller ones bend the belt too far.
    fewest_teeth = 10

    line: float
    gap: float
    tip: float

    def pitch_radius(self, teeth: int) -> float:
        return teeth * self.pitch / (2 * np.pi)

    def tip_radius(self, teeth: int) -> float:
        return self.pitch_radius(teeth) - self.line

    def depth(self, teeth: int) -> float:
        return self.gap


@record
class RoundBeltProfile(BeltProfile):
    """A groove with a round bottom: its flanks are arcs of a radius, or straight if it is infinite; all in mm.

    bottom: radius of the bottom. flank: radius of the flanks, tangent to the bottom. offset: distance of the centre of
    a flank from the middle, beyond it; of straight flanks, half of the width between them at the tips.
    """

    bottom: float
    flank: float
    offset: float

    def half_gap(self, teeth: int) -> HalfGap:
        outer = self.tip_radius(teeth)
        centre, low = 1j * (outer - self.gap + self.bottom), 1j * (outer - self.gap)
        if np.isfinite(self.flank):
            inner = self.flank - self.bottom
            middle = centre - self.offset + 1j * np.sqrt(inner**2 - self.offset**2)
            joint = centre + self.bottom * (centre - middle) / inner
            edge = _touching(middle, self.flank + self.tip, outer - self.tip)
            return [
                (low, None),
                (joint, centre),
                (middle + self.flank * (edge - middle) / abs(edge - middle), middle),
                (edge * outer / abs(edge), edge),
            ]
        # The tangent from the edge of the groove at the height of the tips to the circle of its bottom.
        top = complex(self.offset, outer)
        away = top - centre
        turn = np.arccos(self.bottom / abs(away))
        joint = centre + self.bottom * away / abs(away) * np.exp(-1j * turn)
        return [(low, None), (joint, centre), *_wall(joint, top, outer, self.tip)]


@record
class StraightBeltProfile(BeltProfile):
    """A trapezoidal groove; all in mm.

    width: of the bottom. angle_deg: of each flank to the middle. bottom: radius of the corners of the bottom. small:
    depth and width of the grooves of pulleys with up to `SMALL` teeth; those of the others if 0.
    """

    width: float
    angle_deg: float
    bottom: float
    small: tuple[float, float] = (0.0, 0.0)

    def sizes(self, teeth: int) -> tuple[float, float]:
        """Depth of a groove and width of its bottom, mm."""
        return self.small if self.small[0] and teeth <= SMALL else (self.gap, self.width)

    def depth(self, teeth: int) -> float:
        return self.sizes(teeth)[0]

    def half_gap(self, teeth: int) -> HalfGap:
        outer, angle = self.tip_radius(teeth), np.radians(self.angle_deg)
        depth, width = self.sizes(teeth)
        corner = complex(width / 2, outer - depth)
        along = complex(np.sin(angle), np.cos(angle))
        # A fillet turns from the bottom into the flank by 90 deg less the angle of the flank.
        back = self.bottom * np.tan((np.pi / 2 - angle) / 2)
        start = corner - back
        half: HalfGap = [(1j * corner.imag, None), (start, None)]
        if back:
            half.append((corner + back * along, start + 1j * self.bottom))
        return [*half, *_wall(half[-1][0], half[-1][0] + along, outer, self.tip)]


def _touching(middle: complex, apart: float, radius: float, side: int = -1) -> complex:
    """The point at a distance from `middle`, mm, and at a radius about the axis; side: 1 if ahead counterclockwise."""
    distance = abs(middle)
    along = (distance**2 + radius**2 - apart**2) / (2 * distance)
    return complex(middle / distance * (along + side * 1j * np.sqrt(radius**2 - along**2)))


def _wall(start: complex, through: complex, outer: float, tip: float) -> Iterator[tuple[complex, complex | None]]:
    """A straight flank from a point through another one, and the round edge of the tip, to the tip circle."""
    along = (through - start) / abs(through - start)
    # The centre of the edge is in the tooth, to the right of the flank.
    shifted = start - 1j * tip * along
    foot = (shifted * np.conj(along)).real
    height = -foot + np.sqrt(foot**2 - abs(shifted) ** 2 + (outer - tip) ** 2)
    centre = complex(shifted + height * along)
    yield centre + 1j * tip * along, None
    if tip:
        yield centre * outer / abs(centre), centre


@record
class ChainProfile(AbstractProfile):
    """Sizes of a roller chain and its sprockets, mm.

    roller: diameter of the rollers. inner_width: least width between the inner plates (ISO 606).
    """

    # With fewer, the largest tips of the standard touch a roller as it swings off.
    fewest_teeth = 9

    roller: float
    inner_width: float

    def pitch_radius(self, teeth: int) -> float:
        return float(self.pitch / 2 / np.sin(np.pi / teeth))

    def tip_radius(self, teeth: int) -> float:
        """The middle of the range of ISO 606."""
        least, most = self.pitch * (1 - 1.6 / teeth), 1.25 * self.pitch
        return self.pitch_radius(teeth) + ((least + most) / 2 - self.roller) / 2

    def depth(self, teeth: int) -> float:
        return self.tip_radius(teeth) - self.pitch_radius(teeth) + self.seat_radius

    @property
    def seat_radius(self) -> float:
        """Radius of the roller's seat, the middle of the range of ISO 606, mm."""
        return 0.505 * self.roller + 0.0345 * float(np.cbrt(self.roller))

    def half_gap(self, teeth: int) -> HalfGap:
        """The seat of a roller and a flank tangent to it, with the middle of each range of ISO 606."""
        seat, centre = self.seat_radius, 1j * self.pitch_radius(teeth)
        flank = self.roller * (0.12 * (teeth + 2) + 0.008 * (teeth**2 + 180)) / 2
        half = np.radians(130 - 90 / teeth) / 2
        towards = complex(np.sin(half), -np.cos(half))
        middle = centre + (seat + flank) * towards
        # The crossing of flank and tip circle that is nearer to the gap.
        end = _touching(middle, flank, self.tip_radius(teeth), 1)
        return [(centre - 1j * seat, None), (centre + seat * towards, centre), (end, middle)]


# Sources: grooves GT2 and HTD from makers' drawings of tools, T, MXL and XL from the tables of two makers each; belts
# from SDP/SI, handbook D265, figure 19, HTD 8M as makers print it. The pitch line is half of the difference of pitch
# and outer diameter above the tips. GT3 belts run in grooves of GT2. Straight flanks of HTD are tangents of the bottom.
# Name, pitch, (thickness, tooth height) of the belt, twice the pitch line's distance, depth, tip radius.
_ROUND = (
    ("GT2-2M", 2.0, (1.52, 0.76), 0.508, 0.75, 0.15, 0.555, 1.0, 0.40),
    ("GT2-3M", 3.0, (2.41, 1.14), 0.762, 1.14, 0.25, 0.85, 1.52, 0.61),
    ("HTD-3M", 3.0, (2.41, 1.22), 0.762, 1.28, 0.30, 0.91, np.inf, 1.90 / 2),
    ("HTD-5M", 5.0, (3.81, 2.08), 1.144, 2.16, 0.48, 1.56, np.inf, 3.25 / 2),
    ("HTD-8M", 8.0, (6.0, 3.4), 1.372, 3.54, 0.80, 2.57, np.inf, 5.35 / 2),
)


def _t(width: float, depth: float) -> float:
    """Width of the bottom of a groove of series T, whose width is stated at the tips, mm."""
    return width - 2 * depth * float(np.tan(np.radians(25)))


_STRAIGHT = (
    ("T2.5", 2.5, (1.3, 0.7), 0.53, 1.0, 0.0, _t(1.83, 1.0), 25.0, 0.0, (0.75, _t(1.75, 0.75))),
    ("T5", 5.0, (2.2, 1.2), 0.85, 1.95, 0.0, _t(3.32, 1.95), 25.0, 0.0, (1.25, _t(2.96, 1.25))),
    ("T10", 10.0, (4.5, 2.5), 1.85, 3.4, 0.0, _t(6.57, 3.4), 25.0, 0.0, (2.6, _t(6.02, 2.6))),
    ("MXL", 2.032, (1.14, 0.51), 0.508, 0.69, 0.13, 0.84, 20.0, 0.35),
    ("XL", 5.08, (2.3, 1.27), 0.508, 1.65, 0.64, 1.32, 25.0, 0.41),
)
# Pitch and roller by ISO 606 and ASME B29.1, least width between the inner plates by ISO 606.
_CHAINS = (
    ("04B", 6.0, 4.0, 2.8), ("05B", 8.0, 5.0, 3.0), ("06B", 9.525, 6.35, 5.72), ("08B", 12.7, 8.51, 7.75),
    ("25", 6.35, 3.30, 3.10), ("35", 9.525, 5.08, 4.68), ("40", 12.7, 7.92, 7.85),
)  # fmt: skip


def _belts() -> Iterator[BeltProfile]:
    for kind, rows in ((RoundBeltProfile, _ROUND), (StraightBeltProfile, _STRAIGHT)):
        for name, pitch, (thickness, tooth), twice, *sizes in rows:
            yield kind(name, pitch, thickness - tooth - twice / 2, tooth + twice / 2, twice / 2, *sizes)


BELTS = {profile.name: profile for profile in _belts()}
# Plates of a chain are about as high as 0.95 pitches; chosen here, for the distance from what the chain passes.
CHAINS = {name: ChainProfile(name, p, 0.475 * p, 0.475 * p, roller, width) for name, p, roller, width in _CHAINS}
# All profiles by name.
PROFILES: dict[str, AbstractProfile] = {**BELTS, **CHAINS}


@checked
def toothed_outline(profile: str, teeth: PositiveInt) -> Polyline:
    """The outline of a timing pulley or sprocket about the origin, with the middle of a gap on +y.

    Parameters
    ----------
    profile : str
        A name in `PROFILES`, such as "GT2-2M" or "06B".
    teeth : int
        Number of teeth.

    Returns
    -------
    Polyline
        Exact, of arcs and straight lines.

    Raises
    ------
    DesignError
        If the profile is unknown, or there are too few or too many teeth.

    Examples
    --------
    >>> outline = gk.belt.toothed_outline("GT2-2M", 20)
    >>> round(2 * float(abs(outline.vertices).max()), 3)
    12.224
    """
    if profile not in PROFILES:
        raise DesignError("profile", f"found {shown(profile)}", f"give {' or '.join(PROFILES)}", "out-of-range")
    sizes = PROFILES[profile]
    check_teeth("teeth", sizes, teeth)
    points, centres = zip(*sizes.half_gap(teeth))
    # One gap from its right edge through the bottom to the left one, then the tip; all counterclockwise.
    right, left = points[:0:-1], [-np.conj(z) for z in points[1:]]
    bulges = [_bulge(*step) for step in zip(points[:-1], points[1:], centres[1:])]
    tip = np.tan(sizes.land(teeth) / abs(points[-1]) / 4)
    bottom = np.tan(2 * np.arctan(bulges[0]))
    run = [*(-b for b in bulges[:0:-1]), -bottom, *(-b for b in bulges[1:])]
    gap = np.array([*right, *left])
    turns = spaced_directions(teeth)
    return Polyline((turns[:, None] * gap).ravel(), np.tile([*run, tip], teeth))


def _bulge(start: complex, end: complex, centre: complex | None) -> float:
    """tan(sweep / 4) of an arc, 0 for a straight line."""
    return 0.0 if centre is None else float(np.tan(np.angle((end - centre) / (start - centre)) / 4))


def check_teeth(key: str, profile: AbstractProfile, teeth: int) -> None:
    """DesignError with the key for a number of teeth that is too small for a profile, or too large."""
    if teeth < (least := profile.fewest_teeth):
        problem = f"found {teeth}, fewer than a wheel of {profile.name} may have"
        raise DesignError(key, problem, f"give at least {least}", "out-of-range", least)
    if teeth > MOST_TEETH:
        raise DesignError(key, f"found {teeth}", f"give at most {MOST_TEETH}", "out-of-range", MOST_TEETH)
