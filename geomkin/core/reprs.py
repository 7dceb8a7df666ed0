"""Short representations of objects: one line for `repr`, and drawings for notebooks."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .errors import harmless, shown
from .named import VIEWS, named

# Most characters of a whole line, and of one of its fields. A longer line wraps in a terminal; a longer field leaves no
# room for the others.
LONGEST, LONGEST_FIELD = 120, 40
# Words for NumPy's one-letter kinds of elements.
KINDS = {"f": "real", "c": "complex", "i": "whole", "u": "whole", "b": "bool", "U": "text"}


def one_line(self: Any) -> str:
    """Text for `__repr__`: the class and its fields, without those that have their default.

    Arrays are shown by shape and kind, sequences by their length, other things by their class alone. A class
    takes it by `__repr__ = one_line` in its body; every curve has it.
    """
    fields = dataclasses.fields(self) if dataclasses.is_dataclass(self) else ()
    shown = [(f.name, getattr(self, f.name)) for f in fields if f.repr and not _is_default(f, getattr(self, f.name))]
    return clipped(f"{type(self).__name__}({', '.join(f'{name}={short(value)}' for name, value in shown)})")


def _is_default(field: dataclasses.Field[Any], value: object) -> bool:
    plain = isinstance(value, (str, int, float, complex))
    return value is field.default or (plain and type(value) is type(field.default) and bool(value == field.default))


def clipped(text: str, longest: int = LONGEST) -> str:
    """The text on one line of at most `longest` characters; a shortened text keeps its last one, such as a bracket."""
    text = harmless(text)
    return text if len(text) <= longest else f"{text[: longest - 4]}...{text[-1]}"


def short(value: object) -> str:
    """A value in few characters."""
    if isinstance(value, np.ndarray) and value.ndim:
        return f"<{' x '.join(map(str, value.shape))} {KINDS.get(value.dtype.kind, value.dtype.name)}>"
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.item()
    if isinstance(value, (float, complex)):
        return f"{value:.6g}"
    if value is None or isinstance(value, (str, int)):
        return clipped(shown(value), LONGEST_FIELD)
    if isinstance(value, Mapping):
        return clipped(f"{{{', '.join(map(str, value))}}}", LONGEST_FIELD)
    if isinstance(value, (tuple, list)):
        each = [short(item) for item in value] if len(value) < 4 else []
        line = f"({', '.join(each)})"
        if len(each) == len(value) and not any("(...)" in text for text in each) and len(line) <= LONGEST_FIELD:
            return line
        return f"<{len(value)} {' or '.join(sorted({type(item).__name__ for item in value}))}>"
    return value.__name__ if callable(value) and hasattr(value, "__name__") else f"{type(value).__name__}(...)"


def moving_picture(self: Any) -> str:
    """The moving drawing as HTML, or why there is none; a class has it by `_repr_html_ = moving_picture`."""
    html: str = named(VIEWS["moving"])(self)
    return html


def still_picture(self: Any, curves: Sequence[Any], marks: Sequence[Any] = ()) -> str | None:
    """Curves and engraved marks of an object as SVG, for `_repr_svg_`; None if they cannot be drawn."""
    svg: str | None = named(VIEWS["still"])(repr(self), curves, marks)
    return svg
