"""A cycloidal drive: sizes, profile of its disc, undercut, and forces of the pins."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..core.errors import DesignError
from ..core.fields import FARTHEST, inside, quantity
from ..core.fields import entry as field_entry
from ..core.records import record
from ..core.units import mm
from ..plane.curve import AbstractCurve
from ..plane.joined import PolarArray
from ..plane.vec import Complex, Real, spaced_directions

# Numbers of pins: with more no size that fits a machine has pins thick enough to cut.
FEWEST_PINS, MOST_PINS, MOST_OUTPUT_PINS = 4, 120, 24


@record(eq=False)
class LobeCurve(AbstractCurve):
    """One lobe of the disc, from one root to the next: the parallel of an epitrochoid, exact.

    circle: radius of the circle of the pins, mm. pins: their number. eccentricity, inset: eccentricity, and distance of
    the parallel, the radius of the pins with their clearance, mm.
    """

    circle: float
    pins: int
    eccentricity: float
    inset: float

    def _trochoid(self, t: Real) -> tuple[Complex, Complex, Complex]:
        """Point of the epitrochoid, and its first two derivatives; t = 0 is nearest to the centre."""
        n, e = self.pins, self.eccentricity
        own, fast = self.circle * np.exp(1j * t), e * np.exp(1j * n * t)
        return own - fast, 1j * (own - n * fast), -own + n * n * fast

    def point(self, t: ArrayLike) -> Complex:
        z, first, _ = self._trochoid(np.asarray(t, dtype=float))
        # The outward normal is to the right of a counterclockwise curve.
        return np.asarray(z + 1j * self.inset * first / np.abs(first))

    def velocity(self, t: ArrayLike) -> Complex:
        _, first, second = self._trochoid(np.asarray(t, dtype=float))
        speed = np.abs(first)
        turning = (first.conjugate() * second).imag / speed**2
        return np.asarray(first * (1 - self.inset * turning / speed))

    def curvature(self, t: ArrayLike) -> Real:
        _, first, second = self._trochoid(np.asarray(t, dtype=float))
        speed = np.abs(first)
        own = (first.conjugate() * second).imag / speed**3
        return np.asarray(own / np.abs(1 - self.inset * own))

    @property
    def breaks(self) -> Real:
        return np.array([0.0, 2 * np.pi / (self.pins - 1)])

    closed = False


@record(checked=True)
class CycloidalDrive:
    """A cycloidal drive whose ring of pins is fixed; all lengths in mm.

    Parameters
    ----------
    pins : int
        Number of pins of the ring; the disc has one lobe fewer.
    circle : float
        Diameter of the circle of the pins' axes.
    pin : float
        Diameter of the pins.
    eccentricity : float
        Distance of the axes of ring and disc.
    clearance : float, optional
        Gap between the disc and the pins all round.
    discs : {1, 2}, optional
        Number of discs; two lie opposite each other and balance.
    eccentric : float, optional
        Diameter of the round eccentric on which the disc turns.
    output_pins : int, optional
        Number of pins that the disc turns.
    output_circle : float, optional
        Diameter of the circle of their axes.
    output_pin : float, optional
        Their diameter.

    Examples
    --------
    >>> drive = gk.cycloidal.CycloidalDrive(pins=11, circle=100, pin=8, eccentricity=3)
    >>> drive.ratio, round(drive.least_radius, 3)
    (-10, 14.848)
    """

    pins: int = quantity(
        "number of pins of the ring; the disc has one lobe fewer, which is the ratio",
        whole=True, at_least=FEWEST_PINS, at_most=MOST_PINS, example=11,
    )  # fmt: skip
    circle: float = quantity("diameter of the circle of the pins' axes", "mm", above=0, at_most=FARTHEST, example=100)
    pin: float = quantity("diameter of the pins", "mm", above=0, at_most=FARTHEST, example=8)
    eccentricity: float = quantity("distance of the axes of ring and disc", "mm", above=0, at_most=FARTHEST, example=3)
    clearance: float = quantity(
        "gap between the disc and the pins all round", "mm", default=0.1, at_least=0, at_most=FARTHEST, printed=0.5
    )
    discs: Literal[1, 2] = field_entry("number of discs; two lie opposite each other and balance", default=1)
    eccentric: float = quantity(
        "diameter of the round eccentric on which the disc turns", "mm", default=20.0, above=0, at_most=FARTHEST
    )
    output_pins: int = quantity(
        "number of pins that the disc turns", whole=True, default=6, at_least=3, at_most=MOST_OUTPUT_PINS
    )
    output_circle: float = quantity(
        "diameter of the circle of the output pins' axes", "mm", default=54.0, above=0, at_most=FARTHEST
    )
    output_pin: float = quantity("diameter of the output pins", "mm", default=6.0, above=0, at_most=FARTHEST)

    def __post_init__(self) -> None:
        radius, most = self.circle / 2, self.circle / 2 / self.pins
        if self.eccentricity >= most:
            problem = f"found {mm(self.eccentricity):g}, with which the epitrochoid of {self.pins} pins has loops"
            remedy = f"give less than {mm(most):down}, or a larger circle"
            raise DesignError("eccentricity", problem, remedy, "conflict", inside(most, 1))
        half_pitch = radius * float(np.sin(np.pi / self.pins))
        widest = 2 * min(self.least_radius, half_pitch) - 2 * self.clearance
        if self.pin >= widest:
            is_undercut = self.least_radius < half_pitch
            what = "the profile of the disc is undercut" if is_undercut else "the pins leave no room between them"
            problem = f"found {mm(self.pin):g}, with which {what}"
            smaller = f"give less than {mm(widest):down}, or a" if widest > 0 else "give a"
            remedy = f"{smaller} smaller eccentricity or a larger circle"
            raise DesignError("pin", problem, remedy, "conflict", inside(widest, 1) if widest > 0 else None)
        hole, middle = self.output_hole, self.output_circle / 2
        least, most = self.eccentric + hole, 2 * self.root_radius - hole
        between = self.output_circle * float(np.sin(np.pi / self.output_pins))
        if not least < self.output_circle < most:
            problem = (
                f"found {mm(self.output_circle):g}, with which holes of {mm(hole):g} cut the edge or the eccentric"
            )
            limits = f"give more than {mm(least):up} and less than {mm(most):down}"
            remedy = limits if least < most else "give a smaller eccentric or output_pin, or a larger circle"
            raise DesignError(
                "output_circle", problem, remedy, "conflict", (least + most) / 2 if least < most else None
            )
        if between <= hole:
            fitting = int(np.pi / np.arcsin(hole / (2 * middle)))
            problem = f"found {self.output_pins}, whose holes of {mm(hole):g} cut into each other"
            raise DesignError("output_pins", problem, f"give at most {fitting}, or thinner ones", "conflict")
        if self.eccentric <= 2 * self.eccentricity:
            problem = f"found {mm(self.eccentric):g}, which leaves no room for its shaft"
            remedy = f"give more than {mm(2 * self.eccentricity):up}"
            raise DesignError("eccentric", problem, remedy, "conflict")

    @property
    def lobes(self) -> int:
        """Number of lobes of the disc."""
        return self.pins - 1

    @property
    def ratio(self) -> int:
        """Rotations of the input for one of the output; below 0, as it turns the other way."""
        return -self.lobes

    @property
    def shortening(self) -> float:
        """Eccentricity over that with which the epitrochoid has cusps; makers use 0.5 to 0.8."""
        return 2 * self.eccentricity * self.pins / self.circle

    @property
    def least_radius(self) -> float:
        """Least radius of curvature of the epitrochoid where the pins are outside it, mm."""
        k, n, radius = self.shortening, self.pins, self.circle / 2
        if k > (n - 2) / (2 * n - 1):
            return float(radius * np.sqrt(27 * (1 - k * k) * (n - 1) / (n + 1) ** 3))
        return radius * (1 + k) ** 2 / (1 + n * k)

    @property
    def root_radius(self) -> float:
        """Radius of the disc in its roots, mm."""
        return self.circle / 2 - self.eccentricity - self.pin / 2 - self.clearance

    @property
    def output_hole(self) -> float:
        """Diameter of the disc's holes for the output pins, mm: wider by twice the eccentricity."""
        return self.output_pin + 2 * (self.eccentricity + self.clearance)

    @property
    def outline(self) -> AbstractCurve:
        """Outline of the disc about its own axis; a root is on +x."""
        inset = self.pin / 2 + self.clearance
        return PolarArray(LobeCurve(self.circle / 2, self.pins, self.eccentricity, inset), self.lobes)

    @property
    def second_turn(self) -> tuple[float, bool]:
        """Rotation of the second disc against the first one, rad, and whether it is the same part.

        Its lobes are half a pitch off, so that it meets the same pins with its axis opposite. It is the same part if a
        rotation by whole pitches of the holes does this.
        """
        for k in range(self.output_pins):
            if 2 * k * self.lobes % (2 * self.output_pins) == self.output_pins:
                return 2 * np.pi * k / self.output_pins, True
        return np.pi / self.lobes, False

    def disc_pose(self, turn: ArrayLike, which: int) -> tuple[Complex, Complex]:
        """Axis and direction of a disc, 0 or 1, at rotations of the input, rad; its outline has a root on +x."""
        side, turn = 1 - 2 * which, np.asarray(turn, dtype=float)
        own = which * self.second_turn[0] - turn / self.lobes
        axis, direction = side * self.eccentricity * np.exp(1j * turn), np.exp(1j * own)
        return np.asarray(axis), np.asarray(direction)

    def pin_forces(self, torque: float, turn: ArrayLike) -> tuple[Real, Real]:
        """Force on each pin of the ring, N, (..., pins), and on the eccentric, N, of one disc under a torque, N mm.

        The disc is rigid and all pins are equal springs without clearance; those that the disc leaves carry nothing.
        """
        turn = np.asarray(turn, dtype=float)[..., None]
        axis = self.eccentricity * np.exp(1j * turn)
        pins = self.circle / 2 * spaced_directions(self.pins)
        # All normals pass through the rolling point of the pitch circles.
        normal = pins - self.pins * axis
        normal = normal / np.abs(normal)
        arm = ((pins - axis).conjugate() * normal).imag
        loaded = np.maximum(arm, 0.0)
        force = torque * loaded / (loaded**2).sum(axis=-1, keepdims=True)
        return force, np.abs((force * normal).sum(axis=-1))

    def contact_curvature(self, turn: ArrayLike) -> Real:
        """Sum of the curvatures of the disc and each pin where they meet, 1/mm, (..., pins)."""
        pins = 2 * np.pi * np.arange(self.pins) / self.pins
        at = pins + np.asarray(turn, dtype=float)[..., None] / self.lobes
        return LobeCurve(self.circle / 2, self.pins, self.eccentricity, self.pin / 2).curvature(at) + 2 / self.pin
