"""Frames over which teeth in mesh come round to where they were, and where flanks touch in them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..cached import cached_property
from ..part import Part
from ..plane.vec import Complex, Real, Whole

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
