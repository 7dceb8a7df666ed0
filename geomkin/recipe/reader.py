"""Reads the table of a recipe: TOML values become those of its classes, and each problem is listed under its key."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from typing import Any, get_args

from ..core.arguments import PLAIN, ArgumentType, found_value, is_endless, number_range
from ..core.errors import MOST_SHOWN, DesignError, Problem, ProblemId, printable, shown
from ..core.field_visitor import ROWS, DeclaredField, TypeShape, fields_of, item_shape, kind_of
from ..core.fields import Coordinate, point_of, quantity_fits, refusal_id
from ..core.names import Folder, is_name
from ..core.units import marked
from .messages import allowed_value, did_you_mean, joined_key, number_meant, of_default, table_remedy, unknown_key

# In place of a value that is refused.
WRONG: Any = object()


def read_table(given: Any, recipe: type, folder: Folder) -> tuple[Any, list[Problem]]:
    """The instance of a dataclass that a table states, and the problems of the table; the instance only without any."""
    reader = _TableReader(recipe, folder)
    return reader.table(given, [recipe], "", None), reader.problems


class _TableReader:
    def __init__(self, recipe: type, folder: Folder):
        self.recipe, self.folder = recipe, folder
        self.problems: list[Problem] = []

    def refuse(self, key: str, problem: str, remedy: str, id: ProblemId = "wrong-type") -> Any:
        self.problems.append(Problem(key, problem, remedy, id))
        return WRONG

    def refuse_by(self, error: DesignError, key: str) -> Any:
        self.problems.append(error.named(joined_key(key, error.field)).as_problem)
        return WRONG

    def table(self, given: Any, tables: Sequence[type], key: str, declared: DeclaredField | None) -> Any:
        """An instance of one of several dataclasses."""
        if isinstance(given, tuple(tables)):
            return given
        if not isinstance(given, Mapping):
            known = dict.fromkeys(name for table in tables for name in fields_of(table))
            value = (declared and allowed_value(declared.about)) or f"a table with {', '.join(known)}"
            return self.refuse(key, f"found {shown(given)}", table_remedy(declared, key) or f"give {value}")
        kind = given.get("kind")
        table = next((table for table in tables if len(tables) == 1 or kind_of(table) == kind), None)
        if table is None:
            kinds = [str(kind_of(table)) for table in tables]
            remedy = f"{did_you_mean(kind, kinds)}give {' or '.join(map(repr, kinds))}"
            problem, id = ("is missing", "missing-key") if kind is None else (f"found {shown(kind)}", "unknown-kind")
            return self.refuse(_inside(key, "kind"), problem, remedy, id)  # type: ignore[arg-type]
        values = {}
        for name, field in fields_of(table).items():
            if name in given:
                values[name] = self.value(given[name], field.shape, _inside(key, name), field)
            elif field.is_required:
                values[name] = self.missing(_inside(key, name), field)
        for name in given:
            if name not in fields_of(table):
                inner = _inside(key, printable(name, 60) or '""')
                self.problems.append(unknown_key(str(name), inner, table, self.recipe, len(self.problems) < MOST_SHOWN))
                values[name] = WRONG
        return WRONG if any(value is WRONG for value in values.values()) else self.made(table, values, key, given)

    def made(self, table: type, values: Mapping[str, Any], key: str, given: Mapping[str, Any]) -> Any:
        try:
            return table(**values)
        except DesignError as error:
            problem = error.problem if _is_written(given, error.field) else of_default(error.problem)
            return self.refuse_by(DesignError(error.field, problem, error.remedy, error.id, error.value), key)

    def missing(self, key: str, declared: DeclaredField) -> Any:
        choices = " or ".join(map(str, declared.shape.choices))
        value = ": ".join(filter(None, (allowed_value(declared.about) or "it", choices)))
        return self.refuse(key, "is missing", table_remedy(declared, key) or f"give {value}", "missing-key")

    def wrong(self, given: Any, key: str, declared: DeclaredField, id: ProblemId = "wrong-type") -> Any:
        is_short = "unit" in declared.about and isinstance(given, str) and len(given) < 100
        meant = number_meant(given, quoted=True) if is_short else ""
        remedy = f"{meant + '; ' if meant else ''}give {allowed_value(declared.about)}"
        return self.refuse(key, f"found {_found(given, declared)}", remedy, id)

    def value(self, given: Any, shape: TypeShape, key: str, declared: DeclaredField) -> Any:
        """A value of a type."""
        form = shape.form
        if form and form.choices:
            return self.choice(given, form.choices, key)
        try:
            value = self.plain(form.read(given, self.folder) if form else given, shape, key, declared)
        except DesignError as error:
            return self.refuse_by(error, key)
        return form.finished(value) if form and value is not WRONG and value is not None else value

    def plain(self, given: Any, shape: TypeShape, key: str, declared: DeclaredField) -> Any:
        option, origin, tables = shape.options[0], shape.origin, shape.tables
        if given is None and shape.is_optional:
            return None
        if shape.is_mixed and not (tables and isinstance(given, Mapping)):
            return self.first(given, shape.options, key, declared)
        if shape.choices:
            return self.choice(given, shape.choices, key)
        if origin in (tuple, Sequence):
            return self.rows(given, get_args(option) if origin is tuple else (*get_args(option), ...), key, declared)
        if origin in (dict, Mapping):
            return self.named(given, get_args(option)[1], key, declared)
        if isinstance(option, type) and is_dataclass(option) and ROWS in fields_of(option):
            if isinstance(given, option):
                return given
            rows = self.value(given, fields_of(option)[ROWS].shape, key, declared)
            return rows if rows is WRONG else self.made(option, {ROWS: rows, "folder": self.folder}, key, {ROWS: rows})
        if tables:
            return self.table(given, tables, key, declared)
        if option is complex:
            pair = self.rows(given, (Coordinate, Coordinate), key, declared)
            return pair if pair is WRONG else point_of(*pair)
        if option in (float, int):
            return self.number(given, option, shape.mark or PLAIN[option], key, declared)
        if option is bool and not isinstance(given, bool):
            return self.refuse(key, f"found {shown(given)}", f"give true or false: {allowed_value(declared.about)}")
        if option is str and isinstance(given, str) and not given.strip() and declared.default != "":
            return self.wrong(given, key, declared, "out-of-range")
        return given if isinstance(given, option) else self.wrong(given, key, declared)

    def choice(self, given: Any, choices: Sequence[Any], key: str) -> Any:
        if type(given) in (str, int) and given in choices:
            return given
        *others, last = map(repr, choices)
        expected = f"{', '.join(others)} or {last}" if others else last
        return self.refuse(
            key, f"found {shown(given)}", f"{did_you_mean(given, map(str, choices))}give {expected}", "out-of-range"
        )

    def first(self, given: Any, options: Sequence[Any], key: str, declared: DeclaredField) -> Any:
        """The first of several types that fits."""
        for option in options:
            trial = _TableReader(self.recipe, self.folder)
            value = trial.value(given, item_shape(option), key, declared)
            if value is not WRONG:
                return value
        return self.wrong(given, key, declared)

    def number(self, given: Any, kind: type, mark: ArgumentType, key: str, declared: DeclaredField) -> Any:
        about = declared.about
        if "unit" in about:
            fits = quantity_fits(given, about)
            return kind(given) if fits else self.wrong(given, key, declared, refusal_id(given, about))
        if isinstance(given, bool) or not isinstance(given, (int, kind)):
            return self.wrong(given, key, declared)
        if mark.fits(given):
            return kind(given)
        id: ProblemId = "not-finite" if is_endless(given) else "out-of-range"
        allowed = number_range(*mark.limits, "mm") if mark.limits and declared.is_length else marked(mark.allowed)
        return self.refuse(key, f"found {_found(given, declared)}", f"give {allowed} ({allowed_value(about)})", id)

    def rows(self, given: Any, hints: Sequence[Any], key: str, declared: DeclaredField) -> Any:
        """The items of a list; hints: of each item, or of all before `...`."""
        if not isinstance(given, (list, tuple)) or (hints[-1] is not ... and len(given) > len(hints)):
            return self.wrong(given, key, declared)
        hints = [hints[0]] * len(given) if hints[-1] is ... else hints
        values = [
            self.value(given[k], item_shape(hint), f"{key}[{k}]", declared) if k < len(given)
            else self.missing(f"{key}[{k}]", declared)
            for k, hint in enumerate(hints)
        ]  # fmt: skip
        return WRONG if any(value is WRONG for value in values) else tuple(values)

    def named(self, given: Any, hint: Any, key: str, declared: DeclaredField) -> Any:
        if not isinstance(given, Mapping):
            tables = declared.tables
            return self.table(given, tables, key, declared) if tables else self.wrong(given, key, declared)
        keys = {name: _inside(key, printable(name, 60) or '""') for name in given}
        values = {name: self.value(item, item_shape(hint), keys[name], declared) for name, item in given.items()}
        for name in given:
            if not is_name(name):
                problem = f"has the key {shown(name)}, which is empty or has a sign that is not visible"
                values[name] = self.refuse(key, problem, "give keys of visible signs", "out-of-range")
        return WRONG if any(value is WRONG for value in values.values()) else values


def _inside(key: str, name: str) -> str:
    """The dotted key of a name in a table."""
    return f"{key}.{name}" if key else name


def _is_written(given: Any, field: str) -> bool:
    """Whether a table has the key of a field; also if the field is in a row, or is no key."""
    for name in field.split("."):
        if not isinstance(given, Mapping) or "[" in name:
            return True
        if name not in given:
            return False
        given = given[name]
    return True


def _found(given: Any, declared: DeclaredField) -> str:
    return found_value(given, *(declared.units or ("mm",) if declared.is_length else ()))
