"""The deviation that 99.73 % of all linkages keep: linearised, by differences, and by random linkages."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import erfc

import numpy as np

from ...core.records import record
from ...linkage.motion import Motion
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar
from ...linkage.tolerance_analysis import DEVIATIONS, tolerances
from ...plane.vec import Real
from ..family import Method, MethodFamily

# Tolerance of each length, mm, and positions of the crank.
TOLERANCE, FRAMES = 0.1, 36
SIGMA = TOLERANCE / DEVIATIONS
# Share of all linkages that deviate by more.
BEYOND = erfc(DEVIATIONS / np.sqrt(2))
# Nodes of the quadrature over each of three lengths, and steps of the secant; with more, less than 1e-9 rad changes.
NODES, STEPS = 12, 8
LENGTHS = {"ground": 100.0, "crank": 30.0, "coupler": 90.0, "rocker": 70.0}
Call = Callable[[], Real]


@record(eq=False)
class ToleranceProblem:
    """The exact motion of a four-bar, and the right deviation of its rocker at each frame, rad, (frames,)."""

    motion: Motion
    right: Real


def problem() -> ToleranceProblem:
    """A crank-rocker whose four lengths are normally distributed, their tolerance being three standard deviations."""
    motion = move(FourBar(100, 30, 90, 70), np.arange(FRAMES) * (2 * np.pi / FRAMES))
    return ToleranceProblem(motion, exact_deviation(motion.drive, np.angle(motion.rocker.direction)))


def exact_deviation(drive: Real, angle: Real) -> Real:
    """The deviation that a share `BEYOND` of the linkages exceeds, rad, for angles of crank and rocker (frames,).

    With ground, crank and rocker given, the rocker's angle is a monotonic function of the coupler's length, which is
    the distance between the two pins. The share of the couplers beyond it is an error function; its mean over the other
    three lengths follows from Gauss-Hermite quadrature.
    """
    node, weight = np.polynomial.hermite_e.hermegauss(NODES)
    steps, weights = np.array(list(product(node, repeat=3))).T, np.prod(list(product(weight, repeat=3)), axis=1)
    ground, crank, rocker = (LENGTHS[name] + SIGMA * step for name, step in zip(("ground", "crank", "rocker"), steps))
    crank_pin = crank * np.exp(1j * drive[:, None])
    share_beyond = np.vectorize(erfc)

    def excess(deviation: Real) -> Real:
        """Logarithm of the share of the linkages that deviate by more, over that of `BEYOND`."""
        share = np.zeros(len(deviation))
        for sign in (1, -1):
            pin = ground + rocker * np.exp(1j * (angle + sign * deviation)[:, None])
            apart = sign * (np.abs(pin - crank_pin) - LENGTHS["coupler"]) / (np.sqrt(2) * SIGMA)
            # A longer coupler moves the rocker forwards or backwards.
            share += 0.5 * share_beyond(apart * np.sign(apart.mean(axis=1, keepdims=True))) @ weights / weights.sum()
        excess: Real = np.log(share / BEYOND)
        return excess

    before, now = np.full(len(drive), 1.5e-3), np.full(len(drive), 2.5e-3)
    excess_before, excess_now = excess(before), excess(now)
    for _ in range(STEPS):
        change = excess_now - excess_before
        step = excess_now * (now - before) / np.where(change == 0, np.inf, change)
        before, excess_before, now = now, excess_now, now - step
        excess_now = excess(now)
    return now


def _linearised(problem: ToleranceProblem, _: float) -> Call:
    # A motion keeps its derivatives: each call solves it anew.
    given, drive = problem.motion.given, problem.motion.drive
    return lambda: tolerances(move(given, drive), "rocker_angle", TOLERANCE).root_sum_square


def _by_differences(problem: ToleranceProblem, step: float) -> Call:
    steps = 0.5 * step * np.concatenate([np.eye(4), -np.eye(4)])
    ground, crank, coupler, rocker = (length + steps[:, k] for k, length in enumerate(LENGTHS.values()))

    def call() -> Real:
        direction = move(FourBar(ground, crank, coupler, rocker), problem.motion.drive).rocker.direction
        slopes = np.angle(direction[:, :4] * np.conj(direction[:, 4:])) / step
        deviation: Real = TOLERANCE * np.sqrt(np.sum(slopes**2, axis=1))
        return deviation

    return call


def _monte_carlo(problem: ToleranceProblem, linkages: float) -> Call:
    analysis = tolerances(problem.motion, "rocker_angle", TOLERANCE)
    return lambda: analysis.monte_carlo(int(linkages)).largest(1 - BEYOND)


TOLERANCE_BAND: MethodFamily[ToleranceProblem, Real] = MethodFamily(
    name="tolerance",
    title="Tolerance band",
    about="The deviation of the rocker of a crank-rocker of 30, 90, 70 and 100 mm that 99.73 % of all linkages keep, "
    f"each length being {TOLERANCE:g} mm off at three standard deviations; at {FRAMES} positions of the crank.",
    per="position",
    unit="rad",
    reference="the share of the couplers within the deviation in closed form, its mean over ground, crank and rocker "
    f"by quadrature of {NODES} nodes each",
    floor=1e-12,
    problem=problem,
    count=lambda _, found: len(found),
    error=lambda problem, found: np.abs(found - problem.right),
    methods=(
        Method(
            "linearised (geomkin.tolerances)",
            "Root sum square of the exact derivatives by all lengths.",
            _linearised,
            rationale="A thousandth of the error of 100,000 random linkages, in a hundredth of their time.",
            caveat="For a four-bar differences are faster and as exact, but their step has to suit the linkage.",
        ),
        Method(
            "differences",
            "The same with central differences of eight linkages moved at once.",
            _by_differences,
            "step, mm",
            (10.0, 1.0, 0.1, 1e-6, 1e-10),
        ),
        Method(
            "Monte Carlo",
            "Random linkages, each solved exactly, and the deviation that 99.73 % of them keep "
            "(`ToleranceAnalysis.monte_carlo`).",
            _monte_carlo,
            "linkages",
            (100.0, 1e3, 1e4, 1e5),
        ),
    ),
)
