"""One visitor of fields: what a dataclass declares, and its numbers: by dotted key, changed, and in another size."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import MISSING
from functools import cache, cached_property
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from .arguments import ArgumentType, between, checked, point_of
from .errors import DesignError, shown
from .units import length_power, marked

T = TypeVar("T")
# The field of a dataclass that a recipe writes as the list of its rows, such as a motion program.
ROWS = "segments"


class WrittenForm:
    """Marks a type whose values a recipe writes in another form; by default in that of its type."""

    @property
    def choices(self) -> list[str]:
        """The only texts that are allowed; empty if there are others."""
        return []

    @property
    def names(self) -> list[str]:
        """Names that a recipe may state in place of a table of values."""
        return []

    def read(self, given: Any, folder: Any) -> Any:
        """What is read as a value of the type, or the value itself. folder: holds the files that a recipe names."""
        return given

    def finished(self, value: Any) -> Any:
        """The value of the field for one of the type."""
        return value

    def written(self, value: Any, write: Callable[[Any], Any]) -> Any:
        """The reverse, for JSON."""
        return write(value)

    def schema(self, of_type: dict[str, Any]) -> dict[str, Any]:
        """The JSON Schema, from that of the type."""
        return of_type


class TypeShape(NamedTuple):
    """A type as a recipe knows it: without nothing, arrays and functions, which only Python has.

    options: the types of a union. is_optional: whether None is allowed too. choices: texts and numbers of a `Literal`.
    """

    options: tuple[Any, ...]
    is_optional: bool
    choices: tuple[Any, ...] = ()
    form: WrittenForm | None = None
    mark: ArgumentType | None = None

    @property
    def origin(self) -> Any:
        """Of the only or first option."""
        return get_origin(self.options[0])

    @property
    def tables(self) -> list[type]:
        """Classes of the tables that it names itself, not in lists or under names."""
        return [table for option in self.options if get_origin(option) is None for table in tables_in(option)]

    @property
    def is_recipe(self) -> bool:
        """Whether it is a recipe of any kind."""
        return is_open(self.options[0])

    @property
    def is_mixed(self) -> bool:
        """Whether it is a union of other types than tables or choices."""
        others = [option for option in self.options if get_origin(option) is not Literal]
        return len(self.options) > 1 and len(self.tables) < len(others)


def type_shape(hint: Any) -> TypeShape:
    """The shape of a type."""
    marks = get_args(hint)[1:] if get_origin(hint) is Annotated else ()
    types = _united(get_args(hint)[0] if marks else hint)
    options = tuple(o for o in types if o is not NoneType and get_origin(o) not in (np.ndarray, Callable))
    if len(options) == 1 and get_origin(options[0]) is Annotated:
        return type_shape(options[0])._replace(is_optional=NoneType in types)
    choices = tuple(choice for option in options if get_origin(option) is Literal for choice in get_args(option))
    form = next((mark for mark in marks if isinstance(mark, WrittenForm)), None)
    mark = next((mark for mark in marks if isinstance(mark, ArgumentType)), None)
    return TypeShape(options, NoneType in types, choices, form, mark)


# The shape of an item of a list or table. Of a field it is not cached by its type, since `Literal["left", "right"]` and
# `Literal["right", "left"]` are equal but differ in their order.
item_shape: Callable[[Any], TypeShape] = cache(type_shape)


def _united(hint: Any) -> tuple[Any, ...]:
    """The types of a union."""
    if get_origin(hint) in (Union, UnionType):
        return tuple(option for part in get_args(hint) for option in _united(part))
    return (hint,)


@dataclasses.dataclass(frozen=True)
class DeclaredField:
    """A field of a dataclass, with its type."""

    field: dataclasses.Field[Any]
    hint: Any

    @cached_property
    def shape(self) -> TypeShape:
        return type_shape(self.hint)

    @property
    def name(self) -> str:
        return self.field.name

    @property
    def about(self) -> Mapping[str, Any]:
        """What `quantity` or `entry` declares."""
        return self.field.metadata

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the columns of rows of numbers, or the one unit of a number; empty if none is declared."""
        units: tuple[str, ...] = self.about.get("units") or ((self.about["unit"],) if "unit" in self.about else ())
        return units

    @property
    def is_length(self) -> bool:
        """Whether it holds lengths in the unit of the recipe; a key such as `position_mm` names its own unit."""
        units = self.units or (("mm",) if _holds(self.hint, complex) else ())
        return not names_mm(self.name) and any("mm" in unit for unit in units)

    @property
    def default(self) -> Any:
        """Its default value; `dataclasses.MISSING` if it is required."""
        return self.field.default if self.field.default_factory is MISSING else self.field.default_factory()

    @property
    def is_required(self) -> bool:
        return self.default is MISSING

    @property
    def tables(self) -> list[type]:
        """Classes of the tables in it; empty for a recipe in a recipe, which may be of any kind."""
        return tables_in(self.hint)

    @property
    def is_named(self) -> bool:
        """Whether it is a table whose keys the user chooses."""
        return get_origin(self.hint) is dict

    @property
    def is_rows(self) -> bool:
        """Whether it is a list, if it has tables."""
        return get_origin(self.hint) is tuple or (dataclasses.is_dataclass(self.hint) and ROWS in fields_of(self.hint))

    def heading(self, key: str) -> str:
        """The heading of the tables in it, under a dotted key."""
        return f"[{key}.NAME]" if self.is_named else f"[[{key}]]" if self.is_rows else f"[{key}]"


