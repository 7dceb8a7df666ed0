"""Velocity and acceleration from positions at even steps, and positions from velocities, compared with exact ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.records import record
from ...linkage.moving import move
from ...linkage.sampled import central_difference, mid_ordinate_integral, velocity_difference
from ...plane.vec import Real
from ..family import FRAMES, Method, MethodFamily, method, turn
from .four_bar import ORDINARY, FourBarTrack

# Samples per call: enough turns of the crank for any step, so that all methods are timed on the same number.
SAMPLES = 3600
STEPS, DRAWN_STEPS = (10.0, 5.0, 2.0, 1.0, 0.5, 0.1), (20.0, 10.0, 5.0, 2.0)
# Values with the step between them, deg: those at 0, step, 2 step and so on.
Sampled = tuple[Real, float]
Call = Callable[[], Sampled]
# Of a plot on paper: its height, and the least difference that can be read from it, mm.
PLOT, READ = 200.0, 0.2


@record(eq=False)
class SampledRocker:
    """The rocker of a crank-rocker: derivatives of its angle from samples of the angle, or its angle from the first.

    `derivative`: 1 or 2, or 0 for the angle; `right`: exact values, (frames,); `start`: the first angle, rad.
    """

    derivative: int
    right: Real
    start: float

    @classmethod
    def of(cls, derivative: int) -> SampledRocker:
        """By decimal arithmetic."""
        track = FourBarTrack.of(ORDINARY)
        angle = np.angle(track.right[1])
        return cls(derivative, (angle, track.first[1], track.second[1])[derivative], float(angle[0]))

    def samples(self, step: float, shift: float = 0.0) -> Real:
        """The angle, rad, or its derivative, at so many even steps, the first one `shift` steps from 0."""
        drive = np.radians((np.arange(SAMPLES) % round(360 / step) + shift) * step)
        rocker = move(ORDINARY, drive).rocker
        # The rocker swings without passing the cut of the angle.
        return np.asarray(np.angle(rocker.direction) if self.derivative else rocker.first)

    def error(self, found: Sampled) -> Real:
        """Of the values at whole degrees, for which exact ones are known."""
        values, step = found
        frames = np.arange(len(values)) * step
        known = np.flatnonzero(np.abs(frames - np.round(frames)) < 1e-9)
        off = np.abs(values[known] - self.right[np.round(frames[known]).astype(int) % FRAMES])
        return np.asarray(off / np.abs(self.right).max() if self.derivative else off)


@method(
    "exact coefficients (geomkin.move)",
    prepared=True,
    rationale="it is exact at every frame, whatever the step, for about twice the time of the positions that all other "
    "methods start from.",
    caveat="Differences of known positions take less time; this method needs the equations of the motion.",
)
def _exact_rates(rocker: SampledRocker) -> Call:
    """The library's method: the loop's equations differentiated, not the positions."""
    drive, name = np.tile(turn(), SAMPLES // FRAMES), ("", "first", "second")[rocker.derivative]
    return lambda: (getattr(move(ORDINARY, drive).rocker, name), 1.0)


@method("velocity differences", "step, deg", (10.0, 5.0, 2.0, 1.0))
def _velocity_difference(rocker: SampledRocker, step: float) -> Sampled:
    """velocity_difference, the mean over each interval; taken twice for accelerations."""
    # From half a step before, so that the middles of the intervals are at whole steps; and again of these.
    values = rocker.samples(step, -0.5 * rocker.derivative)
    for _ in range(rocker.derivative):
        values = velocity_difference(values, float(np.radians(step))).values
    return values, step


def _central(order: int) -> Method:
    @method(f"central differences, order {order}", "step, deg", STEPS)
    def central(rocker: SampledRocker, step: float) -> Sampled:
        """central_difference over one sample more than the order."""
        h, derivative = float(np.radians(step)), rocker.derivative
        return central_difference(rocker.samples(step), h, derivative, order, True).values, step  # type: ignore[arg-type]

    return central


@method("cubic spline", "step, deg", STEPS, prepared=True)
def _spline(rocker: SampledRocker, step: float) -> Call:
    """The periodic cubic spline through all samples, its equations solved by Fourier sums."""
    h = float(np.radians(step))
    # Slopes m of the periodic cubic spline solve m[-1] + 4 m + m[1] = 3 (z[1] - z[-1]) / h; its second derivatives
    # M[-1] + 4 M + M[1] = 6 (z[1] - 2 z + z[-1]) / h^2: circulant equations, which Fourier sums decouple.
    phase = 2 * np.pi * np.arange(SAMPLES // 2 + 1) / SAMPLES
    right = 6j * np.sin(phase) / h if rocker.derivative == 1 else 12 * (np.cos(phase) - 1) / h**2
    share = right / (4 + 2 * np.cos(phase))
    return lambda: (np.fft.irfft(np.fft.rfft(rocker.samples(step)) * share, SAMPLES), step)


@method("Fourier series", "step, deg", STEPS, prepared=True)
def _fourier(rocker: SampledRocker, step: float) -> Call:
    """The harmonics of each turn, differentiated; for periodic motion alone."""
    count = round(360 / step)
    share = (1j * np.arange(count // 2 + 1)) ** rocker.derivative
    # Each turn by itself: its harmonics are those of the motion.
    return lambda: (np.fft.irfft(np.fft.rfft(rocker.samples(step).reshape(-1, count)) * share, count).ravel(), step)


@method("tangents drawn", "step, deg", DRAWN_STEPS)
def _tangents(rocker: SampledRocker, step: float) -> Sampled:
    """By hand: ordinates are read from a plot 200 mm high to 0.2 mm, a tangent is the chord of its two neighbours, and
    its slope is plotted again. The time is that of the sums, not of the pencil.
    """
    read = _as_read(rocker.samples(step))
    for _ in range(rocker.derivative):
        read = _as_read((np.roll(read, -1) - np.roll(read, 1)) / (2 * np.radians(step)))
    return read, step


@method("mid-ordinates drawn", "step, deg", DRAWN_STEPS)
def _mid_ordinates_drawn(rocker: SampledRocker, step: float) -> Sampled:
    """The same by strips: the slope of each strip's chord is plotted at its mid-ordinate."""
    read = _as_read(rocker.samples(step, -0.5 * rocker.derivative))
    for _ in range(rocker.derivative):
        read = _as_read(np.diff(read) / np.radians(step))
    return read, step


