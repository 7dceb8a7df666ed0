"""Functions of x as text: their values against Python's own reading of them, and what is refused."""

import math

import numpy as np
import pytest

import geomkin as gk
from geomkin.core.expressions import CONSTANTS, FUNCTIONS
from geomkin.synthesis import Expression, named_function
from geomkin.synthesis.function.wanted import NAMED

X = np.linspace(0.2, 0.9, 5)
TEXTS = [
    "log10(x)", "-x**2", "2**-x", "2**3**2", "(x + 1)*(x - 1)/x", "sin(pi*x) + e", "--x", "+x", "- - x - -x", "1e-3*x",
    ".5*x", "5.*x", "2E2/x", "x**1.5", "((x))", "3", "1 - 2 - x", "8/4/x", "-2**2*x", "x*-3", "abs(x - 0.5)", "sqrt(x)",
    "exp(-x*x)*cos(3*x)/tanh(x)", "asin(x) + acos(x) - atan(x)", "sinh(x) - cosh(x) + log(x) + tan(x)",
]  # fmt: skip


def test_values_agree_with_python():
    for text in TEXTS:
        agrees_with_python(text)


def agrees_with_python(text):
    names = {name: getattr(math, name, abs) for name in FUNCTIONS} | CONSTANTS
    wanted = [eval(text, {"__builtins__": {}}, names | {"x": x}) for x in X.tolist()]
    assert np.allclose(Expression(text)(X), wanted, rtol=4e-16, atol=1e-16)
    assert Expression(text)(0.5).shape == () and Expression(text)(np.ones((2, 3))).shape == (2, 3)


@pytest.mark.parametrize("text", [*TEXTS, "(x - 2)**3", "(x - 2)**-2", "abs(x - 2)*x", "x**0", "(x - 0.2)**2"])
def test_slopes_agree_with_differences(text):
    """Central differences of fourth order."""
    step, f = 1e-3, Expression(text)
    wanted = (8 * (f(X + step) - f(X - step)) - (f(X + 2 * step) - f(X - 2 * step))) / (12 * step)
    smooth = np.abs(X - 0.5) > 0.1 if text == "abs(x - 0.5)" else np.full(X.shape, True)
    assert f.slope(X)[smooth] == pytest.approx(wanted[smooth], rel=1e-6, abs=1e-8)


@pytest.mark.parametrize(
    "text",
    [
        "", "x y", "2x", "log(", "log(x", "sin x", "x^2", "__import__('os')", "x.real", "lambda: 1", "x)", "1e999*x", "x +",
        "x**" * 120 + "x", "[x]", "x if x else 1", "x == 1", "f'{x}'", "x[0]", "log(x, 2)", "log(x=1)", "True", "1j", "'x'",
    ],
)  # fmt: skip
def test_invalid_text_is_refused(text):
    with pytest.raises(gk.DesignError) as refusal:
        Expression(text)
    assert refusal.value.field == "function" and "character" in refusal.value.problem


def test_powers_of_powers_are_worked_out_at_once_in_floating_point():
    assert np.isposinf(Expression("9**9**9**9**9")(0.0))
    assert Expression("(((" * 60 + "x" + ")))" * 60)(2.0) == 2


def test_long_expressions_and_other_types_are_refused():
    with pytest.raises(gk.DesignError):
        Expression("x+" * 300 + "x")
    with pytest.raises(gk.DesignError):
        Expression(3)


def test_functions_by_name_are_their_formulas():
    c = np.array([1.5, -0.5, 0.25, 2.0])
    wanted = {
        "polynomial": c[0] + c[1] * X + c[2] * X**2 + c[3] * X**3,
        "power": c[0] * X ** c[1],
        "exponential": c[0] * np.exp(c[1] * X),
        "logarithm": c[0] * np.log10(0.5 * X),
        "sine": c[0] * np.sin(c[1] * X + c[2]),
        "cosine": c[0] * np.cos(c[1] * X + c[2]),
        "tangent": c[0] * np.tan(c[1] * X + c[2]),
    }
    assert set(wanted) == set(NAMED)
    for name, values in wanted.items():
        count = {"polynomial": 4, "sine": 3, "cosine": 3, "tangent": 3}.get(name, 2)
        given = [1.5, 0.5] if name == "logarithm" else c[:count]
        assert np.allclose(named_function(name, given)(X), values, rtol=1e-14), name
    with pytest.raises(gk.DesignError):
        named_function("powr", [1, 2])
    with pytest.raises(gk.DesignError):
        named_function("power", [1, 2, 3])