def _fields_of(table: type) -> Mapping[str, DeclaredField]:
    hints = get_type_hints(table, include_extras=True)
    return {field.name: DeclaredField(field, hints[field.name]) for field in dataclasses.fields(table)}


# The fields of a dataclass by name.
fields_of: Callable[[Any], Mapping[str, DeclaredField]] = cache(_fields_of)


def is_open(hint: Any) -> bool:
    """Whether a type is a dataclass that stands for any class derived from it."""
    return dataclasses.is_dataclass(hint) and bool(getattr(hint, "__abstractmethods__", None))


def tables_in(hint: Any) -> list[type]:
    """Classes of the tables that a type names: for a table that is written as a list, those of its rows."""
    if is_open(hint):
        return []
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        return fields_of(hint)[ROWS].tables if ROWS in fields_of(hint) else [hint]
    if isinstance(hint, type) and hasattr(hint, "KINDS"):
        return list(hint.KINDS.values())
    return [table for part in get_args(hint) for table in tables_in(part)]


def kind_of(table: type) -> Any:
    """The `kind` that distinguishes a table from others; None if it has none."""
    return fields_of(table)["kind"].field.default if "kind" in fields_of(table) else None


def names_mm(name: str) -> bool:
    """Whether a name states mm as the unit of its value."""
    return "mm" in name.split("_")


def _holds(hint: Any, type: type) -> bool:
    return hint is type or any(_holds(part, type) for part in get_args(hint))


def row_shape(shape: TypeShape, k: int) -> TypeShape:
    """The shape of an item of a list; of any value if it is not one."""
    for option in shape.options:
        if dataclasses.is_dataclass(option) and ROWS in fields_of(option):
            return row_shape(fields_of(option)[ROWS].shape, k)
        if get_origin(option) in (tuple, list, Sequence):
            items = [item for item in get_args(option) if item is not ...]
            return item_shape(items[min(k, len(items) - 1)])
    return item_shape(Any)


class Number(NamedTuple):
    """A number of a dataclass or of its table.

    Parameters
    ----------
    key : str
        Dotted key; items of lists and the x and y of points have `[0]`, `[1]`: `linkage.coupler_point[0]`.
    field : str
        The key of the whole value: that of the point or of the field.
    value : float or int
        The number; `with_numbers` also visits arrays.
    unit : str
        Its unit as the field declares it; "mm" for points.
    declared : DeclaredField
        The field that holds it, by itself or in rows or tables.
    """

    key: str
    field: str
    value: Any
    unit: str
    declared: DeclaredField


