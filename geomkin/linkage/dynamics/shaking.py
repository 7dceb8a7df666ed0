"""Shaking force of the slider-crank, and the counterbalance that makes it least."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import Annotated

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, PointXY, entry, quantity
from ...core.records import record
from ...plane.vec import Complex, Real, cross
from ..motion import Motion
from ..moving import move
from ..named_linkages import SliderCrank
from ..solve.branch import Branch

# kg mm/s2 in N.
NEWTON = 1e-3
# Crank angles of the first look for the largest force. Fewer may miss a peak; +-90 deg must be among them, where
# the force of a rod scarcely longer than the crank has a peak narrower than any spacing.
LOOKS = np.arange(720) * np.pi / 360
# Peaks kept at most. Fewer may drop the largest; more take time where the force is nearly even, and rounding makes
# hundreds.
PEAKS = 8
# Narrowings of a peak, each to a quarter. Fewer leave an error in its value; more change no digit, as a peak is flat.
NARROWINGS = 16
# Share by which the largest force over the turn may exceed that at the deciding angles when the search ends. Smaller is
# rounding, and the search goes on to its last round; larger, and digits of the result are lost.
SETTLED = 1e-12
# Exchanges of the deciding angles at most. Five to twenty are usual; fewer may stop before the best is found.
ROUNDS = 100


@record(checked=True)
class SliderCrankMasses:
    """Masses of a slider-crank and where they are, each in its body's own frame.

    The force is that of rigid bodies. A rod lumped at its two pins, its centre of mass kept, gives the same
    force, so there is no such choice; a crank known by its imbalance, kg mm, is one of 1 kg at that many mm.
    """

    crank: float = quantity("mass of the crank", "kg", default=0.0, at_least=0, at_most=FARTHEST, example=0.5)
    coupler: float = quantity(
        "mass of the connecting rod", "kg", default=0.0, at_least=0, at_most=FARTHEST, example=0.6
    )
    slider: float = quantity("mass of the slider", "kg", default=0.0, at_least=0, at_most=FARTHEST, example=0.8)
    crank_centre: Annotated[complex, PointXY()] = entry(
        "crank's centre of mass, from its pivot, x to the crank pin, [x, y] in mm", default=0j, example=10 + 0j
    )
    coupler_centre: Annotated[complex, PointXY()] = entry(
        "rod's centre of mass, from the crank pin, x to the slider pin, [x, y] in mm", default=0j, example=30 + 0j
    )


@record(eq=False)
class Counterbalance:
    """A counterbalance and the largest shaking force it leaves, over the whole turn.

    product: mass times radius, kg mm, opposite the crank pin; complex where turned from there, by its angle
    counterclockwise. largest: N at 1 rad/s, to be multiplied by the speed squared. angles: of the crank from the
    slide line, rad, where that force is reached.
    """

    product: complex
    largest: float
    angles: Real


@checked
def shaking_force(motion: Motion, masses: SliderCrankMasses, counterbalance: complex = 0.0) -> Complex:
    """Force of a slider-crank's moving parts on the frame, (frames,) complex, N: -sum m a of their centres of mass.

    counterbalance: mass times radius, kg mm, as in `Counterbalance`. nan where the linkage is open. DesignError for the
    motion of anything else. Derived here.
    """
    if not {"crank", "coupler", "slider"} <= set(motion.bodies):
        raise DesignError("motion", f"its bodies are {', '.join(motion.bodies)}", "give the motion of a slider-crank")
    parts = (
        (masses.crank, "crank", masses.crank_centre),
        (masses.coupler, "coupler", masses.coupler_centre),
        (masses.slider, "slider", 0j),
        (1.0, "crank", -counterbalance),
    )
    forces = [mass * motion.bodies[body].point(centre).acceleration for mass, body, centre in parts]
    total: Complex = np.sum(forces, axis=0)
    return -NEWTON * total


@checked
def judged_counterbalance(
    linkage: SliderCrank,
    masses: SliderCrankMasses,
    product: complex = 0.0,
    branch: Branch = 1,
    acceleration: float = 0.0,
) -> Counterbalance:
    """A given counterbalance, kg mm, and the largest force it leaves: of all crank angles, not only sampled ones.

    branch as of the slider-crank driven by its crank. acceleration: of the crank at every angle, over its speed
    squared. DesignError where the crank does not turn fully. Derived here.
    """
    angles, forces = _peaks(linkage, masses, product, branch, acceleration)
    sizes = np.abs(forces + product) * abs(1 - 1j * acceleration)
    return Counterbalance(product, NEWTON * float(sizes.max()), angles[sizes >= (1 - 1e-9) * sizes.max()])


@checked
def best_counterbalance(
    linkage: SliderCrank,
    masses: SliderCrankMasses,
    branch: Branch = 1,
    turned: bool = False,
    acceleration: float = 0.0,
) -> Counterbalance:
    """The counterbalance that makes the largest shaking force over the turn least.

    Along the crank, its product real and negative on the pin's side; `turned`: at any angle to it, complex.
    acceleration: of the crank at every angle, over its speed squared. Seen from the crank, and divided by the force of
    1 kg mm, the force runs along a closed curve and a counterbalance shifts it, so the best one is less the centre of
    the smallest circle round the curve. Found by exchange: the circle round a few points exactly, then the curve's
    farthest points join them, until none lies outside. The largest force is right to 1e-11 of the force without any.
    DesignError where the crank does not turn fully. Derived here.
    """
    held = _peaks(linkage, masses, 0.0, branch, acceleration)[1]
    size = float(np.abs(held).max())
    for _ in range(ROUNDS):
        product = _centred(held, turned)
        forces = _peaks(linkage, masses, product, branch, acceleration)[1]
        far, radius = np.abs(forces + product), np.abs(held + product).max()
        if far.max() <= radius + SETTLED * size:
            break
        deciding = held[np.abs(held + product) >= (1 - 1e-6) * radius]
        held = np.concatenate([deciding, forces[far > radius]])
    return judged_counterbalance(linkage, masses, product, branch, acceleration)


def _from_crank(
    linkage: SliderCrank, masses: SliderCrankMasses, angles: Real, branch: Branch, acceleration: float
) -> Complex:
    """sum m a in the crank's own frame over that of 1 kg mm on the crank: a counterbalance adds its product to it."""
    motion = move(linkage, angles.ravel(), branch, 1.0, acceleration)
    force = shaking_force(motion, masses) / -NEWTON / (1 - 1j * acceleration)
    return (force * np.conj(motion.bodies["crank"].direction)).reshape(angles.shape)


