"""Templates of recipes, made from the declarations that validate recipes."""

from __future__ import annotations

import dataclasses
import inspect
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from typing import Any, get_args

from ..core.errors import DesignError, GeomkinError, printable, shown
from ..core.field_visitor import ROWS, DeclaredField, TypeShape, fields_of, item_shape, kind_of
from ..core.fields import Coordinate, allowed
from ..core.names import LONGEST
from .kinds import ENTRY_POINTS, kind_names, recipe_class
from .load import plain_value, short_table, table_lines
from .recipe import SHARED, AbstractRecipe
from .search import did_you_mean
from .toml import toml_value

# Editors look for the schema in the folder of the recipe, so no network is needed.
SCHEMA = "geomkin.schema.json"


def template(recipe: type[AbstractRecipe], options: Sequence[str] = ()) -> str:
    """A recipe of a kind as TOML text that runs without changes; optional keys are commented out.

    options: other kinds of tables, such as `follower=oscillating-roller`, and optional tables, such as `web`.
    DesignError if the kind does not have one of them.
    """
    offered, chosen = choices(recipe), chosen_tables(recipe, options)
    values = recipe.example_values(chosen)
    tables = {key: example(offered[key][kind]) for key, kind in chosen.items() if not _is_given(key, values)}
    try:
        filled = example(recipe, {**tables, **values})
    except DesignError as error:
        if options:
            raise
        kind = kind_of(recipe)
        raise GeomkinError(f"kind {kind}: the examples of its fields make no recipe ({error}); correct them") from None
    return "\n".join([*_head(recipe, offered), *_table("", filled, offered)]).rstrip() + "\n"


def _is_given(key: str, values: Mapping[str, Any]) -> bool:
    """Whether the values contain a table, by itself or inside another one."""
    return any(key == other or key.startswith(f"{other}.") for other in values)


def example(cls: type, given: Mapping[str, Any] | None = None, base: Any = None) -> Any:
    """An instance of a dataclass, made from the examples of its fields.

    given: values by dotted key that replace examples. base: an instance with the values of all other fields.
    """
    given = given or {}
    values = {}
    for name, declared in fields_of(cls).items():
        inside = {key.partition(".")[2]: value for key, value in given.items() if key.startswith(f"{name}.")}
        value = declared.about.get("examples", [None])[0] if base is None else getattr(base, name)
        if name == "kind" and base is None:
            values["kind"] = declared.default
        elif name in given:
            is_row = declared.default == () and dataclasses.is_dataclass(given[name])
            values[name] = (given[name],) if is_row else given[name]
        elif inside:
            is_table = dataclasses.is_dataclass(value)
            table = type(value) if is_table else declared.tables[0]
            values[name] = example(table, given=inside, base=value if is_table else None)
        elif base is not None or value is not None:
            values[name] = value
        elif declared.is_required:
            values[name] = _value_of(cls, declared)
    return cls(**values)


def _value_of(cls: type, declared: DeclaredField) -> Any:
    """A value of a required field without an example: a table of examples, a word, or a number within the limits."""
    kind, shape = declared.shape.options[0], declared.shape
    if dataclasses.is_dataclass(kind):
        return example(kind)  # type: ignore[arg-type]
    if shape.choices:
        return shape.choices[0]
    if kind not in (int, float):
        problem = f"{cls.__name__}.{declared.name} is required and has no example"
        raise GeomkinError(f"{problem}; declare it by `entry(..., example=...)`")
    about = declared.about
    least, most = about.get("ge", about.get("gt")), about.get("le", about.get("lt"))
    if least is None:
        return kind(1 if most is None else min(1, most - 1))
    return kind(least + 1 if most is None else min(least + 1, (least + most) / 2))