def with_numbers(
    thing: T,
    change: Callable[[Number], Any],
    enter: Callable[[Any, str], Any] = lambda inner, key: None,
    table: type | None = None,
    path: str = "",
    only: str = "",
) -> T:
    """A dataclass, or a table from which one is read, with other numbers.

    Parameters
    ----------
    thing : dataclass or mapping
        If nothing changes, it is returned itself.
    change : callable
        The new value of each number, in the order of the fields.
    enter : callable
        Returns what replaces a dataclass inside, or the table of a recipe of any kind, given with its key; None if its
        numbers are to be visited.
    table : type, optional
        The class that is read from a mapping.
    path : str
        The key of the dataclass itself.
    only : str
        The key of the only number that changes: what does not lead to it is not visited.
    """
    changed: T = _Visit(change, enter, only).table(thing, table or type(thing), path)
    return changed


class _Visit(NamedTuple):
    change: Callable[[Number], Any]
    enter: Callable[[Any, str], Any]
    only: str = ""

    def table(self, thing: Any, table: type, path: str) -> Any:
        is_mapping = isinstance(thing, Mapping)
        changed: dict[str, Any] = {}
        for name, declared in fields_of(table).items():
            if not declared.field.init or (is_mapping and name not in thing):
                continue
            key = path if name == ROWS else f"{path}.{name}" if path else name
            value = thing[name] if is_mapping else getattr(thing, name)
            other = self.value(value, declared.shape, key, declared, declared.units)
            changed |= {} if other is value else {name: other}
        if not changed:
            return thing
        return {**thing, **changed} if is_mapping else dataclasses.replace(thing, **changed)

    def value(
        self, value: Any, shape: TypeShape, key: str, declared: DeclaredField, units: tuple[str, ...], field: str = ""
    ) -> Any:
        """A value with other numbers. field: key of the row that holds it; by default its own."""
        if self.only and not f"{self.only}.".startswith((f"{key}.", f"{key}[")):
            return value
        # A field may be a sign, 1 or -1, or the position of a joint.
        is_sign = isinstance(value, int) and value in shape.choices
        units = units or (("mm",) if complex in shape.options and not is_sign else ())
        if isinstance(value, complex):
            parts = (value.real, value.imag)
            x, y = (self.number(f"{key}[{k}]", key, part, declared, units) for k, part in enumerate(parts))
            return value if (x, y) == parts else point_of(x, y)
        if isinstance(value, (int, float, np.number, np.ndarray)) and not isinstance(value, bool):
            return self.number(key, field or key, value, declared, units)
        if isinstance(value, Mapping):
            return self.mapping(value, shape, key, declared, units)
        if dataclasses.is_dataclass(value):
            entered = self.enter(value, key)
            return self.table(value, type(value), key) if entered is None else entered
        if isinstance(value, (list, tuple)):
            field = key if len(value) <= 3 else ""
            is_row = not any(isinstance(item, (list, tuple)) for item in value)
            columns = [(units[k % len(units)],) if units and is_row else units for k in range(len(value))]
            items = [
                self.value(item, row_shape(shape, k), f"{key}[{k}]", declared, columns[k], field)
                for k, item in enumerate(value)
            ]
            is_same = all(item is other for item, other in zip(items, value))
            return value if is_same else tuple(items) if isinstance(value, tuple) else items
        return value

    def number(self, key: str, field: str, value: Any, declared: DeclaredField, units: tuple[str, ...]) -> Any:
        return self.change(Number(key, field, value, units[0] if units else "", declared))

    def mapping(self, value: Any, shape: TypeShape, key: str, declared: DeclaredField, units: tuple[str, ...]) -> Any:
        """Values under names that the user chooses, or the table of a dataclass."""
        for option in shape.options:
            if get_origin(option) in (dict, Mapping):
                inner = item_shape(get_args(option)[1])
                items = {k: self.value(item, inner, f"{key}.{k}", declared, units) for k, item in value.items()}
                return value if all(items[k] is value[k] for k in items) else items
        if shape.is_recipe:
            entered = self.enter(value, key)
            return value if entered is None else entered
        tables, given = shape.tables, value.get("kind")
        table = next((table for table in tables if kind_of(table) == given), tables[0] if tables else None)
        return self.table(value, table, key) if table else value