def _peaks(
    linkage: SliderCrank, masses: SliderCrankMasses, product: complex, branch: Branch, acceleration: float
) -> tuple[Real, Complex]:
    """Crank angles at which the force has its largest maxima, and sum m a there, without the counterbalance."""
    if linkage.coupler <= linkage.crank + np.abs(linkage.offset):
        raise DesignError(
            "coupler",
            f"found {linkage.coupler:g} mm, so the crank cannot turn fully",
            f"give more than {linkage.crank + np.abs(linkage.offset):g} mm, crank and offset together",
        )
    driven = replace(linkage, driver="crank")
    size = np.abs(_from_crank(driven, masses, LOOKS, branch, acceleration) + product)
    tops = np.flatnonzero((size >= np.roll(size, 1)) & (size >= np.roll(size, -1)))
    tops = tops[np.argsort(-size[tops], kind="stable")[:PEAKS]]
    around = np.concatenate([LOOKS[-1:] - 2 * np.pi, LOOKS, LOOKS[:1] + 2 * np.pi])
    low, high, rows = around[tops], around[tops + 2], np.arange(len(tops))
    for _ in range(NARROWINGS):
        angles = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, 9)
        forces = _from_crank(driven, masses, angles, branch, acceleration)
        top = np.argmax(np.abs(forces + product), axis=1)
        low, high = angles[rows, np.maximum(top - 1, 0)], angles[rows, np.minimum(top + 1, 8)]
    return angles[rows, top] % (2 * np.pi), forces[rows, top]


def _centred(p: Complex, turned: bool) -> complex:
    """The product u that makes the largest |p + u| least, real or complex: the exact optimum over a few points.

    It is decided by one, two or three of the points, at equal distance: all such choices are tried.
    """
    one, two = (np.array(side) for side in zip(*combinations(p, 2))) if len(p) > 1 else (p[:0], p[:0])
    with np.errstate(invalid="ignore", divide="ignore"):
        if turned:
            tries = [-p, -(one + two) / 2, *(_circumcentre(*three) for three in combinations(p, 3))]
        else:
            tries = [-p.real, (np.abs(two) ** 2 - np.abs(one) ** 2) / (2 * (one - two).real)]
    u = np.concatenate([np.atleast_1d(t) for t in tries])
    u = u[np.isfinite(u)]
    best = u[np.argmin(np.abs(p + u[:, None]).max(axis=1))]
    return complex(best) if turned else float(best)


def _circumcentre(a: complex, b: complex, c: complex) -> complex:
    """Less the centre of the circle through three points; not finite where they are in line."""
    b, c = b - a, c - a
    return -(a + 1j * (c * abs(b) ** 2 - b * abs(c) ** 2) / (-2 * np.float64(cross(b, c))))
