"""The table of families, in the order in which the chart shows them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..family import MethodFamily
from .four_bar_position import POSITION, TOGGLE

FAMILIES: Mapping[str, MethodFamily[Any, Any]] = {
    family.name: family
    for family in (
        POSITION,
        TOGGLE,
    )
}
