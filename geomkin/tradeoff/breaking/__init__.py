"""Where methods fail: cells of the stability study, a file of them for each kind of mechanism."""

from __future__ import annotations

from ..cell import Cell
from . import cams as cams
from . import gears as gears
from . import linkages as linkages

CELLS: tuple[Cell, ...] = (*linkages.CELLS, *linkages.POSE_CELLS, *cams.CELLS, *gears.CELLS)
