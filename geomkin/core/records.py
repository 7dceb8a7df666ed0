"""Records: frozen dataclasses that check their fields and are shown on one line."""

from __future__ import annotations

import dataclasses
import inspect
import re
import sys
from collections.abc import Callable
from typing import Any, TypeVar, dataclass_transform, overload

from .fields import allowed, check_sizes, entry, one_line, quantity

T = TypeVar("T")


@overload
def record(cls: type[T], /) -> type[T]: ...
@overload
def record(
    *, checked: bool = False, arrays: bool = False, eq: bool = True, kw_only: bool = False
) -> Callable[[type[T]], type[T]]: ...
@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field, entry, quantity))
def record(
    cls: type[T] | None = None,
    /,
    *,
    checked: bool = False,
    arrays: bool = False,
    eq: bool = True,
    kw_only: bool = False,
) -> Any:
    """Make a class a frozen dataclass whose `repr` is one line.

    A docstring without "Parameters" gets them from the declarations of the fields.

    Parameters
    ----------
    checked : bool
        Whether creation raises DesignError for the first field that its declaration does not allow, before
        `__post_init__` runs.
    arrays : bool
        Whether quantities may be arrays, one value for each of many mechanisms.
    eq, kw_only : bool
        As for `dataclasses.dataclass`.
    """

    def decorate(cls: type[T]) -> type[T]:
        if checked:
            after: Callable[[T], None] | None = getattr(cls, "__post_init__", None)

            def check(self: T) -> None:
                check_sizes(self, arrays)
                if after:
                    after(self)

            cls.__post_init__ = check  # type: ignore[attr-defined]
        if cls.__repr__ is object.__repr__:
            cls.__repr__ = one_line  # type: ignore[method-assign]
        made = dataclasses.dataclass(frozen=True, eq=eq, kw_only=kw_only, repr=False)(cls)
        # Python's optimised mode has no docstrings.
        if made.__doc__ and "Parameters\n" not in made.__doc__:
            made.__doc__ = _with_parameters(made, made.__doc__)
        return made

    return decorate if cls is None else decorate(cls)


def _with_parameters(cls: type, doc: str) -> str:
    """A docstring with the section "Parameters": what the fields declare, or the first line on the type of a table."""
    rows = []
    for field in dataclasses.fields(cls):
        if not field.init or field.name.startswith("_"):
            continue
        optional = ", optional" if (field.default, field.default_factory) != (dataclasses.MISSING,) * 2 else ""
        about = field.metadata.get("description") or _first_line(sys.modules[cls.__module__], field.type)
        limits = allowed(field.metadata) if {"gt", "ge", "lt", "le"} & set(field.metadata) else ""
        rows.append(f"{field.name} : {field.type}{optional}")
        rows += [f"    {about[:1].upper()}{about[1:]}{f': {limits}' if limits else ''}."] if about else []
    head, *sections = re.split(r"\n\n(?=\w+\n-{3})", inspect.cleandoc(doc))
    return "\n\n".join([head, "\n".join(["Parameters", "----------", *rows]), *sections]) if rows else doc


def _first_line(module: object, annotation: object) -> str:
    """The first line on the class that an annotation names; "" if it names none."""
    about = getattr(module, str(annotation), None)
    return (about.__doc__ or "").split("\n")[0].rstrip(".") if isinstance(about, type) and about.__doc__ else ""
