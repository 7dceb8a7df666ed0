"""What geomkin must know of a kind of mechanism."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from ..check import Check
from ..part import Part
from ..table import Table


class Kind(NamedTuple):
    """recipe: its dataclass, whose docstring introduces it; the others are functions of an instance.

    notes: further entries of summary.json. fit: of the tables that a template is to show, dotted key -> kind, the
    sizes by dotted key that make an example of them; what it leaves out is made of the examples of its fields.
    advice: what a template says further.
    """

    recipe: type
    table: Callable[[Any], Table]
    checks: Callable[[Any], list[Check]]
    parts: Callable[[Any], list[Part]]
    notes: Callable[[Any], dict[str, Any]] = lambda recipe: {}
    fit: Callable[[Mapping[str, str]], dict[str, Any]] = lambda asked: {}
    advice: str = ""

    @property
    def about(self) -> str:
        """One line that introduces the kind."""
        return " ".join((self.recipe.__doc__ or "").split())
