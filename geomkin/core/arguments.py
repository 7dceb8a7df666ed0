"""Validation of arguments and fields by their annotations.

`checked` validates the arguments of a function, `check_fields` the fields of a dataclass. `float | ArrayLike` allows
finite real numbers of any shape, `complex | ArrayLike` finite points. A condition that plain types cannot express, such
as a number above 0, is an `ArgumentType` in an `Annotated`.
"""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Callable, Mapping, Sequence
from functools import cache, wraps
from typing import Annotated, Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import DesignError, ProblemId, shown, with_article
from .units import PLURAL, as_sentences, bare_mm, converted_power, marked, unit_name

P = ParamSpec("P")
R = TypeVar("R")
# Largest number, in any unit. The fifth power of larger ones overflows; a smaller limit refuses computable values.
LARGEST = 1e60
# Smallest size that is not 0, in its unit. In mm it is a hundred-thousandth of an atom. Products of a few smaller sizes
# underflow, and their quotients overflow. A size that may be negative is a coordinate or an angle; a tiny
# one is a rounded 0, so it has no such limit.
SMALLEST = 1e-12
# Numbers that are squared and added at once. BLAS uses one core for up to 10,000. For more it wakes a thread on each
# core; these threads then wait busily for tens of milliseconds, as long as a motion of a million frames takes.
CHUNK = 8192


@dataclasses.dataclass(frozen=True)
class ArgumentType:
    """The values that an argument may have.

    Parameters
    ----------
    fits : callable
        Whether a value is allowed; never raises.
    allowed : str
        The allowed values in words, for error messages.
    types : tuple of type
        A refused value of one of these types counts as out of range, any other as of a wrong type.
    each : ArgumentType, optional
        The values that each item of a row may have; errors then name the item.
    limits : tuple of float, optional
        The least and the largest value, for the schema.
    unit : str, optional
        Unit of the number.
    """

    fits: Callable[[Any], bool]
    allowed: str
    types: tuple[type, ...] = ()
    each: ArgumentType | None = None
    limits: tuple[float, float] | None = None
    unit: str = ""

    def __post_init__(self) -> None:
        as_sentences(self, "allowed")


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function raise DesignError for the first argument that its annotation does not allow."""
    names = function.__code__.co_varnames
    expected: dict[str, ArgumentType] = {}

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        if not expected:
            hints = get_type_hints(function, include_extras=True)
            types = {name: argument_type(hint) for name, hint in hints.items() if name != "return"}
            expected.update({name: type for name, type in types.items() if type})
        for name, value in (*zip(names, args), *kwargs.items()):
            if name in expected and not expected[name].fits(value):
                raise refused(name, value, expected[name])
        return function(*args, **kwargs)

    return call


def check_fields(thing: Any) -> None:
    """Raise DesignError for the first field of a dataclass that its annotation does not allow.

    Fields by `quantity` are skipped, since `check_sizes` validates them. Call it from `__post_init__`.
    """
    for name, expected in _field_types(type(thing)):  # type: ignore[arg-type]
        value = getattr(thing, name)
        if not expected.fits(value):
            raise refused(name, value, expected)


def refused(name: str, value: object, expected: ArgumentType) -> DesignError:
    """The error for an argument that is not of the expected type."""
    if expected.each and isinstance(value, (tuple, list)):
        wrong = next((k for k, item in enumerate(value) if not expected.each.fits(item)), None)
        if wrong is not None:
            return refused(f"{name}[{wrong}]", value[wrong], expected.each)
    remedy = f"give {marked(expected.allowed)}"
    is_pair = isinstance(value, (tuple, list)) and len(value) == 2 and all(map(is_real, value))
    if is_pair and expected.fits(complex(*value)):  # type: ignore[misc]
        # Recipes give points as pairs.
        problem = f"found {shown(value)}, but a point is a complex number: {complex(*value):g}"  # type: ignore[misc]
        return DesignError(name, problem, remedy, "wrong-type")
    is_right_type = isinstance(value, expected.types) and not isinstance(value, bool)
    id: ProblemId = "not-finite" if is_endless(value) else "out-of-range" if is_right_type else "wrong-type"
    return DesignError(name, f"found {found_value(value, expected.unit)}", remedy, id)


def found_value(value: object, *units: str) -> str:
    """A refused value as it was written; numbers of units with mm, also those in a short row, in the reader's unit."""
    if not any(map(converted_power, units)):
        return shown(value)
    if isinstance(value, list) and len(value) < 5:
        return f"[{', '.join(found_value(item, units[k % len(units)]) for k, item in enumerate(value))}]"
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return f"{bare_mm(value, power=converted_power(units[0]))}" if is_number else shown(value)


