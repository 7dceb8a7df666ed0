"""The table of families, in the order in which the chart shows them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..family import MethodFamily
from .cam_profile import CAM_PROFILE
from .conjugate_tooth import CONJUGATE_TOOTH
from .curve_flattening import CAM_FLATTENING, GEAR_FLATTENING
from .derivatives import DERIVATIVES
from .file_writing import CSV_WRITING, DXF_WRITING, STL_WRITING
from .four_bar_position import POSITION, TOGGLE
from .four_bar_rates import RATES, TOGGLE_RATES
from .function_synthesis import FUNCTION_SYNTHESIS
from .gear_root import GEAR_ROOT
from .iteration import ITERATION
from .new_lengths import NEW_LENGTHS
from .nine_points import NINE_POINTS
from .path_synthesis import PATH_SYNTHESIS
from .sampled_integrals import INTEGRATION
from .sampled_rates import ACCELERATION, VELOCITY
from .six_bar import SIX_BAR_POSITION
from .slider_crank import SLIDER_CRANK
from .tolerance import TOLERANCE_BAND

FAMILIES: Mapping[str, MethodFamily[Any, Any]] = {
    family.name: family
    for family in (
        POSITION,
        TOGGLE,
        RATES,
        TOGGLE_RATES,
        NEW_LENGTHS,
        DERIVATIVES,
        VELOCITY,
        ACCELERATION,
        INTEGRATION,
        SLIDER_CRANK,
        SIX_BAR_POSITION,
        ITERATION,
        TOLERANCE_BAND,
        CAM_FLATTENING,
        GEAR_FLATTENING,
        CAM_PROFILE,
        GEAR_ROOT,
        CONJUGATE_TOOTH,
        FUNCTION_SYNTHESIS,
        PATH_SYNTHESIS,
        NINE_POINTS,
        CSV_WRITING,
        DXF_WRITING,
        STL_WRITING,
    )
}
