"""Coupler points of four-bars that have new lengths at each call, as in searches, sweeps and tolerances."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ...core.records import record
from ...linkage.moving import move
from ...linkage.named_linkages import FourBar
from ...plane.vec import Complex, Real
from ..exact import FRAMES, coupler_point, many_digits
from ..family import Method, MethodFamily

LINKAGES = 10
COUPLER_POINT = 40 + 25j
# Frames from one with a reference to the next; one takes a millisecond for each linkage.
REFERENCE_STEP = 6
Call = Callable[[], Complex]


@record(eq=False)
class LengthsProblem:
    """lengths: ground, crank, coupler, rocker, mm, (linkages, 4); drive: crank angles, rad, (frames,).

    right: position of the coupler point and its first and second derivative by the crank angle, at every
    `REFERENCE_STEP`-th frame, (linkages, 3, frames).
    """

    lengths: Real
    drive: Real
    right: Complex

    @classmethod
    def example(cls) -> LengthsProblem:
        """Crank-rockers with random lengths."""
        lengths = np.array([100.0, 30.0, 90.0, 70.0]) + 10 * np.random.default_rng(1).random((LINKAGES, 4))
        drive = np.arange(FRAMES) * (2 * np.pi / FRAMES)
        right = np.empty((LINKAGES, 3, FRAMES // REFERENCE_STEP), dtype=complex)
        with many_digits():
            for j, sizes in enumerate(lengths.tolist()):
                for k, angle in enumerate(drive[::REFERENCE_STEP].tolist()):
                    point = coupler_point(sizes, COUPLER_POINT, angle)
                    right[j, :, k] = [complex(z.x, z.y) for z in (point.at, point.first, point.second)]
        return cls(lengths, drive, right)


def four_bar(lengths: Any) -> FourBar:
    """The four-bar of ground, crank, coupler and rocker, mm."""
    ground, crank, coupler, rocker = lengths
    return FourBar(ground, crank, coupler, rocker, COUPLER_POINT)


def _library(problem: LengthsProblem, _: float) -> Call:
    def call() -> Complex:
        points = [move(four_bar(sizes), problem.drive).point("coupler_point")
                  for sizes in problem.lengths.tolist()]  # fmt: skip
        return np.array([(point.position, point.first, point.second) for point in points])

    return call


def _library_at_once(problem: LengthsProblem, _: float) -> Call:
    def call() -> Complex:
        point = move(four_bar(problem.lengths.T), problem.drive).point("coupler_point")
        return np.array([point.position, point.first, point.second]).transpose(2, 0, 1)

    return call


def _textbook(problem: LengthsProblem, _: float) -> Call:
    return lambda: np.array([intersected_circles(sizes, problem.drive) for sizes in problem.lengths.tolist()])


def _textbook_at_once(problem: LengthsProblem, _: float) -> Call:
    columns = problem.lengths.T[:, :, None]
    return lambda: np.array(intersected_circles(columns, problem.drive)).transpose(1, 0, 2)


def _single(problem: LengthsProblem, _: float) -> Call:
    lengths, drive = problem.lengths.astype(np.float32), problem.drive.astype(np.float32)
    return lambda: np.array([intersected_circles(sizes, drive) for sizes in lengths])


def _frame_by_frame(problem: LengthsProblem, _: float) -> Call:
    drive = problem.drive.tolist()

    def call() -> Complex:
        frames = [
            [intersected_circles(sizes, angle, cmath.exp, math.sqrt) for angle in drive]
            for sizes in problem.lengths.tolist()
        ]
        return np.array(frames).transpose(0, 2, 1)

    return call


def intersected_circles(lengths: Any, drive: Any, exp: Any = np.exp, sqrt: Any = np.sqrt) -> tuple[Any, Any, Any]:
    """Position of the coupler point and its first and second derivative by the crank angle, as in textbooks.

    Two circles intersect in the rocker pin; the loop equation is differentiated once and twice.
    """
    ground, crank, coupler, rocker = lengths
    crank_pin = crank * exp(1j * drive)
    diagonal = ground - crank_pin
    square = diagonal.real * diagonal.real + diagonal.imag * diagonal.imag
    along = 0.5 + 0.5 * (coupler * coupler - rocker * rocker) / square
    bar = diagonal * (along + 1j * sqrt(coupler * coupler / square - along * along))
    arm = bar - diagonal
    bar_conjugate, arm_conjugate = bar.conjugate(), arm.conjugate()
    determinant = (bar_conjugate * arm).imag
    h3, h4 = (arm_conjugate * crank_pin).imag / determinant, (bar_conjugate * crank_pin).imag / determinant
    h3_prime = (arm_conjugate * (crank_pin + h3 * h3 * bar - h4 * h4 * arm)).real / determinant
    local = COUPLER_POINT / coupler * bar
    return crank_pin + local, 1j * (crank_pin + h3 * local), (1j * h3_prime - h3 * h3) * local - crank_pin


def _error(problem: LengthsProblem, found: Complex) -> Real:
    off = np.abs(found[:, :, ::REFERENCE_STEP] - problem.right) / np.abs(problem.right).max(axis=(0, 2))[:, None]
    worst: Real = off.max(axis=1).ravel()
    return worst


NEW_LENGTHS = MethodFamily(
    name="new-lengths",
    title="Four-bars of new lengths",
    about=f"{LINKAGES} crank-rockers of random lengths, about 105, 35, 95 and 75 mm, made and moved one after the "
    f"other. Found are position, velocity and acceleration of a coupler point at {FRAMES} even steps of a whole turn "
    "at a speed of 1 rad/s. The error is that of the worst of the three, as a share of its largest value.",
    per="pose",
    unit="share of the largest",
    reference="circles that meet, differentiated, in decimal arithmetic of 110 digits, "
    f"at every {REFERENCE_STEP}th pose",
    floor=1e-15,
    problem=LengthsProblem.example,
    count=lambda _, found: found.shape[0] * found.shape[2],
    error=_error,
    methods=(
        Method(
            "geomkin.move",
            "A FourBar is made and moved for each set of lengths; its formulas are recorded once for all.",
            _library,
            rationale="one call serves any linkage, checks its sizes, and keeps all digits near toggles.",
            caveat="The rest is the overhead of a call, which matters less with more poses per call; "
            "arrays of lengths avoid it.",
        ),
        Method(
            "geomkin.move, arrays of lengths", "One FourBar whose lengths are arrays, moved once.", _library_at_once
        ),
        Method(
            "plain NumPy",
            "The textbooks' formulas for this one linkage, without checks: two circles intersect in the rocker pin, "
            "and the loop equation is differentiated once and twice.",
            _textbook,
        ),
        Method(
            "plain NumPy, arrays of lengths",
            "The same formulas once for all lengths.",
            _textbook_at_once,
        ),
        Method("single precision", "The same formulas for one linkage after the other in 32-bit numbers.", _single),
        Method(
            "frame by frame",
            "The same formulas with Python's own complex numbers, one pose after the other.",
            _frame_by_frame,
            slow=True,
        ),
    ),
)