def in_unit_of(unit: str) -> str:
    """The end of a phrase that states the unit of its numbers, such as `, in mm`; empty without a unit."""
    return f", in {unit_name(PLURAL if unit == 'mm' else unit)}" if unit else ""


@cache
def _field_types(kind: type) -> tuple[tuple[str, ArgumentType], ...]:
    hints = get_type_hints(kind, include_extras=True)
    expected = []
    for field in dataclasses.fields(kind):
        type = None if "unit" in field.metadata else argument_type(hints[field.name])
        if type and field.default is None:
            # The class itself fills in an omitted field.
            type = _any_of([type, NOTHING])
        if type:
            expected.append((field.name, type))
    return tuple(expected)


def argument_type(hint: Any) -> ArgumentType | None:
    """The values that an annotation allows, or None if it is not validated."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return next((mark for mark in inner[1:] if isinstance(mark, ArgumentType)), None) or argument_type(inner[0])
    if origin in (Union, types.UnionType):
        first = next(option for option in inner if option is not type(None))
        if first in ARRAY_LIKE and set(get_args(ArrayLike) or [ArrayLike]) <= set(inner):
            # `float | ArrayLike` and `complex | ArrayLike` are equal sets of types; their first member differs.
            # Optional ones are written `None | complex | ArrayLike`: with None last, Python may return the equal union
            # `ArrayLike | None` of another package in its place.
            return _any_of([ARRAY_LIKE[first], *([NOTHING] if type(None) in inner else [])])
        options = [argument_type(option) for option in inner]
        return None if None in options else _any_of([option for option in options if option])
    if origin is Literal:
        return ArgumentType(lambda value: _is_choice(value, inner), _listed([str(choice) for choice in inner]), (str,))
    if origin in (tuple, Sequence, list) and inner:
        return _row(argument_type(inner[0]), None if inner[-1] is ... or origin is not tuple else len(inner))
    if origin is Mapping:
        return _table(argument_type(inner[0]), argument_type(inner[1]))
    if origin is Callable or hint is Callable:
        return ArgumentType(callable, "a function")
    if origin is np.ndarray:
        number = get_args(inner[1])[0]
        return ARRAYS.get(get_origin(number) or number, PLAIN[np.ndarray])
    if hint in PLAIN:
        return PLAIN[hint]
    if isinstance(hint, type) and hint is not Any and not getattr(hint, "_is_protocol", False):
        return ArgumentType(lambda value: isinstance(value, hint), with_article(hint.__name__.removeprefix("Abstract")))
    return None


def number_range(least: float, most: float, unit: str) -> str:
    """The numbers from `least` to `most` in words, without their unit."""
    low, high = (bare_mm(limit, power=converted_power(unit)) for limit in (least, most))
    return f"a number from {low:up6} to {high:down6}"


def between(least: float, most: float, unit: str = "") -> ArgumentType:
    """One number from `least` to `most`."""
    allowed = f"{number_range(least, most, unit)}{in_unit_of(unit)}"
    # A recipe may state lengths in inches.
    limits = None if unit == "mm" else (least, most)

    def fits(value: Any) -> bool:
        return is_real(value) and bool(least <= value <= most)

    return ArgumentType(fits, allowed, REAL, limits=limits, unit=unit)


def whole_between(least: int, most: int) -> ArgumentType:
    """One whole number from `least` to `most`."""
    return ArgumentType(
        lambda value: is_whole(value) and bool(least <= value <= most),
        f"a whole number from {least} to {most}",
        REAL,
        limits=(least, most),
    )


def _any_of(options: list[ArgumentType]) -> ArgumentType:
    if len(options) == 1:
        return options[0]
    allowed = _listed([marked(option.allowed) for option in options if option is not NOTHING])
    types = tuple(each for option in options for each in option.types)
    rows = [option.each for option in options if option.each]
    each = rows[0] if len(rows) == 1 else None
    return ArgumentType(lambda value: any(option.fits(value) for option in options), allowed, types, each)


def _listed(words: Sequence[str]) -> str:
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _is_choice(value: Any, choices: tuple[Any, ...]) -> bool:
    return isinstance(value, (str, int)) and not isinstance(value, bool) and value in choices


def _row(each: ArgumentType | None, count: int | None) -> ArgumentType | None:
    if each is None:
        return None
    many = f"a list of {count}" if count else "a list"

    def fits(value: Any) -> bool:
        row = (isinstance(value, (tuple, list)) or getattr(value, "ndim", 0) > 0) and count in (None, len(value))
        return bool(row) and all(each.fits(v) for v in value)

    return ArgumentType(fits, f"{many}, each item {marked(each.allowed)}", each=each)


def _table(key: ArgumentType | None, each: ArgumentType | None) -> ArgumentType | None:
    if key is None or each is None:
        return None

    def fits(value: Any) -> bool:
        return isinstance(value, Mapping) and all(key.fits(k) and each.fits(v) for k, v in value.items())

    return ArgumentType(fits, f"a table, each {marked(each.allowed)}")


def _python_number(value: Any) -> Any:
    """A NumPy scalar as a Python number, since LARGEST overflows the smaller NumPy types."""
    return value.item() if isinstance(value, (np.ndarray, np.generic)) and not value.ndim else value


def is_real(value: Any) -> bool:
    """Whether a value is one real number below LARGEST."""
    value = _python_number(value)
    return isinstance(value, REAL) and not isinstance(value, bool) and bool(-LARGEST < value < LARGEST)


def is_whole(value: Any) -> bool:
    """Whether a value is one whole number below LARGEST; 3.0 is not."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and -LARGEST < int(value) < LARGEST


