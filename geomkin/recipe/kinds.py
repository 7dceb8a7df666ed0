"""The one table of kinds. A new kind of mechanism is one recipe class, one `KIND` beside it and one row here."""

from __future__ import annotations

from importlib import import_module

from .kind import Kind

# Name in a recipe -> the module here that holds its KIND; only the kind asked for is loaded.
KINDS = {
    "four-bar": "four_bar",
    "disk-cam": "disk_cam",
    "spur-gear": "spur_gear",
}


def kind(name: str) -> Kind:
    """The kind of that name; KeyError for another."""
    return import_module(f".{KINDS[name]}", __package__).KIND
