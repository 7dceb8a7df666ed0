"""What a number that is left out means, and its limits, over the whole package.

`python -m tests.tables.left_out` writes both tables anew, in the order in which they are; the difference is looked over.
"""

import csv
import dataclasses
import importlib
import inspect
import pkgutil
from pathlib import Path

import geomkin as gk

QUANTITIES = Path(__file__).with_name("quantities.csv")
CHOICES = Path(__file__).with_name("defaults.csv")
LIMITS = ("gt", "ge", "lt", "le")


def classes():
    """Every dataclass of the package by its name."""
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
    return {c.__name__: c for c in found if dataclasses.is_dataclass(c)}


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
    """Name of each other field, and of each argument of a public call -> what it is where left out, as text."""
    rooms = (gk.plane, gk.linkage, gk.cam, gk.gear, gk.synthesis, gk.judge, gk.shop, gk.scenes, gk)
    calls = {name: getattr(room, name) for room in rooms for name in dir(room) if not name.startswith("_")}
    calls = {name: call for name, call in calls.items() if inspect.isfunction(call)}
    told = quantities(made)
    found = {
        f"{name}.{given.name}": str(given.default)
        for name, one in (made | calls).items()
        for given in inspect.signature(one).parameters.values()
        if given.default is not given.empty
    }
    return {name: text for name, text in found.items() if name not in told}


def kept(table):
    """Header and rows of one of the two, the rows by their name."""
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
    _write(CHOICES, {name: [text] for name, text in choices(everything).items()})