def _as_read(values: Real) -> Real:
    """The values as read from a plot of them."""
    grid = READ * (values.max() - values.min()) / PLOT
    return np.asarray(np.round(values / grid) * grid)


def _rates(derivative: int, name: str, quantity: str) -> MethodFamily:
    return MethodFamily(
        name=name, title=f"{quantity} from positions", per="sample", unit="share of the largest", floor=1e-15,
        problem=lambda: SampledRocker.of(derivative), error=SampledRocker.error, count=lambda _, found: SAMPLES,
        about=f"The rocker of a crank-rocker of 30, 90, 70 and 100 mm at {SAMPLES} even steps of the crank: its "
        f"{quantity.lower()} at a speed of 1 rad/s, from the positions alone or by the exact coefficients. The time of "
        "the positions, by geomkin.move, is included in each. Small steps do not help: below some step the rounding of "
        "the positions grows as fast as the rest falls.",
        reference="intersecting circles, and differences of these, in decimal arithmetic of 110 digits",
        methods=(_exact_rates, _velocity_difference, *map(_central, (2, 4, 6)), _spline, _fourier, _tangents,
                 _mid_ordinates_drawn),
    )  # fmt: skip


VELOCITY = _rates(1, "velocity-from-positions", "Velocity")
ACCELERATION = _rates(2, "acceleration-from-positions", "Acceleration")