def _head(recipe: type[AbstractRecipe], offered: Mapping[str, Mapping[str, type]]) -> list[str]:
    """Comments: the kind, its schema, and the other tables that `new` can show."""
    # Tables that several tables contain, such as `material` of two stocks, are offered once.
    kinds_by_key: dict[str, list[str]] = {}
    for key, kinds in offered.items():
        kinds_by_key.setdefault(key.rsplit(".", 1)[-1], list(kinds))
    options = [key if "" in kinds else f"{key}={kinds[-1]}" for key, kinds in kinds_by_key.items()]
    texts = [
        f"{recipe.about()} {recipe.advice}".strip(),
        f"Run `geomkin schema > {SCHEMA}` in this folder once; then editors mark mistakes while you type.",
        f"To show other tables, add `--with` and one of: {', '.join(options)}.",
    ]
    text = [line for paragraph in texts[: 3 if options else 2] for line in textwrap.wrap(paragraph, 110)]
    return [f"#:schema ./{SCHEMA}", *(f"# {line}" for line in text)]


def _table(path: str, value: Any, offered: Mapping[str, Mapping[str, type]]) -> list[str]:
    """Lines of a table: its keys with plain values first, then the tables in it."""
    plain, tables = [], []
    if not path:
        plain += [_line(declared, declared.default) for declared in value.applied_fields().values()]
    for declared in sorted(fields_of(type(value)).values(), key=lambda f: (f.name != "kind", f.name in SHARED)):
        inner = getattr(value, declared.name)
        name = f"{path}.{declared.name}" if path else declared.name
        rows = getattr(inner, "segments", inner)
        if isinstance(rows, tuple | list) and rows and dataclasses.is_dataclass(rows[0]):
            for row in rows:
                tables += ["", f"[[{name}]]", *_table(name, row, offered)]
        elif isinstance(inner, dict) and any(map(dataclasses.is_dataclass, inner.values())):
            for key, item in inner.items():
                tables += ["", f"[{name}.{key}]", *_table(f"{name}.{key}", item, offered)]
        elif isinstance(inner, AbstractRecipe):
            tables += ["", f"[{name}]", *table_lines(name, short_table(inner))]
        elif isinstance(inner, dict) and inner:
            tables += ["", f"[{name}]  # {declared.about['description']}"]
            tables += [f"{key} = {toml_value(item)}" for key, item in inner.items()]
        elif dataclasses.is_dataclass(inner):
            tables += ["", f"[{name}]", *_table(name, inner, offered)]
        else:
            text, note = _line(declared, inner)
            if declared.name == "kind" and path in offered:
                note = " or ".join(offered[path])
            if name in offered:
                note += f"; shown by --with {declared.name}"
            plain.append((text, note))
    width = min(36, max((len(text) for text, _ in plain), default=0))
    return [f"{text:<{width}}  # {note}" if note else text for text, note in plain] + tables


def _line(declared: DeclaredField, value: Any) -> tuple[str, str]:
    name, about = declared.name, declared.about
    note = about.get("description", "")
    if "unit" in about:
        limits = allowed({**about, "unit": ""}).removeprefix("a number").removeprefix("a whole number").strip()
        note += f"; {limits}" if limits else ""
    elif len(declared.shape.choices) > 1:
        note += "; " + " or ".join(map(str, declared.shape.choices))
    if value is None:
        return f"# {name} =", note
    is_usual = value in (declared.field.default, about.get("filled_in"), {})
    optional = not declared.is_required and is_usual and name != "kind"
    return f"{'# ' if optional else ''}{name} = {toml_value(value)}", note


def choices(recipe: type, path: str = "", refused: Sequence[str] = ()) -> dict[str, dict[str, type]]:
    """Tables that have several kinds, or that a template leaves out by default: dotted key -> kind -> its dataclass.

    An optional table has the single kind "".
    """
    tables_by_key: dict[str, dict[str, type]] = {}
    refused = recipe.additions.refused if issubclass(recipe, AbstractRecipe) else refused
    for declared in fields_of(recipe).values():
        tables, key = declared.tables, path + declared.name
        # A table with a name, such as a motor, is given by its name.
        if str in declared.shape.options or key in refused:
            continue
        kinds = {kind_of(table): table for table in tables if kind_of(table)}
        kinds = {kind: table for kind, table in kinds.items() if f"{key}={kind}" not in refused}
        is_shown = bool(declared.about.get("examples", [None])[0])
        if len(kinds) > 1:
            tables_by_key[key] = kinds
        elif tables and not is_shown and (declared.field.default is None or declared.is_rows):
            tables_by_key[key] = {"": tables[0]}
        elif len(tables) == 1:
            tables_by_key |= choices(tables[0], f"{key}.", refused)
    return tables_by_key


