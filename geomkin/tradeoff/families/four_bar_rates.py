"""Velocity and acceleration coefficients of a four-bar, of an ordinary one and of one that comes near a toggle."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...linkage.moving import move, placements_for
from ...linkage.named_linkages import FourBar
from ...linkage.solve.branch import as_branch_spec
from ...linkage.solve.input_dyads import CrankDriven
from ...linkage.solve.solution import LinkageSolution
from ...plane.vec import Real
from ..family import Method, MethodFamily
from .four_bar_problem import (
    FRAMES,
    LIBRARY,
    NEAR_TOGGLE,
    ORDINARY,
    STEADY,
    Directions,
    FourBarProblem,
    by_toggle_proof_form,
    by_unit_vectors,
    closing_gaps,
)

# First and second derivatives of the angles of coupler and rocker by the crank's: h3, h4, h3', h4'.
Rates = tuple[Real, Real, Real, Real]
Call = Callable[[], Rates]


def _library(problem: FourBarProblem, _: float) -> Call:
    def call() -> Rates:
        motion = move(problem.linkage, problem.drive)
        return motion.coupler.first, motion.rocker.first, motion.coupler.second, motion.rocker.second

    return call


def _general_dyad(problem: FourBarProblem, _: float) -> Call:
    general = problem.linkage.linkage
    steps = tuple(
        placement.dyad if isinstance(placement, CrankDriven) else placement for placement in placements_for(general, 1)
    )

    def call() -> Rates:
        solution = LinkageSolution(general, lambda: steps, problem.drive, as_branch_spec(1), STEADY)
        first, second = ((solution.value(k, "coupler"), solution.value(k, "rocker")) for k in ("first", "second"))
        return *first, *second

    return call


def _toggle_proof(problem: FourBarProblem, _: float) -> Call:
    a, b, c, d = problem.lengths
    one, two = closing_gaps(a, b, c, d)
    k = 2 * np.sqrt(a * d)

    def call() -> Rates:
        half = 0.5 * problem.drive
        x, y = k * np.cos(half), k * np.sin(half)
        f1, f2 = np.sqrt(one + x * x), np.sqrt(two + y * y)
        s = (d - a) ** 2 + y * y
        p = 0.5 + (b - c) * (b + c) / (2 * s)
        psi = (y * y - 2 * a * (d - a)) / (2 * s)
        g1, g2 = x / f1, y / f2
        tau = g1 * g2
        turn = 0.5 * (two * x / f2**3 * g1 - one * y / f1**3 * g2)
        # (a d sin t / s)(1 - 2 psi + (1 - 2 p) tau), which has no difference that vanishes.
        shared = (x * y) / (2 * s * s) * ((d - a) * (d + a) - (b - c) * (b + c) * tau)
        return psi - (1 - p) * tau, psi + p * tau, shared - (1 - p) * turn, shared + p * turn

    return call


def _loop_equations(problem: FourBarProblem, _: float) -> Call:
    a, b, c, d = problem.lengths
    return lambda: _by_loop(a, b, c, problem.drive, by_unit_vectors(a, b, c, d, problem.drive))


def _loop_after_toggle_proof(problem: FourBarProblem, _: float) -> Call:
    a, b, c, _d = problem.lengths
    return lambda: _by_loop(a, b, c, problem.drive, by_toggle_proof_form(problem.lengths, problem.drive))


def _by_loop(a: float, b: float, c: float, drive: Real, directions: Directions) -> Rates:
    """The loop's equation differentiated once and twice: two linear equations each."""
    crank, bar, arm = a * np.exp(1j * drive), b * directions[0], c * directions[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = 1 / (bar.real * arm.imag - bar.imag * arm.real)
        h3 = (arm.real * crank.imag - arm.imag * crank.real) * share
        h4 = (bar.real * crank.imag - bar.imag * crank.real) * share
        pull = crank + h3 * h3 * bar - h4 * h4 * arm
        return (
            h3,
            h4,
            (pull.real * arm.real + pull.imag * arm.imag) * share,
            (pull.real * bar.real + pull.imag * bar.imag) * share,
        )


def _single(problem: FourBarProblem, _: float) -> Call:
    a, b, c, d = (np.float32(v) for v in problem.lengths)
    drive = problem.drive.astype(np.float32)

    def call() -> Rates:
        px, py = a * np.cos(drive), a * np.sin(drive)
        ux, uy = d - px, -py
        square = ux * ux + uy * uy
        along = (square + (b - c) * (b + c)) / (2 * square)
        with np.errstate(invalid="ignore", divide="ignore"):
            beside = np.sqrt(b * b / square - along * along)
            bx, by = along * ux - beside * uy, along * uy + beside * ux
            cx, cy = bx - ux, by - uy
            share = 1 / (bx * cy - by * cx)
            h3, h4 = (cx * py - cy * px) * share, (bx * py - by * px) * share
            wx, wy = px + h3 * h3 * bx - h4 * h4 * cx, py + h3 * h3 * by - h4 * h4 * cy
            return h3, h4, (wx * cx + wy * cy) * share, (wx * bx + wy * by) * share

    return call


def _differences(problem: FourBarProblem, step: float) -> Call:
    h = np.radians(step)
    around = problem.drive + h * np.array([-2, -1, 0, 1, 2])[:, None]

    def call() -> Rates:
        turned = by_toggle_proof_form(problem.lengths, around)
        found: list[Real] = []
        for z in turned:
            # Angles from the middle one, which has no jump by a turn.
            w = np.angle(z * np.conj(z[2]))
            found += [
                (w[0] - w[4] + 8 * (w[3] - w[1])) / (12 * h),
                (16 * (w[1] + w[3]) - w[0] - w[4]) / (12 * h * h),
            ]
        return found[0], found[2], found[1], found[3]

    return call


def _error(problem: FourBarProblem, found: Rates) -> Real:
    off = np.zeros(FRAMES)
    for rate, right in zip(found, (*problem.first, *problem.second)):
        off = np.maximum(off, np.abs(rate - right) / np.maximum(1.0, np.abs(right)))
    # What is wrong by more than itself, or no number, was not found.
    return np.where(off <= 1, off, np.nan)


METHODS: tuple[Method[FourBarProblem, Rates], ...] = (
    Method("geomkin.move", LIBRARY.about, _library, rationale=LIBRARY.rationale, caveat=LIBRARY.caveat),
    Method(
        "toggle-proof form, plain NumPy",
        "Derivatives of the toggle-proof form, in factors as that is (derived for geomkin).",
        _toggle_proof,
    ),
    Method(
        "general dyad solver",
        "The library's solver of two bars between any two moving points, and its loop equations.",
        _general_dyad,
    ),
    Method(
        "loop equations on unit vectors",
        "Positions by unit vectors, then the loop's equation differentiated: two linear equations for the "
        "velocities and two for the accelerations, as in the textbooks.",
        _loop_equations,
    ),
    Method(
        "loop equations, exact positions",
        "The same from positions by the toggle-proof form: the digits that the equations themselves lose.",
        _loop_after_toggle_proof,
    ),
    Method("single precision", "Unit vectors and loop equations in 32-bit numbers.", _single),
    Method(
        "differences of positions",
        "Five positions by the toggle-proof form around each frame, and central differences of order 4.",
        _differences,
        "step, deg",
        (5.0, 1.0, 0.2, 0.05, 0.01),
    ),
)


def _family(name: str, title: str, about: str, linkage: FourBar) -> MethodFamily[FourBarProblem, Rates]:
    return MethodFamily(
        name=name,
        title=title,
        about=f"{about} Found are the first and second derivatives of the angles of coupler and rocker by the crank's "
        f"at {FRAMES} even steps of a whole turn, which are velocities and accelerations at a speed of 1 rad/s. The "
        "error is that of the worst of the four, as a share of the value, or of 1 where that is larger; what is off by "
        "more than itself counts as missed.",
        per="pose",
        unit="share of the value",
        reference="circles that meet, differentiated, in decimal arithmetic of 110 digits",
        floor=1e-15,
        problem=lambda: FourBarProblem.of(linkage),
        count=lambda _, found: len(found[0]),
        error=_error,
        methods=METHODS,
    )


RATES = _family(
    "four-bar-rates",
    "Velocity and acceleration of a four-bar",
    "A crank-rocker of 30, 90, 70 and 100 mm, which stays away from its toggles.",
    ORDINARY,
)
TOGGLE_RATES = _family(
    "four-bar-toggle-rates",
    "Velocity and acceleration of a four-bar near its toggle",
    "The four-bar that once a turn comes to lie nearly on one line.",
    NEAR_TOGGLE,
)
