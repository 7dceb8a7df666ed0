"""Laws of motion from 0 to 1 over 0 <= x <= 1, with their derivatives to the third, as in VDI 2143; and peaks.

Every law returns (4, ...): f, f', f'', f''' by x. For a rise h over an angle beta, the k-th derivative by angle is
h f^(k) / beta^k. A law with inner jumps of its derivatives has an attribute `breaks`: the x of the jumps, with 0 and 1;
at a jump the piece that starts there counts. The peaks in the docstrings are those of f', f'' and f'''. They and the
laws are in Norton, Cam Design and Manufacturing Handbook, on double-dwell cams, most also in VDI 2143 Blatt 1 (1980);
the forms here are derived.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from numpy.polynomial import Polynomial, chebyshev
from numpy.typing import ArrayLike

from ...core.errors import DesignError, shown
from ...core.records import record
from ...plane.vec import TIED, Real, first_largest

# Samples in each stretch. A segment's law has at most one peak between two of them. Fewer may miss a peak; more take
# proportionally longer.
SAMPLES = 256
# If all stretches together would have more than TOGETHER samples, each gets fewer, but at least FEWEST. Smaller values
# miss detail of a spline among many dwells; larger ones take seconds.
TOGETHER, FEWEST = 256 * 256, 48
# Each refinement narrows the interval of a peak to one sixteenth. After seven the cam angle is exact to 1e-9 rad and
# the value, which is stationary at a peak, to rounding.
REFINEMENTS, FINE = 7, 33


def samples(breaks: Real) -> Real:
    """Parameters, shape (segments, SAMPLES or fewer), that resolve every segment and both sides of every joint."""
    return _samples_between(breaks[:-1], breaks[1:])


def _samples_between(low: Real, high: Real) -> Real:
    count = min(SAMPLES, max(FEWEST, TOGETHER // max(len(low), 1)))
    inside = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, count)
    inside[:, -1] = np.nextafter(high, -np.inf)
    return inside


def highest(breaks: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """The largest value of f in each segment and its parameter; at a joint the segment's own side counts."""
    return highest_between(breaks[:-1], breaks[1:], f)