def chosen_tables(recipe: type, options: Iterable[str]) -> dict[str, str]:
    """Dotted key -> kind of each table that options such as `follower=oscillating-roller` or `stock.web` name.

    The end of a key stands for all keys with this end. DesignError if there is no such table or kind.
    """
    offered = choices(recipe)
    chosen: dict[str, str] = {}
    for option in options:
        end, _, kind = option.partition("=")
        keys = [key for key in offered if key == end or key.endswith(f".{end}")]
        if not keys:
            short = {key.rsplit(".", 1)[-1]: key for key in offered}
            known = f"{kind_of(recipe)} has {', '.join(short) or 'none'}"
            problem = f"no such table: {printable(end)}"
            raise DesignError("--with", problem, did_you_mean(end, [*short, *offered]) + known, "unknown-key")
        for key in keys:
            kinds = offered[key]
            if kind not in kinds:
                remedy = f"give {' or '.join(f'{end}={k}' if k else end for k in kinds)}"
                raise DesignError(
                    "--with", f"found {printable(option)}", did_you_mean(kind, kinds) + remedy, "unknown-kind"
                )
            chosen[key] = kind
    return chosen


# Name of the kind in the module that a new package copies.
EXAMPLE_KIND = "example-kind"
PROJECT = """\
[build-system]
requires = ["hatchling"]
build-backend = "hatchling.build"

[project]
name = "geomkin-{kind}"
version = "0.1"
dependencies = ["geomkin"]

[project.entry-points."{group}"]
{kind} = "{module}:ExampleRecipe"

[tool.hatch.build.targets.wheel]
only-include = ["{module}.py"]
"""
TEST = '''\
"""Run it with `python -m pytest` after `pip install -e .`."""

import geomkin as gk


def test_the_lift_is_twice_the_eccentricity():
    recipe = gk.load({{"kind": "{kind}", "eccentric": {{"radius": 30, "eccentricity": 10}}}})
    assert abs(recipe.table["lift"].max() - 20) < 1e-9 and all(check.passed for check in recipe.checks)
'''


