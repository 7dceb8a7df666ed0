"""Where methods fail: cells of the stability study."""

from __future__ import annotations

from ..family import Cell
from . import cams_and_gears as cams_and_gears
from . import linkages as linkages

CELLS: tuple[Cell, ...] = (
    *linkages.CELLS, *linkages.POSE_CELLS, *cams_and_gears.CAM_CELLS, *cams_and_gears.GEAR_CELLS,
)  # fmt: skip
