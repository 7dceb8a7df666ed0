"""A sun, planets and a ring."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal

import numpy as np

from ..core.arguments import NUMBER, FloatOrNan, checked, refused
from ..core.errors import DesignError
from ..core.fields import entry, last_fit, moving_picture, quantity
from ..core.records import record
from ..core.units import mm
from ..plane.vec import Pose, Real
from .cutters import HelixAngle
from .pair import GearPair
from .ring import RingGear
from .spur import SpurGear
from .train import loss_factor


@record
class SunMesh(GearPair):
    """Sun and planet in mesh."""

    names = "sun", "planet"

    second: SpurGear = entry("the planet")


@record
class RingMesh(GearPair):
    """Planet and ring in mesh."""

    names = "planet", "ring"

    second: RingGear = entry("the ring")


# The members that turn about the common axis.
Member = Literal["sun", "carrier", "ring"]
MEMBERS: tuple[Member, ...] = ("sun", "carrier", "ring")


@record(checked=True)
class PlanetarySet:
    """A planetary gear set: a sun about the origin, equal planets evenly spaced round it, and a ring.

    Parameters
    ----------
    sun : SpurGear
        The gear in the middle.
    planet : SpurGear
        Each of the planets.
    ring : RingGear
        The ring round the planets.
    planets : int, optional
        Number of planets, 1 to 100.

    Raises
    ------
    DesignError
        If the centre distances of sun and planet and of planet and ring differ, or if this number of planets cannot be
        assembled.

    Notes
    -----
    Speeds by Willis's equation (Müller, Epicyclic Drive Trains).

    Examples
    --------
    >>> gears = gk.gear.PlanetarySet(gk.SpurGear(24, 2), gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8))
    >>> gears.ratios["sun to carrier"]
    3.5
    """

    sun: SpurGear = entry("the gear in the middle", example=SpurGear(24, 2))
    planet: SpurGear = entry("each of the planets", example=SpurGear(18, 2))
    ring: RingGear = entry("the ring round the planets", example=RingGear(60, 2, addendum=0.8))
    planets: int = quantity("number of planets", whole=True, default=3, at_least=1, at_most=100)

    _repr_html_ = moving_picture

    def __post_init__(self) -> None:
        inner, outer = self.inner.centre_distance, RingMesh(self.planet, self.ring).tight_distance
        if abs(inner - outer) > 1e-6 * self.sun.module:
            raise DesignError(
                "ring.profile_shift",
                f"found {self.ring.profile_shift:g}, but the planets mesh with the sun {mm(inner):.6g} "
                f"and with the ring {mm(outer):.6g} from the axis",
                self._fitting_ring(),
            )
        self.outer  # noqa: B018  # raises if the planets jam in the ring
        if not self._can_assemble(self.planets):
            raise DesignError("planets", *self._planets_error())

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> PlanetarySet:
        """The transverse section of helical teeth whose normal section has these sizes.

        Parameters
        ----------
        helix_angle_deg : float
            Helix angle of the teeth at the pitch circle, 0 to 45 deg.

        Returns
        -------
        PlanetarySet
            The transverse sections of all gears.
        """
        sun, planet = (gear.transverse(helix_angle_deg) for gear in (self.sun, self.planet))
        return PlanetarySet(sun, planet, self.ring.transverse(helix_angle_deg), self.planets)

    def with_full_clearance(self) -> PlanetarySet:
        """The set with tips shortened in both meshes, as by `GearPair.with_full_clearance`.

        Returns
        -------
        PlanetarySet
            The same distances and speeds.
        """
        inner = self.inner.with_full_clearance()
        outer = RingMesh(inner.second, self.ring, inner.centre_distance).with_full_clearance()
        return replace(self, sun=inner.first, planet=outer.first, ring=outer.second)

    @cached_property
    def inner(self) -> SunMesh:
        """Sun and planet in mesh."""
        return SunMesh(self.sun, self.planet)

    @cached_property
    def outer(self) -> RingMesh:
        """Planet and ring in mesh, at the centre distance of sun and planet."""
        return RingMesh(self.planet, self.ring, self.inner.centre_distance)

    @property
    def planet_gap(self) -> float:
        """Gap between the tips of adjacent planets, mm; inf for one planet."""
        return self._gap(self.planets)

    @property
    def ratios(self) -> dict[str, float]:
        """Rotations of the input for one of the output, by "input to output"; the third member is fixed."""
        sun, ring = self.sun.teeth, self.ring.teeth
        return {
            "sun to carrier": 1 + ring / sun,
            "carrier to sun": 1 / (1 + ring / sun),
            "ring to carrier": 1 + sun / ring,
            "carrier to ring": 1 / (1 + sun / ring),
            "sun to ring": -ring / sun,
            "ring to sun": -sun / ring,
        }

    def speeds(self, **given: float) -> dict[str, float]:
        """Speeds of all members relative to the frame, from two of them.

        Parameters
        ----------
        **given : float
            Two of `sun`, `ring` and `carrier`, in any unit.

        Returns
        -------
        dict
            Speeds of `sun`, `ring`, `carrier` and `planet`, in the same unit.

        Raises
        ------
        DesignError
            If other members are given, or a speed is not a number.

        Notes
        -----
        Willis's equation: sun z_s + ring z_r = carrier (z_s + z_r).
        """
        if len(given) != 2 or not set(given) <= set(MEMBERS):
            raise DesignError("given", f"found {', '.join(given)}", "give two of sun, ring and carrier", "conflict")
        for name, speed in given.items():
            if not NUMBER.fits(speed):
                raise refused(name, speed, NUMBER)
        return {name: float(speed) for name, speed in self._willis(given).items()}

    @checked
    def turns(self, driver: Member = "sun", fixed: Member = "ring") -> dict[str, Fraction]:
        """Rotations of all members for one of the driver, exact.

        Parameters
        ----------
        driver, fixed : {"sun", "carrier", "ring"}, optional
            The member that drives, and another one that is held.

        Returns
        -------
        dict
            Rotations of `sun`, `ring`, `carrier` and `planet` relative to the frame.

        Raises
        ------
        DesignError
            If the driver is fixed.

        Examples
        --------
        >>> gears = gk.gear.PlanetarySet(gk.SpurGear(24, 2), gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8))
        >>> gears.turns(driver="carrier", fixed="sun")["ring"]
        Fraction(7, 5)
        """
        if driver == fixed:
            others = " or ".join(name for name in MEMBERS if name != driver)
            raise DesignError("fixed", f"found {fixed}, which drives", f"give {others}", "conflict")
        return self._willis({driver: Fraction(1), fixed: Fraction(0)})

    def efficiency(self, friction: float, driver: Member = "sun", fixed: Member = "ring") -> float:
        """Share of the power of the driver that reaches the output.

        Parameters
        ----------
        friction : float
            Mean coefficient of friction of the flanks.
        driver, fixed : {"sun", "carrier", "ring"}, optional
            The member that drives, and another one that is held.

        Returns
        -------
        float
            0 if friction locks the set.

        Notes
        -----
        Seen from the carrier the meshes lose power as if it stood still, from the sun to the ring or back; torques and
        speeds relative to the frame then give the powers (Mueller, Die Umlaufgetriebe). Losses as of
        `GearTrain.efficiencies`.

        Examples
        --------
        >>> gears = gk.gear.PlanetarySet(gk.SpurGear(24, 2), gk.SpurGear(18, 2), gk.RingGear(60, 2, addendum=0.8))
        >>> round(gears.efficiency(0.1), 3)
        0.979
        """
        turns, output = self.turns(driver, fixed), next(m for m in MEMBERS if m not in (driver, fixed))
        held = (1 - friction * loss_factor(self.inner)) * (1 - friction * loss_factor(self.outer))
        for sun in (1.0, -1.0):
            drives = sun * float(turns["sun"] - turns["carrier"]) > 0
            ring = sun * self.ring.teeth / self.sun.teeth * (held if drives else 1 / held) if held > 0 else 0.0
            torques = {"sun": sun, "ring": ring, "carrier": -sun - ring}
            power = {name: torques[name] * float(turns[name]) for name in (driver, output)}
            if power[driver] > 0 > power[output]:
                return -power[output] / power[driver]
        return 0.0

    def _willis(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Speeds of all members from two of them."""
        z_s, z_r, z_p = self.sun.teeth, self.ring.teeth, self.planet.teeth
        weights = {"sun": z_s, "ring": z_r, "carrier": -(z_s + z_r)}
        (missing,) = set(weights) - set(given)
        known = sum(weights[name] * speed for name, speed in given.items())
        speeds = {**given, missing: -known / weights[missing]}
        planet = speeds["carrier"] - (speeds["sun"] - speeds["carrier"]) * z_s / z_p
        return {name: speeds[name] for name in weights} | {"planet": planet}

    @checked
    def poses(self, turn: FloatOrNan, driver: Member = "sun", fixed: Member = "ring") -> tuple[Pose, list[Pose], Pose]:
        """Poses of sun, planets and ring at rotations of the driver.

        Parameters
        ----------
        turn : float or array_like
            Rotations of the driver, rad, any shape.
        driver, fixed : {"sun", "carrier", "ring"}, optional
            The member that drives, and another one that is held.

        Returns
        -------
        tuple of Pose, list of Pose, Pose
            Sun, planets and ring; the first planet starts on +y.
        """
        t = np.asarray(turn, dtype=float)
        angles = {name: t * float(speed) for name, speed in self.turns(driver, fixed).items()}
        origin = np.zeros(t.shape, complex)
        arms = [angles["carrier"] + 2 * np.pi * k / self.planets for k in range(self.planets)]
        planets = [self._planet(angles["sun"], arm) for arm in arms]
        # At the start planet and ring are posed as in their pair.
        first = float(np.angle(complex(self._planet(np.array(0.0), np.array(0.0)).direction)))
        ring = complex(self.outer.poses(first)[1].direction) * np.exp(1j * angles["ring"])
        return Pose(origin, np.exp(1j * angles["sun"])), planets, Pose(origin, ring)

    def _planet(self, turn: Real, arm: Real) -> Pose:
        pose = self.inner.poses(turn - arm)[1]
        return Pose(pose.origin * np.exp(1j * arm), pose.direction * np.exp(1j * arm))

    def _gap(self, planets: int) -> float:
        if planets == 1:
            return float("inf")
        return 2 * self.inner.centre_distance * float(np.sin(np.pi / planets)) - 2 * self.planet.tip_radius

    def _can_assemble(self, planets: int) -> bool:
        """Whether a number of planets can be assembled with even spacing and without touching each other."""
        return (self.sun.teeth + self.ring.teeth) % planets == 0 and self._gap(planets) > 0

    def _planets_error(self) -> tuple[str, str]:
        """Problem of the number of planets, and remedy with the nearest valid number."""
        # A single planet is always valid.
        nearest = min((n for n in range(1, 101) if self._can_assemble(n)), key=lambda n: (abs(n - self.planets), n))
        if self._gap(self.planets) <= 0:
            return f"found {self.planets}, whose tips would touch each other", f"give {nearest}, or other teeth"
        return (
            f"found {self.planets}, which cannot be evenly spaced: {self.sun.teeth} + {self.ring.teeth} teeth are not "
            f"divisible by {self.planets}"
        ), f"give {nearest}, or other teeth"

    def _fitting_ring(self) -> str:
        """A remedy: the ring's profile shift, or else its number of teeth, for which both distances agree."""
        given, required = self.ring.profile_shift, self.inner.centre_distance

        def distance(shift: float) -> float:
            """With the ring of another profile shift, mm; infinite of either sign if that ring is impossible."""
            try:
                return GearPair(self.planet, replace(self.ring, profile_shift=shift)).tight_distance
            except DesignError:
                return -np.inf if shift < given else np.inf

        shift = last_fit(lambda x: distance(x) >= required, given + 2, given - 2)
        if abs(distance(shift) - required) < 1e-6 * self.sun.module:
            return f"give {shift:.9g}"
        return f"give the ring {self.sun.teeth + 2 * self.planet.teeth} teeth"
