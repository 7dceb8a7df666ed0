"""Arguments of public calls, refused at the door where they are not what the signature says they are.

The annotations are the one list of what may be given: `checked` holds a function to them, `check_fields` a dataclass.
What Python's own types cannot say, such as finite points of any shape, is a `ArgumentType` in the annotation.
"""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Callable, Mapping, Sequence
from functools import cache, wraps
from typing import Annotated, Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import DesignError, ProblemId, shown

P = ParamSpec("P")
R = TypeVar("R")
# Largest number, of whatever unit: from here on a fifth power overflows. Smaller refuses what can still be worked out.
LARGEST = 1e60
# Numbers that are squared and added at once: BLAS has 10,000 done by one core. Of more it wakes a thread for each other
# core, and those wait busily for tens of milliseconds, as long as a motion of a million frames takes.
ALONE = 8192


@dataclasses.dataclass(frozen=True)
class ArgumentType:
    """What an argument may be: a test that never raises, and the same in words for the one who has to mend it.

    types: those of which some values are allowed and others are out of range.
    """

    fits: Callable[[Any], bool]
    allowed: str
    types: tuple[type, ...] = ()


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """The function, which refuses by DesignError, under the argument's name, what its annotations do not allow."""
    names = function.__code__.co_varnames
    kept: dict[str, ArgumentType] = {}

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        if not kept:
            kept.update(_sorts(function))
        for name, value in zip(names, args):
            if name in kept and not kept[name].fits(value):
                raise refused(name, value, kept[name])
        for name, value in kwargs.items():
            if name in kept and not kept[name].fits(value):
                raise refused(name, value, kept[name])
        return function(*args, **kwargs)

    return call


def check_fields(thing: Any) -> None:
    """Raise DesignError for the first field of a dataclass that its annotation does not allow, bar `quantity` fields.

    Call it from `__post_init__`.
    """
    for name, sort in _field_sorts(type(thing)):  # type: ignore[arg-type]
        value = getattr(thing, name)
        if not sort.fits(value):
            raise refused(name, value, sort)


def refused(name: str, value: object, sort: ArgumentType) -> DesignError:
    """The error for an argument that is not of its sort."""
    if isinstance(value, (tuple, list)) and len(value) == 2 and all(map(is_real, value)) and sort.fits(complex(*value)):
        # A place as a recipe has it.
        problem = f"found {shown(value)}, and a place is a complex number: {complex(*value):g}"
        return DesignError(name, problem, f"give {sort.allowed}", "wrong-type")
    id: ProblemId = "out-of-range" if isinstance(value, sort.types) and not isinstance(value, bool) else "wrong-type"
    return DesignError(name, f"found {shown(value)}", f"give {sort.allowed}", "not-finite" if is_endless(value) else id)


def _sorts(function: Callable[..., Any]) -> dict[str, ArgumentType]:
    hints = get_type_hints(function, include_extras=True)
    return {name: sort for name, hint in hints.items() if (sort := argument_type(hint)) and name != "return"}


@cache
def _field_sorts(kind: type) -> tuple[tuple[str, ArgumentType], ...]:
    hints = get_type_hints(kind, include_extras=True)
    found = []
    for field in dataclasses.fields(kind):
        sort = None if "unit" in field.metadata else argument_type(hints[field.name])
        if sort and field.default is None:
            # Left out, for the class itself to fill.
            sort = _either([sort, NOTHING])
        if sort:
            found.append((field.name, sort))
    return tuple(found)


