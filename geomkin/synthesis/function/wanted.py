"""The function that a linkage is to follow, brought to a share of the input's way and one of the output's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from ...arguments import Sort, are_reals, numbers
from ...brief import one_line
from ...errors import DesignError, printable
from ...plane.spline import Spline
from ...plane.vec import Real
from .expression import Expression


def _is_function(value: Any) -> bool:
    rows = numbers(value, "iuf")
    table = rows is not None and rows.ndim == 2 and rows.shape[1] == 2 and are_reals(value)
    return isinstance(value, str) or callable(value) or table


Function = Annotated[
    Callable[..., Any] | str | Sequence[tuple[float, float]] | Real,
    Sort(_is_function, "a function of one number, a text such as log10(x), or rows of x and y"),
]
# Places at which the function is looked at. Fewer, and a pole between two of them may stay unseen.
LOOKS = 1025
# Share of the function's range that it may jump by between neighbouring numbers: a root, which is steep, makes 1e-7.
JUMP = 1e-3
# How often the range, as it was looked at, a function may exceed between two looks: a pole does it without end.
TALL = 100.0
# Least share of the function's range between its two ends. Below, the swing of the output would be that of a detail.
NO_RANGE = 1e-6


@dataclass(frozen=True, eq=False)
class WantedFunction:
    """y = f(x) from x0 to x1, as a share of the way: of the output's, over that of the input's.

    f: array to array; y0, y1: at the ends.
    """

    f: Callable[[Real], Real]
    x0: float
    x1: float
    y0: float
    y1: float
    __repr__ = one_line

    def x(self, s: Real) -> Real:
        """x (...,) at shares of the input's way."""
        return self.x0 + (self.x1 - self.x0) * s

    def share(self, s: Real) -> Real:
        """Share of the output's way, (y - y0)/(y1 - y0), at shares of the input's."""
        return (self.f(self.x(s)) - self.y0) / (self.y1 - self.y0)


def wanted_function(f: Function, span: tuple[float, float]) -> WantedFunction:
    """The function over its range; DesignError where it has none there, jumps, or ends where it began.

    f: a function of an array or of one number, the text of an `Expression`, or rows (x, y) of rising x, through which
    goes the cubic spline whose end pieces are one cubic each (`plane.Spline`, over x).
    """
    x0, x1 = (float(x) for x in span)
    if not x0 < x1 or not x1 - x0 > 1e-12 * max(abs(x0), abs(x1)):
        raise DesignError("span", f"found {x0:g} to {x1:g}", "give a rising pair")
    if isinstance(f, str):
        called: Callable[[Real], Real] = Expression(f)
    elif callable(f):
        called = _over_arrays(f, x0, x1)
    else:
        called = _through(np.asarray(f, dtype=float), x0, x1)
    x = np.linspace(x0, x1, LOOKS)
    y = called(x)
    if not np.isfinite(y).all():
        raise DesignError(
            "function", f"found no finite value at x = {x[~np.isfinite(y)][0]:.6g}", "give a range in which it has one"
        )
    height = float(np.ptp(y))
    _refuse_jumps(called, x, y, height)
    if height == 0 or abs(y[-1] - y[0]) < NO_RANGE * height:
        what = "is the same all over the range" if height == 0 else "ends at the value at which it began"
        raise DesignError(
            "function",
            f"it {what}, {y[0]:.6g}, so that no output swing fits it",
            "give a range with ends of two values",
        )
    return WantedFunction(called, x0, x1, float(y[0]), float(y[-1]))


def _over_arrays(f: Callable[..., Any], x0: float, x1: float) -> Callable[[Real], Real]:
    """The function for arrays: itself where it takes them, and gives what it gives for single numbers."""

    def one(x: float) -> float:
        try:
            return float(f(x))
        except (ArithmeticError, ValueError):
            return np.nan
        except Exception as error:
            raise DesignError(
                "function",
                f"called at {x:g} it fails, {type(error).__name__}: {printable(error, 60)}",
                "give a function of one number that gives one",
            ) from None

    def each(x: Real) -> Real:
        return np.array([one(value) for value in np.ravel(x).tolist()]).reshape(np.shape(x))

    def whole(x: Real) -> Real:
        with np.errstate(all="ignore"):
            return np.asarray(f(x), dtype=float)

    probe = x0 + (x1 - x0) * np.array([[0.0, 0.37], [0.61, 1.0]])
    singly = each(probe)
    try:
        together = whole(probe)
        same = together.shape == probe.shape and np.allclose(together, singly, rtol=1e-12, atol=0, equal_nan=True)
    except Exception:
        # A function of one number may fail in any way where it is given an array; by single numbers it was sound.
        return each
    return whole if same else each


def _through(rows: Real, x0: float, x1: float) -> Callable[[Real], Real]:
    """The spline through rows of x and y."""
    if len(rows) < 2:
        raise DesignError("function", f"found {len(rows)} rows", "give at least two, of x and y")
    x, y = rows.T
    gaps = np.diff(x)
    if not (gaps > 1e-12 * np.abs(x).max()).all():
        raise DesignError("function", f"x does not rise from row {int(gaps.argmin()) + 1} on", "give rows of rising x")
    if x0 < x[0] or x1 > x[-1]:
        raise DesignError(
            "span", f"found {x0:g} to {x1:g}", f"give a range within that of the rows, {x[0]:g} to {x[-1]:g}"
        )
    # So flat that the length along its chords is x.
    flat = 1e-9 * gaps.min() / (np.abs(y).max() or 1.0)
    spline = Spline(x + 1j * flat * y)
    return lambda places: spline.point(places - x[0]).imag / flat


def _refuse_jumps(f: Callable[[Real], Real], x: Real, y: Real, height: float) -> None:
    """Where the function changes most, and where it is largest, ever nearer: a jump stays, and a pole grows."""
    steepest = [(x[k], x[k + 1], False) for k in np.argsort(-np.abs(np.diff(y)))[:3]]
    k = int(np.argmax(np.abs(y - np.median(y))))
    highest = (x[max(k - 1, 0)], x[min(k + 1, len(x) - 1)], True)
    for low, high, tall in (*steepest, highest):
        while True:
            near = np.linspace(low, high, 17)
            values = f(near)
            with np.errstate(invalid="ignore"):
                steps = np.abs(np.diff(values))
            if not np.isfinite(values).all() or not (np.diff(near) > 0).all():
                break
            k = int(np.argmax(np.abs(values - y[0])) if tall else np.argmax(steps))
            low, high = near[max(k - tall, 0)], near[min(k + 1, 16)]
        jumps = not np.isfinite(values).all() or steps.max() > JUMP * height
        if jumps or np.abs(values - y[0]).max() > TALL * height:
            place = 0.0 if abs(low) < 1e-9 * (x[-1] - x[0]) else low
            raise DesignError(
                "function", f"it jumps or has a pole near x = {place:.6g}", "give a range in which it goes on smoothly"
            )
