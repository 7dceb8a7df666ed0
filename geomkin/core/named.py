"""Objects of folders above, by names that `geomkin/face.py` fills in, so that no folder names one above it."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

# Functions by task: "page" takes a job, "moving" an object, "still" a title, curves and marks. "colours" returns those
# of the page.
VIEWS: dict[str, str] = {}
# Kinds of recipe under each heading of `geomkin list`: the class of each.
KINDS_BY_GROUP: dict[str, Mapping[str, str]] = {}


def named(home: str) -> Any:
    """The object `module:name`, imported on first use."""
    module, _, name = home.partition(":")
    return getattr(import_module(module), name)