def kind_package(kind: str) -> dict[str, bytes]:
    """Files of a package with one kind of recipe, by name: its module, its project file, a recipe and a test.

    DesignError for a name that is no name of a kind, or that of a known kind.
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", kind) or len(kind) > LONGEST or kind in kind_names():
        remedy = (
            f"give a new name of at most {LONGEST} small letters and digits, in words joined by -, such as geneva-drive"
        )
        problem = f"found {shown(kind)}"
        raise DesignError("KIND", problem, remedy, "conflict" if kind in kind_names() else "out-of-range")
    module = f"geomkin_{kind.replace('-', '_')}"
    source = files(__package__).joinpath("example_kind.py").read_text("utf-8")
    words = {"kind": kind, "module": module, "group": ENTRY_POINTS}
    recipe = f'kind = "{kind}"\n\n[eccentric]\nradius = 30\neccentricity = 10\n'
    contents = {
        f"{module}.py": source.replace(EXAMPLE_KIND, kind),
        "pyproject.toml": PROJECT.format(**words),
        f"{kind}.toml": recipe,
        f"test_{module}.py": TEST.format(**words),
    }
    return {name: content.encode() for name, content in contents.items()}


LIMITS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
TYPES = {float: "number", int: "integer", bool: "boolean"}
# The file of a recipe, or a recipe in the recipe.
RECIPE = {"type": ["string", "object"], "if": {"type": "object"}, "then": {"$ref": "#"}}


def schema() -> dict[str, Any]:
    """The JSON Schema of all kinds of recipe.

    Each kind of a table has an `if` on its `kind` and a `then`, so that an editor marks only the wrong key. With
    `oneOf`, a choice between all kinds, it would mark the whole table.
    """
    tables: dict[str, Any] = {}
    references: dict[str, dict[str, Any]] = {}
    for name in kind_names():
        recipe = recipe_class(name)
        references[name] = _schema_of(recipe, tables)
        applied = {key: _field(declared, tables) for key, declared in recipe.applied_fields().items()}
        tables[_name(recipe)]["properties"] |= applied
    draft = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": draft, "$defs": tables, "title": "geomkin recipe", **_by_kind(references)}


def _by_kind(tables: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """A table of one of several kinds."""
    return {
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": {"enum": list(tables)}},
        "allOf": [
            {"if": {"required": ["kind"], "properties": {"kind": {"const": name}}}, "then": table}
            for name, table in tables.items()
        ],
    }  # fmt: skip


def _name(table: type) -> str:
    """A name of its own: no two classes of the package share one."""
    is_own = table.__module__.startswith("geomkin.")
    return table.__name__ if is_own else f"{table.__module__}.{table.__name__}"


def _schema_of(table: type, tables: dict[str, Any]) -> dict[str, Any]:
    """A reference to the schema of a dataclass, which is added to the tables."""
    if _name(table) not in tables:
        tables[_name(table)] = {}
        # Sections such as Notes are for readers of the code.
        about = re.split(r"\n\n(?:Source\b|\w+\n---)", inspect.cleandoc(table.__doc__ or ""))[0]
        tables[_name(table)] |= {
            "title": table.__name__,
            "description": about,
            "type": "object",
            "properties": {name: _field(declared, tables) for name, declared in fields_of(table).items()},
            "required": [name for name, declared in fields_of(table).items() if declared.is_required],
            "additionalProperties": False,
        }
    return {"$ref": f"#/$defs/{_name(table)}"}


def _field(declared: DeclaredField, tables: dict[str, Any]) -> dict[str, Any]:
    about, default = declared.about, declared.default
    described = {"description": about["description"]} if "description" in about else {}
    # Editors do not use default tables.
    is_table = isinstance(default, Mapping) or dataclasses.is_dataclass(default)
    shown = {} if is_table or default in (None, dataclasses.MISSING) else {"default": plain_value(default)}
    return _type(declared.shape, about, tables) | described | shown


def _type(shape: TypeShape, about: Mapping[str, Any], tables: dict[str, Any]) -> dict[str, Any]:
    """The schema of a type. about: what its field declares."""
    form = shape.form
    if form and form.choices:
        return {"type": "string", "enum": form.choices}
    return form.schema(_shape(shape, about, tables)) if form else _shape(shape, about, tables)


def _shape(shape: TypeShape, about: Mapping[str, Any], tables: dict[str, Any]) -> dict[str, Any]:
    option, origin, inner = shape.options[0], shape.origin, shape.tables
    if shape.is_mixed:
        return {"anyOf": [_type(item_shape(option), about, tables) for option in shape.options]}
    if shape.choices:
        return {"const": shape.choices[0]} if len(shape.choices) == 1 else {"enum": list(shape.choices)}
    if origin is tuple and get_args(option)[-1] is not ...:
        items = [_type(item_shape(item), {}, tables) for item in get_args(option)]
        return {"type": "array", "prefixItems": items, "minItems": len(items), "maxItems": len(items)}
    if origin in (tuple, Sequence):
        return {"type": "array", "items": _type(item_shape(get_args(option)[0]), {}, tables)}
    if origin in (dict, Mapping):
        return {"type": "object", "additionalProperties": _type(item_shape(get_args(option)[1]), {}, tables)}
    if shape.is_recipe:
        return RECIPE
    if inner and dataclasses.is_dataclass(option) and ROWS in fields_of(option):
        return _type(fields_of(option)[ROWS].shape, {}, tables)
    if len(inner) > 1:
        return _by_kind({kind_of(table): _schema_of(table, tables) for table in inner})
    if inner:
        return _schema_of(inner[0], tables)
    if option is complex:
        return _type(item_shape(tuple[Coordinate, Coordinate]), {}, tables)
    limits = {LIMITS[key]: about[key] for key in LIMITS if key in about}
    if shape.mark and shape.mark.limits:
        limits = dict(zip(("minimum", "maximum"), shape.mark.limits))
    return {"type": TYPES.get(option, "string"), **limits}
