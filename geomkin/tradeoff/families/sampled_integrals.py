"""Positions back from velocities at even steps: integration, beside the exact positions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...linkage.moving import move
from ...linkage.sampled import mid_ordinate_integral
from ...plane.vec import Real
from ..family import Method, MethodFamily
from .four_bar_problem import FRAMES, ORDINARY, FourBarProblem

# Positions a call: turns of the crank enough for whatever step, so that all methods are timed on as many.
SAMPLES = 3600
# Positions with the step between them, deg, from the crank's 0 on.
Way = tuple[Real, float]
Call = Callable[[], Way]


def _velocities(problem: FourBarProblem, step: float, shift: float = 0.0) -> Real:
    return move(problem.linkage, np.radians((np.arange(SAMPLES) % round(360 / step) + shift) * step)).rocker.first


def _start(problem: FourBarProblem) -> float:
    return float(np.angle(problem.directions[1][0]))


def _exact(problem: FourBarProblem, _: float) -> Call:
    drive = np.tile(problem.drive, SAMPLES // FRAMES)
    return lambda: (np.angle(move(problem.linkage, drive).rocker.direction), 1.0)


def _mid_ordinates(problem: FourBarProblem, step: float) -> Call:
    rates, start = _velocities(problem, step, 0.5), _start(problem)
    return lambda: (mid_ordinate_integral(rates, float(np.radians(step)), start).values[:-1], step)


def _trapezoid(problem: FourBarProblem, step: float) -> Call:
    rates, start, h = _velocities(problem, step), _start(problem), np.radians(step)

    def call() -> Way:
        way = np.empty(SAMPLES)
        way[0] = start
        np.cumsum(0.5 * h * (rates[1:] + rates[:-1]), out=way[1:])
        way[1:] += start
        return way, step

    return call


def _simpson(problem: FourBarProblem, step: float) -> Call:
    rates, start, h = _velocities(problem, step), _start(problem), np.radians(step)

    def call() -> Way:
        # Over two strips, at every second sample.
        strips = (h / 3) * (rates[:-2:2] + 4 * rates[1:-1:2] + rates[2::2])
        return np.concatenate([[start], start + np.cumsum(strips)]), 2 * step

    return call


def _corrected(problem: FourBarProblem, step: float) -> Call:
    rates, start, h = _velocities(problem, step), _start(problem), np.radians(step)

    def call() -> Way:
        bend = (np.roll(rates, -1) - np.roll(rates, 1)) / 2
        strips = 0.5 * (rates[1:] + rates[:-1]) - (bend[1:] - bend[:-1]) / 12
        return np.concatenate([[start], start + h * np.cumsum(strips)]), step

    return call


def _fourier(problem: FourBarProblem, step: float) -> Call:
    count = round(360 / step)
    rates, start = _velocities(problem, step), _start(problem)
    share = np.zeros(count // 2 + 1, dtype=complex)
    share[1:] = 1 / (1j * np.arange(1, count // 2 + 1))

    def call() -> Way:
        way = np.fft.irfft(np.fft.rfft(rates.reshape(-1, count)) * share, count).ravel()
        return way + (start - way[0]), step

    return call


def _error(problem: FourBarProblem, found: Way) -> Real:
    values, step = found
    right = np.angle(problem.directions[1])
    frames = np.arange(len(values)) * step
    known = np.flatnonzero(np.abs(frames - np.round(frames)) < 1e-9)
    off: Real = np.abs(values[known] - right[np.round(frames[known]).astype(int) % FRAMES])
    return off


STEPS = (10.0, 5.0, 2.0, 1.0, 0.5, 0.1)
INTEGRATION: MethodFamily[FourBarProblem, Way] = MethodFamily(
    name="positions-from-velocities",
    title="Positions from velocities",
    about=f"The rocker of a crank-rocker of 30, 90, 70 and 100 mm at {SAMPLES} even steps of the crank: its angle by "
    "adding up its velocities, which were got ready beforehand, from a known start; and exactly. At the coarser steps "
    "these are many turns, over which errors come back to nothing or add up.",
    per="sample",
    unit="rad",
    reference="circles that meet, in decimal arithmetic of 110 digits",
    floor=1e-15,
    problem=lambda: FourBarProblem.of(ORDINARY),
    count=lambda _, found: len(found[0]),
    error=_error,
    methods=(
        Method(
            "exact positions (geomkin.move)",
            "The library's way: positions come from the sizes, not from velocities.",
            _exact,
            rationale="each position is independent, so that errors do not add up, and no velocities are needed.",
            caveat="Integrating known velocities takes less time, but it is meant for measured motion.",
        ),
        Method(
            "mid-ordinates",
            "mid_ordinate_integral, velocities taken in the middles of the steps.",
            _mid_ordinates,
            "step, deg",
            STEPS,
        ),
        Method("trapezoids", "Straight lines between the velocities.", _trapezoid, "step, deg", STEPS),
        Method("Simpson's rule", "Parabolas over two steps, with a position at each second sample.", _simpson,
               "step, deg", STEPS),
        Method(
            "trapezoids with end correction",
            "Trapezoids less the bend of each, from the velocities' own differences (Gregory).",
            _corrected,
            "step, deg",
            STEPS,
        ),
        Method(
            "Fourier series",
            "The harmonics of each turn, integrated; for motion that comes again alone.",
            _fourier,
            "step, deg",
            STEPS,
        ),
    ),
)  # fmt: skip
