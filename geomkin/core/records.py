"""Records: frozen dataclasses that check their fields and are shown on one line."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, TypeVar, dataclass_transform, overload

from .fields import check_sizes, entry, quantity
from .reprs import one_line

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

    Parameters
    ----------
    checked : bool
        Whether creation raises DesignError for the first field that its declaration does not allow, before the
        class's own `__post_init__` runs.
    arrays : bool
        Whether quantities may be arrays, one value for each of many mechanisms.
    eq, kw_only : bool
        As for `dataclasses.dataclass`.
    """

    def decorate(cls: type[T]) -> type[T]:
        if checked:
            after: Callable[[T], None] | None = vars(cls).get("__post_init__")

            def check(self: T) -> None:
                check_sizes(self, arrays)
                if after:
                    after(self)

            cls.__post_init__ = check  # type: ignore[attr-defined]
        if cls.__repr__ is object.__repr__:
            cls.__repr__ = one_line  # type: ignore[method-assign]
        return dataclasses.dataclass(frozen=True, eq=eq, kw_only=kw_only, repr=False)(cls)

    return decorate if cls is None else decorate(cls)
