"""Mechanisms and recipes in another size. The declarations of the fields state which of them are lengths."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any, TypeVar

from .arguments import between, checked
from .errors import DesignError
from .field_visitor import Number, with_numbers
from .units import length_power, marked

T = TypeVar("T")
# Beyond this range every mechanism leaves the range of permitted sizes.
Scale = Annotated[float, between(1e-6, 1e6)]


@checked
def scaled(thing: T, scale: Scale) -> T:
    """A linkage or cam, or a recipe of one, in another size.

    Angles, times, masses and numbers of turns stay.

    Parameters
    ----------
    thing : a linkage, a cam, or a recipe of either
        In a recipe every length of the mechanism, of its stroke and of a goal is multiplied; `stock` with its screws
        and motor, `base` and `files` stay. Points and lifts that are read from a file are multiplied, and are then
        written in the recipe itself. A slide keeps its times: its speed and acceleration are multiplied. A cam's lifts
        in degrees stay.
    scale : float
        From 1e-6 to 1e6; lengths are multiplied by it, 1/mm is divided by it, kg mm multiplied.

    Returns
    -------
    The same type.

    Raises
    ------
    DesignError
        If the thing cannot be scaled, or a length leaves its range.

    See Also
    --------
    load, edit

    Examples
    --------
    >>> import geomkin as gk
    >>> gk.scaled(gk.FourBar(100, 30, 90, 70), 0.5)
    FourBar(ground=50.0, crank=15.0, coupler=45.0, rocker=35.0)
    """
    if not getattr(thing, "can_be_scaled", False) or isinstance(thing, type):
        raise DesignError(
            "thing", f"found {type(thing).__name__}", "give a linkage, a cam, or a recipe of either", "wrong-type"
        )
    if scale == 1:
        return thing
    try:
        result: T = thing.at_scale(scale) if hasattr(thing, "at_scale") else with_lengths(thing, scale)
    except DesignError as error:
        problem = f"found {scale:g}, with which {error.field}: {marked(error.problem)}"
        raise DesignError("scale", problem, error.remedy, error.id) from None
    return result


def with_lengths(thing: Any, scale: float, but: Collection[str] = ()) -> Any:
    """A dataclass whose fields are multiplied as their declarations require. but: names of tables that stay."""

    def multiplied(number: Number) -> Any:
        power = length_power(number.unit)
        return number.value * scale**power if power else number.value

    def inside(inner: Any, key: str) -> Any:
        return inner if key in but else inner.at_scale(scale) if hasattr(inner, "at_scale") else None

    return with_numbers(thing, multiplied, inside)
