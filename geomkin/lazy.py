"""Names of a folder that are loaded when first asked for, so that importing geomkin stays light."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import cache
from importlib import import_module
from types import SimpleNamespace
from typing import Any


def attach(package: str) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package, from the imports that it makes for type checkers.

    The one list of its names stands in its `__init__`, below `if TYPE_CHECKING:`, as
    `from .module import Name as Name`, or `from . import folder as folder`. `from package import *` takes them all.
    """

    @cache
    def homes() -> dict[str, tuple[str, str]]:
        """Module and name there of each name: the `__init__` run again as type checkers see it, importing nothing."""

        def note(module: str, _globals: Any, _locals: Any, names: Sequence[str], level: int) -> SimpleNamespace:
            # At level 0 is `typing`, whose TYPE_CHECKING is to be true; at 1 are the modules of the package.
            return SimpleNamespace(**{name: (module, name) if level else True for name in names})

        seen: dict[str, Any] = {"__builtins__": {"__import__": note}}
        exec(sys.modules[package].__spec__.loader.get_code(package), seen)  # type: ignore[union-attr]
        return {name: home for name, home in seen.items() if isinstance(home, tuple) and not name.startswith("_")}

    def load(name: str) -> object:
        if name == "__all__":
            return list(homes())
        if name.startswith("_") or name not in homes():
            raise AttributeError(f"module {package!r} has no attribute {name!r}", name=name, obj=sys.modules[package])
        module, there = homes()[name]
        home = import_module(f"{package}.{module or there}")
        value: object = getattr(home, there) if module else home
        setattr(sys.modules[package], name, value)
        return value

    def offered() -> list[str]:
        return sorted({*homes(), *(name for name in vars(sys.modules[package]) if name.startswith("__"))})

    return load, offered
