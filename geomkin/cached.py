"""Properties that are worked out when first asked for and kept."""

from __future__ import annotations

import functools
from typing import Self, TypeVar, overload

T = TypeVar("T")


class cached_property(functools.cached_property[T]):  # noqa: N801  # the name that everybody knows it by
    """That of `functools` without its lock, as every Python from 3.12 on has it.

    Before, one lock stands before a property of all things of a class: a thread that works it out for one linkage keeps
    all others waiting, each with a linkage of its own. Two threads that ask one thing at once may both work it out, and
    get the same. Only for what hangs on nothing but the thing, and for classes whose things have a `__dict__`.
    """

    @overload
    def __get__(self, thing: None, kind: type | None = None) -> Self: ...
    @overload
    def __get__(self, thing: object, kind: type | None = None) -> T: ...
    def __get__(self, thing: object, kind: type | None = None) -> Self | T:
        if thing is None:
            return self
        value = thing.__dict__[self.attrname] = self.func(thing)  # type: ignore[index]  # named by its class
        return value