def point_of(x: float, y: float) -> complex:
    """A point as a recipe states it: coordinates below `SMALLEST` are 0, and no 0 is negative."""
    return complex(*(value if abs(value) >= SMALLEST else 0.0 for value in (x, y)))


def is_complex(value: Any) -> bool:
    """Whether a value is one number, real or complex, with both parts below LARGEST."""
    value = _python_number(value)
    if isinstance(value, COMPLEX):
        return bool(-LARGEST < value.real < LARGEST and -LARGEST < value.imag < LARGEST)
    return is_real(value)


def numbers(value: Any, kinds: str = "iufc") -> NDArray[Any] | None:
    """The value as an array of these NumPy kinds, which may hold nan; None if it is not one."""
    if isinstance(value, np.ndarray):
        return value if value.dtype.kind in kinds else None
    if isinstance(value, (str, bytes)):
        return None
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, OverflowError):
        return None
    return array if array.dtype.kind in kinds else None


def is_endless(value: Any) -> bool:
    """Whether a value is a number or an array of numbers, and one of them is infinite or nan."""
    array = numbers(value)
    return array is not None and not np.isfinite(array).all()


def _not_a_list(value: Any, kinds: str = "iufc") -> NDArray[Any] | None:
    """`numbers(value)`, but None for a list or tuple, which cannot be multiplied."""
    return None if isinstance(value, (list, tuple)) else numbers(value, kinds)


def _bounded(array: NDArray[Any] | None, gaps: bool = False) -> bool:
    """Whether all numbers are below LARGEST; with `gaps` they may also be nan."""
    if array is None:
        return False
    # In single precision neither the squares nor the limit are finite.
    if array.dtype.kind in "fc" and array.dtype not in (np.float64, np.complex128):
        array = array.astype(np.result_type(array.dtype, float))
    if gaps:
        return bool((np.isnan(array) | (np.abs(array) < LARGEST)).all())
    if array.dtype.kind in "iu":
        return True
    if array.size > CHUNK:
        row = array.reshape(-1)
        return all(_bounded(row[start : start + CHUNK]) for start in range(0, row.size, CHUNK))
    # The sum of squares takes one pass and is not below the limit if there is a nan or infinity.
    with np.errstate(over="ignore"):
        squares = array.dot(array) if array.ndim == 1 and array.dtype.kind == "f" else np.vdot(array, array).real
    return bool(squares < LARGEST**2)


