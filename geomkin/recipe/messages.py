"""Error messages about recipes: the key, the value found, what is allowed, and the nearest known name."""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import SequenceMatcher
from typing import Any

from ..core.errors import Problem, printable
from ..core.field_visitor import DeclaredField, fields_of, key_parts, kind_of
from ..core.fields import allowed
from ..core.units import PLURAL, START, marked, unit_name

NUMBER = re.compile(r"\s*([+-]?(?:\d[\d_]*[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)\s*([^\W\d_]{0,12}|°|%|\"|')\s*")
# One `key = value` of a line, if the value is neither a text, a list nor a table.
PLAIN = re.compile(r"([\w.-]+)[ \t]*=[ \t]*([^\s\"'\[{,}#][^\"'\[{}#]*?|)[ \t]*(?=,\s*[\w.-]+\s*=|[}#]|$)")
# Longer lines are not searched for mistakes, since this would take long.
LONGEST_LINE = 1000
WORD = re.compile(r"[^\W_]+")
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

# Mechanisms that no kind makes, by a word of their names, and the kinds that come nearest.
NOT_OFFERED = {
    **dict.fromkeys(("worm", "harmonic", "strain"), "planetary or cycloidal-drive"),
    **dict.fromkeys(("bevel", "hypoid", "crown", "miter", "mitre"), "gear-pair"),
    **dict.fromkeys(("screw", "leadscrew", "ballscrew", "nut"), "rack-and-pinion"),
    **dict.fromkeys(("v", "flat", "rope", "cable", "capstan", "ribbed"), "belt-drive"),
    **dict.fromkeys(("escapement",), "ratchet"),
    **dict.fromkeys(("barrel", "cylindrical", "globoid"), "groove-cam"),
    **dict.fromkeys(("universal", "cardan", "hooke", "u", "cv"), "oldham-coupling"),
    **dict.fromkeys(("delta", "hexapod", "stewart", "scara", "robot", "spherical", "flexure", "compliant", "sarrus"),
                    "linkage"),
    **dict.fromkeys(("wobble", "swash"), "slider-crank"),
    **dict.fromkeys(("noncircular", "elliptical", "mutilated"), "gear-pair"),
}  # fmt: skip

# Other names of what a kind, or a recipe of the gallery, makes; of several in one name the first counts.
ALSO_KNOWN_AS = {
    "belt-drive": ("pulley", "timing belt", "toothed belt", "synchronous belt", "idler", "gt2", "htd"),
    "chain-drive": ("sprocket", "roller chain", "bicycle chain", "bike chain", "derailleur"),
    "planetary": ("epicyclic", "sun gear", "planet gear", "differential"),
    "cycloidal-drive": ("cycloidal gear", "cycloidal reducer", "cycloidal gearbox", "cyclo"),
    "rack-and-pinion": ("linear gear",),
    "ring-gear": ("annulus",),
    "lantern-gears": ("pin gear", "pin wheel", "cage gear"),
    "gear-train": ("gearbox", "gear box", "reducer", "reduction", "compound gear", "motion work", "clockwork"),
    "geneva": ("maltese", "indexer", "intermittent", "indexing"),
    "ratchet": ("pawl", "freewheel", "one way clutch"),
    "groove-cam": ("face cam", "track cam", "box cam", "desmodromic"),
    "disk-cam": ("plate cam", "camshaft", "snail cam", "eccentric", "follower"),
    "slider-crank": ("piston", "engine", "crankshaft"),
    "inverted-slider-crank": ("oscillating cylinder",),
    "watt-six-bar": ("6 bar",),
    "four-bar": ("4 bar", "pumpjack", "pump jack", "ackermann", "steering"),
    "linkage": ("5 bar", "five bar", "8 bar", "eight bar", "bell crank"),
    "elliptic-trammel": ("ellipsograph", "trammel of archimedes", "tusi"),
    "fit-test": ("kerf", "tolerance coupon"),
    "lift-table": ("scissor", "lazy tong"),
    "walker": ("strandbeest",),
    "peaucellier": ("hart",),
}


def other_names(*names: str) -> str:
    """Other names of kinds and recipes, by which they are searched."""
    return " ".join(other for name in names for other in ALSO_KNOWN_AS.get(name, ()))


# Largest number of recipes of the gallery that a message names.
MOST_RECIPES = 8