# Positions from velocities


@method(
    "exact positions (geomkin.move)",
    prepared=True,
    rationale="each position is independent, so that errors do not accumulate, and no velocities are needed.",
    caveat="Integrating known velocities takes less time, but it is meant for measured motion.",
)
def _exact_positions(rocker: SampledRocker) -> Call:
    """The library's method: positions come from the sizes, not from velocities."""
    drive = np.tile(turn(), SAMPLES // FRAMES)
    return lambda: (np.angle(move(ORDINARY, drive).rocker.direction), 1.0)


@method("mid-ordinates", "step, deg", STEPS, prepared=True)
def _mid_ordinates(rocker: SampledRocker, step: float) -> Call:
    """mid_ordinate_integral, velocities taken in the middles of the steps."""
    rates = rocker.samples(step, 0.5)
    return lambda: (mid_ordinate_integral(rates, float(np.radians(step)), rocker.start).values[:-1], step)


@method("trapezoids", "step, deg", STEPS, prepared=True)
def _trapezoids(rocker: SampledRocker, step: float) -> Call:
    """Straight lines between the velocities."""
    rates, h = rocker.samples(step), np.radians(step)
    return lambda: (_from_start(rocker, np.cumsum(0.5 * h * (rates[1:] + rates[:-1]))), step)


def _from_start(rocker: SampledRocker, sums: Real) -> Real:
    return np.concatenate([[rocker.start], rocker.start + sums])


@method("Simpson's rule", "step, deg", STEPS, prepared=True)
def _simpson(rocker: SampledRocker, step: float) -> Call:
    """Parabolas over two steps, with a position at each second sample."""
    rates, h = rocker.samples(step), np.radians(step)
    return lambda: (
        _from_start(rocker, np.cumsum((h / 3) * (rates[:-2:2] + 4 * rates[1:-1:2] + rates[2::2]))),
        2 * step,
    )


@method("trapezoids with end correction", "step, deg", STEPS, prepared=True)
def _corrected(rocker: SampledRocker, step: float) -> Call:
    """Trapezoids less the curvature of each, from the velocities' own differences (Gregory)."""
    rates, h = rocker.samples(step), np.radians(step)

    def call() -> Sampled:
        slopes = (np.roll(rates, -1) - np.roll(rates, 1)) / 2
        strips = 0.5 * (rates[1:] + rates[:-1]) - (slopes[1:] - slopes[:-1]) / 12
        return _from_start(rocker, h * np.cumsum(strips)), step

    return call


@method("Fourier series", "step, deg", STEPS, prepared=True)
def _fourier_integral(rocker: SampledRocker, step: float) -> Call:
    """The harmonics of each turn, integrated; for periodic motion alone."""
    count, rates = round(360 / step), rocker.samples(step)
    share = np.zeros(count // 2 + 1, dtype=complex)
    share[1:] = 1 / (1j * np.arange(1, count // 2 + 1))

    def call() -> Sampled:
        angles = np.fft.irfft(np.fft.rfft(rates.reshape(-1, count)) * share, count).ravel()
        return angles + (rocker.start - angles[0]), step

    return call


INTEGRATION = MethodFamily(
    name="positions-from-velocities", title="Positions from velocities", per="sample", unit="rad", floor=1e-15,
    problem=lambda: SampledRocker.of(0), error=SampledRocker.error, count=lambda _, found: len(found[0]),
    about=f"The rocker of a crank-rocker of 30, 90, 70 and 100 mm at {SAMPLES} even steps of the crank: its angle by "
    "integrating its velocities, which were prepared beforehand, from a known start; and exactly. At the coarser steps "
    "these are many turns, over which errors cancel or accumulate.",
    reference="intersecting circles, in decimal arithmetic of 110 digits",
    methods=(_exact_positions, _mid_ordinates, _trapezoids, _simpson, _corrected, _fourier_integral),
)  # fmt: skip
