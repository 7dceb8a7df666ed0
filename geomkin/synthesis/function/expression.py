"""Functions of x as people write them, read without running anything."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...arguments import Reals, Sort, check_fields, checked
from ...brief import one_line
from ...cached import cached_property
from ...errors import DesignError, shown
from ...plane.vec import Real

FUNCTIONS: dict[str, Callable[..., Real]] = {
    "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan,
    "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh, "exp": np.exp, "log": np.log, "log10": np.log10,
    "sqrt": np.sqrt, "abs": np.abs,
}  # fmt: skip
CONSTANTS = {"pi": np.pi, "e": np.e}
KNOWN = f"x, {', '.join(CONSTANTS)}, {', '.join(FUNCTIONS)}"
# Characters and brackets within brackets. No formula of a textbook comes near; a text of ten thousand brackets would
# use up the stack.
LONGEST, DEEPEST = 500, 40
TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*)|(\*\*|[-+*/()])|(\S))")
Value = Callable[[Real], Real]


@dataclass(frozen=True, repr=False)
class Expression:
    """A function of x from its text, such as `log10(x)` or `2*x**1.5 - 1`: numbers, x, + - * / **, brackets.

    Names: pi, e, sin cos tan asin acos atan sinh cosh tanh exp log (natural) log10 sqrt abs; angles are rad. Binding
    is Python's: -x**2 is -(x**2), and 2**3**2 is 2**9. At most 500 characters and 40 brackets deep. DesignError for
    anything else, with its place. Called with an array it gives one; nan or inf where it has no value.
    """

    text: Annotated[str, Sort(lambda value: isinstance(value, str), "a text such as log10(x)")]
    __repr__ = one_line

    def __post_init__(self) -> None:
        check_fields(self)
        if len(self.text) > LONGEST:
            raise DesignError("function", f"found {len(self.text):,} characters", f"give at most {LONGEST}")
        _ = self._value  # read now, or the fault would be told when it is first called

    @cached_property
    def _value(self) -> Value:
        return _Reader(self.text).whole()

    def __reduce__(self) -> tuple[type[Expression], tuple[str]]:
        # What was read of the text is functions, which cannot be pickled.
        return Expression, (self.text,)

    def __call__(self, x: ArrayLike) -> Real:
        """Values (...,) at x (...,)."""
        places = np.asarray(x, dtype=float)
        with np.errstate(all="ignore"):
            return self._value(places) + np.zeros(places.shape)


class _Reader:
    """Reads a text once, from left to right, each kind of operator by the one that binds stronger."""

    def __init__(self, text: str):
        self.text, self.at, self.depth = text, 0, 0
        self.kind, self.token, self.start = "", "", 0
        self.step()

    def step(self) -> None:
        """To the next token."""
        match = TOKEN.match(self.text, self.at)
        if match is None:
            self.kind, self.token, self.start = "end", "", len(self.text)
            return
        number, name, operator, other = match.groups()
        self.token, self.at = match.group().strip(), match.end()
        self.start = self.at - len(self.token)
        self.kind = "number" if number else "name" if name else "operator" if operator else "other"
        if other:
            remedy = "write ** for a power" if other == "^" else f"give numbers, + - * / **, brackets and {KNOWN}"
            raise self.wrong(f"found {shown(other)}", remedy)

    def wrong(self, problem: str, remedy: str) -> DesignError:
        return DesignError("function", f"{problem} at character {self.start + 1} of {shown(self.text)}", remedy)

    def take(self, *operators: str) -> str:
        """The operator that stands here, one of these, which is passed; or nothing."""
        found = self.token if self.kind == "operator" and self.token in operators else ""
        if found:
            self.step()
        return found

    def whole(self) -> Value:
        value = self.sum()
        if self.kind != "end":
            remedy = "close no more brackets than were opened" if self.token == ")" else "write * where you multiply"
            raise self.wrong(f"found {shown(self.token)}", remedy)
        return value

    def sum(self) -> Value:
        value = self.product()
        while sign := self.take("+", "-"):
            value = _joined(np.add if sign == "+" else np.subtract, value, self.product())
        return value

    def product(self) -> Value:
        value = self.signed()
        while sign := self.take("*", "/"):
            value = _joined(np.multiply if sign == "*" else np.divide, value, self.signed())
        return value

    def signed(self) -> Value:
        minus = False
        while sign := self.take("+", "-"):
            minus ^= sign == "-"
        value = self.power()
        return (lambda x: -value(x)) if minus else value

    def power(self) -> Value:
        value = self.single()
        self.deeper()
        if self.take("**"):
            value = _joined(np.power, value, self.signed())
        self.depth -= 1
        return value

    def deeper(self) -> None:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.wrong(f"found more than {DEEPEST} brackets or powers within each other", "give a flatter one")

    def single(self) -> Value:
        kind, token = self.kind, self.token
        if kind == "number":
            number = float(token)
            if not np.isfinite(number):
                raise self.wrong(f"found {shown(token)}", "give finite numbers")
            self.step()
            return lambda x: np.asarray(number)
        if kind == "name":
            if token == "x" or token in CONSTANTS:
                self.step()
                return (lambda x: x) if token == "x" else (lambda x: np.asarray(CONSTANTS[token]))
            if token not in FUNCTIONS:
                raise self.wrong(f"found {shown(token)}", f"give {KNOWN}")
            self.step()
            if not (self.kind == "operator" and self.token == "("):
                raise self.wrong(f"{token} is not followed by a bracket", f"give {token}(...)")
        if not self.take("("):
            what = "the end" if self.kind == "end" else shown(self.token)
            raise self.wrong(f"found {what}", "give a number, x, a name or a bracket there")
        self.deeper()
        value = self.sum()
        self.depth -= 1
        if not self.take(")"):
            raise self.wrong("a bracket is not closed", "give a ) there")
        return _applied(FUNCTIONS[token], value) if kind == "name" else value


def _joined(operation: Callable[..., Real], one: Value, other: Value) -> Value:
    return lambda x: operation(one(x), other(x))


def _applied(function: Callable[..., Real], inner: Value) -> Value:
    return lambda x: function(inner(x))


# Name: the formula in x and its coefficients, and how many these are at least and at most.
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
def named_function(name: str, coefficients: Reals) -> Expression:
    """A function by name with its coefficients: polynomial, power, exponential, logarithm, sine, cosine, tangent.

    polynomial: c0 + c1 x + c2 x**2 and on; power: c0 x**c1; exponential: c0 exp(c1 x); logarithm: c0 log10(c1 x);
    sine, cosine, tangent: of c1 x + c2, rad, times c0. Gives the expression that it stands for.
    """
    if name not in NAMED:
        raise DesignError("name", f"found {shown(name)}", f"give one of {', '.join(NAMED)}")
    formula, least, most = NAMED[name]
    c = np.atleast_1d(np.asarray(coefficients, dtype=float))
    if c.ndim != 1 or not least <= len(c) <= most:
        many = f"{least}" if least == most else f"{least} to {most}"
        raise DesignError("coefficients", f"found shape {np.shape(coefficients)}", f"give {many}, of {formula}")
    told = [f"({float(value)!r})" for value in c]
    if name == "polynomial":
        text = told[-1]
        for one in told[-2::-1]:
            text = f"{one} + x*({text})"
        return Expression(text)
    for k, one in enumerate(told):
        formula = formula.replace(f"c{k}", one)
    return Expression(formula)