# One part of a key: the position of an item of a list, or a name.
PART = re.compile(r"\[(\d+)\]|([^.\[\]]+)")


def numbers_in(thing: Any) -> list[Number]:
    """All numbers of a dataclass and of those inside it, in the order of its fields.

    Parameters
    ----------
    thing : dataclass
        A recipe or a part of one.

    Returns
    -------
    list of Number
        Without those of recipes in files of their own.
    """
    numbers: list[Number] = []

    def listed(number: Number) -> Any:
        numbers.extend([number] if isinstance(number.value, (int, float)) else [])
        return number.value

    with_numbers(thing, listed, lambda inner, key: inner if getattr(inner, "is_in_own_file", False) else None)
    return numbers


def with_number(thing: T, key: str, value: float) -> T:
    """A dataclass with another value of the number under a key, relative to the dataclass.

    Raises
    ------
    DesignError
        If the dataclass refuses the value.
    """
    return with_numbers(thing, lambda number: value if number.key == key else number.value, only=key)


def key_parts(key: str) -> list[str | int]:
    """The parts of a dotted key: names, and positions of items of lists, from 0."""
    return [int(item) if item else name for item, name in PART.findall(key)]


def texts_by_key(field: str, texts: Iterable[str], form: str) -> dict[str, str]:
    """Split texts of the form KEY=TEXT; DesignError for `field` if a part is missing or a key is given twice."""
    by_key: dict[str, str] = {}
    for text in texts:
        key, _, value = (part.strip() for part in text.partition("="))
        if not key or not value:
            raise DesignError(field, f"found {shown(text)}", f"give {form}", "wrong-type")
        if key in by_key:
            raise DesignError(field, f"{shown(key)} is given twice", f"give {form} once for each key", "conflict")
        by_key[key] = value
    return by_key


# Beyond this range every mechanism leaves the range of permitted sizes.
Scale = Annotated[float, between(1e-6, 1e6)]


@checked
def scaled(thing: T, scale: Scale) -> T:
    """A linkage or cam, or a recipe of one, in another size.

    Angles, times, masses and numbers of turns stay.

    Parameters
    ----------
    thing : a linkage, a cam, or a recipe of either
        In a recipe every length of the mechanism, of its stroke and of a goal is multiplied; `stock` with its screws
        and motor, `base` and `files` stay. Points and lifts that are read from a file are multiplied, and are then
        written in the recipe itself. A slide keeps its times: its speed and acceleration are multiplied. A cam's lifts
        in degrees stay.
    scale : float
        From 1e-6 to 1e6; lengths are multiplied by it, 1/mm is divided by it, kg mm multiplied.

    Returns
    -------
    The same type.

    Raises
    ------
    DesignError
        If the thing cannot be scaled, or a length leaves its range.

    See Also
    --------
    load, edit

    Examples
    --------
    >>> import geomkin as gk
    >>> gk.scaled(gk.FourBar(100, 30, 90, 70), 0.5)
    FourBar(ground=50.0, crank=15.0, coupler=45.0, rocker=35.0)
    """
    if not getattr(thing, "can_be_scaled", False) or isinstance(thing, type):
        raise DesignError(
            "thing", f"found {type(thing).__name__}", "give a linkage, a cam, or a recipe of either", "wrong-type"
        )
    if scale == 1:
        return thing
    try:
        result: T = thing.at_scale(scale) if hasattr(thing, "at_scale") else with_lengths(thing, scale)
    except DesignError as error:
        problem = f"found {scale:g}, with which {error.field}: {marked(error.problem)}"
        raise DesignError("scale", problem, error.remedy, error.id) from None
    return result


def with_lengths(thing: Any, scale: float, but: Collection[str] = ()) -> Any:
    """A dataclass whose fields are multiplied as their declarations require. but: names of tables that stay."""

    def multiplied(number: Number) -> Any:
        power = length_power(number.unit)
        return number.value * scale**power if power else number.value

    def inside(inner: Any, key: str) -> Any:
        return inner if key in but else inner.at_scale(scale) if hasattr(inner, "at_scale") else None

    return with_numbers(thing, multiplied, inside)
