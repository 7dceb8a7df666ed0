"""Declarations of sizes: each serves the range check, error messages, templates and the schema.

A size is a dataclass field whose metadata states its meaning, unit and limits.

Also short representations of objects: one line for `repr`, and drawings for notebooks.
"""

from __future__ import annotations

import dataclasses
import re
from collections import UserDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING
from decimal import Decimal
from fractions import Fraction
from functools import cache
from math import inf, isfinite, nextafter
from operator import ge, gt, le, lt
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from .arguments import SMALLEST as SMALLEST
from .arguments import (
    ArgumentType,
    between,
    check_fields,
    found_value,
    in_unit_of,
    is_complex,
    is_endless,
    is_place,
    numbers,
)
from .arguments import point_of as point_of
from .errors import DesignError, ProblemId, harmless, shown
from .field_visitor import WrittenForm
from .named import VIEWS, named
from .units import DIGITS_IN_TEXT, Sentence, bare_mm, converted_power, marked, unit_name
from .units import rounded_down as rounded_down
from .units import rounded_up as rounded_up
from .units import to_digits as to_digits

# Most characters of a whole line, and of one of its fields. A longer line wraps in a terminal; a longer field leaves no
# room for the others.
LONGEST, LONGEST_FIELD = 120, 40
# Words for NumPy's one-letter kinds of elements.
KINDS = {"f": "real", "c": "complex", "i": "whole", "u": "whole", "b": "bool", "U": "text"}


def one_line(self: Any) -> str:
    """Text for `__repr__`: the class and its fields, without those that have their default.

    Arrays are shown by shape and kind, sequences by their length, other things by their class alone. A class
    takes it by `__repr__ = one_line` in its body; every curve has it.
    """
    fields = dataclasses.fields(self) if dataclasses.is_dataclass(self) else ()
    shown = [(f.name, getattr(self, f.name)) for f in fields if f.repr and not _is_default(f, getattr(self, f.name))]
    return clipped(f"{type(self).__name__}({', '.join(f'{name}={short(value)}' for name, value in shown)})")


def _is_default(field: dataclasses.Field[Any], value: object) -> bool:
    plain = isinstance(value, (str, int, float, complex))
    return value is field.default or (plain and type(value) is type(field.default) and bool(value == field.default))


def clipped(text: str, longest: int = LONGEST) -> str:
    """The text on one line of at most `longest` characters; a shortened text keeps its last one, such as a bracket."""
    text = harmless(text)
    return text if len(text) <= longest else f"{text[: longest - 4]}...{text[-1]}"


def short(value: object) -> str:
    """A value in few characters."""
    if isinstance(value, np.ndarray) and value.ndim:
        return f"<{' x '.join(map(str, value.shape))} {KINDS.get(value.dtype.kind, value.dtype.name)}>"
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.item()
    if isinstance(value, (float, complex)):
        return f"{value:.6g}"
    if value is None or isinstance(value, (str, int)):
        return clipped(shown(value), LONGEST_FIELD)
    if isinstance(value, Mapping):
        return clipped(f"{{{', '.join(map(str, value))}}}", LONGEST_FIELD)
    if isinstance(value, (tuple, list)):
        each = [short(item) for item in value] if len(value) < 4 else []
        line = f"({', '.join(each)})"
        if len(each) == len(value) and not any("(...)" in text for text in each) and len(line) <= LONGEST_FIELD:
            return line
        return f"<{len(value)} {' or '.join(sorted({type(item).__name__ for item in value}))}>"
    return value.__name__ if callable(value) and hasattr(value, "__name__") else f"{type(value).__name__}(...)"


def moving_picture(self: Any) -> str:
    """The moving drawing as HTML, or why there is none; a class has it by `_repr_html_ = moving_picture`."""
    html: str = named(VIEWS["moving"])(self)
    return html


def still_picture(self: Any, curves: Sequence[Any], marks: Sequence[Any] = ()) -> str | None:
    """Curves and engraved marks of an object as SVG, for `_repr_svg_`; None if they cannot be drawn."""
    svg: str | None = named(VIEWS["still"])(repr(self), curves, marks)
    return svg