def argument_type(hint: Any) -> ArgumentType | None:
    """What an annotation allows; None for those that leave it to the code."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return next((mark for mark in inner[1:] if isinstance(mark, ArgumentType)), None) or argument_type(inner[0])
    if origin in (Union, types.UnionType):
        sorts = [argument_type(option) for option in inner]
        return None if None in sorts else _either([sort for sort in sorts if sort])
    if origin is Literal:
        words = [str(choice) for choice in inner]
        return ArgumentType(lambda value: _chosen(value, inner), _listed(words), (str,))
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
        article = "an" if hint.__name__[0] in "AEIOU" else "a"
        return ArgumentType(lambda value: isinstance(value, hint), f"{article} {hint.__name__}")
    return None


def between(least: float, most: float, unit: str = "") -> ArgumentType:
    """Of one number from `least` to `most`."""
    allowed = f"a number from {least:g} to {most:g}" + (f", in {unit}" if unit else "")
    return ArgumentType(lambda value: is_real(value) and bool(least <= value <= most), allowed, REAL)


def whole_between(least: int, most: int) -> ArgumentType:
    """Of one whole number from `least` to `most`."""
    return ArgumentType(
        lambda value: is_whole(value) and bool(least <= value <= most), f"a whole number from {least} to {most}", REAL
    )


def _either(sorts: list[ArgumentType]) -> ArgumentType:
    listed = [sort.allowed for sort in sorts if sort is not NOTHING]
    types = tuple(each for sort in sorts for each in sort.types)
    return ArgumentType(lambda value: any(sort.fits(value) for sort in sorts), _listed(listed), types)


def _listed(words: Sequence[str]) -> str:
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _chosen(value: Any, choices: tuple[Any, ...]) -> bool:
    return isinstance(value, (str, int)) and not isinstance(value, bool) and value in choices


def _row(each: ArgumentType | None, count: int | None) -> ArgumentType | None:
    if each is None:
        return None
    many = f"a row of {count}" if count else "a tuple"

    def fits(value: Any) -> bool:
        row = (isinstance(value, (tuple, list)) or getattr(value, "ndim", 0) > 0) and count in (None, len(value))
        return bool(row) and all(each.fits(v) for v in value)

    return ArgumentType(fits, f"{many}, each {each.allowed}")


def _table(key: ArgumentType | None, each: ArgumentType | None) -> ArgumentType | None:
    if key is None or each is None:
        return None

    def fits(value: Any) -> bool:
        return isinstance(value, Mapping) and all(key.fits(k) and each.fits(v) for k, v in value.items())

    return ArgumentType(fits, f"a table, each {each.allowed}")


def _alone(value: Any) -> Any:
    """One number of NumPy's as Python's, which no limit is too large for."""
    return value.item() if isinstance(value, (np.ndarray, np.generic)) and not value.ndim else value


def is_real(value: Any) -> bool:
    """Whether this is one finite real number of bearable size."""
    value = _alone(value)
    return isinstance(value, REAL) and not isinstance(value, bool) and bool(-LARGEST < value < LARGEST)


def is_whole(value: Any) -> bool:
    """Whether this is one whole number of bearable size; 3.0 is none."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and -LARGEST < int(value) < LARGEST


def is_complex(value: Any) -> bool:
    """Whether this is one finite number, real or complex, of bearable size."""
    value = _alone(value)
    if isinstance(value, COMPLEX):
        return bool(-LARGEST < value.real < LARGEST and -LARGEST < value.imag < LARGEST)
    return is_real(value)


def numbers(value: Any, kinds: str = "iufc") -> NDArray[Any] | None:
    """The value as an array of numbers of these NumPy kinds, nan allowed; None where it is none."""
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
    """Whether this is a number or an array of numbers of which one is infinite or nan."""
    array = numbers(value)
    return array is not None and not np.isfinite(array).all()


def _whole(value: Any, kinds: str = "iufc") -> NDArray[Any] | None:
    """The same of what can be added to and multiplied, as a list cannot."""
    return None if isinstance(value, (list, tuple)) else numbers(value, kinds)