def highest_between(low: Real, high: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """The largest value of f, and its parameter, between each `low` and `high` (excluded), where f is smooth."""
    places = _samples_between(low, high)
    _, before, after = _peak_bounds(places, f(places))
    return refine_peak(before, after, f)


def _peak_bounds(places: Real, values: Real) -> tuple[Real, Real, Real]:
    """For each row of samples: an upper bound of its peak, and the samples before and after the highest one."""
    top = values.argmax(axis=1)[:, None]
    most = np.take_along_axis(values, top, 1)
    with np.errstate(invalid="ignore"):
        tied = values >= most - TIED * np.abs(most)
    # The first of equally high ones, so that all processors give the same.
    top = np.where(tied.any(axis=1, keepdims=True), tied.argmax(axis=1)[:, None], top)
    sides = np.maximum(top - 1, 0), np.minimum(top + 1, places.shape[1] - 1)
    left, right = (np.take_along_axis(values, side, 1)[:, 0] for side in sides)
    # A parabola through three samples exceeds the middle one by at most an eighth of the drop to the sides; eight times
    # that is allowed for.
    highest_sample = np.take_along_axis(values, top, 1)[:, 0]
    before, after = (np.take_along_axis(places, side, 1)[:, 0] for side in sides)
    with np.errstate(invalid="ignore"):
        return 2 * highest_sample - np.minimum(left, right), before, after


def refine_peak(low: Real, high: Real, f: Callable[[Real], Real]) -> tuple[Real, Real]:
    """Value and parameter of the single peak of f between each `low` and `high`."""
    for _ in range(REFINEMENTS):
        # Rounding may put the last sample beyond `high`, across a joint.
        places = np.minimum(low[:, None] + (high - low)[:, None] * np.linspace(0, 1, FINE), high[:, None])
        values = f(places)
        top = values.argmax(axis=1)[:, None]
        low = np.take_along_axis(places, np.maximum(top - 1, 0), 1)[:, 0]
        high = np.take_along_axis(places, np.minimum(top + 1, FINE - 1), 1)[:, 0]
    return np.take_along_axis(values, top, 1)[:, 0], np.take_along_axis(places, top, 1)[:, 0]


def exceeds(places: Real, values: Real, f: Callable[[Real], Real], limit: float) -> bool:
    """Whether f exceeds a limit or is nan anywhere; `places` and `values` are its samples, as of `samples`."""
    if not values.max() <= limit:
        return True
    bounds, before, after = _peak_bounds(places, values)
    # Only peaks that may exceed the limit are refined: usually none or one.
    may = ~(bounds <= limit)
    return bool(may.any()) and not refine_peak(before[may], after[may], f)[0].max() <= limit


def largest(breaks: Real, f: Callable[[Real], Real]) -> tuple[float, float]:
    """The largest value of f over all segments, and its parameter."""
    places = samples(breaks)
    values = f(places)
    bounds, before, after = _peak_bounds(places, values)
    # Most stretches are clearly lower: only those that may hold the largest value are refined.
    most = values.max()
    with np.errstate(invalid="ignore"):
        may = ~(bounds < most - TIED * np.abs(most))
    tops, where = refine_peak(before[may], after[may], f)
    return float(tops.max()), float(where[first_largest(tops)])


@record(eq=False)
class SegmentPeaks:
    """Largest sizes of a segment's velocity, acceleration and jerk by cam angle, its joints included.

    Parameters
    ----------
    velocity, acceleration, jerk : float
        mm/rad, mm/rad2 and mm/rad3; for an oscillating follower rad/rad, rad/rad2 and rad/rad3. The acceleration is inf
        if the velocity jumps inside the segment or at one of its ends, the jerk if velocity or acceleration does. A
        jump at an end counts only for a segment whose value there is not 0: a dwell next to a harmonic rise has none,
        nor has a cycloidal return that follows it.
    rise : float
        Lift at its end less that at its start, mm or rad.
    angle : float
        Range of cam angles of the segment, rad.

    Notes
    -----
    Source: the factors are those of VDI 2143 Blatt 1 (1980) and of Norton, Cam Design and Manufacturing Handbook.
    """

    velocity: float
    acceleration: float
    jerk: float
    rise: float
    angle: float

    @property
    def factors(self) -> tuple[float, float, float]:
        """Cv, Ca, Cj: the peaks as multiples of rise / angle, rise / angle^2 and rise / angle^3; nan without a rise."""
        if not self.rise:
            return np.nan, np.nan, np.nan
        by = abs(self.rise)
        peaks = self.velocity, self.acceleration, self.jerk
        cv, ca, cj = (peak * self.angle**k / by for k, peak in enumerate(peaks, 1))
        return cv, ca, cj


Law = Callable[[Real], Real]
LawName = Literal[
    "uniform", "parabolic", "harmonic", "cycloidal", "modified-trapezoid", "modified-sine", "3-4-5", "4-5-6-7"
]
# Largest condition number of a polynomial's equations: a slope without its lift exceeds it, or so many intermediate
# points that the polynomial oscillates. A larger value accepts such polynomials, a smaller one refuses valid ones of a
# high degree.
WORST = 1e10
# Slope and curvature at the start and at the end, by x; None for a spline that closes on itself.
Ends = tuple[tuple[float, float], tuple[float, float]] | None


def uniform(x: Real) -> Real:
    """f = x: constant velocity. Next to a dwell the acceleration is infinite. Peaks 1, 0, 0."""
    return np.stack([x, np.ones_like(x), np.zeros_like(x), np.zeros_like(x)])


def cycloidal(x: Real) -> Real:
    """f = x - sin(2 pi x) / 2 pi: no acceleration at either end. Peaks 2, 2 pi, 4 pi^2."""
    turn = 2 * np.pi * x
    return np.stack(
        [x - np.sin(turn) / (2 * np.pi), 1 - np.cos(turn), 2 * np.pi * np.sin(turn), 4 * np.pi**2 * np.cos(turn)]
    )


def harmonic(x: Real) -> Real:
    """f = (1 - cos(pi x)) / 2: the acceleration jumps next to a dwell. Peaks pi / 2, pi^2 / 2, pi^3 / 2."""
    turn = np.pi * x
    # 1 - cos(turn) would lose the digits of a lift that has just begun.
    lift = 2 * np.sin(0.5 * turn) ** 2
    return 0.5 * np.stack([lift, np.pi * np.sin(turn), np.pi**2 * np.cos(turn), -(np.pi**3) * np.sin(turn)])


@record(eq=False)
class PolynomialLaw:
    """A law whose lift is a polynomial. rows (4, n): its coefficients and its derivatives', the highest power first."""

    rows: Real

    def __call__(self, x: Real) -> Real:
        value = np.zeros((4, *np.shape(x)))
        for column in self.rows.T:
            value = value * x + column.reshape(4, *[1] * np.ndim(x))
        return value


def _polynomial(coefficients: list[float]) -> PolynomialLaw:
    f = Polynomial(coefficients)
    return PolynomialLaw(np.array([np.pad(f.deriv(k).coef if k else f.coef, (0, k))[::-1] for k in range(4)]))


# Peaks 15/8, 10/sqrt(3), 60: continuous acceleration.
polynomial_345 = _polynomial([0, 0, 0, 10, -15, 6])
# Peaks 35/16, 84 sqrt(5)/25, 52.5: continuous jerk.
polynomial_4567 = _polynomial([0, 0, 0, 0, 35, -84, 70, -20])


@record(eq=False)
class Waves:
    """A law in pieces, each f = c0 + c1 u + c2 u^2 / 2 + p sin(w u + q) with u = x - start of the piece.

    breaks (n + 1,); coefficients (6, n): c0, c1, c2, p, w, q.
    """

    breaks: Real
    coefficients: Real

    def __call__(self, x: Real) -> Real:
        piece = np.clip(np.searchsorted(self.breaks, x, side="right") - 1, 0, len(self.breaks) - 2)
        u = x - self.breaks[piece]
        c0, c1, c2, p, w, q = self.coefficients[:, piece]
        sine, cosine = p * np.sin(w * u + q), p * np.cos(w * u + q)
        return np.stack(
            [c0 + u * (c1 + u * c2 / 2) + sine, c1 + u * c2 + w * cosine, c2 - w**2 * sine, -(w**3) * cosine]
        )


def sine_constant_cosine(ramp: float, constant: float, swing: float) -> Waves:
    """Law whose acceleration is a quarter sine, a constant, half a cosine, a constant and a quarter sine.

    ramp, constant and swing are the shares of the whole that the two sines, the two constants and
    the cosine take; they add up to 1. Shares (1/4, 1/2, 1/4) are the modified trapezoid,
    (1/4, 0, 3/4) the modified sine, (0, 1, 0) the parabolic law.
    """
    # Width, constant part, amplitude, frequency and phase of the acceleration in each piece.
    quarter, half = np.pi / (ramp or 1), np.pi / (swing or 1)
    pieces = [
        (ramp / 2, 0, 1, quarter, 0),
        (constant / 2, 1, 0, 1, 0),
        (swing, 0, 1, half, np.pi / 2),
        (constant / 2, -1, 0, 1, 0),
        (ramp / 2, 0, 1, quarter, -np.pi / 2),
    ]
    breaks, rows, f, slope = [0.0], [], 0.0, 0.0
    for width, c2, amplitude, w, q in pieces:
        if width == 0:
            continue
        p = -amplitude / w**2
        rows.append([f - p * np.sin(q), slope - p * w * np.cos(q), c2, p, w, q])
        c0, c1 = rows[-1][:2]
        f = c0 + width * (c1 + width * c2 / 2) + p * np.sin(w * width + q)
        slope = c1 + width * c2 + p * w * np.cos(w * width + q)
        breaks.append(breaks[-1] + width)
    coefficients = np.array(rows).T
    coefficients[:4] /= f  # so far the acceleration has height 1; the lift must end at 1
    return Waves(np.array([*breaks[:-1], 1.0]), coefficients)


# Peaks 2, 4, infinite.
parabolic = sine_constant_cosine(0, 1, 0)
# Peaks 2, 8 pi / (2 + pi), 32 pi^2 / (2 + pi).
modified_trapezoid = sine_constant_cosine(1 / 4, 1 / 2, 1 / 4)
# Peaks 4 pi / (4 + pi), 4 pi^2 / (4 + pi), 16 pi^3 / (4 + pi).
modified_sine = sine_constant_cosine(1 / 4, 0, 3 / 4)

# Names as recipes spell them.
LAWS: dict[str, Law] = {
    "uniform": uniform,
    "parabolic": parabolic,
    "harmonic": harmonic,
    "cycloidal": cycloidal,
    "modified-trapezoid": modified_trapezoid,
    "modified-sine": modified_sine,
    "3-4-5": polynomial_345,
    "4-5-6-7": polynomial_4567,
}


@runtime_checkable
class BrokenLaw(Protocol):
    """A law whose derivatives jump inside."""

    @property
    def breaks(self) -> Real:
        """Places x of the jumps, rising, with 0 and 1."""


def breaks_of(law: Law) -> Real:
    """Places x where the derivatives of a law may jump, rising, with 0 and 1."""
    return np.asarray(law.breaks if isinstance(law, BrokenLaw) else (0.0, 1.0), dtype=float)


# Largest relative error of a user's law at 0, at 1 and of its integrals. A larger value hides a wrong derivative, a
# smaller one refuses laws that are computed by differences.
TRUST = 1e-6


def law_of(law: LawName | Law) -> Law:
    """A law by name, or a callable after checks of its shape, its ends, and of each row as derivative of the last."""
    if isinstance(law, str):
        if law not in LAWS:
            raise DesignError("law", f"found {law!r}", f"give {', '.join(LAWS)} or a callable", "wrong-type")
        return LAWS[law]
    if not callable(law):
        raise DesignError("law", f"found {shown(law)}", f"give {', '.join(LAWS)} or a callable", "out-of-range")
    breaks = breaks_of(law)
    if breaks.ndim != 1 or breaks.size < 2 or breaks[0] != 0 or breaks[-1] != 1 or np.any(np.diff(breaks) <= 0):
        raise DesignError("law.breaks", f"found {breaks}", "give rising numbers from 0 to 1", "out-of-range")
    nodes, weights = np.polynomial.legendre.leggauss(8)
    # Sixteen steps in each piece, eight nodes in each step: polynomials to degree 15 pass exactly.
    edges = np.concatenate([np.linspace(a, b, 17)[:-1] for a, b in pairwise(breaks)] + [[1.0]])
    step = np.diff(edges)
    x = edges[:-1, None] + step[:, None] * (nodes + 1) / 2
    inside, ends = np.asarray(law(x), dtype=float), np.asarray(law(edges), dtype=float)
    if inside.shape != (4, *x.shape) or ends.shape != (4, *edges.shape):
        problem = f"it returns the shape {inside.shape} for {x.shape}"
        raise DesignError("law", problem, "return f, f', f'', f''' stacked", "wrong-type")
    if not (np.isfinite(inside).all() and np.isfinite(ends).all()):
        raise DesignError("law", "it is not finite everywhere in 0 to 1", "give finite derivatives", "not-finite")
    if abs(ends[0, 0]) > TRUST or abs(ends[0, -1] - 1) > TRUST:
        problem = f"it runs from {ends[0, 0]:g} to {ends[0, -1]:g}"
        raise DesignError("law", problem, "make it run from 0 to 1", "out-of-range")
    for k in range(3):
        # At a jump the law returns the values of the piece after it, so steps that end there are checked for f only.
        last = np.isin(edges[1:], breaks[1:-1]) & (k > 0)
        missed = np.abs(np.diff(ends[k]) - inside[k + 1] @ weights * step / 2)[~last].max(initial=0)
        if missed > TRUST * max(1, np.abs(inside[k]).max()):
            remedy = "correct it, or list the x of its jumps in its attribute `breaks`"
            raise DesignError("law", f"its row {k + 1} is not the derivative of its row {k}", remedy, "conflict")
    return law


@record(eq=False)
class ChebyshevLaw:
    """A law as one polynomial. rows (degree + 1, 4): Chebyshev coefficients over 0 <= x <= 1 of f, f', f'', f'''.

    Chebyshev polynomials, since powers lose half their digits at degree 15.
    """

    rows: Real

    def __call__(self, x: Real) -> Real:
        return np.asarray(chebyshev.chebval(2 * x - 1, self.rows), dtype=float)


def chebyshev_law(series: Sequence[Real]) -> ChebyshevLaw:
    """The law from the Chebyshev coefficients of f and its three derivatives over 0 <= x <= 1."""
    rows = np.zeros((len(series[0]), 4))
    for k, coefficients in enumerate(series):
        rows[: len(coefficients), k] = coefficients
    return ChebyshevLaw(rows)


def derive(coefficients: Real, order: int) -> Real:
    """Chebyshev coefficients of a derivative by x, of each column by itself."""
    # x is from 0 to 1, the variable of a Chebyshev polynomial from -1 to 1.
    return chebyshev.chebder(coefficients, order, scl=2) if order else coefficients


def condition_row(x: ArrayLike, order: int, degree: int) -> Real:
    """Derivatives of an order at x (...) of the Chebyshev polynomials up to a degree: (degree + 1, ...)."""
    return chebyshev.chebval(2 * np.asarray(x) - 1, derive(np.eye(degree + 1), order))


def polynomial_from(conditions: Sequence[tuple[float, int, float]]) -> ChebyshevLaw:
    """The polynomial of least degree that meets conditions (x, order of the derivative, its value by x)."""
    degree = len(conditions) - 1
    rows = np.array([condition_row(x, order, degree) for x, order, _ in conditions])
    # Scaled, since a row of the third derivative is thousands of times one of the value.
    size = np.abs(rows).max(axis=1)
    if not size.all() or np.linalg.cond(rows / size[:, None]) > WORST:
        problem = "its conditions do not determine one polynomial"
        raise DesignError("", problem, "give the lower derivatives too, or fewer intermediate points", "conflict")
    f = np.linalg.solve(rows / size[:, None], np.array([v for _, _, v in conditions]) / size)
    return chebyshev_law([derive(f, k) for k in range(4)])


@record(eq=False)
class PiecewisePolynomial:
    """A law in polynomial pieces. knots (n + 1,) over x; coefficients (degree + 1, n) of the powers of x - knot.

    breaks: those places of x, 0 and 1 among them, where a derivative up to the third may jump.
    """

    knots: Real
    coefficients: Real
    breaks: Real

    def __call__(self, x: Real) -> Real:
        piece = np.clip(np.searchsorted(self.knots, x, side="right") - 1, 0, len(self.knots) - 2)
        u = x - self.knots[piece]
        value: Real = np.zeros((4, *np.shape(x)))
        for coefficient in self.coefficients[::-1]:
            # Horner for the Taylor coefficients, f^(k) / k!.
            value[1:] = value[1:] * u + value[:-1]
            value[0] = value[0] * u + coefficient[piece]
        factorials: Real = np.array([1.0, 1, 2, 6]).reshape(4, *[1] * np.ndim(x))
        return value * factorials
