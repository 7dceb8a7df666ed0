"""Slips that people make when they write TOML: words without quotes, decimal commas, units behind numbers."""

from __future__ import annotations

import re

from ..errors import Problem, printable

NUMBER = re.compile(r"\s*([+-]?(?:\d[\d_]*[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)\s*([^\W\d_]{0,12}|°|%|\"|')\s*")
# One `key = value` of a line whose value is no text, list or table.
PLAIN = re.compile(r"([\w.-]+)[ \t]*=[ \t]*([^\s\"'\[{,}#][^\"'\[{}#]*?|)[ \t]*(?=,\s*[\w.-]+\s*=|[}#]|$)")
# Lines longer than this are no slip of a person, and looking into them would take long.
LONGEST = 1000


def slip(text: str, complaint: str) -> Problem | None:
    """What is wrong in the line that a reader of TOML complains of, in a person's words; None where it is no slip."""
    found = re.search(r"line (\d+)", complaint)
    lines = text.split("\n")
    if found is None or int(found[1]) > len(lines):
        return None
    above, line = lines[: int(found[1]) - 1], lines[int(found[1]) - 1]
    if len(line) > LONGEST:
        return None
    if re.search("[“”„‟«»‘’‚]", line) and "=" in line:
        return Problem(_key(above, line.partition("=")[0]), "found curly quotes", 'write straight ones: "')
    for key, value in PLAIN.findall(line):
        remedy = _remedy(key, value)
        if remedy:
            return Problem(_key(above, key), f"found {printable(value) or 'nothing'}", remedy)
    return None


def _remedy(key: str, value: str) -> str:
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


def _key(above: list[str], key: str) -> str:
    """The dotted key, by the last heading above its line."""
    heads = [
        found[1] for line in above if (found := re.match(r"\s*\[+\s*([\w. -]+?)\s*\]+\s*(?:#.*)?$", line[:LONGEST]))
    ]
    return printable(f"{heads[-1]}.{key.strip()}" if heads else key.strip())