def _bounded(array: NDArray[Any] | None, gaps: bool = False) -> bool:
    """Whether all is finite and of bearable size; `gaps`: or nan."""
    if array is None:
        return False
    # In single precision neither the squares nor the limit are finite.
    array = array.astype(np.result_type(array.dtype, float), copy=False) if array.dtype.kind in "fc" else array
    if gaps:
        return bool((np.isnan(array) | (np.abs(array) < LARGEST)).all())
    if array.dtype.kind in "iu":
        return True
    if array.size > ALONE:
        row = array.reshape(-1)
        return all(_bounded(row[start : start + ALONE]) for start in range(0, row.size, ALONE))
    # The sum of squares, in one pass: nan and infinity show in it as well.
    squares = array.dot(array) if array.ndim == 1 and array.dtype.kind == "f" else np.vdot(array, array).real
    return bool(squares < LARGEST**2)


def are_reals(value: Any) -> bool:
    """Whether these are finite real numbers, of any shape."""
    if type(value) is float:
        return -LARGEST < value < LARGEST
    return _bounded(numbers(value, "iuf"))


def are_points(value: Any) -> bool:
    """Whether these are finite complex numbers, of any shape, and not pairs x, y."""
    array = numbers(value)
    if array is not None and array.dtype.kind != "c" and array.ndim and array.shape[-1] == 2:
        # A row of two places on the x axis would be the same numbers: in a list or an array it is taken as that.
        pairs = array.ndim > 1 or isinstance(value, tuple)
        return not pairs and _bounded(array)
    return _bounded(array)


def is_place(value: Any) -> bool:
    """Whether this is a finite complex number or an array of them: a list would not add up."""
    if type(value) in (int, float, complex):
        return is_complex(value)
    return not isinstance(value, (list, tuple)) and are_points(value)


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
    np.ndarray: ArgumentType(lambda value: _whole(value) is not None, "a number or an array of numbers"),
}
# The same by the kind of number, as `plane.vec` names them; what is real or whole serves for complex.
ARRAYS = {
    np.floating: ArgumentType(lambda value: _whole(value, "iuf") is not None, "a real number or an array of them"),
    np.integer: ArgumentType(lambda value: _whole(value, "iu") is not None, "a whole number or an array of them"),
    np.bool_: ArgumentType(lambda value: _whole(value, "b") is not None, "True or False, or an array of them"),
}
Reals = Annotated[ArrayLike, ArgumentType(are_reals, "finite real numbers, one or an array")]
# The same with nan allowed, where one is not known.
RealsOrNan = Annotated[
    ArrayLike, ArgumentType(lambda value: _bounded(numbers(value, "iuf"), True), "real numbers, one or an array")
]
# The same with infinity allowed, as where a point of a ray may be at infinity.
Extended = Annotated[
    ArrayLike, ArgumentType(lambda value: numbers(value, "iuf") is not None, "real numbers, one or an array")
]
Numbers = Annotated[ArrayLike, ArgumentType(lambda value: numbers(value) is not None, "numbers, one or an array")]
# Of a field that is one place, or one for each of many linkages.
Place = Annotated[
    complex | NDArray[Any], ArgumentType(is_place, "a finite complex number, x + yj, or an array of them")
]
# The points that a curve is made of, in a row.
RealRow = Annotated[
    NDArray[np.floating[Any]],
    ArgumentType(lambda value: are_reals(value) and np.ndim(value) == 1, "a row of finite numbers"),
]
Row = Annotated[
    NDArray[np.complexfloating[Any, Any]],
    ArgumentType(lambda value: are_points(value) and np.ndim(value) == 1, "a row of finite points x + yj"),
]
Count = Annotated[int, ArgumentType(lambda value: is_whole(value) and value > 0, "a whole number above 0", REAL)]
Positive = Annotated[float, ArgumentType(lambda value: is_real(value) and value > 0, "a number above 0", REAL)]
# What a number was found to be, which may be nothing.
Found = Annotated[
    float, ArgumentType(lambda value: isinstance(value, REAL) and not isinstance(value, bool), "a number")
]
# Places over the frames, nan where there is none.
Places = Annotated[
    ArrayLike, ArgumentType(lambda value: _bounded(numbers(value), True), "places x + yj, one or an array")
]
Points = Annotated[ArrayLike, ArgumentType(are_points, "finite points as complex numbers x + yj, one or an array")]
