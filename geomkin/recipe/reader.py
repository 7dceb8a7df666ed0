"""Reads the table of a recipe into its classes, and lists each problem under its key, with the nearest name."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from typing import Any, get_args

from ..core.arguments import PLAIN, ArgumentType, found_value, is_endless, number_range
from ..core.errors import MOST_SHOWN, DesignError, Problem, ProblemId, printable, shown
from ..core.field_visitor import ROWS, DeclaredField, TypeShape, fields_of, item_shape, key_parts, kind_of
from ..core.fields import Coordinate, allowed, point_of, quantity_fits, refusal_id
from ..core.names import Folder, is_name
from ..core.units import PLURAL, START, marked, unit_name
from .search import WORD, did_you_mean

NUMBER = re.compile(r"\s*([+-]?(?:\d[\d_]*[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)\s*([^\W\d_]{0,12}|°|%|\"|')\s*")
# One `key = value` of a line, if the value is neither a text, a list nor a table.
VALUE = re.compile(r"([\w.-]+)[ \t]*=[ \t]*([^\s\"'\[{,}#][^\"'\[{}#]*?|)[ \t]*(?=,\s*[\w.-]+\s*=|[}#]|$)")
# Longer lines are not searched for mistakes, since this would take long.
LONGEST_LINE = 1000
# Topics that recipes do not cover, and the words in unknown keys that refer to each.
UNSUPPORTED = {
    "friction and wear": "friction wear efficiency efficiencies lubrication lubricant damping",
    "strength and deformation": "stress stresses strength hardness fatigue stiffness deflection",
    "forces, torques and power": "force forces torque torques load loads payload power gravity weight mass inertia",
    "springs": "spring springs",
}
# Words in unknown keys that belong in the table `loads`, if the recipe has it.
SERVED_BY_LOADS = "friction damping force forces torque torques load gravity weight mass inertia spring springs"

# Renamed keys whose old and new names are too different for `did_you_mean`.
RENAMED = {
    "thinning": "tooth_thickness_allowance", "seconds": "time_limit",
    **dict.fromkeys(("unit", "inch", "inches"), "units"),
}  # fmt: skip


def _unsupported(key: object) -> str:
    """The topic of an unknown key, if recipes do not cover it; otherwise ""."""
    words = set(WORD.findall(str(key)[:100].lower()))
    return next((topic for topic, signs in UNSUPPORTED.items() if words & set(signs.split())), "")


def _nearest_of(topic: str, recipe: type) -> str:
    """The start of a remedy that names the key of a recipe that covers a topic; "" if it has none."""
    for word in UNSUPPORTED[topic].split():
        if word in fields_of(recipe):
            return f"nearest to it is {word}, above the first [table]; "
        if headings := _homes(recipe, word):
            return f"nearest to it is {word} under {headings[0][0]}; "
    return ""


def of_default(problem: str) -> str:
    """A problem of a key that was not written: it was found to have its default."""
    return re.sub(rf"^found (?=[-+\d{START}])", "found the default of ", marked(problem))


def unknown_key(name: str, key: str, table: type, recipe: type, is_shown: bool) -> Problem:
    """The problem of a key that a table does not have. Similar names are only searched for if the problem is shown."""
    known = list(fields_of(table))
    known += recipe.applied_fields() if recipe is table and hasattr(recipe, "applied_fields") else []
    problem, remedy = "unknown key", f"known here: {', '.join(known)}"
    if not is_shown:
        return Problem(key, problem, remedy, "unknown-key")
    homes, here = _homes(recipe, name), re.sub(r"\[\d+\]", "", key.rpartition(".")[0])
    headings = list(dict.fromkeys(heading for heading, _ in homes if heading.strip("[]") != here))
    kinds = [repr(kind) for heading, kind in homes if heading.strip("[]") == here and kind]
    near = f"did you mean {RENAMED[name]}? " if RENAMED.get(name) in known else did_you_mean(name, known)
    in_loads = here.partition(".")[0] == "loads"
    is_load = bool(set(WORD.findall(name[:100].lower())) & set(SERVED_BY_LOADS.split()))
    if kinds:
        near = f"it is a key of kind = {' or '.join(kinds)}; "
    elif {name.removesuffix("s"), f"{name}s"} & set(known):
        pass  # A plural too many or too few, whatever other tables have.
    elif headings:
        near = f"it belongs under {' or '.join(headings[:3])}; "
    elif name in fields_of(recipe):
        near = "it belongs above the first [table], next to kind; "
    elif is_load and not near and "loads" in fields_of(recipe) and not in_loads:
        near = "it belongs under [loads]; "
    elif (is_load or name == "loads") and not near and "mechanisms" in fields_of(recipe):
        near = "it belongs in the recipe of a mechanism, under [mechanisms.NAME.recipe.loads]; "
    elif not near and not (is_load and in_loads) and (topic := _unsupported(name)):
        near = _nearest_of(topic, recipe)
        problem = problem if near else f"unknown key: recipes of this kind do not cover {topic}"
    return Problem(key, problem, near + remedy, "unknown-key")


def table_remedy(declared: DeclaredField | None, key: str) -> str:
    """`give a table ...` and its keys, if a field holds tables; otherwise ""."""
    tables = declared.tables if declared else []
    if not declared or not tables:
        return ""
    # The key of one of several tables with names ends with its own name.
    is_one = declared.is_named and not key.endswith(declared.name)
    heading = "" if "[" in key else f", headed {f'[{key}]' if is_one else declared.heading(key)}"
    some = "tables, each" if (declared.is_rows or declared.is_named) and not is_one else "a table"
    kinds = [str(kind_of(t)) for t in tables if kind_of(t)]
    if kinds:
        return f"give {some} with kind = {' or '.join(map(repr, kinds))}{heading}"
    needed = [name for name, inner in fields_of(tables[0]).items() if inner.is_required]
    others = [name for name in fields_of(tables[0]) if name not in needed]
    more = f" (optional: {', '.join(others)})" if needed and others else ""
    return f"give {some} with {', '.join(needed or others)}{more}{heading}"


def _homes(table: type, name: str, path: str = "") -> list[tuple[str, str]]:
    """Headings and kinds of the tables that have a key of this name."""
    homes = []
    for declared in fields_of(table).values():
        key = path + declared.name
        for inner in declared.tables:
            homes += [(declared.heading(key), str(kind_of(inner) or ""))] if name in fields_of(inner) else []
            homes += _homes(inner, name, f"{key}.")
    return homes


def allowed_value(about: Any) -> str:
    """The allowed values of a key: its meaning, and for numbers the range."""
    meaning = about.get("description", "").removesuffix(f", {about.get('unit')}")
    meaning = meaning.replace(" in mm", f" in {unit_name(PLURAL)}")
    return f"{marked(allowed(about))} ({meaning})" if "unit" in about else meaning


def field_of(key: str, recipe: type) -> DeclaredField | None:
    """The field of a dotted key of a recipe; None if there is none."""
    tables: list[type] = [recipe]
    declared: DeclaredField | None = None
    is_name = False
    for part in key_parts(key):
        if isinstance(part, int):
            continue
        owners = [fields_of(table)[part] for table in tables if part in fields_of(table) and not is_name]
        is_name = any(owner.is_named for owner in owners)
        # Inside a field whose keys the user chooses, such as bodies, the field itself describes the value.
        if owners or not (declared and declared.is_named):
            declared = owners[0] if owners else None
        tables = [table for owner in owners for table in owner.tables] if owners else tables
    return declared


def joined_key(key: str, part: str) -> str:
    """A dotted key; `cam.program` + `program[2].law` does not repeat the table's name."""
    last = key.rsplit(".", 1)[-1]
    if part == last or part.startswith(f"{last}["):
        return key + part[len(last) :]
    return ".".join(filter(None, (key, part)))


