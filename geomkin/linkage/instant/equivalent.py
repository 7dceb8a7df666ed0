"""Equivalent linkages: a contact of two bodies at one position as the linkage that moves as it does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...arguments import Place, check_fields
from ...brief import one_line
from ...cached import cached_property
from ...errors import DesignError
from ...plane.vec import Complex, Real, dot, unit
from ..linkage import Linkage, Slider
from ..solve.move import move


@dataclass(frozen=True, eq=False)
class DirectContact:
    """A turning body that drives a follower by rolling and sliding contact: a cam, a roller, two curved levers.

    All fields of one shape (positions,), or one position; places mm, seen from the ground.
    point: where they touch. normal: the common normal, from the driver into the follower, of any length.
    driver_radius, follower_radius: radius of curvature of each surface there, mm, positive where convex, inf
    where straight, 0 at an edge. A roller may count as part of the driver: point its centre, follower_radius 0 and
    driver_radius that of the pitch curve. driver_pivot: about which the driver turns.
    Give the follower one of follower_pivot, about which it turns, or follower_direction, along which it slides.

    Two bodies in contact move, to the second order, as if a bar joined their centres of curvature; where a surface
    is straight a slider on it takes the place of the bar. Hence the follower's velocity and acceleration need
    the curvature at the contact and not the curve's equation. They are not finite where the follower cannot give way
    along the normal, and where the two surfaces have one centre of curvature. DesignError if both are straight.
    Derived here, after the equivalent linkage of the textbooks.
    """

    point: Place
    normal: Place
    driver_radius: Real
    follower_radius: Real
    driver_pivot: Place = 0j
    follower_pivot: Place | None = None
    follower_direction: Place | None = None

    __repr__ = one_line

    def __post_init__(self) -> None:
        check_fields(self)
        if (self.follower_pivot is None) == (self.follower_direction is None):
            found = "neither" if self.follower_pivot is None else "both"
            raise DesignError("follower_pivot", f"of it and follower_direction found {found}", "give one of them")
        if np.any(np.isinf(self.driver_radius) & np.isinf(self.follower_radius)):
            raise DesignError("follower_radius", "both surfaces are straight", "give at least one a finite radius")

    @property
    def driver_centre(self) -> Complex:
        """Centre of curvature of the driver's surface, mm; not finite where it is straight."""
        return self._centre(-np.asarray(self.driver_radius))

    @property
    def follower_centre(self) -> Complex:
        """Centre of curvature of the follower's surface, mm; not finite where it is straight."""
        return self._centre(np.asarray(self.follower_radius))

    def _centre(self, along: Real) -> Complex:
        with np.errstate(invalid="ignore"):
            return np.asarray(self.point) + along * self._normal

    @property
    def first(self) -> Real:
        """Follower's first kinematic coefficient: rad per rad of the driver, or mm per rad where it slides."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return dot(self._normal, self._driver_way) / dot(self._normal, self._way)

    @property
    def sliding(self) -> Real:
        """How fast the follower's surface slides on the driver's, mm per rad, positive to the left of the normal."""
        with np.errstate(invalid="ignore"):
            return dot(1j * self._normal, self.first * self._way - self._driver_way)

    @property
    def second(self) -> Real:
        """Follower's second kinematic coefficient: rad, or mm where it slides, per rad squared of the driver."""
        n, f, point = self._normal, self.first, np.asarray(self.point)
        with np.errstate(invalid="ignore", divide="ignore"):
            along = self._curving(0 * f if self.follower_pivot is None else f) - dot(n, point - self.driver_pivot)
            if self.follower_pivot is not None:
                along = along + f**2 * dot(n, point - self.follower_pivot)
            return along / dot(n, self._way)

    def _curving(self, h: Real) -> Real:
        """What the two curvatures add along the normal: r1 + h^2 r2 - (r1 + r2) k^2, k the turning of the bar.

        r1, r2 the radii, s the sliding, h the follower's turning: (r1 + r2) k = s + r1 + h r2. As a radius goes to
        infinity, r1 (1 - h)^2 - 2 h s for a straight follower, r2 (1 - h)^2 - 2 s for a straight driver.
        """
        r1, r2, s = np.asarray(self.driver_radius), np.asarray(self.follower_radius), self.sliding
        both = r1 + h**2 * r2 - (s + r1 + h * r2) ** 2 / (r1 + r2)
        straight_follower = r1 * (1 - h) ** 2 - 2 * h * s
        straight_driver = r2 * (1 - h) ** 2 - 2 * s
        return np.where(np.isinf(r2), straight_follower, np.where(np.isinf(r1), straight_driver, both))

    @property
    def linkage(self) -> Linkage:
        """The equivalent linkage of one position, which stands there at drive 0, on branch `branch`.

        Bodies ground, driver, coupler (a bar, or a slider on the straight surface) and follower; the frames of
        driver and follower are turned as the ground's is.
        """
        for field, given in vars(self).items():
            if np.ndim(given) and field in self.__dataclass_fields__:
                raise DesignError(field, f"found {np.shape(given)} positions", "give one position")
        pivot, c1, c2 = complex(self.driver_pivot), complex(self.driver_centre), complex(self.follower_centre)
        ground, driver = {"driver_pivot": pivot}, {"driver_pivot": 0j}
        coupler: dict[str, complex] = {}
        follower: dict[str, complex] = {}
        sliders, home = [], self._home
        if self.follower_pivot is not None:
            ground["follower_pivot"], follower["follower_pivot"] = home, 0j
        along = float(np.degrees(np.angle(1j * self._normal)))
        start = c1 if np.isfinite(c1) else c2
        if np.isfinite(c1):
            driver["driver_centre"], coupler["driver_centre"] = c1 - pivot, c1 - start
        else:
            sliders.append(Slider("contact", "coupler", "driver", through=c2 - pivot, direction_deg=along))
        if np.isfinite(c2):
            follower["follower_centre"], coupler["follower_centre"] = c2 - home, c2 - start
        else:
            sliders.append(Slider("contact", "coupler", "follower", through=c1 - home, direction_deg=along))
        if self.follower_direction is not None:
            way = float(np.degrees(np.angle(self.follower_direction)))
            sliders.append(Slider("guide", "follower", "ground", through=home, direction_deg=way, angle_deg=-way))
        bodies = {"ground": ground, "driver": driver, "coupler": coupler, "follower": follower}
        return Linkage(bodies, "driver", tuple(sliders))

    @property
    def branch(self) -> Literal[1, -1]:
        """The branch of `linkage` that is the position given; +1 where both are."""

        def off(branch: Literal[1, -1]) -> float:
            follower = move(self.linkage, [0.0], branch).bodies["follower"]
            moved = follower.point(complex(self.point) - self._home).position[0] - complex(self.point)
            away = abs(moved) + abs(follower.origin.position[0] - self._home)
            return float(away) if np.isfinite(away) else np.inf

        return 1 if off(1) <= off(-1) else -1

    @property
    def _home(self) -> complex:
        """Where the follower has its own origin: its pivot, or the contact."""
        return complex(self.point if self.follower_pivot is None else self.follower_pivot)

    @cached_property
    def _normal(self) -> Complex:
        return unit(self.normal)

    @property
    def _driver_way(self) -> Complex:
        """Where the driver's point of contact goes, mm per rad of the driver."""
        return 1j * (np.asarray(self.point) - self.driver_pivot)

    @property
    def _way(self) -> Complex:
        """Where the follower's point of contact goes, mm per rad or mm of the follower."""
        if self.follower_direction is not None:
            return unit(self.follower_direction)
        arm: Complex = np.asarray(self.point) - np.asarray(self.follower_pivot)
        return 1j * arm
