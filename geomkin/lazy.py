"""Names of a folder that are loaded when first asked for, so that importing geomkin stays light."""

from __future__ import annotations

import ast
import inspect
import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module


def attach(package: str) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package, from the imports that it makes for type checkers.

    The one list of its names stands in its `__init__`, below `if TYPE_CHECKING:`, as
    `from .module import Name as Name`, or `from . import folder as folder`.
    """

    @cache
    def homes() -> dict[str, str]:
        tree = ast.parse(inspect.getsource(sys.modules[package]))
        imports = [node for block in tree.body if isinstance(block, ast.If) for node in block.body]
        return {
            name.name: f"{package}.{node.module}" if node.module else ""
            for node in imports
            if isinstance(node, ast.ImportFrom) and node.level == 1
            for name in node.names
        }

    def load(name: str) -> object:
        if name.startswith("_") or name not in homes():
            raise AttributeError(f"{package} has no {name!r}")
        home = homes()[name]
        value: object = getattr(import_module(home), name) if home else import_module(f"{package}.{name}")
        setattr(sys.modules[package], name, value)
        return value

    return load, lambda: sorted({*homes(), *vars(sys.modules[package])} - {"TYPE_CHECKING", "attach"})
