"""What is wrong in a recipe, in a person's words: key, what was found, what is allowed, the nearest name."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable
from dataclasses import MISSING
from difflib import SequenceMatcher
from functools import cache
from typing import Any, get_args, get_origin, get_type_hints

from pydantic import ValidationError

from ..core.errors import MOST_SHOWN, DesignError, Problem, ProblemId, printable, shown
from ..core.fields import allowed

# Problems looked into: many more come of one slip or of a file that is no recipe, and each takes a while.
EXPLAINED = 200
NUMBER = re.compile(r"\s*([+-]?(?:\d[\d_]*[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)\s*([^\W\d_]{0,12}|°|%|\"|')\s*")
# One `key = value` of a line whose value is no text, list or table.
PLAIN = re.compile(r"([\w.-]+)[ \t]*=[ \t]*([^\s\"'\[{,}#][^\"'\[{}#]*?|)[ \t]*(?=,\s*[\w.-]+\s*=|[}#]|$)")
# Lines longer than this are no slip of a person, and looking into them would take long.
LONGEST_LINE = 1000
WORD = re.compile(r"[^\W_]+")
# What recipes have no keys for, and words of keys that ask for it.
UNSUPPORTED = {
    "friction and wear": "friction wear efficiency lubrication lubricant damping",
    "strength and deformation": "stress stresses strength hardness fatigue stiffness deflection",
    "forces, torques and power": "force forces torque torques load loads payload power gravity weight mass inertia",
    "springs": "spring springs",
    "other units than mm and deg": "unit units inch inches",
}
# Words of keys that the table `loads` serves, in recipes that have it.
SERVED_BY_LOADS = "friction damping force forces torque torques load gravity weight mass inertia spring springs"

# pydantic's types of errors -> kinds of refusal; all others are of a wrong type.
ID_OF: dict[str, ProblemId] = {
    "finite_number": "not-finite",
    **dict.fromkeys(("greater_than", "greater_than_equal", "less_than", "less_than_equal"), "out-of-range"),
}


@cache
def hints_of(table: type) -> dict[str, Any]:
    """Type hints of a dataclass's fields."""
    return get_type_hints(table)


def explain(error: ValidationError, recipe: type) -> list[Problem]:
    """One problem for each finding, in the file's order of keys."""
    found = error.errors(include_url=False)
    return [_problem(e, recipe, k < MOST_SHOWN) for k, e in enumerate(found[:EXPLAINED])] + [
        Problem(printable(".".join(map(str, e["loc"]))), printable(e["msg"]), "mend it", "wrong-type")
        for e in found[EXPLAINED:]
    ]


# Keys that had another name before, and are spelt too differently for `nearest`.
RENAMED = {"thinning": "tooth_thickness_allowance", "seconds": "time_limit"}


def nearest(name: object, known: Iterable[str]) -> str:
    """`did you mean ...? ` if a known name is spelt much alike, or has all words of this one; else nothing.

    It is what a remedy begins with. One word alike is not enough: a worm gear is no spur gear.
    """
    if not isinstance(name, str) or not (words := WORD.findall(name[:100].lower())):
        return ""
    close = {other: _likeness(words, WORD.findall(other.lower())) for other in known}
    best = max(close, key=lambda other: close[other], default="")
    return f"did you mean {best}? " if best and close[best] else ""


def _likeness(words: list[str], others: list[str]) -> float:
    """How alike two names are, 0 to 1; 0 if they are no misspelling of each other."""

    def ratio(one: str, other: str) -> float:
        return SequenceMatcher(None, one, other).ratio()

    whole = ratio("".join(words), "".join(others))
    each = all(
        any(ratio(one, two) >= (0.6 if max(len(one), len(two)) < 5 else 0.82) for two in others) for one in words
    )
    return whole if each or whole >= 0.85 else 0.0


def _unsupported(key: object) -> str:
    """What a key asks for that geomkin does not know of; else nothing."""
    words = set(WORD.findall(str(key)[:100].lower()))
    return next((topic for topic, signs in UNSUPPORTED.items() if words & set(signs.split())), "")


