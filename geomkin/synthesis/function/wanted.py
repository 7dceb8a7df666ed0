"""Functions of x: named functions, tables, and the checks that a mechanism can follow them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.arguments import ArgumentType, are_reals, checked, numbers
from ...core.errors import DesignError, printable, shown
from ...core.expressions import Expression as Expression
from ...core.fields import rounded_down, rounded_up
from ...core.records import record
from ...plane.joined import Spline
from ...plane.vec import Real

# Name: formula, and least and greatest number of coefficients.
NAMED: dict[str, tuple[str, int, int]] = {
    "polynomial": ("c0 + c1*x + c2*x**2 + ...", 2, 12),
    "power": ("c0*x**c1", 2, 2),
    "exponential": ("c0*exp(c1*x)", 2, 2),
    "logarithm": ("c0*log10(c1*x)", 2, 2),
    "sine": ("c0*sin(c1*x + c2)", 3, 3),
    "cosine": ("c0*cos(c1*x + c2)", 3, 3),
    "tangent": ("c0*tan(c1*x + c2)", 3, 3),
}


@checked
def named_function(name: str, coefficients: float | ArrayLike) -> Expression:
    """A named function with its coefficients as an expression.

    Parameters
    ----------
    name : str
        "polynomial": c0 + c1 x + c2 x**2 and so on; "power": c0 x**c1; "exponential": c0 exp(c1 x); "logarithm": c0
        log10(c1 x); "sine", "cosine", "tangent": c0 times that function of c1 x + c2, rad.
    coefficients : array_like, shape (n,)
        c0, c1 and so on: 2 to 12 for a polynomial, 3 for sine, cosine and tangent, else 2.

    Returns
    -------
    Expression
        The function.

    Raises
    ------
    DesignError
        For an unknown name or a wrong number of coefficients.

    Examples
    --------
    >>> from geomkin.synthesis import named_function
    >>> named_function("power", [2, 3])([2.0]).tolist()
    [16.0]
    """
    if name not in NAMED:
        raise DesignError("name", f"found {shown(name)}", f"give one of {', '.join(NAMED)}", "unknown-key")
    formula, least, most = NAMED[name]
    c = np.atleast_1d(np.asarray(coefficients, dtype=float))
    if c.ndim != 1 or not least <= len(c) <= most:
        count = f"{least}" if least == most else f"{least} to {most}"
        raise DesignError(
            "coefficients", f"found shape {np.shape(coefficients)}", f"give {count}, of {formula}", "wrong-type"
        )
    values = [f"({float(coefficient)!r})" for coefficient in c]
    if name == "polynomial":
        text = values[-1]
        for value in values[-2::-1]:
            text = f"{value} + x*({text})"
        return Expression(text)
    for k, value in enumerate(values):
        formula = formula.replace(f"c{k}", value)
    return Expression(formula)


def _is_function(value: Any) -> bool:
    rows = numbers(value, "iuf")
    table = rows is not None and rows.ndim == 2 and rows.shape[1] == 2 and are_reals(value)
    return isinstance(value, str) or callable(value) or table


Function = Annotated[
    Callable[..., Any] | str | Sequence[tuple[float, float]] | Real,
    ArgumentType(_is_function, "a function of one number, a text such as log10(x), or rows of x and y"),
]
# Number of samples of the function. With fewer a pole between two of them may stay undetected.
SAMPLES = 1025
# Largest step of the function between neighbouring numbers, as a share of its range. A steep square root has 1e-7.
JUMP = 1e-3
# Factor by which a function may exceed its sampled range between samples; a pole exceeds any.
LARGEST_OVERSHOOT = 100.0
# Least difference of the end values as a share of the function's range; the output range is scaled to this difference.
LEAST_END_DIFFERENCE = 1e-6


@record(eq=False)
class WantedFunction:
    """The function y = f(x) from x0 to x1, in terms of shares of the input and output ranges.

    f maps arrays to arrays; y0 and y1 are the values at the ends.
    """

    f: Callable[[Real], Real]
    x0: float
    x1: float
    y0: float
    y1: float

    def x(self, s: Real) -> Real:
        """x (...,) at shares of the input range."""
        return self.x0 + (self.x1 - self.x0) * s

    def share(self, s: Real) -> Real:
        """Share of the output range, (y - y0)/(y1 - y0), at shares of the input range."""
        return (self.f(self.x(s)) - self.y0) / (self.y1 - self.y0)


def wanted_function(f: Function, span: tuple[float, float]) -> WantedFunction:
    """The function over its range; DesignError if it is undefined, jumps, or has equal values at the ends.

    f: a function of an array or of one number, the text of an `Expression`, or rows (x, y) of rising x, joined by the
    cubic spline with the not-a-knot end condition (`plane.Spline`, over x).
    """
    x0, x1 = (float(x) for x in span)
    if not x0 < x1 or not x1 - x0 > 1e-12 * max(abs(x0), abs(x1)):
        raise DesignError("span", f"found {x0:g} to {x1:g}", "give a rising pair", "out-of-range")
    if isinstance(f, str):
        called: Callable[[Real], Real] = Expression(f)
    elif callable(f):
        called = _over_arrays(f, x0, x1)
    else:
        called = _through(np.asarray(f, dtype=float), x0, x1)
    x = np.linspace(x0, x1, SAMPLES)
    y = called(x)
    if not np.isfinite(y).all():
        problem = f"found no finite value at x = {x[~np.isfinite(y)][0]:.6g}"
        raise DesignError("function", problem, "give a range in which it has one", "not-finite")
    height = float(np.ptp(y))
    _check_continuity(called, x, y, height)
    if height == 0 or abs(y[-1] - y[0]) < LEAST_END_DIFFERENCE * height:
        what = "is constant over the range" if height == 0 else "has equal values at both ends"
        problem = f"it {what}, {y[0]:.6g}, so that no output swing fits it"
        raise DesignError("function", problem, "give a range with different values at its ends")
    return WantedFunction(called, x0, x1, float(y[0]), float(y[-1]))


def _over_arrays(f: Callable[..., Any], x0: float, x1: float) -> Callable[[Real], Real]:
    """The function itself, if it accepts arrays and returns the same as for single numbers; otherwise a loop."""

    def call_once(x: float) -> float:
        try:
            return float(f(x))
        except (ArithmeticError, ValueError):
            return np.nan
        except Exception as error:
            problem = f"called at {x:g} it fails, {type(error).__name__}: {printable(error, 60)}"
            remedy = "give a function of one number that returns one"
            raise DesignError("function", problem, remedy, "wrong-type") from None

    def call_each(x: Real) -> Real:
        return np.array([call_once(value) for value in np.ravel(x).tolist()]).reshape(np.shape(x))

    def call_array(x: Real) -> Real:
        with np.errstate(all="ignore"):
            return np.asarray(f(x), dtype=float)

    probe = x0 + (x1 - x0) * np.array([[0.0, 0.37], [0.61, 1.0]])
    by_number = call_each(probe)
    try:
        by_array = call_array(probe)
        is_same = by_array.shape == probe.shape and np.allclose(by_array, by_number, rtol=1e-12, atol=0, equal_nan=True)
    except Exception:
        # A function of one number may raise anything when called with an array; it works for single numbers.
        return call_each
    return call_array if is_same else call_each


def _through(rows: Real, x0: float, x1: float) -> Callable[[Real], Real]:
    """The spline through rows of x and y."""
    if len(rows) < 2:
        raise DesignError("function", f"found {len(rows)} rows", "give at least two, of x and y", "out-of-range")
    x, y = rows.T
    gaps = np.diff(x)
    if not (gaps > 1e-12 * np.abs(x).max()).all():
        raise DesignError(
            "function", f"x does not rise from row {int(gaps.argmin()) + 1} on", "give rows of rising x", "out-of-range"
        )
    if x0 < x[0] or x1 > x[-1]:
        remedy = f"give a range within that of the rows, {rounded_up(x[0])} to {rounded_down(x[-1])}"
        raise DesignError("span", f"found {x0:g} to {x1:g}", remedy, "out-of-range")
    # The table is flattened so that the chord length, which is the spline's parameter, equals x.
    flat = 1e-9 * gaps.min() / (np.abs(y).max() or 1.0)
    spline = Spline(x + 1j * flat * y)
    return lambda places: spline.point(places - x[0]).imag / flat


def _check_continuity(f: Callable[[Real], Real], x: Real, y: Real, height: float) -> None:
    """DesignError for a jump or a pole, found by narrowing down the steepest and the largest places."""
    steepest = [(x[k], x[k + 1], False) for k in np.argsort(-np.abs(np.diff(y)))[:3]]
    k = int(np.argmax(np.abs(y - np.median(y))))
    highest = (x[max(k - 1, 0)], x[min(k + 1, len(x) - 1)], True)
    for low, high, is_peak in (*steepest, highest):
        while True:
            x_near = np.linspace(low, high, 17)
            values = f(x_near)
            with np.errstate(invalid="ignore"):
                steps = np.abs(np.diff(values))
            if not np.isfinite(values).all() or not (np.diff(x_near) > 0).all():
                break
            k = int(np.argmax(np.abs(values - y[0])) if is_peak else np.argmax(steps))
            low, high = x_near[max(k - is_peak, 0)], x_near[min(k + 1, 16)]
        jumps = not np.isfinite(values).all() or steps.max() > JUMP * height
        if jumps or np.abs(values - y[0]).max() > LARGEST_OVERSHOOT * height:
            position = 0.0 if abs(low) < 1e-9 * (x[-1] - x[0]) else low
            problem = f"it jumps or has a pole near x = {position:.6g}"
            raise DesignError("function", problem, "give a range in which it is continuous", "not-finite")
