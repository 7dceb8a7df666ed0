"""The table of families, in the order in which the chart shows them."""

from __future__ import annotations

from collections.abc import Mapping

from ..family import MethodFamily
from . import curves as curves
from . import four_bar as four_bar
from . import lengths as lengths
from . import other_linkages as other_linkages
from . import sampled as sampled
from . import searches as searches
from . import written_files as written_files

FAMILIES: Mapping[str, MethodFamily] = {
    family.name: family
    for family in (
        *(four_bar.POSITION, four_bar.TOGGLE, four_bar.RATES, four_bar.TOGGLE_RATES),
        *(lengths.NEW_LENGTHS, lengths.DERIVATIVES),
        *(sampled.VELOCITY, sampled.ACCELERATION, sampled.INTEGRATION),
        *(other_linkages.SLIDER_CRANK, other_linkages.SIX_BAR_POSITION, other_linkages.ITERATION),
        lengths.TOLERANCE_BAND,
        *(curves.CAM_FLATTENING, curves.GEAR_FLATTENING, curves.CAM_PROFILE, curves.GEAR_ROOT, curves.CONJUGATE_TOOTH),
        *(searches.FUNCTION_SYNTHESIS, searches.PATH_SYNTHESIS, searches.NINE_POINTS),
        *(written_files.CSV_WRITING, written_files.DXF_WRITING, written_files.STL_WRITING),
    )
}
