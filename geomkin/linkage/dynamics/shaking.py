"""Shaking force of the slider-crank, and the counterbalance that minimises it."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from ...core.arguments import checked
from ...core.errors import DesignError
from ...core.fields import FARTHEST, ComplexPoint, entry, inside, quantity
from ...core.records import record
from ...core.units import mm
from ...plane.vec import Complex, Real, cross
from ..motion import Motion
from ..moving import move
from ..named_linkages import SliderCrank
from ..solve.branch import Branch

# kg mm/s2 in N.
NEWTON = 1e-3
# Crank angles of the first scan for the largest force. They must include +-90 deg, at which the force of a rod scarcely
# longer than the crank has a peak narrower than any spacing.
LOOKS = np.arange(720) * np.pi / 360
# Largest number of peaks examined; if the force is nearly constant rounding makes hundreds.
PEAKS = 8
# Number of times that a peak is narrowed, each to a quarter.
NARROWINGS = 16
# Relative excess of the largest force over that at the deciding angles at which the search ends.
SETTLED = 1e-12
# Largest number of exchanges of the deciding angles; five to twenty are usual.
ROUNDS = 100


@record(checked=True)
class SliderCrankMasses:
    """Masses of a slider-crank and their centres, each in its body's frame.

    The force is that of rigid bodies. A rod lumped at its two pins with the same centre of mass gives the same force,
    so that there is no such option; for a crank given by its imbalance in kg mm, use 1 kg at that many mm.

    Parameters
    ----------
    crank, coupler, slider : float
        Masses of crank, connecting rod and slider, kg; at least 0.
    crank_centre : complex
        Crank's centre of mass, mm from its pivot, x towards the crank pin.
    coupler_centre : complex
        Rod's centre of mass, mm from the crank pin, x towards the slider pin.
    """

    crank: float = quantity("mass of the crank", "kg", default=0.0, at_least=0, at_most=FARTHEST, example=0.5)
    coupler: float = quantity(
        "mass of the connecting rod", "kg", default=0.0, at_least=0, at_most=FARTHEST, example=0.6
    )
    slider: float = quantity("mass of the slider", "kg", default=0.0, at_least=0, at_most=FARTHEST, example=0.8)
    crank_centre: ComplexPoint = entry(
        "crank's centre of mass, from its pivot, x to the crank pin, [x, y] in mm", default=0j, example=10 + 0j
    )
    coupler_centre: ComplexPoint = entry(
        "rod's centre of mass, from the crank pin, x to the slider pin, [x, y] in mm", default=0j, example=30 + 0j
    )


@record(eq=False)
class Counterbalance:
    """A counterbalance and the largest shaking force it leaves, over the whole turn.

    Parameters
    ----------
    product : complex
        Mass times radius, kg mm, opposite the crank pin; its angle is counterclockwise from there.
    largest : float
        N at 1 rad/s; multiply by the speed squared.
    angles : array
        Angles of the crank from the slide line, rad, at which that force is reached.
    """

    product: complex
    largest: float
    angles: Real


@checked
def shaking_force(motion: Motion, masses: SliderCrankMasses, counterbalance: complex = 0.0) -> Complex:
    """Force of a slider-crank's moving parts on the frame: -sum m a of their centres of mass.

    Parameters
    ----------
    motion : Motion
        Motion of a slider-crank.
    masses : SliderCrankMasses
        The masses.
    counterbalance : complex
        Mass times radius, kg mm, as in `Counterbalance`.

    Returns
    -------
    array of complex, shape (frames,)
        N; nan where the linkage is open.

    Raises
    ------
    DesignError
        If the motion is of another linkage.

    Notes
    -----
    Derived here.
    """
    if not {"crank", "coupler", "slider"} <= set(motion.bodies):
        raise DesignError(
            "motion", f"its bodies are {', '.join(motion.bodies)}", "give the motion of a slider-crank", "wrong-type"
        )
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
    """The largest force that a given counterbalance leaves, over all crank angles, not only sampled ones.

    Parameters
    ----------
    linkage : SliderCrank
        Its crank must turn fully.
    masses : SliderCrankMasses
        The masses.
    product : complex
        Mass times radius of the counterbalance, kg mm.
    branch : {+1, -1, "follow"}, mapping or Continuation
        Branch of the slider-crank driven by its crank.
    acceleration : float
        Angular acceleration of the crank over its speed squared, the same at every angle.

    Returns
    -------
    Counterbalance

    Raises
    ------
    DesignError
        If the crank does not turn fully.

    Notes
    -----
    Derived here.
    """
    angles, forces = _peaks(linkage, masses, product, branch, acceleration)
    sizes = np.abs(forces + product) * abs(1 - 1j * acceleration)
    return Counterbalance(product, NEWTON * float(sizes.max()), angles[sizes >= (1 - 1e-9) * sizes.max()])


@checked
def best_counterbalance(
    linkage: SliderCrank, masses: SliderCrankMasses, branch: Branch = 1, turned: bool = False, acceleration: float = 0.0
) -> Counterbalance:
    """The counterbalance that minimises the largest shaking force over the turn.

    Parameters
    ----------
    linkage, masses, branch, acceleration
        As for `judged_counterbalance`.
    turned : bool
        Whether the counterbalance may be at any angle to the crank (complex product); otherwise it is along the crank,
        its product real, negative on the pin's side.

    Returns
    -------
    Counterbalance
        Its largest force is accurate to 1e-11 of the force without a counterbalance.

    Raises
    ------
    DesignError
        If the crank does not turn fully.

    Notes
    -----
    In the crank's frame, divided by the force of 1 kg mm, the force runs along a closed curve and a
    counterbalance shifts it, so the best one is minus the centre of the smallest circle around the curve. It is found
    by exchange: the circle around a few points exactly, then the curve's farthest points join them, until none is
    outside. Derived here.
    """
    points = _peaks(linkage, masses, 0.0, branch, acceleration)[1]
    size = float(np.abs(points).max())
    for _ in range(ROUNDS):
        product = _centred(points, turned)
        forces = _peaks(linkage, masses, product, branch, acceleration)[1]
        far, radius = np.abs(forces + product), np.abs(points + product).max()
        if far.max() <= radius + SETTLED * size:
            break
        deciding = points[np.abs(points + product) >= (1 - 1e-6) * radius]
        points = np.concatenate([deciding, forces[far > radius]])
    return judged_counterbalance(linkage, masses, product, branch, acceleration)


def _from_crank(
    linkage: SliderCrank, masses: SliderCrankMasses, angles: Real, branch: Branch, acceleration: float
) -> Complex:
    """sum m a in the crank's frame over that of 1 kg mm on the crank: a counterbalance adds its product to it."""
    motion = move(linkage, angles.ravel(), branch, 1.0, acceleration)
    force = shaking_force(motion, masses) / -NEWTON / (1 - 1j * acceleration)
    return (force * np.conj(motion.bodies["crank"].direction)).reshape(angles.shape)


