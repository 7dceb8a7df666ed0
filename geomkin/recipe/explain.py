"""A validator's findings in a person's words: key, what was found, what is allowed, the nearest name."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any, get_args, get_origin, get_type_hints

from pydantic import ValidationError

from ..errors import DesignError, Problem, printable, shown
from ..sizes import allowed


def explain(error: ValidationError, recipe: type) -> list[Problem]:
    """One problem for each finding, in the file's order of keys."""
    return [_problem(e, recipe) for e in error.errors(include_url=False)]


def nearest(name: str, known: Iterable[str]) -> str:
    """`; did you mean ...?` where a known name is close, else nothing."""
    close = get_close_matches(name, list(known), n=1)
    return f"; did you mean {close[0]}?" if close else ""


def _problem(e: Any, recipe: type) -> Problem:
    tables, field, key = _place(e["loc"], recipe)
    about = field.metadata if field else {}
    found = f"found {shown(e['input'])}"
    match e["type"]:
        case "missing":
            return Problem(key, "is missing", f"give {_wanted(about) or 'it'}")
        case "unexpected_keyword_argument":
            known = [f.name for t in tables for f in dataclasses.fields(t)]
            hint = nearest(str(e["loc"][-1]), known)
            return Problem(key, "unknown key", f"known here: {', '.join(dict.fromkeys(known))}{hint}")
        case "value_error" if isinstance(e["ctx"]["error"], DesignError):
            cause = e["ctx"]["error"]
            return Problem(_join(key, cause.field), cause.problem, cause.remedy)
        case "literal_error":
            expected = e["ctx"]["expected"]
            hint = (
                nearest(e["input"], expected.replace("'", "").replace(" or ", ", ").split(", "))
                if isinstance(e["input"], str)
                else ""
            )
            return Problem(key, found, f"give {expected}{hint}")
        case "union_tag_invalid" | "union_tag_not_found":
            tags = [str(_tag(t)) for t in tables if _tag(t)]
            tag = e["input"].get("kind") if isinstance(e["input"], dict) else None
            problem = "is missing" if tag is None else f"found {shown(tag)}"
            hint = nearest(tag, tags) if isinstance(tag, str) else ""
            return Problem(_join(key, "kind"), problem, f"give {' or '.join(map(repr, tags))}{hint}")
        case "dataclass_type" | "model_attributes_type" | "dict_type":
            known = [f.name for t in tables for f in dataclasses.fields(t)]
            return Problem(key, found, f"give a table with {', '.join(dict.fromkeys(known))}")
        case "less_than_equal" | "greater_than_equal" if "unit" not in about:
            limit = next(iter(e["ctx"].values()))
            return Problem(key, found, f"give numbers between {-abs(limit):g} and {abs(limit):g} ({_wanted(about)})")
        case _:
            return Problem(key, found, f"give {_wanted(about) or e['msg']}")


def _wanted(about: Any) -> str:
    """What may stand under a key: the meaning, and for numbers the range."""
    meaning = about.get("description", "").removesuffix(f", {about.get('unit')}")
    return f"{allowed(about)} ({meaning})" if "unit" in about else meaning


def _place(loc: tuple[int | str, ...], recipe: type) -> tuple[list[type], dataclasses.Field | None, str]:
    """Dataclasses that may stand at a place, the field it is (None for an unknown one), and its dotted key."""
    tables: list[type] = [recipe]
    field: dataclasses.Field | None = None
    key, chosen = "", False
    for part in loc:
        if isinstance(part, int):
            key += f"[{part}]"
            tables = _nested(tables) or tables
            continue
        tagged = [t for t in tables if _tag(t) == part]
        if tagged and len(tables) > 1:
            tables = tagged
            continue
        key = _join(key, printable(part, 60) or '""')
        owners = [t for t in tables if part in {f.name for f in dataclasses.fields(t)}]
        # Under a field of names that a person chooses, such as bodies, that field says what is wanted.
        if owners or not chosen:
            field = next((f for t in owners for f in dataclasses.fields(t) if f.name == part), None)
            chosen = any(get_origin(get_type_hints(t)[part]) is dict for t in owners)
        inner = [c for t in owners for c in _dataclasses_in(get_type_hints(t)[part])]
        tables = inner or tables
    return tables, field, key


def _nested(tables: list[type]) -> list[type]:
    return [c for t in tables for hint in get_type_hints(t).values() for c in _dataclasses_in(hint)]


def _dataclasses_in(hint: Any) -> list[type]:
    if dataclasses.is_dataclass(hint):
        return [hint]  # type: ignore[list-item]
    return [c for arg in get_args(hint) for c in _dataclasses_in(arg)]


def _tag(table: type) -> Any:
    return next((f.default for f in dataclasses.fields(table) if f.name == "kind"), None)


def _join(key: str, part: str) -> str:
    """`cam` + `program[2].law`: dotted, without saying a table's name twice."""
    last = key.rsplit(".", 1)[-1]
    if part == last or part.startswith(f"{last}["):
        return key + part[len(last) :]
    return f"{key}.{part}" if key else part
