"""Derivatives of a four-bar's coupler point by its lengths: exact, by a complex step and by differences."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from functools import partial
from typing import Any

import numpy as np

from ...core.records import record
from ...linkage.moving import move
from ...plane.vec import Array, Complex, Real
from ..exact import FRAMES, coupler_point, many_digits
from ..family import Method, MethodFamily
from .new_lengths import COUPLER_POINT, REFERENCE_STEP, four_bar

SIZES = ("ground", "crank", "coupler", "rocker")
LENGTHS = np.array([100.0, 30.0, 90.0, 70.0])
# Steps, mm: of the differences in decimals, whose error is its square, and of the complex step, which takes no
# difference and so may be as small as numbers are.
DECIMAL_STEP, COMPLEX_STEP = Decimal("1e-25"), 1e-30
# Weights of central differences, by the number of steps.
WEIGHTS = {2: {1: 1 / 2}, 4: {1: 2 / 3, 2: -1 / 12}}
STEPS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
Call = Callable[[], Complex]


@record(eq=False)
class DerivativesProblem:
    """drive: crank angles, rad, (frames,); right: derivatives at every `REFERENCE_STEP`-th frame, (sizes, frames)."""

    drive: Real
    right: Complex

    @classmethod
    def example(cls) -> DerivativesProblem:
        """Its derivatives by central differences in decimals."""
        drive = np.arange(FRAMES) * (2 * np.pi / FRAMES)
        right = np.empty((len(SIZES), FRAMES // REFERENCE_STEP), dtype=complex)
        with many_digits():
            for j in range(len(SIZES)):
                above, below = ([Decimal(v) for v in LENGTHS.tolist()] for _ in range(2))
                above[j] += DECIMAL_STEP
                below[j] -= DECIMAL_STEP
                for k, angle in enumerate(drive[::REFERENCE_STEP].tolist()):
                    one, other = (coupler_point(lengths, COUPLER_POINT, angle).at for lengths in (above, below))
                    rate = (one - other).times(1 / (2 * DECIMAL_STEP))
                    right[j, k] = complex(rate.x, rate.y)
        return cls(drive, right)


def _library(problem: DerivativesProblem, _: float) -> Call:
    def call() -> Complex:
        motion = move(four_bar(LENGTHS.tolist()), problem.drive)
        return np.array([motion.sensitivity("coupler_point", by=size) for size in SIZES])

    return call


def _loop_equation(problem: DerivativesProblem, _: float) -> Call:
    ground, crank, coupler, rocker = LENGTHS.tolist()

    def call() -> Complex:
        turn = np.exp(1j * problem.drive)
        diagonal = ground - crank * turn
        square = diagonal.real**2 + diagonal.imag**2
        along = 0.5 + 0.5 * (coupler**2 - rocker**2) / square
        bar = diagonal * (along + 1j * np.sqrt(coupler**2 / square - along**2))
        arm = bar - diagonal
        coupler_direction = bar / coupler
        # crank + coupler - rocker - ground = 0, differentiated by each length.
        right = np.array([np.ones(FRAMES), -turn, -coupler_direction, arm / rocker])
        rotation = (np.conj(arm) * right).real / (np.conj(bar) * arm).imag
        rates: Complex = 1j * COUPLER_POINT * coupler_direction * rotation
        rates[1] += turn
        return rates

    return call


def real_coordinates(lengths: Array, drive: Real) -> tuple[Array, Array]:
    """Coordinates of the coupler point, mm, for lengths (4, ...): the intersection of two circles, in real arithmetic.

    Every operation is analytic, so that lengths may be complex numbers.
    """
    ground, crank, coupler, rocker = lengths
    pin_x, pin_y = crank * np.cos(drive), crank * np.sin(drive)
    x, y = ground - pin_x, -pin_y
    square = x * x + y * y
    along = 0.5 + 0.5 * (coupler * coupler - rocker * rocker) / square
    beside = np.sqrt(coupler * coupler / square - along * along)
    bar_x, bar_y = (along * x - beside * y) / coupler, (along * y + beside * x) / coupler
    local_x, local_y = COUPLER_POINT.real, COUPLER_POINT.imag
    return pin_x + local_x * bar_x - local_y * bar_y, pin_y + local_x * bar_y + local_y * bar_x


def _complex_step(problem: DerivativesProblem, _: float) -> Call:
    # Lengths by the size that has the step: (4, sizes, 1).
    lengths = (LENGTHS[:, None] + COMPLEX_STEP * 1j * np.eye(len(SIZES)))[:, :, None]

    def call() -> Complex:
        x, y = real_coordinates(lengths, problem.drive)
        rates: Complex = (x.imag + 1j * y.imag) / COMPLEX_STEP
        return rates

    return call


def _by_formula(lengths: Real, drive: Real) -> Complex:
    x, y = real_coordinates(lengths[..., None], drive)
    z: Complex = x + 1j * y
    return z


def _by_move(lengths: Real, drive: Real) -> Complex:
    many = four_bar(lengths.reshape(len(SIZES), -1))
    position = move(many, drive).point("coupler_point").position
    return position.T.reshape(*lengths.shape[1:], -1)


def _central(problem: DerivativesProblem, share: float, order: int, point: Callable[[Real, Real], Complex]) -> Call:
    steps = share * LENGTHS
    weights = WEIGHTS[order]
    # (4, offsets, sizes)
    lengths = np.stack([LENGTHS[:, None] + k * np.diag(steps) for j in weights for k in (j, -j)], axis=1)

    def call() -> Complex:
        z = point(lengths, problem.drive)
        differences: Any = sum(weight * (z[2 * k] - z[2 * k + 1]) for k, weight in enumerate(weights.values()))
        rates: Complex = differences / steps[:, None]
        return rates

    return call


def _error(problem: DerivativesProblem, found: Complex) -> Real:
    off: Real = np.abs(found[:, ::REFERENCE_STEP] - problem.right) / np.abs(problem.right).max(axis=1)[:, None]
    return off.ravel()


DERIVATIVES = MethodFamily(
    name="derivatives",
    title="Derivatives of a coupler point by the lengths",
    about="A crank-rocker of 30, 90, 70 and 100 mm, made and moved at each call. Found are the derivatives of the "
    f"position of a coupler point by each of the four lengths, at {FRAMES} even steps of a whole turn, as a search by "
    "gradients needs them. Small steps are no cure for differences: below some step the rounding of the positions "
    "grows faster than the rest falls.",
    per="derivative",
    unit="share of the largest",
    reference="central differences in decimal arithmetic of 110 digits, with a step of 1e-25 mm",
    floor=1e-15,
    problem=DerivativesProblem.example,
    count=lambda _, found: found.size,
    error=_error,
    methods=(
        Method(
            "motion.sensitivity",
            "The conditions of all joints, differentiated: a linear system at each pose (implicit function theorem).",
            _library,
            rationale="it is exact for any quantity, size and linkage, and chooses no step.",
            caveat="A formula derived by hand for this one linkage takes less time.",
        ),
        Method(
            "loop equation by hand, plain NumPy",
            "The loop equation of this one linkage, differentiated by each length on paper, without checks.",
            _loop_equation,
        ),
        Method(
            "complex step",
            f"A formula in real coordinates, with an imaginary step of {COMPLEX_STEP:g} mm in each length. The formula "
            "may have no absolute values and no complex numbers of its own.",
            _complex_step,
        ),
        *(
            Method(
                f"central differences, order {order}",
                f"{order} evaluations of the same formula in real coordinates for each length.",
                partial(_central, order=order, point=_by_formula),
                "step, share of the length",
                STEPS,
            )
            for order in WEIGHTS
        ),
        Method(
            "central differences of geomkin.move",
            "One motion of eight four-bars, whose lengths are arrays: each length a step longer and shorter.",
            partial(_central, order=2, point=_by_move),
            "step, share of the length",
            STEPS,
        ),
    ),
)
