"""Frames over which teeth in mesh come round to where they were, and where flanks touch: contacts, line of action."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..gear.pair import GearPair
from ..gear.rack import RackPair
from ..part import Part
from ..plane.primitives import Circle, Segment
from ..plane.vec import Complex, Real, Whole
from ..scene import SceneCurve

# Frames for a pitch: the most, where few pitches are shown; the fewest, where many are; and how many all of them take
# together. Fewer for a pitch and teeth seem to stand still or to run backwards; more make pages that nobody can send.
FINE, COARSE, FRAMES = 60, 12, 360
# Pitches that are shown at most: more than a reader waits for.
MOST_PITCHES = 60
# Seconds that a pitch is shown for: about what the eye follows.
PITCH_TIME = 1.0
# Of a plate's size, how near openings come to each other's places for the plate to look the same.
ALIKE = 1e-6


@dataclass(frozen=True)
class Meshing:
    """Frames of a mesh, in equal steps of a driver's turn.

    contact_ratio: pitches for which a pair of flanks touches, 0 where none does; one pair is followed from its first
    contact on, then the next that comes as many whole pitches later. pitches: that are shown. cyclic: the last frame
    looks as the first.
    """

    contact_ratio: float
    pitches: int
    cyclic: bool

    @property
    def followed(self) -> int:
        """Pitches after which the next pair of flanks is followed: that for which one touches, rounded up."""
        return pitches_in_contact(self.contact_ratio)

    @property
    def steps(self) -> int:
        """Frames for a pitch."""
        return max(COARSE, min(FINE, FRAMES // self.pitches))

    @cached_property
    def frame(self) -> Whole:
        """0, 1, 2 ..., (frames,)."""
        return np.arange(self.pitches * self.steps + 1)

    @property
    def passed(self) -> Real:
        """Pitches that the driver has turned since the first frame, (frames,)."""
        return self.frame / self.steps

    @property
    def time(self) -> Real:
        """s."""
        return PITCH_TIME * self.passed

    @property
    def since(self) -> Real:
        """Pitches since the pair of flanks that is followed began to touch, (frames,); nan where it has let go."""
        return self._touching(self.frame % (self.followed * self.steps) / self.steps)

    @property
    def all_since(self) -> Real:
        """The same of every pair of flanks that touches, (pairs, frames), the youngest first."""
        youngest = self.frame % self.steps / self.steps
        return np.array([self._touching(youngest + k) for k in range(self.followed)])

    def _touching(self, since: Real) -> Real:
        # A hair of room: a last contact is not lost to rounding.
        return np.where(since <= self.contact_ratio * (1 + 1e-12), since, np.nan)


def pitches_in_contact(contact_ratio: float) -> int:
    """Whole pitches within which a pair of flanks begins and ends to touch."""
    return max(1, math.ceil(contact_ratio * (1 - 1e-12)))


def meshing(contact_ratio: float, wheels: Iterable[tuple[int, Sequence[Part]]]) -> Meshing:
    """The fewest pitches after which all looks as it did: a keyway, and spokes, come round only with their wheel.

    wheels: number of teeth, and plates, of each. Derived here.
    """
    whole = math.lcm(1, *(teeth for teeth, parts in wheels if not all(_alike(part, teeth) for part in parts)))
    pitches = math.lcm(whole, pitches_in_contact(contact_ratio))
    return Meshing(contact_ratio, min(pitches, MOST_PITCHES), pitches <= MOST_PITCHES)


def _alike(part: Part, teeth: int) -> bool:
    """Whether the openings of a wheel of so many teeth look the same after each pitch."""
    if not part.holes:
        return True
    middles = np.array([_middle(hole.point(_places(hole.breaks))) for hole in part.holes])
    turned = middles * np.exp(2j * np.pi / teeth)
    apart = np.abs(turned[:, None] - middles).min(axis=1)
    size = np.abs(part.outline.point(part.outline.breaks)).max()
    return bool(apart.max() <= ALIKE * size)


def _places(breaks: Real) -> Real:
    return np.linspace(breaks[:-1], breaks[1:], 5)[:-1].ravel()


def _middle(points: Complex) -> complex:
    return complex(points.mean())


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
