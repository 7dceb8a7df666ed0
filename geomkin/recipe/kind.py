"""What geomkin must know of a kind of mechanism."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from ..check import Check
from ..part import Part
from ..table import Table


class Kind(NamedTuple):
    """recipe: its dataclass, whose docstring introduces it; the others are functions of an instance.

    notes: further entries of summary.json.
    """

    recipe: type
    table: Callable[[Any], Table]
    checks: Callable[[Any], list[Check]]
    parts: Callable[[Any], list[Part]]
    notes: Callable[[Any], dict[str, Any]] = lambda recipe: {}

    @property
    def about(self) -> str:
        """One line that introduces the kind."""
        return " ".join((self.recipe.__doc__ or "").split())