def _peaks(
    linkage: SliderCrank, masses: SliderCrankMasses, product: complex, branch: Branch, acceleration: float
) -> tuple[Real, Complex]:
    """Crank angles at which the force has its largest maxima, and sum m a there, without the counterbalance."""
    if linkage.coupler <= (least := float(linkage.crank + np.abs(linkage.offset))):
        problem = f"found {mm(linkage.coupler):g}, so the crank cannot turn fully"
        remedy = f"give more than {mm(least):up}, crank and offset together"
        raise DesignError("coupler", problem, remedy, value=inside(least, -1))
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
    """The product u that minimises the largest |p + u|, real or complex: the exact optimum over a few points.

    It is decided by one, two or three of the points, at equal distance: all combinations are tried.
    """
    one, two = (np.array(side) for side in zip(*combinations(p, 2))) if len(p) > 1 else (p[:0], p[:0])
    with np.errstate(invalid="ignore", divide="ignore"):
        if turned:
            tries = [-p, -(one + two) / 2, *(_negative_circumcentre(*three) for three in combinations(p, 3))]
        else:
            tries = [-p.real, (np.abs(two) ** 2 - np.abs(one) ** 2) / (2 * (one - two).real)]
    u = np.concatenate([np.atleast_1d(t) for t in tries])
    u = u[np.isfinite(u)]
    best = u[np.argmin(np.abs(p + u[:, None]).max(axis=1))]
    return complex(best) if turned else float(best)


def _negative_circumcentre(a: complex, b: complex, c: complex) -> complex:
    """Minus the centre of the circle through three points; not finite if they are in line."""
    b, c = b - a, c - a
    return -(a + 1j * (c * abs(b) ** 2 - b * abs(c) ** 2) / (-2 * np.float64(cross(b, c))))