def are_reals(value: Any) -> bool:
    """Whether a value is one or more finite real numbers, of any shape."""
    if isinstance(value, float):
        return bool(-LARGEST < value < LARGEST)
    return _bounded(numbers(value, "iuf"))


def are_points(value: Any) -> bool:
    """Whether a value is one or more finite complex numbers, of any shape, and not pairs x, y."""
    array = numbers(value)
    if array is not None and array.dtype.kind != "c" and array.ndim and array.shape[-1] == 2:
        # Two numbers may be a pair x, y or two points on the x axis. A list or an array of two is taken as points.
        pairs = array.ndim > 1 or isinstance(value, tuple)
        return not pairs and _bounded(array)
    return _bounded(array)


def is_place(value: Any, gaps: bool = False) -> bool:
    """Whether a value is a finite complex number or an array of them; a list is not, since it cannot be multiplied.

    With `gaps` numbers of an array may also be nan.
    """
    if isinstance(value, (float, complex)) or type(value) is int:
        # The usual case; NumPy's functions take ten times as long for one number.
        return bool(-LARGEST < value.real < LARGEST and -LARGEST < value.imag < LARGEST)
    return not isinstance(value, (list, tuple)) and (_bounded(numbers(value), True) if gaps else are_points(value))


REAL, COMPLEX = (int, float, np.integer, np.floating), (complex, np.complexfloating)
NOTHING = ArgumentType(lambda value: value is None, "nothing")
NUMBER = ArgumentType(is_real, "a finite number")
PLAIN = {
    float: NUMBER,
    int: ArgumentType(is_whole, "a whole number"),
    complex: ArgumentType(is_complex, "a finite complex number, x + yj"),
    bool: ArgumentType(lambda value: isinstance(value, (bool, np.bool_)), "True or False"),
    str: ArgumentType(lambda value: isinstance(value, str), "a text"),
    type(None): NOTHING,
    np.ndarray: ArgumentType(lambda value: _not_a_list(value) is not None, "a number or an array of numbers"),
}
# Arrays by the type of number; integers also serve as real numbers, and these as complex ones.
ARRAYS = {
    np.floating: ArgumentType(lambda value: _not_a_list(value, "iuf") is not None, "a real number or an array of them"),
    np.integer: ArgumentType(lambda value: _not_a_list(value, "iu") is not None, "a whole number or an array of them"),
    np.bool_: ArgumentType(lambda value: _not_a_list(value, "b") is not None, "True or False, or an array of them"),
}
# `float | ArrayLike` and `complex | ArrayLike`, by their first member.
ARRAY_LIKE = {
    float: ArgumentType(are_reals, "finite real numbers, one or an array"),
    complex: ArgumentType(are_points, "finite points as complex numbers x + yj, one or an array"),
}
FloatOrNan = Annotated[
    ArrayLike, ArgumentType(lambda value: _bounded(numbers(value, "iuf"), True), "real numbers, one or an array")
]
ComplexOrNan = Annotated[
    ArrayLike, ArgumentType(lambda value: _bounded(numbers(value), True), "points x + yj, one or an array")
]
# These may be infinite.
AnyFloat = Annotated[
    ArrayLike, ArgumentType(lambda value: numbers(value, "iuf") is not None, "real numbers, one or an array")
]
AnyComplex = Annotated[ArrayLike, ArgumentType(lambda value: numbers(value) is not None, "numbers, one or an array")]
# One-dimensional.
FloatRow = Annotated[
    NDArray[np.floating[Any]],
    ArgumentType(lambda value: are_reals(value) and np.ndim(value) == 1, "a row of finite numbers"),
]
ComplexRow = Annotated[
    NDArray[np.complexfloating[Any, Any]],
    ArgumentType(lambda value: are_points(value) and np.ndim(value) == 1, "a row of finite points x + yj"),
]
PositiveInt = Annotated[int, ArgumentType(lambda value: is_whole(value) and value > 0, "a whole number above 0", REAL)]
PositiveFloat = Annotated[float, ArgumentType(lambda value: is_real(value) and value > 0, "a number above 0", REAL)]
NonZeroFloat = Annotated[
    float, ArgumentType(lambda value: is_real(value) and value != 0, "a number other than 0", REAL)
]