def nearest_kind(name: object, kinds: Iterable[str]) -> str:
    """The start of a remedy for an unknown kind: what was meant, recipes of the gallery, or the nearest kinds."""
    from .kinds import gallery

    meant = did_you_mean(name, kinds)
    words = WORD.findall(name[:100].lower()) if isinstance(name, str) else []
    if not meant and (nearest := next((NOT_OFFERED[word] for word in words if word in NOT_OFFERED), "")):
        return f"geomkin makes planar mechanisms, but not this one; nearest to it is {nearest}; "
    also = "" if meant else next((one for one, names in ALSO_KNOWN_AS.items() if _has_phrase(words, names)), "")
    if also in kinds:
        return f"did you mean {also}? "
    known = {file.removesuffix(".toml"): about.lower() for file, (_, about) in gallery()[1].items()}

    def is_meant(recipe: str) -> bool:
        """Whether the name has the recipe's, or is nearly it, or all its words describe the recipe."""
        described = WORD.findall(f"{recipe} {known[recipe]}")
        is_described = all(any(other.startswith(word) for other in described) for word in words)
        return recipe in words or (not meant and (is_described or bool(did_you_mean(name, [recipe]))))

    named = [recipe for recipe in known if words and recipe not in kinds and is_meant(recipe)][:MOST_RECIPES]
    named = [also] if also in known else named
    if named:
        return f"{meant}the gallery has {', '.join(named)}, which `geomkin new {named[0]}` prints; "
    return meant


def _has_phrase(words: list[str], phrases: Iterable[str]) -> bool:
    """Whether one of the phrases, or its plural, is among the words of a name."""
    return any(re.search(rf"\b{phrase}s?\b", " ".join(words)) for phrase in phrases)


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """The start of a remedy, `did you mean ...? `, if a known name is similar; otherwise "".

    Two names are similar if they are spelt alike, or if each word of the shorter one is similar to a word of the other:
    a planetary gear is a planetary. A single common word is not enough: a worm gear is no spur gear.
    """
    if not isinstance(name, str) or not (words := WORD.findall(name[:100].lower())):
        return ""
    similarity = {other: _similarity(words, WORD.findall(other.lower())) for other in known}
    best = max(similarity, key=lambda other: similarity[other], default="")
    return f"did you mean {best}? " if best and similarity[best] else ""


def _similarity(words: list[str], others: list[str]) -> float:
    """Similarity of two names, 0 to 1; 0 if neither is a misspelling of the other."""

    def ratio(a: str, b: str) -> float:
        return SequenceMatcher(None, a, b).ratio()

    def is_similar(word: str, other: str) -> bool:
        has_swapped_letters = sorted(word) == sorted(other)
        return has_swapped_letters or ratio(word, other) >= (0.6 if max(len(word), len(other)) < 5 else 0.82)

    whole = ratio("".join(words), "".join(others))
    has_all_words = all(any(is_similar(word, other) for other in others) for word in words)
    # One of several words may be the name of something else.
    is_within = whole >= 0.6 and all(any(is_similar(word, other) for word in words) for other in others)
    return whole if has_all_words or is_within or whole >= 0.85 else 0.0


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
    known += ["workshop"] if recipe is table and hasattr(recipe, "loaded_table") else []
    problem, remedy = "unknown key", f"known here: {', '.join(known)}"
    if not is_shown:
        return Problem(key, problem, remedy, "unknown-key")
    homes, here = _homes(recipe, name), re.sub(r"\[\d+\]", "", key.rpartition(".")[0])
    headings = list(dict.fromkeys(heading for heading, _ in homes if heading.strip("[]") != here))
    kinds = [repr(kind) for heading, kind in homes if heading.strip("[]") == here and kind]
    near = f"did you mean {RENAMED[name]}? " if RENAMED.get(name) in known else did_you_mean(name, known)
    is_load = bool(set(WORD.findall(name[:100].lower())) & set(SERVED_BY_LOADS.split()))
    if kinds:
        near = f"it is a key of kind = {' or '.join(kinds)}; "
    elif headings:
        near = f"it belongs under {' or '.join(headings[:3])}; "
    elif name in fields_of(recipe):
        near = "it belongs above the first [table], next to kind; "
    elif is_load and not near and "loads" in fields_of(recipe):
        near = "it belongs under [loads]; "
    elif (is_load or name == "loads") and not near and "mechanisms" in fields_of(recipe):
        near = "it belongs in the recipe of a mechanism, under [mechanisms.NAME.recipe.loads]; "
    elif not near and (topic := _unsupported(name)):
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
    for key, value in PLAIN.findall(line):
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
