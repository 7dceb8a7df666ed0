"""Mechanisms and recipes in another size. The declarations of the fields state which of them are lengths."""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Collection, Mapping, Sequence
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from .arguments import between, checked
from .errors import DesignError
from .units import length_power

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
        result: T = resized(thing, scale)
    except DesignError as error:
        problem = f"found {scale:g}, with which {error.field}: {error.problem}"
        raise DesignError("scale", problem, error.remedy, error.id) from None
    return result


def resized(thing: Any, scale: float) -> Any:
    """A dataclass in another size: by its own `at_scale` if it has one, otherwise field by field."""
    return thing.at_scale(scale) if hasattr(thing, "at_scale") else with_lengths(thing, scale)


def with_lengths(thing: Any, scale: float, but: Collection[str] = ()) -> Any:
    """A dataclass whose fields are multiplied as their declarations require. but: names of fields that stay."""
    hints = get_type_hints(type(thing), include_extras=True)
    changed: dict[str, Any] = {}
    for field in dataclasses.fields(thing):
        value, about = getattr(thing, field.name), field.metadata
        if value is None or field.name in but or not field.init:
            continue
        if "unit" in about:
            power = length_power(about["unit"])
            changed |= {field.name: value * scale**power} if power else {}
        elif "units" in about:
            changed[field.name] = _rows(value, [scale ** length_power(unit) for unit in about["units"]])
        else:
            changed[field.name] = _resized(value, hints[field.name], scale)
    return dataclasses.replace(thing, **changed)


def _rows(rows: Any, factors: Sequence[float]) -> Any:
    """Rows of numbers, each column multiplied by its own factor."""
    if rows and isinstance(rows[0], (tuple, list)):
        return tuple(_rows(row, factors) for row in rows)
    return tuple(number * factor for number, factor in zip(rows, factors)) if rows else rows


def _resized(value: Any, hint: Any, scale: float) -> Any:
    """A value whose points (complex by annotation) are multiplied and whose dataclasses are resized."""
    origin, inner = get_origin(hint), get_args(hint)
    if dataclasses.is_dataclass(value):
        return resized(value, scale)
    if origin is Annotated:
        return _resized(value, inner[0], scale)
    if hint is complex:
        return np.multiply(value, scale) if np.ndim(value) else value * scale
    if origin in (Union, types.UnionType):
        # A field may be a sign or the position of a joint, or a name or the position of a point.
        if type(value) in inner and isinstance(value, (int, str)):
            return value
        return _resized(value, complex if complex in inner else inner[0], scale)
    if isinstance(value, (tuple, list)) and inner:
        hints = inner if origin is tuple and inner[-1] is not ... else [inner[0]] * len(value)
        return tuple(_resized(item, item_hint, scale) for item, item_hint in zip(value, hints))
    if isinstance(value, Mapping) and inner:
        return {name: _resized(item, inner[1], scale) for name, item in value.items()}
    return value
