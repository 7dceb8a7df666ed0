"""What designers judge a linkage by."""

from __future__ import annotations

import numpy as np

from ..arguments import checked
from ..errors import DesignError
from ..plane.vec import Real, Whole, dot
from .motion import Motion
from .named.four_bar import FourBar
from .named.slider_crank import SliderCrank


@checked
def grashof_type(linkage: FourBar) -> str:
    """Which links turn fully: by the shortest link if shortest + longest is no more than the other two (Grashof, 1883).

    crank-rocker, double-crank, rocker-crank, double-rocker (the coupler turns), change-point (the sums
    are equal, to rounding), triple-rocker.
    """
    lengths, shortest, spare = _by_length(linkage)
    if abs(spare) <= 1e-12 * max(lengths.values()):
        return "change-point"
    if spare < 0:
        return "triple-rocker"
    return {
        "crank": "crank-rocker",
        "ground": "double-crank",
        "rocker": "rocker-crank",
        "coupler": "double-rocker",
    }[shortest]


def _by_length(linkage: FourBar) -> tuple[dict[str, float], str, float]:
    """Lengths, the shortest link, and what the other two have over shortest and longest, mm."""
    lengths = {name: getattr(linkage, name) for name in ("ground", "crank", "coupler", "rocker")}
    by_length = sorted(lengths, key=lengths.__getitem__)
    spare = lengths[by_length[1]] + lengths[by_length[2]] - lengths[by_length[0]] - lengths[by_length[3]]
    return lengths, by_length[0], spare


@checked
def circuits(linkage: FourBar | SliderCrank, motion: Motion) -> Whole:
    """The circuit of each frame, +1 or -1: poses of one sign are reached from each other without taking it apart.

    0 where open; +1 throughout where there is one circuit only. Of a Grashof four-bar the sign of the angle at a
    joint not adjacent to the shortest link; of a slider-crank whose crank turns fully the side on which the
    slider stands, and where the connecting rod turns fully the side on which the crank does (Chase and Mirth, Circuits
    and branches of single-degree-of-freedom planar linkages, Journal of Mechanical Design 115, 1993).
    """
    if not _is_of(motion, linkage):
        raise DesignError("motion", "it is of another linkage", "give the motion of this one")
    if isinstance(linkage, FourBar):
        _, shortest, spare = _by_length(linkage)
        # Each joint by the two links that meet there, the first one's x axis and the second's.
        joints = {"crank": "rocker_pin", "ground": "rocker_pin", "coupler": "crank_pivot", "rocker": "crank_pin"}
        if spare <= 0:
            sign = np.ones(motion.closed.shape)
        else:
            crank, coupler, rocker = (motion.bodies[n].direction for n in ("crank", "coupler", "rocker"))
            ground = motion.bodies["ground"].direction
            pairs = {"rocker_pin": (coupler, rocker), "crank_pivot": (ground, crank), "crank_pin": (crank, coupler)}
            one, two = pairs[joints[shortest]]
            sign = np.sign(np.imag(np.conj(one) * two))
    elif linkage.crank + np.abs(linkage.offset) < linkage.coupler:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["coupler"].direction))
    elif linkage.coupler + np.abs(linkage.offset) < linkage.crank:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["crank"].direction))
    else:
        sign = np.ones(motion.closed.shape)
    return np.where(motion.closed, sign, 0).astype(int)


def _is_of(motion: Motion, linkage: FourBar | SliderCrank) -> bool:
    """Whether a motion is of a linkage with these sizes, wherever it stands and whatever drives it."""
    one, two, pins = motion.linkage.bodies, linkage.linkage.bodies, linkage.linkage.pins
    return motion.linkage.pins == pins and all(
        np.array_equal(one[body][pin], two[body][pin]) for pin, bodies in pins.items() for body in bodies
    )


@checked
def least_transmission_angle(motion: Motion) -> Real:
    """Least transmission angle over the frames that are reached, rad, () or (linkages,); nan where none is."""
    least: Real = np.fmin.reduce(np.where(motion.closed, motion.transmission_angle, np.nan), axis=0)
    return least
