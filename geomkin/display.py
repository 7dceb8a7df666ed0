"""What a notebook shows of a thing: its page in a frame, or a picture; what draws it is loaded when it is shown.

That stands above all that is drawn and knows it, so that it is asked for by its name here, and only then.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any


def moving(self: Any) -> str:
    """What `_repr_html_` gives, by `_repr_html_ = moving` in a class: the thing moving, or in words why it cannot."""
    told: str = import_module(f"{__package__}.notebook").inline(self)
    return told


def still(self: Any, curves: Sequence[Any], marks: Sequence[Any] = ()) -> str | None:
    """What `_repr_svg_` gives: curves and engraved marks of a thing as an SVG text; None where they cannot be drawn."""
    told: str | None = import_module(f"{__package__}.export.thumbnail").picture(repr(self), curves, marks)
    return told
