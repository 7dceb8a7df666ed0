"""How far a follower can rock between the walls that hold it: rollers are swept along the plates as they are cut."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..core.records import record
from ..plane.vec import Complex, Real
from .cam import Cam

# Steps of the approach to a wall. Each leaves 1 - cos(pressure angle) of the distance: 1e-9 of it at 45 deg.
STEPS = 17
# Change, as a share of the largest one, with which the approach ends.
NEAR = 1e-6
# Positions in each smooth piece of the programme at which the play is computed; it varies slowly.
POSITIONS = 25
# Shares of a piece at which it begins and ends, so that no position is at a joint.
INSIDE = 1e-6


@record(eq=False)
class Wall:
    """A plate of a cam as cut, and the roller that runs along it.

    outline: closed polygon of the wall, in the cam's frame, mm. centre: of the roller in the follower's frame, mm.
    radius: of the roller, mm.
    """

    outline: Complex
    centre: complex
    radius: float


def play_angles(cam: Cam) -> Real:
    """Cam angles, rad, between the joints of a programme."""
    shares = np.linspace(INSIDE, 1 - INSIDE, POSITIONS)
    return np.concatenate([a + (b - a) * shares for a, b in pairwise(cam.program.breaks)])


def roller_play(cam: Cam, walls: Sequence[Wall], angle: Real, most: float) -> tuple[Real, Real]:
    """Changes of the lift, mm or rad, to either side of the programme's at which a roller meets a wall.

    The first is negative and the second positive; with the other sign they are changes that free a roller that jams.
    most: largest change, mm or rad, for a roller that no wall stops.
    """
    from ..plane.region import Edges

    lift, back = cam.program.motion(angle).lift, np.exp(-1j * cam.sense * angle)
    edges = [Edges(wall.outline, np.roll(wall.outline, -1)) for wall in walls]
    # A roller moves by no more than this per unit of lift.
    reach = max(abs(wall.centre) for wall in walls) if cam.follower.oscillates else 1.0

    def room(shift: Real) -> Real:
        pose = cam.follower.pose(lift + shift, cam.base_radius)
        places = (back * np.asarray(pose.place(wall.centre)) for wall in walls)
        rooms: Real = np.min([near.nearest(z)[1] - wall.radius for near, z, wall in zip(edges, places, walls)], axis=0)
        return rooms

    sides = []
    for side in (-1, 1):
        shift = np.zeros(np.shape(angle))
        for _ in range(STEPS):
            before, shift = shift, np.clip(shift + side * room(shift) / reach, -most, most)
            if np.abs(shift - before).max() < NEAR * most:
                break
        sides.append(shift)
    return sides[0], sides[1]
