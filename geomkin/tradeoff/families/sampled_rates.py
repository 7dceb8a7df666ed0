"""Velocity and acceleration from positions at even steps, beside the exact ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ...linkage.moving import move
from ...linkage.sampled import central_difference, velocity_difference
from ...plane.vec import Real
from ..family import Method, MethodFamily
from .four_bar_problem import FRAMES, ORDINARY, FourBarProblem

# Samples a call: turns of the crank enough for whatever step, so that all methods are timed on as many.
SAMPLES = 3600
# Values with the step between them, deg: those at 0, step, 2 step and so on.
Sampled = tuple[Real, float]
Call = Callable[[], Sampled]
# Of a plot on paper: its height, and what can be read off it, mm.
PLOT, READ = 200.0, 0.2


def rocker_angles(problem: FourBarProblem, step: float, shift: float = 0.0) -> Real:
    """The rocker's angle, rad, at so many even steps, the first one `shift` steps from 0."""
    drive = np.radians((np.arange(SAMPLES) % round(360 / step) + shift) * step)
    # The rocker swings without passing the cut of the angle.
    angle: Real = np.angle(move(problem.linkage, drive).rocker.direction)
    return angle


def _exact(problem: FourBarProblem, step: float, derivative: int) -> Call:
    drive = np.tile(problem.drive, SAMPLES // FRAMES)

    def call() -> Sampled:
        rocker = move(problem.linkage, drive).rocker
        return (rocker.first if derivative == 1 else rocker.second), 1.0

    return call


def _velocity_difference(problem: FourBarProblem, step: float, derivative: int) -> Call:
    h = float(np.radians(step))

    def call() -> Sampled:
        # From half a step before, so that the middles of the intervals are at whole steps; of those, the middles are.
        found = velocity_difference(rocker_angles(problem, step, -0.5 * derivative), h)
        return (found if derivative == 1 else velocity_difference(found.values, h)).values, step

    return call


def _central(problem: FourBarProblem, step: float, derivative: int, order: int) -> Call:
    h = float(np.radians(step))
    return lambda: (central_difference(rocker_angles(problem, step), h, derivative, order, True).values, step)  # type: ignore[arg-type]


def _spline(problem: FourBarProblem, step: float, derivative: int) -> Call:
    h = float(np.radians(step))
    # Slopes m of the periodic cubic spline solve m[-1] + 4 m + m[1] = 3 (z[1] - z[-1]) / h; its second derivatives
    # M[-1] + 4 M + M[1] = 6 (z[1] - 2 z + z[-1]) / h^2: circles of equations, which Fourier's sums take apart.
    turn = 2 * np.pi * np.arange(SAMPLES // 2 + 1) / SAMPLES
    right = 6j * np.sin(turn) / h if derivative == 1 else 12 * (np.cos(turn) - 1) / h**2
    share = right / (4 + 2 * np.cos(turn))
    return lambda: (np.fft.irfft(np.fft.rfft(rocker_angles(problem, step)) * share, SAMPLES), step)


def _fourier(problem: FourBarProblem, step: float, derivative: int) -> Call:
    count = round(360 / step)
    share = (1j * np.arange(count // 2 + 1)) ** derivative

    def call() -> Sampled:
        # Each turn by itself: its harmonics are those of the motion.
        turns = rocker_angles(problem, step).reshape(-1, count)
        return np.fft.irfft(np.fft.rfft(turns) * share, count).ravel(), step

    return call


def _graphical(problem: FourBarProblem, step: float, derivative: int) -> Call:
    h = np.radians(step)

    def call() -> Sampled:
        read = _drawn(rocker_angles(problem, step))
        for _ in range(derivative):
            # The chord between the neighbouring ordinates for the tangent between them; its slope is drawn again.
            read = _drawn((np.roll(read, -1) - np.roll(read, 1)) / (2 * h))
        return read, step

    return call


def _mid_ordinate(problem: FourBarProblem, step: float, derivative: int) -> Call:
    h = np.radians(step)

    def call() -> Sampled:
        read = _drawn(rocker_angles(problem, step, -0.5 * derivative))
        for _ in range(derivative):
            read = _drawn(np.diff(read) / h)
        return read, step

    return call


def _drawn(values: Real) -> Real:
    """The values as read off a plot of them."""
    low, high = values.min(), values.max()
    grid = READ * (high - low) / PLOT
    read: Real = np.round(values / grid) * grid
    return read


def _error(problem: FourBarProblem, found: Sampled, derivative: int) -> Real:
    values, step = found
    right = (problem.first if derivative == 1 else problem.second)[1]
    # Those at whole degrees, of which the right ones are known.
    frames = np.arange(len(values)) * step
    known = np.flatnonzero(np.abs(frames - np.round(frames)) < 1e-9)
    places = np.round(frames[known]).astype(int) % FRAMES
    off: Real = np.abs(values[known] - right[places]) / np.abs(right).max()
    return off


def _methods(derivative: int) -> tuple[Method[FourBarProblem, Sampled], ...]:
    steps = (10.0, 5.0, 2.0, 1.0, 0.5, 0.1)
    return (
        Method(
            "exact coefficients (geomkin.move)",
            "The library's way: the loop's equations differentiated, not the positions.",
            partial(_exact, derivative=derivative),
            rationale="it is exact at every frame, whatever the step, for about twice the time of the "
            "positions that all other methods start from.",
            caveat="Differences of known positions take less time; this method needs the equations of the motion.",
        ),
        Method(
            "velocity differences",
            "velocity_difference, the mean over each interval" + (", taken twice." if derivative == 2 else "."),
            partial(_velocity_difference, derivative=derivative),
            "step, deg",
            (10.0, 5.0, 2.0, 1.0),
        ),
        *(
            Method(
                f"central differences, order {order}",
                f"central_difference over {order + 1} samples.",
                partial(_central, derivative=derivative, order=order),
                "step, deg",
                steps,
            )
            for order in (2, 4, 6)
        ),
        Method(
            "cubic spline",
            "The periodic cubic spline through all samples, its equations solved by Fourier sums.",
            partial(_spline, derivative=derivative),
            "step, deg",
            steps,
        ),
        Method(
            "Fourier series",
            "The harmonics of each turn, differentiated; for motion that comes again alone.",
            partial(_fourier, derivative=derivative),
            "step, deg",
            steps,
        ),
        Method(
            "tangents drawn",
            f"By hand: ordinates are read off a plot {PLOT:g} mm high to {READ:g} mm, a tangent is the chord of "
            "its two neighbours, and its slope is plotted again. The time is that of the sums, not of the pencil.",
            partial(_graphical, derivative=derivative),
            "step, deg",
            (20.0, 10.0, 5.0, 2.0),
        ),
        Method(
            "mid-ordinates drawn",
            "The same by strips: the slope of each strip's chord is plotted at its mid-ordinate.",
            partial(_mid_ordinate, derivative=derivative),
            "step, deg",
            (20.0, 10.0, 5.0, 2.0),
        ),
    )


def _family(derivative: int, name: str, what: str) -> MethodFamily[FourBarProblem, Sampled]:
    return MethodFamily(
        name=name,
        title=f"{what} from positions",
        about=f"The rocker of a crank-rocker of 30, 90, 70 and 100 mm at {SAMPLES} even steps of the crank: its "
        f"{what.lower()} at a speed of 1 rad/s, from the positions alone or by the exact coefficients. The time of "
        "the positions, by geomkin.move, is in each. Small steps are no cure: below some step the rounding of the "
        "positions grows as fast as the rest falls.",
        per="sample",
        unit="share of the largest",
        reference="circles that meet, differentiated, in decimal arithmetic of 110 digits",
        floor=1e-15,
        problem=lambda: FourBarProblem.of(ORDINARY),
        count=lambda _, found: SAMPLES,
        error=partial(_error, derivative=derivative),
        methods=_methods(derivative),
    )


VELOCITY = _family(1, "velocity-from-positions", "Velocity")
ACCELERATION = _family(2, "acceleration-from-positions", "Acceleration")
