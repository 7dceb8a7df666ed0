"""A thing on one line: what a shell shows of it, however much it holds."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

# Characters of a whole line, and of one of its fields. More wraps in a terminal, and hides the fields behind it.
LONGEST, LONGEST_FIELD = 110, 40


def one_line(self: Any) -> str:
    """What `__repr__` gives: the class and its fields, arrays by their shape, things of geomkin by their class.

    A class takes it by `__repr__ = one_line`.
    """
    return _told(self, [f.name for f in dataclasses.fields(self) if f.repr])


def as_given(self: Any) -> str:
    """The same with those fields alone that differ from what leaving them out means: for sizes with many of them."""
    told = [f for f in dataclasses.fields(self) if f.name != "kind" and getattr(self, f.name) != f.default]
    return _told(self, [f.name for f in told])


def _told(self: Any, names: list[str]) -> str:
    whole = f"{type(self).__name__}({', '.join(f'{name}={short(getattr(self, name))}' for name in names)})"
    return whole if len(whole) <= LONGEST else f"{whole[: LONGEST - 4]}...)"


def short(value: object) -> str:
    """A value in few characters."""
    if isinstance(value, np.ndarray) and value.ndim:
        return f"<{' x '.join(map(str, value.shape))} {'complex' if np.iscomplexobj(value) else value.dtype.kind}>"
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value))
    if isinstance(value, (float, complex, np.generic, np.ndarray)):
        return f"{value:.6g}" if not isinstance(value, np.ndarray) else f"{value.item():.6g}"
    if dataclasses.is_dataclass(value):
        return f"{type(value).__name__}(...)"
    if isinstance(value, Mapping):
        return f"{{{len(value)}: {', '.join(map(str, value))}}}"[:LONGEST_FIELD]
    if isinstance(value, (tuple, list)) and len(value) > 3:
        return f"<{len(value)} {type(value[0]).__name__}>"
    return " ".join(repr(value).split())[:LONGEST_FIELD]
