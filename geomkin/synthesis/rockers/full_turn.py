"""What a linkage really does over a full turn of its crank, as it is moved: the judge of those found in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...brief import one_line
from ...linkage.bars import FourBar
from ...linkage.measures import dead_centres, least_transmission_angle
from ...linkage.sliders import SliderCrank
from ...linkage.solve.move import move
from ...plane.vec import Real

# rad. Two dead centres that are nearer than this on the circle are one that was found from both sides of 0; of those
# that are looked for in steps of a quarter degree none are nearer.
ONE = 1e-6
# Frames of the turn, besides the dead centres; that it closes between them as well is seen from as many.
FRAMES = 361


@dataclass(frozen=True, eq=False, kw_only=True)
class FullTurn:
    """A full turn of a crank, counterclockwise, and what it does to its rocker or slider.

    extent: how far the output goes there and back, rad or mm. start, turn: the crank's angle, 0 to 2 pi, where the
    output begins to go counterclockwise, or towards +x, and its turn until the output goes back, rad. least: the least
    transmission angle, rad. All nan where the linkage does not close all the way, or does not go there and back once.
    """

    extent: float
    start: float
    turn: float
    least: float

    __repr__ = one_line


def full_turn(linkage: FourBar | SliderCrank, branch: int = 1) -> FullTurn:
    """The linkage moved once round. Derived here: dead centres as zeros of the output's first coefficient."""
    output = "rocker" if isinstance(linkage, FourBar) else "slider"
    # A little more than one turn: a dead centre at its very ends would show no change of sign.
    dead = _once(dead_centres(linkage, output, branch, (-0.1, 2 * np.pi + 0.1)))
    frames = np.linspace(0, 2 * np.pi, FRAMES)
    # Crank and ground in line are the two places at which the transmission angle of a four-bar is least; of a
    # slider-crank it is crank and slide line at right angles. All three are frames.
    motion = move(linkage, frames, branch)
    if len(dead) != 2 or not motion.closed.all():
        return FullTurn(extent=np.nan, start=np.nan, turn=np.nan, least=np.nan)
    body = move(linkage, dead, branch).bodies[output]
    if output == "rocker":
        places: Real = np.unwrap(np.angle(body.direction))
        way = np.unwrap(np.angle(motion.bodies[output].direction))
    else:
        places, way = body.origin.position.real, motion.bodies[output].origin.position.real
    turn = float(dead[1] - dead[0])
    start, turn = (float(dead[0]), turn) if places[1] > places[0] else (float(dead[1]), 2 * np.pi - turn)
    extent = max(float(np.ptp(places)), float(np.ptp(way)))
    return FullTurn(extent=extent, start=start, turn=turn, least=float(least_transmission_angle(motion)))


def _once(turns: Real) -> Real:
    """Angles on the circle, 0 to 2 pi and rising, each told once."""
    rising = np.sort(np.mod(turns, 2 * np.pi))
    before = np.roll(rising, 1) - 2 * np.pi * (np.arange(len(rising)) == 0)
    once: Real = rising[rising - before > ONE]
    return once