def _problem(e: Any, recipe: type, hinted: bool) -> Problem:
    """hinted: whether anyone will read it; to look for near names takes longest."""
    tables, field, hint, key = _place(e["loc"], recipe)
    about = field.metadata if field else {}
    found = f"found {shown(e['input'])}"
    match e["type"]:
        case "missing":
            return Problem(
                key, "is missing", _table_wanted(hint, key) or f"give {_wanted(about) or 'it'}", "missing-key"
            )
        case "unexpected_keyword_argument":
            known = list(dict.fromkeys(f.name for t in tables for f in dataclasses.fields(t)))
            remedy = f"known here: {', '.join(known)}"
            if hinted:
                homes = [home for home in _homes(recipe, e["loc"][-1]) if home.strip("[]") != key.rpartition(".")[0]]
                name = str(e["loc"][-1])
                near = f"did you mean {RENAMED[name]}? " if RENAMED.get(name) in known else nearest(name, known)
                if any(f.name == e["loc"][-1] for f in dataclasses.fields(recipe)):
                    near = "it belongs above the first [table], beside kind; "
                is_load = bool(set(WORD.findall(name[:100].lower())) & set(SERVED_BY_LOADS.split()))
                if is_load and not near and "loads" in hints_of(recipe):
                    near = "it belongs under [loads]; "
                remedy = (f"it belongs under {' or '.join(homes[:3])}; " if homes else near) + remedy
                if not homes and not near and (topic := _unsupported(e["loc"][-1])):
                    problem = f"unknown key: recipes of this kind know nothing of {topic}"
                    return Problem(key, problem, remedy, "unknown-key")
            return Problem(key, "unknown key", remedy, "unknown-key")
        case "value_error" if isinstance(e["ctx"]["error"], DesignError):
            cause = e["ctx"]["error"]
            return Problem(_join(key, cause.field), cause.problem, cause.remedy, cause.id)
        case "literal_error":
            expected = e["ctx"]["expected"]
            near = nearest(e["input"], expected.replace("'", "").replace(" or ", ", ").split(", "))
            return Problem(key, found, f"{near}give {expected}", "out-of-range")
        case "union_tag_invalid" | "union_tag_not_found":
            tags = [str(kind_of(t)) for t in tables if kind_of(t)]
            tag = e["input"].get("kind") if isinstance(e["input"], dict) else None
            problem = "is missing" if tag is None else f"found {shown(tag)}"
            remedy = f"{nearest(tag, tags)}give {' or '.join(map(repr, tags))}"
            return Problem(_join(key, "kind"), problem, remedy, "missing-key" if tag is None else "unknown-kind")
        case "dataclass_type" | "model_attributes_type" | "dict_type":
            known = [f.name for t in tables for f in dataclasses.fields(t)]
            remedy = _table_wanted(hint, key) or f"give a table with {', '.join(dict.fromkeys(known))}"
            return Problem(key, found, remedy, "wrong-type")
        case "less_than_equal" | "greater_than_equal" if "unit" not in about:
            limit = next(iter(e["ctx"].values()))
            remedy = f"give numbers between {-abs(limit):g} and {abs(limit):g} ({_wanted(about)})"
            return Problem(key, found, remedy, "out-of-range")
        case _:
            is_short = "unit" in about and isinstance(e["input"], str) and len(e["input"]) < 100
            meant = number_meant(e["input"], quoted=True) if is_short else ""
            remedy = f"{meant + '; ' if meant else ''}give {_wanted(about) or e['msg']}"
            return Problem(key, found, remedy, ID_OF.get(e["type"], "wrong-type"))


def _table_wanted(hint: Any, key: str) -> str:
    """`give a table ...` and what it must hold, where a type hint names tables; else nothing."""
    tables = tables_in(hint)
    if not tables:
        return ""
    heading = "" if "[" in key else f", headed {_heading(hint, key)}"
    some = "tables, each" if _is_list(hint) else "a table"
    kinds = [str(kind_of(t)) for t in tables if kind_of(t)]
    if kinds:
        return f"give {some} with kind = {' or '.join(map(repr, kinds))}{heading}"
    fields = dataclasses.fields(tables[0])
    needed = [f.name for f in fields if f.default is MISSING and f.default_factory is MISSING]
    others = [f.name for f in fields if f.name not in needed]
    more = f" (and, as wanted, {', '.join(others)})" if needed and others else ""
    return f"give {some} with {', '.join(needed or others)}{more}{heading}"


def _is_list(hint: Any) -> bool:
    """Whether a recipe gives a list of tables there."""
    return get_origin(hint) is tuple or (dataclasses.is_dataclass(hint) and hint not in tables_in(hint))


def _heading(hint: Any, key: str) -> str:
    return f"[[{key}]]" if _is_list(hint) else f"[{key}]"


def _homes(table: type, name: object, path: str = "") -> list[str]:
    """Headings of the tables in which a key of that name is known."""
    found = []
    for field in dataclasses.fields(table):
        hint, key = hints_of(table)[field.name], path + field.name
        for inner in tables_in(hint):
            if any(f.name == name for f in dataclasses.fields(inner)):
                found.append(_heading(hint, key))
            found += _homes(inner, name, f"{key}.")
    return list(dict.fromkeys(found))


def _wanted(about: Any) -> str:
    """What may stand under a key: the meaning, and for numbers the range."""
    meaning = about.get("description", "").removesuffix(f", {about.get('unit')}")
    return f"{allowed(about)} ({meaning})" if "unit" in about else meaning