T = TypeVar("T")


def quantity(
    meaning: str,
    unit: str = "",
    *,
    default: Any = MISSING,
    example: Any = None,
    above: float | None = None,
    at_least: float | None = None,
    below: float | None = None,
    at_most: float | None = None,
    whole: bool = False,
    filled_in: float | None = None,
    printed: float = 0.0,
) -> Any:
    """A dataclass field for a number: its meaning, unit and limits, and an example for templates.

    filled_in: value of an omitted quantity whose default is None, in the usual case. printed: its share of the
    clearance of a printed mechanism; 0 if it does not depend on it.
    """
    limits = {"gt": above, "ge": at_least, "lt": below, "le": at_most}
    metadata: dict[str, Any] = {"description": f"{meaning}, {unit}" if unit else meaning, "unit": unit}
    metadata |= {name: limit for name, limit in limits.items() if limit is not None}
    metadata |= {"whole": True} if whole else {}
    metadata["examples"] = [_example(example, default)]
    metadata["filled_in"] = filled_in
    metadata |= {"printed": printed} if printed else {}
    return dataclasses.field(default=default, metadata=metadata)


def entry(
    meaning: str,
    *,
    default: Any = MISSING,
    default_factory: Any = MISSING,
    example: Any = None,
    units: tuple[str, ...] | None = None,
) -> Any:
    """A dataclass field that is not a number (a choice, a point, a table): its meaning and an example.

    units: of the numbers in a row, or in each of several rows.
    """
    metadata: dict[str, Any] = {
        "description": meaning,
        "examples": [_example(example, default) if default_factory is MISSING else default_factory()],
    }
    if units is not None:
        metadata["units"] = units
    if default_factory is not MISSING:
        # Tables are mutable: they are compared, and a hash leaves them out.
        return dataclasses.field(default_factory=default_factory, hash=False, metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def _example(example: Any, default: Any) -> Any:
    """The example, else the default; None if there is neither, since MISSING is no value of JSON."""
    return example if example is not None or default is MISSING else default


def allowed(metadata: Any) -> Sentence:
    """The range of a quantity in words, e.g. `a number above 0, in mm`."""
    words = {"gt": ("above", "up6"), "ge": ("at least", "up6"), "lt": ("below", "down6"), "le": ("at most", "down6")}
    unit = metadata.get("unit", "")
    power = converted_power(unit)
    limits = [
        f"{word} {format(bare_mm(metadata[key], power=power), side)}"
        for key, (word, side) in words.items()
        if key in metadata
    ]
    text = ("a whole number " if metadata.get("whole") else "a number ") + " and ".join(limits)
    return Sentence(text.strip() + in_unit_of(unit))


def check_sizes(thing: Any, many: bool = False) -> None:
    """Raise DesignError for the first field of a dataclass that does not satisfy its declaration.

    Call it from `__post_init__`. If `many`, arrays of numbers pass if every element does.
    """
    check_quantities(thing, many)
    check_fields(thing)


def check_quantities(thing: Any, many: bool = False) -> None:
    """Raise DesignError for the first quantity that is not a finite number in its range."""
    rows: dict[str, int] = {}
    for field, types, least, most in _quantities(type(thing)):  # type: ignore[arg-type]
        about, value = field.metadata, getattr(thing, field.name)
        if (type(value) in types and least <= value <= most) or (value is None and field.default is None):
            continue
        unit = about["unit"]
        if isinstance(value, Fraction) and not about.get("whole"):
            value = float(value)
            object.__setattr__(thing, field.name, value)
        if not quantity_fits(value, about, many):
            problem, id = f"found {found_value(value, unit)}", refusal_id(value, about)
            raise DesignError(field.name, problem, f"give {marked(allowed(about))}", id)
        if _is_tiny(value, about):
            smallest = bare_mm(SMALLEST, power=converted_power(unit))
            remedy = f"give {'0 or ' if 'ge' in about else ''}at least {smallest:up} {unit_name(unit)}".strip()
            raise DesignError(
                field.name, f"found {found_value(value, unit)}, which is too small", remedy, "out-of-range"
            )
        if many and np.ndim(value):
            rows[field.name] = len(value)
    if len(set(rows.values()) - {1}) > 1:
        first, *others = (name for name, row in rows.items() if row != 1)
        other = next(name for name in others if rows[name] != rows[first])
        found = f"found {rows[other]} sizes, but {rows[first]} of {first}"
        raise DesignError(other, found, "give one number, or arrays of the same length", "conflict")


@cache
def _quantities(kind: type) -> tuple[tuple[dataclasses.Field[Any], tuple[type, ...], float, float], ...]:
    """The quantities of a class, each with types of number and a range in which all of them fit, the usual case.

    NumPy's functions, which decide about any other value, take ten times as long for one number.
    """
    usual = []
    for field in dataclasses.fields(kind):
        if "unit" in (about := field.metadata):
            least = max(nextafter(about.get("gt", -inf), inf), about.get("ge", -inf))
            most = min(nextafter(about.get("lt", inf), -inf), about.get("le", inf), LARGEST_WHOLE)
            least = max(least, SMALLEST) if _has_one_sign(about) else least
            usual.append((field, (int,) if about.get("whole") else (float, int, np.float64), least, most))
    return tuple(usual)


def last_fit(fits: Callable[[float], bool], good: float, bad: float) -> float:
    """The size nearest to `bad` that still fits, to rounding, by bisection between `good`, which fits, and `bad`."""
    for _ in range(60):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if fits(middle) else (good, middle)
    return good


# Share by which a limit that is advised is inside the computed one, which may be a rounding error beyond.
ROUNDING = 1e-9


def inside(limit: float, side: Literal[1, -1], digits: int = DIGITS_IN_TEXT) -> str:
    """A number just inside a limit that it may not reach, as text; side: 1 for an upper limit, -1 for a lower one."""
    return (rounded_down if side > 0 else rounded_up)(limit - side * abs(limit) * 10.0 ** (1 - digits), digits)


def to_digits_or_none(value: float | np.floating[Any], digits: int = 9) -> float | None:
    """A value rounded to significant digits; None, which JSON writes as null, if it is not finite."""
    return to_digits(value, digits) if isfinite(value) else None


def refusal_id(value: Any, about: Any) -> ProblemId:
    """Id of the problem of a value that does not fit."""
    if isinstance(value, (list, tuple)):
        return "wrong-type"
    if is_endless(value):
        return "not-finite"
    return "out-of-range" if numbers(value, "iu" if about.get("whole") else "iuf") is not None else "wrong-type"


_TESTS: dict[str, Callable[[Any, Any], Any]] = {"gt": gt, "ge": ge, "lt": lt, "le": le}


def quantity_fits(value: Any, about: Any, many: bool = False) -> bool:
    """Whether a value is a finite number in the range that a field declares, or many of them."""
    number = numbers(value, "iu" if about.get("whole") else "iuf")
    if number is None or isinstance(value, (list, tuple)) or (number.ndim and not many):
        return False
    if not np.isfinite(number).all():
        return False
    # In half precision the limits would be infinite.
    number = number.astype(float) if number.dtype.kind == "f" else number
    return all(np.all(test(number, about[key])) for key, test in _TESTS.items() if key in about)


# Up to this number every whole number is also a floating-point number.
LARGEST_WHOLE = 2.0**53


def _has_one_sign(about: Any) -> bool:
    return not about.get("whole") and about.get("gt", about.get("ge")) == 0


def _is_tiny(value: Any, about: Any) -> bool:
    """Whether a size of one sign is too small for calculations, but not 0."""
    number = np.abs(np.asarray(value, dtype=float))
    return _has_one_sign(about) and bool(((number > 0) & (number < SMALLEST)).any())


# Largest width of a written part, mm. A larger one is a mistake of units, and its points would fill the disk.
WIDEST = 1e5
# Largest length, mm. A larger one is a mistake of units, and its squares and cubes overflow.
FARTHEST = 1e9
# A length that may be 0, and one that may not, mm.
Length = Annotated[float, between(0, FARTHEST, "mm")]
Size = Annotated[float, between(SMALLEST, FARTHEST, "mm")]
# A coordinate, or another number of a row.
Coordinate = Annotated[float, between(-FARTHEST, FARTHEST)]


class PointXY(ArgumentType):
    """Marks a complex field that a recipe gives as `[x, y]` in mm; coordinates below `SMALLEST` count as 0.

    many: in the library it may be an array, with one point for each linkage.
    """

    def __init__(self, many: bool = False) -> None:
        def fits(value: Any) -> bool:
            if isinstance(value, complex):
                return abs(value.real) <= FARTHEST and abs(value.imag) <= FARTHEST
            if not is_place(value) or (np.ndim(value) and not many):
                return False
            return bool((np.abs([np.real(value), np.imag(value)]) <= FARTHEST).all())

        within = f"x and y within {bare_mm(FARTHEST):g} of 0"
        super().__init__(fits, f"a finite complex number, x + yj{in_unit_of('mm')}, {within}")


FloatOrArray = float | NDArray[np.float64]
ComplexPoint = Annotated[complex, PointXY()]
ComplexOrArray = Annotated[complex | NDArray[Any], PointXY(many=True)]
# A point of a body: its name, or its position in the body's frame, mm.
PlaceOnBody = Annotated[
    str | complex,
    ArgumentType(lambda value: isinstance(value, str) or is_complex(value), "a point's name, or its position x + yj"),
]


# A fraction as a recipe gives it, such as 10/3 or 47.5 / 12.
FRACTION = re.compile(r"\s*(\d{1,15}(?:\.\d{1,15})?)\s*/\s*(\d{1,15}(?:\.\d{1,15})?)\s*")
# Longest decimal that is meant exactly, and largest denominator of a fraction that is written for a longer one.
EXACT_DIGITS, MOST_PARTS = 9, 10**5


class FractionText(WrittenForm):
    """Marks a ratio that a recipe may also give as a fraction in a text, such as "10/3"."""

    def read(self, given: Any, folder: Any) -> Any:
        match = FRACTION.fullmatch(given) if isinstance(given, str) else None
        return float(Fraction(match[1]) / Fraction(match[2])) if match and Fraction(match[2]) else given

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        return as_fraction(value)

    def schema(self, of_type: dict[str, Any]) -> dict[str, Any]:
        return {"anyOf": [of_type, {"type": "string", "pattern": f"^{FRACTION.pattern}$"}]}


def as_fraction(ratio: float) -> float | str:
    """A ratio as a recipe has it: the fraction in a text if it is one with many decimals, otherwise the number."""
    fraction = Fraction(ratio).limit_denominator(MOST_PARTS)
    is_fraction = significant_digits(ratio)[0] > EXACT_DIGITS and float(fraction) == ratio and fraction.denominator > 1
    return str(fraction) if is_fraction else ratio


def significant_digits(number: float) -> tuple[int, float]:
    """Number of significant digits of a decimal as it is written, and the value of the last one."""
    _, digits, exponent = Decimal(repr(float(number))).normalize().as_tuple()
    return len(digits), 10.0 ** int(exponent)


Ratio = Annotated[float, FractionText()]


class KindTable(UserDict[str, type[T]]):
    """A mapping of `kind` to the dataclass of a recipe's table; a later change of the mapping affects all recipes.

    A class that lacks an abstract method is refused when its row is added; the message lists the missing names.
    """

    def __setitem__(self, kind: str, table: type[T]) -> None:
        if missing := getattr(table, "__abstractmethods__", None):
            raise TypeError(f"{table.__name__} lacks {', '.join(sorted(missing))}")
        super().__setitem__(kind, table)

    def __repr__(self) -> str:
        return clipped(f"KindTable({', '.join(self)})")


Rows = tuple[tuple[Coordinate, Coordinate], ...]
