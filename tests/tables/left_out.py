"""What a number that is left out means, and its limits, over the whole package.

`python -m tests.tables.left_out` writes the tables anew, in the order in which they are; the difference is looked over.
"""

import csv
import dataclasses
import importlib
import inspect
import pkgutil
import types
from pathlib import Path
from typing import get_type_hints

import geomkin as gk
from geomkin.arguments import sort_of

QUANTITIES = Path(__file__).with_name("quantities.csv")
CHOICES = Path(__file__).with_name("defaults.csv")
ARGUMENTS = Path(__file__).with_name("arguments.csv")
LIMITS = ("gt", "ge", "lt", "le")


def classes():
    """Every dataclass of the package by its name."""
    return {name: c for name, c in _classes().items() if dataclasses.is_dataclass(c)}


def _classes():
    """Every class of the package by its name; of several by one name all but one have their module before it."""
    modules = [
        importlib.import_module(m.name)
        for m in pkgutil.walk_packages(gk.__path__, "geomkin.")
        if not m.name.endswith(("__main__", ".compiled"))
    ]
    found = [
        c
        for module in modules
        for c in vars(module).values()
        if isinstance(c, type) and c.__module__ == module.__name__
    ]
    plain = {c.__name__: c for c in sorted(found, key=dataclasses.is_dataclass)}
    return {c.__name__ if plain[c.__name__] is c else f"{c.__module__}.{c.__name__}": c for c in found}


def quantities(made):
    """Name of each quantity -> what it is where left out, and its four limits, as texts."""
    return {
        f"{name}.{field.name}": [
            "" if field.default is dataclasses.MISSING else str(field.default),
            *(str(field.metadata.get(key, "")) for key in LIMITS),
        ]
        for name, one in made.items()
        for field in dataclasses.fields(one)
        if "unit" in field.metadata
    }


def choices(made):
    """Each other field, and each argument of a public call or method, by name -> what it is where left out, as text."""
    told = quantities(made)
    found = {
        f"{name}.{given.name}": str(given.default)
        for name, one in (made | _calls()).items()
        for given in inspect.signature(one).parameters.values()
        if given.default is not given.empty
    }
    return {name: text for name, text in found.items() if name not in told}


def arguments(made):
    """Each field and argument that is held to numbers, by name -> what is allowed, in the words of its refusal."""
    # What a writer takes is known to type checkers only, as is what calls take that are not checked.
    known = {name: one for name, one in made.items() if name != "Writer"}
    known |= {name: inspect.unwrap(call) for name, call in _calls().items() if inspect.unwrap(call) is not call}
    found = {
        f"{name}.{argument}": sort.allowed
        for name, one in known.items()
        for argument, hint in get_type_hints(one, include_extras=True).items()
        if argument != "return" and (sort := sort_of(hint))
    }
    return {name: text for name, text in found.items() if any(letter.isdigit() for letter in text)}


def _calls():
    """Every public call and method by its name."""
    rooms = (gk.plane, gk.linkage, gk.cam, gk.gear, gk.synthesis, gk.judge, gk.shop, gk.scenes, gk)
    calls = {name: getattr(room, name) for room in rooms for name in dir(room) if not name.startswith("_")}
    methods = {
        f"{name}.{method}": getattr(one, method)
        for name, one in _classes().items()
        for method, kept_as in vars(one).items()
        if isinstance(kept_as, types.FunctionType | classmethod | staticmethod)
        and not any(part.startswith("_") for part in (one.__name__, method))
    }
    return {name: call for name, call in calls.items() if inspect.isfunction(call)} | methods


def kept(table):
    """Header and rows of one of them, the rows by their name."""
    header, *rows = csv.reader(table.read_text().splitlines())
    return header, {row[0]: row[1:] for row in rows}


def _write(table, found):
    header, before = kept(table)
    after = {name: found[name] for name in [*(name for name in before if name in found), *found]}
    with table.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *([name, *row] for name, row in after.items())])


if __name__ == "__main__":
    everything = classes()
    _write(QUANTITIES, quantities(everything))
    _write(ARGUMENTS, {name: [text] for name, text in arguments(everything).items()})
    _write(CHOICES, {name: [text] for name, text in choices(everything).items()})
