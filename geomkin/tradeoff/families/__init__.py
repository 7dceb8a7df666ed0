"""The table of families, in the order in which the chart shows them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..family import MethodFamily
from .four_bar_position import POSITION, TOGGLE
from .four_bar_rates import RATES, TOGGLE_RATES
from .iteration import ITERATION
from .sampled_rates import ACCELERATION, VELOCITY
from .sampled_ways import INTEGRATION
from .six_bar import SIX_BAR_POSITION
from .slider_crank import SLIDER_CRANK

FAMILIES: Mapping[str, MethodFamily[Any, Any]] = {
    family.name: family
    for family in (
        POSITION,
        TOGGLE,
        RATES,
        TOGGLE_RATES,
        VELOCITY,
        ACCELERATION,
        INTEGRATION,
        SLIDER_CRANK,
        SIX_BAR_POSITION,
        ITERATION,
    )
}
