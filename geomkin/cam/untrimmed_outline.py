"""What the follower touches all the way round, as one closed curve, loops and all."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..plane.curve import AbstractCurve, just_before
from ..plane.derived import Stretch
from ..plane.joined import Path
from ..plane.vec import Pose, Real
from .cam import Cam
from .maxima import samples

# Contacts on the two sides of a joint that differ by more than this share of the base radius lie apart, and
# what joins them is a piece of the outline. Smaller makes pieces out of the rounding at a law's ends; larger
# leaves gaps, with which a path of pieces is not closed.
APART = 5e-10
# Chords over one turn in the search for crossings, and at least in each segment. Loops of the profile are looked
# at more closely. Fewer miss flanks that just cross; these, crossings less deep than 3e-7 of the radius of curvature.
CHORDS, CHORDS_PER_SEGMENT = 4096, 64


@dataclass(frozen=True, eq=False)
class UntrimmedOutline:
    """What a follower touches all the way round: the profile and, where it jumps, what joins its ends.

    Where the programme's velocity jumps, the follower stands still while the contact runs along it: along
    the face, or round the roller. So pieces of the profile, each over a stretch of cam angles, are followed
    each by such a joint; but one piece, the profile itself, where nothing jumps.
    """

    cam: Cam

    @cached_property
    def pieces(self) -> tuple[AbstractCurve, ...]:
        """Pieces end to end, all the way round; every second one is a joint."""
        profile, breaks = self.cam.profile, self.cam.program.breaks
        before = profile.point(just_before(breaks[1:], breaks[1:]))
        after = profile.point(np.append(breaks[1:-1], breaks[0]))
        jumps = np.flatnonzero(np.abs(after - before) > APART * self.cam.base_radius)
        if not len(jumps):
            return (profile,)
        pieces: list[AbstractCurve] = []
        first = 0
        for k in jumps.tolist():
            joint = _joint(self.cam, float(breaks[k + 1]), complex(before[k]), complex(after[k]))
            pieces += [Stretch(profile, breaks[first : k + 2]), joint]
            first = k + 1
        return (*pieces, Stretch(profile, breaks[first:])) if first < len(breaks) - 1 else tuple(pieces)

    @cached_property
    def reach(self) -> float:
        """Distance from the axis, mm, beyond which no cam is left: the follower covers all of a curve round the axis.

        That is the pitch curve, or the feet of the perpendiculars from the axis to the face.
        """
        cam = self.cam
        motion = cam.program.motion(samples(cam.program.breaks))
        return float(cam.follower.covered_from(motion, cam.base_radius, cam.sense).max())

    @cached_property
    def curve(self) -> Path:
        """The pieces as one closed curve; piece k runs over k <= t <= k + 1."""
        return Path(self.pieces)

    def cam_angle(self, t: float) -> float:
        """Cam angle, rad, at a parameter of the curve."""
        k = min(int(t), len(self.pieces) - 1)
        if k % 2:
            return float(self.pieces[k - 1].breaks[-1])
        first, last = map(float, self.pieces[k].breaks[[0, -1]])
        return first + (t - k) * (last - first)

    def parameter(self, angle: float, ending: bool) -> float:
        """Parameter of the curve at a cam angle; at a joint, that where it is reached if `ending`, else left."""
        ends = np.array([piece.breaks[-1] for piece in self.pieces[::2]])
        k = min(int(np.searchsorted(ends, angle, side="left" if ending else "right")), len(ends) - 1)
        first, last = map(float, self.pieces[2 * k].breaks[[0, -1]])
        return 2 * k + (angle - first) / (last - first)

    def between(self, start: float, end: float) -> list[AbstractCurve]:
        """The curves between two parameters."""
        parts: list[AbstractCurve] = []
        for k in range(int(start), int(np.ceil(end))):
            b = self.pieces[k].breaks
            low, high = (b[0] + (min(max(t, k), k + 1) - k) * (b[-1] - b[0]) for t in (start, end))
            # What is left of a piece beyond a crossing at its very end is rounding.
            if high - low > 1e-13 * (b[-1] - b[0]):
                parts.append(Stretch(self.pieces[k], np.array([low, *b[(b > low) & (b < high)], high])))
        return parts

    @cached_property
    def places(self) -> Real:
        """Rising parameters. The chords between them cross where the curve does, except in its loops."""
        return np.concatenate([k + self._shares(k) for k in range(len(self.pieces))])

    def _shares(self, number: int) -> Real:
        """From 0 to 1 along a piece, its end excluded."""
        b = self.pieces[number].breaks
        if number % 2:
            return np.linspace(0, 1, CHORDS_PER_SEGMENT + 1)[:-1]
        counts = np.maximum(CHORDS_PER_SEGMENT, CHORDS * np.diff(b) / (2 * np.pi)).astype(int).tolist()
        t = np.concatenate([np.linspace(first, last, n + 1)[:-1] for first, last, n in zip(b, b[1:], counts)])
        shares: Real = (t - b[0]) / (b[-1] - b[0])
        return shares


def _joint(cam: Cam, angle: float, before: complex, after: complex) -> AbstractCurve:
    on_ground, to_cam = cam.follower_pose(angle), np.exp(-1j * cam.sense * angle)
    return cam.follower.joint(Pose(to_cam * on_ground.origin, to_cam * on_ground.direction), before, after)
