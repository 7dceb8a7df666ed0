"""A sun, planets and a ring."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from ..core.arguments import NUMBER, RealsOrNan, checked, refused
from ..core.errors import DesignError
from ..core.fields import entry, quantity
from ..core.records import record
from ..core.reprs import moving
from ..plane.vec import Pose, Real
from .cutters import HelixAngle
from .pair import GearPair
from .ring import RingGear
from .spur import SpurGear


@record(checked=True)
class PlanetarySet:
    """A sun about the origin, equal planets evenly around it, and a ring around them.

    Speeds by Willis's equation (Müller, Epicyclic Drive Trains). Raises DesignError where the planets' distances
    from the sun and in the ring differ, or so many planets cannot be put in.
    """

    sun: SpurGear = entry("the gear in the middle", example=SpurGear(24, 2))
    planet: SpurGear = entry("each of the gears between", example=SpurGear(18, 2))
    ring: RingGear = entry("the ring around them", example=RingGear(60, 2, addendum=0.8))
    planets: int = quantity("number of planets", whole=True, default=3, at_least=1, at_most=100)

    _repr_html_ = moving

    def __post_init__(self) -> None:
        inner, outer = self.inner.centre_distance, self._outer_distance
        if abs(inner - outer) > 1e-6 * self.sun.module:
            raise DesignError(
                "ring.profile_shift",
                f"found {self.ring.profile_shift:g}: planets {inner:.6g} mm from the sun, {outer:.6g} mm in the ring",
                self._fitting_ring(),
            )
        self.outer  # noqa: B018  # refuses a ring in which the planets jam
        if not self._can_hold(self.planets):
            raise DesignError("planets", *self._wrong_planets())

    @checked
    def transverse(self, helix_angle_deg: HelixAngle) -> PlanetarySet:
        """The transverse section of helical teeth whose normal section has these sizes, as of a spur gear."""
        sun, planet = (gear.transverse(helix_angle_deg) for gear in (self.sun, self.planet))
        return PlanetarySet(sun, planet, self.ring.transverse(helix_angle_deg), self.planets)

    @cached_property
    def inner(self) -> GearPair:
        """Sun and planet in mesh."""
        return GearPair(self.sun, self.planet)

    @cached_property
    def outer(self) -> GearPair:
        """Planet and ring in mesh, at the distance that the sun gives."""
        return GearPair(self.planet, self.ring, self.inner.centre_distance)

    @property
    def planet_gap(self) -> float:
        """Room between the tips of neighbouring planets, mm; infinite for one."""
        return self._room(self.planets)

    @property
    def ratios(self) -> dict[str, float]:
        """Turns of the input for one of the output, `input to output` as key; the third member held still."""
        sun, ring = self.sun.teeth, self.ring.teeth
        return {
            "sun to carrier": 1 + ring / sun,
            "carrier to sun": 1 / (1 + ring / sun),
            "ring to carrier": 1 + sun / ring,
            "carrier to ring": 1 / (1 + sun / ring),
            "sun to ring": -ring / sun,
            "ring to sun": -sun / ring,
        }

    def speeds(self, **held: float) -> dict[str, float]:
        """Speeds of `sun`, `ring`, `carrier` and `planet`, all seen from the frame, from two of the first three.

        By Willis's equation sun z_s + ring z_r = carrier (z_s + z_r); any unit.
        """
        z_s, z_r, z_p = self.sun.teeth, self.ring.teeth, self.planet.teeth
        weights = {"sun": z_s, "ring": z_r, "carrier": -(z_s + z_r)}
        if len(held) != 2 or not set(held) <= set(weights):
            raise DesignError("held", f"found {', '.join(held)}", "give two of sun, ring and carrier")
        (missing,) = set(weights) - set(held)
        for name, speed in held.items():
            if not NUMBER.fits(speed):
                raise refused(name, speed, NUMBER)
        known = sum(weights[name] * speed for name, speed in held.items())
        speeds = held | {missing: -known / weights[missing]}
        planet = speeds["carrier"] - (speeds["sun"] - speeds["carrier"]) * z_s / z_p
        return {name: float(speeds[name]) for name in weights} | {"planet": float(planet)}

    @checked
    def poses(self, turn: RealsOrNan) -> tuple[Pose, list[Pose], Pose]:
        """Where sun, planets and ring stand when the sun has turned by `turn`, rad, and the ring stands still.

        The first planet starts on +y. Any shape.
        """
        t = np.asarray(turn, dtype=float)
        carrier = t / self.ratios["sun to carrier"]
        still = np.zeros(t.shape, complex)
        planets = [self._planet(t, carrier + 2 * np.pi * k / self.planets) for k in range(self.planets)]
        # Seen along the first arm, planet and ring stand as in their pair; the ring as a whole does not turn.
        arm = np.exp(1j * carrier)
        lean = np.angle(planets[0].direction * np.conj(arm))
        ring = self.outer.poses(lean)[1].direction * arm
        return Pose(still, np.exp(1j * t)), planets, Pose(still, ring)

    def _planet(self, turn: Real, arm: Real) -> Pose:
        pose = self.inner.poses(turn - arm)[1]
        return Pose(pose.origin * np.exp(1j * arm), pose.direction * np.exp(1j * arm))

    def _room(self, planets: int) -> float:
        if planets == 1:
            return float("inf")
        return 2 * self.inner.centre_distance * float(np.sin(np.pi / planets)) - 2 * self.planet.tip_radius

    def _can_hold(self, planets: int) -> bool:
        """Whether so many planets can be put in evenly, clear of each other."""
        return (self.sun.teeth + self.ring.teeth) % planets == 0 and self._room(planets) > 0

    def _wrong_planets(self) -> tuple[str, str]:
        """What is wrong with the number of planets, and the nearest that can be put in."""
        # One always can.
        near = min((n for n in range(1, 101) if self._can_hold(n)), key=lambda n: (abs(n - self.planets), n))
        if self._room(self.planets) <= 0:
            return f"found {self.planets}, whose tips would touch each other", f"give {near}, or other teeth"
        return (
            f"found {self.planets}, by which {self.sun.teeth} + {self.ring.teeth} teeth cannot be divided: "
            "they could not be put in evenly"
        ), f"give {near}, or other teeth"

    @property
    def _outer_distance(self) -> float:
        return GearPair(self.planet, self.ring).tight_distance

    def _fitting_ring(self) -> str:
        """The ring's shift, or failing that its teeth, with which both distances agree."""
        low, high = self.ring.profile_shift - 2, self.ring.profile_shift + 2
        for _ in range(60):
            middle = 0.5 * (low + high)
            try:
                small = self._distance_with(middle) < self.inner.centre_distance
            except DesignError:
                small = middle < self.ring.profile_shift
            low, high = (middle, high) if small else (low, middle)
        try:
            if abs(self._distance_with(high) - self.inner.centre_distance) < 1e-6 * self.sun.module:
                return f"give {high:.9g}"
        except DesignError:
            pass
        return f"give the ring {self.sun.teeth + 2 * self.planet.teeth} teeth"

    def _distance_with(self, shift: float) -> float:
        return GearPair(self.planet, replace(self.ring, profile_shift=shift)).tight_distance
