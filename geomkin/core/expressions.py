"""Formulas as text: a function of one variable, and the evaluation that all formulas of recipes share."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arguments import ArgumentType
from .errors import DesignError, shown
from .records import record

Real = NDArray[np.floating[Any]]
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan,
    "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh, "exp": np.exp, "log": np.log, "log10": np.log10,
    "sqrt": np.sqrt, "abs": lambda x: np.where(np.real(x) < 0, np.negative(x), x),
}  # fmt: skip
CONSTANTS = {"pi": np.pi, "e": np.e}
OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide, ast.Pow: np.power,
    ast.USub: np.negative, ast.UAdd: np.positive,
}  # fmt: skip
# Largest numbers of characters and of nested operations, and largest number in a formula. Formulas of textbooks are far
# below; nested operations use up the stack.
LONGEST, DEEPEST, LARGEST = 500, 100, 1e300
# Imaginary step of derivatives: its square vanishes beside any number.
STEP = 1e-30


def evaluate(
    node: ast.expr,
    value_of: Callable[[str], Any],
    wrong: Callable[..., DesignError],
    calls: Mapping[str, Callable[..., Any]] = FUNCTIONS,
    special: Callable[[ast.expr], Any] = lambda node: None,
    depth: int = 1,
) -> Any:
    """The value of a formula's syntax tree.

    value_of: value of a name, None if it is unknown. wrong: the error for a node, with a problem and a remedy if they
    are known. calls: functions of one value. special: value of a node with a meaning of its own, otherwise None.
    """
    if depth > DEEPEST:
        raise wrong(node, f"found more than {DEEPEST} operations within each other", "give a flatter formula")
    if (value := special(node)) is not None:
        return value

    def inside(inner: ast.expr) -> Any:
        return evaluate(inner, value_of, wrong, calls, special, depth + 1)

    match node:
        case ast.Constant(value=float() | int() as number) if not isinstance(number, bool):
            if number < LARGEST:
                return np.asarray(float(number))
            raise wrong(node, "found a number too large", f"give numbers below {LARGEST:g}")
        case ast.Name(id=name) if name in CONSTANTS:
            return np.asarray(CONSTANTS[name])
        case ast.Name(id=name) if (value := value_of(name)) is not None:
            return value
        case ast.Call(func=ast.Name(id=name), args=[inner], keywords=[]) if name in calls:
            return calls[name](inside(inner))
        case ast.UnaryOp(op=sign, operand=inner) if type(sign) in OPERATORS:
            return OPERATORS[type(sign)](inside(inner))
        case ast.BinOp(left=left, op=sign, right=right) if type(sign) in OPERATORS:
            return OPERATORS[type(sign)](inside(left), inside(right))
    raise wrong(node)


@record(checked=True)
class Expression:
    """A function of one variable, given as text such as `log10(x)` or `2*x**1.5 - 1`.

    It allows numbers, the variable, + - * / **, brackets, and the names pi, e, sin, cos, tan, asin, acos, atan, sinh,
    cosh, tanh, exp, log (natural), log10, sqrt and abs; angles are rad. Precedence is that of Python: -x**2 is -(x**2),
    and 2**3**2 is 2**9. A call with an array returns an array, with nan or inf where the function has no value.

    Parameters
    ----------
    text : str
        The expression: at most 500 characters and 100 nested operations.
    variable : str, optional
        Name of the variable.

    Raises
    ------
    DesignError
        For any other text; the message names the position.

    Examples
    --------
    >>> from geomkin.synthesis import Expression
    >>> Expression("2*x + 1")([0, 1, 2]).tolist()
    [1.0, 3.0, 5.0]
    """

    text: Annotated[str, ArgumentType(lambda value: isinstance(value, str), "a text such as log10(x)")]
    variable: str = "x"

    def __post_init__(self) -> None:
        if len(self.text) > LONGEST:
            found = f"found {len(self.text):,} characters"
            raise DesignError("function", found, f"give at most {LONGEST}", "too-much-work")
        _ = self(0.0)  # visits the whole formula, so that an error is reported now

    @cached_property
    def _formula(self) -> ast.expr:
        try:
            return ast.parse(self.text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            raise self._wrong_at(getattr(error, "offset", None) or 1, "found no formula") from None

    def __call__(self, x: ArrayLike) -> Real:
        """Values (...,) at x (...,)."""
        return self._value(np.asarray(x, dtype=float))

    def slope(self, x: ArrayLike) -> Real:
        """Derivatives (...,) at x (...,), exact to rounding.

        Notes
        -----
        By a complex step (Squire and Trapp, SIAM Review 40, 1998).
        """
        slope: Real = self._value(np.asarray(x, dtype=float) + 1j * STEP).imag / STEP
        return slope

    def _value(self, x: NDArray[Any]) -> NDArray[Any]:
        with np.errstate(all="ignore"):
            value = evaluate(self._formula, {self.variable: x}.get, self._wrong)
            return np.asarray(value + np.zeros(x.shape))

    def _wrong(self, node: ast.expr, problem: str = "", remedy: str = "") -> DesignError:
        part = ast.get_source_segment(self.text.strip(), node)
        return self._wrong_at(node.col_offset + 1, problem or f"found {shown(part)}", remedy)

    def _wrong_at(self, place: int, problem: str, remedy: str = "") -> DesignError:
        known = ", ".join((self.variable, *CONSTANTS, *FUNCTIONS))
        remedy = remedy or f"give numbers, + - * / ** (power), brackets and {known}; write * between factors"
        return DesignError(
            "function", f"{problem} at character {place} of {shown(self.text.strip())}", remedy, "wrong-type"
        )
