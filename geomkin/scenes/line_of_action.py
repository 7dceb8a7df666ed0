"""The line along which two gears touch."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..gear.pair import GearPair
from ..gear.rack import RackPair
from ..plane.primitives import Circle, Segment
from ..plane.vec import Complex
from ..scene import SceneCurve


@dataclass(frozen=True)
class LineOfAction:
    """That of a pair whose driver turns counterclockwise about the origin.

    Lengths along it, mm, are measured from the driver's base circle; the pitch point lies on +y of the driver, of a
    rack on -y. Derived here.
    """

    pair: GearPair | RackPair

    @property
    def angle(self) -> float:
        """Working pressure angle, rad."""
        return self.pair.driver.pressure_angle if isinstance(self.pair, RackPair) else self.pair.working_pressure_angle

    @property
    def side(self) -> int:
        """1 where the other lies on +y of the driver, or is a ring round it; -1 where it is a rack below."""
        return -1 if isinstance(self.pair, RackPair) else 1

    @property
    def pitch_point(self) -> float:
        """Length at which the line passes the line of centres, mm."""
        return self.pair.driver.base_radius * float(np.tan(self.angle))

    @property
    def flank_turn(self) -> float:
        """Turn of the driver, less the roll angle of its contact, rad, within half a pitch of none."""
        driver = self.pair.driver
        # It touches with the left-hand flank of the tooth on +y, or with that of one half a turn on.
        opposite = 0.0 if self.side > 0 or driver.teeth % 2 == 0 else np.pi / driver.teeth
        return opposite - self.angle - driver.tooth.half_angle(driver.base_radius)

    def place(self, along: ArrayLike) -> Complex:
        """Points of the line, mm, at lengths along it."""
        ahead = np.exp(1j * (np.pi - self.angle))
        return np.asarray(self.side * ahead * (np.asarray(along) - 1j * self.pair.driver.base_radius))

    def between(self, start: float, end: float) -> Segment:
        """A stretch of the line."""
        return Segment(complex(self.place(start)), complex(self.place(end)))

    def circles(self) -> Iterator[SceneCurve]:
        """Pitch and base circles of both, those that roll on each other; of a rack its pitch line."""
        driver, pair = self.pair.driver, self.pair
        name, other = pair.names
        if isinstance(pair, RackPair):
            half = pair.rack.teeth * pair.rack.pitch / 2
            radius = driver.pitch_radius
            yield SceneCurve(
                Segment(complex(-half, -radius), complex(half, -radius)), "pitch", f"pitch line of the {other}"
            )
        else:
            radius, across = pair.working_radii
            centre = complex(0, -pair.centre_distance if pair.is_internal else pair.centre_distance)
            yield SceneCurve(Circle(centre, across), "pitch", f"pitch circle of the {other}")
            yield SceneCurve(Circle(centre, pair.second.base_radius), "construction", f"base circle of the {other}")
        yield SceneCurve(Circle(0j, radius), "pitch", f"pitch circle of the {name}")
        yield SceneCurve(Circle(0j, driver.base_radius), "construction", f"base circle of the {name}")