def _place(loc: tuple[int | str, ...], recipe: type) -> tuple[list[type], dataclasses.Field[Any] | None, Any, str]:
    """Dataclasses that may stand at a place, the field it is (None for an unknown one), its hint, its dotted key."""
    tables: list[type] = [recipe]
    field: dataclasses.Field[Any] | None = None
    key, chosen, hint = "", False, None
    for part in loc:
        if isinstance(part, int):
            key += f"[{part}]"
            continue
        tagged = [t for t in tables if kind_of(t) == part]
        if tagged and len(tables) > 1:
            tables = tagged
            continue
        key = _join(key, printable(part, 60) or '""')
        owners = [t for t in tables if part in {f.name for f in dataclasses.fields(t)}]
        # Under a field of names that a person chooses, such as bodies, that field says what is wanted.
        if owners or not chosen:
            field = next((f for t in owners for f in dataclasses.fields(t) if f.name == part), None)
            hints = [hints_of(t)[part] for t in owners]
            chosen, hint = any(get_origin(h) is dict for h in hints), hints[0] if hints else None
        tables = [c for t in owners for c in tables_in(hints_of(t)[part])] or tables
    return tables, field, hint, key


def tables_in(hint: Any) -> list[type]:
    """Dataclasses that a type hint names, or their table; of one that is written as the list of its segments, those."""
    if dataclasses.is_dataclass(hint):
        segments = "segments" in (f.name for f in dataclasses.fields(hint))
        return tables_in(get_type_hints(hint)["segments"]) if segments else [hint]  # type: ignore[list-item]
    if isinstance(hint, type) and hasattr(hint, "KINDS"):
        return list(hint.KINDS.values())
    return [table for part in get_args(hint) for table in tables_in(part)]


def kind_of(table: type) -> Any:
    """The `kind` by which a recipe distinguishes a table from others; None if it needs none."""
    return next((f.default for f in dataclasses.fields(table) if f.name == "kind"), None)


def _join(key: str, part: str) -> str:
    """`cam` + `program[2].law`: dotted, without saying a table's name twice."""
    last = key.rsplit(".", 1)[-1]
    if part == last or part.startswith(f"{last}["):
        return key + part[len(last) :]
    return f"{key}.{part}" if key else part


def toml_mistake(text: str, complaint: str) -> Problem | None:
    """What is wrong in the line that a reader of TOML complains of, in a person's words; None where it is no slip."""
    found = re.search(r"line (\d+)", complaint)
    lines = text.split("\n")
    if found is None or int(found[1]) > len(lines):
        return None
    above, line = lines[: int(found[1]) - 1], lines[int(found[1]) - 1]
    if len(line) > LONGEST_LINE:
        return None
    if re.search("[“”„‟«»‘’‚]", line) and "=" in line:  # noqa: RUF001  # what word processors write
        return Problem(
            _key_at(above, line.partition("=")[0]), "found curly quotes", 'write straight ones: "', "invalid-toml"
        )
    for key, value in PLAIN.findall(line):
        remedy = _remedy_for(key, value)
        if remedy:
            return Problem(_key_at(above, key), f"found {printable(value) or 'nothing'}", remedy, "invalid-toml")
    return None


def _remedy_for(key: str, value: str) -> str:
    if not value:
        return "give a value, or take the line out"
    if value.lower() in ("true", "yes", "on"):
        return "" if value == "true" else "write true"
    if value.lower() in ("false", "no", "off"):
        return "" if value == "false" else "write false"
    if re.fullmatch(r"[^\W\d][\w -]*", value) and value not in ("inf", "nan"):
        return f'a text needs quotes: write {key} = "{value}"'
    return number_meant(value)


def number_meant(text: str, quoted: bool = False) -> str:
    """What to write where a person wrote a number with a comma, a unit or quotes; "" where it is no such number."""
    found = NUMBER.fullmatch(text)
    if not found or (not quoted and text == found[1] == _with_point(found[1])):
        return ""
    unit = f" (lengths are in mm, angles in deg, not in {found[2]})" if found[2] not in ("", "mm", "deg", "°") else ""
    return f"write {_with_point(found[1])}, a number with a point and without unit or quotes{unit}"


def _with_point(number: str) -> str:
    """TOML wants a point, and digits on both sides of it."""
    number = re.sub(r"(?<!\d)\.", "0.", number.replace(",", "."))
    return re.sub(r"\.(?!\d)", ".0", number)


def _key_at(above: list[str], key: str) -> str:
    """The dotted key, by the last heading above its line."""
    heads = [
        found[1]
        for line in above
        if (found := re.match(r"\s*\[+\s*([\w. -]+?)\s*\]+\s*(?:#.*)?$", line[:LONGEST_LINE]))
    ]
    return printable(f"{heads[-1]}.{key.strip()}" if heads else key.strip())
