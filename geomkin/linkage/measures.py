"""What designers judge a linkage by."""

from __future__ import annotations

import numpy as np

from ..arguments import checked
from ..errors import DesignError
from ..plane.vec import Array, dot
from .named.four_bar import FourBar
from .motion import Motion
from .named.slider_crank import SliderCrank

# Turning over the linkage's size as a share of sliding: what is less is rounding of a body that only slides, what
# is more a body that turns.
STILL = 1e-9


@checked
def grashof_type(linkage: FourBar) -> str:
    """Which links turn fully: by the shortest link if shortest + longest is no more than the other two.

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
def circuits(linkage: FourBar | SliderCrank, motion: Motion) -> Array:
    """The circuit of each frame, +1 or -1: poses of one sign are reached from each other without taking it apart.

    0 where open; +1 throughout where there is one circuit only. Of a Grashof four-bar the sign of the angle at a
    joint not adjacent to the shortest link; of a slider-crank whose crank turns fully the side on which the
    slider stands, and where the connecting rod turns fully the side on which the crank does.
    """
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
    elif linkage.crank + abs(linkage.offset) < linkage.coupler:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["coupler"].direction))
    elif linkage.coupler + abs(linkage.offset) < linkage.crank:
        sign = np.sign(dot(motion.bodies["ground"].direction, motion.bodies["crank"].direction))
    else:
        sign = np.ones(motion.closed.shape)
    return np.where(motion.closed, sign, 0).astype(int)


@checked
def least_transmission_angle(motion: Motion) -> Array:
    """Least transmission angle over the frames that are reached, rad, () or (linkages,); nan where none is."""
    return np.fmin.reduce(np.where(motion.closed, motion.transmission_angle, np.nan), axis=0)


@checked
def mechanical_advantage(motion: Motion, output: str) -> Array:
    """Output torque or force over input torque or force, by the power that both have: dq over the output's own way.

    Of a turning body the torque it gives for 1 of the driver's; of one that only slides on the ground the force along
    its line, per mm where the driver turns. Signed: negative where it works against the driver's sense. Of any other
    body that moves without turning, such as a platform on two cranks, the force along the path of its points, which is
    the same for all: positive, since a path has no sense but the motion's. inf where the output stands still (a dead
    centre of the output), 0 where the driver does.
    """
    if output not in motion.bodies or output == motion.linkage.ground:
        raise DesignError("output", f"found {output!r}", f"give one of {', '.join(list(motion.bodies)[1:])}")
    body = motion.bodies[output]
    lines = [s for s in motion.linkage.sliders if {s.body, s.along} == {output, motion.linkage.ground}]
    if lines:
        slider = lines[0]
        line = motion.bodies[motion.linkage.ground].direction * (
            slider.direction if slider.body == output else -slider.direction
        )
        along = dot(line, body.point(slider.point if slider.body == output else slider.through).first)
    else:
        along = np.abs(body.origin.first)
    way = np.where(goes_without_turning(motion, output), along, body.first)
    with np.errstate(divide="ignore"):
        return 1 / way


def goes_without_turning(motion: Motion, body: str) -> Array:
    """Whether all that a body turns over the frames is rounding of its going along, bool, () or (linkages,)."""
    moving = motion.bodies[body]
    turning, going = (
        np.abs(np.nan_to_num(rate, nan=0.0, posinf=0.0, neginf=0.0)).max(axis=0, initial=0.0)
        for rate in (moving.first, moving.origin.first)
    )
    size = motion.linkage.size
    return turning * np.where(size > 0, size, 1.0) <= STILL * going
