"""Functions of x as text: their values against Python's own reading of them, and what is refused."""

import math

import numpy as np
import pytest

import geomkin as gk
from geomkin.synthesis import Expression, named_function
from geomkin.synthesis.function.wanted import CONSTANTS, FUNCTIONS, NAMED

X = np.linspace(0.2, 0.9, 5)
TEXTS = [
    "log10(x)", "-x**2", "2**-x", "2**3**2", "(x + 1)*(x - 1)/x", "sin(pi*x) + e", "--x", "+x", "- - x - -x", "1e-3*x",
    ".5*x", "5.*x", "2E2/x", "x**1.5", "((x))", "3", "1 - 2 - x", "8/4/x", "-2**2*x", "x*-3", "abs(x - 0.5)", "sqrt(x)",
    "exp(-x*x)*cos(3*x)/tanh(x)", "asin(x) + acos(x) - atan(x)", "sinh(x) - cosh(x) + log(x) + tan(x)",
]  # fmt: skip


@pytest.mark.parametrize("text", TEXTS)
def test_a_text_means_what_python_reads_in_it(text):
    names = {name: getattr(math, name, abs) for name in FUNCTIONS} | CONSTANTS
    wanted = [eval(text, {"__builtins__": {}}, names | {"x": x}) for x in X.tolist()]
    assert np.allclose(Expression(text)(X), wanted, rtol=4e-16, atol=1e-16)
    assert Expression(text)(0.5).shape == () and Expression(text)(np.ones((2, 3))).shape == (2, 3)


def test_random_texts_mean_what_python_reads_in_them():
    rng = np.random.default_rng(0)

    def text(depth: int) -> str:
        if not depth or rng.random() < 0.2:
            return str(rng.choice(["x", "2", "0.5", "pi", "1e1"]))
        kind = rng.integers(4)
        if kind == 0:
            return f"({text(depth - 1)})"
        if kind == 1:
            return f"{rng.choice(['sin', 'exp', 'atan', 'tanh'])}({text(depth - 1)})"
        if kind == 2:
            return f"-{text(depth - 1)}"
        space = " " * rng.integers(2)
        return f"{text(depth - 1)}{space}{rng.choice(['+', '-', '*', '/', '**'])}{space}{text(depth - 1)}"

    looked = 0
    names = {name: getattr(np, name, None) for name in ("sin", "exp", "tanh")} | {"atan": np.arctan} | CONSTANTS
    for _ in range(400):
        one = text(4)
        if len(one) > 300:
            continue
        with np.errstate(all="ignore"):
            try:
                wanted = np.asarray(eval(one, {"__builtins__": {}}, names | {"x": X.astype(float)}), dtype=float)
            except (OverflowError, ZeroDivisionError, TypeError, ValueError):
                continue
        found = Expression(one)(X)
        same = np.isfinite(wanted * np.ones(5)) & np.isfinite(found)
        assert np.allclose(found[same], (wanted * np.ones(5))[same], rtol=1e-12), one
        looked += 1
    assert looked > 200


@pytest.mark.parametrize(
    ("text", "place", "remedy"),
    [
        ("", None, "give numbers"),
        ("x y", None, "give numbers"),
        ("2x", None, "give numbers"),
        ("log(", None, "give numbers"),
        ("log(x", None, "give numbers"),
        ("sin x", None, "give numbers"),
        ("x^2", 1, "give numbers"),
        ("__import__('os')", 1, "give numbers"),
        ("x.real", 1, "give numbers"),
        ("x + x[0]", 5, "give numbers"),
        ("x + (x := 2)", 6, "give numbers"),
        ("lambda: 1", 1, "give numbers"),
        ("[x for x in x]", 1, "give numbers"),
        ("1 if x else 2", 1, "give numbers"),
        ("f'{x}'", 1, "give numbers"),
        ("sin(*x)", 5, "give numbers"),
        ("sin(x, x)", 1, "give numbers"),
        ("sin(x=x)", 1, "give numbers"),
        ("sin", 1, "give numbers"),
        ("2j*x", 1, "give numbers"),
        ("True", 1, "give numbers"),
        ("x\0", None, "give numbers"),
        ("x)", None, "give numbers"),
        ("1e999*x", 1, "below 1e\\+300"),
        ("9" * 400 + "*x", 1, "below 1e\\+300"),
        ("x +", None, "give numbers"),
        ("(" * 249 + "x" + ")" * 249, None, "give numbers"),
        ("-" * 499 + "x", 101, "flatter"),
        ("x**" * 160 + "x", 298, "flatter"),
    ],
)
def test_a_fault_is_reported_with_its_place(text, place, remedy):
    with pytest.raises(gk.DesignError, match=remedy) as refusal:
        Expression(text)
    # In texts that are no expression at all, the place is the one that Python finds.
    assert refusal.value.field == "function" and f"at character {place or ''}" in refusal.value.problem


def test_powers_of_powers_are_worked_out_at_once_in_floating_point():
    assert np.isposinf(Expression("9**9**9**9**9")(0.0))
    assert Expression("(((" * 60 + "x" + ")))" * 60)(2.0) == 2


def test_a_long_text_and_what_is_no_text_are_refused():
    with pytest.raises(gk.DesignError, match="at most 500"):
        Expression("x+" * 300 + "x")
    with pytest.raises(gk.DesignError, match="give a text"):
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
    with pytest.raises(gk.DesignError, match="give one of polynomial"):
        named_function("powr", [1, 2])
    with pytest.raises(gk.DesignError, match=r"give 2, of c0\*x\*\*c1"):
        named_function("power", [1, 2, 3])


def test_as_many_coefficients_as_a_formula_has_are_taken():
    """As its letters say; a polynomial of degree 1 to 11."""
    for name, (formula, _, _) in NAMED.items():
        letters = sum(f"c{k}" in formula for k in range(9))
        for count in range(14):
            if 2 <= count <= 12 if name == "polynomial" else count == letters:
                assert np.isfinite(named_function(name, [0.5] * count)(X)).all()
            else:
                with pytest.raises(gk.DesignError, match="coefficients: found shape"):
                    named_function(name, [0.5] * count)
    with pytest.raises(gk.DesignError, match="coefficients: found shape"):
        named_function("power", [[1, 2]])
