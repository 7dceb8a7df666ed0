"""Sizes of one cam: single numbers, where a linkage may take arrays."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from ..errors import DesignError, shown
from ..sizes import allowed, check_sizes


def check_numbers(thing: Any) -> None:
    """Raise DesignError for the first quantity of a dataclass that is no single finite number in its range."""
    check_sizes(thing)
    for field in dataclasses.fields(thing):
        value = getattr(thing, field.name)
        if "unit" in field.metadata and np.ndim(value):
            raise DesignError(field.name, f"found {shown(value)}", f"give {allowed(field.metadata)}")