def toml_mistake(text: str, complaint: str) -> Problem | None:
    """The mistake in the line of a TOML parser's complaint; None if it is not one of the usual mistakes."""
    match = re.search(r"line (\d+)", complaint)
    lines = text.split("\n")
    if match is None or int(match[1]) > len(lines):
        return None
    above, line = lines[: int(match[1]) - 1], lines[int(match[1]) - 1]
    if len(line) > LONGEST_LINE:
        return None
    if re.search("[“”„‟«»‘’‚]", line) and "=" in line:  # noqa: RUF001  # quotes as word processors write them
        return Problem(
            _key_at(above, line.partition("=")[0]), "found curly quotes", 'write straight ones: "', "invalid-toml"
        )
    for key, value in VALUE.findall(line):
        remedy = _remedy_for(key, value)
        if remedy:
            return Problem(_key_at(above, key), f"found {printable(value) or 'nothing'}", remedy, "invalid-toml")
    return None


def _remedy_for(key: str, value: str) -> str:
    if not value:
        return "give a value, or delete the line"
    if value.lower() in ("true", "yes", "on"):
        return "" if value == "true" else "write true"
    if value.lower() in ("false", "no", "off"):
        return "" if value == "false" else "write false"
    if re.fullmatch(r"[^\W\d][\w -]*", value) and value not in ("inf", "nan"):
        return f'a text needs quotes: write {key} = "{value}"'
    return number_meant(value)


def number_meant(text: str, quoted: bool = False) -> str:
    """A remedy for a number written with a comma, a unit or quotes; "" if the text is no such number."""
    match = NUMBER.fullmatch(text)
    if not match or (not quoted and text == match[1] == _with_point(match[1])):
        return ""
    units = "" if match[2] in ("", "mm", "deg", "°") else " (lengths are in the units of the recipe, angles in deg)"
    # Without a comma behind it, the number is not taken for a length in mm.
    return f"write {_with_point(match[1])} without unit or quotes, with a point{units}"


def _with_point(number: str) -> str:
    """The number as TOML requires it: a point with digits on both sides."""
    number = re.sub(r"(?<!\d)\.", "0.", number.replace(",", "."))
    return re.sub(r"\.(?!\d)", ".0", number)


def _key_at(above: list[str], key: str) -> str:
    """The dotted key, with the last heading above its line."""
    heads = [
        match[1]
        for line in above
        if (match := re.match(r"\s*\[+\s*([\w. -]+?)\s*\]+\s*(?:#.*)?$", line[:LONGEST_LINE]))
    ]
    return printable(f"{heads[-1]}.{key.strip()}" if heads else key.strip())


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
        is_text = isinstance(given, str) or not all(isinstance(one, str) for one in choices)
        id: ProblemId = "out-of-range" if is_text else "wrong-type"
        return self.refuse(key, f"found {shown(given)}", f"{did_you_mean(given, map(str, choices))}give {expected}", id)

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
